"""Elements without length of their own: zeroLength, zeroLengthSection, twoNodeLink.

Each of their materials acts in one direction; those of one element that can share a SPRING do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from pound_import.draft import number, numbers
from pound_import.opensees.commands import Command, Flags, joined, options
from pound_import.opensees.materials import Materials
from pound_import.opensees.model import ScriptModel
from pound_import.opensees.new_deck import NewDeck, ends
from pound_import.opensees.parts import GapPart, Part, SpringPart, ViscousPart
from pound_import.opensees.sections import AXIAL, BENDING, SHEAR, Sections

#: components by direction: in two dimensions a third direction is the rotation
_COMPONENTS: Final = {1: "X", 2: "Y", 3: "R", 6: "R"}
_STRENGTHS: Final = {"X": "FX", "Y": "FY", "R": "MR"}
_FORCES: Final = {AXIAL: "X", SHEAR: "Y", BENDING: "R"}


@dataclass(slots=True)
class Links:
    """Translator of elements without length.

    Attributes
    ----------
    model : ScriptModel
    deck : NewDeck
    materials : Materials
    sections : Sections
    """

    model: ScriptModel
    deck: NewDeck
    materials: Materials
    sections: Sections

    def zero_length(self, tag: int, command: Command) -> None:
        """``zeroLength``: materials and their directions, along global axes or those of ``-orient``."""
        choice = options(command, 5)
        choice.only(("-mat", "-dir", "-dof", "-doRayleigh", "-orient"))
        self._write(tag, command, self._acting(choice), _angle(choice, 0.0), "")

    def of_section(self, tag: int, command: Command) -> None:
        """``zeroLengthSection``: the forces of a section."""
        choice = options(command, 6)
        choice.only(("-orient", "-doRayleigh"))
        section = self.sections.section(command.whole(5, "the section"), command)
        if section.fibres:
            raise command.mistake(f"element {tag}: a section of fibres without a length")
        for force in section.laws:
            if force not in _FORCES:
                raise command.mistake(
                    f"element {tag}: the force {force[:20]} of its section has no direction here"
                )
        acting = [(_FORCES[force], law) for force, law in section.laws.items()]
        self._write(tag, command, acting, _angle(choice, 0.0), "")

    def two_nodes(self, tag: int, command: Command) -> None:
        """``twoNodeLink``: as zeroLength, its local x from node to node, its shear between them."""
        choice = options(command, 5)
        choice.only(("-mat", "-dir", "-doRayleigh", "-orient", "-shearDist", "-mass"))
        i, j = (self.model.points[end] for end in ends(command, self.model))
        length = math.hypot(j.x - i.x, j.y - i.y)
        along = math.degrees(math.atan2(j.y - i.y, j.x - i.x)) if length else 0.0
        angle = _angle(choice, along)
        if length and not math.isclose(math.cos(math.radians(angle - along)), 1.0, abs_tol=1e-9):
            raise command.mistake(f"twoNodeLink {tag}: its local x does not run from node to node")
        shares = choice.reals("-shearDist")
        arm = f"ARM={number(shares[0] if shares else 0.5)}" if length else ""
        self.deck.add_mass(ends(command, self.model), 0.5 * choice.real("-mass", 0.0))
        self._write(tag, command, self._acting(choice), angle, arm)

    def _acting(self, choice: Flags) -> list[tuple[str, Part]]:
        """Parts and their components."""
        command = choice.command
        tags, directions = choice.wholes("-mat"), choice.wholes("-dir") or choice.wholes("-dof")
        if not tags or len(tags) != len(directions):
            what = f"element {command.words[2]}: {len(tags)} materials with {len(directions)} directions"
            raise command.mistake(what, code="L620")
        acting = []
        for tag, direction in zip(tags, directions):
            if direction not in _COMPONENTS:
                raise command.mistake(
                    f"element {command.words[2]}: direction {direction} lies outside of the plane"
                )
            acting += [(_COMPONENTS[direction], part) for part in self.materials.parts(tag, command)]
        return acting

    def _write(
        self, tag: int, command: Command, acting: Sequence[tuple[str, Part]], angle: float, arm: str
    ) -> None:
        both = ends(command, self.model)
        turned = f"ANGLE={number(angle)}" if angle else ""
        springs: list[dict[str, SpringPart]] = []
        for component, part in acting:
            if isinstance(part, SpringPart):
                _share(springs, component, part)
        for spring in springs:
            notes = [note for law in spring.values() for note in law.notes]
            self.deck.element(tag, "S", joined((_words(spring), turned, arm)), both, notes)
        for component, part in acting:
            if isinstance(part, ViscousPart):
                alpha = "" if part.alpha == 1.0 else f"ALPHA={number(part.alpha)}"
                words = joined((f"DASHPOT C{component}={number(part.c)}", turned, arm, alpha))
                self.deck.element(tag, "D", words, both, part.notes, damped=False)
            elif isinstance(part, GapPart):
                self._contact(tag, command, component, part, angle)

    def _contact(self, tag: int, command: Command, component: str, part: GapPart, angle: float) -> None:
        """Write a contact: it closes as the first node moves along the local axis towards the second."""
        if component == "R":
            raise command.mistake(f"element {tag}: a gap of a rotation")
        direction = angle + (90.0 if component == "Y" else 0.0) + (180.0 if part.pulls else 0.0)
        masses = "" if part.masses is None else f"MASSES={number(part.masses)},{number(part.masses)}"
        words = (
            f"CONTACT GAP={number(part.gap)}",
            f"ANGLE={number(_turn(direction))}",
            f"LAW={part.words()}",
            masses,
        )
        self.deck.element(tag, "C", joined(words), ends(command, self.model), part.notes, damped=False)


def _share(springs: list[dict[str, SpringPart]], component: str, part: SpringPart) -> None:
    """Put a component into the first spring that has none there and no other rule's items."""
    for spring in springs:
        yielding = [law for law in spring.values() if law.rule != "ELASTIC"]
        if component not in spring and (part.rule == "ELASTIC" or not yielding):
            spring[component] = part
            return
    springs.append({component: part})


