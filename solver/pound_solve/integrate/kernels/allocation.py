"""The one place where the arrays of the kernels are allocated, from a reduced system and a start."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from pound_solve.integrate.kernels import law_state, state
from pound_solve.integrate.kernels.sparse import Product, Rows
from pound_solve.integrate.kernels.state import Scheme
from pound_solve.integrate.protocol import MonitoredOutputs, Start
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.integrate.tracker import TrackedExtremes
from pound_solve.laws.automaton import EVENTS, Rule
from pound_solve.laws.functions import PARAMETERS, VARIABLES
from pound_solve.numerics import ldl
from pound_solve.numerics.ldl import Positions
from pound_solve.numerics.matrices import Matrix, at, by_rows, dense, entries, is_diagonal
from pound_solve.numerics.memo import by_content
from pound_solve.numerics.modes import massless
from pound_solve.numerics.record import record
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.elements.base import LawSpring, Role
from pound_solve.structure.reduction import ReducedSystem

#: samples, transitions and ties kept between two returns to Python, which cost 2 ms each
SAMPLES, TRANSITIONS, TIES = 1024, 4096, 64
MAX_HELD = 2**20  #: most numbers of one kind in those samples, except that two samples always fit
#: fewest motions of one step, and of whole steps between two returns, that envelopes receive
MIN_MOTIONS = 64
SOLUTION_ROUNDING = 16.0 * float(np.finfo(float).eps)  #: relative error of a force from solving for it
MAX_DELAY = 1e-6  #: longest time e for finding massless velocities, as a fraction of the longest step
FULL_DIAGONAL = 0.25  #: filled fraction above which a diagonal is cheaper to store whole than by entries


class Layout(NamedTuple):
    """The order of elimination, and where a law or a member adds to A.

    Attributes
    ----------
    order : ndarray, shape (n,)
        Unknowns of the reduced system in the order of elimination.
    inverse_order : ndarray, shape (n,)
        Position of each unknown in `order`.
    pattern : Pattern
    column : ndarray, shape (n_entries,)
        Columns of the pattern's entries.
    joins : ndarray of bool, shape (n_laws,)
        Which laws add to A.
    position : mapping
        Position of pairs of unknowns in the pattern; empty if the stiffness is not in A.
    """

    order: Index
    inverse_order: Index
    pattern: ldl.Pattern
    column: Index
    joins: Flags
    position: Mapping[tuple[int, int], int]


def sparse_rows(a: Matrix) -> Rows:
    """Return the rows of a matrix as pointers, columns and values."""
    rows, columns, values = entries(a)
    return Rows(*_rows(rows, np.arange(a.shape[0]), columns, values))


def _rows(rows: Index, wanted: Index, columns: Index, values: Array) -> tuple[Positions, Positions, Array]:
    """Return the entries of some rows, given row by row, as pointers, columns and values."""
    pointers = np.append(np.searchsorted(rows, wanted), len(rows)).astype(np.uint32)
    return pointers, columns.astype(np.uint32), np.ascontiguousarray(values)


def product(a: Matrix) -> Product:
    """Lay a square matrix out for products."""
    n = a.shape[0]
    rows, columns, values = entries(a)
    off = columns - rows
    distinct, number = np.unique(off, return_counts=True)
    full = (number >= FULL_DIAGONAL * n) & (distinct != 0)
    offsets = np.concatenate([[0], distinct[full]]).astype(np.int64)
    diagonals = np.zeros((len(offsets), n))
    for z, offset in enumerate(offsets.tolist()):
        diagonals[z, rows[off == offset] - max(0, -offset)] = values[off == offset]
    rest = ~np.isin(off, offsets)
    row = np.unique(rows[rest])
    return Product(
        offsets, diagonals, row.astype(np.uint32), *_rows(rows[rest], row, columns[rest], values[rest])
    )


def coupled_pairs(touched: Iterable[Index]) -> tuple[Index, Index]:
    """Return all pairs of unknowns that the same law or member touches."""
    nothing, sets = np.zeros(0, np.int64), list(touched)
    return (
        np.concatenate([nothing, *(np.repeat(x, len(x)) for x in sets)]),
        np.concatenate([nothing, *(np.tile(x, len(x)) for x in sets)]),
    )


def layout(system: ReducedSystem, scheme: Scheme) -> Layout:
    """Choose the order of elimination for a method."""
    laws = system.structure.laws
    damps = np.array([s.damps for s in laws], bool)
    in_stiffness, in_damping = scheme.beta > 0.0, scheme.gamma > 0.0
    solved = [system.mass, *[system.damping] * in_damping, *[system.stiffness] * in_stiffness]
    linked = [entries(a)[:2] for a in solved]
    joins = damps & in_damping | in_stiffness
    touched = [row for (row, _), joined in zip(by_rows(system.law_rows), joins) if joined]
    if in_stiffness:
        touched += [columns for columns, _ in system.corotational.touched()]
    linked.append(coupled_pairs(touched))
    first, second = (np.concatenate(part) for part in zip(*linked))
    return laid_out(system.size, first, second, joins)


@by_content(most=8)
def laid_out(n: int, first: Index, second: Index, joins: Flags) -> Layout:
    """Choose the order of elimination of n unknowns from the pairs that are coupled."""
    order = ldl.order(n, first, second)
    inverse_order = np.argsort(order)
    pattern = ldl.analyse(n, inverse_order[first], inverse_order[second])
    column = np.repeat(np.arange(n), np.diff(pattern.ap))
    position = {(int(i), int(j)): q for q, (i, j) in enumerate(zip(pattern.ai, column))}
    return Layout(order, inverse_order, pattern, column, joins, position)


def linear_system(
    system: ReducedSystem, monitored: MonitoredOutputs, layout: Layout, scheme: Scheme, dt: float
) -> state.LinearSystem:
    """Return the linear part of the equations of motion, for steps up to `dt`."""
    o, s, laws = layout.order, system.structure, system.structure.laws
    grid = np.ix_(o, o)
    mass, damping, stiffness = (a[grid] for a in (system.mass, system.damping, system.stiffness))
    in_stiffness, in_damping = scheme.beta > 0.0, scheme.gamma > 0.0
    has_mass = ~massless(mass)
    without = o[~has_mass]
    varying = [columns for columns, _ in system.corotational.touched()]
    varying += [row for (row, _), x in zip(by_rows(system.law_rows), laws) if x.law.curved]
    lower = layout.pattern.ai.astype(np.int64)
    solved = (mass, damping * in_damping, stiffness * in_stiffness)
    moved = system.support_inputs
    free, nf = np.array(system.columns, int)[o], s.n_free
    rate_of, second_of = np.zeros_like(moved), np.zeros_like(moved)
    rate_of[:, 1:], second_of[:, 2:] = moved[:, :-1], moved[:, :-2]
    forces = s.stiffness[nf:, nf:] @ moved + s.damping[nf:, nf:] @ rate_of + s.mass[nf:, nf:] @ second_of
    return state.LinearSystem(
        stiffness=product(stiffness),
        damping=product(damping),
        mass=product(mass),
        inputs=np.ascontiguousarray(system.inputs[o].T),
        nodal_inputs=np.ascontiguousarray(system.force_inputs[free]),
        constant=system.constant[o],
        pattern=layout.pattern,
        on_pattern=np.array([at(a, lower, layout.column) for a in solved]),
        column=layout.column,
        has_mass=has_mass,
        all_mass=bool(has_mass.all()),
        massless_vary=any(len(np.intersect1d(x, without)) for x in varying),
        instant=MAX_DELAY * dt,
        has_stiffness=in_stiffness,
        diagonal=is_diagonal(mass),
        explicit=not (in_stiffness or len(layout.pattern.li) or any(s.damps for s in laws)),
        monitored=sparse_rows(monitored.rows[:, o]),
        monitored_inputs=np.ascontiguousarray(monitored.input_rows),
        monitored_constants=np.ascontiguousarray(monitored.constants),
        reactions=np.array([dense(a[nf:][:, free]) for a in (s.stiffness, s.damping, s.mass)]),
        support_forces=np.ascontiguousarray(forces),
        support_rates=rate_of,
        support_damping=np.ascontiguousarray(dense(s.damping[nf:, nf:])),
    )


def inverse_index(chosen: Index, count: int) -> Index:
    """Return the index of each of `count` things in `chosen`, -1 for the others."""
    place = np.full(count, -1)
    place[chosen] = np.arange(len(chosen))
    return place


def places_in_pattern(rows: Rows, layout: Layout) -> tuple[Positions, Positions, Array]:
    """Return where each law's ``b b^T`` adds to A: pointers, positions in its pattern, products."""
    pairs: list[list[tuple[int, float]]] = [[] for _ in layout.joins]
    for i in np.flatnonzero(layout.joins).tolist():
        span = slice(rows.pointers[i], rows.pointers[i + 1])
        on, values = rows.columns[span].tolist(), rows.values[span].tolist()
        pairs[i] = [
            (layout.position[a, b], x * y) for a, x in zip(on, values) for b, y in zip(on, values) if a >= b
        ]
    return (
        ldl.pointers(pairs),
        np.array([q for p in pairs for q, _ in p], np.uint32),
        np.array([x for p in pairs for _, x in p], float),
    )


