"""Work integrals: losses and input by dense quadrature, closed forms and the balance of energy."""

from __future__ import annotations

import numpy as np
import pytest

from pound_solve.integrate.closed_form.decomposition import make_propagator
from pound_solve.integrate.closed_form.work_integrals import Work, WorkIntegrals
from pound_solve.integrate.propagators.modal import ModalPropagator
from pound_solve.integrate.propagators.series import SeriesPropagator
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array
from tiers import at_night
from unit.test_propagators import KINDS, loads, massless, subsystem

pytestmark = pytest.mark.full

X, W = np.polynomial.legendre.leggauss(24)
DASHPOT = 0.7  #: of the contact between the first and the last mass


def contact_row(n: int) -> Array:
    return np.eye(n)[0] - np.eye(n)[-1]


def measure(
    work_integrals: WorkIntegrals,
    q: Array,
    g: Array,
    tau: float,
    coefs: Array,
    constant: Array,
    p: Array | None = None,
) -> Work:
    """Work over one interval."""
    ps = None if p is None else p[None]
    out = work_integrals.over_intervals(q[:, None], g[None], np.array([tau]), coefs[None], constant, ps)
    return Work(
        float(out.damping[0]), float(out.input[0]), [(law, float(loss[0])) for law, loss in out.laws]
    )


class Case:
    """A subsystem with a pressed contact, its loads and start, measured and integrated densely."""

    def __init__(
        self, m: Array, c: Array, k: Array, degree: int, seed: int = 0, dashpot: float = DASHPOT
    ) -> None:
        n = len(m)
        self.m, self.c, self.k, self.row, self.dashpot = m, c, k, contact_row(n), dashpot
        self.inputs, self.coefs, self.constant, self.p, self.u, self.v = loads(n, degree, seed)
        whole = c + dashpot * np.outer(self.row, self.row)
        self.propagator = make_propagator(m, whole, k, self.inputs)
        contacts = [(5, dashpot, self.row)] if dashpot else []
        self.work_integrals = WorkIntegrals(self.propagator, c, self.inputs, contacts)
        self.q, self.g = (
            self.propagator.state_of(self.u, self.v),
            self.propagator.forcing(self.coefs, self.constant),
        )

    def measure(self, tau: float) -> Work:
        return measure(self.work_integrals, self.q, self.g, tau, self.coefs, self.constant, self.p)

    def velocity(self, t: Array) -> Array:
        v = (self.propagator.v_q @ self.propagator.trajectory(self.q, self.g, t)).real
        if self.propagator.u_p is not None:
            p, slope = (
                np.array([polynomial.value(self.p, float(x), order) for x in t]).T for order in (0, 1)
            )
            v = v + self.propagator.v_p @ p + self.propagator.u_p @ slope
        return np.asarray(v)

    def dense(self, tau: float) -> tuple[float, float, float]:
        """Structure's loss, input and contact's loss by quadrature, 24 points on every 1/fastest."""
        cells = int(np.ceil(tau * self.propagator.spectral_radius)) + 1
        width = tau / cells
        t = (width * (np.arange(cells)[:, None] + 0.5 + 0.5 * X)).ravel()
        w = np.tile(0.5 * width * W, cells)
        v = self.velocity(t)
        force = sum(self.p[k][:, None] * t**k for k in range(len(self.p)))
        loss = float(np.einsum("it,ij,jt,t->", v, self.c, v, w))
        return loss, float(((v * force).sum(axis=0)) @ w), float(self.dashpot * (self.row @ v) ** 2 @ w)

    def energy(self, t: float) -> float:
        q = self.propagator.at(self.q, self.g, t)
        u, v = (self.propagator.u_q @ q).real, (self.propagator.v_q @ q).real
        return float(0.5 * v @ self.m @ v + 0.5 * u @ self.k @ u)


