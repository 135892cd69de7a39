"""FRAME: a member with hinges.  The order of all its items is recalled; no deck with results holds one.

``ITYPE IPIN ICOND IHYST ILOS IDAMG ICOL IGA IDUCT``, ``E G A AS I WGT END1 END2 FJ1 FJ2``, with ICOND the
initial forces, and with a rule ``RA RF H1 H2``, the strengths, the loss of strength, the lines of the rule.
"""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import number, numbers
from pound_import.ruaumoko import loss, rules
from pound_import.ruaumoko.lines import DataLine
from pound_import.ruaumoko.property_set import PropertySet

OPTIONS: Final = ("ITYPE", "IPIN", "ICOND", "IHYST", "ILOS", "IDAMG", "ICOL", "IGA", "IDUCT")
SECTION: Final = ("E", "G", "A", "AS", "I", "WGT", "END1", "END2", "FJ1", "FJ2")
HINGES: Final = ("RA", "RF", "H1", "H2")
BEAM: Final = ("PYT", "PYC", "MZ1+", "MZ1-", "MZ2+", "MZ2-")
COLUMN: Final = ("PYC", "PB", "MB", "M1B", "M2B", "M0", "PYT")
INITIAL: Final = ("N0", "MI0", "MJ0")
_PINS: Final = ("NONE", "I", "J", "BOTH")
_BEAM, _CONCRETE = 1, 2


def read(props: PropertySet, label: str) -> None:
    """Add the property set.

    Raises
    ------
    Mistake
        A line is missing, an item is no number, or its type or rule cannot be carried over.
    """
    notes = [label] if label else []
    options = props.rows.next("the options of a FRAME: " + " ".join(OPTIONS))
    kind, pin, initial, code, losing, damaged, *rest = options.wholes(OPTIONS, 4)
    if kind not in (_BEAM, _CONCRETE):
        what = f"is {kind}, a kind of FRAME that is not carried over"
        hint = "1 one-component beam, 2 concrete beam-column"
        raise options.items[0].mistake("L604", "ITYPE", what, hint)
    if not 0 <= pin < len(_PINS):
        raise options.items[1].mistake("L604", "IPIN", f"is {pin}, which is not known", "0 to 3")
    for k, asked in enumerate((damaged, *rest[:2]), 5):
        if asked:
            what = f"is {asked}: what it adds to the lines is not known"
            raise options.items[k].mistake("L604", OPTIONS[k], what, "write 0")
    section = props.rows.next("the section of a FRAME: " + " ".join(SECTION))
    notes.append(props.draft.doubt(section.span, f"the order of a FRAME's section is {' '.join(SECTION)}"))
    items = _section(section, pin)
    if initial:
        items.append(_initial(props, initial, options, notes))
    word = "FRAME"
    if code and not props.elastic:
        word, more = _hinges(props, (kind, code, losing), section, options, notes)
        items.append(more)
    elif code:
        _hinges(props, (kind, code, losing), section, options, notes)
        notes.append("elastic run: IPLAS 0")
    props.draft.add("PROPS", " ".join([f"P{props.number}", word, *items]), options.span, notes)


def _section(row: DataLine, pin: int) -> list[str]:
    """Items of the cross-section and of the member's ends."""
    v = dict(zip(SECTION, row.reals(SECTION, 5)))
    items = [f"{name}={number(v[name])}" for name in ("E", "A", "I")]
    if v["AS"]:
        items += [f"G={number(v['G'])}", f"AS={number(v['AS'])}"]
    items += [f"{name}={number(v[name])}" for name in ("WGT", "END1", "END2") if v[name]]
    if v["FJ1"] or v["FJ2"]:
        items.append(f"FJ={numbers((v['FJ1'], v['FJ2']))}")
    return [*items, f"PIN={_PINS[pin]}"] if pin else items


def _initial(props: PropertySet, code: int, options: DataLine, notes: list[str]) -> str:
    """Items of the initial forces: the axial force (ICOND 1), the end moments (2), or both (3)."""
    names = {1: INITIAL[:1], 2: INITIAL[1:], 3: INITIAL}.get(code)
    if names is None:
        raise options.items[2].mistake("L604", "ICOND", f"is {code}, which is not known", "0 to 3")
    row = props.rows.next("the initial forces: " + " ".join(names))
    v = dict(zip(names, row.reals(names, len(names))))
    notes.append(
        props.draft.doubt(
            row.span, f"ICOND {code}: initial {' '.join(names)}, tension and sagging positive"
        )
    )
    axial = f"N0={number(v['N0'])}" if "N0" in v else ""
    moments = f"M0={numbers((v['MI0'], v['MJ0']))}" if "MI0" in v else ""
    return " ".join(x for x in (axial, moments) if x)


def _hinges(
    props: PropertySet, codes: tuple[int, int, int], section: DataLine, options: DataLine, notes: list[str]
) -> tuple[str, str]:
    """Kind of element in the new deck, and the items of its hinges."""
    kind, code, losing = codes
    rule = rules.known(code, options.items[3], props.catalog)
    hinges = props.rows.next("the hinges: " + " ".join(HINGES))
    _, ratio, *lengths = hinges.reals(HINGES, 2)
    if 0.0 in lengths:
        notes.append(props.draft.doubt(hinges.span, "a hinge length of 0 is 1.0"))
    lp = numbers(x or 1.0 for x in lengths)
    strengths = props.rows.next("the strengths of a FRAME: " + " ".join(BEAM if kind == _BEAM else COLUMN))
    word, items = (_beam if kind == _BEAM else _column)(props, strengths, notes)
    lost = ""
    if losing:
        lost = loss.read(losing, rule, props.rows, options.items[4], props.draft, notes)
    parameters = rules.read(code, props.rows, ratio, props.draft, notes)
    return word, " ".join(x for x in (items, f"LP={lp}", f"RULE={rule.name}", parameters, lost) if x)


def _beam(props: PropertySet, row: DataLine, notes: list[str]) -> tuple[str, str]:
    """Kind of element and items of the yield moments of a one-component beam."""
    tension, compression, *moments = row.reals(BEAM, 4)
    notes.append(props.draft.doubt(row.span, f"the order of a beam's strengths is {' '.join(BEAM)}"))
    if tension or compression:
        notes.append(props.draft.lose(row.span, "axial yield PYT and PYC", "BEAM_COLUMN has interaction"))
    if not any(moments):
        raise mistake("L604", "a hinge without a yield moment", row.span, f"the line is {' '.join(BEAM)}")
    second = moments[2:] if any(moments[2:]) else moments[:2]
    return "FRAME", f"MI={numbers(moments[:2])} MJ={numbers(second)}"


def _column(props: PropertySet, row: DataLine, notes: list[str]) -> tuple[str, str]:
    """Kind of element and items of the interaction diagram of a concrete column, symmetric in moment."""
    crush, balance, mb, m1b, m2b, m0, tension = row.reals(COLUMN, 7)
    notes.append(props.draft.doubt(row.span, f"the order of a column's strengths is {' '.join(COLUMN)}"))
    axial = (-abs(crush), -abs(balance), -abs(balance) * 2 / 3, -abs(balance) / 3, 0.0, abs(tension))
    corners = [x for pair in zip(axial, (0.0, mb, m1b, m2b, m0, 0.0)) for x in pair]
    return "BEAM_COLUMN", f"NM={numbers(corners)}"
