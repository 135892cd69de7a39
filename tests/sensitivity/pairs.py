"""Generated pairs of small buildings that yield and pound, with PARAMs of 1 as factors of their numbers."""

from __future__ import annotations

import random
import re

from verification.generated import decks, laws

MOST_DRAWS = 20
HEAD = "UNITS kN m s\n"
#: items that a PARAM multiplies
SCALED = r"\b(KX|FX|R|E|I|MI|GAP|K|AMPLITUDE|ALPHA|BETA|LP|PGA)=(-?[\d.]+(?:[eE][+-]?\d+)?)(?=\s|$)"


def deck(seed: int, count: int) -> tuple[str, list[str]]:
    """Text of a deck, and the names of its PARAMs, `count` of them at most."""
    rng = random.Random(seed)
    for _ in range(MOST_DRAWS):
        text = _shear_buildings(rng) if rng.random() < 0.6 else _frames(rng)
        with_params, names = _with_params(text, rng, count)
        if not decks.refused(with_params, None):
            return with_params, names
    raise RuntimeError(f"seed {seed}: {MOST_DRAWS} draws were all refused")


def _with_params(text: str, rng: random.Random, count: int) -> tuple[str, list[str]]:
    places = [m for m in re.finditer(SCALED, text) if float(m[2])]
    weights = list(re.finditer(r"(?m)^ \d+ (W) ([\d.]+)", text))
    chosen = rng.sample(places + weights, min(count, len(places)))
    names = []
    for m in sorted(chosen, key=lambda m: -m.start(2)):
        names.append(f"{m[1]}{len(names)}")
        text = f"{text[: m.end(2)]}*{names[-1]}{text[m.end(2) :]}"
    text = re.sub(r"(?m)^( \d+) W ", r"\1 ", text)
    return text.replace(HEAD, HEAD + "".join(f"PARAM {name} = 1\n" for name in names)), names


def _contact(rng: random.Random, force: float) -> str:
    """Items of a straight contact law that is not rigid."""
    while True:
        items = laws.contact(rng, force, 2e-3, 10.0 ** rng.uniform(4.5, 5.5), True)
        if not re.search("STEREOMECHANICS|LAGRANGE", items):
            return items


def _motion(rng: random.Random, length: float) -> str:
    kind = rng.random()
    if kind < 0.5:
        period = rng.uniform(0.3, 1.2)
        return f"SINE AMPLITUDE={rng.uniform(1.5, 5.0):.3f} PERIOD={period:.3f} DURATION={length:g}"
    return f"SYNTHETIC PGA={rng.uniform(3.0, 6.0):.3f} SEED={rng.randint(1, 9999)} DURATION={length:g}"


def _shear_buildings(rng: random.Random) -> str:
    """Two shear buildings of one to three floors, side by side."""
    nodes, elements, props, weights, drifts = [], [], [], [], []
    floors = [rng.randint(1, 3), rng.randint(1, 3)]
    number = 0
    for b, count in enumerate(floors, 1):
        x = 0.0 if b == 1 else 6.0
        nodes.append(f" {b}0 {x:g} 0 FIX=XYR")
        weight = rng.uniform(300.0, 900.0)
        stiffness = rng.uniform(5000.0, 30000.0)
        for i in range(1, count + 1):
            nodes.append(f" {b}{i} {x:g} {3 * i} FIX=YR")
            weights.append(f" {b}{i} W {weight * rng.uniform(0.8, 1.2):.2f}")
            force = rng.uniform(0.1, 0.3) * weight * (count - i + 1)
            number += 1
            elements.append(f" {number} C{b}{i} {b}{i - 1} {b}{i}")
            rule = laws.hysteresis(rng, force, force / stiffness, True) if rng.random() < 0.8 else ""
            strength = f" FX={force:.3f} {rule}" if rule else ""
            props.append(f" C{b}{i} SPRING KX={stiffness:.2f}{strength}")
            drifts.append(f' "{b} {i}" {b}{i - 1} {b}{i}')
    for i in range(1, min(floors) + 1):
        number += 1
        elements.append(f" {number} M{i} 1{i} 2{i}")
        gap = rng.uniform(0.002, 0.02)
        props.append(f" M{i} CONTACT GAP={gap:.5f} ANGLE=0 {_contact(rng, 300.0)}")
    damping = rng.choice(
        (" RAYLEIGH ALPHA=0.3 BETA=0.002", " RAYLEIGH XI=0.05 MODES=1,2", " RAYLEIGH ALPHA=0.5")
    )
    if rng.random() < 0.3:
        damping += " STIFFNESS=TANGENT" if "BETA" in damping or "XI" in damping else ""
    return _text(nodes, elements, props, weights, drifts, damping, _motion(rng, 3.0), 3.0)


def _frames(rng: random.Random) -> str:
    """Two frames of one storey with hinges at joints without rotational mass."""
    hinge = ""
    if rng.random() < 0.8:
        moment = rng.uniform(30.0, 90.0)
        hinge = f" MI={moment:.3f} MJ={moment:.3f} LP=0.3 {laws.hysteresis(rng, moment, 3e-4, True)}"
    nodes = [
        " 1 0 0 FIX=XYR", " 2 6 0 FIX=XYR", " 3 0 3", " 4 6 3",
        " 11 6.02 0 FIX=XYR", " 12 12 0 FIX=XYR", " 13 6.02 3", " 14 12 3",
    ]  # fmt: skip
    elements = [
        " 1 A 1 3",
        " 2 A 2 4",
        " 3 G 3 4",
        " 11 S 11 13",
        " 12 S 12 14",
        " 13 G 13 14",
        " 99 M 4 13",
    ]
    props = [
        f" A FRAME E=2E7 A=0.16 I=0.002{hinge}",
        f" S FRAME E=2E7 A=0.16 I={rng.uniform(0.002, 0.006):.5f}",
        " G FRAME E=2E7 A=0.2 I=0.004",
        f" M CONTACT GAP={rng.uniform(0.003, 0.015):.5f} ANGLE=0 {_contact(rng, 300.0)}",
    ]
    turn = rng.choice(("", " W2"))
    weights = [
        f" {n} W {rng.uniform(150.0, 300.0):.2f}{turn.replace('W2', ' 200 0.5')}" for n in (3, 4, 13, 14)
    ]
    damping = rng.choice((" RAYLEIGH ALPHA=0.4 BETA=0.001", " RAYLEIGH ALPHA=0.4"))
    drifts = [' "left" 1 3', ' "right" 11 13']
    return _text(nodes, elements, props, weights, drifts, damping, _motion(rng, 1.5), 1.5)


def _text(
    nodes: list[str], elements: list[str], props: list[str], weights: list[str], drifts: list[str],
    damping: str, motion: str, length: float,
) -> str:  # fmt: skip
    sections = {
        "NODES": nodes, "ELEMENTS": elements, "PROPS": props, "WEIGHTS": weights, "DAMPING": [damping],
        "DRIFT": drifts, "EQUAKE": [f" {motion}"], "ANALYSIS": [f" HISTORY {length:g} METHOD=EXACT"],
    }  # fmt: skip
    return HEAD + "".join(f"{name}\n" + "\n".join(lines) + "\n" for name, lines in sections.items())
