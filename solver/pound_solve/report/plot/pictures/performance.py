"""Picture `performance`: capacity and demand of the N2 method as acceleration over displacement."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import labels, style
from pound_solve.report.plot.pictures.capacity import IDEALISED, POINT, of_push
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

MOST = 4.0  #: largest displacement drawn, as a multiple of the furthest on the curves


def performance(results: Results, choice: Choice) -> Any:
    """Draw one panel for each pushover with performance points."""
    pushes = sorted(set(results.table("performance")["push"].tolist()))
    pushes = [push for push in pushes if len(of_push(results, "capacity_line", push))]
    if not pushes:
        raise Nothing("no pushover of this run has a performance point: give its card TC")
    figure = style.figure(7.5, 1.0 + 4.2 * len(pushes), "Capacity and demand (N2 method)")
    for axes, push in zip(figure.subplots(len(pushes), 1, squeeze=False).ravel(), pushes):
        panel(axes, results, push)
    return figure


def panel(axes: Any, results: Results, push: int) -> None:
    """Draw the elastic spectra, the curve and the line of the equivalent oscillator, and the points."""
    (line,) = of_push(results, "capacity_line", push)
    curve, units = of_push(results, "capacity_curve", push), results.units
    style.grid(
        axes, f"displacement of the oscillator [{units.length}]", f"acceleration [{units.text('L/T^2')}]"
    )
    along, across = 1.0 / line["participation"], 1.0 / (line["participation"] * line["mass"])
    x, y = (np.abs(curve[c] - curve[c][0]) for c in ("displacement", "base_shear"))
    axes.plot(along * x, across * y, color="0.1", linestyle="-", linewidth=1.6, label="capacity")
    bent = np.array([0.0, line["yield_displacement"], line["displacement"]])
    axes.plot(along * bent, across * line["yield_shear"] * np.array([0.0, 1.0, 1.0]), **IDEALISED)
    spectra = of_push(results, "push_spectra", push)
    points = of_push(results, "performance", push)
    for n, point in enumerate(points):
        spectrum = spectra[spectra["motion"] == point["motion"]]
        color, name = style.stroke(n)["color"], style.short(point["motion"])
        axes.plot(
            spectrum["displacement"],
            spectrum["acceleration"],
            color=color,
            linestyle="-",
            linewidth=1.0,
            label=name,
        )
        if np.isfinite(point["displacement"]):
            at = along * abs(point["displacement"] - curve["displacement"][0])
            force = across * abs(point["base_shear"] - curve["base_shear"][0])
            axes.plot(at, force, **{**POINT, "color": color})
            labels.label(axes, (at, force), f"{at:.3g} {units.length}", far=True)
    shown = max(along * float(x.max()), float(spectra["displacement"].max()))
    axes.set_xlim(0.0, min(1.05 * shown, MOST * along * float(x.max())))
    axes.set_ylim(bottom=0.0)
    style.legend(axes)
    axes.set_title(f"pushover {push}: T* = {line['period']:.4g} {units.time}")


SPEC = Picture(
    name="performance",
    place=52,
    shows="capacity of a pushover beside the spectra of the motions, with the points of the N2 method",
    needs=("performance", "push_spectra", "capacity_line", "capacity_curve"),
    draw=performance,
)
