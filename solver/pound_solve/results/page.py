"""The part of ``manual/results.md`` that lists all tables and histories."""

from __future__ import annotations

from pound_solve.results.contents import HISTORIES, SECTIONS, TABLES
from pound_solve.results.schema import FORMATS


def results_page() -> str:
    """Return the list of all tables and histories as Markdown."""
    lines = ["## Tables", ""]
    for number, (heading, names) in enumerate(SECTIONS, 1):
        lines += [f"### {number} {heading}", ""]
        for table in map(TABLES.__getitem__, names):
            lines += [f"#### `{table.name}`: {table.title[0].lower()}{table.title[1:]}", ""]
            lines += [table.note, ""] if table.note else []
            lines += ["| column | stored as | unit | meaning |", "|---|---|---|---|"]
            for c in table.columns:
                unit = f"`{c.unit}`" if c.unit else ""
                meaning = c.doc or c.title.replace("\n", " ")
                lines.append(f"| `{c.name}` | {FORMATS[c.fmt]} | {unit} | {meaning} |")
            lines.append("")
    lines += ["## Histories", "", "| dataset | one row | meaning |", "|---|---|---|"]
    lines += [f"| `/history/{h.name}` | {h.row} | {h.doc} |" for h in HISTORIES.values()]
    return "\n".join(lines) + "\n"
