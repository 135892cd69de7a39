"""``pound-solve optimize``: values of PARAMs that minimise a quantity or a cost under limits."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from pound_solve.cli import common, studies

if TYPE_CHECKING:
    from pound_solve.statistics.optimum import OptimumSearch
    from pound_solve.sweep.optimize import OptimumAnalysis
    from pound_solve.sweep.points import Points

SUMMARY = "find PARAMs of a study that minimise a quantity or a cost, with limits of others"
EXAMPLES = (("study.toml -o results", "minimise the objective under the limits of the study"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml) with [variables], [objective] and [constraint]")
    studies.add_conduct(parser)
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help="draw the search")


def execute(args: argparse.Namespace) -> int:
    """Read the study, search, write the tables and the deck of the optimum, print the report."""
    if not common.drawable(args.picture):
        return common.MISTAKES
    return studies.carried_out(args.study, lambda: _analysed(args))


def _analysed(args: argparse.Namespace) -> int:
    """Search, write the tables and print the report."""
    from pound_solve.report.plot import optimum
    from pound_solve.report.sweep import summary
    from pound_solve.report.sweep.optimum import OptimumReport
    from pound_solve.results.sweep_file import Sweep, write_table
    from pound_solve.results.whole_file import write_text
    from pound_solve.sweep import optimize
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import read

    document = Document.read(args.study)
    studies.give_conduct(args, document)
    aim = optimize.aim(document)
    study = read(document, optimize.TABLES)

    def explore(points: Points) -> tuple[OptimumAnalysis, OptimumSearch]:
        analysis = optimize.OptimumAnalysis(points, aim)
        analysis.deck(points.nominal)  # a file in its way is told before any run
        return analysis, analysis.carry_out()

    with studies.explored(args, study, explore) as (session, path, result):
        if result is None:
            return studies.ended(args, session, path)
        analysis, search = result
        sweep = Sweep.open(path)
        report = OptimumReport(sweep, analysis.problem, search, analysis.before)
        lines = list(report.report())
        path = study.out / "optimize.h5"
        write_table(path, report.table(), sweep.about)
        if report.is_solved and (deck := analysis.deck(report.values)):
            write_text(*deck)
            lines += ["", f"  Deck of the best point: {deck[0].name}"]
        summary.write(path, sweep, "optimum", lines)
        if args.picture:
            optimum.optimum(report.drawn(), args.picture)
        if not args.quiet:
            print("\n".join(lines))
        return studies.ended(args, session, path)
