"""Pictures of the page that show extremes: displacements over the height, and collisions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pound_solve.report.html.picture import (
    COLOURS,
    MOST_POINTS,
    PlotlyPicture,
    curve,
    numbers,
    plain,
    thinned,
)
from pound_solve.report.plot import courses
from pound_solve.report.plot.geometry import broken_line
from pound_solve.report.plot.pictures import collisions, envelopes
from pound_solve.results import Results


def columns_of_nodes(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the extreme displacements of nodes above each other."""
    if not all(map(results.holds, envelopes.SPEC.needs)):
        return
    columns = envelopes.columns_of_nodes(results)
    names = [f"node {node}" for nodes in columns for node in (*nodes, "")]
    traces = []
    for name, row, line in (
        ("to the right", 2, {"color": COLOURS[0]}),
        ("to the left", 1, {"color": COLOURS[3], "dash": "dash"}),
    ):
        x, y = broken_line(column[[row, 0]].T for column in columns.values())
        look = {"mode": "lines+markers", "marker": {"size": 4}, "line": line, "text": names}
        traces.append(curve(name, x, y) | look)
    unit, note = results.units.length, "Nodes above each other are connected."
    axes = f"displacement X [{unit}]", f"height [{unit}]"
    yield PlotlyPicture("Extreme displacements over the height", note, *axes, traces if columns else [])


def peaks_of_collisions(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the peak force of every collision, or of impulses where no collision has a force."""
    if not all(map(results.holds, collisions.SPEC.needs)):
        return
    column, when, size = collisions.peaks(results)
    traces = []
    for n, name in enumerate(results.labels("contact/force")):
        rows = courses.of_contact(results, name)
        rows = rows[np.isfinite(rows[column])]
        t, peaks = thinned(rows[when], rows[column])
        traces.append({
            "name": plain(name), "mode": "markers", "x": numbers(t), "y": numbers(peaks),
            "marker": {"size": 6, "color": COLOURS[n % len(COLOURS)]},
            # lines down to zero
            "error_y": {"type": "percent", "symmetric": False, "value": 0, "valueminus": 100, "width": 0},
        })  # fmt: skip
    title = f"{size.partition(' [')[0].capitalize()}s of the collisions"
    shown = [trace for trace in traces if trace["x"]]
    yield PlotlyPicture(title, "", f"time [{results.units.time}]", size, shown, time=True)


def closures(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the times at which each contact was closed."""
    if not all(map(results.holds, collisions.SPEC.needs)):
        return
    contacts, traces = results.labels("contact/force"), []
    for n, name in enumerate(contacts):
        rows = courses.of_contact(results, name)
        rows = rows[np.sort(np.argsort(-rows["peak_force"])[:MOST_POINTS])]  # the hardest of very many
        start, end = collisions.times_closed(results, rows)
        x = np.column_stack([start, end, np.full(len(start), np.nan)]).ravel()
        look = {"mode": "lines+markers", "line": {"color": COLOURS[n % len(COLOURS)], "width": 10},
                "marker": {"symbol": "line-ns-open", "size": 10}, "showlegend": False}  # fmt: skip
        traces.append(curve(name, x, np.full(len(x), n)) | look)
    axes = f"time [{results.units.time}]", ""
    yield PlotlyPicture("Times at which contacts were closed", "", *axes, traces, time=True, rows=contacts)
