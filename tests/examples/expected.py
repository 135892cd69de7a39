"""Expected numbers in the READMEs of the examples: tables behind a comment ``<!-- expected: ... -->``.

``examples/README.md`` describes the words of the comment.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

WORDS = {"deck", "table", "key", "columns", "set", "times", "rtol"}
MARK = re.compile(r"<!-- expected:(.*?)-->", re.DOTALL)


@dataclass(frozen=True)
class Expected:
    """One table of a README and what it is compared with."""

    readme: Path
    line: int
    deck: Path
    table: str
    key: str
    columns: tuple[str, ...]
    times: tuple[float, ...]
    rows: tuple[tuple[str, ...], ...]
    params: dict[str, str] = field(default_factory=dict)
    rtol: float | None = None

    def __str__(self) -> str:
        return f"{self.readme.parent.name}:{self.line}-{self.deck.stem}-{self.table}"

    def differences(self, rows: Any) -> list[str]:
        """Every number that differs from a table of results (a structured array)."""
        out = []
        for cells in self.rows:
            mine = [r for n, r in enumerate(rows, 1) if cells[0] == str(n if self.key == "#" else r[self.key])]
            if len(mine) != 1:
                out.append(f"{self}: {len(mine)} rows of the results have {self.key} {cells[0]}")
                continue
            for name, text, times in zip(self.columns, cells[1:], self.times, strict=True):
                got = float(mine[0][name])
                if not self._agree(text, got, times):
                    out.append(f"{self}: {cells[0]} {name} is {got / times:.12g}, README says {text}")
        return out

    def _agree(self, text: str, got: float, times: float) -> bool:
        if text == "-":
            return math.isnan(got)
        want = float(text)
        if self.rtol is not None:
            return abs(got / times - want) <= self.rtol * abs(want)
        # a hair more than half a unit, for what the decimal fraction itself loses
        return abs(got / times - want) <= 0.5000001 * last_digit(text)


def last_digit(text: str) -> float:
    """Worth of the last digit of a number as written."""
    mantissa, _, exponent = text.upper().partition("E")
    return float(10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2])))


def read(readme: Path) -> Iterator[Expected]:
    """All marked tables of a README.

    Raises
    ------
    ValueError
        A mark is not understood, or no table follows it.
    """
    text = readme.read_text("utf-8")
    # a fenced block only tells how marks are written
    text = re.sub(r"^```.*?^```", lambda m: "\n" * m[0].count("\n"), text, flags=re.DOTALL | re.MULTILINE)
    for mark in MARK.finditer(text):
        line = text.count("\n", 0, mark.start()) + 1
        words = dict(word.partition("=")[::2] for word in mark[1].split())
        if not {"deck", "table", "key", "columns"} <= words.keys() <= WORDS:
            raise ValueError(f"{readme}:{line}: the mark needs deck, table, key, columns; it has {sorted(words)}")
        columns = tuple(words["columns"].split(","))
        times = [float(t) for t in words.get("times", "1").split(",")]
        if len(times) == 1:
            times *= len(columns)
        rows = tuple(tuple(cells[: 1 + len(columns)]) for cells in table_after(text[mark.end() :]))
        if not rows or len(times) != len(columns) or any(len(r) != 1 + len(columns) for r in rows):
            raise ValueError(f"{readme}:{line}: no table of {1 + len(columns)} columns, or wrong times=")
        yield Expected(
            readme,
            line,
            readme.parent / words["deck"],
            words["table"],
            words["key"],
            columns,
            tuple(times),
            rows,
            dict(item.partition("=")[::2] for item in words["set"].split(";")) if "set" in words else {},
            float(words["rtol"]) if "rtol" in words else None,
        )


def table_after(text: str) -> list[list[str]]:
    """Body of the Markdown table that a text begins with."""
    lines = []
    for line in text.lstrip("\n").splitlines():
        if not line.startswith("|"):
            break
        lines.append([cell.strip() for cell in line.strip("|").split("|")])
    return lines[2:]
