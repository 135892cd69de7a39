"""Decks that once broke the program, or that it answered without a word: how each ends now.

Each is the smallest that shows the fault, run as a user runs it, by the command line.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pound_solve.cli.main import main
from pound_solve.results import Results

FRAMES = """UNITS kN m s
{head}
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 0.5 0 FIX=XYR
 4 0.5 3
ELEMENTS
 1 LEFT 1 2
 2 RIGHT 3 4
 3 HIT 2 4
PROPS
 LEFT FRAME E=3E7 A=0.1 I=0.001 RULE=BILINEAR R=0.02 MI=60 MJ=60 KH=1E5
 RIGHT FRAME E=3E7 A=0.1 I=0.002 RULE=BILINEAR R=0.02 MI=60 MJ=60 KH=1E5
 HIT CONTACT GAP=0.01 ANGLE=0 {law}
WEIGHTS
 2 300
 4 500
EQUAKE
 SINE AMPLITUDE=4 PERIOD=0.4
ANALYSIS
 {static}HISTORY 0.4 TOL=1E-2
"""
STRUCK = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 K 1 2
PROPS
 K SPRING KX=100 FX=5 {rule}
WEIGHTS
 2 1
INITIAL
 2 VX={v}
ANALYSIS
 HISTORY 1 {method}
"""
RANGE = """NODES
 1 0 0 FIX=XYR
 5 TO 900000 0 1
ANALYSIS
 STATIC
"""
BARS = """NODES
 1 TO 3 0 TO 1 0 FIX=YR
 4 TO 6 1 TO {far} 0 FIX=YR
ELEMENTS
 1 BAR 1 2
 2 BAR 2 3
 3 BAR 4 5
 4 BAR 5 6
 5 HIT 3 4
PROPS
 BAR FRAME E={e} A=1
 HIT CONTACT GAP=0 ANGLE=0 K={k} DIAPHRAGMS=1,3
WEIGHTS
 1 TO 6 1
ANALYSIS
 HISTORY 1
"""


def ended(folder: Path, text: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Exit status and words of a run."""
    deck = folder / "deck.inp"
    deck.write_text(text)
    status = main(["run", str(deck), "--quiet"])
    return status, capsys.readouterr().err


@pytest.mark.parametrize(
    ("head", "law", "static"),
    [
        ("", "LAW=HERTZ K=1E6", ""),
        ("GEOMETRY PDELTA_VARYING", "LAW=KELVIN_VOIGT K=2E5 E=0.6", "STATIC GRAVITY=YES\n "),
    ],
    ids=["curved contact", "varying P-Delta"],
)
def test_hinged_frames_without_a_drift_by_default(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], head: str, law: str, static: str
) -> None:
    """AUTO compared x, y and the rotation; hinges have degrees of freedom beside them."""
    status, told = ended(tmp_path, FRAMES.format(head=head, law=law, static=static), capsys)
    assert status == 0, told
    with Results.open(tmp_path / "deck.h5") as results:
        assert len(results.table("collisions"))
        assert all(np.isfinite(results.history(name)).all() for name in results.histories)


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        (
            STRUCK.format(rule="RULE=ELASTO_PLASTIC", v="1E308", method="METHOD=HHT DT=0.005"),
            "P217",
            "13:7",
        ),
        (
            STRUCK.format(rule="RULE=BILINEAR_SLACK SLACK=0.05", v="1E308", method="METHOD=TAYLOR"),
            "P217",
            "13:7",
        ),
        (BARS.format(far="1E150", e="1", k="1"), "P217", "3:"),
        (BARS.format(far="2", e="1", k="1E306"), "P217", "12:"),
        (BARS.format(far="2", e="1E-308", k="1"), "P217", "11:"),
        (RANGE, "P221", "3:2"),
    ],
    ids=["struck beyond numbers", "slack", "far node", "stiff contact", "soft bars", "endless range"],
)
def test_numbers_beyond_sense_are_told_at_their_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, code: str, place: str
) -> None:
    """They ended as NaN with exit status 0, or as a fault of the program, or after a long time."""
    status, told = ended(tmp_path, text, capsys)
    assert status == 2 and f"deck.inp:{place}" in told and f"error {code}" in told
    assert not (tmp_path / "deck.h5").exists()


def test_a_mode_that_nothing_holds_has_no_period_and_the_run_its_results(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = STRUCK.format(rule="", v="1", method="METHOD=EXACT").replace("1 0 0 FIX=XYR", "1 0 0 FIX=YR")
    status, told = ended(
        tmp_path,
        text.replace(" 2 1\nINITIAL", " 1 1\n 2 1\nINITIAL")
        .replace(" FX=5", "")
        .replace(" HISTORY", " MODAL 2\n HISTORY"),
        capsys,
    )
    assert status == 0, told
    with Results.open(tmp_path / "deck.h5") as results:
        periods = np.sort(results.table("modes")["period"])
        assert periods[0] == pytest.approx(2 * np.pi / np.sqrt(200.0)) and periods[1] > 1e3
        assert all(np.isfinite(results.history(name)).all() for name in results.histories)


def test_storeys_that_fall_by_laplace_end_in_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It transformed what grows on a line left of its poles, and found events without an end."""
    text = STRUCK.format(rule="RULE=BILINEAR R=-0.5", v="9", method="METHOD=LAPLACE DT=0.01")
    status, told = ended(tmp_path, text.replace("HISTORY 1", "HISTORY 20"), capsys)
    assert status == 1 and "A504" in told
