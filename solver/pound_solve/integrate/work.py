r"""Work done on and by a block over a segment, in closed form.

Split each mode into a free and a forced part, :math:`q_i = c_i e^{\lambda_i t} + p_i(t)` with a polynomial
:math:`p_i`.  Then with :math:`S = V^T C V` (V the modes' velocities)

.. math:: \int_0^\tau v^T C v\,dt

has free-free terms :math:`c_i c_j S_{ij}(e^{(\lambda_i+\lambda_j)\tau}-1)/(\lambda_i+\lambda_j)`, free-forced terms through the
moments :math:`\int t^k e^{\lambda t}`, and forced-forced terms that are plain polynomials.  No balance of energy is used, so
the sum of all energies remains a check.

For polynomials above the first degree, and where the modes are defective, Gauss quadrature on a grid that
resolves the fastest mode takes its place.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate import phi
from pound_solve.integrate.flow import RECURRING, ModalFlow, SeriesFlow, gauss, powers
from pound_solve.scene import Scene

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

class Work(NamedTuple):
    """Dissipation in dashpots, input, and for each pressed contact (law, loss) [F L]."""

    damping: float
    input: float
    contacts: list[tuple[int, float]]


class Meter:
    """Measures the work in one block and regime.

    Parameters
    ----------
    flow : ModalFlow or SeriesFlow
    damping : ndarray, shape (n, n)
        Of the structure, contacts apart.
    inputs : ndarray, shape (n, n_inputs)
    contacts : list of (law, c, row)
        Pressed contacts with dashpots.
    """

    def __init__(
        self, flow: ModalFlow | SeriesFlow, damping: Array, inputs: Array, contacts: list[tuple[int, float, Array]]
    ) -> None:
        self.flow, self.inputs, self.contacts, self.damping_matrix = flow, inputs, contacts, damping
        self.damped = bool(np.any(damping))
        self.closed_form = isinstance(flow, ModalFlow) and flow.u_p is None
        if not isinstance(flow, ModalFlow) or not self.closed_form:
            return
        lam, v = flow.lam, flow.v_q
        # modes that move nothing (displacement offsets of a mechanism) and rigid-body pairs have no free part
        self.free = np.abs(lam) > 1e-10 * max(flow.fastest, 1e-300)
        self.lam = np.where(self.free, lam, 1.0)
        self.forms = [self._form(v, damping)] if self.damped else []
        self.contact_forms = [self._form(row[None, :] @ v, np.array([[c]])) for _, c, row in contacts]
        self.power_rows = inputs.T @ v
        self._moments: dict[tuple[float, int], tuple[Complex, Complex]] = {}

    def _form(self, v: Complex, c: Array) -> tuple[Complex, Complex, Complex, Array]:
        """Return (V, R1, R2, C): the free-free quadratic forms already divided by their exponents."""
        v = np.where(self.free, v, 0.0)
        cv = c @ v
        plain, mixed = v.T @ cv, v.conj().T @ cv
        s1, s2 = self.lam[:, None] + self.lam[None, :], self.lam.conj()[:, None] + self.lam[None, :]
        # an undamped pair has no dissipation to divide: 0/0 is 0
        floor = 1e-13 * max(float(np.abs(self.lam).max(initial=0.0)), 1e-300)
        r1 = np.where(np.abs(s1) > floor, plain / np.where(np.abs(s1) > floor, s1, 1.0), 0.0)
        r2 = np.where(np.abs(s2) > floor, mixed / np.where(np.abs(s2) > floor, s2, 1.0), 0.0)
        return v, r1, r2, c

    def _split(self, q: Complex, g: Complex, tau: float) -> tuple[Complex, Complex, Complex, Complex]:
        """Free amplitudes at 0 and tau, forced polynomials (degree + 1, n_q), moments (degree + 2, n_q)."""
        degree = len(g) - 1
        p = np.zeros((degree + 3, len(q)), complex)
        for k in range(degree, -1, -1):
            p[k] = np.where(self.free, ((k + 1) * p[k + 1] - g[k]) / self.lam, 0.0)
        c0 = np.where(self.free, q - p[0], 0.0)
        flow = self.flow
        assert isinstance(flow, ModalFlow)
        if len(flow.b_rows):  # rigid-body velocities are polynomials outright
            b = flow.b_rows
            p[0, b] = q[b]
            for k in range(degree + 1):
                p[k + 1, b] = g[k, b] / (k + 1)
        key = (tau, degree)
        found = self._moments.get(key)
        if found is None:
            z = np.where(self.free, self.lam * tau, 0.0)
            found = np.exp(z), phi.moments(z, degree + 2) * (tau ** np.arange(1, degree + 4))[:, None]
            if len(self._moments) < RECURRING:
                self._moments[key] = found
        used = degree + 3 if len(flow.b_rows) else degree + 1  # rigid bodies integrate the forces once more
        return c0, c0 * found[0], p[:used], found[1]

    def measure(
        self, q: NDArray[Any], g: NDArray[Any], tau: float, coefs: Array, constant: Array, p: Array | None = None
    ) -> Work:
        """Return the work over (0, tau).

        Parameters
        ----------
        q, g : ndarray
            Modal state at 0 and forcing.
        tau : float
            [T]
        coefs : ndarray, shape (degree + 1, n_inputs)
            Inputs; their forces and `constant` loads (n,) do the input work.
        p : ndarray, shape (degree + 1, n), or None
            Force polynomials on the unknowns, where massless freedoms need them.
        """
        if not self.closed_form or len(g) > 2:
            return self._quadrature(q, g, tau, coefs, constant, p)
        c0, c1, forced, moments = self._split(q, g, tau)
        loss = sum(self._loss(form, c0, c1, forced, moments, tau) for form in self.forms)
        contacts = [
            (law, self._loss(form, c0, c1, forced, moments, tau)) for (law, _, _), form in zip(self.contacts, self.contact_forms)
        ]
        # input: sum over inputs j and powers k of coefs[k, j] * integral t^k F_j^T v
        total = 0.0
        for k in range(len(coefs)):
            integral = c0 * moments[k] + sum(forced[j] * tau ** (j + k + 1) / (j + k + 1) for j in range(len(forced)))
            total += float(coefs[k] @ (self.power_rows @ integral).real)
        if constant.any():
            integral = c0 * moments[0] + sum(forced[j] * tau ** (j + 1) / (j + 1) for j in range(len(forced)))
            total += float(constant @ (self.flow.v_q @ integral).real)
        return Work(loss, total, contacts)

    def _loss(self, form: tuple[Complex, Complex, Complex, Array], c0: Complex, c1: Complex, p: Complex, moments: Complex, tau: float) -> float:
        v, r1, r2, c = form
        # v = Re(V q): v^T C v = (q^T S1 q + q^H S2 q) / 2, real part
        free = 0.5 * ((c1 @ r1 @ c1 - c0 @ r1 @ c0) + (c1.conj() @ r2 @ c1 - c0.conj() @ r2 @ c0)).real
        forced = (v @ p.T).real  # velocity polynomials, (n, degree + 3)
        cf = c @ forced
        mixed = 2.0 * sum(float(((v.T @ cf[:, k]) @ (c0 * moments[k])).real) for k in range(min(len(moments), forced.shape[1])))
        plain = 0.0
        for j in range(forced.shape[1]):
            for k in range(forced.shape[1]):
                plain += float(forced[:, j] @ cf[:, k]) * tau ** (j + k + 1) / (j + k + 1)
        return float(free) + mixed + plain

    def _quadrature(self, q: NDArray[Any], g: NDArray[Any], tau: float, coefs: Array, constant: Array, p: Array | None) -> Work:
        w, points = gauss(tau, self.flow.fastest)
        v = np.stack([velocity(self.flow, q, g, p, float(x)) for x in points], axis=1)
        force = constant[:, None] + self.inputs @ np.einsum("kj,kt->jt", coefs, powers(points, len(coefs) - 1))
        loss = float(np.einsum("it,ij,jt,t->", v, self.damping_matrix, v, w)) if self.damped else 0.0
        contacts = [(law, float(c * (w @ (row @ v) ** 2))) for law, c, row in self.contacts]
        return Work(loss, float(np.einsum("it,it,t->", v, force, w)), contacts)


def velocity(flow: ModalFlow | SeriesFlow, q: NDArray[Any], g: NDArray[Any], p: Array | None, t: float) -> Array:
    """Velocity of a block's unknowns at local time `t`; `p` are its force polynomials where massless freedoms need them."""
    v = (flow.v_q @ flow.at(q, g, t)).real
    if flow.u_p is not None and p is not None:
        v = v + flow.space.v_p @ polynomial(p, t) + flow.u_p @ polynomial(p, t, 1)
    return v


