"""``pound-solve sensitivity``: derivatives of the quantities of a study with respect to its variables."""

from __future__ import annotations

import argparse

from pound_solve.cli import common, studies

SUMMARY = "derivatives of peaks with respect to PARAMs: masses, stiffnesses, gaps, strengths, records"
EXAMPLES = (("study.toml -o results", "how the peak force depends on the gap and the contact stiffness"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml) with [variables] and [sensitivity]")
    studies.add_conduct(parser)
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help="draw the elasticities")


def execute(args: argparse.Namespace) -> int:
    """Read the study, execute the runs, write the table of derivatives, print the report."""
    if not common.drawable(args.picture):
        return common.MISTAKES
    return studies.carried_out(args.study, lambda: _analysed(args))


def _analysed(args: argparse.Namespace) -> int:
    """Execute the runs, write the tables and print the report."""
    from pound_solve.report.plot import suites
    from pound_solve.report.sweep import sensitivity as report
    from pound_solve.report.sweep import summary
    from pound_solve.results.sweep_file import Sweep, write_table
    from pound_solve.sensitivity import study as sensitivity
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import read
    from pound_solve.sweep.study.variables import TABLE

    document = Document.read(args.study)
    studies.give_conduct(args, document)
    aim = sensitivity.aim(document)
    study = read(document, (TABLE, sensitivity.TABLE), check=sensitivity.check_steps)
    explore = sensitivity.SensitivityAnalysis(aim).carry_out
    with studies.explored(args, study, explore) as (session, path, result):
        if result is None:
            return studies.ended(args, session, path)
        sweep = Sweep.open(path)
        path = path.with_name("sensitivity.h5")
        lines = list(report.report(sweep, result))
        write_table(path, report.variables(sweep, result.lines), sweep.about)
        summary.write(path, sweep, "sensitivities", lines)
        if args.picture:
            suites.bars(report.drawn(sweep, result.lines), args.picture)
        if not args.quiet:
            print("\n".join(lines))
        return studies.ended(args, session, path)
