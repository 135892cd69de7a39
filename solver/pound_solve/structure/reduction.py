r"""The reduced system: what this deck needs of the structure, and why the rest is left out.

DOFs that nothing can set in motion are dropped, and what is left is written as

.. math:: M\ddot u + C\dot u + K u + \sum_i b_i f_i(d_i, \dot d_i) = F s(t) + p_0, \qquad
          d_i = b_i^T u + e_i^T s(t)

with the laws' forces :math:`f_i`, the inputs :math:`s(t)` (ground accelerations, or displacement,
velocity and acceleration of moved supports; histories of forces) and constant loads :math:`p_0`.

Massless DOFs that only linear elements touch can be condensed besides: few unknowns, but full matrices,
which suits EXACT.  Stepping methods keep them, and with them the sparse matrices.

With one motion for the whole base the displacements are relative to the ground;
with motions of SUPPORTS they are total.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import Motion, Piecewise, common_breaks
from pound_solve.numerics import polynomial
from pound_solve.numerics.matrices import (
    Matrix,
    by_rows,
    dense,
    diagonal,
    entries,
    gathered,
    is_diagonal,
    least_squares,
    scaled,
    selection,
    used_rows,
)
from pound_solve.numerics.modes import massless, softest
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.assembly import Structure
from pound_solve.structure.corotational import QUANTITIES, CorotationalMembers
from pound_solve.structure.dofs import Dof, label


class ReductionError(Exception):
    """A structure whose motion no method can follow."""


@dataclass(frozen=True)
class Decision:
    """One line of the report's SCENE block."""

    subject: str
    decision: str
    why: str


@dataclass(frozen=True)
class Excitation:
    """The motions and the histories of forces on common intervals.

    Attributes
    ----------
    breaks : ndarray, shape (n_pieces + 1,) [T]
    coefs : ndarray, shape (n_pieces, degree + 1, n_inputs)
        Ascending powers of the time since the piece began.
    """

    breaks: Array
    coefs: Array

    @property
    def degree(self) -> int:
        """Highest power."""
        return self.coefs.shape[1] - 1

    def piece(self, t: float) -> int:
        """Index of the piece that begins at or before `t`."""
        return min(max(int(np.searchsorted(self.breaks, t, side="right")) - 1, 0), len(self.coefs) - 1)

    def pieces(self, t: Array) -> Index:
        """`piece` at several times, shape (n_times,)."""
        return np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.coefs) - 1)

    def pieces_after(self, t: Array) -> Index:
        """Indices of the pieces that begin at some times or before, shape (n_times,); a hair after them:
        rounding never puts us on the one that has just ended.
        """
        return self.pieces(t + 1e-13 * np.maximum(1.0, t))

    def local(self, piece: int, t: float) -> Array:
        """Coefficients about `t`, shape (degree + 1, n_inputs)."""
        return polynomial.shift(self.coefs[piece], t - float(self.breaks[piece]))

    def about(self, t: Array) -> Array:
        """Coefficients about each of several times, each on the piece that begins there or before,
        shape (n_times, degree + 1, n_inputs).
        """
        i = self.pieces_after(t)
        own, since = self.coefs[i], t - self.breaks[i]
        if not since.any():
            return own
        return np.asarray(polynomial.shift(own.swapaxes(0, 1), since[:, None]).swapaxes(0, 1))

    def jumps(self) -> Flags:
        """Which inputs jump, from zero at t = 0 or between two pieces."""
        powers = np.diff(self.breaks)[:, None] ** np.arange(self.degree + 1)
        ends = np.einsum("pk,pkj->pj", powers, self.coefs)
        before = np.concatenate([np.zeros((1, ends.shape[1])), ends[:-1]])
        largest = np.abs(self.coefs[:, 0]).max(axis=0, initial=0.0)
        return np.abs(self.coefs[:, 0] - before).max(axis=0, initial=0.0) > 1e-9 * largest

    def value(self, t: float, order: int = 0) -> Array:
        """Value of the inputs (or of their derivative of that order) at `t`, shape (n_inputs,)."""
        i = self.piece(t)
        return polynomial.value(self.coefs[i], t - float(self.breaks[i]), order)

    def values(self, t: Array, order: int = 0) -> Array:
        """`value` at several times, shape (n_times, n_inputs)."""
        i = self.pieces(t)
        return polynomial.values(self.coefs[i], t - self.breaks[i], order)


