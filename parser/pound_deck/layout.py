"""Layout of a deck: its items in columns, every word, value and comment as written.

A line is a row of cells.  Positional items are aligned in columns common to all lines of their kind.  A
named item is aligned with those above and below it if all names up to it are the same.  A comment moves
only if it would touch the text before it.  A card with an item that continues on the next line is
unchanged.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import Final

from pound_deck.cards import Item, ParsedLine, parse, parse_items
from pound_deck.diagnostics import Diagnostic, Mistake, has_errors
from pound_deck.model import Span
from pound_deck.sections import FAMILIES, NAMES, SINGLE
from pound_deck.source import INCLUDE, DeckSource, LogicalLine, is_end, without_comment

_INDENT: Final = "   "  #: of the lines of a section; twice as much for continuation lines
_WIDE: Final = "   "  #: least gap after a positional item
_NARROW: Final = "  "  #: least gap after all other items
_SINGLE: Final = frozenset(SINGLE) - {"TITLE"}


@dataclass(frozen=True, slots=True)
class _Cells:
    """A line of a deck, divided into cells.

    Attributes
    ----------
    at : int
        Index of the line in the text.
    kind : str
        Lines of one kind share columns.
    shared : int
        Number of first columns that all lines of the block share.
    head, tail : str
        Text before and after the cells.
    places, named : list of str
        Cells by position, and by name.
    names : list of str
        Names of `named`, in capitals.
    """

    at: int
    kind: str
    shared: int
    head: str
    places: list[str]
    named: list[str]
    names: list[str]
    tail: str


def arranged(name: str, data: bytes) -> tuple[bytes | None, list[Diagnostic], dict[str, str]]:
    """Lay out a file; its encoding and its line ends are kept.

    Parameters
    ----------
    name : str
        Its name in spans.
    data : bytes
        The whole file.

    Returns
    -------
    data : bytes or None
        The file with its items in columns; None where a line does not follow the grammar.
    diagnostics : list of Diagnostic
        Mistakes of syntax, and a warning of an encoding other than UTF-8.
    files : dict of str to str
        The text by its name, for :func:`~pound_deck.diagnostics.caret`.
    """
    source = DeckSource()
    text = source.decode(name, data, Span(name, 1, 1, 2))
    report = source.report
    laid_out = None
    if not has_errors(report):
        laid_out, mistakes = layout(text, name)
        report += mistakes
    if laid_out is None:
        return None, report, {name: text}
    latin = any(d.code == "P101" for d in report)
    encoding = "latin-1" if latin else "utf-8-sig" if data.startswith(b"\xef\xbb\xbf") else "utf-8"
    end = "\r\n" if 2 * data.count(b"\r\n") > data.count(b"\n") else "\n"
    return laid_out.replace("\n", end).encode(encoding), report, {name: text}


def layout(text: str, name: str = "deck.inp") -> tuple[str | None, list[Diagnostic]]:
    """Lay out a text with the line ends ``\\n``.

    Returns
    -------
    text : str or None
        None where a line does not follow the grammar.
    diagnostics : list of Diagnostic
        Mistakes of syntax in this text; included files are not read.
    """
    source = DeckSource()
    lines = list(_up_to_end(source.logical(name, text)))
    cards = (line for line in lines if not INCLUDE.match(line.text) and not is_end(line.text))
    rows = list(parse(cards, source.report))
    if has_errors(source.report):
        return None, source.report
    raw = text.split("\n")
    new = [without_comment(r).rstrip() for r in raw]
    for at, code in (*_stripped(lines), *(line for block in _blocks(rows) for line in _in_columns(block))):
        new[at] = code
    headings = {row.line.number - 1 for row in rows if row.word in NAMES}
    end = lines[-1].number if lines and is_end(lines[-1].text) else len(raw)
    body = "\n".join([*_with_comments(raw[:end], new, headings), *raw[end:]]).rstrip("\n")
    return (body + "\n" if body else ""), source.report


def _up_to_end(lines: Iterable[LogicalLine]) -> Iterator[LogicalLine]:
    for line in lines:
        yield line
        if is_end(line.text):
            return


def _stripped(lines: Iterable[LogicalLine]) -> Iterator[tuple[int, str]]:
    """Yield index and stripped text of each line that is a whole card."""
    return ((line.number - 1, line.text.strip()) for line in lines if "\n" not in line.text)


def _blocks(rows: Iterable[ParsedLine]) -> Iterator[list[_Cells]]:
    """Yield groups of lines that share columns: those below one heading, and consecutive PARAMs."""
    section = ""
    block: list[_Cells] = []
    params: list[_Cells] = []
    for row in rows:
        if params and (row.word != "PARAM" or row.line.number - 2 != params[-1].at):
            yield params
            params = []
        if row.word in NAMES:
            yield block
            section, block = row.word, []
        elif row.word == "PARAM":
            params += _lines(row, section)
        elif row.word in _SINGLE:
            yield list(_lines(row, section))
        elif row.word != "TITLE":
            block += _lines(row, section)
    yield params
    yield block


def _lines(row: ParsedLine, section: str) -> list[_Cells]:
    """Physical lines of a row as cells; empty where an item spans two lines, or the first has no item."""
    texts = row.line.text.split("\n")
    try:
        items = [parse_items(LogicalLine("", 1, text)) for text in texts]
    except Mistake:
        return []
    if not items[0]:
        return []
    last = max(k for k, line_items in enumerate(items) if line_items)
    first = row.line.number - 1
    lines = [_first(first, row.word, section, texts[0], items[0], "  &" if last else "")]
    for k, (text, line_items) in enumerate(zip(texts[1:], items[1:]), 1):
        if line_items:
            cells = [_NARROW.join(_cell(text, item) for item in line_items)]
            lines.append(_Cells(first + k, "&", 0, 2 * _INDENT, cells, [], [], "  &" if k < last else ""))
    return lines


def _first(at: int, word: str, section: str, text: str, items: Sequence[Item], tail: str) -> _Cells:
    if word == "PARAM":
        cells = [_cell(text, item, " = ") for item in items[1:]]
        return _Cells(at, word, 0, _cell(text, items[0]) + _NARROW, cells, [], [], tail)
    if word in _SINGLE:
        cells = [" ".join(_cell(text, item) for item in items[1:])]
        return _Cells(at, word, 0, _cell(text, items[0]) + _NARROW, cells, [], [], tail)
    split = next((k for k, item in enumerate(items) if item.name), len(items))
    places, named = ([_cell(text, item) for item in part] for part in (items[:split], items[split:]))
    # a line of PROPS begins with a label and its kind, one of DAMPING with its kind, one of NODES has none
    shared = 0 if section not in FAMILIES else 2 if section == "PROPS" else 1
    kind = items[shared - 1].text.upper() if 0 < shared <= split else ""
    return _Cells(at, kind, shared, _INDENT, places, named, [item.name for item in items[split:]], tail)


def _cell(text: str, item: Item, equal: str = "=") -> str:
    """Text of an item with its name as written."""
    name = text[item.name_span.column - 1 : item.name_span.end - 1] + equal if item.name else ""
    return name + item.text


def _in_columns(block: Sequence[_Cells]) -> Iterator[tuple[int, str]]:
    """Yield index and text of each line of a block, its cells aligned in columns."""
    starts: dict[str, int] = {}  # number of columns before the named items, by kind
    wide: dict[tuple[str, int], int] = {}

    def column(row: _Cells, k: int) -> tuple[str, int]:
        return ("" if k < row.shared else row.kind), k

    for row in block:
        if row.named:
            starts[row.kind] = max(starts.get(row.kind, 0), len(row.places))
        for k, cell in enumerate(row.places if row.named else row.places[:-1]):
            wide[column(row, k)] = max(wide.get(column(row, k), 0), len(cell) + len(_WIDE))
    for row, narrow in zip(block, _named_widths(block)):
        places = row.places + [""] * (starts.get(row.kind, 0) - len(row.places) if row.named else 0)
        cells = [cell.ljust(wide.get(column(row, k), 0)) for k, cell in enumerate(places)]
        cells += [cell.ljust(width) for cell, width in zip(row.named, narrow)]
        yield row.at, (row.head + "".join(cells)).rstrip() + row.tail


def _named_widths(block: Sequence[_Cells]) -> list[list[int]]:
    """Widths of the named cells of each line, aligned with neighbours of the same names so far."""
    all_widths: list[list[int]] = [[] for _ in block]
    named = [(row, widths) for row, widths in zip(block, all_widths) if row.named]
    for j in range(max((len(row.named) for row, _ in named), default=0)):
        begin = [(row.kind, row.names[: j + 1]) for row, _ in named]
        for _, run in groupby(zip(begin, named), itemgetter(0)):
            alike = [(row, widths) for _, (row, widths) in run if len(row.named) > j]
            width = max((len(row.named[j]) for row, _ in alike if len(row.named) > j + 1), default=0)
            for _, widths in alike:
                widths.append(width + len(_NARROW))
    return all_widths


def _with_comments(raw: Sequence[str], code: Sequence[str], headings: set[int]) -> Iterator[str]:
    """Yield lines with their comments, which start in one column in consecutive lines."""
    before = [without_comment(line) for line in raw]
    texts = [line[len(b) :].rstrip() for line, b in zip(raw, before)]

    def run(at: int) -> tuple[bool, int]:
        return bool(code[at] and texts[at]), at if at in headings else -1

    for (both, _), members in groupby(range(len(raw)), run):
        lines = list(members)
        column = 0
        if both:
            least = max(len(code[at]) for at in lines) + len(_NARROW)
            column = max(least, min(len(before[at].expandtabs()) for at in lines))
        for at in lines:
            yield code[at].ljust(column) + texts[at] if code[at] else raw[at].rstrip()
