"""Identity of a saved state: all parts of a deck that affect the motion, as texts for comparison."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pound_deck.model import Card, Model
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import GroundMotion

MOTION = "motion"  #: first word of the parts that another earthquake changes


def identity(model: Model, motions: Sequence[GroundMotion], forces: Sequence[Force]) -> dict[str, str]:
    """Return the structure and loading of a deck as text: the name of each part and its values with all
    digits.
    """
    return dict(_parts(model, motions, forces))


def _parts(
    model: Model, motions: Sequence[GroundMotion], forces: Sequence[Force]
) -> Iterator[tuple[str, str]]:
    units = model.units
    yield "UNITS", f"{units.force} {units.length} {units.time}"
    yield "GRAVITY", repr(model.gravity)
    yield "GEOMETRY and MASS", f"{model.geometry} {model.mass}"
    for node in model.nodes.values():
        slaved = " ".join(f"{k}={v}" for k, v in sorted(node.slaved.items()))
        yield f"node {node.id}", f"x={node.x!r} y={node.y!r} FIX={node.fixed} {slaved}".strip()
    for e in model.elements.values():
        yield f"element {e.id}", f"{e.prop} {e.i} {e.j}"
    for label, card in model.props.items():
        yield f"property set {label}", _values(card)
    named = {"WEIGHTS": model.weights, "LOADS": model.loads, "MEMBER_LOADS": model.member_loads}
    for name, cards in {**named, "DAMPING": model.damping}.items():
        for number, card in enumerate(cards, 1):
            yield f"line {number} of {name}", _values(card)
    digests = [m.info.get("sha256", "") for m in motions] + [f.info.get("sha256", "") for f in forces]
    for number, card in enumerate((*model.equake, *model.forces), 1):
        yield f"{MOTION} {number}", _values(card, leave_out="FILE")
    yield f"{MOTION}s' records", " ".join(map(str, digests))


def _values(card: Card, leave_out: str = "") -> str:
    """Text of a card's kind and values."""
    values = (f"{k}={_text(v)}" for k, v in card.values.items() if k != leave_out and v is not None)
    return " ".join((card.spec.name, *values))


def _text(value: object) -> str:
    """Text of a value with all its digits and without blanks."""
    return ",".join(map(_text, value)) if isinstance(value, tuple) else str(value).replace(" ", "_")


def differences(present: Mapping[str, str], saved: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the name of every part that differs, with a text of its present and its saved value."""
    for name in dict.fromkeys((*present, *saved)):
        here, there = present.get(name, ""), saved.get(name, "")
        if here != there:
            a, b = here.split(), there.split()
            news, olds = [x for x in a if x not in b], [x for x in b if x not in a]
            yield name, f"{' '.join(news) or 'nothing'} here, {' '.join(olds) or 'nothing'} there"
