"""Placement of results: beside older ones during the run, replacing them at its end.

A run writes ``model.partial.h5``.  When results file and report are complete, they are renamed to
``model.h5`` and ``model.rpt``; earlier files are kept until then.  A kill during renaming may leave results
without a report, which ``pound-solve report`` restores, but never with the report of other results.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from pound_deck.files import contents
from pound_solve.results.form import ResultsError
from pound_solve.results.whole_file import hold, make_way, partial

_DIGEST = re.compile(r"^ Results [0-9a-f]+$", re.MULTILINE)


def put_in_place(results: Path, report: str, whole: bool) -> Path:
    """Write the report of a run that has ended, and rename both files.

    Parameters
    ----------
    results : Path
        Name that the results file takes; it still has its name `partial`.
    report : str
    whole : bool
        Whether the run ended by itself; an interrupted one replaces no older results.

    Returns
    -------
    Path
        Path of the results file; the report is beside it.

    Raises
    ------
    ResultsError
        The report cannot be written, or another program holds one of the older files.
    """
    temporary, text = partial(results), results.with_suffix(".rpt")
    try:
        for path in (results, text):
            make_way(path, partial(path))
        _lay(partial(text), report)
        if not whole and (results.exists() or text.exists()):
            return temporary
        text.unlink(missing_ok=True)  # a kill between two renames would leave the report of other results
        for path in (results, text):
            os.replace(partial(path), path)
    except OSError as err:
        raise ResultsError(
            f"{err.filename or text}: {err.strerror}; the results of this run are in {temporary}"
        ) from err
    return results


def _lay(path: Path, report: str) -> None:
    """Write a report to a temporary file, which is removed where the disk has no room for it."""
    try:
        path.write_text(report, encoding="ascii", newline="\n")
        hold(path)
    except OSError:
        path.unlink(missing_ok=True)
        raise


def digest_in(report: Path) -> str:
    """Digest that a report gives of the results that it was made from; empty where it gives none."""
    match = _DIGEST.search(contents(report).decode("ascii", "replace")) if report.is_file() else None
    return match[0].split()[-1] if match else ""
