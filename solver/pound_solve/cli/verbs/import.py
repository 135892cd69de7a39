"""``pound-solve import``: translate a model of another program into a deck of this one."""

from __future__ import annotations

import argparse
import os
import sys
from functools import partial
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "make a deck of a model of OpenSees, SAP2000 or Ruaumoko-2D; comments say how it was read"
EXAMPLES = (
    ("old.dat -o model.inp", "translate a deck of Ruaumoko-2D"),
    ("frame.tcl --units kip,in,s -o model.inp", "translate a model of OpenSees"),
    ("frame.s2k --plane XZ@Y=0 --load DEAD -o model.inp", "translate a plane of a model of SAP2000"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "deck",
        type=Path,
        help="model of OpenSees (.tcl, .py) or SAP2000 (.s2k, .$2k), or deck of Ruaumoko-2D",
    )
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="new deck (default: standard output)"
    )
    parser.add_argument(
        "--record",
        action="append",
        default=[],
        type=Path,
        metavar="FILE",
        help="Ruaumoko: file of a record that does not follow in the deck; twice: the vertical one, too",
    )
    parser.add_argument(
        "--units",
        type=_units,
        default=(),
        metavar="F,L,T",
        help="OpenSees: units of force, length and time of the model, such as kip,in,s",
    )
    parser.add_argument(
        "--execute",
        dest="executed",  # `execute` is the verb's function
        action="store_true",
        help="OpenSees: execute a model in Python, which reads it",
    )
    parser.add_argument(
        "--plane",
        default="",
        metavar="PLANE",
        help="SAP2000: plane of a model in space, such as XZ, XZ@Y=3.5 or Y=3.5",
    )
    parser.add_argument(
        "--load",
        default="",
        metavar="CASE",
        help="SAP2000: static case, combination, or load patterns joined by commas",
    )


def execute(args: argparse.Namespace) -> int:
    """Write the new deck; print how the old one was read."""
    from pound_deck.diagnostics import has_errors, render
    from pound_deck.files import contents
    from pound_import.ruaumoko.equake import File
    from pound_solve.driver.importing import Choices, imported
    from pound_solve.driver.record_format import recognise

    folder = args.out.parent if args.out else Path()

    def shown(path: Path) -> str:
        """Path of a file relative to the folder of the new deck, where there is one."""
        try:
            return Path(os.path.relpath(path, folder)).as_posix()
        except ValueError:  # another drive
            return path.resolve().as_posix()

    records = [
        File(shown(path), contents(path).decode("latin-1"), partial(recognise, path))
        for path in args.record
    ]
    choices = Choices(records, shown, args.executed, args.units, args.plane, args.load)
    texts, old = imported(str(args.deck), choices)
    print(render(old.report, texts), file=sys.stderr)
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


def _units(text: str) -> tuple[str, ...]:
    """Names of three units."""
    names = tuple(text.split(","))
    if len(names) != 3 or not all(name.strip() == name != "" for name in names):
        raise argparse.ArgumentTypeError("three names joined by commas are needed, such as kN,m,s")
    return names
