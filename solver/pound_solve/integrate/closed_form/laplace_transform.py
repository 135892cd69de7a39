r"""Response of a linear system by a numerical Laplace transform.

.. math:: D(s)\,\hat u(s) = \hat p(s) + M(s u_0 + v_0) + C u_0, \qquad D(s) = s^2 M + s C + K

is inverted along :math:`s = \alpha + i\omega` by a fast Fourier transform over a window of N samples at
intervals DT.

For the transform, the start is a step in :math:`u`, whose inverse would converge slowly.  Therefore a
function with a closed-form transform and the same initial derivatives as the response, up to order
`MAX_DERIVATIVE`,

.. math:: q(t) = e^{-\beta t}\sum_k c_k t^k, \qquad \hat q(s) = \sum_k \frac{k!\,c_k}{(s+\beta)^{k+1}}

is subtracted before the inversion.  The remainder has kinks where the excitation has kinks, so that the
error is of order DT^3 in displacements and DT^2 in velocities (records with linear interpolation).
:math:`\alpha` is chosen such that wrap-around and rounding errors, which both grow with
:math:`e^{\alpha t}`, are :math:`10^{-10}` in the first half of
the window, and only that half is used.  If the motion itself grows, on a softening branch, the line is
shifted to the right by the fastest growth rate.  All poles are then on its left, and both errors are the
same fraction of the motion.

References
----------
Wilcox DJ (1978), Numerical Laplace transformation and inversion, Int. J. Elect. Engng Educ. 15: 247-265
(the damped Fourier transform).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pound_solve.integrate.intervals import SAME_LENGTH
from pound_solve.integrate.propagators.state_space import StateSpace, state_space
from pound_solve.loading.excitation import CLOCK_ROUNDING
from pound_solve.numerics import phi
from pound_solve.numerics.types import Array, Complex
from pound_solve.structure.reduction import ReducedSystem

MAX_DERIVATIVE = 5  #: highest derivative at the start that is subtracted
DAMPING_OF_WINDOW = 24.0  #: alpha times the window; the errors are 1e-10 in its first half
BATCH = 64  #: number of pieces of the excitation that are transformed at once


@dataclass(frozen=True)
class DynamicStiffness:
    """Damping and stiffness of a system on some branches, its first-order form, and 1/D(s).

    Attributes
    ----------
    damping, stiffness : ndarray, shape (n, n)
    space : StateSpace
    spectral_radius : float
        Largest \\|eigenvalue\\| [1/T].
    s : ndarray of complex, shape (n_frequencies,)
        Points of the transform, to the right of all eigenvalues.
    inverse : ndarray of complex, shape (n_frequencies, n, n)
    """

    damping: Array
    stiffness: Array
    space: StateSpace
    spectral_radius: float
    s: Complex
    inverse: Complex


class LaplaceTransform:
    """Transform over a window of samples.

    Parameters
    ----------
    system : ReducedSystem
    dt : float
        Distance of the samples [T].
    points : int
        Number of samples in the window, even.

    Attributes
    ----------
    s : ndarray of complex, shape (n_frequencies,)
        Points of the transform of a motion that does not grow.
    """

    def __init__(self, system: ReducedSystem, dt: float, points: int) -> None:
        self.system, self.dt, self.points = system, dt, points
        s = (DAMPING_OF_WINDOW + 2j * np.pi * np.arange(points // 2 + 1)) / (points * dt)
        self.s: Complex = np.asarray(s, complex)

    def dynamic_stiffness(self, c: Array, k: Array) -> DynamicStiffness:
        """Return the data that the response with damping `c` and stiffness `k` needs.

        Raises
        ------
        Mechanism
            Massless DOFs with neither stiffness nor dashpot.
        """
        mass, space = self.system.mass, state_space(self.system.mass, c, k)
        values = np.linalg.eigvals(space.a)
        frequencies = self.s + values.real.max(initial=0.0)
        s = frequencies[:, None, None]
        inverse = np.linalg.inv(s * s * mass + s * c + k)
        return DynamicStiffness(c, k, space, float(np.abs(values).max(initial=0.0)), frequencies, inverse)

    def inputs(self, begin: float, s: Complex) -> Complex:
        """Return the transform of the inputs from time `begin` on, shape (n_frequencies, n_inputs)."""
        excitation = self.system.excitation
        transform = np.zeros((len(s), excitation.coefs.shape[2]), complex)
        end = begin + self.points * self.dt
        first = excitation.piece(begin + CLOCK_ROUNDING * max(1.0, begin))
        stop = int(np.searchsorted(excitation.breaks[:-1], end))
        left = np.maximum(begin, excitation.breaks[first:stop])
        right = np.minimum(end, excitation.breaks[first + 1 : stop + 1])
        coefs = excitation.coefs[first:stop]
        if stop > first:
            coefs = np.concatenate([excitation.local(first, begin)[None], coefs[1:]])
        # consecutive pieces of equal length differ by a delay and by their coefficients
        width = right - left
        close = SAME_LENGTH * width[1:] + 4.0 * np.spacing(right[1:])
        edges = np.flatnonzero(np.abs(np.diff(width)) > close) + 1
        for run in np.split(np.arange(len(width)), edges):
            if not len(run) or width[run[0]] <= 0.0:
                continue
            length = float(width[run[0]])
            powers = length ** np.arange(1, excitation.degree + 2)
            kernels = phi.moments(-s * length, excitation.degree) * powers[:, None]
            delays = np.exp(-s[:, None] * length * np.arange(min(BATCH, len(run))))
            for i in range(0, len(run), BATCH):
                chunk = coefs[run[i : i + BATCH]]
                sums = (delays[:, : len(chunk)] @ chunk.reshape(len(chunk), -1)).reshape(
                    len(s), *chunk.shape[1:]
                )
                later = np.exp(-s * (left[run[i]] - begin))[:, None]
                transform += later * np.einsum("js,sjn->sn", kernels, sums)
        # beyond its end the excitation keeps its last value: a jump there would affect earlier times
        last = float(excitation.breaks[-1])
        if last < end:
            transform += (np.exp(-s * (last - begin)) / s)[:, None] * excitation.value(last)
        return transform

    def _start_derivatives(
        self, x: DynamicStiffness, constant: Array, t: float, u: Array, v: Array
    ) -> list[Array]:
        """Return the derivatives of the displacement at the start, up to order `MAX_DERIVATIVE`."""
        system, excitation = self.system, self.system.excitation
        coefs = excitation.local(excitation.piece(t + CLOCK_ROUNDING * max(1.0, t)), t)
        z = x.space.z_u @ u + x.space.z_v @ v
        derivatives, force = [], np.zeros(system.size)
        for j in range(MAX_DERIVATIVE + 1):
            force = math.factorial(j) * system.inputs @ coefs[j] if j < len(coefs) else 0.0 * force
            force = force + constant * (j == 0)
            static = 0.0 if x.space.u_p is None else x.space.u_p @ force
            derivatives.append(x.space.u_z @ z + static)
            z = x.space.a @ z + x.space.b @ force
        return derivatives

    def response(
        self, x: DynamicStiffness, constant: Array, t: float, u: Array, v: Array
    ) -> tuple[Array, Array]:
        """Return displacements and velocities at the samples of the first half window, shape (n,
        n_samples).

        Parameters
        ----------
        x : DynamicStiffness
        constant : ndarray, shape (n,)
            Constant loads.
        t : float
            Time of the start [T].
        u, v : ndarray, shape (n,)
            Displacement and velocity at the start.
        """
        system, s, half = self.system, x.s, self.points // 2
        derivatives = self._start_derivatives(x, constant, t, u, v)
        beta = max(x.spectral_radius, self.s[0].real)  # for free bodies, the rate of the window
        q = np.array(
            [
                sum(
                    beta ** (j - i) / math.factorial(j - i) / math.factorial(i) * derivatives[i]
                    for i in range(j + 1)
                )
                for j in range(MAX_DERIVATIVE + 1)
            ]
        )
        right = self.inputs(t, s) @ system.inputs.T + constant / s[:, None]
        right += s[:, None] * (system.mass @ derivatives[0]) + system.mass @ v + x.damping @ derivatives[0]
        start = sum(
            math.factorial(j) * q[j] / (s[:, None] + beta) ** (j + 1) for j in range(MAX_DERIVATIVE + 1)
        )
        rest = (x.inverse @ right[:, :, None])[:, :, 0] - start
        times = self.dt * np.arange(half + 1)
        growth = np.exp(s[0].real * times) / self.dt
        decay, powers = np.exp(-beta * times), times ** np.arange(MAX_DERIVATIVE + 1)[:, None]
        slopes = powers[:-1] * np.arange(1, MAX_DERIVATIVE + 1)[:, None]
        out_u = np.fft.irfft(rest.T, self.points)[:, : half + 1] * growth + (q.T @ powers) * decay
        out_v = np.fft.irfft(s * rest.T, self.points)[:, : half + 1] * growth
        out_v += (q[1:].T @ slopes - beta * q.T @ powers) * decay
        out_u[:, 0], out_v[:, 0] = derivatives[:2]  # known: the branches of the laws depend on them
        return out_u, out_v
