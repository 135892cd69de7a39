"""Pages of the text report: nothing is lost or torn, and every row stands below its head."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from output import sample
from pound_solve.cli.main import main
from pound_solve.report.pages import SHORTEST, paged
from pound_solve.report.text import WIDTH, render
from pound_solve.results import Results

RULE = re.compile(r"  -[- ]*")
TABLE = """\
1  SECTION
=======

1.1  TABLE

  displacement

          X
  node  [m]
  ----  ---
{rows}

  velocity

            X
  node  [m/s]
  ----  -----
     1    0.5
     2    0.6

  A note of more than one line, which stays in one piece because
  nobody looks for the rest of a sentence on another page.
"""


def pages_of(results: Results, text: str, length: int) -> list[list[str]]:
    """Lines of each page without the head."""
    pages = [page.split("\n") for page in paged(results, text, length).split("\f")]
    for number, (head, below, *_) in enumerate(pages, 1):
        assert head.endswith(f"  {results.digest}  page {number} of {len(pages)}") and below == ""
        assert head.startswith("Two 2-storey buildings") and len(head) == WIDTH
    assert all(page[-1] == "" and len(page) - 1 <= length for page in pages)
    return [page[2:-1] for page in pages]


@pytest.mark.parametrize("length", [SHORTEST, 37, 60])
def test_a_report_is_whole(done: Results, length: int) -> None:
    text = render(done)
    assert "\f" not in text
    rest = iter(line for line in text.split("\n") if line)
    awaited = next(rest)
    for page in pages_of(done, text, length):
        repeated, printed = [], [line for line in page if line]
        for line in printed:
            if line == awaited:
                awaited = next(rest, "")
            else:
                repeated.append(line)
        assert not repeated or (printed[: len(repeated)] == repeated and RULE.fullmatch(repeated[-1]))
        assert printed[-1].startswith(" "), "a heading at the foot of a page"
        assert not RULE.fullmatch(printed[-1])
    assert awaited == ""


def test_heads_are_repeated_and_notes_stay_in_one_piece(done: Results) -> None:
    text = TABLE.format(rows="\n".join(f"    {k:2}  1.0" for k in range(10, 36)))
    first, second, third = pages_of(done, text, 22)
    head = ["  displacement", "", "          X", "  node  [m]", "  ----  ---"]
    assert first[5:10] == head == second[:5] and first[-1] == "    19  1.0" and second[5] == "    20  1.0"
    assert second[-1] == "    34  1.0" and third[:6] == [*head, "    35  1.0"]


def test_a_page_ends_before_a_table_of_which_it_holds_no_two_rows(done: Results) -> None:
    for rows in range(1, 30):
        text = TABLE.format(rows="\n".join(f"    {k:2}  1.0" for k in range(10, 10 + rows)))
        for page in pages_of(done, text, SHORTEST):
            assert not {"  velocity", "  node  [m/s]", "  ----  -----", "     1    0.5"} & {page[-1]}
            assert "another page" in page[-1] or "A note" not in page[-1]


@pytest.mark.parametrize("length", [20, 21])
def test_rows_of_two_lines_are_not_divided(done: Results, length: int) -> None:
    text = TABLE.format(rows="\n".join(f"    {k:2}  one\n        two" for k in range(10, 36)))
    pages = pages_of(done, text, length)
    assert len(pages) > 3
    assert [page for page in pages if page[-1].endswith("one")] == []


def test_the_command_prints_pages(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(sample.write(tmp_path / "o.h5"))
    assert main(["report", path, "--pages"]) == 0
    usual = capsys.readouterr().out
    assert max(len(page.splitlines()) for page in usual.split("\f")) == 60
    assert main(["report", path, "--brief", "--pages", "20"]) == 0
    assert capsys.readouterr().out.count("\f") >= 1
    for wrong in (str(SHORTEST - 1), "a4", "-60"):
        with pytest.raises(SystemExit):
            main(["report", path, f"--pages={wrong}"])
        assert f"{wrong} is no number of lines, {SHORTEST} at least" in capsys.readouterr().err
