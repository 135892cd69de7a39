"""Numbers beyond sense: no result holds one, no check calls it good, no library speaks of it to users."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pound_solve.analyses.recorder import HistoryRecorder
from pound_solve.check import Check, Subject
from pound_solve.cli.main import main
from pound_solve.driver.run import DeckError, Request, prepare
from tiers import each_once
from verification.cases import run_text

MASS = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 K 1 2
PROPS
 K SPRING KX={k} FX={f} RULE=ELASTO_PLASTIC
WEIGHTS
 2 {m}
INITIAL
 2 VX={v}
OUTPUT
 EVERY=0.1
ANALYSIS
 HISTORY 1 METHOD={method}
"""
STEPS = "NEWMARK DT=0.01"
STIFF = ("1e30", "1e30", "1e-30", "1e30")  #: as stiff and as light as a deck may be


def mass(method: str = STEPS, k: str = "200", f: str = "10", m: str = "2", v: str = "1") -> str:
    """A mass on a spring."""
    return MASS.format(method=method, k=k, f=f, m=m, v=v)


@each_once(
    ("bad", [np.nan, np.inf, -np.inf, 1e200]),
    (
        "which, where",
        {
            "displacement": (1, "node 2 ux"),
            "velocity": (2, "node 2 ux"),
            "acceleration": (3, "node 2 ux"),
            "force": (4, "element 1"),
            "work": (5, "work"),
        },
    ),
)
def test_a_sample_that_is_no_number_stops_the_run(
    monkeypatch: pytest.MonkeyPatch, bad: float, which: int, where: str
) -> None:
    """The samples before it stay, whichever number of the fifth is bad."""
    keep: Callable[..., None] = HistoryRecorder.keep

    def spoilt(self: HistoryRecorder, t: Any, u: Any, v: Any, a: Any, laws: Any, works: Any) -> None:
        given = [t, u, v, a, laws.force, works]
        given[which] = np.where((t > 0.35) & (t < 0.45), bad, given[which])
        keep(self, *given[:4], laws._replace(force=given[4]), given[5])

    monkeypatch.setattr(HistoryRecorder, "keep", spoilt)
    r = run_text(mass())
    assert r.status == "stopped" and r.message.startswith("A504 at t = 0.4 s") and where in r.message
    assert r.time == pytest.approx([0.0, 0.1, 0.2, 0.3])


def test_the_check_of_a_run_without_motion_says_so() -> None:
    r = run_text(mass(v="0"))
    energy = Check.of(r.tables["checks"][0])
    assert r.status == "done" and energy.subject is Subject.ENERGY and not energy.looks
    assert energy.value == 0.0 and energy.remark == "nothing moves: there is no energy to compare"


def test_the_check_of_a_run_that_ends_at_its_start_is_not_good() -> None:
    r = run_text(mass("HHT DT=0.01", *STIFF))
    assert r.status == "stopped" and r.message.startswith("A50")
    energy = Check.of(r.tables["checks"][0])
    assert energy.looks and energy.remark == "the run ended before there was anything to compare"


@each_once(
    ("method", ["EXACT", "HHT DT=0.01", STEPS, "CENTRAL DT=0.01", "LAPLACE DT=0.01"]),
    ("deck", [STIFF, ("1e-30", "1e-30", "1e30", "1e30")]),
)
def test_the_ends_of_the_range_are_computed_with_or_refused(method: str, deck: tuple[str, ...]) -> None:
    r = run_text(mass(method, *deck))
    assert r.status == "done" or re.match(r"A50[234] ", r.message), r.message


def test_an_element_beyond_computing_is_told_at_its_place(tmp_path: Path) -> None:
    path = tmp_path / "d.inp"
    path.write_text(
        "NODES\n 1 0 0 FIX=XYR\n 2 0 1E-30\nELEMENTS\n 1 C 1 2\nPROPS\n"
        " C FRAME E=1E30 A=1E30 I=1E-30 AS=1E-30\nANALYSIS\n STATIC\n"
    )
    with pytest.raises(DeckError) as caught:
        prepare(Request(str(path)))
    (told,) = caught.value.diagnostics
    assert told.code == "P330" and told.span is not None and told.span.line == 7


def test_a_warning_of_a_library_is_told_in_words_of_ours(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "d.inp"
    path.write_text(mass())
    sample: Callable[..., None] = HistoryRecorder.sample

    def warns(*given: Any) -> None:
        warnings.warn("overflow encountered in matmul", RuntimeWarning, stacklevel=2)
        sample(*given)

    monkeypatch.setattr(HistoryRecorder, "sample", warns)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        assert main([str(path), "--quiet"]) == 0
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1 and told[0].startswith("pound-solve: warning: arithmetic at the limits")
    assert "recorder.py" not in told[0] and "sample(" not in told[0]
