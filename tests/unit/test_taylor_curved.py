"""TAYLOR with curved contacts and with friction: closed forms, restitutions, and NEWMARK that converges to
it.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import gamma

from pound_solve.assess.law_test import has_loop, specimen
from pound_solve.catalog import catalog
from verification.cases import Ran, run_text

BALL = """UNITS N m s
PARAM v = 0.7
GRAVITY 1
NODES
 1 0 0 FIX=R
ELEMENTS
 1 HIT 1
PROPS
 HIT CONTACT GAP=0.02 ANGLE=0 {card}
WEIGHTS
 1 2
INITIAL
 1 VX=v VY={vt}
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 0.5 FROM=REST METHOD=TAYLOR
"""

PAIR = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=R
 3 2 0 FIX=R
 4 3 0 FIX=XYR
ELEMENTS
 1 K1 1 2
 2 K2 4 3
 3 HIT 2 3
PROPS
 K1 SPRING KX=4000 KY=30000
 K2 SPRING KX=9000 KY=20000
 HIT CONTACT GAP=0.01 ANGLE=0 {card}
WEIGHTS
 2 1000
 3 700
DAMPING
 RAYLEIGH XI=0.03 OMEGA=6,12
INITIAL
 2 VX=0.6 VY=0.2
 3 VX=-0.3 VY=-0.1
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 2 FROM=REST
"""

POWERS = [
    name
    for name, spec in catalog().family("contact").items()
    if has_loop(spec) and specimen(spec)[0].law.rule.powers is not None
]
full = pytest.mark.full


def ball(card: str, vt: float = 0.0) -> Ran:
    r = run_text(BALL.format(card=card, vt=vt))
    assert r.status == "done", r.message
    return r


@full
@pytest.mark.parametrize("n", [1.2, 1.5, 2.65])
def test_an_impact_of_an_elastic_ball(n: float) -> None:
    """m x'' = -k x^n: largest overlap and time of contact in closed form (Hertz: 2.943 x/v)."""
    k, m, v = 3e4, 2.0, 0.7
    r = ball(f"LAW=HERTZ K={k} N={n}" if n != 1.5 else f"LAW=HERTZ K={k}")
    most = ((n + 1.0) * m * v * v / (2.0 * k)) ** (1.0 / (n + 1.0))
    share = 1.0 / (n + 1.0)
    lasts = 2.0 * most / v * math.sqrt(math.pi) * gamma(1.0 + share) / gamma(0.5 + share)
    (c,) = r.tables["collisions"]
    assert c["t_end"] - c["t_start"] == pytest.approx(lasts, rel=1e-11)
    assert c["peak_force"] == pytest.approx(k * most**n, rel=1e-12)
    assert c["impulse"] == pytest.approx(2.0 * m * v, rel=1e-12)
    assert r.v[-1, 0, 0] == pytest.approx(-v, rel=1e-13)
    assert r.column("contact_summary", "peak_penetration")[0] == pytest.approx(most, rel=1e-12)
    assert r.check() < 1e-12


@full
@pytest.mark.parametrize("law", [name for name in POWERS if name != "HERTZ"])
@pytest.mark.parametrize("e", [0.2, 0.75])
def test_a_free_impact_gives_back_what_is_asked(law: str, e: float) -> None:
    """To ten digits: the exact relations of restitution and the exact motion confirm each other."""
    r = ball(f"LAW={law} K=3e4 E={e}")
    assert -r.v[-1, 0, 0] == pytest.approx(0.7 * e, rel=1e-10)
    lost = 0.5 * 2.0 * 0.7**2 * (1.0 - e * e)
    assert r.column("contact_summary", "energy_lost")[0] == pytest.approx(lost, rel=1e-9)
    assert r.check() < 1e-11


@full
@pytest.mark.parametrize("law", ["HERTZ", "JANKOWSKI", "HUNT_CROSSLEY"])
def test_a_contact_without_a_gap(law: str) -> None:
    """It is touched at the start, where nothing has moved yet."""
    e = 1.0 if law == "HERTZ" else 0.5
    card = f"LAW={law} K=3e4" + ("" if law == "HERTZ" else " E=0.5")
    r = run_text(BALL.format(card=card, vt=0.0).replace("GAP=0.02", "GAP=0"))
    assert r.status == "done" and -r.v[-1, 0, 0] == pytest.approx(0.7 * e, rel=1e-10)


@full
def test_tension_holds_until_the_overlap_is_gone() -> None:
    r = ball("LAW=POWER_LAW_DAMPED K=3e4 E=0.4 TENSION=YES")
    assert -r.v[-1, 0, 0] == pytest.approx(0.28, rel=1e-10)
    assert r.check() < 1e-11


@full
@pytest.mark.parametrize("mud", [0.3, 0.2])
@pytest.mark.parametrize("law", ["LINEAR", "HERTZ"])
def test_a_ball_that_slides_throughout(law: str, mud: float) -> None:
    """The tangential impulse is mud times the normal one, which is 2 m v; what the spring takes up at first
    goes with 1/KT."""
    r = ball(f"LAW={law} K=3e4 MU=0.3 MUD={mud} KT=1e9", vt=1.0)
    assert r.v[-1, 0, 0] == pytest.approx(-0.7, rel=1e-12)
    assert r.v[-1, 0, 1] == pytest.approx(1.0 - mud * 1.4, rel=1e-8)
    (row,) = r.tables["spring_envelope"]
    assert row["plastic_work"] == pytest.approx(1.0 - r.v[-1, 0, 1] ** 2, rel=1e-6)
    assert r.check() < 1e-11


