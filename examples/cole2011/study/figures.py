"""The paper's figures from the study's numbers, and two that it does not have.

Figures 1 to 4 are sketches of ideas and left out: two oscillators, two bars, contact elements.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from cases import PAIR, TESTS, G
from errors import Prediction, benchmark_of, drifts, predictions
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from motions import Record
from runs import PLACES, Run
from waves import INSTANTS, waves

from pound_solve.assess.spectra import of_record
from pound_solve.laws.two_bars import Diaphragm, Pair
from pound_solve.report.plot import style

COLOURS = {"El Centro": "#0b4f8a", "Mexico City": "#b3541e", "Loma Prieta": "#3d7a3d"}
MARKS = {"left": "<", "right": ">"}
RATIOS = np.geomspace(0.05, 20, 241)  #: mass ratios of the curves
PERIODS = (1.0, 0.8, 0.6, 0.4, 0.2)  #: period ratios T1/T2 of the curves


def axes_of(figure: Figure, rows: int = 1, columns: int = 1, **options: object) -> Sequence[Axes]:
    """Axes with a light grid."""
    return [style.grid(axes) for axes in np.ravel(figure.subplots(rows, columns, **options))]  # type: ignore[call-overload]


def drift_errors(runs: Mapping[str, Sequence[Run]], building: int, path: Path) -> None:
    """Figures 11 and 12: drift errors of one building, by test, place, record and direction."""
    figure = style.figure(10, 7)
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
    style.save(figure, path)


def force_errors(found: Mapping[str, Sequence[Prediction]], title: str, path: Path) -> None:
    """Figures 13 and 14: error of Eq. 11 over the recorded force, a colour a record or test."""
    figure = style.figure(7, 4.5)
    axes = axes_of(figure)[0]
    axes.axhspan(-15, 15, color="0.93", zorder=0)
    axes.axhline(0, color="0.4", linewidth=0.8)
    cycle = [*COLOURS.values(), "#7a3d7a", "#8a7a0b", "#0b8a7a", "#c03030", "0.3", "#5a5ad0", "0.6"]
    for colour, (name, points) in zip(cycle, found.items()):
        for floor, mark in ((1, "s"), (2, "o")):
            there = [p for p in points if p.floor == floor]
            axes.plot(
                [p.force for p in there], [p.error for p in there], mark, color=colour, markersize=4,
                label=f"{name}, floor {floor}" if there else None,
            )  # fmt: skip
    axes.set_xlabel("recorded force of the benchmark [kN]")
    axes.set_ylabel("error of Eq. 11 [%]")
    axes.set_ylim(-110, 110)
    axes.legend(fontsize=6, ncols=2)
    axes.set_title(title, fontsize=9)
    style.save(figure, path)


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


def pair(mass_ratio: float, period_ratio: float) -> Pair:
    """Two diaphragms of these ratios; the second has unit mass and period."""
    return Pair(Diaphragm(mass_ratio, 4 * mass_ratio / period_ratio**2), Diaphragm(1.0, 4.0))


#: equivalent contacts that are compared, and what they are
CONTACTS = {"0(equiv)": "Eqs 14-17", "0(touch)": "time of touch", "0(exact)": "impulse and centroid"}


def inputs(records: Sequence[Record], folders: Sequence[Path], length: float, path: Path) -> None:
    """Figure 9: the accelerations that were used, with sign, factor and window."""
    figure = style.figure(9, 1.7 * len(records))
    times = np.linspace(0.0, length, 2001)
    for axes, record in zip(axes_of(figure, len(records), 1, sharex=True), records):
        source = of_record(record.file, (*record.items.split(), f"START={record.start!r}"), folders)
        (found,) = source.accelerations.values()
        shown = record.sign * record.scale * found.value(times) / G
        axes.plot(times, shown, color=COLOURS[record.name], linewidth=0.8)
        axes.set_title(f"{record.name}: {record.says}, times {record.scale:g}", fontsize=8)
        axes.set_ylabel("g", fontsize=8)
    figure.axes[-1].set_xlabel("time [s]")
    style.save(figure, path)


def over_stiffness(groups: Mapping[float, Sequence[Run]], path: Path) -> None:
    """Peak force of floor 2, and mean drift error, of the equivalent contacts over the stiffness k_D1."""
    figure = style.figure(9, 4.2)
    left, right = axes_of(figure, 1, 2, sharex=True)
    for colour, (name, label) in zip(COLOURS.values(), CONTACTS.items()):
        runs = [next(r for r in group if r.test == name) for group in groups.values()]
        errors = [
            np.mean([abs(d.error) for d in drifts([run], benchmark_of(group))])
            for run, group in zip(runs, groups.values())
        ]
        left.plot(list(groups), [r.forces[1] for r in runs], "o-", color=colour, markersize=3, label=label)
        right.plot(list(groups), errors, "o-", color=colour, markersize=3)
    left.plot(list(groups), [benchmark_of(g).forces[1] for g in groups.values()], "k:", label="20 elements")
    for axes in (left, right):
        axes.axvline(0.75, color="0.6", linewidth=0.8)
        axes.set_xlabel("k_D1 over that of Table IV; Z1 = Z2 at 0.75")
    left.set_ylabel("peak force of floor 2 [kN]")
    right.set_ylabel("mean drift error [%]")
    left.legend(fontsize=7)
    style.save(figure, path)


def methods(found: Sequence[tuple[str, float, float]], path: Path) -> None:
    """Largest drift error [%] of steps over their CPU time [s]; the time of the exact method."""
    figure = style.figure(6, 3.4)
    axes = axes_of(figure)[0]
    steps = [x for x in found if x[2] > 0]
    axes.loglog([cost for _, cost, _ in steps], [error for *_, error in steps], "o-", color=style.RED)
    for name, cost, error in steps:
        axes.annotate(
            name.split(", ")[1], (cost, error), xytext=(5, 5), textcoords="offset points", fontsize=8
        )
    exact = next(cost for _, cost, error in found if error == 0.0)
    axes.axvline(exact, color=COLOURS["El Centro"], linestyle="-")
    axes.annotate(
        "EXACT", (exact, min(x[2] for x in steps)), xytext=(5, 0), textcoords="offset points", fontsize=8
    )
    axes.margins(0.2)
    axes.set_xlabel("CPU time [s]")
    axes.set_ylabel("largest error of drifts [%]")
    style.save(figure, path)


def share_bars(found: Sequence[tuple[str, float, float]], path: Path) -> None:
    """Shares of readings [%] in which statements hold as written and leniently, by a short name."""
    figure = style.figure(7, 4.2)
    axes = axes_of(figure)[0]
    rows = range(len(found))
    axes.barh(rows, [lenient for *_, lenient in found], color="0.8")
    axes.barh(rows, [strict for _, strict, _ in found], color=COLOURS["El Centro"])
    axes.set_yticks(rows, [f"{n}  {name}" for n, (name, *_) in enumerate(found, 1)], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlim(0, 100)
    axes.set_xlabel("share of the readings [%]")
    style.save(figure, path)


def layout(path: Path) -> None:
    """Figures 8 and 10: the two buildings, and the numbers of elements of a floor."""
    figure = style.figure(9, 5.0)
    whole, mesh = axes_of(figure, 2, 1, sharex=True, height_ratios=(1.2, 1.0))
    floors = ((0.0, 20.0, COLOURS["El Centro"]), (24.0, 50.0, COLOURS["Mexico City"]))  # gap: not to scale
    for axes in (whole, mesh):
        axes.set_axis_off()
        axes.set_xlim(-16, 75)
    for start, length, colour in floors:
        end = start + length
        for y in (7.0, 14.0):
            whole.plot([start, end], [y, y], "-", color=colour, linewidth=4)
            whole.plot([start, start], [y - 7.0, y], "-", color=colour, linewidth=1.2)
            whole.plot([end, end], [y - 7.0, y], "-", color=colour, linewidth=1.2)
        whole.plot([start - 1, end + 1], [0, 0], "-", color="0.4", linewidth=0.8)
        whole.annotate(f"{length:g} m long, 10 m wide", (start + length / 2, -2.6), ha="center", fontsize=8)
    whole.annotate("8 mm", (22.0, 15.2), ha="center", fontsize=8)
    whole.set_ylim(-4, 17)
    for n, (name, elements) in enumerate((("0: rigid", 0), ("1", 1), ("2", 2), ("n", 5))):
        mesh.annotate(f"elements {name}", (-15.0, -n), va="center", fontsize=8)
        for start, length, colour in floors:
            nodes = np.linspace(start, start + length, elements + 1) if elements else [start + length / 2]
            line = [start, start + length]
            mesh.plot(line, [-n, -n], "-", color=colour, linewidth=1 if elements else 3)
            mesh.plot(nodes, [-n] * len(nodes), "o", color=colour, markersize=6)
        mesh.plot([20.0, 24.0], [-n, -n], ":", color="0.4", linewidth=1.2)
        mesh.annotate("k_C", (22.0, 0.15 - n), ha="center", fontsize=8)
    mesh.set_ylim(-3.6, 0.7)
    style.save(figure, path)


def snapshots(path: Path) -> None:
    """Figure 5: velocity and compression along two bars with T1 = 0.75 T2 and Z1 = 0.75 Z2."""
    figure = style.figure(9, 7)
    pair_ = pair(0.5625, 0.75)  # m1/m2 = Z1 T1 / (Z2 T2)
    every = waves(pair_, 60)
    for axes, (name, share) in zip(axes_of(figure, 3, 2, sharex=True, sharey=True), INSTANTS.items()):
        x1, x2, v, f = every(share)
        for x, part in ((x1, slice(0, len(x1))), (x2, slice(len(x1), None))):
            axes.step(
                x, v[part], where="mid", color=COLOURS["El Centro"], label="velocity" if x is x1 else None
            )
            axes.step(
                x, f[part], where="mid", color=COLOURS["Mexico City"], linewidth=1,
                label="force over that of Eq. 11" if x is x1 else None,
            )  # fmt: skip
        axes.axvline(0, color="0.4", linewidth=0.8)
        axes.set_title(name, fontsize=9)
    figure.axes[0].legend(fontsize=7)
    for axes in figure.axes[-2:]:
        axes.set_xlabel("left of 0 diaphragm 1; 1 is the far end of 2")
    style.save(figure, path)


def figure_6(path: Path) -> None:
    """Influence coefficients over the mass ratio: lumped, and distributed by the paper and exact."""
    figure = style.figure(9, 4.2)
    for n, axes in enumerate(axes_of(figure, 1, 2, sharey=True)):
        for colour, tau in zip(["0.1", *COLOURS.values(), "#7a3d7a"], PERIODS):
            pairs = [pair(mu, tau) for mu in RATIOS]
            label = f"T1/T2 = {tau:g}" + (" (lumped)" if tau == 1.0 else "")
            axes.semilogx(
                RATIOS, [p.alpha[n] for p in pairs], "-", color=colour, linewidth=1.3, label=label
            )
            axes.semilogx(RATIOS, [p.alpha_paper[n] for p in pairs], ":", color=colour, linewidth=1.3)
        axes.set_xlabel("m1 / m2")
        axes.set_title(f"alpha {n + 1}: lines exact, dots by the paper", fontsize=9)
    axes.legend(fontsize=7)
    style.save(figure, path)


def figure_7(path: Path) -> None:
    """Effective restitution over the mass ratio, exact and by Eq. 14, and its share r (Eq. 22)."""
    figure = style.figure(7, 4.6)
    axes = axes_of(figure)[0]
    for colour, tau in zip(["0.1", *COLOURS.values(), "#7a3d7a"], PERIODS):
        pairs = [pair(mu, tau) for mu in RATIOS]
        axes.semilogx(
            RATIOS, [p.e for p in pairs], "-", color=colour, linewidth=1.4, label=f"T1/T2 = {tau:g}"
        )
        axes.semilogx(RATIOS, [p.e_paper for p in pairs], ":", color=colour, linewidth=1.2)
        axes.semilogx(RATIOS, [0.5 * p.e for p in pairs], "-", color=colour, linewidth=0.5)
    axes.axhline(0, color="0.4", linewidth=0.8)
    axes.set_ylim(-1, 1.05)
    axes.set_xlabel("m1 / m2")
    axes.set_ylabel("effective restitution")
    axes.set_title("lines exact (thin: r = 0.5), dots Eq. 14", fontsize=9)
    axes.legend(fontsize=7)
    style.save(figure, path)


def theory_map(path: Path) -> None:
    """Error of Eq. 14 over mass and period ratio; none right of the line Z1 = Z2."""
    ratios, periods = np.geomspace(0.05, 20, 161), np.linspace(0.02, 1.0, 99)
    error = np.array([[(p := pair(mu, tau)).e_paper - p.e for mu in ratios] for tau in periods])
    figure = style.figure(7, 4.6)
    axes = axes_of(figure)[0]
    levels = (-2.0, -1.5, -1.0, -0.75, -0.5, -0.25, -0.1, -0.02)
    filled = axes.contourf(ratios, periods, error, levels=(*levels, 1e-9), cmap="YlOrBr_r")
    axes.plot(ratios, np.where(ratios <= 1, ratios, np.nan), "-", color="0.2", linewidth=1.2)
    axes.annotate("Z1 = Z2: the paper\nholds on the left", (0.06, 0.8), fontsize=8)
    first, second = PAIR.first, PAIR.second
    at = first.mass / second.mass, first.period / second.period
    axes.plot(*at, "o", color=style.RED)
    axes.annotate("Table IV", at, fontsize=8, color=style.RED, xytext=(6, -10), textcoords="offset points")
    axes.set_xscale("log")
    axes.set_xlabel("m1 / m2")
    axes.set_ylabel("T1 / T2")
    axes.set_title("e_eff by Eq. 14 less the exact one", fontsize=9)
    figure.colorbar(filled)
    style.save(figure, path)
