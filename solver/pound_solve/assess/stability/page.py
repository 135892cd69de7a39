"""The page of the stability matrix: outcomes by scene and method, and the words of all stops."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from typing import Final

from pound_solve.assess.stability.judge import (
    ALONE,
    ENDS,
    FAULT,
    FLAGGED,
    PARTLY,
    RIGHT,
    STOPPED,
    JudgedRun,
    methods,
)

MEANS: Final = {
    RIGHT: "as the reference",
    FLAGGED: "off, and a check of the report says so",
    STOPPED: "refused or stopped in words",
    FAULT: "all else, such as a wrong answer that no check flags",
}
REFUSED_AT: Final = re.compile(r"^.*?\.inp:\d+:\d+: error ")  #: place in a temporary file


def table(rows: Sequence[JudgedRun]) -> str:
    """Counts of the outcomes, scene by method, as Markdown."""
    by: dict[str, dict[str, list[JudgedRun]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        by[row.case.family][row.case.scene].append(row)
    lines = []
    for family, scenes in by.items():
        lines += [*_counts(family, scenes), ""]
    return "\n".join([*lines, _total(rows)])


def _counts(family: str, scenes: Mapping[str, Sequence[JudgedRun]]) -> list[str]:
    """Table of one family: a line for each scene, a column for each method."""
    names = methods()
    lines = [f"| {family} | cases | " + " | ".join(names) + " |", "|---" * (len(names) + 2) + "|"]
    for scene, cells in scenes.items():
        ends = [Counter(r.end for r in cells if r.method == m) for m in names]
        texts = [" / ".join(str(e[x]) for x in ENDS) for e in ends]
        lines.append(f"| {scene} | {len(cells) // len(names)} | " + " | ".join(texts) + " |")
    return lines


def _total(rows: Sequence[JudgedRun]) -> str:
    """Text with the number of all cases and outcomes."""
    ends, alone = Counter(r.end for r in rows), sum(r.says == ALONE for r in rows)
    counts = ", ".join(f"{ends[e]} {e}" for e in ENDS)
    n = len({id(r.case) for r in rows})
    text = f"{n} cases, {len(rows)} runs: {counts}. Of those right {alone} are known by their energy alone"
    partly = sum(r.end == RIGHT and r.says.startswith(PARTLY) for r in rows)
    return text + (f", {partly} in part, as far as the answer is known." if partly else ".")


def stops(rows: Sequence[JudgedRun]) -> str:
    """Stops by kind, with count, methods and an example; then runs known in part, and all faults."""
    kinds: dict[str, list[tuple[str, JudgedRun]]] = defaultdict(list)
    for row in rows:
        if row.end == STOPPED:
            text = REFUSED_AT.sub("", row.says.split("\n")[0])
            kinds[re.sub(r"[-+\d.e]*\d[-+\d.e]*", "0", text)].append((text, row))
    lines = ["| stops | by | the first of them | in the scene |", "|---|---|---|---|"]
    for kind in sorted(kinds.values(), key=len, reverse=True):
        (text, first), by = kind[0], ", ".join(dict.fromkeys(row.method for _, row in kind))
        lines.append(f"| {len(kind)} | {by} | {text} | {_scene(first)} |")
    lines += [
        f"- {_scene(r)} by {r.method}: {r.says}"
        for r in rows
        if r.end == FAULT or (r.end == RIGHT and r.says.startswith(PARTLY))
    ]
    return "\n".join(lines)


def _scene(row: JudgedRun) -> str:
    return ", ".join(x for x in (row.case.scene, row.case.variant, row.case.law) if x)


def page(rows: Sequence[JudgedRun]) -> str:
    """Counts and stops, for the terminal and the manual."""
    cells = "; ".join(f"{end}: {MEANS[end]}" for end in ENDS)
    return f"{table(rows)}\n\nThe cells count {' / '.join(ENDS)}. {cells}.\n\n{stops(rows)}"
