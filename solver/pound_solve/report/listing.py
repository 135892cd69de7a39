"""Vocabulary of decks as text, made from the Specs for ``pound-solve list``, editors and the manual."""

from __future__ import annotations

import itertools
import textwrap
from collections.abc import Iterable, Sequence
from typing import Final

from pound_deck.diagnostics import suggest
from pound_deck.schema import REQUIRED, Catalog, Field, Kind, Spec
from pound_deck.sections import SECTIONS
from pound_solve.catalog import specs

WIDTH: Final = 108  #: columns of the listing
_NAMES: Final = 90  #: columns of a list of member names

#: Each family in the order of the page: heading, start of its line in the deck, section of that line.
_FAMILIES: Final = {
    "section": ("Sections", "", "lines of the deck's own sections"),
    "element": ("Elements", "label {name}", "lines of PROPS"),
    "hysteresis": ("Hysteresis rules", "RULE={name}", "RULE of a SPRING in PROPS"),
    "contact": ("Contact laws", "LAW={name}", "LAW of a CONTACT in PROPS"),
    "damper": ("Damper laws", "LAW={name}", "LAW of a DASHPOT in PROPS"),
    "damping": ("Damping", "{name}", "lines of DAMPING"),
    "motion": ("Ground motions", "{name}", "lines of EQUAKE"),
    "force": ("Forces in time", "{name}", "lines of FORCES"),
    "record": ("Record formats", "FORMAT={name}", "FORMAT of a RECORD in EQUAKE or FORCES"),
    "analysis": ("Analyses", "{name}", "lines of ANALYSIS"),
    "method": ("Methods of integration", "METHOD={name}", "METHOD of HISTORY in ANALYSIS"),
}

_KINDS: Final = {
    Kind.TEXT: "text",
    Kind.NODE: "node",
    Kind.NODES: "nodes",
    Kind.ELEMENTS: "elements",
    Kind.PROP: "property label",
    Kind.PROPS: "property labels",
}

_HEADS: Final = ("item", "unit", "default", "takes", "meaning")


def vocabulary() -> Catalog:
    """Return the Specs of the deck's sections and of all families."""
    return Catalog((*SECTIONS, *specs()))


def listing(family: str | None = None, name: str | None = None) -> str:
    """Text of ``pound-solve list [FAMILY [NAME]]``.

    Parameters
    ----------
    family : str, optional
        Family in upper or lower case, or a member of only one family; by default all families.
    name : str, optional
        Its member, by name or old code; by default all members.

    Returns
    -------
    str
        Lines without a final line end.

    Raises
    ------
    KeyError
        No such family or member exists; the message lists the existing ones.
    """
    known = vocabulary()
    if family is None:
        return "\n".join(_overview(known))
    key = family.lower()
    if key not in known.families():
        owners = [f for f in known.families() if family.upper() in known.family(f)]
        if name is not None or len(owners) != 1:
            raise KeyError(_no_family(known, family, owners))
        key, name = owners[0], family
    members = known.family(key)
    if name is None:
        return "\n".join(_with_items(key, members.values()))
    code = int(name) if name.isdecimal() else None
    spec = members.get(name.upper()) or (known.by_code(key, code) if code is not None else None)
    if spec is None:
        hint = suggest(name, members) or "there are " + ", ".join(members)
        raise KeyError(f"{key} has no {name.upper()}: {hint}")
    return "\n".join(_sheet(spec))


def _no_family(known: Catalog, word: str, owners: list[str]) -> str:
    if owners:
        return f"{word.upper()} is no family: write " + " or ".join(
            f"list {f} {word.upper()}" for f in owners
        )
    near = suggest(word, known.families()).lower()
    return f"no family {word}: " + (near or "there are " + ", ".join(ordered_families(known)))


def ordered_families(known: Catalog) -> list[str]:
    """Names of the families in the order of the page, those not in `_FAMILIES` last."""
    return [
        *(f for f in _FAMILIES if f in known.families()),
        *(f for f in known.families() if f not in _FAMILIES),
    ]


def family_in_words(name: str) -> tuple[str, str, str]:
    """Heading of a family, start of its line in a deck, and section of that line."""
    return _FAMILIES.get(name, (name.capitalize(), "{name}", ""))


def _overview(known: Catalog) -> list[str]:
    lines = []
    for family in ordered_families(known):
        lines += [*_members(family, known.family(family).values()), ""]
    return [*lines, "pound-solve list FAMILY NAME shows the items of one of them."]


def _members(family: str, members: Iterable[Spec]) -> list[str]:
    rows = [(_coded(s), s.title) for s in members]
    wide = max(len(name) for name, _ in rows)
    return [
        f"{family}: {family_in_words(family)[2]}",
        *(f"   {name.ljust(wide)}   {title}" for name, title in rows),
    ]


