"""A run that waits for a compiler, or for want of one, says so once on the error stream."""

from __future__ import annotations

from pathlib import Path

import pytest

from pound_solve.cli.main import main
from pound_solve.integrate.kernels import engine
from pound_solve.numerics import jit

DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
ELEMENTS
 1 K 1 2
PROPS
 K SPRING KX=400
WEIGHTS
 2 98.1
INITIAL
 2 VX=1
ANALYSIS
 HISTORY 0.05 METHOD=NEWMARK DT=0.01
"""


@pytest.fixture
def interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("POUND_COMPILE", "0")
    for cached in (jit.numba, jit.compiled):
        cached.cache_clear()


@pytest.mark.parametrize(
    ("cold", "missing", "told"),
    [
        (False, False, ""),
        (True, False, f"pound-solve: {engine.COMPILING}\n"),
        (False, True, f"pound-solve: {engine.INTERPRETED}\n"),
    ],
)
@pytest.mark.usefixtures("interpreted")
def test_what_a_run_waits_for(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    cold: bool,
    missing: bool,
    told: str,
) -> None:
    monkeypatch.setattr(jit, "cold", lambda kernel: cold)
    monkeypatch.setattr(jit, "missing", lambda: missing)
    deck = tmp_path / "deck.inp"
    deck.write_text(DECK)
    assert main([str(deck)]) == 0
    assert capsys.readouterr().err == told
    assert main([str(deck), "--quiet"]) == 0
    assert capsys.readouterr().err == ""
