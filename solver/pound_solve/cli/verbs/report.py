"""``pound-solve report``: print the report of a results file."""

from __future__ import annotations

import argparse
import sys

from pound_solve.cli import common

SUMMARY = "print the report of a results file"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5)")
    parser.add_argument("--brief", action="store_true", help="print the summary only")
    parser.add_argument("--full", action="store_true", help="print long tables in full")


def execute(args: argparse.Namespace) -> int:
    """Print the report."""
    from pound_solve.report.text import render
    from pound_solve.results import Results, ResultsError
    from pound_solve.results.contents import SECTIONS
    from pound_solve.results.place import digest_in

    try:
        with Results.open(args.results) as results:
            sys.stdout.write(
                render(results, limit=0 if args.full else None, only=SECTIONS[0][1] if args.brief else None)
            )
            beside = results.path.with_suffix(".rpt")
            if digest_in(beside) not in ("", results.digest):
                common.complain(f"warning: {beside} is the report of another run")
    except ResultsError as err:
        return common.complain(str(err))
    return common.DONE
