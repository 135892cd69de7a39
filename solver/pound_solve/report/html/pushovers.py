"""Pictures of the page that show pushovers: capacity curves, and the N2 method."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pound_solve.report.html.picture import COLOURS, PlotlyPicture, curve, numbers
from pound_solve.report.plot.pictures import capacity, performance
from pound_solve.results import Results


def capacity_curves(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of the capacity curves of pushovers, with the backbones of those that turn."""
    if not results.holds("capacity_curve"):
        return
    units = results.table_units("capacity_curve")
    x, y = f"control displacement [{units['displacement']}]", f"base shear [{units['base_shear']}]"
    pushes = capacity.pushovers(results)
    for push in pushes:
        traces = [
            curve(name, rows["displacement"], rows["base_shear"])
            for name, source in (("base shear", "capacity_curve"), ("backbone", "backbone"))
            if len(rows := capacity.of_push(results, source, push))
        ]
        title = f"Capacity curve {push}" if len(pushes) > 1 else "Capacity curve"
        yield PlotlyPicture(title, "", x, y, traces)


def performance_points(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of capacity and demand as acceleration over displacement."""
    if not all(map(results.holds, performance.SPEC.needs)):
        return
    for push in performance.assessed(results):
        oscillator, units = performance.equivalent(results, push), results.units
        traces = [
            curve("capacity", *oscillator.capacity) | {"line": {"color": "#222", "width": 2.5}},
            curve("idealised", *oscillator.idealised) | {"line": {"color": "#555", "dash": "dash"}},
        ]
        for n, (motion, spectrum, point) in enumerate(oscillator.demands):
            colour = COLOURS[n % len(COLOURS)]
            group = {"legendgroup": str(n)}
            traces.append(curve(motion, *spectrum) | group | {"line": {"color": colour}})
            if np.isfinite(point).all():
                x, y = numbers(point)
                traces.append({
                    "name": "performance point", "mode": "markers+text", "x": [x], "y": [y],
                    "marker": {"symbol": "star", "size": 12, "color": colour},
                    "text": [f"{point[0]:.3g} {units.length}"], "textposition": "top right",
                    "showlegend": False,
                } | group)  # fmt: skip
        note = "Stars: performance points. "
        note += f"The period of the oscillator is {oscillator.period:.4g} {units.time}."
        title = f"Capacity and demand of pushover {push} (N2 method)"
        axes = performance.axes_names(results)
        yield PlotlyPicture(title, note, *axes, traces, reach=oscillator.reach)
