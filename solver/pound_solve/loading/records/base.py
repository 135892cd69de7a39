"""Common parts of all record formats: the samples as read, the two functions of a format, and errors.

Codes of :class:`RecordError`:

====== ===================================================================================
R401   the record is not found
R402   the file cannot be read: format not recognised, no finite number, times in disorder
R403   the number of values in the file differs from the declared one
R404   a value exceeds that of any record
R405   an item of the card is missing, or does not fit the file
====== ===================================================================================
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from pound_solve.numerics.types import Array

HEAD: Final = 4096  #: largest number of characters passed to `sniff`
#: bounds of steps, rates and factors in headers; numbers outside them are refused
MIN_NUMBER: Final = 1e-9
MAX_NUMBER: Final = 1e9


class RecordError(Exception):
    """A record that cannot be used; the application shows it at the card that names the record.

    Parameters
    ----------
    code : str
        Number in the table at the head of this module.
    message : str
        Description of the error, with line and counts where known.
    hint : str
        Remedy, or empty.
    item : str
        Item of the card that is at fault.
    """

    def __init__(self, code: str, message: str, hint: str = "", item: str = "FILE") -> None:
        super().__init__(code, message, hint)
        self.code = code
        self.message = message
        self.hint = hint
        self.item = item

    def __str__(self) -> str:
        return f"{self.code}: {self.message}" + (f" ({self.hint})" if self.hint else "")

    def within(self, name: str) -> RecordError:
        """The same error, with the name of the file in front of its message."""
        return RecordError(self.code, f"{name}: {self.message}", self.hint, self.item)


@dataclass(frozen=True, slots=True, eq=False)
class RawRecord:
    """The samples of one component as in the file.

    Attributes
    ----------
    values : ndarray, shape (n,), [`unit`]
        Ground acceleration.
    dt : float or None, [s]
        Step of an evenly sampled record; its first sample is at time 0.
    times : ndarray, shape (n,), or None, [s]
        Times of the samples where the file gives them.
    unit : str or None
        ``G``, ``M/S2``, ``CM/S2`` or ``MM/S2``; None if the file names no unit.
    declared : int or None
        Number of values stated in the file's header.
    component : str
        Name of the component, or empty.
    title : tuple of str
        Text at the head of the file.
    peak, length : str
        Largest acceleration [`unit`] and length [s] as the file's header prints them, or empty.
    notes : tuple of str
        Where the samples contradict the header; `checked` fills it.
    format : str
        Name of the format where it was recognised by content, else empty.
    """

    values: Array
    dt: float | None = None
    times: Array | None = None
    unit: str | None = None
    declared: int | None = None
    component: str = ""
    title: tuple[str, ...] = ()
    peak: str = ""
    length: str = ""
    notes: tuple[str, ...] = ()
    format: str = ""

    @property
    def t(self) -> Array:
        """Times of the samples, shape (n,), [s]."""
        if self.times is not None:
            return self.times
        assert self.dt is not None
        return self.dt * np.arange(len(self.values), dtype=np.float64)

    def checked(self) -> RawRecord:
        """Check count and times, and return the record with `notes`; every reader ends with this.

        Raises
        ------
        RecordError
            R402 for fewer than two samples, a step out of bounds or times that do not increase, R403 for a
            wrong count.
        """
        n = len(self.values)
        if self.declared is not None and n != self.declared:
            raise RecordError(
                "R403",
                f"the header declares {self.declared} values, the file holds {n}",
                "the file may be cut short or have been edited; get it again, or correct its header",
            )
        if n < 2:
            raise RecordError("R402", f"the file holds {n} samples; a record needs two at least")
        if self.dt is not None and not MIN_NUMBER <= self.dt <= MAX_NUMBER:
            raise RecordError(
                "R402", f"the step is {self.dt:g} s, not from {MIN_NUMBER:g} to {MAX_NUMBER:g} s"
            )
        if self.times is not None and (stuck := np.flatnonzero(np.diff(self.times) <= 0)).size:
            k = int(stuck[0])
            before, after = self.times[k : k + 2]
            raise RecordError(
                "R402",
                f"sample {k + 2} is at time {after:g}, not after sample {k + 1} at {before:g}",
                "if the first column is no time, give DT= and COLUMN=",
            )
        return replace(self, notes=tuple(self._contradictions()))

    def _contradictions(self) -> Iterator[str]:
        """Remarks on a peak or a length of the samples that differs from that in the header."""
        if self.peak:
            stated, actual = abs(float(self.peak)), float(np.abs(self.values).max())
            # agencies print samples with five digits and take the peak before that
            if abs(actual - stated) > _last_place(self.peak) + 1e-4 * stated:
                yield f"the header gives a peak of {stated:g} {self.unit}, the samples have {actual:g}"
        if self.length:
            stated, step = abs(float(self.length)), float(self.t[1] - self.t[0])
            actual = float(self.t[-1] - self.t[0]) + step
            # some count samples, some the steps between them, some what an approximate clock gave
            if abs(actual - stated) > _last_place(self.length) + 2 * step:
                yield f"the header gives a length of {stated:g} s, the samples last {actual:g} s"

    def named(self, format: str) -> RawRecord:
        """The same samples, marked as recognised as that format."""
        return replace(self, format=format)


def _last_place(printed: str) -> float:
    """Value of one unit in the last place of a printed number."""
    mantissa, _, exponent = printed.upper().replace("D", "E").partition("E")
    return float(10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2])))


@dataclass(frozen=True, slots=True)
class Format:
    """The two functions of a record format: `impl` of its Spec.

    Attributes
    ----------
    sniff : function (head) -> bool
        Whether a file with this head (whole lines, at most `HEAD` characters) has this format.
    read : function (text, options) -> RawRecord
        Samples out of the file's text; `options` are the values of the deck's card by field name.
    greedy : bool
        Whether the format is recognised by numbers alone, and therefore tried after all others.
    """

    sniff: Callable[[str], bool]
    read: Callable[[str, Mapping[str, Any]], RawRecord]
    greedy: bool = False


def head(text: str) -> str:
    """First whole lines of a text, at most `HEAD` characters."""
    if len(text) <= HEAD:
        return text
    # a line cut in two could make a table look uneven
    return text[: text.rfind("\n", 0, HEAD) + 1] or text[:HEAD]
