"""The script while it is written: its lines by section, its tags, and what it cannot contain."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count
from typing import Any, Final, NamedTuple

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Model, Span
from pound_solve.structure.structure import Structure

REFUSED: Final = "P380"  #: number of the message on what has no counterpart
#: functions of the script, in this order, and what each does
SECTIONS: Final = {
    "nodes": "Nodes, supports, slaved directions and masses.",
    "elements": "Members, springs, dashpots and contacts.",
    "loads": "Static loads.",
    "released": "Loads that the history releases at its start.",
    "damping": "Damping: factors on masses and on initial stiffnesses; contacts have none.",
    "motion": "Ground motions, forces and initial velocities.",
}


class Material(NamedTuple):
    """A uniaxialMaterial of OpenSees: its type, its arguments after the tag, and the materials whose tags
    come first among them.
    """

    kind: str
    arguments: tuple[float | str, ...]
    parts: tuple[Material, ...] = ()


@dataclass
class Script:
    """A script while it is written.

    Attributes
    ----------
    model : Model
    structure : Structure
    lines : dict of str to list of str
        Statements by section.
    files : dict of str to str
        Texts of the files beside the script, by name.
    refusals : list of Diagnostic
    sway : list of str
        Rows of the table of members whose axial force has a side force (PDELTA).
    arms : bool
        Whether nodes follow others by rigid arms that turn.
    settled : bool
        Whether the history starts with accelerations.
    """

    model: Model
    structure: Structure
    lines: dict[str, list[str]] = field(default_factory=lambda: {name: [] for name in SECTIONS})
    files: dict[str, str] = field(default_factory=dict)
    refusals: list[Diagnostic] = field(default_factory=list)
    sway: list[str] = field(default_factory=list)
    arms: bool = False
    settled: bool = True

    def __post_init__(self) -> None:
        first = 10 ** len(str(max((*self.model.nodes, *self.model.elements))))
        self._tags: Iterator[int] = count(first + 1)
        self._materials: dict[Material, int] = {}

    def tag(self) -> int:
        """Return a tag above all numbers of the deck."""
        return next(self._tags)

    def call(self, section: str, command: str, *arguments: object) -> None:
        """Add a command of OpenSees."""
        self.lines[section].append(f"ops.{command}({', '.join(map(literal, arguments))})")

    def refuse(self, message: str, place: Span, hint: str = "") -> None:
        """Add a refusal, once for each message and place."""
        refusal = Diagnostic(REFUSED, message, place, hint)
        if refusal not in self.refusals:
            self.refusals.append(refusal)

    def material(self, material: Material) -> int:
        """Write a material unless it is there already, and return its tag."""
        if material not in self._materials:
            tags = [self.material(part) for part in material.parts]
            self._materials[material] = tag = self.tag()
            self.call("elements", "uniaxialMaterial", material.kind, tag, *tags, *material.arguments)
        return self._materials[material]


def literal(value: Any) -> str:
    """Python text of a word or number; floats with all digits."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return repr(int(value) if isinstance(value, bool | int) else float(value))


def table(rows: Iterable[str]) -> str:
    """Text of a tuple with one row to a line."""
    lines = "".join(f"    {row},\n" for row in rows)
    return f"(\n{lines})" if lines else "()"
