"""Class of pictures; every module of `pictures` declares an object of it as `SPEC`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.formats import IMAGE_FORMATS
from pound_solve.results import Results
from pound_solve.user_error import UserError


class Nothing(Exception):
    """Raised where there is nothing to draw; the message states what is missing."""


class ChoiceError(UserError):
    """Raised where the file has no such member, instant or time; the message states what there is."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Selection of what is drawn of a run; a picture uses the attributes that its `Picture.options` name.

    Parameters
    ----------
    member : tuple of str
        Numbers, names or labels of elements; empty for all, or those that matter most.
    time : float, optional
        An instant [T].
    at_peak : str, optional
        The instant of the largest force of this contact, in place of `time` (see `moments`).
    between : tuple of float, optional
        First and last time [T].
    style : Path, optional
        Style sheet of matplotlib, laid over that of the program.
    """

    member: tuple[str, ...] = ()
    time: float | None = None
    at_peak: str | None = None
    between: tuple[float, float] | None = None
    style: Path | None = None

    @property
    def stated(self) -> set[str]:
        """Names of the options that are stated."""
        names = ("member", "time", "at_peak", "between")
        return {name for name in names if getattr(self, name) not in (None, ())}

    @property
    def at_instant(self) -> bool:
        """Whether an instant is chosen."""
        return self.time is not None or self.at_peak is not None

    def instant(self, results: Results, t: Array) -> int:
        """Index of the instant out of `t` that is nearest to `time`.

        Raises
        ------
        ChoiceError
            The history does not reach so far.
        """
        unit = results.units.time
        if self.time is None or not len(t) or not t[0] <= self.time <= t[-1]:
            reach = f"reaches from {t[0]:g} to {t[-1]:g} {unit}" if len(t) else "is empty"
            raise ChoiceError(f"the history has no time {self.time:g} {unit}: it {reach}")
        return int(np.argmin(np.abs(t - self.time)))

    def span(self, results: Results, times: Array | None = None) -> slice:
        """Slice of the instants within `between`, or of all; `times` ascend and default to the stored ones.

        Raises
        ------
        ChoiceError
            There are fewer than two.
        """
        if self.between is None:
            return slice(None)
        t, unit = results.time if times is None else times, results.units.time
        low, high = np.searchsorted(t, self.between[0]), np.searchsorted(t, self.between[1], "right")
        if high - low < 2:
            reach = f"from {t[0]:g} to {t[-1]:g} {unit}" if len(t) else "nowhere"
            raise ChoiceError(
                f"the history has fewer than two instants from {self.between[0]:g} to "
                f"{self.between[1]:g} {unit}: it reaches {reach}"
            )
        return slice(int(low), int(high))


ALL: Final = Choice()  #: nothing is chosen


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """One picture of a results file.

    Parameters
    ----------
    name : str
        That of its module.
    place : int
        Pictures are drawn and listed in the order of their places.
    shows : str
        What it shows, for the help and the manual.
    needs : tuple of str
        Tables and histories that the file must have, and have rows of.
    draw : callable
        Makes the figure, of a picture that moves the first frame.  It raises `Nothing` where the rows are
        of no use to it.
    options : tuple of str
        Attributes of `Choice` that it uses.
    endings : tuple of str
        Formats of its file.
    write : callable, optional
        Writes the file of a picture that moves.
    overlay : callable, optional
        Makes the figure of several runs drawn over each other.  A run may lack some of what is drawn.
    """

    name: str
    place: int
    shows: str
    needs: tuple[str, ...]
    draw: Callable[[Results, Choice], Any]
    options: tuple[str, ...] = ()
    endings: tuple[str, ...] = IMAGE_FORMATS
    write: Callable[[Results, Choice, Path], None] | None = None
    overlay: Callable[[Sequence[Results], Choice], Any] | None = None
