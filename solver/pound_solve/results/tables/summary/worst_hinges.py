"""Table ``worst_hinges``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pound_solve.results.columns import ELEMENT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

if TYPE_CHECKING:
    from pound_solve.analyses.spring_response import SpringResponse

MOST = 10  #: rows
#: states by the damage index of Park and Ang
STATES = ((1.0, "failed"), (0.4, "beyond repair"), (0.2, "moderate"), (0.1, "slight"), (0.0, "none"))


def rows(run: RunRecord) -> list[Row] | None:
    """The springs and hinges of the largest damage, or ductility where the deck gives no ultimate one."""
    yielded = [r for r in run.history.springs if r.ductility > 1.0]
    worst = sorted(yielded, key=_rank, reverse=True)[:MOST]
    out = []
    for r in worst:
        index = r.damage.total if r.damage else math.nan
        state = "failed" if r.failed else next((word for least, word in STATES if index >= least), "")
        out.append(
            (
                r.spring.element,
                r.spring.component,
                r.spring.rule,
                r.ductility,
                r.yields,
                r.loss,
                index,
                state,
            )
        )
    return out or None


def _rank(r: SpringResponse) -> tuple[float, float]:
    return (r.damage.total if r.damage else -1.0, r.ductility)


TABLE = Table(
    name="worst_hinges",
    title="Springs and hinges that are worst off",
    place=40,
    stages=(Stage.PEAKS,),
    columns=(
        ELEMENT,
        Column("component", "comp.", doc="as in the spring envelopes"),
        Column("rule", doc="hysteresis rule"),
        Column("ductility", "ductility", "-", "short", doc="largest absolute deformation over yield"),
        Column("yield_events", "yield\nevents", fmt="int", doc="number of times that it began to yield"),
        Column("plastic_work", "plastic\nwork", "F*L", "short", doc="energy lost in hysteresis"),
        Column(
            "damage", "damage\nindex", "-", "short", doc="of Park and Ang; NaN without ultimate ductility"
        ),
        Column("state", doc="state that the index stands for"),
    ),
    rows=rows,
    note="All springs and hinges are in the section on members.",
    sample=(
        (11, "hinge I", "TAKEDA", 11.22, 3, 20.91, 0.853, "beyond repair"),
        (12, "X", "BILINEAR", 2.1, 1, 3.2, math.nan, ""),
    ),
)
