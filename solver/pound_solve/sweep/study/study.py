"""A study: decks with values of their PARAMs, under records of several strengths; all of its runs.

All mistakes are reported in one pass: those of its items, of its records, and of its decks with the first
values of their PARAMs.
"""

from __future__ import annotations

import csv
import itertools
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from pound_deck.diagnostics import Diagnostic, has_errors, render, suggest
from pound_deck.files import contents
from pound_deck.model import Model
from pound_solve.driver import loading
from pound_solve.driver.overrides import option
from pound_solve.driver.prepare import DeckError, prepare
from pound_solve.driver.reading import read as read_deck
from pound_solve.driver.request import Request
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import find, load
from pound_solve.sweep.study.document import Document, Path_
from pound_solve.sweep.study.records import Suite, scaled
from pound_solve.sweep.study.run import ParameterCase, Shaking, StudyRun, digest_of
from pound_solve.sweep.study.variables import TABLE, StudyVariable, study_variables
from pound_solve.user_error import UserError

MAX_RUNS: Final = 10**6  #: runs
ITEMS: Final = (
    "deck", "decks", "records", "out", "method", "dt", "tol", "workers", "seconds", "memory", "histories",
    "grid", "zip", "cases", "motions",
)  # fmt: skip

#: limits of a run, three years [s] and a petabyte [MB], and of the processes of a study
LARGEST: Final[Mapping[str, float]] = MappingProxyType({"seconds": 1e8, "memory": 1e9, "workers": 1e4})
#: tables read by other verbs; a study with variables may have those of several
OF_OTHERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "ida": "pound-solve ida",
        TABLE: "pound-solve sensitivity, optimize, calibrate or uncertainty",
        "sensitivity": "pound-solve sensitivity",
        "calibrate": "pound-solve calibrate",
        "measured": "pound-solve calibrate",
        "uncertainty": "pound-solve uncertainty",
        "correlation": "pound-solve uncertainty",
        "optimize": "pound-solve optimize",
        "objective": "pound-solve optimize",
        "constraint": "pound-solve optimize",
    }
)
#: items of a sweep that give PARAMs several values, which a study with variables does not take
SEVERAL: Final = ("decks", "grid", "zip", "cases")
NUDGE: Final = 1e-6  #: relative change of a variable by which a deck is searched for an effect

Params = tuple[tuple[str, str], ...]


class StudyError(UserError):
    """Raised if a study has mistakes; the text lists all of them."""

    has_places = True

    def __init__(self, diagnostics: Sequence[Diagnostic], files: Mapping[str, str]) -> None:
        super().__init__(render(diagnostics, files))
        self.diagnostics, self.files = tuple(diagnostics), dict(files)


@dataclass(frozen=True)
class Study:
    """A study: its runs, and the settings of their execution.

    Attributes
    ----------
    name : str
    out : Path
        Folder of its results.
    runs : tuple of StudyRun
    units : tuple of str
        Force, length and time of all its decks.
    measure : str
        Measure of `Shaking.level`: ``scale``, ``pga`` or ``sa``; empty if the motions of the decks act.
    workers : int
        Number of processes; 0 for one per processor.
    seconds, memory : float or None
        Limits of CPU time [s] and memory [MB] of one run.
    histories : tuple of str
        Histories kept of each run.
    warnings : str
        Warnings about the decks with the first values of their PARAMs.
    variables : tuple of StudyVariable
        Variables, at whose values the runs are; empty for a verb that has none.
    """

    name: str
    out: Path
    runs: tuple[StudyRun, ...]
    units: tuple[str, str, str]
    measure: str
    workers: int
    seconds: float | None
    memory: float | None
    histories: tuple[str, ...] = ()
    warnings: str = ""
    variables: tuple[StudyVariable, ...] = ()


