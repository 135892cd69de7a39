"""Pictures of the page as plain data for plotly.js: curves, axes, a note below."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from html import escape
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot.geometry import NOWHERE, DrawnStructure, apart, broken_line, displacements
from pound_solve.results import Results

MOST_POINTS: Final = 4000  #: most points of a curve in time, else extremes of short intervals
MOST_SHOWN: Final = 8  #: curves of a picture visible at first; a click on a name shows another
MOST_CURVES: Final = 60
MOST_LOOPS: Final = 12

#: Histories that are drawn over time: path, component where a row has pairs, title, name of the axis.
COURSES: Final = (
    ("ground", "", "Ground acceleration", "acceleration"),
    ("storey/drift", "", "Drift ratios of the storeys", "drift ratio"),
    ("drift", "", "Drifts that the deck names", "drift"),
    ("storey/acceleration", "", "Total accelerations of the floors", "acceleration"),
    ("storey/shear", "", "Shears of the storeys", "shear"),
    ("building/base", "shear X", "Base shears", "base shear"),
    ("contact/force", "", "Contact forces", "contact force"),
    ("contact/gap", "", "Gaps", "gap"),
    ("energy", "", "Energies", "energy"),
)
#: quantity in the table of storey extremes, title, name of the axis
PROFILES: Final = (
    ("drift ratio", "Extreme drift ratios over the height", "drift ratio"),
    ("floor acceleration", "Extreme floor accelerations over the height", "floor acceleration"),
    ("shear", "Extreme storey shears over the height", "storey shear"),
)
COLOURS: Final = (
    "#1f77b4",
    "#ff7f0e",
    "#2ca02c",
    "#d62728",
    "#9467bd",
    "#8c564b",
    "#e377c2",
    "#7f7f7f",
)  #: colours of buildings; both sides of one have the same

Trace: TypeAlias = dict[str, Any]


class PlotlyPicture(NamedTuple):
    """One picture.

    Attributes
    ----------
    title, note : str
        Above and below it.
    x, y : str
        Names of the axes with their units.
    traces : list of dict
        Curves in the format of plotly.js.
    equal : bool
        Whether both axes have the same scale.
    time : bool
        Whether the X axis is time, which all such pictures show alike.
    """

    title: str
    note: str
    x: str
    y: str
    traces: list[Trace]
    equal: bool = False
    time: bool = False

    def as_json(self) -> dict[str, Any]:
        """Picture as data for the script of the page."""
        axes = {"x": _plain(self.x), "y": _plain(self.y), "equal": self.equal, "time": self.time}
        return axes | {"traces": self.traces}


def pictures(results: Results) -> list[PlotlyPicture]:
    """Return all pictures for which the results have data."""
    makers: tuple[Callable[[Results], Iterator[PlotlyPicture]], ...] = (
        _structure, _profiles, _courses, _loops, _capacity,
    )  # fmt: skip
    return [picture for make in makers for picture in make(results) if picture.traces]


def _structure(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the structure, undeformed and at the instant of its largest displacement."""
    if not results.holds("nodes"):
        return
    s, note, shift = DrawnStructure(results, apart()), "", dict[int, Array]()
    traces: list[Trace] = []
    if results.holds("node/u"):
        displaced = displacements(results)
        s, shift = displaced.structure, displaced.shift(displaced.row)
        note = (
            f"The displacements are those at {results.time[displaced.row]:.6g} {s.units.time}, "
            f"when the largest is {displaced.largest:.5g} {s.units.length}. "
            f"Displacements and gaps are drawn {displaced.factor:.3g} times as large."
        )
        traces.append(_line("displaced", s.path(shift), "#0b4f8a"))
    traces.insert(0, _line("at rest", s.path(), "#b0b0b0"))
    ends = [s.ends(c, shift) for c in s.contacts]
    marked = {"mode": "lines+markers", "marker": {"symbol": "square-open", "size": 9, "color": "#b3301e"}}
    traces.append(_line("contacts", broken_line((tip, end) for _, tip, end in ends), "#b3301e") | marked)
    arms = [(start, tip) for start, tip, _ in ends if not np.array_equal(start, tip)]
    traces.append(_line("rigid arms of contacts", broken_line(arms), "#b3301e"))
    place = {n: xy + shift.get(n, NOWHERE) for n, xy in s.place.items()}
    traces.append(
        {
            "name": "nodes", "mode": "markers", "marker": {"size": 5, "color": "#333"},
            "x": _numbers(xy[0] for xy in place.values()), "y": _numbers(xy[1] for xy in place.values()),
            "text": [f"node {n}" for n in place], "hoverinfo": "text",
        }
    )  # fmt: skip
    length = s.units.length
    kept = [t for t in traces if t["x"]]
    yield PlotlyPicture("Structure", note, f"X [{length}]", f"Y [{length}]", kept, equal=True)


def _line(name: str, points: Array, colour: str) -> Trace:
    """A line with gaps through points, shape (2, n)."""
    x, y = map(_numbers, points)
    return {"name": name, "mode": "lines", "line": {"color": colour}, "x": x, "y": y, "hoverinfo": "skip"}


