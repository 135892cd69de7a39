"""The tutorial, followed to the letter: every deck is saved, every command run, every print compared.

A comment before a fenced block says what it is: ``file: name`` (saved), ``run`` (each line a command, exit
status 0 or ``run: status N``), ``prints`` (all that the last command or script printed), ``in: file``
(lines that stand together in that file), ``python`` (a script), ``not run``.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
import shlex
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from kernels import as_with_numba
from pound_solve.cli.main import main
from pound_solve.numerics.jit import COMPILING
from pound_solve.results.contents import SECTIONS, TABLES

pytestmark = pytest.mark.full

MANUAL = Path(__file__).parents[2] / "manual"
EXAMPLE = Path(__file__).parents[2] / "examples" / "01_two_oscillators"
BLOCK = re.compile(r"(?:^<!-- ([^>]*?) -->\n)?^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)

Block = tuple[str, str]


def blocks(text: str) -> list[Block]:
    """What each fenced block of a page is, and its text."""
    return [(m[1] or "", m[3]) for m in BLOCK.finditer(text)]


def follow(steps: list[Block]) -> list[str]:
    """Do all steps in the present folder; the kinds of the steps that were done."""
    printed, done = "", []
    for mark, text in steps:
        kind, _, rest = (part.strip() for part in mark.partition(":"))
        match kind:
            case "file":
                Path(rest).write_text(text, "utf-8")
            case "run":
                for line in text.splitlines():
                    words = shlex.split(line)
                    assert words[0] == "pound-solve", line
                    status, printed = captured(main, words[1:])
                    assert status == int(rest.removeprefix("status") or 0), f"{line}: {printed}"
            case "python":
                _, printed = captured(exec, compile(text, "tutorial", "exec"), {"__name__": "tutorial"})
            case "prints":
                assert printed.strip() == text.strip()
            case "in":
                page = plain(Path(rest).read_text("ascii"))
                assert "\n" + plain(text) in page, f"{rest} has no such lines:\n{text}"
            case "not run":
                continue
            case _:
                raise AssertionError(f"a block without a mark, or with an unknown one: {mark!r}\n{text}")
        done.append(kind)
    return done


def captured(function: Any, *arguments: Any) -> tuple[Any, str]:
    """Result of a call, and what it printed on either stream, but that it compiled kernels."""
    stream = io.StringIO()
    with contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream):
        result = function(*arguments)
    return result, stream.getvalue().replace(f"pound-solve: {COMPILING}\n", "")


def plain(text: str) -> str:
    """Without blanks at the ends of lines; what is rounding has other digits on other processors."""
    text = re.sub(r" *\b\d(?:\.\d+)?[eE]-1[4-9]\b", " 0", text)
    return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"


@pytest.fixture
def matplotlib(monkeypatch: pytest.MonkeyPatch) -> None:
    """A matplotlib that draws nothing and writes the file's name down, where there is none."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
    if importlib.util.find_spec("matplotlib"):
        return
    pyplot: Any = ModuleType("matplotlib.pyplot")
    for name in ("plot", "vlines", "xlabel", "ylabel", "legend"):
        setattr(pyplot, name, lambda *_, **__: None)
    pyplot.savefig = lambda name: Path(name).write_bytes(b"")
    package: Any = ModuleType("matplotlib")
    package.pyplot = pyplot
    monkeypatch.setitem(sys.modules, "matplotlib", package)
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", pyplot)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # matplotlib's own
@pytest.mark.usefixtures("matplotlib")
def test_the_tutorial_can_be_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    as_with_numba(monkeypatch)
    done = follow(blocks((MANUAL / "tutorial.md").read_text("utf-8")))
    assert {"file", "run", "python", "prints", "in"} == set(done)
    assert Path("drifts.png").exists()


def test_its_deck_is_the_example():
    steps = dict(blocks((MANUAL / "tutorial.md").read_text("utf-8")))
    name = "two_oscillators.inp"
    assert steps[f"file: {name}"] == (EXAMPLE / name).read_text("utf-8")


@pytest.mark.parametrize("page", ["tutorial.md", "README.md", "deck-reference.md"])
def test_links_lead_somewhere(page: str):
    text = (MANUAL / page).read_text("utf-8")
    links = [link for link in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text) if "://" not in link]
    assert links
    assert [link for link in links if not (MANUAL / link).exists()] == []


def test_the_index_names_every_page():
    index = (MANUAL / "README.md").read_text("utf-8")
    assert [
        p.name for p in sorted(MANUAL.glob("*.md")) if p.name != "README.md" and f"({p.name})" not in index
    ] == []


@pytest.mark.parametrize(
    "steps",
    [
        [("", "x")],
        [("walk", "x")],
        [("run", "pound-solve check missing.inp")],
        [("run: status 2", "pound-solve list")],
        [("run", "pound-solve list contact"), ("prints", "something else")],
        [("python", "print(1)"), ("prints", "2")],
        [("python", "raise ValueError")],
        [("file: a.txt", "one\ntwo\n"), ("in: a.txt", "one\nthree\n")],
        [("file: a.txt", "one\ntwo\n"), ("in: a.txt", "wo\n")],
    ],
)
def test_a_page_that_is_wrong_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, steps: list[Block]):
    monkeypatch.chdir(tmp_path)
    with pytest.raises((AssertionError, ValueError)):
        follow(steps)


def test_the_numbers_in_the_prose():
    """What the text says of the run, as far as no block shows it."""
    text = " ".join((MANUAL / "tutorial.md").read_text("utf-8").split())
    for said in (
        "6288 kN/m",
        "2141 kN s/m",
        "15 %",
        "3901 kN",
        "3.7 mm",
        "26 kN m",
        "0.646 m/s",
        "0.414 m/s",
        "21 ms",
    ):
        assert said in text
    for shown in ("6287.97", " 2141 ", "0.1499", "3900.5", "0.003727", "25.97", "0.6462", "0.4136"):
        assert shown in text


def test_sections_and_tables_have_the_numbers_that_the_tutorial_gives():
    page = (MANUAL / "tutorial.md").read_text("utf-8")
    section_of = {
        t.title.upper(): heading for heading, names in SECTIONS for t in map(TABLES.get, names) if t
    }
    parts = re.split(r"^### (\d+) (\w+).*$", page.split("\n## 5 ")[0], flags=re.MULTILINE)[1:]
    heads = list(zip(parts[::3], parts[1::3], parts[2::3]))
    shown = {}
    for number, word, text in heads:
        for at, title in re.findall(r"^(\d+\.\d+)  ([A-Z].*)$", text, re.MULTILINE):
            assert at.startswith(f"{number}.") and section_of[title].startswith(word)
            shown[at] = title
    assert len(heads) >= 7 and {at.split(".")[0] for at in shown} == {number for number, _, _ in heads}
    named = re.findall(r'Table (\d+\.\d+), "([^"]+)"', page)
    assert named and all(shown[number] == title.upper() for number, title in named)
