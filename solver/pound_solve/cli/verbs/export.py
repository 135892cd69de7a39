"""``pound-solve export``: write the tables and histories of a results file as CSV."""

from __future__ import annotations

import argparse
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "write the tables and histories of a results file as CSV"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5)")
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder (default: beside the file)")


def execute(args: argparse.Namespace) -> int:
    """Write the CSV files and print their paths."""
    from pound_solve.report.export import export_csv
    from pound_solve.results import Results, ResultsError

    folder = args.out or Path(args.results).with_suffix("")
    try:
        with Results.open(args.results) as results:
            for path in export_csv(results, folder):
                print(path)
    except ResultsError as err:
        return common.complain(str(err))
    return common.DONE
