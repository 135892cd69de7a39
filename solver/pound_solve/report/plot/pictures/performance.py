"""Picture `performance`: capacity and demand of the N2 method as acceleration over displacement."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.plot import labels, style
from pound_solve.report.plot.pictures.capacity import IDEALISED, POINT, TITLE, of_push
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

MOST = 4.0  #: largest displacement drawn, as a multiple of the furthest on the curves


class Demand(NamedTuple):
    """A motion as the N2 method sees it.

    Attributes
    ----------
    motion : str
    spectrum : ndarray, shape (2, n)
        Displacements [L] and accelerations of elastic oscillators [L/T^2].
    point : ndarray, shape (2,)
        Performance point, NaN without one.
    """

    motion: str
    spectrum: Array
    point: Array


class Oscillator(NamedTuple):
    """The oscillator that is equivalent to a pushover.

    Attributes
    ----------
    period : float
        Of its elastic branch [T].
    capacity, idealised : ndarray, shape (2, n)
        Displacements [L] and accelerations [L/T^2] along the curve and the line that stands for it.
    demands : list of Demand
    reach : float
        Largest displacement that is drawn [L].
    """

    period: float
    capacity: Array
    idealised: Array
    demands: list[Demand]
    reach: float


def performance(results: Results, choice: Choice) -> Any:
    """Draw one panel for each pushover with performance points."""
    pushes = assessed(results)
    if not pushes:
        raise Nothing("no pushover of this run has a performance point: give its card TC")
    figure = style.figure(7.5, 1.0 + 4.2 * len(pushes), "Capacity and demand (N2 method)")
    for axes, push in zip(figure.subplots(len(pushes), 1, squeeze=False).ravel(), pushes):
        panel(axes, results, push)
    return figure


def assessed(results: Results) -> list[int]:
    """Numbers of the pushovers that the N2 method was applied to."""
    pushes = sorted(set(results.table("performance")["push"].tolist()))
    return [push for push in pushes if len(of_push(results, "capacity_line", push))]


def axes_names(results: Results) -> tuple[str, str]:
    """Names of both axes."""
    units = results.units
    return f"displacement of the oscillator [{units.length}]", f"acceleration [{units.text('L/T^2')}]"


def panel(axes: Any, results: Results, push: int) -> None:
    """Draw the elastic spectra, the curve and the line of the equivalent oscillator, and the points."""
    oscillator, units = equivalent(results, push), results.units
    style.grid(axes, *axes_names(results))
    axes.plot(*oscillator.capacity, color="0.1", linestyle="-", linewidth=1.6, label="capacity")
    axes.plot(*oscillator.idealised, **IDEALISED, label="idealised")
    for n, demand in enumerate(oscillator.demands):
        look = {"color": style.stroke(n)["color"], "linestyle": "-", "linewidth": 1.0}
        axes.plot(*demand.spectrum, **look, label=style.short(demand.motion))
        if np.isfinite(demand.point).all():
            axes.plot(*demand.point, **{**POINT, "color": look["color"]})
            labels.label(axes, demand.point, f"{demand.point[0]:.3g} {units.length}", far=True)
    axes.set_xlim(0.0, oscillator.reach)
    axes.set_ylim(bottom=0.0)
    style.legend(axes)
    periods = of_push(results, "performance", push)["period"]
    shown = ", ".join(f"{period:.4g} {units.time}" for period in periods[np.isfinite(periods)])
    at_points = f"; up to the point: {shown}" if shown else ""
    title = f"pushover {push}: T* = {oscillator.period:.4g} {units.time}{at_points}"
    axes.set_title(style.wrapped(title, TITLE))


def equivalent(results: Results, push: int) -> Oscillator:
    """The oscillator that is equivalent to a pushover, beside its motions."""
    (line,) = of_push(results, "capacity_line", push)
    curve, spectra = of_push(results, "capacity_curve", push), of_push(results, "push_spectra", push)
    scale = np.array([1.0, 1.0 / line["mass"]]) / line["participation"]
    start = np.array([curve["displacement"][0], curve["base_shear"][0]])

    def scaled(rows: NDArray[Any]) -> Array:
        points: Array = scale * np.abs(np.stack([rows["displacement"], rows["base_shear"]], -1) - start)
        return points.T

    capacity = scaled(curve)
    (x, y), end = (line["yield_displacement"], line["yield_shear"]), line["displacement"]
    bent = scale[:, None] * np.array([[0.0, x, end], [0.0, y, y]])
    demands = []
    for point in of_push(results, "performance", push):
        rows = spectra[spectra["motion"] == point["motion"]]
        spectrum = np.array([rows["displacement"], rows["acceleration"]])
        demands.append(Demand(str(point["motion"]), spectrum, scaled(point)))
    furthest = float(capacity[0].max())
    reach = min(1.05 * max(furthest, float(spectra["displacement"].max())), MOST * furthest)
    return Oscillator(float(line["period"]), capacity, bent, demands, reach)


SPEC = Picture(
    name="performance",
    place=52,
    shows="capacity of a pushover beside the spectra of the motions, with the points of the N2 method",
    needs=("performance", "push_spectra", "capacity_line", "capacity_curve"),
    draw=performance,
)
