"""STUDY: accuracy of each method against its time, on the user's own deck.

Time is CPU time of the process, so that other load of the machine ends no run and favours no method.

The history is run by several methods over a ladder of steps (or tolerances).  Errors are those of extremes,
against a reference: EXACT with a search grid four times finer than usual, if it solves the deck in the time
allowed; else LAGUERRE with a tolerance far below the compared ones; else an extrapolation from the finest
steps after Richardson (1911), Phil. Trans. R. Soc. A 210.
"""

from __future__ import annotations

import itertools
import math
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from pound_deck.schema import out_of_limits
from pound_solve.analyses.history import ROWS
from pound_solve.assess.advice import MARGIN, TARGETS, MethodStudyError, advise, errors, extrapolated
from pound_solve.catalog import catalog
from pound_solve.check import Subject
from pound_solve.driver import run as driver
from pound_solve.driver.overrides import with_method
from pound_solve.driver.preflight import MOST_STEPS
from pound_solve.results import Results
from pound_solve.results.place import put_in_place
from pound_solve.results.schema import Stage
from pound_solve.results.study_record import MethodStudy, MethodTrial, Peaks, Reference
from pound_solve.results.whole_file import partial

Report = Callable[[str], None]

HALVINGS: Final = 16  #: most halvings of the first step
FINE: Final = 1e-10  #: tolerance of LAGUERRE for the reference
CHECKED: Final = 1e-8  #: tolerance of the run that estimates the error of the reference
TOO_LONG: Final = "takes longer than --longest"


class TooLong(Exception):
    """Raised if a run takes longer than the plan allows."""


@dataclass(frozen=True)
class Plan:
    """Methods and settings of a study.

    Attributes
    ----------
    methods : tuple of str
        The first stepping method provides the reference if EXACT and LAGUERRE are not among them or fail.
    steps : tuple of float
        Time steps, descending [T]; empty: from the step of the record on by halves until errors are below
        the last of `TARGETS`, or a run would take too long.
    tols : tuple of float
        Tolerances of AUTO and LAGUERRE.
    repeat : int
        Number of timed runs of each trial.
    longest : float
        Limit of CPU time of one run [s].
    """

    methods: tuple[str, ...] = (
        "EXACT", "TAYLOR", "LAGUERRE", "NEWMARK", "HHT", "GENERALISED_ALPHA", "CENTRAL", "AUTO",
    )  # fmt: skip
    steps: tuple[float, ...] = ()
    tols: tuple[float, ...] = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
    repeat: int = 3
    longest: float = 5.0


def run(
    request: driver.Request, plan: Plan, report: Report = lambda text: None
) -> tuple[MethodStudy, driver.Prepared]:
    """Run the study of a deck.

    Parameters
    ----------
    request : Request
        Its method, dt and tol are not used.
    plan : Plan
    report : callable
        Called with a line of text on each run.

    Raises
    ------
    MethodStudyError
        There is no HISTORY, an unknown method, or no run that could be a reference.
    DeckError, OSError
        See `app.prepare`.
    """
    ready = driver.prepare(request)
    cards = [c for c in ready.model.analyses if c.spec.name == "HISTORY"]
    if not cards:
        raise MethodStudyError("the deck has no HISTORY: there is nothing to study")
    known = catalog().family("method")
    for name in plan.methods:
        if name not in known:
            raise MethodStudyError(f"--methods {name}: known methods are {', '.join(known)}")
    _check_settings(plan, max(card["T"] for card in cards))
    model = replace(ready.model, analyses=tuple(cards))
    with tempfile.TemporaryDirectory(prefix="pound-study-") as folder:
        bench = _Bench(request, replace(ready, model=model), plan, Path(folder) / "run.h5", report)
        trials, reference = bench.all()
    return MethodStudy(tuple(trials), reference, advise(trials, reference)), ready


def _check_settings(plan: Plan, end: float) -> None:
    """Raise MethodStudyError where a step or a tolerance is out of the limits of a method, or a step is too
    short for a history up to `end`.
    """
    methods = [catalog().family("method")[name] for name in plan.methods]
    for option, item, values in (("--steps", "DT", plan.steps), ("--tols", "TOL", plan.tols)):
        fields = filter(None, (m.field(item) for m in methods))
        narrow = sorted(fields, key=lambda field: field.lo or 0.0, reverse=True)  # its limits suit all
        for value, field in itertools.product(values, narrow):
            if wrong := out_of_limits(value, field):
                raise MethodStudyError(f"{option}: {item} {wrong}")
    if plan.steps and end / min(plan.steps) > MOST_STEPS:
        raise MethodStudyError(f"--steps: DT={min(plan.steps):g} requires more than {MOST_STEPS:g} steps")


