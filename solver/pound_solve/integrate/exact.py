r"""EXACT: event-driven integration without a time step.

Between events (a spring yields or unloads, a contact closes or opens) the scene is linear and its motion under
piecewise-polynomial excitation is known in closed form (:mod:`~pound_solve.integrate.flow`).  So only the event
times need finding: the exits of all laws are sampled with their slopes on a grid that resolves the fastest
mode, bracketed by value and by slope (two crossings within one interval), and polished by safeguarded Newton to
the last digits.  Peaks of drifts, spring deformations and contact forces are found the same way.

Parts of the structure that no closed contact joins are solved apart, each with its own modes for each
combination of stiffnesses, kept for when it returns.

Energies are integrated independently of each other: the dashpots' work as the closed integral of
:math:`v^T C v`, the input as that of :math:`v^T p`, the plastic work from the laws' slip.  Their sum against kinetic and
strain energy is therefore a check of the whole integration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pound_deck.schema import Field, Kind, Spec

from pound_solve.integrate import work
from pound_solve.integrate.base import Ledger, Outcome, Sink, Start, Stop, Watch, cubic_top, stock
from pound_solve.integrate.flow import Mechanism, ModalFlow, SeriesFlow, make_flow, powers
from pound_solve.laws import Branch
from pound_solve.scene import Scene

Array = NDArray[np.float64]

MOST_POINTS = 256  #: grid points of one segment
GRID = 1.0  #: grid interval times the fastest eigenvalue
STILL = 1e-12  #: share of its largest value below which an exit counts as not reached


@dataclass
class Block:
    """A part of the scene that moves on its own."""

    key: tuple[Any, ...]
    index: NDArray[np.intp]  # its unknowns
    laws: NDArray[np.intp]  # laws that act within it
    flow: ModalFlow | SeriesFlow
    q: NDArray[Any]
    constant: Array
    watched: NDArray[np.intp]  # rows of all functionals that touch it
    place: list[int]  # of every functional among them, or -1
    rows: Array  # their part on the block's unknowns
    g: NDArray[Any]
    uv_rows: NDArray[Any]  # rows @ u_q above rows @ v_q
    p: Array | None = None  # force polynomials, (degree + 1, n), where the inputs alone do not tell them


class Exact:
    """One run; see the module's head."""

    def __init__(self, scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink) -> None:
        self.scene, self.watch, self.sink = scene, watch, sink
        self.refine = 2.0 ** -int(options.get("REFINE") or 0)
        self.laws = scene.structure.laws
        self.n_laws = len(self.laws)
        self.states = list(start.states)
        self.branches: list[Branch] = [s.law.branch(x) for s, x in zip(self.laws, self.states)]
        self.rows = np.vstack([scene.law_rows, watch.rows]) if self.n_laws else watch.rows
        self.row_inputs = np.vstack([scene.law_inputs, watch.input_rows]) if self.n_laws else watch.input_rows
        self.row_constants = np.concatenate([np.zeros(self.n_laws), watch.constants])
        self.known = bool(np.any(self.row_inputs))
        self.base = self._base_parts()
        self.flows: dict[tuple[Any, ...], tuple[ModalFlow | SeriesFlow, Any]] = {}
        self.blocks: list[Block] = []
        self.t = 0.0
        self.times = start.times
        self.ledger = Ledger(scene, len(watch.names))
        self.events = self.segments = self.same_instant = 0
        self.worst_residual = self.worst_condition = 0.0
        self.series_used = False
        self.damping_work = self.contact_work = self.input_work = 0.0
        self.largest = np.zeros((2, self.n_laws))  # |d|, |v| seen, the scale of the exits
        self.u, self.v = start.u.copy(), start.v.copy()

    # ------------------------------------------------------------------ parts and their flows

    def _base_parts(self) -> NDArray[np.intp]:
        """Label the unknowns by what hangs together with all contacts open, shape (n,)."""
        scene, n = self.scene, self.scene.size
        linked = (scene.stiffness != 0) | (scene.damping != 0) | (scene.mass != 0)
        for s, row in zip(self.laws, scene.law_rows):
            if not s.is_contact:
                at = np.flatnonzero(row)
                linked[np.ix_(at, at)] = True
        labels = np.arange(n)
        while True:
            # every unknown takes the lowest label among its neighbours until nothing changes
            lowest = np.where(linked, labels[None, :], n).min(axis=1, initial=n)
            lowest = np.minimum(lowest, labels)
            if (lowest == labels).all():
                return labels
            labels = lowest

    def _regroup(self, fresh: bool = False) -> None:
        """Form the blocks that the present branches ask for; keep those that did not change."""
        scene = self.scene
        self._list_exits()
        labels = self.base.copy()
        for i, (s, b) in enumerate(zip(self.laws, self.branches)):
            if s.is_contact and (b.stiffness or b.damping):
                parts = np.unique(labels[scene.law_rows[i] != 0])
                if len(parts):
                    labels[np.isin(labels, parts)] = parts[0]
        old = {b.key: b for b in self.blocks}
        blocks = []
        acting = [i for i, b in enumerate(self.branches) if b.stiffness or b.damping or b.force0]
        for label in np.unique(labels):
            index = np.flatnonzero(labels == label)
            laws = np.array([i for i in acting if np.any(scene.law_rows[i, index])], np.intp)
            key = (int(label), len(index), *((int(i), self.branches[i].stiffness, self.branches[i].damping) for i in laws))
            constant = scene.constant[index] - scene.law_rows[np.ix_(laws, index)].T @ [self.branches[i].force0 for i in laws]
            block = old.get(key)
            if block is None or fresh:
                block = self._make_block(key, index, laws)
                block.q = block.flow.enter(self.u[index], self.v[index])
            block.constant = constant
            blocks.append(block)
        self.blocks = blocks

    def _make_block(self, key: tuple[Any, ...], index: NDArray[np.intp], laws: NDArray[np.intp]) -> Block:
        scene = self.scene
        if key not in self.flows:
            grid = np.ix_(index, index)
            b = scene.law_rows[np.ix_(laws, index)]
            k = scene.stiffness[grid] + (b.T * [self.branches[i].stiffness for i in laws]) @ b
            c = scene.damping[grid] + (b.T * [self.branches[i].damping for i in laws]) @ b
            try:
                flow = make_flow(scene.mass[grid], c, k, scene.inputs[index])
            except Mechanism as err:
                worst = index[int(np.argmax(np.abs(err.shape)))]
                raise self._stop("A501", f"{scene.name(int(worst))} has no mass and nothing holds it") from None
            self.worst_residual = max(self.worst_residual, flow.residual)
            self.worst_condition = max(self.worst_condition, flow.condition)
            self.series_used |= isinstance(flow, SeriesFlow)
            watched = np.flatnonzero(np.any(self.rows[:, index] != 0, axis=1))
            rows = self.rows[np.ix_(watched, index)]
            contact_rows = [(int(i), self.branches[i].damping, scene.law_rows[i, index]) for i in laws if self.branches[i].damping]
            meter = work.Meter(flow, scene.damping[grid], scene.inputs[index], contact_rows)
            self.flows[key] = (flow, (watched, rows, np.vstack([rows @ flow.u_q, rows @ flow.v_q]), meter))
        flow, (watched, rows, uv_rows, _) = self.flows[key]
        place = [-1] * len(self.rows)
        for i, row in enumerate(watched.tolist()):
            place[row] = i
        return Block(key, index, laws, flow, np.zeros(0), np.zeros(0), watched, place, rows, np.zeros(0), uv_rows)

    # ------------------------------------------------------------------ evaluation

    def _functionals(self, t: Array, samples: Sequence[NDArray[Any]], coefs: Array) -> tuple[Array, Array, Array]:
        """Value, rate and second rate of all rows at local times `t` from the blocks' q samples.

        The second rate is computed only where an exit or a dashpot of the present branches needs it.
        """
        value = np.repeat(self.row_constants[:, None], len(t), axis=1)
        rate, second = np.zeros_like(value), np.zeros_like(value)
        if self.known:
            offset = coefs @ self.row_inputs.T  # polynomials of what the inputs add, (degree + 1, n_rows)
            p = powers(t, len(coefs) - 1)
            value += np.einsum("kr,kt->rt", offset, p)
            for k in range(1, len(coefs)):
                rate += k * offset[k][:, None] * p[k - 1]
                if k > 1:
                    second += k * (k - 1) * offset[k][:, None] * p[k - 2]
        for block, q in zip(self.blocks, samples):
            w, n = block.watched, len(block.watched)
            both = (block.uv_rows @ q).real
            value[w] += both[:n]
            rate[w] += both[n:]
            if self.bending:
                second[w] += (block.uv_rows[n:] @ block.flow.rate(q, block.g, t)).real
            if block.p is not None and block.flow.u_p is not None:
                # forces move massless freedoms directly
                u_p, v_p = block.rows @ block.flow.u_p, block.rows @ block.flow.space.v_p
                force, slope, bend = (np.array([work.polynomial(block.p, x, order) for x in t]).T for order in (0, 1, 2))
                value[w] += u_p @ force
                rate[w] += v_p @ force + u_p @ slope
                second[w] += v_p @ slope + u_p @ bend
        return value, rate, second

    def _at(self, row: int, tau: float, coefs: Array) -> tuple[float, float, float]:
        """Value, rate and second rate of one row at one time: what polishing asks for again and again."""
        value, rate, second = float(self.row_constants[row]), 0.0, 0.0
        if self.known:
            offset = coefs @ self.row_inputs[row]
            value += float(work.polynomial(offset, tau))
            rate += float(work.polynomial(offset, tau, 1))
            second += float(work.polynomial(offset, tau, 2))
        for block in self.blocks:
            i = block.place[row]
            if i < 0:
                continue
            q = block.flow.at(block.q, block.g, tau)
            n = len(block.watched)
            value += (block.uv_rows[i] @ q).real
            rate += (block.uv_rows[n + i] @ q).real
            second += (block.uv_rows[n + i] @ block.flow.rate(q, block.g, tau)).real
            if block.p is not None and block.flow.u_p is not None:
                force, slope, bend = (work.polynomial(block.p, tau, order) for order in (0, 1, 2))
                u_p, v_p = block.rows[i] @ block.flow.u_p, block.rows[i] @ block.flow.space.v_p
                value += u_p @ force
                rate += v_p @ force + u_p @ slope
                second += v_p @ slope + u_p @ bend
        return float(value), float(rate), float(second)

    def _motion(self, tau: float, coefs: Array, samples: Sequence[NDArray[Any]] | None = None) -> tuple[Array, Array, Array]:
        """Displacement, velocity and acceleration of the unknowns at local time `tau`."""
        n = self.scene.size
        u, v, a = np.zeros(n), np.zeros(n), np.zeros(n)
        for i, block in enumerate(self.blocks):
            q = block.flow.at(block.q, block.g, tau) if samples is None else samples[i]
            qdot = block.flow.rate(q, block.g, tau)
            u[block.index] = (block.flow.u_q @ q).real
            v[block.index] = (block.flow.v_q @ q).real
            a[block.index] = (block.flow.v_q @ qdot).real
            if block.p is not None and block.flow.u_p is not None:
                force, slope, bend = (work.polynomial(block.p, tau, order) for order in (0, 1, 2))
                u_p, v_p = block.flow.u_p, block.flow.space.v_p
                u[block.index] += u_p @ force
                v[block.index] += v_p @ force + u_p @ slope
                a[block.index] += v_p @ slope + u_p @ bend
        return u, v, a

    # ------------------------------------------------------------------ the run

    def run(self) -> Outcome:
        """Integrate to the last output time."""
        scene = self.scene
        breaks = scene.excitation.breaks
        end = float(self.times[-1])
        for i, s in enumerate(self.laws):
            if s.is_contact and self.branches[i].name == "pressed":
                d, v = float(scene.law_rows[i] @ self.u), float(scene.law_rows[i] @ self.v)
                self.ledger.switched(i, "open", "pressed", 0.0, d, v, self.branches[i].force(d, v))
        self._regroup(fresh=True)
        self._enter_piece()
        self._sample(0.0)
        next_out = 1
        stops = np.unique(np.concatenate([breaks[(breaks > 0) & (breaks < end)], self.times[1:]]))
        cursor = 0
        while self.t < end:
            while cursor < len(stops) and stops[cursor] <= self.t:
                cursor += 1
            goal = float(stops[cursor])
            reached = self._segment(goal)
            if reached and next_out < len(self.times) and goal >= self.times[next_out]:
                self.t = goal
                self._sample(goal)
                next_out += 1
        return self.outcome()

    def _enter_piece(self) -> Array:
        """Local coefficients of the excitation from now on, and the blocks' forcing."""
        ex = self.scene.excitation
        # a hair beyond, so that rounding never puts us on the piece that has just ended
        coefs = ex.local(ex.piece(self.t + 1e-13 * max(1.0, abs(self.t))), self.t)
        self._force(coefs)
        return coefs

    def _force(self, coefs: Array) -> None:
        for block in self.blocks:
            if not self.scene.total and block.flow.u_p is None:
                block.g = block.flow.forcing(coefs, block.constant)
                continue
            p = coefs @ block.flow.inputs.T
            p[0] += block.constant
            block.p = p + self._supports(block, coefs)
            block.g = block.flow.push(block.p)

    def _supports(self, block: Block, coefs: Array) -> Array:
        """Forces of laws that reach to moved supports, whose deformation has a known part, (degree + 1, n)."""
        scene = self.scene
        e = coefs @ scene.law_inputs[block.laws].T  # (degree + 1, n_laws)
        rate = np.zeros_like(e)
        rate[:-1] = e[1:] * np.arange(1, len(e))[:, None]
        k = np.array([self.branches[i].stiffness for i in block.laws])
        c = np.array([self.branches[i].damping for i in block.laws])
        return -(e * k + rate * c) @ scene.law_rows[np.ix_(block.laws, block.index)]

    def _segment(self, goal: float) -> bool:
        """Advance to `goal` or to the first event before it; tell whether the goal was reached."""
        coefs = self._enter_piece()
        # twelve digits: segments of equal length share their exponentials, whatever the rounding of the times
        length = float(f"{goal - self.t:.12e}")
        fastest = max(b.flow.fastest for b in self.blocks) if self.blocks else 0.0
        # grid steps are powers of two of a second, so that tables of exponentials are found again
        h = 2.0 ** np.floor(np.log2(GRID * self.refine / fastest)) if fastest > 0 else 2.0 ** np.ceil(np.log2(length))
        h = min(h, 2.0 ** np.ceil(np.log2(length / 8)))
        count = int(np.ceil(length / h * (1 - 1e-12)))  # intervals; the last one is cut short
        whole = count <= MOST_POINTS
        if not whole:
            count, length = MOST_POINTS, MOST_POINTS * h
        t = np.append(h * np.arange(count), length)
        samples = []
        for block in self.blocks:
            q = block.flow.sample(block.q, block.g, h, count)
            samples.append(np.hstack([q, block.flow.at(block.q, block.g, length)[:, None]]))
        value, rate, second = self._functionals(t, samples, coefs)
        if not np.isfinite(value).all() or not np.isfinite(rate).all():
            raise self._stop("A504", "the motion grew beyond all numbers")
        self.segments += 1
        event = self._first_event(t, value, rate, second, coefs) if self.n_laws else None
        if event is None:
            self._peaks(t, value, rate, second, coefs)
            self._advance(length, [q[:, -1] for q in samples], coefs)
            self.t = goal if whole else self.t + length
            if self.n_laws:
                self.largest = np.maximum(self.largest, np.abs([value[: self.n_laws], rate[: self.n_laws]]).max(axis=2))
            self.same_instant = 0
            return whole
        tau, law, exit_index = event
        inside = t < tau
        cut = np.append(t[inside], tau)
        ends = [b.flow.at(b.q, b.g, tau) for b in self.blocks]
        at_event = self._functionals(np.array([tau]), [q[:, None] for q in ends], coefs)
        value, rate, second = (np.hstack([a[:, inside], b]) for a, b in zip((value, rate, second), at_event))
        self._peaks(cut, value, rate, second, coefs)
        u, v, _ = self._motion(tau, coefs, ends)
        self._advance(tau, ends, coefs)
        self.largest = np.maximum(self.largest, np.abs([value[: self.n_laws], rate[: self.n_laws]]).max(axis=2))
        self.same_instant = self.same_instant + 1 if tau <= 1e-13 * max(1.0, self.t) else 0
        self.t += tau
        self.u, self.v = u, v
        self._switch(law, exit_index, float(value[law, -1]), float(rate[law, -1]))
        return False

    def _switch(self, law: int, exit_index: int, d: float, v: float) -> None:
        before = self.branches[law].name
        self.states[law] = self.laws[law].law.leave(self.states[law], exit_index, d)
        self.branches[law] = self.laws[law].law.branch(self.states[law])
        after = self.branches[law]
        force = after.force(d, v)
        self.events += 1
        self.ledger.switched(law, before, after.name, self.t, d, v, force)
        self.ledger.peaks.force[law].take(force, self.t)
        if self.same_instant > 50 + 4 * self.n_laws:
            spring = self.laws[law]
            raise self._stop(
                "A503", f"{self.same_instant} changes at one instant, the last in element {spring.element} ({spring.rule}): {before} to {after.name}"
            )
        self._regroup()

    def _advance(self, tau: float, ends: Sequence[NDArray[Any]], coefs: Array) -> None:
        """Put all blocks at local time `tau` and add the work done on the way."""
        if tau > 0.0:
            for block in self.blocks:
                done = self._meter(block).measure(block.q, block.g, tau, coefs, self.scene.constant[block.index], block.p)
                if not self.scene.total:
                    self.damping_work += done.damping
                    self.input_work += done.input
                for law, loss in done.contacts:
                    self.contact_work += loss
                    self.ledger.peaks.dashpot_losses[law] += loss
            if self.scene.total:
                fastest = max((b.flow.fastest for b in self.blocks), default=0.0)
                input_, lost = work.total_work(
                    self.scene, tau, fastest, lambda x: self._motion(x, coefs), lambda x: self._law_forces(x, coefs), self.t
                )
                self.input_work += input_
                self.damping_work += lost
            for law, collision in self.ledger.open.items():
                if self.branches[law].name == "pressed":
                    collision.impulse += self._impulse(law, tau, coefs)
        for block, q in zip(self.blocks, ends):
            block.q = q

    def _meter(self, block: Block) -> work.Meter:
        return self.flows[block.key][1][3]  # type: ignore[no-any-return]

    def _impulse(self, law: int, tau: float, coefs: Array) -> float:
        """Integral of a contact force over (0, tau)."""
        b = self.branches[law]
        e = coefs @ self.scene.law_inputs[law]
        area = sum(e[k] * tau ** (k + 1) / (k + 1) for k in range(len(e)))
        change = sum(e[k] * tau**k for k in range(1, len(e)))
        for block in self.blocks:
            row = self.scene.law_rows[law, block.index]
            if np.any(row):
                flow = block.flow
                area += float((row @ (flow.u_q @ flow.integral(block.q, block.g, tau))).real)
                change += float((row @ (flow.u_q @ (flow.at(block.q, block.g, tau) - block.q))).real)
                if block.p is not None and flow.u_p is not None:
                    p = block.p
                    area += float(row @ flow.u_p @ sum(p[k] * tau ** (k + 1) / (k + 1) for k in range(len(p))))
                    change += float(row @ flow.u_p @ (work.polynomial(p, tau) - p[0]))
        return float(b.force0 * tau + b.stiffness * area + b.damping * change)

    # ------------------------------------------------------------------ events and peaks

    def _list_exits(self) -> None:
        """Gather the exits of the present branches as arrays."""
        self.exit_pairs = [(i, e) for i, b in enumerate(self.branches) for e in range(len(b.exits))]
        self.exit_law = np.array([i for i, _ in self.exit_pairs], np.intp)
        self.exit_factors = np.array([self.branches[i].exits[e] for i, e in self.exit_pairs]).reshape(-1, 3).T
        # the second rate of a law matters where its rate decides
        self.bending = bool(np.any(self.exit_factors[1])) or any(b.damping for b in self.branches)

    def _first_event(
        self, t: Array, value: Array, rate: Array, second: Array, coefs: Array
    ) -> tuple[float, int, int] | None:
        law, (a, b, c), pairs = self.exit_law, self.exit_factors, self.exit_pairs
        g = a[:, None] * value[law] + c[:, None]
        slope = a[:, None] * rate[law]
        if self.bending:
            g += b[:, None] * rate[law]
            slope += b[:, None] * second[law]
        scale = np.abs(a) * self.largest[0, law] + np.abs(b) * self.largest[1, law] + np.abs(c)
        tol = STILL * np.maximum(scale, np.abs(g).max(axis=1))[:, None]
        # a branch holds when it is entered: what stands above zero at the start is rounding
        g[:, 0] = np.minimum(g[:, 0], 0.0)
        crossed = (g[:, 1:] > tol) & (g[:, :-1] <= tol)
        # up and down again within one interval: where the end tangents meet above zero it is looked at closely
        dt = np.diff(t)
        turn = (slope[:, :-1] > 0) & (slope[:, 1:] < 0) & (g[:, 1:] <= tol) & (g[:, :-1] <= tol)
        with np.errstate(divide="ignore", invalid="ignore"):
            x = (g[:, 1:] - g[:, :-1] - slope[:, 1:] * dt) / (slope[:, :-1] - slope[:, 1:])
            turn &= g[:, :-1] + slope[:, :-1] * x > tol
        for j in np.flatnonzero((crossed | turn).any(axis=0)):
            best: tuple[float, int, int] | None = None
            for n in np.flatnonzero(crossed[:, j] | turn[:, j]):
                exit_ = (int(law[n]), float(a[n]), float(b[n]), float(c[n]))
                low, high = float(t[j]), float(t[j + 1])
                if not crossed[n, j]:
                    top = self._root(exit_, low, high, coefs, order=1)
                    if self._exit_value(exit_, top, coefs)[0] <= tol[n, 0]:
                        continue
                    high = top
                elif j == 0 and g[n, 0] == 0.0 and slope[n, 0] < 0.0:
                    low = self._dip(exit_, high, coefs)
                elif j == 0 and g[n, 0] == 0.0 and slope[n, 0] > 0.0:
                    high = 0.0  # it leaves at once
                tau = self._root(exit_, low, high, coefs) if high > low else low
                if best is None or tau < best[0]:
                    best = (tau, *pairs[n])
            if best is not None:
                return best
        return None

    def _exit_value(self, exit_: tuple[int, float, float, float], tau: float, coefs: Array) -> tuple[float, float]:
        law, a, b, c = exit_
        value, rate, second = self._at(law, tau, coefs)
        return a * value + b * rate + c, a * rate + b * second

    def _dip(self, exit_: tuple[int, float, float, float], high: float, coefs: Array) -> float:
        """A time in (0, high) where the exit is below zero, for one that starts at zero and falls first."""
        low = high
        for _ in range(60):
            low *= 0.5
            if self._exit_value(exit_, low, coefs)[0] < 0.0:
                return low
        return 0.0

    def _root(self, exit_: tuple[int, float, float, float], low: float, high: float, coefs: Array, order: int = 0) -> float:
        """Root of an exit that rises in (low, high), or with `order` 1 of its slope that falls: safeguarded Newton."""
        sign = 1.0 if order == 0 else -1.0
        x = 0.5 * (low + high)
        last = np.inf
        for _ in range(200):
            g, slope = self._exit_value(exit_, x, coefs)
            f = sign * (g if order == 0 else slope)
            if f > 0:
                high = x
            else:
                low = x
            if order == 0 and slope > 0:
                new = x - g / slope
            else:  # secant on the bracket's middle: slopes have no slope at hand
                new = 0.5 * (low + high)
            if not low < new < high:
                new = 0.5 * (low + high)
            if abs(new - x) <= 4e-16 * max(self.t, high) or new in (low, high) or f == 0.0:
                return new if f != 0.0 else x
            if order == 1 and high - low < 1e-9 * (high + low):
                return new
            if abs(new - x) > 0.5 * last:  # Newton stalls: halve
                new = 0.5 * (low + high)
            last = abs(new - x)
            x = new
        return x

    def _peaks(self, t: Array, value: Array, rate: Array, second: Array, coefs: Array) -> None:
        n = self.n_laws
        peaks = self.ledger.peaks
        targets = [*peaks.deformation, *peaks.watch]
        self._extremes(t, value, rate, targets, lambda i, tau: self._at(i, tau, coefs)[:2])
        pressed = [i for i in range(n) if self.branches[i].damping]
        for i, b in enumerate(self.branches):
            if i not in pressed:  # without a dashpot the force peaks where the deformation does
                for d, at in ((value[i].max(), value[i].argmax()), (value[i].min(), value[i].argmin())):
                    peaks.force[i].take(b.force(float(d), 0.0), self.t + float(t[at]))
                top = peaks.deformation[i]
                for d, at in ((top.high, top.t_high), (top.low, top.t_low)):
                    if self.t <= at <= self.t + t[-1]:
                        peaks.force[i].take(b.force(d, 0.0), at)
        contacts = [i for i in self.ledger.open if self.branches[i].name == "pressed"]
        if contacts:
            k = np.array([self.branches[i].stiffness for i in contacts])[:, None]
            c = np.array([self.branches[i].damping for i in contacts])[:, None]
            f0 = np.array([self.branches[i].force0 for i in contacts])[:, None]
            force = k * value[contacts] + c * rate[contacts] + f0
            slope = k * rate[contacts] + c * second[contacts]

            def exact(i: int, tau: float) -> tuple[float, float]:
                v, r, s = self._at(contacts[i], tau, coefs)
                return float(k[i, 0] * v + c[i, 0] * r + f0[i, 0]), float(k[i, 0] * r + c[i, 0] * s)

            targets = [_Top(self.ledger, i) for i in contacts]
            self._extremes(t, force, slope, targets, exact)
            for i in contacts:
                collision = self.ledger.open[i]
                peaks.force[i].take(collision.peak, collision.t_peak)

    def _extremes(self, t: Array, value: Array, rate: Array, targets: Sequence[Any], exact: Any) -> None:
        """Take the grid's extremes, and those between grid points that would beat what is known, polished."""
        if not len(targets):
            return
        hi, lo = value.argmax(axis=1), value.argmin(axis=1)
        every = np.arange(len(targets))
        for target, x, j, y, k in zip(targets, value[every, hi].tolist(), hi, value[every, lo].tolist(), lo):
            if x > target.high:
                target.take(x, self.t + float(t[j]))
            if y < target.low:
                target.take(y, self.t + float(t[k]))
        known = np.array([[target.high, target.low] for target in targets])[:, :, None]
        dt, f0, s0, s1 = np.diff(t), value[:, :-1], rate[:, :-1], rate[:, 1:]
        turn = s0 * s1 < 0
        if not turn.any():
            return
        with np.errstate(divide="ignore", invalid="ignore"):
            # where the end tangents meet bounds the turning point of a smooth arc
            meet = f0 + s0 * (value[:, 1:] - f0 - s1 * dt) / (s0 - s1)
        beyond = turn & (((s0 > 0) & (meet > known[:, 0])) | ((s0 < 0) & (meet < known[:, 1])))
        for i, j in zip(*np.nonzero(beyond)):
            sign = 1.0 if s0[i, j] > 0 else -1.0
            best = targets[i].high if sign > 0 else -targets[i].low
            ends = sign * np.array([f0[i, j], value[i, j + 1], s0[i, j], s1[i, j]])
            # the cubic through both ends tells whether it can win; only then is it polished
            top = cubic_top(*ends, dt[j])[1]
            if top + 0.02 * abs(top - max(ends[0], ends[1])) <= best:
                continue
            tau = _turning(lambda x, i=i, sign=sign: sign * exact(i, x)[1], float(t[j]), float(t[j + 1]), ends[2], ends[3])  # type: ignore[misc]
            targets[i].take(float(exact(i, tau)[0]), self.t + tau)

    # ------------------------------------------------------------------ samples, energies, end

    def _sample(self, t: float) -> None:
        coefs = self._enter_piece()
        u, v, a = self._motion(0.0, coefs)
        self.u, self.v = u, v
        self.sink.sample(t, u, v, a, self.states, self.energies(u, v))

    def _law_forces(self, tau: float, coefs: Array) -> Array:
        """Forces of all laws at local time `tau`."""
        return np.array([x.force(*self._at(i, tau, coefs)[:2]) for i, x in enumerate(self.branches)])

    def energies(self, u: Array, v: Array) -> dict[str, float]:
        """Energies at the present state, by name."""
        scene = self.scene
        return stock(scene, self.t, u, v, self.states, self.input_work, self.damping_work, self.contact_work)

    def outcome(self) -> Outcome:
        """What the run gathered."""
        figures = {
            "method": "EXACT, event-driven",
            "events": self.events,
            "segments": self.segments,
            "linear regimes": len(self.flows),
        }
        checks = [
            ("residual of the modes, worst regime", f"{self.worst_residual:.1e}", "good" if self.worst_residual < 1e-10 else "look"),
            ("condition of the modes, worst regime", f"{self.worst_condition:.1e}", "good" if self.worst_condition < 1e7 else "look"),
        ]
        if self.series_used:
            checks.append(("defective modes", "met", "integrated by the exponential series"))
        return Outcome(self.ledger.close(), figures, checks)

    def _stop(self, code: str, why: str) -> Stop:
        return Stop(code, self.t, why, self.outcome())


