"""The paper's figures from the study's numbers, and two that it does not have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from cases import TESTS
from errors import Prediction, benchmark_of, drifts, predictions
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from runs import PLACES, Run

COLOURS = {"El Centro": "#0b4f8a", "Mexico City": "#b3541e", "Loma Prieta": "#3d7a3d"}
MARKS = {"left": "<", "right": ">"}
RATIOS = np.geomspace(0.05, 20, 241)  #: mass ratios of the curves
PERIODS = (1.0, 0.8, 0.6, 0.4, 0.2)  #: period ratios T1/T2 of the curves


def save(figure: Figure, path: Path) -> None:
    """Write a picture; the same numbers give the same bytes."""
    figure.savefig(path, metadata={"Date": None}, dpi=150)


def axes_of(figure: Figure, rows: int = 1, columns: int = 1, **options: object) -> Sequence[Axes]:
    """Axes with a light grid."""
    out = np.ravel(figure.subplots(rows, columns, **options))  # type: ignore[call-overload]
    for axes in out:
        axes.grid(color="0.88", linewidth=0.6)
        axes.set_axisbelow(True)
    return list(out)


def drift_errors(runs: Mapping[str, Sequence[Run]], building: int, path: Path) -> None:
    """Figures 11 and 12: drift errors of one building, by test, place, record and direction."""
    figure = Figure(figsize=(10, 7), layout="constrained")
    places = [p for p in PLACES if p.startswith(f"B{building}")]
    all_axes = axes_of(figure, 2, 2, sharex=True, sharey=True)
    names = [t.name for t in TESTS[:-1]]
    for axes, place in zip(all_axes, places):
        axes.axhspan(-10, 10, color="0.93", zorder=0)
        axes.axhline(0, color="0.4", linewidth=0.8)
        for shift, (record, group) in enumerate(runs.items()):
            for d in drifts(group, benchmark_of(group)):
                if d.place != place or d.test not in names:
                    continue
                x = names.index(d.test) + 0.22 * (shift - 1) + (0.06 if d.direction == "right" else -0.06)
                shown = float(np.clip(d.error, -60, 60))
                axes.plot(x, shown, MARKS[d.direction], color=COLOURS[record], markersize=5)
                if shown != d.error:
                    axes.annotate(
                        f"{d.error:.0f}", (x, shown), fontsize=6, ha="center", va="center",
                        xytext=(0, 7 if shown < 0 else -7), textcoords="offset points",
                    )  # fmt: skip
        axes.set_title(place.replace(f"B{building} ", ""), fontsize=9)
        axes.set_ylim(-63, 63)
        axes.set_xticks(range(len(names)), names, fontsize=8)
    for axes in (all_axes[0], all_axes[2]):
        axes.set_ylabel("drift error [%]")
    for record in runs:
        for direction, mark in MARKS.items():
            all_axes[0].plot([], [], mark, color=COLOURS[record], label=f"{record}, {direction}ward")
    all_axes[0].legend(fontsize=7, ncols=3, loc="lower right")
    figure.suptitle(
        f"Building {building}: drift envelopes against 20 elements a diaphragm (grey: within 10 %)",
        fontsize=10,
    )
    save(figure, path)


def force_errors(found: Mapping[str, Sequence[Prediction]], title: str, path: Path) -> None:
    """Figures 13 and 14: error of Eq. 11 over the recorded force, a colour a record or test."""
    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axes = axes_of(figure)[0]
    axes.axhspan(-15, 15, color="0.93", zorder=0)
    axes.axhline(0, color="0.4", linewidth=0.8)
    cycle = [*COLOURS.values(), "#7a3d7a", "#8a7a0b", "#0b8a7a", "#c03030", "0.3", "#5a5ad0", "0.6"]
    for colour, (name, points) in zip(cycle, found.items()):
        for floor, mark in ((1, "s"), (2, "o")):
            own = [p for p in points if p.floor == floor]
            axes.plot(
                [p.force for p in own], [p.error for p in own], mark, color=colour, markersize=4,
                label=f"{name}, floor {floor}" if own else None,
            )  # fmt: skip
    axes.set_xlabel("recorded force of the benchmark [kN]")
    axes.set_ylabel("error of Eq. 11 [%]")
    axes.set_ylim(-110, 110)
    axes.legend(fontsize=6, ncols=2)
    axes.set_title(title, fontsize=9)
    save(figure, path)


def figure_13(runs: Mapping[str, Sequence[Run]], per_speed: float, of: str, path: Path) -> None:
    """Eq. 11 against the benchmark's own forces."""
    found = {
        record: list(predictions(benchmark_of(group), benchmark_of(group), per_speed, of))
        for record, group in runs.items()
    }
    force_errors(found, f"Eq. 11 in the benchmark, recorded force: {of} (grey: within 15 %)", path)


def figure_14(group: Sequence[Run], per_speed: float, of: str, path: Path) -> None:
    """Eq. 11 at every test's approach speed against the benchmark's forces, El Centro."""
    found = {run.test: list(predictions(run, benchmark_of(group), per_speed, of)) for run in group}
    force_errors(
        found, f"Eq. 11 in all tests, El Centro, recorded force: {of}; -100 %: no such collision", path
    )
