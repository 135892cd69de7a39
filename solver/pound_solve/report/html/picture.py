"""A picture of the page as plain data for plotly.js."""

from __future__ import annotations

import math
from html import escape
from typing import Any, NamedTuple, TypeAlias

Trace: TypeAlias = dict[str, Any]


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
    """

    title: str
    note: str
    x: str
    y: str
    traces: list[Trace]
    equal: bool = False
    time: bool = False

    def as_json(self) -> dict[str, Any]:
        """Picture as data for the script of the page."""
        axes = {"x": plain(self.x), "y": plain(self.y), "equal": self.equal, "time": self.time}
        return axes | {"traces": self.traces}


def numbers(values: Any) -> list[float | None]:
    """Numbers rounded to seven digits, enough for any screen; None for one that is not finite."""
    return [float(f"{v:.7g}") if math.isfinite(v) else None for v in values]


def plain(text: str) -> str:
    """Text escaped so that plotly.js interprets none of it as markup."""
    return escape(text, quote=False)
