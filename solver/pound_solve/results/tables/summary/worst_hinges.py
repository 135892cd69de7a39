"""Table ``worst_hinges``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from pound_solve.results.columns import ELEMENT, RULE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

if TYPE_CHECKING:
    from pound_solve.analyses.spring_response import SpringResponse

MAX_ROWS = 10  #: rows
#: states by the damage index of Park and Ang
STATES = ((1.0, "failed"), (0.4, "beyond repair"), (0.2, "moderate"), (0.1, "slight"), (0.0, "none"))
BEYOND = "look: beyond ordinary rotations"


def rows(run: RunRecord) -> list[Row] | None:
    """Rows of the springs and members of the largest damage, or of the largest ductility where the deck
    gives no ultimate one; of a member, that of its worse end.
    """
    from pound_solve.structure.locations import member_end  # not needed to read a report

    members: dict[tuple[int, str], list[SpringResponse]] = {}
    for r in run.history.springs:
        kind = "hinge" if _end(r) else r.spring.component
        members.setdefault((r.spring.element, kind), []).append(r)
    worst = [max(ends, key=_rank) for ends in members.values()]
    other = {
        id(w): [r.ductility for r in ends if _end(r) != _end(w)] for w, ends in zip(worst, members.values())
    }
    yielded = sorted((r for r in worst if r.ductility > 1.0), key=_rank, reverse=True)
    buildings = run.history.items.buildings
    places = [member_end(run.model, buildings, r.spring.element, _end(r)) for r in yielded[:MAX_ROWS]]
    limits = sorted((c["ROTATION"], c.label) for c in run.model.limits if c["ROTATION"] is not None)
    return [
        _row(r, max(other[id(r)], default=math.nan), place, limits) for r, place in zip(yielded, places)
    ] or None


def _row(r: SpringResponse, other: float, place: str, limits: Sequence[tuple[float, str]]) -> Row:
    s, index = r.spring, r.damage.total if r.damage else math.nan
    values = s.element, s.component, place, s.rule, r.ductility, other, r.rotation, r.yields, r.loss
    return *values, index, _state(r, index, limits)


def _state(r: SpringResponse, index: float, limits: Sequence[tuple[float, str]]) -> str:
    if r.failed or index >= STATES[0][0]:
        return "failed"
    passed = [name for allowed, name in limits if r.rotation > allowed]
    if passed:
        return f"beyond {passed[-1]}"
    if not limits and r.beyond_ordinary:
        return BEYOND
    return next((word for least, word in STATES if index >= least), "")


def _end(r: SpringResponse) -> str:
    """End of the member at which a hinge is, I or J; empty for what is not a hinge."""
    kind, _, rest = r.spring.component.partition(" ")
    return rest[:1] if kind == "hinge" else ""


def _rank(r: SpringResponse) -> tuple[float, float]:
    """Sort key of the largest damage, then ductility; what has none is smallest."""
    return (r.damage.total if r.damage else -1.0, r.ductility if r.ductility == r.ductility else -1.0)


TABLE = Table(
    name="worst_hinges",
    title="Springs and hinges that are worst off",
    place=40,
    stages=(Stage.PEAKS,),
    columns=(
        ELEMENT,
        Column("component", "comp.", doc="as in the spring envelopes"),
        Column("location", "place", doc="building, column of a storey or beam of a floor, and its end"),
        RULE,
        Column("ductility", "ductility", "-", "short", doc="largest absolute deformation over yield"),
        Column(
            "ductility_other",
            "at the\nother end",
            "-",
            "short",
            doc="ductility at the other end of the member",
        ),
        Column(
            "rotation", "plastic\nrotation", "rad", "short", doc="largest rotation of a hinge beyond yield"
        ),
        Column("yield_events", "yield\nevents", fmt="count", doc="as in the spring envelopes"),
        Column("plastic_work", "plastic\nwork", "F*L", "short", doc="energy lost in hysteresis"),
        Column(
            "damage", "damage\nindex", "-", "short", doc="of Park and Ang; NaN without ultimate ductility"
        ),
        Column(
            "state",
            doc="the largest limit of LIMITS that its rotation exceeds, else the state that the "
            "index stands for, or what to look at",
        ),
    ),
    rows=rows,
    note="Of a member the end that is worse off. All springs and hinges are in the section on members.",
)
