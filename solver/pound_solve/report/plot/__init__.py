"""Pictures of a results file by matplotlib (extra `plot`), which `style` imports on demand."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pound_solve.report.plot import labels, style
from pound_solve.report.plot.catalog import PICTURES
from pound_solve.report.plot.loop import loop
from pound_solve.report.plot.schema import ALL, Choice, ChoiceError, Nothing, Picture
from pound_solve.report.plot.spectrum import spectra
from pound_solve.report.plot.style import ready, sheet
from pound_solve.results import Results
from pound_solve.results.contents import TABLES

__all__ = (
    "ALL", "PICTURES", "Choice", "ChoiceError", "Nothing", "draw", "draw_into", "loop",
    "picture", "possible", "ready", "sheet", "spectra",
)  # fmt: skip


def possible(results: Results, ending: str = "svg") -> list[str]:
    """Pictures of a format that the file has the tables and histories for, be they empty."""
    held = {*results.tables, *results.histories}
    return [p.name for p in PICTURES.values() if ending in p.endings and held >= set(p.needs)]


def draw(
    results: Results, names: Sequence[str], folder: Path, ending: str = "svg", choice: Choice = ALL
) -> tuple[list[Path], dict[str, list[str]]]:
    """Draw pictures into files ``<results>_<picture>.<ending>``.

    Parameters
    ----------
    results : Results
    names : sequence of str
        Out of `PICTURES`.
    folder : Path
        Made where it is missing.
    ending : str
        One of the picture's endings.
    choice : Choice

    Returns
    -------
    drawn : list of Path
    left_out : dict of str to list of str
        Pictures that have nothing to draw, by what the file has none of.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    ChoiceError
        The file has not what is chosen.
    """
    ready(folder)
    drawn: list[Path] = []
    left_out: dict[str, list[str]] = {}
    for name in names:
        path = folder / f"{results.path.stem}_{name}.{ending}"
        try:
            draw_into(results, name, path, choice)
        except Nothing as why:
            left_out.setdefault(str(why), []).append(name)
        else:
            drawn.append(path)
    return drawn, left_out


def draw_into(results: Results, name: str, path: Path, choice: Choice = ALL) -> None:
    """Draw one picture into a file, whose ending names the format; see `draw`.

    Raises
    ------
    Nothing
        There is nothing to draw.
    """
    spec = PICTURES[name]
    _complete(results, spec)
    with style.sheet(choice.style):
        if spec.write:
            spec.write(results, choice, path)
        else:
            style.save(picture(results, name, choice), path)


def picture(results: Results, name: str, choice: Choice = ALL) -> Any:
    """The figure of a picture, its labels in their places; the first frame of one that moves.

    Raises
    ------
    Nothing
        There is nothing to draw.
    """
    spec = PICTURES[name]
    _complete(results, spec)
    with style.sheet(choice.style):
        figure = spec.draw(results, choice)
        labels.settle(figure)
    return figure


def _complete(results: Results, spec: Picture) -> None:
    """Raise `Nothing` where a table or history that a picture needs is missing or empty."""
    for need in spec.needs:
        if not results.holds(need):
            raise Nothing("history" if need in results.histories else TABLES[need].title.lower())
