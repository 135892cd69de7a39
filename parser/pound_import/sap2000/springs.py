"""Properties of links by degree of freedom: linear, damper, gap, Wen, isolator; `curves` has the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import number
from pound_import.sap2000 import curves
from pound_import.sap2000.link_elements import ElementWriter, LinkDof
from pound_import.sap2000.tables import SapRow


def component(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    """Add the elements of a degree of freedom whose property has these rows.

    Raises
    ------
    Mistake
        A row lacks a value, or holds a wrong one.
    """
    row = rows[0]
    if row.yes("Fixed"):
        writer.lose(
            at.span, f"{at.dof} of link {at.link[:40]}, which is fixed", "add SLAVED or a stiff SPRING"
        )
        return
    table = row.table.partition("DEFINITIONS ")[2]
    if table.startswith("02") or not row.yes("NonLinear"):
        _linear(writer, at, rows)
    else:
        READERS[table](writer, at, rows)


def _linear(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    """Linear stiffness and damping."""
    k, c = (_positive(rows[0], at.key(name)) for name in ("KE", "CE"))
    if k:
        writer.spring(at, k, "", [])
    if c:
        writer.dashpot(at, c, "", [])


def _damper(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    row = rows[0]
    k, c, exponent = _positive(row, at.key("K")), _positive(row, at.key("C")), row.real("CExp", 1.0)
    if exponent <= 0.0:
        raise mistake("L643", "CExp is not above zero", row.place("CExp"), "the exponent of the rate")
    if not c:
        return
    notes = []
    if k:
        reading = f"the spring {number(k)} in series with the damper of {at.link[:40]} is rigid"
        notes.append(writer.draft.doubt(row.span, reading))
    writer.dashpot(at, c, f" ALPHA={number(exponent)}" if exponent != 1.0 else "", notes)


def _gap(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    row = rows[0]
    k, opening = _positive(row, at.key("K")), row.real(at.key("Open"), 0.0)
    if at.turns:
        writer.lose(at.span, f"{at.dof} of link {at.link[:40]}: a gap of a rotation")
        return
    if not k:
        raise mistake("L643", f"{at.key('K')} of a gap is zero", row.place(at.key("K")), "above zero")
    notes, angle = [], at.angle
    if not row.has(at.key("Open")):
        notes.append(writer.draft.doubt(row.span, f"the gap {at.link[:40]} is closed: no {at.key('Open')}"))
    if " " not in at.ends:  # the ground is the first joint, but the wall of a contact is the second
        angle += 180.0
        notes.append(writer.draft.doubt(row.span, f"the gap {at.link[:40]} closes towards its ground"))
    text = f"CONTACT GAP={number(opening)} ANGLE={number(round(angle, 9))} LAW=LINEAR K={number(k)}"
    writer.element(text, at.ends, at.link, at.span, notes)


def _wen(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    row = rows[0]
    k, strength, ratio = (
        _positive(row, at.key("K")),
        _positive(row, at.key("Yield")),
        row.real("Ratio", 0.0),
    )
    exponent = row.real("YieldExp", 2.0)
    writer.within("BOUC_WEN", "R", ratio, row, "Ratio")
    writer.within("BOUC_WEN", "N", exponent, row, "YieldExp")
    if not k:
        return
    items = (
        f" {at.item('FX', 'MR')}={number(strength)} RULE=BOUC_WEN R={number(ratio)} N={number(exponent)}"
    )
    writer.spring(at, k, items if strength else "", [])


def _positive(row: SapRow, key: str) -> float:
    """Value that is not below zero.

    Raises
    ------
    Mistake
        It is.
    """
    value = row.real(key, 0.0)
    if value < 0.0:
        raise mistake("L643", f"{key} is {number(value)}, below zero", row.place(key), "zero or above")
    return value


#: by the end of the names of their tables; what they do with a degree of freedom that is not linear
READERS: Final[Mapping[str, Callable[[ElementWriter, LinkDof, Sequence[SapRow]], None]]] = {
    "02 - LINEAR": _linear,
    "03 - MULTILINEAR": curves.elastic,
    "04 - DAMPER": _damper,
    "05 - GAP": _gap,
    "07 - RUBBER ISOLATOR": _wen,
    "10 - PLASTIC (WEN)": _wen,
    "11 - MULTILINEAR PLASTIC": curves.plastic,
}
