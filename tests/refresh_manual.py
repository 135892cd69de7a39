"""Rewrite the pages of the manual that the program makes (``make manual``);
tests check that they are fresh.
"""

import argparse
from functools import partial

import manual_pages
from highlighters import kate, notepad, textmate
from manual_pages import MANUAL
from pound_solve.assess.law_test import AXES, picture
from pound_solve.catalog import specs
from samples import has_loop
from verification import cases, validation


def write(name: str, text: str) -> None:
    """Write a page."""
    (MANUAL / name).write_text(text, encoding="utf-8", newline="\n")


def pictures() -> dict[str, str]:
    """Loops of all rules and contact laws as SVG, by file name."""
    drawn = [s for s in specs() if s.family in AXES and has_loop(s)]
    kind = {"hysteresis": "loop", "contact": "contact"}
    return {f"{kind[s.family]}_{s.name.lower()}.svg": picture(s) for s in drawn}


def verification() -> None:
    """The page of verification, whose cases are run."""
    page = cases.page(cases.PAGE.read_text(encoding="utf-8"))
    cases.PAGE.write_text(page, encoding="utf-8", newline="\n")


def experiments() -> None:
    """The page of validation, whose cases are run."""
    page = validation.page(validation.PAGE.read_text(encoding="utf-8"))
    validation.PAGE.write_text(page, encoding="utf-8", newline="\n")


def loops() -> None:
    """The pictures of rules and contact laws."""
    folder = MANUAL / "pictures"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("*.svg"):
        old.unlink()
    for name, text in pictures().items():
        write(f"pictures/{name}", text)


def gallery() -> None:
    """The pictures of runs."""
    import gallery as pictures_of_runs

    pictures_of_runs.draw()


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


def renew(name: str) -> None:
    """A page that holds a part made from the program's tables."""
    write(manual_pages.PARTS[name][0], manual_pages.renewed(name))


PARTS = {name: partial(renew, name) for name in manual_pages.PARTS} | {
    part.__name__: part for part in (loops, gallery, highlighting, verification, experiments)
}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", help=f"of {', '.join(PARTS)}; all but gallery if left out")
    # the gallery needs matplotlib, and each version of it draws other bytes
    parts = parser.parse_args().parts or [name for name in PARTS if name != "gallery"]
    if unknown := sorted({*parts} - PARTS.keys()):
        parser.error(f"no part: {', '.join(unknown)}")
    for name in parts:
        PARTS[name]()
