"""Two frames that pound, of which one yields: a deck that many tests of methods share."""

import numpy as np

from decks import results_of

# two one-bay frames of which the left one yields at its hinges, slabs that meet with a dashpot
POUNDING = """UNITS kN m s
NODES
 1  0 0 FIX=XYR
 2  6 0 FIX=XYR
 3  0 3
 4  6 3
 11 6.02 0 FIX=XYR
 12 12 0 FIX=XYR
 13 6.02 3
 14 12 3
ELEMENTS
 1 COL 1 3
 2 COL 2 4
 3 BEAM 3 4
 11 STIFF 11 13
 12 STIFF 12 14
 13 BEAM 13 14
 99 MEET 4 13
PROPS
 COL   FRAME E=2E7 A=0.16 I=0.002 {hinge}
 STIFF FRAME E=2E7 A=0.16 I=0.004
 BEAM  FRAME E=2E7 A=0.2 I=0.004
 MEET  CONTACT GAP={gap} ANGLE=0 LAW=KELVIN_VOIGT K=60000 E=0.6
WEIGHTS
 3,4 200 200 {turn}
 13,14 300 300 {turn}
DAMPING
 RAYLEIGH ALPHA=0.4 BETA=0.001
DRIFT
 "left"  1 3
 "right" 11 13
EQUAKE
 SINE AMPLITUDE=6 PERIOD=0.4 DURATION=1.2
ANALYSIS
 HISTORY 1.2 METHOD={method}
OUTPUT
 EVERY={every}
"""


HINGED = "RULE=BILINEAR R=0.05 MI=60 MJ=60 KH=2E5"


def run(folder, method, hinge=HINGED, turn="0.5", every=0.1):
    deck = folder / "frames.inp"
    gap = 0.02 if hinge else 0.008
    deck.write_text(POUNDING.format(method=method, hinge=hinge, turn=turn, gap=gap, every=every))
    return results_of(deck)


def figures(results):
    drift = results.table("drift_envelope")
    return np.array([*drift["max"], *drift["min"], *results.table("contact_summary")["peak_force"]])


def tabled(results):
    node, member = results.table("node_envelope"), results.table("member_envelope")
    return [np.array([t[c] for c in ("max", "t_max", "min", "t_min")]) for t in (node, member)]
