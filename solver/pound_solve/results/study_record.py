"""Interface of the data that the tables of a study are made from; `assess.study.Study` has it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol


class Trial(Protocol):
    """One method with one setting."""

    @property
    def method(self) -> str:
        """Name of the method."""
        ...

    @property
    def setting(self) -> str:
        """Step or tolerance as a deck gives it."""
        ...

    @property
    def time(self) -> float:
        """Median time [s]."""
        ...

    @property
    def steps(self) -> int:
        """Steps taken."""
        ...

    @property
    def events(self) -> int:
        """Changes of springs and contacts that were located."""
        ...

    @property
    def collisions(self) -> int:
        """Number of collisions."""
        ...

    @property
    def residual(self) -> float:
        """Largest energy residual over the largest energy."""
        ...

    @property
    def stopped(self) -> str:
        """Why it stopped early; empty if it did not."""
        ...

    @property
    def errors(self) -> Mapping[str, float]:
        """Errors of extremes by kind: ``drift``, ``member``, ``contact``."""
        ...

    @property
    def error(self) -> float:
        """Largest error of all kinds."""
        ...


class Reference(Protocol):
    """Reference that the errors of trials are measured against."""

    @property
    def error(self) -> Mapping[str, float]:
        """Estimated errors of the reference itself, by kind."""
        ...

    @property
    def how(self) -> str:
        """Text on how it was found."""
        ...


class Advice(Protocol):
    """The trial of least time for a target."""

    @property
    def target(self) -> float:
        """Error that must be met."""
        ...

    @property
    def trial(self) -> Trial | None:
        """Trial of least time that meets the target; None where none is sure to."""
        ...

    @property
    def sure(self) -> float:
        """Error of the trial with the margin of the advice."""
        ...


class StudyRecord(Protocol):
    """Trials with their errors, the reference, and the advice."""

    @property
    def trials(self) -> Sequence[Trial]:
        """All trials, each method's in one piece."""
        ...

    @property
    def orders(self) -> Sequence[float]:
        """Observed order of each trial against the one before; NaN where there is none."""
        ...

    @property
    def reference(self) -> Reference:
        """Reference that the errors of trials are measured against."""
        ...

    @property
    def advice(self) -> Sequence[Advice]:
        """One for each target."""
        ...

    @property
    def sentence(self) -> str:
        """The advice in one sentence."""
        ...

    @property
    def warning(self) -> str:
        """Why times are not to be trusted; empty if they are."""
        ...
