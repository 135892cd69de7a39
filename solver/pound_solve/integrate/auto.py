"""AUTO: EXACT where the scene is piecewise linear and of moderate size, which needs no time step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate import exact, newmark
from pound_solve.integrate.base import Outcome, Sink, Start, Stop, Watch
from pound_solve.scene import Decision, Scene

MOST_UNKNOWNS = 1000  #: at 800 unknowns a run like the paper's takes a minute


def integrate(scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink) -> Outcome:
    """Choose a method, note why, and run it."""
    if scene.size <= MOST_UNKNOWNS:
        scene.decisions.append(
            Decision(
                "method",
                "EXACT",
                f"all laws are piecewise linear and {scene.size} unknowns are not many: "
                "no time step is needed",
            )
        )
        return exact.integrate(scene, start, watch, {}, sink)
    if options.get("DT") is None:
        raise Stop(
            "A505",
            0.0,
            f"{scene.size} unknowns are too many for EXACT (up to {MOST_UNKNOWNS}); "
            "give METHOD=AUTO a DT for NEWMARK",
        )
    scene.decisions.append(
        Decision(
            "method", "NEWMARK", f"{scene.size} unknowns are too many for EXACT (up to {MOST_UNKNOWNS})"
        )
    )
    return newmark.integrate(scene, start, watch, options, sink)


SPEC = Spec(
    "method",
    "AUTO",
    "EXACT where it pays, else NEWMARK",
    (Field("DT", Kind.REAL, "T", default=None, above=0, doc="time step, should NEWMARK be needed"),),
    impl=integrate,
)
