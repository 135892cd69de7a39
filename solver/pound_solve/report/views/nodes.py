"""Envelopes of nodes and supports with one row for each node."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from pound_solve.report.views.instants import decimals
from pound_solve.report.views.members import NONE, extremes
from pound_solve.report.views.part import TablePart, part
from pound_solve.results import Results
from pound_solve.results.columns import NODE, time_column
from pound_solve.results.schema import Column

#: dimension of each quantity of the nodes, of their directions X, Y and R
MOTION: Final[Mapping[str, tuple[str, ...]]] = {
    "displacement": ("L", "L", "rad"),
    "velocity": ("L/T", "L/T", "rad/T"),
    "acceleration": ("L/T^2", "L/T^2", "rad/T^2"),
}
#: names and dimensions of the quantities of a support
REACTION: Final = (("force X", "F"), ("force Y", "F"), ("moment", "F*L"))


def motion(results: Results) -> list[TablePart]:
    """For each quantity: one row for each node, its directions side by side."""
    rows = results.table("node_envelope")
    parts = []
    for quantity, dimensions in MOTION.items():
        envelope = rows[rows["quantity"] == quantity]
        if len(envelope):
            heads = [(d, unit) for d, unit in zip("XYR", dimensions)]
            parts.append(_beside(envelope, "direction", heads, quantity))
    return parts


def reactions(results: Results) -> list[TablePart]:
    """One row for each support, its forces and its moment side by side."""
    return [_beside(results.table("reaction_envelope"), "quantity", REACTION, "")]


def _beside(rows: Any, by: str, quantities: Sequence[tuple[str, str]], title: str) -> TablePart:
    """Part with one row for each node: the extremes of its quantities side by side."""
    present = [(name, unit) for name, unit in quantities if (rows[by] == name).any()]
    columns, digits = [NODE], decimals(rows)
    for name, unit in present:
        columns += [
            Column(f"{name} max", f"{name}\nmax", unit, "num"),
            time_column(f"{name} t_max", "at time", ""),
            Column(f"{name} min", f"{name}\nmin", unit, "num"),
            time_column(f"{name} t_min", "at time", ""),
        ]
    envelope = {(r["node"], r[by]): extremes(r) for r in rows}

    def values(owner: int) -> Iterator[float]:
        for name, _ in present:
            high, t_high, low, t_low = envelope.get((owner, name), NONE)
            yield from (high, round(t_high, digits), low, round(t_low, digits))

    lines = [(owner, *values(owner)) for owner in dict.fromkeys(rows["node"].tolist())]
    return part(columns, lines)._replace(title=title)
