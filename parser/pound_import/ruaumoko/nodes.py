"""NODES: ``N X Y NF1 NF2 NF3 KUP1 KUP2 KUP3 IOUT``, and DRIFT, a list of nodes from the base up.

NF is 0 free, 1 fixed, 2 slaved to the node KUP.  Omitted nodes are evenly spaced between those given.
KUP has no effect with NF 0 or 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake
from pound_deck.model import Span
from pound_import.draft import Draft, number
from pound_import.ruaumoko.lines import DataLine, DataLines

NAMES: Final = ("N", "X", "Y", "NF1", "NF2", "NF3", "KUP1", "KUP2", "KUP3", "IOUT")
_LETTERS: Final = "XYR"
_FREE, _FIXED, _SLAVED = 0, 1, 2


@dataclass(frozen=True, slots=True)
class LegacyNode:
    """A node: number, coordinates [L], codes and masters of its directions, and its line."""

    id: int
    x: float
    y: float
    codes: tuple[int, ...]
    masters: tuple[int, ...]
    row: DataLine


def read(rows: DataLines, last: int, draft: Draft) -> dict[int, LegacyNode]:
    """Nodes by number, up to `last`; those that are generated lie between their neighbours.

    Mistakes in a line are reported, and the line is left out.
    """
    nodes: dict[int, LegacyNode] = {}
    before: LegacyNode | None = None
    for row in rows:
        if row.word and not nodes:  # names of the columns
            continue
        try:
            node = _node(row, last, before)
        except Mistake as error:
            error.keep(draft.report)
            continue
        if before is not None and node.id > before.id + 1:
            nodes |= {n.id: n for n in _between(before, node, draft)}
        nodes[node.id], before = node, node
        if node.id == last:
            break
    _rest(rows, draft)
    if not nodes or max(nodes) != last:
        text = f"NODES end with node {max(nodes, default=0)}, and NNP is {last}"
        draft.report.append(Diagnostic("L608", text, rows.here, "add the nodes, or correct NNP"))
    return nodes


def _rest(rows: DataLines, draft: Draft) -> None:
    """Report lines behind that of the last node."""
    if rows.more:
        text = "lines follow the last node that NNP counts"
        draft.report.append(Diagnostic("L607", text, rows.peek().span, "correct NNP, or take them out"))


def _node(row: DataLine, last: int, before: LegacyNode | None) -> LegacyNode:
    id_, *codes = (row.item(k).whole(NAMES[k]) for k in (0, *range(3, 9)))
    row.need(NAMES, 3)
    x, y = row.item(1).real("X"), row.item(2).real("Y")
    first = 0 if before is None else before.id
    if not first < id_ <= last or (not first and id_ > 1):
        what = f"is {id_}: node {id_} does not follow {first} on the way to NNP, {last}"
        raise row.items[0].mistake("L608", "N", what, "nodes ascend from 1 to NNP")
    for k, code in enumerate(codes[:3]):
        if code not in (_FREE, _FIXED, _SLAVED):
            hint = "0 free, 1 fixed, 2 slaved to KUP"
            raise row.item(3 + k).mistake("L604", NAMES[3 + k], f"is {code}", hint)
        if code == _SLAVED and not 0 < codes[3 + k] <= last:
            what = f"is {codes[3 + k]}, no node, and {NAMES[3 + k]} is 2"
            raise row.item(6 + k).mistake("L608", NAMES[6 + k], what, "KUP is the node that it follows")
    return LegacyNode(id_, x, y, tuple(codes[:3]), tuple(codes[3:6]), row)


def _between(before: LegacyNode, after: LegacyNode, draft: Draft) -> list[LegacyNode]:
    """Generate the nodes that lie evenly between two given ones."""
    count = after.id - before.id
    what = f"nodes {before.id + 1} to {after.id - 1} lie evenly between {before.id} and {after.id}"
    if before.codes != after.codes or before.masters != after.masters:
        text = f"{what}, and these have different supports"
        error = Diagnostic("L604", text, after.row.span, "write the nodes between them out")
        draft.report.append(error)
    draft.doubt(after.row.span, f"{what}, with their supports")
    nodes = []
    for k in range(1, count):
        fraction = k / count
        x = before.x + fraction * (after.x - before.x)
        y = before.y + fraction * (after.y - before.y)
        nodes.append(LegacyNode(before.id + k, x, y, after.codes, after.masters, after.row))
    return nodes


def write(nodes: dict[int, LegacyNode], draft: Draft) -> None:
    """Add the lines of NODES."""
    for node in nodes.values():
        items, notes = _slaved(node, nodes, draft)
        fixed = "".join(c for c, code in zip(_LETTERS, node.codes) if code == _FIXED)
        text = f"{node.id:6} {number(node.x):>12} {number(node.y):>12}"
        text += (f"  FIX={fixed}" if fixed else "") + items
        if node.id != node.row.items[0].whole("N"):
            notes.append(f"generated, between those given: line {node.row.span.line} of the old deck")
        draft.add("NODES", text, node.row.span, notes)


def _slaved(node: LegacyNode, nodes: dict[int, LegacyNode], draft: Draft) -> tuple[str, list[str]]:
    """Items of a node that is slaved to another, and comments; both empty for others."""
    ways = [k for k in range(3) if node.codes[k] == _SLAVED]
    if not ways:
        return "", []
    place = node.row.item(3 + ways[0]).span
    masters = [node.masters[k] for k in ways]
    letters = "".join(_LETTERS[k] for k in ways)
    notes = []
    if letters == "X" and masters[0] in nodes and nodes[masters[0]].y == node.y:
        draft.rest("NF 2: slaved to the node KUP")
    else:
        for master in dict.fromkeys(masters):
            along = "".join(letter for letter, m in zip(letters, masters) if m == master)
            reading = f"node {node.id} follows {master} along {along} with a rigid arm"
            notes.append(draft.doubt(place, reading))
    named = masters if len(set(masters)) > 1 else masters[:1]
    return f"  SLAVED={letters} MASTER={','.join(map(str, named))}", notes


def drifts(rows: DataLines, levels: int, place: Span, nodes: dict[int, LegacyNode], draft: Draft) -> None:
    """Add the lines of DRIFT: each storey between neighbours in the list, which holds as many nodes as
    NLEVEL says, at its `place` among the control lines.
    """
    listed: list[tuple[int, DataLine]] = []
    count = 0  # wrong items included: NLEVEL need not change where these are corrected
    for row in rows:
        for item in row.items:
            count += 1
            try:
                id_ = item.whole("a node of DRIFT")
                if id_ not in nodes:
                    what = f"is {id_}, which NODES do not hold"
                    raise item.mistake("L608", "a node of DRIFT", what, "correct the number")
            except Mistake as error:
                error.keep(draft.report)
                continue
            listed.append((id_, row))
    if count != levels:
        text = f"DRIFT lists {count} node{'s' * (count != 1)}, and NLEVEL is {levels}"
        hint = f"NLEVEL stands in line {place.line}, column {place.column}: write {count} there"
        if levels > 1:
            hint += f", or list {levels} nodes"
        draft.report.append(Diagnostic("L608", text, rows.here, hint))
    draft.rest("DRIFT: levels from the base up")
    for k, ((low, _), (high, row)) in enumerate(pairwise(listed), 1):
        draft.add("DRIFT", f'"level {k}" {low} {high}', row.span)
