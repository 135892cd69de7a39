"""A picture of the page as plain data for plotly.js."""

from __future__ import annotations

import math
from html import escape
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np

from pound_solve.numerics.types import Array

Trace: TypeAlias = dict[str, Any]

MOST_POINTS: Final = 4000  #: most points of a curve in time, else extremes of short intervals
COLOURS: Final = (
    "#1f77b4",
    "#ff7f0e",
    "#2ca02c",
    "#d62728",
    "#9467bd",
    "#8c564b",
    "#e377c2",
    "#7f7f7f",
)  #: of things that several curves show


class PlotlyPicture(NamedTuple):
    """One picture.

    Attributes
    ----------
    title, note : str
        Above and below it.
    x, y : str
        Names of the axes with their units.
    traces : list of dict
        Curves in the format of plotly.js.
    equal : bool
        Whether both axes have the same scale.
    time : bool
        Whether the X axis is time, which all such pictures show alike.
    log : bool
        Whether both axes are logarithmic.
    rows : tuple of str
        Names at the places 0, 1, ... of the Y axis, to the right; empty for numbers.
    reach : float
        Largest X that is shown at first, from 0; 0 for all.
    """

    title: str
    note: str
    x: str
    y: str
    traces: list[Trace]
    equal: bool = False
    time: bool = False
    log: bool = False
    rows: tuple[str, ...] = ()
    reach: float = 0.0

    def as_json(self) -> dict[str, Any]:
        """Picture as data for the script of the page."""
        axes = {"x": plain(self.x), "y": plain(self.y), "equal": self.equal, "time": self.time}
        axes |= {"log": self.log, "rows": list(map(plain, self.rows)), "reach": self.reach}
        return axes | {"traces": self.traces}


def numbers(values: Any) -> list[float | None]:
    """Numbers rounded to seven digits, enough for any screen; None for one that is not finite."""
    return [float(f"{v:.7g}") if math.isfinite(v) else None for v in values]


def plain(text: str) -> str:
    """Text escaped so that plotly.js interprets none of it as markup."""
    return escape(text, quote=False)


def curve(name: str, x: Array, y: Array, shown: bool = True) -> Trace:
    """A line through points, visible at first if `shown`."""
    line = {"name": plain(name), "mode": "lines", "x": numbers(x), "y": numbers(y)}
    hidden = {} if shown else {"visible": "legendonly"}
    return line | hidden


def thinned(t: Array, values: Array) -> tuple[Array, Array]:
    """Thin out a curve of many points: keep the smallest and the largest value of every short interval."""
    if len(t) <= MOST_POINTS:
        return t, values
    size = -(-2 * len(t) // MOST_POINTS)
    keep = {0, len(t) - 1}
    for start in range(0, len(t), size):
        window = values[start : start + size]
        keep |= {start + int(np.argmin(window)), start + int(np.argmax(window))}
    chosen = sorted(keep)
    return t[chosen], values[chosen]
