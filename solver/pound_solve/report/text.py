"""The plain-text report: a view of the tables in a results file.

ASCII, at most 132 columns, sections and tables numbered as they are printed. Tables longer than a page are
in an appendix, so that the others can be read in a few pages. Nothing but the last section depends on the
machine, the day or the host, so two reports of one deck compare line by line.
"""

from __future__ import annotations

import itertools
import math
import re
import textwrap
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from tabulate import tabulate

from pound_deck.model import Units
from pound_solve.report.views import view_of
from pound_solve.results import Results
from pound_solve.results.contents import MOVABLE, OF_THE_DAY, SECTIONS, TABLES
from pound_solve.results.schema import Column, Row, Sheet, Table

WIDTH: Final = 132  #: columns of the report
_PAGE: Final = 60  #: longest table, in lines, that is printed in its section
_INDENT: Final = "  "
_GAP: Final = 2  #: blanks that tabulate leaves between columns
_NARROWEST: Final = 16  #: texts are not wrapped to less; a table that is still too wide is split instead
_DIGITS: Final = {"given": 10, "num": 5, "short": 4}  #: significant digits by format
_WHOLE: Final = 7  #: number of digits before the point from which on a number gets an exponent
#: fraction of the largest value of a block of a column below which rounding prints as zero
_DUST: Final = 1e-12

_TINY: Final = 1e-300  #: always prints as zero

#: Signs that do not decompose into ASCII, and what stands for them; Greek letters go by their names.
_PAIRS: Final = """
    –|- —|- −|- ‘|' ’|' “|" ”|" ·|* ×|x ÷|/ ≤|<= ≥|>= ≠|/= ≈|~ ±|+- √|sqrt ∞|inf °|deg →|-> ←|<-
    ß|ss ø|o Ø|O æ|ae Æ|AE ł|l Ł|L
"""
_SIGNS: Final = dict(pair.split("|") for pair in _PAIRS.split())


def render(results: Results, *, limit: int | None = None, only: Collection[str] | None = None) -> str:
    """Report of a results file.

    Parameters
    ----------
    results : Results
        The file.
    limit : int, optional
        Rows to print of each limited table, instead of its limit (0: all rows).
    only : collection of str, optional
        Names of the tables to print, for an excerpt.

    Returns
    -------
    str
        The report; every line ends in ``\\n``.
    """
    present = set(results.tables) if only is None else set(results.tables) & set(only)
    movable: Collection[str] = MOVABLE if only is None else ()
    lines, moved, last = [*_banner(results), *_warning(results)], list[str](), list[str]()
    number = appended = 0
    for heading, names in SECTIONS:
        printed = {
            name: body
            for name in names
            if name in present and (body := _block(results, TABLES[name], limit))
        }
        if not printed:
            continue
        number += 1
        section = last if printed.keys() <= OF_THE_DAY else lines
        section += _heading(f"{number}  {heading}")
        if "options" in names:
            section += [_INDENT + "An asterisk (*) marks a default value.", ""]
        for place, (name, body) in enumerate(printed.items(), 1):
            title, at = TABLES[name].title.upper(), f"{number}.{place}"
            if name in movable and len(body) > _PAGE:
                appended += 1
                moved += [f"A.{appended}  {title} ({at})", "", *body, "", ""]
                body = [f"{_INDENT}Table A.{appended} of the appendix; '{name}' in the results file."]
            section += [f"{at}  {title}", "", *body, "", ""]
    lines += [*(_heading("A  Appendix: long tables") if moved else ()), *moved, *last]
    return "\n".join(line.rstrip() for line in lines).rstrip() + "\n"


def _heading(text: str) -> list[str]:
    """Lines of the heading of a section."""
    return [text.upper(), "=" * WIDTH, ""]


def _banner(results: Results) -> Iterator[str]:
    units = results.units
    yield "=" * WIDTH
    yield f" POUND-SOLVE {plain(results.program_version)}     EARTHQUAKE POUNDING OF PLANE FRAMES"
    yield ""
    for line in textwrap.wrap(plain(results.title), WIDTH - 2):
        yield " " + line
    yield f" Units: force {plain(units.force)}, length {plain(units.length)}, time {plain(units.time)}"
    if results.digest:
        yield f" Results {results.digest}"
    if results.changed:
        yield " The results file was changed after the run; what is printed here is as the run wrote it."
    yield "=" * WIDTH
    yield from ("", "")


