"""Rows + Specs -> Cards: every item is matched to its field, evaluated, checked and given its type."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from pound_deck.cards import Item
from pound_deck.diagnostics import Diagnostic, Mistake, hints, mistake, suggest
from pound_deck.expressions import Expression, Range
from pound_deck.model import Card, Span
from pound_deck.schema import REQUIRED, Field, Kind, Spec
from pound_deck.values import Values

MAX_GENERATED: Final = 100_000
_LISTS: Final = {Kind.NODES, Kind.ELEMENTS, Kind.PROPS}
_NUMBERED: Final = {Kind.NODES, Kind.ELEMENTS}
_WHOLE: Final = {Kind.INT, Kind.NODE, Kind.NODES, Kind.ELEMENTS}
_PLURAL: Final = {
    Kind.NODES: "node numbers",
    Kind.ELEMENTS: "element numbers",
    Kind.PROPS: "property labels",
}


@dataclass(slots=True)
class _Draft:
    """Card under construction, while its fields are filled in.

    Attributes
    ----------
    spec : Spec
    span : Span
    label : str
    items : mapping of str to Item
        By the name of the field.
    numbers : sequence of int or None
        Those that a range in the first field generates; None without one.
    matched : bool
        Whether every item found a field.
    whole : bool
        Whether there is no mistake so far.
    values : dict of str to value
    laws : dict of str to tuple of Spec
        What the FAMILY items choose, whose fields join those of the card.
    lost : set of str
        Fields that a FAMILY item with a mistake might have brought along.
    """

    spec: Spec
    span: Span
    label: str
    items: Mapping[str, Item]
    numbers: Sequence[int] | None
    matched: bool
    whole: bool
    values: dict[str, Any] = field(default_factory=dict)
    laws: dict[str, tuple[Spec, ...]] = field(default_factory=dict)
    lost: set[str] = field(default_factory=set)

    def cards(self) -> list[Card]:
        """Make the finished card, or one for each of the generated numbers."""
        spans = {name: item.span for name, item in self.items.items()}
        every = [self.values]
        if self.numbers is not None:
            every = [
                {n: v[k] if isinstance(v, _Steps) else v for n, v in self.values.items()}
                for k in range(len(self.numbers))
            ]
        return [Card(self.spec, values, self.span, self.label, self.laws, spans) for values in every]


@dataclass(slots=True)
class Binder:
    """Binds the items of a deck.

    Attributes
    ----------
    read : Values
        Reads the single values.
    report : list of Diagnostic
        Receives every mistake.
    """

    read: Values
    report: list[Diagnostic]
    _generated: int = field(default=0)

    def card(self, spec: Spec, items: Sequence[Item], span: Span, label: str = "") -> Card | None:
        """Bind one card; None where it has mistakes."""
        cards = self.cards(spec, items, span, label)
        return cards[0] if cards else None

    def cards(
        self, spec: Spec, items: Sequence[Item], span: Span, label: str = "", generate: bool = False
    ) -> list[Card] | None:
        """Bind a row.

        Parameters
        ----------
        spec : Spec
            What the row holds.
        items : sequence of Item
            The row's items, without those that chose the Spec.
        span : Span
            The whole row.
        label : str
            Label of a property set.
        generate : bool
            A range in the first field generates one card for each of its numbers.

        Returns
        -------
        list of Card or None
            One card, or as many as the row's range generates; None where the row has mistakes.
        """
        before = len(self.report)
        by_field, matched = self._match(spec, items)
        numbers = self._count(spec, by_field) if generate else None
        draft = _Draft(spec, span, label, by_field, numbers, matched, matched)
        fields = list(spec.fields)
        for f in fields:  # grows while FAMILY items add the fields of what they choose
            if f.name not in draft.values:
                fields += self._fill(draft, f)
        for name, item in by_field.items():
            if name not in draft.values and name not in draft.lost:
                self.report.append(self._unknown(name, item, draft))
        return draft.cards() if draft.whole and len(self.report) == before else None

    def _fill(self, draft: _Draft, f: Field) -> Sequence[Field]:
        """Set the value of a field of a card; return the fields of the laws that the value chooses."""
        item = draft.items.get(f.name)
        try:
            value = self._default(f, draft) if item is None else self._value(f, item, draft)
        except Mistake as error:
            draft.whole, draft.values[f.name] = False, None
            error.keep(self.report)
            if f.kind is Kind.FAMILY:
                chosen = self.read.catalog.family(f.family).values()
                draft.lost |= {g.name for s in chosen for g in s.fields}
            return ()
        draft.values[f.name] = value
        if f.kind is not Kind.FAMILY or value is None:
            return ()
        draft.laws[f.name] = self._laws(f, value)
        return [g for law in draft.laws[f.name] for g in law.fields]

    def _match(self, spec: Spec, items: Sequence[Item]) -> tuple[dict[str, Item], bool]:
        """Items by field name, and whether all of them have a field."""
        places = [f.name for f in spec.fields if f.positional]
        by_field: dict[str, Item] = {}
        before, named = len(self.report), False
        for k, item in enumerate(items):
            if item.name:
                named, name = True, item.name
            elif named or k >= len(places):
                if len(self.report) == before:  # one report is enough: the first that is out of place
                    self._out_of_place(spec, named, items[k - 1], item)
                continue
            else:
                name = places[k]
            if name in by_field:
                joined = _joined(spec, name, by_field[name], item)
                hint = hints("take one of them out", f"a list is written {joined}" if joined else "")
                self._error("P212", f"{name} is given twice in this card", item.name_span, hint)
            else:
                by_field[name] = item
        return by_field, len(self.report) == before

    def _out_of_place(self, spec: Spec, named: bool, before: Item, item: Item) -> None:
        if named:
            message = "an item by position stands after a named one"
            self._error("P215", message, item.span, _after_named(spec, before, item))
            return
        places = ", ".join(f.name for f in spec.fields if f.positional)
        hint = "write further items as NAME=value; lists have commas and no blanks: 1,3,5"
        if spec.field(item.word):
            hint = f"write {item.word}=value"
        message = f"one item too many: {spec.name} reads {places or 'nothing'} by position"
        self._error("P214", message, item.span, hint)

    def _default(self, f: Field, draft: _Draft) -> Any:
        if not draft.matched and (f.default is REQUIRED or f.kind is Kind.FAMILY):
            raise Mistake  # what is out of place may be meant for it
        if f.default is REQUIRED:
            raise mistake(
                "P213",
                f"{draft.label or draft.spec.name} needs {self.read.meaning(f)}",
                draft.span,
                _how(f),
            )
        return f.default

    def _laws(self, f: Field, chosen: Any) -> tuple[Spec, ...]:
        names = (chosen,) if isinstance(chosen, str) else tuple(chosen)
        return tuple(self.read.catalog.family(f.family)[name] for name in dict.fromkeys(names))

    def _unknown(self, name: str, item: Item, draft: _Draft) -> Diagnostic:
        spec, laws, takes = draft.spec, draft.laws, [*draft.values]
        chosen = [f"{key}={','.join(s.name for s in specs)}" for key, specs in laws.items()]
        owner = " with ".join([spec.name, ", ".join(chosen)] if chosen else [spec.name])
        elsewhere = [
            f"{key}={other.name}"
            for key in laws
            for f in [_field(spec, laws, key)]
            for other in self.read.catalog.family(f.family).values()
            if other.field(name)
        ]
        belongs = f"{name} belongs to {' or '.join(elsewhere[:4])}" if elsewhere else ""
        hint = hints(belongs or suggest(name, takes), "it takes " + ", ".join(takes))
        return Diagnostic("P211", f"{owner} has no item {name}", item.name_span, hint)

    def _count(self, spec: Spec, items: Mapping[str, Item]) -> Sequence[int] | None:
        """Numbers that a range in the first item generates; None where that is not a range."""
        first = spec.fields[0]
        item = items.get(first.name)
        part = item.parts[0] if item and len(item.parts) == 1 else None
        if not isinstance(part, Range):
            return None
        try:
            return self._members(part, first)
        except Mistake:
            return ()  # the item itself reports it; the ranges beside it need no message of theirs

    def _members(self, part: Range, f: Field) -> Sequence[int]:
        """Whole numbers of an ascending range; empty where its last number is one less than its first."""
        a, b = (self.read.whole(end, f, bounded=False) for end in (part.first, part.last))
        step = self.read.whole(part.step, None) if part.step else 1
        if step < 1:
            raise mistake(
                "P220", f"BY {step} does not ascend", part.span, "BY takes a whole number from 1 on"
            )
        if b == a - 1:
            return ()
        self.read.within(a, part.first, f)
        self.read.within(b, part.last, f)
        if b < a:
            shown = f"the range {a} TO {b} descends"
            hint = f"a range goes from the smaller to the larger number; {a} TO {a - 1} would be none"
            raise mistake("P220", shown, part.span, hint)
        if (b - a) % step:
            end = b - (b - a) % step
            raise mistake(
                "P220",
                f"steps of {step} from {a} do not reach {b}",
                part.span,
                f"write {a} TO {end} BY {step}",
            )
        self._room((b - a) // step + 1, part.span)
        return range(a, b + 1, step)

    def _room(self, count: int, span: Span) -> None:
        if self._generated + count > MAX_GENERATED:
            message = f"{count} more numbers; the ranges of a deck generate at most {MAX_GENERATED}"
            raise mistake("P221", message, span, "check the ends of this range")
        self._generated += count

    def _spread(self, part: Range, f: Field, numbers: Sequence[int]) -> _Steps:
        """Values from the first to the last of a range, evenly spaced, one for each generated card."""
        count = len(numbers)
        whole = f.kind in _WHOLE
        read: Callable[[Expression, Field | None, bool], float] = (
            self.read.whole if whole else self.read.real
        )
        a, b = (read(end, f, count > 0) for end in (part.first, part.last))
        if not count:
            return _Steps(())
        if count == 1 and a != b:
            message = f"{f.name} ranges from {a:g} to {b:g}, but the card generates one number only"
            raise mistake("P220", message, part.span, f"write {f.name} without TO")
        spacing = (b - a) / max(count - 1, 1)
        if whole and count > 1 and (b - a) % (count - 1):
            message = f"{count} steps of {f.name} from {a} to {b} are {spacing:g} apart, not a whole number"
            fits = f"{a} TO {a + count - 1} would step by one"
            raise mistake("P220", message, part.span, fits)
        if part.step and not math.isclose(read(part.step, None, True), spacing, rel_tol=1e-9):
            message = f"BY does not fit: {count} values from {a:g} to {b:g} are {spacing:g} apart"
            raise mistake("P220", message, part.step.span, "leave BY out")
        self._room(count, part.span)
        if whole:
            return _Steps(int(a) + k * (int(b - a) // max(count - 1, 1)) for k in range(count))
        return _Steps(b if k == count - 1 else a + (b - a) * (k / (count - 1)) for k in range(count))

    def _value(self, f: Field, item: Item, draft: _Draft) -> Any:
        if f.kind in _LISTS:
            return self._list(f, item)
        least, most = f.count
        if not least <= len(item.parts) <= most:
            takes = f"{least}" if least == most else f"{least} to {most}"
            message = f"{f.name} takes {takes} value{'s' * (most > 1)}, not {len(item.parts)}"
            raise mistake("P218", message, item.span, self.read.meaning(f))
        if isinstance(item.parts[0], Range):
            part = item.parts[0]
            if f is draft.spec.fields[0] and f.varies:
                return _Steps(draft.numbers or self._members(part, f))
            if draft.numbers is not None and f.varies:
                return self._spread(part, f, draft.numbers)
        values = tuple(self.read.one(f, part) for part in item.parts)
        return values[0] if f.count == (1, 1) else values

    def _list(self, f: Field, item: Item) -> tuple[Any, ...]:
        values: list[Any] = []
        for part in item.parts:
            if isinstance(part, Range) and f.kind in _NUMBERED:
                values += self._members(part, f)
            elif isinstance(part, Range):
                raise mistake(
                    "P219", f"{f.name} takes no range", part.span, "write the labels with commas: A,B,C"
                )
            elif f.kind is Kind.PROPS:
                values.append(self.read.label(part, f.name))
            else:
                values.append(self.read.whole(part, f))
        return tuple(values)

    def _error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.report.append(Diagnostic(code, message, span, hint))


class _Steps(tuple[Any, ...]):
    """Values of a field that differ from one generated card to the next."""

    __slots__ = ()

    def __new__(cls, values: Iterable[Any]) -> _Steps:
        return super().__new__(cls, tuple(values))


def _joined(spec: Spec, name: str, first: Item, second: Item) -> str:
    """Text of both items as one list, where the field may hold several values; else empty."""
    f = spec.field(name)
    several = f is None or f.kind in _LISTS or f.count[1] > 1  # an unknown name may belong to a law
    return f"{name}={first.text},{second.text}"[:80] if several else ""


def _after_named(spec: Spec, before: Item, item: Item) -> str:
    joined = _joined(spec, before.name, before, item)
    if joined:
        unit = f"leave {item.word[:60]} out if it is a unit" if item.word and not before.word else ""
        return hints(unit, f"values of one list are joined by commas without blanks: {joined}")
    return f"{before.name} takes one value; write further items as NAME=value"


def _how(f: Field) -> str:
    if f.kind in _LISTS:
        return f"{_PLURAL[f.kind]} with commas and no blanks"
    return "" if f.positional else f"add {f.name}=value"


def _field(spec: Spec, laws: Mapping[str, tuple[Spec, ...]], name: str) -> Field:
    """Field of that name in the Spec or in one of the chosen laws."""
    owners = [spec, *(s for specs in laws.values() for s in specs)]
    return next(f for owner in owners if (f := owner.field(name)))