def normal_of(laws: Sequence[LawSpring], law: LawSpring) -> tuple[int, int]:
    """Return the law whose force is the normal force of `law` (-1 if none), and a bit for each branch on
    which it is pressed.
    """
    for j, other in enumerate(laws if law.role is Role.FRICTION else ()):
        if (other.element, other.component) == (law.element, law.normal_component):
            return j, sum(b.kind.closed << n for n, b in enumerate(other.law.rule.branches))
    return -1, 0


def rounding_at_rest(system: ReducedSystem, start: Start, d: Array) -> Array:
    r"""Return the rounding errors of the deformations `d` at a start, shape (n_laws,).  A law takes the
    fraction :math:`\epsilon^2` of the strain energy E there, so it moves by :math:`\epsilon\sqrt{2E/k}`,
    whatever the units of its deformation.
    """
    k = np.array([s.steepest for s in system.structure.laws], float)
    doubled = float(np.abs(start.u) @ np.abs(system.stiffness @ start.u) + k @ d**2)
    square: Array = np.divide(doubled, k, out=np.zeros_like(k), where=k > 0.0)
    return SOLUTION_ROUNDING * np.sqrt(square)


def law_arrays(
    system: ReducedSystem, start: Start, layout: Layout, rules: Sequence[Rule], dashpot_losses: Array,
    dt: float,
) -> law_state.Laws:  # fmt: skip
    """Return the laws in the state of a start, for steps up to `dt`, with the losses of an accumulator.
    Their branches are not entered yet (see `laws.enter_branch`).
    """
    laws, count = system.structure.laws, len(system.structure.laws)
    t, value = float(start.times[0]), system.excitation.value
    d = np.asarray(system.law_rows @ start.u + system.law_inputs @ value(t), float)
    v = np.asarray(system.law_rows @ start.v + system.law_inputs @ value(t, 1), float)
    rounding = rounding_at_rest(system, start, d)
    rows = sparse_rows(system.law_rows[:, layout.order])
    pointers, places, values = places_in_pattern(rows, layout)
    normal = np.array([normal_of(laws, s) for s in laws], np.int64).reshape(count, 2).T
    parameters, internal = _law_numbers(laws, start)
    branch, entry, work = (np.array([s[k] for s in start.states]) for k in range(3))
    definition = law_state.LawDefinition(
        rows=rows,
        inputs=np.ascontiguousarray(system.law_inputs),
        pair_pointers=pointers,
        pair_places=places,
        pair_values=values,
        supports=np.ascontiguousarray(dense(system.structure.law_rows[:, system.structure.n_free :])),
        rule=_integers(rules.index(s.law.rule) for s in laws),
        curved=_integers(s.law.curved for s in laws),
        contact=_integers(s.role.collides for s in laws),
        reports_damping=_integers(s.role.reports_damping for s in laws),
        tangent_damping=np.array([s.beta for s in laws], float),
        secant_damping=np.array([s.secant for s in laws], float),
        parameters=parameters,
    )
    friction = law_state.FrictionCoupling(
        coupled=_integers(np.flatnonzero([s.role is Role.FRICTION for s in laws])),
        normal_law=np.ascontiguousarray(normal[0]),
        pressed_branches=np.ascontiguousarray(normal[1]),
        force=np.zeros(count),
        offset_rate=np.zeros(count),
        limits_at_start=np.zeros((count, EVENTS)),
        limit_rates=np.zeros((count, EVENTS)),
        limit_rates_at_start=np.zeros((count, EVENTS)),
    )
    return law_state.Laws(
        definition=definition,
        state=law_state.LawState(
            branch.astype(np.int64), entry.astype(float), work.astype(float), internal, dashpot_losses
        ),
        saved=law_state.SavedState(np.zeros(count, bool), np.zeros((count, 3 + internal.shape[1]))),
        tangent=law_state.LawTangent(np.zeros(count), np.zeros(count), np.zeros(count)),
        events=law_state.BranchEvents(
            np.zeros(count, np.int64), np.zeros((count, EVENTS, 3)), np.full(count, -1, np.int64)
        ),
        friction=friction,
        now=law_state.LawMotion(d, v),
        trial=law_state.LawMotion(np.zeros(count), np.zeros(count)),
        largest=law_state.LawExtremes(
            deformation=np.maximum(np.abs(d), rounding / EVENT_TOLERANCE),
            rate=np.abs(v),
            terms=np.maximum(np.abs(v), rounding / dt / EVENT_TOLERANCE),
        ),
        collision=law_state.CollisionForces(np.zeros(count), np.zeros(count), np.zeros(count)),
    )


