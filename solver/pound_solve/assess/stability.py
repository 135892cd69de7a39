"""The stability matrix: every method on every stiff and extreme scene with every law.

Each case must give the right answer, or say clearly why not: a message with its number, place and cause, or
a self-check of the report that says "look".  Everything else is a fault: a wrong answer with good checks,
NaN, an exception, or no end.

Right is the closed form where there is one; else what EXACT finds on a search grid eight times finer; for
curved laws, which EXACT does not take, NEWMARK with steps so short that a quarter of them changes nothing.
Displacements and the springs' forces are compared at all times of output, of contacts the largest force
(one that a dashpot makes jump has no value at the instant of touch).  The methods that take steps are
allowed the share that the case names, EXACT and TAYLOR `EXACT_WITHIN`.  AUTO is judged by what it
promises: its peaks by `AUTO_WITHIN`, its histories as those of steps.

Some answers hang on the last digits of the deck: two motions of a chaotic scene part from each other,
however close they begin, and a contact that just touches may as well just not.  Where something is off, the
reference is therefore run again with all masses changed by a `NUDGE` of the error allowed.  What that alone
changes by more than is allowed (a motion from some time on, a largest force) is unknown: not judged.
"""

from __future__ import annotations

import math
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
from typing import Any, Final, NamedTuple

import numpy as np

from pound_solve.analyses.history import RESIDUAL
from pound_solve.assess.scenes import cases
from pound_solve.assess.scenes.case import METHOD, STEP, Case, every
from pound_solve.assess.scenes.linear import KICK, one
from pound_solve.catalog import catalog
from pound_solve.driver import run
from pound_solve.numerics.types import Array
from pound_solve.results import Results

STEPLESS: Final = ("EXACT", "TAYLOR")  #: methods without an error but rounding
EXACT_WITHIN, AUTO_WITHIN = 1e-6, 2e-3  #: errors allowed, as shares of the largest value
FASTER: Final = 1.5  #: forces carry more of fast modes than displacements: their share of an error allowed
NUDGE: Final = 1e-6  #: share of the error allowed by which masses are changed
LIMIT: Final = 180.0  #: seconds until a case counts as endless
SETTLED: Final = 1e-3  #: share by which a reference by steps may still change when they are quartered
MOST_STEPS: Final = 1e6  #: of such a reference
ALONE: Final = "energy balances; nothing else to compare with"
PARTLY: Final = "compared as far as the answer is known"
FAMILIES: Final = ("linear", "contact", "hysteresis")
RIGHT, TOLD, STOPPED, FAULT = "right", "told", "stopped", "fault"  #: how a case may end
MEANS: Final = {
    RIGHT: "as the reference",
    TOLD: "off, and a check of the report says so",
    STOPPED: "refused or stopped in words",
    FAULT: "all else, such as a wrong answer that no check tells",
}
#: a stop names its number and time or stage; a refused deck its place
CLEAR: Final = re.compile(r"A5\d\d (at t = \S+ \S+: |static analysis: )\w.{20,}|A50[15] \w.{20,}")
REFUSED: Final = re.compile(r"\.inp:\d+:\d+: error [A-Z]\d{3}: ")
REFUSED_AT: Final = re.compile(r"^.*?\.inp:\d+:\d+: error ")  #: in a file that is gone


class Found(NamedTuple):
    """What a run gave: times, displacements, forces of springs; the springs' largest deformations both
    ways, shape (n_springs, 2), the contacts' largest forces; the stop's or refusal's message; checks that
    say "look"; what is wrong with it; seconds.
    """

    t: Array
    u: Array
    f: Array
    swings: Array
    blows: Array
    stop: str
    looks: tuple[str, ...]
    wrong: str
    seconds: float


NOTHING: Final = Found(
    np.zeros(0), np.zeros(0), np.zeros((0, 0)), np.zeros((0, 2)), np.zeros(0), "", (), "", 0.0
)


