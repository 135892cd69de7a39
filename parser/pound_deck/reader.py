"""From a deck's file to its Model and all its diagnostics: the stages of reading, in order."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from pound_deck.bind import Binder
from pound_deck.cards import Item, Row, parse, parse_items
from pound_deck.checks import run_checks
from pound_deck.diagnostics import Diagnostic, Mistake, closest, has_errors, hints, suggest
from pound_deck.expressions import RESERVED, Definition, Expression, Step, Value, resolve
from pound_deck.model import Card, Element, Model, Node, Span, Units
from pound_deck.schema import Catalog, Field, Kind, Spec
from pound_deck.sections import SECTIONS
from pound_deck.source import Line, Source

_SPECS: Final = {spec.name: spec for spec in SECTIONS}
#: sections whose lines are cards of a family of the solver
_FAMILIES: Final = {"PROPS": "element", "DAMPING": "damping", "EQUAKE": "motion", "ANALYSIS": "analysis"}
_SECTIONS: Final = (*_SPECS, *_FAMILIES)
_SINGLE: Final = ("TITLE", "UNITS", "GRAVITY", "MASS")  #: cards that stand once, anywhere
_KEYWORDS: Final = (*_SECTIONS, *_SINGLE, "PARAM", "INCLUDE", "END")
_GRAVITY: Final = Field("GRAVITY", Kind.REAL, "L/T^2", doc="acceleration", above=0, positional=True)
_MASS: Final = Field(
    "MASS", Kind.WORD, doc="mass matrix of members", words=("LUMPED", "CONSISTENT"), positional=True
)
_LENGTHS: Final = {"M": 9.81, "MM": 9810.0, "CM": 981.0, "FT": 32.174, "IN": 386.09}
_UNITS: Final = ("kN", "m", "s")  #: of words that UNITS leaves out
_TIMES: Final = ("S", "SEC")
_FORCES: Final = ("N", "KN", "MN", "KIP", "KIPS", "LB", "LBF", "KGF", "TF")

Reading = tuple[Model | None, list[Diagnostic], dict[str, str]]


def read_deck(path: str, catalog: Catalog, overrides: Mapping[str, str] | None = None) -> Reading:
    """Read and check a deck.

    Parameters
    ----------
    path : str
        The deck's file; spans carry this name.
    catalog : Catalog
        Every Spec that PROPS, DAMPING, EQUAKE and ANALYSIS may hold.
    overrides : mapping of str to str
        Texts that replace PARAM values, by name in any case.

    Returns
    -------
    model : Model or None
        None only when there are errors.
    diagnostics : list of Diagnostic
        All mistakes and warnings, in the order of the deck.
    files : dict of str to str
        Texts by file name, for :func:`~pound_deck.diagnostics.caret`.

    Raises
    ------
    OSError
        The deck cannot be read.
    """
    source = Source()
    lines = source.read(str(path))
    return _read(source, lines, catalog, overrides or {})


def read_text(
    text: str, catalog: Catalog, overrides: Mapping[str, str] | None = None, name: str = "deck.inp"
) -> Reading:
    """Read and check a deck given as text; see :func:`read_deck`."""
    source = Source()
    data = text.encode("utf-8", "surrogatepass")
    lines = source.lines(name, source.decode(name, data, Span(name, 1, 1, 2)))
    return _read(source, lines, catalog, overrides or {})


def _read(source: Source, lines: list[Line], catalog: Catalog, overrides: Mapping[str, str]) -> Reading:
    report = source.report
    files = source.files
    unread = has_errors(report)
    outline = Outline(catalog, report)
    rows = list(parse(lines, report))
    for row in sorted(rows, key=lambda row: row.word != "PARAM"):  # names first: a line may start with one
        outline.add(row)
    texts = {f"--set {name}": str(value) for name, value in overrides.items()}
    if unread:  # what is missing would only bring complaints about things that stand in the unread file
        outline.broken |= set(_SECTIONS)
        texts = {}
    params = _params(outline, texts, report)
    model, cards = _build(outline, params, catalog, dict(files), report)
    report += run_checks(model, cards, frozenset(outline.broken))
    if unread:  # names may be defined in what could not be read
        report[:] = [d for d in report if d.code not in ("P222", "P234")]
    order = {name: k for k, name in enumerate(files)}
    report.sort(
        key=lambda d: (
            (order.get(d.span.file, -1), d.span.line, d.span.column) if d.span else (len(order), 0, 0)
        )
    )
    return (None if has_errors(report) else model), report, {**files, **texts}


@dataclass(slots=True)
class Outline:
    """Rows of a deck, sorted into sections and single cards.

    `broken` names the sections that lost a row to a mistake: what refers to them cannot be judged.
    """

    catalog: Catalog
    report: list[Diagnostic]
    sections: dict[str, list[Row]] = field(default_factory=lambda: {name: [] for name in _SECTIONS})
    single: dict[str, Row] = field(default_factory=dict)
    definitions: dict[str, Definition] = field(default_factory=dict)
    lost: set[str] = field(default_factory=set)
    broken: set[str] = field(default_factory=set)
    _section: str | None = None
    _skipping: bool = False

    def add(self, row: Row) -> None:
        """Put a row where it belongs."""
        if row.word in _SECTIONS:
            self._open(row)
        elif row.word in _SINGLE:
            if row.word in self.single:
                self._error("P237", f"{row.word} is given twice", row.span, "take one of them out")
            self.single.setdefault(row.word, row)
        elif row.word == "PARAM":
            self._define(row)
        elif row.items and row.items[0].name in (*_SINGLE, "PARAM"):
            name = row.items[0].name
            self._error(
                "P209", f"{name} is no named item", row.items[0].name_span, f"write {name} without ="
            )
        elif row.items is None:
            self.broken.add(self._section or "NODES")
        elif self._misspelt(row):
            pass
        elif self._section:
            self.sections[self._section].append(row)
        elif not self._skipping:
            self._skipping = True  # one message for all the lines up to the next section
            hint = hints(
                suggest(row.word, _KEYWORDS) if row.word else "", "write NODES, ELEMENTS, ... above it"
            )
            self._error("P234", "this line stands before any section", row.span, hint)
            self.broken |= set(_SECTIONS)

    def _open(self, row: Row) -> None:
        self._section = row.word
        rest = (row.items or ())[1:]
        # Ruaumoko's sections may carry a number, which has no meaning here
        if rest and not (len(rest) == 1 and _is_whole(rest[0])):
            hint = "put column heads behind an exclamation mark; a name of a section cannot be a label"
            self._error("P236", f"{row.word} stands alone on its line", rest[0].name_span, hint)

    def _misspelt(self, row: Row) -> bool:
        """Whether the row is a section's name with a slip; reading then goes on in the section meant."""
        items = row.items or ()
        alone = len(items) == 1 or (len(items) == 2 and _is_whole(items[1]))
        if not alone or not items[0].word or row.word in self.definitions or row.word in self.lost:
            return False
        meant = closest(row.word, (*_SECTIONS, *_SINGLE))
        family = _FAMILIES.get(self._section or "", "")
        kinds = self.catalog.family(family) if family != "element" else {}
        if row.word in kinds or closest(row.word, kinds) or (not meant and len(items) == 2):
            return False  # an ordinary line of the section above, perhaps with a slip of its own
        lines = f"lines of {self._section} start with {', '.join(kinds)}" if kinds else ""
        hint = hints(f"did you mean {meant}?" if meant else lines, "sections are " + ", ".join(_SECTIONS))
        self._error("P235", f"{row.word[:60]} is no section", row.span, hint)
        self._section, self._skipping = (meant if meant in _SECTIONS else None), True
        if not self._section:
            self.broken |= set(_SECTIONS)
        return True

    def _define(self, row: Row) -> None:
        if row.items is None:
            self.lost |= {name.upper() for name in re.findall(r"([A-Za-z_][\w.]*)\s*=", row.line.text)}
            return
        items = row.items[1:]
        for item in items:
            name, place, part = item.name, item.name_span, item.parts[0]
            if not name or len(item.parts) > 1 or not isinstance(part, Expression):
                hint = "write PARAM name = value; an expression holds no blanks outside brackets"
                self._error("P231", "PARAM takes name = value, one value each", item.span, hint)
                self.lost |= {i.name or i.word for i in items}
                break
            if name in RESERVED:
                self._error("P230", f"{name} cannot be the name of a PARAM", place, "choose another name")
            elif name in self.definitions:
                first = self.definitions[name].span
                self._error(
                    "P229", f"PARAM {name} is already given in line {first.line}", place, "take one out"
                )
            else:
                self.definitions[name] = Definition(name, part, place)
        if not items:
            self._error("P231", "PARAM without a name", row.span, "write PARAM name = value")

    def _error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.report.append(Diagnostic(code, message, span, hint))


