"""The stability matrix: every method on every stiff and extreme scene with every law.

Each case must give the right answer, or say clearly why not: a message with its number, place and cause, or
a self-check of the report that says "look".  Everything else is a fault: a wrong answer with good checks,
NaN, an exception, or no end.

Right is the closed form where there is one; else what EXACT finds on a search grid eight times finer; for
curved laws, which EXACT does not take, NEWMARK with steps so short that a quarter of them changes nothing.
The methods that take steps are allowed the share that the case names, EXACT and AUTO `EXACT_WITHIN` and
`AUTO_WITHIN`.
"""

from __future__ import annotations

import multiprocessing
import os
import re
import tempfile
import time
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Final, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from pound_solve import app
from pound_solve.catalog import catalog
from pound_solve.extremes import KICK, METHOD, STEP, Case, cases, one

Array = NDArray[np.float64]

EXACT_WITHIN, AUTO_WITHIN = 1e-6, 2e-3  #: errors allowed, as shares of the largest displacement
LIMIT: Final = 180.0  #: seconds until a case counts as endless
SETTLED: Final = 1e-3  #: share by which a reference by steps may still change when they are quartered
MOST_STEPS: Final = 1e6  #: of such a reference
ALONE: Final = "energy balances; nothing else to compare with"
FAMILIES: Final = ("linear", "contact", "hysteresis")
RIGHT, TOLD, STOPPED, FAULT = "right", "told", "stopped", "fault"  #: how a case may end
#: a stop names its number and time or stage; a refused deck its place
CLEAR: Final = re.compile(r"A5\d\d (at t = \S+ \S+: |static analysis: )\w.{20,}|A50[15] \w.{20,}")
REFUSED: Final = re.compile(r"\.inp:\d+:\d+: error [A-Z]\d{3}: ")


class Found(NamedTuple):
    """What a run gave: times and displacements; the stop's or refusal's message; checks that say "look";
    what is wrong with it; seconds.
    """

    t: Array
    u: Array
    stop: str
    looks: tuple[str, ...]
    wrong: str
    seconds: float


@dataclass(frozen=True)
class Row:
    """One case solved by one method.

    Attributes
    ----------
    case : Case
    method : str
    end : str
        `RIGHT`, `TOLD`, `STOPPED` or `FAULT`.
    error : float
        As a share of the largest displacement; NaN where nothing was compared.
    says : str
        The message, or what is wrong.
    seconds : float
    """

    case: Case
    method: str
    end: str
    error: float
    says: str
    seconds: float


def solve(deck: str, files: Mapping[str, str]) -> Found:
    """Run a deck in a folder of its own; nothing is raised."""
    began, nothing = time.perf_counter(), np.zeros(0)

    def found(t: Array = nothing, u: Array = nothing, **told: Any) -> Found:
        plain: dict[str, Any] = {"stop": "", "looks": (), "wrong": ""}
        return Found(t, u, **{**plain, **told}, seconds=time.perf_counter() - began)

    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        path = Path(folder) / "case.inp"
        for name, text in {**files, path.name: deck}.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        try:
            request = app.Request(str(path))  # no report is printed, which is half of a short run
            _, results = app.solve(app.prepare(request), request.path(".h5"), None, began, request)
        except app.DeckError as err:
            text = str(err)
            return found(stop=text) if REFUSED.search(text) else found(wrong=f"unclear refusal: {text}")
        except Exception as err:
            return found(wrong=f"{type(err).__name__}: {err}")
        with results:
            stop, t, u = results.message, nothing, nothing
            if "node/u" in results.histories:
                t, u = results.time.copy(), results.history("node/u")[:, :, 0].copy()
            looks = (
                [c for c in results.table("checks") if c["verdict"].startswith("look")]
                if "checks" in results.tables
                else []
            )
            bad = [name for name in results.histories if not np.isfinite(results.history(name)).all()]
        if bad:
            return found(t, u, wrong=f"numbers that are none in {', '.join(bad)}")
        if stop and not CLEAR.match(stop):
            return found(t, u, wrong=f"unclear stop: {stop}")
        return found(t, u, stop=stop, looks=tuple(f"{c['check']}: {c['value']}" for c in looks))


