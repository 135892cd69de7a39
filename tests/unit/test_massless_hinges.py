"""Peaks of hinges whose rotations have neither mass nor dashpot, in methods with steps."""

from __future__ import annotations

import numpy as np
import pytest

from decks import results_of
from kernels import interpreted
from pound_solve.analyses.history import HINGES
from pound_solve.integrate.kernels import recording
from pound_solve.integrate.protocol import BETWEEN
from tiers import each_once

pytestmark = pytest.mark.full

FRAME = """UNITS kN m s
{head}
NODES
 1 0 0 FIX=XYR
 2 6 0 FIX=XYR
 11 0 4
 12 6 4
 21 0 7
 22 6 7
ELEMENTS
 1 COL 1 11
 2 COL 2 12
 3 BEAM 11 12
 4 COL 11 21
 5 COL 12 22
 6 BEAM 21 22
PROPS
 COL FRAME E=200E6 A=0.01 I=0.00013 KH=90000 MI=240 MJ=240 RULE={rule}
 BEAM FRAME E=200E6 A=0.008 I=0.0002 KH=110000 MI=210 MJ=210 RULE={rule}
WEIGHTS
 11,12,21,22 240 240
LOADS
 11,12,21,22 0 -150
DAMPING
 RAYLEIGH ALPHA=0.25 BETA=0.002
EQUAKE
 SYNTHETIC SEED=1 PGA=9 DURATION=3 RISE=0.5 STRONG=2
OUTPUT
 EVERY=0.005
ANALYSIS
 HISTORY 3 METHOD={method}
"""


@each_once(
    (
        "rule",
        ["MENEGOTTO_PINTO R=0.02", "BOUC_WEN R=0.02 N=1", "TAKEDA R=0.02 ALFA=0.4", "BILINEAR R=0.02"],
    ),
    ("head", ["GEOMETRY PDELTA", "GEOMETRY SMALL", "GEOMETRY PDELTA_VARYING"]),
    ("method", ["NEWMARK DT=0.005", "HHT DT=0.005 ALPHA=-0.05", "GENERALISED_ALPHA DT=0.005 RHO=0.8"]),
)
def test_no_peak_stands_between_the_steps(tmp_path, rule, head, method):
    """Each step is stored: between two of them a rotation or a moment cannot grow by more than a little.

    A law that turns back leaves the joints a little out of balance; no dashpot holds them, and what their
    rates would have to be to restore it in no time is not how they move.
    """
    deck = tmp_path / "frame.inp"
    deck.write_text(FRAME.format(rule=rule, head=head, method=method))
    with results_of(deck) as r:
        assert r.status == "done", r.message
        peaks = r.table("spring_envelope")
        for kind in ("deformation", "force"):
            peak = np.maximum(peaks[f"{kind}_max"], -peaks[f"{kind}_min"])
            stored = np.abs(r.history(f"spring/{kind}")).max(axis=0)
            assert (stored <= peak * (1 + 1e-12)).all()
            assert (peak <= 1.02 * stored).all(), peak / stored
        assert np.nanmax(peaks["ductility"]) > 4


def test_peaks_that_never_were_are_told(tmp_path, monkeypatch):
    """Crests between two steps ten times as high as they are: members bear no such moment, and the ends of
    no step come near.
    """
    deck = tmp_path / "frame.inp"
    text = FRAME.format(rule="BILINEAR R=0.02", head="", method="NEWMARK DT=0.005")
    deck.write_text(text.replace("HISTORY 3", "HISTORY 0.8"))
    cubic_peak = recording.cubic_peak

    def too_high(*ends):
        at, top = cubic_peak(*ends)
        return at, 10.0 * top

    verdicts = []
    for crest in (cubic_peak, too_high):
        monkeypatch.setattr(recording, "cubic_peak", crest)
        with interpreted(), results_of(deck) as r:
            verdicts.append([x.verdict for x in r.checks if x.name in (BETWEEN, HINGES)])
    assert verdicts == [["good", "good"], ["look", "look"]]
