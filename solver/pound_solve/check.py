"""A check: a number that a run computes about itself, with its allowed range and a verdict.

Methods, analyses and the driver make checks; the report, pictures and sweeps print the same objects.
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
    """Subject that a check is about."""

    EQUILIBRIUM = "equilibrium"  #: of forces at one instant
    ENERGY = "energy"  #: its balance over the history
    ERROR = "error"  #: an estimate of the error in time
    STEPS = "steps"  #: whether the steps follow the motion
    ROUNDING = "rounding"  #: how far digits are lost
    MAGNIFICATION = "magnification"  #: of rounding, by the motion
    PEAKS = "peaks"  #: one peak against another source of it
    UNIQUENESS = "uniqueness"  #: of the solution
    STORAGE = "storage"  #: what found no room
    RESPONSE = "response"  #: values that no engineer would believe, or that end what the model means


class Verdict(StrEnum):
    """Whether a value is good enough."""

    GOOD = "good"
    LOOK = "look"  #: the user should look at it


class Bound(StrEnum):
    """Side of `Check.allowed` on which a value is good."""

    MOST = "at most"
    LEAST = "at least"
    NONE = ""  #: on both: a value to know, or to look at in any case


@dataclass(frozen=True)
class Check:
    """One check.

    Attributes
    ----------
    subject : Subject
    name : str
        What was checked, with the place.
    value : float
        What was found.
    bound, allowed : Bound, float
        What it may be; NaN without a bound.
    verdict : Verdict
    remark : str
        What to do about it, or how to read it; empty where a good value needs none.
    unit : str
        Of `value` and `allowed`, in the deck's units; empty for a pure number.
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
        """Whether the user should look at the value."""
        return self.verdict is Verdict.LOOK

    @property
    def told(self) -> str:
        """The value with its unit."""
        return f"{self.value:.3g} {self.unit}".rstrip()

    @property
    def severity(self) -> tuple[bool, float]:
        """Sort key that is larger for the worse of two checks of one name."""
        value = -self.value if self.bound is Bound.LEAST else self.value
        return self.looks, math.inf if math.isnan(value) else value

    def __str__(self) -> str:
        allowed = f", {self.bound} {self.allowed:.3g} {self.unit}".rstrip() if self.bound else ""
        return f"{self.name}: {self.told}{allowed}" + (f"; {self.remark}" if self.remark else "")

    def row(self) -> tuple[Any, ...]:
        """Row of the table `checks`, in the order of `COLUMNS`."""
        fields = (self.subject, self.name, self.value, self.unit, self.bound, self.allowed)
        return tuple(str(x) if isinstance(x, str) else x for x in (*fields, self.verdict, self.remark))

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Self:
        """Make a check from a row of the table `checks`, given by its columns."""
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
    """Make a check that a value is at most `allowed`; `remark` is kept only where it is not, or is NaN."""
    check = Check(subject, name, float(value), Bound.MOST, float(allowed), remark=remark, unit=unit)
    return _judged(check, check.value <= check.allowed)


def at_least(
    subject: Subject, name: str, value: float, allowed: float, remark: str, unit: str = ""
) -> Check:
    """Make a check that a value is at least `allowed`; `remark` is kept only where it is not, or is NaN."""
    check = Check(subject, name, float(value), Bound.LEAST, float(allowed), remark=remark, unit=unit)
    return _judged(check, check.value >= check.allowed)


def beyond(subject: Subject, name: str, value: float, allowed: float, remark: str, unit: str = "") -> Check:
    """Make a check to look at whatever its value: it has reached its bound, or it proves nothing."""
    check = Check(subject, name, float(value), Bound.MOST, float(allowed), remark=remark, unit=unit)
    return _judged(check, False)


def _judged(check: Check, good: bool) -> Check:
    return replace(check, remark="") if good else replace(check, verdict=Verdict.LOOK)


def worst(checks: Iterable[Check]) -> list[Check]:
    """Worst of all checks of one name, such as those of the parts of a history."""
    by_name = dict[tuple[Subject, str], Check]()
    for check in checks:
        kept = by_name.setdefault((check.subject, check.name), check)
        if check.severity > kept.severity:
            by_name[check.subject, check.name] = check
    return list(by_name.values())


def looked(checks: Iterable[Check]) -> list[Check]:
    """Checks that the user should look at."""
    return [check for check in checks if check.looks]
