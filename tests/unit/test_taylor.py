"""TAYLOR: closed forms, EXACT's answers to rounding, what it refuses and where it stops."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from kernels import FAST, interpreted
from pound_deck.schema import REQUIRED, Spec
from pound_solve.assess.law_test import specimen
from pound_solve.catalog import catalog
from pound_solve.integrate.series import branches, taylor
from samples import has_loop, written
from tiers import at_night, each_once
from unit.test_laplace import SOIL
from verification.cases import ROOT, Ran, run_deck, run_text

pytestmark = pytest.mark.full

#: sampled, so that they hang on the instants that a method looks at
SAMPLED = {"node_envelope", "member_envelope", "reaction_envelope", "base_envelope", "storey_envelope"}
#: what a run tells of itself
TOLD = {"run", "scene", "options", "checks", "run_figures", "overview"}
#: rows in the order of a figure, in which rounding decides between equals
RANKED = {"worst_hinges"}


def item(r: Ran, name: str) -> str:
    """A row of the table `run`."""
    return next(x["value"] for x in r.tables["run"] if x["item"] == name)


def same(r: Ran, e: Ran, tol: float, where: float = 1e-6) -> None:
    """Histories, and every figure of every table, are the same but for `tol` of the largest of their kind;
    times but for `where` of the last.
    """
    assert (r.status, e.status) == ("done", "done"), (r.message, e.message)
    assert r.check() < 1e-10
    for name in ("u", "v", "a", "force"):
        a, b = getattr(r, name), getattr(e, name)
        assert np.abs(a - b).max(initial=0.0) <= tol * np.abs(b).max(initial=0.0), name
    assert set(r.tables) == set(e.tables)
    energy = np.abs(e.tables["energy"]["value"]).max()
    apart = [
        (table, name, *off)
        for table in set(e.tables) - SAMPLED - TOLD - RANKED
        for name in e.tables[table].dtype.names or ()
        if name != "share"  # of what was put in, which may be nothing
        if (off := difference(name, r.tables[table], e.tables[table], tol, where * e.time[-1], energy))
    ]
    assert not apart


def difference(name: str, one: Any, other: Any, tol: float, where: float, energy: float) -> tuple[Any, ...]:
    """What is too far apart in a column of two tables; () if nothing is."""
    if len(one) != len(other):
        return (len(one), len(other))
    if "t_end" in one.dtype.names:  # collisions that end at one instant come in either order
        one, other = (np.sort(x, order=["contact", "t_start"]) for x in (one, other))
    a, b = one[name], other[name]
    if b.dtype.kind != "f":
        return () if np.array_equal(a, b) else (a, b)
    finite = np.isfinite(b)
    if not np.array_equal(np.isfinite(a), finite):
        return (a, b)
    both = (
        name.replace("max", "min"),
        name.replace("min", "max"),
    )  # what goes one way only is near 0 the other
    with_it = [other[x] for x in both if x in other.dtype.names]
    size = max(np.abs(x[np.isfinite(x)]).max(initial=0.0) for x in with_it)
    near = where if name.startswith("t_") else tol * size
    if name in ("value", "energy_lost", "plastic_work"):  # a part is as exact as the whole
        near = max(near, 0.1 * tol * energy)
    off = np.abs(a[finite] - b[finite]).max(initial=0.0)
    return (off, size) if off > near else ()


def agree(text: str, tol: float = 1e-9, where: float = 1e-6, **params: object) -> tuple[Ran, Ran]:
    """Run a deck by TAYLOR and by EXACT, and compare."""
    r, e = (run_text(text, params, method) for method in ("TAYLOR", "EXACT"))
    same(r, e, tol, where)
    return r, e


# ---------------------------------------------------------------- closed forms

OSCILLATOR = """UNITS N m s
PARAM w = 5   xi = 0.05   every = 0.1   end = 3   k = 0   gap = 9
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 K 1 2
 2 STOP 2
 3 LESS 1 2
PROPS
 K SPRING KX=w^2
 LESS SPRING KX=k
 STOP CONTACT GAP=gap LAW=KELVIN_VOIGT K=1000 E=0.7
WEIGHTS
 2 1
