"""Checks: their verdicts, their words, and the rows that they are stored as."""

import math

import numpy as np
import pytest

from output import sample
from pound_solve.check import COLUMNS, Bound, Check, Subject, at_least, at_most, beyond, looked, worst
from pound_solve.report.text import render
from pound_solve.results import Results


@pytest.mark.parametrize(
    ("check", "good"),
    [
        (at_most(Subject.ENERGY, "a", 1.0, 1.0, "why"), True),
        (at_most(Subject.ENERGY, "a", 1.0 + 1e-15, 1.0, "why"), False),
        (at_most(Subject.ENERGY, "a", math.nan, 1.0, "why"), False),
        (at_least(Subject.STEPS, "a", 1.0, 1.0, "why"), True),
        (at_least(Subject.STEPS, "a", 1.0 - 1e-15, 1.0, "why"), False),
        (at_least(Subject.STEPS, "a", math.nan, 1.0, "why"), False),
        (beyond(Subject.RESPONSE, "a", 1.0, 1.0, "why"), False),
    ],
)
def test_verdicts(check: Check, good: bool) -> None:
    """A value on its bound is good, one that is no number is not; what to do is told of the latter."""
    assert check.looks is not good and check.remark == ("" if good else "why")
    assert looked([check]) == [check] * (not good)


def test_words() -> None:
    assert str(at_most(Subject.RESPONSE, "drift", 12.345, 10, "units?", "%")) == (
        "drift: 12.3 %, at most 10 %; units?"
    )
    assert str(at_least(Subject.STEPS, "steps", 30, 10, "why")) == "steps: 30, at least 10"
    assert str(Check(Subject.ROUNDING, "defective", 2.0)) == "defective: 2"


def test_a_row_gives_the_check_back() -> None:
    for check in (
        beyond(Subject.RESPONSE, "drift", 0.1, 0.02, "why", "m"),
        at_most(Subject.PEAKS, "a", 0, 1, ""),
    ):
        assert Check.of(dict(zip(COLUMNS, check.row()))) == check
    free = Check(Subject.ROUNDING, "defective", 2.0)
    again = Check.of(dict(zip(COLUMNS, free.row())))
    assert again.bound is Bound.NONE and math.isnan(again.allowed) and again.subject is Subject.ROUNDING


def test_of_the_parts_of_a_history_the_worst_counts() -> None:
    """By the verdict, then by the value on its side of the bound, NaN first."""
    few, many = (at_least(Subject.STEPS, "steps", n, 10, "") for n in (20, 30))
    low, high, none = (at_most(Subject.ENERGY, "energy", x, 1, "") for x in (0.1, 0.2, math.nan))
    ended = beyond(Subject.ENERGY, "energy", 0.0, 1, "ended")
    assert worst([many, low, few, high]) == [few, high]
    assert worst([ended, high]) == [ended] and worst([high, none, ended]) == [none]


def test_a_file_of_sentences_is_printed(tmp_path) -> None:
    """Format 1 has texts as values and no subjects: they are shown, and not taken for checks."""
    import h5py

    path = sample.write(tmp_path / "m.h5")
    with h5py.File(path, "r+") as file:
        old = file["tables/checks"]
        attrs = {name: value for name, value in old.attrs.items() if name != "digest"}
        file.attrs["format_version"] = [1, 1]
        text = h5py.string_dtype()
        kinds = [(name, text) for name in ("check", "value", "verdict")]
        del file["tables/checks"]
        file["tables/checks"] = np.array([("energy residual", "1.9E-13", "good")], kinds)
        file["tables/checks"].attrs.update(attrs)
    with Results.open(path) as results:
        assert results.checks == []
        assert "energy residual  1.9E-13  good" in render(results)
