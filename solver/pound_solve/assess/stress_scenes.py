"""Stiff and extreme scenes for the stability matrix, as decks: every contact law, every hysteresis rule,
and linear scenes whose motion is known in closed form.

Laws are taken from the catalog with their own sample items, so a new one is covered by itself.  Masses are
weights (GRAVITY 1); the storey of unit mass has a period of 1.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from pound_deck.schema import Spec
from pound_solve.catalog import catalog
from pound_solve.numerics.types import Array

OMEGA: Final = 2.0 * math.pi
STOREY: Final = OMEGA**2  #: stiffness of the storey of unit mass
METHOD: Final = "@METHOD"  #: where the method's name and items go in a deck
STEP: Final = 1e-3


def every(t: Array, u: Array) -> Array:
    """All displacements."""
    return u


@dataclass(frozen=True)
class Case:
    """One deck of the matrix.

    Attributes
    ----------
    family : str
        ``contact``, ``hysteresis`` or ``linear``.
    scene, variant, law : str
        Row of the table; what is extreme; the law in it.
    deck : str
        Text with `METHOD` in place of the method.
    step : float
        DT of the methods that take steps [T].
    within : float
        Error of those allowed, as a share of the largest displacement.
    right : callable or None
        Displacements ux of the nodes of OUTPUT at some times, shape (n_times, n_nodes), in closed form; or
        what `compared` makes of them.
    compared : callable
        What is compared with the right one: of times and displacements, shape (n_times, n_nodes).
    like : tuple of str and float
        Deck whose displacements times the factor are the right ones; empty: the deck itself.
    files : mapping of str to str
        Files beside the deck.
    heavy : bool
        Left out of a quick run.
    """

    family: str
    scene: str
    variant: str
    law: str
    deck: str
    step: float = STEP
    within: float = 0.02
    right: Callable[[Array], Array] | None = None
    compared: Callable[[Array, Array], Array] = every
    like: tuple[str, float] = ("", 1.0)
    files: Mapping[str, str] = field(default_factory=dict)
    heavy: bool = False


def powers(unit: str, n: float) -> tuple[float, float]:
    """Powers of force and length in a unit of both, as F/L^1.5; N stands for `n`."""
    found = re.fullmatch(r"(F)?(?:(/?)L(?:\^([0-9.]+|N))?)?", unit)
    if not found or not unit:
        return 0.0, 0.0
    size = (n if found[3] == "N" else float(found[3] or 1.0)) if "L" in unit else 0.0
    return float(unit[0] == "F"), -size if found[2] else size


def items(spec: Spec, length: float = 1.0, force: float = 1.0, **given: float) -> str:
    """A law's sample items, and a stiffness K of 1 if it knows one, as if the units of length and force
    were `length` and `force`; items given that it knows replace its own.
    """
    own = dict(word.split("=", 1) for word in spec.sample.split())
    if spec.field("K") is not None:
        own["K"] = "1"
    exponent = spec.field("N")
    n = float(own.get("N", exponent.default)) if exponent is not None else 1.0
    for name, value in own.items():
        item = spec.field(name)
        f, x = powers(item.unit if item is not None else "", n)
        if f or x:
            own[name] = ",".join(repr(float(v) * force**f * length**x) for v in value.split(","))
    own |= {name: repr(value) for name, value in given.items() if spec.field(name) is not None}
    return " ".join([spec.name, *(f"{name}={value}" for name, value in own.items())])


def contact(spec: Spec, k: float, mass: float = 1.0, bodies: int = 2, **given: float) -> str:
    """A contact law with the items given, as stiff as a spring `k` for a unit `mass` at unit speed.

    Its overlap there is the unit of length of the sample items.  EQUIVALENT has its stiffness from its
    diaphragms: two alike collide without loss, as long as a spring of pi^2/8 of theirs does.
    """
    overlap = math.sqrt(mass / k)
    law = items(spec, overlap, k * overlap, **given)
    if spec.name == "EQUIVALENT":
        law += " DIAPHRAGMS=" + ",".join([repr(8.0 / math.pi**2 * k)] * bodies)
    return law


PAIR: Final = """UNITS kN {length} s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 1 0 FIX=XYR
 4 1 1 FIX=YR
ELEMENTS
 1 LEFT 1 2
 2 RIGHT 3 4
 3 MEET 2 4