def serve(line: Connection) -> None:
    """Solve what comes along a line, in a process of its own; say when its kernels are compiled."""
    solve(one(KICK).replace(METHOD, "NEWMARK DT=0.1"), {})
    line.send(None)
    with suppress(EOFError):
        while True:
            line.send(solve(*line.recv()))


class Runner:
    """Runs decks in a process of its own, which may die or be ended; the same deck is run once."""

    def __init__(self, limit: float) -> None:
        self.limit, self.kept = limit, dict[str, Found]()
        self.worker: tuple[BaseProcess, Connection] | None = None

    def __call__(self, case: Case, deck: str, method: str) -> Found:
        """Run a deck with a method."""
        text = deck.replace(METHOD, method)
        if not self.limit:
            return solve(text, case.files)
        if text not in self.kept:
            self.kept[text] = self._apart(text, case.files)
        return self.kept[text]

    def _apart(self, text: str, files: Mapping[str, str]) -> Found:
        if self.worker is None:
            context = multiprocessing.get_context("spawn")
            here, there = context.Pipe()
            self.worker = context.Process(target=serve, args=(there,), daemon=True), here
            self.worker[0].start()
            there.close()  # so that the line ends with the process
            here.recv()
        process, line = self.worker
        line.send((text, files))
        wrong = f"no end within {self.limit:g} s"
        try:
            if line.poll(self.limit):
                return cast(Found, line.recv())
        except (EOFError, ConnectionError):
            process.join()
            wrong = f"the process died: exit code {process.exitcode}"
        self.close()
        return Found(np.zeros(0), np.zeros(0), "", (), wrong, self.limit)

    def close(self) -> None:
        """End the process."""
        if self.worker is not None:
            self.worker[1].close()
            self.worker[0].terminate()
            self.worker[0].join()
        self.worker = None


def methods() -> list[str]:
    """Names of the catalog's methods, those that need no step first."""
    return sorted(catalog().family("method"), key=lambda name: (name != "EXACT", name != "AUTO", name))


def written(method: str, step: float) -> str:
    """A method as the deck has it."""
    return f"{method} DT={step!r}" if catalog().family("method")[method].field("DT") else method


def reference(run: Runner, case: Case) -> tuple[Array, Array, float] | None:
    """Times, right displacements, and the share by which these may be off; None where nothing tells them.

    EXACT; where it cannot, NEWMARK with steps that are quartered until the motion stands still.
    """
    deck, factor = case.like[0] or case.deck, case.like[1]
    found = run(case, deck, "EXACT REFINE=3")
    if not (found.stop or found.wrong):
        return found.t, factor * found.u, 0.0
    step, before = min(case.step, STEP) / 16.0, np.zeros(0)
    while not len(found.t) or found.t[-1] / step < MOST_STEPS:
        found = run(case, deck, f"NEWMARK DT={step!r}")
        if found.stop or found.wrong:
            return None
        if (
            before.shape == found.u.shape
            and np.abs(found.u - before).max() <= SETTLED * np.abs(found.u).max()
        ):
            return found.t, factor * found.u, SETTLED
        step, before = step / 4.0, found.u
    return None


def judge(run: Runner, case: Case, method: str) -> Row:
    """Solve a case by a method and judge what comes."""
    found = run(case, case.deck, written(method, case.step))

    def row(end: str, says: str, error: float = np.nan) -> Row:
        return Row(case, method, end, error, says, found.seconds)

    if found.wrong:
        return row(FAULT, found.wrong)
    if found.stop:
        return row(STOPPED, found.stop)
    says = "; ".join(found.looks)
    doubt = 0.0
    if case.right is not None:
        right = case.right(found.t)
    else:
        told = reference(run, case)
        if told is None and case.like[0]:
            return row(FAULT, "the deck that tells the right answer does not run")
        if told is None or len(told[0]) != len(found.t):
            return row(TOLD if says else RIGHT, says or ALONE)
        right, doubt = case.compared(*told[:2]), told[2]
    size = float(np.abs(right).max(initial=0.0))
    off = float(np.abs(case.compared(found.t, found.u) - right).max(initial=0.0))
    error = off / size if size else off
    within = {"EXACT": EXACT_WITHIN, "AUTO": AUTO_WITHIN}.get(method, case.within) + doubt
    if error <= within:
        return row(RIGHT, says, error)
    return row(TOLD, says, error) if says else row(FAULT, f"error {error:.2g}, above {within:g}", error)


