"""Measured values of a test, with which the runs of a study are compared: peaks, and histories from files.

Each table ``[[measured]]`` is one peak, a quantity of the sweep with its value, or one history with a file
of times and values.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from pound_deck.diagnostics import suggest
from pound_deck.files import contents
from pound_solve.numerics.types import Array
from pound_solve.results.contents import HISTORIES
from pound_solve.statistics.curves import Asked
from pound_solve.sweep.study.asked import asked
from pound_solve.sweep.study.document import Document, Path_

TABLE: Final = "measured"
ITEMS: Final = ("quantity", "value", "history", "label", "file", "columns", "sd", "record")
COMPONENTS: Final = ("X", "Y", "R")  #: of the histories of nodes


@dataclass(frozen=True)
class Measured:
    """One peak or history of a test.

    Attributes
    ----------
    name : str
        Of the quantity or the history, with its label.
    asked : Asked or None
        Quantity of a peak; None for a history.
    history, label : str
        Name of a history, and label of its column.
    times, values : ndarray, shape (n,)
        Times [T] of a history, one NaN for a peak, and measured values.
    sd : float
        Standard deviation of the errors of the values; NaN if it is not known.
    record : str
        Name of the record of the run; empty for the only one.
    """

    name: str
    asked: Asked | None
    history: str
    label: str
    times: Array
    values: Array
    sd: float
    record: str


def measured(document: Document) -> Iterator[Measured]:
    """Yield what a study has measured; mistakes are added to the document."""
    tables = document.tables(TABLE)
    if not tables:
        message = "the study has no measured values"
        document.mistake(
            "S604", message, (TABLE,), f"[[{TABLE}]] with quantity and value, or with history and file"
        )
    for n, items in enumerate(tables):
        path = (TABLE, n)
        document.known(path, ITEMS)
        sd = document.take((*path, "sd"), float, math.nan)
        record = document.take((*path, "record"), str, "")
        if sd <= 0.0:
            document.mistake("S603", "sd is above zero", (*path, "sd"))
        if ("quantity" in items) == ("history" in items):
            message = "a measured value is that of a quantity or of a history"
            document.mistake("S605", message, path, "give quantity and value, or history and file")
        elif "quantity" in items:
            yield from _peak(document, path, sd, record)
        else:
            yield from _history(document, path, sd, record)
    unknown = [n for n, items in enumerate(tables) if "sd" not in items]
    if unknown and len(tables) > 1:
        message = "sd tells how much one measured value counts beside the others"
        document.mistake(
            "S604", message, (TABLE, unknown[0]), "give each the standard deviation of its errors"
        )


def _peak(document: Document, path: Path_, sd: float, record: str) -> Iterator[Measured]:
    """A measured peak."""
    text = document.take((*path, "quantity"), str, "")
    quantity = asked(document, (*path, "quantity"), text)
    value = document.take((*path, "value"), float, math.nan)
    if document.at((*path, "value")) is None:
        document.mistake("S604", f"{text} has no value", path, "value = 1520.0")
    for item in ("file", "label", "columns"):
        if document.at((*path, item)) is not None:
            document.mistake("S605", f"{item} belongs to a history", (*path, item))
    yield Measured(text, quantity, "", "", np.array([math.nan]), np.array([value]), sd, record)


def _history(document: Document, path: Path_, sd: float, record: str) -> Iterator[Measured]:
    """A measured history, from its file."""
    name = document.take((*path, "history"), str, "")
    label = document.take((*path, "label"), str, "")
    if name not in HISTORIES or name == "time":
        hint = suggest(name, HISTORIES) or f"there are {', '.join(HISTORIES)}"
        document.mistake("S602", f"there is no history {name}", (*path, "history"), hint)
        return
    if document.at((*path, "value")) is not None:
        document.mistake("S605", "value belongs to a quantity", (*path, "value"))
    file = document.take((*path, "file"), str, "")
    if not file:
        document.mistake("S604", f"{name} names no file", path, 'file = "test.csv" with times and values')
        return
    columns = document.listed((*path, "columns"), (int,)) or [1, 2]
    if len(columns) != 2 or min(columns) < 1:
        document.mistake(
            "S603", "columns are two numbers from 1: of the times and the values", (*path, "columns")
        )
        return
    rows = _rows(document, (*path, "file"), document.folder / Path(file).expanduser(), columns)
    if rows is not None:
        yield Measured(
            " ".join(filter(None, [name, label])), None, name, label, rows[:, 0], rows[:, 1], sd, record
        )


def _rows(document: Document, path: Path_, file: Path, columns: Sequence[int]) -> Array | None:
    """Times and values of a text file, shape (n, 2): numbers separated by commas or blanks, below lines of
    heads; None, with a mistake, if it has none.
    """
    try:
        text = contents(file).decode("utf-8-sig", "replace")
    except OSError as err:
        document.mistake("S604", f"{file.name} cannot be read: {err.strerror or err}", path)
        return None
    rows: list[tuple[float, ...]] = []
    for count, line in enumerate(text.splitlines(), 1):
        words = line.replace(",", " ").replace(";", " ").split()
        if not words or words[0].startswith("#"):
            continue
        try:
            row = tuple(float(words[c - 1]) for c in columns)
        except (ValueError, IndexError):
            if not rows:  # a head
                continue
            message = f"{file.name}, line {count}: no numbers in columns {columns[0]} and {columns[1]}"
            document.mistake("S605", message, path)
            return None
        if not all(map(math.isfinite, row)) or (rows and row[0] <= rows[-1][0]):
            document.mistake(
                "S605", f"{file.name}, line {count}: times increase, and all numbers are finite", path
            )
            return None
        rows.append(row)
    if not rows:
        document.mistake("S605", f"{file.name} has no lines of numbers", path)
        return None
    return np.array(rows)


def column(kept: Mapping[str, Array], name: str, label: str) -> tuple[Array | None, list[str]]:
    """Column of a kept history by its label, shape (n_times,), and the labels that there are.

    Parameters
    ----------
    kept : mapping of str to ndarray
        Histories of a run with their labels, see `work.histories_of`.
    name, label : str
        An empty label stands for the only column.
    """
    if name not in kept:
        return None, []
    rows = kept[name].reshape(len(kept[name]), -1)
    labels = _labels(kept, name, rows.shape[1])
    if not label and len(labels) == 1:
        return rows[:, 0], labels
    return (rows[:, labels.index(label)] if label in labels else None), labels


def _labels(kept: Mapping[str, Array], name: str, count: int) -> list[str]:
    """Labels of the columns of a history."""
    if f"{name}|labels" in kept:
        labels = kept[f"{name}|labels"].tolist()
    elif f"{name}|nodes" in kept:
        labels = [f"{node} {c}" for node in kept[f"{name}|nodes"].tolist() for c in COMPONENTS]
    elif f"{name}|element" in kept:
        pairs = zip(kept[f"{name}|element"].tolist(), kept[f"{name}|quantity"].tolist())
        labels = [f"{element} {quantity}" for element, quantity in pairs]
    else:
        labels = []
    return labels if len(labels) == count else [str(k) for k in range(1, count + 1)]
