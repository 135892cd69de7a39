"""One run from end to end: deck, analyses, results file, report."""

from __future__ import annotations

import time
from pathlib import Path

from pound_solve.driver.prepare import DeckError, Prepared, prepare
from pound_solve.driver.request import Request
from pound_solve.driver.sequence import AnalysisSequence, Progress
from pound_solve.results import Results, Writer
from pound_solve.version import __version__

__all__ = (
    "DONE",
    "MISTAKES",
    "STOPPED",
    "DeckError",
    "Prepared",
    "Progress",
    "Request",
    "execute",
    "prepare",
    "solve",
)

DONE, STOPPED, MISTAKES = 0, 1, 2  #: exit statuses; 3 (files) is the command line's own


def execute(request: Request, progress: Progress | None = None) -> tuple[int, Results, Prepared]:
    """Run a deck and write its results and report.

    Returns
    -------
    status : int
        `DONE`, or `STOPPED` when an analysis ended early (what was computed is kept).
    results : Results
        The results file, opened.
    prepared : Prepared
        The model and its warnings.

    Raises
    ------
    DeckError, OSError
        See `prepare`; or an output file cannot be written.
    """
    began = time.perf_counter()
    ready = prepare(request)
    if request.out is not None:
        request.out.mkdir(parents=True, exist_ok=True)
    status, results = solve(ready, request.path(".h5"), progress, began, request)
    from pound_solve.report.text import render

    request.path(".rpt").write_text(render(results), encoding="ascii", newline="\n")
    return status, results, ready


def solve(
    ready: Prepared, path: Path, progress: Progress | None, began: float, request: Request
) -> tuple[int, Results]:
    """Run the analyses of a prepared deck into a results file.

    Parameters
    ----------
    ready : Prepared
    path : Path
        The results file.
    progress : callable or None
    began : float
        Reading of `time.perf_counter` from which the total time counts.
    request : Request
        Tells which PARAMs do not come from the deck, and whether to explain.

    Returns
    -------
    status : int
        `DONE` or `STOPPED`.
    results : Results
        The file, opened.
    """
    model = ready.model
    with Writer(path, title=model.title, units=model.units, program_version=__version__) as writer:
        message = AnalysisSequence(ready, request, writer, progress, began).run()
        writer.finish("stopped" if message else "done", message)
    return (STOPPED if message else DONE), Results.open(path)
