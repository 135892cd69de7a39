"""Every deck below ``examples`` runs, and every expected number of a README is what the program gives.

Expected numbers stand in tables behind a comment ``<!-- expected: ... -->``, see ``examples/README.md``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pound_solve.check import looked
from pound_solve.driver.run import Request, prepare
from tiers import at_night

pytestmark = pytest.mark.full

LONG = "steel_20x6"  #: takes a tenth of a minute, and its numbers are compared in every check
WORDS = {"deck", "table", "key", "columns", "set", "times", "rtol", "only"}
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
    only: tuple[str, str] | None = None

    def __str__(self) -> str:
        return f"{self.readme.parent.name}:{self.line}-{self.deck.stem}-{self.table}"

    def differences(self, rows: Any) -> list[str]:
        """Every number that differs from a table of results (a structured array)."""
        out = []
        if self.only is not None:
            column, value = self.only
            rows = [r for r in rows if str(r[column]) == value]
        for cells in self.rows:
            mine = [
                r for n, r in enumerate(rows, 1) if cells[0] == str(n if self.key == "#" else r[self.key])
            ]
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
            raise ValueError(
                f"{readme}:{line}: the mark needs deck, table, key, columns; it has {sorted(words)}"
            )
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
            only_of(words["only"]) if "only" in words else None,
        )


def only_of(text: str) -> tuple[str, str]:
    """Column and value of the rows that count; _ stands for a blank."""
    column, _, value = text.partition("=")
    return column, value.replace("_", " ")


def table_after(text: str) -> list[list[str]]:
    """Body of the Markdown table that a text begins with."""
    lines = []
    for line in text.lstrip("\n").splitlines():
        if not line.startswith("|"):
            break
        lines.append([cell.strip() for cell in line.strip("|").split("|")])
    return lines[2:]


ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
#: decks of ``validation/open`` wait for numbers, see ``tests/verification/test_validation.py``
ALL_DECKS = sorted(deck for deck in EXAMPLES.rglob("*.inp") if deck.parent.name != "open")
#: decks that ``tests/verification`` runs, against their sources
ELSEWHERE = {"verification", "validation"}
DECKS = [deck for deck in ALL_DECKS if ELSEWHERE.isdisjoint(deck.parts)]
READMES = sorted(EXAMPLES.rglob("README.md"))
EXPECTED = [e for readme in READMES for e in read(readme)]


LEANING = ("06_unequal_frames/unequal_frames.inp", "frames/steel_10x3.inp")


@pytest.mark.parametrize(
    "deck",
    [*(d for d in DECKS if d.stem != LONG), *at_night(*(d for d in DECKS if d.stem == LONG))],
    ids=lambda d: f"{d.parent.name}/{d.name}",
)
def test_deck_runs_to_its_end_without_a_warning(deck: Path, run):
    status, results, prepared = run(deck)
    assert (status, results.status, results.message) == (0, "done", "")
    assert prepared.warnings == ()
    # what a reader of the report would look at first; strong records leave some buildings leaning
    looks = looked(results.checks)
    assert all("it leans" in check.remark for check in looks)
    assert bool(looks) == (f"{deck.parent.name}/{deck.name}" in LEANING)


@pytest.mark.parametrize(
    "deck", [d for d in ALL_DECKS if d not in DECKS], ids=lambda d: f"{d.parent.name}/{d.name}"
)
def test_deck_has_no_mistakes(deck: Path, records):
    records(deck)
    assert prepare(Request(str(deck))).warnings == ()


@pytest.mark.parametrize("expected", EXPECTED, ids=str)
def test_numbers_of_the_readme(expected: Expected, run):
    _, results, _ = run(expected.deck, expected.params)
    assert results.status == "done"
    assert expected.differences(results.table(expected.table)) == []


def test_every_folder_has_a_readme_that_names_its_decks_and_holds_numbers():
    index = (EXAMPLES / "README.md").read_text("utf-8")
    for folder in {deck.parent for deck in DECKS}:
        text = (folder / "README.md").read_text("utf-8")
        assert all(f"]({d.name})" in text for d in DECKS if d.parent == folder)
        assert f"({folder.name}/README.md)" in index
    assert {e.deck for e in EXPECTED} == set(DECKS)


def test_links_lead_somewhere():
    for readme in READMES:
        for link in links(readme.read_text("utf-8")):
            assert (readme.parent / link).exists(), f"{readme}: {link}"


def links(text: str) -> list[str]:
    """Files that a Markdown page links to."""
    found = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
    return [f for f in found if not f.startswith(("http:", "https:"))]


# The scheme itself: a test that compares numbers must be able to fail.

PAGE = """
# A page