PROPS
 LEFT SPRING KX={k1!r}
 RIGHT SPRING KX={k2!r}
 MEET CONTACT GAP={gap!r} ANGLE=0 LAW={law}
WEIGHTS
 2 1
 4 {mass!r}
{damping}INITIAL
 2 VX={speed!r}
{motion}ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=2,4
"""


def pair(law: str, **given: object) -> str:
    """Two storeys of which the left one meets the right one."""
    plain: dict[str, object] = {
        "length": "m", "k1": STOREY, "k2": STOREY, "gap": 0.05, "mass": 1.0, "damping": "", "speed": 1.0,
        "motion": "", "end": 0.6, "every": 0.02,
    }  # fmt: skip
    return PAIR.format(law=law, **{**plain, **given})


def damped(share: float) -> str:
    """Section DAMPING: `share` of critical at the storey's own period."""
    return f"DAMPING\n RAYLEIGH ALPHA={2.0 * share * OMEGA!r} BETA=0\n"


TWICE: Final = """GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 MEET 1 2
 2 MEET 2 3
PROPS
 MEET CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1,2,3 1
INITIAL
 1 VX=1
 3 VX=-1
ANALYSIS
 HISTORY 0.3 METHOD=@METHOD
OUTPUT
 EVERY=0.01
"""
BALL: Final = """GRAVITY 1
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 FLOOR 1
PROPS
 FLOOR CONTACT GAP={gap} ANGLE=0 LAW={law}
WEIGHTS
 1 1
LOADS
 1 FX=9.81
ANALYSIS
 HISTORY {end} METHOD=@METHOD FROM=REST
OUTPUT
 EVERY=0.01
"""
FREE: Final = """GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 MEET 1 2
PROPS
 MEET CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1,2 1
INITIAL
 1 VX=1
ANALYSIS
 HISTORY 1 METHOD=@METHOD
OUTPUT
 EVERY=0.1
"""
OBLIQUE: Final = """GRAVITY 1
NODES
 1 0 0 FIX=R
ELEMENTS
 1 FLOOR 1
PROPS
 FLOOR CONTACT GAP=0.05 ANGLE=90 LAW={law} MU=0.2 KT=1E6
WEIGHTS
 1 1
INITIAL
 1 VX=1 VY=1
ANALYSIS
 HISTORY 0.5 METHOD=@METHOD
OUTPUT
 EVERY=0.02
"""
CROWD: Final = """GRAVITY 1
NODES
 1 TO {n} 0 TO {n}-1 0 FIX=YR
ELEMENTS
 1 TO {n} STOREY 1 TO {n}
 {n}+1 TO 2*{n} WALL 1 TO {n}
PROPS
 STOREY SPRING KX={k!r}
 WALL CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1 TO {n} 1
INITIAL
 1 TO {n} VX=1
ANALYSIS
 HISTORY {end} METHOD=@METHOD
OUTPUT
 EVERY={end} NODES=1,{n}
"""
SPIKE: Final = "EQUAKE\n TABLE POINTS=0.01,0,0.010001,1E6,0.010002,0\n"
JUMP: Final = "EQUAKE\n TABLE POINTS=0.1,0,0.1,5,3,5\n"
ZEROS: Final = "EQUAKE\n TABLE POINTS=0,0,10,0\n"


OWN_LOSS: Final = ("TABLE", "BILINEAR_IMPACT")  #: what they lose depends on the depth of the impact


def last_speed(t: Array, u: Array) -> Array:
    """Mean velocities between the last two samples, shape (n_nodes,)."""
    return np.asarray((u[-1] - u[-2]) / (t[-1] - t[-2]))


