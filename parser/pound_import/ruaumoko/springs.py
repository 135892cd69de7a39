"""SPRING: stiffnesses, yield forces and a rule of the components x (from I to J), y and rotation.

``ITYPE IHYST ILOS IDAMG KX KY GJ WGT RF RT``, with a rule ``FX+ FX- FY+ FY- MZ+ MZ-``, with a loss of
strength
``DUCT1 DUCT2 RDUCT DUCT3 RCYC``, then the lines of the rule once for each component.
"""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import number, numbers
from pound_import.ruaumoko import loss, rules
from pound_import.ruaumoko.lines import DataLine
from pound_import.ruaumoko.property_set import PropertySet

NAMES: Final = ("ITYPE", "IHYST", "ILOS", "IDAMG", "KX", "KY", "GJ", "WGT", "RF", "RT")
FORCES: Final = ("FX+", "FX-", "FY+", "FY-", "MZ+", "MZ-")
_STIFF: Final = ("KX", "KY", "KR")
_STRONG: Final = ("FX", "FY", "MR")


def read(props: PropertySet, label: str) -> None:
    """Add the property set.

    Raises
    ------
    Mistake
        A line is missing, an item is no number, or its type or rule cannot be carried over.
    """
    notes = [label] if label else []
    row = props.rows.next("the line of a SPRING: " + " ".join(NAMES))
    kind, code, losing, damaged = (row.item(k).whole(NAMES[k]) for k in range(4))
    stiff = [row.item(k).real(NAMES[k]) for k in (4, 5, 6)]
    weight, rf, rt = (row.item(k).real(NAMES[k]) for k in (7, 8, 9))
    row.need(NAMES, 8)
    if kind != 1:
        what = f"is {kind}, a SPRING whose components act on each other"
        raise row.items[0].mistake("L604", "ITYPE", what, "only ITYPE 1 is carried over")
    if damaged:
        what = f"is {damaged}: the line of the index is not known"
        raise row.items[3].mistake("L604", "IDAMG", what, "write 0")
    if len(row.items) > len(NAMES) and any(i.text != "0" for i in row.items[len(NAMES) :]):
        notes.append(props.draft.lose(row.items[len(NAMES)].span, "items behind RT"))
    if weight:
        notes.append(
            props.draft.lose(row.items[7].span, f"WGT {number(weight)} of a spring", "add WEIGHTS")
        )
    _axes(props, stiff, row, notes)
    items = [f"{name}={number(k)}" for name, k in zip(_STIFF, stiff) if k]
    if code:
        items.append(_yielding(props, code, losing, stiff, (rf, rf, rt), row, notes))
    text = " ".join([f"P{props.number}", "SPRING", *items, "ANGLE=MEMBER" if any(props.lengths) else ""])
    props.draft.add("PROPS", text.rstrip(), row.span, notes)


def _axes(props: PropertySet, stiff: list[float], row: DataLine, notes: list[str]) -> None:
    """Warn of the convention for directions of components, and of the effect of a spring's length."""
    if any(length == 0.0 for length in props.lengths) and stiff[0] != stiff[1]:
        notes.append(props.draft.doubt(row.span, "a spring without length has x along global x"))
        if any(props.lengths):
            text = f"some springs of set {props.number} have a length and some have none"
            raise mistake("L604", text, row.span, "give them two property sets")
    if any(props.lengths) and stiff[1]:
        reading = "a transverse force of a spring with a length makes no moment; ARM= gives it one"
        notes.append(props.draft.doubt(row.items[5].span, reading))


def _yielding(
    props: PropertySet,
    code: int,
    losing: int,
    stiff: list[float],
    ratios: tuple[float, float, float],
    row: DataLine,
    notes: list[str],
) -> str:
    """Text of the items of the components that yield; empty where none does, or all is elastic."""
    rule = rules.known(code, row.items[1], props.catalog)
    strong = props.rows.next("the yield forces: " + " ".join(FORCES))
    forces = strong.reals(FORCES)
    lost = ""
    if losing:
        lost = loss.read(losing, rule, props.rows, row.items[2], props.draft, notes)
    sets = [rules.read(code, props.rows, r, props.draft, notes) for r in ratios]
    yielding = [k for k in range(3) if stiff[k] and (forces[2 * k] or forces[2 * k + 1])]
    for k in range(3):
        if stiff[k] and k not in yielding:
            notes.append(props.draft.doubt(strong.span, f"without yield forces {_STIFF[k]} is elastic"))
    if props.elastic:
        notes.append("elastic run: IPLAS 0")
        return ""
    if not yielding:
        return ""
    if len({sets[k] for k in yielding}) > 1:
        text = "the components that yield have different parameters"
        raise mistake("L604", text, strong.span, "give each component a spring of its own")
    chosen = ",".join(rule.name if k in yielding else "ELASTIC" for k in range(3))
    limits = [f"{_STRONG[k]}={numbers(forces[2 * k : 2 * k + 2])}" for k in yielding]
    return " ".join(x for x in (*limits, f"RULE={chosen}", sets[yielding[0]], lost) if x)
