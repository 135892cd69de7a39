"""Table ``overview``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.check import Subject, looked
from pound_solve.results.columns import ITEM, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table
from pound_solve.results.words import contact_name, damped_part

if TYPE_CHECKING:
    from pound_solve.integrate.protocol import Outcome
    from pound_solve.loading.motions.base import GroundMotion

FEW = 2  #: most kinds of damping or of contacts listed one by one


def rows(run: RunRecord) -> Iterator[Row]:
    """Rows on the model and its analyses, and on the largest values of the response."""
    model = run.model
    yield "deck", Path(next(iter(model.files), "")).name
    size = f"{len(model.nodes)} nodes, {len(model.elements)} elements, {run.structure.n_free} unknowns"
    yield "structure", size
    yield "analyses", ", ".join(card.spec.name for card in model.analyses)
    for motion in run.motions:
        yield "ground motion", ground_motion(run, motion)
    if run.warnings:
        yield "warnings about the input", f"{len(run.warnings)}, see there"
    yield "damping", damping(run)
    if any(s.role.collides for s in run.structure.laws):
        yield "contact law", contact_law(run)
    yield from pushovers(run)
    if run.responded:
        yield from response(run)


def pushovers(run: RunRecord) -> Iterator[Row]:
    """Capacity and performance point of every pushover."""
    units = run.model.units
    for pushed in run.pushovers:
        top, legs = max(pushed.curve, key=lambda p: abs(p.shear)), pushed.curve[-1].leg
        text = f"largest base shear {top.shear:.5g} {units.force} at {top.displacement:.4g} {units.length}"
        text += f", in {legs} legs" * (legs > 1)
        for name, point in run.performance[pushed.number]:
            reached = f"N2 {point.displacement:.4g} {units.length}" if point else "no N2 point"
            text += f"; {reached} under {name}"
        yield f"pushover {pushed.number}", text


def damping(run: RunRecord) -> str:
    """Text on the damping other than that of contacts and dampers."""
    cards = [(card.spec.name, damped_part(card), text) for card, text in run.structure.damping_texts]
    texts = [f"{kind}{'' if part == 'all' else ' of ' + part}: {text}" for kind, part, text in cards]
    return _few(texts, "cards") if texts else "none but that of contacts and dampers"


def contact_law(run: RunRecord) -> str:
    """Text on the laws of the contacts with their stiffness, restitution and gap."""
    kinds, units = dict[str, None](), run.model.units
    for s in run.structure.laws:
        if s.role.collides:
            k, e = s.facts["k"], s.facts["e_given"]
            stiff = math.isfinite(k) and k > 0.0  # a rigid contact has none that is finite
            stiffness = f", {k:.5g} {units.text(s.facts['k_unit'])}" if stiff else ""
            restitution = "" if math.isnan(e) else f", restitution {e:.3g}"
            kinds[f"{s.rule}{stiffness}{restitution}, gap {s.gap:.4g} {units.length}"] = None
    return _few(list(kinds), "kinds")


def _few(texts: list[str], what: str) -> str:
    return "; ".join(texts) if len(texts) <= FEW else f"{len(texts)} {what}, see the input"


def ground_motion(run: RunRecord, motion: GroundMotion) -> str:
    """Text on a motion: its name and peak."""
    info, units = motion.info, run.model.units
    if motion.direction == "R":
        return f"{motion.name}: peak {info['pga']:.4g} rad/{units.time}^2"
    share = info["pga"] / run.model.gravity
    misfit = ""
    if "misfit" in info:
        misfit = f"; its spectrum misses the given one by {100 * info['misfit']:.2g} % at most"
    peak = f"peak {info['pga']:.4g} {units.text('L/T^2')}, {share:.3g} of gravity"
    return f"{motion.name}: {peak}{_within(run, motion)}{misfit}"


def _within(run: RunRecord, motion: GroundMotion) -> str:
    """Words on the peak of a motion within the history, if that ends before the peak of the whole."""
    end = max((card["T"] for card in run.model.analyses if card.spec.name == "HISTORY"), default=math.inf)
    a = motion.acceleration
    if not a.start < end < motion.info["t_pga"]:
        return ""
    peak, unit = abs(a.slice(a.start, end).peak()[1]), run.model.units
    return f" (within the {end:.6g} {unit.time} of the history {peak:.4g} {unit.text('L/T^2')})"


def response(run: RunRecord) -> Iterator[Row]:
    """The largest values of a history."""
    history, units = run.history, run.model.units
    figures = history.returned.figures
    yield "method", str(figures.get("method", ""))
    yield "error of the method", error_of(history.returned)
    yield "end of the history", f"{history.recorder.reached:.6g} {units.time}"
    if storeys := history.storey_drifts():
        worst = max(storeys, key=lambda d: d.ratio)
        where = f"{worst.building} storey {worst.storey}"
        yield "largest storey drift ratio", f"{100.0 * worst.ratio:.3g} %, {where}"
    elif drifts := [drift for drift in history.drift_ratios() if not math.isnan(drift[1])]:
        name, ratio = max(drifts, key=lambda drift: drift[1])
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
    """Text on what is known about the error of a method in time."""
    if outcome.one_of_several:
        return "not known: the motion is one of several, see the checks"
    if outcome.exact:
        for check in outcome.checks:
            if check.subject is Subject.MAGNIFICATION:
                return f"rounding only; {check.name}: {check.value:.1e}"
        return "rounding only: it makes no error from one instant to the next"
    estimates = [check for check in outcome.checks if check.subject is Subject.ERROR]
    if estimates:
        worst = next(iter(looked(estimates)), estimates[0])
        return f"{worst.value:.1e}, {worst.name}, TOL {worst.allowed:g}" + ", not shown" * worst.looks
    return "not estimated: METHOD=AUTO does, and a second run with half the step, or TOL, shows it"


def _collisions(run: RunRecord) -> str:
    """Number of collisions and their largest force; an impact of a rigid contact has an impulse instead."""
    collisions, units = run.history.returned.peaks.collisions, run.model.units
    lasting = [c for c in collisions if c.peak == c.peak]
    count = str(len(collisions))
    if impacts := len(collisions) - len(lasting):
        count += f", {impacts} of them instantaneous impacts without a force"
    if not lasting:
        return count
    worst = max(lasting, key=lambda c: c.peak)
    spring = run.structure.laws[worst.law]
    force = "largest force while closed" if spring.law.rigid else "largest force"
    when, name = f"{worst.t_peak:.6g} {units.time}", contact_name(run.model, spring.element)
    return f"{count}, {force} {worst.peak:.5g} {units.force} at {when}, contact {name}"


TABLE = Table(
    name="overview",
    title="Overview",
    place=10,
    stages=(Stage.INPUT, Stage.MODAL, Stage.PUSHOVER, Stage.PEAKS),
    columns=(ITEM, VALUE),
    rows=rows,
)
