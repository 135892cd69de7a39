"""The echo of the deck in groups: ranges of nodes and elements, nodes of equal values, items of a set."""

from __future__ import annotations

from typing import Any, Final

from pound_solve.report.views.part import TablePart, part
from pound_solve.report.views.ranges import between, numbers, stepping
from pound_solve.results import Results
from pound_solve.results.contents import TABLES
from pound_solve.results.schema import Column

FEW: Final = 1e-12  #: fraction of a range that a coordinate which does not change may still differ by


def properties(results: Results) -> list[TablePart]:
    """One row for each property set and kind: the items that are given, then those of default value."""
    sets: dict[tuple[str, str], tuple[list[str], list[str]]] = {}
    for r in results.table("properties"):
        unit = f" {r['unit']}" if r["unit"] else ""
        items = sets.setdefault((r["property"], r["kind"]), ([], []))
        items[r["default"] == "*"].append(f"{r['item']} {r['value']}{unit}")
    columns = Column("property"), Column("kind"), Column("given"), Column("default", "default (*)")
    rows = ((*key, ", ".join(given), ", ".join(default)) for key, (given, default) in sets.items())
    return [part(columns, rows)]


def ranges(name: str, results: Results) -> list[TablePart]:
    """Table of the deck with rows that step evenly merged into one."""
    columns, rows = _stored(results, name)
    merged = []
    for first, last, count in stepping(rows):
        merged.append(tuple(_cell(c, a, b, count) for c, a, b in zip(columns, first, last)))
    return [part([Column(c.name, c.head, c.unit) for c in columns], merged)]


def _stored(results: Results, name: str) -> tuple[list[Column], list[tuple[Any, ...]]]:
    """Columns of a table that are in the file, and its rows as tuples."""
    rows = results.table(name)
    columns = [c for c in TABLES[name].columns if c.name in (rows.dtype.names or ())]
    return columns, list(zip(*(rows[c.name].tolist() for c in columns)))


def _cell(column: Column, first: Any, last: Any, count: int) -> str:
    """Text of a column in a range of rows: its value, or its first and last value."""
    if column.fmt == "text":
        return str(first)
    if column.fmt == "int":
        if column.zero and not first:
            return column.zero
        return str(first) if first == last else between(first, last, (last - first) // (count - 1))
    if first != first:
        return "-"
    digits = 10 if column.fmt == "given" else 5
    a, b = (f"{0.0 if abs(x) <= FEW * max(abs(first), abs(last)) else x:.{digits}g}" for x in (first, last))
    return a if a == b else f"{a} to {b}"


def equal(name: str, results: Results) -> list[TablePart]:
    """Table of the deck with rows of equal values merged into one that lists their numbers."""
    (key, *columns), rows = _stored(results, name)
    groups: dict[tuple[Any, ...], list[int]] = {}
    for owner, *values in rows:
        groups.setdefault(tuple(values), []).append(owner)
    owners = Column(key.name, f"{key.name}s")
    return [part([owners, *columns], ((numbers(group), *values) for values, group in groups.items()))]
