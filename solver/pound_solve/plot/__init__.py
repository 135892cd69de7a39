"""Pictures of a results file by matplotlib (extra `plot`), which `style` imports when asked."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pound_solve.plot import course, structure, style
from pound_solve.plot.loop import loop
from pound_solve.plot.study import study
from pound_solve.plot.style import ready
from pound_solve.results import Results

__all__ = ("PICTURES", "draw", "draw_into", "loop", "possible", "ready")

#: Every picture: what draws it, and the tables and histories that it needs.
PICTURES: Mapping[str, tuple[Callable[[Results], Any], tuple[str, ...]]] = MappingProxyType(
    {
        "frame": (structure.frame, ("nodes", "elements")),
        "modes": (structure.modes, ("mode_shapes",)),
        "deformed": (structure.deformed, ("node/u",)),
        "envelopes": (structure.envelopes, ("drift_envelope", "node_envelope")),
        "histories": (course.histories, ("drift",)),
        "energy": (course.energy, ("energy",)),
        "loops": (course.loops, ("spring/force",)),
        "contacts": (course.contacts, ("contact/force",)),
        "collisions": (course.collisions, ("collisions", "contact/force")),
        "study": (study, ("study",)),
    }
)


def possible(results: Results) -> list[str]:
    """Pictures that the file holds the numbers for."""
    held = {*results.tables, *results.histories}
    return [name for name, (_, needs) in PICTURES.items() if held >= set(needs)]


def draw(results: Results, names: Sequence[str], folder: Path, ending: str = "svg") -> list[Path]:
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
    list of Path

    Raises
    ------
    ImportError
        matplotlib is not installed.
    """
    ready(folder)
    out = []
    for name in names:
        out.append(folder / f"{results.path.stem}_{name}.{ending}")
        draw_into(results, name, out[-1])
    return out


def draw_into(results: Results, name: str, path: Path) -> None:
    """Draw one picture into a file, whose ending names the format; see `draw`."""
    style.save(PICTURES[name][0](results), path)