def _profiles(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of the largest and smallest values of the storeys over the height of each building."""
    if not (results.holds("storey_envelope") and results.holds("storey_extremes")):
        return
    table, length = results.table("storey_extremes"), results.units.length
    levels = {(r["building"], r["storey"]): r["level"] for r in results.table("storey_envelope")}
    for quantity, title, name in PROFILES:
        traces = []
        rows = table[table["quantity"] == quantity]
        for n, building in enumerate(dict.fromkeys(rows["building"])):
            storeys = rows[rows["building"] == building]
            y = _numbers(levels[building, storey] for storey in storeys["storey"])
            colour = COLOURS[n % len(COLOURS)]
            for side, column, dash in (("to the right", "max", "solid"), ("to the left", "min", "dash")):
                line = {"color": colour, "dash": dash}
                label = f"{_plain(building)}, {side}"
                curve = {"name": label, "mode": "lines+markers", "line": line, "y": y}
                traces.append(curve | {"x": _numbers(storeys[column])})
        unit = rows["unit"][0] if len(rows) else ""
        yield PlotlyPicture(title, "", f"{name} [{unit}]", f"level [{length}]", traces)


def _courses(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of histories over time."""
    for name, component, title, axis in COURSES:
        if not results.holds(name) or name not in results.histories:
            continue
        (t, values), labels = results.course(name), results.labels(name)
        kinds = results.coordinates(name)["component"] if component else labels
        chosen = [k for k, kind in enumerate(kinds) if not component or kind == component][:MOST_CURVES]
        size = [float(np.abs(values[:, k]).max()) for k in chosen]
        shown = {chosen[k] for k in np.argsort(size)[::-1][:MOST_SHOWN]}
        traces = [_curve(labels[k], *thinned(t, values[:, k]), k in shown) for k in chosen]
        note = "" if len(shown) == len(chosen) else "A click on a name shows its curve, or hides it."
        if name == "contact/force":
            traces += _peaks(results)
            note = f"The marks are the peaks in the table of collisions. {note}".strip()
        unit = results.history_units(name)[chosen[0]]
        x, y = f"time [{results.units.time}]", f"{axis} [{unit}]"
        yield PlotlyPicture(title, note, x, y, traces, time=True)


def _curve(name: str, x: Array, y: Array, shown: bool) -> Trace:
    curve = {"name": _plain(name), "mode": "lines", "x": _numbers(x), "y": _numbers(y)}
    return curve if shown else curve | {"visible": "legendonly"}


def _peaks(results: Results) -> Iterator[Trace]:
    """Curve of marks at the true peak force of every collision."""
    if results.holds("collisions"):
        table = results.table("collisions")
        hard = table[np.isfinite(table["peak_force"])]
        yield {
            "name": "peaks", "mode": "markers", "marker": {"symbol": "x", "size": 6, "color": "#333"},
            "x": _numbers(hard["t_peak"]), "y": _numbers(hard["peak_force"]),
            "text": [_plain(c) for c in hard["contact"]],
        }  # fmt: skip


def _loops(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of force against deformation of springs and hinges, one for each unit of force."""
    if not (results.holds("spring/force") and results.holds("spring/deformation")):
        return
    force, deformation = results.history("spring/force"), results.history("spring/deformation")
    units, labels = results.history_units("spring/force"), results.labels("spring/force")
    along = results.history_units("spring/deformation")
    work = np.abs(np.diff(deformation, axis=0) * 0.5 * (force[1:] + force[:-1])).sum(axis=0)
    for unit in dict.fromkeys(units):
        shown = [k for k in np.argsort(work)[::-1].tolist() if units[k] == unit][:MOST_LOOPS]
        traces = [_curve(labels[k], deformation[:, k], force[:, k], n == 0) for n, k in enumerate(shown)]
        kind = "Moment" if along[shown[0]] == "rad" else "Force"
        note = "At first the one with the most work is shown. " if len(shown) > 1 else ""
        note += "The corners are those of the stored instants."
        yield PlotlyPicture(
            f"{kind}s of springs and hinges",
            note,
            f"deformation [{along[shown[0]]}]",
            f"{kind.lower()} [{unit}]",
            traces,
        )


def _capacity(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of the capacity curve of a pushover."""
    if results.holds("capacity_curve"):
        table, units = results.table("capacity_curve"), results.table_units("capacity_curve")
        curve = _curve("base shear", table["displacement"], table["base_shear"], True)
        x, y = f"control displacement [{units['displacement']}]", f"base shear [{units['base_shear']}]"
        yield PlotlyPicture("Capacity curve", "", x, y, [curve])


def thinned(t: Array, values: Array) -> tuple[Array, Array]:
    """Thin out a curve of many points: keep the smallest and the largest value of every short interval."""
    if len(t) <= MOST_POINTS:
        return t, values
    size = -(-2 * len(t) // MOST_POINTS)
    keep = {0, len(t) - 1}
    for start in range(0, len(t), size):
        window = values[start : start + size]
        keep |= {start + int(np.argmin(window)), start + int(np.argmax(window))}
    chosen = sorted(keep)
    return t[chosen], values[chosen]


def _numbers(values: Any) -> list[float | None]:
    """Numbers rounded to seven digits, enough for any screen; None for one that is not finite."""
    return [float(f"{v:.7g}") if math.isfinite(v) else None for v in values]


def _plain(text: str) -> str:
    """Text escaped so that plotly.js interprets none of it as markup."""
    return escape(text, quote=False)
