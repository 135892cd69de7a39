"""``pound-solve import``: translate a deck of Ruaumoko-2D into one of this program."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "make a deck of this program of one of Ruaumoko-2D; comments say how it was read"
EXAMPLES = (("old.dat -o model.inp", "translate a deck of Ruaumoko-2D"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("deck", type=Path, help="deck of Ruaumoko-2D")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="new deck (default: standard output)"
    )
    parser.add_argument(
        "--record",
        action="append",
        default=[],
        type=Path,
        metavar="FILE",
        help="file of a record that does not follow in the deck; twice: the vertical one, too",
    )


def execute(args: argparse.Namespace) -> int:
    """Write the new deck; print how the old one was read."""
    from pound_deck.diagnostics import has_errors, render
    from pound_deck.files import contents
    from pound_import.ruaumoko.equake import File
    from pound_solve.driver.reading import imported

    folder = args.out.parent if args.out else Path()
    records = [File(_from(folder, path), contents(path).decode("latin-1")) for path in args.record]
    text, old = imported(str(args.deck), records, _from(folder, args.deck))
    print(render(old.report, {str(args.deck): text}), file=sys.stderr)
    if has_errors(old.report):
        return common.MISTAKES
    if args.out is None:
        print(old.text, end="")
        return common.DONE
    if args.out.exists() and args.out.samefile(args.deck):
        return common.complain(f"{args.out} is the deck that is read", common.MISTAKES)
    from pound_solve.results.whole_file import write_text

    write_text(args.out, old.text)
    return common.DONE


def _from(folder: Path, path: Path) -> str:
    """Path of a file relative to the folder of the deck, where there is one."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()
