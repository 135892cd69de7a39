"""TAYLOR with curved contacts and with friction: closed forms, restitutions, and NEWMARK that converges to
it.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import gamma

from pound_solve.assess.law_test import specimen
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law
from pound_solve.numerics.types import Array
from samples import has_loop
from tiers import at_night, each_once
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
    if has_loop(spec) and specimen(spec)[0].law.rule.power_law is not None
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
    k = 3e7 if law == "RUBBER_BUMPER" else 3e4  # softer, with its exponent it parts late
    r = ball(f"LAW={law} K={k} E={e}")
    assert -r.v[-1, 0, 0] == pytest.approx(0.7 * e, rel=1e-10)
    lost = 0.5 * 2.0 * 0.7**2 * (1.0 - e * e)
    assert r.column("contact_summary", "energy_lost")[0] == pytest.approx(lost, rel=1e-9)
    assert r.check() < 1e-11


GRAZE = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 K 1
 2 HIT 1
PROPS
 K SPRING KX=4
 HIT CONTACT GAP={gap!r} ANGLE=0 {card}
WEIGHTS
 1 1
INITIAL
 1 UX=-0.1
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 2 METHOD=TAYLOR
"""


@full
@pytest.mark.parametrize("name", POWERS)
@pytest.mark.parametrize("off", [1e-8, 1e-9])
def test_a_graze_presses_as_far_as_the_free_swing_goes(name: str, off: float) -> None:
    """The contact hardly moves the body: the force follows from u = -0.1 cos 2t, however shallow."""
    items = ["K=300"] if name == "HERTZ" else ["K=300", "E=0.5"]
    law = specimen(catalog().family("contact")[name], items)[0].law  # its masses make one of 1
    swing, omega = 0.1, 2.0
    r = run_text(GRAZE.format(gap=swing * (1.0 - off), card=" ".join([f"LAW={name}", *items])))
    (c,) = r.tables["collisions"]
    touch = math.acos(1.0 - off) / omega  # before the crest
    before = np.linspace(touch, 0.0, 20001)
    overlap = swing * (off - 2.0 * np.sin(0.5 * omega * before) ** 2)
    rate = swing * omega * np.sin(omega * before)
    at, _, _, m = law.transition(law.start(), 0, 0.0, rate[0])
    forces = [law.rule.curve(law.p, at, m, 0.0, max(x, 0.0), v)[0] for x, v in zip(overlap, rate)]
    assert c["peak_force"] == pytest.approx(max(forces), rel=1e-5)
    assert 0.5 * (c["t_start"] + c["t_end"]) == pytest.approx(0.5 * math.pi, abs=0.01 * touch)


@full
@pytest.mark.parametrize("law", ["HERTZ", "JANKOWSKI", "HUNT_CROSSLEY"])
def test_a_contact_without_a_gap(law: str) -> None:
    """It is touched at the start, where nothing has moved yet."""
    e = 1.0 if law == "HERTZ" else 0.5
    card = f"LAW={law} K=3e4" + ("" if law == "HERTZ" else " E=0.5")
    r = run_text(BALL.format(card=card, vt=0.0).replace("GAP=0.02", "GAP=0"))
    assert r.status == "done" and -r.v[-1, 0, 0] == pytest.approx(0.7 * e, rel=1e-10)


K, N, LIMIT, KU, D, GAP, MASS = 4e5, 2.65, 0.02, 6e4, 0.7, 0.02, 2.0  #: of the bumper below


def bumper(x: float, where: int) -> tuple[float, float]:
    """Force and energy of a rubber at an overlap, open (0), soft (1) or used up (2)."""
    if where < 2:
        return where * K * max(x, 0.0) ** N, K / (N + 1.0) * max(x, 0.0) ** (N + 1.0)
    at, more = K * LIMIT**N, x - LIMIT
    return at + KU * more, K / (N + 1.0) * LIMIT ** (N + 1.0) + (at + 0.5 * KU * more) * more


def bumped(v: float, load: float, times: Array) -> tuple[Array, float]:
    """Places at some times of a mass that a load presses on a bumper, and the largest force: by DOP853
    from one touch, turn or end of the rubber to the next, where its force goes on as it was.
    """
    t, y, speed, parting, where = 0.0, np.array([0.0, v]), 0.0, False, 0
    out, most = [0.0], 0.0
    events = [lambda t, y: y[0] - GAP, lambda t, y: y[0] - GAP - LIMIT, lambda t, y: y[1]]
    for event in events:
        event.terminal = True  # type: ignore[attr-defined]
    while t < times[-1]:

        def rates(
            t: float, y: Array, damped: float = D / speed if parting else 0.0, where: int = where
        ) -> Array:
            force = bumper(y[0] - GAP, where)[0] * (1.0 + damped * y[1])
            return np.array([y[1], (load - force) / MASS])

        found = solve_ivp(
            rates,
            (t, times[-1]),
            y,
            "DOP853",
            events=events,
            dense_output=True,
            rtol=1e-13,
            atol=1e-16,
            max_step=1e-3,  # its output between steps, where events are found, is of a lower order
        )
        out += [float(found.sol(at)[0]) for at in times if t < at <= found.t[-1]]
        if found.status == 0:
            break
        (which,) = (i for i, at in enumerate(found.t_events) if len(at))
        t, y = float(found.t_events[which][0]), found.y_events[which][0]
        if which == 0:
            speed, parting, where = max(float(y[1]), 0.0), False, int(y[1] > 0.0)
        elif which == 1:
            where = 2 if y[1] > 0.0 else 1
        else:
            force, energy = bumper(y[0] - GAP, where)
            parting, most = force > 0.0 and not parting, max(most, force)
            speed = max(speed, math.sqrt(2.0 * energy / MASS)) if parting else speed
        # off the event, lest it is found again
        y, t = y + 1e-9 * rates(t, y, D / speed if parting else 0.0), t + 1e-9
    return np.array(out), most


