"""``pound-solve ida``: incremental dynamic analysis, records scaled up until the structure collapses."""

from __future__ import annotations

import argparse

from pound_solve.cli import common, studies

SUMMARY = "scale the records of a study up until the structure collapses; capacities and fractiles"
EXAMPLES = (("study.toml -o results", "scale the records up until the structure collapses"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml) with [[motions]] and [ida]")
    studies.add_conduct(parser)
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help="draw curves and fractiles")


def execute(args: argparse.Namespace) -> int:
    """Read the study, run the rounds, write the table of all runs, print capacities and fractiles."""
    if not common.drawable(args.picture):
        return common.MISTAKES
    return studies.carried_out(args.study, lambda: _analysed(args))


def _analysed(args: argparse.Namespace) -> int:
    """Run the rounds, write the table and print the report."""
    from pound_solve.report.plot import suites
    from pound_solve.report.sweep import incremental
    from pound_solve.results.sweep_file import Sweep
    from pound_solve.sweep import ida
    from pound_solve.sweep.execution.executors import engine
    from pound_solve.sweep.execution.lock import locked
    from pound_solve.sweep.session import Session
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import read

    document = Document.read(args.study)
    studies.give_conduct(args, document)
    aim = ida.aim(document)
    study = read(document, (ida.TABLE,))
    with locked(study.out):
        session = Session(study, engine(args.executor, study.workers), retry=args.retry)
        progress = studies.StudyProgress(args)
        ida.IncrementalAnalysis(session, aim).carry_out(progress)
        progress.end()
        path = session.write(
            "incremental dynamic analysis", lambda sweep: incremental.report(sweep, aim.asked, aim.rules)
        )
        sweep = Sweep.open(path)
        if args.picture:
            cases = incremental.drawn(sweep, aim.asked, aim.rules)
            suites.incremental(cases, *incremental.axes_of(sweep, aim.asked), args.picture)
        if not args.quiet:
            print("\n".join(incremental.report(sweep, aim.asked, aim.rules)))
        return studies.ended(args, session, path)