DAMPING
 RAYLEIGH XI=xi OMEGA=w,3*w PROPS=K
INITIAL
 2 UX=-1 VX=2
OUTPUT
 EVERY=every
ANALYSIS
 HISTORY end
"""


def free(t: np.ndarray, w: float, xi: float, u: float, v: float) -> np.ndarray:
    """Free vibration, by its closed form."""
    decay = np.exp(-xi * w * t)
    if xi == 1.0:
        return decay * (u + (v + w * u) * t)
    wd = w * np.emath.sqrt(1.0 - xi * xi)
    return np.real(decay * (u * np.cos(wd * t) + (v + xi * w * u) / wd * np.sin(wd * t)))


@pytest.mark.parametrize("every", [0.01, 0.1, 3.0])
@pytest.mark.parametrize("xi", [0.0, 0.05, 1.0, 10.0])
def test_free_vibration_however_far_the_outputs_are_apart(xi: float, every: float) -> None:
    """Undamped to ten times critical: the step is the method's own affair."""
    deck = OSCILLATOR if xi else OSCILLATOR.replace("DAMPING\n RAYLEIGH XI=xi OMEGA=w,3*w PROPS=K\n", "")
    r = run_text(deck, {"xi": xi, "every": every, "w": 20}, "TAYLOR")
    # the ratio is xi at w
    assert np.abs(r.u[:, 1, 0] - free(r.time, 20.0, xi, -1.0, 2.0)).max() < 2e-13
    assert r.check() < 1e-12


@pytest.mark.parametrize(("every", "v"), [(1e-3, 2.0), (1.0, 2.0), (1.0, 0.0)])
def test_no_error_gathers_over_thousands_of_periods(every: float, v: float) -> None:
    """And steps are as many as radians of the motion over some five, whatever is tried first: terms of a
    step far too long would make all later ones inexact.
    """
    w = 1e4
    deck = OSCILLATOR.replace("DAMPING\n RAYLEIGH XI=xi OMEGA=w,3*w PROPS=K\n", "")
    deck = deck.replace("VX=2", f"VX={v}")
    r = run_text(deck, {"w": w, "every": every, "end": 2, "gap": 99}, "TAYLOR")
    off = r.u[:, 1, 0] - free(r.time, w, 0.0, -1.0, v)
    assert np.abs(off).max() < 2e-11  # 2e4 radians, known to 2e-12
    assert r.check() < 1e-11
    steps = int(item(r, "series"))
    if every < 0.01:  # in modes
        assert steps < 100
    else:
        assert w * 2 / 6 < steps < w * 2 / (3 if every < 1 else 4)


def test_growth_that_a_negative_stiffness_leaves_free() -> None:
    """Beyond yield it is negative, and what is left pushes outwards once past the balance."""
    deck = OSCILLATOR.replace("DAMPING\n RAYLEIGH XI=xi OMEGA=w,3*w PROPS=K\n", "")
    deck = deck.replace("LESS SPRING KX=k", "LESS SPRING KX=k FX=0.1 RULE=BILINEAR R=-29/25")
    r, _ = agree(deck.replace("VX=2", "VX=-2"), k=25, gap=99, end=0.8)
    assert np.abs(r.u[-1, 1, 0]) > 2.0


def test_an_earthquake_that_begins_with_nothing_at_a_moved_support() -> None:
    """The support's displacement begins with its third power, the mass's with its fifth: no term of the
    fourth yet tells that anything will move.
    """
    deck = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=XYR
ELEMENTS
 1 K 1 2
 2 K 2 3
PROPS
 K SPRING KX=18
WEIGHTS
 2 1
EQUAKE
 TABLE POINTS=0,0,2,4 SUPPORTS=1
 TABLE POINTS=0,0,2,0 SUPPORTS=3
OUTPUT
 EVERY=1
ANALYSIS
 HISTORY 2
