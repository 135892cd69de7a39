"""``pound-solve plot``: draw pictures of a results file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "draw pictures of a results file (needs matplotlib: the extra plot)"
#: those of `report.plot`, which is not imported for the help
PICTURES = (
    "frame", "modes", "deformed", "envelopes", "histories", "energy", "loops", "contacts", "collisions",
    "study",
)  # fmt: skip


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5)")
    parser.add_argument(
        "pictures", nargs="*", metavar="PICTURE", help=f"{', '.join(PICTURES)} (default: all)"
    )
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder (default: the file's)")
    parser.add_argument("--as", dest="ending", default="svg", choices=common.FORMATS, help="format")


def execute(args: argparse.Namespace) -> int:
    """Draw the pictures, print their paths and name those left out."""
    from pound_solve.report import plot
    from pound_solve.results import Results, ResultsError

    unknown = [name for name in args.pictures if name not in PICTURES]
    if unknown:
        text = f"there is no picture {unknown[0]}: choose from {', '.join(PICTURES)}"
        return common.complain(text, common.MISTAKES)
    try:
        with Results.open(args.results) as results:
            can = plot.possible(results)
            if not can:
                return common.complain(
                    f"{args.results} holds nothing that a picture shows", common.MISTAKES
                )
            if lacking := [name for name in args.pictures if name not in can]:
                needs = ", ".join(plot.PICTURES[lacking[0]][1])
                text = f"{args.results} lacks what the picture {lacking[0]} needs: {needs}"
                return common.complain(text, common.MISTAKES)
            folder = args.out or results.path.parent
            drawn, left_out = plot.draw(results, args.pictures or can, folder, args.ending)
    except ResultsError as err:
        return common.complain(str(err))
    except ImportError:
        return common.complain('pictures need matplotlib: pip install "pound-solve[plot]"', common.MISTAKES)
    for path in drawn:
        print(path)
    if left_out:
        reasons = "; ".join(f"{', '.join(names)} (no {what})" for what, names in left_out.items())
        print(f"pound-solve: left out, nothing to draw: {reasons}", file=sys.stderr)
    return common.DONE if drawn else common.MISTAKES