def _is_whole(item: Item) -> bool:
    step = item.parts[0].lone if len(item.parts) == 1 and isinstance(item.parts[0], Expression) else None
    return bool(step and not item.name and step.kind == "number" and step.text.isdecimal())


def _params(
    outline: Outline, texts: Mapping[str, str], report: list[Diagnostic]
) -> dict[str, Value | None]:
    """Values of all PARAMs; `texts` holds the overrides by the name that their spans carry."""
    if texts:
        own = resolve(outline.definitions, [], outline.lost)  # tells which PARAMs hold texts
        for source, text in texts.items():
            _override(source, text, own, outline, report)
    return resolve(outline.definitions, report, outline.lost)


def _override(
    source: str, text: str, own: Mapping[str, Value | None], outline: Outline, report: list[Diagnostic]
) -> None:
    name = source.removeprefix("--set ").strip()
    line = Line(source, 1, text)
    place = Span(source, 1, 1, max(2, len(text) + 1))
    key = name.upper()
    if key not in outline.definitions:
        if key not in outline.lost:
            hint = hints(
                suggest(key, own), f"its PARAMs are {', '.join(own)}" if own else "it has no PARAM"
            )
            report.append(Diagnostic("P232", f"the deck has no PARAM {name[:60]}", place, hint))
        return
    value: Expression | None = None
    if isinstance(own[key], str):  # a text stays a text: paths hold slashes, dashes and blanks
        bare = text.strip()
        quoted = len(bare) > 1 and bare[0] == bare[-1] and bare[0] in "\"'"
        value = Expression((Step("text", bare[1:-1] if quoted else bare, place),), place)
    else:
        try:
            items = parse_items(line)
            part = (
                items[0].parts[0]
                if len(items) == 1 and not items[0].name and len(items[0].parts) == 1
                else None
            )
            if isinstance(part, Expression) and not (part.lone and part.lone.kind == "text"):
                value = part
        except Mistake:
            pass
    if value is None:
        message = f"PARAM {name} holds a number, and {text[:60]!r} is none"
        report.append(
            Diagnostic("P233", message, place, f"write --set {name}=5, or an expression without blanks")
        )
    else:
        outline.definitions[key] = Definition(outline.definitions[key].name, value, place)


