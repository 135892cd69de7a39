"""Dense output: the motion of all subsystems at any time of a window of intervals.  The excitation is one
polynomial within each interval.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.closed_form.subsystems import Subsystem, Subsystems
from pound_solve.integrate.propagators.base import real_parts
from pound_solve.integrate.tolerances import COUNT_ROUNDING
from pound_solve.laws.automaton import Branch
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Index

#: instants of two intervals count as equal if they differ by less than this fraction of the length
SAME_LENGTH = 1e-12
Kinematics = tuple[Array, Array, Array]  #: displacement, velocity and acceleration of the unknowns


class DenseOutput:
    """The motion over a window; it sets the window's data in every `Subsystem`.

    Parameters
    ----------
    subsystems : Subsystems
    branches : sequence of Branch
    input_coefs : ndarray, shape (n, degree + 1, n_inputs)
        Input polynomials of each interval about its start.
    lengths : ndarray, shape (n,)
        Of the intervals [T]; all but the first are equal.

    Attributes
    ----------
    edges : ndarray, shape (n + 1,)
        Local times of the ends of the intervals, from zero.
    """

    def __init__(
        self, subsystems: Subsystems, branches: Sequence[Branch], input_coefs: Array, lengths: Array
    ) -> None:
        self.subsystems, self.branches = subsystems, branches
        self.input_coefs, self.lengths = input_coefs, lengths
        self.edges = np.concatenate([[0.0], np.cumsum(lengths)])
        for subsystem in subsystems.present:
            propagator = subsystem.decomposition.propagator
            if not subsystems.system.total and propagator.u_p is None:
                subsystem.forcing = propagator.forcing(input_coefs, subsystem.constant)
            else:
                subsystem.loads = self._loads(subsystem)
                subsystem.forcing = propagator.load_forcing(subsystem.loads)
            subsystem.states = propagator.march(subsystem.q, subsystem.forcing, lengths)

    def _loads(self, subsystem: Subsystem) -> Array:
        """Return the load polynomials of a subsystem, with the prescribed deformations of closed rigid
        contacts.
        """
        decomposition, n = subsystem.decomposition, len(subsystem.constant)
        loads = self.input_coefs @ decomposition.propagator.inputs.T
        loads[:, 0, :n] += subsystem.constant
        loads[..., :n] += self._support_loads(subsystem)
        if decomposition.reactions is None:
            return loads
        return decomposition.reactions.extended(loads, self.input_coefs)

    def _support_loads(self, subsystem: Subsystem) -> Array:
        """Return the loads of laws attached to moving supports, whose deformation has a known part, shape
        (n, degree + 1, n_unknowns).
        """
        system, laws = self.subsystems.system, subsystem.decomposition.laws
        e = self.input_coefs @ system.law_inputs[laws].T
        rate = np.zeros_like(e)
        rate[:, :-1] = e[:, 1:] * np.arange(1, e.shape[1])[:, None]
        k = np.array([self.branches[i].stiffness for i in laws])
        c = np.array([self.branches[i].damping for i in laws])
        loads: Array = -(e * k + rate * c) @ system.law_rows[np.ix_(laws, subsystem.decomposition.unknowns)]
        return loads

    def kept(self) -> DenseOutput:
        """Return a copy that does not change when the run continues."""
        snapshot = copy.copy(self)
        snapshot.__dict__.pop("end", None)  # cached; not used in a snapshot
        snapshot.branches = list(self.branches)
        snapshot.subsystems = copy.copy(self.subsystems)
        snapshot.subsystems.present = [copy.copy(x) for x in self.subsystems.present]
        return snapshot

    @property
    def intervals(self) -> int:
        """Number of intervals."""
        return len(self.input_coefs)

    @property
    def length(self) -> float:
        """Length of the window [T]."""
        return float(self.edges[-1])

    def locate(self, tau: float) -> tuple[int, float]:
        """Return the interval of local time `tau`, and the time since its start."""
        i = min(max(int(np.searchsorted(self.edges, tau, "right")) - 1, 0), self.intervals - 1)
        return i, tau - float(self.edges[i])

    def derivative_bounds(self) -> Array:
        """Return bounds of the second derivatives of the values and of the rates of all rows in each
        interval, shape (2, n_rows, n).  Apart from its forcing, no mode exceeds its initial magnitude.
        """
        subsystems = self.subsystems
        limits = np.zeros((2, len(subsystems.rows.rows), self.intervals))
        if subsystems.rows_have_inputs:
            e = np.abs(self.input_coefs @ subsystems.rows.inputs.T)
            for order in (0, 1):
                limits[order] += polynomial.values(e, self.lengths, order + 2).T
        for subsystem in subsystems.present:
            x = subsystem.decomposition
            bounds = x.propagator.derivative_bounds(
                subsystem.states[:, :-1], subsystem.forcing, self.lengths
            )
            if x.reactions is not None:
                limits[:, x.reactions.rows] = np.inf
            if not np.isfinite(bounds).all():
                limits[:, x.monitored] = np.inf
                continue
            for order in (0, 1):
                limits[order, x.monitored] += x.rows_q_size @ bounds[order]
                if subsystem.loads is not None and x.propagator.u_p is not None:
                    p = polynomial.values(np.abs(subsystem.loads), self.lengths, order + 2)
                    limits[order, x.monitored] += np.abs(x.rows @ x.propagator.u_p) @ p.T
        return limits

    def motion(self, interval: int, tau: float) -> Kinematics:
        """Return the motion at `tau` within an interval, shape (n,) each."""
        u, v, a = self.motions(interval, np.array([tau]))
        return u[:, 0], v[:, 0], a[:, 0]

    def motions(self, interval: int, times: Array) -> Kinematics:
        """Return the motion at several times of an interval, shape (n, n_times) each."""

        def states(subsystem: Subsystem) -> NDArray[Any]:
            if len(times) == 1:  # the ends of intervals are already known; other times recur
                return self.state(subsystem, interval, float(times[0]))[:, None, None]
            return subsystem.decomposition.propagator.trajectory(
                subsystem.states[:, interval], subsystem.forcing[interval], times
            )[:, None]

        return self._motions(np.array([interval]), times[None], states)

    def motions_within(self, chosen: Index, times: Array) -> Kinematics:
        """Return the motion at the same `times` within each of some intervals, interval by interval, shape
        (n, n_chosen * n_times) each.
        """
        t = np.tile(times, (len(chosen), 1))
        return self._motions(chosen, t, partial(_trajectories, chosen, times))

    def enveloped_motions(self, times: Array) -> Kinematics:
        """Return the motion of the unknowns in the envelopes at several local times, zero for other
        unknowns, shape (n, n_times) each.
        """
        interval = np.clip(np.searchsorted(self.edges, times, "right") - 1, 0, self.intervals - 1)
        local = times - self.edges[interval]
        alike: dict[bytes, list[Index]] = {}  # columns of each interval, by fractions of its length
        for i in np.unique(interval).tolist():
            columns = np.flatnonzero(interval == i)
            shares = np.round(local[columns] / self.lengths[i] / SAME_LENGTH)
            alike.setdefault(shares.tobytes() + self.lengths[i].tobytes(), []).append(columns)
        motions = np.zeros((3, self.subsystems.system.size, len(times)))
        for some in map(np.array, alike.values()):
            chosen, t = interval[some[:, 0]], local[some[0]]
            states = partial(_trajectories, chosen, t)
            motion = self._motions(chosen, np.tile(t, (len(chosen), 1)), states, enveloped=True)
            motions[:, :, some.ravel()] = motion
        u, v, a = motions
        return u, v, a

    def motions_at_ends(self, chosen: Index) -> Kinematics:
        """Return the motion at the ends of some intervals, shape (n, n_chosen) each."""
        t = self.lengths[chosen, None]
        return self._motions(chosen, t, lambda subsystem: subsystem.states[:, chosen + 1, None])

    @cached_property
    def end(self) -> tuple[Array, Array]:
        """Displacements and velocities at the end, shape (n,) each, valid only until the branches or the
        subsystems change.
        """
        u, v, _ = self.motions_at_ends(np.array([self.intervals - 1]))
        return u[:, 0], v[:, 0]

    def enveloped_grid(self, h: float, end: float) -> tuple[Array, Kinematics]:
        """Return local times at equal steps of at most `h` in each interval up to `end`, shape (n_times,),
        and the motion of the unknowns in the envelopes at these times, zero for other unknowns, shape (n,
        n_times) each.
        """
        last, longest = self.locate(end)[0], float(self.lengths.max())
        count = int(np.ceil(longest / h * (1 - COUNT_ROUNDING)))
        h = longest / count
        t = np.tile(h * np.arange(count), (last + 1, 1))
        chosen = np.arange(last + 1)

        def states(subsystem: Subsystem) -> NDArray[Any]:
            return subsystem.decomposition.propagator.samples(
                subsystem.states[:, chosen], subsystem.forcing[chosen], h, count
            )

        motion = self._motions(chosen, t, states, enveloped=True)
        seen = ((t < self.lengths[chosen, None]) & (self.edges[chosen, None] + t <= end)).ravel()
        u, v, a = (x[:, seen] for x in motion)
        return (self.edges[chosen, None] + t).ravel()[seen], (u, v, a)

    def _motions(
        self,
        intervals: Index,
        t: Array,
        states: Callable[[Subsystem], NDArray[Any]],
        enveloped: bool = False,
    ) -> Kinematics:
        """Return the motion at times `t`, shape (n_intervals, n_times), within each of some intervals;
        shape (n, n_intervals * n_times) each.

        `states` returns q of a subsystem at these times, shape (n_q, n_intervals, n_times).
        """
        motion = np.zeros((3, self.subsystems.system.size, t.size))
        for subsystem in self.subsystems.present:
            x = subsystem.decomposition
            unknowns, motion_q = (
                (x.unknowns[x.enveloped], x.enveloped_motion_q) if enveloped else (x.unknowns, x.motion_q)
            )
            if not len(unknowns):
                continue
            q, n, propagator = states(subsystem), len(unknowns), x.propagator
            kinematics = (motion_q @ real_parts(q.reshape(len(q), t.size))).reshape(3, n, *t.shape)
            kinematics[2] += polynomial.on(
                real_parts(subsystem.forcing[intervals], -1) @ motion_q[n : 2 * n].T, t
            )
            u_p, v_p = propagator.u_p, propagator.v_p
            if subsystem.loads is not None and u_p is not None and v_p is not None:
                if enveloped:
                    u_p, v_p = u_p[x.enveloped], v_p[x.enveloped]
                kinematics += direct_response(u_p, v_p, subsystem.loads[intervals], t)
            motion[:, unknowns] = kinematics.reshape(3, n, t.size)
        u, v, a = motion
        return u, v, a

    def state(self, subsystem: Subsystem, interval: int, tau: float) -> NDArray[Any]:
        """Return the state q of a subsystem at `tau` within an interval."""
        if tau == self.lengths[interval]:
            return subsystem.states[:, interval + 1]
        return subsystem.decomposition.propagator.at(
            subsystem.states[:, interval], subsystem.forcing[interval], tau
        )

    def advance_subsystems(self, interval: int, tau: float) -> None:
        """Set the present state of every subsystem to that at `tau` within an interval."""
        for subsystem in self.subsystems.present:
            subsystem.q = self.state(subsystem, interval, tau)

    def impulse(self, law: int, interval: int, tau: float) -> float:
        """Return the integral of a law's force over the first `tau` of an interval [F T]."""
        b, system = self.branches[law], self.subsystems.system
        if b.constrains:
            return self._reaction_impulse(law, interval, tau)
        e = self.input_coefs[interval] @ system.law_inputs[law]
        area = float(_integral(e, tau))
        change = sum(e[k] * tau**k for k in range(1, len(e)))
        for subsystem in self.subsystems.present:
            row = system.law_rows[law, subsystem.decomposition.unknowns]
            if not np.any(row):
                continue
            propagator = subsystem.decomposition.propagator
            q, g = subsystem.states[:, interval], subsystem.forcing[interval]
            area += float((row @ (propagator.u_q @ propagator.integral(q, g, tau))).real)
            change += float((row @ (propagator.u_q @ (self.state(subsystem, interval, tau) - q))).real)
            if subsystem.loads is not None and propagator.u_p is not None:
                p = subsystem.loads[interval]
                area += float(row @ propagator.u_p @ _integral(p, tau))
                change += float(row @ propagator.u_p @ (polynomial.value(p, tau) - p[0]))
        return float(b.force0 * tau + b.stiffness * area + b.damping * change)

    def _reaction_impulse(self, law: int, interval: int, tau: float) -> float:
        """Return the `impulse` of a closed rigid contact."""
        for subsystem in self.subsystems.present:
            x = subsystem.decomposition.reactions
            if x is None or law not in x.laws:
                continue
            assert subsystem.loads is not None
            p, propagator = subsystem.loads[interval], subsystem.decomposition.propagator
            q = propagator.integral(subsystem.states[:, interval], subsystem.forcing[interval], tau)
            area = (x.on_q @ q).real
            area = area + x.on_p @ _integral(p, tau)
            area += x.on_rate @ (polynomial.value(p, tau) - p[0])
            return float(area[x.laws == law][0])
        return 0.0


def _trajectories(chosen: Index, t: Array, subsystem: Subsystem) -> NDArray[Any]:
    """Return the states q of a subsystem at times `t` of some intervals, shape (n_q, n_chosen, n_times)."""
    states, forcing = subsystem.states[:, chosen], subsystem.forcing[chosen]
    return subsystem.decomposition.propagator.trajectories(states, forcing, t)


def _integral(coefs: Array, tau: float) -> Array:
    """Return the integral over (0, tau) of polynomials, shape (degree + 1, ...)."""
    integral: Array = sum(coefs[k] * tau ** (k + 1) / (k + 1) for k in range(len(coefs)))
    return integral


def direct_response(u_p: Array, v_p: Array, loads: Array, t: Array) -> Array:
    """Return the direct response of massless DOFs to loads: value, rate and second rate of rows, shape
    ``(3, n_rows, *t.shape)``, from the load polynomials of some intervals at times `t` of each.
    """
    force, slope, curvature = (polynomial.on(loads, t, order) for order in range(3))
    u, v = (partial(np.tensordot, rows, axes=1) for rows in (u_p, v_p))
    return np.stack([u(force), v(force) + u(slope), v(slope) + u(curvature)])