class _Top:
    """Feeds a contact's force into its running collision."""

    def __init__(self, ledger: Ledger, law: int) -> None:
        self.ledger, self.law = ledger, law

    @property
    def high(self) -> float:
        return self.ledger.open[self.law].peak

    @property
    def low(self) -> float:
        return -np.inf  # only the largest force counts

    def take(self, value: float, t: float) -> None:
        self.ledger.force(self.law, value, t)


def _turning(slope: Any, low: float, high: float, s_low: float, s_high: float) -> float:
    """Zero of a falling slope in (low, high) by the Illinois form of regula falsi; 1e-9 of the interval is plenty at a peak."""
    side = 0
    x, steep = low, s_low - s_high  # a slope of 1e-8 of the ends' costs 1e-16 of the arc's height
    for _ in range(60):
        x = (s_low * high - s_high * low) / (s_low - s_high)
        s = slope(x)
        if s > 0:
            low, s_low = x, s
            if side == 1:
                s_high *= 0.5
            side = 1
        else:
            high, s_high = x, s
            if side == -1:
                s_low *= 0.5
            side = -1
        if s == 0.0 or high - low < 1e-9 * (high + 1e-300) or abs(s) < 1e-8 * steep:
            break
    return x


def integrate(scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink) -> Outcome:
    """Integrate a scene exactly; see the module's head.

    Raises
    ------
    Stop
        Too many changes at one instant, a mechanism, or numbers beyond all bounds.
    """
    return Exact(scene, start, watch, options, sink).run()


SPEC = Spec(
    "method",
    "EXACT",
    "event-driven, exact between events",
    (Field("REFINE", Kind.INT, default=0, lo=0, hi=8, doc="halvings of the search grid, for a self-check"),),
    reference="after Nigam & Jennings 1969, for many freedoms and events",
    impl=integrate,
)
