"""Pictures of the page that show the structure: displaced, in its modes, and where it has yielded."""

from __future__ import annotations

from collections.abc import Iterator
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
from pound_solve.results import Results

MOST_MODES: Final = 8
GREY: Final = "#b0b0b0"  #: at rest
BLUE: Final = "#0b4f8a"  #: displaced


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
        traces.append(_line("displaced", s.path(shift), BLUE))
    traces.insert(0, _line("at rest", s.path(), GREY))
    ends = [s.ends(c, shift) for c in s.contacts]
    marked = {"mode": "lines+markers", "marker": {"symbol": "square-open", "size": 9, "color": "#b3301e"}}
    traces.append(_line("contacts", broken_line((tip, end) for _, tip, end in ends), "#b3301e") | marked)
    arms = [(start, tip) for start, tip, _ in ends if not np.array_equal(start, tip)]
    traces.append(_line("rigid arms of contacts", broken_line(arms), "#b3301e"))
    place = {n: xy + shift.at(n) for n, xy in s.place.items()}
    traces.append(
        {
            "name": "nodes", "mode": "markers", "marker": {"size": 5, "color": "#333"},
            "x": numbers(xy[0] for xy in place.values()), "y": numbers(xy[1] for xy in place.values()),
            "text": [f"node {n}" for n in place], "hoverinfo": "text",
        }
    )  # fmt: skip
    yield _of_structure("Structure", note, s, [t for t in traces if t["x"]])


def _of_structure(title: str, note: str, s: DrawnStructure, traces: list[Trace]) -> PlotlyPicture:
    length = s.units.length
    return PlotlyPicture(title, note, f"X [{length}]", f"Y [{length}]", traces, equal=True)


def _line(name: str, points: Array, colour: str = "") -> Trace:
    """A line with gaps through points, shape (2, n); without `colour`, in the next one of plotly.js."""
    x, y = map(numbers, points)
    line = {"color": colour} if colour else {}
    return {"name": name, "mode": "lines", "line": line, "x": x, "y": y, "hoverinfo": "skip"}


def mode_shapes(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the mode shapes, drawn to one size; at first the first mode is visible."""
    if not all(map(results.holds, modes.SPEC.needs)):
        return
    s, shapes = DrawnStructure(results, apart(2.0 * SHARE)), results.table("mode_shapes")
    periods = {int(m["mode"]): float(m["period"]) for m in results.table("modes")}
    traces = [_line("at rest", s.path(), GREY)]
    for n, mode in enumerate(dict.fromkeys(shapes["mode"].tolist())):
        shape = shapes[shapes["mode"] == mode]
        bent = s.path(mode_shift(shape, s.size))
        line = _line(f"mode {mode}, {periods[mode]:.4g} {s.units.time}", bent)
        traces.append(line if n == 0 else line | {"visible": "legendonly"})
    note = "A click on a name shows its shape, or hides it. All shapes are drawn to one size."
    yield _of_structure("Mode shapes", note, s, traces[: MOST_MODES + 1])


def yielded(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of springs and hinges, coloured by their ductility; the worst stands above others."""
    if not all(map(results.holds, hinges.SPEC.needs)):
        return
    rows = results.table("spring_envelope")
    rows = np.sort(rows[np.isfinite(rows["ductility"])], order="ductility")
    if not len(rows):
        return
    s = DrawnStructure(results, apart())
    traces = [_line("members", s.path(), GREY)]
    for colour, (_, word) in zip(hinges.COLOURS, reversed(hinges.DUCTILITY)):
        of_class = [r for r in rows if hinges.state(float(r["ductility"]), hinges.DUCTILITY) == word]
        if of_class:
            traces.append(_discs(s, word, colour, of_class))
    note = "The ductility is the largest deformation over that at yield."
    yield _of_structure("Ductilities of springs and hinges", note, s, traces)


def _discs(s: DrawnStructure, name: str, colour: str, rows: list[NDArray[Any]]) -> Trace:
    """Discs at springs and hinges, named by element, component and ductility."""
    places = [s.component(int(r["element"]), str(r["component"])) for r in rows]
    texts = [f"{r['element']} {r['component']}: ductility {r['ductility']:.4g}" for r in rows]
    return {
        "name": name, "mode": "markers", "text": list(map(plain, texts)), "hoverinfo": "text",
        "marker": {"size": 9, "color": colour, "line": {"width": 1, "color": "#333"}},
        "x": numbers(xy[0] for xy in places), "y": numbers(xy[1] for xy in places),
    }  # fmt: skip