def matrix(
    families: tuple[str, ...] = FAMILIES,
    chosen: Callable[[Case], bool] = lambda case: True,
    progress: Callable[[Row], None] = lambda row: None,
    limit: float = LIMIT,
) -> Iterator[Row]:
    """Solve all cases by all methods.

    Parameters
    ----------
    families : tuple of str
        Of ``linear``, ``contact`` and ``hysteresis``.
    chosen : callable
        Which cases.
    progress : callable
        Told every row as it is there.
    limit : float
        Seconds that a run may take, in one of as many processes as there are cores; 0: in this process,
        without a limit.
    """
    count = (os.cpu_count() or 1) if limit else 1
    runners: SimpleQueue[Runner] = SimpleQueue()
    for _ in range(count):
        runners.put(Runner(limit))

    def solved(case: Case) -> list[Row]:
        run = runners.get()
        run.kept.clear()
        try:
            return [judge(run, case, method) for method in methods()]
        finally:
            runners.put(run)

    try:
        with ThreadPoolExecutor(count) as pool:
            for rows in pool.map(solved, filter(chosen, cases(families))):
                for row in rows:
                    progress(row)
                    yield row
    finally:
        for _ in range(count):
            runners.get().close()


ENDS: Final = (RIGHT, TOLD, STOPPED, FAULT)


def table(rows: Sequence[Row]) -> str:
    """Counts of how cases end, scene by method, as Markdown."""
    names = methods()
    by: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        by[row.case.family, row.case.scene].append(row)
    out = []
    for family in dict.fromkeys(f for f, _ in by):
        out += [f"| {family} | cases | " + " | ".join(names) + " |", "|---" * (len(names) + 2) + "|"]
        for (own, scene), cells in by.items():
            if own == family:
                ends = [Counter(r.end for r in cells if r.method == m) for m in names]
                texts = [" / ".join(str(e[x]) for x in ENDS) for e in ends]
                out.append(f"| {scene} | {len(cells) // len(names)} | " + " | ".join(texts) + " |")
        out.append("")
    total, alone = Counter(r.end for r in rows), sum(r.says == ALONE for r in rows)
    counts = ", ".join(f"{total[e]} {e}" for e in ENDS)
    n = len({id(r.case) for r in rows})
    told = f"{n} cases, {len(rows)} runs: {counts}. Of those right {alone} are known by their energy alone."
    return "\n".join([*out, told])


def stops(rows: Sequence[Row]) -> str:
    """The stops by kind, with their count and an example each; then all faults."""
    kinds: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        if row.end == STOPPED:
            text = re.sub(r"^.*?case.inp", "case.inp", row.says.split("\n")[0])
            kinds[re.sub(r"[-+\d.e]*\d[-+\d.e]*", "0", text)].append(text)
    found = sorted(kinds.values(), key=len, reverse=True)
    out = ["| stops | the first of them |", "|---|---|", *(f"| {len(x)} | {x[0]} |" for x in found)]
    faults = [r for r in rows if r.end == FAULT]
    for r in faults:
        out.append(f"- {r.case.scene}, {r.case.variant}, {r.case.law} by {r.method}: {r.says}")
    return "\n".join(out)


def page(rows: Sequence[Row]) -> str:
    """Both, for the terminal and the manual."""
    return f"Cells: {' / '.join(ENDS)}.\n\n{table(rows)}\n\n{stops(rows)}"
