r"""Separation of two buildings by rules on the peak displacements of a run, at every contact.

:math:`u_1, u_2` are the largest absolute displacements of the contact's nodes along its direction.

* ABS: :math:`u_1 + u_2`
* SRSS: :math:`\sqrt{u_1^2 + u_2^2}`
* DDC, the double difference combination, see `statistics.separation`
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from pound_solve.report.text import printed
from pound_solve.results import Results
from pound_solve.results.columns import CONTACT
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.statistics.separation import SeparationPeaks, correlation, own_mode
from pound_solve.structure.elements.base import axes
from pound_solve.user_error import UserError

NAN: Final = math.nan
FREE, MET = "free: nothing met", "pounding: something met"
UNKNOWN = "; no DDC without periods and damping: MODAL SHAPES=YES, or --periods and --damping"


class SeparationError(UserError):
    """Raised if a results file lacks data that the rules need."""

    status = 3


def text(results: Results, periods: Sequence[float] = (), damping: Sequence[float] = ()) -> str:
    """Table of the rules for all contacts of a results file, as the report prints tables.

    Parameters
    ----------
    results : Results
    periods : sequence of two floats
        Periods of the buildings of nodes I and J [T], instead of those of the modes.
    damping : sequence of two floats
        Damping of these buildings [%], instead of that of the modes.

    Raises
    ------
    SeparationError
        The file has no contact or no history.
    """
    return "\n".join(printed(results.units, TABLE, rows(results, periods, damping)))


def rows(results: Results, periods: Sequence[float] = (), damping: Sequence[float] = ()) -> list[Row]:
    """One row for each contact; see `text`."""
    _check(results)
    ends = {e["name"] or str(e["element"]): (e["i"], e["j"]) for e in results.table("elements")}
    summary = {row["contact"]: row for row in results.table("contact_summary")}
    early = "" if results.status == "done" else f"; the run ended early, at {results.last_time:g}"
    met = any(row["closures"] > 0 for row in summary.values())  # which changes all displacements
    note = (MET if met else FREE) + early
    separations = []
    for law in results.table("contact_laws"):
        direction, nodes = axes(law["angle"])[0], ends[law["contact"]]
        u1, u2 = (_peak(results, node, direction) for node in nodes)
        modes = [_mode(results, node, direction) for node in nodes]
        t1, t2 = periods or [m[0] for m in modes]
        xi1, xi2 = damping or [m[1] for m in modes]
        ddc, remark = _ddc(u1, u2, (t1, t2), (xi1, xi2))
        gap = float(law["gap"])
        closure = NAN if met else gap - float(summary[law["contact"]]["min_gap"])
        sums = (u1 + u2, math.hypot(u1, u2), ddc)
        separations.append((law["contact"], u1, u2, t1, t2, xi1, xi2, *sums, closure, gap, note + remark))
    return separations


def _check(results: Results) -> None:
    """Raise a SeparationError if there is no history or no contact."""
    if math.isnan(results.last_time):
        why = f": {results.message}" if results.message else ""
        raise SeparationError(f"{results.path} holds no history{why}")
    needed = {"contact_laws", "contact_summary", "node_envelope", "elements"}
    if not needed <= set(results.tables) or not len(results.table("contact_laws")):
        raise SeparationError(f"{results.path}: the rules need a HISTORY of a deck with contacts")


def _ddc(
    u1: float, u2: float, periods: tuple[float, float], damping: tuple[float, float]
) -> tuple[float, str]:
    """Double difference combination of two peaks [L]; a remark if a period or damping [%] is unknown."""
    rho = correlation(*periods, *(xi / 100.0 for xi in damping))
    return SeparationPeaks(u1, u2, rho).difference, UNKNOWN if math.isnan(rho) and u1 and u2 else ""


def _peak(results: Results, node: int, direction: tuple[float, float]) -> float:
    """Largest absolute displacement of a node; 0 for a wall, NaN if not stored."""
    if node == 0:
        return 0.0
    envelope = results.table("node_envelope")
    displacements = envelope[(envelope["node"] == node) & (envelope["quantity"] == "displacement")]
    if 0.0 in direction:
        axis = displacements[displacements["direction"] == ("X" if direction[0] else "Y")]
        return float(max(abs(axis["max"][0]), abs(axis["min"][0]))) if len(axis) else NAN
    if "node/u" not in results.histories or node not in results.attributes("node/u")["nodes"]:
        return NAN
    at = results.attributes("node/u")["nodes"].index(node)
    return float(np.abs(results.history("node/u")[:, at, :2] @ direction).max(initial=0.0))


def _mode(results: Results, node: int, direction: tuple[float, float]) -> tuple[float, float]:
    """Period [T] and damping [%] of the longest mode in which a node takes part; NaN without one."""
    if not {"modes", "mode_shapes"} <= set(results.tables):
        return NAN, NAN
    shapes, modes = results.table("mode_shapes"), results.table("modes")
    shape = shapes[shapes["node"] == node]
    chosen = modes[np.isin(modes["mode"], shape["mode"])]
    return own_mode(
        shape["x"] * direction[0] + shape["y"] * direction[1], chosen["period"], chosen["damping"]
    )


TABLE = Sheet(
    columns=(
        CONTACT,
        Column("u1", "peak\nnode I", "L", "short", doc="largest absolute displacement along the contact"),
        Column("u2", "peak\nnode J", "L", "short", doc="the same; 0 for a wall"),
        Column("t1", "period\nI", "T", "short", doc="period of the building of node I"),
        Column("t2", "period\nJ", "T", "short", doc="period of the building of node J"),
        Column("xi1", "damping\nI", "%", "percent", doc="damping of that mode"),
        Column("xi2", "damping\nJ", "%", "percent", doc="damping of that mode"),
        Column("abs", "ABS", "L", "num", doc="sum of the peaks"),
        Column("srss", "SRSS", "L", "num", doc="root of the sum of their squares"),
        Column("ddc", "DDC", "L", "num", doc="double difference combination"),
        Column("needed", "gap\nneeded", "L", "num", doc="largest closure of this run, if nothing met"),
        Column("gap", "gap of\nthe deck", "L", "num", doc="gap of the contact"),
        Column("note", "run", doc="whether the buildings moved freely, and what is not known"),
    ),
    note="Peaks are absolute displacements from the node envelopes of this run. The gap needed is its "
    "largest closure, if nothing met in it; else run the deck with gaps that stay open. The period of a "
    "building is that of the longest mode in which the node has a tenth of the largest component, or "
    "--periods.",
)
