"""Beams and bars: FRAME, elastic or with hinges.

A section that yields at each of several points of integration becomes two hinges, as long as the weights of
the end points.

Reference
---------
Scott MH, Fenves GL (2006), Plastic hinge integration methods for force-based beam-column elements,
J. Struct. Eng. 132(2): 244-252: HingeRadau is exact for an elastic interior beside hinges of length LP.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from pound_import.draft import number, numbers
from pound_import.opensees.commands import Command, joined, options
from pound_import.opensees.materials import Materials
from pound_import.opensees.model import ScriptModel
from pound_import.opensees.new_deck import NewDeck, ends
from pound_import.opensees.parts import GapPart, Part, SpringPart, ViscousPart, alike
from pound_import.opensees.reduction import reduced
from pound_import.opensees.sections import AXIAL, BENDING, SHEAR, SectionLaws, Sections

GEOMETRIES: Final = {
    "Linear": "SMALL",
    "LinearInt": "SMALL",
    "PDelta": "PDELTA_VARYING",
    "Corotational": "LARGE",
}
_PINS: Final = {0: "", 1: "PIN=I", 2: "PIN=J", 3: "PIN=BOTH"}
_HINGED: Final = ("HingeRadau", "HingeRadauTwo", "HingeMidpoint", "HingeEndpoint")


@dataclass(frozen=True, slots=True)
class Shape:
    """Axis of a member: its length between the ends of the rigid blocks, and these [L]."""

    length: float
    blocks: tuple[float, float] = (0.0, 0.0)

    def words(self) -> str:
        """Items of the rigid blocks."""
        return joined(f"END{k}={number(x)}" if x else "" for k, x in enumerate(self.blocks, 1))


@dataclass(slots=True)
class Beams:
    """Translator of members.

    Attributes
    ----------
    model : ScriptModel
    deck : NewDeck
    materials : Materials
    sections : Sections
    geometries : dict of str to Command
        Kinds of geometry that members have, each with the first that has it.
    axial : mapping of int to float, or None
        Axial forces of elements in the static state, tension positive [F]; None: sections of fibres stay
        elastic.
    """

    model: ScriptModel
    deck: NewDeck
    materials: Materials
    sections: Sections
    geometries: dict[str, Command]
    axial: Mapping[int, float] | None = None

    # ------------------------------------------------------------------ elastic

    def elastic(self, tag: int, command: Command) -> None:
        """``elasticBeamColumn``: A E I, or a section, and the transformation."""
        choice = options(command, 5)
        choice.only(("-mass", "-cMass", "-lMass", "-release", "-releasez"))
        plain = choice.plain
        if len(plain) == 2 and _is_whole(plain[0]):
            section = self.sections.section(command.whole(5, "the section"), command)
            if SHEAR in section.laws:
                reading = f"element {tag} has no shear deformation, as in OpenSees 3.7.1"
                section = _slender(section, self.materials.doubt(command, reading))
        elif len(plain) == 4:
            area, e, inertia = command.reals(5, "A E I")
            section = _section(e, area, inertia)
        else:
            raise command.mistake(
                f"elasticBeamColumn {tag}: A E I and a transformation, or a section", code="L620"
            )
        shape = self._shape(command, command.whole(4 + len(plain), "the transformation"))
        release = choice.real("-release", choice.real("-releasez", 0.0))
        if release not in _PINS:
            raise command.mistake(
                f"elasticBeamColumn {tag}: -release is {release:g}, not 0 to 3", code="L620"
            )
        self._elastic(tag, command, section, shape, _PINS[int(release)])

    def timoshenko(self, tag: int, command: Command) -> None:
        """``ElasticTimoshenkoBeam``: E G A I and the shear area."""
        e, g, area, inertia, shear = command.reals(5, "E G A Iz Avy")
        choice = options(command, 11)
        choice.only(("-mass", "-cMass"))
        section = SectionLaws({SHEAR: SpringPart(g * shear)}, (e, area, inertia))
        self._elastic(
            tag, command, section, self._shape(command, command.whole(10, "the transformation")), ""
        )

    def _elastic(self, tag: int, command: Command, section: SectionLaws, shape: Shape, pin: str) -> None:
        words = joined(("FRAME", _elastic_words(command, section), shape.words(), pin))
        self._mass(tag, command, shape, words, section.notes)

    def _mass(self, tag: int, command: Command, shape: Shape, words: str, notes: Sequence[str]) -> None:
        """Write a member with its mass: of the nodes, or along it where it is consistent."""
        choice = options(command, 5)
        mass = choice.real("-mass", 0.0)
        if mass < 0.0:
            raise command.mistake(f"the mass of element {tag} is negative", code="L620")
        if "-cMass" in choice.flags and mass:
            words = f"{words} WGT={number(mass)}*g"
        elif mass:
            self.deck.add_mass(ends(command, self.model), 0.5 * mass * shape.length)
        self.deck.element(tag, "B", words, ends(command, self.model), notes)

    # ------------------------------------------------------------------ with sections along them

    def integrated(self, tag: int, command: Command) -> None:
        """``forceBeamColumn``, ``nonlinearBeamColumn``, ``dispBeamColumn``, in their three forms."""
        choice = options(command, 5)
        plain = " ".join(choice.plain).split()
        words = Command(("integration", *plain), command.span)
        if plain and not _is_whole(plain[0]):
            raise command.mistake(
                f"element {tag}: a transformation or a count of sections is missing", code="L620"
            )
        if len(plain) == 3:  # count of points, section, transformation
            rule = (*choice.flags.get("-integration", ("Lobatto",)), "Lobatto")[0]
            self._distributed(
                tag,
                command,
                rule,
                words.whole(1, "the count"),
                words.whole(2, "the section"),
                words.whole(3, "the transformation"),
            )
        elif len(plain) == 2:  # transformation, integration
            integration = self.model.item(
                "the integration", self.model.integrations, words.whole(2, "the integration"), command
            )
            self._by_rule(
                tag,
                command,
                words.whole(1, "the transformation"),
                (integration.words[1], *integration.words[3:]),
            )
        elif len(plain) > 3:
            self._by_rule(tag, command, words.whole(1, "the transformation"), tuple(plain[1:]))
        else:
            raise command.mistake(f"element {tag} lacks its sections or its transformation", code="L620")

    def with_hinges(self, tag: int, command: Command) -> None:
        """``beamWithHinges``: sections and lengths of the hinges, then E A I."""
        choice = options(command, 5)
        lengths = command.real(6, "the first hinge's length"), command.real(8, "the second hinge's length")
        hinges = (
            command.whole(5, "the first hinge's section"),
            command.whole(7, "the second hinge's section"),
        )
        if len(choice.plain) == 6:
            interior = self.sections.section(command.whole(9, "the section"), command)
        else:
            interior = _section(*command.reals(9, "E A I"))
        shape = self._shape(command, command.whole(4 + len(choice.plain), "the transformation"))
        self._hinged(tag, command, "HingeRadau", hinges, lengths, interior, shape)

    def _by_rule(self, tag: int, command: Command, transformation: int, words: tuple[str, ...]) -> None:
        rule = Command(words, command.span)
        if rule.name in _HINGED:
            hinges = rule.whole(1, "the first section"), rule.whole(3, "the second section")
            lengths = rule.real(2, "the first length"), rule.real(4, "the second length")
            interior = self.sections.section(rule.whole(5, "the section of the interior"), command)
            self._hinged(
                tag, command, rule.name, hinges, lengths, interior, self._shape(command, transformation)
            )
        elif len(words) == 3:
            self._distributed(
                tag,
                command,
                rule.name,
                rule.whole(2, "the count"),
                rule.whole(1, "the section"),
                transformation,
            )
        else:
            raise command.mistake(
                f"element {tag}: the integration {rule.name[:40]} of several sections has no counterpart"
            )

    def _distributed(
        self, tag: int, command: Command, rule: str, count: int, section_tag: int, transformation: int
    ) -> None:
        section = self._under_load(self.sections.section(section_tag, command), tag, command)
        if command.words[1] == "dispBeamColumn":  # it ignores the shear of its section
            section = _slender(section)
        shape = self._shape(command, transformation)
        if section.bends or section.fibres:
            self._elastic(tag, command, section, shape, "")
            return
        share = 1.0 / (count * (count - 1)) if count > 1 else 0.5  # of the first point of Lobatto
        if rule != "Lobatto":
            raise command.mistake(
                f"element {tag}: a section that yields, integrated by {rule[:40]}", "use Lobatto"
            )
        length = share * shape.length
        note = self.materials.doubt(
            command, f"element {tag} yields in hinges of the length {length:.4g} of its end sections only"
        )
        self._yielding(tag, command, section, [section, section], [length, length], shape, [note])

    def _hinged(
        self,
        tag: int,
        command: Command,
        rule: str,
        hinges: tuple[int, int],
        lengths: tuple[float, float],
        interior: SectionLaws,
        shape: Shape,
    ) -> None:
        interior = self._under_load(interior, tag, command)
        stiffness = interior.laws[BENDING].k if BENDING in interior.laws else None
        at_ends = [
            self._under_load(self.sections.section(hinge, command), tag, command, stiffness)
            for hinge in hinges
        ]
        if any(section.fibres for section in at_ends):  # before the axial forces are known
            self._elastic(tag, command, interior, shape, "")
            return
        if all(section.bends for section in at_ends):
            stiff = [section.laws.get(BENDING, SpringPart(0.0)).k for section in (*at_ends, interior)]
            if all(math.isclose(k, stiff[-1], rel_tol=1e-9) for k in stiff):
                self._elastic(tag, command, interior, shape, "")
                return
        notes = []
        if rule != "HingeRadau":
            notes.append(
                self.materials.doubt(
                    command, f"the integration {rule} is that of hinges of the same lengths"
                )
            )
        self._yielding(tag, command, interior, at_ends, list(lengths), shape, notes)

    def _under_load(
        self, section: SectionLaws, tag: int, command: Command, interior: float | None = None
    ) -> SectionLaws:
        """Section with its fibres reduced, once the axial forces are known."""
        if self.axial is None or section.fibres is None:
            return section
        return reduced(section, tag, command, self.axial.get(tag, 0.0), self.deck.draft, interior)

    def _yielding(
        self,
        tag: int,
        command: Command,
        interior: SectionLaws,
        hinges: list[SectionLaws],
        lengths: list[float],
        shape: Shape,
        notes: list[str],
    ) -> None:
        """Write a FRAME with hinges of lengths within the member."""
        laws = [section.laws.get(BENDING) for section in hinges]
        first, second = laws
        if first is None or second is None or not first.strength or not second.strength:
            raise command.mistake(
                f"element {tag}: a hinge at one end only, or an elastic one of another stiffness"
            )
        if (first.rule, first.items) != (second.rule, second.items):
            raise command.mistake(f"element {tag}: hinges of two rules")
        stiffness = interior.laws[BENDING].k if BENDING in interior.laws else 0.0
        for law in (first, second):
            if not math.isclose(law.k, stiffness, rel_tol=1e-6):
                what = (
                    f"element {tag}: the hinge bends with EI = {law.k:g}, the interior with {stiffness:g}"
                )
                raise command.mistake(
                    what, "a hinge of a length has the stiffness of the member: make both equal"
                )
        scaled = [law.scaled(1.0, length) for law, length in zip((first, second), lengths)]
        if scaled[0].lengths != scaled[1].lengths:
            raise command.mistake(f"element {tag}: hinges that deteriorate, of two lengths")
        words = (
            "FRAME",
            _elastic_words(command, interior),
            shape.words(),
            f"RULE={first.rule}",
            scaled[0].words(),
            f"MI={numbers(first.strength)} MJ={numbers(second.strength)}",
            f"LP={numbers(alike(lengths))}",
        )
        all_notes = [*notes, *interior.notes, *(note for section in hinges for note in section.notes)]
        self._mass(tag, command, shape, joined(words), all_notes)

    # ------------------------------------------------------------------ bars

    def bar(self, tag: int, command: Command) -> None:
        """``truss``, ``corotTruss``: an area and a material."""
        choice = options(command, 5)
        choice.only(("-rho", "-cMass", "-doRayleigh", "-useInitialDisp"))
        area = 1.0
        parts: Sequence[Part] = ()
        if len(choice.plain) == 2:
            area = command.real(5, "the area")
            parts = self.materials.parts(command.whole(6, "the material"), command)
        elif len(choice.plain) == 1:
            section = self.sections.section(command.whole(5, "the section"), command)
            parts = [section.laws[AXIAL]] if AXIAL in section.laws and not section.fibres else []
        if not parts or area <= 0.0:
            what = f"{command.words[1]} {tag}: an area above 0 and a material, or a section"
            raise command.mistake(what, code="L620")
        both = ends(command, self.model)
        length = self._length(command, both)
        rho = choice.real("-rho", 0.0)
        if rho and choice.flags.get("-cMass", ("0",))[:1] != ("0",):
            raise command.mistake(f"{command.words[1]} {tag}: a consistent mass of a bar (-cMass)")
        self.deck.add_mass(both, 0.5 * rho * length)
        self.geometries.setdefault("LARGE" if command.words[1].startswith("corot") else "SMALL", command)
        for part in parts:
            scaled = part.scaled(area, length)
            notes = part.notes
            if scaled is None:
                raise command.mistake(f"{command.words[1]} {tag}: a contact of a bar must be elastic")
            if isinstance(part, SpringPart) and part.rule == "ELASTIC":
                self.deck.element(tag, "T", f"FRAME E={number(part.k)} A={number(area)} I=0", both, notes)
            elif isinstance(scaled, SpringPart):
                strength = numbers(scaled.strength)
                rule = f"RULE={scaled.rule},ELASTIC,ELASTIC"
                head = f"SPRING KX={number(scaled.k)} FX={strength} ANGLE=MEMBER {rule}"
                self.deck.element(tag, "T", joined((head, scaled.words())), both, notes)
            elif isinstance(scaled, ViscousPart):
                words = joined((f"DASHPOT CX={number(scaled.c)} ANGLE=MEMBER", _alpha(scaled)))
                self.deck.element(tag, "D", words, both, notes, damped=False)
            elif isinstance(scaled, GapPart):
                way = both if not scaled.pulls else both[::-1]
                i, j = (self.model.points[end] for end in way)
                angle = math.degrees(math.atan2(j.y - i.y, j.x - i.x)) + (180.0 if scaled.pulls else 0.0)
                words = f"CONTACT GAP={number(scaled.gap)} ANGLE={number(angle)} LAW={scaled.words()}"
                self.deck.element(tag, "C", words, both, notes, damped=False)

    # ------------------------------------------------------------------ axes

    def _length(self, command: Command, both: tuple[int, int]) -> float:
        i, j = (self.model.points[end] for end in both)
        length = math.hypot(j.x - i.x, j.y - i.y)
        if length == 0.0:
            raise command.mistake(
                f"element {command.words[2][:20]} has no length: its nodes are at one place", code="L620"
            )
        return length

    def _shape(self, command: Command, transformation: int) -> Shape:
        """Axis of a member; its kind of geometry is noted."""
        both = ends(command, self.model)
        given = self.model.item("the transformation", self.model.transformations, transformation, command)
        kind = given.word(1, "its type")
        if kind not in GEOMETRIES:
            raise given.mistake(
                f"geomTransf {kind[:40]} has no counterpart", "use Linear, PDelta or Corotational"
            )
        self.geometries.setdefault(GEOMETRIES[kind], command)
        full = self._length(command, both)
        offsets = options(given, 3).reals("-jntOffset")
        if not any(offsets):
            return Shape(full)
        i, j = (self.model.points[end] for end in both)
        axis = (j.x - i.x) / full, (j.y - i.y) / full
        if len(offsets) != 4:
            raise given.mistake("-jntOffset needs four numbers", code="L620")
        blocks = []
        for x, y, sign in ((*offsets[:2], 1.0), (*offsets[2:], -1.0)):
            along = sign * (x * axis[0] + y * axis[1])
            if abs(x * axis[1] - y * axis[0]) > 1e-9 * full or along < 0.0:
                what = f"element {command.words[2]}: -jntOffset points away from the axis of the member"
                raise given.mistake(
                    what, "an offset along the axis is a rigid block; model another one by a stiff member"
                )
            blocks.append(along)
        if sum(blocks) >= full:
            raise given.mistake(f"element {command.words[2]}: its -jntOffset leaves no length", code="L620")
        return Shape(full - sum(blocks), (blocks[0], blocks[1]))


def _slender(section: SectionLaws, *notes: str) -> SectionLaws:
    """Section without shear deformation."""
    laws = {force: law for force, law in section.laws.items() if force != SHEAR}
    return replace(section, laws=laws, notes=(*section.notes, *notes))


def _section(e: float, area: float, inertia: float) -> SectionLaws:
    """Section by E, A and I."""
    return SectionLaws({AXIAL: SpringPart(e * area), BENDING: SpringPart(e * inertia)}, (e, area, inertia))


def _elastic_words(command: Command, section: SectionLaws) -> str:
    """Items of the stiffness of a member; raises a Mistake where there is none."""
    if section.elastic:
        e, area, inertia = section.elastic
    elif AXIAL in section.laws and BENDING in section.laws:
        area = section.area
        e = section.laws[AXIAL].k / area if area != 1.0 else 1.0
        area, inertia = section.laws[AXIAL].k / e, section.laws[BENDING].k / e
    else:
        raise command.mistake(
            f"element {command.words[2][:20]}: its section has no axial or no bending stiffness"
        )
    if e <= 0.0 or area <= 0.0 or inertia < 0.0:
        raise command.mistake(f"element {command.words[2][:20]}: E, A or I is not above 0", code="L620")
    if AXIAL in section.laws and section.laws[AXIAL].rule != "ELASTIC":
        raise command.mistake(f"element {command.words[2][:20]}: a section that yields in its axial force")
    shear = section.laws.get(SHEAR)
    if shear and shear.rule != "ELASTIC":
        raise command.mistake(f"element {command.words[2][:20]}: a section that yields in shear")
    words = f"E={number(e)} A={number(area)} I={number(inertia)}"
    return f"{words} G={number(e)} AS={number(shear.k / e)}" if shear else words


def _alpha(dashpot: ViscousPart) -> str:
    """Item of the exponent of a dashpot."""
    return "" if dashpot.alpha == 1.0 else f"ALPHA={number(dashpot.alpha)}"


def _is_whole(word: str) -> bool:
    return word.lstrip("+-").isdigit()
