"""WEIGHTS ``N WX WY MZ``, LOADS ``N FX FY MZ`` and SHAPE ``N SX SY SM``: lists by node."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake
from pound_import.draft import Draft, number
from pound_import.ruaumoko.lines import DataItem, DataLine, DataLines
from pound_import.ruaumoko.nodes import LegacyNode

WEIGHTS: Final = ("N", "WX", "WY", "MZ")
LOADS: Final = ("N", "FX", "FY", "MZ")


def _lines(
    rows: DataLines, names: tuple[str, ...], nodes: dict[int, LegacyNode], draft: Draft
) -> list[tuple[DataLine, int, list[float]]]:
    """Row, node and values of each line of a list; a line with a mistake is reported and left out."""
    lines: list[tuple[DataLine, int, list[float]]] = []
    for row in rows:
        try:
            id_, values = row.item(0).whole("N"), row.reals(names, 2)[1:]
            if id_ not in nodes:
                what = f"is {id_}, which NODES do not hold"
                raise row.items[0].mistake("L608", "N", what, "correct the number")
        except Mistake as error:
            error.keep(draft.report)
            continue
        lines.append((row, id_, values))
    return lines


def weights(
    rows: DataLines, option: DataItem | None, gravity: float, nodes: dict[int, LegacyNode], draft: Draft
) -> None:
    """Add the weights; option 1 of the section's head says that they are masses."""
    scale, notes = 1.0, []
    if option is not None and option.whole("the option of WEIGHTS"):
        scale = gravity
        notes.append(draft.doubt(option.span, "WEIGHTS 1: the values are masses"))
    done: dict[int, list[float]] = {}
    for row, id_, values in _lines(rows, WEIGHTS, nodes, draft):
        if id_ in done and (any(values) or any(done[id_])):
            draft.report.append(
                Diagnostic(
                    "L604", f"node {id_} has two weights", row.span, "write their sum, or one of them"
                )
            )
        done[id_] = values
        if any(values):
            text = f"{id_:6} {' '.join(number(scale * x) for x in values)}"
            draft.add("WEIGHTS", text, row.span, notes)
            notes = []


def loads(rows: DataLines, nodes: dict[int, LegacyNode], draft: Draft) -> bool:
    """Add the loads; return whether there are any."""
    some = False
    for row, id_, values in _lines(rows, LOADS, nodes, draft):
        if any(values):
            some = True
            draft.add("LOADS", f"{id_:6} {' '.join(map(number, values))}", row.span)
    return some


def shape(
    rows: DataLines, nodes: dict[int, LegacyNode], draft: Draft
) -> list[tuple[DataLine, int, list[float]]]:
    """Row, node and values of each line of SHAPE: factors on the force history at the node."""
    return [line for line in _lines(rows, ("N", "SX", "SY", "SM"), nodes, draft) if any(line[2])]
