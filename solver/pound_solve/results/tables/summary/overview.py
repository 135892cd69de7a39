"""Table ``overview``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pound_solve.results.columns import ITEM, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table
from pound_solve.results.words import contact_name

if TYPE_CHECKING:
    from pound_solve.integrate.protocol import Outcome
    from pound_solve.loading.motions.base import Motion


def rows(run: RunRecord) -> Iterator[Row]:
    """What was run, and the largest values of the response."""
    model = run.model
    size = f"{len(model.nodes)} nodes, {len(model.elements)} elements, {run.structure.n_free} unknowns"
    yield "structure", size
    yield "analyses", ", ".join(card.spec.name for card in model.analyses)
    for motion in run.motions:
        yield "ground motion", ground_motion(run, motion)
    if run.responded:
        yield from response(run)


def ground_motion(run: RunRecord, motion: Motion) -> str:
    """Name and peak of a motion."""
    info, units = motion.info, run.model.units
    name = " ".join(str(info[k]) for k in ("name", "component") if info.get(k)) or str(info.get("kind"))
    if motion.direction == "R":
        return f"{name}: peak {info['pga']:.4g} rad/{units.time}^2"
    share = info["pga"] / run.model.gravity
    return f"{name}: peak {info['pga']:.4g} {units.text('L/T^2')}, {share:.3g} of gravity"


def response(run: RunRecord) -> Iterator[Row]:
    """The largest values of a history."""
    history, units = run.history, run.model.units
    figures = history.returned.figures
    yield "method", str(figures.get("method", ""))
    yield "error of the method", error_of(history.returned)
    yield "end of the history", f"{history.recorder.reached:.6g} {units.time}"
    drifts = [(ratio, name) for name, ratio in history.drift_ratios() if not math.isnan(ratio)]
    if drifts:
        ratio, name = max(drifts)
        yield "largest drift ratio", f"{100.0 * ratio:.3g} %, {name}"
    if history.items.contacts:
        yield "collisions", _collisions(run)
    ductile = [(r.ductility, r.spring) for r in history.springs if not math.isnan(r.ductility)]
    if ductile:
        most, spring = max(ductile, key=lambda pair: pair[0])
        yielded = sum(mu > 1.0 for mu, _ in ductile)
        yield "springs and hinges beyond yield", f"{yielded} of {len(ductile)}"
        yield "largest ductility", f"{most:.3g}, element {spring.element} {spring.component}"
    indices = [(r.damage.total, r.spring) for r in history.springs if r.damage is not None]
    if indices:
        index, spring = max(indices, key=lambda pair: pair[0])
        yield "largest damage index", f"{index:.3g}, element {spring.element} {spring.component}"


def error_of(outcome: Outcome) -> str:
    """What is known about the error of a method in time."""
    if outcome.exact:
        return "rounding only: it makes no error from one instant to the next"
    told = [found for found in outcome.checks if found[0].startswith("estimated error")]
    if told:
        check, value, verdict = next((found for found in told if found[2] != "met"), told[0])
        return f"{value}, {check}" + ("" if verdict == "met" else ", not shown")
    return "not estimated: METHOD=AUTO does, and a second run with half the step shows it"


def _collisions(run: RunRecord) -> str:
    found = run.history.returned.peaks.collisions
    hard = [c for c in found if c.peak == c.peak]
    if not hard:
        return str(len(found))
    worst = max(hard, key=lambda c: c.peak)
    name = contact_name(run.model, run.structure.laws[worst.law].element)
    units = run.model.units
    when = f"{worst.t_peak:.6g} {units.time}"
    return f"{len(found)}, largest force {worst.peak:.5g} {units.force} at {when}, contact {name}"


TABLE = Table(
    name="overview",
    title="Overview",
    place=10,
    stages=(Stage.INPUT, Stage.PEAKS),
    columns=(ITEM, VALUE),
    rows=rows,
    sample=(
        ("structure", "18 nodes, 22 elements, 36 unknowns"),
        ("analyses", "STATIC, HISTORY"),
        ("largest drift ratio", "1.13 %, B2 storey 1"),
    ),
)
