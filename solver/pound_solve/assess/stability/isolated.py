"""Runs of the stability matrix in separate processes, which may crash or hang."""

from __future__ import annotations

import multiprocessing
import re
import tempfile
import time
import warnings
from collections.abc import Mapping
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from pound_solve.assess.stability.scenes.case import METHOD, StabilityCase
from pound_solve.assess.stability.scenes.linear import KICK, one
from pound_solve.check import Check, Subject, looked
from pound_solve.driver import run
from pound_solve.numerics.types import Array
from pound_solve.results import Results

LIMIT: Final = 180.0  #: time after which a case counts as endless [s]
#: the message of a stop has its number and time or stage, that of a refused deck its place
CLEAR: Final = re.compile(r"A5\d\d (at t = \S+ \S+: |static analysis: )\w.{20,}|A50[15] \w.{20,}")
REFUSED: Final = re.compile(r"\.inp:\d+:\d+: error [A-Z]\d{3}: ")


class Findings(NamedTuple):
    """Outcome of a run: times, displacements, velocities, forces of springs; the largest deformations of
    springs, positive and negative, shape (n_springs, 2); the largest forces of contacts; the message of a
    stop or refusal; checks of the numbers with the verdict "look"; what is wrong with it; seconds.
    """

    t: Array = np.zeros(0)
    u: Array = np.zeros(0)
    v: Array = np.zeros((0, 0))
    f: Array = np.zeros((0, 0))
    swings: Array = np.zeros((0, 2))
    blows: Array = np.zeros(0)
    stop: str = ""
    looks: tuple[Check, ...] = ()
    wrong: str = ""
    seconds: float = 0.0


def motion(results: Results) -> dict[str, Array]:
    """Quantities of a run that are compared, by their names in `Findings`."""
    tables = {x: results.table(x) for x in ("spring_envelope", "contact_summary") if x in results.tables}
    quantities = {}
    if "node/u" in results.histories:
        quantities = {"t": results.time.copy(), "u": results.history("node/u")[:, :, 0].copy()}
        quantities["v"] = results.history("node/v")[:, :, 0].copy()
        quantities["f"] = np.zeros((len(quantities["t"]), 0))
    if "spring/force" in results.histories:
        quantities["f"] = results.history("spring/force").copy()
    if "spring_envelope" in tables:
        springs = tables["spring_envelope"]
        quantities["swings"] = np.column_stack([springs["deformation_max"], springs["deformation_min"]])
    if "contact_summary" in tables:
        quantities["blows"] = tables["contact_summary"]["peak_force"].copy()
    return quantities


def solve(deck: str, files: Mapping[str, str]) -> Findings:
    """Run a deck in a temporary folder; every exception becomes part of the result."""
    began = time.perf_counter()

    def findings(**known: Any) -> Findings:
        return Findings(**known, seconds=time.perf_counter() - began)

    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        path = Path(folder) / "case.inp"
        for name, text in {**files, path.name: deck}.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        try:
            request = run.Request(str(path))  # no report is printed, which is half of a short run
            results = run.solve(run.prepare(request), request.path(".h5"), None, began, request)
        except run.DeckError as err:
            text = str(err)
            return (
                findings(stop=text) if REFUSED.search(text) else findings(wrong=f"unclear refusal: {text}")
            )
        except Exception as err:
            return findings(wrong=f"{type(err).__name__}: {err}")
        with results:
            stop, moved = results.message, motion(results)
            # an implausible response may be right, and excuses no error
            looks = tuple(c for c in looked(results.checks) if c.subject is not Subject.RESPONSE)
            bad = [name for name in results.histories if not np.isfinite(results.history(name)).all()]
        if bad:
            return findings(**moved, wrong=f"NaN or infinite values in {', '.join(bad)}")
        if stop and not CLEAR.match(stop):
            return findings(**moved, wrong=f"unclear stop: {stop}")
        return findings(**moved, stop=stop, looks=looks)


def serve(line: Connection) -> None:
    """Solve the decks that arrive on a connection; before, send None when the kernels are compiled."""
    solve(one(KICK).replace(METHOD, "NEWMARK DT=0.1"), {})
    line.send(None)
    with suppress(EOFError):
        while True:
            line.send(solve(*line.recv()))


class Runner:
    """Runs decks in a separate process, which may die or be killed; each deck is run once."""

    def __init__(self, limit: float) -> None:
        self.limit, self.kept = limit, dict[str, Findings]()
        self.worker: tuple[BaseProcess, Connection] | None = None

    def __call__(self, case: StabilityCase, deck: str, method: str) -> Findings:
        """Run a deck with a method."""
        text = deck.replace(METHOD, method)
        if not self.limit:
            return solve(text, case.files)
        if text not in self.kept:
            self.kept[text] = self._apart(text, case.files)
        return self.kept[text]

    def _apart(self, text: str, files: Mapping[str, str]) -> Findings:
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
                answer: Findings = line.recv()
                return answer
        except (EOFError, ConnectionError):
            process.join()
            wrong = f"the process died: exit code {process.exitcode}"
        self.close()
        return Findings(wrong=wrong, seconds=self.limit)

    def close(self) -> None:
        """End the process."""
        if self.worker is not None:
            self.worker[1].close()
            self.worker[0].terminate()
            self.worker[0].join()
        self.worker = None
