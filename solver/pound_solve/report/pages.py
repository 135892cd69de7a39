"""Pages of the text report for a printer: numbered, with form feeds between them and heads repeated."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final, NamedTuple

from pound_solve.report.text import WIDTH, plain
from pound_solve.results import Results

SHORTEST: Final = 20  #: least number of lines of a page, which holds the head of any table and some rows
_ROWS: Final = 2  #: least number of rows below the head of a table
_RULE: Final = re.compile(r"  -+(?:  -+)*")


class _Table(NamedTuple):
    """Lines of a table, or of a panel of a wide one: the head with the title above it, and the rows."""

    head: range
    rows: range


def paged(results: Results, text: str, length: int) -> str:
    """Divide the report of a results file into pages.

    Parameters
    ----------
    results : Results
        The file; its title and digest stand above every page.
    text : str
        The report, see `pound_solve.report.text.render`.
    length : int
        Number of lines of a page with the two of its head, at least `SHORTEST`.

    Returns
    -------
    str
        The report with a form feed between two pages.
    """
    pages = _pages(text.splitlines(), length - 2)
    right = [f"  {results.digest}  page {n} of {len(pages)}" for n in range(1, len(pages) + 1)]
    heads = [plain(results.title)[: WIDTH - len(r)].ljust(WIDTH - len(r)) + r for r in right]
    return "\f".join("\n".join((head, "", *page)) + "\n" for head, page in zip(heads, pages))


def _pages(lines: Sequence[str], length: int) -> list[list[str]]:
    """Lines of each page, filled as far as what belongs together allows."""
    tables = _tables(lines)
    heads = {k: table.head for table in tables for k in table.rows}
    joined = _joined(lines, tables)
    pages, start = list[list[str]](), 0
    while start < len(lines):
        repeated = [lines[k] for k in heads.get(start, ())]
        end = start + length - len(repeated)
        if end < len(lines):
            end = max((k for k in range(start + 1, end + 1) if k not in joined), default=end)
        pages.append([*repeated, *lines[start:end]])
        start = next((k for k in range(end, len(lines)) if lines[k]), len(lines))
    return pages


def _tables(lines: Sequence[str]) -> list[_Table]:
    """Find the tables by the rules of dashes below their heads."""
    heads = []
    for rule in (k for k, line in enumerate(lines) if _RULE.fullmatch(line)):
        top = rule
        while lines[top - 1]:
            top -= 1
        if re.fullmatch(r" +\S+(?: \S+)*", lines[top - 2]) and not lines[top - 3]:
            top -= 2  # a title of one line: rows have cells two blanks apart
        heads.append(range(top, rule + 1))
    ends = [*(head.start for head in heads[1:]), len(lines)]
    return [_Table(head, _rows(lines, head.stop, end)) for head, end in zip(heads, ends)]


def _rows(lines: Sequence[str], start: int, end: int) -> range:
    """Lines of the rows below a rule, at most up to `end`, with the blank lines among them."""
    gaps = [k for k, sign in enumerate(lines[start - 1]) if sign == " "]
    stop = start
    # a sentence of a note crosses a gap, which is two blanks wide, and a heading begins left of the first
    while stop < end and not any(lines[stop][k : k + 1].strip() for k in gaps):
        stop += 1
    return range(start, stop)


def _joined(lines: Sequence[str], tables: Sequence[_Table]) -> set[int]:
    """Lines before which no page begins, because they belong to the line above."""
    rows = {k for table in tables for k in table.rows}
    joined = {k for k in range(1, len(lines)) if lines[k - 1] and lines[k] and k not in rows}
    below_heading = False
    for k, line in enumerate(lines):
        if below_heading:
            joined.add(k)
        if line:
            below_heading = not line.startswith(" ")
    for head, below in tables:
        joined.update(range(head.start + 1, head.stop + _ROWS))
        key = len(lines[head[-1]].lstrip().split(" ")[0]) + 2
        # a row that goes on in a second line, with nothing in the first column
        joined.update(k for k in below if lines[k] and not lines[k][:key].strip())
    return joined
