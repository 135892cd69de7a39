"""A history that is taken up again gives the bits of the whole one."""

import h5py
import numpy as np
import pytest

from decks import results_of
from pound_solve.driver.run import DeckError
from samples import stepping_methods
from tiers import each_once

pytestmark = pytest.mark.full

DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
 4 0.5 3 FIX=YR
 5 0.5 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 COL 2 3
 3 SOFT 5 4
 9 GAP 2 4 NAME=touch
PROPS
 COL SPRING KX=4000 FX=60 RULE=BILINEAR R=0.05
 SOFT SPRING KX=900
 GAP CONTACT GAP=0.004 LAW=KELVIN_VOIGT K=80000 E=0.6 ANGLE=0
WEIGHTS
 2 TO 4 100
DAMPING
 RAYLEIGH XI=0.03 MODES=1,2
DRIFT
 "storey 1" 1 2
EQUAKE
 SYNTHETIC SEED=3 PGA=6 DURATION=6 RISE=1 STRONG=3
ANALYSIS
 HISTORY {end} METHOD={method} {more}
OUTPUT
 EVERY=0.02
"""

STEPS = [f"{name} DT=1e-3" for name in stepping_methods()]
METHODS = ["EXACT", "TAYLOR", "LAGUERRE", *STEPS]


def run(folder, name, method, end=6, more=""):
    deck = folder / f"{name}.inp"
    deck.write_text(DECK.format(method=method, end=end, more=more))
    return results_of(deck)


def histories(results, since):
    late = results.time > since
    return {name: results.history(name)[late] for name in results.histories if name != "time"}


@each_once(("method", METHODS), ("at", [3.0, 3.0137]), at_most=3)
def test_a_restart_at_half_time_gives_the_bits_of_the_whole_run(tmp_path, method, at):
    whole = run(tmp_path, "whole", method, more=f"SAVE={at}")
    rest = run(tmp_path, "rest", method, more="RESTART=whole.h5")
    first = run(tmp_path, "first", method, end=at)
    after = run(tmp_path, "after", method, more="RESTART=first.h5")
    assert rest.time[0] == at and len(rest.table("collisions"))
    for part in (rest, after):
        for name, values in histories(whole, at).items():
            assert np.array_equal(values, histories(part, at)[name]), (method, name)
    # the parts' collisions are those of the whole run
    assert len(first.table("collisions")) + len(rest.table("collisions")) - len(
        whole.table("collisions")
    ) in (0, 1)
    own = whole.table("drift_envelope")["max"][0]
    assert own == max(r.table("drift_envelope")["max"][0] for r in (first, rest))


def test_a_saved_time_changes_the_exact_run_by_rounding_only(tmp_path):
    plain, cut = run(tmp_path, "plain", "EXACT"), run(tmp_path, "cut", "EXACT", more="SAVE=2.5")
    a, b = histories(plain, -1.0), histories(cut, -1.0)
    for name in a:
        size = np.abs(a[name]).max(initial=1e-300)
        assert np.abs(a[name] - b[name]).max(initial=0.0) < 1e-8 * size, name
    assert len(plain.table("collisions")) == len(cut.table("collisions"))


def test_a_state_of_another_structure_is_refused(tmp_path):
    run(tmp_path, "first", "EXACT", end=2)
    deck = tmp_path / "other.inp"
    text = DECK.format(method="EXACT", end=4, more="RESTART=first.h5")
    deck.write_text(
        text.replace(" 4 0.5 3 FIX=YR", " 4 0.5 3 FIX=R")
        .replace(" 3 SOFT 5 4", " 3 SOFT 5 4\n 4 UP 5 4")
        .replace(" SOFT SPRING", " UP SPRING KY=100\n SOFT SPRING")
    )
    with pytest.raises(DeckError, match=r"(?s)node 4 is not that of .*element 4 is not that of"):
        results_of(deck)


def test_a_state_later_than_the_end_is_refused(tmp_path):
    run(tmp_path, "first", "EXACT", end=3)
    assert "ends at 2" in run(tmp_path, "again", "EXACT", end=2, more="RESTART=first.h5").message


def test_a_state_of_another_version_is_refused(tmp_path):
    run(tmp_path, "first", "EXACT", end=2)
    with h5py.File(tmp_path / "first.h5", "r+") as file:
        file.attrs["program_version"] = "0.1.0"
        file.attrs["format_version"] = [1, 1]
    with pytest.raises(DeckError, match="written by version 0"):
        run(tmp_path, "again", "EXACT", end=4, more="RESTART=first.h5")
