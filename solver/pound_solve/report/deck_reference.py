"""Reference of the deck, for ``pound-solve list`` and for the manual's page; both are made from the Specs.

``python -m pound_solve.report.deck_reference`` prints the page ``manual/deck-reference.md``.
"""

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

#: Each family in the order of the page: heading, start of its line in the deck, where it stands.
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
        Family in any case; all families if left out.
    name : str, optional
        Member of it, by name or old code; all members if left out.

    Returns
    -------
    str
        Lines without a final line end.

    Raises
    ------
    KeyError
        There is no such family or member; the text says what there is.
    """
    known = vocabulary()
    if family is None:
        return "\n".join(_overview(known))
    key = family.lower()
    if key not in known.families():
        raise KeyError(_no_family(known, family))
    members = known.family(key)
    if name is None:
        return "\n".join(_with_items(key, members.values()))
    code = int(name) if name.isdecimal() else None
    spec = members.get(name.upper()) or (known.by_code(key, code) if code is not None else None)
    if spec is None:
        hint = suggest(name, members) or "there are " + ", ".join(members)
        raise KeyError(f"{key} has no {name.upper()}: {hint}")
    return "\n".join(_sheet(spec))


def _no_family(known: Catalog, word: str) -> str:
    owners = [f for f in known.families() if word.upper() in known.family(f)]
    if owners:
        return f"{word.upper()} is no family: write " + " or ".join(
            f"list {f} {word.upper()}" for f in owners
        )
    near = suggest(word, known.families()).lower()
    return f"no family {word}: " + (near or "there are " + ", ".join(_ordered(known)))


def _ordered(known: Catalog) -> list[str]:
    """Names of the families in the order of the page, those not in `_FAMILIES` last."""
    return [
        *(f for f in _FAMILIES if f in known.families()),
        *(f for f in known.families() if f not in _FAMILIES),
    ]


def _family(name: str) -> tuple[str, str, str]:
    return _FAMILIES.get(name, (name.capitalize(), "{name}", ""))


def _overview(known: Catalog) -> list[str]:
    lines = []
    for family in _ordered(known):
        lines += [*_members(family, known.family(family).values()), ""]
    return [*lines, "pound-solve list FAMILY NAME shows the items of one of them."]


def _members(family: str, members: Iterable[Spec]) -> list[str]:
    rows = [(_coded(s), s.title) for s in members]
    wide = max(len(name) for name, _ in rows)
    return [
        f"{family}: {_family(family)[2]}",
        *(f"   {name.ljust(wide)}   {title}" for name, title in rows),
    ]


def _with_items(family: str, members: Iterable[Spec]) -> list[str]:
    """Lines that list the members of a family with the names of their items."""
    specs = list(members)
    wide = max(len(_coded(s)) for s in specs)
    lines = [f"{family}: {_family(family)[2]}"]
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
    rows = [_HEADS, *(_row(f) for f in fields)]
    wide = [max(len(row[i]) for row in rows) for i in range(4)]
    # long limits are wrapped: a column as wide as them would leave no room for the meaning
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
    """Usage of a card: its items in order, in brackets those that may be left out."""
    words = [_family(spec.family)[1].format(name=spec.name)]
    for f in spec.fields:
        word = f.name if f.positional else f"{f.name}="
        words.append(word if f.default is REQUIRED else f"[{word}]")
    return " ".join(w for w in words if w)


def _row(f: Field) -> tuple[str, str, str, str, str]:
    return f.name, f.unit, default(f), takes(f), f.doc


def default(f: Field) -> str:
    """Text of an item's default value; ``must`` where the item is required."""
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


def deck_page() -> str:
    """Text of ``manual/deck-reference.md``."""
    known = vocabulary()
    lines = [_RULES.strip(), ""]
    for family in _ordered(known):
        heading, _, where = _family(family)
        lines += [f"## {heading}", ""]
        if family == "section":
            lines += [_SECTIONS.strip(), ""]
        elif where:
            lines += [f"{where[0].upper()}{where[1:]}.", ""]
        for spec in known.family(family).values():
            lines += [*_chapter(spec), ""]
    return "\n".join(lines).rstrip() + "\n"


def _chapter(spec: Spec) -> list[str]:
    lines = [
        f"### {spec.name}",
        "",
        f"{spec.title[0].upper()}{spec.title[1:]}.",
        "",
        "```",
        usage(spec),
        "```",
    ]
    facts = [f"Old code: {spec.code}."] if spec.code is not None else []
    facts += [f"Reference: {spec.reference}."] if spec.reference else []
    lines += ["", " ".join(facts)] if facts else []
    if not spec.fields:
        return [*lines, "", "No items."]
    lines += ["", "| item | unit | default | takes | meaning |", "|---|---|---|---|---|"]
    for f in spec.fields:
        name, unit, default, choice, doc = (cell.replace("|", r"\|") for cell in _row(f))
        lines.append(f"| `{name}` | {f'`{unit}`' if unit else ''} | {default} | {choice} | {doc} |")
    return lines


