"""Runs of the study's decks, side by side in some processes, and what is kept of each."""

from __future__ import annotations

import json
import os
import re
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from cases import BENCHMARK, Test
from motions import Record

import pound_solve
from pound_solve.driver.run import DeckError
from pound_solve.loading.records import known
from pound_solve.loading.records.base import RecordError

#: intervals of the histories from which a program without peaks between the rows takes its largest force
STORED = ("1 ms", "2 ms", "5 ms")
PLACES = tuple(f"B{b} storey {s} {end}" for b in (1, 2) for s in (1, 2) for end in ("left", "right"))


@dataclass(frozen=True)
class Hit:
    """One collision.

    Attributes
    ----------
    floor : int
    t, lasts : float
        Time and length [s].
    approach : float
        Closing speed [m/s].
    peak, plateau : float
        Force [kN].
    stored : tuple of float
        Largest force among samples every 1, 2 and 5 ms [kN], of the benchmark alone.
    """

    floor: int
    t: float
    lasts: float
    approach: float
    peak: float
    plateau: float
    stored: tuple[float, ...] = ()

    def force(self, of: str) -> float:
        """Return what is taken for the recorded force [kN]: ``peak``, ``plateau``, ``1 ms``, ``2 ms`` or
        ``5 ms``.
        """
        if of in STORED:
            return self.stored[STORED.index(of)]
        return self.plateau if of == "plateau" else self.peak


@dataclass(frozen=True)
class Run:
    """What is kept of one run.

    Attributes
    ----------
    right, left : dict of str to float
        Largest drift of every place rightward and leftward [mm], both positive.
    hits : tuple of Hit
    forces, closures : tuple
        Peak force [kN] and number of closures of every floor.
    residual : float
        Energy residual as a share of the input.
    """

    record: str
    test: str
    right: dict[str, float]
    left: dict[str, float]
    hits: tuple[Hit, ...]
    forces: tuple[float, ...]
    closures: tuple[int, ...]
    residual: float


@dataclass(frozen=True, eq=False)
class Job:
    """One run to be made; the deck takes those of `params` that it has.  `damping` is a card in place of
    the deck's own damping.
    """

    record: Record
    test: Test
    params: Mapping[str, object]
    folders: tuple[Path, ...]
    damping: str = ""


def write_deck(job: Job, folder: Path) -> tuple[Path, set[str]]:
    """The deck of a job and what it includes, with the test's changes; and the PARAMs that it has."""
    names: set[str] = set()
    for source in (job.test.deck, *job.test.deck.parent.glob("*.inc")):
        text = source.read_text(encoding="utf-8")
        for old, new in job.test.edits:
            text = text.replace(old, new)
        text = text.replace("RECORD  record  SCALE", f"RECORD  record  {job.record.items}  SCALE")
        if job.damping:
            text = re.sub(
                r"^DAMPING.*?(?=^DRIFT)", f"DAMPING\n   {job.damping}\n\n", text, flags=re.M | re.S
            )
        if source == job.test.deck:  # peaks do not depend on what is stored, but time does
            rows = "EVERY=0.001  NODES=1000  MEMBERS=9001,9002" if benchmark(job.test) else "EVERY=1"
            text += f"\nOUTPUT\n   {rows}\n"
            names |= params_of(text)
        elif f'INCLUDE "{source.name}"' in job.test.deck.read_text(encoding="utf-8"):
            names |= params_of(text)
        (folder / source.name).write_text(text, encoding="utf-8")
    return folder / job.test.deck.name, names


def benchmark(test: Test) -> bool:
    """Whether the recorded forces of a test are those that Eq. 11 is compared with."""
    return test.name == BENCHMARK


def params_of(text: str) -> set[str]:
    """Names of a deck's PARAMs."""
    cards = re.findall(r"^PARAM([^!\n]*)", text, re.M)
    return {name for card in cards for name in re.findall(r"(\w+) *=", card)}


def solve(job: Job) -> Run:
    """Run one job in a folder of its own."""
    name = f"{job.record.name}, test {job.test.name}, {dict(job.params)}"
    with tempfile.TemporaryDirectory() as folder:
        deck, names = write_deck(job, Path(folder))
        given = {**job.params, **job.test.params, **job.record.params}
        params = {k: v for k, v in given.items() if k in names}
        try:
            results = pound_solve.run(
                deck, params, records=job.folders, method=job.test.method, dt=job.test.dt
            )
        except DeckError as err:
            raise RuntimeError(f"{name}: {err}") from None
        with results:
            if results.status != "done":
                raise RuntimeError(f"{name}: {results.message}")
            return gather(job, results)


