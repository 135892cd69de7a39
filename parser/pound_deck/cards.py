"""Logical lines to rows of items, each with its Span: the only module that uses lark.

The parser's callbacks only put tokens into postfix order; spans are added afterwards in plain loops.  So no
step calls itself, however long or deep a card is.  How a card is built depends on the kinds of its tokens
only: the thousandth line of a table is taken apart as its first was, without parsing it again.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, Final

from lark import Lark, Token, Transformer, UnexpectedCharacters, UnexpectedInput
from lark.lark import PostLex

from pound_deck.diagnostics import Diagnostic, Mistake, mistake
from pound_deck.expressions import Expression, Range, Step
from pound_deck.model import Span
from pound_deck.source import Line

MAX_NESTING: Final = 50

Part = Expression | Range

_TIGHT: Final = frozenset({"EQUAL", "TO", "BY"})  #: tokens that may have blanks around them
_SIGNS: Final = frozenset({"PLUS", "MINUS", "STAR", "SLASH", "POWER"})
# a keyword, and no named item; what follows TITLE is free
_FIRST_WORD: Final = re.compile(r"\s*(TITLE(?![\w.])|[A-Za-z_][\w.]*(?![\w.]|\s*=))", re.IGNORECASE)
_BRACKET: Final = re.compile(r""""[^"\n]*"|'[^'\n]*'|([()])""")
_LONGEST_NAME: Final = 300  #: of a file, with its path
_PATH_START: Final = re.compile(r"\.{1,2}[/\\]|~/|\\\\|[A-Za-z]:[/\\]")
_FILE: Final = re.compile(r"""[^()*"']*[A-Za-z_][^()*"']*\.[A-Za-z]\w*""")  #: a letter, and an extension
#: at the end, or before the = of the next item
_NO_VALUE: Final = re.compile(r"([A-Za-z_][\w.]*)(\s*=)(\s+[A-Za-z_][\w.]*)?$")
_LOOKALIKES: Final = {
    "−": "-",
    "–": "-",
    "—": "-",
    "“": '"',
    "”": '"',
    "„": '"',
    "‘": "'",
    "’": "'",
    "×": "*",
}


@dataclass(frozen=True, slots=True)
class Item:
    """One item of a row: its upper-case name (empty by position) and the parts of its comma list."""

    name: str
    parts: tuple[Part, ...]
    span: Span
    name_span: Span

    @property
    def text(self) -> str:
        """Its value as written."""
        return ",".join(part.text for part in self.parts)

    @property
    def word(self) -> str:
        """The word in upper case, where the item is nothing but an unquoted word; else empty."""
        part = self.parts[0]
        return (
            part.lone_word
            if len(self.parts) == 1 and isinstance(part, Expression) and not self.name
            else ""
        )


@dataclass(frozen=True, slots=True)
class Row:
    """A parsed line: first word in upper case, items (None where it could not be parsed), place."""

    word: str
    items: tuple[Item, ...] | None
    line: Line
    span: Span


def parse(lines: Iterable[Line], report: list[Diagnostic]) -> Iterator[Row]:
    """Parse line by line; a line that cannot be parsed adds a diagnostic and comes without items."""
    shapes: dict[tuple[str, ...], _Shape] = {}
    for line in lines:
        first = _FIRST_WORD.match(line.text)
        word = first[1].upper() if first else ""
        items: tuple[Item, ...] | None = None
        if word == "TITLE":
            items = ()  # the rest of a title is free text
        else:
            try:
                items = parse_items(line, shapes)
            except Mistake as error:
                if error.diagnostic:
                    report.append(error.diagnostic)
        yield Row(word, items, line, line.span)


