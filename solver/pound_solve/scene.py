r"""The scene: what this deck needs of the structure, and why the rest is left out.

Freedoms that nothing can set in motion are dropped, massless freedoms that only linear elements touch are
condensed, and what is left is written as

.. math:: M\ddot u + C\dot u + K u + \sum_i b_i f_i(d_i, \dot d_i) = F s(t) + p_0, \qquad
          d_i = b_i^T u + e_i^T s(t)

with the laws' forces :math:`f_i`, the motions :math:`s(t)` (ground accelerations, or displacement,
velocity and acceleration of moved supports) and constant loads :math:`p_0`.

With one motion for the whole base the displacements are relative to the ground;
with motions of SUPPORTS they are total.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pound_solve import polynomial
from pound_solve.assemble import Structure
from pound_solve.dofs import Freedom, label
from pound_solve.modes import massless
from pound_solve.motions.base import Motion, Piecewise, common_breaks

Array = NDArray[np.float64]


class SceneError(Exception):
    """A structure whose motion no method can follow."""


@dataclass(frozen=True)
class Decision:
    """One line of the report's SCENE block."""

    subject: str
    decision: str
    why: str


@dataclass(frozen=True)
class Excitation:
    """The motions on common intervals.

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

    def local(self, piece: int, t: float) -> Array:
        """Coefficients about `t`, shape (degree + 1, n_inputs)."""
        return polynomial.shift(self.coefs[piece], t - float(self.breaks[piece]))

    def value(self, t: float, order: int = 0) -> Array:
        """Value of the inputs (or of their derivative of that order) at `t`, shape (n_inputs,)."""
        i = self.piece(t)
        return polynomial.value(self.coefs[i], t - float(self.breaks[i]), order)

    def values(self, t: Array, order: int = 0) -> Array:
        """`value` at several times, shape (n_times, n_inputs)."""
        i = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.coefs) - 1)
        return polynomial.values(self.coefs[i], t - self.breaks[i], order)


@dataclass
class Scene:
    """The reduced problem of a history; see the module's head.

    Attributes
    ----------
    freedoms : tuple of Freedom
        The n unknowns that are left.
    mass, damping, stiffness : ndarray, shape (n, n)
    inputs : ndarray, shape (n, n_inputs)
        F.
    constant : ndarray, shape (n,)
        p_0.
    law_rows : ndarray, shape (n_laws, n)
        b.
    law_inputs : ndarray, shape (n_laws, n_inputs)
        e.
    excitation : Excitation
    expand : ndarray, shape (n_free, n)
    expand_constant : ndarray, shape (n_free,)
    expand_inputs : ndarray, shape (n_free, n_inputs)
        All unknown freedoms: ``expand u + expand_constant + expand_inputs s``.
    support_inputs : ndarray, shape (n_moved, n_inputs)
        Prescribed displacements from s.
    total : bool
        Displacements are total (moved supports), not relative to the ground.
    acceleration_inputs : ndarray, shape (2, n_inputs)
        Ground acceleration along x and y from s; zero rows in the total form.
    decisions : list of Decision
    """

    structure: Structure
    freedoms: tuple[Freedom, ...]
    mass: Array
    damping: Array
    stiffness: Array
    inputs: Array
    constant: Array
    law_rows: Array
    law_inputs: Array
    excitation: Excitation
    expand: Array
    expand_constant: Array
    expand_inputs: Array
    support_inputs: Array
    total: bool
    acceleration_inputs: Array
    motions: Sequence[Motion]
    decisions: list[Decision] = field(default_factory=list)

    def all_freedoms(self, u: Array, t: float, order: int = 0) -> Array:
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

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.freedoms)

    def name(self, index: int) -> str:
        """Unknown in words."""
        return label(self.freedoms[index])


def moved_supports(motions: Sequence[Motion], fixed: Sequence[Freedom]) -> tuple[Freedom, ...]:
    """Fixed freedoms that the motions with SUPPORTS prescribe."""
    out: set[Freedom] = set()
    for m in motions:
        if m.supports is not None:
            out |= {(node, "XY".index(m.direction)) for node in m.supports}
    return tuple(sorted(out & set(fixed)))


def build(
    structure: Structure, motions: Sequence[Motion], t_end: float, start: Array, start_rate: Array
) -> Scene:
    """Reduce a structure to what its history needs.

    Parameters
    ----------
    structure : Structure
    motions : sequence of Motion
    t_end : float
        Length of the history [T].
    start, start_rate : ndarray, shape (n_free,)
        Displacement and velocity at t = 0: freedoms that start in motion stay.

    Raises
    ------
    SceneError
        Mass on arms of slaved nodes leaves some motion without inertia.
    """
    n, total = structure.n_free, bool(structure.freedoms.moved)
    decisions: list[Decision] = []
    excitation, inputs, displacement_of, ground = _inputs(structure, motions, t_end)
    names = structure.freedoms.free
    k, c, m = (a[:n, :n] for a in (structure.stiffness, structure.damping, structure.mass))
    rows = structure.law_rows[:, :n]
    law_inputs = structure.law_rows[:, n:] @ displacement_of
    load = structure.loads[:n]

    live = _can_move(structure, inputs, excitation, start, start_rate)
    if not live.all():
        dead = [f for f, ok in zip(names, live) if not ok]
        decisions.append(
            Decision(
                f"{len(dead)} of {n} freedoms", "dropped", "nothing sets them in motion: " + _some(dead)
            )
        )
    # massless freedoms on linear elements follow the others exactly, if what damps them is proportional to
    # what holds them (C_ca + C_cc G = 0) or they are not damped at all
    light = live & massless(m) & ~np.any(rows != 0.0, axis=0)
    slave = _condensable(structure.stiffness, structure.damping, light, live)
    if slave.any():
        decisions.append(
            Decision(
                f"{int(slave.sum())} massless freedoms",
                "condensed",
                "they follow the others statically, no error is made",
            )
        )
    left = light & ~slave
    if left.any():
        decisions.append(
            Decision(
                f"{int(left.sum())} massless freedoms",
                "kept",
                "dashpots move them: " + _some([f for f, x in zip(names, left) if x]),
            )
        )
    keep = np.flatnonzero(live & ~slave)
    s = np.flatnonzero(slave)
    expand = np.zeros((n, len(keep)))
    expand[keep, np.arange(len(keep))] = 1.0
    constant, follow = np.zeros(n), np.zeros((n, inputs.shape[1]))
    if len(s):
        inverse = np.linalg.inv(k[np.ix_(s, s)])
        expand[s] = -inverse @ k[np.ix_(s, keep)]
        constant[s] = inverse @ load[s]
        follow[s] = -inverse @ (structure.stiffness[s, n:] @ displacement_of)
    mass = expand.T @ m @ expand
    _all_inert(mass, [names[i] for i in keep])
    return Scene(
        structure,
        tuple(names[i] for i in keep),
        mass,
        expand.T @ c @ expand,
        expand.T @ k @ expand,
        expand.T @ inputs,
        expand.T @ load,
        rows @ expand,
        law_inputs,
        excitation,
        expand,
        constant,
        follow,
        displacement_of,
        total,
        ground,
        motions,
        decisions,
    )


def _inputs(
    structure: Structure, motions: Sequence[Motion], t_end: float
) -> tuple[Excitation, Array, Array, Array]:
    """Excitation, its force on the unknowns, prescribed displacements from it,
    ground acceleration from it.
    """
    n, moved = structure.n_free, structure.freedoms.moved
    breaks = common_breaks(motions, t_end)
    channels: list[Piecewise] = []
    if not moved:
        force = np.zeros((n, len(motions)))
        ground = np.zeros((2, len(motions)))
        for j, motion in enumerate(motions):
            d = "XY".index(motion.direction)
            force[:, j] = -structure.ground[d, :n]
            ground[d, j] = 1.0
            channels.append(motion.acceleration)
        displacement_of = np.zeros((0, len(motions)))
    else:
        force = np.zeros((n, 3 * len(motions)))
        ground = np.zeros((2, 3 * len(motions)))
        displacement_of = np.zeros((len(moved), 3 * len(motions)))
        for j, motion in enumerate(motions):
            columns = [
                i
                for i, (node, d) in enumerate(moved)
                if "XY"[d] == motion.direction and motion.supports and node in motion.supports
            ]
            displacement_of[columns, 3 * j] = 1.0
            at = [n + i for i in columns]
            force[:, 3 * j] = -structure.stiffness[:n, at].sum(axis=1)
            force[:, 3 * j + 1] = -structure.damping[:n, at].sum(axis=1)
            force[:, 3 * j + 2] = -structure.mass[:n, at].sum(axis=1)
            channels += [motion.displacement(t_end), motion.velocity(t_end), motion.acceleration]
    degree = max((ch.degree for ch in channels), default=0)
    coefs = np.zeros((len(breaks) - 1, degree + 1, len(channels)))
    for j, ch in enumerate(channels):
        coefs[:, : ch.degree + 1, j] = ch.on(breaks).coefs.T
    return Excitation(breaks, coefs), force, displacement_of, ground


def _can_move(
    structure: Structure, inputs: Array, excitation: Excitation, start: Array, start_rate: Array
) -> NDArray[np.bool_]:
    """Which unknowns anything can set in motion: all that hang together with one that is driven
    or not at zero.
    """
    n = structure.n_free
    linked = (
        (structure.stiffness[:n, :n] != 0)
        | (structure.damping[:n, :n] != 0)
        | (structure.mass[:n, :n] != 0)
    )
    parent = list(range(n))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for i, j in zip(*np.nonzero(np.triu(linked, 1))):
        parent[root(int(i))] = root(int(j))
    driven = (start != 0) | (start_rate != 0) | (structure.loads[:n] != 0)
    active = np.abs(excitation.coefs).max(axis=(0, 1), initial=0.0) > 0
    driven |= np.any(inputs[:, active] != 0, axis=1)
    for spring, row in zip(structure.laws, structure.law_rows):
        touched = np.flatnonzero(row[:n])
        for i in touched[1:]:
            parent[root(int(touched[0]))] = root(int(i))
        branch = spring.law.branch(spring.law.start())
        if branch.force(0.0, 0.0) != 0 or np.any(row[n:] != 0):
            driven[touched] = True
    # a freedom without mass, stiffness, dashpot or law takes part in nothing
    real = linked.any(axis=1) | np.any(structure.law_rows[:, :n] != 0, axis=0)
    awake = {root(int(i)) for i in np.flatnonzero(driven)}
    return np.array([root(i) in awake for i in range(n)], bool) & real


def _condensable(
    k: Array, c: Array, light: NDArray[np.bool_], live: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Which massless freedoms follow the others exactly; those that do not are taken out
    until the rest do.
    """
    none, candidates = np.zeros_like(light), light
    while candidates.any():
        s = np.flatnonzero(candidates)
        values = np.linalg.eigvalsh(k[np.ix_(s, s)])
        if values[0] <= 1e-13 * max(values[-1], 0.0):
            # a mechanism among them, or what only dashpots hold: leave it to the integrator,
            # which can name it
            undamped = candidates & ~np.any(c[: len(light)] != 0.0, axis=1)
            if (undamped == candidates).all():
                return none
            candidates = undamped
            continue
        # prescribed freedoms are among the others that they follow
        rest = np.concatenate([np.flatnonzero(live & ~candidates), np.arange(len(live), len(k))])
        g = -np.linalg.solve(k[np.ix_(s, s)], k[np.ix_(s, rest)])
        misfit = np.abs(c[np.ix_(s, rest)] + c[np.ix_(s, s)] @ g).max(axis=1, initial=0.0)
        bad = misfit > 1e-11 * max(np.abs(c[s]).max(initial=0.0), 1e-300)
        if not bad.any():
            return candidates
        candidates = candidates.copy()
        candidates[s[bad]] = False
    return none


def _all_inert(m: Array, names: Sequence[Freedom]) -> None:
    """Raise where mass on arms of slaved nodes leaves some motion without inertia: no method takes that."""
    heavy = np.flatnonzero(~massless(m))
    part = m[np.ix_(heavy, heavy)]
    if not np.any(part - np.diag(np.diag(part))):
        return
    root = 1.0 / np.sqrt(np.diag(part))
    values, vectors = np.linalg.eigh(root[:, None] * part * root)
    if values[0] < 1e-13 * len(values):
        # the rotation at the other end of the arms, where one takes part
        share = np.abs(vectors[:, 0]) * [2.0 if names[int(i)][1] == 2 else 1.0 for i in heavy]
        worst = label(names[int(heavy[int(np.argmax(share))])])
        raise SceneError(
            f"{worst} has no inertia of its own beside the mass on slaved nodes: "
            "give it a rotational weight WR"
        )


def _some(freedoms: Sequence[Freedom], most: int = 6) -> str:
    """Name a few freedoms."""
    text = ", ".join(label(f).removeprefix("node ") for f in freedoms[:most])
    return text + (f", and {len(freedoms) - most} more" if len(freedoms) > most else "")
