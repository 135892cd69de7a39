"""Pictures of the page that show forces of members: diagrams, and axial forces over moments of hinges."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.html.picture import COLOURS, PlotlyPicture, Trace, curve
from pound_solve.report.html.structures import GREY, RED, line, of_structure
from pound_solve.report.plot.geometry import DrawnStructure
from pound_solve.report.plot.members import QUANTITIES, MemberForces
from pound_solve.report.plot.pictures import diagrams as drawn
from pound_solve.report.plot.pictures import interaction
from pound_solve.report.plot.schema import ALL
from pound_solve.results import Results

STRAIGHT: Final = 1e-4  #: of the largest value: a value so near to a line is left out
CELLS: Final = 400  #: of a picture along each axis: a path that stays within one cell is not drawn on


def diagrams(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of the extreme forces along the members, each of one quantity."""
    if not all(map(results.holds, drawn.SPEC.needs)):
        return
    s, members = drawn.spread(results, ALL)
    for quantity, (word, *_) in QUANTITIES.items():
        chosen = [member for member in members if quantity in member.low]
        if not chosen:
            continue
        low, high = drawn.extremes(chosen, quantity)
        unit = results.units.text(drawn.UNITS[quantity])
        note = f"From {low:.5g} to {high:.5g} {unit}. "
        note += "Drawn on the side in tension. " * (quantity == "M")
        note += "A pointer on a curve shows the member and the value."
        title = f"{drawn.title(results, ALL)}: {word} {quantity} [{unit}]"
        traces = [
            line("members", s.path(), GREY),
            *_diagram(s, chosen, quantity),
            _ends(s, chosen, quantity),
        ]
        yield of_structure(title, note, s, traces)


def _diagram(s: DrawnStructure, members: list[MemberForces], quantity: str) -> Iterator[Trace]:
    """Shaded outlines of the largest and of the smallest values, or of the only ones."""
    factor = drawn.scale(s, members, quantity)
    sides = [(quantity, COLOURS[0], [m.low[quantity] for m in members])]
    if any(not np.array_equal(m.low[quantity], m.high[quantity]) for m in members):
        sides = [("largest", COLOURS[0], [m.high[quantity] for m in members]),
                 ("smallest", COLOURS[3], [m.low[quantity] for m in members])]  # fmt: skip
    least = STRAIGHT * max(map(abs, drawn.extremes(members, quantity)))
    for name, colour, values in sides:
        points, texts = [np.zeros((2, 0))], list[str]()
        for member, along in zip(members, values):
            keep = bends(member.x, along, least)
            base, edge = (p[:, keep] for p in drawn.outline(member, along, quantity, factor))
            points += [base[:, :1], edge, base[:, -1:], np.full((2, 1), np.nan)]
            texts += ["", *(f"{member.element}: {value:.5g}" for value in along[keep]), "", ""]
        look = {
            "fill": "toself", "hoveron": "points", "hoverinfo": "text", "text": texts,
            "line": {"color": colour, "width": 1},
        }  # fmt: skip
        yield curve(name, *np.hstack(points)) | look


def _ends(s: DrawnStructure, members: list[MemberForces], quantity: str) -> Trace:
    """Texts at the largest and at the smallest value of all members."""
    factor = drawn.scale(s, members, quantity)
    highest = max(members, key=lambda m: float(m.high[quantity].max()))
    lowest = min(members, key=lambda m: float(m.low[quantity].min()))
    places, texts = [], []
    for member, values, furthest in (
        (highest, highest.high[quantity], np.argmax),
        (lowest, lowest.low[quantity], np.argmin),
    ):
        at = int(furthest(values))
        places.append(drawn.outline(member, values, quantity, factor)[1][:, at])
        texts.append(f"{values[at]:.5g}")
    return line("ends", np.array(places).T) | {
        "mode": "markers+text", "text": texts, "textposition": "top right", "showlegend": False,
        "marker": {"size": 5, "color": "#222"},
    }  # fmt: skip


def bends(x: Array, values: Array, least: float) -> NDArray[np.intp]:
    """Indices of values off the line from the one kept before to the next, of the extremes and the ends."""
    kept = [0]
    for k in range(1, len(x) - 1):
        (x0, y0), (x1, y1) = ((x[at], values[at]) for at in (kept[-1], k + 1))
        share = (x[k] - x0) / max(x1 - x0, 1e-12)
        if abs(y0 + share * (y1 - y0) - values[k]) > least:
            kept.append(k)
    return np.unique([*kept, np.argmin(values), np.argmax(values), len(x) - 1])


def orbits(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of axial forces over moments of hinges with the strengths of their sections."""
    if not all(map(results.holds, interaction.SPEC.needs)):
        return
    hinges = list(interaction.member_hinges(results, ALL))
    if not hinges:
        return
    forces, stored = results.course("member/force")[1], results.history("member/force")
    traces = list[Trace]()
    for n, k in enumerate(interaction.most_varied(hinges, forces)):
        first = interaction.first_yields(results, hinges[k], ALL)
        look = {"legendgroup": str(n)} | ({"visible": "legendonly"} if n else {})
        for trace in _orbit(hinges[k], forces, stored[first], COLOURS[n % len(COLOURS)]):
            traces.append(trace | look)
    note = "Tension and sagging are positive. Red: strength; square: start; ring: largest moment; crosses: "
    note += "first yield to each side. A click on a name shows its hinge, or hides it."
    axes = f"moment [{results.units.text('F*L')}]", f"axial force [{results.units.force}]"
    yield PlotlyPicture("Axial forces over moments of hinges", note, *axes, traces)


def _orbit(hinge: interaction.MemberHinge, forces: Array, yields: Array, colour: str) -> Iterator[Trace]:
    """Path of the forces of one hinge, its strength, and its start, peak and first yields."""
    moment, axial = hinge.path(forces)
    yield curve(hinge.name, *_seen(moment, axial)) | {
        "line": {"color": colour, "width": 1, "dash": "solid"}
    }
    limits = [hinge.outline] if len(hinge.corners) else []
    ends = [axial.min(), axial.max(), np.nan]
    limits += [np.array([[m] * 3, ends]) for m in hinge.yield_moments]
    # marks that nobody sees keep lines off the border
    red = {"mode": "lines+markers", "marker": {"opacity": 0}, "line": {"color": RED, "dash": "solid"}}
    if limits:
        yield curve("strength", *np.hstack(limits)) | red | {"showlegend": False, "hoverinfo": "name"}
    top = int(np.argmax(np.abs(moment)))
    for name, symbol, (x, y) in (
        ("start", "square", (moment[:1], axial[:1])),
        ("largest moment", "circle-open", (moment[[top]], axial[[top]])),
        ("first yield", "x-thin-open", hinge.path(yields)),
    ):
        marker = {"symbol": symbol, "size": 8, "color": "#222"}
        yield curve(name, x, y) | {"mode": "markers", "marker": marker, "showlegend": False}


def _seen(x: Array, y: Array) -> tuple[Array, Array]:
    """A path without the points that nobody sees: it stays in the cell of the point before, and has no
    extreme there.
    """
    cells = [np.floor(CELLS * (v - v.min()) / (np.ptp(v) or 1.0)) for v in (x, y)]
    moved = np.any([np.diff(cell, prepend=-1.0) != 0.0 for cell in cells], axis=0)
    moved[[-1, *(f(v) for v in (x, y) for f in (np.argmin, np.argmax))]] = True
    return x[moved], y[moved]