"""
    r, _ = agree(deck)
    # u'' + w^2 u = (w^2 / 2) t^3 / 3 with w = 6
    t, w = r.time, 6.0
    u = (w * w * t**3 - 6 * t) / (6 * w * w) + np.sin(w * t) / w**3
    assert np.abs(r.u[:, r.nodes.index(2), 0] - u).max() < 1e-14


# ---------------------------------------------------------------- laws

STOREYS = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
 4 3 0 FIX=XYR
ELEMENTS
 1 S 1 2
 2 S 2 3
 3 L 1 3
 4 W 3 4
PROPS
 S SPRING KX=4000 {law}
 L SPRING KX=500
 W CONTACT GAP=0.02 {contact}
WEIGHTS
 2,3 100
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2 {damping}
DRIFT
 "lower" 1 2
 "upper" 2 3
EQUAKE
 SYNTHETIC SEED=7 PGA=7 DURATION=4 RISE=0.5 STRONG=3
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 4
 MODAL 2
"""
BILINEAR = "FX=60 RULE=BILINEAR R=0.05"
TOUCH = "LAW=KELVIN_VOIGT K=1e5 E=0.6"
CAP = "R=0.05 DP=0.05 DPC=0.12 RESIDUAL=0.2 LAMBDA=1.5"
RULES = {
    "BILINEAR": "R=0.05",
    "BILINEAR_ELASTIC": "R=0.1",
    "BILINEAR_SLACK": "R=0.1 SLACK=0.004",
    "CLOUGH": "R=0.05",
    "DEGRADING_BILINEAR": "R=0.1 ALFA=0.4",
    "ELASTIC": "",
    "ELASTO_PLASTIC": "",
    "FLAG_SHAPED": "R=0.05 BETA=0.7",
    "IMK_BILINEAR": CAP,
    "IMK_PEAK_ORIENTED": CAP,
    "IMK_PINCHING": CAP + " KAPPAF=0.3 KAPPAD=0.3",
    "MATSUSHIMA": "R=0.05 ALFA=0.95 BETA=0.9",
    "ORIGIN_CENTRED": "R=0.1",
    "Q_HYST": "R=0.05 ALFA=0.5",
    "RING_SPRING": "R=0.1 LOWER=0.4",
    "SINA": "R=0.05 ALFA=0.4 FCR=0.4 RHO=0.6 FCC=0.3",
    "TAKEDA": "R=0.05 ALFA=0.4 BETA=0.3",
    "TAKEDA_SLIP": "R=0.05 ALFA=0.4 FCR=0.4 RHO=0.6 SLIP=1 INNER=0.7",
    "TRILINEAR": "R=0.4 R2=0.05 F2=90",
    "WAYNE_STEWART": "R=0.2 FU=90 FI=10 PTRI=-0.05 PUNL=1.4 BETA=1.1 ALPHA=0.4",
}
CONTACTS = {
    "LINEAR": "K=1e5",
    "KELVIN_VOIGT": "K=1e5 E=0.3",
    "MAHMOUD_JANKOWSKI": "K=1e5 E=0.5",
    "BILINEAR_IMPACT": "K1=1e5 K2=3e4 DY=0.001",
    "TABLE": "DEPTHS=0.001,0.004,0.02 FORCES=80,81,300",
    "TABLE crushing, flat": "DEPTHS=0.001,0.02 FORCES=80,80 KU=1e5",
}


def storeys(law: str = BILINEAR, contact: str = TOUCH, damping: str = "") -> str:
    return STOREYS.format(law=law, contact=contact, damping=damping)


def linear_in_pieces(spec: Spec) -> bool:
    """Whether a law is linear between its changes of branch, and no rigid contact."""
    if not has_loop(spec):
        return False
    return not specimen(spec)[0].law.curved


#: rules that between them have all kinds of branches: hardening and falling, slack, pinched, re-centred
CHECKED = ("ELASTIC", "BILINEAR_SLACK", "FLAG_SHAPED", "IMK_PINCHING", "TAKEDA", "WAYNE_STEWART")
OTHERS = [s.name for s in catalog().family("hysteresis").values() if linear_in_pieces(s)]


@pytest.mark.parametrize("rule", [*CHECKED, *at_night(*(x for x in OTHERS if x not in CHECKED))])
def test_rules_that_are_linear_in_pieces(rule: str) -> None:
    force = "" if rule == "ELASTIC" else "FX=60 "
    given = RULES[rule] if rule in RULES else written(catalog().family("hysteresis")[rule], 60.0, 0.015)
    r, _ = agree(storeys(f"{force}RULE={rule} {given}"))
    assert len(r.tables["collisions"]) > 0


