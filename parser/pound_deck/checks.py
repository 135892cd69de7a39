"""Checks of the whole Model: a list of small functions, each with its own messages."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from typing import Any, Final

from pound_deck.diagnostics import Diagnostic, suggest
from pound_deck.model import Card, Element, Model, Span
from pound_deck.schema import Kind

Found = Iterator[Diagnostic]
#: where the kinds that name something are defined: nodes, elements, property sets
_TABLE: Final = {Kind.NODE: 0, Kind.NODES: 0, Kind.ELEMENTS: 1, Kind.PROP: 2, Kind.PROPS: 2}
#: elements along the line between their nodes
_LONG: Final = ("FRAME", "BEAM_COLUMN", "TENDON")
_MOST_NAMED: Final = 10  #: numbers in one message
_MOST_HINTS: Final = 100  #: most hints: further messages are not printed, and each hint takes time


def run_checks(
    model: Model,
    cards: Iterable[Card],
    unreadable_sections: Set[str] = frozenset(),
    incomplete_sections: Set[str] = frozenset(),
    unreadable_props: Set[str] = frozenset(),
) -> list[Diagnostic]:
    """Run every check.

    Parameters
    ----------
    model : Model
        Model of all that could be read.
    cards : iterable of Card
        Every card of the deck; those of NODES and ELEMENTS have the places of single items.
    unreadable_sections, incomplete_sections, unreadable_props : set of str
        Sections with unreadable lines, those whose unreadable lines define unknown names, and the labels of
        unreadable property sets: checks that depend on unreadable lines are skipped.
    """
    diagnostics = [d for check, needs in CHECKS if not unreadable_sections & needs for d in check(model)]
    return diagnostics + list(_references(model, cards, incomplete_sections, unreadable_props))


def _references(
    model: Model, cards: Iterable[Card], incomplete_sections: Set[str], unreadable_props: Set[str]
) -> Found:
    """Report nodes, elements and property sets that are named but not defined."""
    tables: tuple[tuple[str, str, str, Any], ...] = (
        ("P305", "node", "NODES", model.nodes),
        ("P306", "element", "ELEMENTS", model.elements),
        ("P307", "property set", "PROPS", dict.fromkeys((*model.props, *sorted(unreadable_props)))),
    )
    reported: set[Span] = set()  # one report for an item is enough: a range may miss a hundred
    for value, kind, span in _named(cards):
        code, what, section, known = tables[_TABLE[kind]]
        if section not in incomplete_sections and value not in known and span not in reported:
            reported.add(span)
            near = suggest(value, known) if isinstance(value, str) and len(reported) <= _MOST_HINTS else ""
            ground = "leave J out for the ground" if value == 0 else ""
            hint = near or ground or f"define it under {section}"
            yield Diagnostic(code, f"there is no {what} {value}", span, hint)


def _named(cards: Iterable[Card]) -> Iterator[tuple[Any, Kind, Span]]:
    """Yield the nodes, elements and property sets that cards name, with kind and place."""
    for card in cards:
        for spec in (card.spec, *(s for specs in card.laws.values() for s in specs)):
            for f in spec.fields:
                value = card.values.get(f.name) if f.kind in _TABLE else None
                if value is not None:
                    for v in value if isinstance(value, tuple) else (value,):
                        yield v, f.kind, card.place(f.name)


def _slaving(model: Model) -> Found:
    for node in model.nodes.values():
        for letter, number in node.slaved.items():
            master = model.nodes.get(number)
            if number == node.id:
                yield Diagnostic(
                    "P309", f"node {node.id} is slaved to itself", node.span, "name another MASTER"
                )
                break
            if letter in node.fixed:
                message = f"direction {letter} of node {node.id} is both fixed and slaved"
                yield Diagnostic("P311", message, node.span, f"take {letter} out of FIX or SLAVED")
            if master and letter in master.slaved and master.slaved[letter] != number:
                last = master.slaved[letter]
                message = f"the master {number} of node {node.id} follows node {last} in {letter} itself"
                hint = f"name the master {last}"
                if last == node.id:
                    message = f"nodes {node.id} and {number} follow each other in {letter}"
                    hint = f"take {letter} out of SLAVED of one of them"
                yield Diagnostic("P310", message, node.span, hint)


def _zero_length(model: Model) -> Found:
    for element in model.elements.values():
        i, j = model.nodes.get(element.i), model.nodes.get(-1 if element.j is None else element.j)
        prop = model.props.get(element.prop)
        if i is None or j is None:
            continue
        if i is j:
            message = f"both ends of element {element.id} are node {i.id}"
            yield Diagnostic("P321", message, element.span, "name two nodes, or leave J out for the ground")
        elif prop and prop.spec.name in _LONG and (i.x, i.y) == (j.x, j.y):
            message = f"member {element.id} has no length: nodes {i.id} and {j.id} are at the same place"
            hint = "correct the coordinates of one of them; a SPRING alone joins nodes at one place"
            yield Diagnostic("P312", message, element.span, hint)


def _element_names(model: Model) -> Found:
    """Warn of names that several elements share, as when NAME is on a line that generates several."""
    named: dict[str, list[Element]] = {}
    for element in model.elements.values():
        if element.name:
            named.setdefault(element.name, []).append(element)
    for name, elements in named.items():
        if len(elements) > 1:
            message = f'elements {_numbers([e.id for e in elements])} have one name, "{name}"'
            hint = "name each on a line of its own, or leave NAME out: then their numbers tell them apart"
            yield Diagnostic("P350", message, elements[1].span, hint, "warning")


def _unused_props(model: Model) -> Found:
    used = {e.prop for e in model.elements.values()}
    for label, card in model.props.items():
        if label not in used:
            message = f"no element has the property set {label}"
            yield Diagnostic(
                "P313",
                message,
                card.span,
                "name it under ELEMENTS, or take it out if it is idle",
                "warning",
            )


def _loose_nodes(model: Model) -> Found:
    tied = {n for e in model.elements.values() for n in (e.i, e.j)}
    tied |= {n for node in model.nodes.values() if node.slaved for n in (node.id, *node.slaved.values())}
    reported: set[Span] = set()
    for node in model.nodes.values():
        if model.elements and node.id not in tied and node.span not in reported:
            reported.add(node.span)
            message = f"node {node.id} is connected to nothing"
            yield Diagnostic("P314", message, node.span, "join it by an element, or take it out", "warning")


def _something(model: Model) -> Found:
    for what, section, example in (
        (model.nodes, "NODES", "1 0 0 FIX=XYR"),
        (model.elements, "ELEMENTS", "1 COL 1 2"),
    ):
        if not what:
            yield Diagnostic(
                "P315",
                f"the deck has no {section.lower()}",
                _deck(model),
                f"write {section} and lines like: {example}",
            )


def _analysis(model: Model) -> Found:
    if not model.analyses:
        hint = "write ANALYSIS and below it STATIC, MODAL 4 or HISTORY T=10"
        yield Diagnostic("P316", "the deck requests no analysis", _deck(model), hint)


def _deck(model: Model) -> Span:
    """Span of the start of the deck, for diagnostics without a place."""
    return Span(next(iter(model.files)), 1, 1, 2)


def _analysis_twice(model: Model) -> Found:
    seen: dict[str, Span] = {}
    for card in model.analyses:
        name = card.spec.name
        if name in seen and name != "PUSHOVER":  # each starts from the static state
            hint = f"the first stands at {seen[name]}; run the deck again with other PARAMs"
            yield Diagnostic("P324", f"a second {name}: a deck holds one {name}", card.span, hint)
        seen.setdefault(name, card.span)


def _initial(model: Model) -> Found:
    for card in model.initial:
        for letter in "XYR":
            names = [name for name in ("U" + letter, "V" + letter) if card[name]]
            for number in card["NODES"]:
                node = model.nodes.get(number)
                if not names or node is None or not (letter in node.fixed or letter in node.slaved):
                    continue
                state = "fixed" if letter in node.fixed else f"slaved to node {node.slaved[letter]}"
                hint = "give the initial motion to the master" if letter in node.slaved else "leave it out"
                message = f"node {number} is {state} along {letter}: {names[0]} has no effect"
                yield Diagnostic("P325", message, card.place(names[0]), hint)
                break  # one node is enough


def _excitation(model: Model) -> Found:
    histories = [card for card in model.analyses if card.spec.name == "HISTORY"]
    still = all(card.values.get("FROM") != "REST" for card in histories)  # they start under the loads
    loads = [card for card in model.loads if not still or card["HELD"] == "NO"]
    # a list may be empty
    moved = any(card["NODES"] for card in (*model.initial, *loads, *model.forces))
    moved |= not still and any(card["ELEMENTS"] for card in model.member_loads)
    overlaps = any(x.spec.name == "CONTACT" and x["GAP"] < 0.0 for x in model.props.values())
    if model.equake or moved or overlaps:
        return
    for card in histories:
        hint = f"add EQUAKE, FORCES, INITIAL or LOADS{' with HELD=NO' * still}"
        yield Diagnostic("P317", "nothing sets this history in motion", card.span, hint, "warning")


def _percent(model: Model) -> Found:
    """Warn of damping that seems to be given in percent instead of as a ratio."""
    for card in model.damping:
        value = card.values.get("XI")
        ratios = value if isinstance(value, tuple) else () if value is None else (value,)
        if any(xi > 1.0 for xi in ratios):
            xi = max(ratios)
            message = f"a damping ratio of {xi:g} is {100.0 * xi:g} % of critical: nothing would swing"
            hint = f"XI is a share: {xi:g} % is XI={xi / 100.0:g}"
            yield Diagnostic("P341", message, card.place("XI"), hint, "warning")


def _drift_names(model: Model) -> Found:
    first: dict[str, Span] = {}
    for card in model.drifts:
        if card.label in first:
            message = f'drift "{card.label}" is already given in line {first[card.label].line}'
            yield Diagnostic("P304", message, card.place("NAME"), "choose another name")
        first.setdefault(card.label, card.span)


def _limits(model: Model) -> Found:
    first: dict[str, Span] = {}
    for card in model.limits:
        if card.label in first:
            message = f'limit "{card.label}" is already given in line {first[card.label].line}'
            yield Diagnostic("P304", message, card.place("NAME"), "choose another name")
        first.setdefault(card.label, card.span)
        if card["DRIFT"] is None and card["ROTATION"] is None:
            message = f'limit "{card.label}" has neither DRIFT nor ROTATION'
            yield Diagnostic("P379", message, card.span, "give it DRIFT=0.02 or ROTATION=0.02, or both")


def _drift_nodes(model: Model) -> Found:
    for card in model.drifts:
        i, j = model.nodes.get(card["I"]), model.nodes.get(card["J"])
        if card["I"] == card["J"]:
            message = f'drift "{card.label}" is that of node {card["I"]} against itself'
            yield Diagnostic("P344", message, card.place("J"), "name the lower and the upper node")
        elif i and j and i.y == j.y and card["HEIGHT"] is None:
            message = f"nodes {i.id} and {j.id} are at the same height, so this drift has no ratio"
            yield Diagnostic("P318", message, card.span, "add HEIGHT=value", "warning")


def _node_like(model: Model, card: Card) -> bool:
    """Whether WX looks like the second of two node numbers that lack a comma between them."""
    wx, wy = card["WX"], card["WY"]
    return wy is not None and wx < wy and wx in model.nodes and not {"WX", "WY"} - card.spans.keys()


def _node_like_weights(model: Model) -> Found:
    for card in model.weights:
        if _node_like(model, card):
            message = f"WX is {card['WX']:g}, which is the number of a node, and WY differs from it"
            hint = "a list of nodes has commas and no blanks: 1,2"
            yield Diagnostic("P320", message, card.place("WX"), hint, "warning")


def _weights_twice(model: Model) -> Found:
    """Warn of nodes with two weights, but not of lists that overlap in part: there elements that share a
    node put half their weight on each end.
    """
    lines = [(card, frozenset(card["NODES"])) for card in model.weights]
    first: dict[int, int] = {}  # the line that names a node first
    for i, (card, nodes) in enumerate(lines):
        shared = Counter(first[n] for n in nodes if n in first)
        within = [j for j, n in shared.items() if n in (len(nodes), len(lines[j][1]))]
        hint = "take it out of one of the lists, or write the sum"
        if within:
            earlier, others = lines[min(within)]
            node, line = min(nodes & others), earlier.span.line
            message = f"node {node} has a weight in line {line} already, and this adds to it"
            yield Diagnostic("P329", message, card.place("NODES"), hint, "warning")
        elif len(nodes) < len(card["NODES"]):
            twice = next(n for n, count in Counter(card["NODES"]).items() if count > 1)
            message = f"node {twice} is listed twice, and gets the weight twice"
            yield Diagnostic("P329", message, card.place("NODES"), hint, "warning")
        for n in nodes:
            first.setdefault(n, i)


def _weights_of_supports(model: Model) -> Found:
    """Warn of weights on fixed nodes: they have no effect, except on supports with their own motion,
    or where weights act as loads.
    """
    if any(card.values.get("GRAVITY") == "YES" for card in model.analyses):
        return
    moved = {node for card in model.equake for node in card.values.get("SUPPORTS") or ()}
    for card in model.weights:
        held = [
            number
            for number in dict.fromkeys(card["NODES"])
            if number in model.nodes and number not in moved
            if {"X", "Y", *("R" * bool(card["WR"]))} <= set(model.nodes[number].fixed)
        ]
        if held and not _node_like(model, card):
            who = f"nodes {_numbers(held)} are" if len(held) > 1 else f"node {held[0]} is"
            message = f"{who} fixed: a weight there moves nothing"
            hint = "take it out of the list, or correct FIX under NODES"
            yield Diagnostic("P343", message, card.place("NODES"), hint, "warning")


def _numbers(numbers: Sequence[int]) -> str:
    """Text of the first of some numbers, and how many more there are."""
    more = f" and {len(numbers) - _MOST_NAMED} more" if len(numbers) > _MOST_NAMED else ""
    return ", ".join(map(str, numbers[:_MOST_NAMED])) + more


_NODES: Final = frozenset({"NODES"})
_MEMBERS: Final = frozenset({"ELEMENTS"})
_PROPS: Final = frozenset({"PROPS"})
#: every check, with the sections that must be complete for it
CHECKS: Final[tuple[tuple[Callable[[Model], Found], frozenset[str]], ...]] = (
    (_something, _NODES | _MEMBERS),
    (_analysis, frozenset({"ANALYSIS"})),
    (_analysis_twice, frozenset({"ANALYSIS"})),
    (_initial, frozenset({"NODES", "INITIAL"})),
    (_slaving, frozenset()),
    (_zero_length, frozenset()),
    (_element_names, frozenset()),
    (_unused_props, _MEMBERS | _PROPS),
    (_loose_nodes, _NODES | _MEMBERS),
    (_excitation, frozenset({"EQUAKE", "FORCES", "INITIAL", "LOADS", "MEMBER_LOADS"})),
    (_percent, frozenset()),
    (_drift_names, frozenset()),
    (_limits, frozenset()),
    (_drift_nodes, frozenset()),
    (_node_like_weights, frozenset()),
    (_weights_twice, frozenset()),
    (_weights_of_supports, _NODES | frozenset({"ANALYSIS", "EQUAKE"})),
)
