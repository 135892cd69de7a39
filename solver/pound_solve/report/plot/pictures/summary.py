"""Picture `summary`: one page (A4) to be stapled to the report."""

from __future__ import annotations

from functools import partial
from typing import Any

from pound_solve.check import looked
from pound_solve.report.plot import courses, style
from pound_solve.report.plot.geometry import DrawnStructure, apart
from pound_solve.report.plot.members import members
from pound_solve.report.plot.pictures import base_shear, capacity, diagrams, frame, storeys
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results
from pound_solve.version import __version__

PAGE = (8.27, 11.69)  #: inches
MOST_LINES = 26  #: of the main figures
WIDTH = 58  #: characters of a line
SIZE, SPACING = 7.0, 1.35  #: of the letters [pt]; lines over letters


def summary(results: Results, choice: Choice) -> Any:
    """Draw the structure and the main figures, what there is of the histories, and profiles."""
    figure = style.figure(*PAGE, title=results.title)
    rows = _rows(results)
    profiles = all(results.holds(name) for name in storeys.SPEC.needs)
    figures_text = _figures(results)
    heights = [
        max(2.6, 0.5 + len(figures_text) * SIZE * SPACING / 72.0),
        (1.5 if len(rows) > 1 else 4.0) * len(rows) + 0.01,
        2.3 * profiles + 0.01,
        0.35,
    ]
    head, middle, low, foot = figure.subfigures(4, 1, height_ratios=heights)
    axes, text = head.subplots(1, 2, width_ratios=(1.15, 1.0))
    _structure(axes, results)
    text.set_axis_off()
    text.text(
        0.0,
        1.0,
        "\n".join(figures_text),
        va="top",
        fontsize=SIZE,
        transform=text.transAxes,
        linespacing=SPACING,
    )
    if rows:
        for draw, panel in zip(rows, middle.subplots(len(rows), 1, squeeze=False, sharex=True).ravel()):
            draw(panel)
    if profiles:
        _profiles(low, results)
    foot.text(0.01, 0.5, _foot(results, profiles), fontsize=6.5, color="0.4", va="center")
    return figure


def _rows(results: Results) -> list[Any]:
    """Functions that draw the panels: histories that the file has, else the capacity curve or moments."""
    if not len(results.time):
        if results.holds("capacity_curve"):
            return [partial(capacity.curve, results=results, push=1)]
        return [partial(_moments, results=results)] if members(results) else []
    panels: list[Any] = []
    for name in ("ground", "drift", "base", "contact/force"):
        if name == "base":
            if all(map(results.holds, base_shear.SPEC.needs)) and base_shear.moves(results):
                panels.append(partial(base_shear.panel, results=results, last=False))
        elif results.holds(name):
            panels.append(partial(courses.panel, results=results, name=name, last=False))
    return [*panels[:-1], partial(panels[-1], last=True)] if panels else []


def _moments(axes: Any, results: Results) -> None:
    """Draw the bending moments of the static state."""
    diagrams.panel(axes, *diagrams.spread(results, Choice()), "M")


def _structure(axes: Any, results: Results) -> None:
    """Draw the structure with the names of its contacts."""
    s = DrawnStructure(results, apart())
    frame.panel(axes, s, 220.0)
    axes.set_title("structure", loc="left")


def _figures(results: Results) -> list[str]:
    """Lines of the main figures, cut to the room there is; checks that call for a look are kept longest."""
    lines = list[tuple[str, str]]()
    if "overview" in results.tables:
        lines += [(str(item), str(value)) for item, value in results.table("overview").tolist()]
    if results.status != "done":
        lines.insert(0, ("this run", f"{results.status}: {results.message}".rstrip(": ")))
    looks = [("look at", f"{check.name}: {check.value_text}") for check in looked(results.checks)]
    first, last = _wrapped(lines), _wrapped(looks)[: MOST_LINES // 2]
    room = MOST_LINES - len(last)
    return [*first[: room - 1], "…", *last] if len(first) > room else first + last


def _wrapped(lines: list[tuple[str, str]]) -> list[str]:
    return [line for item, value in lines for line in style.wrapped(f"{item}: {value}", WIDTH).splitlines()]


def _profiles(part: Any, results: Results) -> None:
    """Draw the three profiles of all buildings, a colour for each."""
    names = list(dict.fromkeys(results.table("storey_envelope")["building"].tolist()))
    all_axes = part.subplots(1, 3, sharey=True)
    for axes, quantity in zip(all_axes, storeys.PROFILES):
        storeys.panel(axes, results, names, quantity)
        axes.label_outer()
    style.legend(all_axes[-1])


def _foot(results: Results, profiles: bool) -> str:
    imprint = f"pound-solve {__version__}, {results.path.name}"
    rings = ["rings: true peaks"] if len(results.time) else []
    sides = ["profiles: lines to the right, dashes to the left"] if profiles else []
    imprint += f", digest {results.digest[:16]}" if results.digest else ""
    return "\n".join(filter(None, ["; ".join(rings + sides), imprint]))


SPEC = Picture(
    name="summary",
    place=10,
    shows="one page (A4): structure, figures, ground motions, drifts, base shears, contacts, profiles",
    needs=("nodes", "elements"),
    draw=summary,
)