def further_contacts() -> dict[str, str]:
    """Items for the laws that are not among `CONTACTS`, and do not follow the rule of one of them."""
    family = catalog().family("contact")
    rules = {specimen(family[x.split()[0]])[0].law.rule for x in CONTACTS}
    further = {}
    for spec in family.values():
        if linear_in_pieces(spec) and specimen(spec)[0].law.rule not in rules:
            stiffness = spec.field("K")
            k = "K=1e5 " if stiffness is not None and stiffness.default is REQUIRED else ""
            further[spec.name] = k + written(spec, 80.0, 0.001)
    return further


@pytest.mark.parametrize("law", [*CONTACTS, *further_contacts()])
def test_contacts_that_are_linear_in_pieces(law: str) -> None:
    # where the force stays the same no one knows the time of its peak
    where = math.inf if "flat" in law else 1e-6
    r, _ = agree(
        storeys(contact=f"LAW={law.split()[0]} {(CONTACTS | further_contacts())[law]}"), where=where
    )
    assert len(r.tables["collisions"]) > 2 and r.column("contact_summary", "impulse").min() > 0


@pytest.mark.parametrize("stiffness", ["TANGENT", "SECANT"])
def test_damping_that_follows_the_stiffness(stiffness: str) -> None:
    r, _ = agree(storeys(damping=f"STIFFNESS={stiffness}"))
    assert r.column("spring_envelope", "yield_events").min() >= 2


# ---------------------------------------------------------------- reduced systems

FRAMES = """UNITS kN m s
{head}
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 4 3
 4 4 0 FIX=XYR
 5 4.02 3 FIX=YR
 6 4.02 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 COL 4 3
 3 BEAM 2 3
 4 SIDE 5 6
 5 MEET 3 5
PROPS
 COL FRAME E=2E7 A=0.09 I=0.0007 {hinge}
 BEAM FRAME E=2E7 A=0.09 I=0.0005
 SIDE SPRING KX=4000 FX=50 RULE=BILINEAR R=0.05
 MEET CONTACT GAP=0.02 ANGLE=0 LAW=KELVIN_VOIGT K=60000 E=0.6
WEIGHTS
 2,3 150 150 {turn}
 5 250 0
DAMPING
 RAYLEIGH ALPHA=0.4 BETA=0.001
DRIFT
 "frame" 1 2
 "other" 6 5
LOADS
 2,3 0 -400
{load}
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 2
"""
SHAKEN = "EQUAKE\n SINE AMPLITUDE=6 PERIOD=0.4 DURATION=1.2"


def frames(head="", hinge="", turn="0.5", load=SHAKEN) -> str:  # type: ignore[no-untyped-def]
    return FRAMES.format(head=head, hinge=hinge, turn=turn, load=load)


HINGE = "RULE=BILINEAR R=0.05 MI=60 MJ=60 KH=2E5"
LOADS = {
    "one motion of the ground": SHAKEN,
    "supports apart": "EQUAKE\n SINE AMPLITUDE=6 PERIOD=0.4 DURATION=1.2 SUPPORTS=1,4\n"
    " TABLE POINTS=0,0,0.3,4,0.5,-5,1,0.5,2,0 SUPPORTS=6",
    "forces": "FORCES\n TABLE 2 90 POINTS=0,0,0.2,1,0.2,-1,0.5,0.3,1,0\n SINE 5 60 OMEGA=9",
    "forces and supports": "EQUAKE\n SINE AMPLITUDE=4 PERIOD=0.4 SUPPORTS=1,4\n"
    " TABLE POINTS=0,1,2,-1 SUPPORTS=6\nFORCES\n SINE 3 50 -20 5 PERIOD=0.21\n SINE 5 -120 PERIOD=0.5",
    "thrown": "INITIAL\n 2,3 VX=0.9 VR=0.1\n 5 UX=0.03 VX=-0.5",
    "let go": "LOADS\n 2 400 HELD=NO",
}