@full
@pytest.mark.parametrize(
    ("v", "load"),
    [
        (0.3, 0.0),  # the rubber is not used up
        (3.0, 0.0),
        (0.01, 900.0),  # touched slowly, and pressed beyond the limit
        (1.5, 200.0),
        (0.06, 8.0),
    ],
)
def test_a_bumper_against_an_ode_solver(v: float, load: float) -> None:
    card = f"LAW=RUBBER_BUMPER K={K} N={N} THICKNESS={LIMIT / 0.8} KU={KU} D={D}"
    deck = BALL.format(card=card, vt=0.0).replace("PARAM v = 0.7", f"PARAM v = {v}")
    deck = deck.replace("OUTPUT", f"FORCES\n TABLE 1 {load} 0 POINTS=0,1,9,1\nOUTPUT").replace(
        "0.05", "0.01"
    )
    r = run_text(deck)
    assert r.status == "done" and r.check() < 1e-11, r.message
    x, most = bumped(v, load, np.linspace(0.0, 0.5, 51))
    assert np.abs(r.u[:, 0, 0] - x).max() < 1e-9 * np.abs(x).max()
    assert r.column("contact_summary", "peak_force")[0] == pytest.approx(most, rel=1e-9)


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
        "LAW=HERTZDAMP K=2E6 E=0.5 MU=0.5 MUD=0.3 KT=1E6",
        "LAW=KELVIN_VOIGT K=1E5 E=0.6 TENSION=YES MU=0.5 KT=1E6",
        *at_night(
            "LAW=POWER_LAW_DAMPED K=2E6 E=0.7",
            "LAW=RUBBER_BUMPER K=2E8 E=0.6 THICKNESS=0.02 KU=2E5",
            "LAW=MAHMOUD_JANKOWSKI K=1E5 E=0.6 MU=0.4 MUD=0.1 KT=1E6",
            "LAW=HERTZ K=2E6",
            "LAW=RUBBER_BUMPER K=2E8 E=0.6",
            "LAW=KELVIN_VOIGT K=1E5 E=0.6 MU=0.5 KT=1E6",
        ),
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
    limit = math.inf
    if name == "RUBBER_BUMPER":
        limit = 0.1
        law = Law(law.rule, (*law.p[:3], limit, 3.0, *law.p[5:]))
    rule, rng, seen = law.rule, np.random.default_rng(3), set()
    states = [law.start()]
    for v in (1e-4, 0.5, 3.0):
        touched = law.transition(states[0], 0, law.p[2], v)
        states += [touched, *(law.transition(touched, e, law.p[2] + 0.1, -v) for e in (0, 1))]
        if limit < math.inf:
            states.append(law.transition(touched, 2, law.p[2] + limit, v))
            states.append(law.transition(states[-1], 0, law.p[2] + 2.0 * limit, 0.0))
    for at, d0, _, m in states:
        k, n, c, q, pulls, shift = rule.power_law(law.p, at, m)
        used_up = "used up" in rule.branches[at].name
        for x, v in zip(10.0 ** rng.uniform(-6, 0, 20), rng.normal(size=20)):
            v = abs(v) if rule.branches[at].name == "pressed" and name == "JANKOWSKI" else v  # in approach
            if limit < math.inf:
                x = limit + x if used_up else limit * x
            force = k * (x - shift) ** n + c * (x - shift) ** q * v
            told = rule.curve(law.p, at, m, d0, law.p[2] + x, float(v))[0]
            expected = force if force > 0.0 or pulls > 0.0 else 0.0
            assert told == pytest.approx(expected, rel=1e-12, abs=1e-300)
            seen.add((at, expected > 0.0))
    assert {at for at, _ in seen} == set(range(len(rule.branches)))


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


@pytest.mark.full
@each_once(
    ("law", ["LINEAR K={k!r}", "KELVIN_VOIGT K={k!r} C={c!r}", "HERTZ K={k!r}"]), ("mud", ["", "MUD=0.25"])
)
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


ROW = """UNITS N m s
GRAVITY 1
NODES
 1 TO 5 0 TO 4 0 FIX=YR
ELEMENTS
 1 TO 4 TOUCH 1 TO 4 2 TO 5
PROPS
 TOUCH CONTACT GAP={gap} {card}
WEIGHTS
 1 TO 5 0.002
INITIAL
 1 VX=0.5
OUTPUT
 EVERY=1E-6
ANALYSIS
 HISTORY 1E-4 FROM=REST METHOD=TAYLOR
"""


@pytest.mark.parametrize("card", ["HERTZ K=7E9", "HERTZ K=2E7 N=1", "HUNT_CROSSLEY K=7E9 E=0.8"])
def test_a_row_of_bodies_that_touch_is_the_limit_of_small_gaps(card: str) -> None:
    """The overlap of the second contact begins with a power of time above three, at the same instant."""
    touching, apart = (run_text(ROW.format(gap=gap, card=f"LAW={card}")) for gap in ("0", "1E-13"))
    assert touching.status == apart.status == "done", touching.message
    assert np.abs(apart.u).max() > 1e-5 and touching.u == pytest.approx(apart.u, abs=100 * 1e-13)
    assert touching.check() < 1e-12