def _with_items(family: str, members: Iterable[Spec]) -> list[str]:
    """Lines that list the members of a family with the names of their items."""
    specs = list(members)
    wide = max(len(_coded(s)) for s in specs)
    lines = [f"{family}: {family_in_words(family)[2]}"]
    for s in specs:
        items = f" ({' '.join(f.name for f in s.fields)})" if s.fields else ""
        lines += _wrapped(f"   {_coded(s).ljust(wide)}   ", s.title + items)
    return lines


def _coded(spec: Spec) -> str:
    return spec.name if spec.code is None else f"{spec.name} ({spec.code})"


def _sheet(spec: Spec) -> list[str]:
    """Lines that describe one Spec: usage, code, reference, example and items."""
    lines = [f"{spec.name}: {spec.title}", ""]
    lines += _wrapped("write      ", usage(spec))
    lines += [f"code       {spec.code}, in place of the name"] if spec.code is not None else []
    lines += _wrapped("reference  ", spec.reference) if spec.reference else []
    lines += _wrapped("example    ", spec.sample) if spec.sample else []
    if not spec.fields:
        return [*lines, "", "It has no items."]
    return [*lines, "", *_items(spec.fields), "", *_wrapped("", _legend(spec.fields))]


def _items(fields: Sequence[Field]) -> list[str]:
    """Lines of a table of items; permitted values and meanings are wrapped within their columns."""
    rows = [_HEADS, *(item_row(f) for f in fields)]
    wide = [max(len(row[i]) for row in rows) for i in range(4)]
    # long limits are wrapped: a column as wide would leave no space for the meaning
    wide[3] = min(wide[3], 24)
    lines = []
    for row in rows:
        start = "  ".join(row[i].ljust(wide[i]) for i in range(3)) + "  "
        limits = textwrap.wrap(row[3], wide[3], break_long_words=False) or [""]
        meaning = textwrap.wrap(row[4], WIDTH - len(start) - wide[3] - 2) or [""]
        for n, (left, right) in enumerate(itertools.zip_longest(limits, meaning, fillvalue="")):
            head = start if n == 0 else " " * len(start)
            lines.append((head + left.ljust(wide[3]) + "  " + right).rstrip())
    return lines


def _wrapped(head: str, text: str) -> list[str]:
    return textwrap.wrap(head + text, WIDTH, subsequent_indent=" " * len(head), break_long_words=False)


def _legend(fields: Sequence[Field]) -> str:
    notes = ["Units: F force, L length, T time, - none."] if any(f.unit for f in fields) else []
    if any(f.positional for f in fields):
        notes.append("Items of the line above without = are read by position.")
    if any(f.default is REQUIRED for f in fields):
        notes.append("'must' has no default.")
    return " ".join(notes)


def usage(spec: Spec) -> str:
    """Usage of a card: its items in order, optional ones in brackets."""
    words = [family_in_words(spec.family)[1].format(name=spec.name)]
    for f in spec.fields:
        word = f.name if f.positional else f"{f.name}="
        words.append(word if f.default is REQUIRED else f"[{word}]")
    return " ".join(w for w in words if w)


def item_row(f: Field) -> tuple[str, str, str, str, str]:
    """Cells that describe an item, one for each of `_HEADS`."""
    return f.name, f.unit, default(f), takes(f), f.doc


def default(f: Field) -> str:
    """Text of an item's default value; ``must`` if the item is required."""
    if f.default is REQUIRED:
        return "must"
    values = f.default if isinstance(f.default, tuple) else (f.default,)
    return ",".join(
        "none" if v in (None, "") else f"{v:g}" if isinstance(v, float) else str(v) for v in values
    )


def takes(f: Field) -> str:
    """Text of an item's permitted values: choices, limits, number of values."""
    text = _one_value(f) + (", or range" if f.varies else "")
    return ", ".join(t for t in (_many(f), text) if t)


def _many(f: Field) -> str:
    """Text of an item's number of values; empty for a single value."""
    least, most = f.count
    if most == 1:
        return ""
    return f"{least} to {most} values" if least < most else f"{most} values"


def _one_value(f: Field) -> str:
    if f.kind is Kind.WORD:
        return ", ".join(f"{w} ({f.codes[w]})" if w in f.codes else w for w in f.words)
    if f.kind is Kind.FLAGS:
        return f"letters of {f.words[0]}"
    if f.kind is Kind.FAMILY:
        return f"one of {f.family}"
    text = " ".join(t for t in (_KINDS.get(f.kind, ""), _limits(f)) if t)
    text = text or ("whole number" if f.kind is Kind.INT else "number")
    return text + "".join(f", or {word}" for word in f.words)


def _limits(f: Field) -> str:
    if f.kind not in (Kind.REAL, Kind.INT):
        return ""
    number = "whole number " if f.kind is Kind.INT else ""
    bounds = ((">", f.above), (">=", f.lo), ("<", f.below), ("<=", f.hi))
    text = ", ".join(f"{sign} {limit:g}" for sign, limit in bounds if limit is not None)
    return number + text if text else ""
