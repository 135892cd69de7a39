"""Separation rules: closed forms, white noise, and a results file."""

from __future__ import annotations

import math
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_lyapunov

from decks import results_of
from pound_solve.cli.main import main
from pound_solve.report.separation import SeparationError, rows, text
from pound_solve.results import Results
from pound_solve.statistics.separation import correlation, double_difference

WALLS = """
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 2 0 FIX=XYR
 4 2 1 FIX=YR
ELEMENTS
 1 LEFT  1 2
 2 RIGHT 3 4
 9 HIT   {ends}  NAME=floor
PROPS
 LEFT  SPRING KX=100
 RIGHT SPRING KX=400
 HIT   CONTACT GAP=gap ANGLE={angle} K=1000
PARAM gap = 1
WEIGHTS
 2,4 1
DAMPING
 RAYLEIGH XI=0.05 OMEGA=10,20
INITIAL
 2 UX=0.03
 4 UX=-0.02
OUTPUT
 EVERY=0.001
ANALYSIS
 MODAL 2
 HISTORY 0.6 METHOD=EXACT FROM=REST
"""


def white_noise_correlation(t1: float, t2: float, xi1: float, xi2: float) -> float:
    """Correlation of the displacements from the Lyapunov equation of both oscillators."""
    a = np.zeros((4, 4))
    for n, (t, xi) in enumerate(((t1, xi1), (t2, xi2))):
        w = 2 * math.pi / t
        a[2 * n : 2 * n + 2, 2 * n : 2 * n + 2] = [[0, 1], [-w * w, -2 * xi * w]]
    b = np.array([0.0, 1.0, 0.0, 1.0])
    p = solve_continuous_lyapunov(a, -np.outer(b, b))
    return float(p[0, 2] / math.sqrt(p[0, 0] * p[2, 2]))


@pytest.mark.parametrize(
    ("t1", "t2", "xi1", "xi2"),
    [(0.2, 0.3, 0.05, 0.05), (0.3, 0.2, 0.02, 0.10), (0.2, 0.3, 0.02, 0.10), (1.0, 0.9, 0.2, 0.01)],
)
def test_the_correlation_is_that_of_white_noise(t1: float, t2: float, xi1: float, xi2: float) -> None:
    assert correlation(t1, t2, xi1, xi2) == pytest.approx(
        white_noise_correlation(t1, t2, xi1, xi2), rel=1e-9
    )


positive = st.floats(0.05, 5.0)
damped = st.floats(0.005, 0.5)


@given(positive, positive, damped, damped, positive, positive)
def test_properties(t1: float, t2: float, xi1: float, xi2: float, u1: float, u2: float) -> None:
    rho = correlation(t1, t2, xi1, xi2)
    assert 0.0 < rho <= 1.0 + 1e-12
    assert rho == pytest.approx(correlation(t2, t1, xi2, xi1), rel=1e-12)
    assert correlation(t1, t1, xi1, xi1) == pytest.approx(1.0, rel=1e-14)
    assert double_difference(u1, u2, 1.0) == pytest.approx(abs(u1 - u2), abs=1e-7)
    assert abs(u1 - u2) <= double_difference(u1, u2, rho) * (1 + 1e-9) + 1e-7
    assert double_difference(u1, u2, rho) <= math.hypot(u1, u2) * (1 + 1e-12)


def test_far_periods_are_srss_and_undamped_equals_move_alike() -> None:
    assert double_difference(3.0, 4.0, correlation(0.01, 10.0, 0.05, 0.05)) == pytest.approx(5.0, rel=1e-5)
    assert correlation(1.0, 1.0, 0.0, 0.0) == 1.0
    assert correlation(1.0, 2.0, 0.0, 0.0) == 0.0


def ran(folder: Path, ends: str = "2 4", angle: str = "0", **params: float):
    deck = folder / "walls.inp"
    deck.write_text(WALLS.format(ends=ends, angle=angle), encoding="utf-8")
    return results_of(deck, params, out=folder)


def test_a_run_in_which_nothing_meets(tmp_path: Path) -> None:
    with ran(tmp_path) as results:
        (row,) = rows(results)
        history = results.history("node/u")[:, [1, 3], 0]
    _, u1, u2, t1, t2, xi1, xi2, total, srss, ddc, needed, gap, note = row
    assert (u1, u2) == pytest.approx((0.03, 0.02), rel=1e-12)
    assert (t1, t2) == pytest.approx((2 * math.pi / 10, 2 * math.pi / 20), rel=1e-12)
    assert (xi1, xi2) == pytest.approx((5.0, 5.0))
    assert (total, srss) == pytest.approx((0.05, math.hypot(0.03, 0.02)))
    assert ddc == pytest.approx(math.sqrt(srss**2 - 2 * 6e-4 * white_noise_correlation(t1, t2, 0.05, 0.05)))
    assert needed == pytest.approx((history[:, 0] - history[:, 1]).max(), abs=1e-6)
    assert gap == 1.0 and note.startswith("free")


