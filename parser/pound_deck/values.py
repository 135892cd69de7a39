"""Single values of a deck: a part of an item becomes a number, a text, a word, letters or a label."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from pound_deck.cards import Part
from pound_deck.diagnostics import Mistake, hints, mistake, suggest
from pound_deck.expressions import FUNCTIONS, Expression, ExpressionStep, Range, Value, evaluate
from pound_deck.model import Units
from pound_deck.schema import Catalog, Field, Kind, beyond, outside

_LARGEST: Final = 10**15  #: whole numbers beyond are no longer exact


@dataclass(frozen=True, slots=True)
class Values:
    """Reads the values of a deck.

    Every method raises :class:`~pound_deck.diagnostics.Mistake` if the part has another kind of value.

    Attributes
    ----------
    catalog : Catalog
    params : mapping of str to float, str or None
        PARAM values by upper-case name; None where a mistake is already reported.
    labels : collection of str
        Labels of all property sets, upper case.
    units : Units
        For the messages only.
    """

    catalog: Catalog
    params: Mapping[str, Value | None]
    labels: Collection[str]
    units: Units

    def one(self, f: Field, part: Part) -> Any:
        """Value of a part, read by the kind of its field."""
        if isinstance(part, Range):
            hint = f"give {f.name} one value"
            if f.varies:
                hint = "ranges step along with the card's first item; make that a range too"
            raise mistake("P219", f"{f.name} takes no range here", part.span, hint)
        match f.kind:
            case Kind.REAL:
                return self._instead(part, f) or self.real(part, f)
            case Kind.INT | Kind.NODE:
                return self.whole(part, f)
            case Kind.TEXT:
                return self._text(part, f)
            case Kind.WORD:
                return self.choice(
                    part, f.words, lambda: {code: word for word, code in f.codes.items()}, f.name, f.doc
                )
            case Kind.FLAGS:
                return self._flags(part, f)
            case Kind.PROP:
                return self.label(part, f.name)
            case Kind.FAMILY:
                codes = partial(self.catalog.codes, f.family)
                return self.choice(part, self.catalog.family(f.family), codes, f.name, f.doc)
        raise AssertionError(f.kind)

    def _instead(self, part: Expression, f: Field) -> str:
        """Word that a field takes in place of a number, written or from a PARAM; empty for a number."""
        step = part.lone
        value = self._param(step) if f.words and step and step.kind == "word" else None
        text = value if isinstance(value, str) else step.text if step else ""
        return text.upper() if text.upper() in f.words else ""

    def real(self, part: Expression, f: Field | None, bounded: bool = True) -> float:
        """Number of a sensible magnitude (that of BY where the field is None), within the field's limits if
        `bounded`.
        """
        value = self._number(part, f)
        if wrong := beyond(value, f):
            name, meaning = (f.name, self.meaning(f)) if f else ("BY", "the step of a range")
            raise mistake("P217", f"{name} {wrong}", part.span, meaning)
        return self.within(value, part, f) if bounded else value

    def whole(self, part: Expression, f: Field | None, bounded: bool = True) -> int:
        """Whole number; see `real`."""
        value = self._number(part, f)
        nearest = round(value)
        if not math.isclose(value, nearest, rel_tol=1e-9, abs_tol=1e-9) or abs(nearest) > _LARGEST:
            name = f.name if f else "BY"
            wrong = "too large" if abs(nearest) > _LARGEST else "not a whole number"
            raise mistake(
                "P216", f"{name} is {value:.10g}, {wrong}", part.span, self.meaning(f) if f else ""
            )
        return int(self.within(nearest, part, f)) if bounded else nearest

    def _number(self, part: Expression, f: Field | None) -> float:
        name = f.name if f else "BY"
        meaning = self.meaning(f) if f else "the step of a range"
        try:
            value = evaluate(part, self.params)
        except Mistake as error:
            d = error.diagnostic
            if (
                d and d.code == "P222" and part.lone_word not in FUNCTIONS
            ):  # the place is clearer than the name alone
                known = suggest(part.lone_word, self.params) if part.lone_word else d.hint
                message = f"{name} takes a number, and {d.message}"
                raise mistake("P222", message, d.span or part.span, hints(known, meaning)) from None
            raise
        if isinstance(value, str):
            what = f'"{value[:60]}" is text'
            raise mistake("P216", f"{name} takes a number, and {what}", part.span, meaning)
        return value

    def within(self, value: float, part: Expression, f: Field | None) -> float:
        """Return the value; raise Mistake where it is not within the field's limits."""
        if f and (wrong := outside(value, f)):
            raise mistake("P217", f"{f.name} {wrong}", part.span, self.meaning(f))
        return value

    def _text(self, part: Expression, f: Field) -> str:
        step = part.lone
        if step and step.kind == "text":
            return step.text
        value = self._param(step) if step and step.kind == "word" else None
        if isinstance(value, str):
            return value
        # a number as written is a name (DRIFT 5 ...), but an expression is not
        if step and value is None and part.text == step.text:
            return step.text
        what = f"{part.text[:60]} is " + ("an expression" if value is None else f"the number {value:g}")
        hint = f'put the text in quotes: "{part.text[:60]}"'
        raise mistake("P216", f"{f.name} takes a text, and {what}", part.span, hint)

    def _param(self, step: ExpressionStep) -> Value | None:
        """Value of the PARAM that a step names; None if it names none."""
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
        return text

    def label(self, part: Part, name: str) -> str:
        """Label of a property set, upper case; a whole number is a label too."""
        step = part.lone if isinstance(part, Expression) else None
        text = self._substituted(step, self.labels) if step else ""
        if not step or not text.strip() or (step.kind == "number" and not text.isdecimal()):
            hint = "a label is a word, a whole number, or a text in quotes"
            raise mistake("P216", f"{name} takes the label of a property set", part.span, hint)
        return text

    def choice(
        self,
        part: Part,
        words: Collection[str],
        codes: Callable[[], Mapping[int, str]],
        name: str,
        doc: str = "",
    ) -> str:
        """One of `words`, given as a word, an old numeric code, or a PARAM that holds one of them.

        All words and codes are asked for only where the word is not among them: a family of laws need not
        be imported for one.
        """
        step = part.lone if isinstance(part, Expression) else None
        # a word may hold a slash: CM/S2
        text = self._substituted(step, words) if step else part.text.upper()
        if text in words:
            return text
        number, known = _code(text), codes()
        if number is not None and number in known:
            return known[number]
        shown, choices = (step or part).text[:60], list(words)
        listed = ", ".join(f"{w} ({c})" for c, w in sorted(known.items())) if number is not None else ""
        hint = hints(
            suggest(text, choices), "choose " + (listed or ", ".join(choices) or "nothing: none exist"), doc
        )
        raise mistake("P210", f"{name} cannot be {shown}", part.span, hint)

    def _substituted(self, step: ExpressionStep, known: Collection[str]) -> str:
        """Text of a step in upper case; for an unknown word that names a PARAM, the PARAM's value."""
        text = step.text.upper()
        if step.kind != "word" or text in known:
            return text
        value = self._param(step)
        if value is None:
            return text
        return value.upper() if isinstance(value, str) else f"{value:.15g}"

    def meaning(self, f: Field) -> str:
        """Name, unit and meaning of a field, for messages."""
        unit = self.units.text(f.unit)
        return f.name + (f" [{unit}]" if f.unit else "") + (f": {f.doc}" if f.doc else "")


def _are_flags(text: str, letters: str) -> bool:
    return bool(text) and set(text) <= set(letters) and len(set(text)) == len(text)


def _code(text: str) -> int | None:
    """Whole number of up to nine digits given by a text; else None."""
    return int(text) if text.isascii() and text.isdecimal() and len(text) < 10 else None