@pytest.mark.parametrize(
    "load",
    [
        "forces and supports",
        *at_night("one motion of the ground", "forces", "supports apart", "thrown", "let go"),
    ],
)
def test_what_moves_a_frame(load: str) -> None:
    r, _ = agree(frames(load=LOADS[load]))
    assert len(r.tables["collisions"]) > 0 and r.column("spring_envelope", "yield_events").sum() > 0


@each_once(
    ("head", ["GEOMETRY PDELTA", "GEOMETRY PDELTA_MEMBER", "MASS CONSISTENT"]),
    ("load", ["one motion of the ground", "supports apart"]),
    at_most=2,
)
def test_geometry_and_mass_of_a_frame(head: str, load: str) -> None:
    deck = frames(head=head, load=LOADS[load])
    if head.startswith("MASS"):
        deck = deck.replace("I=0.0007", "I=0.0007 WGT=3").replace("I=0.0005", "I=0.0005 WGT=5")
    r, _ = agree(deck)
    plain = run_text(deck.replace(head, ""), None, "TAYLOR")
    assert np.abs(r.u - plain.u).max() > 1e-4


def test_rotations_without_mass_are_condensed() -> None:
    agree(frames(turn="0"))


def test_a_full_damping_matrix() -> None:
    agree(frames().replace("RAYLEIGH ALPHA=0.4 BETA=0.001", "MODAL XI=0.05"))


def test_soil_below_the_footings() -> None:
    """Monkey tails of cone models: DOFs with little mass beside buildings."""
    r, _ = agree(SOIL.format(foot="G=8e4 NU=0.33 WGT=19 B=2 L=2"))
    assert len(r.tables["collisions"]) > 0


def test_a_row_whose_storeys_yield_without_hardening() -> None:
    """Several storeys yield at once: floors that no stiffness holds beside buildings that move as one."""
    deck = """UNITS kN m s
GRAVITY 9.81
NODES
 100 0 0 FIX=XYR
 200 10 0 FIX=XYR
 300 20 0 FIX=XYR
 1 TO 4 0 1 TO 4 FIX=YR
 5 TO 8 10 1 TO 4 FIX=YR
 9 TO 12 20 1 TO 4 FIX=YR
ELEMENTS
 1 STIFF 100 1
 2 TO 4 STIFF 1 TO 3 2 TO 4
 5 SOFT 200 5
 6 TO 8 SOFT 5 TO 7 6 TO 8
 9 STIFF 300 9
 10 TO 12 STIFF 9 TO 11 10 TO 12
 21 TO 28 MEET 1 TO 8 5 TO 12
PROPS
 STIFF SPRING KX=4E5 FX=2000 RULE=ELASTO_PLASTIC
 SOFT SPRING KX=2.5E5 FX=1500 RULE=ELASTO_PLASTIC
 MEET CONTACT GAP=0.01 ANGLE=0 LAW=KELVIN_VOIGT K=2E6 C=0
WEIGHTS
 1 TO 12 2000
DAMPING
 RAYLEIGH ALPHA=0.5 BETA=0.001
EQUAKE
 SYNTHETIC PGA=4 SEED=5 DURATION=10
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 10
"""
    r, _ = agree(deck)
    assert len(r.tables["collisions"]) > 30


def test_cables_that_go_slack() -> None:
    deck = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=R
 3 4 0 FIX=XYR
 4 -4 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 T 3 2
 3 T 4 2
PROPS
 COL FRAME E=2E7 A=0.09 I=0.0002
 T TENDON E=2E8 A=1E-4 SLACK=0.001
WEIGHTS
 2 200 200
EQUAKE
 SINE AMPLITUDE=6 PERIOD=0.4 DURATION=2
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 2
"""
    agree(deck)


@pytest.mark.parametrize(
    "given", [{"light": 1e-8, "k": 1}, {"light": 1e-4, "c": 0.1}, {"light": 0.01, "c": 1e3}]
)
def test_a_node_of_little_mass(given: dict[str, float]) -> None:
    """Far faster than all else, by its spring or its dashpot; its own speed is sqrt(M/m) less exact."""
    deck = """UNITS N m s
PARAM light=1  k=1000  c=0
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
 9 3 0 FIX=XYR