def contacts(spec: Spec) -> Iterator[Case]:
    """Scenes with one contact law."""

    def law(ratio: float = 1e3, bodies: int = 2, **given: float) -> str:
        return contact(spec, ratio * STOREY, 1.0, bodies, **given)

    def case(scene: str, variant: str, deck: str, **given: object) -> Case:
        return replace(Case("contact", scene, variant, spec.name, deck), **given)  # type: ignore[arg-type]

    plain = law()
    for ratio in (1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12):
        yield case("contact stiffness over the storey's", f"{ratio:g}", pair(law(ratio)))
        span = 8.0 / math.sqrt(max(ratio, 1.0) * STOREY)  # of the impact, which the step resolves
        deck = pair(law(ratio), gap=0.1 * span, end=span, every=span / 20)
        yield case("the same, steps that resolve the impact", f"{ratio:g}", deck, step=span / 800)
    for mass in (1e-8, 1e-4, 1e4, 1e8):
        deck = pair(plain, mass=mass, k2=STOREY * mass)
        yield case("one mass over the other", f"{mass:g}", deck)
    yield case("massless node that is met", "no weight", pair(plain, mass=0.0))
    yield case("massless node that is met", "MASSES", pair(plain + " MASSES=1,1", mass=0.0))
    for gap in (0.0, 1e-12, -0.002):
        yield case("gap", f"{gap:g}", pair(plain, gap=gap))
    for e in (1.0, 0.5, 0.05) if spec.field("E") is not None else (1.0,):
        rebound = None if spec.name in OWN_LOSS else np.array([0.5 - 0.5 * e, 0.5 + 0.5 * e])
        told = None if rebound is None else lambda t, v=rebound: v
        deck = FREE.format(law=law(E=e))
        yield case(
            "free impact, speeds after it", f"e {e:g}", deck, step=1e-4, right=told, compared=last_speed
        )
    for name, values in (("E", (1.0, 1e-3, 0.0)), ("XI", (0.0, 1.0, 10.0)), ("C", (0.0, 1e6))):
        if spec.field(name) is not None and (spec.sample == "E=0.5" or name == "E"):
            for value in values:
                text = contact(spec, 1e3 * STOREY, 1.0, 2, **{name: value})
                if name != "E":
                    text = text.replace("E=0.5 ", "")
                # a strong dashpot's force rises and falls within a share of the impact
                yield case(
                    "restitution and dashpot of the contact", f"{name} {value:g}", pair(text),
                    step=STEP / (32 if name == "E" and value < 0.01 else 8),
                )  # fmt: skip
    for share in (0.0, 1.0, 10.0):
        deck = pair(plain, damping=damped(share))
        yield case("damping of the storeys over critical", f"{share:g}", deck)
    deck = TWICE.format(law=plain)
    yield case("two contacts at the same instant", "symmetric", deck, step=STEP / 2)
    swing = 1.0 / OMEGA
    for gap in (1.0 - 1e-3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9):
        yield case("a contact that grazes", f"{gap:.9f} of the swing", pair(plain, gap=gap * swing))
    asked = re.search(r"\bE=(\S+)", plain)
    lost, wall = 0.2 * (1.0 + (float(asked[1]) if asked else 1.0)), law(bodies=1)
    text = OBLIQUE.format(law=wall)
    told = None if spec.name in OWN_LOSS else lambda t, v=1.0 - lost: np.array([v])
    yield case("friction", "oblique impact", text, step=1e-4, right=told, compared=last_speed)
    for ratio, end in ((250.0, 6.0), (1e6, 3.0)):
        deck = BALL.format(gap=0.05, law=law(ratio, bodies=1), end=end)
        step = STEP / 16 if ratio < 1e3 else STEP  # what each of twenty bounces is off adds up
        yield case("a ball that comes to rest", f"stiffness {ratio:g}", deck, step=step)
    deck = BALL.format(gap=0, law=law(25.0, bodies=1), end=1.0)
    yield case("a ball that lies there", "gap 0", deck, step=STEP / 2)
    crowd = {"law": law(bodies=1), "k": STOREY}
    yield case("many contacts at once", "30", CROWD.format(n=30, end=0.3, **crowd))
    if spec.name == "KELVIN_VOIGT":  # the number tries the program, not the law; all do as two of them do
        decks = [CROWD.format(n=n, end=0.1, **crowd) for n in (10_000, 2)]
        yield case("many contacts at once", "10000", decks[0], like=(decks[1], 1.0), heavy=True)
    for step in (1e-9, 1e-5, 0.05, 1.0):
        end = min(0.6, 200 * step) if step < 1e-4 else max(0.6, 2 * step)
        deck = pair(plain, gap=min(0.05, 0.1 * end), end=end, every=end / 10)
        yield case("steps", f"{step:g}", deck, step=step)
    for length, scale in (("mm", 1e3), ("km", 1e-3)):
        own = contact(spec, 1e3 * STOREY / scale, mass=scale)
        deck = pair(own, length=length, k1=STOREY / scale, k2=STOREY / scale, gap=0.05 * scale,
                    mass=1.0, speed=scale)  # fmt: skip
        deck = deck.replace("GRAVITY 1", f"GRAVITY {scale!r}")
        yield case("units", length, deck, like=(pair(plain), scale))
    for name, motion in (("a spike", SPIKE), ("a step", JUMP), ("zeros", ZEROS)):
        deck = pair(plain, motion=motion, speed=0.0 if name != "zeros" else 1.0, k2=2 * STOREY, gap=0.01)
        yield case("records", name, deck)


