"""AUTO over generated decks against independent answers; run by hand.

    python -m verification.generated.campaign rows.jsonl 0 100 [--records FOLDER] [--limit 120]
    python -m verification.generated.campaign rows.jsonl

For every seed AUTO solves the deck, and, where it took no steps, AUTO that may take steps alone
(``STEPS``).  NEWMARK with ever shorter steps, TAYLOR and EXACT give the independent answer: that of
another method than AUTO took.  How sure it is: TAYLOR and EXACT have no truncation error; steps are
quartered until a third of the difference to the run before is a small share of TOL, and that is told.
Where collisions make small differences large that share is too small: EXACT decides where steps and TAYLOR
are further apart than TOL.
One row per answer of AUTO goes into a file of JSON lines, in which a later run goes on.  Without seeds, the
tables of a file are printed.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import re
import tempfile
import time
from collections import Counter
from collections.abc import Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from verification.generated.answers import STEPS, Answer, answer, errors
from verification.generated.decks import deck

CHECK_LIMIT = 8.0  #: the same of a run that serves as reference
LIMIT = 30.0  #: CPU seconds that a run may take
FIRST_STEP, SHORTER = 2e-3, 4  #: of the steps that are shortened [s], and how much each time
MOST_RUNS = 6
SETTLED = 0.2  #: share of TOL that a run of shorter steps may leave
SURE = 0.3  #: share of TOL that an independent answer may be uncertain by
LADDER_SECONDS = 5.0  #: CPU time after which no shorter steps are tried
#: of errors that are printed
KINDS = ("auto", "hinge", "contact of own", "contact of largest", "acceleration", "member")
RIGID = "knows no rigid contact"  #: message of methods that take none
MOST_TASKS = 300  #: of one worker: a new one has a clean memory


class Worker:
    """A process that solves decks one after another and is ended where one takes too long."""

    def __init__(self, limit: float) -> None:
        self.limit, self.tasks = limit, 0
        self.process: multiprocessing.context.SpawnProcess | None = None

    def solve(self, *task: Any) -> Answer:
        """Answer of a method to a deck (see `answer`), or one with the status ``timeout``."""
        if self.process is None or self.tasks >= MOST_TASKS:
            self._start()
        self.tasks += 1
        self.connection.send(task)
        limit = self.limit if task[2] in ("AUTO", "EXACT") else min(self.limit, CHECK_LIMIT)
        begun = self.used()
        while not self.connection.poll(0.2) and self.used() < begun + limit:
            pass
        if self.connection.poll():
            try:
                found: Answer = self.connection.recv()
                return found
            except EOFError:
                self.end()
                return Answer("crashed", "the process ended", "", np.nan, None, None, False, True, {}, [])
        self.end()
        return Answer("timeout", f"no end in {limit:g} s", "", limit, None, None, False, True, {}, [])

    def used(self) -> float:
        """CPU seconds of the process; seconds where the system does not tell [s]."""
        assert self.process is not None
        try:
            facts = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
            return (int(facts[11]) + int(facts[12])) / os.sysconf("SC_CLK_TCK")
        except (OSError, IndexError):  # no such system, or the process is gone
            return time.monotonic()

    def _start(self) -> None:
        """Start a process."""
        self.end()
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process, self.tasks = context.Process(target=serve, args=(theirs,), daemon=True), 0
        self.process.start()
        theirs.close()
        self.connection.recv()  # it is warm: kernels may have been compiled

    def end(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.join()
            self.connection.close()
            self.process = None


def serve(connection: Connection) -> None:
    """Solve what is asked for until there is no more; a fault of the program is an answer, too."""
    warm = Path(tempfile.mkdtemp()) / "warm.inp"
    for seed in range(20):  # loads the kernels, so that no run's time contains that
        warm.write_text(deck(seed))
        answer(warm, None, "NEWMARK", {"dt": 0.01})
        if answer(warm, None, "TAYLOR", {}).status == "done":
            break
    connection.send(None)
    while True:
        try:
            task = connection.recv()
        except EOFError:
            return
        try:
            connection.send(answer(*task))
        except Exception as err:
            connection.send(
                Answer(
                    "crashed", f"{type(err).__name__}: {err}", "", np.nan, None, None, False, True, {}, []
                )
            )


class Reference(NamedTuple):
    """An independent answer: its name, how far it may be off, and itself."""

    name: str
    uncertain: float
    answer: Answer


class Seed:
    """What is found of one seed."""

    def __init__(self, seed: int, worker: Worker, folder: Path, records: Path | None) -> None:
        self.seed, self.worker, self.records = seed, worker, records
        text = deck(seed, records)
        self.deck = folder / f"{seed}.inp"
        self.deck.write_text(text)
        found = re.search(r"TOL=(\S+)", text)
        assert found is not None
        self.tol = float(found[1])
        self.answers: dict[str, Answer] = {}
        self.ladder: list[tuple[float, Answer, float]] = []

    def by(self, method: str, **options: float) -> Answer:
        """Answer of a method; it is asked once."""
        name = method + "".join(f" {k}={v:g}" for k, v in options.items())
        if name not in self.answers:
            self.answers[name] = self.worker.solve(self.deck, self.records, method, options)
        return self.answers[name]

    def rows(self) -> list[dict[str, Any]]:
        """Rows of the answers of AUTO."""
        own = self.by("AUTO")
        self._climb()
        out = [self._row("AUTO", own)]
        if own.method in ("EXACT", "TAYLOR") and self.ladder:
            out.append(self._row(STEPS, self.by(STEPS)))
        return out

    def _climb(self) -> None:
        """Shorten the steps of NEWMARK until the peaks settle."""
        used = 0.0
        for k in range(MOST_RUNS):
            found = self.by("NEWMARK", dt=FIRST_STEP / SHORTER**k)
            if RIGID in found.message or found.status in ("timeout", "refused"):
                return
            if found.status != "done":
                continue
            used += found.seconds
            left = errors(found, self.ladder[-1][1])["auto"] / (SHORTER - 1) if self.ladder else np.inf
            self.ladder.append((FIRST_STEP / SHORTER**k, found, left))
            if left < SETTLED * self.tol or used > LADDER_SECONDS:
                return

    def reference(self, taken: str) -> Reference | None:
        """Independent answer to one by a method."""
        if taken != "TAYLOR" and self.by("TAYLOR").status == "done":
            return Reference("TAYLOR", 0.0, self.by("TAYLOR"))
        step, found, left = self.ladder[-1] if self.ladder else (0.0, None, np.inf)
        doubtful = left > SURE * self.tol
        own = self.by("AUTO")
        if own.method == taken == "TAYLOR" and own.status == "done" and found is not None:
            doubtful |= errors(own, found)["auto"] > self.tol
        if doubtful and taken != "EXACT" and self.by("EXACT").status == "done":
            return Reference("EXACT", 0.0, self.by("EXACT"))
        return None if found is None else Reference(f"NEWMARK {step:.2g}", left, found)

    def best(self, truth: Reference) -> tuple[str, float]:
        """Method that meets TOL at least cost, and that [CPU s]; the error of steps as their square."""
        found = []
        for step, a, _ in self.ladder:
            if a is truth.answer or (error := errors(a, truth.answer)["auto"]) <= self.tol:
                longer = (
                    1.0 if a is truth.answer else float(np.clip((self.tol / error) ** 0.5, 1.0, SHORTER))
                )
                found.append((f"NEWMARK {step * longer:.2g}", a.seconds / longer))
                break
        asked = (self.answers.get(m) for m in ("EXACT", "TAYLOR"))
        found += [(a.method, a.seconds) for a in asked if a is not None and a.status == "done"]
        return min(found, key=lambda pair: pair[1], default=("", np.nan))

    def _row(self, mode: str, own: Answer) -> dict[str, Any]:
        """One row."""
        row: dict[str, Any] = {
            "seed": self.seed, "mode": mode, "tol": self.tol, "status": own.status,
            "message": own.message[:160], "method": own.method, "claimed": own.claimed,
            "magnified": own.magnified, "met": own.met,
            "seconds": round(own.seconds, 3),
        }  # fmt: skip
        truth = self.reference(own.method)
        if truth is not None:
            row |= {"reference": truth.name, "uncertain": truth.uncertain}
            row["best"], row["best seconds"] = self.best(truth)
            if own.status == "done":
                row["unique"] = own.unique and truth.answer.unique
                row["errors"] = {k: float(f"{x:.3g}") for k, x in errors(own, truth.answer).items()}
        return row | {"outcome": outcome(row)}


def outcome(row: Mapping[str, Any]) -> str:
    """Outcome of a row in a word or two."""
    if row["status"] != "done":
        solved = "errors" in row or row.get("best")
        return f"{row['status']}, another method ends" if solved else row["status"]
    if "errors" not in row:
        return "no reference"
    error, tol, uncertain = row["errors"]["auto"], row["tol"], row["uncertain"]
    if not row["met"]:
        return "not met, told"
    if error <= tol:
        return "right"
    if not row["unique"]:
        return "not unique, told"
    return "unsure" if error <= tol + uncertain or uncertain > SURE * tol else "above"


def line(row: Mapping[str, Any]) -> str:
    """A row as one line of text."""
    e = row.get("errors", {})
    claimed = f"{row['claimed']:.1e}" if row["claimed"] is not None else "-"
    best = row.get("best seconds") or np.nan
    told = [f"{e.get(k, np.nan):.1e}" for k in KINDS]
    return (
        f"{row['seed']:5d} {row['mode']:5} {row['method'] or '-':8} TOL {row['tol']:.0e} "
        f"{row['outcome']:14} "
        f"claimed {claimed:8} true {' '.join(told)}  by {row.get('reference', '-'):16} "
        f"(+-{row.get('uncertain', np.nan):.0e}) {row['seconds']:7.2f} s, best {best:7.2f} s "
        f"{row.get('best', '')} {row['message'] if row['status'] != 'done' else ''}"
    )


def summary(rows: list[dict[str, Any]]) -> str:
    """Tables of a campaign: outcomes, errors over TOL, costs."""
    out = []
    for mode in ("AUTO", STEPS):
        own = [r for r in rows if r["mode"] == mode]
        if not own:
            continue
        count = Counter((r["outcome"], r["method"] or "-") for r in own)
        out += [f"\n{mode}: {len(own)} decks", "| outcome | method | decks |", "|---|---|---|"]
        out += [f"| {o} | {m} | {n} |" for (o, m), n in sorted(count.items())]
        out += ["", "| figure | method | decks | median | 90 % | 99 % | largest | seeds of the largest |"]
        out += ["|---|---|---|---|---|---|---|---|"]
        for method in sorted({r["method"] for r in own if "errors" in r}):
            mine = [r for r in own if "errors" in r and r["method"] == method and r["outcome"] != "unsure"]
            for kind in KINDS:
                pairs = [(r["errors"][kind] / r["tol"], r["seed"]) for r in mine]
                out.append(_distribution(f"error over TOL: {kind}", method, pairs))
            pairs = [(r["seconds"] / r["best seconds"], r["seed"]) for r in mine if r.get("best seconds")]
            out.append(_distribution("cost over that of the best", method, pairs))
            out.append(_distribution("CPU seconds", method, [(r["seconds"], r["seed"]) for r in mine]))
    return "\n".join(out)


def _distribution(name: str, method: str, pairs: list[tuple[float, int]]) -> str:
    """Row of a table."""
    if not pairs:
        return f"| {name} | {method} | 0 | | | | | |"
    values = np.array([x for x, _ in pairs])
    figures = [f"{np.quantile(values, q):.2g}" for q in (0.5, 0.9, 0.99, 1.0)]
    worst = ", ".join(str(seed) for _, seed in sorted(pairs, reverse=True)[:3])
    return f"| {name} | {method} | {len(pairs)} | {' | '.join(figures)} | {worst} |"


def main() -> None:
    """Run seeds, or print the tables of a file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path, help="file of JSON lines")
    parser.add_argument(
        "seeds", type=int, nargs="*", metavar="SEED", help="the first, and the one after the last"
    )
    parser.add_argument("--records", type=Path, metavar="FOLDER", help="folder of record files")
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds that a run may take")
    args = parser.parse_args()
    rows = [json.loads(x) for x in args.file.read_text().splitlines()] if args.file.exists() else []
    known = {r["seed"] for r in rows}
    worker = Worker(args.limit)
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(*args.seeds) if args.seeds else ():
            if seed in known:
                continue
            new = Seed(seed, worker, Path(folder), args.records).rows()
            with args.file.open("a") as file:
                file.writelines(json.dumps(r) + "\n" for r in new)
            rows += new
            print("\n".join(map(line, new)), flush=True)
    worker.end()
    print(summary(rows))


if __name__ == "__main__":
    main()
