"""What every integrator is given, tells and may raise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from pound_solve.laws.automaton import Branch, BranchKind, State
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.reduction import ReducedSystem

ENERGIES = ("input", "kinetic", "strain", "damping", "hysteretic", "contact")


STILL = 1e-12  #: share of its largest value below which an exit counts as not reached
SHARP = 1e-2  #: share of a spring's largest force that rounding may make
RUNAWAY = "the motion grows without bound: its energy {:.3g} is far above what was put in"
CHATTER = "{} changes at one instant, the last in element {} ({}) to {!r}: try {}"
STEPPED = "NEWMARK EVENTS=STEPPED"  #: which passes over them
INTERRUPTED = "interrupted by the user; what was computed up to then is kept"


@dataclass(frozen=True)
class MonitoredOutputs:
    """Quantities whose peaks an integrator finds, linear in u: drifts.

    Attributes
    ----------
    names : sequence of str
    rows : ndarray, shape (n_watch, n)
    input_rows : ndarray, shape (n_watch, n_inputs)
    constants : ndarray, shape (n_watch,)
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


@dataclass
class Extreme:
    """Largest and smallest value of a quantity and their times."""

    high: float = -np.inf
    t_high: float = 0.0
    low: float = np.inf
    t_low: float = 0.0

    def take(self, value: float, t: float) -> None:
        """Count a value in."""
        if value > self.high:
            self.high, self.t_high = value, t
        if value < self.low:
            self.low, self.t_low = value, t


@dataclass
class Collision:
    """One closure of a contact."""

    law: int
    t_start: float
    approach: float
    t_end: float = np.nan
    separation: float = np.nan
    peak: float = 0.0
    t_peak: float = 0.0
    impulse: float = 0.0


@dataclass
class Peaks:
    """What an integrator gathers on its way, beyond the samples it hands out.

    Attributes
    ----------
    monitored : list of Extreme
        Of the Watch.
    deformation, force : list of Extreme
        Of every law; for contacts the closure and the force (compression positive).
    collisions : list of Collision
        Ended ones in order of their end, those still closed last.
    yields : list of int
        Yield events per law.
    dashpot_losses : list of float
        Energy lost in the dashpot of every law (contacts) [F L].
    """

    monitored: list[Extreme]
    deformation: list[Extreme]
    force: list[Extreme]
    yields: list[int]
    dashpot_losses: list[float]
    collisions: list[Collision] = field(default_factory=list)


class Peak(Protocol):
    """Something that keeps extremes, as `Extreme`."""

    @property
    def high(self) -> float:
        """Largest value so far."""
        ...

    @property
    def low(self) -> float:
        """Smallest value so far."""
        ...

    def take(self, value: float, t: float) -> None:
        """Count a value in."""
        ...


class LawValues(NamedTuple):
    """Forces [F] or [F L], recoverable and lost energies [F L] of all laws, shape (n_laws, n_times)."""

    force: Array
    stored: Array
    lost: Array


def law_values(system: ReducedSystem, t: Array, u: Array, v: Array, states: Sequence[State]) -> LawValues:
    """Forces and energies of all laws from their states, at times (n_times,) and motions (n, n_times)
    between two changes of branch.
    """
    laws = [s.law for s in system.structure.laws]
    if not laws:
        return LawValues(*np.zeros((3, 0, len(t))))
    d = system.law_rows @ u + system.law_inputs @ system.excitation.values(t).T
    rate = system.law_rows @ v + system.law_inputs @ system.excitation.values(t, 1).T
    # `Law.work` and `Law.dissipated` of all laws and times at once: a sample of some laws is a small thing
    k, c, f0 = np.array([x.rule.branch(x.p, s[0], s[3])[:3] for x, s in zip(laws, states)]).T[:, :, None]
    begin, before = np.array([s[1:3] for s in states]).T[:, :, None]
    still = k * d + f0
    done = before + (0.5 * k * (d + begin) + f0) * (d - begin)
    force = still + c * rate * np.array([[s.role.viscous] for s in system.structure.laws])
    for i, s in enumerate(system.structure.laws):
        if s.law.curved:
            own = d[i].tolist()
            still[i] = [s.law.force(states[i], x)[0] for x in own]
            done[i] = [s.law.work(states[i], x) for x in own]
            force[i] = [s.force(states[i], x, y) for x, y in zip(own, rate[i].tolist())]
    stored = np.array(
        [
            [x.rule.recoverable(x.p, s[0], s[3], y, f) for y, f in zip(*pair)]
            for x, s, *pair in zip(laws, states, d.tolist(), still.tolist())
        ]
    )
    size = np.array([[x.p[0]] for x in laws]) * np.maximum(np.abs(d), np.abs(begin)) ** 2
    lost = done - stored
    return LawValues(force, stored, np.where(np.abs(lost) > 1e-14 * size, lost, 0.0))