def parse_items(line: Line, shapes: dict[tuple[str, ...], _Shape] | None = None) -> tuple[Item, ...]:
    """Items of one logical line; `shapes` keeps what was parsed before.

    Raises
    ------
    Mistake
        The line does not follow the grammar.
    """
    _check_nesting(line)
    lexer, parser = _lark()
    try:
        tokens = list(lexer.lex(line.text))
        kinds = tuple([token.type for token in tokens])
        shape = shapes.get(kinds) if shapes else None
        if shape is None:
            shape = _shape(parser.parse(line.text), tokens)
            if shapes is not None:
                shapes[kinds] = shape
    except UnexpectedInput as error:
        raise _explain(_first_error(parser, line, error), line) from None
    return tuple([_item(item, tokens, line) for item in shape])


def _first_error(parser: Lark, line: Line, error: UnexpectedInput) -> UnexpectedInput:
    """What the parser meets first: the lexer alone runs past mistakes of grammar."""
    try:
        parser.parse(line.text)
    except UnexpectedInput as first:
        return first
    return error


class _Blanks(PostLex):
    """Drops the blanks that separate no items."""

    always_accept = ("_WS",)

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        held, last, depth = None, "EQUAL", 0
        for token in stream:
            if token.type == "_WS":
                held = token
                continue
            if held and not depth and last not in _TIGHT and token.type not in _TIGHT:
                yield held
            held, last = None, token.type
            depth += (last == "LPAR") - (last == "RPAR")
            yield token


_Postfixed = list[tuple[str, Token, int]]  #: (kind, token, number of values)
_Parts = list[tuple[_Postfixed, ...]]  #: of one formula an expression, of more a range


class _Postfix(Transformer[Token, list[tuple[Token | None, _Parts]]]):
    """Puts tokens into postfix order: lists that are extended in place.

    Brackets stay as steps of the kind ``mark``: they have a place, but no value.
    """

    def number(self, children: list[Any]) -> _Postfixed:
        return [("number", children[0], 0)]

    def word(self, children: list[Any]) -> _Postfixed:
        return [("word", children[0], 0)]

    def text(self, children: list[Any]) -> _Postfixed:
        return [("text", children[0], 0)]

    def bracket(self, children: list[Any]) -> _Postfixed:
        steps: _Postfixed
        opening, steps, closing = children
        steps.append(("mark", opening, 0))
        steps.append(("mark", closing, 0))
        return steps

    def unary(self, children: list[Any]) -> _Postfixed:
        steps: _Postfixed
        sign, steps = children
        steps.append(("operator", sign, 1))
        return steps

    def binary(self, children: list[Any]) -> _Postfixed:
        left: _Postfixed
        left, sign, right = children
        left += right
        left.append(("operator", sign, 2))
        return left

    def call(self, children: list[Any]) -> _Postfixed:
        name, *rest = children
        arguments = [c for c in rest if not isinstance(c, Token)]
        steps = [step for argument in arguments for step in argument]
        return [*steps, ("call", name, len(arguments)), ("mark", rest[-1], 0)]

    def expression(self, children: list[Any]) -> tuple[_Postfixed, ...]:
        return (children[0],)

    def range(self, children: list[Any]) -> tuple[_Postfixed, ...]:
        return tuple(c[0] for c in children if isinstance(c, tuple))

    def plain(self, children: list[Any]) -> tuple[None, _Parts]:
        return None, [c for c in children if isinstance(c, tuple)]

    def named(self, children: list[Any]) -> tuple[Token, _Parts]:
        return children[0], [c for c in children if isinstance(c, tuple)]

    def start(self, children: list[Any]) -> list[tuple[Token | None, _Parts]]:
        return [c for c in children if c is not None]


@dataclass(frozen=True, slots=True)
class _Formula:
    """Steps of an expression as (kind, index of token, number of values), and its first and last token."""

    steps: tuple[tuple[str, int, int], ...]
    first: int
    last: int


#: for each item the index of its name and its parts: of one formula an expression, of more a range
_Shape = tuple[tuple[int | None, tuple[tuple[_Formula, ...], ...]], ...]


