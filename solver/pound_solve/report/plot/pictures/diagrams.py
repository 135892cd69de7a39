"""Picture `diagrams`: bending moments, shear and axial forces along the members."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import geometry, labels, style
from pound_solve.report.plot.members import QUANTITIES, MemberForces, lines
from pound_solve.report.plot.moments import moment
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

SHARE = 0.11  #: largest value as a fraction of the structure's size
MOST = 60  #: members whose values are written, those with the largest
WIDEST = 0.35  #: and no more than this fraction of a middling member's length
UNITS = {"M": "F*L", "V": "F", "N": "F"}


def diagrams(results: Results, choice: Choice) -> Any:
    """Draw the three beside or below each other, at an instant or as envelopes."""
    at = moment(results, "member/force", choice) if choice.at_instant else None
    s, chosen = spread(results, choice, at.row if at else None)
    shown = [q for q in QUANTITIES if any(q in line.low for line in chosen)]
    if not shown:
        raise Nothing("members with forces at both ends")
    width, height = s.shape()
    upright = height > 0.8 * width
    scale = min(1.0, 5.0 / width) if upright else min(1.0, 8.0 / width)
    width, height = max(4.0, width * scale), max(2.4, height * scale) + 0.3
    size = (width * len(shown), height + 0.4) if upright else (width, height * len(shown) + 0.4)
    figure = style.figure(*size, title=f"Member forces {at.title}" if at else title(results, choice))
    for n, quantity in enumerate(shown):
        axes = figure.add_subplot(*((1, len(shown)) if upright else (len(shown), 1)), n + 1)
        panel(axes, s, [line for line in chosen if quantity in line.low], quantity)
    return figure


def spread(
    results: Results, choice: Choice, row: Array | None = None
) -> tuple[geometry.DrawnStructure, list[MemberForces]]:
    """The structure and the forces along the chosen members, with neighbours so far apart that their
    diagrams do not overlap.
    """
    s = geometry.DrawnStructure(results)
    members = list(lines(results, s.place, choice, row))
    s = geometry.DrawnStructure(results, geometry.apart(2.0 * _largest_drawn(s, members) / s.size))
    moves = {int(e["element"]): s.place[int(e["i"])] - s.true[int(e["i"])] for e in s.elements}
    return s, [replace(x, i=x.i + moves[x.element], j=x.j + moves[x.element]) for x in members]


def _largest_drawn(s: geometry.DrawnStructure, members: list[MemberForces]) -> float:
    """Length that the largest value is drawn with [L]."""
    lengths = [float(np.hypot(*(line.j - line.i))) for line in members]
    return min(SHARE * s.size, WIDEST * float(np.median(lengths))) if lengths else SHARE * s.size


def title(results: Results, choice: Choice) -> str:
    """Return what the diagrams show where no instant is chosen."""
    if not len(results.time):
        return "Member forces of the static state"
    if choice.between:
        return (
            f"Envelopes of the member forces from {choice.between[0]:g} to {choice.between[1]:g} "
            f"{results.units.time}"
        )
    return "Envelopes of the member forces"


def panel(axes: Any, s: geometry.DrawnStructure, members: list[MemberForces], quantity: str) -> None:
    """Draw one force along some members, with the largest and smallest values of each as text."""
    s.frame(axes, 0.06 + SHARE)
    s.draw(axes, color="0.6", linewidth=0.8)
    s.draw_contacts(axes)
    low, high = extremes(members, quantity)
    top = max(abs(low), abs(high)) or 1.0
    factor = scale(s, members, quantity)
    one = all(np.array_equal(line.low[quantity], line.high[quantity]) for line in members)
    for line in members:
        both = ((line.high[quantity], style.BLUE), (line.low[quantity], style.RED))
        for values, colour in both[: 1 if one else 2]:
            base, edge = outline(line, values, quantity, factor)
            axes.fill(*np.hstack([edge, base[:, ::-1]]), color=colour, alpha=0.18, linewidth=0)
            axes.plot(*np.hstack([base[:, :1], edge, base[:, -1:]]), color=colour, linestyle="-",
                      linewidth=0.8)  # fmt: skip
    order = sorted(members, key=lambda x: -max(abs(x.low[quantity]).max(), abs(x.high[quantity]).max()))
    for line in order[:MOST]:
        _values(axes, line, quantity, factor, 0.02 * top, (low, high))
    unit, word = s.units.text(UNITS[quantity]), QUANTITIES[quantity][0]
    remarks = ["drawn on the side in tension"] * (quantity == "M") + ["blue: largest, red: smallest"] * (
        not one
    )
    axes.set_title(f"{word} {quantity} [{unit}]: {low:.5g} to {high:.5g}\n{'; '.join(remarks)}")


def extremes(members: list[MemberForces], quantity: str) -> tuple[float, float]:
    """Smallest and largest value of one force of some members."""
    low = min(float(line.low[quantity].min()) for line in members)
    return low, max(float(line.high[quantity].max()) for line in members)


def scale(s: geometry.DrawnStructure, members: list[MemberForces], quantity: str) -> float:
    """Length that a unit of one force is drawn with."""
    return _largest_drawn(s, members) / (max(map(abs, extremes(members, quantity))) or 1.0)


def outline(line: MemberForces, values: Array, quantity: str, factor: float) -> tuple[Array, Array]:
    """Points of a member's axis, and the points offset from them by the values, shape (2, n) each."""
    along = (line.j - line.i) / max(float(np.hypot(*(line.j - line.i))), 1e-300)
    left = np.array([-along[1], along[0]]) * (-1.0 if quantity == "M" else 1.0)
    base = line.i[:, None] + (line.j - line.i)[:, None] * line.x
    return base, base + factor * left[:, None] * values


def _values(
    axes: Any, line: MemberForces, quantity: str, factor: float, least: float, ends: tuple[float, float]
) -> None:
    """Label the largest and the smallest value of a member, if they differ and are not small; those of all
    members, the `ends`, also far from it.
    """
    labelled: list[float] = []
    one = np.array_equal(line.low[quantity], line.high[quantity])
    for values, furthest, sign in (
        (line.high[quantity], np.argmax, 1.0),
        (line.low[quantity], np.argmin, -1.0),
    ):
        at = int(furthest(values))
        value = float(values[at])
        if abs(value) < least or any(abs(value - other) < least for other in labelled):
            continue
        labelled.append(value)
        base, edge = outline(line, values, quantity, factor)
        # beyond the shading, unless that of the other extreme is on the same side of the member
        side = (edge - base)[:, at] if one or sign * value > 0.0 else (0.0, 0.0)
        labels.label(axes, edge[:, at], _text(value), value in ends, side, fontsize=6)


def _text(value: float) -> str:
    """Text of a value with three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):g}"


SPEC = Picture(
    name="diagrams",
    place=160,
    shows="bending moments, shear and axial forces along the members, at an instant or as envelopes",
    needs=("nodes", "elements", "properties"),
    draw=diagrams,
    options=("member", "time", "at_peak", "between"),
)
