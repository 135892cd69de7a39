"""``pound-solve format``: put the items of a deck into columns."""

from __future__ import annotations

import argparse
import os
import shutil
from pathlib import Path

from pound_solve.cli import common, terminal

SUMMARY = "put the items of a deck into columns; values, comments and meaning stay"
EXAMPLES = (
    ("model.inp", "align the items in columns"),
    ("model.inp --check", "only tell whether that would change the deck"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("deck", type=Path, help="input deck; it is rewritten unless -o is given")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--check", action="store_true", help="write nothing; exit status 1 if the deck would change"
    )
    where.add_argument("-o", "--out", type=Path, metavar="FILE", help="write here in place of the deck")


def execute(args: argparse.Namespace) -> int:
    """Lay out the deck and write it, unless it has mistakes of syntax."""
    from pound_deck.diagnostics import render
    from pound_deck.files import contents
    from pound_deck.layout import arranged

    data = contents(args.deck)
    new, diagnostics, files = arranged(str(args.deck), data)
    if diagnostics:
        terminal.tell(render(diagnostics, files))
    if new is None:
        return common.complain(f"{args.deck} has mistakes: it is left as it is", common.MISTAKES)
    if args.check:
        print(f"{args.deck}: {'is in columns' if new == data else 'would change'}")
        return common.DONE if new == data else common.STOPPED
    if args.out or new != data:
        _write(args.out or args.deck, new)
    return common.DONE


def _write(path: Path, data: bytes) -> None:
    """Write a deck, preserving its mode and a link to it."""
    from pound_solve.results.whole_file import whole

    real = Path(os.path.realpath(path))  # the target of a link
    with whole(real) as partial:
        partial.write_bytes(data)
        if real.exists():
            shutil.copymode(real, partial)
