"""Sections of OpenSees: stiffness and law of each of their forces.

References
----------
OpenSees documentation, commands section Elastic, Uniaxial, Aggregator, Fiber, WFSection2d.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from pound_deck.diagnostics import Mistake
from pound_import.opensees.commands import Command, options
from pound_import.opensees.fibres import Fibres, fibres
from pound_import.opensees.materials import Materials
from pound_import.opensees.model import ScriptModel
from pound_import.opensees.moment_curvature import initial
from pound_import.opensees.parts import SpringPart

AXIAL, BENDING, SHEAR = "P", "Mz", "Vy"  #: forces of a section
FIBRES: Final = ("Fiber", "fiberSec", "WFSection2d")  #: sections of fibres
_ELASTIC_FORMS: Final = (3, 5)


@dataclass(frozen=True, slots=True)
class SectionLaws:
    """A section.

    Attributes
    ----------
    laws : mapping of str to SpringPart
        For each of its forces: stiffness EA, EI or G As, and what yields.
    elastic : tuple of float
        E, A and I, empty where it is not given by them.
    notes : tuple of str
        Comments.
    fibres : Fibres or None
        That it is made of.
    area : float
        Of its fibres; 1 without, so that E A and E I stand in place of A and I [L^2].
    """

    laws: Mapping[str, SpringPart] = field(default_factory=dict)
    elastic: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()
    fibres: Fibres | None = None
    area: float = 1.0

    @property
    def bends(self) -> bool:
        """Whether its bending is elastic."""
        return not self.fibres and (BENDING not in self.laws or self.laws[BENDING].rule == "ELASTIC")


class Sections:
    """Sections of a model, each read once.

    Parameters
    ----------
    model : ScriptModel
    materials : Materials
    """

    def __init__(self, model: ScriptModel, materials: Materials) -> None:
        self._model, self._materials = model, materials
        self._read: dict[int, SectionLaws | None] = {}

    def section(self, tag: int, user: Command) -> SectionLaws:
        """Section by its tag.

        Raises
        ------
        Mistake
            There is none, or it has no counterpart.
        """
        if tag not in self._read:
            command = self._model.item("the section", self._model.sections, tag, user)
            self._read[tag] = None  # one that fails, or holds itself, is reported once
            self._read[tag] = self._translated(command)
        section = self._read[tag]
        if section is None:
            raise Mistake
        return section

    def _translated(self, command: Command) -> SectionLaws:
        name = command.word(1, "the type")
        if name == "Elastic":
            return self._elastic(command)
        if name == "Uniaxial":
            law = self._materials.spring(command.whole(3, "the material"), command, "a section")
            return SectionLaws({command.word(4, "the force"): law}, notes=law.notes)
        if name == "Aggregator":
            return self._aggregated(command)
        if name in FIBRES:
            made = fibres(self._model, command.whole(2, "the tag"), command)
            stiffness = initial(made.fibres)
            laws = {AXIAL: SpringPart(stiffness.axial), BENDING: SpringPart(stiffness.bending)}
            return SectionLaws(laws, fibres=made, area=sum(fibre.area for fibre in made.fibres))
        hint = "give the section its moments and curvatures: Uniaxial, Aggregator or Elastic"
        raise command.no_counterpart(name, ("Elastic", "Uniaxial", "Aggregator", *FIBRES), hint)

    def _elastic(self, command: Command) -> SectionLaws:
        count = len(command.words) - 3
        if count not in _ELASTIC_FORMS:
            raise command.mistake(
                f"section Elastic has {count} numbers, not E A I or E A I G alpha", code="L620"
            )
        e, area, inertia, *shear = (command.real(k, "a number") for k in range(3, len(command.words)))
        laws = {AXIAL: SpringPart(e * area), BENDING: SpringPart(e * inertia)}
        if shear:
            laws[SHEAR] = SpringPart(shear[0] * shear[1] * area)
        return SectionLaws(laws, (e, area, inertia))

    def _aggregated(self, command: Command) -> SectionLaws:
        choice = options(command, 3)
        choice.only(("-section",))
        base = SectionLaws()
        for tag in choice.wholes("-section"):
            base = self.section(tag, command)
        laws, notes = dict(base.laws), list(base.notes)
        for k in range(0, len(choice.plain), 2):
            if k + 1 == len(choice.plain):
                raise command.mistake("Aggregator: a material without its force", code="L620")
            force = choice.plain[k + 1]
            law = self._materials.spring(command.whole(3 + k, "the material"), command, "a section")
            laws[force] = law
            notes += law.notes
        elastic = base.elastic if BENDING not in choice.plain and AXIAL not in choice.plain else ()
        made = base.fibres if BENDING not in choice.plain else None
        return SectionLaws(laws, elastic, tuple(dict.fromkeys(notes)), made)