def gather(job: Job, results: pound_solve.results.Results) -> Run:
    """Keep what the study needs of a results file."""
    drifts = {row["name"]: row for row in results.table("drift_envelope")}
    rows = {place: drifts.get(place, drifts.get(place.rsplit(" ", 1)[0])) for place in PLACES}
    summary = results.table("contact_summary")
    hits = tuple(
        Hit(
            int(str(row["contact"])[-1]),
            float(row["t_start"]),
            float(row["t_end"]) - float(row["t_start"]),
            float(row["approach_velocity"]),
            float(row["peak_force"]),
            float(row["plateau_force"]),
            stored(results, row) if benchmark(job.test) else (),
        )
        for row in results.table("collisions")
    )
    energy = {row["item"]: row for row in results.table("energy")}
    return Run(
        job.record.name,
        job.test.name,
        {place: 1e3 * float(row["max"]) for place, row in rows.items()},
        {place: -1e3 * float(row["min"]) for place, row in rows.items()},
        hits,
        tuple(float(row["peak_force"]) for row in summary),
        tuple(int(row["closures"]) for row in summary),
        abs(float(energy["residual"]["share"])) / 100,
    )


def stored(results: pound_solve.results.Results, row: Any) -> tuple[float, ...]:
    """Largest force of a collision among samples every 1, 2 and 5 ms [kN]."""
    t, forces = results.course("contact/force")
    force = forces[:, results.labels("contact/force").index(str(row["contact"]))]
    inside = (t >= row["t_start"]) & (t <= row["t_end"])
    out = []
    for interval in STORED:
        step = 1e-3 * float(interval.split()[0])
        sampled = inside & (np.abs(t / step - np.round(t / step)) < 1e-6)
        out.append(float(force[sampled].max(initial=0.0)))
    return tuple(out)


def found(record: Record, folders: Sequence[Path]) -> bool:
    """Whether the record is at hand."""
    try:
        known.find(record.file, [Path(), *folders])
    except RecordError:
        return False
    return True


def solve_all(
    jobs: Iterable[Job], store: Path, tell: Callable[[int, int], None], processes: int | None = None
) -> list[tuple[Run, float]]:
    """Run jobs in processes; `tell` is called with how many are done, of how many.

    Parameters
    ----------
    store : Path
        File of all runs made, in lines of JSON: what stands in it is not run again.
    processes : int, optional
        As many as there are cores.

    Returns
    -------
    list
        Of every job its run, and its CPU time [s].
    """
    jobs = list(jobs)
    kept: dict[str, tuple[Run, float]] = {}
    if store.exists():
        for line in store.read_text(encoding="utf-8").splitlines():
            name, run, cost = json.loads(line)
            kept[name] = read_run(run), cost
    wanted = {key(job): job for job in jobs if key(job) not in kept}
    with (
        store.open("a", encoding="utf-8") as stream,
        ProcessPoolExecutor(processes or os.cpu_count()) as pool,
    ):
        for n, (name, (run, cost)) in enumerate(zip(wanted, pool.map(timed, wanted.values()))):
            kept[name] = run, cost
            stream.write(json.dumps([name, asdict(run), cost]) + "\n")
            stream.flush()
            tell(n + 1, len(wanted))
    return [kept[key(job)] for job in jobs]


def timed(job: Job) -> tuple[Run, float]:
    """A run, and its CPU time [s]."""
    began = time.process_time()
    return solve(job), time.process_time() - began


def key(job: Job) -> str:
    """A run's name among those kept."""
    test = [
        job.test.deck.name,
        dict(job.test.params),
        job.test.edits,
        job.test.method,
        job.test.dt,
        job.test.name,
    ]
    job_of = [job.record.params, job.record.items, test, dict(job.params), job.damping]
    return json.dumps(job_of, sort_keys=True)


def read_run(kept: Mapping[str, Any]) -> Run:
    """A run from its fields, as `dataclasses.asdict` gives them."""
    hits = tuple(Hit(**{**hit, "stored": tuple(hit["stored"])}) for hit in kept["hits"])
    return Run(
        **{**kept, "hits": hits, "forces": tuple(kept["forces"]), "closures": tuple(kept["closures"])}
    )
