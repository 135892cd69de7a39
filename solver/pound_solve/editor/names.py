"""Definitions and mentions of nodes, elements, property sets and PARAMs in a deck."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from pound_deck.cards import Item, ParsedLine
from pound_deck.diagnostics import Mistake
from pound_deck.expressions import Expression, ExpressionStep, Range
from pound_deck.model import Span
from pound_deck.schema import Field, Kind
from pound_deck.values import Values
from pound_solve.editor.fields import LABEL, fields
from pound_solve.editor.reading import Reading

Sort = Literal["node", "element", "property set", "PARAM"]

#: what the kinds name that name something
SORTS: Final[dict[Kind, Sort]] = {
    Kind.NODE: "node",
    Kind.NODES: "node",
    Kind.ELEMENTS: "element",
    Kind.PROP: "property set",
    Kind.PROPS: "property set",
}
#: sorts of names defined by the items of a section
_DEFINES: Final[dict[tuple[str, str], Sort]] = {
    ("NODES", "NODE"): "node",
    ("ELEMENTS", "ELEMENT"): "element",
    ("PROPS", LABEL.name): "property set",
}


@dataclass(frozen=True, slots=True)
class Mention:
    """A mention of a name.

    Attributes
    ----------
    sort : str
    keys : sequence
        Numbers, or one upper-case name; a range names many.
    span : Span
        The name itself, or the expression or range that gives it.
    defines : bool
        Whether it is defined here.
    plain : bool
        Whether the span is the name itself, which can be replaced.
    """

    sort: Sort
    keys: Sequence[int | str]
    span: Span
    defines: bool = False
    plain: bool = False

    @property
    def key(self) -> int | str:
        """The name, or the first one of a range."""
        return self.keys[0]

    def holds(self, span: Span) -> bool:
        """Whether a place lies within the mention or at its end."""
        here = self.span
        return (here.file, here.line) == (span.file, span.line) and here.column <= span.column <= here.end


def mentions(reading: Reading) -> list[Mention]:
    """Every mention, in the order of the deck."""
    heads = [row.items[0] for section, row in reading.rows if section == "PROPS" and row.items]
    labels = frozenset(step.text.upper() for item in heads if (step := _lone(item)))
    values = Values(reading.catalog, reading.params, labels, reading.units)
    return [m for section, row in reading.rows for m in _of_row(row, section, reading, values)]


def at(all_mentions: Sequence[Mention], place: Span) -> Mention | None:
    """Shortest mention at a place; if a PARAM provides the name, the mention of the PARAM."""
    here = [m for m in all_mentions if m.holds(place)]
    return min(here, key=lambda m: (m.span.end - m.span.column, not m.plain), default=None)


def definitions(all_mentions: Sequence[Mention], of: Mention) -> list[Mention]:
    """Mentions that define the name of a mention."""
    return [m for m in all_mentions if m.defines and m.sort == of.sort and of.key in m.keys]


def words_of(row: ParsedLine) -> list[tuple[str, str]]:
    """Items of a row as (name, text), the form that `fields` takes."""
    return [(item.name, item.text) for item in row.items or ()]


def _of_row(row: ParsedLine, section: str, reading: Reading, values: Values) -> Iterator[Mention]:
    items = row.items or ()
    if row.word == "PARAM" and not section:
        for item in items[1:]:
            if item.name:
                yield Mention("PARAM", (item.name,), item.name_span, defines=True, plain=True)
            yield from _params(item.parts, reading)
    elif section or row.word in ("GRAVITY", "MASS", "GEOMETRY", "MEANT"):
        known = fields(words_of(row), section, reading.catalog, reading.params)
        for item, f in zip(items, known.matched):
            if f:
                yield from _of_item(item, f, section, values, reading)


def _of_item(item: Item, f: Field, section: str, values: Values, reading: Reading) -> Iterator[Mention]:
    defined = _DEFINES.get((section, f.name))
    sort = defined or SORTS.get(f.kind)
    for part in item.parts:
        if sort:
            yield from _named(part, sort, f.name, defined is not None, values)
        yield from _params([part], reading, f, values)


def _named(
    part: Expression | Range, sort: Sort, name: str, defines: bool, values: Values
) -> Iterator[Mention]:
    try:
        if isinstance(part, Range):
            yield from _of_range(part, sort, defines, values)
        elif sort == "property set":
            step = part.lone
            plain = step is not None and (step.kind != "word" or step.text.upper() in values.labels)
            yield Mention(sort, (values.label(part, name),), part.span, defines, plain)
        else:
            step = part.lone
            plain = step is not None and step.kind == "number" and step.text.isdecimal()
            yield Mention(sort, (values.whole(part, None, False),), part.span, defines, plain)
    except Mistake:
        return


def _of_range(part: Range, sort: Sort, defines: bool, values: Values) -> Iterator[Mention]:
    """Yield the mention of a whole range, and those of its ends."""
    first, last = (values.whole(end, None, False) for end in (part.first, part.last))
    step = values.whole(part.step, None) if part.step else 1
    numbers = range(first, last + 1, max(1, step))
    if numbers:
        yield Mention(sort, numbers, part.span, defines)
        for end, number in ((part.first, first), (part.last, last)):
            yield Mention(sort, (number,), end.span)


def _params(
    parts: Sequence[Expression | Range],
    reading: Reading,
    f: Field | None = None,
    values: Values | None = None,
) -> Iterator[Mention]:
    """Yield the mentions of PARAMs in the expressions of an item."""
    for part in parts:
        ends = (part,) if isinstance(part, Expression) else (part.first, part.last, part.step)
        for expression in ends:
            for step in expression.steps if expression else ():
                name = step.text.upper()
                choice = f and values and expression and expression.lone and _is_word(step, f, values)
                if step.kind == "word" and name in reading.definitions and not choice:
                    yield Mention("PARAM", (name,), step.span, plain=True)


def _is_word(step: ExpressionStep, f: Field, values: Values) -> bool:
    """Whether a field takes a word literally, although there is a PARAM of that name."""
    word = step.text.upper()
    match f.kind:
        case Kind.WORD:
            return word in f.words
        case Kind.REAL:
            return word in f.words and not isinstance(values.params.get(word), str)
        case Kind.FLAGS:
            return set(word) <= set(f.words[0]) and len(set(word)) == len(word)
        case Kind.FAMILY:
            return word in values.catalog.family(f.family)
        case Kind.PROP | Kind.PROPS:
            return word in values.labels
    return False


def _lone(item: Item) -> ExpressionStep | None:
    part = item.parts[0]
    return part.lone if isinstance(part, Expression) else None
