"""Inputs, results and exceptions of every integrator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from pound_solve.check import Check, Subject, at_most, beyond, looked
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.integrate.tracker import Peaks
from pound_solve.laws.automaton import K, State
from pound_solve.numerics.matrices import used_rows
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.corotational import ACROSS, KIND, QUANTITIES, STRING
from pound_solve.structure.elements.base import LawSpring, Role
from pound_solve.structure.reduction import ReducedSystem

BETWEEN = "largest share of a peak above both ends of its step"  #: name of a check
MAX_BETWEEN = 0.1  #: limit of that fraction; a sine with seven steps in its period reaches it
MAX_ROUNDING = 1e-2  #: fraction of a spring's largest force that may be rounding
RUNAWAY_TEXT = "the motion grows without bound: its energy {:.3g} is far above what was put in"
MAX_CHANGES, MAX_CHANGES_PER_LAW = 50, 4  #: most changes of branch at one instant: in all, and per law
CHATTER_TEXT = "{} changes at one instant, the last in element {} ({}) to {!r}: try {}"
INTERRUPTED = "interrupted; what was computed up to then is kept"


@dataclass(frozen=True)
class MonitoredOutputs:
    """Quantities whose peaks an integrator finds, linear in u: drifts.

    Attributes
    ----------
    names : sequence of str
    rows : ndarray, shape (n_monitored, n)
    input_rows : ndarray, shape (n_monitored, n_inputs)
    constants : ndarray, shape (n_monitored,)
    """

    names: Sequence[str]
    rows: Array
    input_rows: Array
    constants: Array


@dataclass(frozen=True)
class Start:
    """State at the start: displacement and velocity (n,), laws' states, output times (ascending,
    the first is the start), works so far (3,) as in `Recorder.sample`.
    """

    u: Array
    v: Array
    states: tuple[State, ...]
    times: Array
    works: Array = field(default_factory=lambda: np.zeros(3))


class LawValues(NamedTuple):
    """Forces [F] or [F L], recoverable and lost energies [F L] of all laws, and forces of the dashpots that
    damping adds parallel to springs (not included in the forces), shape (n_laws, n_times) each.
    """

    force: Array
    stored: Array
    lost: Array
    dashpot: Array


class Motion(NamedTuple):
    """The motion at some instants: their times, shape (n_times,), the unknowns, their velocities and
    accelerations, shape (n, n_times) each, and the forces of the laws, all dashpots included,
    shape (n_enveloped, n_times).  Only the rows of `Recorder.enveloped_unknowns` need be valid, and only
    the forces of `Recorder.enveloped_laws` are present.
    """

    t: Array
    u: Array
    v: Array
    a: Array
    law_forces: Array


class MotionRows(NamedTuple):
    """Sparse rows of a matrix whose columns are u, v, a and the forces of the laws.  The entries are stored
    row by row, shape (n_entries,) each.

    Attributes
    ----------
    row : ndarray of int
        Row numbers.
    columns : ndarray of int
    factors : ndarray
    """

    row: Index
    columns: Index
    factors: Array

    def some(self, entries: Index | Flags) -> MotionRows:
        """Return some of the entries."""
        return MotionRows(self.row[entries], self.columns[entries], self.factors[entries])

    def summed(self, values: Array) -> tuple[Index, Array]:
        """Return the numbers of the rows that have entries, and for each the sum of its factors times
        `values`, shape (n_used, n); `values` belong to the entries, shape (n_entries, n).
        """
        if not len(self.row):
            return self.row, values
        starts = np.flatnonzero(np.diff(self.row, prepend=-1))
        return self.row[starts], np.add.reduceat(self.factors[:, None] * values, starts, axis=0)


class RowPeaks(NamedTuple):
    """Extremes of rows on a motion and on the inputs.

    Attributes
    ----------
    rows : MotionRows
        Rows on the motion, in ascending order.
    on_inputs : ndarray, shape (n_rows, 3 n_inputs + 1)
        Factors of the inputs and of their first two derivatives, and a constant.
    high, t_high, low, t_low : ndarray, shape (n_rows,)
        Largest and smallest values so far, and their times [T].
    """

    rows: MotionRows
    on_inputs: Array
    high: Array
    t_high: Array
    low: Array
    t_low: Array


class Course(NamedTuple):
    """The motion between two samples: at ascending instants and, if known, after each of them.

    Attributes
    ----------
    motion : Motion
    lengths : ndarray, shape (n_times,)
        Time after each instant over which the motion is smooth [T]: to the next one or an earlier event.
    within : callable or None
        Returns the motion after the instants with given numbers, shape (n_cells,), at fractions of these
        times between 0 and 1, shape (n_shares,): n_cells * n_shares instants, cell by cell.  None: unknown.
    extremes : callable or None
        Updates the `RowPeaks` of some rows with this motion, with proof.  None: only `within` is available.
    """

    motion: Motion
    lengths: Array
    within: Callable[[Index, Array], Motion] | None
    extremes: Callable[[RowPeaks], None] | None = None


class RunEnvelopes(Protocol):
    """Envelopes of a run."""

    def between(self, course: Course) -> None:
        """Include the motion between samples, as `Recorder.between`."""

    def take(self, motion: Motion, s: Sequence[Array]) -> object:
        """Include samples; `s` are the inputs and their first two rates."""

    def peaks(self) -> tuple[Array, list[str]]:
        """Return the largest and smallest accelerations of nodes and forces of members, and their kinds."""

    def blank(self) -> Self:
        """Return empty envelopes of the same quantities."""

    def widen(self, other: Self) -> None:
        """Include the extremes of other envelopes."""


class Recorder(Protocol):
    """Takes the samples of a history."""

    @property
    def enveloped_unknowns(self) -> Flags:
        """Return which unknowns `between` needs, shape (n,), including those of `enveloped_laws`."""

    @property
    def enveloped_laws(self) -> Index:
        """Return the laws whose forces `between` needs, ascending, shape (n_enveloped,)."""

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take the motion (n, n_times) and the laws' forces and energies at some output times.

        `works`, shape (3, n_times), are the work put in so far, and the losses in the structure's and in
        the contacts' dashpots.
        """

    def between(self, course: Course) -> None:
        """Take the motion between samples: for envelopes."""

    def report_progress(self, t: float, doing: str = "") -> None:
        """Receive the time reached by a run whose samples may not be used, or what it is doing."""


