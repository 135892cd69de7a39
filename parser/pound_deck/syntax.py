"""Explanation of syntax errors: one function for each kind of slip, the most certain first."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Mistake, mistake
from pound_deck.model import Span
from pound_deck.source import LogicalLine

MAX_NESTING: Final = 50

_OPERATORS: Final = frozenset({"PLUS", "MINUS", "STAR", "SLASH", "POWER"})
_BRACKET: Final = re.compile(r""""[^"\n]*"|'[^'\n]*'|([()])""")
_LONGEST_NAME: Final = 300  #: of a file, with its path
_PATH_START: Final = re.compile(r"\.{1,2}[/\\]|~/|\\\\|[A-Za-z]:[/\\]")
_FILE: Final = re.compile(r"""[^()*"']*[A-Za-z_][^()*"']*\.[A-Za-z]\w*""")  #: a letter, and an extension
#: at the end, or before the = of the next item
_NUMBER: Final = r"((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
_PERCENT: Final = re.compile(rf"(?<![\w.]){_NUMBER}\s*$")
_WITH_UNIT: Final = re.compile(rf"{_NUMBER}[A-Za-z]+\d?$")
_NO_VALUE: Final = re.compile(r"(?<![\w.])([A-Za-z_][\w.]*)(\s*=)(\s+[A-Za-z_][\w.]*)?$")
_LOOKALIKES: Final = dict(zip("−–—“”„‘’×", '---"""\'\'*'))


@dataclass(frozen=True, slots=True)
class Fault:
    """First place of a line that does not follow the grammar.

    Attributes
    ----------
    line : LogicalLine
    at : int
        Index in the line's text.
    kind, token : str
        Kind and text of the token there; both are empty at a character that begins no token.
    """

    line: LogicalLine
    at: int
    kind: str = ""
    token: str = ""

    @property
    def before(self) -> str:
        """Text before the place, without the blanks at its end."""
        return self.line.text[: self.at].rstrip()

    @property
    def last(self) -> str:
        """Last character before the place, blanks apart; empty at the start of the line."""
        return self.before[-1:]

    @property
    def after_blank(self) -> bool:
        """Whether a blank precedes the place."""
        return self.line.text[self.at - 1 : self.at].isspace()

    @property
    def span(self) -> Span:
        """Span of the token."""
        return place(self.line, self.at, len(self.token.rstrip()))


def check_nesting(line: LogicalLine) -> None:
    """Refuse a line whose brackets are nested too deep.

    Raises
    ------
    Mistake
        More than `MAX_NESTING` brackets are open at one place.
    """
    if line.text.count("(") <= MAX_NESTING:
        return
    depth = 0
    for mark in _BRACKET.finditer(line.text):
        depth += {"(": 1, ")": -1}.get(mark[1] or "", 0)
        if depth > MAX_NESTING:
            message = f"brackets are nested more than {MAX_NESTING} deep"
            raise mistake("P204", message, place(line, mark.start()), "use PARAM for the parts")


def place(line: LogicalLine, at: int, length: int = 1) -> Span:
    """Span of `length` characters of the line's text."""
    before = line.text[:at]
    column = at - before.rfind("\n")
    return Span(line.file, line.number + before.count("\n"), column, column + max(1, length))


def explain(fault: Fault) -> Mistake:
    """Mistake whose message explains a fault."""
    for kind in _KINDS:
        if slip := kind(fault):
            return slip
    shown = fault.token.strip() or "a blank"
    message = f"{shown[:60]} does not belong here"
    return mistake("P209", message, fault.span, "items are separated by blanks: 1 2 NAME=3")


def _unquoted_path(fault: Fault) -> Mistake | None:
    """Mistake for the name of a file without quotes; None for other faults."""
    text, start, end = fault.line.text, fault.at, fault.at
    while start and text[start - 1] not in " \t\n=,":
        start -= 1
    while end < len(text) and text[end] not in " \t\n=,":
        end += 1
    name = text[start:end]
    if end == fault.at or len(name) > _LONGEST_NAME:
        return None
    if not _PATH_START.match(name) and not _FILE.fullmatch(name):
        return None
    message = f"{name[:60]} is neither a word nor an expression"
    hint = f'the name of a file stands in quotes: "{name[:60]}"'
    return mistake("P239", message, place(fault.line, start, len(name)), hint)


