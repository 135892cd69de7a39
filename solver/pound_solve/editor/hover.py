"""Hover text at a place: unit, default, limits and meaning of an item, or the meaning of a word."""

from __future__ import annotations

from pound_deck.cards import Item, ParsedLine
from pound_deck.model import Span, Units
from pound_deck.schema import Field, Kind, Spec
from pound_deck.sections import FAMILIES, NAMES, SECTIONS
from pound_solve.editor.fields import fields
from pound_solve.editor.names import Mention, at, definitions, mentions, words_of
from pound_solve.editor.reading import Reading
from pound_solve.report.listing import default, takes, usage


def hover(reading: Reading, place: Span) -> tuple[str, Span] | None:
    """Text in Markdown on the item at a place, and the item's span; None without an item."""
    for section, row in reading.rows:
        for k, item in enumerate(row.items or ()):
            if _holds(item, place):
                text = _heading(row.word) if row.word in NAMES else _about(reading, section, row, k, place)
                return (text, item.name_span) if text else None
    return None


def _holds(item: Item, place: Span) -> bool:
    first, last = item.name_span, item.span
    inside = first.line == place.line == last.line and first.column <= place.column <= last.end
    return first.file == place.file and inside


def _about(reading: Reading, section: str, row: ParsedLine, k: int, place: Span) -> str:
    known = fields(words_of(row), section, reading.catalog, reading.params)
    item = (row.items or ())[k]
    parts = []
    if k == known.kind_at and known.spec:
        parts.append(describe(known.spec))
    elif k < len(known.matched) and (f := known.matched[k]):
        parts.append(explain(f, reading.units))
        parts += [describe(known.chosen[w]) for w in _words(item) if w in known.chosen]
    mentioned = mentions(reading)
    named = at(mentioned, place)
    if named:
        parts += [_definition(reading, m, named) for m in definitions(mentioned, named)[:1]]
    return "\n\n".join(part for part in parts if part)


def _words(item: Item) -> list[str]:
    return [part.text.upper() for part in item.parts]


def _heading(word: str) -> str:
    section = next((spec for spec in SECTIONS if spec.name == word), None)
    return describe(section) if section else f"**{word}**: lines of the family {FAMILIES[word]}"


def describe(spec: Spec) -> str:
    """Text in Markdown on a Spec: title, usage, source."""
    parts = [f"**{spec.name}**: {spec.title}"]
    parts += [f"```\n{usage(spec)}\n```"] if spec.fields else []
    return "\n\n".join(parts + ([f"Reference: {spec.reference}"] if spec.reference else []))


def explain(f: Field, units: Units) -> str:
    """Text in Markdown on a field: unit, meaning, default and permitted values."""
    unit = f" [{units.text(f.unit)}]" if f.unit else ""
    left_out = default(f)
    missing = "must be given" if left_out == "must" else f"default: {left_out}"
    accepted = takes(f) if f.kind is not Kind.FAMILY else f"one of {f.family}"
    return f"**{f.name}**{unit} {f.doc}\n\n{missing}; takes: {accepted}"


def _definition(reading: Reading, there: Mention, named: Mention) -> str:
    """Text in Markdown on the definition of a name: its line, or the value of a PARAM."""
    if named.sort == "PARAM":
        value = reading.params.get(str(named.key))
        shown = f"{value:.10g}" if isinstance(value, float) else f'"{value}"' if value is not None else "?"
        return f"PARAM **{named.key}** = {shown}"
    line = reading.files[there.span.file].split("\n")[there.span.line - 1].strip()
    return f"{named.sort} **{named.key}**\n```\n{line}\n```"