@dataclass
class ReducedSystem:
    """The reduced problem of a history; see the module's head.

    Attributes
    ----------
    dofs : tuple of Dof
        The n unknowns that are left.
    mass, damping, stiffness : Matrix, shape (n, n)
    inputs : ndarray, shape (n, n_inputs)
        F.
    constant : ndarray, shape (n,)
        p_0.
    law_rows : Matrix, shape (n_laws, n)
        b.
    law_inputs : ndarray, shape (n_laws, n_inputs)
        e.
    excitation : Excitation
    expand : Matrix, shape (n_free, n)
    expand_constant : ndarray, shape (n_free,)
    expand_inputs : ndarray, shape (n_free, n_inputs)
        All unknown DOFs: ``expand u + expand_constant + expand_inputs s``.
    support_inputs : ndarray, shape (n_moved, n_inputs)
        Prescribed displacements from s.
    total : bool
        Displacements are total (moved supports), not relative to the ground.
    acceleration_inputs : ndarray, shape (3, n_inputs)
        Acceleration of the ground along x and y at the origin, and of its turn, from s;
        zero rows in the total form.
    force_inputs : ndarray, shape (n_free, n_inputs)
        Part of F on all unknown DOFs that is FORCES.
    decisions : list of Decision
    """

    structure: Structure
    dofs: tuple[Dof, ...]
    mass: Matrix
    damping: Matrix
    stiffness: Matrix
    inputs: Array
    constant: Array
    law_rows: Matrix
    law_inputs: Array
    excitation: Excitation
    expand: Matrix
    expand_constant: Array
    expand_inputs: Array
    support_inputs: Array
    total: bool
    acceleration_inputs: Array
    force_inputs: Array
    motions: Sequence[Motion]
    forces: Sequence[Force]
    decisions: list[Decision] = field(default_factory=list)

    def all_dofs(self, u: Array, t: float, order: int = 0) -> Array:
        """All columns of the structure, prescribed ones included, from the unknowns' motion at `t`.

        With `order` 1 or 2 `u` is their velocity or acceleration, and so is the result.
        """
        return self.expanded(u, self.excitation.value(t, order), order)

    def expanded(self, u: Array, s: Array, order: int = 0) -> Array:
        """`all_freedoms` from inputs `s` (of the same order of derivative);
        columns are instants where there are several.
        """
        free = self.expand @ u + self.expand_inputs @ s
        if order == 0:
            free = (free.T + self.expand_constant).T
        return np.concatenate([free, self.support_inputs @ s])

    def over(self, rows: Matrix) -> tuple[Matrix, Array, Array]:
        """Rows over all columns of the structure as rows over unknowns and inputs, and constants."""
        n = self.structure.n_free
        own = rows[:, :n]
        over = own @ self.expand
        return (
            gathered(over.shape, *entries(over)),
            own @ self.expand_inputs + rows[:, n:] @ self.support_inputs,
            own @ self.expand_constant,
        )

    def applied(self, s: Array) -> Array:
        """Held loads and FORCES on all unknown DOFs at inputs `s`; columns are instants
        where there are several.
        """
        constant = self.structure.held[: self.structure.n_free]
        return ((self.force_inputs @ s).T + constant).T

    @cached_property
    def corotational(self) -> CorotationalMembers:
        """The members' chords over the unknowns."""
        return self.structure.corotational.on(self.columns)

    @cached_property
    def corotational_inputs(self) -> Array:
        """Their quantities from the inputs, shape (n_chords, 6, n_inputs)."""
        corotational = self.structure.corotational
        own = corotational.rows[:, self.structure.n_free :] @ self.support_inputs
        return np.asarray(own, float).reshape(len(corotational), QUANTITIES, own.shape[1])

    def quantities(self, u: Array, s: Array) -> Array:
        """Quantities of the chords, shape (n_times, n_chords, 6), for rows of unknowns and of inputs."""
        own = (u @ self.corotational.rows.T).reshape(len(u), len(self.corotational), QUANTITIES)
        return np.asarray(own + np.einsum("ti,cji->tcj", s, self.corotational_inputs), float)

    @property
    def columns(self) -> list[int]:
        """Columns of the structure's matrices that the unknowns stand at."""
        column = {f: i for i, f in enumerate(self.structure.dofs.free)}
        return [column[f] for f in self.dofs]

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.dofs)

    def name(self, index: int) -> str:
        """Unknown in words."""
        return label(self.dofs[index])


