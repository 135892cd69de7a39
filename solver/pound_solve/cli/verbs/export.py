"""``pound-solve export``: write the tables and histories of a results file as CSV or for ParaView, or a
deck as a script for OpenSees.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common, terminal

if TYPE_CHECKING:
    from pound_solve.results import Results

SUMMARY = "write the tables and histories of a results file, or a deck for OpenSees"
EXAMPLES = (
    ("model.h5", "all tables and histories as CSV"),
    ("model.h5 --history node/u node=12 component=X", "one column of a history"),
    ("model.h5 --vtk", "for ParaView"),
    ("model.inp --opensees", "the deck as a script for OpenSeesPy"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5); with --opensees a deck")
    common.add_deck_options(parser)
    parser.add_argument(
        "-o",
        "--out",
        type=Path,
        metavar="DIR",
        help="folder (default: model for model.h5; with --vtk and --opensees that of the file)",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--history",
        nargs="+",
        action="append",
        metavar=("NAME", "KEY=VALUE"),
        help="write histories.csv instead: times and these columns, such as node/u node=12 component=X; "
        "may be repeated",
    )
    what.add_argument(
        "--vtk",
        action="store_true",
        help="write model.vtkhdf instead: the structure in motion, for ParaView",
    )
    what.add_argument(
        "--opensees",
        action="store_true",
        help="write model_opensees.py of a deck and the files of its motions; what OpenSees has no exact "
        "counterpart of is refused",
    )


def execute(args: argparse.Namespace) -> int:
    """Write the files and print their paths."""
    if args.opensees:
        return _opensees(args)
    if Path(args.results).suffix == ".inp":
        text = f"{args.results} is a deck: --opensees writes it for OpenSees"
        return common.complain(text, common.MISTAKES)
    for option in ("set", "records"):
        if getattr(args, option):
            return common.complain(f"--{option} belongs to --opensees", common.MISTAKES)
    from pound_solve.report.export import export_columns, export_csv
    from pound_solve.results import Results

    choices = [(name, _coordinates(items)) for name, *items in args.history or ()]
    with Results.open(args.results) as results:
        folder = args.out or results.path.with_suffix("")
        if args.vtk:
            paths = [_vtk(results, args.out or results.path.parent)]
        elif choices:
            paths = [export_columns(results, folder, choices)]
        else:
            paths = export_csv(results, folder)
        for path in paths:
            print(path)
    return common.DONE


def _opensees(args: argparse.Namespace) -> int:
    """Write a deck as a script for OpenSeesPy."""
    from pound_deck.diagnostics import render
    from pound_solve.driver.run import prepare
    from pound_solve.opensees.export import export

    args.deck = args.results
    request = common.request(args)
    ready = prepare(request)
    exported = export(ready, request.deck)
    if ready.warnings:
        terminal.tell(render(ready.warnings, ready.files))
    deck = Path(request.deck)
    for path in exported.write((args.out or deck.parent) / f"{deck.stem}_opensees.py"):
        print(path)
    return common.DONE


def _coordinates(items: Sequence[str]) -> dict[str, str]:
    """Parse coordinates of columns, given as KEY=VALUE."""
    coordinates = {}
    for item in items:
        key, equals, value = item.partition("=")
        if not equals or key in coordinates:
            what = f"{key} is given twice" if equals else f"{item} is no KEY=VALUE, such as node=12"
            text = f"--history: {what}; repeat --history for further columns"
            raise SystemExit(common.complain(text, common.MISTAKES))
        coordinates[key] = value
    return coordinates


def _vtk(results: Results, folder: Path) -> Path:
    """Write the VTKHDF file and name the nodes that it lacks."""
    from pound_solve.results.vtkhdf import write_vtkhdf

    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{results.path.stem}.vtkhdf"
    left_out = write_vtkhdf(results, path)
    if left_out:
        some = ", ".join(map(str, left_out[:5])) + (", ..." if len(left_out) > 5 else "")
        text = f"left out with their elements, because OUTPUT does not store them: nodes {some}"
        print(f"pound-solve: {text}", file=sys.stderr)
    return path
