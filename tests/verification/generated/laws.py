"""Hysteresis rules and contact laws with random items, from their Specs: a new one comes in by itself."""

from __future__ import annotations

import random
from functools import cache
from typing import Final

from pound_deck.schema import Field, Kind, Spec
from pound_solve.assess import law_test
from pound_solve.catalog import catalog

WHOLE_LOSS: Final = "ILOS"  #: word that needs three more items, which no Spec can say
SPREAD: Final = 1.4  #: largest factor on a number of a Spec's sample
#: items that a law needs beyond its sample, with their values in units of the law's own force and length
NEEDED: Final = {"K": 1.0}


@cache
def choices(family: str, straight: bool) -> list[Spec]:
    """Rules or laws of a family, all or those alone that are linear in pieces."""
    found = [s for s in catalog().family(family).values() if s.impl is not None]
    return [s for s in found if not (straight and _curved(s))]


def _curved(spec: Spec) -> bool:
    """Whether a law is curved; a rigid one, of which there is no specimen, is not."""
    try:
        return law_test.specimen(spec)[0].law.curved
    except law_test.LawTestError:
        return False


def hysteresis(
    rng: random.Random, force: float, deformation: float, straight: bool, carries: bool = False
) -> str:
    """Items RULE and its own of a hinge or spring that yields at a force and a deformation; `carries`
    is for columns.
    """
    specs = choices("hysteresis", straight)
    # columns on hinges with slack, or on hinges of one side, are a mechanism, which gravity overturns
    loose = [s for s in specs if "SLACK" in s.sample or s.name == "MASONRY_STRUT"]
    spec = rng.choice([s for s in specs if not (carries and s in loose)])
    words = [f"RULE={spec.name}", *items(rng, spec, force, deformation)]
    loss = spec.field(WHOLE_LOSS)
    if loss and "GROW=NO" not in words and rng.random() < 0.3:
        begin = rng.uniform(1.5, 4.0)
        forms = [word for word in ("EACH", "LARGEST") if word in loss.words]
        words += [f"ILOS={rng.choice(forms)} DUCT1={begin:.3g}"]
        words += [f"DUCT2={begin * rng.uniform(1.5, 4.0):.3g} RDUCT={rng.uniform(0.5, 0.9):.3g}"]
    return " ".join(words)


def contact(rng: random.Random, force: float, depth: float, slab: float, straight: bool) -> str:
    """Items LAW and its own of a contact whose force is `force` at the overlap `depth`; where its law is
    for diaphragms, these get stiffnesses about `slab`.
    """
    spec = rng.choice(choices("contact", straight))
    words = [f"LAW={spec.name}", *items(rng, spec, force, depth)]
    if spec.field("MODEL"):
        words.append(f"DIAPHRAGMS={slab * rng.uniform(0.5, 2.0):.4g},{slab:.4g}")
    return " ".join(words)


def items(rng: random.Random, spec: Spec, force: float, deformation: float) -> list[str]:
    """Items of a Spec's sample, scaled from yield (or contact) at one and one, each number a little other;
    now and then one of its other words.
    """
    sample = dict(item.split("=") for item in spec.sample.split())
    for name, value in NEEDED.items():
        if spec.field(name) and name not in sample:
            sample[name] = str(value)
    power = float(sample.get("N", _default(spec.field("N"), 1.5)))
    out = []
    for field in spec.fields:
        if field.name in sample and field.kind is Kind.WORD:
            out.append(f"{field.name}={rng.choice(field.words)}")
        elif field.name in sample:
            scale = _scale(field.unit, force, deformation, power)
            factor = 1.0 if field.name == "N" else SPREAD ** rng.uniform(-1.0, 1.0)
            out.append(f"{field.name}={_numbers(field, sample[field.name], scale, factor)}")
        elif field.kind is Kind.WORD and field.name != WHOLE_LOSS and rng.random() < 0.2:
            out.append(f"{field.name}={rng.choice(field.words)}")
    return out


def _default(field: Field | None, otherwise: float) -> float:
    """Default of an item, if it has one."""
    return field.default if field is not None and isinstance(field.default, float) else otherwise


def _scale(unit: str, force: float, length: float, power: float) -> float:
    """Factor from the unit one to that of a force and a length; `power` is the exponent N."""
    if unit.startswith("F/L^"):
        exponent = unit.removeprefix("F/L^")
        return float(force / length ** (power if exponent == "N" else float(exponent)))
    return {"F": force, "L": length, "F/L": force / length}.get(unit, 1.0)


def _numbers(field: Field, text: str, scale: float, factor: float) -> str:
    """Numbers of a sample, scaled, and multiplied by a factor as far as the item's limits allow."""
    found = []
    for x in map(float, text.split(",")):
        value = x * factor
        low, high = (
            next((y for y in pair if y is not None), end)
            for pair, end in (((field.lo, field.above), -1e300), ((field.hi, field.below), 1e300))
        )
        found.append(f"{scale * (value if low < value < high else x):.5g}")
    return ",".join(found)
