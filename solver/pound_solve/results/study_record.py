"""What the tables of a study are made from; `assess.study.Study` is one."""

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
        """Its step or tolerance as a deck has it."""
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
    """What errors are measured against."""

    @property
    def error(self) -> Mapping[str, float]:
        """Its own errors by kind."""
        ...

    @property
    def how(self) -> str:
        """How it was found."""
        ...


class Advice(Protocol):
    """The trial of least time for a target."""

    @property
    def target(self) -> float:
        """Error that must be met."""
        ...

    @property
    def trial(self) -> Trial | None:
        """None where no trial is sure to meet it."""
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
        """What errors are measured against."""
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
