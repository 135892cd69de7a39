"""Pictures of a results file by matplotlib (extra `plot`), which `style` imports on demand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pound_solve.report.plot import course, structure, style
from pound_solve.report.plot.loop import loop
from pound_solve.report.plot.spectrum import spectra
from pound_solve.report.plot.study import study
from pound_solve.report.plot.style import Nothing, ready
from pound_solve.results import Results
from pound_solve.results.contents import TABLES

__all__ = ("PICTURES", "Nothing", "draw", "draw_into", "loop", "possible", "ready", "spectra")

#: Every picture: what draws it, and the tables and histories that it needs.
PICTURES: Mapping[str, tuple[Callable[[Results], Any], tuple[str, ...]]] = MappingProxyType(
    {
        "frame": (structure.frame, ("nodes", "elements")),
        "modes": (structure.modes, ("mode_shapes",)),
        "deformed": (structure.deformed, ("node/u",)),
        "envelopes": (structure.envelopes, ("node_envelope",)),
        "histories": (course.histories, ("drift",)),
        "energy": (course.energy, ("energy",)),
        "loops": (course.loops, ("spring/force",)),
        "contacts": (course.contacts, ("contact/force",)),
        "collisions": (course.collisions, ("collisions", "contact/force")),
        "study": (study, ("study",)),
    }
)


def possible(results: Results) -> list[str]:
    """Pictures that the file has the tables and histories for, be they empty."""
    held = {*results.tables, *results.histories}
    return [name for name, (_, needs) in PICTURES.items() if held >= set(needs)]


def draw(
    results: Results, names: Sequence[str], folder: Path, ending: str = "svg"
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
        ``svg``, ``png`` or ``pdf``.

    Returns
    -------
    drawn : list of Path
    left_out : dict of str to list of str
        Pictures that have nothing to draw, by what the file has none of.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    """
    ready(folder)
    drawn: list[Path] = []
    left_out: dict[str, list[str]] = {}
    for name in names:
        path = folder / f"{results.path.stem}_{name}.{ending}"
        try:
            draw_into(results, name, path)
        except Nothing as why:
            left_out.setdefault(str(why), []).append(name)
        else:
            drawn.append(path)
    return drawn, left_out


def draw_into(results: Results, name: str, path: Path) -> None:
    """Draw one picture into a file, whose ending names the format; see `draw`.

    Raises
    ------
    Nothing
        There is nothing to draw.
    """
    picture, needs = PICTURES[name]
    for need in needs:
        if not results.holds(need):
            raise Nothing("history" if need in results.histories else TABLES[need].title.lower())
    style.save(picture(results), path)
