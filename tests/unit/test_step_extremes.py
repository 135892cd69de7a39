"""Extremes of rows over the steps of TAYLOR and LAGUERRE, beside dense samples of the same steps."""

import numpy as np
import pytest

from pound_solve.integrate.protocol import MotionRows, RowPeaks
from pound_solve.integrate.series.course import StepCourse
from pound_solve.integrate.series.state import EnvelopeBuffers
from pound_solve.loading.excitation import Excitation
from pound_solve.numerics.types import Array

SIZE, LAWS, STEPS, INPUTS = 3, 2, 12, 2
SHARES = np.linspace(0.0, 1.0, 2001)


def steps(degree: int, rng: np.random.Generator) -> StepCourse:
    """Steps with random series whose powers fall, of unknowns in another order than that of elimination."""
    length = rng.uniform(0.01, 0.1, STEPS)
    coefs = rng.normal(size=(STEPS, SIZE + LAWS, degree + 1)) / 1.5 ** np.arange(degree + 1)
    used = rng.integers(3, degree + 1, STEPS)
    coefs[np.arange(degree + 1) > used[:, None, None] + np.zeros((1, SIZE + LAWS, 1), int)] = 0.0
    nothing = np.zeros((1, 0, 0))
    shown = EnvelopeBuffers(
        is_needed=True,
        unknowns=np.arange(SIZE),
        laws=np.arange(LAWS),
        kept=np.array([STEPS, 0]),
        coefs=coefs,
        degree=used,
        begin=np.append(0.0, np.cumsum(length)[:-1]),
        length=length,
        x=nothing,
        equilibrium=nothing,
        constant_forces=np.zeros((1, LAWS)),
        start=np.zeros(1),
    )
    breaks = np.array([0.0, 0.2, 0.3, 5.0])
    return StepCourse(shown, np.array([2, 0, 1]), Excitation(breaks, rng.normal(size=(3, 3, INPUTS))))


@pytest.mark.parametrize("degree", [6, 32])
@pytest.mark.parametrize("seed", range(4))
def test_extremes_are_those_of_dense_samples(degree: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    own = steps(degree, rng)
    course = own.course()
    assert course.within is not None
    assert course.extremes is not None
    # on u, v, a and the forces; of the fifth row on inputs alone
    on_motion = rng.normal(size=(5, 3 * SIZE + LAWS))
    on_motion[:, SIZE : 2 * SIZE] *= 1e-2
    on_motion[:, 2 * SIZE : 3 * SIZE] *= 1e-4
    on_motion[rng.random(on_motion.shape) < 0.4] = 0.0
    on_motion[4] = 0.0
    number, column = np.nonzero(on_motion)
    on_inputs = rng.normal(size=(5, 3 * INPUTS + 1))
    on_inputs[:2] = 0.0
    peaks = RowPeaks(MotionRows(number, column, on_motion[number, column]), on_inputs, *_nothing_known(5))
    course.extremes(peaks)

    motion = course.within(np.arange(len(course.motion.t)), SHARES)
    cells = len(course.motion.t) // STEPS
    # the inputs of the piece at the start of the step, up to its end
    pieces = np.repeat(own.excitation.pieces_after(own.envelope.begin[:STEPS]), cells * len(SHARES))
    since = motion.t - own.excitation.breaks[pieces]
    c = own.excitation.coefs[pieces]
    s = [_derivative(c, since, order) for order in range(3)]
    given = np.concatenate([*s, np.ones((1, len(motion.t)))])
    values = on_motion @ np.concatenate(motion[1:]) + on_inputs @ given
    span = np.ptp(values, axis=1)
    np.testing.assert_allclose(peaks.high, values.max(axis=1), rtol=0.0, atol=1e-4 * span.max())
    np.testing.assert_allclose(peaks.low, values.min(axis=1), rtol=0.0, atol=1e-4 * span.max())
    assert np.all(peaks.high >= values.max(axis=1) - 1e-12 * span)
    assert np.all(peaks.low <= values.min(axis=1) + 1e-12 * span)
    for at, top in ((peaks.t_high, values.max(axis=1)), (peaks.t_low, values.min(axis=1))):
        near = [np.abs(x[np.abs(motion.t - t) < 1e-4] - y).min() for x, t, y in zip(values, at, top)]
        assert np.all(np.array(near) < 1e-3 * span)


def test_a_force_between_supports_has_extremes() -> None:
    own = steps(6, np.random.default_rng(0))
    held = own.envelope._replace(unknowns=np.zeros(0, int), coefs=own.envelope.coefs[:, SIZE:].copy())
    course = StepCourse(held, np.zeros(0, int), own.excitation).course()
    assert course.within is not None
    assert course.extremes is not None
    rows = MotionRows(np.zeros(1, int), np.ones(1, int), np.ones(1))
    peaks = RowPeaks(rows, np.zeros((1, 3 * INPUTS + 1)), *_nothing_known(1))
    course.extremes(peaks)
    force = course.within(np.arange(len(course.motion.t)), SHARES).law_forces[1]
    np.testing.assert_allclose(peaks.high, force.max(), rtol=1e-5)
    np.testing.assert_allclose(peaks.low, force.min(), rtol=1e-5)


def test_what_is_known_stays_where_no_step_exceeds_it() -> None:
    own = steps(6, np.random.default_rng(0))
    course = own.course()
    assert course.extremes is not None
    rows = MotionRows(np.zeros(1, int), np.zeros(1, int), np.ones(1))
    peaks = RowPeaks(rows, np.zeros((1, 3 * INPUTS + 1)), *(np.array([x]) for x in (1e3, 7.0, -1e3, 8.0)))
    course.extremes(peaks)
    assert [x.item() for x in peaks[2:]] == [1e3, 7.0, -1e3, 8.0]


def _nothing_known(count: int) -> list[Array]:
    return [np.full(count, -np.inf), np.zeros(count), np.full(count, np.inf), np.zeros(count)]


def _derivative(c: Array, t: Array, order: int) -> Array:
    """Derivative of some quadratic pieces, shape (n_inputs, n_times)."""
    one, two, three = c[:, 0].T, c[:, 1].T, c[:, 2].T
    return (one + two * t + three * t**2, two + 2.0 * three * t, 2.0 * three + 0.0 * t)[order]
