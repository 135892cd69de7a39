"""Elements of links in the new deck, with their property sets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_deck.schema import Catalog, out_of_limits
from pound_import.draft import Draft, number, quoted
from pound_import.sap2000.numbering import computed
from pound_import.sap2000.tables import SapRow


@dataclass(frozen=True, slots=True)
class LinkDof:
    """A degree of freedom of a link in the plane.

    Attributes
    ----------
    ends : str
        Nodes as the card of an element has them.
    angle : float
        Of its axis from x, anticlockwise; 0 for a rotation [deg].
    arm : str
        Item of the place of a shear spring; empty for none.
    reverse : bool
        Its deformation is that of the element with the other sign.
    """

    link: str
    dof: str
    ends: str
    angle: float
    arm: str
    reverse: bool
    span: Span

    @property
    def turns(self) -> bool:
        """Whether it is a rotation."""
        return self.dof[0] == "R"

    def key(self, name: str) -> str:
        """Key of a value: ``TransK`` or ``RotK``."""
        return ("Rot" if self.turns else "Trans") + name

    def item(self, translation: str, rotation: str) -> str:
        """Item of the deck, by the kind of the degree of freedom."""
        return rotation if self.turns else translation


class ElementWriter:
    """Adds elements with their property sets: equal sets are written once.

    Parameters
    ----------
    last : int
        Largest number of an element so far.
    catalog : Catalog
    draft : Draft
    """

    def __init__(self, last: int, catalog: Catalog, draft: Draft) -> None:
        self.last, self.catalog, self.draft = last, catalog, draft
        self.sets: dict[str, str] = {}

    def element(self, items: str, ends: str, name: str, span: Span, notes: Sequence[str]) -> None:
        """Add an element of the property set with these items."""
        if items not in self.sets:
            self.sets[items] = f"L{len(self.sets) + 1}"
            self.draft.add("PROPS", f"{self.sets[items]} {items}", span, notes)
        self.last += 1
        self.draft.add("ELEMENTS", f"{self.last} {self.sets[items]} {ends} NAME={quoted(name)}", span)

    def lose(self, span: Span, what: str, remedy: str = "add an element of this program") -> None:
        """Say that a part is not carried over."""
        self.draft.add("ELEMENTS", "", span, [self.draft.lose(span, what, remedy)])

    def within(self, rule: str, name: str, value: float, row: SapRow, key: str) -> None:
        """Raise a Mistake where a rule does not take a value."""
        spec = self.catalog.family("hysteresis")[rule].field(name)
        wrong = out_of_limits(value, spec) if spec else ""
        if wrong:
            raise mistake("L643", f"{key} {wrong}", row.place(key), f"{name} of the rule {rule}")

    def spring(self, at: LinkDof, k: float, items: str, notes: Sequence[str]) -> None:
        """Add a spring with a stiffness and more items."""
        text = f"SPRING {at.item('KX', 'KR')}={computed(k)}{_turn(at)}{at.arm}{items}"
        self.element(text, at.ends, f"{at.link} {at.dof}", at.span, notes)

    def dashpot(self, at: LinkDof, c: float, items: str, notes: Sequence[str]) -> None:
        """Add a dashpot with a coefficient and more items."""
        text = f"DASHPOT {at.item('CX', 'CR')}={computed(c)}{_turn(at)}{at.arm}{items}"
        self.element(text, at.ends, f"{at.link} {at.dof} damping", at.span, notes)


def _turn(at: LinkDof) -> str:
    """Item of the angle, where there is one."""
    return f" ANGLE={number(round(at.angle, 9))}" if not at.turns and at.angle else ""
