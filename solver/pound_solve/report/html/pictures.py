"""Pictures of the page as plain data for plotly.js: curves, axes, a note below."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import MappingProxyType
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.html.members import diagrams, orbits
from pound_solve.report.html.methods import errors_of_methods
from pound_solve.report.html.peaks import closures, columns_of_nodes, peaks_of_collisions
from pound_solve.report.html.picture import COLOURS, PlotlyPicture, Trace, curve, numbers, plain, thinned
from pound_solve.report.html.pushovers import capacity_curves, performance_points
from pound_solve.report.html.structures import loads, mode_shapes, structure, yielded
from pound_solve.report.plot.courses import of_contact, with_peaks
from pound_solve.report.plot.pictures import base_shear, storeys
from pound_solve.results import Results

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
    ("building/base", "moment", "Overturning moments", "overturning moment"),
    ("contact/force", "", "Contact forces", "contact force"),
    ("contact/gap", "", "Gaps", "gap"),
    ("energy", "", "Energies", "energy"),
)
#: factor and unit of ratios, as in their profiles over the height
RATIOS: Final = MappingProxyType({"storey/drift": (storeys.PROFILES["drift ratio"][2], "%")})
#: both sides of a profile: name and dashes
SIDES: Final = (("to the right", "solid"), ("to the left", "dash"))


def pictures(results: Results) -> list[PlotlyPicture]:
    """Return all pictures for which the results have data."""
    makers: tuple[Callable[[Results], Iterator[PlotlyPicture]], ...] = (
        errors_of_methods, structure, loads, mode_shapes, columns_of_nodes, _profiles, diagrams, _courses,
        peaks_of_collisions, closures, _overlaps, yielded, _loops, orbits, capacity_curves,
        performance_points,
    )  # fmt: skip
    return [picture for make in makers for picture in make(results) if picture.traces]


def _profiles(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of the extremes of the storeys over the height of each building."""
    if not all(map(results.holds, storeys.SPEC.needs)):
        return
    units = results.units
    for quantity, (name, dimension, _) in storeys.PROFILES.items():
        traces = []
        for n, building in enumerate(storeys.buildings(results)):
            curves = zip(SIDES, storeys.profile_points(results, building, quantity))
            for (side, dash), (values, heights) in curves:
                line = {"color": COLOURS[n % len(COLOURS)], "dash": dash}
                points = {"x": numbers(values), "y": numbers(heights)}
                # marks that nobody sees keep lines off the border
                look = {"mode": "lines+markers", "marker": {"opacity": 0}, "line": line}
                traces.append({"name": plain(f"{building}, {side}")} | look | points)
        if quantity == "drift ratio":
            traces += _drift_limits(results)
        unit = dimension if dimension == "%" else units.text(dimension)
        axes = f"{name} [{unit}]", f"height [{units.length}]"
        yield PlotlyPicture(f"Extreme {name}s over the height", "", *axes, traces)


def _drift_limits(results: Results) -> Iterator[Trace]:
    """Curves of the drift limits, from the lowest level to the highest on both sides."""
    rows = results.table("storey_envelope")
    low, high = float((rows["level"] - rows["height"]).min()), float(rows["level"].max())
    for name, allowed in storeys.drift_limits([results]):
        line = {"color": COLOURS[3], "width": 1, "dash": "dot"}
        points = {"x": [-allowed, -allowed, None, allowed, allowed], "y": [low, high, None, low, high]}
        yield {"name": plain(name), "mode": "lines", "line": line} | points


def _courses(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of histories over time."""
    for name, component, title, axis in COURSES:
        if not results.holds(name) or name not in results.histories:
            continue
        if component and results.holds("base_envelope") and not base_shear.moves(results, component):
            continue
        (t, values), labels = results.course(name, jumps=True), results.labels(name)
        factor, percent = RATIOS.get(name, (1.0, ""))
        values = factor * values
        kinds = results.coordinates(name)["component"] if component else labels
        chosen = [k for k, kind in enumerate(kinds) if not component or kind == component][:MOST_CURVES]
        if not chosen:
            continue
        size = [float(np.abs(values[:, k]).max()) for k in chosen]
        shown = {chosen[k] for k in np.argsort(size)[::-1][:MOST_SHOWN]}
        note = "" if len(shown) == len(chosen) else "A click on a name shows its curve, or hides it."
        traces = []
        for k in chosen:
            points = t, values[:, k]
            if name == "contact/force":
                points = with_peaks(*points, of_contact(results, labels[k]))
            traces.append(curve(labels[k], *thinned(*points), k in shown))
        if name == "contact/force":
            traces += _peaks(results)
            note = f"The marks are the peaks in the table of collisions. {note}".strip()
        if name == "contact/gap":
            note = f"Below zero a contact is pressed. {note}".strip()
        unit = percent or results.history_units(name)[chosen[0]]
        x, y = f"time [{results.units.time}]", f"{axis} [{unit}]"
        yield PlotlyPicture(title, note, x, y, traces, time=True)


def _peaks(results: Results) -> Iterator[Trace]:
    """Curve of marks at the true peak force of every collision."""
    if results.holds("collisions"):
        table = results.table("collisions")
        hard = table[np.isfinite(table["peak_force"])]
        yield {
            "name": "peaks", "mode": "markers", "marker": {"symbol": "x", "size": 6, "color": "#333"},
            "x": numbers(hard["t_peak"]), "y": numbers(hard["peak_force"]),
            "text": [plain(c) for c in hard["contact"]],
        }  # fmt: skip


def _overlaps(results: Results) -> Iterator[PlotlyPicture]:
    """Picture of contact forces against overlaps, of all contacts that closed."""
    if not (results.holds("contact/force") and results.holds("contact/gap")):
        return
    forces, gaps = (results.course(f"contact/{name}", jumps=True)[1] for name in ("force", "gap"))
    labels, units = results.labels("contact/force"), results.units
    hardest = np.argsort(-forces.max(axis=0, initial=0.0), kind="stable").tolist()
    closed = [k for k in hardest if forces[:, k].max(initial=0.0) > 0.0][:MOST_LOOPS]
    traces = [curve(labels[k], *_pressed(gaps[:, k], forces[:, k]), n == 0) for n, k in enumerate(closed)]
    note = "At first the one with the largest force is shown. " if len(closed) > 1 else ""
    note += "The corners are those of the stored instants."
    x, y = f"overlap [{units.length}]", f"contact force [{units.force}]"
    yield PlotlyPicture("Contact forces over overlaps", note, x, y, traces)


def _pressed(gap: Array, force: Array) -> tuple[Array, Array]:
    """Overlaps and forces of a contact while it is closed, NaN between closures."""
    rows = np.flatnonzero((gap <= 0.0) | (force != 0.0))
    breaks = np.flatnonzero(np.diff(rows) > 1) + 1
    return np.insert(-gap[rows], breaks, np.nan), np.insert(force[rows], breaks, np.nan)


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
        traces = [curve(labels[k], deformation[:, k], force[:, k], n == 0) for n, k in enumerate(shown)]
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
