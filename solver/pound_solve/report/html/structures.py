"""Pictures of the page that show the structure: displaced, loaded, in modes, and where it yielded."""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.html.picture import PlotlyPicture, Trace, numbers, plain
from pound_solve.report.plot.geometry import (
    SHARE,
    UNDISPLACED,
    DrawnStructure,
    apart,
    broken_line,
    displacements,
    mode_shift,
)
from pound_solve.report.plot.pictures import hinges, modes
from pound_solve.report.plot.pictures import loads as static_loads
from pound_solve.results import Results

MOST_MODES: Final = 8
MOST_VALUES: Final = 40  #: of loads, beside which a text has room; else a pointer shows them
GREY: Final = "#b0b0b0"  #: at rest
BLUE: Final = "#0b4f8a"  #: displaced
RED: Final = "#b3301e"  #: contacts and loads
#: titles and notes of the maps of springs and hinges by what they show
TITLES: Final = MappingProxyType(
    {
        "ductility": (
            "Ductilities of springs and hinges",
            "The ductility is the largest deformation over that at yield.",
        ),
        "index": ("Damage of springs and hinges", "The index of Park and Ang; 1 is failure."),
    }
)


def structure(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the structure, undeformed and at the instant of its largest displacement."""
    if not results.holds("nodes"):
        return
    s, note, shift = DrawnStructure(results, apart()), "", UNDISPLACED
    traces: list[Trace] = []
    if results.holds("node/u"):
        displaced = displacements(results)
        s, shift = displaced.structure, displaced.shift(displaced.row)
        note = (
            f"The displacements are those at {results.time[displaced.row]:.6g} {s.units.time}, "
            f"when the largest is {displaced.largest:.5g} {s.units.length}. "
            f"Displacements and gaps are drawn {displaced.factor:.3g} times as large."
        )
        traces.append(line("displaced", s.path(shift), BLUE))
    traces.insert(0, line("at rest", s.path(), GREY))
    ends = [s.ends(c, shift) for c in s.contacts]
    marked = {"mode": "lines+markers", "marker": {"symbol": "square-open", "size": 9, "color": RED}}
    traces.append(line("contacts", broken_line((tip, end) for _, tip, end in ends), RED) | marked)
    arms = [(start, tip) for start, tip, _ in ends if not np.array_equal(start, tip)]
    traces.append(line("rigid arms of contacts", broken_line(arms), RED))
    place = {n: xy + shift.at(n) for n, xy in s.place.items()}
    traces.append(
        {
            "name": "nodes", "mode": "markers", "marker": {"size": 5, "color": "#333"},
            "x": numbers(xy[0] for xy in place.values()), "y": numbers(xy[1] for xy in place.values()),
            "text": [f"node {n}" for n in place], "hoverinfo": "text",
        }
    )  # fmt: skip
    yield of_structure("Structure", note, s, [t for t in traces if t["x"]])


def of_structure(title: str, note: str, s: DrawnStructure, traces: list[Trace]) -> PlotlyPicture:
    """A picture in the plane of the structure, with equal scales."""
    length = s.units.length
    return PlotlyPicture(title, note, f"X [{length}]", f"Y [{length}]", traces, equal=True)


def line(name: str, points: Array, colour: str = "") -> Trace:
    """A line with gaps through points, shape (2, n); without `colour`, in the next one of plotly.js."""
    x, y = map(numbers, points)
    look = {"color": colour} if colour else {}
    return {"name": name, "mode": "lines", "line": look, "x": x, "y": y, "hoverinfo": "skip"}


def mode_shapes(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the mode shapes, drawn to one size; at first the first mode is visible."""
    if not all(map(results.holds, modes.SPEC.needs)):
        return
    s, shapes = DrawnStructure(results, apart(2.0 * SHARE)), results.table("mode_shapes")
    periods = {int(m["mode"]): float(m["period"]) for m in results.table("modes")}
    traces = [line("at rest", s.path(), GREY)]
    for n, mode in enumerate(dict.fromkeys(shapes["mode"].tolist())):
        shape = shapes[shapes["mode"] == mode]
        bent = s.path(mode_shift(shape, s.size))
        trace = line(f"mode {mode}, {periods[mode]:.4g} {s.units.time}", bent)
        traces.append(trace if n == 0 else trace | {"visible": "legendonly"})
    note = "A click on a name shows its shape, or hides it. All shapes are drawn to one size."
    yield of_structure("Mode shapes", note, s, traces[: MOST_MODES + 1])


def loads(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the static loads: an arrow for each point load, a comb for each line load."""
    if not all(map(results.holds, static_loads.SPEC.needs)):
        return
    s = DrawnStructure(results, apart())
    drawn = list(static_loads.arrows_of_loads(results, s))
    if not drawn:
        return
    arrows = [arrow for tails, heads, _ in drawn for arrow in np.stack([tails, heads], axis=1)]
    combs = [tails for tails, _, _ in drawn if len(tails) > 1]
    heads = {"symbol": "arrow", "angleref": "previous", "size": [0, 9, 0] * len(arrows)}
    middles = np.array([tails[len(tails) // 2] for tails, _, _ in drawn]).T
    values = {
        "mode": "text" if len(drawn) <= MOST_VALUES else "markers", "marker": {"opacity": 0},
        "text": [plain(text).replace("\n", "<br>") for _, _, text in drawn], "hoverinfo": "text",
        "textposition": "top center", "textfont": {"size": 10, "color": RED},
    }  # fmt: skip
    traces = [
        line("loads", broken_line(arrows), RED) | {"mode": "lines+markers", "marker": heads},
        line("lines of loads", broken_line(combs), RED) | {"showlegend": False},
        line("values", middles, RED) | values | {"showlegend": False},
    ]
    traces = [line("at rest", s.path(), GREY), *(trace | {"legendgroup": "loads"} for trace in traces)]
    note = "Masses and the motion of the ground are not loads here. A pointer on a load shows its value."
    yield of_structure("Static loads", note, s, traces)


def yielded(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of springs and hinges, coloured by their ductility and by their damage; the worst stands
    above others.
    """
    if not all(map(results.holds, hinges.SPEC.needs)):
        return
    s = DrawnStructure(results, apart())
    for shown in hinges.maps(results):
        traces = [line("members", s.path(), GREY)]
        rows = np.sort(shown.rows, order=shown.column)
        for colour, (_, word) in zip(hinges.COLOURS, reversed(shown.classes)):
            of_class = [r for r in rows if hinges.state(float(r[shown.column]), shown.classes) == word]
            if of_class:
                traces.append(_discs(s, word, colour, of_class, shown.column))
        title, note = TITLES[shown.column]
        yield of_structure(title, note, s, traces if len(rows) else [])


def _discs(s: DrawnStructure, name: str, colour: str, rows: list[NDArray[Any]], column: str) -> Trace:
    """Discs at springs and hinges, named by element, component and value."""
    places = [s.component(int(r["element"]), str(r["component"])) for r in rows]
    texts = [f"{r['element']} {r['component']}: {column} {r[column]:.4g}" for r in rows]
    return {
        "name": name, "mode": "markers", "text": list(map(plain, texts)), "hoverinfo": "text",
        "marker": {"size": 9, "color": colour, "line": {"width": 1, "color": "#333"}},
        "x": numbers(xy[0] for xy in places), "y": numbers(xy[1] for xy in places),
    }  # fmt: skip