ELEMENTS
 1 A 1 2
 2 B 2 3
 3 D 2 3
 4 W 3 9
PROPS
 A SPRING KX=30 FX=2 RULE=BILINEAR R=0.1
 B SPRING KX=k
 D DASHPOT CX=c
 W CONTACT GAP=0.1 LAW=KELVIN_VOIGT K=2000 E=0.5
WEIGHTS
 2 1
 3 light
EQUAKE
 SINE AMPLITUDE=3 PERIOD=1.1 DURATION=2
OUTPUT
 EVERY=1
ANALYSIS
 HISTORY 2
"""
    agree(deck, 1e-8, **given)


def test_a_ball_comes_to_rest_on_the_floor() -> None:
    """It bounces lower and lower, and is pressed for good in the end."""
    deck = """UNITS N m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XR
ELEMENTS
 1 FLOOR 1
PROPS
 FLOOR CONTACT GAP=0.1 ANGLE=-90 LAW=KELVIN_VOIGT K=2E5 E=0.6
WEIGHTS
 1 0 9.81
LOADS
 1 FY=-9.81
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 3 FROM=REST
"""
    r, _ = agree(deck)
    assert len(r.tables["collisions"]) > 3 and r.force[-1, 0] == pytest.approx(9.81, rel=1e-9)
    # nothing moves any more
    assert np.abs(r.v[-1]).max() < 1e-12


def test_balls_that_touch_at_one_instant() -> None:
    """A row of five, one thrown at it; then one at each end."""
    deck = """UNITS N m s
GRAVITY 1
NODES
 1 TO 5 0 TO 0.4 0 FIX=YR
ELEMENTS
 1 TO 4 HIT 1 TO 4 2 TO 5
PROPS
 HIT CONTACT GAP=0 ANGLE=0 LAW=KELVIN_VOIGT K=1E4 E=0.9
WEIGHTS
 1 TO 5 1
INITIAL
 1 VX=1
 5 VX={v}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 1
