"""Sections of fibres as laws of moment and curvature, under the axial force of the static state."""

from __future__ import annotations

from pound_import.draft import Draft
from pound_import.opensees.commands import Command
from pound_import.opensees.moment_curvature import TwoLines, initial, two_lines
from pound_import.opensees.parts import Items, SpringPart
from pound_import.opensees.sections import BENDING, SectionLaws


def reduced(
    section: SectionLaws,
    tag: int,
    command: Command,
    axial: float,
    draft: Draft,
    interior: float | None = None,
) -> SectionLaws:
    """Section with two lines in place of its fibres.

    Parameters
    ----------
    section : SectionLaws
    tag : int
        Of the element.
    command : Command
    axial : float
        Axial force, tension positive [F].
    draft : Draft
    interior : float, optional
        EI of the member, which the first line takes; without it that of the section [F*L^2].

    Raises
    ------
    Mistake
        The section cannot carry the axial force, or it does not bend.
    """
    assert section.fibres
    sides: list[TwoLines] = []
    for sign in (1.0, -1.0):
        side = two_lines(section.fibres.fibres, axial, sign)
        if side is None:
            what = f"element {tag}: its section of fibres has no moment under the axial force {axial:.4g}"
            raise command.mistake(what, "check the section's units and the loads")
        sides.append(side)
    k = interior or 0.5 * (sides[0].stiffness + sides[1].stiffness)
    hardening = 0.5 * sum(max(side.ratio, 0.0) * side.stiffness for side in sides) / k
    rule, items = _rule(section.fibres.cracks, min(hardening, 0.99))
    gross = initial(section.fibres.fibres).bending
    note = draft.doubt(
        command.span,
        f"element {tag} yields as its section of fibres does under {axial:.4g} of axial force, {rule}: "
        f"EI = {k / gross:.3f} of the section without cracks",
    )
    law = SpringPart(k, (sides[0].strength, -sides[1].strength), rule, items)
    laws = {**section.laws, BENDING: law}
    return SectionLaws(laws, notes=(*section.notes, note), area=section.area)


def _rule(cracks: bool, hardening: float) -> tuple[str, Items]:
    """Rule of the hinge: of concrete that of Takeda, else bilinear."""
    if cracks:
        return "TAKEDA", (("R", (hardening,)), ("ALFA", (0.4,)))
    if hardening == 0.0:
        return "ELASTO_PLASTIC", ()
    return "BILINEAR", (("R", (hardening,)),)
