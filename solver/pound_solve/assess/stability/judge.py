"""The stability matrix: every method on every stiff and extreme scene with every law.

Each case must give the right answer, or state clearly why it does not: a message with its number, place and
cause, or a self-check of the report with the verdict "look".  Everything else is a fault: a wrong answer
with good checks, NaN, an exception, or a run without end.

The right answer is the closed form where there is one; else that of EXACT on a search grid eight times
finer; for curved laws, which EXACT does not support, that of NEWMARK with steps so short that a quarter of
them changes nothing.  Displacements and the forces of springs are compared at all output times, of contacts
the largest force (one that jumps by a dashpot has no value at the instant of touch).  The allowed error of
stepping methods is the fraction that the case states, that of EXACT and TAYLOR is `EXACT_WITHIN`, that of
LAGUERRE `LAGUERRE_WITHIN`.  AUTO is judged by its tolerance: its peaks by `AUTO_WITHIN`, its histories like
those of stepping methods.

Some answers depend on the last digits of the deck: two motions of a chaotic scene diverge, however close
they begin, and a contact that just closes may as well stay open.  Where an error is too large, the
reference is therefore run again with all masses changed by a `NUDGE` of the allowed error.  Whatever
changes by more than the allowed error (a motion from some time on, a largest force) is unknown and not
judged.  A reference by steps does not resolve what `events.within_step` treats as rounding: overlaps of
contacts up to `MOVING_ALIKE` times `EVENT_TOLERANCE` of the displacements, so its masses change by `BLIND`
at least; and laws that turn at less than `REVERSE_RATE` of the largest rate, so forces of springs are
unknown where a body turns.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Final

import numpy as np

from pound_solve.assess.stability.isolated import LIMIT, Findings, Runner
from pound_solve.assess.stability.scenes import cases
from pound_solve.assess.stability.scenes.case import STEP, STOREY, StabilityCase, every
from pound_solve.catalog import catalog
from pound_solve.check import Subject
from pound_solve.integrate.events.within_step import REVERSE_RATE
from pound_solve.integrate.tolerances import EVENT_TOLERANCE, MOVING_ALIKE
from pound_solve.numerics.types import Array, Flags

STEPLESS: Final = ("EXACT", "TAYLOR")  #: methods whose only error is rounding
#: errors allowed, as shares of the largest value
EXACT_WITHIN, LAGUERRE_WITHIN, AUTO_WITHIN = 1e-6, 1e-3, 2e-3
FASTER: Final = 1.5  #: factor on the allowed error of forces, in which fast modes have a larger share
ROUNDING: Final = 1e-9  #: fraction of the force of a storey below which that of a contact counts as none
NUDGE: Final = 1e-6  #: fraction of the allowed error by which masses are changed
#: least change of masses with a reference by steps
BLIND: Final = 10.0 * MOVING_ALIKE * EVENT_TOLERANCE
SETTLED: Final = 1e-3  #: fraction by which a reference by steps may still change when they are quartered
MOST_STEPS: Final = 1e6  #: most steps of such a reference
ALONE: Final = "energy balances; nothing else to compare with"
PARTLY: Final = "compared as far as the answer is known"
FAMILIES: Final = ("linear", "contact", "hysteresis")
RIGHT, FLAGGED, STOPPED, FAULT = "right", "flagged", "stopped", "fault"  #: outcomes of a case


@dataclass(frozen=True)
class JudgedRun:
    """One case solved by one method.

    Attributes
    ----------
    case : StabilityCase
    method : str
    end : str
        `RIGHT`, `FLAGGED`, `STOPPED` or `FAULT`.
    error : float
        The largest of displacements, as a fraction of the largest; NaN where nothing was compared.
    says : str
        The message, or the fault.
    seconds : float
    """

    case: StabilityCase
    method: str
    end: str
    error: float
    says: str
    seconds: float


def methods() -> list[str]:
    """Names of the catalog's methods, those without steps first."""
    return sorted(catalog().family("method"), key=lambda name: (name not in STEPLESS, name != "AUTO", name))


def written(method: str, step: float) -> str:
    """Method as it is written in a deck."""
    return f"{method} DT={step!r}" if catalog().family("method")[method].field("DT") else method


