"""Picture `envelopes`: largest drifts of the deck, and horizontal displacements over the height."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.geometry import DrawnStructure
from pound_solve.report.plot.overlay import curves
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

MOST_COLUMNS = 12  #: panels where runs are drawn over each other


def envelopes(results: Results, choice: Choice) -> Any:
    """Draw drifts in the order of the deck and nodes above each other over the height, as available."""
    drifts = results.holds("drift_envelope")
    columns = columns_of_nodes(results)
    count = drifts + bool(columns)
    if not count:
        raise Nothing("drifts, no columns of nodes")
    rows = len(results.table("drift_envelope")) if drifts else 0
    figure = style.figure(4.75 * count, max(4.2, 0.16 * rows + 1.0))
    if drifts:
        _drifts(figure.add_subplot(1, count, 1), results)
    if columns:
        axes = figure.add_subplot(1, count, count)
        unit = results.units.length
        style.grid(axes, f"displacement X [{unit}]", f"height [{unit}]")
        for height, low, high in columns.values():
            axes.plot(low, height, color=style.RED, linestyle="--", marker=".")
            axes.plot(high, height, color=style.BLUE, linestyle="-", marker=".")
        axes.axvline(0.0, color="0.3", linewidth=0.8)
        axes.margins(x=0.06)
        axes.set_title(
            "largest displacements to the right (lines) and to the left\n(dashes) of each column of nodes"
        )
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw extremes of displacements over the height: a panel for each column of nodes, a colour for each
    run.
    """
    drawn = [(look, columns_of_nodes(run)) for run, look in curves(runs) if run.holds("node_envelope")]
    panels = list(dict.fromkeys(nodes for _, columns in drawn for nodes in columns))[:MOST_COLUMNS]
    if not panels:
        raise Nothing("columns of nodes")
    title = "largest displacements to the right (lines) and to the left (dashes)"
    figure, all_axes = style.panels(len(panels), title)
    unit = runs[0].units.length
    for axes, nodes in zip(all_axes, panels):
        style.grid(axes, f"displacement X [{unit}]", f"height [{unit}]")
        axes.axvline(0.0, color="0.3", linewidth=0.8)
        axes.set_title(f"nodes {nodes[0]} to {nodes[-1]}")
        for look, columns in drawn:
            if nodes in columns:
                height, low, high = columns[nodes]
                axes.plot(low, height, **{**look, "linestyle": "--", "marker": ".", "label": None})
                axes.plot(high, height, **{**look, "linestyle": "-", "marker": "."})
    style.legend_below(figure, all_axes)
    return figure


def _drifts(axes: Any, results: Results) -> None:
    drifts = results.table("drift_envelope")
    rows = np.arange(len(drifts))
    style.grid(axes, f"drift [{results.units.length}]")
    axes.barh(rows, drifts["max"], color=style.BLUE, height=0.6)
    axes.barh(rows, drifts["min"], color=style.RED, height=0.6)
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.margins(x=0.06)
    room = max(0.6, 2.5 - 0.5 * len(rows))  # a few bars do not fill the picture
    axes.set_ylim(-room, len(rows) - 1 + room)
    axes.set_yticks(rows, [style.short(str(n)) for n in drifts["name"]])
    axes.set_title("largest drifts to both sides, in the order of the deck")


def columns_of_nodes(results: Results) -> dict[tuple[int, ...], Array]:
    """Heights, smallest and largest displacements X of the nodes above each other, shape (3, n) each,
    for the numbers of the nodes from below.
    """
    place, table = DrawnStructure(results).place, results.table("node_envelope")
    envelope = table[(table["direction"] == "X") & (table["quantity"] == "displacement")]
    lines: dict[float, list[tuple[float, int, float, float]]] = {}
    for row in envelope:
        x, y = place[int(row["node"])].tolist()
        lines.setdefault(x, []).append((y, int(row["node"]), float(row["min"]), float(row["max"])))
    return {
        tuple(node for _, node, _, _ in line): np.array([(y, low, high) for y, _, low, high in line]).T
        for line in map(sorted, lines.values())
        if len({y for y, _, _, _ in line}) > 1
    }


SPEC = Picture(
    name="envelopes",
    place=60,
    shows="largest drifts to both sides; extremes of horizontal displacements over the height",
    needs=("node_envelope", "nodes", "elements"),
    draw=envelopes,
    overlay=overlay,
)
