r"""Equilibrium paths of STATIC and PUSHOVER, traced from event to event.

.. math:: K u + \sum_i b_i f_i(d_i) = p_0 + \lambda p, \qquad d_i = b_i^T u + (1-\lambda)\,o_i

The path is controlled by the load factor :math:`\lambda`, or by one displacement :math:`c^T u`, which can
pass a limit load.  :math:`o_i` are deformations applied along with the load.

With linear branches the path is a chain of straight segments.  Along each of them

.. math:: \Bigl(K + \sum_i k_i b_i b_i^T\Bigr)\dot u
          = \dot\lambda\Bigl(p + \sum_i k_i b_i o_i\Bigr), \qquad
          \dot\lambda = \pm 1 \quad\text{or}\quad c^T\dot u = \pm 1

and the point is moved exactly to the first event of a law.  If several events coincide, the event of the
first law is processed first and the rates are recomputed; this terminates if the stiffness is positive
definite (Murty 1974: the least-index pivots of a linear complementarity problem).  A force that a law
releases suddenly (by fracture) is redistributed to the other laws at constant control.  Curved laws make
the segments curved: Newton's method finds their points, and the events are bracketed.

A closed rigid contact constrains its nodes (see `contact_constraints`); its event occurs when its force
falls to zero.  If a loaded mechanism moves towards a touching contact, that contact closes first: the
ground supports a body that lies on it.

References
----------
Batoz JL, Dhatt G (1979), Incremental displacement algorithms for nonlinear problems, Int. J. Numer. Methods
Engng 14: 1262-1267 (a displacement as the control).
Murty KG (1974), Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11: 123-130.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from pound_solve.analyses.contact_constraints import ContactConstraints
from pound_solve.analyses.tangent_solution import InstabilityError, solve_under_control, solve_under_load
from pound_solve.laws.automaton import K, Law, State
from pound_solve.numerics.matrices import Matrix, by_rows, dense, gathered
from pound_solve.numerics.modes import scaling
from pound_solve.numerics.types import Array
from pound_solve.structure.structure import Structure

RATE_ROUNDING = 1e-12  #: fraction of its terms below which a rate is rounding error
#: rounding error of rates as a fraction of the fastest rate, scaled by roots of stiffness
SOLUTION_ROUNDING = 1e-14
EVENT_REACHED = 1e-13  #: fraction of its terms below which an event is reached
#: fraction of its terms above which a force has jumped at an event, and is released; above `EVENT_REACHED`,
#: to which the place of the event is known
RELEASED_FORCE = 1e-12
JUST_CLOSED = 1e-6  #: fraction of its final stiffness below which a curved contact has only just closed
INCREMENTS = 20  #: smallest number of increments to the first mark with curved laws
#: Newton iterations for one point; the error in a contact with force overlap^n shrinks by 1 - 1/n at each
ITERATIONS = 80
BALANCED = 1e-15  #: residual, as a fraction of the forces, below which Newton's iteration ends
#: the same if the iteration no longer makes it smaller than `STALLED` of the last one
NEARLY_BALANCED, STALLED = 1e-11, 0.25
#: increment, as a fraction of the longest one, at which the path ends if Newton's method fails on it
SHORTEST_INCREMENT = 1e-9
BRACKETED = 1e-12  #: fraction of an increment to which an event on it is bracketed
NEAREST_TO_END = 0.01  #: distance of a false position from the ends of its bracket, lest it creep along one
MAX_CHANGES = 10_000  #: largest number of transitions between two turns of the control
MAX_RETURNS = 5  #: largest number of returns of all laws to the same branches at one point


class Mark(NamedTuple):
    """A point at which a path is stopped: where ``row . u + on_factor * factor`` rises to `value`."""

    row: Array
    on_factor: float
    value: float


class PathEvent(NamedTuple):
    """Event of a law: index of the law, and of the event function of its branch."""

    law: int
    event: int


class Rates(NamedTuple):
    """Rates along the path, shape (n_free,), (), (n_laws,), (n_laws,).

    Attributes
    ----------
    displacement, factor : ndarray, float
    argument, noise : ndarray
        Rates of the event arguments of each law, and their rounding errors.
    """

    displacement: Array
    factor: float
    argument: Array
    noise: Array


class Change(NamedTuple):
    """Transition of a law, with the names of its branches."""

    law: int
    before: str
    after: str


class EquilibriumPath:
    """A point on an equilibrium path, which is moved along it.

    Parameters
    ----------
    structure : Structure
    u : ndarray, shape (n_free,)
        Displacements of the start [L] or [rad].
    states : sequence of State
        States of the laws at the start.
    applied : ndarray, shape (n_free,)
        Loads at the start [F].
    load : ndarray, shape (n_free,)
        Loads per load factor; may be replaced between steps.
    control : ndarray, shape (n_free,), or None
        Row of the displacement that is controlled; None for the load factor.
    sign : float
        1.0 or -1.0: whether the control grows or decreases.
    lead : ndarray, shape (n_laws,), or None
        Deformations that vanish as the load factor goes from 0 to 1.

    Attributes
    ----------
    factor : float
    changes : int
        Number of transitions so far.
    """

    def __init__(
        self,
        structure: Structure,
        u: Array,
        states: Sequence[State],
        applied: Array,
        load: Array,
        control: Array | None = None,
        sign: float = 1.0,
        lead: Array | None = None,
    ) -> None:
        n = structure.n_free
        self.structure, self.laws = structure, structure.laws
        self.k, self.rows = structure.stiffness[:n, :n], structure.law_rows[:, :n]
        self.u, self.states, self.applied, self.load = u.copy(), list(states), applied.copy(), load
        self.control, self.sign = control, sign
        # entries of b b^T of every law: a row involves few unknowns
        pairs = [
            (law, i, j, x * y)
            for law, row in enumerate(by_rows(self.rows))
            for (i, x), (j, y) in itertools.product(list(zip(*row)), repeat=2)
        ]
        *self._outer, self._product = np.array(pairs).reshape(-1, 4).T
        self.lead = np.zeros(len(self.laws)) if lead is None else lead
        self.factor, self.changes, self._changes_before = 0.0, 0, 0
        self._visits: Counter[tuple[int, ...]] = Counter()  # branches of all laws since the last move
        self.corotational = structure.corotational.on(slice(n))
        self.curved = len(self.corotational) > 0 or any(s.law.curved for s in self.laws)
        self.branches = [s.law.branch(x) for s, x in zip(self.laws, self.states)]
        self._root = scaling(structure.initial_stiffness[:n, :n])
        self._released = np.zeros(n)  # forces that laws have released, not yet redistributed
        self._largest_load = float(np.abs(applied).max(initial=0.0))
        self._longest_increment = self._next_increment = np.inf
        self._rates_key = np.zeros(0)  # stiffnesses of the last rates
        self._rates: Rates | None = None
        self.constraints = self._closed()

    def deformations(self, u: Array, factor: float) -> Array:
        """Return the deformation of every law, shape (n_laws,)."""
        d: Array = self.rows @ u + (1.0 - factor) * self.lead
        return d

    def _deformation_terms(self, u: Array) -> Array:
        """Return the sum of the absolute terms of each deformation, on which its rounding error depends."""
        return np.asarray(np.abs(self.rows) @ np.abs(u) + np.abs(self.lead))

    def forces(self, d: Array) -> tuple[Array, Array]:
        """Return the force and tangent stiffness of every law at deformations `d`."""
        pairs = [s.law.force(x, at)[:2] for s, x, at in zip(self.laws, self.states, d.tolist())]
        both = np.array(pairs).reshape(len(self.laws), 2)
        return both[:, 0], both[:, 1]

    def _stiffnesses(self, d: Array) -> Array:
        """Return the stiffness of every law for the next iteration from deformations `d`, shape (n_laws,):
        the tangent or, if a curved contact has only just closed, the secant.
        """
        if not self.curved:
            return np.array([b.stiffness for b in self.branches], float)
        tangents = self.forces(d)[1]
        size = float(max(np.abs(self.load).max(initial=0.0), np.abs(self.applied).max(initial=0.0)))
        secants = [
            _secant(s.law, x, size) if s.role.collides else 0.0 for s, x in zip(self.laws, self.states)
        ]
        return np.where(tangents < JUST_CLOSED * np.array(secants), secants, tangents)

    def tangent(self) -> Matrix:
        """Return the tangent stiffness, shape (n_free, n_free)."""
        return self._stiffness(self.u, self.forces(self.deformations(self.u, self.factor))[1])

    def turn(self, sign: float) -> None:
        """Let the control grow (1.0) or decrease (-1.0) from here on."""
        self.sign, self._changes_before = sign, self.changes

    def unbalanced(self) -> float:
        """Return the largest residual force as a fraction of the largest force applied so far."""
        residual, size = self._residual(self.u, self.factor)
        return _relative_size(residual, np.append(size, self._largest_load))

    def step(self, marks: Sequence[Mark]) -> PathEvent | int | None:
        """Move to the first event of a law or to the first mark (its index); after a law has released a
        force, move to the point where the others have taken it over (None).

        Raises
        ------
        InstabilityError
            There is no further equilibrium.
        """
        try:
            if self._released.any():
                return self._redistribute()
            while (hit := self._increment(marks) if self.curved else self._segment(marks)) is None:
                pass
            return hit
        except InstabilityError as err:
            if self.factor == 0.0:
                raise
            raise InstabilityError(f"{err}; at load factor {self.factor:.6g}", err.code) from None

    def transition(self, event: PathEvent) -> Change:
        """Move a law to its next branch.

        Raises
        ------
        InstabilityError
            The transitions do not end.
        """
        i, law = event.law, self.laws[event.law].law
        d, before = float(self.deformations(self.u, self.factor)[i]), self.branches[i].name
        force = law.force(self.states[i], d)[0]
        self.states[i] = law.transition(self.states[i], event.event, d)
        self.branches[i] = law.branch(self.states[i])
        released = force - law.force(self.states[i], d)[0]
        if law.rigid:  # it opens when its force is zero
            self.constraints = self._closed()
        elif abs(released) > RELEASED_FORCE * (
            abs(force) + abs(law.p[K]) * float(self._deformation_terms(self.u)[i])
        ):
            self._released = self._released + released * self.rows[i]
        self.changes += 1
        if self.changes - self._changes_before > MAX_CHANGES:
            raise InstabilityError(
                f"more than {MAX_CHANGES} changes of state of springs and contacts", "A507"
            )
        same = tuple(state[0] for state in self.states)
        self._visits[same] += 1
        if self._visits[same] > MAX_RETURNS:
            spring = self.laws[i]
            why = "loses its strength faster than its neighbours unload, and changes state"
            if spring.role.collides:
                why = "is a contact that the forces open when it is closed and close when it is open,"
            raise InstabilityError(
                f"there is no further equilibrium without a jump: element {spring.element} {why} again and "
                f"again at the same point; at load factor {self.factor:.6g}",
                "A507",
            )
        return Change(i, before, self.branches[i].name)

    def _segment(self, marks: Sequence[Mark]) -> PathEvent | int:
        """Move along a straight segment to its end."""
        du, factor_rate, distance, hit = self._first_ahead(marks)
        if hit is None:
            raise InstabilityError("nothing lies ahead: the end of this analysis moves away", "A507")
        if distance > 0.0:
            self._move(self.u + distance * du, self.factor + distance * factor_rate)
        return hit

    def _redistribute(self) -> PathEvent | None:
        """Redistribute the forces that laws have released, at fixed control."""
        if self.curved:
            self._released = np.zeros(len(self.u))
            there = self._equilibrium(0.0, 0.0 * self.u, 0.0, ())
            if there is None:
                raise InstabilityError("no equilibrium for the force that a law has released", "A507")
            self._move(*there[0])
            return None
        du, factor_rate, distance, hit = self._first_ahead(())
        fraction = min(distance, 1.0)
        self._released = (1.0 - fraction) * self._released
        self._move(self.u + fraction * du, self.factor + fraction * factor_rate)
        return hit if isinstance(hit, PathEvent) and distance < 1.0 else None

    def _first_ahead(self, marks: Sequence[Mark]) -> tuple[Array, float, float, PathEvent | int | None]:
        """Return the rates of displacements and load factor, the first mark or event, and the distance to
        it.
        """
        try:
            du, factor_rate, rate, noise = self.rates(self.u, self.factor)
        except InstabilityError as err:
            if err.motion is None or (event := self._blocking(err.motion)) is None:
                raise
            return 0.0 * self.u, 0.0, 0.0, event
        distance = np.inf
        hit: PathEvent | int | None = None
        for j, (row, on_factor, value) in enumerate(marks):
            slope = float(row @ du) + on_factor * factor_rate
            if slope > 0.0:
                at = max((value - float(row @ self.u) - on_factor * self.factor) / slope, 0.0)
                if at < distance:
                    distance, hit = at, j
        if np.isfinite(distance) and not np.isfinite(self._longest_increment):
            self._longest_increment = self._next_increment = distance / INCREMENTS
        for event, at in self._events(rate, noise):
            if at < distance:
                distance, hit = at, event
        return du, factor_rate, distance, hit

    def _events(self, rate: Array, noise: Array) -> Iterator[tuple[PathEvent, float]]:
        """Yield the events ahead at these rates of their arguments, and the distances to them."""
        now, size = self._arguments(self.u, self.factor)
        for i, (branch, x, v, least, terms) in enumerate(
            zip(self.branches, now.tolist(), rate.tolist(), noise.tolist(), size.tolist())
        ):
            for n, (a, b, c) in enumerate(branch.events):
                if a == 0.0:
                    if b * v > abs(b) * least:
                        yield PathEvent(i, n), 0.0
                elif a * v > abs(a) * least:
                    off = a * x + c
                    reached = off > -EVENT_REACHED * (abs(a) * terms + abs(c))
                    yield PathEvent(i, n), 0.0 if reached else -off / (a * v)

    def _blocking(self, motion: Array) -> PathEvent | None:
        """Return the event of the first touching open contact that the motion of a mechanism closes, if
        any.
        """
        rate, noise = self.rows @ motion, RATE_ROUNDING * (np.abs(self.rows) @ np.abs(motion))
        rate[[not s.role.collides or b.constrains for s, b in zip(self.laws, self.branches)]] = 0.0
        # the motion does not move pressed contacts, except by rounding
        rate[self._stiffnesses(self.deformations(self.u, self.factor)) > 0.0] = 0.0
        return next((event for event, at in self._events(rate, noise) if at == 0.0), None)

    def _arguments(self, u: Array, factor: float) -> tuple[Array, Array]:
        """Return the argument of the event functions of each law, shape (n_laws,), and the sum of its
        absolute terms.  The argument is the deformation or, for a closed rigid contact, the force.
        """
        now, size = self.deformations(u, factor), self._deformation_terms(u)
        if len(self.constraints):
            now[self.constraints.laws], size[self.constraints.laws] = self._reactions(u, factor)
        return now, size

    def _reactions(self, u: Array, factor: float) -> tuple[Array, Array]:
        """Return the forces of the closed rigid contacts, shape (n_closed,), and the magnitudes of their
        terms.
        """
        residual, terms = self._residual(u, factor)
        known = np.array([self.branches[i].force0 for i in self.constraints.laws])
        return known - self.constraints.forces(residual + self._released), self.constraints.magnitudes(
            terms
        )

    def _closed(self) -> ContactConstraints:
        """Return the constraints of the closed rigid contacts."""
        constrained = np.array([i for i, b in enumerate(self.branches) if b.constrains], np.intp)
        return ContactConstraints(constrained, dense(self.rows[constrained]))

    def rates(self, u: Array, factor: float) -> Rates:
        """Return the rates of displacements, load factor and event arguments (see `_arguments`), and the
        rounding errors of the last.

        With piecewise linear laws the rates are constant until a stiffness, the load or the control
        changes; a transition between equally stiff branches changes none of these.
        """
        stiffness = self._stiffnesses(self.deformations(u, factor))
        control = np.zeros(len(u)) if self.control is None else self.control
        key = np.concatenate(
            [stiffness, self._released, self.load, control, [self.sign], self.constraints.laws], dtype=float
        )
        if self._rates is None or self.curved or not np.array_equal(key, self._rates_key):
            self._rates_key, self._rates = key, self._rates_with(u, stiffness)
        return self._rates

    def _rates_with(self, u: Array, stiffness: Array) -> Rates:
        """Return the `rates` for given stiffnesses of the laws."""
        du, factor_rate = self._linear(
            u, stiffness, self._released, 0.0 if self._released.any() else self.sign
        )
        rate = self.rows @ du - self.lead * factor_rate
        terms = np.abs(self.rows) @ np.abs(du) + np.abs(self.lead * factor_rate)
        fastest = float(np.abs(du / self._root).max(initial=0.0))
        noise = np.maximum(
            RATE_ROUNDING * terms, SOLUTION_ROUNDING * fastest * (np.abs(self.rows) @ self._root)
        )
        if at := list(self.constraints.laws):
            k, unit_load = self._stiffness(u, stiffness), self._unit_load(stiffness)
            rate[at] = self.constraints.forces(self._released + factor_rate * unit_load - k @ du)
            most = np.abs(self._released) + np.abs(factor_rate * unit_load) + np.abs(k) @ np.abs(du)
            noise[at] = RATE_ROUNDING * self.constraints.magnitudes(most)
        return Rates(du, factor_rate, rate, noise)

    def _move(self, u: Array, factor: float) -> None:
        self.applied = self.applied + (factor - self.factor) * self.load
        self.u, self.factor = u, factor
        for i, force in zip(
            self.constraints.laws, self._reactions(u, factor)[0].tolist() if self.constraints else ()
        ):
            self.states[i] = (*self.states[i][:3], (force,))
            self.branches[i] = self.laws[i].law.branch(self.states[i])
        self._visits.clear()
        self._largest_load = max(self._largest_load, float(np.abs(self.applied).max(initial=0.0)))

    def _increment(self, marks: Sequence[Mark]) -> PathEvent | int | None:
        """Move one increment along a curved segment, or to its end; None if there was no event."""
        du, factor_rate, distance, hit = self._first_ahead(marks)
        if distance == 0.0:
            return hit
        span = min(distance, self._next_increment)
        if not np.isfinite(span):
            raise InstabilityError("nothing lies ahead: the end of this analysis moves away", "A507")
        while (end_point := self._equilibrium(span, du, factor_rate, marks)) is None:
            span = self._next_increment = 0.5 * span
            if span < SHORTEST_INCREMENT * self._longest_increment:
                # load control has none; displacement control may have one
                code = "A501" if self.control is None else "A507"
                raise InstabilityError("no equilibrium was found further on: the strength is used up", code)
        self._next_increment = min(2.0 * self._next_increment, self._longest_increment)
        end, values = end_point
        start = self._values(self.u, self.factor, marks)
        if not (crossed := _crossed(start, values)):
            self._move(*end)
            return None
        low, high, tries = 0.0, span, 0
        while high - low > BRACKETED * span:
            # false position and bisection alternate: the first is fast, the second robust
            fractions = [start[j] / (start[j] - values[j]) for j in crossed]
            fraction = (
                min(max(min(fractions), NEAREST_TO_END), 1.0 - NEAREST_TO_END) if tries % 2 == 0 else 0.5
            )
            tries += 1
            middle = low + fraction * (high - low)
            there = self._equilibrium(middle, du, factor_rate, marks)
            if there is None:
                break
            if inside := _crossed(start, there[1]):
                high, (end, values), crossed = middle, there, inside
            else:
                low, start = middle, there[1]
        self._move(*end)
        first = crossed[0]
        if first < len(marks):
            return first
        events = [PathEvent(i, n) for i, b in enumerate(self.branches) for n in range(len(b.events))]
        return events[first - len(marks)]

    def _values(self, u: Array, factor: float, marks: Sequence[Mark]) -> list[float]:
        """Return functions that rise to zero at marks, then at events of all laws; rounding errors count as
        zero.
        """
        now_at, sizes = self._arguments(u, factor)
        _, _, rate, noise = self.rates(u, factor)
        values = [float(row @ u) + on_factor * factor - value for row, on_factor, value in marks]
        for branch, di, vi, least, size in zip(
            self.branches, now_at.tolist(), rate.tolist(), noise.tolist(), sizes.tolist()
        ):
            for a, b, c in branch.events:
                reversal = a == 0.0
                now, small = (
                    (b * vi, abs(b) * least)
                    if reversal
                    else (a * di + c, EVENT_REACHED * (abs(a) * size + abs(c)))
                )
                values.append(0.0 if abs(now) <= small else now)
        return values

    def _equilibrium(
        self, span: float, du: Array, factor_rate: float, marks: Sequence[Mark]
    ) -> tuple[tuple[Array, float], list[float]] | None:
        """Return the displacements and load factor at a distance along the path, by Newton's method, with
        the `_values` there; None if there is no stable equilibrium.
        """
        u, factor = self.u + span * du, self.factor + span * factor_rate
        last = np.inf
        for _ in range(ITERATIONS):
            residual, size = self._residual(u, factor)
            error = _relative_size(self.constraints.reduced_vector(residual), size)
            if not np.isfinite(error):
                return None
            try:
                if error <= BALANCED or STALLED * last <= error <= NEARLY_BALANCED:
                    return (u, factor), self._values(u, factor, marks)
                stiffness = self._stiffnesses(self.deformations(u, factor))
                u_change, factor_change = self._linear(u, stiffness, -residual, 0.0)
            except InstabilityError:
                return None
            last, u, factor = error, u + u_change, factor + factor_change
        return None

    def _residual(self, u: Array, factor: float) -> tuple[Array, Array]:
        """Return the residual forces, and the sum of the absolute terms of each equation."""
        force = self.forces(self.deformations(u, factor))[0]
        applied = self.applied + (factor - self.factor) * self.load
        size = np.abs(self.k) @ np.abs(u) + np.abs(self.rows.T) @ np.abs(force) + np.abs(applied)
        displaced = self.corotational.forces(u)
        return self.k @ u + displaced + self.rows.T @ force - applied, size + np.abs(displaced)

    def _stiffness(self, u: Array, stiffness: Array) -> Matrix:
        law, i, j = (x.astype(int) for x in self._outer)
        k = self.k + gathered(self.k.shape, i, j, stiffness[law] * self._product)
        return k + self.corotational.stiffness(u) if self.corotational else k

    def _linear(self, u: Array, stiffness: Array, force: Array, change: float) -> tuple[Array, float]:
        """Return the changes of displacements and load factor for a `force` and a `change` of the
        control.
        """
        k = self._stiffness(u, stiffness)
        constraints = self.constraints
        k, force = constraints.reduced_matrix(k), constraints.reduced_vector(force)
        unit_load = constraints.reduced_vector(self._unit_load(stiffness))
        try:
            if self.control is None:
                load = force + change * unit_load
                x, factor_rate = solve_under_load(self.structure, k, load, unit_load), change
            else:
                control = constraints.reduced_vector(self.control)
                x, factor_rate = solve_under_control(k, unit_load, control, force, change)
        except InstabilityError as err:
            if err.motion is not None:
                err.motion = self.constraints.expand(err.motion)
            raise
        return self.constraints.expand(x), factor_rate

    def _unit_load(self, stiffness: Array) -> Array:
        """Return the force per load factor, including that of the applied deformations, shape (n_free,)."""
        return np.asarray(self.load + self.rows.T @ (stiffness * self.lead))


def _secant(law: Law, state: State, size: float) -> float:
    """Return the secant stiffness of a contact from zero force to a force `size`; zero if it is open or
    linear.
    """
    if law.rule.power_law is None:
        return 0.0
    k, n = law.rule.power_law(law.p, state[0], state[3])[:2]
    secant: float = k ** (1.0 / n) * size ** (1.0 - 1.0 / n)
    return secant


def _relative_size(residual: Array, size: Array) -> float:
    return float(np.abs(residual).max(initial=0.0) / max(float(size.max(initial=0.0)), 1e-300))


def _crossed(before: Sequence[float], after: Sequence[float]) -> list[int]:
    """Return the indices of the values that rose above zero."""
    return [j for j, (a, b) in enumerate(zip(before, after)) if a <= 0.0 < b]