def _strange_character(fault: Fault) -> Mistake | None:
    if fault.kind:
        return None
    character, span = fault.line.text[fault.at], place(fault.line, fault.at)
    if character in "\"'":
        hint = f"end the text with {character} on the same line"
        return mistake("P202", "this quote is not closed", span, hint)
    plain, percent = _LOOKALIKES.get(character, ""), _PERCENT.search(fault.before)
    hint = f"write a plain {plain}" if plain else "put texts in quotes; a comment starts with !"
    if character == "%" and percent:
        hint = f"write a ratio: {float(percent[1]) / 100.0:.12g} for {percent[1]} %"
    shown = character if character.isprintable() else f"the character U+{ord(character):04X}"
    return mistake("P201", f"{shown} has no meaning here", span, hint)


def _missing_value(fault: Fault) -> Mistake | None:
    empty = _NO_VALUE.search(fault.before)
    if not empty or fault.kind != ("EQUAL" if empty[3] else "$END"):
        return None
    name = empty[1][:60].upper()
    there = place(fault.line, empty.start(), len(empty[1] + empty[2]))
    return mistake("P209", f"the value of {name} is missing", there, f"write {name}=value")


def _blank_in_list(fault: Fault) -> Mistake | None:
    after_comma = fault.kind == "_WS" and fault.last == ","
    if not after_comma and not (fault.kind == "COMMA" and fault.after_blank):
        return None
    at = len(fault.before) - 1 if fault.last == "," else fault.at
    return mistake("P206", "a list holds no blanks", place(fault.line, at), "write 1,3,5")


def _unpaired_bracket(fault: Fault) -> Mistake | None:
    text, before = fault.line.text, fault.line.text[: fault.at]
    if before.count("(") > before.count(")") and fault.kind in ("$END", "EQUAL", "TO", "BY"):
        if fault.kind == "$END":
            return mistake(
                "P203", "this bracket is not closed", place(fault.line, _unclosed(text)), "add )"
            )
        message = f"{fault.token} cannot stand in brackets"
        return mistake("P209", message, fault.span, "close the bracket before it")
    if fault.kind == "RPAR" and _unclosed(before) < 0:
        return mistake("P203", "this bracket was not opened", fault.span, "take it out, or add (")
    return None


def _unclosed(text: str) -> int:
    """Index of the last bracket that is open at the end of the text, or -1."""
    opened: list[int] = []
    for mark in _BRACKET.finditer(text):
        if mark[1] == "(":
            opened.append(mark.start())
        elif mark[1] and opened:
            opened.pop()
    return opened[-1] if opened else -1


def _blank_at_operator(fault: Fault) -> Mistake | None:
    if fault.kind == "_WS" and fault.last in tuple("+-*/^"):
        span = place(fault.line, len(fault.before) - 1)
        return mistake("P205", f"a blank after {fault.last}", span, _without_blanks(fault.last))
    if fault.kind in _OPERATORS and fault.after_blank:
        return mistake("P205", f"a blank before {fault.token}", fault.span, _without_blanks(fault.token))
    return None


def _without_blanks(operator: str) -> str:
    items = f"; 1 {operator}2 for two items" if operator in ("+", "-") else ""
    return (
        f"remove the blanks or put the expression in parentheses: 1{operator}2 or (1 {operator} 2){items}"
    )


def _neither_number_nor_word(fault: Fault) -> Mistake | None:
    joined = fault.last.isalnum() or fault.last == "."
    if fault.kind not in ("WORD", "NUMBER") or not joined:
        return None
    start = max(fault.before.rfind(c) for c in " \t\n,=()+-*/^") + 1
    shown = fault.before[start:] + fault.token
    message = f"{shown[:60]} is neither a number nor a word"
    hint = "a word starts with a letter"
    if match := _WITH_UNIT.match(shown):
        hint = f"write {match[1]} alone, in the units of the deck; {hint}"
    return mistake("P207", message, place(fault.line, start, len(shown)), hint)


def _incomplete_range(fault: Fault) -> Mistake | None:
    if fault.kind not in ("TO", "BY") and not re.search(r"\b(TO|BY)$", fault.before, re.IGNORECASE):
        return None
    return mistake("P208", "this range is not complete", fault.span, "write 1 TO 9, or 1 TO 9 BY 2")


def _early_end(fault: Fault) -> Mistake | None:
    if fault.kind != "$END":
        return None
    hint = f"something must follow {fault.last}"
    return mistake("P209", "the card ends too early", place(fault.line, max(fault.at - 1, 0)), hint)


_KINDS: Final[tuple[Callable[[Fault], Mistake | None], ...]] = (
    _unquoted_path,
    _strange_character,
    _missing_value,
    _blank_in_list,
    _unpaired_bracket,
    _blank_at_operator,
    _neither_number_nor_word,
    _incomplete_range,
    _early_end,
)