_RULES: Final = r"""
# Deck reference

Everything that a deck may hold. The first part says how a deck is written; the rest is made from the
program's own tables by `python -m pound_solve.report.deck_reference`, so it is what the program reads. On a
terminal, `pound-solve list` prints the same tables. New to decks? Start with the [tutorial](tutorial.md).

## Lines

- A deck is a text file. One line is one card. Upper and lower case are the same, except in texts.
- `!` starts a comment, anywhere outside quotes. Blank lines are free.
- A line that ends in `&` goes on in the next one.
- A section's name stands alone on its line; the lines below belong to it until the next section's name.
  Sections stand in any order, may stand more than once, and may refer to what comes later.
- A line that says `END` ends the file.

These cards stand anywhere, once each but for the last two:

| card | meaning | left out |
|---|---|---|
| `TITLE text` | heading of the report | no title |
| `UNITS force length time` | names of the units | `kN m s` |
| `GRAVITY g` | acceleration of gravity; mass = weight / gravity | by the unit of length |
| `MASS LUMPED` or `MASS CONSISTENT` | mass of FRAME members that have a weight | `LUMPED` |
| `GEOMETRY word` | `PDELTA`, `PDELTA_MEMBER`, `PDELTA_VARYING` or `LARGE` displacements | `SMALL` |
| `MEANT codes` | [warnings](messages.md) not to be told, such as `P334,P359`: the deck means it so | none |
| `PARAM name = value` | a name for a number or a text; several on a line are fine | |
| `INCLUDE "file"` | reads another file here; its name counts from the folder of this one | |

Any consistent set of units will do. Nothing is converted: `UNITS` only puts the names into the report,
and chooses the value of gravity: 9.81 for m, 9810 for mm, 981 for cm, 32.174 for ft, 386.09 for in, with
s.

## Items

- Items are separated by blanks. The first ones are read by position, all others as `NAME=value`, in any
  order. An item by position may be written by name too: `NODE=1 X=0 Y=3.5`. After the first named item
  all are named.
- Several values of one item are joined by commas without blanks: `FX=200,-150`.
- An option is a word. Where Ruaumoko has a code for it, that number is read as well; the tables give it
  in brackets.
- A text that is more than one word stands in quotes, single or double.
- What is left out takes its default. The report prints every default that was taken and marks it with
  `*`.

## Numbers and expressions

- Numbers: `3500`, `0.05`, `3.5E6`, `1D-3`.
- Wherever a number may stand, an expression may: `+ - * /`, `^` or `**`, brackets, `pi`, PARAM names, and
  the functions `sqrt sin cos tan asin acos atan exp log log10 abs min max floor ceil round int`. Angles
  are in radians, `log` is the natural logarithm, `round` takes halves away from zero, `int` cuts towards
  zero. Powers go from the right and before a sign: `-2^2` is -4.
- Blanks separate items, so an expression holds none outside brackets: `w/2` or `(w / 2)`. `1 -2` are two
  items.
- `pound-solve model.inp --set n=5 --set record="other.at2"` replaces the value of a PARAM of the deck.

## Ranges and lists

- `11 TO 15` means 11, 12, 13, 14, 15, and `11 TO 15 BY 2` means 11, 13, 15. The ends may be expressions.
- A list of nodes or elements may hold both: `1,5,11 TO 15 BY 2`.
- A range whose end is one below its start, such as `11 TO 10+n` with n = 0, is empty. Others ascend.
- In NODES and ELEMENTS a range in the first place writes one card for each of its numbers. The items
  marked "or range" may then be ranges too: coordinates are spaced evenly from end to end, node numbers
  step along evenly. So `11 TO 15  0 TO 8  3.5` makes five nodes 2 apart at height 3.5.

## Directions and signs

X points to the right, Y upwards, rotations R are anticlockwise. Forces, displacements and accelerations
follow them. End forces of a FRAME member act on the member along its own axes (x from I to J, y to its
left); its axial force is positive in tension. Moments of its hinges (`hinge I`, `hinge J`) are positive
where it sags, with tension on the right of the line from I to J. A spring's deformation is the displacement
of J less that of I. A contact closes as I moves towards J, and its force is positive in compression.

The tables give units in dimensions: `F` force, `L` length, `T` time, `-` a pure number. "must" means that
there is no default.
"""

_SECTIONS: Final = """
PROPS, DAMPING, EQUAKE, FORCES and ANALYSIS hold lines of several kinds, each in a chapter of its own
below: [elements](#elements), [damping](#damping), [ground motions](#ground-motions), [forces in
time](#forces-in-time) and [analyses](#analyses). A line of PROPS starts with a label of your choice, the
others with their kind. An item that takes "one of" a family (`RULE`, `LAW`, `FORMAT`, `METHOD`) brings
the items of the chosen member into its line. The other sections have one kind of line each:
"""

if __name__ == "__main__":
    print(deck_page(), end="")
