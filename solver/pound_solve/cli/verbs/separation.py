"""``pound-solve separation``: the separation that two buildings need, from one run or those of a sweep."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Final

from pound_solve.cli import common

if TYPE_CHECKING:
    from pound_solve.statistics.needed_gaps import Options

SUMMARY = "separation of the buildings by ABS, SRSS, DDC and codes; of a sweep: probability of contact"
EXAMPLES = (("model.h5", "gap that the buildings need, by several rules"),)
OF_SWEEPS: Final = ("gap", "raise", "confidence", "picture")  #: options for the results of sweeps


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5), or results of a sweep or of ida (sweep.h5)")
    parser.add_argument(
        "--periods", type=_two, default=(), metavar="T1,T2", help="of the buildings, in place of the modes'"
    )
    parser.add_argument(
        "--damping", type=_two, default=(), metavar="X1,X2", help="in percent, in place of the modes'"
    )
    group = parser.add_argument_group("of a sweep")
    group.add_argument("--gap", metavar="X,X,...", help="gaps at which probabilities are asked for")
    text = "factors of codes on elastic displacements: Cd/Ie, q (default 1,1)"
    group.add_argument("--raise", type=_two, metavar="A1,A2", help=text)
    group.add_argument("--confidence", type=common.share, metavar="P", help="default 0.95")
    group.add_argument("--picture", type=common.picture, metavar="FILE", help="draw the probabilities")


def _two(word: str) -> tuple[float, float]:
    """Parse two positive numbers of the magnitudes that a deck may have."""
    from pound_deck.schema import SMALL

    values = common.numbers(word.split(","), "write two numbers, as 0.2,0.3", argparse.ArgumentTypeError)
    if len(values) != 2:
        raise argparse.ArgumentTypeError(f"{word[:60]}: write two numbers, as 0.2,0.3")
    if min(values) <= 0.0:
        raise argparse.ArgumentTypeError(f"{word[:60]}: both must be above 0")
    if min(values) < SMALL:
        raise argparse.ArgumentTypeError(f"{word[:60]}: both must be at least {SMALL:g}")
    return values[0], values[1]


def execute(args: argparse.Namespace) -> int:
    """Print the separations."""
    from pound_solve.report import separation
    from pound_solve.results import Results
    from pound_solve.results.sweep_file import Sweep

    if Sweep.is_of(args.results):
        return _of_sweep(args)
    if option := next((name for name in OF_SWEEPS if getattr(args, name) is not None), ""):
        return common.complain(f"--{option} needs the runs of a sweep: sweep.h5", common.MISTAKES)
    with Results.open(args.results) as results:
        print(separation.text(results, args.periods, args.damping))
    return common.DONE


def _of_sweep(args: argparse.Namespace) -> int:
    """Print the probabilities, and write them beside the file of the sweep."""
    from pound_solve.report.plot import suites
    from pound_solve.report.sweep import separation, summary
    from pound_solve.results.sweep_file import Sweep, write_table
    from pound_solve.statistics.curves import CurveError, units_of
    from pound_solve.statistics.needed_gaps import groups

    if not common.drawable(args.picture):
        return common.MISTAKES
    path = Path(args.results).with_name("separation.h5")
    try:
        options = _options(args)
        sweep = Sweep.open(args.results)
        contacts = groups(sweep, options)
        lines = list(separation.report(sweep, contacts, options))
        write_table(path, separation.variables(sweep, contacts, options), sweep.about)
        written = summary.write(path, sweep, "separation of the buildings", lines)
    except CurveError as err:
        return common.complain(f"{args.results}: {err}", common.MISTAKES)
    print("\n".join(lines))
    print(f"{written}\n{path.with_suffix('.csv')}\n{path}")
    if args.picture:
        gap = f"gap [{units_of(sweep).length}]"
        suites.separations(separation.drawn(sweep, contacts, options), gap, args.picture)
    return common.DONE


def _options(args: argparse.Namespace) -> Options:
    """Options of the statistics from those of the command line.

    Raises
    ------
    CurveError
        An option is out of range.
    """
    from pound_solve.statistics.curves import CurveError
    from pound_solve.statistics.needed_gaps import Options
    from pound_solve.statistics.separation import correlation

    if bool(args.periods) != bool(args.damping):
        raise CurveError("--periods and --damping stand together: the correlation needs both")
    gaps = common.numbers(args.gap.split(","), "--gap takes numbers", CurveError) if args.gap else []
    if min(gaps, default=1.0) <= 0.0:
        raise CurveError("gaps are above zero")
    options = {"raised": getattr(args, "raise"), "level": args.confidence}
    if args.periods:
        options["correlation"] = correlation(*args.periods, *(xi / 100.0 for xi in args.damping))
    return Options(gaps, **{name: value for name, value in options.items() if value is not None})