def _warning(results: Results) -> Iterator[str]:
    """Lines of the framed warning above the report of an unfinished analysis."""
    sentences = incomplete(results)
    if not sentences:
        return
    inner = WIDTH - 8
    yield "*" * WIDTH
    for line in "\n\n".join("\n".join(textwrap.wrap(plain(text), inner)) for text in sentences).split("\n"):
        yield f"**  {line.ljust(inner)}  **"
    yield "*" * WIDTH
    yield from ("", "")


def incomplete(results: Results) -> tuple[str, ...]:
    """Sentences on an unfinished analysis: the fact, the reason, and the time reached."""
    if results.status == "done":
        return ()
    head = "THE ANALYSIS DID NOT COMPLETE"
    if results.status == "stopped":
        why = results.message or "No reason was recorded."
    elif results.status == "killed":
        why = "The run was killed, or its machine stopped; no reason is recorded."
    else:
        why = "The run may still go on."
    if math.isnan(results.last_time):
        scope = "There is no time history; only what is printed below was computed."
    else:
        when = f"{_times([results.last_time])[0]} {results.units.time}"
        scope = f"The last sample of the time history is that at {when}: results taken from it end there."
    return head, why, scope


def _block(results: Results, table: Table[Any], limit: int | None) -> list[str]:
    """Lines of one table of the file with its notes; empty if it has no rows."""
    lines = []
    for part in shown(results, table, limit):
        lines += ["", *([_INDENT + part.title, ""] if part.title else [])]
        lines += _body(results.units, part.table, part.rows)
        if part.more:
            lines += ["", _INDENT + part.more]
    return _with_notes(lines[1:], table, results.note(table.name))


class ReportTable(NamedTuple):
    """A part of a table as a report shows it.

    Attributes
    ----------
    title : str
        Line above it; empty for none.
    table : Table
        With the columns of the part.
    rows : ndarray, structured
    more : str
        A line on the omitted rows; empty for none.
    """

    title: str
    table: Table[Any]
    rows: NDArray[Any]
    more: str = ""


def shown(results: Results, table: Table[Any], limit: int | None) -> list[ReportTable]:
    """Parts in which a report shows a table: those of its view, or the whole; `limit` as in `render`."""
    view = view_of(table.name, whole=limit == 0)
    if view is None:
        return [ReportTable("", table, *_excerpt(results, table, limit))]
    return [
        ReportTable(part.title, replace(table, columns=part.columns, group=""), part.rows)
        for part in view(results)
    ]


def _excerpt(results: Results, table: Table[Any], limit: int | None) -> tuple[NDArray[Any], str]:
    """The first rows of a table, which a report shows, and a line on the omitted ones; see `render`."""
    rows = results.table(table.name)
    most = table.limit if limit is None or not table.limit else limit
    if not most or len(rows) <= most:
        return rows, ""
    return rows[:most], f"... and {len(rows) - most} more rows: table '{table.name}' of the results file"


def block(units: Units, sheet: Sheet, rows: NDArray[Any]) -> list[str]:
    """Lines of rows, whose fields are the columns, with notes; empty if there is nothing to show."""
    return _with_notes(_body(units, sheet, rows), sheet)


def _with_notes(lines: list[str], sheet: Sheet, note: str = "") -> list[str]:
    """Lines of a table, if any, followed by its notes."""
    notes = " ".join(plain(text) for text in (sheet.note, note) if text)
    if lines and notes:
        lines = [*lines, "", *(_INDENT + line for line in textwrap.wrap(notes, WIDTH - len(_INDENT)))]
    return lines


def printed(units: Units, sheet: Sheet, rows: Iterable[Row]) -> list[str]:
    """Lines of rows that are not stored in a file; see `block`."""
    records = np.array(list(rows), dtype=sheet.kinds)
    return [line.rstrip() for line in block(units, sheet, records)]


class Formatted(NamedTuple):
    """A table as text.

    Attributes
    ----------
    columns : list of Column
        The columns that are not empty.
    heads, cells : dict of str
        Head with its unit, and the cells from top to bottom, of each column, keyed by name.
    blocks : list of int
        Number of rows of each group.
    """

    columns: list[Column]
    heads: dict[str, str]
    cells: dict[str, list[str]]
    blocks: list[int]


