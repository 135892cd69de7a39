"""``pound-solve calibrate``: fit PARAMs to measured peaks and histories, with intervals."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from pound_solve.cli import common, studies

if TYPE_CHECKING:
    from pound_solve.statistics.calibration import Calibration
    from pound_solve.sweep.points import Points

SUMMARY = "fit PARAMs to the peaks and histories of a test; intervals of the fitted values"
EXAMPLES = (("study.toml -o results", "contact stiffness and restitution from a measured history"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml) with [variables], [[measured]] and [calibrate]")
    studies.add_conduct(parser)
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help="draw measured and fitted")


def execute(args: argparse.Namespace) -> int:
    """Read the study, search the fit, write its tables, print the report."""
    if not common.drawable(args.picture):
        return common.MISTAKES
    return studies.carried_out(args.study, lambda: _calibrated(args))


def _calibrated(args: argparse.Namespace) -> int:
    """Search the fit, write the tables and print the report."""
    from pound_solve.report.plot import suites
    from pound_solve.report.sweep import calibration as report
    from pound_solve.report.sweep import summary
    from pound_solve.results.sweep_file import Sweep, write_table
    from pound_solve.sweep import calibrate
    from pound_solve.sweep.study import measured
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import read
    from pound_solve.sweep.study.variables import TABLE

    document = Document.read(args.study)
    studies.give_conduct(args, document)
    aim = calibrate.aim(document)
    tables = (TABLE, measured.TABLE, calibrate.TABLE)
    study = read(document, tables)

    def explore(points: Points) -> Calibration:
        return calibrate.CalibrationAnalysis(points, aim).carry_out()

    with studies.explored(args, study, explore) as (session, path, result):
        if result is None:
            return studies.ended(args, session, path)
        sweep = Sweep.open(path)
        path = path.with_name("calibrate.h5")
        lines = list(report.report(sweep, result, str(document.at(("deck",)))))
        write_table(path, report.columns(result), report.about(sweep, result))
        summary.write(path, sweep, "calibration", lines)
        if args.picture:
            suites.fits(report.drawn(sweep, result), args.picture)
        if not args.quiet:
            print("\n".join(lines))
        return studies.ended(args, session, path)
