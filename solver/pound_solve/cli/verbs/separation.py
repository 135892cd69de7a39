"""``pound-solve separation``: the separation that two buildings need, from the peaks of their analyses."""

from __future__ import annotations

import argparse
import math

from pound_solve.cli import common

SUMMARY = "separation of the buildings by ABS, SRSS and DDC from the peaks of a results file"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5)")
    parser.add_argument(
        "--periods",
        type=_two,
        default=(),
        metavar="T1,T2",
        help="of the buildings, in place of the modes'",
    )
    parser.add_argument(
        "--damping", type=_two, default=(), metavar="X1,X2", help="in percent, in place of the modes'"
    )


def _two(word: str) -> tuple[float, float]:
    """Two positive numbers of an option."""
    try:
        first, second = (float(x) for x in word.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word[:60]}: write two numbers, as 0.2,0.3") from None
    if not (0.0 < first < math.inf and 0.0 < second < math.inf):
        raise argparse.ArgumentTypeError(f"{word[:60]}: both must be above 0")
    return first, second


def execute(args: argparse.Namespace) -> int:
    """Print the separations."""
    from pound_solve.report import separation
    from pound_solve.results import Results, ResultsError

    try:
        with Results.open(args.results) as results:
            print(separation.text(results, args.periods, args.damping))
    except (ResultsError, separation.SeparationError) as err:
        return common.complain(str(err))
    return common.DONE