def formatted(units: Units, sheet: Sheet, rows: NDArray[Any]) -> Formatted:
    """Format the cells of a table as a report shows them."""
    groups = _groups(sheet, rows)
    cells, heads, columns = {}, {}, []
    for c in sheet.columns:
        if c.name not in (rows.dtype.names or ()):
            continue  # a file of an older minor version
        as_text = rows.dtype[c.name].kind == "O" and not c.is_text  # in a file of an older version
        shown_as = Column(c.name) if as_text else c
        texts = [t for g in groups for t in _format(shown_as, rows[c.name][g].tolist())]
        if any(t not in ("", "-") for t in texts):
            columns.append(c)
            cells[c.name] = texts
            unit = f"\n[{plain(units.text(c.unit))}]" if c.unit else ""
            heads[c.name] = c.title + unit
    return Formatted(columns, heads, cells, [len(g) for g in groups])


def _body(units: Units, sheet: Sheet, rows: NDArray[Any]) -> list[str]:
    """Lines of the heads and rows of a table; empty if no column has anything to show."""
    columns, heads, cells, blocks = formatted(units, sheet, rows)
    if not columns:
        return []
    _wrap(columns, heads, cells)
    # Blank lines between groups, unless every group is a single row.
    breaks = blocks[:-1] if len(blocks) < len(rows) else []
    lines: list[str] = []
    for panel in _panels(columns, heads, cells):
        lines += ["", *_print(panel, heads, cells, breaks)]
    return lines[1:]


def _groups(sheet: Sheet, rows: NDArray[Any]) -> list[list[int]]:
    """Row numbers by value of the group column, in order of first appearance."""
    if not sheet.group:
        return [list(range(len(rows)))]
    groups: dict[Any, list[int]] = {}
    for number, key in enumerate(rows[sheet.group].tolist()):
        groups.setdefault(key, []).append(number)
    return list(groups.values())


def _wrap(columns: Sequence[Column], heads: dict[str, str], cells: dict[str, list[str]]) -> None:
    """Wrap the widest texts, in place, until the table fits the page."""
    widths = {c.name: _width(heads[c.name], cells[c.name]) for c in columns}
    texts = [c.name for c in columns if c.is_text]
    room = WIDTH - len(_INDENT) - _GAP * (len(columns) - 1)
    room -= sum(width for name, width in widths.items() if name not in texts)
    cap = max((widths[n] for n in texts), default=0)
    while cap > _NARROWEST and sum(min(widths[n], cap) for n in texts) > room:
        cap -= 1
    for name in texts:
        if widths[name] > cap:
            cells[name] = [textwrap.fill(t, cap) for t in cells[name]]


def _panels(
    columns: Sequence[Column], heads: dict[str, str], cells: dict[str, list[str]]
) -> Iterator[list[Column]]:
    """Divide columns into the fewest panels that fit the page; each begins with the first column."""
    key = columns[0]
    start = used = len(_INDENT) + _width(heads[key.name], cells[key.name])
    panel = [key]
    for column in columns[1:]:
        width = _GAP + _width(heads[column.name], cells[column.name])
        if used + width > WIDTH:
            yield panel
            panel, used = [key], start
        panel.append(column)
        used += width
    yield panel


def _print(
    panel: Sequence[Column], heads: dict[str, str], cells: dict[str, list[str]], breaks: Sequence[int]
) -> list[str]:
    """Lines of one panel, with a blank line after each of the first groups."""
    tallest = max(heads[c.name].count("\n") for c in panel)
    # Heads are rows like others, filled up on top so that all units stand on the last line: as tabulate's
    # own headers they would get extra blanks.
    tops = ["\n" * (tallest - heads[c.name].count("\n")) + heads[c.name] for c in panel]
    lines = [*_lines(tops), ["-" * _width(heads[c.name], cells[c.name]) for c in panel]]
    ends = set(itertools.accumulate(breaks))
    for number, row in enumerate(zip(*(cells[c.name] for c in panel)), 1):
        lines += _lines(row)
        lines += [[""] * len(panel)] if number in ends else []
    align = ["left" if c.is_text else "right" for c in panel]
    # a column is one cell of many lines: tabulate looks at every cell several times
    cell = ["\n".join(column) for column in zip(*lines)]
    text = tabulate(
        [cell], tablefmt="plain", disable_numparse=True, colalign=align, preserve_whitespace=True
    )
    return [_INDENT + line for line in text.split("\n")]


def _lines(row: Sequence[str]) -> list[list[str]]:
    """Split a row of cells, some of several lines, into rows of one line each."""
    if not any("\n" in cell for cell in row):
        return [list(row)]
    return [list(line) for line in itertools.zip_longest(*(cell.split("\n") for cell in row), fillvalue="")]


