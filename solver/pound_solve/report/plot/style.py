"""What all pictures share: matplotlib (extra `plot`), imported here only, and how axes look in print."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

BLUE, RED, GREEN = "#0b4f8a", "#b3301e", "#3d7a3d"
COLOURS = (BLUE, "#b3541e", GREEN, "#7a3d7a", "#8a7a0b", "#0b8a7a", "0.35", "#5a5ad0")


class Nothing(Exception):
    """There is nothing to draw; the message states what is missing."""


def ready(folder: Path) -> None:
    """Make the folder of pictures where it is missing, and see that there will be pictures.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    OSError
        The folder cannot be made.
    """
    figure()
    folder.mkdir(parents=True, exist_ok=True)


def figure(width: float = 7.0, height: float = 4.5, title: str = "") -> Any:
    """An empty figure of a size in inches.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    """
    from matplotlib.figure import Figure

    out = Figure(figsize=(width, height), layout="constrained")
    if title:
        out.suptitle(title, fontsize=10)
    return out


def grid(axes: Any, x: str = "", y: str = "") -> Any:
    """Light lines behind the curves, and names of the axes."""
    axes.grid(color="0.88", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(x, fontsize=8)
    axes.set_ylabel(y, fontsize=8)
    axes.tick_params(labelsize=8)
    return axes


def panels(count: int, title: str, each: tuple[float, float] = (3.4, 2.6)) -> tuple[Any, Sequence[Any]]:
    """A figure of `count` axes in up to four columns."""
    columns = min(4, max(1, round(count**0.5 + 0.2)))
    rows = -(-count // columns)
    out = figure(each[0] * columns + 0.4, each[1] * rows + 0.5, title)
    axes = [out.add_subplot(rows, columns, n + 1) for n in range(count)]
    for own in axes:
        own.locator_params(nbins=4)  # numbers that do not run into each other
    return out, axes


def save(picture: Any, path: Path) -> None:
    """Write a picture, whose file's ending names the format; equal numbers give equal bytes."""
    import matplotlib

    _literal(picture)
    with matplotlib.rc_context({"svg.hashsalt": "pound-solve", "svg.fonttype": "none"}):
        dated = {"Date": None} if path.suffix == ".svg" else None
        if path.suffix == ".pdf":
            dated = {"CreationDate": None}
        picture.savefig(path, dpi=150, metadata=dated)


def _literal(picture: Any) -> None:
    """Have names of a deck drawn as they are: dollar signs mean formulas in numbers of log axes only."""
    from matplotlib.text import Text

    for text in picture.findobj(Text):
        text.set_parse_math(False)
    for axis in (axis for axes in picture.axes for axis in (axes.xaxis, axes.yaxis)):
        if axis.get_scale() == "log":
            for label in axis.get_ticklabels(which="both"):
                label.set_parse_math(True)
