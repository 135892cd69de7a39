"""Example 07, a row of three frames: its contacts by hand, and NEWMARK beside EXACT."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kernels import FAST

DECK = Path(__file__).parents[2] / "examples" / "07_row_of_three" / "row_of_three.inp"


def rows(results, table: str):
    return {r["contact"]: r for r in results.table(table)}


def test_stiffnesses_by_hand(run):
    _, results, _ = run(DECK)
    laws = rows(results, "contact_laws")
    for n, beam in ((1, 5), (2, 6)):  # E A / L of the left frame's beam, 0.3 by 0.45
        row = laws[f"left {n}"]
        assert row["k"] == f"{28e6 * 0.3 * 0.45 / 6:.0f} kN/m"
        assert row["note"].endswith(f"K of element {beam}, the softer")
    # e^2 = 1 - D/W at 5 mm: a (K1 - K) = s (a K1 + (1 - a) K), K = KH 0.005^0.5, s = 0.32, a = 0.1
    hertz, s = 1.5e6 * 0.005**0.5, 0.32
    k1 = hertz * (0.1 + 0.9 * s) / (0.1 - 0.1 * s)
    assert float(laws["column 1"]["k"].split()[0]) == pytest.approx(k1, rel=1e-6)


def test_what_the_pad_lost_is_the_area_that_was_crushed(run):
    """However often it was hit: every way back is the way there."""
    _, results, _ = run(DECK)
    wall = rows(results, "contact_summary")["wall"]
    depths, forces, ku = [0.0, 2e-3, 6e-3, 1e-2], [0.0, 60.0, 90.0, 210.0], 6e4
    most = wall["peak_penetration"]
    assert 6e-3 < most < 1e-2 and wall["closures"] >= 3
    force = float(np.interp(most, depths, forces))
    area = 0.5 * 60 * 2e-3 + 75 * 4e-3 + 0.5 * (90 + force) * (most - 6e-3)
    assert wall["peak_force"] == pytest.approx(force, rel=1e-9)
    assert wall["energy_lost"] == pytest.approx(area - 0.5 * force**2 / ku, rel=1e-9)


@pytest.mark.full
def test_energies_balance_with_and_without_pounding(run):
    for pounding in ("0", "1"):
        _, results, _ = run(DECK, {"pounding": pounding})
        assert results.table("contact_summary")["closures"].any() == (pounding == "1")
        checks = {r["check"]: r["value"] for r in results.table("checks")}
        assert float(checks["largest energy residual over the largest energy"]) < 1e-11


@pytest.mark.full
@FAST
def test_steps_come_near(run):
    _, exact, _ = run(DECK)
    errors = []
    for h in (1e-3, 5e-4):
        _, steps, _ = run(DECK, None, "NEWMARK", h)
        one, two = exact.table("contact_summary"), steps.table("contact_summary")
        assert one["closures"].tolist() == two["closures"].tolist()
        drift = [r.table("drift_envelope") for r in (exact, steps)]
        off = [np.abs(drift[1][c] / drift[0][c] - 1.0).max() for c in ("max", "min")]
        errors.append(
            max(*off, np.abs(two["peak_force"] - one["peak_force"]).max() / one["peak_force"].max())
        )
    assert errors[0] < 6e-3 and 3.0 < errors[0] / errors[1] < 5.0, errors
