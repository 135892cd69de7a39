"""Examples 03 to 06 against matrices made by hand, plastic mechanisms, and NEWMARK."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

pytestmark = pytest.mark.full

EXAMPLES = Path(__file__).parents[2] / "examples"
CONCRETE = EXAMPLES / "03_concrete_frame" / "concrete_frame.inp"
TIMBER = EXAMPLES / "04_timber_frame" / "timber_frame.inp"
SECTION = EXAMPLES / "05_rocking_wall" / "section.inp"
FLAG = EXAMPLES / "05_rocking_wall" / "flag.inp"
UNEQUAL = EXAMPLES / "06_unequal_frames" / "unequal_frames.inp"
G = 9.81


class Frame:
    """Stiffness and mass by hand, three DOFs a node, from flexibilities of cantilevers."""

    def __init__(self, at: dict[int, tuple[float, float]]) -> None:
        self.at, self.names = at, list(at)
        self.k = np.zeros((3 * len(at), 3 * len(at)))
        self.m = np.zeros(3 * len(at))

    def add(self, i: int, j: int, ea: float, ei: float, n: float = 0.0, soft: tuple[float, float] = (0, 0)):
        """Add a member with axial force n (the string) and joints that turn by `soft` per moment."""
        (x0, y0), (x1, y1) = self.at[i], self.at[j]
        length = np.hypot(x1 - x0, y1 - y0)
        c, s = (x1 - x0) / length, (y1 - y0) / length
        # tip of a cantilever from I: the joint at I turns by soft (M + F L), that at J by soft M
        a = soft[0]
        tip = np.array(
            [
                [length / ea, 0, 0],
                [0, length**3 / (3 * ei) + a * length**2, length**2 / (2 * ei) + a * length],
                [0, length**2 / (2 * ei) + a * length, length / ei + a + soft[1]],
            ]
        )
        rigid = np.array([[1, 0, 0], [0, 1, length], [0, 0, 1]])
        turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        relative = np.hstack([-rigid @ turn, turn])
        across = np.array([s, -c, 0, -s, c, 0])
        both = [3 * self.names.index(p) + d for p in (i, j) for d in range(3)]
        self.k[np.ix_(both, both)] += relative.T @ np.linalg.inv(tip) @ relative
        self.k[np.ix_(both, both)] += n / length * np.outer(across, across)

    def weigh(self, node: int, weight: float):
        self.m[3 * self.names.index(node) : 3 * self.names.index(node) + 2] += weight / G

    def periods(self, count: int, fixed: tuple[int, ...]) -> np.ndarray:
        """Longest periods, rotations condensed."""
        held = [3 * self.names.index(n) + d for n in fixed for d in range(3)]
        free = [f for f in range(len(self.m)) if f not in held]
        heavy = [f for f in free if self.m[f] > 0]
        light = [f for f in free if self.m[f] == 0]
        inner = np.linalg.solve(self.k[np.ix_(light, light)], self.k[np.ix_(light, heavy)])
        k = self.k[np.ix_(heavy, heavy)] - self.k[np.ix_(heavy, light)] @ inner
        return 2 * np.pi / np.sqrt(eigh(k, np.diag(self.m[heavy]), eigvals_only=True)[:count])


def test_periods_of_the_concrete_frame(run):
    _, results, _ = run(CONCRETE)
    b, h, e, c, w, d = 5.0, 3.2, 28e6, 0.4, 0.25, 0.45
    frame = Frame({10 * s + n if s else n: ((n - 1) * b, s * h) for s in range(4) for n in (1, 2, 3)})
    axial = {
        (r["element"]): r["value"] for r in results.table("static_force") if r["quantity"] == "axial I"
    }
    for s in range(1, 4):
        for n in (1, 2, 3):
            below = 10 * (s - 1) + n if s > 1 else n
            frame.add(below, 10 * s + n, e * c * c, e * 0.3 * c**4 / 12, axial[10 * s + n])
            frame.weigh(10 * s + n, 200 if n == 2 else 100)
        for n in (1, 2):
            beam = 100 * s + n
            frame.add(10 * s + n, 10 * s + n + 1, e * w * d, e * 0.3 * w * d**3 / 12, axial[beam])
    # the columns carry the floors: the axial forces of a storey add up to what is above
    for s, above in ((1, 1200), (2, 800), (3, 400)):
        assert sum(axial[10 * s + n] for n in (1, 2, 3)) == pytest.approx(-above, rel=1e-9)
    np.testing.assert_allclose(results.table("modes")["period"], frame.periods(4, (1, 2, 3)), rtol=1e-8)


def first_push(results):
    """Capacity curve of the first PUSHOVER."""
    curve = results.table("capacity_curve")
    return curve[curve["push"] == 1]


def test_mechanism_of_the_concrete_frame(run, tmp_path: Path):
    small = tmp_path / "small.inp"
    small.write_text(CONCRETE.read_text("utf-8").replace("GEOMETRY PDELTA", "GEOMETRY SMALL"), "utf-8")
    arm = 3.2 * (1 + 4 + 9) / 6
    _, results, _ = run(small, {"r": "0"})
    assert first_push(results)["base_shear"].max() == pytest.approx(2000 / arm, rel=1e-10)
    # P-Delta: 2400 kN of weight on the storeys' drifts, no less than were they equal
    _, results, _ = run(CONCRETE, {"r": "0"})
    end = first_push(results)["base_shear"][-1]
    assert end == pytest.approx(233.093, abs=5e-4)
    assert end < (2000 - 2400 * 0.1) / arm
    # and with hardening
    _, results, _ = run(CONCRETE)
    assert first_push(results)["base_shear"][-1] == pytest.approx(262.826, abs=5e-4)


def test_timber_frame_by_hand(run):
    _, results, _ = run(TIMBER)
    e, ac, ic, ab, ib = 10e6, 0.27 * 0.63, 0.27 * 0.63**3 / 12, 0.18 * 0.63, 0.18 * 0.63**3 / 12
    frame = Frame({2 * s + n: (9.0 * (n - 1), 3.0 * s) for s in range(5) for n in (1, 2)})
    for s in range(1, 5):
        for n in (1, 2):
            soft = (1 / 80000, 0) if s == 1 else (0, 0)
            frame.add(2 * s + n - 2, 2 * s + n, e * ac, e * ic, soft=soft)
            frame.weigh(2 * s + n, 45)
        frame.add(2 * s + 1, 2 * s + 2, e * ab, e * ib, soft=(1 / 50000, 1 / 50000))
    np.testing.assert_allclose(results.table("modes")["period"], frame.periods(4, (1, 2)), rtol=1e-8)
    curve = results.table("capacity_curve")["base_shear"]
    assert curve.max() == pytest.approx((8 * 90 + 2 * 120) / 9, rel=1e-12)
    assert len(results.table("push_events")) == 10


def test_rocking_wall_by_hand(run):
    h, b, w, ei = 9.0, 3.0, 900.0, 30e6 * 0.25 * 3.0**3 / 12
    k0 = 100e6 * b**2 / 12 + 2 * 2e5
    period = 2 * np.pi * np.sqrt((h**3 / (3 * ei) + h**2 / k0) * w / G)
    for deck in (SECTION, FLAG):
        _, results, _ = run(deck)
        assert results.table("modes")["period"][0] == pytest.approx(period, rel=1e-9)
        assert results.table("reactions")["fy"].sum() == pytest.approx(w, rel=1e-12)
    # the flag's moment at its largest rotation lies on the line of weight, prestress, bars and tendon
    (spring,) = results.table("spring_envelope")
    kt, my = 195e6 * 1.2e-3 / h * (b / 2) ** 2, (w + 600) * b / 2 + 200 * b
    line = my + kt * (spring["deformation_max"] - my / k0)
    assert spring["force_max"] == pytest.approx(line, rel=1e-9)
    # the section: bars at their strength, and never more than the lever of the whole half foot gives
    _, results, _ = run(SECTION)
    springs = {(r["element"], r["component"]): r for r in results.table("spring_envelope")}
    moment = max(
        max(abs(r["max"]), abs(r["min"]))
        for r in results.table("member_envelope")
        if r["element"] == 10 and r["quantity"] == "moment I"
    )
    most = (w + springs[30, "axial"]["force_max"]) * b / 2 + 200 * b
    assert springs[40, "spring 1"]["force_max"] == pytest.approx(200, rel=1e-9)
    assert 0.9 * most < moment < most


def test_one_unequal_frame_does_not_know_of_the_other_without_pounding(run):
    _, apart, _ = run(UNEQUAL, {"pounding": "0"})
    _, close, _ = run(UNEQUAL)
    assert not apart.table("contact_summary")["closures"].any()
    assert (close.table("contact_summary")["closures"] >= 2).all()
    # the impulse changes the speed of the reduced mass, and holds against what bends behind it
    laws = {r["contact"]: r for r in close.table("contact_laws")}
    for row in close.table("collisions"):
        change = row["approach_velocity"] + row["separation_velocity"]
        assert row["impulse"] > laws[row["contact"]]["mass"] * change


@pytest.mark.parametrize(
    "deck, error", [(FLAG, 0.006), (SECTION, 0.001)], ids=lambda x: x.stem if isinstance(x, Path) else ""
)
def test_steps_come_near(run, monkeypatch: pytest.MonkeyPatch, deck: Path, error: float):
    monkeypatch.setenv("POUND_COMPILE", "0")
    _, exact, _ = run(deck)
    _, steps, _ = run(deck, None, "NEWMARK", 0.01)
    e, s = exact.table("drift_envelope"), steps.table("drift_envelope")
    size = np.maximum(np.abs(e["max"]), np.abs(e["min"]))
    got = max(np.abs((s[c] - e[c]) / size).max() for c in ("max", "min"))
    assert 0.0 < got < error