def moved_supports(motions: Sequence[Motion], fixed: Sequence[Dof]) -> tuple[Dof, ...]:
    """Fixed DOFs that the motions with SUPPORTS prescribe."""
    out: set[Dof] = set()
    for m in motions:
        if m.supports is not None:
            out |= {(node, d) for node in m.supports for d in m.directions}
    return tuple(sorted(out & set(fixed)))


def build(
    structure: Structure,
    motions: Sequence[Motion],
    t_end: float,
    start: Array,
    start_rate: Array,
    forces: Sequence[Force] = (),
) -> ReducedSystem:
    """Reduce a structure to what its history needs.

    Parameters
    ----------
    structure : Structure
    motions : sequence of Motion
    t_end : float
        Length of the history [T].
    start, start_rate : ndarray, shape (n_free,)
        Displacement and velocity at t = 0: DOFs that start in motion stay.
    forces : sequence of Force

    Raises
    ------
    SceneError
        Mass on arms of slaved nodes leaves some motion without inertia; or a force that jumps on a massless
        DOF would throw a spring with memory from one place to another.
    """
    n, total = structure.n_free, bool(structure.dofs.moved)
    decisions: list[Decision] = []
    excitation, inputs, displacement_of, ground, force_inputs = _inputs(structure, motions, forces, t_end)
    names = structure.dofs.free
    k, c, m = (a[:n, :n] for a in (structure.stiffness, structure.damping, structure.mass))
    rows = structure.law_rows[:, :n]
    law_inputs = structure.law_rows[:, n:] @ displacement_of
    load = structure.held[:n]

    live = _can_move(structure, inputs, excitation, start, start_rate)
    if not live.all():
        dead = [f for f, ok in zip(names, live) if not ok]
        decisions.append(
            Decision(
                f"{len(dead)} of {n} degrees of freedom",
                "dropped",
                "nothing sets them in motion: " + _some(dead),
            )
        )
    keep = np.flatnonzero(live)
    mass = m[np.ix_(keep, keep)]
    _all_inert(mass, [names[i] for i in keep])
    _no_leap(structure, force_inputs[:, excitation.jumps()], live)
    return ReducedSystem(
        structure,
        tuple(names[i] for i in keep),
        mass,
        c[np.ix_(keep, keep)],
        k[np.ix_(keep, keep)],
        inputs[keep],
        load[keep],
        rows[:, keep],
        law_inputs,
        excitation,
        selection(n, keep),
        np.zeros(n),
        np.zeros((n, inputs.shape[1])),
        displacement_of,
        total,
        ground,
        force_inputs,
        motions,
        forces,
        decisions,
    )


