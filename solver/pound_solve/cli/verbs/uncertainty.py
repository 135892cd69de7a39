"""``pound-solve uncertainty``: distributions of the results of a study with uncertain variables."""

from __future__ import annotations

import argparse

from pound_solve.cli import common, studies

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
    from pound_solve.sweep.execution.executors import engine
    from pound_solve.sweep.execution.lock import locked
    from pound_solve.sweep.points import Interrupted, Points
    from pound_solve.sweep.session import Session
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import read

    document = Document.read(args.study)
    studies.give_conduct(args, document)
    aim = uncertainty.aim(document)
    study = read(document, uncertainty.TABLES)
    with locked(study.out):
        session = Session(study, engine(args.executor, study.workers), retry=args.retry)
        progress = studies.StudyProgress(args)
        points = Points(session)
        try:
            runs = uncertainty.UncertaintyAnalysis(points, aim).carry_out(progress)
        except Interrupted:
            progress.end()
            return studies.ended(args, session, session.write())
        progress.end()
        sweep = Sweep.open(session.write())
        evaluation = Evaluation(sweep, {v.name: v.value for v in points.variables}, aim, runs)
        lines = list(evaluation.report())
        path = study.out / "uncertainty.h5"
        write_table(path, evaluation.table(), sweep.about)
        summary.write(path, sweep, "uncertainty", lines)
        if args.picture:
            uncertain.uncertainty(evaluation.drawn(), args.picture)
        if not args.quiet:
            print("\n".join(lines))
        return studies.ended(args, session, path)
