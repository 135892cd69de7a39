"""Logical lines to rows of items, each with its Span: the only module that uses lark.

The parser's callbacks only put tokens into postfix order; spans are added afterwards in plain loops.  So no
recursion is needed, however long or deep a card is.  How a card is built depends on the kinds of its tokens
only, so the thousandth line of a table has the shape of the first and is not parsed again.
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

from pound_deck.diagnostics import Diagnostic, Mistake
from pound_deck.expressions import Expression, ExpressionStep, Range
from pound_deck.model import Span
from pound_deck.source import LogicalLine
from pound_deck.syntax import Fault, check_nesting, explain

Part = Expression | Range

_TIGHT: Final = frozenset({"EQUAL", "TO", "BY"})  #: tokens that may have blanks around them
# a keyword, and no named item; the text after TITLE is free
_FIRST_WORD: Final = re.compile(r"\s*(TITLE(?![\w.])|[A-Za-z_][\w.]*(?![\w.]|\s*=))", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Item:
    """One item of a row: its upper-case name (empty by position) and the parts of its comma list."""

    name: str
    parts: tuple[Part, ...]
    span: Span
    name_span: Span

    @property
    def text(self) -> str:
        """The item's value as written."""
        return ",".join(part.text for part in self.parts)

    @property
    def word(self) -> str:
        """The item's word in upper case, where it is an unquoted word without a name; else empty."""
        part = self.parts[0]
        return (
            part.lone_word
            if len(self.parts) == 1 and isinstance(part, Expression) and not self.name
            else ""
        )


@dataclass(frozen=True, slots=True)
class ParsedLine:
    """Parsed line: first word in upper case, items (None where it could not be parsed), place."""

    word: str
    items: tuple[Item, ...] | None
    line: LogicalLine
    span: Span


def parse(lines: Iterable[LogicalLine], report: list[Diagnostic]) -> Iterator[ParsedLine]:
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
                error.keep(report)
        yield ParsedLine(word, items, line, line.span)


def parse_items(line: LogicalLine, shapes: dict[tuple[str, ...], _Shape] | None = None) -> tuple[Item, ...]:
    """Items of one logical line; `shapes` keeps what was parsed before.

    Raises
    ------
    Mistake
        The line does not follow the grammar.
    """
    check_nesting(line)
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
        raise explain(_fault(_first_error(parser, line, error), line)) from None
    return tuple([_item(item, tokens, line) for item in shape])


def _first_error(parser: Lark, line: LogicalLine, error: UnexpectedInput) -> UnexpectedInput:
    """First error that the parser finds in a line, which may precede that of the lexer."""
    try:
        parser.parse(line.text)
    except UnexpectedInput as first:
        return first
    return error


class _Blanks(PostLex):
    """Post-lexer that drops the blanks that do not separate items."""

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
    """Callbacks of the parser that put tokens into postfix order, in lists that are extended in place.

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
    """Shape of a parsed card: indices in place of its tokens."""
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
    # the basic lexer is independent of the parser's state, so _Blanks may read one token ahead
    grammar = files("pound_deck").joinpath("deck.lark").read_text("utf-8")
    return (
        Lark(grammar, parser=None, lexer="basic", postlex=_Blanks()),
        Lark(grammar, parser="lalr", lexer="basic", postlex=_Blanks(), transformer=_Postfix()),
    )


def _span(token: Token, line: LogicalLine) -> Span:
    number = line.number + (token.line or 1) - 1
    column = token.column or 1
    return Span(line.file, number, column, column + max(1, len(token.rstrip())))


def _join(first: Span, last: Span) -> Span:
    """Span from the start of one span to the end of another, but no further than the first one's line."""
    return Span(first.file, first.line, first.column, last.end if last.line == first.line else first.end)


def _expression(formula: _Formula, tokens: list[Token], line: LogicalLine) -> Expression:
    first, last = tokens[formula.first], tokens[formula.last]
    text = line.text[first.start_pos : last.end_pos]
    if formula.first == formula.last:
        kind = formula.steps[0][0]
        span = _span(first, line)
        return Expression((ExpressionStep(kind, text[1:-1] if kind == "text" else text, span),), span, text)
    steps = []
    for kind, k, arity in formula.steps:
        token = tokens[k]
        steps.append(
            ExpressionStep(kind, token[1:-1] if kind == "text" else str(token), _span(token, line), arity)
        )
    return Expression(tuple(steps), _join(_span(first, line), _span(last, line)), text)


def _item(
    shape: tuple[int | None, tuple[tuple[_Formula, ...], ...]], tokens: list[Token], line: LogicalLine
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


def _fault(error: UnexpectedInput, line: LogicalLine) -> Fault:
    """Place and token of a syntax error."""
    end = len(line.text)
    at = min(end if error.pos_in_stream is None else error.pos_in_stream, end)
    if isinstance(error, UnexpectedCharacters):
        return Fault(line, at)
    token: Token = getattr(error, "token", Token("", ""))
    return Fault(line, len(line.text.rstrip()) if token.type == "$END" else at, token.type, str(token))
