"""The report as one HTML page, with sortable tables and zoomable pictures.

The page is self-contained: it includes the library of the pictures (plotly.js, extra ``html``), its style
and its script, and a policy in its head forbids the browser to fetch anything.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator, Sequence
from html import escape
from importlib.resources import files
from itertools import accumulate
from typing import Any, Final, NamedTuple

from pound_solve.report.html.picture import PlotlyPicture
from pound_solve.report.html.pictures import pictures
from pound_solve.report.text import ReportTable, formatted, incomplete, shown
from pound_solve.results import Results
from pound_solve.results.contents import SECTIONS, TABLES
from pound_solve.results.schema import Table

#: policy of the browser: only the contents of the page, and images that it creates
POLICY: Final = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "form-action 'none'; base-uri 'none'"
)

_LONG: Final = 22  #: characters from which on a text is wrapped on a narrow screen
#: a cell that is a number, or has no value
_NUMBER: Final = re.compile(r"-?|[-+]?(\d+\.?\d*(E[-+]?\d+)?|inf)", re.I)
#: numbers and dates that a browser would break at their hyphens
_HYPHENATED: Final = re.compile(r"(?<![\w.])\d[\d.]*(E-\d+|(-\d+){2})(?![\w-])", re.I)


class _PageSection(NamedTuple):
    """One section of the page: its anchor, heading, and content."""

    place: str
    heading: str
    body: str


def page(results: Results, *, limit: int | None = None, only: Collection[str] | None = None) -> str:
    """Report of a results file as HTML; for the parameters see `pound_solve.report.text.render`.

    Without pictures if `only` is given.

    Raises
    ------
    ImportError
        plotly is not installed.
    """
    library = _library()
    present = set(results.tables) if only is None else set(results.tables) & set(only)
    sections = list[_PageSection]()
    for heading, names in SECTIONS:
        number, tables = len(sections) + 1, list[str]()
        for name in names:
            place = f"{number}.{len(tables) + 1}"
            if name in present and (lines := "".join(_table(results, TABLES[name], place, limit))):
                tables.append(lines)
        if tables:
            sections.append(_PageSection(f"s{number}", f"{number} {heading}", "".join(tables)))
    drawn = pictures(results) if only is None else []
    if drawn:  # after the summary
        figures = "".join(_figure(f"p{k}", picture) for k, picture in enumerate(drawn, 1))
        sections.insert(1, _PageSection("pictures", "Pictures", figures))
    return "".join((*_head(results), *_body(results, sections), *_programs(drawn, library)))


def _library() -> str:
    """Source text of plotly.js."""
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs())


def _own(name: str) -> str:
    """Text of a file beside this module."""
    return (files(__name__) / name).read_text("utf-8")


def _title(results: Results) -> str:
    return escape(results.title or results.path.stem)


def _head(results: Results) -> Iterator[str]:
    yield '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
    yield f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
    yield '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
    yield f"<title>{_title(results)}</title>\n<style>\n{_own('page.css')}</style>\n</head>\n"


def _body(results: Results, sections: Sequence[_PageSection]) -> Iterator[str]:
    links = (f'<a href="#{s.place}">{s.heading}</a>\n' for s in sections)
    yield f"<body>\n<nav>\n{''.join(links)}</nav>\n<main>\n<h1>{_title(results)}</h1>\n"
    units = ", ".join(map(escape, (results.units.force, results.units.length, results.units.time)))
    made = f"; results {results.digest}" if results.digest else ""
    yield f"<p>pound-solve {escape(results.program_version)}; units {units}{made}</p>\n"
    sentences = incomplete(results)
    if sentences:
        yield f'<div class="warning">{"".join(f"<p>{escape(text)}</p>" for text in sentences)}</div>\n'
    for s in sections:
        yield f'<section id="{s.place}">\n<h2>{s.heading}</h2>\n{s.body}</section>\n'
    yield "</main>\n"


def _programs(drawn: Sequence[PlotlyPicture], library: str) -> Iterator[str]:
    if drawn:
        data = json.dumps([p.as_json() for p in drawn], allow_nan=False, separators=(",", ":"))
        data = data.replace("</", r"<\/")  # no text in them may end the script element
        yield f"<script>{library}</script>\n"
        yield f'<script type="application/json" id="figures">{data}</script>\n'
    yield f"<script>\n{_own('page.js')}</script>\n</body>\n</html>\n"


def _figure(place: str, picture: PlotlyPicture) -> str:
    note = f"<figcaption>{escape(picture.note)}</figcaption>" if picture.note else ""
    head = f"<figure><h3>{escape(picture.title)}</h3>"
    return f'{head}<div class="picture" id="{place}"></div>{note}</figure>\n'


def _table(results: Results, table: Table[Any], number: str, limit: int | None) -> Iterator[str]:
    """Yield the HTML of a table with its notes, in one part or several; nothing for an empty table."""
    parts = [line for part in shown(results, table, limit) for line in _part(results, part)]
    if not parts:
        return
    yield f"<h3>{number} {escape(table.title)}</h3>\n"
    yield from parts
    notes = (table.note, results.note(table.name))
    yield from (f'<p class="note">{_text(text)}</p>\n' for text in notes if text)


def _part(results: Results, part: ReportTable) -> Iterator[str]:
    """Yield the HTML of a part of a table."""
    columns, heads, cells, blocks = formatted(results.units, part.table, part.rows)
    if not columns:
        return
    if part.title:
        yield f'<p class="part">{escape(part.title)}</p>\n'
    yield f'<div class="wide"><table class="{part.table.name}">\n<thead><tr>'
    kinds = ["text" if c.is_text and not _are_numbers(cells[c.name]) else "number" for c in columns]
    for column, kind in zip(columns, kinds):
        head = "<br>".join(map(_head_line, heads[column.name].split("\n")))
        yield f'<th class="{kind}" aria-sort="none"><button type="button">{head}</button></th>'
    yield "</tr></thead>\n<tbody>\n"
    starts = set(accumulate(blocks[:-1])) if len(blocks) < len(part.rows) else set()
    for place, row in enumerate(zip(*(cells[c.name] for c in columns))):
        yield '<tr class="block">' if place in starts else "<tr>"
        yield from map(_cell, kinds, row)
        yield "</tr>\n"
    yield "</tbody></table></div>\n"
    if part.more:
        yield f'<p class="note">{escape(part.more)}</p>\n'


def _are_numbers(cells: Sequence[str]) -> bool:
    return all(map(_NUMBER.fullmatch, cells))


def _cell(kind: str, text: str) -> str:
    kind += " long" if len(text) >= _LONG else ""
    return f'<td class="{kind}">{_text(text)}</td>'


def _head_line(line: str) -> str:
    """HTML of a line of a head; a unit stays in one piece."""
    return f"<span>{escape(line)}</span>" if line.startswith("[") else escape(line)


def _text(text: str) -> str:
    """HTML of a text, in which numbers stay in one piece."""
    return _HYPHENATED.sub(r"<span>\g<0></span>", escape(text))
