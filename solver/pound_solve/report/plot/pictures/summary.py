"""Picture `summary`: one page (A4) to be stapled to the report."""

from __future__ import annotations

from typing import Any

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.geometry import DrawnStructure
from pound_solve.report.plot.pictures import base_shear, capacity, frame, storeys
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results
from pound_solve.version import __version__

PAGE = (8.27, 11.69)  #: inches
MOST_FIGURES = 16  #: lines of figures
WIDTH = 58  #: characters of a line


def summary(results: Results, choice: Choice) -> Any:
    """Draw the structure and the main figures, what there is of the histories, and profiles."""
    figure = style.figure(*PAGE, title=results.title)
    rows = _rows(results)
    heights = [2.6, *[1.45] * len(rows)]
    profiles = all(results.holds(name) for name in storeys.SPEC.needs)
    if profiles:
        heights.append(2.2)
    parts = figure.subfigures(len(heights) + 1, 1, height_ratios=[*heights, 0.25])
    head, *courses_, foot = parts
    axes, text = head.subplots(1, 2, width_ratios=(1.15, 1.0))
    _structure(axes, results)
    _figures(text, results)
    for part, draw in zip(courses_, rows):
        draw(part.subplots())
    if profiles:
        _profiles(courses_[-1], results)
    foot.text(0.01, 0.5, _foot(results), fontsize=6.5, color="0.4", va="center")
    return figure


def _rows(results: Results) -> list[Any]:
    """What draws each panel over time, of what the file has."""
    out: list[Any] = []
    wanted = ["ground", "drift", "base", "contact/force"]
    for n, name in enumerate(wanted):
        last = n == len(wanted) - 1
        if name == "base":
            if all(map(results.holds, base_shear.SPEC.needs)):
                out.append(lambda axes: base_shear.panel(axes, results))
        elif name in results.histories and len(results.time):
            out.append(lambda axes, name=name, last=last: courses.panel(axes, results, name, last=last))
    if not out and results.holds("capacity_curve"):
        out.append(lambda axes: capacity.curve(axes, results))
    return out


def _structure(axes: Any, results: Results) -> None:
    """Draw the structure with the names of its contacts."""
    s = DrawnStructure(results)
    frame.panel(axes, s)
    axes.set_title("structure", loc="left")


def _figures(axes: Any, results: Results) -> None:
    """Write the main figures as lines, item and value."""
    axes.set_axis_off()
    lines: list[tuple[str, str]] = []
    if "overview" in results.tables:
        lines += [(str(item), str(value)) for item, value in results.table("overview").tolist()]
    if results.status != "done":
        lines.insert(0, ("this run", f"{results.status}: {results.message}".rstrip(": ")))
    if "checks" in results.tables:
        bad = [row for row in results.table("checks") if not str(row["verdict"]).startswith("good")]
        lines += [("look at", f"{row['check']}: {row['value']}") for row in bad]
    if results.holds("warnings"):
        lines.append(("warnings", f"{len(results.table('warnings'))}, see the report"))
    text = [style.wrapped(f"{item}: {value}", WIDTH) for item, value in lines[:MOST_FIGURES]]
    axes.text(0.0, 1.0, "\n".join(text), va="top", fontsize=7, transform=axes.transAxes, linespacing=1.35)


def _profiles(part: Any, results: Results) -> None:
    """Draw the three profiles of all buildings, a colour for each."""
    names = list(dict.fromkeys(results.table("storey_envelope")["building"].tolist()))
    all_axes = part.subplots(1, 3, sharey=True)
    for axes, quantity in zip(all_axes, storeys.PROFILES):
        storeys.panel(axes, results, names, quantity)
        axes.label_outer()
    style.legend(all_axes[-1])


def _foot(results: Results) -> str:
    own = f"pound-solve {__version__}, {results.path.name}"
    return f"{own}, digest {results.digest[:16]}" if results.digest else own


SPEC = Picture(
    name="summary",
    place=10,
    shows="one page (A4): structure, main figures, base point motions, drifts, base shears, contact forces, "
    "profiles of the storeys",
    needs=("nodes", "elements"),
    draw=summary,
)
