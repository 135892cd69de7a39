"""One run from end to end: deck, analyses, results file, report."""

from __future__ import annotations

import shutil
import tempfile
import time
import weakref
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Final

from pound_solve.driver.outputs import taken
from pound_solve.driver.prepare import DeckError, Prepared, prepare
from pound_solve.driver.request import Request
from pound_solve.driver.sequence import NO_ROOM, AnalysisSequence, Progress
from pound_solve.interruption import undisturbed
from pound_solve.results import Results, Writer
from pound_solve.results.place import put_in_place
from pound_solve.results.safe_file import NoRoomError
from pound_solve.results.whole_file import partial
from pound_solve.version import __version__

__all__ = (
    "DONE",
    "FILES",
    "MISTAKES",
    "STOPPED",
    "DeckError",
    "Prepared",
    "Progress",
    "Request",
    "execute",
    "in_temporary_folder",
    "prepare",
    "report_of",
    "solve",
    "structure_in_temporary_folder",
    "writer_of",
)

DONE, STOPPED, MISTAKES, FILES = range(4)  #: exit statuses
#: messages of runs that did not end normally: interrupted, refused, or stopped by a full disk
BROKEN_OFF: Final = ("A505", "A506", "A508")


def execute(request: Request, progress: Progress | None = None) -> tuple[int, Results, Prepared]:
    """Run a deck and write its results and report.

    Returns
    -------
    status : int
        `DONE`, or `STOPPED` if an analysis ended early (its results so far are kept), or `FILES` if the
        disk was full.
    results : Results
        The opened results file.  An interrupted run replaces no older results; its file is then named
        `partial`.
    prepared : Prepared
        The model and its warnings.

    Raises
    ------
    DeckError, OSError
        See `prepare`.
    ResultsError
        An output file cannot be written.
    """
    began = time.perf_counter()
    ready = prepare(request)
    if others := taken(request):
        raise DeckError(others, ready.files)
    path = request.path(".h5")
    path.parent.mkdir(parents=True, exist_ok=True)
    with writer_of(ready, partial(path)) as writer:
        message = analyse(ready, writer, progress, began, request)
        with suppress(KeyboardInterrupt), undisturbed():  # the analyses have ended
            path = put_in_place(path, report_of(partial(path)), whole=not message.startswith(BROKEN_OFF))
    status = FILES if message.startswith("A508") else STOPPED if message else DONE
    return status, Results.open(path), ready


def in_temporary_folder(request: Request) -> Results:
    """Run a deck in a folder that is removed with the results; see `execute`."""
    return _in_temporary_folder(lambda folder: execute(replace(request, out=folder))[1])


def structure_in_temporary_folder(request: Request) -> Results:
    """Store the tables of a deck's structure, without an analysis or a record, in a folder that is removed
    with the results; see `execute`.
    """
    ready = prepare(request, at_rest=True)

    def stored(folder: Path) -> Results:
        path = folder / request.path(".h5").name
        with writer_of(ready, path) as writer:
            AnalysisSequence(ready, request, writer, None, 0.0).store_input()
            writer.finish("done")
        return Results.open(path)

    return _in_temporary_folder(stored)


def _in_temporary_folder(make: Callable[[Path], Results]) -> Results:
    """Results that a function makes in a folder, which is removed with them."""
    folder = Path(tempfile.mkdtemp(prefix="pound-solve-"))
    try:
        results = make(folder)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    weakref.finalize(results, shutil.rmtree, folder, ignore_errors=True)
    return results


def writer_of(ready: Prepared, path: Path) -> Writer:
    """Return the writer of the results file of a prepared deck."""
    return Writer(path, title=ready.model.title, units=ready.model.units, program_version=__version__)


def analyse(
    ready: Prepared, writer: Writer, progress: Progress | None, began: float, request: Request
) -> str:
    """Run the analyses of a prepared deck and complete their results file.

    Parameters
    ----------
    ready : Prepared
    writer : Writer
        Closed at the end.
    progress : callable or None
    began : float
        Reading of `time.perf_counter` at the start of the total time.
    request : Request
        Gives the PARAMs that are not from the deck, and whether to explain.

    Returns
    -------
    str
        Number and text of the message on why the analyses stopped; empty if they did not.
    """
    message = AnalysisSequence(ready, request, writer, progress, began).run()
    with suppress(KeyboardInterrupt), undisturbed():  # the analyses have ended
        try:
            writer.finish("stopped" if message else "done", message)
        except NoRoomError:  # the reserved space is free from now on
            message = message or NO_ROOM
            writer.finish("stopped", message)
        writer.close()
    return message


def solve(
    ready: Prepared, path: Path, progress: Progress | None, began: float, request: Request
) -> Results:
    """Run the analyses of a prepared deck and write their file, no report; parameters as in `analyse`."""
    with writer_of(ready, path) as writer:
        analyse(ready, writer, progress, began, request)
    return Results.open(path)


def report_of(path: Path) -> str:
    """Return the report of a results file as text."""
    from pound_solve.report.text import render

    with Results.open(path) as results:
        return render(results)