def polynomial(p: Array, t: float, order: int = 0) -> Array:
    """Value of polynomials (ascending, first axis) at `t`, or of their derivative of some order."""
    out = np.zeros(p.shape[1:])
    for k in range(len(p) - 1, order - 1, -1):
        out = out * t + p[k] * float(np.prod(np.arange(k - order + 1, k + 1)))
    return out


def total_work(
    scene: Scene, tau: float, fastest: float, motion: Callable[[float], tuple[Array, Array, Array]], law_force: Callable[[float], Array], t0: float
) -> tuple[float, float]:
    """Return input and dashpot work over a segment in the total form.

    The input is the power of the supports: their reactions times their velocities, and of the constant loads.

    Parameters
    ----------
    scene : Scene
    tau : float
        Length of the segment [T]; `t0` is its start.
    fastest : float
        Fastest eigenvalue, for the quadrature.
    motion : callable
        Displacement, velocity and acceleration of the unknowns at a local time.
    law_force : callable
        Forces of all laws at a local time, shape (n_laws,).
    """
    s = scene.structure
    n = s.n_free
    done, lost = 0.0, 0.0
    for w, x in zip(*gauss(tau, fastest)):
        u, v, a = (scene.all_freedoms(y, t0 + float(x), order) for order, y in enumerate(motion(float(x))))
        force = s.stiffness @ u + s.damping @ v + s.mass @ a + s.law_rows.T @ law_force(float(x))
        done += w * float(force[n:] @ v[n:] + s.loads[:n] @ v[:n])
        lost += w * float(v @ s.damping @ v)
    return done, lost
