"""Picture of a search for an optimum: objective and limits point by point; of two variables their plane."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style


class OptimumPath(NamedTuple):
    """Data of a search.

    Attributes
    ----------
    objective : str
    objectives : ndarray, shape (n_points,)
        NaN for one that is not known.
    feasible : ndarray of bool, shape (n_points,)
    best : ndarray, shape (n_points,)
        Best objective so far.
    limits : sequence of (str, Array)
        Limited quantities over their limits.
    variables : sequence of str
    values : ndarray, shape (n_points, n_variables)
    logs : sequence of bool
        Whether each variable is scaled by its logarithm.
    optimum : ndarray, shape (n_variables,)
    """

    objective: str
    objectives: Array
    feasible: NDArray[np.bool_]
    best: Array
    limits: Sequence[tuple[str, Array]]
    variables: Sequence[str]
    values: Array
    logs: Sequence[bool]
    optimum: Array


@style.sheet()
def optimum(search: OptimumPath, path: Path) -> None:
    """Draw a search; see `suites.incremental`."""
    plane = len(search.variables) == 2
    count = 1 + bool(search.limits) + plane
    figure, all_axes = style.panels(count, "", (4.2, 3.4))
    at = np.arange(1, len(search.objectives) + 1)
    axes = style.grid(all_axes[0], "point", search.objective)
    for fulfilled, look in ((True, {"color": style.BLUE}), (False, {"color": "0.7"})):
        some = search.feasible == fulfilled
        label = "limits satisfied" if fulfilled else "limits exceeded"
        axes.plot(at[some], search.objectives[some], ".", markersize=4, label=label, **look)
    axes.step(at, search.best, where="post", color=style.RED, linewidth=1.2, label="best so far")
    if search.limits:
        axes = style.grid(all_axes[1], "point", "quantity over its limit [-]")
        for k, (name, ratios) in enumerate(
            search.limits, 2
        ):  # the first colours are those of the objective
            axes.plot(
                at, ratios, ".", markersize=4, color=style.stroke(k)["color"], label=style.short(name)
            )
        axes.axhline(1.0, color="0.2", linewidth=0.8)
    if plane:
        axes = style.grid(all_axes[-1], *search.variables)
        for fulfilled, colour in ((False, "0.7"), (True, style.BLUE)):
            some = search.feasible == fulfilled
            axes.plot(*search.values[some].T, ".", markersize=4, color=colour)
        axes.plot(*search.optimum, "*", markersize=11, color=style.RED, label="best point")
        for set_scale, is_log in zip((axes.set_xscale, axes.set_yscale), search.logs):
            if is_log:
                set_scale("log")
    style.legend_below(figure, all_axes)
    style.save(figure, path)