@dataclass(frozen=True)
class JudgedRun:
    """One case solved by one method.

    Attributes
    ----------
    case : Case
    method : str
    end : str
        `RIGHT`, `TOLD`, `STOPPED` or `FAULT`.
    error : float
        The largest of displacements, as a share of the largest; NaN where nothing was compared.
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


def motion(results: Results) -> dict[str, Array]:
    """What is compared of a run, as `Found` has it."""
    tables = {x: results.table(x) for x in ("spring_envelope", "contact_summary") if x in results.tables}
    out = {}
    if "node/u" in results.histories:
        out = {"t": results.time.copy(), "u": results.history("node/u")[:, :, 0].copy()}
        out["f"] = np.zeros((len(out["t"]), 0))
    if "spring/force" in results.histories:
        out["f"] = results.history("spring/force").copy()
    if "spring_envelope" in tables:
        springs = tables["spring_envelope"]
        out["swings"] = np.column_stack([springs["deformation_max"], springs["deformation_min"]])
    if "contact_summary" in tables:
        out["blows"] = tables["contact_summary"]["peak_force"].copy()
    return out


def solve(deck: str, files: Mapping[str, str]) -> Found:
    """Run a deck in a folder of its own; nothing is raised."""
    began = time.perf_counter()

    def found(**told: Any) -> Found:
        return Found(**{**NOTHING._asdict(), **told, "seconds": time.perf_counter() - began})

    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        path = Path(folder) / "case.inp"
        for name, text in {**files, path.name: deck}.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        try:
            request = run.Request(str(path))  # no report is printed, which is half of a short run
            _, results = run.solve(run.prepare(request), request.path(".h5"), None, began, request)
        except run.DeckError as err:
            text = str(err)
            return found(stop=text) if REFUSED.search(text) else found(wrong=f"unclear refusal: {text}")
        except Exception as err:
            return found(wrong=f"{type(err).__name__}: {err}")
        with results:
            stop, moved = results.message, motion(results)
            looks = (
                [c for c in results.table("checks") if c["verdict"].startswith("look")]
                if "checks" in results.tables
                else []
            )
            bad = [name for name in results.histories if not np.isfinite(results.history(name)).all()]
        if bad:
            return found(**moved, wrong=f"numbers that are none in {', '.join(bad)}")
        if stop and not CLEAR.match(stop):
            return found(**moved, wrong=f"unclear stop: {stop}")
        return found(**moved, stop=stop, looks=tuple(f"{c['check']}: {c['value']}" for c in looks))


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
                found: Found = line.recv()
                return found
        except (EOFError, ConnectionError):
            process.join()
            wrong = f"the process died: exit code {process.exitcode}"
        self.close()
        return NOTHING._replace(wrong=wrong, seconds=self.limit)

    def close(self) -> None:
        """End the process."""
        if self.worker is not None:
            self.worker[1].close()
            self.worker[0].terminate()
            self.worker[0].join()
        self.worker = None


def methods() -> list[str]:
    """Names of the catalog's methods, those that need no step first."""
    return sorted(catalog().family("method"), key=lambda name: (name not in STEPLESS, name != "AUTO", name))


def written(method: str, step: float) -> str:
    """A method as the deck has it."""
    return f"{method} DT={step!r}" if catalog().family("method")[method].field("DT") else method


def reference(run: Runner, case: Case) -> tuple[Found, str, float] | None:
    """The right motion, the method that found it, and the share by which it may be off; None where nothing
    tells it.

    EXACT; where it cannot, or loses energy, NEWMARK with steps that are quartered until the motion stands
    still.
    """

    def holds(found: Found) -> bool:
        return not any(x.startswith(RESIDUAL) for x in found.looks)

    deck = case.like[0] or case.deck
    found = run(case, deck, method := "EXACT REFINE=3")
    if not (found.stop or found.wrong) and holds(found):
        return found, method, 0.0
    step, before = min(case.step, STEP) / 16.0, NOTHING
    while not len(found.t) or found.t[-1] / step < MOST_STEPS:
        found = run(case, deck, method := f"NEWMARK DT={step!r}")
        if found.stop or found.wrong:
            return None
        if len(before.t) and holds(found):
            changes = [shares(found.u, before.u), shares(found.f, before.f)]
            changes += [off for off, _ in promised(found, before, SETTLED).values()]
            if max(x.max(initial=0.0) for x in changes) <= SETTLED:
                return found, method, SETTLED
        step, before = step / 4.0, found
    return None


