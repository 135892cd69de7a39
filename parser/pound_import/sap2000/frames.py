"""Frames: connectivity, and what `assignments` add to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000 import joints as points
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.sections import SapSection
from pound_import.sap2000.tables import SapRow, SapTables
from pound_import.sap2000.vectors import Vector, difference, length, local_axes


@dataclass(frozen=True, slots=True)
class SapFrame:
    """A frame.

    Attributes
    ----------
    axes : tuple, shape (3, 3)
        Unit vectors of its local axes.
    released : frozenset of str
        Components of force that it does not transmit, such as ``M3I``.
    fixity : dict of str to float
        Springs of released moments [F L].
    offsets : tuple of float, shape (2,)
        Lengths of its rigid ends [L].
    added : float
        Mass per length besides that of its material [F T^2/L^2].
    whole : str
        Name of the frame of which this is a part; empty: it is no part.
    part : tuple of float, shape (2,)
        Fractions of the length of that frame from which and to which it goes.
    """

    name: str
    i: SapJoint
    j: SapJoint
    span: Span
    axes: tuple[Vector, Vector, Vector]
    section: SapSection | None = None
    modifiers: SapRow | None = None
    released: frozenset[str] = frozenset()
    fixity: Mapping[str, float] = field(default_factory=dict)
    offsets: tuple[float, float] = (0.0, 0.0)
    added: float = 0.0
    whole: str = ""
    part: tuple[float, float] = (0.0, 1.0)

    @property
    def length(self) -> float:
        """Distance of its joints [L]."""
        return length(difference(self.j.at, self.i.at))


def connected(tables: SapTables, joints: dict[str, SapJoint], draft: Draft) -> dict[str, SapFrame]:
    """Frames by name, of the whole model."""
    frames: dict[str, SapFrame] = {}
    for row in tables["CONNECTIVITY - FRAME"]:
        with draft.keeping():
            name = row.text("Frame")
            if name in frames:
                what = f"frame {name[:40]} is given twice"
                raise mistake("L645", what, row.place("Frame"), "give it another name")
            i, j = (points.known(joints, row, key) for key in ("JointI", "JointJ"))
            if i.at == j.at:
                what = f"frame {name[:40]} has no length"
                raise mistake("L651", what, row.span, "its joints must lie at two places")
            if row.yes("IsCurved"):
                what = f"frame {name[:40]} is curved"
                raise mistake("L651", what, row.place("IsCurved"), "divide it into straight frames")
            frames[name] = SapFrame(name, i, j, row.span, local_axes(difference(j.at, i.at), 0.0))
    return frames


def known(frames: Mapping[str, SapFrame], row: SapRow) -> SapFrame:
    """Frame that a row names.

    Raises
    ------
    Mistake
        There is none.
    """
    name = row.text("Frame")
    if name not in frames:
        what = f"{row.table}: there is no frame {name[:40]}"
        raise mistake("L646", what, row.place("Frame"), "correct the name, or add the frame")
    return frames[name]