def _integers(values: Iterable[int]) -> Index:
    """Return values as an array of integers, which may be empty."""
    return np.array([*values], np.int64)


def _law_numbers(laws: Sequence[LawSpring], start: Start) -> tuple[Array, Array]:
    """Return parameters and internal variables of laws, a row each; those of a secant dashpot come last."""
    parameters, internal = np.zeros((len(laws), PARAMETERS)), np.zeros((len(laws), VARIABLES + 2))
    for i, (s, (_, _, _, variables)) in enumerate(zip(laws, start.states)):
        n = s.law.rule.variables
        parameters[i, : len(s.law.p)], internal[i, :n] = s.law.p, variables[:n]
        if s.secant:
            internal[i, -2:] = variables[n:]
    return parameters, internal


def member_arrays(system: ReducedSystem, layout: Layout, scheme: Scheme) -> state.Corotational:
    """Return the corotational members at rest."""
    members = system.corotational
    count = len(members)
    supports = system.structure.corotational.rows[:, system.structure.n_free :]
    by_member = members.on(layout.order.tolist()).touched()
    touched = [x for x, _ in by_member]
    first = ldl.pointers(touched)
    position = layout.position if scheme.beta > 0.0 else {}
    pairs = [
        [
            (position[i, j], begin + a, begin + b)
            for a, i in enumerate(x)
            for b, j in enumerate(x)
            if (i, j) in position
        ]
        for begin, x in zip(first.tolist(), (x.tolist() for x in touched))
    ]

    def six() -> Array:
        return np.zeros((count, 6))

    return state.Corotational(
        parameters=members.p,
        pointers=first,
        unknown=np.concatenate([*touched, np.zeros(0)]).astype(np.int64),
        rows=np.concatenate([*(rows.T for _, rows in by_member), np.zeros((0, 6))]),
        pair_pointers=ldl.pointers(pairs),
        pair=np.array([x for p in pairs for x in p], np.int64).reshape(-1, 3),
        inputs=np.ascontiguousarray(system.corotational_inputs),
        supports=np.ascontiguousarray(dense(supports)).reshape(count, 6, supports.shape[1]),
        now=state.MemberState(six(), six()),
        trial=state.MemberState(six(), six()),
        predicted=six(),
        at_zero=six(),
        tangent=np.zeros((count, 36)),
        present_tangent=np.zeros((count, 36)),
        product=np.zeros((max((len(x) for x in touched), default=1), 6)),
        largest=np.zeros(1),
    )


