"""Results as CSV: one file for each table and each history."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

from pound_deck.model import Units
from pound_solve.numerics.types import Array
from pound_solve.results import Results
from pound_solve.results.schema import Row, Table

_BLOCK: Final = 4096  #: rows that are turned into Python numbers at a time


def export_csv(results: Results, folder: str | Path) -> list[Path]:
    """Write ``<table>.csv``, ``history_<name>.csv`` and ``closeup_<name>.csv`` files.

    Heads hold the units in brackets.  Numbers have all their digits; a number that is missing is an empty
    cell.  Texts are UTF-8; one that a spreadsheet would take for a formula
    begins with an apostrophe.

    Parameters
    ----------
    results : Results
        The file to export.
    folder : str or Path
        Where the files go; made if it does not exist, files of the same names are replaced.

    Returns
    -------
    list of Path
        The files, in the order of the report.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    return [
        *(_table(results, name, folder) for name in results.tables),
        *(
            _history(results, name, folder, "history", results.time, results.history(name))
            for name in results.histories
            if name != "time"
        ),
        *(_history(results, name, folder, "closeup", *results.closeup(name)) for name in results.closeups),
    ]


def export_rows(path: Path, units: Units, table: Table[Any], rows: Iterable[Row]) -> None:
    """Write rows of a table that is not in a results file as CSV; see `export_csv`."""
    heads = [_head(column.name, units.text(column.unit)) for column in table.columns]
    _write(path, heads, ([_cell(v) for v in row] for row in rows))


def _table(results: Results, name: str, folder: Path) -> Path:
    heads = [_head(column, unit) for column, unit in results.table_units(name).items()]
    rows = ([_cell(v) for v in row] for row in results.table(name).tolist())
    return _write(folder / f"{name}.csv", heads, rows)


def _history(results: Results, name: str, folder: Path, kind: str, time: Array, values: Array) -> Path:
    labels = results.labels(name)
    values = values.reshape(len(time), len(labels))
    heads = [_head("time", results.history_units("time")[0])]
    heads += map(_head, labels, results.history_units(name))
    rows = (
        [t, *row]
        for start in range(0, len(time), _BLOCK)
        for t, row in zip(time[start : start + _BLOCK].tolist(), values[start : start + _BLOCK].tolist())
    )
    return _write(folder / f"{kind}_{name.replace('/', '_')}.csv", heads, rows)


def _write(path: Path, heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> Path:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)
    return path


def _head(name: str, unit: str) -> str:
    return str(_cell(f"{name} [{unit}]" if unit not in ("", "-") else name))


def _cell(value: Any) -> Any:
    """A value as a cell; a text that a spreadsheet would compute gets an apostrophe in front."""
    if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) and not _number(value):
        return "'" + value
    return "" if isinstance(value, float) and math.isnan(value) else value


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return text == "-"
    return True
