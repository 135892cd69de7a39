"""What a terminal shows: one line of progress at any width, colours, first steps, helps with examples."""

from __future__ import annotations

import io
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from pound_solve.cli import terminal
from pound_solve.cli.main import FIRST_STEPS, VERBS, main, parser
from pound_solve.cli.progress import AnalysisProgress, StatusLine

BAD = "NODES\n 1 0 0 FIX=XYR\n 2 x 0\n"


def terminal_of(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """Put a terminal in place of the error stream."""
    stream: Any = io.StringIO()
    stream.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return stream


def seen(text: str, columns: int) -> list[str]:
    """Rows of a terminal after a text; each return goes to the start of the row, nothing may wrap."""
    rows = []
    for line in text.split("\n"):
        row = [" "] * columns
        for part in line.split("\r"):
            assert len(part) < columns, part
            row[: len(part)] = part
        rows.append("".join(row).rstrip())
    return rows


@pytest.mark.parametrize("columns", [40, 60, 80, 120, 200])
def test_the_progress_is_one_line_at_any_width(monkeypatch: pytest.MonkeyPatch, columns: int) -> None:
    screen = terminal_of(monkeypatch)
    monkeypatch.setenv("COLUMNS", str(columns))
    clock = iter(range(1000))
    monkeypatch.setattr("time.monotonic", lambda: next(clock))
    progress = AnalysisProgress(False)
    for t in (10.0, 12345.6789, 5.0, 20000.25):
        progress(t, 123456.78, "")
        (row,) = seen(screen.getvalue(), columns)
        assert "%" in row and row.endswith("s to go")
    assert "run 2" in row
    progress.end()
    assert seen(screen.getvalue(), columns) == [""]


def test_a_line_that_is_too_long_ends_between_words(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = terminal_of(monkeypatch)
    monkeypatch.setenv("COLUMNS", "40")
    line = StatusLine()
    line.show("run 12 of 300: rigid-body modes with KELVIN_VOIGT contacts")
    assert seen(screen.getvalue(), 40) == [" run 12 of 300: rigid-body modes..."]
    line.show("short")
    assert seen(screen.getvalue(), 40) == [" short"]


def test_messages_are_painted_on_a_terminal_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    screen = terminal_of(monkeypatch)
    deck = tmp_path / "bad.inp"
    deck.write_text(BAD, "utf-8")
    assert main(["check", str(deck)]) == 2
    painted = screen.getvalue()
    for colour, words in (
        (terminal.RED, "error P222"),
        (terminal.GREEN, "   ^"),
        (terminal.CYAN, "  hint"),
    ):
        assert f"{colour}{words}{terminal.PLAIN}" in painted
    plain = re.sub(r"\x1b\[[\d;]*m", "", painted)
    for name, value in (("NO_COLOR", "1"), ("TERM", "dumb")):
        screen.seek(0)
        screen.truncate()
        with monkeypatch.context() as patch:
            patch.setenv(name, value)
            assert main(["check", str(deck)]) == 2
        assert screen.getvalue() == plain


def test_a_pipe_gets_no_colours(tmp_path: Path, capsys: Any) -> None:
    deck = tmp_path / "bad.inp"
    deck.write_text(BAD, "utf-8")
    assert main(["check", str(deck)]) == 2
    assert "error P222" in (err := capsys.readouterr().err) and "\x1b" not in err


def test_the_command_alone_says_what_to_do_first(capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for columns in ("40", "120"):
        monkeypatch.setenv("COLUMNS", columns)
        assert main([]) == 0
        text = capsys.readouterr().out
        assert all(f"  pound-solve {words}" in text and what in text for words, what in FIRST_STEPS)
    for words, _ in FIRST_STEPS:
        verb = words.split()[0]
        assert verb in (*VERBS, "model.inp", "--help")


def test_every_help_has_examples_that_the_program_takes(capsys: Any) -> None:
    for verb in VERBS:
        examples = import_module(f"pound_solve.cli.verbs.{verb}").EXAMPLES
        assert examples
        for words, what in examples:
            assert what and parser().parse_args([verb, *words.split()]).verb == verb
        with pytest.raises(SystemExit, match="0"):
            main([verb, "--help"])
        text = capsys.readouterr().out
        assert all(f"  pound-solve {verb} {words}".rstrip() in text for words, _ in examples)
