"""Table ``pushover``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pound_solve.results.columns import ITEM, PUSH, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table

if TYPE_CHECKING:
    from pound_deck.model import Units
    from pound_solve.analyses.pushover import PushoverResult


def rows(run: RunRecord) -> Iterator[Row]:
    """Rows on the load pattern and control, the end of the analysis, and the capacity."""
    for pushed in run.pushovers:
        for item, value in _items(pushed, run.model.units):
            yield pushed.number, item, value


def _items(pushed: PushoverResult, units: Units) -> Iterator[tuple[str, str]]:
    """Names and values of one pushover."""
    card, length, force = pushed.card, units.text("L"), units.text("F")
    top, end = max(pushed.curve, key=lambda p: abs(p.shear)), pushed.curve[-1]
    adaptive = ", adaptive" if card["ADAPTIVE"] == "YES" else ""
    if card["BUILDING"]:
        neighbours = "beside its neighbours" if card["NEIGHBOURS"] == "YES" else "without its neighbours"
        yield "building", f"{card['BUILDING']}, {neighbours}"
    yield "pattern", f"{card['PATTERN']}{adaptive}, along {card['DIRECTION']}"
    yield "control", f"{card['CONTROL'].lower()}, node {card['NODE']}"
    yield "end", pushed.end
    at_end = f"{end.displacement:.5g} {length}, {end.shear:.5g} {force}"
    yield "displacement and base shear at the end", at_end
    yield "largest base shear", f"{top.shear:.5g} {force} at {top.displacement:.5g} {length}"
    yield "changes of springs, hinges and contacts", str(end.changes)


TABLE = Table(
    name="pushover",
    title="Pushovers",
    place=10,
    stages=(Stage.PUSHOVER,),
    columns=(PUSH, ITEM, VALUE),
    rows=rows,
    group="push",
)
