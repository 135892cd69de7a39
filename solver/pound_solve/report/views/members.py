"""Forces of members with one row for each end."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, Final

from pound_solve.report.views.instants import decimals
from pound_solve.report.views.part import TablePart, part
from pound_solve.results import Results
from pound_solve.results.columns import ELEMENT, time_column
from pound_solve.results.contents import TABLES
from pound_solve.results.schema import Column

Extremes = Sequence[float]  #: largest value, its time, smallest value, its time

NONE: Final = (math.nan,) * 4
STATIC_COLUMNS: Final = (
    ELEMENT,
    Column("end"),
    Column("axial", "", "F", "num"),
    Column("shear", "", "F", "num"),
    Column("moment", "", "F*L", "num"),
)
END_COLUMNS: Final = (
    ELEMENT,
    Column("end"),
    Column("axial_max", "axial\nmax", "F", "num"),
    Column("axial_min", "axial\nmin", "F", "num"),
    Column("shear_max", "shear\nmax", "F", "num"),
    Column("shear_min", "shear\nmin", "F", "num"),
    Column("max", "moment\nmax", "F*L", "num"),
    time_column("t_max", "at time", ""),
    Column("min", "moment\nmin", "F*L", "num"),
    time_column("t_min", "at time", ""),
    Column("ductility", "hinge\nductility", "-", "short"),
    Column("yield_events", "yield\nevents", "", "count"),
    Column("damage", "damage\nindex", "-", "short"),
)


def envelopes(results: Results) -> list[TablePart]:
    """One row for each end of a member, with what happened to its hinge; then all other forces."""
    rows = results.table("member_envelope")
    envelope = {(r["element"], r["quantity"]): extremes(r) for r in rows}
    hinges, listed = _hinges(results), set[tuple[int, str]]()
    digits, lines = decimals(rows), []
    for element, end, names in ends(rows):
        axial, shear, moment, hinge = (envelope.get((element, name), NONE) for name in names)
        listed.update((element, name) for name in names[:3])
        if _same(hinge, moment):
            listed.add((element, names[3]))
        bent = (moment[0], round(moment[1], digits), moment[2], round(moment[3], digits))
        forces = axial[0], axial[2], shear[0], shear[2], *bent
        lines.append((element, end, *forces, *hinges.get((element, end), NONE[:3])))
    rest = [i for i, r in enumerate(rows) if (r["element"], r["quantity"]) not in listed]
    stored = TABLES["member_envelope"].columns
    return [part(END_COLUMNS, lines)] * bool(lines) + [TablePart(stored, rows[rest])] * bool(rest)


def static_forces(results: Results) -> list[TablePart]:
    """One row for each end of a member; then all other forces."""
    rows = results.table("static_force")
    forces = {(r["element"], r["quantity"]): float(r["value"]) for r in rows}
    listed, lines = set[tuple[int, str]](), []
    for element, end, names in ends(rows):
        axial, shear, moment, hinge = (forces.get((element, name), math.nan) for name in names)
        listed.update((element, name) for name in names[:3])
        if abs(hinge) == abs(moment):
            listed.add((element, names[3]))
        lines.append((element, end, axial, shear, moment))
    rest = [i for i, r in enumerate(rows) if (r["element"], r["quantity"]) not in listed]
    stored = TABLES["static_force"].columns
    return [part(STATIC_COLUMNS, lines)] * bool(lines) + [TablePart(stored, rows[rest])] * bool(rest)


def ends(rows: Any) -> Iterator[tuple[int, str, tuple[str, ...]]]:
    """Ends of the members among rows of elements and quantities: element, end, names of its axial force,
    shear, moment, and moment of the hinge, which is the same where nothing rigid lies between.
    """
    known = {(r["element"], r["quantity"]) for r in rows}
    for element in dict.fromkeys(rows["element"].tolist()):
        axial = "axial" if (element, "axial") in known else ""
        for end in ("I", "J"):
            if (element, f"moment {end}") in known:
                names = axial or f"axial {end}", f"shear {end}", f"moment {end}", f"moment hinge {end}"
                yield element, end, names


def _same(one: Extremes, other: Extremes) -> bool:
    """Whether two extremes are equal, or equal with the sign of the quantity reversed."""
    return tuple(one) in (tuple(other), (-other[2], other[3], -other[0], other[1]))


def _hinges(results: Results) -> dict[tuple[int, str], tuple[float, float, float]]:
    """Ductility, yield events and damage index of the hinge at each end of a member."""
    index: dict[tuple[int, str], float] = {}
    if "damage" in results.tables:
        index = {(r["element"], r["component"]): r["index"] for r in results.table("damage")}
    hinges: dict[tuple[int, str], tuple[float, float, float]] = {}
    for r in results.table("spring_envelope") if "spring_envelope" in results.tables else ():
        kind, _, end = r["component"].partition(" ")
        if kind == "hinge":
            key = (r["element"], r["component"])
            hinges[r["element"], end] = (r["ductility"], r["yield_events"], index.get(key, math.nan))
    return hinges


def extremes(row: Any) -> tuple[float, float, float, float]:
    """Largest value, its time, smallest value and its time of a row of an envelope."""
    return float(row["max"]), float(row["t_max"]), float(row["min"]), float(row["t_min"])
