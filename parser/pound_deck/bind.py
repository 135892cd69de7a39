"""Rows + Specs -> Cards: every item is matched to its field, evaluated, checked and given its type."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from pound_deck.cards import Item, Part
from pound_deck.diagnostics import Diagnostic, Mistake, hints, mistake, suggest
from pound_deck.expressions import FUNCTIONS, Expression, Range, Step, Value, evaluate
from pound_deck.model import Card, Span, Units
from pound_deck.schema import REQUIRED, Catalog, Field, Kind, Spec

MAX_GENERATED: Final = 200_000
_LARGEST: Final = 10**15  #: whole numbers beyond are no longer exact
_LISTS: Final = {Kind.NODES, Kind.ELEMENTS, Kind.PROPS}
_NUMBERED: Final = {Kind.NODES, Kind.ELEMENTS}
_WHOLE: Final = {Kind.INT, Kind.NODE, Kind.NODES, Kind.ELEMENTS}
_PLURAL: Final = {
    Kind.NODES: "node numbers",
    Kind.ELEMENTS: "element numbers",
    Kind.PROPS: "property labels",
}


@dataclass(slots=True)
class Binder:
    """Binds the items of a deck.

    Attributes
    ----------
    catalog : Catalog
    params : mapping of str to float, str or None
        PARAM values by upper-case name; None where a mistake is already reported.
    labels : collection of str
        Labels of all property sets, upper case.
    units : Units
        For the messages only.
    report : list of Diagnostic
        Receives every mistake.
    """

    catalog: Catalog
    params: Mapping[str, Value | None]
    labels: Iterable[str]
    units: Units
    report: list[Diagnostic]
    _generated: int = field(default=0)

    def card(self, spec: Spec, items: Sequence[Item], span: Span, label: str = "") -> Card | None:
        """Bind one card; None where it has mistakes."""
        cards = self.cards(spec, items, span, label)
        return cards[0] if cards else None

    def cards(
        self, spec: Spec, items: Sequence[Item], span: Span, label: str = "", generate: bool = False
    ) -> list[Card]:
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
        list of Card
            One card, as many as the row's range generates, or none where the row has mistakes.
        """
        before = len(self.report)
        given, whole = self._match(spec, items)
        numbers = self._count(spec, given) if generate else ()
        values: dict[str, Any] = {}
        laws: dict[str, tuple[Spec, ...]] = {}
        lost: set[str] = set()  # names that a FAMILY item with a mistake might have brought along
        fields = list(spec.fields)
        for f in fields:  # grows while FAMILY items add the fields of what they choose
            if f.name in values:
                continue
            item = given.get(f.name)
            try:
                if item is None:
                    values[f.name] = self._default(f, spec, label, span)
                else:
                    values[f.name] = self._value(f, item, spec, numbers)
            except Mistake as error:
                whole = False
                values[f.name] = None
                if error.diagnostic:
                    self.report.append(error.diagnostic)
                if f.kind is Kind.FAMILY:
                    lost |= {g.name for s in self.catalog.family(f.family).values() for g in s.fields}
                continue
            if f.kind is Kind.FAMILY and values[f.name] is not None:
                laws[f.name] = self._laws(f, values[f.name])
                fields += [g for law in laws[f.name] for g in law.fields]
        for name, item in given.items():
            if name not in values and name not in lost:
                self.report.append(self._unknown(name, item, spec, laws, [*values]))
        if not whole or len(self.report) > before:
            return []
        spans = {name: item.span for name, item in given.items()}
        if not numbers:
            return [Card(spec, values, span, label, laws, spans)]
        varying = {name for name, value in values.items() if isinstance(value, _Steps)}
        return [
            Card(
                spec, {n: v[k] if n in varying else v for n, v in values.items()}, span, label, laws, spans
            )
            for k in range(len(numbers))
        ]

    def _match(self, spec: Spec, items: Sequence[Item]) -> tuple[dict[str, Item], bool]:
        """Items by field name, and whether all of them found one."""
        places = [f.name for f in spec.fields if f.positional]
        given: dict[str, Item] = {}
        before, named = len(self.report), False
        for k, item in enumerate(items):
            if item.name:
                named, name = True, item.name
            elif named:
                joined = f"{items[k - 1].name or 'X'}=1,2"
                hint = f"several values of one item are joined by commas without blanks: {joined}"
                self._error("P215", "an item by position stands after a named one", item.span, hint)
                break
            elif k >= len(places):
                takes = f"{spec.name} reads {', '.join(places) or 'nothing'} by position"
                hint = "write further items as NAME=value; lists have commas and no blanks: 1,3,5"
                if spec.field(item.word):
                    hint = f"write {item.word}=value"
                self._error("P214", f"one item too many: {takes}", item.span, hint)
                break
            else:
                name = places[k]
            if name in given:
                self._error(
                    "P212", f"{name} is given twice in this card", item.name_span, "take one of them out"
                )
            else:
                given[name] = item
        return given, len(self.report) == before

    def _default(self, f: Field, spec: Spec, label: str, span: Span) -> Any:
        if f.default is REQUIRED:
            raise mistake("P213", f"{label or spec.name} needs {self._meaning(f)}", span, _how(f))
        return f.default

    def _laws(self, f: Field, chosen: Any) -> tuple[Spec, ...]:
        names = (chosen,) if isinstance(chosen, str) else tuple(chosen)
        return tuple(self.catalog.family(f.family)[name] for name in dict.fromkeys(names))

    def _unknown(
        self, name: str, item: Item, spec: Spec, laws: Mapping[str, tuple[Spec, ...]], takes: list[str]
    ) -> Diagnostic:
        chosen = [f"{key}={','.join(s.name for s in specs)}" for key, specs in laws.items()]
        owner = " with ".join([spec.name, ", ".join(chosen)] if chosen else [spec.name])
        elsewhere = [
            f"{key}={other.name}"
            for key in laws
            for f in [_field(spec, laws, key)]
            for other in self.catalog.family(f.family).values()
            if other.field(name)
        ]
        belongs = f"{name} belongs to {' or '.join(elsewhere[:4])}" if elsewhere else ""
        hint = hints(belongs or suggest(name, takes), "it takes " + ", ".join(takes))
        return Diagnostic("P211", f"{owner} has no item {name}", item.name_span, hint)

    def _count(self, spec: Spec, given: Mapping[str, Item]) -> Sequence[int]:
        """Numbers that the first item's range generates; empty where it is no range."""
        first = spec.fields[0]
        item = given.get(first.name)
        part = item.parts[0] if item and len(item.parts) == 1 else None
        if not isinstance(part, Range):
            return ()
        try:
            return self._members(part, first)
        except Mistake:
            return ()  # the item itself reports it

    def _members(self, part: Range, f: Field) -> Sequence[int]:
        """Whole numbers of an ascending range."""
        a, b = self._whole(part.first, f), self._whole(part.last, f)
        step = self._whole(part.step, None) if part.step else 1
        if step < 1:
            raise mistake(
                "P220", f"BY {step} does not ascend", part.span, "BY takes a whole number from 1 on"
            )
        if b < a:
            shown = f"the range {a} TO {b} descends"
            raise mistake("P220", shown, part.span, "a range goes from the smaller to the larger number")
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
        """One value for each generated card, evenly spaced."""
        count = len(numbers)
        whole = f.kind in _WHOLE
        read: Callable[[Expression, Field | None], float] = self._whole if whole else self._real
        a, b = read(part.first, f), read(part.last, f)
        if count == 1 and a != b:
            message = f"{f.name} ranges from {a:g} to {b:g}, but the card generates one number only"
            raise mistake("P220", message, part.span, f"write {f.name} without TO")
        spacing = (b - a) / max(count - 1, 1)
        if whole and count > 1 and (b - a) % (count - 1):
            message = f"{count} steps of {f.name} from {a} to {b} are {spacing:g} apart, not a whole number"
            fits = f"{a} TO {a + count - 1} would step by one"
            raise mistake("P220", message, part.span, fits)
        if part.step and not math.isclose(read(part.step, None), spacing, rel_tol=1e-9):
            message = f"BY does not fit: {count} values from {a:g} to {b:g} are {spacing:g} apart"
            raise mistake("P220", message, part.step.span, "leave BY out")
        self._room(count, part.span)
        if whole:
            return _Steps(int(a) + k * (int(b - a) // max(count - 1, 1)) for k in range(count))
        return _Steps(b if k == count - 1 else a + (b - a) * (k / (count - 1)) for k in range(count))

    def _value(self, f: Field, item: Item, spec: Spec, numbers: Sequence[int]) -> Any:
        if f.kind in _LISTS:
            return self._list(f, item)
        least, most = f.count
        if not least <= len(item.parts) <= most:
            takes = f"{least}" if least == most else f"{least} to {most}"
            message = f"{f.name} takes {takes} value{'s' * (most > 1)}, not {len(item.parts)}"
            raise mistake("P218", message, item.span, self._meaning(f))
        if isinstance(item.parts[0], Range):
            part = item.parts[0]
            if f is spec.fields[0] and f.varies:
                return _Steps(numbers) if numbers else _Steps(self._members(part, f))
            if numbers and f.varies:
                return self._spread(part, f, numbers)
        values = tuple(self._one(f, part) for part in item.parts)
        return values[0] if f.count == (1, 1) else values

    def _one(self, f: Field, part: Part) -> Any:
        if isinstance(part, Range):
            hint = f"give {f.name} one value"
            if f.varies:
                hint = "ranges step along with the card's first item; make that a range too"
            raise mistake("P219", f"{f.name} takes no range here", part.span, hint)
        match f.kind:
            case Kind.REAL:
                return self._real(part, f)
            case Kind.INT | Kind.NODE:
                return self._whole(part, f)
            case Kind.TEXT:
                return self._text(part, f)
            case Kind.WORD:
                codes = {code: word for word, code in f.codes.items()}
                return self.choice(part, f.words, codes, f.name, f.doc)
            case Kind.FLAGS:
                return self._flags(part, f)
            case Kind.PROP:
                return self.label(part, f.name)
            case Kind.FAMILY:
                specs = self.catalog.family(f.family)
                codes = {s.code: s.name for s in specs.values() if s.code is not None}
                return self.choice(part, specs, codes, f.name, f.doc)
        raise AssertionError(f.kind)

    def _list(self, f: Field, item: Item) -> tuple[Any, ...]:
        out: list[Any] = []
        for part in item.parts:
            if isinstance(part, Range) and f.kind in _NUMBERED:
                out += self._members(part, f)
            elif isinstance(part, Range):
                raise mistake(
                    "P219", f"{f.name} takes no range", part.span, "write the labels with commas: A,B,C"
                )
            elif f.kind is Kind.PROPS:
                out.append(self.label(part, f.name))
            else:
                out.append(self._whole(part, f))
        return tuple(out)

    def _real(self, part: Expression, f: Field | None) -> float:
        value = self._number(part, f)
        return self._limits(value, part, f)

    def _whole(self, part: Expression, f: Field | None) -> int:
        value = self._number(part, f)
        nearest = round(value)
        if not math.isclose(value, nearest, rel_tol=1e-9, abs_tol=1e-9) or abs(nearest) > _LARGEST:
            name = f.name if f else "BY"
            wrong = "too large" if abs(nearest) > _LARGEST else "not a whole number"
            raise mistake(
                "P216", f"{name} is {value:.10g}, {wrong}", part.span, self._meaning(f) if f else ""
            )
        return int(self._limits(nearest, part, f))

    def _number(self, part: Expression, f: Field | None) -> float:
        name = f.name if f else "BY"
        meaning = self._meaning(f) if f else "the step of a range"
        try:
            value = evaluate(part, self.params)
        except Mistake as error:
            d = error.diagnostic
            if (
                d and d.code == "P222" and part.lone_word not in FUNCTIONS
            ):  # the place tells more than the name alone
                known = suggest(part.lone_word, self.params) if part.lone_word else d.hint
                message = f"{name} takes a number, and {d.message}"
                raise mistake("P222", message, d.span or part.span, hints(known, meaning)) from None
            raise
        if isinstance(value, str):
            what = f'"{value[:60]}" is text'
            raise mistake("P216", f"{name} takes a number, and {what}", part.span, meaning)
        return value

    def _limits(self, value: float, part: Expression, f: Field | None) -> float:
        if f and not _inside(value, f):
            raise mistake(
                "P217", f"{f.name} is {value:.10g}, but must be {_allowed(f)}", part.span, self._meaning(f)
            )
        return value

    def _text(self, part: Expression, f: Field) -> str:
        step = part.lone
        if step and step.kind == "text":
            return step.text
        value = self._param(step) if step and step.kind == "word" else None
        if isinstance(value, str):
            return value
        if step and step.kind == "word" and value is None:
            return step.text
        what = (
            f"{step.text} is the number {value:g}"
            if step and value is not None
            else "this is a number or an expression"
        )
        raise mistake("P216", f"{f.name} takes a text, and {what}", part.span, "put the text in quotes")

    def _param(self, step: Step) -> Value | None:
        """Value of the PARAM of that name, None where there is none."""
        name = step.text.upper()
        if name in self.params and self.params[name] is None:
            raise Mistake
        return self.params.get(name)

    def _flags(self, part: Expression, f: Field) -> str:
        letters = f.words[0]
        step = part.lone
        text = step.text.upper() if step else ""
        if step and step.kind == "word" and not _are_flags(text, letters):
            value = self._param(step)
            text = value.upper() if isinstance(value, str) else "0" if value == 0 else text
        if text in ("NONE", "0"):
            return ""
        if not _are_flags(text, letters):
            shown = step.text if step else "an expression"
            message = f"{f.name} takes letters out of {letters}, each once, and not {shown[:60]}"
            raise mistake(
                "P210", message, part.span, hints(f"for example {letters[:2]}; NONE for none", f.doc)
            )
        return "".join(letter for letter in letters if letter in text)

    def label(self, part: Part, name: str) -> str:
        """Label of a property set, upper case; a whole number is a label too."""
        step = part.lone if isinstance(part, Expression) else None
        text = step.text.upper() if step else ""
        if step and step.kind == "word" and text not in self.labels:
            value = self._param(step)
            if value is not None:
                text = value.upper() if isinstance(value, str) else f"{value:.15g}"
        if not step or not text.strip() or (step.kind == "number" and not text.isdecimal()):
            hint = "a label is a word, a whole number, or a text in quotes"
            raise mistake("P216", f"{name} takes the label of a property set", part.span, hint)
        return text

    def choice(
        self, part: Part, words: Iterable[str], codes: Mapping[int, str], name: str, doc: str = ""
    ) -> str:
        """One of `words`, given as a word, an old numeric code, or a PARAM that holds one of them."""
        choices = list(words)
        step = part.lone if isinstance(part, Expression) else None
        text = step.text.upper() if step else ""
        if step and step.kind == "word" and text not in choices:
            value = self._param(step)
            if value is not None:
                text = value.upper() if isinstance(value, str) else f"{value:.15g}"
        if text in choices:
            return text
        number = _code(text)
        if number is not None and number in codes:
            return codes[number]
        shown = step.text[:60] if step else "an expression"
        listed = ", ".join(f"{w} ({c})" for c, w in sorted(codes.items())) if number is not None else ""
        hint = hints(
            suggest(text, choices), "choose " + (listed or ", ".join(choices) or "nothing: none exist"), doc
        )
        raise mistake("P210", f"{name} cannot be {shown}", part.span, hint)

    def _meaning(self, f: Field) -> str:
        unit = self.units.text(f.unit)
        return f.name + (f" [{unit}]" if f.unit else "") + (f": {f.doc}" if f.doc else "")

    def _error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.report.append(Diagnostic(code, message, span, hint))


class _Steps(tuple[Any, ...]):
    """Values of a field that differ from one generated card to the next."""

    __slots__ = ()

    def __new__(cls, values: Iterable[Any]) -> _Steps:
        return super().__new__(cls, tuple(values))


def _how(f: Field) -> str:
    if f.kind in _LISTS:
        return f"{_PLURAL[f.kind]} with commas and no blanks"
    return "" if f.positional else f"add {f.name}=value"


def _field(spec: Spec, laws: Mapping[str, tuple[Spec, ...]], name: str) -> Field:
    """Field of that name of the Spec or of one of the laws that joined it."""
    owners = [spec, *(s for specs in laws.values() for s in specs)]
    return next(f for owner in owners if (f := owner.field(name)))


def _are_flags(text: str, letters: str) -> bool:
    return bool(text) and set(text) <= set(letters) and len(set(text)) == len(text)


def _code(text: str) -> int | None:
    """The whole number that a text is, or None."""
    return int(text) if text.isascii() and text.isdecimal() and len(text) < 10 else None


def _inside(value: float, f: Field) -> bool:
    return (
        (f.lo is None or value >= f.lo)
        and (f.hi is None or value <= f.hi)
        and (f.above is None or value > f.above)
        and (f.below is None or value < f.below)
    )


def _allowed(f: Field) -> str:
    low = f"at least {f.lo:g}" if f.lo is not None else f"above {f.above:g}" if f.above is not None else ""
    high = f"at most {f.hi:g}" if f.hi is not None else f"below {f.below:g}" if f.below is not None else ""
    return " and ".join(part for part in (low, high) if part)
