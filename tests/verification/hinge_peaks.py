"""Peaks of hinges of a frame: every hysteresis rule by several methods, with joints that have mass or none.

    python -m verification.hinge_peaks

prints a table.  Per rule, joints and method it gives the largest deviation of ductilities, plastic work,
drifts and contact forces from a reference that is another method: TAYLOR, which has no truncation error;
where it does not take the rule, or was taken itself, NEWMARK with a step of 1/16 of that of the methods.
"""

from __future__ import annotations

import random
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from verification.generated import laws
from verification.generated.answers import Answer, answer, errors
from verification.generated.campaign import Worker

FRAME = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 6 0 FIX=XYR
 11 0 4
 12 6 4
 21 0 7
 22 6 7
ELEMENTS
 1 COL 1 11
 2 COL 2 12
 3 BEAM 11 12
 4 COL 11 21
 5 COL 12 22
 6 BEAM 21 22
 7 WALL 22
PROPS
 COL FRAME E=200E6 A=0.01 I=0.00013 KH=90000 MI=240 MJ=240 {column}
 BEAM FRAME E=200E6 A=0.008 I=0.0002 KH=110000 MI=210 MJ=210 {beam}
 WALL CONTACT GAP=0.05 LAW=LINEAR K=2E4
WEIGHTS
 11,12,21,22 240 240 {turn}
LOADS
 11,12,21,22 0 -150
DAMPING
 RAYLEIGH ALPHA=0.25 BETA=0.002
DRIFT
 "lower" 1 11
 "upper" 11 21
EQUAKE
 SYNTHETIC SEED=1 PGA=9 DURATION=1.5 RISE=0.3 STRONG=1
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 1.5
"""
SECONDS = 20.0  #: CPU time of a run by AUTO
FINER = 16  #: steps of the reference in one of the methods
STEP = 0.002  #: of methods with steps [s]
METHODS = {
    "NEWMARK": {"dt": STEP},
    "HHT": {"dt": STEP},
    "GENERALISED_ALPHA": {"dt": STEP},
    "EXACT": {},
    "TAYLOR": {},
    "LAGUERRE": {},
    "AUTO": {"tol": 1e-3},
}
JOINTS = {"massless": "", "mass": "2"}  #: what WEIGHTS give the rotations of the joints
RULES = tuple(spec.name for spec in laws.choices("hysteresis", False))


def deck(rule: str, joints: str) -> str:
    """Frame of a rule, whose items are drawn from its name and scaled to the hinges' yield."""
    (spec,) = (s for s in laws.choices("hysteresis", False) if s.name == rule)
    rng = random.Random(rule)
    items = [
        " ".join([f"RULE={rule}", *laws.items(rng, spec, moment, moment / stiffness)])
        for moment, stiffness in ((240.0, 90e3), (210.0, 110e3))
    ]
    return FRAME.format(column=items[0], beam=items[1], turn=JOINTS[joints])


class Frames:
    """Answers of methods to the frames.

    Parameters
    ----------
    solve : callable
        Solves a deck, as `answers.answer` and `campaign.Worker.solve` do.
    """

    def __init__(self, solve: Callable[..., Answer] = answer) -> None:
        self.solve = solve
        self.known: dict[tuple[str, str, str, float], Answer] = {}

    def by(self, rule: str, joints: str, method: str, dt: float = STEP) -> Answer:
        """Answer of a method to a frame; it is asked once."""
        if (key := (rule, joints, method, dt)) not in self.known:
            options = METHODS[method] if dt == STEP else {"dt": dt}
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder, "frame.inp")
                path.write_text(deck(rule, joints), encoding="utf-8")
                self.known[key] = self.solve(path, None, method, options)
        return self.known[key]

    def deviation(self, rule: str, joints: str, method: str) -> float | str:
        """Largest deviation of the peaks from another method's; the status where one does not end."""
        own = self.by(rule, joints, method)
        truth = self.by(rule, joints, "TAYLOR") if own.method != "TAYLOR" else None
        if truth is None or truth.status != "done":
            truth = self.by(rule, joints, "NEWMARK", STEP / FINER)
        if own.status != "done" or truth.status != "done":
            return own.status if own.status != "done" else f"reference {truth.status}"
        found = errors(own, truth)
        return max(found[kind] for kind in ("hinge", "drift", "contact"))


def table(frames: Frames) -> Iterator[str]:
    """Lines of the table, in Markdown."""
    head = ["rule", "joints", *METHODS]
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for rule in RULES:
        for joints in JOINTS:
            found = [frames.deviation(rule, joints, method) for method in METHODS]
            cells = [f"{x:.1e}" if isinstance(x, float) else x for x in found]
            yield f"| {rule} | {joints} | {' | '.join(cells)} |"


if __name__ == "__main__":
    worker = Worker(SECONDS)
    for line in table(Frames(worker.solve)):
        print(line, flush=True)
    worker.end()