def _words(spring: dict[str, SpringPart]) -> str:
    """Property set of a SPRING."""
    parts = [
        f"K{component}={number(spring[component].k)}" for component in _STRENGTHS if component in spring
    ]
    yielding = {component: law for component, law in spring.items() if law.rule != "ELASTIC"}
    parts += [f"{_STRENGTHS[component]}={numbers(law.strength)}" for component, law in yielding.items()]
    if yielding:
        rules = [spring[c].rule if c in spring else "ELASTIC" for c in _STRENGTHS]
        parts.append(f"RULE={','.join(rules)}")
        parts += [law.words() for law in yielding.values()]
    return joined(("SPRING", *parts))


def _angle(choice: Flags, default: float) -> float:
    """Angle of local x from global x [deg].

    Raises
    ------
    Mistake
        ``-orient`` turns it out of the plane, or turns local y the other way.
    """
    given = choice.reals("-orient")
    if not given:
        return default
    command = choice.command
    if len(given) not in (3, 6):
        raise command.mistake("-orient needs 3 or 6 numbers", code="L620")
    if len(given) == 3:  # local y alone
        x, y = (given[1], -given[0]), (given[0], given[1])
        flat = given[2] == 0.0
    else:
        x, y = (given[0], given[1]), (given[3], given[4])
        flat = given[2] == 0.0 == given[5]
    if not flat or x[0] * y[1] - x[1] * y[0] <= 0.0:
        raise command.mistake("-orient turns the element out of the plane, or its local y the other way")
    return _turn(math.degrees(math.atan2(x[1], x[0])))


def _turn(angle: float) -> float:
    """Angle between -180 and 180 degrees, exact at right angles."""
    turned = math.remainder(angle, 360.0)
    nearest = 90.0 * round(turned / 90.0)
    return nearest if abs(turned - nearest) < 1e-12 else turned
