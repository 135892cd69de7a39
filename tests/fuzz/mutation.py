"""Texts changed in the units of their grammar: lines, items, values, labels, ranges, sections, files.

`mutated` changes a deck, `damaged` any text of lines and columns, such as a record.  Both depend on the
given source of random numbers alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cache
from random import Random

from pound_deck.schema import Spec
from pound_deck.sections import NAMES
from pound_solve.catalog import catalog

# fmt: off
FAMILIES = (
    "element", "hysteresis", "contact", "damper", "damping", "motion", "force", "record", "analysis",
    "method",
)
#: values at and beyond the bounds of what a number is
EXTREMES = (
    "0", "-0", "1", "-1", "2", "0.5", "1.5", "1E-9", "1E9", "1E-30", "1E30", "-1E30", "1E154", "1E300",
    "-1E300", "1E-300", "4.9E-324", "1E308", "1E309", "-1E309", "1E99999", "nan", "inf", "-inf", "1D3",
    "1d-3", "1e", "2147483647", "2147483648", "-2147483649", "9223372036854775808", "1000000",
    "999999999999", "0x10", "1_000", "1,5", "1.2.3", "+", "-", ".", "1+", "\u0663",
    "9" * 400, "9" * 5000, "0." + "0" * 400 + "1",
)
FORMULAS = (
    "1/0", "0/0", "sqrt(-1)", "log(0)", "exp(1000)", "10**400", "2**2**2**2**2", "(-8)**(1/3)",
    "1e308*10", "pi", "x", "n", "n+1", "min()", "max(1,2,3)", "min(1)", "abs(-3)", "floor(1e300)",
    "sin(1e300)", "(1)(2)", "()", "2*(3", "3)", "-(-(-1))", "--1", "1/3", "9**9**9", "0**0", "0**-1",
    "(0-1)**0.5", "5%3", "a.b", "\u221a2", "1 2",
)
#: numbers and words where a command line takes a number
WRONG = (
    "nan", "NaN", "inf", "-inf", "Infinity", "-1", "0", "-0.0", "1e400", "", " ", "word", "0.01", "0.02",
    "1e-3", "1e-7", "0.5", "5e-324", "1e-31", "1e31", "1e300", "1__0", "\udcff", "--", "-", "x=y", "1,2",
    "None",
)
RANGES = (
    "1 TO 1000000000", "1 TO 5 BY 0", "5 TO 1", "1 TO 5 BY -1", "1 TO", "TO 5", "1 TO 2 TO 3", "1,1,1",
    "1,,2", ",", "1,", "1 TO 1E300", "1.5 TO 3.5", "-3 TO 3", "1 TO 100000 BY 3", "1 TO 5 BY 1E-9",
    "1,2,3 TO 5,7", "nan TO 1", "0 TO 0",
)
#: characters that are no part of a deck, or have a meaning of their own
ODD = (
    "\u0000", "\ufeff", "\u2212", "\u00a0", "\u202e", "\u200b", "\u0085", "\u2028", "\f", "\t", "\"",
    "'", "&", "!", "=", "(", ")", ",", "#", "*", "/", "\\", "\r", "\u00e9", "\U0001f4a5", "\u007f",
    "\u0001", "$", ";", "\u001b[31m", "==", "&\n", "& & &", "{}", "%s",
)
# fmt: on
#: texts that mean something to what shows them: formulas, pages, tables, shells, paths
TEXTS = (
    "cost $5_a^",
    "$\\frac{1}{0$",
    "$$",
    "\\badcommand{",
    "</title><script>alert(1)</script>",
    "-->",
    "]]>",
    "<img src=x onerror=alert(2)>",
    "&amp;&lt;&#0;",
    "%s%n%d{0}{}{x!r}",
    "=1+1",
    "@SUM(1)",
    "+1",
    "-2",
    "../../elsewhere",
    "/",
    "nul",
    "a/b",
    "C:\\x",
    "\\0",
    "\\",
    "'",
    "`x`",
    "$(x)",
    "\u00e9\u0301\u4e2d\U0001f4a5",
    "\u202eabc",
    "\u200b",
    "_legend",
    "__",
    "^",
    "x" * 300,
    "long name " * 40,
    "nan",
    "1",
    ",",
    ";",
    "#",
    "|",
)
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
GIVEN = re.compile(rf"(?<==){NUMBER.pattern}")  #: value of a named item
WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
Lines = list[str]


def mutated(text: str, rng: Random, others: Sequence[str], ways: Sequence[int] = (1, 1, 2, 4)) -> str:
    """A deck with as many changes as one of `ways`; lines come over from `others`."""
    lines = text.split("\n")
    for _ in range(rng.choice(ways)):
        rng.choice(MUTATIONS)(lines, rng, others)
        lines = lines or [""]
    return "\n".join(lines)


def revalued(text: str, rng: Random, most: int = 2) -> str:
    """A deck with other values, most of them near the old ones: it is likely to run."""
    lines = text.split("\n")
    for _ in range(rng.randint(1, most)):
        rng.choice((_scale, _scale, _scale, _scale, _scale, _scale, _value, _word, _drop))(lines, rng, ())
    return "\n".join(lines)


def rescaled(text: str, rng: Random) -> str:
    """A text with one other number, most of them of a near magnitude: it is likely to be taken."""
    lines = text.split("\n")
    factor = rng.choice((-1.0, 0.0, 1e-9, 1e-3, 0.5, 0.9, 1.000001, 2.0, 10.0, 1e6))
    _replace(lines, rng, NUMBER, lambda old: f"{float(old) * factor:.9g}")
    return "\n".join(lines)


def damaged(text: str, rng: Random) -> str:
    """A text of lines and columns with one to three changes."""
    lines = text.split("\n")
    for _ in range(rng.randint(1, 3)):
        rng.choice(PLAIN)(lines, rng, ())
        lines = lines or [""]
    return "\n".join(lines)


def encoded(text: str, rng: Random, share: float = 0.1) -> bytes:
    """A text as bytes, a share of them not as the plain UTF-8 that a deck is."""
    plain = text.encode("utf-8", "surrogatepass")
    if rng.random() > share:
        return plain
    codes = [
        "utf-16",
        "utf-16-le",
        "utf-16-be",
        "utf-32",
        "utf-8-sig",
        "latin-1",
        "cp1252",
        "utf-7",
        "cp500",
    ]
    way = rng.randrange(len(codes) + 6)
    if way < len(codes):
        return text.encode(codes[way], "replace")
    if way == len(codes):
        return plain.replace(b"\n", b"\r\n")
    if way == len(codes) + 1:
        return plain.replace(b"\n", b"\r")
    if way == len(codes) + 2:
        return b"\x1f\x8b" + plain
    at = rng.randint(0, len(plain))
    if way == len(codes) + 3:
        return plain[:at]
    if way == len(codes) + 4:
        return plain[:at] + b"\0" * rng.choice((1, 512)) + plain[at:]
    return plain[:at] + rng.randbytes(rng.randint(1, 8)) + plain[at:]


# ---------------------------------------------------------------- words of the language


@cache
def words() -> tuple[str, ...]:
    """Names that a deck may hold: sections, cards, members of all families, their items and their words."""
    members = [spec for family in FAMILIES for spec in catalog().family(family).values()]
    names = {*NAMES, "TITLE", "UNITS", "PARAM", "GRAVITY", "GEOMETRY", "INCLUDE", "END", "TO", "BY", "XYR"}
    return tuple(sorted(names | {w for spec in members for w in (spec.name, *_items(spec))}))


@cache
def items() -> tuple[str, ...]:
    """Names of items."""
    members = [spec for family in FAMILIES for spec in catalog().family(family).values()]
    return tuple(sorted({field.name for spec in members for field in spec.fields}))


def _items(spec: Spec) -> list[str]:
    return [word for field in spec.fields for word in (field.name, *field.words)]


def number(rng: Random) -> str:
    """What is given where a number is asked for, on a command line, which holds no zero character."""
    pool = rng.choice((EXTREMES, FORMULAS, WRONG, WRONG, words()))
    return rng.choice(pool)


def text(rng: Random) -> str:
    """A text with a meaning for somebody, or a mixture of characters."""
    if rng.random() < 0.7:
        return rng.choice(TEXTS)
    return "".join(
        rng.choice((*ODD, "a", " ", "_", "^", "{", "}", "<", ">")) for _ in range(rng.randint(1, 9))
    )


def _any_value(rng: Random) -> str:
    pool: Sequence[str] = rng.choice((EXTREMES, EXTREMES, FORMULAS, RANGES, words()))
    return rng.choice(pool)


# ---------------------------------------------------------------- changes of lines


def _at(lines: Lines, rng: Random) -> int:
    """A line that is not blank, if there is one."""
    filled = [k for k, line in enumerate(lines) if line.strip()]
    return rng.choice(filled) if filled else 0


def _drop(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    del lines[_at(lines, rng)]


def _double(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k = _at(lines, rng)
    lines[k:k] = [lines[k]] * rng.choice((1, 1, 1, 50))


def _swap(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    a, b = _at(lines, rng), _at(lines, rng)
    lines[a], lines[b] = lines[b], lines[a]


def _foreign(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    """Lines of another deck."""
    more = rng.choice(others).split("\n") if others else lines
    k = rng.randrange(len(more))
    at = rng.randint(0, len(lines))
    lines[at:at] = more[k : k + rng.choice((1, 1, 3, 20))]


def _cut(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    """The end is missing."""
    k = _at(lines, rng)
    lines[k:] = [lines[k][: rng.randint(0, len(lines[k]))]]


def _continue(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k = _at(lines, rng)
    if rng.random() < 0.5:
        lines[k] += " &"
    else:
        at = rng.randint(0, len(lines[k]))
        lines[k : k + 1] = [lines[k][:at] + "&", lines[k][at:]]


def _section(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    """A section twice, away, in another place, or with another heading."""
    heads = [k for k, line in enumerate(lines) if line.split()[:1] and line.split()[0].upper() in NAMES]
    if not heads:
        lines.insert(0, rng.choice(sorted(NAMES)))
        return
    k = rng.choice(heads)
    end = next((h for h in heads if h > k), len(lines))
    block = lines[k:end]
    way = rng.randrange(4)
    if way == 0:
        lines += block
    elif way == 1:
        del lines[k:end]
    elif way == 2:
        del lines[k:end]
        at = rng.randint(0, len(lines))
        lines[at:at] = block
    else:
        lines[k] = rng.choice(sorted(NAMES))


def _include(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    name = rng.choice(
        ("part.inc", "deck.inp", "missing.inc", ".", "..", '"part.inc"', "", "/dev/null", "a b", "x" * 300)
    )
    lines.insert(rng.randint(0, len(lines)), f"INCLUDE {name}")


# ---------------------------------------------------------------- changes of items


def _items_of(lines: Lines, rng: Random) -> tuple[int, list[str]]:
    k = _at(lines, rng)
    return k, lines[k].split()


def _drop_item(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k, parts = _items_of(lines, rng)
    if parts:
        del parts[rng.randrange(len(parts))]
    lines[k] = " " + " ".join(parts)


def _double_item(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k, parts = _items_of(lines, rng)
    if parts:
        j = rng.randrange(len(parts))
        parts[j:j] = [parts[j]] * rng.choice((1, 1, 1, 300))
    lines[k] = " " + " ".join(parts)


def _swap_items(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k, a = _items_of(lines, rng)
    m, b = _items_of(lines, rng)
    if k != m and a and b:
        i, j = rng.randrange(len(a)), rng.randrange(len(b))
        a[i], b[j] = b[j], a[i]
        lines[k], lines[m] = " " + " ".join(a), " " + " ".join(b)


def _add_item(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k = _at(lines, rng)
    lines[k] += f"  {rng.choice(items())}={_any_value(rng)}"


def _replace(lines: Lines, rng: Random, pattern: re.Pattern[str], new: Callable[[str], str]) -> None:
    """Another text for one place of a pattern, in a line that has it."""
    having = [k for k, line in enumerate(lines) if pattern.search(line)]
    if having:
        k = rng.choice(having)
        found = rng.choice(list(pattern.finditer(lines[k])))
        lines[k] = lines[k][: found.start()] + new(found[0]) + lines[k][found.end() :]


def _value(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    _replace(lines, rng, NUMBER, lambda _: _any_value(rng))


def _scale(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    factor = rng.choice(
        (-1.0, 0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.999999, 1.000001, 2.0, 10.0, 1e3, 1e6, 1e12)
    )
    _replace(lines, rng, GIVEN, lambda old: f"{float(old) * factor:.9g}")


def _label(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    """A whole number of the deck in the place of another."""
    known = re.findall(r"(?<![\w.])\d+(?![\w.])", "\n".join(lines)) or ["1"]
    _replace(lines, rng, re.compile(r"(?<![\w.])\d+(?![\w.])"), lambda _: rng.choice(known))


def _word(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    _replace(lines, rng, WORD, lambda _: rng.choice(words()))


def _misspell(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    def wrong(old: str) -> str:
        at = rng.randrange(len(old))
        return rng.choice((old[:at] + old[at + 1 :], old[:at] + "Q" + old[at:], old.swapcase(), old * 40))

    _replace(lines, rng, WORD, wrong)


def _nest(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    depth = rng.choice((3, 30, 49, 51, 200, 5000))
    deep = rng.choice(
        (
            "(" * depth + "1" + ")" * depth,
            "-" * depth + "1",
            "+".join("1" for _ in range(depth)),
            "**".join("1" for _ in range(depth)),
            "sqrt(" * depth + "1" + ")" * depth,
            "(" * depth,
            "max(" * depth + "1" + ",1)" * depth,
        )
    )
    _replace(lines, rng, NUMBER, lambda _: deep)


def _chain(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    """PARAMs that name one another, in a ring or without an end."""
    n = rng.choice((2, 50)) if rng.random() < 0.97 else 2000
    last = rng.choice(("1", "q0", "q0*1e300", "missing"))
    chain = [f"PARAM q{k} = q{k + 1}+q{k + 1}" for k in range(n)] + [f"PARAM q{n} = {last}"]
    rng.shuffle(chain)
    lines[:0] = chain


def _long(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k = _at(lines, rng)
    tail = rng.choice(("x", "9", " 1", " A=1", "(", '"', ",1", "! ", "1.", "=", "é"))
    lines[k] += " " + tail * (rng.choice((300, 3000, 30_000, 101_000)) // len(tail))


def _odd(lines: Lines, rng: Random, others: Sequence[str]) -> None:
    k = rng.randrange(len(lines))
    at = rng.randint(0, len(lines[k]))
    lines[k] = lines[k][:at] + rng.choice(ODD) + lines[k][at + rng.choice((0, 0, 1, 5)) :]


MUTATIONS = (
    *(_drop, _double, _swap, _foreign, _foreign, _cut, _continue, _section, _section, _include),
    *(_drop_item, _double_item, _swap_items, _add_item, _add_item, _value, _value, _value, _value, _scale),
    *(_label, _label, _word, _word, _misspell, _nest, _chain, _long, _odd, _odd),
)
PLAIN = (
    *(
        _drop,
        _double,
        _swap,
        _cut,
        _drop_item,
        _double_item,
        _swap_items,
        _value,
        _scale,
        _odd,
        _long,
        _label,
    ),
)