class Envelopes(Protocol):
    """Envelopes of a run."""

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Count in the motion at some times, as `Recorder.between`."""
        ...

    def stationary(self, t: Array, u: Array) -> None:
        """Count in displacements that turn between those instants."""
        ...

    def blank(self) -> Self:
        """Return one that has seen nothing."""
        ...

    def widen(self, other: Self) -> None:
        """Count in what another one has seen."""
        ...


class Recorder(Protocol):
    """Takes the samples of a history."""

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` looks at, shape (n,)."""
        ...

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take the motion (n, n_times) and the laws' forces and energies at some output times.

        `works`, shape (3, n_times), are the work put in, and that lost so far in the structure's
        and in the contacts' dashpots.
        """
        ...

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Take the motion at times between the samples, shapes (n_times,), (n, n_times): for envelopes.
        Only that of the unknowns in `shown` need be right.

        `apart` is the longest time from one instant that is seen to the next.
        """
        ...

    def stationary(self, t: Array, u: Array) -> None:
        """Take displacements at instants at which some of them turn, shapes as in `between`."""
        ...

    def trial(self, t: float, doing: str = "") -> None:
        """Be told the time reached by a run whose samples may not count, or what keeps it waiting there."""
        ...


class EnvelopeRecorder(Recorder, Protocol):
    """A sink that keeps envelopes, and takes samples of a run that is over."""

    def keep(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples, as `sample` does, whose progress was told before."""
        ...

    @property
    def envelopes(self) -> Envelopes:
        """What it has seen between the samples, and may be at them."""
        ...


@dataclass
class Outcome:
    """How an integration went: its peaks, whether they are exact, figures, self-checks;
    the laws' states at its end; whether it told the sink of the instants at which displacements turn.
    """

    peaks: Peaks
    figures: dict[str, Any]
    states: tuple[State, ...]
    checks: list[tuple[str, str, str]] = field(default_factory=list)
    exact: bool = False
    turns: bool = False


class Stop(Exception):
    """The integration cannot go on; says when, where and why.

    Attributes
    ----------
    code : str
        Message number.
    t : float
        Time reached [T].
    outcome : Outcome
        What was gathered up to then.
    """

    def __init__(self, code: str, t: float, why: str, outcome: Outcome | None = None) -> None:
        super().__init__(why)
        self.code, self.t, self.outcome = code, t, outcome


def not_linear(system: ReducedSystem) -> str:
    """Reason why a reduced system is not linear between events, as some methods need; empty where it is."""
    if system.structure.corotational:
        return f"members change their stiffness as they move (GEOMETRY {system.structure.model.geometry})"
    curved = next((s for s in system.structure.laws if s.law.curved), None)
    return "" if curved is None else f"the law {curved.rule} of element {curved.element} is curved"


def light(system: ReducedSystem) -> Flags:
    """Which laws hold an unknown without mass, whose velocity may jump, shape (n_laws,): the force of their
    dashpots is only known when the velocities have settled.
    """
    return np.asarray((system.law_rows[:, massless(system.mass)] != 0.0).any(axis=1))


def rounding_check(
    laws: Sequence[LawSpring], peaks: Peaks, still: float = STILL
) -> list[tuple[str, str, str]]:
    """Check whether springs are so stiff that their force is lost in the last digits of their deformation,
    of which a share `still` of the largest cannot be told from none.
    """
    worst, place = SHARP, None
    for s, d, f in zip(laws, peaks.deformation, peaks.force):
        force = max(abs(f.high), abs(f.low))
        off = still * s.law.p[0] * max(abs(d.high), abs(d.low))
        if not s.role.collides and off > worst * force > 0.0:
            worst, place = off / force, s.element
    if place is None:
        return []
    name = f"share of the force of element {place} that rounding of its deformation makes"
    return [(name, f"{worst:.1e}", "look: too stiff for the distance that it gives way")]


def refuse_rigid(system: ReducedSystem, start: Start, method: str) -> None:
    """Raise Stop where a reduced system has rigid contacts and the method knows none, or none where the
    reduced system is not linear between events: that no method does.
    """
    rigid = next((s for s in system.structure.laws if s.law.rigid), None)
    if rigid is None:
        return
    contact = f"{rigid.rule} of element {rigid.element}"
    if why := not_linear(system):
        other = "another GEOMETRY" if system.structure.corotational else "laws that are linear in pieces"
        told = f"no method takes a rigid contact, which {contact} is, where {why}"
        cure = f"give the contact a LAW with a stiffness, or choose {other}"
    else:
        told = f"{method} knows no rigid contact, and {contact} is one"
        cure = "EXACT takes it, or a LAW with a stiffness"
    raise Stop("A505", float(start.times[0]), f"{told}: {cure}")


class ResponseTracker:
    """Collisions, yield events and extremes of the laws while a run goes on; shared by all methods."""

    def __init__(self, system: ReducedSystem, n_watch: int) -> None:
        self.laws = system.structure.laws
        n = len(self.laws)
        self.peaks = Peaks(
            [Extreme() for _ in range(n_watch)],
            [Extreme() for _ in range(n)],
            [Extreme() for _ in range(n)],
            [0] * n,
            [0.0] * n,
        )
        self.open: dict[int, Collision] = {}

    def begin(
        self, system: ReducedSystem, t: float, u: Array, v: Array, branches: Sequence[Branch]
    ) -> None:
        """Note the contacts that are closed at the start."""
        ex = system.excitation
        d = system.law_rows @ u + system.law_inputs @ ex.value(t)
        rate = system.law_rows @ v + system.law_inputs @ ex.value(t, 1)
        for i, (s, b) in enumerate(zip(self.laws, branches)):
            if s.role.collides and b.kind.closed:
                x, y = float(d[i]), float(rate[i])
                self.switched(i, BranchKind.OPEN, b.kind, t, x, y, b.force(x, y))

    def switched(
        self,
        law: int,
        before: BranchKind,
        after: BranchKind,
        t: float,
        d: float,
        v: float,
        force_after: float,
    ) -> None:
        """Note that a law went from a branch of a kind to one of another at deformation `d`, rate `v`."""
        if not self.laws[law].role.collides:
            if after is BranchKind.YIELDING and before is not BranchKind.YIELDING:
                self.peaks.yields[law] += 1
            return
        was, now = before.closed, after.closed
        ended = self._last_ended(law) if before is BranchKind.RELEASED and now else None
        if ended is not None:
            # the bodies never parted: the collision goes on
            again = self.peaks.collisions.pop(ended)
            again.t_end = again.separation = np.nan
            self.open[law] = again
        elif now and not was and law not in self.open:
            self.open[law] = Collision(law, t, v, peak=force_after, t_peak=t)
        elif was and not now and law in self.open:
            done = self.open.pop(law)
            done.t_end, done.separation = t, -v
            self.peaks.collisions.append(done)

    def _last_ended(self, law: int) -> int | None:
        """Place of the contact's last collision; it is seldom far from the end of the list."""
        collisions = self.peaks.collisions
        return next((i for i in reversed(range(len(collisions))) if collisions[i].law == law), None)

    def force(self, law: int, value: float, t: float) -> None:
        """Count a contact force into its collision."""
        collision = self.open.get(law)
        if collision is not None and value > collision.peak:
            collision.peak, collision.t_peak = value, t

    def running(self, law: int) -> Peak:
        """Keeper of the largest force in the contact's present collision."""
        return _Running(self, law)

    def close(self) -> Peaks:
        """Return all peaks; contacts still closed come last."""
        self.peaks.collisions += [self.open[i] for i in sorted(self.open)]
        self.open = {}
        return self.peaks


class _Running:
    """Feeds a contact's force into its running collision; only the largest counts."""

    low = -np.inf

    def __init__(self, tracker: ResponseTracker, law: int) -> None:
        self.tracker, self.law = tracker, law

    @property
    def high(self) -> float:
        return self.tracker.open[self.law].peak

    def take(self, value: float, t: float) -> None:
        self.tracker.force(self.law, value, t)


def goals(system: ReducedSystem, times: Array) -> tuple[Array, Flags]:
    """Return the times after 0 at which an integrator must arrive, and which of them are output times.

    They come after the first of `times`, the start.
    Breaks of the excitation and output times that differ by rounding only are one: no interval is a sliver.
    """
    breaks, end = system.excitation.breaks, float(times[-1])
    inner = breaks[(breaks > times[0]) & (breaks < end)]
    near = np.clip(np.searchsorted(times, inner), 1, len(times) - 1)
    apart = np.minimum(np.abs(inner - times[near]), np.abs(inner - times[near - 1])) > 1e-12 * end
    out = np.unique(np.concatenate([inner[apart], times[1:]]))
    return out, np.isin(out, times[1:])


def energies(
    system: ReducedSystem, t: Array, u: Array, v: Array, stored: Array, lost: Array, works: Array
) -> Array:
    """Return all energies at some times.

    Parameters
    ----------
    system : ReducedSystem
    t : ndarray, shape (n_times,)
    u, v : ndarray, shape (n_times, n)
    stored, lost : ndarray, shape (n_times, n_laws)
        What the laws hold and have lost.
    works : ndarray, shape (n_times, 3)

    Returns
    -------
    ndarray, shape (n_times, 6)
        In the order of `ENERGIES` [F L].
    """
    mass, stiffness, turning = system.mass, system.stiffness, np.zeros(len(t))
    if system.corotational:
        turning = system.corotational.actions(system.quantities(u, system.excitation.values(t)))[
            :, :, 0
        ].sum(axis=1)
    if system.total:  # moved supports have mass and stretch elements too
        mass, stiffness = system.structure.mass, system.structure.stiffness
        u = system.expanded(u.T, system.excitation.values(t).T).T
        v = system.expanded(v.T, system.excitation.values(t, 1).T, 1).T
    contact = np.array([s.role.contact_energy for s in system.structure.laws], bool)
    out = np.zeros((len(t), len(ENERGIES)))
    out[:, 0], out[:, 3], out[:, 5] = works.T
    out[:, 1] = 0.5 * (v * (v @ mass)).sum(axis=1)
    out[:, 2] = 0.5 * (u * (u @ stiffness)).sum(axis=1) + stored.sum(axis=1) + turning
    out[:, 4] = lost[:, ~contact].sum(axis=1)
    out[:, 5] += lost[:, contact].sum(axis=1)
    return out


def energy_at_start(system: ReducedSystem, start: Start) -> float:
    """Kinetic and recoverable energy [F L]: with the work put in since, all that the motion can hold."""
    t, u, v = start.times[:1], start.u, start.v
    laws = law_values(system, t, u[:, None], v[:, None], start.states)
    whole = energies(system, t, u[None], v[None], laws.stored.T, laws.lost.T, np.zeros((1, 3)))
    return float(whole[0, 1] + whole[0, 2])