def _build(
    outline: Outline,
    params: dict[str, Value | None],
    catalog: Catalog,
    files: Mapping[str, str],
    report: list[Diagnostic],
) -> tuple[Model, list[Card]]:
    """Model of all that could be bound, and every card in it."""
    units = _units(outline.single.get("UNITS"), report)
    heads = [row.items[0] for row in outline.sections["PROPS"] if row.items]
    binder = Binder(catalog, params, frozenset(_plain_labels(heads)), units, report)
    bound = {name: _section(name, outline, binder) for name in _SECTIONS}
    gravity = _single(Spec("card", "GRAVITY", "gravity", (_GRAVITY,)), outline, binder)
    mass = _single(Spec("card", "MASS", "mass of members", (_MASS,)), outline, binder)
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
    if known is None and "GRAVITY" not in outline.single and bound["WEIGHTS"]:
        message = f"no value of gravity is known for {units.length} and {units.time}"
        report.append(Diagnostic("P319", message, bound["WEIGHTS"][0].span, "add GRAVITY with its value"))
    left = {"units": "UNITS", "gravity": "GRAVITY", "mass": "MASS"}
    model = Model(
        title=_title(outline.single.get("TITLE")),
        units=units,
        gravity=gravity if gravity is not None else known or 9.81,
        mass=mass or "LUMPED",
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
        if not found:
            outline.broken.add(name)
        out += found
    return tuple(out)


def _row(name: str, row: Row, binder: Binder) -> list[Card]:
    items = row.items or ()
    if name in _SPECS:
        cards = binder.cards(_SPECS[name], items, row.span, generate=name in ("NODES", "ELEMENTS"))
        if name == "DRIFT":
            cards = [_labelled(card) for card in cards]
        return cards
    family = _FAMILIES[name]
    specs = binder.catalog.family(family)
    codes = {s.code: s.name for s in specs.values() if s.code is not None}
    at = 1 if family == "element" else 0
    try:
        if len(items) <= at or any(item.name for item in items[: at + 1]):
            return _no_kind(name, row, items, list(specs), binder)
        label = binder.label(items[0].parts[0], "PROPS") if at else ""
        if any(len(item.parts) > 1 for item in items[: at + 1]):
            return _no_kind(name, row, items, list(specs), binder)
        kind = binder.choice(items[at].parts[0], specs, codes, "this card's kind")
    except Mistake as error:
        if error.diagnostic:
            binder.report.append(error.diagnostic)
        return []
    card = binder.card(specs[kind], items[at + 1 :], row.span, label)
    return [card] if card else []


def _no_kind(name: str, row: Row, items: Iterable[Item], kinds: list[str], binder: Binder) -> list[Card]:
    start = "a label and a kind of element" if name == "PROPS" else "its kind"
    hint = "kinds are " + ", ".join(kinds)
    binder.report.append(Diagnostic("P213", f"a line of {name} starts with {start}", row.span, hint))
    return []


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
    if named or not 1 <= len(words) <= 3 or len(words) != len(steps) or not right:
        message = "UNITS takes the units of force, length and time, in this order"
        report.append(Diagnostic("P238", message, row.span, "for example UNITS kN m s"))
        return Units()
    force, length, time = (*words, *_UNITS[len(words) :])
    return Units(force, length, time, given=True)


def _dimension(word: str) -> str:
    return "F" if word in _FORCES else "L" if word in _LENGTHS else "T" if word in _TIMES else ""


def _default_gravity(units: Units) -> float | None:
    return _LENGTHS.get(units.length.upper()) if units.time.upper() in _TIMES else None


def _title(row: Row | None) -> str:
    if row is None:
        return ""
    text = " ".join(row.line.text.split("\n")).strip()[len("TITLE") :].strip()
    quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" and text.count(text[0]) == 2
    return text[1:-1] if quoted else text


def _default_output() -> Card:
    spec = _SPECS["OUTPUT"]
    return Card(spec, {f.name: f.default for f in spec.fields}, Span("", 0, 0, 0))
