"""Picture of a study: the largest error of every run against its time and its steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.plot import style
from pound_solve.results import Results

MARKS = "os^Dvx"


def study(results: Results) -> Any:
    """Error against time to solve and against the number of steps, one curve a method."""
    table = results.table("study")
    table = table[np.isfinite(table["seconds"])]
    # a run without error is drawn at the rounding of numbers
    worst = np.fmax(np.fmax(np.fmax(table["drift"], table["member"]), table["contact"]), 1e-16)
    figure = style.figure(9.0, 4.2, results.title)
    left, right = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2)
    style.grid(left, "time to solve [s]", "largest error")
    style.grid(right, "steps")
    for k, method in enumerate(dict.fromkeys(table["method"].tolist())):
        own = table["method"] == method
        look = {
            "color": style.COLOURS[k % len(style.COLOURS)],
            "marker": MARKS[k % len(MARKS)],
            "markersize": 4,
            "linewidth": 0.9,
            "label": method,
        }
        left.loglog(table["seconds"][own], worst[own], **look)
        if table["steps"][own].all():
            right.loglog(table["steps"][own], worst[own], **look)
    for axes in (left, right):
        for target in results.table("study_advice")["target"]:
            axes.axhline(target, color="0.5", linewidth=0.6, linestyle="--")
    left.legend(fontsize=7)
    return figure
