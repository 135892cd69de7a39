"""Motions of a deck written as record files: what is read again is what the deck has."""

import numpy as np
import pytest

from pound_solve.assess.motion_files import MotionError, of_deck
from pound_solve.cli.main import main
from pound_solve.driver.request import Request
from pound_solve.loading.records import peer

DECK = """UNITS kN mm s
GRAVITY 9806.65
PARAM seed=3
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 S 1 2
PROPS
 S SPRING KX=1
EQUAKE
{motions}
ANALYSIS
 STATIC
"""


def deck(folder, motions):
    path = folder / "suite.inp"
    path.write_text(DECK.format(motions=motions))
    return Request(str(path))


def test_the_file_holds_the_motion_in_shares_of_gravity(tmp_path):
    (file,) = of_deck(deck(tmp_path, " SYNTHETIC PGA=2000 SEED=seed DT=0.005 DURATION=4"))
    raw = peer.read(file.text, {})
    assert (file.name, file.warning, raw.dt, raw.unit) == ("01_synthetic_seed_3.at2", "", 0.005, "G")
    assert len(raw.values) == 801
    assert np.abs(raw.values).max() * 9806.65 == pytest.approx(2000.0, rel=1e-9)


def test_a_motion_without_a_step_needs_one(tmp_path):
    request = deck(tmp_path, " TABLE POINTS=0,0,0.1,100,0.35,0")
    with pytest.raises(MotionError, match="--dt"):
        list(of_deck(request))
    (file,) = of_deck(request, 0.05)
    assert peer.read(file.text, {}).values * 9806.65 == pytest.approx([0, 50, 100, 80, 60, 40, 20, 0])
    assert "straight lines" in file.warning


def test_rotations_are_left_out_and_nothing_is_told(tmp_path):
    with pytest.raises(MotionError, match="no motion along X or Y"):
        list(of_deck(deck(tmp_path, " SINE AMPLITUDE=1 PERIOD=1 DURATION=2 DIRECTION=R")))


def test_the_verb_replaces_no_file(tmp_path, capsys):
    request = deck(tmp_path, " SYNTHETIC PGA=2000 SEED=1\n SYNTHETIC PGA=2000 SEED=2")
    words = ["motions", request.deck, "-o", str(tmp_path / "suite")]
    assert main(words) == 0
    names = capsys.readouterr().out.split()
    assert [name.rpartition("/")[2] for name in names] == [
        "01_synthetic_seed_1.at2",
        "02_synthetic_seed_2.at2",
    ]
    assert main(words) == 3 and "is there" in capsys.readouterr().err
    assert main([*words, "--dt", "-1"]) == 2
    assert main(["motions", str(tmp_path / "none.inp")]) == 3