def step_arrays(
    system: ReducedSystem,
    start: Start,
    layout: Layout,
    linear: state.LinearSystem,
    extremes: TrackedExtremes,
) -> state.Step:
    """Return the motion of a start, the factor of the mass, and the extremes of a tracker."""
    n, o, t = system.size, layout.order, float(start.times[0])
    inputs = system.inputs.shape[1]
    value = system.excitation.value

    def motion() -> state.MotionState:
        return state.MotionState(*np.zeros((6, n)), *np.zeros((2, inputs)))

    step = state.Step(
        now=motion(),
        trial=motion(),
        residual=np.zeros(n),
        right_side=np.zeros(n),
        marked=np.zeros(n, bool),
        scratch=np.zeros((4, n)),
        row=np.zeros(n),
        matrix=np.zeros(len(layout.column)),
        factors=np.zeros((4, len(layout.pattern.li))),
        pivots=np.zeros((4, n)),
        extremes=extremes,
    )
    step.now.displacement[:], step.now.velocity[:] = start.u[o], start.v[o]
    step.now.damping_force[:] = system.damping[np.ix_(o, o)] @ start.v[o]
    step.now.load[:] = system.inputs[o] @ value(t) + linear.constant
    step.now.inputs[:], step.now.input_rates[:] = value(t), value(t, 1)
    diagonal = layout.pattern.ai == layout.column
    mass = np.where(diagonal & ~linear.has_mass[layout.column], 1.0, linear.on_pattern[state.M_ROW])
    if linear.diagonal:
        step.pivots[state.MASS] = mass[layout.pattern.ap[:-1]]
    else:
        ldl.factor(layout.pattern, mass, step.factors[state.MASS], step.pivots[state.MASS], step.row)
    return step


