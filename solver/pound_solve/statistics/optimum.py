r"""Search for the minimum of an objective under limits, with functions that cost a run of the deck each.

The variables are scaled to 0 to 1 between their bounds.  Objective and limits are scaled too: the objective
f by its value at the first start, and a limit l of a quantity q to its excess

.. math:: g = q / l - 1 \le 0.

Two methods are there.  ``smooth`` is sequential quadratic programming (Kraft 1988, DFVLR-FB 88-28) from
several starts: the values of the study, then points of a Sobol sequence.  The gradients are central
differences, all of whose points are asked for at once.  ``rough`` is differential evolution (Storn and
Price 1997, J.  Global Optim. 11: 341-359) with the rule of Lampinen (2002) for limits; it asks for one
generation at once, and needs no gradients.

The search aims half a tolerance below the limits, so that its end satisfies them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.statistics.design_variable import PLACES, DesignVariable

METHODS: Final = ("smooth", "rough")
STEP: Final = 1e-3  #: of a difference, as a share of the range of a variable
PENALTY: Final = 10.0  #: scaled value of an objective or an excess that is infinite
ROUNDS: Final = 30  #: of sequential quadratic programming from one start
INDIVIDUALS: Final = 8  #: of a generation of differential evolution, for each variable
EQUAL: Final = 10.0  #: tolerances within which the ends of two starts are one optimum
NEAR: Final = 0.05  #: share of the ranges within which their points are

CONVERGED, HALTED, SPENT = "converged", "no further descent", "out of runs"


class DesignLimit(NamedTuple):
    """A limit of a quantity: a largest value, or a least one."""

    name: str
    value: float
    is_least: bool

    def excess(self, value: float) -> float:
        """How far a value exceeds the limit, as a share of it; infinite for a value that is not finite."""
        if not math.isfinite(value):
            return math.inf
        beyond = self.value - value if self.is_least else value - self.value
        return beyond / (abs(self.value) or 1.0)


class PointOutcome(NamedTuple):
    """Objective, to be minimised, and limited quantities at one point; not finite where a run stopped."""

    objective: float
    limited: tuple[float, ...]


@dataclass(frozen=True)
class Tried:
    """One point of a search.

    Attributes
    ----------
    start : int
        Number of the start that was the first to ask for it, from 1.
    x : tuple of float
        The point, each coordinate 0 to 1.
    outcome : PointOutcome
    excess : float
        The largest of the limits' excesses; 0 or less where all are satisfied.
    """

    start: int
    x: tuple[float, ...]
    outcome: PointOutcome
    excess: float

    @property
    def is_feasible(self) -> bool:
        """Whether it satisfies all limits, and its objective is known."""
        return self.excess <= 0.0 and math.isfinite(self.outcome.objective)

    @property
    def rank(self) -> tuple[float, float]:
        """Sort key: points that satisfy the limits by their objective, then others by their excess."""
        if self.is_feasible:
            return 0.0, self.outcome.objective
        return (self.excess if self.excess > 0.0 else math.inf), self.outcome.objective


class StartEnd(NamedTuple):
    """End of the search from one start: its best point, and how it ended."""

    start: int
    best: Tried
    how: str


class SearchRules(NamedTuple):
    """Rules of a search.

    Attributes
    ----------
    method : str
        One of `METHODS`.
    starts : int
        Of ``smooth``.
    runs : int
        Most points.
    tolerance : float
        Of the objective, relative to its first value, and of the limits.
    seed : int
    """

    method: str
    starts: int
    runs: int
    tolerance: float
    seed: int


@dataclass(frozen=True)
class OptimumProblem:
    """An objective of some variables, with limits.

    Attributes
    ----------
    variables : tuple of DesignVariable
    objective : str
        Quantity, or formula of the variables.
    is_maximised : bool
    over : str
        How the values of the records become one.
    limits : tuple of DesignLimit
    rules : SearchRules
    """

    variables: tuple[DesignVariable, ...]
    objective: str
    is_maximised: bool
    over: str
    limits: tuple[DesignLimit, ...]
    rules: SearchRules

    @property
    def sign(self) -> float:
        """Factor of the objective that is minimised."""
        return -1.0 if self.is_maximised else 1.0

    def values(self, x: Sequence[float]) -> tuple[float, ...]:
        """Values of the variables at a point of a search."""
        return tuple(v.at(share) for v, share in zip(self.variables, x))


class _SpentError(Exception):
    """Raised if a search asks for more points than it may."""


class OptimumSearch:
    """A search.

    Parameters
    ----------
    evaluate : callable
        Outcomes of several points, which it gets as tuples of coordinates from 0 to 1.
    first : sequence of float
        The first start.
    limits : sequence of DesignLimit
        Of the limited quantities of an outcome.
    rules : SearchRules
    """

    def __init__(
        self,
        evaluate: Callable[[list[tuple[float, ...]]], list[PointOutcome]],
        first: Sequence[float],
        limits: Sequence[DesignLimit],
        rules: SearchRules,
    ) -> None:
        self._evaluate, self._first = evaluate, np.asarray(first, np.float64)
        self.limits, self.rules = limits, rules
        self.tried = dict[tuple[float, ...], Tried]()  #: points in the order in which they were asked for
        self.ends = list[StartEnd]()
        self._asked = dict[
            tuple[float, ...], None
        ]()  # points of the current start, earlier ones among them
        self._start, self._scale, self._allowed = 1, 1.0, rules.runs

    @property
    def best(self) -> Tried:
        """The best point."""
        return min(self.tried.values(), key=lambda t: t.rank)

    @property
    def spent(self) -> int:
        """Number of starts that have used up their share of the points."""
        return sum(end.how == SPENT for end in self.ends)

    def carry_out(self) -> None:
        """Search until the method ends, or the points that are allowed have been asked for.

        Of these, each start of ``smooth`` may have an equal share of those that earlier ones left.
        """
        (self._smooth if self.rules.method == METHODS[0] else self._rough)()

    def _smooth(self) -> None:
        """Sequential quadratic programming from every start."""
        from scipy.optimize import minimize
        from scipy.stats import qmc

        count, rules = len(self._first), self.rules
        more = max(rules.starts - 1, 0)
        sequence = qmc.Sobol(count, seed=np.random.default_rng(rules.seed))
        others = sequence.random(1 << more.bit_length())[:more] if more else np.empty((0, count))
        starts = [self._first, *others]
        self._at(starts[:1])
        objective = next(iter(self.tried.values())).outcome.objective
        self._scale = abs(objective) if math.isfinite(objective) and objective else 1.0
        programming: Any = minimize
        limits: Any = ()
        if self.limits:
            limits = {
                "type": "ineq",
                "fun": lambda x: -self._scaled([x])[0, 1:],
                "jac": lambda x: -self._gradients(x)[1:],
            }
        for self._start, start in enumerate(starts, 1):
            self._allowed = len(self.tried) + (rules.runs - len(self.tried)) // (
                len(starts) + 1 - self._start
            )
            try:
                result = programming(
                    lambda x: self._scaled([x])[0, 0],
                    start,
                    jac=lambda x: self._gradients(x)[0],
                    method="SLSQP",
                    bounds=[(0.0, 1.0)] * count,
                    constraints=limits,
                    options={"ftol": 0.1 * rules.tolerance, "maxiter": ROUNDS},
                )
                self._end(CONVERGED if result.success else HALTED)
            except _SpentError:
                self._end(SPENT)

    def _rough(self) -> None:
        """Differential evolution, one generation at once."""
        from scipy.optimize import NonlinearConstraint, differential_evolution

        self._at([self._first])
        evolution: Any = differential_evolution
        limits: Any = ()
        if self.limits:
            limits = NonlinearConstraint(lambda x: self._columns(x)[1:], -np.inf, 0.0)
        try:
            result = evolution(
                lambda x: self._columns(x)[0],
                [(0.0, 1.0)] * len(self._first),
                constraints=limits,
                popsize=INDIVIDUALS,
                init="sobol",
                x0=self._first,
                maxiter=self.rules.runs,
                tol=self.rules.tolerance,
                seed=np.random.default_rng(self.rules.seed),
                polish=False,
                updating="deferred",
                vectorized=True,
            )
            self._end(CONVERGED if result.success else HALTED)
        except _SpentError:
            self._end(SPENT)

    def _end(self, how: str) -> None:
        """Keep the end of the current start, the best of the points that it asked for."""
        asked_for = [self.tried[x] for x in self._asked if x in self.tried]
        if asked_for:
            self.ends.append(StartEnd(self._start, min(asked_for, key=lambda t: t.rank), how))
        self._asked.clear()

    def _at(self, points: Sequence[Array]) -> list[Tried]:
        """Points with their outcomes; those that are new are evaluated at once.

        Raises
        ------
        _SpentError
            There would be too many; as many as are allowed have been evaluated.
        """
        keys = [tuple(np.clip(p, 0.0, 1.0).round(PLACES).tolist()) for p in points]
        self._asked |= dict.fromkeys(keys)
        fresh = list(dict.fromkeys(k for k in keys if k not in self.tried))
        allowed = fresh[: self._allowed - len(self.tried)]
        for x, outcome in zip(allowed, self._evaluate(allowed) if allowed else ()):
            excess = max((c.excess(v) for c, v in zip(self.limits, outcome.limited)), default=0.0)
            self.tried[x] = Tried(self._start, x, outcome, excess)
        if len(allowed) < len(fresh):
            raise _SpentError
        return [self.tried[k] for k in keys]

    def _scaled(self, points: Sequence[Array]) -> Array:
        """Scaled objective and excesses of points, shape (n_points, 1 + n_limits)."""
        margin = 0.5 * self.rules.tolerance
        rows = [
            [t.outcome.objective / self._scale]
            + [c.excess(v) + margin for c, v in zip(self.limits, t.outcome.limited)]
            for t in self._at(points)
        ]
        scaled = np.array(rows, np.float64)
        return np.nan_to_num(scaled, nan=PENALTY, posinf=PENALTY, neginf=-PENALTY)

    def _columns(self, x: Array) -> Array:
        """The same of points that are columns, as differential evolution has them."""
        points = list(np.atleast_2d(x.T)) if x.size else []
        values = self._scaled(points).reshape(-1, 1 + len(self.limits)).T
        return values if x.ndim > 1 else values[:, 0]

    def _gradients(self, x: Array) -> Array:
        """Gradients by central differences, at a bound by those within it."""
        steps = STEP * np.eye(len(x))
        pairs = np.clip([x + steps, x - steps], 0.0, 1.0)
        values = self._scaled([x, *pairs[0], *pairs[1]])[1:].reshape(2, len(x), -1)
        width = np.diagonal(pairs[0] - pairs[1])
        return np.ascontiguousarray(((values[0] - values[1]) / width[:, None]).T)  # SLSQP ignores strides


class Agreement(NamedTuple):
    """Ends of starts at the best point, at as good an objective elsewhere, and at a worse one."""

    same: list[StartEnd]
    elsewhere: list[StartEnd]
    worse: list[StartEnd]


def agreement(ends: Sequence[StartEnd], best: Tried, tolerance: float) -> Agreement:
    """Compare the ends of several starts; `tolerance` is relative to the best objective."""
    out = Agreement([], [], [])
    room = EQUAL * tolerance * max(abs(best.outcome.objective), math.ulp(0.0))
    for end in ends:
        distance = max(abs(a - b) for a, b in zip(end.best.x, best.x))
        if not end.best.is_feasible or end.best.outcome.objective > best.outcome.objective + room:
            out.worse.append(end)
        else:
            (out.same if distance <= NEAR else out.elsewhere).append(end)
    return out
