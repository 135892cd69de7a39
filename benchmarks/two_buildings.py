"""The two pounding buildings of Cole et al. (2011) as the peers know them: from the paper, not from a deck.

Units kN, m, s, t.
"""

import math

G = 9.81  # gravity [m/s2]
GAP = 0.008  # clear distance between the buildings [m]
ZETA = 0.05  # damping ratio of both rigid-diaphragm sway modes [-]

# Table IV: floor weight [kN], storey stiffness [kN/m], storey yield force [kN], diaphragm stiffness [kN/m]
BUILDINGS = {
    1: {"W": 1600.0, "k": 420_000.0, "Fy": 2400.0, "kD": 1_881_300.0},
    2: {"W": 3000.0, "k": 350_000.0, "Fy": 1400.0, "kD": 752_520.0},
}
SOFT, STIFF = sorted(b["kD"] for b in BUILDINGS.values())


def rayleigh(b):
    """Alpha [1/s] and beta [s] that give ZETA at omega^2 = (3 -+ sqrt 5)/2 k/m, the two sway modes."""
    w1, w2 = (math.sqrt((3 + s * math.sqrt(5)) / 2 * b["k"] * G / b["W"]) for s in (-1, 1))
    return 2 * ZETA * w1 * w2 / (w1 + w2), 2 * ZETA / (w1 + w2)


def read_two_columns(path):
    """Times [s] and accelerations [g]; blank lines and # comments are skipped."""
    with open(path) as file:
        rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
    return [float(t) for t, _ in rows], [float(a) for _, a in rows]
