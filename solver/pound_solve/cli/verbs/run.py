"""``pound-solve run``: run the analyses of a deck and write its results file and report."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common, terminal
from pound_solve.cli.progress import AnalysisProgress

if TYPE_CHECKING:
    from pound_solve.results import Results

SUMMARY = "run a deck (the verb may be left out)"
EXAMPLES = (
    ("model.inp", "writes model.rpt and model.h5"),
    ("model.inp --set gap=0.05 -o wide", "another PARAM, another folder"),
    ("model.inp --method NEWMARK --dt 0.001", "another method"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    common.add_deck(parser)
    common.add_method(parser)
    parser.add_argument(
        "-o", "--out", type=Path, metavar="DIR", help="folder of report and results (default: the deck's)"
    )
    parser.add_argument("--name", help="name of report and results (default: the deck's)")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    parser.add_argument(
        "--explain", action="store_true", help="list what the run imported, compiled, stored and left out"
    )


def execute(args: argparse.Namespace) -> int:
    """Run the deck; print warnings, failed checks and the paths of the files."""
    from pound_deck.diagnostics import render
    from pound_solve.driver import run
    from pound_solve.report.text import render as report

    request, progress = common.request(args), AnalysisProgress(args.quiet, args.interruption.check)
    try:
        status, results, ready = run.execute(request, progress)
    except Exception:
        args.interruption.check()  # a library caught the interrupt and failed later
        raise
    progress.end()
    if ready.warnings and not args.quiet:
        terminal.tell(render(ready.warnings, ready.files))
    with results:
        if not args.quiet:
            _warn_of_checks(results)
        if status != common.DONE:
            common.complain(f"stopped: {results.message}")
        if args.explain:
            print(report(results, only=("scene", "size", "arrays", "imports")))
        if not args.quiet:
            print(f"{results.path.with_suffix('.rpt')}\n{results.path}")
        if results.path != request.path(".h5"):
            common.complain(f"{request.path('.h5')} is that of an earlier run")
    return status


def _warn_of_checks(results: Results) -> None:
    """Print the checks whose verdict calls for a look at the results."""
    from pound_solve.check import looked

    for check in looked(results.checks):
        common.complain(f"warning: {check}")