@dataclass(frozen=True)
class Condensed:
    """A reduced system without the massless DOFs that follow the others, and the way back.

    Attributes
    ----------
    system : ReducedSystem
    keep : ndarray, shape (n_left,)
        Which unknowns are left.
    expand, follow, constant : ndarray, shapes (n, n_left), (n, n_inputs), (n,)
        All unknowns: ``expand u + follow s + constant``.
    loads : ndarray, shape (n, n_inputs + 1)
        FORCES, and held loads in the last column, on the condensed DOFs.
    """

    system: ReducedSystem
    keep: Index
    expand: Array
    follow: Array
    constant: Array
    loads: Array

    def put_in(self, t: Array) -> Array:
        """Work of the loads on condensed DOFs by that part of their displacements which follows
        the loads at once, since these were zero [F L], at some times.
        """
        s = np.vstack([self.system.excitation.values(t).T, np.ones(len(t))])
        own = np.column_stack([self.follow, self.constant]) @ s
        return np.asarray(0.5 * (own * (self.loads @ s)).sum(axis=0))

    def all(self, u: Array, s: Array, order: int = 0) -> Array:
        """All unknowns from those that are left and the inputs `s`, shape (n,); `order` 1: velocities,
        2: accelerations.  Columns are instants where there are several.
        """
        out = self.expand @ u + self.follow @ s
        return (out.T + self.constant).T if order == 0 else out


def condense(system: ReducedSystem) -> Condensed:
    """Condense massless DOFs on linear elements.

    They follow the others exactly, if what damps them is proportional to what holds them
    (C_ca + C_cc G = 0) or they are not damped at all; and what pushes them alone meets no dashpot.
    """
    structure, n = system.structure, system.size
    system = replace(
        system,
        mass=dense(system.mass),
        damping=dense(system.damping),
        stiffness=dense(system.stiffness),
        law_rows=dense(system.law_rows),
        expand=dense(system.expand),
    )
    k, support = system.stiffness, system.support_inputs
    at = system.columns
    to_supports = dense(structure.stiffness[at, structure.n_free :])
    pushed = system.force_inputs[at]
    light = massless(system.mass) & ~np.any(system.law_rows != 0.0, axis=0)
    slave = _condensable(
        np.hstack([k, to_supports]),
        np.hstack([system.damping, dense(structure.damping[at, structure.n_free :])]),
        np.column_stack([pushed, structure.released[at]]),
        light,
    )
    if slave.any():
        system.decisions.append(
            Decision(
                f"{int(slave.sum())} massless degrees of freedom",
                "condensed",
                "they follow the others statically, no error is made",
            )
        )
    left = light & ~slave
    if left.any():
        system.decisions.append(
            Decision(
                f"{int(left.sum())} massless degrees of freedom",
                "kept",
                "dashpots move them: " + _some([f for f, x in zip(system.dofs, left) if x]),
            )
        )
    keep, s = np.flatnonzero(~slave), np.flatnonzero(slave)
    expand = np.eye(n)[:, keep]
    constant, follow = np.zeros(n), np.zeros((n, system.inputs.shape[1]))
    if len(s):
        inverse = np.linalg.inv(k[np.ix_(s, s)])
        expand[s] = -inverse @ k[np.ix_(s, keep)]
        constant[s] = inverse @ system.constant[s]
        follow[s] = inverse @ (pushed[s] - to_supports[s] @ support)
    inner = replace(
        system,
        dofs=tuple(system.dofs[i] for i in keep),
        mass=expand.T @ system.mass @ expand,
        damping=expand.T @ system.damping @ expand,
        stiffness=expand.T @ k @ expand,
        inputs=expand.T @ system.inputs,
        constant=expand.T @ system.constant,
        law_rows=system.law_rows @ expand,
        expand=system.expand @ expand,
        expand_constant=system.expand @ constant,
        expand_inputs=system.expand @ follow,
    )
    loads = np.zeros((n, system.inputs.shape[1] + 1))
    loads[s] = np.column_stack([pushed[s], system.constant[s]])
    return Condensed(inner, keep, expand, follow, constant, loads)


