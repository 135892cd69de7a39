"""The part of ``manual/results.md`` that lists all tables and histories."""

from __future__ import annotations

from pound_solve.results.contents import HISTORIES, SECTIONS, TABLES
from pound_solve.results.schema import FORMATS


def results_page() -> str:
    """Return that part as Markdown."""
    out = ["## Tables", ""]
    for number, (heading, names) in enumerate(SECTIONS, 1):
        out += [f"### {number} {heading}", ""]
        for table in map(TABLES.__getitem__, names):
            out += [f"#### `{table.name}`: {table.title[0].lower()}{table.title[1:]}", ""]
            out += [table.note, ""] if table.note else []
            out += ["| column | stored as | unit | meaning |", "|---|---|---|---|"]
            for c in table.columns:
                unit = f"`{c.unit}`" if c.unit else ""
                meaning = c.doc or c.title.replace("\n", " ")
                out.append(f"| `{c.name}` | {FORMATS[c.fmt]} | {unit} | {meaning} |")
            out.append("")
    out += ["## Histories", "", "| dataset | one row | meaning |", "|---|---|---|"]
    out += [f"| `/history/{h.name}` | {h.row} | {h.doc} |" for h in HISTORIES.values()]
    return "\n".join(out) + "\n"