def shares(x: Array, right: Array) -> Array:
    """How far something is off at some times, as a share of the largest right value."""
    size, off = np.abs(right).max(initial=0.0), np.abs(x - right)
    off = off.reshape(len(off), math.prod(off.shape[1:]))
    return np.asarray((off / size if size else off).max(axis=1, initial=0.0))


def nudged(deck: str, share: float) -> str:
    """A deck whose masses, as far as they are weights, are greater by a share."""
    return re.sub(r"(?m)^GRAVITY (\S+)", lambda g: f"GRAVITY {float(g[1]) / (1.0 + share)!r}", deck)


def judge(run: Runner, case: Case, method: str) -> JudgedRun:
    """Solve a case by a method and judge what comes."""
    found = run(case, case.deck, written(method, case.step))

    def row(end: str, says: str, error: float = np.nan) -> JudgedRun:
        return JudgedRun(case, method, end, error, says, found.seconds)

    if found.wrong:
        return row(FAULT, found.wrong)
    if found.stop:
        return row(STOPPED, found.stop)
    says = "; ".join(found.looks)
    whole = case.right is None and not case.like[0] and case.compared is every  # all there is is comparable
    within = case.within
    if method in STEPLESS or (method == "AUTO" and not whole):
        within = EXACT_WITHIN if method in STEPLESS else AUTO_WITHIN
    if case.right is not None:
        offs = {"displacements": (shares(case.compared(found.t, found.u), case.right(found.t)), within)}
    else:
        told = reference(run, case)
        if told is None and case.like[0]:
            return row(FAULT, "the deck that gives the right answer does not run")
        if told is None or len(told[0].t) != len(found.t):
            return row(TOLD if says else RIGHT, says or ALONE)
        right, by, doubt = told
        within += doubt

        def off_by(other: Found, factor: float) -> Offs:
            u = case.compared(right.t, case.like[1] * right.u)
            out = {"displacements": (shares(case.compared(other.t, factor * other.u), u), within)}
            if case.compared is every:
                out |= forces(other, right, within)
            if method == "AUTO" and whole:
                out |= promised(other, right, AUTO_WITHIN + doubt)
            return out

        offs = off_by(found, 1.0)
        if beyond(offs):
            other = run(case, nudged(case.like[0] or case.deck, NUDGE * within), by)
            if len(other.t) == len(right.t):
                offs, part = known(offs, off_by(other, case.like[1]), right.t)
                says = says or part
    error = float(offs["displacements"][0].max(initial=0.0))
    if wrong := beyond(offs):
        return row(TOLD, says, error) if found.looks else row(FAULT, wrong, error)
    return row(RIGHT, says, error)


Offs = dict[str, tuple[Array, float]]  #: how far quantities are off, and how far they may be
PEAKS: Final = "largest "  #: so begin those that are no series in time


def forces(found: Found, right: Found, within: float) -> Offs:
    """How far forces are off, where both runs have the same springs and contacts."""
    out = {}
    if found.f.shape == right.f.shape:
        out["spring forces"] = shares(found.f, right.f), FASTER * within
    if found.blows.shape == right.blows.shape:
        out[f"{PEAKS}contact forces"] = parts(found.blows, right.blows, 0.05), FASTER * within
    return out


def promised(found: Found, right: Found, within: float) -> Offs:
    """How far off the figures are that AUTO brings to its tolerance (see `auto`)."""
    swings = np.abs(right.swings).max(axis=1, keepdims=True, initial=0.0)
    return {
        f"{PEAKS}deformations": (parts(found.swings, right.swings, 1e-6, swings), within),
        f"{PEAKS}contact forces": (parts(found.blows, right.blows, 0.05), within),
    }


def parts(x: Array, right: Array, floor: float, size: Array | None = None) -> Array:
    """How far some values are off, each as a share of its own right size, but of no less than a share
    `floor` of the largest.
    """
    size = np.abs(right) if size is None else size
    size = np.maximum(size, floor * size.max(initial=0.0))
    return np.asarray(np.abs(x - right) / np.where(size > 0.0, size, 1.0))


