"""Outline -> Model: every section is bound, numbers and labels are distinguished, defaults filled in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from pound_deck.bind import Binder
from pound_deck.cards import Item, Row
from pound_deck.diagnostics import Diagnostic, Mistake, hints
from pound_deck.expressions import Expression, Value
from pound_deck.model import Card, Element, Model, Node, Span, Units
from pound_deck.outline import FAMILIES, NAMES, Outline
from pound_deck.schema import Catalog, Field, Kind, Spec
from pound_deck.sections import SECTIONS
from pound_deck.values import Values

_SPECS: Final = {spec.name: spec for spec in SECTIONS}
_GRAVITY: Final = Field("GRAVITY", Kind.REAL, "L/T^2", doc="acceleration", above=0, positional=True)
_MASS: Final = Field(
    "MASS", Kind.WORD, doc="mass matrix of members", words=("LUMPED", "CONSISTENT"), positional=True
)
_GEOMETRY: Final = Field(
    "GEOMETRY",
    Kind.WORD,
    doc="what displacements do to equilibrium",
    words=("SMALL", "PDELTA", "PDELTA_MEMBER", "PDELTA_VARYING", "LARGE"),
    codes={"SMALL": 0, "PDELTA": 1, "LARGE": 2},
    positional=True,
)
_LENGTHS: Final = {"M": 9.81, "MM": 9810.0, "CM": 981.0, "FT": 32.174, "IN": 386.09}
_ALIKE: Final = 0.01  #: relative difference up to which two values of gravity count as equal
_QUANTITIES: Final = ("force", "length", "time")  #: whose units UNITS names
_TIMES: Final = ("S", "SEC")
_FORCES: Final = ("N", "KN", "MN", "KIP", "KIPS", "LB", "LBF", "KGF", "TF")


def build(
    outline: Outline,
    params: dict[str, Value | None],
    catalog: Catalog,
    files: Mapping[str, str],
    report: list[Diagnostic],
) -> tuple[Model, list[Card]]:
    """Model of all that could be bound, and every card in it."""
    units = _units(outline.single.get("UNITS"), report)
    heads = [row.items[0] for row in outline.sections["PROPS"] if row.items]
    binder = Binder(Values(catalog, params, frozenset(_plain_labels(heads)), units), report)
    bound = {name: _section(name, outline, binder) for name in NAMES}
    gravity = _single(Spec("card", "GRAVITY", "gravity", (_GRAVITY,)), outline, binder)
    mass = _single(Spec("card", "MASS", "mass of members", (_MASS,)), outline, binder)
    geometry = _single(Spec("card", "GEOMETRY", "displacements", (_GEOMETRY,)), outline, binder)
    output = bound["OUTPUT"] or (_default_output(),)
    nodes: dict[int, Node] = {}
    for card in bound["NODES"]:
        node = _node(card, report)
        _once(nodes, node.id, node, "P301", f"node {node.id}", card.place("NODE"), report)
    elements: dict[int, Element] = {}
    for card in bound["ELEMENTS"]:
        v = card.values
        element = Element(v["ELEMENT"], v["PROP"], v["I"], v["J"], card.span, v["NAME"])
        _once(elements, element.id, element, "P302", f"element {element.id}", card.place("ELEMENT"), report)
    props: dict[str, Card] = {}
    for card in bound["PROPS"]:
        _once(props, card.label, card, "P303", f"property set {card.label}", card.span, report)
    known = _default_gravity(units)
    if known and gravity is not None:
        report += _another_gravity(gravity, known, units, outline.single)
    if known is None and "GRAVITY" not in outline.single and bound["WEIGHTS"]:
        message = f"no value of gravity is known for {units.length} and {units.time}"
        report.append(Diagnostic("P319", message, bound["WEIGHTS"][0].span, "add GRAVITY with its value"))
    left = {"units": "UNITS", "gravity": "GRAVITY", "mass": "MASS", "geometry": "GEOMETRY"}
    model = Model(
        title=_title(outline.single.get("TITLE")),
        units=units,
        gravity=gravity if gravity is not None else known or 9.81,
        mass=mass or "LUMPED",
        geometry=geometry or "SMALL",
        params={name: value for name, value in params.items() if value is not None},
        nodes=nodes,
        elements=elements,
        props=props,
        weights=bound["WEIGHTS"],
        loads=bound["LOADS"],
        member_loads=bound["MEMBER_LOADS"],
        initial=bound["INITIAL"],
        drifts=bound["DRIFT"],
        damping=bound["DAMPING"],
        equake=bound["EQUAKE"],
        forces=bound["FORCES"],
        analyses=bound["ANALYSIS"],
        output=output[0],
        files=files,
        defaults=frozenset(key for key, card in left.items() if card not in outline.single),
    )
    return model, [card for cards in bound.values() for card in cards]


def _section(name: str, outline: Outline, binder: Binder) -> tuple[Card, ...]:
    rows = outline.sections[name]
    if name == "OUTPUT" and rows:  # all its lines are one card
        items = tuple(item for row in rows for item in row.items or ())
        card = binder.card(_SPECS[name], items, rows[0].span)
        return (card,) if card else ()  # nothing refers to OUTPUT, so it cannot be broken
    out: list[Card] = []
    for row in rows:
        found = _row(name, row, binder)
        if found is None:
            outline.broken.add(name)
        out += found or ()
    return tuple(out)


def _row(name: str, row: Row, binder: Binder) -> list[Card] | None:
    """Cards of a row: none where its range is empty, None where it has mistakes."""
    items = row.items or ()
    if name in _SPECS:
        cards = binder.cards(_SPECS[name], items, row.span, generate=name in ("NODES", "ELEMENTS"))
        if cards and name == "DRIFT":
            cards = [_labelled(card) for card in cards]
        return cards
    family = FAMILIES[name]
    specs = binder.read.catalog.family(family)
    codes = {s.code: s.name for s in specs.values() if s.code is not None}
    at = 1 if family == "element" else 0
    try:
        if len(items) <= at or any(item.name for item in items[: at + 1]):
            _no_kind(name, row, items, list(specs), binder)
            return None
        label = binder.read.label(items[0].parts[0], "PROPS") if at else ""
        if any(len(item.parts) > 1 for item in items[: at + 1]):
            _no_kind(name, row, items, list(specs), binder)
            return None
        kind = binder.read.choice(items[at].parts[0], specs, codes, "this card's kind")
    except Mistake as error:
        if error.diagnostic:
            binder.report.append(error.diagnostic)
        return None
    card = binder.card(specs[kind], items[at + 1 :], row.span, label)
    return [card] if card else None


def _no_kind(name: str, row: Row, items: Iterable[Item], kinds: list[str], binder: Binder) -> None:
    start = "a label and a kind of element" if name == "PROPS" else "its kind"
    hint = "kinds are " + ", ".join(kinds)
    binder.report.append(Diagnostic("P213", f"a line of {name} starts with {start}", row.span, hint))


def _labelled(card: Card) -> Card:
    return Card(card.spec, card.values, card.span, card.values["NAME"], card.laws, card.spans)


def _plain_labels(heads: Iterable[Item]) -> list[str]:
    parts = [item.parts[0] for item in heads]
    return [p.lone.text.upper() for p in parts if isinstance(p, Expression) and p.lone]


def _node(card: Card, report: list[Diagnostic]) -> Node:
    v = card.values
    if bool(v["SLAVED"]) != (v["MASTER"] is not None):
        there, needed = ("SLAVED", "MASTER") if v["SLAVED"] else ("MASTER", "SLAVED")
        message = f"node {v['NODE']} has {there}, but no {needed}"
        report.append(
            Diagnostic(
                "P308", message, card.place(there), "write SLAVED=XYR MASTER=node, or leave both out"
            )
        )
    slaved = dict.fromkeys(v["SLAVED"], v["MASTER"]) if v["MASTER"] is not None else {}
    return Node(v["NODE"], v["X"], v["Y"], v["FIX"], card.span, slaved)


def _once(
    table: dict[Any, Any],
    key: int | str,
    value: Any,
    code: str,
    what: str,
    span: Span,
    report: list[Diagnostic],
) -> None:
    if key in table:
        first = table[key].span
        report.append(
            Diagnostic(code, f"{what} is already given at {first.file}:{first.line}", span, "take one out")
        )
    else:
        table[key] = value


def _single(spec: Spec, outline: Outline, binder: Binder) -> Any:
    row = outline.single.get(spec.name)
    if row is None or row.items is None:
        return None
    card = binder.card(spec, row.items[1:], row.span)
    return card[spec.name] if card else None


def _units(row: Row | None, report: list[Diagnostic]) -> Units:
    if row is None or row.items is None:
        return Units()
    steps = [i.parts[0].lone if isinstance(i.parts[0], Expression) else None for i in row.items[1:]]
    words = [s.text for s in steps if s and s.kind == "word"]
    kinds = [_dimension(word.upper()) for word in words]
    right = all(kind in ("", want) for kind, want in zip(kinds, "FLT"))
    named = any(i.name or len(i.parts) > 1 for i in row.items)
    if named or len(words) != 3 or len(words) != len(steps) or not right:
        message = "UNITS takes the units of force, length and time, in this order"
        missing = _QUANTITIES[len(words) :] if right and len(words) == len(steps) else ()
        hint = hints(f"missing: {', '.join(missing)}" if missing else "", "for example UNITS kN m s")
        report.append(Diagnostic("P238", message, row.span, hint))
        return Units()
    force, length, time = words
    return Units(force, length, time, given=True)


def _dimension(word: str) -> str:
    return "F" if word in _FORCES else "L" if word in _LENGTHS else "T" if word in _TIMES else ""


def _default_gravity(units: Units) -> float | None:
    return _LENGTHS.get(units.length.upper()) if units.time.upper() in _TIMES else None


def _another_gravity(
    gravity: float, known: float, units: Units, single: Mapping[str, Row]
) -> Iterator[Diagnostic]:
    """GRAVITY as it is with another unit of length; `known` is that with the deck's own."""
    other = next((u for u, g in _LENGTHS.items() if math.isclose(gravity, g, rel_tol=_ALIKE)), "")
    if other and _LENGTHS[other] != known and (units.given or "UNITS" not in single):
        message = (
            f"GRAVITY is {gravity:g}, that of {other.lower()}, but the unit of length is {units.length}"
        )
        hint = f"in {units.length} it is {known:g}; or name the deck's own units in UNITS"
        items = single["GRAVITY"].items or ()
        yield Diagnostic("P342", message, items[1].span, hint, "warning")


def _title(row: Row | None) -> str:
    if row is None:
        return ""
    text = " ".join(row.line.text.split("\n")).strip()[len("TITLE") :].strip()
    quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" and text.count(text[0]) == 2
    return text[1:-1] if quoted else text


def _default_output() -> Card:
    spec = _SPECS["OUTPUT"]
    return Card(spec, {f.name: f.default for f in spec.fields}, Span("", 0, 0, 0))