STOREYS: Final = """UNITS kN {length} s
GRAVITY {g!r}
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 0 2 FIX=YR
ELEMENTS
 1 SPR 1 2
 2 SPR 2 3
PROPS
 SPR SPRING KX={k!r} FX={fy!r} RULE={rule}
WEIGHTS
 2 {middle!r}
 3 1
{damping}EQUAKE
 {motion}
ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=2,3
"""


def storeys(rule: str, **given: object) -> str:
    """Two storeys on springs of one rule, shaken by a sine close to their period."""
    plain: dict[str, object] = {
        "length": "m", "g": 1.0, "k": 2.6 * STOREY, "fy": 4.0, "middle": 1.0, "damping": "", "end": 2.0,
        "every": 0.05, "motion": "SINE AMPLITUDE=4 PERIOD=1 DURATION=30",
    }  # fmt: skip
    return STOREYS.format(rule=rule, **{**plain, **given})


def top(t: Array, u: Array) -> Array:
    """The last node's motion: of two springs in line that yield without hardening, with hardly any mass
    between, either may have the other's share.
    """
    return u[:, -1:]


def springs(spec: Spec) -> Iterator[Case]:
    """Scenes with one hysteresis rule."""

    def case(scene: str, variant: str, deck: str, **given: object) -> Case:
        return replace(Case("hysteresis", scene, variant, spec.name, deck), **given)  # type: ignore[arg-type]

    def rule(fy: float = 4.0, k: float = 2.6 * STOREY, **given: float) -> str:
        """Lengths and forces of the sample items are shares of what yielding begins at."""
        return items(spec, fy / k, fy, **given)

    plain = rule()
    for force in (0.0, 1e-9, 1e12):
        elastic = storeys("ELASTIC").replace("FX=4.0 RULE=ELASTIC", "") if force > 1.0 else ""
        if "SLACK=" in plain:  # as wide as the yield deformation: nothing holds
            elastic = ""
        deck = storeys(rule(force) if force else plain, fy=force)
        yield case("yield force", f"{force:g}", deck, like=(elastic, 1.0))
    for ratio in (1e-6, 1e-3, 1e3, 1e6, 1e12):
        k = 2.6 * STOREY * ratio
        deck = storeys(rule(k=k), k=k)
        step = STEP / 32 if ratio == 1e3 else STEP  # that follows the stiffer springs, or does not
        yield case("stiffness of the springs", f"{ratio:g}", deck, step=step, heavy=ratio > 1e5)
    for ratio in (0.0, 1e-8, 1e8):
        yield case(
            "mass of the middle over the top's", f"{ratio:g}", storeys(plain, middle=ratio),
            compared=top if ratio < 1.0 else every,
        )  # fmt: skip
    if spec.field("R") is not None:
        for r in (-0.05, -0.5):
            deck = storeys(rule(R=r), motion="TABLE POINTS=0,6,1,6", end=3.0)
            yield case("falling branch to collapse", f"R {r:g}", deck)
    if spec.field("DPC") is not None:
        deck = storeys(plain, motion="TABLE POINTS=0,6,1,6", end=3.0)
        yield case("falling branch to collapse", "capped", deck)
    deck = storeys(plain, end=20.0, every=0.5)
    yield case("resonance", "20 periods", deck, step=STEP / 8)  # what each period is off adds up
    for share in (1.0, 10.0):
        yield case("damping over critical", f"{share:g}", storeys(plain, damping=damped(share)))
    for name, motion in (("a spike", SPIKE), ("a step", JUMP), ("zeros", ZEROS)):
        yield case("records", name, storeys(plain, motion=motion.split("\n")[1]))
    for step in (1e-9, 1e-5, 0.1, 1.0):
        end = 200 * step if step < 1e-4 else max(2.0, 2 * step)
        deck, within = storeys(plain, end=end, every=end / 10), 0.02
        if step == 0.1:  # ten steps a period make it longer by (omega h)^2/12 = 3 %
            within = 0.05
        yield case("steps", f"{step:g}", deck, step=step, within=within)
    for length, scale in (("mm", 1e3), ("km", 1e-3)):
        k = 2.6 * STOREY / scale
        deck = storeys(rule(k=k), length=length, g=scale, k=k,
                       motion=f"SINE AMPLITUDE={4 * scale!r} PERIOD=1 DURATION=30")  # fmt: skip
        yield case("units", length, deck, like=(storeys(plain), scale))


