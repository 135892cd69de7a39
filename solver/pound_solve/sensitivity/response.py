"""The derivatives of the response of one run by PARAMs of its deck."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from pound_deck.model import Model
from pound_solve.analyses.recorder import HistoryRecorder
from pound_solve.driver.prepare import DeckError, Prepared
from pound_solve.driver.request import Request
from pound_solve.driver.sequence import Progress
from pound_solve.integrate.condensed import condensed
from pound_solve.integrate.protocol import Outcome, Problem
from pound_solve.integrate.tracker import Peaks
from pound_solve.numerics.types import Array
from pound_solve.results.record import RunRecord
from pound_solve.sensitivity import case
from pound_solve.sensitivity.coefficients import Coefficients, coefficients, derivative
from pound_solve.sensitivity.course import RunCourse
from pound_solve.sensitivity.crest import refined
from pound_solve.sensitivity.dual import Dual, duals
from pound_solve.sensitivity.dual_law import DualLaw
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import InputSlopes
from pound_solve.sensitivity.quantities import PeakFormula, PeakFormulas
from pound_solve.sensitivity.refusal import NoDerivativeError
from pound_solve.sensitivity.samples import ObservedValue, TangentSample, differentiated
from pound_solve.sensitivity.tangent_run import Crossing, TangentRun
from pound_solve.sensitivity.trajectory import Trajectory
from pound_solve.sweep.study.quantities import Fields, Values, taken
from pound_solve.sweep.study.variables import MOTION

GRAZING = 1e-3  #: fraction of the largest speed of a law below which it meets an event in grazing
AT_REST = 1e-9  #: fraction of the largest deformation and rate of a law below which it is at rest
SAME_VALUE = 1e-8  #: largest relative difference of a quantity from that of the run


@dataclass(frozen=True)
class Derivatives:
    """The response of a run, and its derivatives.

    Attributes
    ----------
    names : tuple of str
        PARAMs.
    values : dict
        Of the run, by quantity and label, as a sweep keeps them.
    slopes : dict of dict of ndarray, shape (n_params,)
        Derivatives of the values, by quantity and label; a quantity that has none here is absent.
    flags : tuple of str
        Warnings: events near which the derivatives hold in a small neighbourhood only, and quantities
        without a derivative.
    sequence : tuple of (int, int)
        Law and event function of all events in order.  Runs with the same sequence lie on one smooth branch
        of the response.
    """

    names: tuple[str, ...]
    values: Values
    slopes: Mapping[str, Mapping[str, Array]]
    flags: tuple[str, ...]
    sequence: tuple[tuple[int, int], ...]


def derivatives(request: Request, names: Sequence[str], progress: Progress | None = None) -> Derivatives:
    """Return the exact derivatives of the response of a run by PARAMs.

    The run is integrated by EXACT; a deck with METHOD=AUTO too.

    Parameters
    ----------
    request : Request
        The deck, its PARAMs and its motion.
    names : sequence of str
        PARAMs that are numbers, or `MOTION`; without any, only the run and its events are returned.
    progress : callable or None
        Of the run, see `sequence.Progress`; it may raise an exception to end the run.

    Raises
    ------
    NoDerivativeError
        The run, or a PARAM, has no exact derivative here.
    DeckError, OSError
        See `driver.prepare`.
    """
    ready = case.ready_for(request)
    given = {name.casefold(): value for name, value in ready.model.params.items()}
    values = [_number(name, given, request) for name in names]
    record, rows, middle, trajectory = _run(ready, request, progress)
    course, known = RunCourse(trajectory.course), taken(rows)
    if not names:
        return Derivatives((), known, {}, (), course.sequence)
    base, places = coefficients(middle)
    at = partial(_case_at, request, given)
    each = [derivative(partial(at, name), x, name, middle, base) for name, x in zip(names, values)]
    slopes = Coefficients(*(np.stack(x) for x in zip(*each)))
    equations, excitation = TangentEquations(base, slopes), trajectory.system.excitation
    formulas, flags = list[PeakFormula](), list[str]()
    no_slopes = InputSlopes(excitation, slopes.excitation[:0])
    for f in PeakFormulas(record.history, base, slopes, places).all():
        peaks = tuple(filter(None, (refined(course, equations, no_slopes, r) for r in f.readings)))
        if len(peaks) == len(f.readings):
            formulas.append(f._replace(readings=peaks))
        else:
            flags.append(f"{f.quantity} {f.label} has no derivative: its peak is the limit at a jump")
    inputs = InputSlopes(excitation, slopes.excitation)
    run = TangentRun(equations, inputs, _laws(middle, base, slopes), trajectory.largest)
    samples = run.follow(course, [r.t for f in formulas for r in f.readings if not r.is_total])
    results = _results(formulas, samples, run, known)
    flags += [
        f"{f.quantity} {f.label} has no derivative: its value there is not that of the run"
        for f in formulas
        if f.label not in results.get(f.quantity, {})
    ]
    flags += _grazing(run.crossings, trajectory, ready.model)
    flags += _missed(record.history.returned.peaks, trajectory, ready.model)
    return Derivatives(tuple(names), known, results, tuple(flags), course.sequence)


def _results(
    formulas: Sequence[PeakFormula],
    samples: Mapping[float, Sequence[TangentSample]],
    run: TangentRun,
    known: Values,
) -> dict[str, dict[str, Array]]:
    """Return the derivatives of all quantities whose values are those `known` of the run.

    Another one is a row with the label of a larger row, or its peak lies where several events meet.
    """
    results: dict[str, dict[str, Array]] = {}
    for f in formulas:
        y, expected = _evaluated(f, samples, run), known.get(f.quantity, {}).get(f.label, math.nan)
        is_end = any(not r.is_peak for r in f.readings)  # which may be zero but for rounding
        if is_end or abs(y.value - expected) <= SAME_VALUE * abs(expected):
            results.setdefault(f.quantity, {})[f.label] = np.zeros(run.equations.n_params) + y.slopes
    return results


def _run(
    ready: Prepared, request: Request, progress: Progress | None
) -> tuple[RunRecord, dict[str, list[Fields]], case.Case, Trajectory]:
    """Return the record of the run, the rows of its tables, its start and its course."""
    runs: list[tuple[Problem[HistoryRecorder], Trajectory]] = []

    def follow(problem: Problem[HistoryRecorder]) -> Outcome:
        trajectory = Trajectory(condensed(problem, "EXACT"))
        runs.append((problem, trajectory))
        with np.errstate(over="ignore", invalid="ignore"):
            return trajectory.run()

    record, rows, message = case.run(ready, request, follow, progress)
    if message:
        raise NoDerivativeError(f"the run does not reach its end: {message}")
    ((problem, trajectory),) = runs
    if trajectory.released:
        raise NoDerivativeError("massless joints jump where a law loses its force: give the joints mass")
    return record, rows, case.Case(problem, problem.recorder.items, case.periods_of(record)), trajectory


def _number(name: str, given: Mapping[str, float | str], request: Request) -> float:
    """Return the value of a PARAM, or 1 of the factor on the motion of the request."""
    value = given.get(name.casefold())
    if value is None and name == MOTION and request.motion is not None:
        return 1.0
    if value is None:
        raise NoDerivativeError(f"the deck has no PARAM {name}")
    if isinstance(value, str):
        raise NoDerivativeError(f"PARAM {name} is a text, {value!r}, and has no derivative")
    return float(value)


def _moved(request: Request, name: str, value: float, given: Mapping[str, float | str]) -> Request:
    """Return the request of another value of a PARAM, or of a factor on its motion."""
    motion = request.motion
    if name.casefold() not in given and motion is not None:
        scaled = {**motion.values, "SCALE": motion.values["SCALE"] * value}
        return replace(request, motion=replace(motion, values=scaled))
    params = {key: x for key, x in request.params.items() if key.casefold() != name.casefold()}
    return replace(request, params={**params, name: repr(value)})


def _case_at(request: Request, given: Mapping[str, float | str], name: str, value: float) -> case.Case:
    """Return the history of a deck with another value of a PARAM."""
    try:
        return case.case_of(_moved(request, name, value, given))
    except DeckError as err:
        raise NoDerivativeError(
            f"{name} = {value!r}, next to the value of the deck, is refused:\n{err}"
        ) from None


def _laws(middle: case.Case, base: Coefficients, slopes: Coefficients) -> list[DualLaw]:
    """Return the laws at the start with their derivatives."""
    laws, problem = [], middle.problem
    for i, (spring, state) in enumerate(zip(problem.system.structure.laws, problem.start.states)):
        p = duals(spring.law.p, slopes.parameters[:, i])
        m = duals(state[3], slopes.variables[:, i])
        beta, secant = (Dual(getattr(base, x)[i], getattr(slopes, x)[:, i]) for x in ("beta", "secant"))
        laws.append(DualLaw(spring, p, beta, secant, state[0], m))
    return laws


def _evaluated(f: PeakFormula, samples: Mapping[float, Sequence[TangentSample]], run: TangentRun) -> Dual:
    """Return a quantity with its derivatives."""

    def value(reading: ObservedValue) -> Dual:
        if reading.is_total:
            return Dual(reading.value, run.impulse[:, reading.item])
        each = [differentiated(run.equations, reading.kind, reading.item, x) for x in samples[reading.t]]
        return min(each, key=lambda y: abs(abs(y.value) - abs(reading.value)))

    return f.value(*map(value, f.readings))


def _missed(outcome: Peaks, trajectory: Trajectory, model: Model) -> Iterator[str]:
    """Yield a text for every contact that has only just stayed open."""
    closed = {collision.law for collision in outcome.collisions}
    for law in trajectory.contacts:
        spring, d = trajectory.laws[law], outcome.deformation[law]
        left = spring.gap - d.high
        if law not in closed and left <= GRAZING * (d.high - d.low):
            yield (
                f"contact of element {spring.element} has a near miss at t = {d.t_high:.9g} "
                f"{model.units.time}: {left:.1e} {model.units.length} of its gap are left, so the "
                "derivatives hold in a small neighbourhood only"
            )


def _grazing(crossings: Sequence[Crossing], trajectory: Trajectory, model: Model) -> Iterator[str]:
    """Yield a text for every event that is only just met."""
    laws, (largest, fastest) = trajectory.laws, trajectory.largest
    sharpest = np.zeros(len(laws))
    for x in crossings:
        sharpest[x.law] = max(sharpest[x.law], abs(x.second))
    for x in crossings:
        if abs(x.d) <= AT_REST * largest[x.law] and abs(x.rate) <= AT_REST * fastest[x.law]:
            continue  # nothing moves yet
        scale = abs(x.on_d) * fastest[x.law] + abs(x.on_v) * sharpest[x.law]
        share = abs(x.speed) / scale if scale else 0.0
        if share < GRAZING:
            spring = laws[x.law]
            yield (
                f"{spring.component} of element {spring.element} has a grazing event at t = {x.t:.9g} "
                f"{model.units.time}: it is met at {share:.1e} of the largest speed, so the derivatives "
                "hold in a small neighbourhood only"
            )
