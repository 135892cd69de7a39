"""Records of old decks in files of their own: in the format that the deck states, or in any other."""

from __future__ import annotations

import numpy as np
import pytest

from agency_files import FILES, SAMPLES, cosmos, esm
from imports.ruaumoko_decks import STICK
from pound_solve import run
from pound_solve.cli.main import main
from pound_solve.driver.prepare import prepare
from pound_solve.driver.request import Request

GRAVITY = 9.81
AT2 = FILES["PEER"]
TWO = "t, a\n" + "".join(f"{0.02 * k:.2f}, {0.1 * (-1) ** k}\n" for k in range(9))
THREE = "t, north, east\n" + "".join(f"{0.02 * k:.2f}, {0.1 * (-1) ** k}, 0.5\n" for k in range(9))
COUNTED = "START\n" + "".join(f"{k} {0.02 * k:.2f} {0.1 * (-1) ** k}\n" for k in range(9))
SERIES = " 0.1 -0.2 0.3 -0.1 0.2\n 0.2  0.1 0.1 -0.4 0.1\n 0.1 -0.2 0.3\n"
PAIRS = "0.00 0.1 0.02 -0.2 0.04 0.3\n0.06 0.1\n"
SIX = "6 1 0.02 9.81 -1 0 0 1"
COUNTS = "3 1 0.01 1 -1 0 0 1"


@pytest.fixture
def imported(tmp_path, capsys):
    """Function that imports a deck with these lines of EQUAKE and these texts of records; it returns the
    exit code, the path of the new deck and the messages.
    """

    def call(line, *texts, deck=STICK):
        old, new = tmp_path / "old.dat", tmp_path / "new.inp"
        old.write_text(deck.partition("EQUAKE")[0] + f"EQUAKE\n{line}\n")
        words = []
        for k, text in enumerate(texts, 1):
            file = tmp_path / f"quake{k}.txt"
            file.write_bytes(text if isinstance(text, bytes) else text.encode())
            words += ["--record", str(file)]
        new.unlink(missing_ok=True)
        return main(["import", str(old), *words, "-o", str(new)]), new, capsys.readouterr().err

    return call


def motion(new):
    """Accelerations at the samples of the first motion of a deck, in m/s2."""
    return prepare(Request(str(new))).motions[0]


@pytest.mark.parametrize("line", [SIX, COUNTS, SIX.replace("6 1", "0 0"), SIX.replace("6 1", "1 1")])
@pytest.mark.parametrize(
    ("text", "unit", "dt", "peak"),
    [
        (AT2, "G", 0.005, 0.4 * GRAVITY),
        (cosmos(), '"CM/S2"', 0.005, 10.1912345),
        (esm(), '"CM/S2"', 0.005, 10.1912345),
        (FILES["KNET"], '"CM/S2"', 0.01, 0.12681),
        (FILES["CSMIP"], '"CM/S2"', 0.005, None),
        (FILES["SMC"], '"CM/S2"', 0.005, 10.1912345),
    ],
)
def test_a_file_with_a_header_is_read_by_it(imported, line, text, unit, dt, peak):
    code, new, told = imported(line, text)
    assert code == 0, told
    (card,) = (row for row in new.read_text().splitlines() if "RECORD" in row)
    assert card.split() == ["RECORD", 'FILE="quake1.txt"', "FORMAT=AUTO", f"UNIT={unit}"]
    assert "BY CONVENTION" in new.read_text() and "L605" in told
    found = motion(new)
    assert found.info["dt"] == dt and not found.info["warnings"]
    assert peak is None or abs(found.acceleration.peak()[1]) == pytest.approx(peak, rel=1e-4)


@pytest.mark.parametrize("line", [SIX, COUNTS])
@pytest.mark.parametrize("text", [TWO, TWO.replace(", ", ";"), TWO.replace("t, a\n", ""), FILES["BERG"]])
def test_times_of_a_file_go_before_the_step_of_the_deck(imported, line, text):
    code, new, told = imported(line, text)
    assert code == 0 and "FORMAT=AUTO UNIT=G" in new.read_text(), told
    assert ("SCALE=0.10193" in new.read_text()) == (line == SIX)  # no unit in the file: ASCALE acts
    found = motion(new)
    assert found.info["dt"] in (0.02, None)
    factor = 1.0 if line == SIX else GRAVITY
    assert abs(found.acceleration.peak()[1]) == pytest.approx(
        factor * (0.3 if text == FILES["BERG"] else 0.1)
    )


@pytest.mark.parametrize(
    ("line", "text", "items"),
    [
        (SIX, SERIES, "FORMAT=COLUMNS COLUMN=0 DT=0.02"),
        (SIX, "a\n0.1\n-0.2\n0.3\n", "FORMAT=COLUMNS COLUMN=0 DT=0.02"),
        (COUNTS, COUNTED, "FORMAT=COLUMNS TIMES=2 COLUMN=3 START=0.02"),
        (SIX.replace("6 1", "1 1"), PAIRS, "FORMAT=BERG"),
        (SIX.replace("6 1", "1 1"), TWO, "FORMAT=BERG"),
    ],
)
def test_the_format_that_the_deck_states_is_kept(imported, line, text, items):
    code, new, told = imported(line, text)
    assert code == 0 and f'"quake1.txt" {items} UNIT=G' in new.read_text(), told
    motion(new)