class _Bench:
    """Runs the trials of one study."""

    def __init__(
        self, request: driver.Request, ready: driver.Prepared, plan: Plan, path: Path, report: Report
    ) -> None:
        self.request, self.ready, self.plan, self.path, self.report = request, ready, plan, path, report
        self.methods = catalog().family("method")
        self.warm: set[str] = set()

    def all(self) -> tuple[list[MethodTrial], Reference]:
        """Every trial with its errors, and the reference."""
        plan, trials = self.plan, dict[str, list[MethodTrial]]()
        items = {m: {f.name for f in self.methods[m].fields} for m in plan.methods}
        stepping = [m for m in plan.methods if "DT" in items[m]]
        reference = self._exact(trials) or self._finest_tolerance(trials) or self._stepped(stepping, trials)
        for method in plan.methods:
            if method not in trials:
                if method in stepping:
                    trials[method] = self._ladder(method, reference)
                else:
                    trials[method] = (
                        self._tolerances(method) if "TOL" in items[method] else [self.trial(method)]
                    )
        known = reference
        return [
            replace(t, errors=errors(t.peaks, known.peaks)) for m in plan.methods for t in trials[m]
        ], known

    def _exact(self, out: dict[str, list[MethodTrial]]) -> Reference | None:
        """EXACT with a finer search grid, or None if it is not requested or stops; its trial goes into
        `out`.
        """
        if "EXACT" not in self.plan.methods:
            return None
        # a finer search grid can take longer; it is the first run, which is not timed
        fine = self.trial("EXACT", 2.0 * self.plan.longest, timed=False, REFINE=2)
        usual = replace(fine, setting="") if fine.stopped else self.trial("EXACT")
        out["EXACT"] = [usual]
        if usual.stopped:
            return None
        return Reference(fine.peaks, errors(usual.peaks, fine.peaks), "EXACT with REFINE=2")

    def _finest_tolerance(self, out: dict[str, list[MethodTrial]]) -> Reference | None:
        """LAGUERRE with `FINE`, or None if it is not requested or stops; its trials go into `out`."""
        if "LAGUERRE" not in self.plan.methods:
            return None
        out["LAGUERRE"] = self._tolerances("LAGUERRE")  # the first of them compiles
        if any(t.stopped for t in out["LAGUERRE"]):
            return None
        fine, usual = (
            self.trial("LAGUERRE", 2.0 * self.plan.longest, timed=False, TOL=tol) for tol in (FINE, CHECKED)
        )
        if fine.stopped or usual.stopped:
            return None
        return Reference(fine.peaks, errors(usual.peaks, fine.peaks), f"LAGUERRE with {fine.setting}")

    def _stepped(self, methods: Sequence[str], out: dict[str, list[MethodTrial]]) -> Reference:
        """Reference extrapolated from the ladder of the first of some methods for which that succeeds; the
        trials of all ladders go into `out`, but for the two finest of the reference.
        """
        message = "without EXACT and LAGUERRE a study needs a method with steps: name one in --methods"
        why = MethodStudyError(message)
        for method in methods:
            out[method] = ladder = self._ladder(method, None)
            try:
                reference = extrapolated(method, ladder)
            except MethodStudyError as err:
                why = err
                continue
            # the two finest made the reference: their own errors would look too small
            out[method] = [t for t in ladder if t.stopped] + [t for t in ladder if not t.stopped][:-2]
            return reference
        raise why

    def _ladder(self, method: str, reference: Reference | None) -> list[MethodTrial]:
        """Trials with successively shorter steps."""
        if self.plan.steps:
            return [self.trial(method, DT=dt) for dt in self.plan.steps]
        return self._halved(method, reference)

    def _halved(self, method: str, reference: Reference | None) -> list[MethodTrial]:
        """Trials with halved steps until the errors are small, or a run would take too long."""
        trials: list[MethodTrial] = []
        for k in range(HALVINGS):
            trial = self.trial(method, DT=self.first / 2**k)
            if trials and trial.steps and trial.steps == trials[-1].steps:
                continue  # the record and the output times need more steps than DT
            if trials and trials[-1].stopped and trial.stopped:
                trials.pop()  # of those that stop the finest is enough
            trials.append(trial)
            done = [t for t in trials if not t.stopped]
            if _converged(done, reference):
                break
            if trial.stopped == TOO_LONG and done:
                trials.pop()
            if trial.stopped == TOO_LONG or 2.0 * trial.time > self.plan.longest:
                break
            if trial.stopped.startswith("A505"):  # the method does not take this model, with any step
                break
        return trials

    def _tolerances(self, method: str) -> list[MethodTrial]:
        """Trials of a method with a tolerance."""
        trials: list[MethodTrial] = []
        for tol in self.plan.tols:
            trials.append(self.trial(method, TOL=tol))
            taken = trials[-1].method.removeprefix(f"{method}: ")
            if taken != trials[-1].method:  # a method without steps, as for smaller tolerances
                return [] if len(trials) == 1 and taken in self.plan.methods else trials
            if not trials[-1].stopped and 4.0 * trials[-1].time > self.plan.longest:
                break
        return trials

    @property
    def first(self) -> float:
        """Longest step of a ladder [T]: that of the record, or of the output where it is shorter."""
        model = self.ready.model
        steps = [m.info.get("dt") for m in self.ready.motions] + [
            f.info.get("dt") for f in self.ready.forces
        ]
        intervals = [dt for dt in (*steps, model.output["EVERY"]) if dt]
        return float(min(intervals, default=model.analyses[0]["T"] / ROWS))

    def trial(
        self, method: str, longest: float | None = None, *, timed: bool = True, **given: float
    ) -> MethodTrial:
        """Run one method with one setting, as often as planned; the first run of a method is not timed,
        because it imports and compiles.
        """
        cards = tuple(with_method(c, self.methods[method], given) for c in self.ready.model.analyses)
        ready = replace(self.ready, model=replace(self.ready.model, analyses=cards))
        setting = " ".join(f"{k}={v:.12g}" for k, v in given.items())
        cold = timed and method not in self.warm
        trial, seconds = MethodTrial(method, setting), list[float]()
        for n in range(self.plan.repeat + cold if timed else 1):
            self.report(f"{method} {setting}, run {n + 1}")
            # only what is compiled may take longer the first time
            limit = math.inf if cold and n == 0 and method != "EXACT" else longest or self.plan.longest
            try:
                took, trial = self._once(ready, method, setting, limit)
            except TooLong:
                return replace(trial, stopped=TOO_LONG)
            if trial.stopped:
                return trial
            seconds.append(took)
        self.warm.add(method)
        return replace(trial, seconds=tuple(seconds[cold:]))

    def _once(
        self, ready: driver.Prepared, method: str, setting: str, longest: float
    ) -> tuple[float, MethodTrial]:
        used = time.process_time()

        def monitored(*_: object) -> None:
            if time.process_time() - used > longest:
                raise TooLong

        with driver.solve(ready, self.path, monitored, time.perf_counter(), self.request) as results:
            if results.message.startswith("A506"):
                raise KeyboardInterrupt
            if results.message:
                return 0.0, MethodTrial(method, setting, stopped=results.message)
            figures, took = dict(results.table("run").tolist()), dict(results.table("run_figures").tolist())
            name = figures["method"].split(",")[0]
            energy = next(check for check in results.checks if check.subject is Subject.ENERGY)
            if method == "EXACT" and energy.looks:  # it must not become the reference
                return 0.0, MethodTrial(method, setting, stopped=str(energy))
            trial = MethodTrial(
                f"AUTO: {name}" if method == "AUTO" and "steps" not in figures else method,
                setting,
                steps=int(figures.get("steps", 0)),
                events=int(figures["events"]),
                collisions=len(results.table("collisions")),
                residual=energy.value,
                peaks=peaks(results),
            )
            return float(took["solve seconds, CPU"]), trial


