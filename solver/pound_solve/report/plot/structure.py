"""Pictures of the structure: as it stands, deformed, its modes, drifts over the height."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.results import Results
from pound_solve.structure.elements.base import axes as own_axes

MOST_NUMBERS = 60  #: nodes up to which their numbers are written
MOST_MODES = 8
SHARE = 0.08  #: largest drawn displacement as a share of the structure's size
WALL = 0.035  #: half the length of a wall, and about its distance, as a share of that size
HATCHES = 6


class DrawnStructure:
    """Nodes and elements of a results file, for drawing."""

    def __init__(self, results: Results) -> None:
        nodes, self.elements = results.table("nodes"), results.table("elements")
        self.units = results.units
        self.place = {int(n["node"]): np.array([n["x"], n["y"]], float) for n in nodes}
        self.fixed = {int(n["node"]): str(n["fixed"]) for n in nodes}
        self.mass: dict[int, float] = {}
        if "masses" in results.tables:
            self.mass = {int(m["node"]): max(m["mx"], m["my"]) for m in results.table("masses")}
        xy = np.array(list(self.place.values()))
        self.low, self.high = xy.min(axis=0), xy.max(axis=0)
        self.size = float(max(*(self.high - self.low), 1e-30))

    def lines(self, contacts: bool) -> list[tuple[int, int]]:
        """Ends of all elements between two nodes: contacts, or the others."""
        return [
            (int(e["i"]), int(e["j"]))
            for e in self.elements
            if e["j"] and (e["kind"] == "CONTACT") == contacts
        ]

    def draw(self, axes: Any, shift: dict[int, Array] | None = None, **look: Any) -> None:
        """Draw the members, displaced by `shift` of every node."""
        moved = {n: xy + (shift or {}).get(n, np.zeros(2)) for n, xy in self.place.items()}
        for i, j in self.lines(contacts=False):
            axes.plot(*zip(moved[i], moved[j]), **look)

    def frame(self, axes: Any, room: float = 0.06) -> None:
        """Equal scales, with room around the structure as a share of its size."""
        margin = room * self.size
        (x0, y0), (x1, y1) = self.low - margin, self.high + margin
        axes.set_xlim(x0, x1)
        axes.set_ylim(y0, y1)
        axes.set_aspect("equal", adjustable="box")
        style.grid(axes, f"X [{self.units.length}]", f"Y [{self.units.length}]")

    def shape(self) -> tuple[float, float]:
        """Width and height of a picture of it, in inches."""
        width, height = self.high - self.low + 0.12 * self.size
        scale = min(9.0 / width, 7.0 / height)
        return max(5.0, float(width * scale)), max(3.0, float(height * scale))


def frame(results: Results) -> Any:
    """Nodes with numbers, supports, masses, members and contacts."""
    s = DrawnStructure(results)
    figure = style.figure(*s.shape(), title=results.title)
    axes = figure.add_subplot()
    s.frame(axes)
    s.draw(axes, color=style.BLUE, linewidth=1.4)
    angles = dict(results.table("contact_laws")[["contact", "angle"]].tolist())
    for e in s.elements[s.elements["kind"] == "CONTACT"]:
        name, i = str(e["name"] or e["element"]), s.place[int(e["i"])]
        if e["j"]:
            end = s.place[int(e["j"])]
            axes.plot(*zip(i, end), color=style.RED, linewidth=2.0, marker="|", markersize=10)
            above, room = (i + end) / 2, 7
        else:
            above, room = _wall(axes, i, angles[name], WALL * s.size), 3
        axes.annotate(
            name, above, fontsize=7, color=style.RED, ha="center",
            xytext=(0, room), textcoords="offset points",
        )  # fmt: skip
    heaviest = max(s.mass.values(), default=0.0)
    for node, (x, y) in s.place.items():
        held = {"X", "Y"} & set(s.fixed[node])
        if len(held) == 2 or (held and y == s.low[1]):  # floors of shear buildings may slide: no mark
            axes.plot(x, y, marker="^", color=style.GREEN, markersize=8, clip_on=False)
        if heaviest and s.mass.get(node):
            axes.plot(x, y, "o", color="0.2", markersize=2 + 6 * (s.mass[node] / heaviest) ** 0.5)
        if len(s.place) <= MOST_NUMBERS:
            axes.annotate(str(node), (x, y), fontsize=6, xytext=(3, 3), textcoords="offset points")
    axes.set_title("triangles: supports; dots: masses; red: contacts", fontsize=7, color="0.4")
    return figure


def _wall(axes: Any, node: Array, angle: float, half: float) -> Array:
    """Draw the wall that a node meets in a direction [deg], `half` as long on each side, hatched behind;
    return its highest point.
    """
    across, along = np.array(own_axes(angle))
    ends = node + half * across + half * np.array([along, -along])
    axes.plot(*zip(node, node + half * across), color=style.RED, linewidth=2.0)
    axes.plot(*ends.T, color=style.RED, linewidth=1.4)
    for share in np.linspace(0.0, 1.0, HATCHES):
        front = ends[0] + share * (ends[1] - ends[0])
        back = front + 0.4 * half * (across + along)
        axes.plot(*zip(front, back), color=style.RED, linewidth=0.7)
    return max(ends, key=lambda p: p[1])


def modes(results: Results) -> Any:
    """Mode shapes beside each other."""
    s, shapes = DrawnStructure(results), results.table("mode_shapes")
    periods = {int(m["mode"]): float(m["period"]) for m in results.table("modes")}
    numbers = list(dict.fromkeys(int(n) for n in shapes["mode"]))[:MOST_MODES]
    width, height = s.shape()
    figure, all_axes = style.panels(
        len(numbers), "Modes", (max(2.5, 0.45 * width), max(2.0, 0.45 * height))
    )
    for axes, number in zip(all_axes, numbers):
        own = shapes[shapes["mode"] == number]
        moved = {int(r["node"]): SHARE * s.size * np.array([r["x"], r["y"]]) for r in own}
        s.frame(axes, 0.06 + SHARE)
        s.draw(axes, color="0.8", linewidth=0.8)
        s.draw(axes, moved, color=style.BLUE, linewidth=1.2)
        axes.set_title(f"mode {number}, period {periods[number]:.4g} {s.units.time}", fontsize=8)
    return figure


def deformed(results: Results) -> Any:
    """The structure when its displacements are largest, magnified."""
    s, u = DrawnStructure(results), results.history("node/u")[:, :, :2]
    numbers = [int(n) for n in results.attributes("node/u")["nodes"]]
    size = np.abs(u).max(axis=(1, 2))
    at = int(np.argmax(size))
    factor = SHARE * s.size / size[at] if size[at] > 0.0 else 1.0
    moved = {n: factor * u[at, i] for i, n in enumerate(numbers)}
    figure = style.figure(
        *s.shape(),
        title=f"Displacements at {results.time[at]:.4g} {s.units.time}, drawn {factor:.3g} times as large",
    )
    axes = figure.add_subplot()
    s.frame(axes, 0.06 + SHARE)
    s.draw(axes, color="0.8", linewidth=0.8)
    s.draw(axes, moved, color=style.BLUE, linewidth=1.3)
    for i, j in s.lines(contacts=True):
        ends = [s.place[n] + moved.get(n, np.zeros(2)) for n in (i, j)]
        axes.plot(*zip(*ends), color=style.RED, linewidth=1.5, marker="|", markersize=8)
    return figure


def envelopes(results: Results) -> Any:
    """Extremes of the drifts, in the order of the deck, and of horizontal displacements over the height:
    what there is of the two.
    """
    drifts = results.holds("drift_envelope")
    columns = _columns(results)
    count = drifts + bool(columns)
    if not count:
        raise style.Nothing("drifts, no columns of nodes")
    figure = style.figure(4.75 * count, 4.6)
    if drifts:
        _drifts(figure.add_subplot(1, count, 1), results)
    if columns:
        axes = figure.add_subplot(1, count, count)
        unit = results.units.length
        style.grid(axes, f"displacement X [{unit}]", f"height [{unit}]")
        for height, low, high in columns:
            axes.plot(low, height, color=style.COLOURS[1], linewidth=1, marker=".")
            axes.plot(high, height, color=style.BLUE, linewidth=1, marker=".")
        axes.axvline(0.0, color="0.3", linewidth=0.8)
        axes.set_title("envelopes over the height, one line for each column", fontsize=9)
    return figure


def _drifts(axes: Any, results: Results) -> None:
    drifts = results.table("drift_envelope")
    rows = np.arange(len(drifts))
    style.grid(axes, f"drift [{results.units.length}]")
    axes.barh(rows, drifts["max"], color=style.BLUE, height=0.6)
    axes.barh(rows, drifts["min"], color=style.COLOURS[1], height=0.6)
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set_yticks(rows, [str(n) for n in drifts["name"]], fontsize=7)
    axes.set_title("largest drifts in both directions", fontsize=9)


def _columns(results: Results) -> list[Array]:
    """Heights, smallest and largest displacements X of the nodes above each other, shape (3, n) each."""
    place, table = DrawnStructure(results).place, results.table("node_envelope")
    own = table[(table["direction"] == "X") & (table["quantity"] == "displacement")]
    lines: dict[float, list[tuple[float, float, float]]] = {}
    for row in own:
        x, y = place[int(row["node"])].tolist()
        lines.setdefault(x, []).append((y, float(row["min"]), float(row["max"])))
    return [np.array(sorted(line)).T for line in lines.values() if len(line) > 1]