ONE: Final = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
ELEMENTS
 1 SPR 1 2
PROPS
 SPR SPRING KX={k!r}
WEIGHTS
 2 {mass!r}
{more}ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=2
"""


def one(
    more: str, end: float = 3.0, every: float = 0.0437123456789, k: float = STOREY, mass: float = 1.0
) -> str:
    """One storey."""
    return ONE.format(more=more, end=end, every=every, k=k, mass=mass)


def swing(share: float, omega: float = OMEGA) -> Callable[[Array], Array]:
    """Free vibration after a unit velocity with a `share` of critical damping."""

    def motion(t: Array) -> Array:
        decay, w = share * omega, omega * math.sqrt(abs(1.0 - share * share))
        if share < 1.0:
            return np.asarray(np.exp(-decay * t) * np.sin(w * t) / w)[:, None]
        if share == 1.0:
            return np.asarray(np.exp(-decay * t) * t)[:, None]
        slow = -omega * omega / (decay + w)
        return np.asarray(np.exp(slow * t) * -np.expm1(-2 * w * t) / (2 * w))[:, None]

    return motion


KICK: Final = "INITIAL\n 2 VX=1\n"
TWO: Final = """GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 0 2 FIX=YR
ELEMENTS
 1 LOW 1 2
 2 HIGH 2 3
PROPS
 LOW SPRING KX={low!r}
 HIGH SPRING KX={high!r}
WEIGHTS
 2 {middle!r}
 3 {top!r}
INITIAL
 3 VX=1
ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=3
"""
LEANING: Final = """GEOMETRY {form}
NODES
 1 0 0 FIX=XYR
 2 0 1
ELEMENTS
 1 POST 1 2
PROPS
 POST FRAME E=1E6 A=1 I=1E-4
WEIGHTS
 2 9.81 9.81 0.001
LOADS
 2 FY={push!r} FX=0.001
ANALYSIS
 STATIC
 HISTORY 0.5 METHOD=@METHOD
OUTPUT
 NODES=2
