"""Report of a search for an optimum: before and after, the limits, the starts, and every point."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot.optimum import OptimumPath
from pound_solve.report.text import WIDTH, printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import units_of
from pound_solve.statistics.optimum import (
    CONVERGED,
    METHODS,
    SPENT,
    OptimumProblem,
    OptimumSearch,
    PointOutcome,
    agreement,
)

ACTIVE: Final = 2.0  #: tolerances below a limit within which it is active
AT_BOUND: Final = 2e-3  #: share of a range within which a variable is at its bound


class OptimumReport:
    """Report of a search.

    Parameters
    ----------
    sweep : Sweep
        All runs.
    problem : OptimumProblem
    search : OptimumSearch
    before : PointOutcome
        At the values of the study.
    """

    def __init__(
        self, sweep: Sweep, problem: OptimumProblem, search: OptimumSearch, before: PointOutcome
    ) -> None:
        self.sweep, self.problem, self.search, self.before = sweep, problem, search, before
        self.best = search.best
        self.values = problem.values(self.best.x)
        self.tried = list(search.tried.values())

    @property
    def is_solved(self) -> bool:
        """Whether a point satisfies all limits."""
        return self.best.is_feasible

    def of_results(self) -> Iterator[Row]:
        """One row for the objective and each limit: before and after."""
        p, after = self.problem, self.best.outcome
        goal = "largest" if p.is_maximised else "smallest"
        values = p.sign * self.before.objective, p.sign * after.objective
        yield "objective", self._name(p.objective), *map(_finite, values), goal, math.nan, ""
        margin = ACTIVE * p.rules.tolerance
        for limit, x, y in zip(p.limits, self.before.limited, after.limited):
            excess = limit.excess(y)
            remark = "exceeded" if excess > 0.0 else "active" if excess >= -margin else ""
            kind = "at least" if limit.is_least else "at most"
            yield "limit", self._name(limit.name), _finite(x), _finite(y), kind, limit.value, remark

    def of_variables(self) -> Iterator[Row]:
        """One row for each variable: before and after."""
        for v, value, share in zip(self.problem.variables, self.values, self.best.x):
            remark = "at its lower bound" if share <= AT_BOUND else ""
            remark = "at its upper bound" if share >= 1.0 - AT_BOUND else remark
            yield v.name, v.value, value, v.low, v.high, "log" if v.is_log else "linear", remark

    def of_starts(self) -> Iterator[Row]:
        """One row for each start."""
        for end in self.search.ends:
            points = sum(t.start == end.start for t in self.tried)
            objective = _finite(self.problem.sign * end.best.outcome.objective)
            x = ", ".join(f"{v:.5g}" for v in self.problem.values(end.best.x))
            kept = "yes" if end.best.is_feasible else "no"
            yield end.start, points, objective, kept, x, end.how

    def report(self) -> Iterator[str]:
        """Lines of the report."""
        units = units_of(self.sweep)
        for sentence in self._sentences():
            yield from textwrap.wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="  ")
        yield from ("", *printed(units, RESULTS, self.of_results()))
        yield from ("", *printed(units, VARIABLES, self.of_variables()))
        if self.problem.rules.method == METHODS[0]:
            yield from ("", *printed(units, STARTS, self.of_starts()))

    def _sentences(self) -> Iterator[str]:
        """Sentences on what the search has reached."""
        p, search = self.problem, self.search
        name = {"smooth": "Sequential quadratic programming", "rough": "Differential evolution"}
        yield (
            f"{name[p.rules.method]}, {len(self.tried)} points of at most {p.rules.runs}, "
            f"{len(self.sweep)} runs; {p.over}."
        )
        if search.spent:
            of = f"{search.spent} of {len(search.ends)} starts" if len(search.ends) > 1 else "The search"
            yield f"{of} used up its share of the runs: the best point may not be an optimum."
        if not self.is_solved:
            known = math.isfinite(self.best.excess) and math.isfinite(self.best.outcome.objective)
            least = f"; the least excess is {100.0 * self.best.excess:.3g} % of a limit" if known else ""
            yield f"No point satisfies all limits{least}."
        elif p.rules.method == METHODS[0]:
            yield from self._agreement()
        if not math.isfinite(self.before.objective):
            yield "A run at the values of the study stopped or failed."
        lost = sum(not math.isfinite(t.outcome.objective) or math.isinf(t.excess) for t in self.tried)
        if lost:
            yield f"Points with runs that stopped or failed, which count as infinite: {lost}."

    def _agreement(self) -> Iterator[str]:
        """Sentences on whether the starts agree."""
        ends = [end for end in self.search.ends if end.how != SPENT]
        ended = agreement(ends, self.best, self.problem.rules.tolerance)
        if len(ends) < 2:
            yield "Less than two starts have ended: whether there are other optima is not known."
        elif len(ended.same) == len(ends):
            yield f"All {len(ends)} starts that ended agree."
        else:
            yield (
                f"Of {len(ends)} starts that ended, {len(ended.same)} found the best point, "
                f"{len(ended.elsewhere)} as good an objective elsewhere, {len(ended.worse)} a worse one "
                "or none within the limits."
            )
            if any(end.how == CONVERGED and end.best.is_feasible for end in ended.worse):
                yield "There are several local optima: more starts may find a better one."

    def _name(self, name: str) -> str:
        """Name of a quantity with its unit; a formula as it is."""
        quantity = name.partition(" ")[0]
        if quantity not in self.sweep.variables:
            return name
        return f"{name} [{self.sweep.variables[quantity].unit or '-'}]"

    def table(self) -> dict[str, Variable]:
        """Columns of the table of all points."""
        p = self.problem
        columns = {
            "start": Variable(np.array([t.start for t in self.tried]), doc="start that asked for the point")
        }
        values = np.array([p.values(t.x) for t in self.tried])
        for k, v in enumerate(p.variables):
            columns[v.name] = Variable(values[:, k], doc=f"variable {v.name}")
        objective = np.array([p.sign * t.outcome.objective for t in self.tried], np.float64)
        columns["objective"] = Variable(objective, doc=p.objective)
        for k, limit in enumerate(p.limits):
            name = f"{limit.name} {'min' if limit.is_least else 'max'}"
            limited = np.array([t.outcome.limited[k] for t in self.tried], np.float64)
            columns[name] = Variable(limited, doc=f"quantity with the limit {limit.value:g}")
        columns["feasible"] = Variable(
            np.array([int(t.is_feasible) for t in self.tried]), doc="1: satisfies all"
        )
        columns["best"] = Variable(self._best_so_far(), doc="best objective of all points so far")
        return columns

    def _best_so_far(self) -> Array:
        """Best objective of the points that satisfy all limits, up to each; NaN before the first."""
        costs = [t.outcome.objective if t.is_feasible else math.inf for t in self.tried]
        best = np.minimum.accumulate(np.array(costs, np.float64))
        return np.where(np.isinf(best), np.nan, self.problem.sign * best)

    def drawn(self) -> OptimumPath:
        """Data of the picture."""
        p = self.problem
        return OptimumPath(
            self._name(p.objective).replace("_", " "),
            np.array([_finite(p.sign * t.outcome.objective) for t in self.tried]),
            np.array([t.is_feasible for t in self.tried]),
            self._best_so_far(),
            [(c.name.replace("_", " "), self._ratios(k)) for k, c in enumerate(p.limits)],
            [v.name for v in p.variables],
            np.array([p.values(t.x) for t in self.tried]),
            [v.is_log for v in p.variables],
            np.array(self.values),
        )

    def _ratios(self, k: int) -> Array:
        """Values of a limited quantity over its limit."""
        limit = self.problem.limits[k]
        values = np.array([_finite(t.outcome.limited[k]) for t in self.tried])
        return values / (limit.value or 1.0)


def _finite(value: float) -> float:
    return value if math.isfinite(value) else math.nan


RESULTS: Final = Sheet(
    columns=(
        Column("what", "", doc="objective or limit"),
        Column("name", "quantity", doc="quantity or formula"),
        Column("before", "at the values\nof the study", fmt="num", doc="value"),
        Column("after", "at the\nbest point", fmt="num", doc="value"),
        Column("kind", "asked for", doc="how it is limited"),
        Column("limit", fmt="given", doc="limit"),
        Column("remark", doc="active or exceeded"),
    ),
    group="name",
)
VARIABLES: Final = Sheet(
    columns=(
        Column("variable", doc="variable"),
        Column("before", "in the\nstudy", fmt="num", doc="value"),
        Column("after", "at the\nbest point", fmt="given", doc="value"),
        Column("low", fmt="given", doc="bound"),
        Column("high", fmt="given", doc="bound"),
        Column("scale", doc="of the search"),
        Column("remark", doc="whether it is at a bound"),
    ),
    group="variable",
)
STARTS: Final = Sheet(
    columns=(
        Column("start", fmt="int", doc="start"),
        Column("points", fmt="int", doc="points that it asked for"),
        Column("objective", fmt="num", doc="at its best point"),
        Column("feasible", "limits\nsatisfied", doc="whether all are"),
        Column("values", doc="of the variables"),
        Column("how", "end", doc="how it ended"),
    ),
    note="The first start is at the values of the study, the others are points of a Sobol sequence.",
)
