"""Picture `contacts`: contact force against overlap."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.members import chosen_contacts
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

MOST = 16  #: panels


def contacts(results: Results, choice: Choice) -> Any:
    """Draw one panel for each contact."""
    names = results.labels("contact/force")
    columns = chosen_contacts(results, choice)
    columns = columns or [k for k, name in enumerate(names) if _peaks(results, name)[2]]
    if not columns:
        raise Nothing("closed contacts")
    shown = columns[:MOST]
    more = f": {len(shown)} of {len(columns)}" if len(shown) < len(columns) else ""
    figure, all_axes = style.panels(len(shown), f"Contacts{more}, at the stored instants")
    for axes, k in zip(all_axes, shown):
        panel(axes, results, k, choice)
    return figure


def panel(axes: Any, results: Results, k: int, choice: Choice) -> None:
    """Draw the force of a contact over its overlap, at the stored instants; a line is its true peak."""
    t, force = results.course("contact/force", jumps=True)
    rows = choice.span(results, t)
    t, force, gap = t[rows], force[rows, k], results.course("contact/gap", jumps=True)[1][rows, k]
    name = results.labels("contact/force")[k]
    style.grid(axes, f"overlap [{results.units.length}]", f"force [{results.units.force}]")
    near = gap <= max(0.0, 0.2 * float(-gap.min()))
    x, y = np.where(near, -gap, np.nan), np.where(near, force, np.nan)
    axes.plot(x, y, ".", color=style.RED, markersize=3)
    for collision in courses.of_contact(results, name, choice):
        closed = (t >= collision["t_start"]) & ~(t > collision["t_end"])
        if closed.sum() >= courses.DENSE:
            # a dashpot's force appears at touch, and a pull ends at parting: the line closes at both
            along, up = -gap[closed], np.concatenate([[0.0], force[closed], [0.0]])
            axes.plot(np.pad(along, 1, "edge"), up, color=style.RED, linestyle="-", linewidth=0.8)
    peak, overlap, closures = _peaks(results, name)
    if closures and np.isfinite(peak) and not choice.between:
        axes.axhline(peak, color="0.3", linestyle="--", linewidth=0.8)
        axes.set_title(f"{style.short(name)}\ndashes: peak of {peak:.5g} {results.units.force}")
        axes.set_xlim(-0.2 * overlap, 1.05 * overlap)
        axes.set_ylim(min(0.0, float(np.nanmin(y, initial=0.0))) - 0.05 * peak, 1.08 * peak)
    else:
        axes.set_title(f"{style.short(name)}" + ("" if closures else "\nnot closed"))


def _peaks(results: Results, name: str) -> tuple[float, float, int]:
    """True peaks of the force and of the overlap of a contact, and its number of collisions."""
    if "contact_summary" in results.tables:
        for row in results.table("contact_summary"):
            if row["contact"] == name:
                return float(row["peak_force"]), float(row["peak_penetration"]), int(row["closures"])
    return float("nan"), float("nan"), 0


SPEC = Picture(
    name="contacts",
    place=120,
    shows="the force of each contact over its overlap, with its true peak",
    needs=("contact/force", "contact/gap"),
    draw=contacts,
    options=("member", "between"),
)
