"""Functions shared by verbs that execute studies: arguments, mistakes, progress line, output."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from pound_solve.cli import common
from pound_solve.cli.progress import StatusLine

_T = TypeVar("_T")

if TYPE_CHECKING:
    from pound_solve.sweep.execution.conduct import State
    from pound_solve.sweep.points import Points
    from pound_solve.sweep.session import Session
    from pound_solve.sweep.study.document import Document
    from pound_solve.sweep.study.study import Study


def add_conduct(parser: argparse.ArgumentParser) -> None:
    """Add the options for the execution of runs."""
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder of the results")
    parser.add_argument("--workers", type=int, metavar="N", help="processes (default: one a processor)")
    parser.add_argument("--retry", action="store_true", help="try runs again that stopped or failed")
    parser.add_argument("--executor", default="", metavar="WHERE", help="dask://HOST:PORT, or dask")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def give_conduct(args: argparse.Namespace, document: Document) -> None:
    """Replace items of the study by the options of the command line."""
    if args.out:
        document.set_item(("out",), str(args.out.absolute()), "--out", str(args.out))
    if args.workers is not None:
        document.set_item(("workers",), args.workers, "--workers", str(args.workers))


def carried_out(study: str, work: Callable[[], int]) -> int:
    """Call `work`; print the mistakes of the study or the reason of a failure; return the exit status."""
    from pound_solve.statistics.curves import CurveError
    from pound_solve.sweep.execution.executors import ExecutorError

    try:
        return work()
    except argparse.ArgumentTypeError as err:
        return common.complain(str(err), common.MISTAKES)
    except (CurveError, ExecutorError) as err:
        return common.complain(f"{study}: {err}", common.MISTAKES)


class StudyProgress:
    """Line that shows the progress of a study; a call may raise KeyboardInterrupt."""

    def __init__(self, args: argparse.Namespace) -> None:
        self.line, self.interruption = StatusLine(args.quiet), args.interruption

    def __call__(self, state: State) -> None:
        """Show the state."""
        self.line.show(state.text)
        self.interruption.check()

    def end(self) -> None:
        """Clear the line."""
        self.line.clear()


@contextmanager
def explored(
    args: argparse.Namespace, study: Study, explore: Callable[[Points], _T]
) -> Iterator[tuple[Session, Path, _T | None]]:
    """Call `explore` with the points of a study under the lock of its folder; write the table of all runs.

    Yields once, still locked: the session, the path of the table, and the result; None after Ctrl-C.
    """
    from pound_solve.sweep.execution.executors import engine
    from pound_solve.sweep.execution.lock import locked
    from pound_solve.sweep.points import Interrupted, Points
    from pound_solve.sweep.session import Session

    if study.warnings and not args.quiet:
        print(study.warnings, file=sys.stderr)
    with locked(study.out):
        session = Session(study, engine(args.executor, study.workers), retry=args.retry)
        points, progress, result = Points(session), StudyProgress(args), None
        try:
            with points.conducted(progress):
                result = explore(points)
        except Interrupted:
            pass  # the table has the runs so far
        finally:
            progress.end()
        yield session, session.write(), result


def ended(args: argparse.Namespace, session: Session, path: Path | None) -> int:
    """Print the number of runs by status and the paths of the results; return the exit status."""
    if not args.quiet:
        print("\n".join(session.summary()))
        if path is not None:
            print("\n".join(str(path.with_suffix(ending)) for ending in (".rpt", ".csv", ".h5")))
    return common.DONE if session.whole else common.STOPPED
