"""How the program takes a case: fine, told, stopped, or a fault."""

from __future__ import annotations

import io
import math
import re
import tempfile
import traceback
import warnings
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import numpy as np

from editor.everything import ask_everything, place_in
from fuzz.cases import Case
from pound_deck.diagnostics import render
from pound_solve.cli.main import main
from pound_solve.driver.run import DeckError, Request, prepare
from pound_solve.loading.records import formats
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import load
from pound_solve.results import Results, ResultsError
from pound_solve.sweep.execution import executors
from sweep.small import Here

FINE, TOLD, STOPPED = "fine", "told", "stopped"
ENDS = (FINE, TOLD, STOPPED)  #: all others are faults
#: where the program ends each exit status
BY_STATUS = {0: FINE, 1: STOPPED, 2: TOLD, 3: TOLD}


class Outcome(NamedTuple):
    """How a case ended, and what was said where that is of interest."""

    end: str
    said: str = ""

    @property
    def fault(self) -> bool:
        """Whether the program is at fault."""
        return self.end not in ENDS


class Fault(Exception):
    """A fault of the program: its sort and its words."""


def judge(case: Case, folder: Path) -> Outcome:
    """Give a case to the program, its files in a folder that is empty."""
    for name, data in case.files.items():
        (folder / name).write_bytes(data)
    try:
        return JUDGES[case.kind](case, folder)
    except Fault as fault:
        return Outcome(fault.args[0], fault.args[1])
    except MemoryError:
        return Outcome("memory", traceback.format_exc(limit=-4))
    except Warning:
        return Outcome("warning", traceback.format_exc(limit=-8))
    except Exception:
        return Outcome("traceback", traceback.format_exc(limit=-8))


def said(*words: str, allowed: Sequence[int] = (0, 2, 3)) -> tuple[int, str]:
    """Status and words of a command; raises `Fault` where no user should see them."""
    out = io.StringIO()
    with redirect_stdout(out), redirect_stderr(out), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            status = main(list(words))
        except SystemExit as end:  # the argument parser
            status = end.code if isinstance(end.code, int) else 1
    text = out.getvalue()
    if "Warning" in text and "fault of the program" in text:
        raise Fault("warning", text[-600:])
    if "fault of the program" in text or "Traceback" in text:
        raise Fault("fault of the program", text[-600:])
    if "not enough memory" in text:
        raise Fault("memory", text[-600:])
    if status not in allowed:
        raise Fault(f"status {status}", text[-600:])
    if status and not text.strip():
        raise Fault("silent", f"status {status} without a word")
    return status, text


def _deck(case: Case, folder: Path) -> Outcome:
    """The checks of a deck."""
    return Outcome(_checked(folder / "deck.inp"))


def _verbs(case: Case, folder: Path) -> Outcome:
    """`check`, which says what the checks say, and `format`, which changes nothing of it."""
    path = folder / "deck.inp"
    end = _checked(path)
    if BY_STATUS[said("check", str(path))[0]] != end:
        raise Fault("check", f"the verb does not say {end}")
    laid = folder / "laid.inp"
    if said("format", str(path), "-o", str(laid))[0] == 0:
        if _checked(laid) != end:
            raise Fault("layout", "check of the deck and of its layout differ")
        if said("format", "--check", str(laid), allowed=(0, 1))[0]:
            raise Fault("layout", "a layout of a layout differs")
    return Outcome(end)


