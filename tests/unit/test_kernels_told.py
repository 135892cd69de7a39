"""A run that waits for a compiler, or for want of one, says so once on the error stream."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from pound_solve.cli.main import main
from pound_solve.integrate.kernels import engine
from pound_solve.laws import functions
from pound_solve.numerics import jit, kernel_cache, providers
from pound_solve.numerics.kernel_cache import NOT_KEPT, VARIABLE, CacheFolder
from pound_solve.numerics.providers import INTERPRETED, Interpreter
from pound_solve.results import Results

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


@pytest.mark.full
@pytest.mark.parametrize("told", ["", INTERPRETED])
def test_what_a_run_waits_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], told: str
) -> None:
    for module in (engine, functions):
        monkeypatch.setattr(module, "provider", lambda: Interpreter(told))
    deck = tmp_path / "deck.inp"
    deck.write_text(DECK)
    assert main([str(deck)]) == 0
    assert capsys.readouterr().err == (f"pound-solve: {told}\n" if told else "")
    assert main([str(deck), "--quiet"]) == 0
    assert capsys.readouterr().err == ""


class Uncompiled(NamedTuple):
    """A function that numba would compile, left as it is."""

    function: Callable[..., Any]

    def compile(self, types: tuple[type, ...]) -> Callable[..., Any]:
        return self.function


def test_error_stream_and_report_say_that_nothing_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(kernel_cache, "cache_folder", lambda: CacheFolder(None, NOT_KEPT))
    monkeypatch.setattr(
        jit, "compiled", lambda kernel, *signature: kernel if signature else Uncompiled(kernel)
    )
    monkeypatch.setattr(jit, "kinds_of", lambda arguments: tuple(type(value) for value in arguments))
    numba = jit.Numba()
    for module in (engine, functions, providers):
        monkeypatch.setattr(module, "provider", lambda: numba)
    deck = tmp_path / "deck.inp"
    deck.write_text(DECK)
    assert main([str(deck)]) == 0
    assert capsys.readouterr().err == f"pound-solve: {NOT_KEPT}\n"
    assert VARIABLE in NOT_KEPT
    with Results.open(deck.with_suffix(".h5")) as results:
        assert dict(results.table("run_figures").tolist())["kernels"] == f"compiled by numba; {NOT_KEPT}"
    assert VARIABLE in deck.with_suffix(".rpt").read_text(encoding="utf-8")
