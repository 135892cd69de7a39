"""Parsing of the numbers of a record: a fast path for clean files, else word by word.

Old Fortran programs write exponents with a D, leave no blank before a minus sign in fixed columns, and
print asterisks where a number does not fit.  The first two are read, the third is an error.

Spreadsheets of many countries write a decimal comma.  If blanks, tabs or semicolons separate the numbers,
such commas are read as points.  If only commas separate digits, their role is ambiguous: the file is
refused if a fraction such as ``,05`` shows that some are decimal.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import chain
from typing import Final

import numpy as np

from pound_solve.loading.records.base import RecordError
from pound_solve.numerics.types import Array

_SEPARATORS: Final = str.maketrans(",;\t", "   ")
_BEYOND: Final = 1e30  # far above every unit and instrument, far below where sums overflow
_OTHER_SEPARATORS: Final = str.maketrans(";\t", "  ")
_D_EXPONENT: Final = str.maketrans("Dd", "EE")
_EXPONENT: Final = r"(?:[EeDd][+-]?\d+)?"
_NUMBER: Final = re.compile(rf"[+-]?(?:\d+(?:\.\d*)?|\.\d+){_EXPONENT}")
# only numbers with a point may lack a blank between them: the date 1940-05-18 is not three numbers
_POINTED: Final = rf"(?:\d+\.\d*|\.\d+){_EXPONENT}"
_GLUED: Final = re.compile(rf"[+-]?{_POINTED}(?:[+-]{_POINTED})+")
# a comma that is no decimal one has no digit before it or none after it
_PARTING: Final = re.compile(r"(?<!\d),|,(?!\d)")
_FRACTION: Final = re.compile(r"\d+,0\d+")
# not numbers, but in place of numbers: such a line is damaged data, not a title
_SPOILT: Final = r"[+-]?(?:nan|inf|infinity)|\*+"
_NUMERIC: Final = re.compile(rf"{_NUMBER.pattern}|{_GLUED.pattern}|{_SPOILT}", re.IGNORECASE)


def is_data(line: str) -> bool:
    """Whether a line consists of numbers alone."""
    words = line.translate(_SEPARATORS).split()
    return bool(words) and all(_NUMERIC.fullmatch(word) for word in words)


def split_head(lines: Sequence[str], comment: str = "#") -> tuple[list[str], list[str], int]:
    """Split a file into its title lines and its data.

    Parameters
    ----------
    lines : sequence of str
    comment : str
        Starts a comment, which is dropped; line numbers do not change.

    Returns
    -------
    title : list of str
        Lines before the first one of numbers, comments included, blank ones left out.
    data : list of str
        The first line of numbers and all that follow.
    first : int
        1-based line number of ``data[0]``.
    """
    bare = [line.partition(comment)[0] for line in lines]
    start = next((k for k, line in enumerate(bare) if is_data(line)), len(bare))
    title = [line.strip("# \t") for line in lines[:start]]
    return [line for line in title if line], bare[start:], start + 1


def parse(lines: Sequence[str], first: int = 1) -> tuple[Array, list[int]]:
    """All numbers of some lines.

    Parameters
    ----------
    lines : sequence of str
        Numbers with blanks, tabs, commas or semicolons between.
    first : int
        Line number of ``lines[0]``, for messages.

    Returns
    -------
    values : ndarray, shape (n,)
    counts : list of int
        Count of numbers in each line.

    Raises
    ------
    RecordError
        R402 with the number of a line that holds anything but finite numbers or commas that may be decimal
        ones, or for no numbers; R404 for a number from 1e30 on.
    """
    lines = _decimal_points(lines, first)
    rows = [line.translate(_SEPARATORS).split() for line in lines]
    try:
        values = np.array(list(chain.from_iterable(rows)), dtype=np.float64)
        # Python accepts 1_000 as a number, which no record means
        clean = bool((np.abs(values) < _BEYOND).all()) and not any("_" in line for line in lines)
    except ValueError:
        clean = False
    if not clean:
        rows = [_patient(row, number) for number, row in enumerate(rows, first)]
        values = np.array(list(chain.from_iterable(rows)), dtype=np.float64)
    if not values.size:
        raise RecordError("R402", "the file holds no numbers")
    return values, [len(row) for row in rows]


def fixed(lines: Sequence[str], width: int) -> list[str]:
    """The same lines with a blank between columns of `width` characters, which Fortran omits."""
    return [" ".join(line[k : k + width] for k in range(0, len(line.rstrip()), width)) for line in lines]


def _decimal_points(lines: Sequence[str], first: int) -> Sequence[str]:
    """The lines with points for decimal commas; R402 where it is ambiguous which commas are decimal."""
    if not any("," in line for line in lines) or any("." in line for line in lines):
        return lines
    words = [line.translate(_OTHER_SEPARATORS).split() for line in lines]
    if any(_PARTING.search(word) for row in words for word in row):
        return lines
    if any(len(row) > 1 for row in words) and all(word.count(",") <= 1 for row in words for word in row):
        return [line.replace(",", ".") for line in lines]
    for number, line in enumerate(lines, first):
        if shown := _FRACTION.search(line):
            raise RecordError(
                "R402",
                f"line {number}: '{shown[0]}' may be a decimal comma",
                "write decimal points; if the comma parts two numbers, put a blank after each comma",
            )
    return lines


def _patient(row: list[str], number: int) -> list[str]:
    """Words of one line as numbers that ``float`` takes, numbers written without a blank separated; or
    R402.
    """
    words = []
    for word in row:
        parts = _NUMBER.findall(word) if _GLUED.fullmatch(word) else [word]
        for part in parts:
            plain = part.translate(_D_EXPONENT)
            if not _NUMBER.fullmatch(part) or not np.isfinite(float(plain)):
                raise RecordError("R402", f"line {number}: '{part[:30]}' is not a finite number")
            if abs(float(plain)) >= _BEYOND:
                raise RecordError("R404", f"line {number}: '{part[:30]}' is beyond any record")
            words.append(plain)
    return words