def _converged(done: Sequence[MethodTrial], reference: Reference | None) -> bool:
    """Whether the error of the last trial is well below the last target, or as small as the reference's.

    Errors are those against the reference, without one those against the trial before.
    """
    if not done or (reference is None and len(done) < 2):
        return False
    now = max(
        errors(done[-1].peaks, reference.peaks if reference else done[-2].peaks).values(), default=0.0
    )
    return not now > TARGETS[-1] / (4.0 * MARGIN) or (
        reference is not None and now <= 4.0 * reference.doubt
    )


def peaks(results: Results) -> Peaks:
    """Largest and smallest values of a history's drifts, member forces and contact forces.

    Drifts, forces of springs and peaks of contacts are those as found by the method itself.  Forces of
    members, and displacements of nodes in place of drifts where there are none, are taken at the output
    times, which are the same for all methods.
    """
    extremes: dict[tuple[str, str], list[float]] = {}

    def take(kind: str, unit: str, *values: float) -> None:
        extremes.setdefault((kind, unit), []).extend(values)

    for row in results.table("drift_envelope"):
        take("drift", "", row["max"], row["min"])
    if not extremes and "node/u" in results.histories:
        unknowns = results.history("node/u")[:, :, :2].reshape(len(results.time), -1)
        take("drift", "", *unknowns.max(axis=0), *unknowns.min(axis=0))
    if "member/force" in results.histories:
        forces = results.history("member/force")
        for unit, high, low in zip(
            results.history_units("member/force"), forces.max(axis=0), forces.min(axis=0)
        ):
            take("member", unit, high, low)
    for row in results.table("spring_envelope"):
        take("member", row["unit"], row["force_max"], row["force_min"])
    for row in results.table("contact_summary"):
        take("contact", "", row["peak_force"])
    return {kind: np.array(values, float) for kind, values in extremes.items()}


def write(study: MethodStudy, ready: driver.Prepared, path: Path) -> Results:
    """Write the results file and the report of a study, and open the former."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with driver.writer_of(ready, partial(path)) as writer:
        for name, text in ready.model.files.items():
            writer.text(Path(name).name, text)
        writer.tables(Stage.STUDY, study)
        writer.finish("done")
        writer.close()
        return Results.open(put_in_place(path, driver.report_of(partial(path)), whole=True))
