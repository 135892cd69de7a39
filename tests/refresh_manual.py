"""Rewrite the pages of the manual that the program makes (``make manual``);
tests check that they are fresh.
"""

import argparse
from pathlib import Path

from highlighters import kate, notepad, textmate
from pound_deck.messages import messages_page
from pound_solve.assess.law_test import AXES, has_loop, picture
from pound_solve.catalog import specs
from pound_solve.report.deck_reference import deck_page
from pound_solve.results.page import results_page
from pound_solve.sweep.study import quantities
from verification import cases

MANUAL = Path(__file__).parents[1] / "manual"


def write(name: str, text: str) -> None:
    """Write a page."""
    (MANUAL / name).write_text(text, encoding="utf-8", newline="\n")


def pictures() -> dict[str, str]:
    """Loops of all rules and contact laws as SVG, by file name."""
    drawn = [s for s in specs() if s.family in AXES and has_loop(s)]
    kind = {"hysteresis": "loop", "contact": "contact"}
    return {f"{kind[s.family]}_{s.name.lower()}.svg": picture(s) for s in drawn}


def messages() -> None:
    """The page of messages."""
    write("messages.md", messages_page())


def reference() -> None:
    """The deck reference."""
    write("deck-reference.md", deck_page())


def results() -> None:
    """The tables of the results file, below a head that is written by hand."""
    page = (MANUAL / "results.md").read_text(encoding="utf-8")
    mark = "<!-- made by pound_solve.results.page.results_page"
    head, line = page.split(mark)[0], mark + page.split(mark)[1].split("\n")[0]
    write("results.md", f"{head}{line}\n\n{results_page()}")


def sweep() -> None:
    """The quantities of a sweep, in a page that is written by hand."""
    page = (MANUAL / "sweep.md").read_text(encoding="utf-8")
    before, rest = page.split("<!-- quantities -->\n")
    after = rest.partition("<!-- end -->")[2]
    write("sweep.md", f"{before}<!-- quantities -->\n{quantities.page()}<!-- end -->{after}")


def verification() -> None:
    """The page of verification, whose cases are run."""
    page = cases.page(cases.PAGE.read_text(encoding="utf-8"))
    cases.PAGE.write_text(page, encoding="utf-8", newline="\n")


def loops() -> None:
    """The pictures of rules and contact laws."""
    folder = MANUAL / "pictures"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("*.svg"):
        old.unlink()
    for name, text in pictures().items():
        write(f"pictures/{name}", text)


def editors() -> dict[str, str]:
    """Highlighting of decks, by file name."""
    return {
        "editor/vscode/pound-deck.tmLanguage.json": textmate.text(),
        "editor/pound-deck.udl.xml": notepad.text(),
        "editor/pound-deck.xml": kate.text(),
    }


def highlighting() -> None:
    """The highlighting of decks in editors."""
    for name, text in editors().items():
        write(name, text)


PARTS = {
    part.__name__: part for part in (messages, reference, results, sweep, loops, highlighting, verification)
}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", help=f"of {', '.join(PARTS)}; all if left out")
    parts = parser.parse_args().parts or [*PARTS]
    if unknown := sorted({*parts} - PARTS.keys()):
        parser.error(f"no part: {', '.join(unknown)}")
    for name in parts:
        PARTS[name]()