@full
def test_a_ball_that_sticks_goes_back_the_way_it_came() -> None:
    """KT = K, below MU: both directions are one oscillator."""
    r = ball("LAW=LINEAR K=5000 MU=0.8 KT=5000", vt=0.5)
    assert r.v[-1, 0, :2] == pytest.approx([-0.7, -0.5], rel=1e-12)


@full
@pytest.mark.parametrize(
    "card",
    [
        "LAW=HERTZ K=2E6",
        "LAW=HERTZDAMP K=2E6 E=0.5 MU=0.5 MUD=0.3 KT=1E6",
        "LAW=POWER_LAW_DAMPED K=2E6 E=0.7",
        "LAW=KELVIN_VOIGT K=1E5 E=0.6 MU=0.5 KT=1E6",
        "LAW=KELVIN_VOIGT K=1E5 E=0.6 TENSION=YES MU=0.5 KT=1E6",
        "LAW=MAHMOUD_JANKOWSKI K=1E5 E=0.6 MU=0.4 MUD=0.1 KT=1E6",
    ],
)
def test_newmark_converges_to_it(card: str) -> None:
    """Differences of second order in the step, over collisions, stick and slip."""
    deck = PAIR.format(card=card)
    r = run_text(deck, None, "TAYLOR")
    assert r.status == "done" and r.check() < 1e-11
    far, near = (np.abs(run_text(deck, None, "NEWMARK", dt).u - r.u).max() for dt in (4e-5, 1e-5))
    assert near < 2e-6 * np.abs(r.u).max()
    assert far / near > 6.0  # 16, but where the force begins with the power 1/4 of the overlap


@pytest.mark.parametrize("name", POWERS)
def test_powers_are_the_curve(name: str) -> None:
    """On all branches, at random overlaps and rates."""
    law = specimen(catalog().family("contact")[name])[0].law
    rule, rng, seen = law.rule, np.random.default_rng(3), set()
    states = [law.start()]
    for v in (1e-4, 0.5, 3.0):
        touched = law.transition(states[0], 0, law.p[2], v)
        states += [touched, *(law.transition(touched, e, law.p[2] + 0.1, -v) for e in (0, 1))]
    for at, d0, _, m in states:
        k, n, c, q, pulls = rule.powers(law.p, at, m)
        for x, v in zip(10.0 ** rng.uniform(-6, 0, 20), rng.normal(size=20)):
            v = abs(v) if rule.branches[at].name == "pressed" and name == "JANKOWSKI" else v  # in approach
            force = k * x**n + c * x**q * v
            told = rule.curve(law.p, at, m, d0, law.p[2] + x, float(v))[0]
            expected = force if force > 0.0 or pulls > 0.0 else 0.0
            assert told == pytest.approx(expected, rel=1e-12, abs=1e-300)
            seen.add((at, expected > 0.0))
    assert {at for at, _ in seen} == set(range(len(rule.branches)))


@full
def test_what_is_no_power_is_refused_in_words() -> None:
    r = run_text(PAIR.format(card="LAW=RUBBER_BUMPER K=2E6 E=0.5"), None, "TAYLOR")
    assert r.status == "stopped"
    assert r.message.startswith("A505 at t = 0 s: TAYLOR finds no power series where the law RUBBER_BUMPER")


TWINS = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=R
ELEMENTS
 1 K 1
 2 TO {last} HIT 1
PROPS
 K SPRING KX=900 KY=400
 HIT CONTACT GAP=0.01 ANGLE=-90 LAW={law} MU=0.4 {mud} KT={kt!r}
WEIGHTS
 1 2
INITIAL
 1 VX=0.9 VY=-0.5
FORCES
 TABLE 1 0 -60 POINTS=0,1,9,1
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.6 FROM=REST METHOD=TAYLOR
"""


@pytest.mark.parametrize("law", ["LINEAR K={k!r}", "KELVIN_VOIGT K={k!r} C={c!r}", "HERTZ K={k!r}"])
@pytest.mark.parametrize("mud", ["", "MUD=0.25"])
def test_twins_touch_stick_slip_and_part_at_one_instant(law: str, mud: str) -> None:
    """Two or three contacts with friction side by side are one that is twice, or three times, as stiff."""
    k, c, kt = 6000.0, 6.0, 3000.0
    one = run_text(TWINS.format(last=2, law=law.format(k=6 * k, c=6 * c), mud=mud, kt=6 * kt))
    assert one.status == "done" and len(one.tables["collisions"]) > 1, one.message
    for count in (2, 3):
        share = 6 // count
        own = law.format(k=share * k, c=share * c)
        many = run_text(TWINS.format(last=1 + count, law=own, mud=mud, kt=share * kt))
        assert many.status == "done", many.message
        assert many.u == pytest.approx(one.u, abs=1e-12)
        assert many.check() < 1e-12
