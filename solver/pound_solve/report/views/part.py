"""A part of a table as it is printed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.results.schema import FORMATS, Column


class TablePart(NamedTuple):
    """Columns, rows as a structured array whose fields are the columns, and a title line."""

    columns: tuple[Column, ...]
    rows: NDArray[Any]
    title: str = ""


def part(columns: Sequence[Column], rows: Iterable[Sequence[Any]]) -> TablePart:
    """Make a part from rows with one value for each column."""
    kinds = [object if FORMATS[c.fmt] == "text" else FORMATS[c.fmt] for c in columns]
    kind = np.dtype([(c.name, k) for c, k in zip(columns, kinds)])
    return TablePart(tuple(columns), np.array([tuple(row) for row in rows], kind))
