"""Outline -> Model: every section is bound, numbers and labels are distinguished, defaults filled in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Final

from pound_deck.bind import Binder
from pound_deck.cards import Item, ParsedLine
from pound_deck.diagnostics import Diagnostic, Mistake, hints, mistake
from pound_deck.expressions import Expression, ExpressionStep, Value
from pound_deck.model import Card, Element, Model, Node, Span, Units
from pound_deck.outline import Outline
from pound_deck.schema import Catalog
from pound_deck.sections import CARDS, FAMILIES, NAMES, SECTIONS
from pound_deck.values import Values

_SPECS: Final = {spec.name: spec for spec in (*SECTIONS, *CARDS)}
_LENGTHS: Final = {"M": 9.81, "MM": 9810.0, "CM": 981.0, "FT": 32.174, "IN": 386.09}
_ALIKE: Final = 0.01  #: relative difference up to which two values of gravity count as equal
_DIRECTIONS: Final = "XYR"  #: letters of FIX and SLAVED, in the order of a node
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
    """Build the model from all rows that could be bound; also return every card."""
    units = units_of(outline.single.get("UNITS"), report)
    heads = [row.items[0] for row in outline.sections["PROPS"] if row.items]
    binder = Binder(Values(catalog, params, frozenset(_plain_labels(heads)), units), report)
    bound = {name: _section(name, outline, binder) for name in NAMES}
    gravity = _single("GRAVITY", outline, binder)
    mass = _single("MASS", outline, binder)
    geometry = _single("GEOMETRY", outline, binder)
    meant = _single("MEANT", outline, binder)
    output = bound["OUTPUT"] or (_default_output(),)
    nodes = _nodes(bound["NODES"], report)
    elements = _elements(bound["ELEMENTS"], report)
    props = _props(bound["PROPS"], report)
    report += _doubtful_gravity(gravity, units, outline.single, bound["WEIGHTS"])
    left = {"units": "UNITS", "gravity": "GRAVITY", "mass": "MASS", "geometry": "GEOMETRY"}
    model = Model(
        title=_title(outline.single.get("TITLE")),
        units=units,
        gravity=gravity or _default_gravity(units) or 9.81,
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
        limits=bound["LIMITS"],
        buildings=bound["BUILDINGS"],
        damping=bound["DAMPING"],
        equake=bound["EQUAKE"],
        forces=bound["FORCES"],
        analyses=bound["ANALYSIS"],
        output=output[0],
        files=files,
        meant=frozenset(meant or ()),
        defaults=frozenset(key for key, card in left.items() if card not in outline.single),
    )
    return model, [card for cards in bound.values() for card in cards]


def _section(name: str, outline: Outline, binder: Binder) -> tuple[Card, ...]:
    rows = outline.sections[name]
    if name == "OUTPUT" and rows:  # all its lines are one card
        items = tuple(item for row in rows for item in row.items or ())
        card = binder.card(_SPECS[name], items, rows[0].span)
        return (card,) if card else ()  # nothing refers to OUTPUT, so it cannot be broken
    cards: list[Card] = []
    for row in rows:
        row_cards = _row(name, row, binder)
        if row_cards is None:
            outline.lose(name, *_plain_labels(item for item in (row.items or ())[:1] if not item.name))
        cards += row_cards or ()
    return tuple(cards)


def _row(name: str, row: ParsedLine, binder: Binder) -> list[Card] | None:
    """Cards of a row: an empty list where its range is empty, None where it has mistakes."""
    if name not in _SPECS:
        card = _kind(name, row, binder)
        return [card] if card else None
    generate = name in ("NODES", "ELEMENTS")
    cards = binder.cards(_SPECS[name], row.items or (), row.span, generate=generate)
    if cards and name in ("DRIFT", "LIMITS", "BUILDINGS"):
        cards = [_labelled(card) for card in cards]
    return cards


def _kind(name: str, row: ParsedLine, binder: Binder) -> Card | None:
    """Card of a line that names its kind, as first item or, under PROPS, after the label; None if wrong."""
    items, family = row.items or (), FAMILIES[name]
    specs = binder.read.catalog.family(family)
    codes = partial(binder.read.catalog.codes, family)
    at = 1 if family == "element" else 0
    try:
        if len(items) <= at or any(item.name for item in items[: at + 1]):
            raise _no_kind(name, row, specs)
        label = binder.read.label(items[0].parts[0], "PROPS") if at else ""
        if any(len(item.parts) > 1 for item in items[: at + 1]):
            raise _no_kind(name, row, specs)
        kind = binder.read.choice(items[at].parts[0], specs, codes, "this card's kind")
    except Mistake as error:
        error.keep(binder.report)
        return None
    return binder.card(specs[kind], items[at + 1 :], row.span, label)


def _no_kind(name: str, row: ParsedLine, kinds: Iterable[str]) -> Mistake:
    start = "a label and a kind of element" if name == "PROPS" else "its kind"
    return mistake(
        "P213", f"a line of {name} starts with {start}", row.span, "kinds are " + ", ".join(kinds)
    )


def _labelled(card: Card) -> Card:
    return Card(card.spec, card.values, card.span, card.values["NAME"], card.laws, card.spans)


def _plain_labels(heads: Iterable[Item]) -> list[str]:
    return [step.text.upper() for step in _lone_steps(heads) if step]


def _lone_steps(items: Iterable[Item]) -> list[ExpressionStep | None]:
    """For each item the single step of its first part, such as a word; None for a formula or a range."""
    parts = [item.parts[0] for item in items]
    return [p.lone if isinstance(p, Expression) else None for p in parts]


def _nodes(cards: Iterable[Card], report: list[Diagnostic]) -> dict[int, Node]:
    nodes: dict[int, Node] = {}
    for card in cards:
        node = _node(card, report)
        _once(nodes, node.id, node, "P301", f"node {node.id}", card.place("NODE"), report)
    return nodes


def _node(card: Card, report: list[Diagnostic]) -> Node:
    v = card.values
    if bool(v["SLAVED"]) != (v["MASTER"] is not None):
        there, needed = ("SLAVED", "MASTER") if v["SLAVED"] else ("MASTER", "SLAVED")
        message = f"node {v['NODE']} has {there}, but no {needed}"
        hint = "write SLAVED=XYR MASTER=node, or leave both out"
        report.append(Diagnostic("P308", message, card.place(there), hint))
    fixed = "".join(letter for letter in _DIRECTIONS if letter in v["FIX"])
    return Node(v["NODE"], v["X"], v["Y"], fixed, card.span, _masters(card, report))


def _masters(card: Card, report: list[Diagnostic]) -> dict[str, int]:
    """Masters of the slaved directions of a node, in the order X, Y, R."""
    letters, nodes = card["SLAVED"], card["MASTER"] or ()
    if len(nodes) == 1:
        nodes *= len(letters)
    if letters and nodes and len(nodes) != len(letters):
        message = (
            f"MASTER of node {card['NODE']} names {len(nodes)} nodes, SLAVED={letters} {len(letters)} "
        )
        message += "directions" if len(letters) > 1 else "direction"
        each = f", or {len(letters)}, for {', '.join(letters)} in this order" if len(letters) > 1 else ""
        report.append(Diagnostic("P308", message, card.place("MASTER"), f"name one node{each}"))
    masters = dict(zip(letters, nodes))
    return {letter: masters[letter] for letter in _DIRECTIONS if letter in masters}


def _elements(cards: Iterable[Card], report: list[Diagnostic]) -> dict[int, Element]:
    elements: dict[int, Element] = {}
    for card in cards:
        v = card.values
        element = Element(v["ELEMENT"], v["PROP"], v["I"], v["J"], card.span, v["NAME"])
        _once(elements, element.id, element, "P302", f"element {element.id}", card.place("ELEMENT"), report)
    return elements


def _props(cards: Iterable[Card], report: list[Diagnostic]) -> dict[str, Card]:
    props: dict[str, Card] = {}
    for card in cards:
        _once(props, card.label, card, "P303", f"property set {card.label}", card.span, report)
    return props


def _once(
    table: dict[Any, Any],
    key: int | str,
    value: Any,
    code: str,
    what: str,
    span: Span,
    report: list[Diagnostic],
) -> None:
    """Add a value to a table; report and skip it if its key exists already."""
    if key in table:
        first = table[key].span
        message = f"{what} is already given at {first.file}:{first.line}"
        report.append(Diagnostic(code, message, span, "take one out"))
    else:
        table[key] = value


def _single(name: str, outline: Outline, binder: Binder) -> Any:
    row = outline.single.get(name)
    if row is None or row.items is None:
        return None
    card = binder.card(_SPECS[name], row.items[1:], row.span)
    return card[name] if card else None


def units_of(row: ParsedLine | None, report: list[Diagnostic]) -> Units:
    """Units of the UNITS card; default units without the card, or where it has mistakes."""
    if row is None or row.items is None:
        return Units()
    steps = _lone_steps(row.items[1:])
    words = [s.text for s in steps if s and s.kind == "word"]
    right = _in_order(words)
    listed = any(i.name or len(i.parts) > 1 for i in row.items)
    if listed or len(words) != 3 or len(words) != len(steps) or not right:
        message = "UNITS takes the units of force, length and time, in this order"
        missing = _QUANTITIES[len(words) :] if right and len(words) == len(steps) else ()
        hint = hints(f"missing: {', '.join(missing)}" if missing else "", "for example UNITS kN m s")
        report.append(Diagnostic("P238", message, row.span, hint))
        return Units()
    force, length, time = words
    return Units(force, length, time, stated=True)


def _in_order(words: Iterable[str]) -> bool:
    """Whether words may be units of force, length and time in this order; unknown words fit anywhere."""
    return all(_dimension(word.upper()) in ("", want) for word, want in zip(words, "FLT"))


def _dimension(word: str) -> str:
    return "F" if word in _FORCES else "L" if word in _LENGTHS else "T" if word in _TIMES else ""


def _default_gravity(units: Units) -> float | None:
    return _LENGTHS.get(units.length.upper()) if units.time.upper() in _TIMES else None


def _doubtful_gravity(
    gravity: float | None, units: Units, single: Mapping[str, ParsedLine], weights: Sequence[Card]
) -> Iterator[Diagnostic]:
    """Report gravity in a unit of length other than the deck's, or gravity that is needed but unknown."""
    known = _default_gravity(units)
    if known is None and "GRAVITY" not in single and weights:
        message = f"no value of gravity is known for {units.length} and {units.time}"
        yield Diagnostic("P319", message, weights[0].span, "add GRAVITY with its value")
    if known is None or gravity is None:
        return
    other = next((u for u, g in _LENGTHS.items() if math.isclose(gravity, g, rel_tol=_ALIKE)), "")
    if other and _LENGTHS[other] != known and (units.stated or "UNITS" not in single):
        message = (
            f"GRAVITY is {gravity:g}, that of {other.lower()}, but the unit of length is {units.length}"
        )
        hint = f"it is {known:g} for lengths in {units.length}; or name the deck's own units in UNITS"
        items = single["GRAVITY"].items or ()
        yield Diagnostic("P342", message, items[1].span, hint, "warning")


def _title(row: ParsedLine | None) -> str:
    if row is None:
        return ""
    text = " ".join(row.line.text.split("\n")).strip()[len("TITLE") :].strip()
    quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" and text.count(text[0]) == 2
    return text[1:-1] if quoted else text


def _default_output() -> Card:
    spec = _SPECS["OUTPUT"]
    return Card(spec, {f.name: f.default for f in spec.fields}, Span("", 0, 0, 0))
