r"""Step-by-step integration with events located within the step: what NEWMARK, HHT, GENERALISED_ALPHA
and CENTRAL share.

Lays the reduced system out for the kernels (see `kernel`), lets them run, and takes in what they kept:
samples, changes of branches, peaks.

Energies are integrated from velocities taken as straight lines over a step,
not by the trapezoid rule of the method itself, which would balance for any step, right or wrong.

References
----------
Newmark NM (1959), A method of computation for structural dynamics, J. Engng Mech. Div. ASCE 85(EM3): 67-94;
Chung J, Hulbert GM (1993), A time integration algorithm for structural dynamics with improved numerical
dissipation: the generalized-alpha method, J. Appl. Mech. 60(2): 371-375.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind
from pound_solve.integrate.kernels import corotational
from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels import state as arrays
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    RUNAWAY,
    Collision,
    Extreme,
    LawValues,
    MonitoredOutputs,
    Outcome,
    Peaks,
    Recorder,
    ResponseTracker,
    Start,
    Stop,
    energy_at_start,
    goals,
    not_linear,
    refuse_rigid,
    rounding_check,
)
from pound_solve.integrate.stepping import kernel
from pound_solve.laws import functions
from pound_solve.laws.automaton import BranchKind, State
from pound_solve.laws.hysteresis import bilinear
from pound_solve.numerics import jit, ldl
from pound_solve.numerics.matrices import Matrix, at, by_rows, dense, entries, is_diagonal
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.elements.base import LawSpring, Role
from pound_solve.structure.reduction import ReducedSystem

COMMON = (
    Field("DT", Kind.REAL, "T", above=0, doc="longest time step"),
    Field(
        "EVENTS",
        Kind.WORD,
        default="LOCATED",
        words=("LOCATED", "STEPPED"),
        doc="cut the step where a law changes branch, or let it change at the end of the step",
    ),
)  #: fields of every implicit method

#: samples and changes of branches kept between two visits of Python, which cost 2 ms each
SAMPLES, LOG = 1024, 4096
RESOLVED = 10  #: steps in a period or a collision at least, which gives peaks to a few parts in a hundred
QUIET = 1e-9  #: share of the energy below which a motion is rounding
HELD = 2**20  #: numbers of one kind in those samples, at most, but for two


FULL = 0.25  #: part of a diagonal from which its zeros cost less than naming its entries


def sparse(a: Matrix) -> tuple[Index, ldl.Place, Array]:
    """Rows of a matrix as pointers, columns and values."""
    rows, columns, values = entries(a)
    return _rows(rows, np.arange(a.shape[0]), columns, values)


def _rows(rows: Index, wanted: Index, columns: Index, values: Array) -> tuple[Index, ldl.Place, Array]:
    """The entries of some rows, which come row by row, as pointers, columns and values."""
    pointers = np.append(np.searchsorted(rows, wanted), len(rows)).astype(np.int64)
    return pointers, columns.astype(np.uint32), np.ascontiguousarray(values)


def product(a: Matrix) -> arrays.Product:
    """Lay a square matrix out for products."""
    n = a.shape[0]
    rows, columns, values = entries(a)
    off = columns - rows
    found, number = np.unique(off, return_counts=True)
    offsets = np.concatenate([[0], found[(number >= FULL * n) & (found != 0)]]).astype(np.int64)
    diagonals = np.zeros((len(offsets), n))
    for z, own in enumerate(offsets.tolist()):
        diagonals[z, rows[off == own] - max(0, -own)] = values[off == own]
    rest = ~np.isin(off, offsets)
    row = np.unique(rows[rest])
    return arrays.Product(
        offsets, diagonals, row.astype(np.uint32), *_rows(rows[rest], row, columns[rest], values[rest])
    )


def coupled(touched: Iterable[Index]) -> tuple[Index, Index]:
    """All pairs among the unknowns that each of some laws or members touches."""
    nothing, sets = np.zeros(0, np.int64), list(touched)
    return (
        np.concatenate([nothing, *(np.repeat(x, len(x)) for x in sets)]),
        np.concatenate([nothing, *(np.tile(x, len(x)) for x in sets)]),
    )


def _enough(count: float) -> str:
    """Verdict on a number of steps."""
    return "good" if count >= RESOLVED else f"look: {RESOLVED} at least, by a shorter DT, or EXACT"


class Stepper:
    """One run of a method; see the module's head.

    Parameters
    ----------
    reduced system, start, watch, sink
        See `integrate.base`.
    options : mapping
        DT, the longest step [T]: every interval between output times and record points is divided evenly;
        EVENTS.
    scheme : Scheme
    name : str
        For the report.
    """

    exact = False  #: whether there is no error but rounding

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        recorder: Recorder,
        options: Mapping[str, Any],
        scheme: arrays.Scheme,
        name: str,
    ) -> None:
        refuse_rigid(system, start, name.partition(",")[0])
        self.system, self.monitored, self.recorder = system, monitored, recorder
        self.dt, self.name = options["DT"], name
        self.scheme = scheme._replace(locate=options.get("EVENTS", "LOCATED") == "LOCATED")
        self.laws = system.structure.laws
        self.times = start.times
        self.tracker = ResponseTracker(system, len(monitored.names))
        self.rules = list(dict.fromkeys(s.law.rule for s in self.laws))
        self.tables = functions.tables(
            self.rules or [bilinear.RULE]
        )  # never empty, which compiles to nothing
        self._lay_out(start)
        self.count = np.zeros(12, np.int64)
        self.rush = np.zeros(2)  # v M v and a M a, summed over the samples
        self.seen = float(start.times[0])  # latest instant that the sink was shown
        self.clock = np.array([start.times[0], -1.0, energy_at_start(system, start), np.inf])

    def _lay_out(self, start: Start) -> None:
        system, monitored, laws = self.system, self.monitored, self.laws
        n, count = system.size, len(laws)
        damps = np.array([bool(s.facts.get("c") or s.beta or s.secant) or s.law.curved for s in laws], bool)
        stiff, damped = self.scheme.beta > 0.0, self.scheme.gamma > 0.0
        solved = (system.mass, *[system.damping] * damped, *[system.stiffness] * stiff)
        linked = [entries(a)[:2] for a in solved]
        joined = damps & damped | stiff
        touched = [row for (row, _), joins in zip(by_rows(system.law_rows), joined) if joins]
        if stiff:
            touched += [columns for columns, _ in system.corotational.touched()]
        linked.append(coupled(touched))
        one, other = (np.concatenate(part) for part in zip(*linked))
        self.order = ldl.order(n, one, other)
        o, grid, place = self.order, np.ix_(self.order, self.order), np.argsort(self.order)
        pattern = ldl.analyse(n, place[one], place[other])
        mass, damping, stiffness = (a[grid] for a in (system.mass, system.damping, system.stiffness))
        columns = np.repeat(np.arange(n), np.diff(pattern.ap))
        heavy = ~massless(mass)
        light = o[~heavy]
        bends = [columns for columns, _ in system.corotational.touched()]
        bends += [row for (row, _), x in zip(by_rows(system.law_rows), laws) if x.law.curved]
        lower = pattern.ai.astype(np.int64)
        on_pattern = [at(a, lower, columns) for a in (mass, damping * damped, stiffness * stiff)]
        moved = system.support_inputs
        s = system.structure
        free = np.array(system.columns, int)[o]
        nf = s.n_free
        rate_of, bend_of = np.zeros_like(moved), np.zeros_like(moved)
        rate_of[:, 1:], bend_of[:, 2:] = moved[:, :-1], moved[:, :-2]
        self.matrices = arrays.Matrices(
            k=product(stiffness),
            c=product(damping),
            m=product(mass),
            inputs=np.ascontiguousarray(system.inputs[o].T),
            pushed=np.ascontiguousarray(system.force_inputs[free]),
            constant=system.constant[o],
            pattern=pattern,
            a=np.array(on_pattern),
            column=columns,
            heavy=heavy,
            inert=bool(heavy.all()),
            shifts=any(len(np.intersect1d(x, light)) for x in bends),
            instant=arrays.INSTANT * self.dt,
            implicit=stiff,
            diagonal=is_diagonal(mass),
            explicit=not (stiff or len(pattern.li) or damps.any()),
            rows=sparse(monitored.rows[:, o]),
            row_inputs=np.ascontiguousarray(monitored.input_rows),
            row_constants=np.ascontiguousarray(monitored.constants),
            reactions=np.array([dense(a[nf:][:, free]) for a in (s.stiffness, s.damping, s.mass)]),
            supports=np.array(
                [
                    s.stiffness[nf:, nf:] @ moved
                    + s.damping[nf:, nf:] @ rate_of
                    + s.mass[nf:, nf:] @ bend_of,
                    rate_of,
                ]
            ),
            support_c=np.ascontiguousarray(dense(s.damping[nf:, nf:])),
        )
        rows = sparse(system.law_rows[:, o])
        position = {(int(i), int(j)): q for q, (i, j) in enumerate(zip(pattern.ai, columns))}
        pairs: list[list[tuple[int, float]]] = [[] for _ in laws]
        for i in range(count):
            if not joined[i]:
                continue
            span = range(rows[0][i], rows[0][i + 1])
            on, own = [int(rows[1][q]) for q in span], [float(rows[2][q]) for q in span]
            pairs[i] = [
                (position[on[a], on[b]], own[a] * own[b])
                for a in range(len(on))
                for b in range(len(on))
                if on[a] >= on[b]
            ]
        t, inputs = float(start.times[0]), system.excitation.value
        d = system.law_rows @ start.u + system.law_inputs @ inputs(t)
        v = system.law_rows @ start.v + system.law_inputs @ inputs(t, 1)
        self.w = w = arrays.Laws(
            rows=rows,
            inputs=np.ascontiguousarray(system.law_inputs),
            pairs=(
                np.concatenate([[0], np.cumsum([len(p) for p in pairs])]).astype(np.int64),
                np.array([q for p in pairs for q, _ in p], np.uint32),
                np.array([x for p in pairs for _, x in p], float),
            ),
            supports=np.ascontiguousarray(dense(s.law_rows[:, nf:])),
            p=np.zeros((count, functions.PARAMETERS)),
            memory=np.zeros((count, functions.VARIABLES + 2)),
            f=np.zeros((count, 27)),
            i=np.zeros((count, 9), np.int64),
            saved=np.zeros((count, 5 + functions.VARIABLES)),
            leans=np.flatnonzero([s.role is Role.FRICTION for s in laws]).astype(np.int64),
            corotational=self._turning(position if stiff else {}),
        )
        for i, (law, state) in enumerate(zip(laws, start.states)):
            w.i[i, :4] = self.rules.index(law.law.rule), law.law.curved, law.role.collides, state[0]
            w.f[i, [arrays.D0, arrays.WORK, arrays.BETA]] = state[1], state[2], law.beta
            w.f[i, [arrays.LD, arrays.LV]] = d[i], v[i]
            ruled = law.law.rule.variables  # of a secant law two more follow
            w.p[i, : len(law.law.p)], w.memory[i, :ruled] = law.law.p, state[3][:ruled]
            w.f[i, arrays.SECANT] = law.secant
            w.memory[i, arrays.TURN : arrays.TURN + len(state[3]) - ruled] = state[3][ruled:]
            w.f[i, [arrays.MOST_D, arrays.MOST_V]] = abs(d[i]), abs(v[i])
            w.i[i, [arrays.NORMAL, arrays.PRESSED]] = self._leans_on(law)
            w.i[i, arrays.VISCOUS] = law.role.viscous
        self.x = x = arrays.Motion(
            np.zeros((19, n)),
            np.zeros((4, len(pattern.li))),
            np.zeros(len(columns)),
            np.zeros((7, len(monitored.names) + 2 * count)),
            np.zeros(4),
            np.zeros((4, system.inputs.shape[1])),
        )
        x.q[arrays.U], x.q[arrays.V] = start.u[o], start.v[o]
        x.q[arrays.CV] = damping @ start.v[o]
        x.works[:3] = start.works
        x.peak[arrays.HIGH], x.peak[arrays.LOW] = -np.inf, np.inf
        padded = np.where((pattern.ai == columns) & ~heavy[columns], 1.0, on_pattern[0])
        if self.matrices.diagonal:
            x.q[arrays.D + arrays.MASS] = padded[pattern.ap[:-1]]
        else:
            ldl.factor(pattern, padded, x.l, arrays.MASS, x.q, arrays.D + arrays.MASS, arrays.W)
        samples = min(SAMPLES, max(HELD // (3 * max((1 + arrays.SHOWS) * n, count, 1)), 2))
        which = place[np.flatnonzero(self.recorder.shown)]
        shown = max(samples * arrays.SHOWS, min(16 * SAMPLES, HELD // (3 * max(len(which), 1))))
        self.z = arrays.Samples(
            np.zeros((samples, 3, n)),
            np.zeros((samples, 3, count)),
            np.zeros((samples, 4)),
            np.zeros((LOG + 16 * count, arrays.COLUMNS)),
            which,
            np.zeros((shown, 3, len(which))),
            np.zeros(shown),
        )
        for i in range(count):
            law_kernels.enter(w, self.tables, i)
            if w.i[i, arrays.CURVED]:
                law_kernels.tangent(w, self.tables, i)
        corotational.turn_start(w, x, inputs(t))
        corotational.linearise(w.corotational, arrays.S0)

    def _leans_on(self, law: LawSpring) -> tuple[int, int]:
        """Law that this one leans on, and a bit for each branch where that one is pressed; -1 if none."""
        for j, other in enumerate(self.laws if law.role is Role.FRICTION else ()):
            if (other.element, other.component) == (law.element, law.normal_component):
                return j, sum(b.kind.closed << n for n, b in enumerate(other.law.rule.branches))
        return -1, 0

    def _turning(self, position: Mapping[tuple[int, int], int]) -> arrays.Turning:
        """The members' chords; `position` of pairs of unknowns in A, none if that needs no stiffness."""
        system, corotational = self.system, self.system.corotational
        whole = system.structure.corotational.rows[:, system.structure.n_free :]
        found = corotational.on(self.order.tolist()).touched()
        touched = [x for x, _ in found]
        at = np.concatenate([[0], np.cumsum([len(x) for x in touched])]).astype(np.int64)
        pairs = [
            [
                (position[i, j], first + a, first + b)
                for a, i in enumerate(x)
                for b, j in enumerate(x)
                if (i, j) in position
            ]
            for first, x in zip(at.tolist(), (x.tolist() for x in touched))
        ]
        return arrays.Turning(
            p=corotational.p,
            at=at,
            unknown=np.concatenate([*touched, np.zeros(0)]).astype(np.int64),
            rows=np.concatenate([*(rows.T for _, rows in found), np.zeros((0, 6))]),
            pairs=np.concatenate([[0], np.cumsum([len(x) for x in pairs])]).astype(np.int64),
            pair=np.array([x for p in pairs for x in p], np.int64).reshape(-1, 3),
            inputs=np.ascontiguousarray(system.corotational_inputs),
            supports=dense(whole).reshape(len(corotational), 6, whole.shape[1]),
            s=np.zeros((len(corotational), 36)),
            h=np.zeros((2 * len(corotational), 36)),
            product=np.zeros((max((len(x) for x in touched), default=1), 6)),
            most=np.zeros(1),
        )

    def _force(self, t: float) -> Array:
        """Loads on the unknowns, in the order of elimination."""
        return self.system.inputs[self.order] @ self.system.excitation.value(t) + self.matrices.constant

    def run(self) -> Outcome:
        """Integrate to the last output time.

        Raises
        ------
        Stop
            Too many changes within one step, a step that finds no solution, numbers beyond all bounds,
            or an interrupt.
        """
        try:
            return self._run()
        except KeyboardInterrupt:
            raise self.stop("A506", INTERRUPTED) from None

    def _begin(self, advance: jit.Function) -> None:
        """Take the first sample, before a kernel advances."""
        m, w, x, z, system = self.matrices, self.w, self.x, self.z, self.system
        turns = next((s for s in self.laws if s.role in (Role.FRICTION, Role.DAMPER)), None)
        if turns is not None and not self.scheme.locate:
            what = "friction" if turns.role is Role.FRICTION else "a fluid damper"
            raise self.stop("A505", f"{what} (element {turns.element}) needs steps with EVENTS=LOCATED")
        t0 = float(self.times[0])
        for i, s in enumerate(self.laws):
            kind = s.law.rule.branches[w.i[i, arrays.AT]].kind
            if s.role.collides and kind.closed:
                d, v = w.f[i, [arrays.LD, arrays.LV]].tolist()
                force = law_kernels.law_force(w, self.tables, i, d, v)
                self.tracker.switched(i, BranchKind.OPEN, kind, t0, d, v, force)
                w.f[i, arrays.PEAK] = force
        x.q[arrays.P] = self._force(t0)
        x.inputs[:2] = system.excitation.value(t0), system.excitation.value(t0, 1)
        for i in w.leans.tolist():
            law_kernels.grip(w, self.tables, x.q, i)
        if jit.cold(advance):
            self.recorder.trial(t0, "compiling the kernels, once for this version: some 40 s")
        with jit.compiling():
            jit.compiled(kernel.settle)(m, w, x)
        kernel.note(m, w, x, t0, 0.0)
        kernel.sample(w, x, z, self.tables, self.count, t0)

    def _run(self) -> Outcome:
        self._begin(kernel.advance)
        m, w, x, z, system = self.matrices, self.w, self.x, self.z, self.system
        t0 = float(self.times[0])
        ends, is_output = goals(system, self.times)
        lengths = np.diff(ends, prepend=t0)
        steps = np.maximum(1, np.ceil(lengths / self.dt * (1 - 1e-9))).astype(np.int64)
        # twelve digits: steps of equal length share their factor, whatever the rounding of the times
        h = np.array([float(f"{x:.12e}") for x in lengths / steps])
        # steps from one output to the next, of which so many are shown to the envelopes
        output = np.concatenate([[0], np.cumsum(is_output)[:-1]])
        shows = -(-np.bincount(output, steps).astype(np.int64) // (arrays.SHOWS + 1))[output]
        ex = system.excitation
        pieces = ex.pieces_after(ends - lengths)
        coefs = np.ascontiguousarray(ex.coefs)
        self._loop(
            kernel.advance, m, w, x, z, self.tables, self.scheme, coefs, ex.breaks, ends, steps, h,
            is_output, shows, pieces, self.count, self.clock,
        )  # fmt: skip
        return self.outcome()

    def _loop(self, advance: jit.Function, *given: Any) -> None:
        """Let a kernel advance to the end, and take in what it keeps."""
        compiled = jit.compiled(advance)
        while True:
            with np.errstate(all="ignore"), jit.compiling():  # a runaway is told in words
                why = compiled(*given)
            self._fetch()
            if why == arrays.DONE:
                return
            if why != arrays.FULL:
                raise self._trouble(why)

    def _fetch(self) -> None:
        """Take in the samples and the changes of branches that were kept."""
        z, count, laws = self.z, self.count, self.laws
        back = np.argsort(self.order)
        for row in z.log[: count[arrays.LOGGED]].tolist():
            law, before, after = (int(x) for x in row[:3])
            branches = laws[law].law.rule.branches
            if law in self.tracker.open:
                self._count(self.tracker.open[law], row[7:])
            self.tracker.switched(law, branches[before].kind, branches[after].kind, *row[3:7])
        shown, kept = count[arrays.SHOWN], count[arrays.KEPT]
        if shown:
            seen = np.sort(np.concatenate([[self.seen], z.when[:shown], z.works[:kept, 0]]))
            u, v, a = motion = np.zeros((3, len(back), shown))
            motion[:, self.order[z.which]] = z.shown[:shown].transpose(1, 2, 0)
            self.recorder.between(z.when[:shown].copy(), u, v, a, float(np.diff(seen).max()))
            self.seen = seen[-1]
        if kept:
            t, *works = z.works[:kept].T.copy()
            u, v, a = z.motion[:kept, :, back].transpose(1, 2, 0)
            self.rush += (v * (self.system.mass @ v)).sum(), (a * (self.system.mass @ a)).sum()
            values = LawValues(*z.laws[:kept].transpose(1, 2, 0).copy())
            self.recorder.sample(t, u, v, a, values, np.array(works))
        count[arrays.LOGGED] = count[arrays.KEPT] = count[arrays.SHOWN] = 0

    @staticmethod
    def _count(collision: Collision, running: list[float]) -> None:
        """Count what a contact went through on one branch into its collision."""
        peak, t_peak, impulse = running
        collision.impulse += impulse
        if peak > collision.peak:
            collision.peak, collision.t_peak = peak, t_peak

    def _trouble(self, why: int) -> Stop:
        worst = int(self.count[arrays.WORST])
        if why == arrays.RUNAWAY:
            fastest = int(self.order[np.argmax(np.abs(self.x.q[arrays.V]))])
            name = self.system.name(fastest)
            cause = f", fastest at {name}: the structure collapses, or DT={self.dt:g} is too long"
            return self.stop("A504", RUNAWAY.format(self.clock[2]) + cause)
        if why == arrays.PIVOT:
            name = self.system.name(int(self.order[worst]))
            return self.stop("A501", f"{name} has no mass and nothing holds it")
        place, last = "the members' turning", ""
        if worst >= 0:
            s = self.laws[worst]
            place = f"element {s.element} ({s.rule})"
            last = f"the last in {place} to {s.law.rule.branches[self.w.i[worst, arrays.AT]].name!r}"
        if why == arrays.CHATTER:
            told = f"laws change branch again and again at one instant, {last}"
        elif why == arrays.CROWD:
            told = f"laws change branch more than {len(self.z.log) // 2} times within one step, {last}"
        else:
            told = f"Newton's iterations find no equilibrium of {place}, however short the step"
        exact = "" if not_linear(self.system) else ", or METHOD=EXACT"
        return self.stop("A503", f"{told}; try a DT well below {self.dt:g}{exact}")

    def outcome(self) -> Outcome:
        """What the run gathered."""
        for law, collision in self.tracker.open.items():
            self._count(collision, self.w.f[law, arrays.PEAK : arrays.IMPULSE + 1].tolist())
        peaks, x, n = self.tracker.close(), self.x, len(self.laws)
        found = [Extreme(*e) for e in x.peak[: arrays.SLOPE].T.tolist()]
        rest = len(found) - 2 * n
        peaks.monitored, peaks.deformation, peaks.force = (
            found[:rest],
            found[rest : rest + n],
            found[rest + n :],
        )
        peaks.dashpot_losses = self.w.f[:, arrays.DASHPOT].tolist()
        states = tuple(self._state(i) for i in range(n))
        return Outcome(peaks, self._figures(), states, self._checks(peaks), self.exact)

    def _state(self, i: int) -> State:
        """State of law `i`."""
        w, spring = self.w, self.laws[i]
        memory = w.memory[i, : spring.law.rule.variables].tolist()
        if spring.secant:
            memory += w.memory[i, [arrays.TURN, arrays.STIFFNESS]].tolist()
        d0, work = w.f[i, [arrays.D0, arrays.WORK]].tolist()
        return int(w.i[i, arrays.AT]), d0, work, tuple(memory)

    def _figures(self) -> dict[str, Any]:
        """What the report tells of the run."""
        return {
            "method": self.name,
            "time step": f"{self.dt:.6g}",
            "steps": int(self.count[arrays.STEPS]),
            "events": int(self.count[arrays.EVENTS]),
        }

    def _checks(self, peaks: Peaks) -> list[tuple[str, str, str]]:
        """Whether the steps resolve the motion, and the hardest collision of every contact.

        Newmark's energy balances in free vibration however long the step; so the period is taken from the
        ratio of velocities to accelerations.
        """
        speed, rush = self.rush.tolist()
        moves = speed > QUIET * (float(self.clock[2]) + float(self.x.works[3]))
        out = []
        if moves and rush > 0.0:
            count = 2.0 * np.pi * (speed / rush) ** 0.5 / self.dt
            out.append(("steps in a period of the motion, about", f"{count:.3g}", _enough(count)))
        if falls := int(self.count[arrays.FALLING]):
            told = "look: a DT that follows how it gives way, or EXACT"
            out.append(("steps too long for a branch that falls", str(falls), told))
        out += [*self._springs(peaks), *rounding_check(self.laws, peaks)]
        ended = [c for c in peaks.collisions if c.t_end > c.t_start]
        hardest = [
            max((c for c in ended if c.law == law), key=lambda c: c.peak) for law in {c.law for c in ended}
        ]
        if hardest:
            count = min(c.t_end - c.t_start for c in hardest) / self.dt
            out.append(("steps in the hardest collision of a contact", f"{count:.3g}", _enough(count)))
        return out

    def _springs(self, peaks: Peaks) -> list[tuple[str, str, str]]:
        """Whether the steps follow the springs' forces."""
        steepest = self.x.peak[arrays.STEEPEST, len(self.x.peak[0]) - len(self.laws) :].tolist()
        rises = [
            max(abs(f.high), abs(f.low)) / (slope * self.dt)
            for s, f, slope in zip(self.laws, peaks.force, steepest)
            if not s.role.viscous and slope > 0.0
        ]
        count = min(rises, default=np.inf)
        if count >= 1.0:
            return []
        told = "look: 1 at least, by a shorter DT, or EXACT"
        return [("steps in which a spring's force rises to its largest", f"{count:.2g}", told)]

    def stop(self, code: str, why: str) -> Stop:
        """The exception that ends the run here."""
        return Stop(code, float(self.clock[0]), why, self.outcome())
