"""Uncertain variables of a study, propagated to its quantities: a sample, Sobol indices and a tornado.

Every point of the sample is run under all records of the study, so the statistics are over points and
records, of which each counts alike.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np

from pound_deck.diagnostics import suggest
from pound_solve.numerics.types import Array
from pound_solve.statistics.curves import Asked, CurveError
from pound_solve.statistics.distributions import (
    FAMILIES,
    Distribution,
    DistributionError,
    Parameters,
    dependent,
)
from pound_solve.statistics.propagation import CONTACT, SPREAD, Propagated, UncertaintyAim
from pound_solve.statistics.replicates import REPLICATES, SAMPLINGS, uniform
from pound_solve.statistics.sobol_indices import mixed
from pound_solve.sweep.demands import demands, quantities_of
from pound_solve.sweep.points import PointResult, Points
from pound_solve.sweep.study.asked import all_asked, asked
from pound_solve.sweep.study.document import Document, Path_
from pound_solve.sweep.study.study import MAX_RUNS
from pound_solve.sweep.study.variables import TABLE as VARIABLES
from pound_solve.sweep.study.variables import given_values

TABLE: Final = "uncertainty"  #: of a study
CORRELATION: Final = "correlation"  #: the other one
TABLES: Final = (VARIABLES, TABLE, CORRELATION)
ITEMS: Final = ("quantities", "limits", "sampling", "runs", "seed", "confidence", "indices")
DEFAULTS: Final = (Asked("storey_drift"), Asked("contact_force"))  #: quantities without `quantities`
LEAST: Final = 64  #: runs of a record, below which the scatter of the replicates says little
SMALLEST_EIGENVALUE: Final = 1e-8  #: of a matrix of correlations


def aim(document: Document) -> UncertaintyAim:
    """Read the tables ``[uncertainty]`` and ``[correlation]`` and the distributions of the variables of a
    study; mistakes are added to the document.
    """
    document.take((TABLE,), dict, {})
    document.known((TABLE,), ITEMS)
    names = list(given_values(document))
    distributions = {name: _distribution(document, name) for name in names}
    with_indices = document.take((TABLE, "indices"), bool, False)
    correlation = _correlation(document, names)
    if with_indices and document.at((CORRELATION,)) is not None:
        message = "Sobol indices need independent variables, and the study has [correlation]"
        document.mistake("S605", message, (TABLE, "indices"), "leave out indices, or [correlation]")
    level = document.take((TABLE, "confidence"), float, 0.95)
    if not 0.0 < level < 1.0:
        document.mistake("S603", "confidence is between 0 and 1", (TABLE, "confidence"))
    seed = document.take((TABLE, "seed"), int, 0)
    if seed < 0:
        document.mistake("S603", "seed is zero or above", (TABLE, "seed"))
    sampling, runs = _plan(document, len(names), with_indices)
    return UncertaintyAim(
        MappingProxyType({name: d for name, d in distributions.items() if d is not None}),
        correlation,
        tuple(dict.fromkeys(all_asked(document, (TABLE, "quantities")))),
        tuple(_limits(document)),
        sampling,
        runs,
        seed,
        level,
        with_indices,
    )


def _distribution(document: Document, name: str) -> Distribution | None:
    """Distribution of a variable; None, with a mistake, where there is none."""
    path = (VARIABLES, name)
    word = document.take((*path, "distribution"), str, "")
    if word not in FAMILIES:
        hint = suggest(word, list(FAMILIES)) or f"there are {', '.join(FAMILIES)}"
        message = f"there is no distribution {word}" if word else f"{name} has no distribution"
        document.mistake("S604", message, path, hint)
        return None
    family = FAMILIES[word]
    given = {
        item: x
        for item in ("mean", "sd", "cov", "mode", "low", "high")
        if not math.isnan(x := document.take((*path, item), float, math.nan))
    }
    takes = {*family.takes, "low", "high", *(["cov"] if "sd" in family.takes else ())}
    for item in given:
        if item not in takes:
            document.mistake(
                "S605", f"{word} does not take {item}: it takes {', '.join(family.takes)}", path
            )
    missing = [item for item in family.takes if item not in given and not (item == "sd" and "cov" in given)]
    if missing:
        words = [f"{x} or cov" if x == "sd" else x for x in missing]
        document.mistake("S604", f"{word} needs {', '.join(words)}", path)
        return None
    if "sd" in given and "cov" in given:
        document.mistake("S605", "sd stands beside cov", path, "give one of them")
        return None
    if "cov" in given:
        given["sd"] = given.pop("cov") * abs(given["mean"])
    if not given.get("sd", 1.0) > 0.0:
        document.mistake("S605", f"the standard deviation of {name} is above zero", path)
        return None
    if not given.get("low", -math.inf) < given.get("high", math.inf):
        return None  # a mistake of every variable, which is reported with its value
    try:
        return Distribution(word, Parameters(**{k: x for k, x in given.items() if k in takes}))
    except DistributionError as err:
        document.mistake("S605", f"{word} of {name}: {err}", path)
        return None


def _correlation(document: Document, names: Sequence[str]) -> Array:
    """Matrix of correlations, of items such as ``gap.k = 0.5``; the identity without any."""
    matrix = np.eye(len(names))
    table = document.take((CORRELATION,), dict, {})
    for one in table:
        for other in document.take((CORRELATION, one), dict, {}):
            path: Path_ = (CORRELATION, one, other)
            value = document.take(path, float, 0.0)
            wrong = next((name for name in (one, other) if name not in names), None)
            if wrong is not None:
                hint = suggest(wrong, names) or f"there are {', '.join(names)}"
                document.mistake("S602", f"there is no variable {wrong}", path, hint)
            elif one == other:
                document.mistake("S605", f"{one} stands beside itself", path, "name two variables")
            elif not abs(value) < 1.0:
                document.mistake("S603", f"a correlation is between -1 and 1, not {value:g}", path)
            elif matrix[i := names.index(one), j := names.index(other)] != 0.0:
                document.mistake("S605", f"{one} and {other} have two correlations", path)
            else:
                matrix[i, j] = matrix[j, i] = value
    smallest = float(np.linalg.eigvalsh(matrix).min(initial=1.0))
    if smallest < SMALLEST_EIGENVALUE:
        message = "no variables have these correlations: the smallest eigenvalue of their matrix is "
        hint = "correlations of three variables or more limit each other: reduce the largest"
        document.mistake("S605", f"{message}{smallest:.2g}, and must be above zero", (CORRELATION,), hint)
    return matrix


def _plan(document: Document, variables: int, with_indices: bool) -> tuple[str, int]:
    """Kind of the sample, and its number of points."""
    sampling = document.take((TABLE, "sampling"), str, SAMPLINGS[0])
    if sampling not in SAMPLINGS:
        hint = suggest(sampling, list(SAMPLINGS)) or f"there are {' and '.join(SAMPLINGS)}"
        document.mistake("S603", f"there is no sampling {sampling}", (TABLE, "sampling"), hint)
    path = (TABLE, "runs")
    runs = document.take(path, int, 256)
    each = variables + 2 if with_indices else 1
    if runs < LEAST:
        document.mistake("S603", f"runs is {LEAST} or more, not {runs}", path)
    elif runs * each > MAX_RUNS:
        document.mistake("S603", f"the study has more than {MAX_RUNS} runs", path, "take fewer runs")
    elif sampling == "sobol" and runs & (runs - 1):
        message = f"a Sobol sequence has a power of 2 as its number of points, not {runs}"
        document.mistake("S603", message, path, f"write runs = {2 ** (runs.bit_length() - 1)}")
    elif runs % REPLICATES:
        message = f"runs is a multiple of {REPLICATES}, the number of replicates, not {runs}"
        document.mistake("S603", message, path, f"write runs = {runs - runs % REPLICATES}")
    return sampling, runs


def _limits(document: Document) -> Iterator[tuple[Asked, float]]:
    """Yield the limits and their quantities."""
    for text in document.take((TABLE, "limits"), dict, {}):
        path = (TABLE, "limits", text)
        yield asked(document, path, text), document.take(path, float, math.nan)


class UncertaintyAnalysis:
    """Runs of an analysis of uncertainty.

    Parameters
    ----------
    points : Points
    aim : UncertaintyAim
    """

    def __init__(self, points: Points, aim: UncertaintyAim) -> None:
        self.points, self.aim = points, aim
        self.distributions = [aim.distributions[v.name] for v in points.variables]

    def carry_out(self) -> Propagated:
        """Execute the runs.

        Raises
        ------
        Interrupted
            Ctrl-C has ended the execution.
        CurveError
            The runs do not have a quantity.
        """
        aim, variables = self.aim, len(self.distributions)
        u = uniform(aim.sampling, aim.runs, variables * (2 if aim.with_indices else 1), aim.seed)
        first, second = u[..., :variables], u[..., variables:]
        parts = [first, *((second, *mixed(first, second)) if aim.with_indices else ())]
        if aim.is_dependent:  # without indices
            parts = [dependent(first, aim.correlation)]
        (nominal,) = self.points.results([self.points.nominal])
        quantities = self._quantities(nominal)
        at = np.concatenate([x.reshape(-1, variables) for x in (*parts, self._crosses())])
        values = np.column_stack([d.quantile(x) for d, x in zip(self.distributions, at.T)])
        results = self.points.results(values)
        nominals, at_points = ({q: demands(r, q) for q in quantities} for r in ([nominal], results))
        shape = (len(parts), *first.shape[:2], -1)
        sizes = len(parts) * aim.runs
        blocks = {q: x[:sizes].reshape(shape) for q, x in at_points.items()}
        samples = min(len(parts), 2)
        return Propagated(
            {q: x[0] for q, x in nominals.items()},
            {q: np.concatenate(x[:samples], axis=1) for q, x in blocks.items()},
            {q: x[samples:] for q, x in blocks.items()},
            {q: x[sizes:] for q, x in at_points.items()},
        )

    def _crosses(self) -> Array:
        """Variates of the points of the tornado."""
        count = len(self.distributions)
        u = np.full((1 + 2 * count, count), 0.5)
        for i in range(count):
            u[1 + 2 * i : 3 + 2 * i, i] = SPREAD
        return u

    def _quantities(self, nominal: PointResult) -> list[Asked]:
        """Quantities of the analysis, those of limits and contact included."""
        wanted = [*self.aim.quantities, *(q for q, _ in self.aim.limits)]
        there = quantities_of(nominal, wanted)
        if not self.aim.quantities:
            wanted += [q for q in DEFAULTS if q.quantity in there]
        if not wanted:
            names = ", ".join(q.quantity for q in DEFAULTS)
            raise CurveError(f"its runs have none of {names}: name others under quantities of [{TABLE}]")
        return list(dict.fromkeys([*wanted, *([CONTACT] if CONTACT.quantity in there else ())]))
