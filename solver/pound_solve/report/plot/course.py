"""Pictures of a time history: drifts and ground, energies, collisions, loops of springs and contacts."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import style
from pound_solve.results import Results
from pound_solve.results.histories.energy import ENERGIES

MOST_LOOPS = 16


def histories(results: Results) -> Any:
    """Ground accelerations, drifts, contact forces over time."""
    wanted = [h for h in ("ground", "drift", "contact/force") if h in results.histories]
    figure = style.figure(9.0, 2.6 * len(wanted) + 0.4, results.title)
    first = None
    for n, name in enumerate(wanted):
        axes = figure.add_subplot(len(wanted), 1, n + 1, sharex=first)
        first = first or axes
        last = n == len(wanted) - 1
        unit = ", ".join(dict.fromkeys(results.history_units(name)))
        title = {"ground": "ground acceleration", "drift": "drift", "contact/force": "contact force"}[name]
        style.grid(axes, f"time [{results.units.time}]" if last else "", f"{title} [{unit}]")
        t, rows = results.course(name)
        for k, (label, values) in enumerate(zip(results.labels(name), rows.T)):
            axes.plot(t, values, color=style.COLOURS[k % len(style.COLOURS)], linewidth=0.8, label=label)
        if len(results.labels(name)) <= 12:
            axes.legend(fontsize=6, ncols=4, loc="upper right")
    return figure


def energy(results: Results) -> Any:
    """Energies over time, piled up against what was there at the start and the work put in."""
    t, values = results.time, results.history("energy")
    by_name = dict(zip(ENERGIES, values.T))
    figure = style.figure(8.0, 4.2, "Energy")
    axes = style.grid(
        figure.add_subplot(), f"time [{results.units.time}]", f"energy [{results.units.text('F*L')}]"
    )
    parts = ("kinetic", "strain", "damping", "hysteretic", "contact")
    colours = ("#9dc3e6", "#c9b3e0", "#f2c48d", "#e39a8b", "#a9cf9f")
    axes.stackplot(t, *(by_name[p] for p in parts), labels=parts, colors=colours)
    there = sum(by_name[p][0] for p in parts)  # strain under gravity, motion of INITIAL
    label = "input" if there == 0.0 else "energy at the start plus input"
    axes.plot(t, there + by_name["input"], color="0.1", linewidth=1.2, label=label)
    axes.legend(fontsize=7, loc="upper left")
    return figure


def collisions(results: Results) -> Any:
    """When every contact was closed, and how hard it was hit."""
    table, names = results.table("collisions"), list(results.labels("contact/force"))
    figure = style.figure(9.0, 0.55 * len(names) + 3.4, "Collisions")
    top, bottom = figure.add_subplot(2, 1, 1), figure.add_subplot(2, 1, 2)
    style.grid(top, "", f"peak force [{results.units.force}]")
    style.grid(bottom, f"time [{results.units.time}]")
    end = results.last_time
    for n, name in enumerate(names):
        colour = style.COLOURS[n % len(style.COLOURS)]
        own = table[[str(c) == name for c in table["contact"]]]
        last = np.where(np.isnan(own["t_end"]), end, own["t_end"])
        if len(own):
            top.vlines(own["t_start"], 0.0, own["peak_force"], color=colour, linewidth=0.9)
        top.plot(own["t_start"], own["peak_force"], "o", color=colour, markersize=3.5, label=name)
        # a collision is short: no bar is thinner than a line
        width = np.maximum(last - own["t_start"], 0.002 * end)
        bottom.barh(np.full(len(own), n), width, left=own["t_start"], color=colour, height=0.6)
    for axes in (top, bottom):
        axes.set_xlim(results.time[0], end)
    top.set_ylim(bottom=0.0)
    top.legend(fontsize=7)
    bottom.set_yticks(range(len(names)), names, fontsize=7)
    bottom.set_ylim(-0.6, len(names) - 0.4)
    bottom.set_title("closed", fontsize=8)
    return figure


def loops(results: Results) -> Any:
    """Force against deformation of the springs and hinges that yielded most."""
    force, deformation = results.history("spring/force"), results.history("spring/deformation")
    labels, units = results.labels("spring/force"), results.history_units("spring/force")
    span = np.ptp(deformation, axis=0)
    held = np.abs(force).max(axis=0)
    area = np.abs(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(deformation, axis=0), axis=0))
    scale = np.where(span * held > 0.0, span * held, 1.0)
    chosen = np.sort(np.argsort(-area / scale, kind="stable")[:MOST_LOOPS])
    more = f": {len(chosen)} of {len(labels)}, those that yielded most" if len(chosen) < len(labels) else ""
    figure, all_axes = style.panels(len(chosen), f"Springs and hinges{more}")
    deformed = results.history_units("spring/deformation")
    for axes, k in zip(all_axes, chosen.tolist()):
        turns = deformed[k] == "rad"
        style.grid(
            axes,
            f"{'rotation' if turns else 'deformation'} [{deformed[k]}]",
            f"{'moment' if turns else 'force'} [{units[k]}]",
        )
        axes.plot(deformation[:, k], force[:, k], color=style.BLUE, linewidth=0.8)
        axes.set_title(labels[k], fontsize=8)
    return figure


def contacts(results: Results) -> Any:
    """Contact force against overlap, by the stored samples and close-ups."""
    force, gap = (results.course(name)[1] for name in ("contact/force", "contact/gap"))
    names = results.labels("contact/force")
    figure, all_axes = style.panels(len(names), "Contacts, as sampled")
    for k, (axes, name) in enumerate(zip(all_axes, names)):
        style.grid(axes, f"overlap [{results.units.length}]", f"force [{results.units.force}]")
        near = gap[:, k] <= max(0.0, 0.2 * float(-gap[:, k].min()))
        # a line only between neighbours in time that both are close
        x, y = np.where(near, -gap[:, k], np.nan), np.where(near, force[:, k], np.nan)
        axes.plot(x, y, color=style.RED, linewidth=0.8, marker=".", markersize=3)
        axes.set_title(name, fontsize=8)
    return figure