def known(offs: Offs, nudged: Offs, t: Array) -> tuple[Offs, str]:
    """What of some errors counts where those of a nudged deck tell what is known of the answer at the times
    `t`; and in words whether that is a part only.
    """
    good = {x: off <= most for x, (off, most) in nudged.items()}
    series = [x for x in good if not x.startswith(PEAKS)]
    n = min([len(t), *(int(np.argmin(good[x])) for x in series if not good[x].all())])
    known = {x: (off[:n] if x in series else off[good[x]], most) for x, (off, most) in offs.items()}
    if all(x.all() for x in good.values()):
        return known, ""
    return known, PARTLY + (f", up to t = {t[n - 1]:g}" if n < len(t) else "")


def beyond(offs: Offs) -> str:
    """What is further off than allowed, in words."""
    bad = [(x, off.max(), most) for x, (off, most) in offs.items() if not (off <= most).all()]
    return ", ".join(f"{x} {off:.2g} off, above {most:g}" for x, off, most in bad)


def matrix(
    families: tuple[str, ...] = FAMILIES,
    chosen: Callable[[Case], bool] = lambda case: True,
    limit: float = LIMIT,
) -> Iterator[JudgedRun]:
    """Solve all cases by all methods.

    Parameters
    ----------
    families : tuple of str
        Of ``linear``, ``contact`` and ``hysteresis``.
    chosen : callable
        Which cases.
    limit : float
        Seconds that a run may take, in one of as many processes as there are cores; 0: in this process,
        without a limit.
    """
    count = (os.cpu_count() or 1) if limit else 1
    runners: SimpleQueue[Runner] = SimpleQueue()
    for _ in range(count):
        runners.put(Runner(limit))

    def solved(case: Case) -> list[JudgedRun]:
        run = runners.get()
        run.kept.clear()
        try:
            return [judge(run, case, method) for method in methods()]
        finally:
            runners.put(run)

    try:
        with ThreadPoolExecutor(count) as pool:
            for rows in pool.map(solved, filter(chosen, cases(families))):
                yield from rows
    finally:
        for _ in range(count):
            runners.get().close()


ENDS: Final = (RIGHT, TOLD, STOPPED, FAULT)


def table(rows: Sequence[JudgedRun]) -> str:
    """Counts of how cases end, scene by method, as Markdown."""
    names = methods()
    by: dict[tuple[str, str], list[JudgedRun]] = defaultdict(list)
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
    told = f"{n} cases, {len(rows)} runs: {counts}. Of those right {alone} are known by their energy alone"
    partly = sum(r.end == RIGHT and r.says.startswith(PARTLY) for r in rows)
    told += f", {partly} in part, as far as the answer is known." if partly else "."
    return "\n".join([*out, told])


def stops(rows: Sequence[JudgedRun]) -> str:
    """The stops by kind, with their count, methods and an example; then what is known in part, and all
    faults.
    """
    kinds: dict[str, list[tuple[str, JudgedRun]]] = defaultdict(list)
    for row in rows:
        if row.end == STOPPED:
            text = REFUSED_AT.sub("", row.says.split("\n")[0])
            kinds[re.sub(r"[-+\d.e]*\d[-+\d.e]*", "0", text)].append((text, row))
    out = ["| stops | by | the first of them | in the scene |", "|---|---|---|---|"]
    for kind in sorted(kinds.values(), key=len, reverse=True):
        (text, first), by = kind[0], ", ".join(dict.fromkeys(row.method for _, row in kind))
        out.append(f"| {len(kind)} | {by} | {text} | {_scene(first)} |")
    out += [
        f"- {_scene(r)} by {r.method}: {r.says}"
        for r in rows
        if r.end == FAULT or (r.end == RIGHT and r.says.startswith(PARTLY))
    ]
    return "\n".join(out)


def _scene(row: JudgedRun) -> str:
    return ", ".join(x for x in (row.case.scene, row.case.variant, row.case.law) if x)


def page(rows: Sequence[JudgedRun]) -> str:
    """Both, for the terminal and the manual."""
    cells = "; ".join(f"{end}: {MEANS[end]}" for end in ENDS)
    return f"{table(rows)}\n\nThe cells count {' / '.join(ENDS)}. {cells}.\n\n{stops(rows)}"