def read(
    document: Document,
    tables: Sequence[str] = (),
    check: Callable[[Document, Sequence[StudyVariable]], None] = lambda document, variables: None,
) -> Study:
    """The study of a document.

    Parameters
    ----------
    document : Document
    tables : sequence of str
        Tables of it that the verb reads beside those of a sweep.
    check : callable
        Adds what is wrong with the variables for the verb to the document.

    Raises
    ------
    StudyError
        It has mistakes.
    """
    if any(d.code == "S601" for d in document.diagnostics):  # not TOML
        raise StudyError(document.diagnostics, document.files)
    return _Reader(document, tables, check).study()


class _Reader:
    """Reads one document."""

    def __init__(
        self,
        document: Document,
        tables: Sequence[str],
        check: Callable[[Document, Sequence[StudyVariable]], None],
    ) -> None:
        self.document, self.varies, self.check = document, TABLE in tables, check
        document.known((), (*ITEMS, *OF_OTHERS))
        for name, verb in OF_OTHERS.items():
            if name not in tables and not self.varies and document.at((name,)) is not None:
                message = f"[{name}] is a table of {verb}, not of this command"
                document.mistake("S602", message, (name,), f"run {verb}, or leave the table out")
        for name in SEVERAL if self.varies else ():
            if document.at((name,)) is not None:
                message = f"{name} gives several cases, and this command finds its own by the variables"
                document.mistake("S605", message, (name,), "take one deck, and PARAMs under [variables]")
        self.folders = tuple(self._beside(f) for f in document.listed(("records",), (str,)))
        self.motions = document.tables("motions")
        self.suites = [Suite(document, n, self.folders) for n in range(len(self.motions))]
        self.models = dict[str, Model]()
        self.histories = tuple(self._histories())
        self.warned: list[Diagnostic] = []

    def study(self) -> Study:
        """Read the whole study; raise StudyError if it has mistakes."""
        document = self.document
        decks, combinations = list(self._decks()), self._combinations()
        texts = {name: document.take((name,), str, "") for name in ("out", "method")}
        dt, tol = (self._number(name) for name in ("dt", "tol"))
        seconds, memory, workers = (self._number(*limits) for limits in LARGEST.items())
        measures = {s.measure for s in self.suites}
        if len(measures) > 1:
            message = (
                f"the tables [[motions]] give {' and '.join(sorted(measures))}: give all the same measure"
            )
            document.mistake("S605", message, ("motions",))
        base = ParameterCase("", (), self.folders, texts["method"] or None, dt, tol)
        self._names(decks, combinations)
        variables = tuple(self._variables())
        self.check(document, variables)
        if variables:
            combinations = [tuple((v.name, repr(v.value)) for v in variables if self._is_param(v.name))]
        for deck in decks:
            self._tried(replace(base, deck=deck), combinations)
        self._stop_at_mistakes()
        runs = tuple(self._runs(base, decks, combinations))
        self._stop_at_mistakes()
        units = next(iter(self.models.values())).units
        return Study(
            document.name,
            self._out(texts["out"]),
            runs,
            (units.force, units.length, units.time),
            "".join(measures),
            int(workers or 0),
            seconds,
            memory,
            self.histories,
            self._warnings(),
            variables,
        )

    def _variables(self) -> Iterator[StudyVariable]:
        """Variables of the one deck, if the verb has any."""
        if self.varies and self.models:
            yield from study_variables(self.document, next(iter(self.models.values())))

    def _is_param(self, name: str) -> bool:
        """Whether the decks have a PARAM of that name: a variable may also be `MOTION`."""
        return any(name.upper() in map(str.upper, model.params) for model in self.models.values())

    def _number(self, name: str, largest: float | None = None) -> float | None:
        """A number of the study, None where it is left out or wrong; DT and TOL have the deck's limits."""
        kind = int if name == "workers" else float
        value: float | None = self.document.take((name,), kind, None)
        if value is not None and largest is not None and not 0 < value <= largest:
            message = f"{name} is above zero and at most {largest:g}, not {value:g}"
            self.document.mistake("S603", message, (name,))
            return None
        return value

    def _stop_at_mistakes(self) -> None:
        """Raise StudyError if there are mistakes, in the order of the study."""
        mistakes = self.document.diagnostics
        order = {name: k for k, name in enumerate(self.document.files)}
        mistakes.sort(key=lambda d: (order.get(d.span.file, 0), d.span.line) if d.span else (-1, 0))
        if has_errors(mistakes):
            raise StudyError(mistakes, self.document.files)

    def _warnings(self) -> str:
        """Text of the warnings about the decks, with the lines that they concern."""
        return render(self.warned, self.document.files)

    def _beside(self, name: str) -> Path:
        """Absolute path of a file that the study names relative to its folder."""
        return (self.document.folder / os.path.expanduser(name)).absolute()

    def _out(self, folder: str) -> Path:
        """Folder of the results: the given one, else one named after the study's file."""
        return self._beside(folder or Path(self.document.name).stem + ".sweep")

    def _decks(self) -> Iterator[str]:
        """Yield the paths of all decks; a pattern yields all files that match it."""
        document = self.document
        named = [name for name in ("deck", "decks") if document.at((name,)) is not None]
        if len(named) != 1:
            message = "deck stands beside decks" if named else "the study names no deck"
            document.mistake("S604", message, (named[-1],) if named else (), 'write deck = "model.inp"')
        for item in named:
            for name in document.listed((item,), (str,)):
                paths = [self._beside(name)]
                if any(c in name for c in "*?["):
                    paths = document.matching(name)
                    if not paths:
                        document.mistake("S604", f"no deck fits {name}", (item,))
                for path in paths:
                    if path.is_file():
                        yield str(path)
                    else:
                        document.mistake("S604", f"there is no deck {path}", (item,))

    def _histories(self) -> Iterator[str]:
        """Names of the histories to keep."""
        from pound_solve.results.contents import HISTORIES

        for name in self.document.listed(("histories",), (str,)):
            if name in HISTORIES:
                yield name
            else:
                hint = suggest(name, HISTORIES) or f"there are {', '.join(HISTORIES)}"
                self.document.mistake("S602", f"there is no history {name}", ("histories",), hint)

    def _combinations(self) -> list[Params]:
        """PARAMs of every case: all combinations of the tables grid and zip and the file of cases."""
        document = self.document
        grid: list[list[Params]] = [
            [((n, v),) for v in self._values(("grid", n))] for n in self._table("grid")
        ]
        side = {n: self._values(("zip", n)) for n in self._table("zip")}
        lengths = {n: len(v) for n, v in side.items()}
        if len(set(lengths.values())) > 1:
            counts = ", ".join(f"{n} has {k}" for n, k in lengths.items())
            document.mistake("S605", f"lists under zip are of one length: {counts}", ("zip",))
        rows = self._cases()
        parts = [*grid]
        if side:
            parts.append([tuple(zip(side, values)) for values in zip(*side.values())])
        if rows is not None:
            parts.append(rows)
        return [tuple(itertools.chain(*choice)) for choice in itertools.product(*parts)]

    def _table(self, name: str) -> dict[str, Any]:
        """Table of the study by its name; empty where there is none."""
        return self.document.take((name,), dict, {})

    def _values(self, path: Path_) -> list[str]:
        """Values of one PARAM as texts."""
        return [v if isinstance(v, str) else repr(v) for v in self.document.listed(path, (str, int, float))]

    def _cases(self) -> list[Params] | None:
        """Rows of the file of cases: its first line names the PARAMs."""
        document, path = self.document, ("cases",)
        name = document.take(path, str, "")
        if not name:
            return None
        file = self._beside(name)
        try:
            text = contents(file).decode("utf-8-sig")
        except (OSError, UnicodeDecodeError) as err:
            document.mistake("S604", f"{name} cannot be read: {err}", path)
            return []
        lines = [row for row in csv.reader(text.splitlines()) if any(cell.strip() for cell in row)]
        if len(lines) < 2:
            document.mistake("S605", f"{name} has no cases below its line of names", path)
            return []
        names = [cell.strip() for cell in lines[0]]
        for number, row in enumerate(lines[1:], 2):
            if len(row) != len(names):
                message = f"{name}, case {number - 1}: {len(row)} values for {len(names)} names"
                document.mistake("S605", message, path)
        self.columns = names
        return [tuple(zip(names, (cell.strip() for cell in row))) for row in lines[1:]]

    def _sources(self) -> Iterator[tuple[str, Path_]]:
        """Yield the name of every PARAM with the path of the item that gives it values."""
        for table in ("grid", "zip"):
            for name in self._table(table):
                yield name, (table, name)
        for name in getattr(self, "columns", ()):
            yield name, ("cases",)
        for name in self._table(TABLE) if self.varies else ():
            yield name, (TABLE, name)

    def _names(self, decks: Sequence[str], combinations: Sequence[Params]) -> None:
        """Add a diagnostic for every PARAM that is given twice, and read the decks."""
        seen: dict[str, Path_] = {}
        for name, path in self._sources():
            if name.upper() in seen:
                message = f"{name} has values here and under {seen[name.upper()][0]}"
                self.document.mistake("S605", message, path)
            seen[name.upper()] = path
        if not combinations:
            return
        for deck in decks:
            read = read_deck(Request(deck, dict(combinations[0])))
            self._take_diagnostics(read.diagnostics, read.files)
            if read.model is not None:
                self.models[deck] = read.model

    def _take_diagnostics(self, diagnostics: Sequence[Diagnostic], files: Mapping[str, str]) -> None:
        """Add the mistakes of a deck to the study's; that of a value is placed at the item that sets it."""
        for d in map(self._here, diagnostics):
            if d.severity == "error" and d not in self.document.diagnostics:
                self.document.diagnostics.append(d)
        options = self._options()
        self.document.files.update({n: t for n, t in files.items() if n not in options})

    def _options(self) -> dict[str, Path_]:
        """Paths of the study's items by the equivalent options of a run (``--set NAME``, ...)."""
        values = {f"--set {name}": path for name, path in self._sources()}
        return {option(name).file: (name,) for name in ("method", "dt", "tol")} | values

    def _here(self, diagnostic: Diagnostic) -> Diagnostic:
        """Diagnostic of a deck, placed at the item of the study whose value it concerns, if any."""
        path = self._options().get(diagnostic.span.file) if diagnostic.span else None
        return replace(diagnostic, span=self.document.place(path)) if path else diagnostic

    def _tried(self, case: ParameterCase, combinations: Sequence[Params]) -> None:
        """Prepare the first run of a deck, and check that every PARAM has an effect."""
        if case.deck not in self.models:
            return
        first = next((r for s in self.suites for r in s.records), None)
        motion = scaled(Shaking(first, 1.0, 1.0)) if first else None
        if self.suites and not first:
            return  # the mistakes of its records are reported already
        try:
            ready = prepare(request_of(replace(case, params=combinations[0]), motion))
        except DeckError as err:
            self._take_diagnostics(err.diagnostics, err.files)
            return
        self.models[case.deck] = ready.model
        self.warned += map(self._here, ready.warnings)
        self.document.files.update(ready.files)
        here, there = ready.model.units, next(iter(self.models.values())).units
        if (here.force, here.length, here.time) != (there.force, there.length, there.time):
            message = f"{Path(case.deck).name} has other units than {Path(next(iter(self.models))).name}"
            self.document.mistake("S605", message, ("decks",))
        for name, path in self._sources():
            self._effective(name, path, case, combinations)

    def _effective(
        self, name: str, path: Path_, case: ParameterCase, combinations: Sequence[Params]
    ) -> None:
        """Add a diagnostic if a PARAM affects only the motion, which the study replaces."""
        first = dict(combinations[0])
        if name not in first:  # the factor on the records, or a variable with a mistake
            return
        values = [dict(c)[name] for c in combinations]
        if self.varies:
            values.append(repr(float(first[name]) * (1.0 + NUDGE) or NUDGE))
        other = next((value for value in values if value != first[name]), None)
        if other is None or not self.suites:
            return
        models = [read_deck(Request(case.deck, params)).model for params in (first, {**first, name: other})]
        if None not in models and len({_contents(m) for m in models if m is not None}) == 1:
            deck = Path(case.deck).name
            message = f"{name} changes nothing in {deck} but the motion, which [[motions]] replaces"
            self.document.mistake("S607", message, path, "leave it out, or leave out [[motions]]")

    def _runs(
        self, base: ParameterCase, decks: Sequence[str], combinations: Sequence[Params]
    ) -> Iterator[StudyRun]:
        """All runs; those of one case follow one another."""
        document = self.document
        first = next((r for s in self.suites for r in s.records), None)
        numbers, seen = itertools.count(1), dict[str, int]()
        for deck in decks:
            context = self._context(deck)
            shakings: list[Shaking | None] = [x for s in self.suites for x in s.shakings(context)]
            if len(decks) * len(combinations) * len(shakings or [None]) > MAX_RUNS:
                document.mistake("S605", f"the study has more than {MAX_RUNS} runs")
                return
            read = dict[Params, tuple[str, str]]()
            for params in combinations:
                texts = tuple((n, v) for n, v in params if not _is_number(v))
                if texts not in read:
                    sources, own_texts = self._inputs(replace(base, deck=deck, params=params))
                    read[texts] = digest_of(sources), own_texts
                inputs, own_texts = read[texts]
                case = replace(base, deck=deck, params=params, texts=own_texts)
                for shaking in shakings or [None]:
                    run = StudyRun(next(numbers), case, shaking, first, inputs)
                    other = seen.setdefault(run.identity, run.number)
                    if other != run.number:
                        document.mistake("S605", f"runs {other} and {run.number} are the same")
                        return
                    yield run

    def _context(self, deck: str) -> LoadingContext:
        return loading.context(self.models[deck], Request(deck))

    def _inputs(self, case: ParameterCase) -> tuple[dict[str, str], str]:
        """Inputs that the results of a deck depend on: texts of the deck and of included files, digests of
        other files that it reads, and the histories to keep; also return the digest of the texts alone.
        """
        deck = read_deck(request_of(case))
        model = deck.model
        if model is None:
            self._take_diagnostics(deck.diagnostics, deck.files)
            return {}, ""
        sources = dict(model.files) | ({"histories": " ".join(self.histories)} if self.histories else {})
        context = loading.context(model, request_of(case))
        for card in (*(() if self.suites else model.equake), *model.forces):
            if card.values.get("FILE"):
                try:
                    sources[str(card["FILE"])] = load(find(str(card["FILE"]), context.search_path))[1]
                except RecordError as err:
                    place = card.place("FILE")
                    self.document.diagnostics.append(Diagnostic(err.code, err.message, place, err.hint))
        for card in model.analyses:
            if card.values.get("RESTART"):
                with suppress(OSError):  # the preparation of the deck reports why
                    state = contents(Path(case.deck).parent / card["RESTART"])
                    sources["RESTART"] = sha256(state).hexdigest()
        return sources, digest_of(model.files)


def request_of(case: ParameterCase, motion: Any = None) -> Request:
    """Make the request for a run of a case."""
    return Request(
        case.deck,
        dict(case.params),
        records=case.records,
        method=case.method,
        dt=case.dt,
        tol=case.tol,
        motion=motion,
    )


def _contents(model: Model) -> str:
    """Text that identifies all of a model but its motion, its PARAMs and its files."""
    return repr(replace(model, params={}, equake=(), files={}))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
