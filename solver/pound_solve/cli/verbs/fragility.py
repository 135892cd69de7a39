"""``pound-solve fragility``: lognormal fragilities from the runs of a sweep or an incremental analysis."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common

if TYPE_CHECKING:
    from pound_solve.statistics.curves import Asked

SUMMARY = "fragilities with intervals of confidence from the runs of a sweep"
EXAMPLES = (("results/sweep.h5 --picture fragility.svg", "curves with intervals, drawn"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("sweep", help="results of a sweep or of ida (sweep.h5)")
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help="draw the curves")
    text = "quantity of the sweep that counts, or collapse (default: storey_drift)"
    parser.add_argument("--demand", default="storey_drift", metavar="NAME", help=text)
    parser.add_argument("--label", default="", help="the one of its labels that counts (default: largest)")
    parser.add_argument("--limit", default="", metavar="X,X,...", help="limits of the demand")
    parser.add_argument(
        "--method", default="", choices=("capacities", "stripes", "cloud"), help="default: what suits"
    )
    parser.add_argument("--confidence", type=common.share, default=0.95, metavar="P", help="default 0.95")
    parser.add_argument(
        "--at", default="", metavar="X,X,...", help="print the probabilities at these levels"
    )


def execute(args: argparse.Namespace) -> int:
    """Fit the fragilities and print them."""
    from pound_solve.report.plot import suites
    from pound_solve.report.sweep import fragility, summary
    from pound_solve.report.sweep.incremental import axes_of
    from pound_solve.results.sweep_file import Sweep
    from pound_solve.statistics.curves import Asked, CurveError
    from pound_solve.statistics.fragility_of_sweep import fit

    if not common.drawable(args.picture):
        return common.MISTAKES

    try:
        limits, at = (
            common.numbers(text.split(","), f"--{name} takes numbers", CurveError) if text else []
            for name, text in (("limit", args.limit), ("at", args.at))
        )
        if min((*limits, *at), default=1.0) <= 0.0:
            raise CurveError("limits and levels are above zero")
        sweep, asked = Sweep.open(Path(args.sweep)), Asked(args.demand, args.label)
        fitted = fit(sweep, asked, limits, args.method, args.confidence)
        lines = list(fragility.report(sweep, asked, fitted, at))
        written = summary.write(
            Path(args.sweep).with_name(_name(asked, limits)), sweep, "fragilities", lines
        )
    except CurveError as err:
        return common.complain(f"{args.sweep}: {err}", common.MISTAKES)
    print("\n".join([*lines, str(written)]))
    if args.picture:
        suites.fragilities(fragility.drawn(fitted), axes_of(sweep, asked)[1], args.picture)
    return common.DONE


def _name(asked: Asked, limits: Sequence[float]) -> str:
    """File name of the report, with demand and limits, so that it replaces no report on others."""
    words = ["fragility", asked.quantity, asked.label, *(f"{x:g}" for x in limits)]
    return "_".join(re.sub(r"[^\w.+-]+", "-", word) for word in words if word) + ".rpt"
