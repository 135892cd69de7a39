"""EXACT where a mode is far faster than the motion: it foresees how many windows the motion takes."""

import pytest

from pound_solve.cli.main import main
from pound_solve.integrate.closed_form import exact

DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 COL 1 2
PROPS
 COL SPRING KX={k}
WEIGHTS
 2 100
INITIAL
 2 VX=0.1
ANALYSIS
 HISTORY {seconds} METHOD=EXACT
OUTPUT
 EVERY=0.01
"""


@pytest.fixture
def status(tmp_path):
    """Runs the deck with a stiffness and a length of the motion."""

    def run(k, seconds=0.02):
        (tmp_path / "deck.inp").write_text(DECK.format(k=k, seconds=seconds))
        return main(["run", str(tmp_path / "deck.inp"), "--quiet"])

    return run


@pytest.mark.full
def test_that_an_interval_takes_too_many_windows_is_foreseen(status, monkeypatch, capsys):
    windows = []
    monkeypatch.setattr(exact.Exact, "_charge_window", lambda *_: windows.append(1))
    assert status(1e20) == 1
    assert "too fast to be followed" in capsys.readouterr().err
    assert len(windows) == exact.WINDOWS_BEFORE_FORECAST


def test_that_a_run_takes_too_many_windows_is_foreseen(status, monkeypatch, capsys):
    """Some twenty windows an interval, which is followed, but not in four thousand intervals."""
    windows = []
    monkeypatch.setattr(exact.Exact, "_charge_window", lambda *_: windows.append(1))
    assert status(6.5e14, 40.0) == 1
    assert "too fast to be followed" in capsys.readouterr().err
    assert len(windows) == exact.WINDOWS_BEFORE_FORECAST


def test_an_interval_of_windows_that_suffice_is_followed(status, monkeypatch):
    windows = []
    monkeypatch.setattr(exact.Exact, "_charge_window", lambda *_: windows.append(1))
    assert status(1e12) == 0
    assert len(windows) > 2
