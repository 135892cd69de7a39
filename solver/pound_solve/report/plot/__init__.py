"""Pictures of a results file by matplotlib (extra `plot`), which `style` imports on demand."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pound_solve.report.plot import labels, style
from pound_solve.report.plot.catalog import PICTURES
from pound_solve.report.plot.loop import loop
from pound_solve.report.plot.overlay import check_units, run_names
from pound_solve.report.plot.schema import ALL, Choice, ChoiceError, Nothing, Picture
from pound_solve.report.plot.spectrum import spectra
from pound_solve.report.plot.style import ready, sheet
from pound_solve.results import Results
from pound_solve.results.contents import TABLES

__all__ = (
    "ALL", "PICTURES", "Choice", "ChoiceError", "Nothing", "draw", "draw_into", "loop",
    "overlaid", "picture", "possible", "ready", "sheet", "spectra",
)  # fmt: skip


def possible(results: Results | Sequence[Results], ending: str = "svg") -> list[str]:
    """Pictures of a format that the file has the tables and histories for, be they empty; of several files,
    those that draw runs over each other and that one of the files has all for.
    """
    runs = [results] if isinstance(results, Results) else results
    held = [{*run.tables, *run.histories} for run in runs]
    return [
        p.name
        for p in PICTURES.values()
        if ending in p.endings
        and any(there >= set(p.needs) for there in held)
        and (len(runs) == 1 or p.overlay is not None)
    ]


def draw(
    results: Results | Sequence[Results],
    names: Sequence[str],
    folder: Path,
    ending: str = "svg",
    choice: Choice = ALL,
) -> tuple[list[Path], dict[str, list[str]]]:
    """Draw pictures into files ``<results>_<picture>.<ending>``.

    Parameters
    ----------
    results : Results or sequence of Results
        Several runs are drawn over each other, in pictures that have an `overlay`; the files are then named
        ``<first>_vs_<second>_<picture>.<ending>``.
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
        The file has not what is chosen, or runs are in different units.
    """
    runs = [results] if isinstance(results, Results) else results
    ready(folder)
    drawn: list[Path] = []
    left_out: dict[str, list[str]] = {}
    for name in names:
        path = folder / f"{_stem(runs)}_{name}.{ending}"
        try:
            if len(runs) > 1:
                with style.sheet(choice.style):
                    style.save(overlaid(runs, name, choice), path)
            else:
                draw_into(runs[0], name, path, choice)
        except Nothing as why:
            left_out.setdefault(str(why), []).append(name)
        else:
            drawn.append(path)
    return drawn, left_out


def _stem(runs: Sequence[Results]) -> str:
    """First part of the names of pictures."""
    first, *others = run_names([run.path for run in runs])
    more = others if len(others) < 2 else [f"{len(others)}_others"]
    return "_vs_".join([first, *more]).replace("/", "_")


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


def overlaid(runs: Sequence[Results], name: str, choice: Choice = ALL) -> Any:
    """The figure of a picture that draws several runs over each other, its labels in their places.

    Raises
    ------
    Nothing
        There is nothing to draw in any of them.
    ChoiceError
        Their units differ, or a run has not what is chosen.
    """
    check_units(runs)
    spec = PICTURES[name]
    assert spec.overlay is not None
    if not any(all(run.holds(need) for need in spec.needs) for run in runs):
        _complete(runs[0], spec)
    with style.sheet(choice.style):
        figure = spec.overlay(runs, choice)
        labels.settle(figure)
    return figure


def _complete(results: Results, spec: Picture) -> None:
    """Raise `Nothing` where a table or history that a picture needs is missing or empty."""
    for need in spec.needs:
        if not results.holds(need):
            is_history = need in results.histories or need not in TABLES
            raise Nothing("history" if is_history else TABLES[need].title.lower())
