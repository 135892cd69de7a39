"""Gaps that the runs of a sweep needed, compared with separation rules, contact by contact.

The runs whose gaps stayed open tell the gap that each of them needed.  A run in which something met needed
more than its smallest gap; it counts as contact up to there, and nothing is said of wider gaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.results.sweep_file import DONE, Sweep
from pound_solve.statistics.curves import CurveError, cases, measure
from pound_solve.statistics.fragility import Fragility, FragilityError, from_capacities
from pound_solve.statistics.separation import RULES, SeparationPeaks

ANY: Final = "any"  #: name of all contacts together, in a deck with several
DIGITS: Final = 4  #: of probabilities by a distribution
NEEDS: Final = ("needed_gap", "given_gap", "peak_i", "peak_j", "correlation")


class Options(NamedTuple):
    """Options of the statistics of separations.

    Attributes
    ----------
    gaps : sequence of float
        At which probabilities are asked for; empty for steps up to the largest that was needed.
    correlation : float
        Of both buildings; NaN for that of their modes.
    raised : tuple of float
        Factors of codes on the displacements of both buildings.
    level : float
        Of confidence.
    """

    gaps: Sequence[float] = ()
    correlation: float = math.nan
    raised: tuple[float, float] = (1.0, 1.0)
    level: float = 0.95


class NeededGaps(NamedTuple):
    """One contact under the records of one case and level.

    Attributes
    ----------
    case : str
    level : float
    contact : str
        Its name, or `ANY`.
    needed : ndarray, shape (n_free,)
        Gap that each run needed in which nothing met.
    met : ndarray, shape (n_met,)
        Smallest gap of each run in which something met.
    left_out : int
        Runs that stopped, failed, or have not ended.
    rules : tuple of float
        Gaps by `RULES` for the mean peaks of the runs in which nothing met.
    fitted : Fragility or None
        Lognormal distribution of the gap that is needed.
    """

    case: str
    level: float
    contact: str
    needed: Array
    met: Array
    left_out: int
    rules: tuple[float, ...]
    fitted: Fragility | None

    def contacts(self, gap: float) -> tuple[int, int]:
        """Number of runs that collide at a gap, and of all runs; zeros where some runs do not tell."""
        if (self.met < gap).any() or not math.isfinite(gap):
            return 0, 0
        return int((self.needed > gap).sum()) + len(self.met), len(self.needed) + len(self.met)

    def by_fit(self, gap: float) -> float:
        """Probability of contact by the lognormal distribution."""
        if self.fitted is None or not math.isfinite(gap):
            return math.nan
        return 1.0 if gap <= 0.0 else round(1.0 - float(self.fitted.probability(gap)), DIGITS)


def groups(sweep: Sweep, options: Options) -> list[NeededGaps]:
    """Every contact of every case and level; `ANY` first.

    Raises
    ------
    CurveError
        The sweep has no contacts, or no levels.
    """
    if not set(NEEDS) <= set(sweep.variables):
        raise CurveError(
            "its runs tell of no gaps that are needed: the decks need contacts and a HISTORY, "
            "and the sweep a version of the program that keeps them"
        )
    levels, done = np.asarray(sweep[measure(sweep)], np.float64), sweep["status"] == DONE
    places: dict[tuple[str, float], list[int]] = {}
    for i, key in enumerate(zip(cases(sweep), levels.tolist())):
        places.setdefault(key, []).append(i)
    return [
        group
        for (case, level), runs in places.items()
        for group in _contacts(sweep, case, level, np.array(runs)[done[runs]], len(runs), options)
    ]


def _contacts(
    sweep: Sweep, case: str, level: float, runs: Array, asked: int, options: Options
) -> Iterator[NeededGaps]:
    """Groups of one case and level, one for each contact; `runs` are its completed runs, by index."""
    needed, given_gap, u1, u2, rho = (sweep[name][runs] for name in NEEDS)
    there = ~np.isnan(given_gap).all(axis=0)  # contacts of this deck
    names = [n for n, is_there in zip(sweep.labels["contact"], there) if is_there]
    if not names or not len(runs):
        return
    needed, given_gap, u1, u2, rho = (x[:, there] for x in (needed, given_gap, u1, u2, rho))
    free = ~np.isnan(needed).any(axis=1)
    met = given_gap[~free].min(axis=1)
    gaps = np.full((len(names), len(RULES)), np.nan)
    for k in range(len(names) if free.any() else 0):
        correlation = options.correlation if math.isfinite(options.correlation) else rho[free, k].mean()
        peaks = SeparationPeaks(u1[free, k].mean(), u2[free, k].mean(), float(correlation), *options.raised)
        gaps[k] = [rule.of(peaks) for rule in RULES]

    def group(contact: str, of: Array, rules: Array) -> NeededGaps:
        fitted = _fit(of, met, options.level)
        return NeededGaps(case, level, contact, of, met, asked - len(runs), tuple(rules.tolist()), fitted)

    if len(names) > 1:
        yield group(ANY, needed[free].max(axis=1), gaps.max(axis=0))
    if len(names) == 1 or not len(
        met
    ):  # else it is not known which of them a free motion would have closed
        for k, name in enumerate(names):
            yield group(name, needed[free, k], gaps[k])


def _fit(needed: Array, met: Array, level: float) -> Fragility | None:
    """Fit a lognormal distribution to the gaps that are needed; None where they do not determine one."""
    try:
        return from_capacities(needed, met, level=level)
    except FragilityError:
        return None
