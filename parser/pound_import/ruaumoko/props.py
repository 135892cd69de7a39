"""PROPS: ``N TYPE [label]``, then the lines of the type; each type has a file."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake, mistake
from pound_deck.schema import Catalog
from pound_import.draft import Draft
from pound_import.ruaumoko import frames, springs
from pound_import.ruaumoko.elements import LegacyMember
from pound_import.ruaumoko.lines import DataLine, DataLines
from pound_import.ruaumoko.nodes import LegacyNode
from pound_import.ruaumoko.property_set import PropertySet

READERS: Final = {"SPRING": springs.read, "FRAME": frames.read}
#: types of the old program by name; their lines are not known
OTHERS: Final = (
    *("BEAM", "WALL", "DAMPER", "DASHPOT", "TENDON", "CONTACT", "MULTISPRING", "MASONRY", "MACRO"),
    *("QUADRILATERAL", "FOUNDATION", "COMPOUND", "INTERACTION"),
)


def read(
    rows: DataLines,
    count: int,
    members: dict[int, LegacyMember],
    nodes: dict[int, LegacyNode],
    elastic: bool,
    catalog: Catalog,
    draft: Draft,
) -> None:
    """Add the property sets; mistakes in one are reported, and its lines are left out."""
    for expected in range(1, count + 1):
        try:
            head = rows.next(f"property set {expected}")
            kind = _kind(head, expected)
        except Mistake as error:
            error.keep(draft.report)
            return
        note = " ".join(item.text for item in head.items[2:])[:60].strip("\"'")
        of_kind = [m for m in members.values() if m.kind == expected]
        places = [(nodes[m.i], nodes[m.j]) for m in of_kind]
        try:
            READERS[kind](PropertySet(expected, rows, places, elastic, catalog, draft), note)
        except Mistake as error:
            error.keep(draft.report)
            _skip(rows)
    if rows.more:
        text = "lines follow the last property set that NTYPE counts"
        draft.report.append(Diagnostic("L607", text, rows.peek().span, "correct NTYPE, or take them out"))


def _kind(head: DataLine, expected: int) -> str:
    """Type of the property set on its first line; raise Mistake where it cannot be read."""
    if head.item(0).whole("the number of a property set") != expected or len(head.items) < 2:
        text = f"a line `{expected} TYPE` should begin property set {expected}"
        raise mistake(
            "L608", text, head.span, "sets stand in ascending order; one may have a line too many"
        )
    word = head.items[1].text.strip("\"'").upper()
    if word in OTHERS:
        what = f"is {word}, and no source states its lines"
        raise head.items[1].mistake("L604", "TYPE", what, "write the property set in the new language")
    if word not in READERS:
        what = f"is {head.items[1].text[:40]}, no type of member"
        raise head.items[1].mistake("L604", "TYPE", what, "SPRING or FRAME")
    return word


def _skip(rows: DataLines) -> None:
    """Skip lines up to one that begins a property set: a number and a word."""
    while rows.more and not _begins(rows.peek()):
        rows.next("a line")


def _begins(row: DataLine) -> bool:
    return len(row.items) > 1 and row.items[0].numeric and not row.items[1].numeric