def _shape(parsed: Any, tokens: list[Token]) -> _Shape:
    """What `_Postfix` made of a card (lark calls it a tree), with indices in place of its tokens."""
    index = {token.start_pos: k for k, token in enumerate(tokens)}

    def formula(raw: _Postfixed) -> _Formula:
        steps = [(kind, index[token.start_pos], arity) for kind, token, arity in raw]
        places = [k for _, k, _ in steps]
        return _Formula(tuple(s for s in steps if s[0] != "mark"), min(places), max(places))

    return tuple(
        (
            None if name is None else index[name.start_pos],
            tuple(tuple(formula(raw) for raw in part) for part in parts),
        )
        for name, parts in parsed
    )


@cache
def _lark() -> tuple[Lark, Lark]:
    """The lexer alone, and the parser with the same lexer."""
    # the basic lexer looks at no parser state, so _Blanks may read one token ahead
    grammar = files("pound_deck").joinpath("deck.lark").read_text("utf-8")
    return (
        Lark(grammar, parser=None, lexer="basic", postlex=_Blanks()),
        Lark(grammar, parser="lalr", lexer="basic", postlex=_Blanks(), transformer=_Postfix()),
    )


def _span(token: Token, line: Line) -> Span:
    number = line.number + (token.line or 1) - 1
    column = token.column or 1
    return Span(line.file, number, column, column + max(1, len(token.rstrip())))


def _join(first: Span, last: Span) -> Span:
    """From the start of one to the end of the other, within the first one's line."""
    return Span(first.file, first.line, first.column, last.end if last.line == first.line else first.end)


def _expression(formula: _Formula, tokens: list[Token], line: Line) -> Expression:
    first, last = tokens[formula.first], tokens[formula.last]
    text = line.text[first.start_pos : last.end_pos]
    if formula.first == formula.last:
        kind = formula.steps[0][0]
        span = _span(first, line)
        return Expression((Step(kind, text[1:-1] if kind == "text" else text, span),), span, text)
    steps = []
    for kind, k, arity in formula.steps:
        token = tokens[k]
        steps.append(Step(kind, token[1:-1] if kind == "text" else str(token), _span(token, line), arity))
    return Expression(tuple(steps), _join(_span(first, line), _span(last, line)), text)


def _item(
    shape: tuple[int | None, tuple[tuple[_Formula, ...], ...]], tokens: list[Token], line: Line
) -> Item:
    name, raw = shape
    parts: list[Part] = []
    for formulas in raw:
        values = [_expression(formula, tokens, line) for formula in formulas]
        if len(values) == 1:
            parts.append(values[0])
        else:
            span = _join(values[0].span, values[-1].span)
            parts.append(Range(values[0], values[1], values[2] if len(values) > 2 else None, span))
    span = parts[0].span if len(parts) == 1 else _join(parts[0].span, parts[-1].span)
    if name is None:
        return Item("", tuple(parts), span, span)
    return Item(tokens[name].upper(), tuple(parts), span, _span(tokens[name], line))


def _check_nesting(line: Line) -> None:
    if line.text.count("(") <= MAX_NESTING:
        return
    depth = 0
    for mark in _BRACKET.finditer(line.text):
        depth += {"(": 1, ")": -1}.get(mark[1] or "", 0)
        if depth > MAX_NESTING:
            message = f"brackets are nested more than {MAX_NESTING} deep"
            raise mistake("P204", message, _place(line, mark.start()), "use PARAM for the parts")


def _place(line: Line, at: int, length: int = 1) -> Span:
    """Span of `length` characters of the line's text."""
    before = line.text[:at]
    column = at - before.rfind("\n")
    return Span(line.file, line.number + before.count("\n"), column, column + max(1, length))


