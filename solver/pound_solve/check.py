"""A check: a number that a run computes about itself, with its allowed range and a verdict.

Methods, analyses and the driver make checks; the report, pictures and sweeps show the same objects.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Final, Self

#: columns of the table `checks`
COLUMNS: Final = ("subject", "check", "value", "unit", "bound", "allowed", "verdict", "remark")


class Subject(StrEnum):
    """Subject of a check."""

    EQUILIBRIUM = "equilibrium"  #: equilibrium of forces at one instant
    ENERGY = "energy"  #: energy balance over the history
    ERROR = "error"  #: estimated error of the time integration
    STEPS = "steps"  #: whether the steps resolve the motion
    ROUNDING = "rounding"  #: loss of digits by rounding
    MAGNIFICATION = "magnification"  #: magnification of rounding errors by the motion
    PEAKS = "peaks"  #: a peak compared with another source
    UNIQUENESS = "uniqueness"  #: uniqueness of the solution
    STORAGE = "storage"  #: data that exceeded its storage
    RESPONSE = "response"  #: implausible values, or values beyond the validity of the model


class Verdict(StrEnum):
    """Verdict on a value: whether it is good enough."""

    GOOD = "good"
    LOOK = "look"  #: the user should examine it


class Bound(StrEnum):
    """Side of `Check.allowed` on which a value is good."""

    MOST = "at most"
    LEAST = "at least"
    NONE = ""  #: both sides: for information, or always to be examined


@dataclass(frozen=True)
class Check:
    """One check.

    Attributes
    ----------
    subject : Subject
    name : str
        Checked quantity, with its place.
    value : float
        Computed value.
    bound, allowed : Bound, float
        Allowed range; NaN without a bound.
    verdict : Verdict
    remark : str
        Remedy or explanation; empty if a good value needs none.
    unit : str
        Unit of `value` and `allowed`, in the deck's units; empty for a pure number.
    """

    subject: Subject
    name: str
    value: float
    bound: Bound = Bound.NONE
    allowed: float = float("nan")
    verdict: Verdict = Verdict.GOOD
    remark: str = ""
    unit: str = ""

    @property
    def looks(self) -> bool:
        """Whether the user should examine the value."""
        return self.verdict is Verdict.LOOK

    @property
    def value_text(self) -> str:
        """The value with its unit."""
        return f"{self.value:.3g} {self.unit}".rstrip()

    @property
    def severity(self) -> tuple[bool, float]:
        """Sort key, larger for the worse of two checks of one name."""
        value = -self.value if self.bound is Bound.LEAST else self.value
        return self.looks, math.inf if math.isnan(value) else value

    def __str__(self) -> str:
        allowed = f", {self.bound} {self.allowed:.3g} {self.unit}".rstrip() if self.bound else ""
        return f"{self.name}: {self.value_text}{allowed}" + (f"; {self.remark}" if self.remark else "")

    def row(self) -> tuple[Any, ...]:
        """Row of the table `checks`, in the order of `COLUMNS`."""
        fields = (self.subject, self.name, self.value, self.unit, self.bound, self.allowed)
        return tuple(str(x) if isinstance(x, str) else x for x in (*fields, self.verdict, self.remark))

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Self:
        """Make a check from a row of the table `checks`, keyed by column."""
        subject, name, value, unit, bound, allowed, verdict, remark = (row[column] for column in COLUMNS)
        return cls(
            Subject(subject),
            name,
            float(value),
            Bound(bound),
            float(allowed),
            Verdict(verdict),
            remark,
            unit,
        )


def at_most(
    subject: Subject, name: str, value: float, allowed: float, remark: str, unit: str = ""
) -> Check:
    """Make a check that a value is at most `allowed`; keep `remark` only if it is larger or NaN."""
    check = Check(subject, name, float(value), Bound.MOST, float(allowed), remark=remark, unit=unit)
    return _judged(check, check.value <= check.allowed)


def at_least(
    subject: Subject, name: str, value: float, allowed: float, remark: str, unit: str = ""
) -> Check:
    """Make a check that a value is at least `allowed`; keep `remark` only if it is smaller or NaN."""
    check = Check(subject, name, float(value), Bound.LEAST, float(allowed), remark=remark, unit=unit)
    return _judged(check, check.value >= check.allowed)


def beyond(subject: Subject, name: str, value: float, allowed: float, remark: str, unit: str = "") -> Check:
    """Make a check that the user should always examine: its bound is reached, or it proves nothing."""
    check = Check(subject, name, float(value), Bound.MOST, float(allowed), remark=remark, unit=unit)
    return _judged(check, False)


def _judged(check: Check, good: bool) -> Check:
    return replace(check, remark="") if good else replace(check, verdict=Verdict.LOOK)


def worst(checks: Iterable[Check]) -> list[Check]:
    """Worst check of each name, such as among the parts of a history."""
    by_name = dict[tuple[Subject, str], Check]()
    for check in checks:
        kept = by_name.setdefault((check.subject, check.name), check)
        if check.severity > kept.severity:
            by_name[check.subject, check.name] = check
    return list(by_name.values())


def looked(checks: Iterable[Check]) -> list[Check]:
    """Checks that the user should examine."""
    return [check for check in checks if check.looks]
