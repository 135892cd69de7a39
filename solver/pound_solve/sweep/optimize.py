"""Optimum of a study: values of its variables that minimise an objective under limits.

Every point of the search is run under all records, whose values become one by the mean, a fractile or the
largest.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np

from pound_deck.files import contents
from pound_deck.formula import Formula, FormulaError
from pound_deck.revise import with_params
from pound_solve.numerics.types import Array
from pound_solve.statistics.curves import Asked, CurveError
from pound_solve.statistics.optimum import (
    METHODS,
    DesignLimit,
    OptimumProblem,
    OptimumSearch,
    PointOutcome,
    SearchRules,
)
from pound_solve.statistics.over_records import MEAN, OverRecords
from pound_solve.sweep.demands import demands, quantities_of
from pound_solve.sweep.points import PointResult, Points
from pound_solve.sweep.study.asked import asked, over_records
from pound_solve.sweep.study.document import Document, Path_
from pound_solve.sweep.study.run import ParameterCase
from pound_solve.sweep.study.scaling import design_variables, scales, word
from pound_solve.sweep.study.variables import TABLE as VARIABLES
from pound_solve.sweep.study.variables import StudyVariable, given_values

TABLE: Final = "optimize"  #: of a study
OBJECTIVE: Final = "objective"
CONSTRAINT: Final = "constraint"
TABLES: Final = (VARIABLES, TABLE, OBJECTIVE, CONSTRAINT)
OBJECTIVE_ITEMS: Final = ("quantity", "expression", "records", "goal")
ITEMS: Final = ("method", "starts", "runs", "tolerance", "seed")
GOALS: Final = ("minimize", "maximize")
OVER: Final = MappingProxyType({MEAN: OverRecords(MEAN), "max": OverRecords(1.0)})
MAX_POINTS: Final = 100_000
MARK: Final = "! Optimum of"  #: beginning of a deck that this verb has written


@dataclass(frozen=True)
class OptimumAim:
    """What a search for an optimum asks for.

    Attributes
    ----------
    quantity : Asked or None
        Objective, unless it is the formula.
    formula : Formula or None
    is_maximised : bool
    over : OverRecords
    limited : tuple of Asked
        Quantities of the limits.
    limits : tuple of DesignLimit
    scales : mapping of str to str
        One of `scaling.SCALES` for each variable.
    rules : SearchRules
    """

    quantity: Asked | None
    formula: Formula | None
    is_maximised: bool
    over: OverRecords
    limited: tuple[Asked, ...]
    limits: tuple[DesignLimit, ...]
    scales: Mapping[str, str]
    rules: SearchRules

    def problem(self, variables: Sequence[StudyVariable]) -> OptimumProblem:
        """The problem of the variables of a study."""
        over = "largest of the records" if self.over.how == 1.0 else self.over.text
        return OptimumProblem(
            design_variables(variables, self.scales),
            self.formula.text if self.formula else " ".join(filter(None, self.quantity or ())),
            self.is_maximised,
            over,
            self.limits,
            self.rules,
        )


def aim(document: Document) -> OptimumAim:
    """Read the tables ``[objective]``, ``[constraint]`` and ``[optimize]`` and the bounds of the variables
    of a study; mistakes are added to the document.
    """
    names = list(given_values(document))
    document.take((OBJECTIVE,), dict, {})
    document.known((OBJECTIVE,), OBJECTIVE_ITEMS)
    quantity, formula = _objective(document, names)
    goal = word(document, (OBJECTIVE, "goal"), GOALS)
    limits = list(_limits(document))
    document.take((TABLE,), dict, {})
    document.known((TABLE,), ITEMS)
    return OptimumAim(
        quantity,
        formula,
        goal == GOALS[1],
        over_records(document, (OBJECTIVE, "records"), OVER),
        tuple(q for q, _ in limits),
        tuple(limit for _, limit in limits),
        scales(document),
        _rules(document),
    )


def _objective(document: Document, names: Sequence[str]) -> tuple[Asked | None, Formula | None]:
    """Quantity or formula of the objective."""
    quantity = document.take((OBJECTIVE, "quantity"), str, "")
    text = document.take((OBJECTIVE, "expression"), str, "")
    if bool(quantity) == bool(text):
        message = "quantity stands beside expression" if text else "the study has no objective"
        hint = '[objective] with quantity = "storey_drift", or expression = "2*k" of the variables'
        document.mistake("S604", message, (OBJECTIVE,), hint)
    if quantity:
        return asked(document, (OBJECTIVE, "quantity"), quantity), None
    if text:
        try:
            return None, Formula(text, names)
        except FormulaError as err:
            hint = f"a formula of {', '.join(names)}"
            document.mistake("S605", str(err), (OBJECTIVE, "expression"), hint)
    return None, None


def _limits(document: Document) -> Iterator[tuple[Asked, DesignLimit]]:
    """Yield quantities and their limits: a largest value, or a table with min or max or both."""
    for text in document.take((CONSTRAINT,), dict, {}):
        path: Path_ = (CONSTRAINT, text)
        quantity = asked(document, path, text)
        if not isinstance(document.at(path), dict):
            yield quantity, DesignLimit(text, document.take(path, float, math.nan), False)
            continue
        document.known(path, ("min", "max"))
        ends = {item: document.take((*path, item), float, math.nan) for item in ("min", "max")}
        if all(math.isnan(x) for x in ends.values()):
            document.mistake("S604", f"{text} has no limit", path, "give it max or min")
        for item, value in ends.items():
            if not math.isnan(value):
                yield quantity, DesignLimit(text, value, item == "min")


def _rules(document: Document) -> SearchRules:
    """Rules of the search."""
    method = word(document, (TABLE, "method"), METHODS)
    starts = document.take((TABLE, "starts"), int, 5)
    runs = document.take((TABLE, "runs"), int, 500)
    seed = document.take((TABLE, "seed"), int, 0)
    tolerance = document.take((TABLE, "tolerance"), float, 1e-3)
    for name, value, least, most in (("starts", starts, 1, 1000), ("runs", runs, 1, MAX_POINTS)):
        if not least <= value <= most:
            document.mistake("S603", f"{name} is {least} to {most}, not {value}", (TABLE, name))
    if seed < 0:
        document.mistake("S603", "seed is zero or above", (TABLE, "seed"))
    if not 1e-8 <= tolerance <= 0.1:
        document.mistake("S603", f"tolerance is 1e-8 to 0.1, not {tolerance:g}", (TABLE, "tolerance"))
    return SearchRules(method, starts, runs, tolerance, seed)


class OptimumAnalysis:
    """Runs of a search for an optimum.

    Parameters
    ----------
    points : Points
    aim : OptimumAim

    Attributes
    ----------
    problem : OptimumProblem
    before : PointOutcome
        At the values of the study; defined by `carry_out`.
    """

    before: PointOutcome

    def __init__(self, points: Points, aim: OptimumAim) -> None:
        self.points, self.aim = points, aim
        self.problem = aim.problem(points.variables)

    def carry_out(self) -> OptimumSearch:
        """Execute the runs; return the search that asked for them.

        Raises
        ------
        Interrupted
            Ctrl-C has ended the execution.
        CurveError
            The runs do not have a quantity, or the objective has no value at those of the study.
        """
        problem, aim = self.problem, self.aim
        first = [v.share(v.value) for v in problem.variables]
        search = OptimumSearch(self.outcomes, first, problem.limits, problem.rules)
        (nominal,) = self.points.results([self.points.nominal])
        quantities_of(nominal, [*([aim.quantity] if aim.quantity else ()), *aim.limited])
        if aim.formula:
            try:
                aim.formula.value(dict(zip([v.name for v in problem.variables], self.points.nominal)))
            except FormulaError as err:
                raise CurveError(f"{aim.formula.text} has no value at those of the study: {err}") from err
        self.before = self._outcome(self.points.nominal, nominal)
        search.carry_out()
        return search

    def outcomes(self, points: list[tuple[float, ...]]) -> list[PointOutcome]:
        """Outcomes of points of the search."""
        values = [self.problem.values(x) for x in points]
        return [self._outcome(x, r) for x, r in zip(values, self.points.results(values))]

    def _outcome(self, values: Sequence[float], result: PointResult) -> PointOutcome:
        """PointOutcome of the runs at values of the variables."""
        aim = self.aim

        def one(quantity: Asked) -> float:
            (of_records,) = demands([result], quantity)
            return float(aim.over.of(_known(of_records))[0])

        objective = one(aim.quantity) if aim.quantity else self._by_formula(values)
        worst = objective if math.isfinite(objective) else math.inf
        return PointOutcome(
            self.problem.sign * worst if math.isfinite(worst) else worst, tuple(map(one, aim.limited))
        )

    def _by_formula(self, values: Sequence[float]) -> float:
        assert self.aim.formula is not None
        try:
            return self.aim.formula.value(dict(zip([v.name for v in self.problem.variables], values)))
        except FormulaError:
            return math.inf

    def deck(self, values: Sequence[float]) -> tuple[Path, str] | None:
        """Path and text of the deck with values of the variables, beside the deck of the study; None if no
        variable is a PARAM.

        Raises
        ------
        CurveError
            A file that this verb has not written has its name.
        """
        study = self.points.session.study
        case = study.runs[0].case
        if not case.params:
            return None
        path = Path(case.deck).with_name(f"{Path(study.name).stem}.optimum.inp")
        if path.exists() and not contents(path).startswith(MARK.encode()):
            raise CurveError(
                f"{path} is in the way of the deck of the optimum: move it, or rename the study"
            )
        texts = {v.name: repr(x) for v, x in zip(self.problem.variables, values)}
        others = [f"; {name} = {x}" for name, x in texts.items() if name not in dict(case.params)]
        options = "".join(f" {word}" for word in _options(case))
        head = f"{MARK} {Path(study.name).name}: pound-solve {path.name}{options}{''.join(others)}\n"
        return path, head + with_params(case.deck, texts)


def _known(values: Array) -> Array:
    """Demands with a failed run as a stopped one: neither is an optimum."""
    return np.where(np.isnan(values), np.inf, values)


def _options(case: ParameterCase) -> Iterator[str]:
    """Options of the command line by which a deck has the results of a case."""
    for name in ("method", "dt", "tol"):
        value = getattr(case, name)
        if value is not None:
            yield f"--{name} {value}"
    for folder in case.records:
        yield f"--records {shlex.quote(str(folder))}"
