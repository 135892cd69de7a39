"""Pictures of many runs: trends over a PARAM, bars, curves of an incremental dynamic analysis with
fractiles, fragilities, and probabilities of contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style

FEW: Final = 20  #: values that are marked one by one
BAR: Final = 0.8  #: width of all bars of a row, as a fraction of the distance of rows


class Curves(NamedTuple):
    """Data of a picture: curves of an incremental analysis of one case.

    Attributes
    ----------
    title : str
    records : sequence of (Array, Array)
        Demands and levels of every record, from the origin on.
    levels : ndarray, shape (n,)
    fractiles : sequence of (str, Array)
        Name of a fractile, and its demands at the levels; infinite beyond the collapse.
    """

    title: str
    records: Sequence[tuple[Array, Array]]
    levels: Array
    fractiles: Sequence[tuple[str, Array]]


class Fragilities(NamedTuple):
    """Data of a picture: one fragility.

    Attributes
    ----------
    title : str
    levels, probability : ndarray, shape (n,)
    observed : tuple of two ndarray
        Levels, and shares of the runs there that exceed the limit.
    median, interval : float, (float, float)
        Median and the ends of its interval.
    """

    title: str
    levels: Array
    probability: Array
    observed: tuple[Array, Array]
    median: float
    interval: tuple[float, float]


class Contacts(NamedTuple):
    """Data of a picture: probability of contact of one case at one level.

    Attributes
    ----------
    title : str
    gaps : ndarray, shape (n,)
    seen : ndarray, shape (n, 3)
        Share of the runs that meet, and its interval.
    fitted : ndarray, shape (n,)
        Probability by a distribution; NaN without one.
    rules : sequence of (str, float)
        Names of rules, and the gaps that they ask for.
    """

    title: str
    gaps: Array
    seen: Array
    fitted: Array
    rules: Sequence[tuple[str, float]]


class Trend(NamedTuple):
    """Values of the runs of one case over a PARAM.

    Attributes
    ----------
    title : str
        The case; empty for the only one.
    x : ndarray, shape (n,)
    fractiles : ndarray, shape (3, n)
        Of the values of all records there.
    records : sequence of (Array, Array)
        Abscissas and values of every record.
    """

    title: str
    x: Array
    fractiles: Array
    records: Sequence[tuple[Array, Array]]


class BarPanel(NamedTuple):
    """Data of a picture: horizontal bars of one quantity.

    Attributes
    ----------
    title, axis : str
        Of the panel, and of its values with their unit.
    names : sequence of str
        Of the rows, from above.
    bars : sequence of (str, Array)
        Name of a set of bars, and its value in every row; NaN for none.
    """

    title: str
    axis: str
    names: Sequence[str]
    bars: Sequence[tuple[str, Array]]


class FitPanel(NamedTuple):
    """Data of a picture: measured values and the fitted ones.

    Attributes
    ----------
    title, x_axis, y_axis : str
    x, measured, fitted : ndarray, shape (n,)
    """

    title: str
    x_axis: str
    y_axis: str
    x: Array
    measured: Array
    fitted: Array


class TrendPanel(NamedTuple):
    """Data of a picture: one quantity over a PARAM, with its unit and the trends of all cases."""

    quantity: str
    unit: str
    trends: Sequence[Trend]


def trends(panels: Sequence[TrendPanel], over: str, path: Path, sheet: Path | None = None) -> None:
    """Draw a panel for each quantity over a PARAM, in the style of the program or of a sheet of the user;
    see `incremental`.
    """
    with style.sheet(sheet):
        style.save(_trends(panels, over), path)


def _trends(panels: Sequence[TrendPanel], over: str) -> Any:
    """Draw the median of each case, of several records also the band of the 16 and 84 % fractiles, and
    thin lines for the records if there is one case.
    """
    figure, all_axes = style.panels(len(panels), "", (4.2, 3.2))
    for axes, panel in zip(all_axes, panels):
        style.grid(axes, over, f"{panel.quantity.replace('_', ' ')} [{panel.unit or '-'}]")
        for k, trend in enumerate(panel.trends[: style.LINES]):
            look = style.stroke(k)
            if len(trend.records) > 1:
                low, _, high = trend.fractiles
                axes.fill_between(trend.x, low, high, color=look["color"], alpha=0.15, linewidth=0.0)
                if len(panel.trends) == 1:
                    for x, y in trend.records:
                        axes.plot(x, y, "-", color="0.75", linewidth=0.6)
            word = "median" if len(trend.records) > 1 else ""
            label = ", ".join(filter(None, [trend.title, word]))
            axes.plot(trend.x, trend.fractiles[1], **{**look, "markersize": 3.5}, label=label or None)
        axes.set_ylim(bottom=0.0)
    if any(axes.get_legend_handles_labels()[1] for axes in all_axes):
        style.legend_below(figure, all_axes)
    return figure


@style.sheet()
def bars(panels: Sequence[BarPanel], path: Path) -> None:
    """Draw a panel of horizontal bars for each quantity, see `incremental`."""
    rows = max(len(panel.names) for panel in panels)
    sets = max(len(panel.bars) for panel in panels)
    figure, all_axes = style.panels(len(panels), "", (4.2, 1.1 + rows * (0.18 + 0.14 * sets)))
    for axes, panel in zip(all_axes, panels):
        style.grid(axes, panel.axis)
        width = BAR / len(panel.bars)
        for k, (name, values) in enumerate(panel.bars):
            at = np.arange(len(values)) + (k + 0.5) * width - 0.5 * BAR
            look = style.stroke(k)
            axes.barh(at, values, width, color=look["color"], label=name or None)
            for y, value in zip(at, values):
                if np.isnan(value):
                    axes.text(0.0, y, " none", fontsize="x-small", va="center")
        axes.margins(x=0.08)
        axes.axvline(0.0, color="0.2", linewidth=0.8)
        axes.set_yticks(range(len(panel.names)), panel.names)
        axes.invert_yaxis()
        axes.set_title(panel.title)
    if sets > 1:
        style.legend_below(figure, all_axes)
    style.save(figure, path)


@style.sheet()
def fits(panels: Sequence[FitPanel], path: Path) -> None:
    """Draw measured and fitted values, and below them their difference; see `incremental`."""
    figure = style.figure(4.2 * len(panels), 4.6)
    grid = figure.subplots(2, len(panels), squeeze=False, sharex="col", height_ratios=(2.5, 1.0))
    for (above, below), panel in zip(grid.T, panels):
        style.grid(above, "", panel.y_axis).set_title(panel.title)
        style.grid(below, panel.x_axis, "difference")
        line = "o" if len(panel.x) <= FEW else "-"
        above.plot(panel.x, panel.measured, line, markersize=7, color="0.7", label="measured")
        above.plot(panel.x, panel.fitted, line, markersize=4, color=style.BLUE, label="fitted")
        below.plot(panel.x, panel.fitted - panel.measured, line, markersize=4, color=style.BLUE)
        below.axhline(0.0, color="0.2", linewidth=0.8)
    style.legend_below(figure, list(grid.flat))
    style.save(figure, path)


@style.sheet()
def incremental(cases: Sequence[Curves], demand: str, level: str, path: Path) -> None:
    """Draw the curves of every case, demand along x as usual.

    Parameters
    ----------
    cases : sequence of Curves
    demand, level : str
        Names of the axes with their units.
    path : Path
        File, whose ending names the format.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    OSError
        The file cannot be written.
    """
    figure, all_axes = style.panels(len(cases), "", (4.2, 3.4))
    for n, (axes, case) in enumerate(zip(all_axes, cases)):
        style.grid(axes, demand, "" if n else level)
        for k, (x, y) in enumerate(case.records):
            axes.plot(x, y, ".-", color="0.65", linewidth=0.8, markersize=3, label="" if k else "records")
        for k, (name, values) in enumerate(case.fractiles):
            axes.plot(values, case.levels, **style.stroke(k), label=name)
        axes.set_title(case.title)
    for axes in all_axes:  # alike, so that cases compare
        axes.set_xlim(0.0, max(panel.get_xlim()[1] for panel in all_axes))
        axes.set_ylim(0.0, max(panel.get_ylim()[1] for panel in all_axes))
    style.legend_below(figure, all_axes)
    style.save(figure, path)


@style.sheet()
def fragilities(fits: Sequence[Fragilities], level: str, path: Path) -> None:
    """Draw fragility curves, the observed shares, and medians with intervals; see `incremental`."""
    figure = style.figure(6.4, 4.2)
    axes = style.grid(figure.add_subplot(), level, "probability [-]")
    for k, fragility in enumerate(fits):
        look = style.stroke(k)
        axes.plot(fragility.levels, fragility.probability, **look, label=fragility.title)
        axes.plot(*fragility.observed, "o", color=look["color"], markersize=3)
        axes.plot(fragility.interval, (0.5, 0.5), "|-", color=look["color"], linewidth=1.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlim(left=0.0)
    style.legend(axes)
    style.save(figure, path)


@style.sheet()
def separations(cases: Sequence[Contacts], gap: str, path: Path) -> None:
    """Draw probabilities of contact against the gap, with the gaps of the rules; see `incremental`."""
    figure, all_axes = style.panels(len(cases), "", (4.2, 3.4))
    for n, (axes, case) in enumerate(zip(all_axes, cases)):
        style.grid(axes, gap, "" if n else "probability of contact [-]")
        share, low, high = case.seen.T
        axes.fill_between(case.gaps, low, high, color="0.88", step="post", label="interval")
        axes.step(case.gaps, share, where="post", color="0.35", label="runs")
        axes.plot(case.gaps, case.fitted, "--", color="0.35", linewidth=1.0, label="lognormal")
        for k, (name, at) in enumerate(case.rules):
            look = style.stroke(k)
            axes.axvline(at, color=look["color"], linestyle=look["linestyle"], linewidth=1.2, label=name)
        axes.set_ylim(0.0, 1.0)
        axes.set_xlim(left=0.0)
        axes.set_title(case.title)
    style.legend_below(figure, all_axes)
    style.save(figure, path)