<!-- expected: deck=a.inp set=n=5;s="x" table=t key=name columns=a,b times=0.001,1 -->

| name | a [mm] | b | remark |
|---|---|---|---|
| one | 1.50 | -2E3 | free |
| two | 0.004 | - | |
"""
ROWS = np.array(
    [("one", 0.001504, -2499.0), ("two", 4.4e-6, np.nan)], dtype=[("name", "O"), ("a", "f8"), ("b", "f8")]
)


def page(tmp_path: Path, text: str) -> list[Expected]:
    (tmp_path / "README.md").write_text(text, "utf-8")
    return list(read(tmp_path / "README.md"))


def test_a_mark_is_read(tmp_path: Path):
    (e,) = page(tmp_path, PAGE)
    assert (e.deck, e.line, e.params) == (tmp_path / "a.inp", 4, {"n": "5", "s": '"x"'})
    assert e.rows == (("one", "1.50", "-2E3"), ("two", "0.004", "-"))
    assert e.differences(ROWS) == []


@pytest.mark.parametrize(
    "row, column, value",
    [(0, "a", 0.001506), (0, "a", 0.001494), (0, "b", -2501.0), (1, "a", 4.6e-6), (1, "b", 0.0)],
)
def test_a_number_off_by_more_than_half_a_digit_is_told(
    tmp_path: Path, row: int, column: str, value: float
):
    (e,) = page(tmp_path, PAGE)
    rows = ROWS.copy()
    rows[column][row] = value
    assert len(e.differences(rows)) == 1


def test_a_missing_or_double_row_is_told(tmp_path: Path):
    (e,) = page(tmp_path, PAGE)
    assert len(e.differences(ROWS[:1])) == 1
    assert len(e.differences(np.concatenate([ROWS, ROWS[:1]]))) == 1


def test_a_relative_tolerance(tmp_path: Path):
    (e,) = page(tmp_path, PAGE.replace("key=name", "key=name rtol=0.01").replace("| - |", "| 7 |"))
    rows = ROWS.copy()
    rows["b"] = -1981.0, 7.06
    rows["a"][1] = 4e-6
    assert e.differences(rows) == []
    rows["b"] = -1979.0, 7.08
    assert len(e.differences(rows)) == 2


def test_only_some_rows_count(tmp_path: Path):
    (e,) = page(tmp_path, PAGE.replace("key=name", "key=name only=kind=the_right_one"))
    rows = np.array(
        [
            ("one", 0.001504, -2499.0, "the right one"),
            ("one", 7.0, 7.0, "another"),
            ("two", 4.4e-6, np.nan, "the right one"),
        ],
        dtype=[("name", "O"), ("a", "f8"), ("b", "f8"), ("kind", "O")],
    )
    assert e.differences(rows) == []
    rows["kind"][0] = "another"
    assert len(e.differences(rows)) == 1


@pytest.mark.parametrize(
    "old, new",
    [
        ("table=t", "tabel=t"),
        ("columns=a,b", ""),
        ("times=0.001,1", "times=1,2,3"),
        ("|---|---|---|---|\n", "\n"),
        ("columns=a,b times=0.001,1", "columns=a,b,c,d"),
    ],
)
def test_a_mark_with_a_slip_is_an_error(tmp_path: Path, old: str, new: str):
    with pytest.raises(ValueError, match=r"README.md:4"):
        page(tmp_path, PAGE.replace(old, new))


@pytest.mark.parametrize(
    "text, worth", [("12", 1), ("1.50", 0.01), ("-2E3", 1000), ("2.5e-3", 1e-4), ("0.", 1)]
)
def test_worth_of_the_last_digit(text: str, worth: float):
    assert last_digit(text) == pytest.approx(worth)