"""
    agree(deck.format(v=0).replace("GAP=0", "GAP=0.001"))
    for v in (0, -1):
        r, e = (run_text(deck.format(v=v), None, method) for method in ("TAYLOR", "EXACT"))
        assert np.abs(r.v - e.v).max() < 1e-12 and np.abs(r.force - e.force).max() < 1e-10
    assert np.abs(r.v[:, ::-1, 0] + r.v[:, :, 0]).max() < 1e-12


# ---------------------------------------------------------------- examples


@pytest.mark.parametrize(
    "deck",
    [
        "01_two_oscillators/two_oscillators",
        "verification/cradle/cradle",
        *at_night(
            "cole2011/lumped",
            "cole2011/equivalent",
            "cole2011/distributed",
            *(f"verification/{x}" for x in ("sdof/linear", "sdof/slack", "sdof/yielding", "sdnd102/pair")),
            *(f"verification/{x}" for x in ("two_bars/two_bars", "unit_impact/wall")),
        ),
    ],
)
def test_examples(deck: str) -> None:
    path = ROOT / "examples" / f"{deck}.inp"
    r, e = (run_deck(path, None, method) for method in ("TAYLOR", "EXACT"))
    for name in ("u", "v", "a", "force"):
        a, b = getattr(r, name), getattr(e, name)
        assert np.abs(a - b).max(initial=0.0) <= 1e-9 * np.abs(b).max(initial=0.0), name
    for table, columns in (
        ("drift_envelope", ("max", "min")),
        ("contact_summary", ("peak_force", "impulse", "energy_lost")),
        ("spring_envelope", ("force_max", "force_min", "plastic_work", "yield_events")),
    ):
        for name in columns if table in e.tables else ():
            want = e.column(table, name)
            size = np.abs(want).max(initial=0.0)
            assert np.abs(r.column(table, name) - want).max(initial=0.0) <= 1e-10 * size, (table, name)
    assert r.check() < 1e-12


# ---------------------------------------------------------------- repeated, taken up again


def test_a_run_returns_to_the_bit() -> None:
    a, b = (run_text(frames(), None, "TAYLOR") for _ in range(2))
    for name in ("u", "v", "a", "force"):
        assert np.array_equal(getattr(a, name), getattr(b, name))
    for table in ("collisions", "spring_envelope", "drift_envelope", "node_envelope", "energy"):
        assert repr(a.tables[table].tolist()) == repr(b.tables[table].tolist())


@FAST
def test_interpreted_kernels_give_the_same_numbers() -> None:
    deck = frames().replace("HISTORY 2", "HISTORY 0.7")
    fast = run_text(deck, None, "TAYLOR")
    assert len(fast.tables["collisions"]) > 0
    with interpreted():
        slow = run_text(deck, None, "TAYLOR")
    same(slow, fast, 1e-11)


def test_envelopes_see_the_jump_at_a_touch_between_two_outputs() -> None:
    """The dashpot of the stop acts at once, with c v, and is never pressed harder afterwards."""
    deck = OSCILLATOR.replace("E=0.7", "E=0.05")
    r = run_text(deck, {"gap": 0.3, "every": 3, "w": 8}, "TAYLOR")
    hit = r.tables["collisions"][0]
    assert hit["t_peak"] == hit["t_start"]
    (low,) = [
        x["min"] for x in r.tables["node_envelope"] if (str(x["node"]), x["quantity"][0]) == ("2", "a")
    ]
    v, c = hit["approach_velocity"], r.column("contact_laws", "c")[0]
    assert low == pytest.approx(-(64 * 0.3 + 2 * 0.05 * 8 * v + c * v), rel=1e-9)


# ---------------------------------------------------------------- stops


def test_a_curved_contact_at_a_node_without_mass_is_refused_in_words() -> None:
    deck = OSCILLATOR.replace(" 2 STOP 2\n", " 2 STOP 3\n 4 K 2 3\n")
    deck = deck.replace("ELEMENTS", " 3 2 0 FIX=YR\nELEMENTS").replace("LAW=KELVIN_VOIGT", "LAW=HERTZ")
    r = run_text(deck.replace(" E=0.7", ""), None, "TAYLOR")
    assert r.status == "stopped" and r.message.startswith("A505 at t = 0 s"), r.message
    assert "the law HERTZ of element 2 is curved and meets a node without mass" in r.message


def test_members_that_turn_are_refused() -> None:
    r = run_text(frames(head="GEOMETRY LARGE"), None, "TAYLOR")
    assert r.message.startswith("A505") and "GEOMETRY LARGE" in r.message, r.message


def test_a_light_stiff_node_for_a_long_time_is_told_early(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(taylor, "MAX_STEPS", 200_000)
    r = run_text(OSCILLATOR, {"w": 1e6, "end": 30, "gap": 99, "xi": 1e-6}, "TAYLOR")
    assert r.message.startswith("A502"), r.message
    assert r.message.endswith("which LAGUERRE and NEWMARK need not follow")


def test_a_mode_beyond_all_clocks_is_told() -> None:
    r = run_text(OSCILLATOR, {"w": 1e15, "gap": 99}, "TAYLOR")
    assert r.message.startswith("A502") and "requires" in r.message, r.message


def test_growth_without_bound_names_no_time_step() -> None:
    deck = OSCILLATOR.replace("DAMPING\n RAYLEIGH XI=xi OMEGA=w,3*w PROPS=K\n", "")
    deck = deck.replace("LESS SPRING KX=k", "LESS SPRING KX=k FX=0.1 RULE=BILINEAR R=-29/25")
    r = run_text(deck.replace("VX=2", "VX=-2"), {"k": 25, "gap": 99, "end": 5}, "TAYLOR")
    assert r.message.startswith("A504") and "grows without bound" in r.message and "DT" not in r.message


def test_changes_at_one_instant_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Were every change taken for one of the same instant, the first reduced system that has many would
    stop.
    """
    monkeypatch.setattr(branches, "SAME_INSTANT", 10.0)
    with interpreted():
        r = run_text(storeys().replace("KX=500", "KX=500 FX=1 RULE=BILINEAR R=0.5"), None, "TAYLOR")
    assert r.message.startswith("A503") and "changes at one instant, the last in element" in r.message
    assert "EVENTS=STEPPED" in r.message and "DT" not in r.message
