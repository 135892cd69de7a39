"""``pound-solve ida``: incremental dynamic analysis, records scaled up until the structure collapses."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common
from pound_solve.cli.progress import StatusLine

if TYPE_CHECKING:
    from pound_solve.sweep.conduct import State
    from pound_solve.sweep.hunt import Aim
    from pound_solve.sweep.session import Session

SUMMARY = "scale the records of a study up until the structure collapses; capacities and fractiles"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml) with [[motions]] and [ida]")
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder of the results")
    parser.add_argument("--workers", type=int, metavar="N", help="processes (default: one a processor)")
    parser.add_argument("--retry", action="store_true", help="try runs again that stopped or failed")
    parser.add_argument("--executor", default="", metavar="WHERE", help="dask://HOST:PORT, or dask")
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help="draw curves and fractiles")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def execute(args: argparse.Namespace) -> int:
    """Read the study, run the rounds, write the table of all runs, print capacities and fractiles."""
    from pound_solve.results import ResultsError
    from pound_solve.sweep import hunt
    from pound_solve.sweep.curves import CurveError
    from pound_solve.sweep.document import Document
    from pound_solve.sweep.executors import ExecutorError, engine
    from pound_solve.sweep.lock import BusyError, locked
    from pound_solve.sweep.session import Session
    from pound_solve.sweep.study import StudyError, read

    if not common.drawable(args.picture):
        return common.MISTAKES
    document = Document.read(args.study)
    if args.out:
        document.given(("out",), str(args.out.absolute()), "--out", str(args.out))
    if args.workers is not None:
        document.given(("workers",), args.workers, "--workers", str(args.workers))
    try:
        aim = hunt.aim(document)
        study = read(document, (hunt.TABLE,))
        with locked(study.out):
            session = Session(study, engine(args.executor, study.workers), retry=args.retry)
            return _hunted(args, session, aim)
    except StudyError as err:
        print(err, file=sys.stderr)
        return common.MISTAKES
    except (CurveError, ExecutorError) as err:
        return common.complain(f"{args.study}: {err}", common.MISTAKES)
    except (BusyError, ResultsError) as err:
        return common.complain(str(err))


def _hunted(args: argparse.Namespace, session: Session, aim: Aim) -> int:
    """Run the rounds and tell what was found."""
    from pound_solve.report.plot import suites
    from pound_solve.results.sweep_file import Sweep
    from pound_solve.sweep import fractiles
    from pound_solve.sweep.hunt import Hunt

    line = StatusLine(args.quiet)

    def report(state: State) -> None:
        line.show(state.text)
        args.interruption.check()

    Hunt(session, aim).carry_out(report)
    line.clear()
    path = session.write()
    sweep = Sweep.open(path)
    if args.picture:
        cases = fractiles.drawn(sweep, aim.asked, aim.rules)
        suites.incremental(cases, *fractiles.axes_of(sweep, aim.asked), args.picture)
    if not args.quiet:
        print("\n".join(fractiles.report(sweep, aim.asked, aim.rules)))
        print("\n".join(session.summary()))
        print(f"{path.with_suffix('.csv')}\n{path}")
    return common.DONE if session.whole else common.STOPPED
