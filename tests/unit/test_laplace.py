"""LAPLACE: orders against closed forms, and EXACT's answers with contact, yielding and soil."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pound_solve.integrate.closed_form import laplace
from pound_solve.integrate.closed_form.laplace_transform import LaplaceTransform
from verification.cases import ROOT, Ran, run_deck, run_text

pytestmark = pytest.mark.full

OSCILLATOR = """UNITS N m s
PARAM w = 5   xi = 0.05   gap = 9
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 K 1 2
 2 STOP 2
PROPS
 K SPRING KX=w^2
 STOP CONTACT GAP=gap LAW=KELVIN_VOIGT K=1000 E=0.7
WEIGHTS
 2 1
DAMPING
 RAYLEIGH XI=xi OMEGA=w,3*w
INITIAL
 2 UX=-1 VX=2
OUTPUT
 EVERY=0.1
ANALYSIS
 HISTORY 3
"""


def test_free_vibration_by_its_closed_form() -> None:
    """Without kinks in the excitation the error is that of the cubics between the samples: order 4 at an
    output time between them."""
    w, xi = 5.0, 0.05
    wd = w * math.sqrt(1 - xi * xi)
    off = []
    for dt in (0.03, 0.015, 0.0075):
        r = run_text(OSCILLATOR, method="LAPLACE", dt=dt)
        t = r.time
        u = np.exp(-xi * w * t) * (-np.cos(wd * t) + (2 - xi * w) / wd * np.sin(wd * t))
        off.append(np.abs(r.u[:, 1, 0] - u).max())
        assert r.check() < 1e-3
    assert off[2] < 2e-6
    assert math.log2(off[0] / off[1]) > 3.5 and math.log2(off[1] / off[2]) > 3.5


def test_bodies_that_nothing_holds_keep_their_speeds() -> None:
    """Between impacts they have no rate of their own, to which the part taken off could be fitted."""
    deck = """GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 MEET 1 2
PROPS
 MEET CONTACT GAP=0.05 ANGLE=0 LAW=KELVIN_VOIGT K=4E4 E=0.5
WEIGHTS
 1,2 1
INITIAL
 1 VX=1
ANALYSIS
 HISTORY 1
OUTPUT
 EVERY=0.02
"""
    r = run_text(deck, method="LAPLACE", dt=1e-4)
    before, after = r.time < 0.05, r.time > 0.08
    assert np.abs(r.v[before, :, 0] - [1.0, 0.0]).max() < 1e-9
    assert np.abs(r.v[after, :, 0] - [0.25, 0.75]).max() < 1e-6
    assert len(r.tables["collisions"]) == 1


def test_an_input_between_the_samples_is_named_where_the_energy_misses_it() -> None:
    deck = OSCILLATOR.replace("ANALYSIS", "EQUAKE\n TABLE POINTS=0.101,0,0.101001,1E8,0.101002,0\nANALYSIS")
    r = run_text(deck, method="LAPLACE", dt=0.01)
    assert r.message.startswith("A504") and "is DT too long for the excitation?" in r.message


def test_kinks_of_the_excitation_leave_order_3() -> None:
    """A sawtooth of the ground whose points lie between the samples."""
    deck = OSCILLATOR.replace("ANALYSIS", "EQUAKE\n TABLE POINTS=0,0,0.31,8,0.77,-9,1.3,3,9,3\nANALYSIS")
    exact = run_text(deck, method="EXACT")
    runs = [run_text(deck, method="LAPLACE", dt=dt) for dt in (0.04, 0.02, 0.01, 0.005)]
    place, speed = (
        [float(np.abs(getattr(r, x) - getattr(exact, x)).max()) for r in runs] for x in ("u", "v")
    )
    assert math.log2(place[0] / place[3]) / 3 > 2.5 and place[3] < 1e-7
    assert math.log2(speed[0] / speed[3]) / 3 > 1.5 and speed[3] < 1e-5


def test_impacts_are_those_of_exact() -> None:
    deck = OSCILLATOR.replace("gap = 9", "gap = 0.5")
    exact = run_text(deck, method="EXACT").tables["collisions"]
    off = []
    for dt in (0.005, 0.0025, 0.00125):
        r = run_text(deck, method="LAPLACE", dt=dt)
        c = r.tables["collisions"]
        assert c["t_start"] == pytest.approx(exact["t_start"], abs=1e-6)
        assert c["peak_force"] == pytest.approx(exact["peak_force"], rel=2e-5)
        assert c["impulse"] == pytest.approx(exact["impulse"], rel=2e-5)
        off.append(np.abs(c["t_end"] - exact["t_end"]).max())
    assert off[0] / off[2] > 30.0


SOIL = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0
 2 0 4
 3 12 0
 4 12 4
ELEMENTS
 1 FOOT 1
 2 COL 1 2
 3 FOOT 3
 4 COL 3 4
 5 HIT 2 4
PROPS
 FOOT FOUNDATION {foot}
 COL FRAME E=3e7 A=0.2 I=0.004
 HIT CONTACT GAP=0.004 LAW=KELVIN_VOIGT K=2e5 E=0.6
WEIGHTS
 1 300 300 200
 2 800 800 100
 3 300 300 200
 4 300 300 60
INITIAL
 2 VX=0.4
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 1.2
"""


def test_two_buildings_on_soil_that_pound() -> None:
    """Cones under both footings, the contact between the roofs: displacements and forces of EXACT."""
    deck = SOIL.format(foot="G=8e4 NU=0.33 WGT=19 B=2 L=2")
    exact = run_text(deck, method="EXACT")
    assert exact.status == "done", exact.message
    r = run_text(deck, method="LAPLACE", dt=2e-4)
    assert r.status == "done", r.message
    size = np.abs(exact.u).max()
    assert np.abs(r.u - exact.u).max() < 1e-5 * size
    assert len(r.tables["collisions"]) == len(exact.tables["collisions"]) > 0
    assert r.column("contact_summary", "peak_force") == pytest.approx(
        exact.column("contact_summary", "peak_force"), rel=1e-4
    )
    assert r.check() < 1e-3