class EnvelopeRecorder(Recorder, Protocol):
    """A recorder that keeps envelopes, and accepts samples of a finished run."""

    def keep(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take samples as `sample` does, but without reporting their progress, which has been reported."""

    @property
    def envelopes(self) -> RunEnvelopes:
        """Return the envelopes of the motion between the samples, and possibly at them."""


R = TypeVar("R", bound=Recorder, covariant=True)
S = TypeVar("S", bound=Recorder)


@dataclass(frozen=True)
class Problem(Generic[R]):
    """What a method integrates.

    Attributes
    ----------
    system : ReducedSystem
    start : Start
        State at the start, with the output times.
    monitored : MonitoredOutputs
    recorder : Recorder
        Takes the samples.
    """

    system: ReducedSystem
    start: Start
    monitored: MonitoredOutputs
    recorder: R

    @property
    def begin(self) -> float:
        """Time of the start [T]."""
        return float(self.start.times[0])

    def recorded_by(self, recorder: S) -> Problem[S]:
        """Return the same problem with another recorder."""
        return Problem(self.system, self.start, self.monitored, recorder)


@dataclass
class Outcome:
    """Result of an integration: its peaks, whether they are exact, figures, self-checks, and the laws'
    states at its end.
    """

    peaks: Peaks
    figures: dict[str, Any]
    states: tuple[State, ...]
    checks: list[Check] = field(default_factory=list)
    exact: bool = False

    @property
    def one_of_several(self) -> bool:
        """Whether a check says that rounding, or a convention, has chosen one of several motions."""
        chosen = (Subject.MAGNIFICATION, Subject.UNIQUENESS)
        return any(check.subject in chosen for check in looked(self.checks))


class Stop(Exception):
    """The integration cannot continue; states when, where and why.

    Attributes
    ----------
    code : str
        Message number.
    t : float
        Time reached [T].
    outcome : Outcome
        Results up to that time.
    """

    def __init__(self, code: str, t: float, why: str, outcome: Outcome | None = None) -> None:
        super().__init__(why)
        self.code, self.t, self.outcome = code, t, outcome


def reason_not_linear(system: ReducedSystem) -> str:
    """Return why a reduced system is not linear between events, as some methods require; empty if it is."""
    if system.structure.corotational:
        return f"members change their stiffness as they move (GEOMETRY {system.structure.model.geometry})"
    curved = next((s for s in system.structure.laws if s.law.curved), None)
    return "" if curved is None else f"the law {curved.rule} of element {curved.element} is curved"


def rigid_contact(system: ReducedSystem) -> LawSpring | None:
    """Return the first rigid contact of a reduced system; no method with steps accepts any."""
    return next((s for s in system.structure.laws if s.law.rigid), None)


def reason_not_in_series(system: ReducedSystem) -> str:
    """Return why the motion of a reduced system has no known power series; empty if it has one."""
    rigid = rigid_contact(system) is not None
    if system.structure.corotational and (rigid or not has_strings(system)):
        return reason_not_linear(system)
    if element := string_on_massless(system):
        return f"the P-Delta force of element {element} acts on a node without mass"
    laws = system.structure.laws
    pressing = {s.element for s in laws if s.law.rigid}
    for s, is_on_massless in zip(laws, laws_on_massless(system)):
        if s.law.curved:
            law = f"the law {s.rule} of element {s.element} is curved"
            smooth, rubs = s.law.rule.smooth_curve is not None, s.role is Role.FRICTION
            if s.law.rule.power_law is None and not smooth and not rubs:
                return law
            if is_on_massless and not smooth and s.role is not Role.DAMPER:
                return f"{law} and meets a node without mass"
            if rubs and s.element in pressing:
                return f"{law} and rubs where a rigid contact presses"
    return ""


def has_strings(system: ReducedSystem) -> bool:
    """Return whether all members that change their stiffness are strings (see `structure.corotational`)."""
    return bool((system.corotational.p[:, KIND] == STRING).all())


def string_on_massless(system: ReducedSystem) -> int:
    """Return the first member whose string moves a massless unknown transversely; 0 for none."""
    members = system.corotational
    across = used_rows(members.rows[ACROSS::QUANTITIES][:, np.flatnonzero(massless(system.mass))])
    return next((c.element for c, moves_massless in zip(members.members, across) if moves_massless), 0)


def laws_on_massless(system: ReducedSystem) -> Flags:
    """Return which laws hold a massless unknown, whose velocity may jump, shape (n_laws,).  The force
    of their dashpots is known only after the velocities are made consistent.
    """
    return used_rows(system.law_rows[:, np.flatnonzero(massless(system.mass))])


def without_steps(system: ReducedSystem) -> list[str]:
    """Return the methods without a time step that accept a reduced system."""
    reasons = {"EXACT": reason_not_linear(system), "TAYLOR": reason_not_in_series(system)}
    return [method for method, why in reasons.items() if not why]


def remedy(system: ReducedSystem) -> str:
    """Return advice for a run with too many changes at one instant."""
    if rigid_contact(system) is not None:
        return "LAWs with a stiffness for the rigid contacts"
    return "NEWMARK EVENTS=STEPPED"  # which passes over the changes


def rounding_check(laws: Sequence[LawSpring], peaks: Peaks, still: float = EVENT_TOLERANCE) -> list[Check]:
    """Check whether springs are so stiff that their force is lost in the last digits of their deformation.
    A fraction `still` of the largest deformation is indistinguishable from zero.
    """
    worst, place = MAX_ROUNDING, None
    for s, d, f in zip(laws, peaks.deformation, peaks.force):
        force = max(abs(f.high), abs(f.low))
        off = still * s.law.p[K] * max(abs(d.high), abs(d.low))
        if not s.role.collides and off > worst * force > 0.0:
            worst, place = off / force, s.element
    if place is None:
        return []
    name = f"share of the force of element {place} that rounding of its deformation makes"
    return [
        beyond(
            Subject.ROUNDING, name, worst, MAX_ROUNDING, "too stiff: its deformation is lost in rounding"
        )
    ]


def between_check(peaks: Peaks) -> Check:
    """Check how far peaks depend on the motion between the steps.  It is interpolated with the rates at
    their ends, so wrong rates give peaks that never occurred.
    """
    remark = "peaks lie far above both ends of a step; a shorter DT shows them"
    return at_most(Subject.STEPS, BETWEEN, peaks.between, MAX_BETWEEN, remark)


def refuse_rigid(problem: Problem[Recorder], method: str) -> None:
    """Raise Stop if a reduced system has rigid contacts that the method does not accept.  No method accepts
    them if the motion has no power series.
    """
    system = problem.system
    rigid = rigid_contact(system)
    if rigid is None:
        return
    contact = f"{rigid.rule} of element {rigid.element}"
    if not (methods := without_steps(system)):
        other = "another GEOMETRY" if system.structure.corotational else "laws that are linear in pieces"
        why = reason_not_in_series(system)
        reason = f"no method takes a rigid contact, which {contact} is, where {why}"
        remedy = f"give the contact a LAW with a stiffness, or choose {other}"
    elif method in ("AUTO", "EXACT", "TAYLOR"):
        return
    else:
        reason = f"{method} knows no rigid contact, and {contact} is one"
        takes = "TAYLOR and EXACT take" if "EXACT" in methods else "TAYLOR takes"
        remedy = f"{takes} it, or a LAW with a stiffness"
    raise Stop("A505", problem.begin, f"{reason}: {remedy}")


def goals(system: ReducedSystem, times: Array) -> tuple[Array, Flags]:
    """Return the times after 0 at which an integrator must arrive, and which of them are output times.

    They come after the first of `times`, the start.  Breaks of the excitation and output times that differ
    only by rounding are merged, so that no interval is extremely short.
    """
    breaks, end = system.excitation.breaks, float(times[-1])
    inner = breaks[(breaks > times[0]) & (breaks < end)]
    near = np.clip(np.searchsorted(times, inner), 1, len(times) - 1)
    apart = np.minimum(np.abs(inner - times[near]), np.abs(inner - times[near - 1])) > 1e-12 * end
    instants = np.unique(np.concatenate([inner[apart], times[1:]]))
    return instants, np.isin(instants, times[1:])