@pytest.mark.parametrize("tau", [1.3, 1e-3, 1e-7])
@pytest.mark.parametrize("degree", [0, 1, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_against_dense_quadrature(kind: str, degree: int, tau: float) -> None:
    # measured against long double exponentials: loss 4e-12, input 4e-14, contact 5e-12 at worst
    for seed in range(3):
        case = Case(*subsystem(kind, seed=seed), degree, seed)
        loss, done, contact = case.dense(tau)
        found = case.measure(tau)
        assert found.damping == pytest.approx(loss, rel=5e-11, abs=0.0)
        assert found.input == pytest.approx(done, rel=1e-11)
        assert [law for law, _ in found.laws] == [5]
        assert found.laws[0][1] == pytest.approx(contact, rel=5e-11)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tau", [8.0, 0.1, 1e-5])
def test_balance_of_energy(kind: str, tau: float) -> None:
    """Input = change of energy + losses: the work integrals use no balance, so this is a check."""
    for degree in (0, 1, 4):
        case = Case(*subsystem(kind), degree)
        found = case.measure(tau)
        change = case.energy(tau) - case.energy(0.0)
        gross = max(abs(found.input), found.damping, case.energy(tau), case.energy(0.0))
        assert abs(found.input - change - found.damping - found.laws[0][1]) < 1e-12 * gross


def test_undamped_modes_among_damped_ones() -> None:
    """Two oscillators that share a subsystem on paper only: just the damped one loses energy."""
    m, k, c = np.eye(2), np.diag([9.0, 4.0]), np.diag([0.0, 0.4])
    case = Case(m, c, k, 1, dashpot=0.0)
    alone = Case(m, 0.0 * c, k, 1, dashpot=0.0)
    assert alone.measure(2.0).damping == 0.0
    loss = case.dense(2.0)[0]
    assert loss > 0.1
    assert case.measure(2.0).damping == pytest.approx(loss, rel=1e-13)


@pytest.mark.parametrize("decay", [1.0, 1e-6, 0.0, *at_night(1e-2, 1e-4, 1e-8, 1e-10)])
def test_plastic_storey_with_hardly_any_damping(decay: float) -> None:
    """Zero stiffness, mass damping `decay` and a rising force, beside a damped oscillator.

    The rigid mass follows v' = f + g t - decay v from v0: thirty terms of its Taylor series are exact here.
    """
    tau, f, g, v0 = 0.8, 0.3, -0.5, 0.6
    terms = [v0]  # v' = f + g t - decay v
    for j in range(30):
        push = f if j == 0 else g if j == 1 else 0.0
        terms.append((push - decay * terms[j]) / (j + 1))
    v = np.polynomial.Polynomial(terms)
    loss = decay * (v**2).integ()(tau)
    done = (v * np.polynomial.Polynomial([f, g])).integ()(tau)
    for fast in (1.0, 1e4):
        k, c = np.diag([0.0, fast**2]), np.diag([decay, 0.02 * fast])
        propagator = make_propagator(np.eye(2), c, k, np.eye(2))
        work_integrals = WorkIntegrals(propagator, np.diag([decay, 0.0]), np.eye(2), [])
        coefs = np.array([[f, 0.0], [g, 0.0]])
        q = propagator.state_of(np.zeros(2), np.array([v0, 1.0]))
        found = measure(work_integrals, q, propagator.forcing(coefs, np.zeros(2)), tau, coefs, np.zeros(2))
        assert found.damping == pytest.approx(loss, rel=1e-12, abs=0.0)
        assert found.input == pytest.approx(done, rel=1e-12)
        if fast > 1.0 and isinstance(propagator, SeriesPropagator):
            break


@pytest.mark.parametrize("degree", [0, 1])
@pytest.mark.parametrize("kind", ["damped", "rigid body", "rigid body, mass damping", "critically damped"])
def test_many_intervals_at_once(kind: str, degree: int) -> None:
    case = Case(*subsystem(kind), degree)
    h, n = 0.25, 6
    gs = np.stack([polynomial.shift(case.g, i * h) for i in range(n)])
    coefs = np.stack([polynomial.shift(case.coefs, i * h) for i in range(n)])
    qs = case.propagator.march(case.q, gs, np.full(n, h))[:, :-1]
    several = case.work_integrals.over_intervals(qs, gs, np.full(n, h), coefs, case.constant)
    whole = case.measure(n * h)
    lengths = h * np.array([1.0, 0.4, 1.0, 1e-3, 1.0, 0.4])
    cut = case.work_integrals.over_intervals(qs, gs, lengths, coefs, case.constant)
    assert several.damping.shape == several.input.shape == several.laws[0][1].shape == (n,)
    assert several.damping.sum() == pytest.approx(whole.damping, rel=1e-12)
    assert several.input.sum() == pytest.approx(whole.input, rel=1e-12)
    assert several.laws[0][1].sum() == pytest.approx(whole.laws[0][1], rel=1e-12)
    for i in range(n):
        one = measure(case.work_integrals, qs[:, i], gs[i], h, coefs[i], case.constant)
        assert one.damping == pytest.approx(several.damping[i], rel=1e-13)
        assert one.input == pytest.approx(several.input[i], rel=1e-12, abs=1e-13 * abs(whole.input))
        part = measure(case.work_integrals, qs[:, i], gs[i], lengths[i], coefs[i], case.constant)
        assert part.damping == pytest.approx(cut.damping[i], rel=1e-11, abs=1e-15 * whole.damping)
        assert part.input == pytest.approx(cut.input[i], rel=1e-11, abs=1e-15 * abs(whole.input))


@pytest.mark.parametrize("off", [1e-3, 1e-5, 1e-7, 1e-9, 1e-12])
def test_nearly_critical_damping(off: float) -> None:
    """Products of nearly parallel modes would lose the condition's square: the quadrature takes over."""
    for xi in (1.0 - off, 1.0 + off):
        case = Case(np.eye(2), np.diag([6.0 * xi, 0.3]), np.diag([9.0, 4.0]), 1, dashpot=0.0)
        found = case.measure(1.1)
        change = case.energy(1.1) - case.energy(0.0)
        assert abs(found.input - change - found.damping) < 1e-9 * found.damping


def test_massless_dofs() -> None:
    for seed in range(3):
        m, c, k, _ = massless(3, 1, 1, 1.0, seed)
        case = Case(m, c, k, 2, seed, dashpot=0.0)
        assert case.propagator.u_p is not None
        loss, done, _ = case.dense(0.9)
        found = case.measure(0.9)
        assert found.damping == pytest.approx(loss, rel=1e-11)
        assert found.input == pytest.approx(done, rel=1e-11)


def test_defective_and_modal_paths_both_ran() -> None:
    assert isinstance(Case(*subsystem("damped"), 1).propagator, ModalPropagator)
    assert isinstance(Case(*subsystem("critically damped"), 1, dashpot=0.0).propagator, SeriesPropagator)
