"""``pound-solve uncertainty``: distributions of the results of a study with uncertain variables."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from pound_solve.cli import common, studies

if TYPE_CHECKING:
    from pound_solve.statistics.propagation import Propagated
    from pound_solve.sweep.points import Points

SUMMARY = "propagate uncertain PARAMs of a study: moments, fractiles, probabilities, Sobol indices"
EXAMPLES = (("study.toml -o results", "propagate the distributions under [variables]"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml) with [variables] and [uncertainty]")
    studies.add_conduct(parser)
    text = "draw tornados and distribution functions"
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help=text)


def execute(args: argparse.Namespace) -> int:
    """Read the study, run the sample, write the tables, print the statistics."""
    if not common.drawable(args.picture):
        return common.MISTAKES
    return studies.carried_out(args.study, lambda: _analysed(args))


def _analysed(args: argparse.Namespace) -> int:
    """Run the sample, write the tables and print the report."""
    from pound_solve.report.plot import uncertain
    from pound_solve.report.sweep import summary
    from pound_solve.report.sweep.uncertainty import Evaluation
    from pound_solve.results.sweep_file import Sweep, write_table
    from pound_solve.sweep import uncertainty
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import read

    document = Document.read(args.study)
    studies.give_conduct(args, document)
    aim = uncertainty.aim(document)
    study = read(document, uncertainty.TABLES)

    def explore(points: Points) -> Propagated:
        return uncertainty.UncertaintyAnalysis(points, aim).carry_out()

    with studies.explored(args, study, explore) as (session, path, runs):
        if runs is None:
            return studies.ended(args, session, path)
        sweep = Sweep.open(path)
        evaluation = Evaluation(sweep, {v.name: v.value for v in study.variables}, aim, runs)
        lines = list(evaluation.report())
        path = study.out / "uncertainty.h5"
        write_table(path, evaluation.table(), sweep.about)
        summary.write(path, sweep, "uncertainty", lines)
        if args.picture:
            uncertain.uncertainty(evaluation.drawn(), args.picture)
        if not args.quiet:
            print("\n".join(lines))
        return studies.ended(args, session, path)