def _checked(path: Path) -> str:
    """How the checks of a deck end; every message is rendered."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            ready = prepare(Request(str(path)))
        except DeckError as error:
            text, end = str(error), TOLD
        else:
            text, end = render(ready.warnings, ready.files), FINE
    if end == TOLD and not text.strip():
        raise Fault("silent", "mistakes without a word")
    return end


def _editor(case: Case, folder: Path) -> Outcome:
    """Help in an editor, which holds text."""
    path = folder / "deck.inp"
    try:
        text = case.files["deck.inp"].decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError:
        return Outcome(TOLD)
    if "\0" in text:
        return Outcome(TOLD)
    ask_everything(path, text, place_in(path, text, int(case.place * len(text))))
    return Outcome(FINE)


def _run(case: Case, folder: Path) -> Outcome:
    """A run whose results and report are whole."""
    return _ran(folder, "deck.inp")


def _ran(folder: Path, deck: str, *words: str) -> Outcome:
    """A run with options, whose results and report are whole, and in the folder."""
    status, text = said("run", str(folder / deck), "--quiet", *words, allowed=(0, 1, 2, 3))
    if status == 1 and not re.search(r"\bA5\d\d\b", text):
        raise Fault("stopped without a number", text[-600:])
    if status > 1:
        return Outcome(TOLD)
    (path,) = folder.glob("*.h5")
    with Results.open(path) as results:
        bad = [name for name in results.histories if not np.isfinite(results.history(name)).all()]
        if any(math.isnan(check.value) for check in results.checks):
            bad.append("checks")
        if "energy" in results.tables and not np.isfinite(results.table("energy")["value"]).all():
            bad.append("energy")  # a share of no input is a missing number, which is NaN
    if bad:
        raise Fault("NaN", f"status {status}, not finite: {', '.join(bad)}; {text[-300:]}")
    if not path.with_suffix(".rpt").is_file():
        raise Fault("no report", text[-300:])
    return Outcome(BY_STATUS[status], text[:200])


def _record(case: Case, folder: Path) -> Outcome:
    """The reader of a format, and every sixteenth time the whole way of a deck."""
    if case.number % 16 == 0:
        return Outcome(BY_STATUS[said("check", str(folder / "deck.inp"))[0]])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            text, _ = load(folder / "record.txt")
            raw = formats()[case.words[0]].impl.read(text, {})
    except RecordError as error:
        if len(error.message) > 900:
            raise Fault("long message", error.message[:300]) from None
        return Outcome(TOLD)
    t = raw.t
    if not (np.isfinite(raw.values).all() and np.isfinite(t).all() and (np.diff(t) > 0).all()):
        raise Fault("NaN", "samples or times are not in order")
    return Outcome(FINE)


def everything(path: Path) -> list[object]:
    """All that a reader can ask of a file, as comparable values."""
    with Results.open(path) as r:
        head = [(r.status, r.message, r.title, r.units)]
        texts = [(name, r.text(name)) for name in r.texts]
        tables = [(n, repr(r.table(n).tolist()), r.note(n), r.table_units(n)) for n in r.tables]
        histories = [(n, r.history(n).tobytes(), r.labels(n), r.history_units(n)) for n in r.histories]
        saved = [(name, values.tobytes()) for name, values in sorted(r.restart().items())]
        return [*head, *texts, *tables, *histories, *saved, r.identity()]


#: verbs that read results, and where their files go, in the folder of the case
READERS = (("report",), ("export", "-o", "tables"), ("plot", "-o", "pictures"), ("separation",))


def _results(case: Case, folder: Path) -> Outcome:
    """A reader, a verb that reads, and for every eighth case a run that takes the file up."""
    path = folder / "model.h5"
    # the numbers of the sample do not make a structure that could be drawn
    verbs = READERS[:2] if case.words[0] == "sample.h5" else READERS
    verb, *more = verbs[case.number % len(verbs)]
    worst, _ = said(verb, str(path), *more)
    if case.number % 8 == 0:
        allowed = (0, 1, 2, 3)
        said("run", str(folder / "deck.inp"), "-o", str(folder / "out"), "--quiet", allowed=allowed)
    try:
        found = everything(path)
    except ResultsError:
        return Outcome(TOLD)
    if of_one_digest(path, folder / "whole.h5") and found != as_written(case.files["whole.h5"]):
        raise Fault("silent", "what is read is not what was written")
    return Outcome(BY_STATUS[worst])


def of_one_digest(*paths: Path) -> bool:
    """Whether results files name the same digest."""
    digests = set()
    for path in paths:
        with Results.open(path) as results:
            digests.add(results.digest)
    return len(digests) == 1


@cache
def as_written(whole: bytes) -> list[object]:
    """All that stands in a whole file."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "whole.h5").write_bytes(whole)
        return everything(Path(folder) / "whole.h5")


def _words(case: Case, folder: Path) -> Outcome:
    return Outcome(BY_STATUS[said("list", "--", *case.words)[0]])


def _options(case: Case, folder: Path) -> Outcome:
    """A run with what a command line asks for."""
    return _ran(folder, "wall.inp", *case.words)


def _study(case: Case, folder: Path) -> Outcome:
    """A sweep or an incremental analysis in this process, and what reads its table."""
    own = Here()
    engine = mock.patch.object(executors, "engine", lambda *_: executors.Engine(lambda: own, 1, 1, 1, True))
    verb = case.words[0] if case.words[0] == "ida" else "sweep"
    more = ("--plan",) if case.words[0] == "plan" else ()
    with engine:
        status, text = said(verb, str(folder / "study.toml"), *more, allowed=(0, 1, 2, 3))
    for table in folder.rglob("*.csv"):
        if "fault of the program" in (rows := table.read_text("utf-8", "replace")):
            raise Fault("fault of the program", rows[-600:])
    if case.words[0] in ("fragility", "separation"):
        for table in folder.rglob("sweep.h5"):
            said(case.words[0], str(table))
    return Outcome(BY_STATUS[status], text[:200])


def _import(case: Case, folder: Path) -> Outcome:
    """A deck of another program; what is made of it has mistakes of the model and the record only."""
    old, new = folder / "legacy.dat", folder / "model.inp"
    status, text = said("import", str(old), "-o", str(new), allowed=(0, 2, 3))
    if case.number % 4 == 0:
        said("check", str(old))
    if new.is_file():
        try:
            prepare(Request(str(new)))
        except DeckError as error:
            if any(d.code.startswith(("P1", "P2")) for d in error.diagnostics):
                raise Fault("import", f"the deck that is made has other mistakes\n{error}") from None
    return Outcome(BY_STATUS[status], text[:200])


def _texts(case: Case, folder: Path) -> Outcome:
    """A run, and a verb that shows its texts; a page holds them as texts."""
    outcome = _ran(folder, "deck.inp")
    if outcome.end != FINE:
        return outcome
    verb, *names = case.words
    path, page = str(folder / "deck.h5"), folder / "page.html"
    status, text = {
        "report": partial(said, "report", path, "--html", str(page)),
        "export": partial(said, "export", path, "-o", str(folder / "tables")),
        "vtk": partial(said, "export", path, "--vtk"),
        "plot": partial(said, "plot", path, *names, "-o", str(folder / "pictures")),
    }[verb]()
    if page.is_file() and re.search(r"<script>alert|<img src=x", page.read_text("utf-8")):
        raise Fault("page", "a text of the deck is a part of the page")
    return Outcome(BY_STATUS[status], text[:200])


JUDGES = {
    "deck": _deck,
    "verbs": _verbs,
    "editor": _editor,
    "run": _run,
    "record": _record,
    "results": _results,
    "words": _words,
    "options": _options,
    "study": _study,
    "import": _import,
    "texts": _texts,
}
