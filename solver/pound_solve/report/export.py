"""Results as CSV: one file for each table and each history."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_deck.model import Units
from pound_solve.numerics.types import Array
from pound_solve.results import Results
from pound_solve.results.schema import Row, Sheet
from pound_solve.results.whole_file import whole

_BLOCK: Final = 4096  #: rows converted to Python numbers at a time


def export_csv(results: Results, folder: str | Path) -> list[Path]:
    """Write ``<table>.csv``, ``history_<name>.csv``, ``closeup_<name>.csv``, ``extremes_<name>.csv`` files.

    Heads contain the units in brackets.  Numbers have all their digits; a missing number is an empty
    cell.  Texts are UTF-8; one that a spreadsheet would take for a formula
    begins with an apostrophe.

    Parameters
    ----------
    results : Results
        The file to export.
    folder : str or Path
        Folder of the files; created if missing, files of the same names are replaced.

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
        *(_extremes(results, name, folder) for name in results.extremes),
    ]


def export_columns(
    results: Results, folder: str | Path, choices: Sequence[tuple[str, Mapping[str, str]]]
) -> Path:
    """Write chosen columns of histories side by side: ``histories.csv``, times first.

    Parameters
    ----------
    results : Results
        The file to export.
    folder : str or Path
        Folder of the file, as for `export_csv`.
    choices : sequence of (str, mapping)
        Names of histories, each with the coordinates of the chosen columns, as texts
        (``{"node": "12", "component": "X"}``); empty: all columns of that history.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    NoSuchPartError
        The file lacks that history, or the history lacks that column.
    """
    heads, columns = [_head("time", results.history_units("time")[0])], [results.time]
    for name, texts in choices:
        coordinates = results.coordinates(name)
        at = {
            key: next((v for v in coordinates.get(key, ()) if str(v) == text), text)
            for key, text in texts.items()
        }
        labels, units = results.labels(name), results.history_units(name)
        places = results.places(name, **at)
        heads += [_head(f"{name} {labels[i]}", units[i]) for i in places]
        columns += list(results.history(name).reshape(len(results.time), len(labels)).T[places])
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    return _write(folder / "histories.csv", heads, _blocks(columns))


def export_rows(path: Path, units: Units, sheet: Sheet, rows: Iterable[Row]) -> None:
    """Write rows of a table outside any results file as CSV; see `export_csv`."""
    heads = [_head(column.name, units.text(column.unit)) for column in sheet.columns]
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
    return _write(folder / f"{kind}_{name.replace('/', '_')}.csv", heads, _blocks([time, *values.T]))


def _extremes(results: Results, name: str, folder: Path) -> Path:
    """Write the extremes of a history within intervals as CSV: bounds, smallest and largest values."""
    bounds, low, high = results.extreme(name)
    unit = results.history_units("time")[0]
    heads, columns = [_head("from", unit), _head("to", unit)], [bounds[:-1], bounds[1:]]
    values = (x.reshape(len(x), len(results.labels(name))).T for x in (low, high))
    for label, of, *both in zip(results.labels(name), results.history_units(name), *values):
        heads += [_head(f"{label} min", of), _head(f"{label} max", of)]
        columns += both
    return _write(folder / f"extremes_{name.replace('/', '_')}.csv", heads, _blocks(columns))


def _blocks(columns: Sequence[Array]) -> Iterator[list[float]]:
    """Yield the rows of columns as Python numbers."""
    for start in range(0, len(columns[0]), _BLOCK):
        yield from np.stack([column[start : start + _BLOCK] for column in columns], axis=1).tolist()


def _write(path: Path, heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> Path:
    with whole(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)
    return path


def _head(name: str, unit: str) -> str:
    return str(_cell(f"{name} [{unit}]" if unit not in ("", "-") else name))


def _cell(value: Any) -> Any:
    """Value as a cell; a text that a spreadsheet would take for a formula gets a leading apostrophe."""
    if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) and not _number(value):
        return "'" + value
    return "" if isinstance(value, float) and math.isnan(value) else value


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return text == "-"
    return True
