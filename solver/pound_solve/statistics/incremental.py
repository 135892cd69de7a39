r"""Incremental dynamic analysis: the sequence of levels at which one record is run.

The rules are those of Vamvatsikos and Cornell (2002, Earthquake Engng Struct. Dyn. 31: 491-514; 2004,
Earthquake Spectra 20: 523-553), hunt and fill:

1. the hunt: steps that grow by a constant amount, :math:`\Delta_i = \Delta + (i - 1)\,\delta`, until a run
   collapses or the highest level is reached;
2. the bracket: a third of the way from the highest level without collapse to the lowest with collapse,
   until they are close;
3. the fill: the middle of the widest interval between levels without collapse, as long as runs are left.

A run counts as collapse if it stops, if its demand reaches a limit, or if the curve is flat: its slope from
the run below is less than a fraction of the initial slope (FEMA 350: a fifth).  The next level depends on
the points alone, so that an interrupted analysis resumes without a difference.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

#: verdicts on a point
STANDS, STOPPED, BEYOND, FLAT = "stands", "stopped", "beyond the limit", "flat"
THIRD: Final = 1.0 / 3.0
SAME: Final = 1e-9  #: relative difference below which two levels are the same


class IdaPoint(NamedTuple):
    """One run.

    Attributes
    ----------
    level : float
        Intensity.
    demand : float
        Infinite if the run stopped early.
    """

    level: float
    demand: float


@dataclass(frozen=True)
class Rules:
    """Rules that select levels and define collapse.

    Attributes
    ----------
    step, growth : float
        First step of the hunt, and increment of each further step.
    top : float
        Highest level.
    runs : int
        Largest number of runs per record.
    close : float
        Relative width of the bracket of collapse at which it is accepted.
    limit : float
        Demand that counts as collapse.
    slope : float
        Fraction of the initial slope below which the curve is flat; 0 for never.
    """

    step: float
    growth: float = 0.0
    top: float = math.inf
    runs: int = 12
    close: float = 0.1
    limit: float = math.inf
    slope: float = 0.2


def ends(points: Sequence[IdaPoint], rules: Rules) -> list[str]:
    """Verdict on every point, such as `STANDS`; `points` must be in the order of their levels."""
    ends: list[str] = []
    first = before = None
    for point in points:
        if not math.isfinite(point.demand):
            ends.append(STOPPED)
            continue
        if point.demand >= rules.limit:
            ends.append(BEYOND)
            continue
        flat = False
        if first is not None and before is not None and point.demand > before.demand:
            slope = (point.level - before.level) / (point.demand - before.demand)
            flat = slope < rules.slope * first.level / first.demand
        ends.append(FLAT if flat else STANDS)
        before = point
        if first is None and point.demand > 0.0:
            first = point
    return ends


def collapse(points: Sequence[IdaPoint], rules: Rules) -> tuple[float, float]:
    """Bracket of the collapse level of a record.

    Parameters
    ----------
    points : sequence of IdaPoint
        In the order of their levels.
    rules : Rules

    Returns
    -------
    stands, falls : float
        Highest level without collapse below the lowest with collapse, and the latter; infinite if none.
    """
    stands = 0.0
    for point, end in zip(points, ends(points, rules)):
        if end != STANDS:
            return stands, point.level
        stands = point.level
    return stands, math.inf


def next_level(points: Sequence[IdaPoint], rules: Rules) -> float | None:
    """The level of the next run; None where the record is done.

    Parameters
    ----------
    points : sequence of IdaPoint
        At least one, in the order of their levels.
    rules : Rules
    """
    if len(points) >= rules.runs:
        return None
    stands, falls = collapse(points, rules)
    if falls == math.inf:
        return _hunt(points, rules) or _fill(points, stands)
    if falls - stands > rules.close * max(stands, rules.close * falls):
        return stands + THIRD * (falls - stands)
    return _fill(points, stands)


def _hunt(points: Sequence[IdaPoint], rules: Rules) -> float | None:
    """Next level of the hunt; None where the highest level is reached."""
    highest = points[-1].level
    if highest >= rules.top * (1.0 - SAME):
        return None
    # steps are counted by levels, not by runs, so that levels that are given beside the hunt do no harm
    level, step = points[0].level, rules.step
    while level <= highest * (1.0 + SAME):
        level, step = level + step, step + rules.growth
    return min(level, rules.top)


def _fill(points: Sequence[IdaPoint], stands: float) -> float | None:
    """The middle of the widest gap between levels that stand, the lowest of several."""
    levels = [0.0, *(p.level for p in points if p.level <= stands)]
    gaps = [high - low for low, high in pairwise(levels)]
    if not gaps:
        return None
    widest = max(gaps)
    at = next(i for i, gap in enumerate(gaps) if gap >= widest * (1.0 - SAME))
    return levels[at] + 0.5 * gaps[at]


def standing(points: Sequence[IdaPoint], rules: Rules) -> list[IdaPoint]:
    """The curve of a record up to the highest level that stands, from the origin on."""
    stands, _ = collapse(points, rules)
    return [IdaPoint(0.0, 0.0), *(p for p in points if p.level <= stands)]


def capacity(
    points: Sequence[IdaPoint], rules: Rules, demand: float, in_steps: bool = False, from_rest: bool = False
) -> tuple[float, float]:
    """Levels between which a record first reaches a demand: zero and the lowest level where its first run
    reaches it, the highest level and infinity where none does, twice the same where the level is known.

    The level is known where two runs may be joined by a straight line.  They may not below the lowest
    level, where nothing was run, unless the demand grows `from_rest` in proportion to the level; nor where
    the demand comes `in_steps`, as a count does, or is zero in the lower run; nor up to a collapse.
    """
    for below, point in pairwise(standing(points, rules)):
        if point.demand >= demand:
            if in_steps or not (below.demand or (from_rest and not below.level)):
                return below.level, point.level
            fraction = (demand - below.demand) / (point.demand - below.demand)
            level = below.level + fraction * (point.level - below.level)
            return level, level
    return collapse(points, rules)


def demand_at(points: Sequence[IdaPoint], rules: Rules, level: float) -> float:
    """Demand at a level: infinite from the middle of the bracket of a collapse on.

    NaN beyond the highest level of a record that stands.
    """
    stands, falls = collapse(points, rules)
    if level > stands * (1.0 + SAME):
        if falls == math.inf:
            return math.nan
        if level >= 0.5 * (stands + falls):
            return math.inf
    levels, demands = zip(*standing(points, rules))
    return float(np.interp(level, levels, demands))