def _width(head: str, cells: Iterable[str]) -> int:
    return max(map(len, "\n".join((head, *cells)).split("\n")))


def _format(column: Column, values: list[Any]) -> list[str]:
    """Texts of the cells of one column, numbers with equal numbers of decimals; ``-`` for no value."""
    if column.fmt == "text":
        texts = {v: plain(v)[: column.clip or None] for v in set(values)}
        return [texts[v] for v in values]
    if column.fmt == "int":
        return [column.zero if column.zero and not v else str(v) for v in values]
    shown = iter(_decimals(column.fmt, [v for v in values if math.isfinite(v)]))
    return [next(shown) if math.isfinite(v) else "-" if math.isnan(v) else str(v) for v in values]


def _decimals(fmt: str, values: list[float]) -> list[str]:
    """Texts of finite values in the format `fmt` of a column of real numbers."""
    if fmt == "time":
        return _times(values)
    if fmt == "count":
        return [f"{v:.0f}" for v in values]
    if fmt == "percent":
        return [_unsigned_zero(f"{v:.2f}") for v in values]
    as_given = fmt == "given"
    dust = _TINY if as_given else max(_TINY, _DUST * max(map(abs, values), default=0.0))
    return _numbers([v if abs(v) > dust else 0.0 for v in values], _DIGITS[fmt], as_given)


def _times(values: list[float]) -> list[str]:
    """Texts of times with three to six decimals, as the longest needs."""
    needed = max((len(f"{v:.6f}".rstrip("0").partition(".")[2]) for v in values), default=0)
    return [_unsigned_zero(f"{v:.{max(needed, 3)}f}") for v in values]


def _numbers(values: list[float], digits: int, every: bool = False) -> list[str]:
    """Texts of values to a number of significant digits: fixed-point if readable, else with exponents.

    Where the largest value has at most three digits more before the point than the smallest, it determines
    the decimals of all; otherwise, and with `every`, each value is shown to its last digit.
    """
    shapes = [_shape(v, digits) for v in values if v] or [(1, 0)]
    decimals = _fixed(shapes, digits, every)
    if decimals is not None:
        return [_unsigned_zero(f"{v:.{decimals}f}") for v in values]
    mantissa = max(1, *(n - 1 for n, _ in shapes))
    return [f"{v:.{mantissa}E}" if v else "0" for v in values]


def _fixed(shapes: Sequence[tuple[int, int]], digits: int, every: bool) -> int | None:
    """Number of decimals with which values are readable without exponents; None if they are not."""
    highest, lowest = max(e for _, e in shapes), min(e for _, e in shapes)
    alike = highest - lowest <= 3
    exact = max(1, *(n - 1 - e for n, e in shapes))  # decimals that show every value to its last digit
    room = max(0, digits - 1 - highest)  # decimals that show the largest value to its last digit
    if -3 <= highest < _WHOLE and (alike or exact <= room or highest + exact <= max(_WHOLE, digits)):
        return min(exact, room) if alike and not every else exact
    return None


def _shape(value: float, digits: int) -> tuple[int, int]:
    """Number of significant digits of a value without trailing zeros, and its decimal exponent."""
    mantissa, exponent = f"{abs(value):.{digits - 1}E}".split("E")
    return len(mantissa.replace(".", "").rstrip("0")), int(exponent)


def _unsigned_zero(text: str) -> str:
    """Text of a number without the minus sign of a zero."""
    return text[1:] if text[0] == "-" and not text.strip("-0.") else text


def plain(text: str) -> str:
    """Text in ASCII on one line."""
    if not text.isascii():
        text = "".join(map(_spelled, unicodedata.normalize("NFKD", unicodedata.normalize("NFC", text))))
    return re.sub(r"[\x00-\x1f\x7f]", "?", " ".join(text.split()))


def _spelled(char: str) -> str:
    """ASCII text for one decomposed character; empty for a combining accent."""
    if char.isascii() or char in _SIGNS:
        return _SIGNS.get(char, char)
    if unicodedata.combining(char):
        return ""
    greek = re.match(r"GREEK (SMALL|CAPITAL) LETTER (?:FINAL )?(\w+)", unicodedata.name(char, ""))
    if greek:
        return greek[2].lower() if greek[1] == "SMALL" else greek[2].capitalize()
    return "?"
