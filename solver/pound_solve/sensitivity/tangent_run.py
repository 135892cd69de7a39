r"""The derivatives of a motion along a run, through its events.

At an event, whose function is :math:`g(d, \dot d; p)`, the run changes from one equation of motion to
another, and the instant of the event moves with the parameters.  With the derivatives S of the state x
before it at a fixed time, and the rates of the state before and after,

.. math:: \frac{dt_e}{dp} = -\frac{\partial_p g + \partial_x g\, S^-}{\dot g^-}, \qquad
          S^+ = S^- + (\dot x^- - \dot x^+)\frac{dt_e}{dp} .

The internal variables of the law have the derivatives of its transition along the moving instant.

References
----------
Aizerman MA, Gantmacher FR (1958), On the stability of periodic motions, J. Appl. Math. Mech. 22: 1065-1078.
Corner S, Sandu C, Sandu A (2019), Modeling and sensitivity analysis methodology for hybrid dynamical
systems, Nonlinear Analysis: Hybrid Systems 31: 19-40.
Kong NJ, Payne JJ, Zhu J, Johnson AM (2023), Saltation matrices: the essential tool for linearizing hybrid
dynamical systems, Proc. IEEE 112: 585-608.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from pound_solve.numerics.types import Array, Index
from pound_solve.sensitivity.course import Instant, RunCourse
from pound_solve.sensitivity.dual import Dual, slopes_of, value_of
from pound_solve.sensitivity.dual_law import DualLaw, branch_slopes
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import InputSlopes, Instants, instants
from pound_solve.sensitivity.propagation import Carried, carried
from pound_solve.sensitivity.samples import TangentSample, sampled
from pound_solve.sensitivity.trajectory import BranchChange, SmoothPiece

OVERDUE = 1e-9  #: fraction of the terms of an event function above which the event follows from another


class Crossing(NamedTuple):
    """How an event function passes zero.

    Attributes
    ----------
    t : float
        Time [T].
    law : int
    on_d, on_v : float
        Factors of the function on the deformation and on its rate.
    d, rate, second : float
        Deformation there, and its first two rates.
    """

    t: float
    law: int
    on_d: float
    on_v: float
    d: float
    rate: float
    second: float

    @property
    def speed(self) -> float:
        """Return the rate of the event function."""
        return self.on_d * self.rate + self.on_v * self.second


class TangentRun:
    """Derivatives along the course of a run.

    Parameters
    ----------
    equations : TangentEquations
    input_slopes : InputSlopes
    laws : sequence of DualLaw
        At the start.
    largest : ndarray, shape (2, n_laws)
        Largest magnitudes of the deformations and of their rates in the run.

    Attributes
    ----------
    crossings : list of Crossing
        Of all events.
    su, sv : ndarray, shape (n_params, n)
        Derivatives of displacements and velocities at the present time.
    impulse : ndarray, shape (n_params, n_laws)
        Derivatives of the integrals of the laws' forces up to then.
    """

    def __init__(
        self,
        equations: TangentEquations,
        input_slopes: InputSlopes,
        laws: Sequence[DualLaw],
        largest: Array,
    ) -> None:
        self.equations, self.input_slopes = equations, input_slopes
        self.laws, self.largest = laws, largest
        self.su, self.sv = equations.slopes.u.copy(), equations.slopes.v.copy()
        self.impulse = np.zeros((equations.n_params, len(laws)))
        self.crossings: list[Crossing] = []
        self.branches = branch_slopes(laws, equations.n_params)
        self._moved = np.zeros(equations.n_params)  # derivative of the instant of the last event
        self._before: Instants | None = None  # motion just before the events at the present time
        self._at_once = False  # whether the last piece has no length
        self._changed = False  # whether an event has occurred since the last piece
        self._here = list[float]()  # times of samples at this event

    def follow(self, course: RunCourse, times: Iterable[float]) -> dict[float, list[TangentSample]]:
        """Follow a course, and return the samples at some times: one, or those before and after the event
        that occurs then.
        """
        samples = {t: list[TangentSample]() for t in times}
        wanted: dict[int, list[tuple[Instant, float]]] = {}
        for t in samples:
            wanted.setdefault((at := course.place(t)).part, []).append((at, t))
        for i, part in enumerate(course.parts):
            here = sorted(wanted.get(i, ()))
            if isinstance(part, SmoothPiece):
                self._begin(part, samples)
                self._advance(part, here, samples)
            else:
                self._pass(part, [t for _, t in here], samples)
        return samples

    def _begin(self, piece: SmoothPiece, samples: dict[float, list[TangentSample]]) -> None:
        """Continue after the events at the start of a piece, if any."""
        if not self._changed:
            return
        if self._before is not None:
            after = self._instants(piece, 0, 0.0)
            self.su += np.outer(self._moved, (self._before.v - after.v)[:, 0])
            self.sv += np.outer(self._moved, (self._before.a - after.a)[:, 0])
            for t in self._here:
                samples[t].append(self._sampled(after, self.su, self.sv, self._moved))
        self._changed = False
        if piece.lengths.any():  # otherwise another event follows at this instant
            self._here = []

    def _advance(
        self,
        piece: SmoothPiece,
        here: list[tuple[Instant, float]],
        samples: dict[float, list[TangentSample]],
    ) -> None:
        """Follow a piece, and take the samples within it."""
        lengths, stops = piece.lengths, {at.interval for at, _ in here}
        i = 0
        while i < len(lengths):
            for at, t in here:
                if at.interval == i:
                    there = self._carried(piece, np.array([i]), at.tau)
                    x = self._instants(piece, i, at.tau)
                    samples[t].append(self._sampled(x, there.su, there.sv))
            end = i + 1
            while end < len(lengths) and lengths[end] == lengths[i] and end not in stops:
                end += 1
            self.su, self.sv, impulse = self._carried(piece, np.arange(i, end), float(lengths[i]))
            self.impulse += impulse
            i = end
        self._before = self._instants(piece, len(lengths) - 1, float(lengths[-1]))
        self._at_once = not lengths.any()

    def _pass(
        self, change: BranchChange, here: list[float], samples: dict[float, list[TangentSample]]
    ) -> None:
        """Let a law change its branch."""
        d, v = Dual(change.d), Dual(change.v)
        if (x := self._before) is not None:  # otherwise the run starts here, at a fixed time
            if not self._changed:
                self._moved = self._instant(change, x)
            for t in here:
                samples[t].append(self._sampled(x, self.su, self.sv, self._moved))
            rate, second = (float(self.equations.deformations(x, i)[change.law, 0]) for i in (1, 2))
            dd, drate = self._law_slopes(change.law, x)
            d, v = Dual(d.value, dd + rate * self._moved), Dual(v.value, drate + second * self._moved)
        force = self.branches.values[:, change.law]
        self.laws[change.law].change(change.event, d, v, change.after[0])
        self.branches = branch_slopes(self.laws, self.equations.n_params)
        jump = (self.branches.values[:, change.law] - force) @ (d.value, v.value, 1.0)
        self.impulse[:, change.law] -= jump * self._moved
        self._changed = True
        self._here += here

    def _instant(self, change: BranchChange, x: Instants) -> Array:
        """Return the derivative of the instant of a change, shape (n_params,)."""
        on_d, on_v, constant = self.laws[change.law].event(change.event)
        a, b, c = map(value_of, (on_d, on_v, constant))
        d, rate, second = (float(self.equations.deformations(x, i)[change.law, 0]) for i in range(3))
        size = abs(a) * self.largest[0, change.law] + abs(b) * self.largest[1, change.law] + abs(c)
        if self._at_once and a * d + b * rate + c > OVERDUE * size:
            return self._moved  # it follows from the change before it, at the same instant
        dd, drate = self._law_slopes(change.law, x)
        slope = a * dd + b * drate + d * slopes_of(on_d) + rate * slopes_of(on_v) + slopes_of(constant)
        crossing = Crossing(change.t, change.law, a, b, d, rate, second)
        self.crossings.append(crossing)
        return np.asarray(-slope / crossing.speed) if crossing.speed else np.zeros(len(dd))

    def _law_slopes(self, law: int, x: Instants) -> tuple[Array, Array]:
        """Return the derivatives of a law's deformation and rate at a fixed time, (n_params,) each."""
        row = self.equations.base.law_rows[law]
        dd, drate = (
            s @ row + self.equations.deformations_at_fixed_motion(x, order)[:, law, 0]
            for order, s in enumerate((self.su, self.sv))
        )
        return dd, drate

    def _carried(self, piece: SmoothPiece, chosen: Index, tau: float) -> Carried:
        """Return the derivatives after intervals of a piece, at whose start the run is."""
        start = self.su, self.sv
        return carried(self.equations, self.input_slopes, piece, self.branches, chosen, tau, start)

    def _instants(self, piece: SmoothPiece, interval: int, tau: float) -> Instants:
        """Return the motion at one instant of a piece."""
        return instants(piece, np.array([interval]), np.array([tau]), self.input_slopes)

    def _sampled(self, x: Instants, su: Array, sv: Array, moved: Array | None = None) -> TangentSample:
        """Return the sample at one instant of the present branches."""
        return sampled(self.equations, x, self.branches, su, sv, moved)
