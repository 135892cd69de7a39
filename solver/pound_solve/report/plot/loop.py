"""Loop of a law as the verb ``loop`` drives it."""

from __future__ import annotations

from pathlib import Path

from pound_solve.report.plot import style
from pound_solve.report.text_plot import Curve


def loop(curve: Curve, title: str, x_name: str, y_name: str, path: Path) -> None:
    """Draw a force against its deformation into a file, whose ending names the format.

    Parameters
    ----------
    curve : sequence of (deformation, force)
        Corners, joined by straight lines.
    title, x_name, y_name : str
        Texts above the picture and at its axes.
    path : Path

    Raises
    ------
    ImportError
        matplotlib is not installed.
    OSError
        The file cannot be written.
    """
    with style.sheet():
        figure = style.figure(6.4, 4.5)
        axes = style.grid(figure.add_subplot(), x_name, y_name)
        axes.set_title(style.wrapped(title, 80))
        axes.axhline(0.0, color="0.4", linewidth=0.8)
        axes.axvline(0.0, color="0.4", linewidth=0.8)
        axes.plot(*zip(*curve), color=style.BLUE, linestyle="-", linewidth=1.4)
        style.save(figure, path)