def test_the_new_deck_runs(imported):
    shares = []
    for text in (TWO, AT2, cosmos()):
        code, new, told = imported(COUNTS, text)
        assert code == 0, told
        with run(new, out=new.parent) as results:
            shares.append(results.table("drift_envelope")[0]["max"])
    assert np.all(np.array(shares) > 0.0)


def test_factors_of_the_deck_act_on_a_file_of_another_format(imported):
    deck = STICK.replace("0.005 0.4 1.0", "0.005 0.4 0.5")
    code, new, told = imported("3 3 0.01 2 0.08 0 0 0.5", TWO, deck=deck)
    assert code == 0, told
    assert "FORMAT=AUTO START=0.04 DURATION=0.04 TSCALE=0.5 UNIT=G SCALE=0.25" in new.read_text()
    assert told.count("L605") == 4  # the file's times, ISTART, END, TSCALE
    assert motion(new).acceleration.end == pytest.approx(0.02)
    code, new, told = imported("3 1 0.01 980.665 -1 0 0 1", esm(), deck=deck)
    assert 'UNIT="CM/S2" SCALE=0.5' in new.read_text() and "ASCALE" not in told
    code, new, told = imported("3 1 0.01 9.81 -1 0 0 1", esm(), deck=deck)
    assert 'UNIT="CM/S2" SCALE=0.5' in new.read_text() and "ASCALE 9.81 does not act" in told


def test_two_records(imported):
    deck = STICK.replace("2 0 1 0 2 0 0", "2 0 1 0 2 1 0")
    code, new, told = imported(f"{COUNTS}\n{SIX}", AT2, esm(), deck=deck)
    cards = [row.split(None, 1)[1] for row in new.read_text().splitlines() if "RECORD" in row]
    assert code == 0, told
    assert cards[0] == 'FILE="quake1.txt" FORMAT=AUTO UNIT=G'
    assert cards[1] == 'FILE="quake2.txt" FORMAT=AUTO UNIT="CM/S2" DIRECTION=Y'
    assert [m.direction for m in prepare(Request(str(new))).motions] == ["X", "Y"]
    code, _, told = imported(f"{COUNTS}\n{SIX}", "no\n", "1 x\n", deck=deck)
    assert code == 2 and told.count("error L613") == told.count("error") == 2
    for texts in ((), (AT2,)):
        code, _, told = imported(f"{COUNTS}\n{SIX}", *texts, deck=deck)
        assert code == 2 and told.count("error") == 1
        assert "--record HORIZONTAL --record VERTICAL" in told


@pytest.mark.parametrize(
    ("line", "text", "place", "message", "hint"),
    [
        (SIX, TWO.replace("-0.1", "x", 1), "3:1", "'x' is not a finite number", "one a line"),
        (COUNTS, TWO.replace("-0.1", "x", 1), "3:1", "'x' is not a finite number", "ISTART"),
        (SIX, "no record\n", "1:1", "holds no numbers", "two columns of time and acceleration"),
        (SIX, THREE, "1:1", "the file has 3 columns", "two columns of time and acceleration"),
        (COUNTS, THREE, "1:1", "the file has 3 columns", "two columns of time and acceleration"),
        (SIX, TWO.replace("0.04", "0.02"), "1:1", "sample 3 is at time 0.02", "two columns of time"),
        (SIX, TWO.replace("0.04, 0.1", "0.04"), "4:1", "line 4 holds 1", "two columns of time"),
        (COUNTS, "0.1\n0.2\n", "1:1", "one column and no times", "two columns of time and acceleration"),
        (SIX, AT2.replace("NPTS= 4", "NPTS= 5"), "1:1", "declares 5 values, the file holds 4", "cut short"),
        (SIX, b"\x1f\x8b\x08\0", "1:1", "a gzip archive", "unpack it"),
        (SIX, "", "1:1", "the file is empty", "two columns of time and acceleration"),
    ],
)
def test_a_file_of_no_format_is_told_once_at_its_line(imported, line, text, place, message, hint):
    code, new, told = imported(line, text)
    assert code == 2 and not new.exists()
    (found,) = (row for row in told.splitlines() if "error" in row)
    assert found.partition(": error L613: no record as IBERG")[0].endswith(f"quake1.txt:{place}")
    assert message in found and hint in told
    assert "FORMAT=" not in told and "DT=" not in told  # items of a card that does not exist yet


@pytest.mark.parametrize("line", [SIX, COUNTS])
def test_what_the_hint_names_is_read(imported, line):
    layout = "".join(f"{x}\n" for x in SAMPLES) if line == SIX else COUNTED
    for text in (TWO, layout):
        code, _, told = imported(line, text)
        assert code == 0, told


def test_a_start_beyond_the_samples(imported):
    code, _, told = imported("3 9 0.01 1 -1 0 0 1", AT2)
    assert code == 2 and "error L608" in told and "has 4 samples" in told


def test_forces_in_another_format(imported):
    deck = STICK.replace("2 0 1 0 2 0 0", "3 0 1 0 2 0 0").replace("EQUAKE", "SHAPE\n2 1 0 0\nEQUAKE")
    deck = deck.partition("EQUAKE")[0]
    code, new, told = imported("6 1 0.02 2 -1 0 0 1", TWO, deck=deck)
    assert code == 0, told
    assert 'RECORD 2 0.5 0 0 FILE="quake1.txt" FORMAT=AUTO\n' in new.read_text()
    prepare(Request(str(new)))
