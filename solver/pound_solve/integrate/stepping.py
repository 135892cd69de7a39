r"""Step-by-step integration with events located within the step: what NEWMARK and CENTRAL share.

Newmark's family with parameters :math:`\beta, \gamma`:

.. math::
    u_1 = u_0 + h v_0 + h^2[(\tfrac12-\beta) a_0 + \beta a_1], \qquad
    v_1 = v_0 + h[(1-\gamma) a_0 + \gamma a_1]

with equilibrium at the end of the step.  Between events the scene is linear, so a step needs no iteration.
When an exit of a law is passed within a step, the step is taken again, shorter, so that it ends
on the exit (to 1e-12 of the step), the law changes branch, the acceleration is made consistent,
and the rest of the step follows.

Energies are integrated from velocities taken as straight lines over a step,
not by the trapezoid rule of the method itself, which would balance for any step, right or wrong.

References
----------
Newmark NM (1959), A method of computation for structural dynamics, J. Engng Mech. Div. ASCE 85(EM3): 67-94.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.base import (
    INTERRUPTED,
    RUNAWAY,
    Ledger,
    Outcome,
    Sink,
    Start,
    Stop,
    Watch,
    cubic_top,
    energies,
    goals,
)
from pound_solve.laws import Branch
from pound_solve.modes import massless
from pound_solve.scene import Scene

Array = NDArray[np.float64]
Motion = tuple[Array, Array, Array]  #: displacement, velocity, acceleration

STILL = 1e-12  #: share of its largest value below which an exit counts as not reached


class Stepper:
    """One run of a Newmark method; see the module's head.

    Parameters
    ----------
    scene, start, watch, sink
        See `integrate.base`.
    dt : float
        Longest step [T]; every interval between output times and record points is divided evenly.
    beta, gamma : float
    name : str
        For the report.
    """

    def __init__(
        self,
        scene: Scene,
        start: Start,
        watch: Watch,
        sink: Sink,
        dt: float,
        beta: float,
        gamma: float,
        name: str,
    ) -> None:
        self.scene, self.watch, self.sink, self.dt, self.beta, self.gamma, self.name = (
            scene,
            watch,
            sink,
            dt,
            beta,
            gamma,
            name,
        )
        self.laws = scene.structure.laws
        self.states = list(start.states)
        self.branches: list[Branch] = [s.branch(x) for s, x in zip(self.laws, self.states)]
        self.times = start.times
        self.light = massless(scene.mass)
        self.heavy = ~self.light
        self.t, self.u, self.v = 0.0, start.u.copy(), start.v.copy()
        self.a = np.zeros_like(self.u)
        self.ledger = Ledger(scene, len(watch.names))
        self.steps = self.events = self.same_instant = 0
        self.works = np.zeros(3)  # input, dashpots of the structure, dashpots of contacts
        self.largest = np.zeros((2, len(self.laws)))
        self.held = self.put_in = 0.0  # energy at the start, sum of all |input| since
        self._maps: dict[tuple[Any, ...], Array] = {}
        self._noted: tuple[Array, Array] = (np.zeros(0), np.zeros(0))
        self._regime()

    def _regime(self) -> None:
        scene = self.scene
        ks = np.array([b.stiffness for b in self.branches])
        cs = np.array([b.damping for b in self.branches])
        self.law_k, self.law_c, self.law_f0 = ks, cs, np.array([b.force0 for b in self.branches])
        rows = scene.law_rows
        self.k = scene.stiffness + (rows.T * ks) @ rows
        self.c = scene.damping + (rows.T * cs) @ rows if cs.any() else scene.damping
        self.key = (ks.tobytes(), cs.tobytes())
        pairs = [(i, e) for i, b in enumerate(self.branches) for e in range(len(b.exits))]
        self.exit_pairs = pairs
        self.exit_law = np.array([i for i, _ in pairs], np.intp)
        self.exit_factors = np.array([self.branches[i].exits[e] for i, e in pairs]).reshape(-1, 3)

    def force(self, t: float) -> Array:
        """Load on the unknowns in the present regime: inputs, constant loads, constants of the laws."""
        scene = self.scene
        p = scene.inputs @ scene.excitation.value(t) + scene.constant
        if len(self.laws):
            known = self.law_f0
            if scene.total:
                known = known + self.law_k * (scene.law_inputs @ scene.excitation.value(t))
                known = known + self.law_c * (scene.law_inputs @ scene.excitation.value(t, 1))
            p = p - scene.law_rows.T @ known
        return p

    def settle(self) -> None:
        """Make the acceleration (and the velocity of damped massless freedoms)
        consistent with the present regime.
        """
        h, z = self.heavy, self.light
        force = self.force(self.t) - self.k @ self.u
        if z.any():
            czz = self.c[np.ix_(z, z)]
            if czz.any():
                back = np.linalg.pinv(czz, rcond=1e-12)
                old = self.v[z]
                self.v[z] = back @ (force[z] - self.c[np.ix_(z, h)] @ self.v[h]) + old - back @ (czz @ old)
            self.a[z] = 0.0
        force = force - self.c @ self.v
        self.a[h] = np.linalg.solve(self.scene.mass[np.ix_(h, h)], force[h])

    def step(self, h: float, keep: bool) -> Motion:
        """Return the motion one step `h` on; `keep` the inverse for the next step of this length."""
        u, v, b, g = self.u, self.v, self.beta, self.gamma
        # the acceleration is the unknown: a remainder of a step, however short, divides nothing by h^2
        ahead = u + h * v + h * h * (0.5 - b) * self.a
        faster = v + (1 - g) * h * self.a
        rhs = self.scaled(self.force(self.t + h) - self.k @ ahead - self.c @ faster, h)
        inverse = self._maps.get((self.key, h)) if keep else None
        if inverse is None:
            matrix = self.scaled(self.scene.mass + g * h * self.c + b * h * h * self.k, h)
            if keep:
                inverse = self._maps[self.key, h] = np.asarray(np.linalg.inv(matrix), float)
        a1 = np.asarray(np.linalg.solve(matrix, rhs), float) if inverse is None else inverse @ rhs
        return ahead + b * h * h * a1, faster + g * h * a1, a1

    def scaled(self, rows: Array, h: float) -> Array:
        """Multiply the rows of massless freedoms so that they weigh as much as the others."""
        if self.light.any():
            rows = rows.copy()
            rows[self.light] *= 1.0 / (self.beta * h * h)
        return rows

    def deformations(self, t: float, u: Array, v: Array) -> tuple[Array, Array]:
        """Deformation and rate of every law."""
        scene = self.scene
        d, rate = scene.law_rows @ u, scene.law_rows @ v
        if scene.total:
            d = d + scene.law_inputs @ scene.excitation.value(t)
            rate = rate + scene.law_inputs @ scene.excitation.value(t, 1)
        return d, rate

    def run(self) -> Outcome:
        """Integrate to the last output time.

        Raises
        ------
        Stop
            Too many changes within one step, numbers beyond all bounds, or an interrupt.
        """
        try:
            return self._run()
        except KeyboardInterrupt:
            raise self.stop("A506", INTERRUPTED) from None

    def _run(self) -> Outcome:
        d, v = self.deformations(0.0, self.u, self.v)
        for i, s in enumerate(self.laws):
            if s.is_contact and self.branches[i].name == "pressed":
                at, rate = float(d[i]), float(v[i])
                self.ledger.switched(i, "open", "pressed", 0.0, at, rate, self.branches[i].force(at, rate))
        self.settle()
        self._note()
        self._sample(0.0)
        first = energies(
            self.scene, np.zeros(1), self.u[None], self.v[None], [self.states], self.works[None]
        )
        self.held = float(first[0, 1] + first[0, 2])
        with np.errstate(over="ignore", invalid="ignore"):  # a runaway is told in words
            for goal, is_output in zip(*goals(self.scene, self.times)):
                n = max(1, int(np.ceil((goal - self.t) / self.dt * (1 - 1e-9))))
                # twelve digits: steps of equal length share their inverse,
                # whatever the rounding of the times
                h = float(f"{(goal - self.t) / n:.12e}")
                for i in range(n):
                    self._advance(h if i < n - 1 else float(goal) - self.t, h)
                self.t = float(goal)
                self._check()
                if is_output:
                    self._sample(self.t)
        return self.outcome()

    def _check(self) -> None:
        """Stop a runaway: motion cannot hold more than it started with and what was put in."""
        kinetic = 0.5 * float(self.v @ self.scene.mass @ self.v)
        if not np.isfinite(self.u).all() or not kinetic <= 10.0 * (self.held + self.put_in) + 1e-300:
            raise self.stop(
                "A504",
                RUNAWAY.format(kinetic),
            )

    def _advance(self, length: float, nominal: float) -> None:
        """Advance by one nominal step, in pieces where events cut it."""
        left = length
        whole = True
        while left > 0.0:
            h = nominal if whole else left
            new = self.step(h, keep=whole)
            event = self._event(h, new) if len(self.exit_pairs) else None
            if event is None:
                self._accept(h, new)
                self.t += left
                self.same_instant = 0
                self._note(h)
                return
            tau, new, law, exit_index = event
            self._accept(tau, new)
            self.t += tau
            left -= tau
            whole = False
            self._note(tau)
            self._switch(law, exit_index)

    def _exits(self, t: float, motion: Motion) -> tuple[Array, Array]:
        """Values and slopes of all exits."""
        u, v, a = motion
        d, rate = self.deformations(t, u, v)
        second = self.scene.law_rows @ a
        if self.scene.total:
            second = second + self.scene.law_inputs @ self.scene.excitation.value(t, 2)
        k = self.exit_law
        fd, fv, c = self.exit_factors.T
        return fd * d[k] + fv * rate[k] + c, fd * rate[k] + fv * second[k]

    def _event(self, h: float, new: Motion) -> tuple[float, Motion, int, int] | None:
        g0, s0 = self._exits(self.t, (self.u, self.v, self.a))
        g1, s1 = self._exits(self.t + h, new)
        fd, fv, c = np.abs(self.exit_factors).T
        tol = STILL * np.maximum(
            fd * self.largest[0, self.exit_law] + fv * self.largest[1, self.exit_law] + c, np.abs(g1)
        )
        g0 = np.minimum(g0, 0.0)  # a branch holds when it is entered
        crossed = g1 > tol
        with np.errstate(divide="ignore", invalid="ignore"):
            x = (g1 - g0 - s1 * h) / (s0 - s1)
            turn = ~crossed & (s0 > 0) & (s1 < 0) & (g0 + s0 * x > tol)
        best: tuple[float, Motion, int, int] | None = None
        for n in np.flatnonzero(crossed | turn):
            high = h
            if not crossed[n]:
                top = h * s0[n] / (s0[n] - s1[n])
                if self._exits(self.t + top, self.step(top, keep=False))[0][n] <= tol[n]:
                    continue
                high = top
            tau, motion = self._locate(int(n), high, float(g0[n]), float(s0[n]))
            if best is None or tau < best[0]:
                best = (tau, motion, *self.exit_pairs[n])
        return best

    def _locate(self, n: int, high: float, g_low: float, s_low: float) -> tuple[float, Motion]:
        """Step length at which exit `n` is reached: Illinois regula falsi on the length of the step."""
        low, span = 0.0, high
        motion = self.step(high, keep=False)
        g_high = float(self._exits(self.t + high, motion)[0][n])
        if g_low == 0.0 and s_low < 0.0:  # it falls from zero first: find where it is below
            x = high
            for _ in range(50):
                x *= 0.5
                g = float(self._exits(self.t + x, self.step(x, keep=False))[0][n])
                if g < 0.0:
                    low, g_low = x, g
                    break
        side = 0
        for _ in range(100):
            if high - low <= 1e-12 * span:
                break
            x = (g_low * high - g_high * low) / (g_low - g_high) if g_low < 0.0 else 0.5 * (low + high)
            if not low < x < high:
                break
            trial = self.step(x, keep=False)
            g = float(self._exits(self.t + x, trial)[0][n])
            if g >= 0.0:
                high, g_high, motion = x, g, trial
                if side == 1:
                    g_low *= 0.5
                side = 1
            else:
                low, g_low = x, g
                if side == -1:
                    g_high *= 0.5
                side = -1
            if abs(g) == 0.0:
                break
        return high, motion

    def _switch(self, law: int, exit_index: int) -> None:
        d, v = self.deformations(self.t, self.u, self.v)
        before = self.branches[law].name
        self.states[law] = self.laws[law].law.leave(self.states[law], exit_index, float(d[law]))
        after = self.branches[law] = self.laws[law].branch(self.states[law])
        self.ledger.switched(
            law,
            before,
            after.name,
            self.t,
            float(d[law]),
            float(v[law]),
            after.force(float(d[law]), float(v[law])),
        )
        self.events += 1
        self.same_instant += 1
        if self.same_instant > 100 + 8 * len(self.laws):
            s = self.laws[law]
            raise self.stop(
                "A503",
                f"{self.same_instant} changes within one step, "
                f"the last in element {s.element} ({s.rule}): {before} to {after.name}",
            )
        self._regime()
        self.settle()
        self._note()

    def _accept(self, h: float, new: Motion) -> None:
        u, v, a = new
        s = self.scene
        if h > 0.0:
            before = float(self.works[0])
            if s.total:
                self._total_work(h, new)
            else:
                p0 = s.inputs @ s.excitation.value(self.t) + s.constant
                p1 = s.inputs @ s.excitation.value(self.t + h) + s.constant
                self.works[0] += h / 6 * float((2 * p0 + p1) @ self.v + (p0 + 2 * p1) @ v)
                c0 = s.damping @ self.v
                self.works[1] += h / 3 * float(c0 @ self.v + c0 @ v + v @ s.damping @ v)
            self.put_in += abs(float(self.works[0]) - before)
            rate0, rate1 = s.law_rows @ self.v, s.law_rows @ v
            if self.law_c.any():
                loss = h / 3 * self.law_c * (rate0 * rate0 + rate0 * rate1 + rate1 * rate1)
                self.works[2] += float(loss.sum())
                for law in np.flatnonzero(loss).tolist():
                    self.ledger.peaks.dashpot_losses[law] += float(loss[law])
            if self.ledger.open:
                f0 = self._law_forces(self.t, self.u, self.v)
                f1 = self._law_forces(self.t + h, u, v)
                for law, collision in self.ledger.open.items():
                    collision.impulse += 0.5 * h * float(f0[law] + f1[law])
        self.u, self.v, self.a = u, v, a
        self.steps += 1

    def _total_work(self, h: float, new: Motion) -> None:
        """Input (power of the supports' reactions) and dashpot work of a step
        in the total form, by the trapezoid.
        """
        scene, s = self.scene, self.scene.structure
        n = s.n_free
        for t, motion in ((self.t, (self.u, self.v, self.a)), (self.t + h, new)):
            u, v, a = (scene.all_freedoms(x, t, order) for order, x in enumerate(motion))
            force = (
                s.stiffness @ u
                + s.damping @ v
                + s.mass @ a
                + s.law_rows.T @ self._law_forces(t, motion[0], motion[1])
            )
            self.works[0] += 0.5 * h * float(force[n:] @ v[n:] + s.loads[:n] @ v[:n])
            self.works[1] += 0.5 * h * float(v @ s.damping @ v)

    def _law_forces(self, t: float, u: Array, v: Array) -> Array:
        d, rate = self.deformations(t, u, v)
        return self.law_k * d + self.law_c * rate + self.law_f0

    def _watched(self) -> tuple[Array, Array, Array]:
        """Values and slopes of all quantities whose peaks are kept: drifts, deformations,
        contact forces; law rates.
        """
        w, s = self.watch, self.scene
        value, slope = w.rows @ self.u + w.constants, w.rows @ self.v
        if s.total:
            value = value + w.input_rows @ s.excitation.value(self.t)
            slope = slope + w.input_rows @ s.excitation.value(self.t, 1)
        d, rate = self.deformations(self.t, self.u, self.v)
        force, change = self.law_k * d + self.law_c * rate + self.law_f0, self.law_k * rate
        if self.law_c.any():
            second = s.law_rows @ self.a
            if s.total:
                second = second + s.law_inputs @ s.excitation.value(self.t, 2)
            change = change + self.law_c * second
        np.maximum(self.largest, np.abs([d, rate]), out=self.largest)
        return np.concatenate([value, d, force]), np.concatenate([slope, rate, change]), rate

    def _note(self, since: float = 0.0) -> None:
        """Count the present motion into the peaks; `since` the last note
        on the same branches, turning points too.
        """
        value, slope, _ = self._watched()
        for i, x in enumerate(value.tolist()):
            self._take(i, x, self.t)
        if since > 0.0:
            f0, s0 = self._noted
            for i in np.flatnonzero(s0 * slope < 0).tolist():
                sign = 1.0 if s0[i] > 0 else -1.0
                x, top = cubic_top(sign * f0[i], sign * value[i], sign * s0[i], sign * slope[i], since)
                self._take(i, sign * top, self.t - since + x)
        self._noted = value, slope

    def _take(self, i: int, value: float, t: float) -> None:
        peaks, n_watch, n = self.ledger.peaks, len(self.watch.names), len(self.laws)
        if i < n_watch:
            peaks.watch[i].take(value, t)
        elif i < n_watch + n:
            peaks.deformation[i - n_watch].take(value, t)
        else:
            law = i - n_watch - n
            peaks.force[law].take(value, t)
            if law in self.ledger.open:
                self.ledger.force(law, value, t)

    def _sample(self, t: float) -> None:
        self.sink.sample(
            t, self.u.copy(), self.v.copy(), self.a.copy(), tuple(self.states), self.works.copy()
        )

    def outcome(self) -> Outcome:
        """What the run gathered."""
        figures = {
            "method": self.name,
            "time step": f"{self.dt:.6g}",
            "steps": self.steps,
            "events": self.events,
        }
        return Outcome(self.ledger.close(), figures)

    def stop(self, code: str, why: str) -> Stop:
        """The exception that ends the run here."""
        return Stop(code, self.t, why, self.outcome())