def _inputs(
    structure: Structure, motions: Sequence[Motion], forces: Sequence[Force], t_end: float
) -> tuple[Excitation, Array, Array, Array, Array]:
    """Excitation, its force on the unknowns, prescribed displacements from it,
    ground acceleration from it, part of its force that is FORCES.
    """
    n, dofs, nodes = structure.n_free, structure.dofs, structure.model.nodes
    channels: list[Piecewise] = []
    each = 3 if dofs.moved else 1  # channels of a motion
    count = each * len(motions) + len(forces)
    push, own = np.zeros((n, count)), np.zeros((n, count))
    ground, displacement_of = np.zeros((3, count)), np.zeros((len(dofs.moved), count))
    for j, motion in enumerate(motions):
        at = each * j
        if not dofs.moved:
            ground[:, at] = [motion.share(d, 0.0, 0.0) for d in range(3)]
            push[:, at] = -ground[:, at] @ structure.ground[:, :n]
            channels.append(motion.acceleration)
            continue
        shares = [
            motion.share(d, nodes[node].x, nodes[node].y) if node in (motion.supports or ()) else 0.0
            for node, d in dofs.moved
        ]
        displacement_of[:, at] = shares
        for k, matrix in enumerate((structure.stiffness, structure.damping, structure.mass)):
            push[:, at + k] = -matrix[:n, n:] @ shares
        channels += [motion.displacement(t_end), motion.velocity(t_end), motion.acceleration]
    for j, force in enumerate(forces, each * len(motions)):
        for node in force.nodes:
            for d, share in enumerate(force.push):
                for column, factor in dofs.terms[node, d]:
                    if column < n:
                        own[column, j] += share * factor
        channels.append(force.history)
    breaks = common_breaks([*(m.acceleration for m in motions), *(f.history for f in forces)], t_end)
    degree = max((ch.degree for ch in channels), default=0)
    coefs = np.zeros((len(breaks) - 1, degree + 1, len(channels)))
    for j, ch in enumerate(channels):
        coefs[:, : ch.degree + 1, j] = ch.on(breaks).coefs.T
    return Excitation(breaks, coefs), push + own, displacement_of, ground, own


def _can_move(
    structure: Structure, inputs: Array, excitation: Excitation, start: Array, start_rate: Array
) -> Flags:
    """Which unknowns anything can set in motion: all that hang together with one that is driven
    or not at zero.
    """
    n = structure.n_free
    linked = [entries(a[:n, :n])[:2] for a in (structure.stiffness, structure.damping, structure.mass)]
    parent = list(range(n))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    def join(touched: Index) -> None:
        for i in touched[1:].tolist():
            parent[root(int(touched[0]))] = root(i)

    real = np.zeros(n, bool)  # a DOF without mass, stiffness, dashpot or law takes part in nothing
    for rows, columns in linked:
        real[rows] = True
        for i, j in zip(rows.tolist(), columns.tolist()):
            if i < j:
                parent[root(i)] = root(j)
    for touched, _ in structure.corotational.on(slice(n)).touched():
        join(touched)
    driven = (start != 0) | (start_rate != 0) | (structure.held[:n] != 0)
    active = np.abs(excitation.coefs).max(axis=(0, 1), initial=0.0) > 0
    driven |= np.any(inputs[:, active] != 0, axis=1)
    for spring, (row, _) in zip(structure.laws, by_rows(structure.law_rows)):
        touched = row[row < n]
        join(touched)
        real[touched] = True
        if spring.law.force(spring.law.start(), 0.0)[0] != 0 or np.any(row >= n):
            driven[touched] = True
    awake = {root(int(i)) for i in np.flatnonzero(driven)}
    return np.array([root(i) in awake for i in range(n)], bool) & real