def _explain(error: UnexpectedInput, line: Line) -> Mistake:
    text = line.text
    at = min(error.pos_in_stream if error.pos_in_stream is not None else len(text), len(text))
    token: Token = getattr(error, "token", Token("", ""))  # a strange character is none
    if token.type == "$END":
        at = len(text.rstrip())
    path = _path(text, at)
    if path:
        start, name = path
        message = f"{name[:60]} is neither a word nor an expression"
        return mistake(
            "P239",
            message,
            _place(line, start, len(name)),
            f'the name of a file stands in quotes: "{name[:60]}"',
        )
    if isinstance(error, UnexpectedCharacters):
        return _strange(text[at], _place(line, at))
    before = text[:at].rstrip()
    last = before[-1:]
    place = _place(line, at, len(token.rstrip()))
    hint = "write 1-2 or (1 - 2) for a difference, 1 -2 for two items"
    empty = _NO_VALUE.search(before)
    if empty and token.type == ("EQUAL" if empty[3] else "$END"):
        name = empty[1][:60].upper()
        there = _place(line, empty.start(), len(empty[1] + empty[2]))
        return mistake("P209", f"the value of {name} is missing", there, f"write {name}=value")
    if (token.type == "_WS" and last == ",") or (token.type == "COMMA" and text[at - 1 : at].isspace()):
        return mistake(
            "P206",
            "a list holds no blanks",
            _place(line, len(before) - 1 if last == "," else at),
            "write 1,3,5",
        )
    if text[:at].count("(") > text[:at].count(")") and token.type in ("$END", "EQUAL", "TO", "BY"):
        if token.type == "$END":
            opening = _unclosed(text)
            return mistake("P203", "this bracket is not closed", _place(line, opening), "add )")
        message = f"{token} cannot stand in brackets"
        return mistake("P209", message, place, "close the bracket before it")
    if token.type == "RPAR" and _unclosed(text[:at]) < 0:
        return mistake("P203", "this bracket was not opened", place, "take it out, or add (")
    if token.type == "_WS" and last in tuple("+-*/^"):
        return mistake("P205", f"a blank after {last}", _place(line, len(before) - 1), hint)
    if token.type in _SIGNS and text[at - 1 : at].isspace():
        return mistake("P205", f"a blank before {token}", place, hint)
    if token.type in ("WORD", "NUMBER") and last and (last.isalnum() or last == "."):
        start = max(before.rfind(c) for c in " \t\n,=()+-*/^") + 1
        shown = before[start:] + str(token)
        message = f"{shown[:60]} is neither a number nor a word"
        return mistake("P207", message, _place(line, start, len(shown)), "a word starts with a letter")
    if token.type in ("TO", "BY") or re.search(r"\b(TO|BY)$", before, re.IGNORECASE):
        return mistake("P208", "this range is not complete", place, "write 1 TO 9, or 1 TO 9 BY 2")
    if token.type == "$END":
        return mistake(
            "P209", "the card ends too early", _place(line, max(at - 1, 0)), f"something must follow {last}"
        )
    shown = str(token).strip() or "a blank"
    return mistake(
        "P209", f"{shown[:60]} does not belong here", place, "items are separated by blanks: 1 2 NAME=3"
    )


def _path(text: str, at: int) -> tuple[int, str] | None:
    """Start and text of what stands at a place without blanks, if it is like the name of a file."""
    start = end = at
    while start and text[start - 1] not in " \t\n=,":
        start -= 1
    while end < len(text) and text[end] not in " \t\n=,":
        end += 1
    piece = text[start:end]
    if end == at or len(piece) > _LONGEST_NAME or not (_PATH_START.match(piece) or _FILE.fullmatch(piece)):
        return None
    return start, piece


def _unclosed(text: str) -> int:
    """Index of the last bracket that is open at the end of the text, or -1."""
    opened: list[int] = []
    for mark in _BRACKET.finditer(text):
        if mark[1] == "(":
            opened.append(mark.start())
        elif mark[1] and opened:
            opened.pop()
    return opened[-1] if opened else -1


def _strange(character: str, place: Span) -> Mistake:
    if character in "\"'":
        return mistake(
            "P202", "this quote is not closed", place, f"end the text with {character} on the same line"
        )
    plain = _LOOKALIKES.get(character, "")
    hint = f"write a plain {plain}" if plain else "put texts in quotes; a comment starts with !"
    shown = character if character.isprintable() else f"the character U+{ord(character):04X}"
    return mistake("P201", f"{shown} has no meaning here", place, hint)