def buffers(n: int, n_laws: int, unknowns: Index, laws: Index) -> state.Buffers:
    """Allocate room for samples and transitions, and for the motion of some `unknowns` and the forces of
    some `laws` between the samples, which the envelopes need.
    """
    samples = min(SAMPLES, max(MAX_HELD // (3 * max(n, n_laws, 1)), 2))
    log = TRANSITIONS + 16 * n_laws
    # half of it is reserved for the parts of one step that is cut at events
    motions = 2 * max(min(16 * SAMPLES, MAX_HELD // max(3 * len(unknowns) + len(laws), 3)), MIN_MOTIONS)
    u, v, a = np.zeros((3, samples, n))
    force, stored, lost, dashpot = np.zeros((4, samples, n_laws))
    return state.Buffers(
        displacement=u,
        velocity=v,
        acceleration=a,
        force=force,
        stored=stored,
        lost=lost,
        dashpot=dashpot,
        time=np.zeros(samples),
        works=np.zeros((samples, 3)),
        log=np.zeros((log, state.LOG_COLUMNS)),
        ties=np.zeros((TIES, 3, n_laws)),
        tie_time=np.zeros(TIES),
        rests=np.zeros((TIES, 4)),
        enveloped_unknowns=unknowns,
        motion=np.zeros((motions, 3, len(unknowns))),
        motion_time=np.zeros(motions),
        enveloped_laws=laws,
        law_forces=np.zeros((motions, len(laws))),
    )


def run_record(t: float, initial_energy: float) -> state.Run:
    """Return the counters and clocks at the start of a run."""
    run: state.Run = record(state.Run)
    run.time, run.factor_length, run.initial_energy = t, -1.0, initial_energy
    run.longest_part = np.inf
    run.changed_law = run.failed_law = run.failed_unknown = run.lost_force = -1
    run.remaining_step = run.load_jump_time = -1.0
    return run