def reference(run: Runner, case: StabilityCase) -> tuple[Findings, str, float] | None:
    """Reference motion of a case, its method, and its possible error as a fraction; None for none.

    EXACT; where that stops or loses energy, NEWMARK with steps that are quartered until the motion changes
    no more.
    """

    def holds(result: Findings) -> bool:
        return not any(check.subject is Subject.ENERGY for check in result.looks)

    deck = case.like[0] or case.deck
    result = run(case, deck, method := "EXACT REFINE=3")
    if not (result.stop or result.wrong) and holds(result):
        return result, method, 0.0
    step, before = min(case.step, STEP) / 16.0, Findings()
    while not len(result.t) or result.t[-1] / step < MOST_STEPS:
        result = run(case, deck, method := f"NEWMARK DT={step!r}")
        if result.stop or result.wrong:
            return None
        if len(before.t) and not result.looks:  # steps that do not resolve a collision may agree by chance
            changes = [shares(result.u, before.u), shares(result.f, before.f)]
            changes += [off for off, _ in promised(result, before, SETTLED).values()]
            if max(x.max(initial=0.0) for x in changes) <= SETTLED:
                return result, method, SETTLED
        step, before = step / 4.0, result
    return None


def shares(x: Array, right: Array) -> Array:
    """Largest error at each time, as a fraction of the largest right value."""
    size, off = np.abs(right).max(initial=0.0), np.abs(x - right)
    off = off.reshape(len(off), math.prod(off.shape[1:]))
    return np.asarray((off / size if size else off).max(axis=1, initial=0.0))


def nudged(deck: str, fraction: float) -> str:
    """Deck whose masses are greater by a fraction, as far as they are given as weights."""
    return re.sub(r"(?m)^GRAVITY (\S+)", lambda g: f"GRAVITY {float(g[1]) / (1.0 + fraction)!r}", deck)


Offs = dict[str, tuple[Array, float]]  #: errors of quantities, and the allowed error of each
PEAKS: Final = "largest "  #: first word of those that are no series in time
SPRINGS: Final = "spring forces"


def judge(run: Runner, case: StabilityCase, method: str) -> JudgedRun:
    """Solve a case by a method and judge the outcome."""
    outcome = run(case, case.deck, written(method, case.step))

    def row(end: str, says: str, error: float = np.nan) -> JudgedRun:
        return JudgedRun(case, method, end, error, says, outcome.seconds)

    if outcome.wrong:
        return row(FAULT, outcome.wrong)
    if outcome.stop:
        return row(STOPPED, outcome.stop)
    says, part = "; ".join(f"{check.name}: {check.value_text}" for check in outcome.looks), ""
    if case.right is not None:
        error = shares(case.compared(outcome.t, outcome.u), case.right(outcome.t))
        offs = {"displacements": (error, allowed(case, method))}
    else:
        right = reference(run, case)
        if right is None and case.like[0]:
            return row(FAULT, "the deck that gives the right answer does not run")
        if right is None or len(right[0].t) != len(outcome.t):
            return row(FLAGGED if says else RIGHT, says or ALONE)
        offs, part = compared(run, case, method, outcome, right)
    largest = float(offs["displacements"][0].max(initial=0.0))
    if wrong := beyond(offs):
        return row(FLAGGED, says, largest) if says else row(FAULT, wrong, largest)
    return row(RIGHT, says or part, largest)


def compared(
    run: Runner, case: StabilityCase, method: str, result: Findings, right: tuple[Findings, str, float]
) -> tuple[Offs, str]:
    """Errors against a reference, restricted to what is `known` of it; and a remark on the restriction."""
    best, by, doubt = right
    within = allowed(case, method) + doubt

    def errors(other: Findings, factor: float) -> Offs:
        u = case.compared(best.t, case.like[1] * best.u)
        by_quantity = {"displacements": (shares(case.compared(other.t, factor * other.u), u), within)}
        if case.compared is every:
            by_quantity |= forces(other, best, within)
        if method == "AUTO" and whole(case):
            by_quantity |= promised(other, best, AUTO_WITHIN + doubt)
        return by_quantity

    offs = errors(result, 1.0)
    if not beyond(offs):
        return offs, ""
    fraction = max(NUDGE * within, BLIND if doubt else 0.0)
    other = run(case, nudged(case.like[0] or case.deck, fraction), by)
    if len(other.t) != len(best.t):
        return offs, ""
    return known(offs, errors(other, case.like[1]), best.t, turns(best) & (doubt > 0.0))


def whole(case: StabilityCase) -> bool:
    """Whether the reference of a case is a run of the same deck, so that all quantities are compared."""
    return case.right is None and not case.like[0] and case.compared is every


def allowed(case: StabilityCase, method: str) -> float:
    """Allowed error of the displacements, as a fraction of the largest."""
    if method in STEPLESS:
        return EXACT_WITHIN + case.inexact
    if method == "LAGUERRE":
        return LAGUERRE_WITHIN + case.inexact
    return AUTO_WITHIN if method == "AUTO" and not whole(case) else case.within