def _condensable(k: Array, c: Array, push: Array, light: Flags) -> Flags:
    """Which massless DOFs follow the others exactly; those that do not are taken out
    until the rest do.  Columns of `k` and `c` beyond the unknowns are those of moved supports,
    columns of `push` the forces that change in time.
    """
    none, candidates = np.zeros_like(light), light
    while candidates.any():
        s = np.flatnonzero(candidates)
        values = np.linalg.eigvalsh(k[np.ix_(s, s)])
        if values[0] <= 1e-13 * max(values[-1], 0.0):
            # a mechanism among them, or what only dashpots hold: leave it to the integrator,
            # which can name it
            undamped = candidates & ~np.any(c != 0.0, axis=1)
            if (undamped == candidates).all():
                return none
            candidates = undamped
            continue
        # prescribed DOFs are among the others that they follow
        rest = np.concatenate([np.flatnonzero(~candidates), np.arange(len(light), k.shape[1])])
        g = -np.linalg.solve(k[np.ix_(s, s)], k[np.ix_(s, rest)])
        misfit = np.abs(c[np.ix_(s, rest)] + c[np.ix_(s, s)] @ g).max(axis=1, initial=0.0)
        # what a force moves against a dashpot comes after it
        yielded = np.linalg.solve(k[np.ix_(s, s)], push[s])
        yielded /= np.maximum(np.abs(yielded).max(axis=0, initial=0.0), 1e-300)
        lag = np.abs(c[np.ix_(s, s)] @ yielded).max(axis=1, initial=0.0)
        bad = np.maximum(misfit, lag) > 1e-11 * max(np.abs(c[s]).max(initial=0.0), 1e-300)
        if not bad.any():
            return candidates
        candidates = candidates.copy()
        candidates[s[bad]] = False
    return none


def _all_inert(m: Matrix, names: Sequence[Dof]) -> None:
    """Raise where mass on arms of slaved nodes leaves some motion without inertia: no method takes that."""
    heavy = np.flatnonzero(~massless(m))
    part = m[np.ix_(heavy, heavy)]
    if is_diagonal(part):
        return
    value, vector = softest(scaled(part, 1.0 / np.sqrt(diagonal(part))))
    if value < 1e-13 * len(heavy):
        # the rotation at the other end of the arms, where one takes part
        share = np.abs(vector) * [2.0 if names[int(i)][1] == 2 else 1.0 for i in heavy]
        worst = label(names[int(heavy[int(np.argmax(share))])])
        raise ReductionError(
            f"{worst} has no inertia of its own beside the mass on slaved nodes: "
            "give it a rotational weight WR"
        )


def _no_leap(structure: Structure, pushes: Array, live: Flags) -> None:
    """Raise where forces that jump, or loads that are let go, move springs with memory at once:
    on DOFs with neither mass nor dashpot nothing says along which path.
    """
    n = structure.n_free
    quick = live & massless(structure.mass[:n, :n]) & ~used_rows(structure.damping[:n, :n])
    z = np.flatnonzero(quick)
    pushes = np.column_stack([pushes, structure.released[:n]])[z]
    if not pushes.any():
        return
    leap = least_squares(structure.initial_stiffness[np.ix_(z, z)], pushes, 1e-12)
    for spring, (at, row) in zip(structure.laws, by_rows(structure.law_rows[:, z])):
        if not spring.role.viscous and np.any(
            np.abs(row @ leap[at]) > 1e-9 * np.abs(row).max(initial=0.0) * np.abs(leap).max()
        ):
            where = int(z[int(np.argmax(np.abs(pushes).max(axis=1)))])
            raise ReductionError(
                f"a force jumps, or a load is let go, at {label(structure.dofs.free[where])}, which "
                f"has no mass, and throws the spring {spring.element} {spring.component} along: give it "
                "weight, or let the force change within a short time (FORCES)"
            )


def _some(dofs: Sequence[Dof], most: int = 6) -> str:
    """Name a few DOFs."""
    text = ", ".join(label(f).removeprefix("node ") for f in dofs[:most])
    return text + (f", and {len(dofs) - most} more" if len(dofs) > most else "")
