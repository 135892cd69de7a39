"""Storeys, and the shapes of modes side by side."""

from __future__ import annotations

import math

import numpy as np

from pound_solve.report.views.instants import digits, latest
from pound_solve.report.views.part import TablePart, part
from pound_solve.results import Results
from pound_solve.results.columns import NODE
from pound_solve.results.contents import TABLES
from pound_solve.results.schema import Column


def storeys(results: Results) -> list[TablePart]:
    """Table of storeys as stored, with instants rounded to leave room for all columns."""
    stored, rows = TABLES["storey_envelope"].columns, results.table("storey_envelope").copy()
    instants = [c.name for c in stored if c.fmt == "time" and c.name in (rows.dtype.names or ())]
    last = max((latest(rows, name) for name in instants), default=0.0)
    for name in instants:
        rows[name] = np.round(rows[name], digits(last))
    return [TablePart(stored, rows)]


def shapes(results: Results) -> list[TablePart]:
    """Modes side by side, one row for each node: X, Y and R one below the other."""
    rows, stored = results.table("mode_shapes"), TABLES["mode_shapes"].columns
    modes = dict.fromkeys(rows["mode"].tolist())
    parts = []
    for column in stored[2:]:
        mode_columns = (Column(f"{n}", f"{column.title}\nmode {n}", column.unit, "short") for n in modes)
        columns = [NODE, *mode_columns]
        ordinates = {(r["node"], r["mode"]): float(r[column.name]) for r in rows}
        if any(ordinates.values()):
            owners = dict.fromkeys(rows["node"].tolist())
            parts.append(
                part(columns, [(n, *(ordinates.get((n, m), math.nan) for m in modes)) for n in owners])
            )
    return parts