def forces(result: Findings, right: Findings, within: float) -> Offs:
    """Errors of forces, where both runs have the same springs and contacts."""
    offs = {}
    if result.f.shape == right.f.shape:
        offs[SPRINGS] = shares(result.f, right.f), FASTER * within
    if result.blows.shape == right.blows.shape:
        offs[f"{PEAKS}contact forces"] = blows(result, right), FASTER * within
    return offs


def blows(result: Findings, right: Findings) -> Array:
    """Errors of the largest contact forces, relative to at least `ROUNDING` of the force of a storey."""
    storey = STOREY * float(np.abs(right.u).max(initial=0.0))
    size = np.maximum(np.abs(right.blows), ROUNDING * storey)
    return parts(result.blows, right.blows, 0.05, size)


def promised(result: Findings, right: Findings, within: float) -> Offs:
    """Errors of the peaks whose accuracy AUTO promises (see `auto`)."""
    swings = np.abs(right.swings).max(axis=1, keepdims=True, initial=0.0)
    return {
        f"{PEAKS}deformations": (parts(result.swings, right.swings, 1e-6, swings), within),
        f"{PEAKS}contact forces": (blows(result, right), within),
    }


def parts(x: Array, right: Array, floor: float, size: Array | None = None) -> Array:
    """Errors of some values, each divided by its own size, but at least by `floor` times the largest size;
    sizes are those of the right values if left out.
    """
    size = np.abs(right) if size is None else size
    size = np.maximum(size, floor * size.max(initial=0.0))
    return np.asarray(np.abs(x - right) / np.where(size > 0.0, size, 1.0))


def turns(result: Findings) -> Flags:
    """Whether a body is almost at rest at each time, shape (n_times,): steps may miss reversals there."""
    speed = np.abs(result.v)
    return np.asarray((speed < REVERSE_RATE * speed.max(axis=0, initial=0.0)).any(axis=1))


def known(offs: Offs, nudged: Offs, t: Array, unseen: Flags) -> tuple[Offs, str]:
    """Errors that count, and a remark where these are a part only.

    A series counts up to the first time at which the `nudged` deck is off by more than is allowed, a peak
    where that is not, and forces of springs not at times that are `unseen`.
    """
    good = {x: off <= most for x, (off, most) in nudged.items()}
    series = [x for x in good if not x.startswith(PEAKS)]
    n = min([len(t), *(int(np.argmin(good[x])) for x in series if not good[x].all())])
    known = {x: (off[:n] if x in series else off[good[x]], most) for x, (off, most) in offs.items()}
    whole = all(x.all() for x in good.values())
    if SPRINGS in known and unseen.any():
        (off, most), whole = known[SPRINGS], False
        known[SPRINGS] = off[~unseen[: len(off)]], most
    if whole:
        return known, ""
    return known, PARTLY + (f", up to t = {t[n - 1]:g}" if n < len(t) else "")


def beyond(offs: Offs) -> str:
    """Text on the errors beyond the allowed ones; empty without any."""
    bad = [(x, off.max(), most) for x, (off, most) in offs.items() if not (off <= most).all()]
    return ", ".join(f"{x} {off:.2g} off, above {most:g}" for x, off, most in bad)


def matrix(
    families: tuple[str, ...] = FAMILIES,
    chosen: Callable[[StabilityCase], bool] = lambda case: True,
    limit: float = LIMIT,
) -> Iterator[JudgedRun]:
    """Solve all cases by all methods.

    Parameters
    ----------
    families : tuple of str
        Of ``linear``, ``contact`` and ``hysteresis``.
    chosen : callable
        Which cases.
    limit : float
        Seconds that a run may take, in one of as many processes as there are cores; 0: in this process,
        without a limit.
    """
    count = (os.cpu_count() or 1) if limit else 1
    runners: SimpleQueue[Runner] = SimpleQueue()
    for _ in range(count):
        runners.put(Runner(limit))

    def solved(case: StabilityCase) -> list[JudgedRun]:
        run = runners.get()
        run.kept.clear()
        try:
            return [judge(run, case, method) for method in methods()]
        finally:
            runners.put(run)

    try:
        with ThreadPoolExecutor(count) as pool:
            for rows in pool.map(solved, filter(chosen, cases(families))):
                yield from rows
    finally:
        for _ in range(count):
            runners.get().close()


ENDS: Final = (RIGHT, FLAGGED, STOPPED, FAULT)