"""


def linear() -> Iterator[Case]:
    """Linear scenes, whose motion is known."""

    def case(scene: str, variant: str, deck: str, **given: object) -> Case:
        return replace(Case("linear", scene, variant, "", deck), **given)  # type: ignore[arg-type]

    for share in (0.0, 0.05, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 10.0, 1e3, 1e6):
        deck = one(damped(share) + KICK)
        told = f"{share:.9g}"
        yield case("damping over critical", told, deck, right=swing(share), heavy=share > 1e5)
    for step in (1e-9, 1e-6, 1e-4, 0.01, 0.2, 1.0):
        end = 500 * step if step < 1e-5 else max(3.0, 3 * step)
        within = min(2.0 * (OMEGA * step) ** 2 * OMEGA * end / 12 + 1e-9, 0.05)
        deck = one(KICK, end=end, every=max(end / 20.3, min(step, 0.937)))
        yield case("steps", f"{step:g}", deck, step=step, within=within, right=swing(0.0))
    for k in (1e-6, 1e6, 1e12):
        w = OMEGA * math.sqrt(k)
        deck = one(KICK, k=STOREY * k, end=3 / math.sqrt(k), every=0.0437 / math.sqrt(k))
        yield case("stiffness", f"{k:g}", deck, step=1e-3 / math.sqrt(k), right=swing(0.0, w))
        deck = one(KICK, k=STOREY * k, end=3.0)
        yield case(
            "stiffness, step of the plain storey", f"{k:g}", deck, right=swing(0.0, w), heavy=k > 1e9
        )
    for length, scale in (("mm", 1e3), ("km", 1e-3)):
        deck = one(KICK.replace("1", repr(scale)), k=STOREY / scale).replace("kN m s", f"kN {length} s")
        deck = deck.replace("GRAVITY 1", f"GRAVITY {scale!r}")
        yield case("units", length, deck, right=lambda t, x=scale: x * swing(0.0)(t))
    for ratio in (1e-8, 1e-4, 1e4, 1e8):
        deck = TWO.format(low=STOREY, high=STOREY, middle=ratio, top=1.0, end=1.0, every=0.05)
        yield case("one mass over the other", f"{ratio:g}", deck)
    for ratio in (1e-8, 1.0, 1e6, 1e12):
        deck = TWO.format(low=STOREY * ratio, high=STOREY, middle=0.0, top=1.0, end=1.0, every=0.05)
        w = OMEGA * math.sqrt(ratio / (1.0 + ratio))
        yield case("massless node", f"stiffness {ratio:g}", deck, right=swing(0.0, w))
    free = TWO.format(low=STOREY, high=STOREY, middle=1.0, top=1.0, end=3.0, every=0.1)
    free = free.replace(" 1 LOW 1 2\n", "").replace(" 3 VX", " 2,3 VX")
    yield case("rigid-body modes", "moving on", free, right=lambda t: t[:, None])
    pushed = free.replace("ANALYSIS", "LOADS\n 2,3 FX=2\nANALYSIS").replace("METHOD=", "FROM=REST METHOD=")
    yield case("rigid-body modes", "pushed", pushed, right=lambda t: (t + t * t)[:, None])
    for share in (0.0, 1.0):
        deck = one(damped(share) + "INITIAL\n 2,3 VX=1\n").replace(
            "ELEMENTS", " 3 1 1 FIX=YR\nELEMENTS\n 2 SPR 1 3"
        )
        deck = deck.replace(" 2 1.0\n", " 2,3 1.0\n").replace("NODES=2\n", "NODES=2,3\n")
        yield case(
            "repeated eigenvalues", "defective" if share else "undamped", deck,
            right=lambda t, s=share: np.tile(swing(s)(t), 2),
        )  # fmt: skip
    sine = f"EQUAKE\n SINE AMPLITUDE=1 OMEGA={OMEGA!r} DURATION=1000\n"
    yield case(
        "resonance", "50 periods", one(sine, end=50.0, every=0.125), within=5e-3,
        right=lambda t: (-(np.sin(OMEGA * t) - OMEGA * t * np.cos(OMEGA * t)) / (2 * STOREY))[:, None],
    )  # fmt: skip
    yield case("records", "zeros", one(ZEROS), right=lambda t: 0.0 * t[:, None])
    area = 1.0  # of the spike
    yield case(
        "records", "a spike", one(SPIKE, every=0.1), within=0.03,
        right=lambda t: -area * np.where(t > 0.01, np.sin(OMEGA * (t - 0.010001)) / OMEGA, 0.0)[:, None],
    )  # fmt: skip
    yield case(
        "records", "a step", one(JUMP, every=0.1, end=2.5), within=1e-3,
        right=lambda t: np.where(t > 0.1, -5 * (1 - np.cos(OMEGA * (t - 0.1))) / STOREY, 0.0)[:, None],
    )  # fmt: skip
    point = 'EQUAKE\n RECORD FILE="point.txt" FORMAT=COLUMNS DT=0.01 UNIT=DECK\n'
    yield case("records", "one point", one(point), files={"point.txt": "1.0\n"})
    n = 1_000_000
    long = 'EQUAKE\n RECORD FILE="long.txt" FORMAT=COLUMNS DT=0.00001 UNIT=DECK\n'
    text = "\n".join(f"{math.sin(3 * OMEGA * i * 1e-5):.17g}" for i in range(n + 1))
    r = 3 * OMEGA
    yield case(
        "records", "a million points", one(long, end=10.0, every=0.437),
        heavy=True, files={"long.txt": text},
        right=lambda t: (-(np.sin(r * t) - 3 * np.sin(OMEGA * t)) / (STOREY - r * r))[:, None],
    )  # fmt: skip
    for form in ("PDELTA", "PDELTA_MEMBER", "PDELTA_VARYING", "LARGE"):
        for share in (0.999, 1.001, 50.0):
            euler = math.pi**2 / 4 * 100
            yield case(
                "axial load over Euler's",
                f"{form} {share:g}",
                LEANING.format(form=form, push=-share * euler),
            )


def cases(families: tuple[str, ...] = ("linear", "contact", "hysteresis")) -> Iterator[Case]:
    """All cases of some families."""
    if "linear" in families:
        yield from linear()
    for family, scenes in (("contact", contacts), ("hysteresis", springs)):
        if family in families:
            for spec in catalog().family(family).values():
                if spec.impl is not None:
                    yield from scenes(spec)
