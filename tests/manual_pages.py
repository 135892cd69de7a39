"""Parts of the manual that are made from the program's own tables, between two comments of a page."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from pound_deck.messages import MESSAGES
from pound_deck.schema import Spec
from pound_solve.report.listing import family_in_words, item_row, ordered_families, usage, vocabulary
from pound_solve.results.contents import HISTORIES, SECTIONS, TABLES
from pound_solve.results.schema import FORMATS
from pound_solve.sweep.study.quantities import QUANTITIES

MANUAL = Path(__file__).parents[1] / "manual"

#: headings of the messages by the beginning of their codes
SUBJECTS = {
    "P1": "Source text",
    "P2": "Cards and values",
    "P3": "The model",
    "R4": "Records",
    "A5": "Stops of an analysis",
    "S6": "Studies of many runs",
    "L6": "Models of other programs",
}


def table(heads: str, rows: Iterator[tuple[str, ...]]) -> list[str]:
    """Lines of a table, whose `heads` are separated by bars."""
    lines = [f"| {heads} |", "|" + "---|" * len(heads.split("|"))]
    return [
        *lines,
        *(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows),
    ]


def messages() -> list[str]:
    """Every code with its meaning and remedy."""
    lines = []
    for prefix, subject in SUBJECTS.items():
        rows = ((c, title, text) for c, (title, text) in MESSAGES.items() if c.startswith(prefix))
        lines += [f"## {subject}", "", *table("Code | Title | Meaning and remedy", rows), ""]
    return lines


def tables() -> list[str]:
    """All tables and histories of a results file."""
    lines = ["## Tables", ""]
    for number, (heading, names) in enumerate(SECTIONS, 1):
        lines += [f"### {number} {heading}", ""]
        for t in map(TABLES.__getitem__, names):
            lines += [
                f"#### `{t.name}`: {t.title[0].lower()}{t.title[1:]}",
                "",
                *([t.note, ""] if t.note else []),
            ]
            rows = (
                (
                    f"`{c.name}`",
                    FORMATS[c.fmt],
                    f"`{c.unit}`" if c.unit else "",
                    c.doc or " ".join(c.title.split("\n")),
                )
                for c in t.columns
            )
            lines += [*table("column | stored as | unit | meaning", rows), ""]
    histories = ((f"`/history/{h.name}`", h.row, h.doc) for h in HISTORIES.values())
    return [*lines, "## Histories", "", *table("dataset | one row | meaning", histories), ""]


def chapters() -> list[str]:
    """A chapter on every card that a deck may hold; the page has the heading of the first family."""
    known, lines = vocabulary(), list[str]()
    for family in ordered_families(known):
        heading, _, where = family_in_words(family)
        if family != "section":
            lines += [f"## {heading}", "", *([f"{where[0].upper()}{where[1:]}.", ""] if where else [])]
        for spec in known.family(family).values():
            lines += [*chapter(spec), ""]
    return lines


def chapter(spec: Spec) -> list[str]:
    """Chapter on one card."""
    facts = [f"Old code: {spec.code}."] if spec.code is not None else []
    facts += [f"Reference: {spec.reference}."] if spec.reference else []
    lines = [f"### {spec.name}", "", f"{spec.title[0].upper()}{spec.title[1:]}.", ""]
    lines += ["```", usage(spec), "```", *(["", " ".join(facts)] if facts else []), ""]
    rows = (item_row(f) for f in spec.fields)
    marked = ((f"`{name}`", f"`{unit}`" if unit else "", *more) for name, unit, *more in rows)
    return (
        [*lines, *table("item | unit | default | takes | meaning", marked)]
        if spec.fields
        else [*lines, "No items."]
    )


def quantities() -> list[str]:
    """The quantities of a sweep."""
    rows = ((f"`{q.name}`", q.axis or "none", f"`{q.unit}`", q.doc) for q in QUANTITIES)
    return table("quantity | labels | unit | meaning", rows)


#: page and maker of each part
PARTS = {
    "messages": ("messages.md", messages),
    "reference": ("deck-reference.md", chapters),
    "results": ("results.md", tables),
    "sweep": ("sweep.md", quantities),
}


def renewed(name: str) -> str:
    """Text of the page that holds a part, with this part as the program makes it now."""
    page, make = PARTS[name]
    text = (MANUAL / page).read_text(encoding="utf-8")
    start, end = f"<!-- made: {name} -->\n", "<!-- end -->"
    before, rest = text.split(start)
    return before + start + "\n".join(make()).rstrip() + "\n" + rest[rest.index(end) :]
