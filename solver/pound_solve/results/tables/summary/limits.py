"""Table ``limits``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import UNIT, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

DRIFT = "storey drift"
ROTATION = "plastic rotation"


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each drift that a line of LIMITS allows, then one for each rotation."""
    for card in run.model.limits:
        if card["DRIFT"] is not None:
            yield card.label, DRIFT, "%", 100.0 * card["DRIFT"], *_drift(run, card["DRIFT"])
    for card in run.model.limits:
        if card["ROTATION"] is not None:
            yield card.label, ROTATION, "rad", card["ROTATION"], *_rotation(run, card["ROTATION"])


def _drift(run: RunRecord, allowed: float) -> Row:
    """Largest drift ratio [%], over the allowed one, number of storeys beyond that, place and time."""
    drifts = [(d.ratio, f"{d.building} storey {d.storey}", d.t) for d in run.history.storey_drifts()]
    if not drifts:  # without storeys, those of the section DRIFT
        named = run.history.drift_ratios()
        drifts = [(ratio, name, math.nan) for name, ratio in named if not math.isnan(ratio)]
    ratio, place, t = max(drifts, default=(math.nan, "", math.nan))
    beyond = sum(ratio > allowed for ratio, _, _ in drifts)
    return 100.0 * ratio, ratio / allowed, beyond, place, t


def _rotation(run: RunRecord, allowed: float) -> Row:
    """The same of the largest plastic rotation of a hinge, whose time is not known."""
    from pound_solve.structure.locations import member_end  # not needed to read a report

    hinges = [r for r in run.history.springs if not math.isnan(r.rotation)]
    if not hinges:
        return math.nan, math.nan, 0, "", math.nan
    worst = max(hinges, key=lambda r: r.rotation)
    beyond = sum(r.rotation > allowed for r in hinges)
    element, component = worst.spring.element, worst.spring.component
    place = member_end(run.model, run.history.items.buildings, element, component.split()[1])
    name = f"{element} {component}"
    return worst.rotation, worst.rotation / allowed, beyond, f"{name}, {place}" if place else name, math.nan


TABLE = Table(
    name="limits",
    title="Response and its limits",
    place=25,
    stages=(Stage.PEAKS,),
    columns=(
        Column("limit", doc="name of the performance level"),
        Column("quantity", doc="storey drift, or plastic rotation of a hinge"),
        UNIT,
        Column("allowed", fmt="short", doc="as in the deck"),
        Column("largest", fmt="short", doc="largest absolute value of the history; NaN without any"),
        Column("ratio", "over\nallowed", "-", "short", doc="largest value over the allowed one"),
        Column("beyond", fmt="int", doc="number of storeys or hinges beyond the limit"),
        Column("place", doc="storey, or element and hinge and where it is, of the largest value"),
        time_column("t", "at time", "time of the largest drift; NaN for rotations"),
    ),
    rows=rows,
    group="quantity",
    note=(
        "As in the section LIMITS of the deck. Beyond: the number of storeys or hinges that exceed what is "
        "allowed. Plastic rotations are those of FRAME members; a BEAM_COLUMN has none here."
    ),
)
