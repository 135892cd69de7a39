r"""LAPLACE: between events the response by a numerical Laplace transform.

A structure that is linear between events, soil and foundation included, obeys

.. math:: D(s)\,\hat u(s) = \hat p(s) + M(s u_0 + v_0) + C u_0, \qquad D(s) = s^2 M + s C + K

from the state :math:`u_0, v_0` on.  The transform is inverted along :math:`s = \alpha + i\omega` by a fast
Fourier transform over a window of N samples DT apart.  The earliest exit of a law ends the piece: the law
changes its branch, and the next piece starts from the state there, which carries the unbalanced forces
over.  So did Chouw with buildings, their contact and the soil in one transform.

The start is a step in :math:`u` to the transform, whose inverse would converge slowly.  A part with a
closed transform that starts as the response does, up to the derivative of order `STARTS`,

.. math:: q(t) = e^{-\beta t}\sum_k c_k t^k, \qquad \hat q(s) = \sum_k \frac{k!\,c_k}{(s+\beta)^{k+1}}

is taken off before the inversion.  What is left has kinks where the excitation has them, so that the error
is of order DT^3 in displacements and DT^2 in velocities (straight-line records).
:math:`\alpha` is such that the window's repetition and the rounding, which both grow with
:math:`e^{\alpha t}`, are :math:`10^{-10}` in the first half of the window; only that is used.

Beside the transforms of the polynomial pieces of the excitation, which are exact, this shares nothing with
EXACT: it is a check of it, not a rival.

References
----------
Chouw N (2002), Influence of soil-structure interaction on pounding response of adjacent buildings due to
near-source earthquakes, J. Applied Mechanics JSCE 5: 543-553; Wilcox DJ (1978), Numerical Laplace
transformation and inversion, Int. J. Elect. Engng Educ. 15: 247-265 (the damped Fourier transform).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.closed_form.propagator import Mechanism, StateSpace, state_space
from pound_solve.integrate.condensed import condensed
from pound_solve.integrate.events import grid
from pound_solve.integrate.events.functions import exits, followed
from pound_solve.integrate.protocol import (
    CHATTER,
    INTERRUPTED,
    RUNAWAY,
    MonitoredOutputs,
    Outcome,
    Recorder,
    ResponseTracker,
    Start,
    Stop,
    energy_at_start,
    law_values,
    light,
    not_linear,
    refuse_rigid,
    rounding_check,
)
from pound_solve.numerics import phi
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Complex
from pound_solve.structure.reduction import ReducedSystem

STARTS = 5  #: highest derivative at the start that is taken off
DAMPING = 24.0  #: alpha times the window: 1e-10 in its first half
TOGETHER = 64  #: pieces of the excitation that are transformed at once
STILL = 1e-10  #: as that of `base`; the transforms have ten digits


def hermite(h: float, x: float, f: Array, slope: Array) -> tuple[Array, Array]:
    """Value and slope at `x` within (0, h) of the cubic through values and slopes at both ends."""
    y = x / h
    d = f[1] - f[0]
    a, b = h * slope[0] - d, d - h * slope[1]
    value = (1 - y) * f[0] + y * f[1] + y * (1 - y) * ((1 - y) * a + y * b)
    rate = d + (1 - 2 * y) * ((1 - y) * a + y * b) + y * (1 - y) * (b - a)
    return value, rate / h


class Samples:
    """Rows at samples of equal distance, an arc for `functionals`, and the cubics between them.

    Parameters
    ----------
    t : ndarray, shape (n_t,)
    value, rate, second : ndarray, shape (n_rows, n_t)
    """

    def __init__(self, t: Array, value: Array, rate: Array, second: Array) -> None:
        self.t = t[None]
        self.value, self.rate, self.second = (x[:, None] for x in (value, rate, second))

    def at(self, row: int, arc: int, cell: int, tau: float) -> tuple[float, float, float]:
        """Value, rate and second rate of a row at a time in a cell."""
        h, x = float(self.t[0, cell + 1] - self.t[0, cell]), tau - float(self.t[0, cell])
        d, v, w = (y[row, arc, cell : cell + 2] for y in (self.value, self.rate, self.second))
        value = hermite(h, x, d, v)[0]
        rate, second = hermite(h, x, v, w)
        return float(value), float(rate), float(second)

    def until(self, tau: float, ends: tuple[Array, Array, Array]) -> Samples:
        """Those before `tau`, and there the rows `ends`."""
        cut = self.t[0] < tau
        known = (
            np.append(x[:, 0, cut], y[:, None], axis=1)
            for x, y in zip((self.value, self.rate, self.second), ends)
        )
        return Samples(np.append(self.t[0, cut], tau), *known)


class Laplace:
    """One run; see the module's head."""

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        options: Mapping[str, Any],
        recorder: Recorder,
    ) -> None:
        self.system, self.recorder, self.monitored, self.times = system, recorder, monitored, start.times
        self.dt, self.points = options["DT"], 2 * (options["POINTS"] // 2)
        self.laws = system.structure.laws
        self.states = list(start.states)
        self.branches = [s.branch(x) for s, x in zip(self.laws, self.states)]
        self.tracker = ResponseTracker(system, len(monitored.names))
        self.t, self.u, self.v = float(start.times[0]), start.u.copy(), start.v.copy()
        self.works = start.works.copy()
        self.rows = np.vstack([system.law_rows, monitored.rows])
        self.row_inputs = np.vstack([system.law_inputs, monitored.input_rows])
        self.row_constants = np.concatenate([np.zeros(len(self.laws)), monitored.constants])
        self.largest = np.zeros((2, len(self.laws)))
        self.heavy, self.light = np.flatnonzero(~massless(system.mass)), light(system)
        self.events = self.transforms = self.same_instant = 0
        self.held, self.put_in = energy_at_start(system, start), 0.0
        self.s = (DAMPING + 2j * np.pi * np.arange(self.points // 2 + 1)) / (self.points * self.dt)
        self._decompositions: dict[tuple[float, ...], tuple[StateSpace, float, Complex]] = {}

    def run(self) -> Outcome:
        """Integrate to the last output time."""
        self.tracker.begin(self.system, self.t, self.u, self.v, self.branches)
        first, end = True, float(self.times[-1])
        while first or end - self.t > 1e-12 * max(1.0, end):
            self._piece(end, first)
            first = False
        return self.outcome()

    def _matrices(self) -> tuple[Array, Array, Array]:
        """Damping, stiffness and constant forces on the present branches."""
        system, b = self.system, self.system.law_rows
        k, c, f0 = (
            np.array([getattr(x, name) for x in self.branches])
            for name in ("stiffness", "damping", "force0")
        )
        return (
            system.damping + (b.T * c) @ b,
            system.stiffness + (b.T * k) @ b,
            system.constant - b.T @ f0,
        )

    def _decomposition(self, c: Array, k: Array) -> tuple[StateSpace, float, Complex]:
        """First-order form, fastest rate, and 1/D(s) at all frequencies, of a set of branches."""
        key = tuple(x for b in self.branches for x in (b.stiffness, b.damping))
        if key not in self._decompositions:
            try:
                space = state_space(self.system.mass, c, k)
            except Mechanism as err:
                name = self.system.name(int(np.argmax(np.abs(err.shape))))
                raise self.stop("A501", f"{name} has no mass and nothing holds it") from None
            fastest = float(np.abs(np.linalg.eigvals(space.a)).max(initial=0.0))
            if fastest * self.dt > 1.0:
                why = "DT={:g} does not resolve the fastest mode, {:.4g} rad per unit of time: {:.3g} does"
                raise self.stop("A502", why.format(self.dt, fastest, 0.5 / fastest))
            s = self.s[:, None, None]
            self._decompositions[key] = space, fastest, np.linalg.inv(s * s * self.system.mass + s * c + k)
        return self._decompositions[key]

    def _transform(self) -> Complex:
        """Transform of the inputs from now on, shape (n_frequencies, n_inputs)."""
        ex, s = self.system.excitation, self.s
        out = np.zeros((len(s), ex.coefs.shape[2]), complex)
        begin, end = self.t, self.t + self.points * self.dt
        first = ex.piece(begin + 1e-13 * max(1.0, begin))
        stop = int(np.searchsorted(ex.breaks[:-1], end))
        left, right = (
            np.maximum(begin, ex.breaks[first:stop]),
            np.minimum(end, ex.breaks[first + 1 : stop + 1]),
        )
        coefs = ex.coefs[first:stop]
        if stop > first:
            coefs = np.concatenate([ex.local(first, begin)[None], coefs[1:]])
        # pieces of one length in a row differ by a delay and by their coefficients
        width = right - left
        close = 1e-11 * width[1:] + 4.0 * np.spacing(right[1:])
        edges = np.flatnonzero(np.abs(np.diff(width)) > close) + 1
        for run in np.split(np.arange(len(width)), edges):
            if not len(run) or width[run[0]] <= 0.0:
                continue
            length = float(width[run[0]])
            powers = length ** np.arange(1, ex.degree + 2)
            kernels = phi.moments(-s * length, ex.degree) * powers[:, None]
            delays = np.exp(-s[:, None] * length * np.arange(min(TOGETHER, len(run))))
            for i in range(0, len(run), TOGETHER):
                own = coefs[run[i : i + TOGETHER]]
                sums = (delays[:, : len(own)] @ own.reshape(len(own), -1)).reshape(len(s), *own.shape[1:])
                later = np.exp(-s * (left[run[i]] - begin))[:, None]
                out += later * np.einsum("js,sjn->sn", kernels, sums)
        # beyond its end the excitation stands still: a jump there would be felt before it
        last = float(ex.breaks[-1])
        if last < end:
            out += (np.exp(-s * (last - begin)) / s)[:, None] * ex.value(last)
        return out

    def _response(self) -> tuple[Array, Array]:
        """Displacements and velocities at the samples of the half window, shape (n, n_samples)."""
        system, s, half = self.system, self.s, self.points // 2
        c, k, constant = self._matrices()
        space, beta, inverse = self._decomposition(c, k)
        ex = system.excitation
        coefs = ex.local(ex.piece(self.t + 1e-13 * max(1.0, self.t)), self.t)
        # derivatives at the start, from the first-order form
        z = space.z_u @ self.u + space.z_v @ self.v
        derivatives, force = [], np.zeros(system.size)
        for j in range(STARTS + 1):
            force = math.factorial(j) * system.inputs @ coefs[j] if j < len(coefs) else 0.0 * force
            force = force + constant * (j == 0)
            follow = 0.0 if space.u_p is None else space.u_p @ force
            derivatives.append(space.u_z @ z + follow)
            z = space.a @ z + space.b @ force
        beta = max(beta, self.s[0].real)  # free bodies have no rate: that of the window
        q = np.array(
            [
                sum(
                    beta ** (j - i) / math.factorial(j - i) / math.factorial(i) * derivatives[i]
                    for i in range(j + 1)
                )
                for j in range(STARTS + 1)
            ]
        )
        right = self._transform() @ system.inputs.T + constant / s[:, None]
        right += s[:, None] * (system.mass @ derivatives[0]) + system.mass @ self.v + c @ derivatives[0]
        start = sum(math.factorial(j) * q[j] / (s[:, None] + beta) ** (j + 1) for j in range(STARTS + 1))
        rest = (inverse @ right[:, :, None])[:, :, 0] - start
        t = self.dt * np.arange(half + 1)
        grow = np.exp(DAMPING / (self.points * self.dt) * t) / self.dt
        decay, powers = np.exp(-beta * t), t ** np.arange(STARTS + 1)[:, None]
        slopes = powers[:-1] * np.arange(1, STARTS + 1)[:, None]
        u = np.fft.irfft(rest.T, self.points)[:, : half + 1] * grow + (q.T @ powers) * decay
        v = np.fft.irfft(s * rest.T, self.points)[:, : half + 1] * grow
        v += (q[1:].T @ slopes - beta * q.T @ powers) * decay
        u[:, 0], v[:, 0] = derivatives[:2]  # known: the branches of the laws hang on them
        self.transforms += 1
        return u, v

    def _acceleration(self, u: Array, v: Array, s: Array) -> Array:
        """From the equations of motion, at instants that are columns."""
        c, k, constant = self._matrices()
        out, h = np.zeros_like(u), self.heavy
        force = (self.system.inputs @ s - c @ v - k @ u) + constant[:, None]
        out[h] = np.linalg.solve(self.system.mass[np.ix_(h, h)], force[h])
        return out

    def _piece(self, end: float, first: bool) -> None:
        """Go on to the next event, to the middle of the window, or to the end."""
        ex = self.system.excitation
        u, v = self._response()
        count = min(u.shape[1], int(np.ceil((end - self.t) / self.dt * (1 - 1e-12))) + 1)
        t = self.dt * np.arange(count)
        u, v = u[:, :count], v[:, :count]
        inputs = [ex.values(self.t + t, order).T for order in range(3)]
        a = self._acceleration(u, v, inputs[0])
        value, rate, second = (self.rows @ x + self.row_inputs @ s for x, s in zip((u, v, a), inputs))
        value += self.row_constants[:, None]
        if not np.isfinite(value).all():
            raise self.stop("A504", "the motion grew beyond all numbers")
        seen = Samples(t, value, rate, second)
        span = min(float(t[-1]), end - self.t)
        event = self._first_event(seen)
        tau = span if event is None or event[0] >= span else event[0]

        def within(x: Array, slope: Array, at: float) -> tuple[Array, Array]:
            i = min(int(at / self.dt), count - 2)
            return hermite(self.dt, at - i * self.dt, x[:, i : i + 2].T, slope[:, i : i + 2].T)

        out = self.times[(self.times > self.t) & (self.times <= self.t + tau * (1 + 1e-13))]
        done, at = self.works, 0.0
        if first:
            self._hand_out(self.t, u[:, 0], v[:, 0], a[:, 0], done)
        for goal in out.tolist():
            done = done + self._work(at, goal - self.t, u, v, a)
            at = goal - self.t
            now, speed = within(u, v, at)[0], within(v, a, at)[0]
            bend = self._acceleration(now[:, None], speed[:, None], ex.value(goal)[:, None])[:, 0]
            self._hand_out(goal, now, speed, bend, done)
        self.works = done + self._work(at, tau, u, v, a)
        ends = within(value, rate, tau)[0], within(rate, second, tau)[0], within(rate, second, tau)[1]
        self._peaks(seen.until(tau, ends))
        self.u, self.v = within(u, v, tau)[0], within(v, a, tau)[0]
        self.same_instant = self.same_instant + 1 if tau <= 1e-12 * max(1.0, self.t) else 0
        self.t += tau
        if event is not None and event[0] < span:
            self._switch(event[1], event[2], float(ends[0][event[1]]), float(ends[1][event[1]]))
        self.put_in += abs(float(self.works[0] - done[0]))
        kinetic = 0.5 * float(self.v @ self.system.mass @ self.v)
        if not kinetic <= 10.0 * (self.held + self.put_in + abs(float(self.works[0]))) + 1e-300:
            why = f" as samples {self.dt:g} apart see it: is DT too long for the excitation?"
            raise self.stop("A504", RUNAWAY.format(kinetic) + why)

    def _first_event(self, seen: Samples) -> tuple[float, int, int] | None:
        watched, pairs = exits(self.branches, {})
        found = watched.first_rise(seen, self.largest, STILL) if pairs else None
        return None if found is None else (found[0], *pairs[found[1]])

    def _switch(self, law: int, exit_index: int, d: float, v: float) -> None:
        before = self.branches[law].kind
        self.states[law] = self.laws[law].law.transition(self.states[law], exit_index, d, v)
        after = self.branches[law] = self.laws[law].branch(self.states[law])
        force = self.laws[law].force(self.states[law], d, 0.0 if self.light[law] else v)
        self.events += 1
        self.tracker.switched(law, before, after.kind, self.t, d, v, force)
        self.tracker.peaks.force[law].take(force, self.t)
        if self.same_instant > 50 + 4 * len(self.laws):
            s = self.laws[law]
            why = CHATTER.format(self.same_instant, s.element, s.rule, after.name, "EXACT")
            raise self.stop("A503", why)

    def _work(self, begin: float, end: float, u: Array, v: Array, a: Array) -> Array:
        """Work put in and lost in dashpots between two local times, shape (3,), by Simpson's rule
        over the samples' cubics; losses and impulses of the laws are noted.
        """
        if end <= begin:
            return np.zeros(3)
        h, system = self.dt, self.system
        inner = h * np.arange(math.floor(begin / h) + 1, math.ceil(end / h))
        ends = np.concatenate([[begin], inner[(inner > begin) & (inner < end)], [end]])
        width = np.diff(ends)
        t = np.append(np.column_stack([ends[:-1], ends[:-1] + 0.5 * width]).ravel(), end)
        weight = np.zeros(len(t))
        weight[:-1:2] += width / 6
        weight[1::2] += 4 * width / 6
        weight[2::2] += width / 6
        i = np.minimum((t / h).astype(int), u.shape[1] - 2)
        x = t - i * h
        place = hermite(h, x, np.stack([u[:, i], u[:, i + 1]]), np.stack([v[:, i], v[:, i + 1]]))[0]
        speed = hermite(h, x, np.stack([v[:, i], v[:, i + 1]]), np.stack([a[:, i], a[:, i + 1]]))[0]
        s, ds = (system.excitation.values(self.t + t, order).T for order in (0, 1))
        d, rate = system.law_rows @ place + system.law_inputs @ s, system.law_rows @ speed
        rate = rate + system.law_inputs @ ds
        power = ((system.inputs @ s + system.constant[:, None]) * speed).sum(axis=0)
        damping, lost = float((speed * (system.damping @ speed)).sum(axis=0) @ weight), 0.0
        for law, branch in enumerate(self.branches):
            loss = float(branch.damping * rate[law] ** 2 @ weight)
            self.tracker.peaks.dashpot_losses[law] += loss
            if self.laws[law].role.contact_energy:
                lost += loss
            else:
                damping += loss
            if law in self.tracker.open:
                force = branch.stiffness * d[law] + branch.damping * rate[law] + branch.force0
                self.tracker.open[law].impulse += float(force @ weight)
        return np.array([float(power @ weight), damping, lost])

    def _peaks(self, seen: Samples) -> None:
        n = len(self.laws)
        both = np.abs([seen.value[:n, 0], seen.rate[:n, 0]]).max(axis=2)
        np.maximum(self.largest, both, out=self.largest)
        watched, kept = followed(self.tracker, self.branches, {})
        grid.widen(kept, self.t, seen.t, *watched.of(seen), watched.at(seen))
        for i, collision in self.tracker.open.items():
            self.tracker.peaks.force[i].take(collision.peak, collision.t_peak)

    def _hand_out(self, t: float, u: Array, v: Array, a: Array, works: Array) -> None:
        at, (u, v, a) = np.array([t]), np.stack([u, v, a])[:, :, None]
        laws = law_values(self.system, at, u, v, self.states)
        self.recorder.sample(at, u, v, a, laws, works[:, None])

    def outcome(self) -> Outcome:
        """What the run gathered."""
        figures = {
            "method": f"LAPLACE, {self.points} samples {self.dt:g} apart",
            "events": self.events,
            "transforms": self.transforms,
            "linear regimes": len(self._decompositions),
        }
        peaks = self.tracker.close()
        checks = rounding_check(self.laws, peaks, STILL)
        return Outcome(peaks, figures, tuple(self.states), checks)

    def stop(self, code: str, why: str) -> Stop:
        """The exception that ends the run here."""
        return Stop(code, self.t, why, self.outcome())


def integrate(
    system: ReducedSystem,
    start: Start,
    monitored: MonitoredOutputs,
    options: Mapping[str, Any],
    recorder: Recorder,
) -> Outcome:
    """Integrate a reduced system by numerical Laplace transforms; see the module's head.

    Raises
    ------
    Stop
        A reduced system that is not piecewise linear or whose supports move apart from each other, a DT
        that does not resolve it, a mechanism, numbers beyond all bounds, or an interrupt.
    """
    refuse_rigid(system, start, "LAPLACE")
    if why := not_linear(system) or ("the supports move apart from each other" if system.total else ""):
        raise Stop("A505", float(start.times[0]), f"LAPLACE cannot take this: {why}; AUTO can")
    system, start, monitored, recorder = condensed(system, start, monitored, recorder, "LAPLACE")
    run = Laplace(system, start, monitored, options, recorder)
    try:
        return run.run()
    except KeyboardInterrupt:
        raise run.stop("A506", INTERRUPTED) from None


SPEC = Spec(
    "method",
    "LAPLACE",
    "numerical Laplace transform between events",
    (
        Field("DT", Kind.REAL, "T", above=0, doc="distance of the samples"),
        Field("POINTS", Kind.INT, default=4096, lo=16, hi=1_000_000, doc="samples in one transform"),
    ),
    reference="after Chouw 2002; Wilcox 1978",
    impl=integrate,
)
