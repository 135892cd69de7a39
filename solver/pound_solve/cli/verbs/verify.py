"""``pound-solve verify``: compare the peaks of a deck with those of OpenSees."""

from __future__ import annotations

import argparse

from pound_solve.cli import common, terminal
from pound_solve.cli.progress import StatusLine

SUMMARY = "compare the peaks of a deck with those of OpenSees at three halved steps"
EXAMPLES = (
    ("model.inp --python opensees/bin/python", "with OpenSeesPy of that environment"),
    ("model.inp --python opensees/bin/python --step 1E-4", "from another coarsest step"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    common.add_deck(parser)
    common.add_method(parser)
    parser.add_argument(
        "--python", default="python3", metavar="PATH", help="interpreter with openseespy (default python3)"
    )
    text = "coarsest time step of OpenSees (default: by the contacts and the record)"
    parser.add_argument("--step", type=common.finite, metavar="DT", help=text)


def execute(args: argparse.Namespace) -> int:
    """Run both programs and print the comparison; the status is 1 where a peak lies off its limit, or
    is undecided.
    """
    from pound_deck.diagnostics import render
    from pound_solve.opensees.page import page
    from pound_solve.opensees.verify import AGREES, verify

    if args.step is not None and args.step <= 0.0:
        return common.complain("--step must be above zero", common.MISTAKES)
    request, line = common.request(args), StatusLine()
    try:
        comparison, warnings, files = verify(request, args.python, args.step, line.show)
    finally:
        line.clear()
    if warnings:
        terminal.tell(render(warnings, files))
    print(page(comparison))
    return common.DONE if all(x.outcome == AGREES for x in comparison.rows) else common.STOPPED