def test_the_papers_lumped_buildings() -> None:
    """El Centro, storeys that yield, a stiff and an equivalent contact: peaks of EXACT."""
    deck = ROOT / "examples" / "cole2011" / "lumped.inp"
    for contact, share in (({}, 1e-4), ({"kc": 3254097, "cc": 9822.4}, 1e-5)):
        exact = run_deck(deck, {"t": 3, **contact}, "EXACT")
        r = run_deck(deck, {"t": 3, **contact}, "LAPLACE", 1e-3)
        for name in ("max", "min"):
            size = np.abs(exact.column("drift_envelope", name)).max()
            off = r.column("drift_envelope", name) - exact.column("drift_envelope", name)
            assert np.abs(off).max() < share * size
        most = exact.column("contact_summary", "peak_force")
        assert r.column("contact_summary", "peak_force") == pytest.approx(most, rel=share)
        assert len(r.tables["collisions"]) == len(exact.tables["collisions"])


def test_what_it_cannot_take_is_refused_in_words() -> None:
    r = run_text(
        OSCILLATOR.replace("LAW=KELVIN_VOIGT K=1000", "LAW=STEREOMECHANICS"), None, "LAPLACE", 0.01
    )
    assert r.status == "stopped" and "LAPLACE knows no rigid contact" in r.message
    r = run_text(OSCILLATOR, {"w": 500}, "LAPLACE", 0.01)
    assert "DT=0.01 does not resolve the fastest mode" in r.message
    moved = OSCILLATOR.replace("ANALYSIS", "EQUAKE\n SINE AMPLITUDE=1 PERIOD=1 SUPPORTS=1\nANALYSIS")
    assert "the supports move apart" in run_text(moved, None, "LAPLACE", 0.01).message
    curved = OSCILLATOR.replace("KX=w^2", "KX=w^2 FX=3 RULE=BOUC_WEN N=2")
    assert "the law BOUC_WEN of element 1 is curved" in run_text(curved, None, "LAPLACE", 0.01).message


SOFTENING = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
 4 1 0 FIX=XYR
 5 1 3 FIX=YR
 6 1 6 FIX=YR
ELEMENTS
 1 S 1 2
 2 S 2 3
 3 S2 4 5
 4 S2 5 6
 9 C 2 5
 10 C 3 6
PROPS
 S SPRING KX=30000 RULE=BILINEAR R=-0.05 FX=150
 S2 SPRING KX=60000 RULE=BILINEAR R=-0.05 FX=150
 C CONTACT GAP=0.01 ANGLE=0 LAW=KELVIN_VOIGT K=1E6 E=0.5
WEIGHTS
 2,3 300
 5,6 500
DAMPING
 RAYLEIGH ALPHA=0.2 BETA=0.001
INITIAL
 2 VX=1
 6 VX=-1.5
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.15
"""


def test_motion_that_grows_is_that_of_exact() -> None:
    """Softening branches have poles right of the line of other motions.  Transforms on that line gave
    velocities that jump, and events without an end."""
    exact = run_text(SOFTENING, method="EXACT")
    off = []
    for dt in (1e-3, 5e-4):
        r = run_text(SOFTENING, method="LAPLACE", dt=dt)
        assert r.status == "done", r.message
        assert figure(r, "events") == figure(exact, "events") == 13
        off.append(np.abs(r.u - exact.u).max() / np.abs(exact.u).max())
        assert r.check() < 1e-5
    assert off[0] < 1e-5 and off[1] < 0.3 * off[0]


def figure(r: Ran, item: str) -> int:
    """A count of the report."""
    return int(dict(r.tables["run"].tolist())[item])


def test_events_between_the_samples_without_an_end_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two springs of the deck yield 0.04 ms apart."""
    monkeypatch.setattr(laplace, "MAX_CHANGES", 1)
    monkeypatch.setattr(laplace, "MAX_CHANGES_PER_LAW", 0)
    r = run_text(SOFTENING, method="LAPLACE", dt=1e-3)
    assert r.message.startswith("A503 at t = 0.0051") and "2 changes of branch within one DT" in r.message
    assert "METHOD=EXACT" in r.message


def test_only_so_many_dynamic_stiffnesses_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """The oldest goes, and is formed again; the answers are the same."""
    deck = OSCILLATOR.replace("gap = 9", "gap = 0.5")
    whole = run_text(deck, method="LAPLACE", dt=0.005)
    monkeypatch.setattr(laplace, "MAX_NUMBERS", 2049)
    kept = run_text(deck, method="LAPLACE", dt=0.005)
    assert np.array_equal(kept.u, whole.u)
    assert figure(kept, "combinations of stiffnesses") > figure(whole, "combinations of stiffnesses")


def test_what_does_not_fit_into_memory_is_refused_before_it_is_formed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(LaplaceTransform, "dynamic_stiffness", None)
    deck = OSCILLATOR.replace(" 2 1 0 FIX=YR", " 2 TO 201 1 TO 200 0 FIX=YR").replace(
        " 1 K 1 2", " 1 K 1 2\n 3 TO 201 K 2 TO 200 3 TO 201"
    )
    r = run_text(deck.replace("\n 2 1\n", "\n 2 TO 201 1\n"), method="LAPLACE", dt=0.01)
    assert r.message.startswith("A505")
    assert "200 unknowns at 2049 frequencies, 1.31 GB: METHOD=EXACT" in r.message