def test_along_an_inclined_direction(tmp_path: Path) -> None:
    with ran(tmp_path, angle="60") as results:
        (row,) = rows(results)
    assert row[1:3] == pytest.approx((0.015, 0.01), rel=1e-12)


def test_a_node_that_is_not_stored(tmp_path: Path) -> None:
    deck, words = tmp_path / "walls.inp", WALLS.replace(" EVERY=0.001", " EVERY=0.001 NODES=2")
    deck.write_text(words.format(ends="2 4", angle="0"), encoding="utf-8")
    with results_of(deck, out=tmp_path) as results:
        (row,) = rows(results)
    assert row[1] == pytest.approx(0.03) and math.isnan(row[2]) and math.isnan(row[7])


def test_given_periods_and_a_wall(tmp_path: Path) -> None:
    with ran(tmp_path) as results:
        (row,) = rows(results, (0.4, 0.4), (3.0, 3.0))
        assert row[3:7] == (0.4, 0.4, 3.0, 3.0) and row[9] == pytest.approx(0.01)
    with ran(tmp_path, ends="2") as results:
        (row,) = rows(results)
        assert row[2] == 0.0 and row[7:10] == pytest.approx((0.03, 0.03, 0.03))


def test_without_mode_shapes_there_is_no_ddc(tmp_path: Path) -> None:
    deck, words = tmp_path / "walls.inp", WALLS.replace(" MODAL 2", " MODAL 2 SHAPES=NO")
    deck.write_text(words.format(ends="2 4", angle="0"), encoding="utf-8")
    with results_of(deck, out=tmp_path) as results:
        (row,) = rows(results)
        assert row[8] == pytest.approx(math.hypot(0.03, 0.02))  # SRSS needs no periods
        assert math.isnan(row[9]) and "--periods" in row[12]
        assert "SHAPES=YES" in " ".join(text(results).split())
        (row,) = rows(results, (0.4, 0.4))  # the damping is still not known
        assert math.isnan(row[9])
        (row,) = rows(results, (0.4, 0.4), (3.0, 3.0))
        assert row[9] == pytest.approx(0.01) and row[12] == "free: nothing met"


def test_a_run_in_which_they_meet_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with ran(tmp_path, gap=0.04) as results:
        (row,) = rows(results)
        assert math.isnan(row[10]) and row[11] == 0.04 and row[12].startswith("pounding")
        assert "DDC" in text(results)
        path = results.path
    assert main(["separation", str(path), "--periods", "0.2,0.3", "--damping", "5,5"]) == 0
    out = capsys.readouterr().out
    assert "pounding" in out and "something met" in " ".join(out.split())


@pytest.mark.parametrize("word", ["0.2", "a,b", "0.2,-1", "1,2,3", "nan,1"])
def test_options_are_checked(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["separation", "x.h5", "--periods", word])
    err = capsys.readouterr().err
    assert "two numbers" in err or "above 0" in err


def test_a_file_without_contacts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck = tmp_path / "walls.inp"
    lines = [line for line in WALLS.splitlines() if "HIT" not in line and "gap" not in line]
    deck.write_text("\n".join(lines), encoding="utf-8")
    with results_of(deck, out=tmp_path) as results, pytest.raises(SeparationError, match="contacts"):
        rows(results)
    assert main(["separation", str(tmp_path / "walls.h5")]) == 3
    assert "contacts" in capsys.readouterr().err
    assert main(["separation", str(tmp_path / "none.h5")]) == 3


def test_a_run_that_ended_early_says_so(tmp_path: Path) -> None:
    deck = tmp_path / "walls.inp"
    deck.write_text(WALLS.format(ends="2 4", angle="0"), encoding="utf-8")
    results_of(deck, out=tmp_path).close()
    with Results.open(tmp_path / "walls.h5") as results:
        assert "early" not in rows(results)[0][-1]
    with h5py.File(tmp_path / "walls.h5", "a") as file:
        file.attrs["status"] = "stopped"
        file.attrs["format_version"] = [1, 1]
    with Results.open(tmp_path / "walls.h5") as results:
        assert rows(results)[0][-1].endswith(f"the run ended early, at {results.time[-1]:g}")


@pytest.mark.parametrize(
    ("history", "told"),
    [("HISTORY 0.6 METHOD=LAPLACE DT=1", "holds no history: A502 at t = 0"), ("", "holds no history\n")],
)
def test_a_file_without_history(
    history: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deck = tmp_path / "walls.inp"
    words = WALLS.replace("HISTORY 0.6 METHOD=EXACT FROM=REST", history)
    deck.write_text(words.format(ends="2 4", angle="0"), encoding="utf-8")
    results_of(deck, out=tmp_path).close()
    assert main(["separation", str(tmp_path / "walls.h5")]) == 3
    assert told in capsys.readouterr().err
