"""ELEMENTS: ``N MT I J K L IOUT``; members that are left out have both ends one node further."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake, mistake
from pound_import.draft import Draft
from pound_import.ruaumoko.lines import DataLine, DataLines
from pound_import.ruaumoko.nodes import LegacyNode

NAMES: Final = ("N", "MT", "I", "J", "K", "L", "IOUT")


@dataclass(frozen=True, slots=True)
class LegacyMember:
    """A member: number, property set, end nodes, and its line."""

    id: int
    kind: int
    i: int
    j: int
    row: DataLine


def read(
    rows: DataLines, last: int, kinds: int, nodes: dict[int, LegacyNode], draft: Draft
) -> dict[int, LegacyMember]:
    """Members by number, up to `last`; mistakes in a line are reported, and the line is left out."""
    members: dict[int, LegacyMember] = {}
    before: LegacyMember | None = None
    for row in rows:
        try:
            member = _member(row, last, kinds, before, nodes)
            between = _between(before, member, nodes, draft) if before else []
        except Mistake as error:
            error.keep(draft.report)
            continue
        members |= {m.id: m for m in (*between, member)}
        before = member
        if member.id == last:
            break
    if rows.more:
        text = "lines follow the last member that NMEM counts"
        draft.report.append(Diagnostic("L607", text, rows.peek().span, "correct NMEM, or take them out"))
    if not members or max(members) != last:
        text = f"ELEMENTS end with member {max(members, default=0)}, and NMEM is {last}"
        draft.report.append(Diagnostic("L608", text, rows.here, "add the members, or correct NMEM"))
    return members


def _member(
    row: DataLine, last: int, kinds: int, before: LegacyMember | None, nodes: dict[int, LegacyNode]
) -> LegacyMember:
    id_, kind, i, j = row.wholes(NAMES[:4], 4)
    first = before.id if before else 0
    if not first < id_ <= last or (not first and id_ > 1):
        what = f"is {id_}: member {id_} does not follow {first} on the way to NMEM, {last}"
        raise row.items[0].mistake("L608", "N", what, "members ascend from 1 to NMEM")
    if not 1 <= kind <= kinds:
        what = f"is {kind}, a property set that is not from 1 to NTYPE, {kinds}"
        raise row.items[1].mistake("L608", "MT", what, "correct the number or NTYPE")
    for k, node in ((2, i), (3, j)):
        if node not in nodes:
            what = f"is {node}, which NODES do not hold"
            raise row.items[k].mistake("L608", NAMES[k], what, "correct the number")
    return LegacyMember(id_, kind, i, j, row)


def _between(
    before: LegacyMember, after: LegacyMember, nodes: dict[int, LegacyNode], draft: Draft
) -> list[LegacyMember]:
    """Generate the members between two given ones."""
    members = []
    for id_ in range(before.id + 1, after.id):
        step = id_ - before.id
        i, j = before.i + step, before.j + step
        if i not in nodes or j not in nodes:
            text = f"member {id_} is left out, and nodes {i} and {j} for it are not both there"
            raise mistake("L608", text, after.row.span, "write the members out")
        members.append(LegacyMember(id_, before.kind, i, j, before.row))
    if members:
        what = f"members {before.id + 1} to {after.id - 1} are as {before.id}, each one node further"
        draft.doubt(after.row.span, what)
    return members


def write(members: dict[int, LegacyMember], draft: Draft) -> None:
    """Add the lines of ELEMENTS."""
    for member in members.values():
        made = member.id != member.row.items[0].whole("N")
        notes = [f"generated: line {member.row.span.line} of the old deck"] if made else []
        draft.add("ELEMENTS", f"{member.id:6} P{member.kind} {member.i} {member.j}", member.row.span, notes)
