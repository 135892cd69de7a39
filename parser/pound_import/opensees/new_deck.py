"""The new deck while it is written: its numbers, its property sets, and the masses of its nodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from pound_import.draft import Draft, number
from pound_import.opensees.commands import Command
from pound_import.opensees.model import DIRECTIONS, ScriptModel

MOST: Final = 10_000_000  #: largest number of a node or element that is kept


class NewDeck:
    """Writer of nodes, elements and property sets.

    Parameters
    ----------
    model : ScriptModel
    draft : Draft
    stiffness_factors : mapping of int to str
        For each element the damping that multiplies its stiffness, as `damping` names it.
    """

    def __init__(self, model: ScriptModel, draft: Draft, stiffness_factors: Mapping[int, str]) -> None:
        self.model, self.draft = model, draft
        self._factors = stiffness_factors
        self._nodes = _numbers(model.points)
        self._elements = _numbers(model.elements)
        self._last = max((*self._elements.values(), 0))
        self._labels: dict[tuple[str, str], str] = {}
        self._counts: dict[str, int] = {}
        self.damped: dict[str, list[str]] = {}  #: labels by the damping of their stiffness
        self.masses = {tag: list(point.mass) for tag, point in model.points.items()}
        self.written: dict[int, list[int]] = {}  #: numbers of the new elements by those of the model
        self.members: set[int] = set()  #: tags of elements that are a FRAME

    def node(self, tag: int) -> int:
        """Number of a node in the new deck."""
        return self._nodes[tag]

    def nodes(self, tags: Iterable[int]) -> str:
        """Numbers of nodes, joined by commas."""
        return ",".join(str(self._nodes[tag]) for tag in tags)

    def element(
        self,
        tag: int,
        letter: str,
        words: str,
        ends: tuple[int, int],
        notes: Iterable[str] = (),
        damped: bool = True,
    ) -> None:
        """Write an element and, unless it is there, its property set.

        Parameters
        ----------
        tag : int
            Of the element that it is made of.
        letter : str
            First letter of the label.
        words : str
            Of the property set.
        ends : tuple of int
            Its nodes' tags.
        notes : iterable of str
            Comments on the property set.
        damped : bool
            Whether damping in proportion to stiffness acts on it.
        """
        factor = self._factors.get(tag, "") if damped else ""
        command = self.model.elements[tag]
        key = words, factor
        if key not in self._labels:
            self._counts[letter] = self._counts.get(letter, 0) + 1
            self._labels[key] = label = f"{letter}{self._counts[letter]}"
            self.draft.add("PROPS", f"{label} {words}", command.span, dict.fromkeys(notes))
            if damped:
                self.damped.setdefault(factor, []).append(label)
        number_of_it = self._elements[tag]
        if tag in self.written:
            self._last += 1
            number_of_it = self._last
        self.written.setdefault(tag, []).append(number_of_it)
        if words.startswith("FRAME "):
            self.members.add(tag)
        i, j = (self._nodes[end] for end in ends)
        self.draft.add("ELEMENTS", f"{number_of_it} {self._labels[key]} {i} {j}", command.span)

    def add_mass(self, tags: Iterable[int], mass: float) -> None:
        """Add a mass that moves along x and y to each of the nodes."""
        for tag in tags:
            self.masses[tag][0] += mass
            self.masses[tag][1] += mass

    def write_nodes(self, followers: Mapping[int, Mapping[str, int]]) -> None:
        """Write nodes and weights; `followers` has a node's directions that follow others, and these."""
        for tag, point in self.model.points.items():
            masters = followers.get(tag, {})
            fixed = [d for d in DIRECTIONS if d in point.fixed or d not in point.letters]
            kept = "".join(d for d in fixed if d not in masters)
            words = [str(self._nodes[tag]), number(point.x), number(point.y)]
            words += [f"FIX={kept}"] if kept else []
            if masters:
                nodes = list(masters.values())
                named = nodes if len(set(nodes)) > 1 else nodes[:1]
                words += [f"SLAVED={''.join(masters)}", f"MASTER={self.nodes(named)}"]
            notes = [f"node {tag} of the model"] if self._nodes[tag] != tag else []
            self.draft.add("NODES", " ".join(words), point.command.span, notes)
        for tag, mass in self.masses.items():
            if any(mass):
                self._weight(tag, mass)

    def _weight(self, tag: int, mass: list[float]) -> None:
        command = self.model.points[tag].command
        if min(mass) < 0.0:
            self.draft.report.append(
                command.mistake(f"node {tag} has a negative mass", code="L620").diagnostic  # type: ignore[arg-type]
            )
            return
        x, y, r = (f"{number(value)}*g" if value else "0" for value in mass)
        self.draft.add(
            "WEIGHTS", f"{self._nodes[tag]} {x} {y}" + (f" {r}" if mass[2] else ""), command.span
        )


def _numbers(tags: Iterable[int]) -> dict[int, int]:
    """Numbers of the new deck by tags: the same where a deck takes them."""
    tags = list(tags)
    if all(0 < tag <= MOST for tag in tags):
        return dict(zip(tags, tags))
    return {tag: k for k, tag in enumerate(tags, 1)}


def ends(command: Command, model: ScriptModel) -> tuple[int, int]:
    """Nodes of an element, the two words behind its tag.

    Raises
    ------
    Mistake
        One is missing or not defined.
    """
    i, j = command.whole(3, "the first node"), command.whole(4, "the second node")
    model.point(i, command)
    model.point(j, command)
    return i, j
