"""Picture of an analysis of uncertainty: a tornado and a distribution function for each quantity."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style


class UncertainPanel(NamedTuple):
    """Data of one quantity.

    Attributes
    ----------
    name : str
        With its unit.
    middle : float
        Value with all variables at their medians.
    bars : sequence of (str, float, float)
        Variables with the values at their lower and upper fractile, the widest first.
    values : ndarray, shape (n,)
        Of the sample, ascending; infinite ones last.
    limits : sequence of float
    """

    name: str
    middle: float
    bars: Sequence[tuple[str, float, float]]
    values: Array
    limits: Sequence[float]


@style.sheet()
def uncertainty(panels: Sequence[UncertainPanel], path: Path) -> None:
    """Draw a row for each quantity: the tornado, and the distribution function of the sample; see
    `suites.incremental`.
    """
    rows = max(len(panels), 1)
    figure = style.figure(8.0, 2.6 * rows + 0.3)
    for n, panel in enumerate(panels):
        left, right = (figure.add_subplot(rows, 2, 2 * n + k) for k in (1, 2))
        style.grid(left, panel.name)
        for k, (_, low, high) in enumerate(panel.bars):
            for value, colour, label in ((low, style.BLUE, "16 %"), (high, style.RED, "84 %")):
                left.barh(
                    k, value - panel.middle, 0.7, panel.middle, color=colour, label="" if k else label
                )
        left.axvline(panel.middle, color="0.2", linewidth=0.8)
        left.set_yticks(range(len(panel.bars)), [style.short(name) for name, _, _ in panel.bars])
        left.invert_yaxis()
        if panel.bars:
            left.legend(title="variable at its", fontsize="small")
        style.grid(right, panel.name, "share of the runs [-]")
        finite = panel.values[np.isfinite(panel.values)]
        right.step(
            finite, np.arange(1, len(finite) + 1) / len(panel.values), where="post", color=style.BLUE
        )
        for limit in panel.limits:
            right.axvline(limit, color=style.RED, linestyle="--", linewidth=1.0)
        right.set_ylim(0.0, 1.0)
        for axes in (left, right):
            axes.locator_params(axis="x", nbins=5)
    style.save(figure, path)
