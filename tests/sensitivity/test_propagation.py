"""The derivative of the matrix exponential, against that of a block-triangular matrix."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from pound_solve.integrate.closed_form.decomposition import make_propagator
from pound_solve.integrate.propagators.base import gauss
from pound_solve.integrate.propagators.series import SeriesPropagator
from pound_solve.numerics.types import Array
from pound_solve.sensitivity.propagation import marched

CHAIN = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
FREE = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
SYSTEMS = {
    "damped": (np.diag([1.0, 2.0, 3.0]), 0.3 * CHAIN, 400.0 * CHAIN),
    "undamped": (np.diag([1.0, 2.0, 3.0]), np.zeros((3, 3)), 400.0 * CHAIN),
    "free body": (np.diag([1.0, 2.0, 3.0]), np.zeros((3, 3)), 400.0 * FREE),
    "equal": (np.eye(3), 0.2 * np.eye(3), 100.0 * np.eye(3)),
    "critical": (np.eye(3), 20.0 * np.eye(3), 100.0 * np.eye(3)),
    "apart": (np.eye(3), np.zeros((3, 3)), np.diag([1e-4, 1.0, 1e6])),
}


def first_order(m: Array, c: Array, k: Array) -> Array:
    """State matrix of u and v."""
    inverse, n = np.linalg.inv(m), len(m)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ k, -inverse @ c]])


@pytest.mark.parametrize("name", SYSTEMS)
def test_derivative_of_free_motion_is_that_of_the_exponential(name: str) -> None:
    m, c, k = SYSTEMS[name]
    rng = np.random.default_rng(1)
    dm, dc, dk = np.diag(rng.uniform(size=3)), rng.normal(size=(3, 3)), 50.0 * rng.normal(size=(3, 3))
    dc, dk = dc + dc.T, dk + dk.T
    u, v, tau = rng.normal(size=3), rng.normal(size=3), 0.2
    a = first_order(m, c, k)
    inverse = np.linalg.inv(m)
    da = np.zeros((6, 6))
    da[3:, :3], da[3:, 3:] = -inverse @ dk, -inverse @ dc
    da[3:] -= inverse @ dm @ a[3:]
    whole = expm(tau * np.block([[a, da], [np.zeros((6, 6)), a]]))
    expected = whole[:6, 6:] @ np.concatenate([u, v])

    propagator = make_propagator(m, c, k, np.zeros((3, 1)))
    assert isinstance(propagator, SeriesPropagator) == (name == "critical")
    weights, points = gauss(tau, propagator.spectral_radius)
    motion = np.array([expm(t * a) @ np.concatenate([u, v]) for t in points])
    load = -(motion @ a.T)[:, 3:] @ dm - motion[:, 3:] @ dc - motion[:, :3] @ dk
    start = np.zeros((1, len(propagator.state_of(u, v))), propagator.u_q.dtype)
    q, area = marched(propagator, start, load[None, None], weights, tau - points, tau)
    slopes = np.concatenate([(q @ propagator.u_q.T).real[0], (q @ propagator.v_q.T).real[0]])
    assert slopes == pytest.approx(expected, rel=1e-11, abs=1e-12 * np.abs(expected).max())
    augmented = np.zeros((13, 13))
    augmented[:6, :6], augmented[:6, 6:12], augmented[6:12, 6:12] = a, da, a
    augmented[12, :3] = [1.0, 2.0, -1.0]  # integral of a row of the displacements
    over_time = expm(tau * augmented)[12, 6:12] @ np.concatenate([u, v])
    integral = float((area @ propagator.u_q.T).real[0] @ [1.0, 2.0, -1.0])
    assert integral == pytest.approx(over_time, rel=1e-10, abs=1e-13)
