"""The reduced system in blocks: parts that move on their own between events (see `window` for their
motion).

Each part has its modes for each combination of stiffnesses.  Small ones are put together: a hundred numbers
more in a product cost less than a product more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.closed_form.propagator import (
    Mechanism,
    ModalPropagator,
    Propagator,
    make_propagator,
    on_stacked,
)
from pound_solve.integrate.closed_form.rigid_contact import Rigid
from pound_solve.integrate.closed_form.work_integrals import WorkIntegrals
from pound_solve.laws.automaton import Branch
from pound_solve.numerics.graph import components
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import ReducedSystem

Key = tuple[Any, ...]

#: cost of a regime, as `exact.WINDOW`; its products, over the unknowns' square; its modes, over the cube
REGIME, PRODUCTS, MODES = 8e-4, 1.5e-6, 8e-9
SMALL = 128  #: modes that blocks put together may have


def cost_of_decomposition(n: int) -> float:
    """Cost of a new combination of stiffnesses of `n` unknowns."""
    return REGIME + PRODUCTS * n**2 + MODES * n**3


@dataclass(frozen=True)
class Reactions:
    """Forces of the rigid contacts that a block holds closed: ``on_q q + on_p p + on_rate p'``.

    Attributes
    ----------
    laws : ndarray of int, shape (n_held,)
    place : ndarray of int, shape (n_held,)
        Their rows among those of the run.
    gaps : ndarray, shape (n_held,)
    inputs : ndarray, shape (n_held, n_inputs)
        The deformations that the unknowns are held to are ``gaps - inputs s``.
    on_q : ndarray, shape (n_held, n_q)
    on_p, on_rate : ndarray, shape (n_held, n + 3 n_held)
        On the forces, extended as in `propagator.held_space`.
    """

    laws: Index
    place: Index
    gaps: Array
    inputs: Array
    on_q: NDArray[Any]
    on_p: Array
    on_rate: Array

    def extended(self, ps: Array, coefs: Array) -> Array:
        """Force polynomials (n_intervals, degree + 1, n + 3 n_held) with what is held in their last
        columns, from inputs' coefficients.
        """
        m, orders = len(self.laws), np.arange(1, coefs.shape[1])[:, None]
        ps = ps.copy()
        x, first, second = (ps[..., k * m - 3 * m : (k * m - 2 * m) or None] for k in range(3))
        x[:] = -coefs @ self.inputs.T
        x[:, 0] += self.gaps
        first[:, :-1] = x[:, 1:] * orders
        second[:, :-1] = first[:, 1:] * orders
        return ps


class Part(NamedTuple):
    """What a regime was put together from: its place among q, its unknowns and what measures its work."""

    q: slice
    unknowns: Index
    work: WorkIntegrals


@dataclass(frozen=True)
class Decomposition:
    """A block's exact motion for one set of stiffnesses; kept for when they return.

    Attributes
    ----------
    index : ndarray of int
        The block's unknowns.
    laws : ndarray of int
        Laws that act within it.
    watched : ndarray of int, place : list of int
        Which rows of the run touch it; the place of every row among them, or -1.
    rows : ndarray, shape (n_watched, n)
    on_u : ndarray, shape (n_watched, n_q)
        What the rows' values take from q.
    size : ndarray, shape (n_watched, n_q)
        Its magnitude.
    on_q : ndarray, shape (3 n_watched, n_q or 2 n_q)
        What their values, rates and second rates take from `propagator.stacked` q.
    motion : ndarray, shape (3 n, n_q or 2 n_q)
        What displacements, velocities and accelerations take from it.
    shown : ndarray of int
        Those of the block's unknowns that the envelopes look at.
    motion_shown : ndarray, shape (3 n_shown, n_q or 2 n_q)
        `motion` of those.
    parts : tuple of Part
    reactions : Reactions or None
    """

    index: Index
    laws: Index
    propagator: Propagator
    watched: Index
    place: list[int]
    rows: Array
    on_u: NDArray[Any]
    size: Array
    on_q: Array
    motion: Array
    shown: Index
    motion_shown: Array
    parts: tuple[Part, ...]
    reactions: Reactions | None


@dataclass
class Subsystem:
    """A regime at work: its state `q` and its motion over the present window.

    Attributes
    ----------
    keys : tuple of Key
        Of the regime's parts.
    constant : ndarray, shape (n,)
        Constant forces: loads and constants of the laws.
    qs : ndarray, shape (n_q, n_intervals + 1)
    gs : ndarray, shape (n_intervals, degree + 1, n_q)
        States at the starts of the window's intervals and forcing within them.
    ps : ndarray, shape (n_intervals, degree + 1, n) or None
        Force polynomials, where massless DOFs or moved supports need them.
    """

    keys: tuple[Key, ...]
    decomposition: Decomposition
    constant: Array
    q: NDArray[Any]
    qs: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0)))
    gs: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0, 0)))
    ps: Array | None = None


class Subsystems:
    """Keeps the reduced system divided into blocks as contacts close and springs yield.

    Parameters
    ----------
    system : ReducedSystem
    rows : ndarray, shape (n_rows, n)
        Functionals that the run watches; the first are the laws' deformations.
        The forces of the rigid contacts come after them.
    row_inputs : ndarray, shape (n_rows, n_inputs)
    row_constants : ndarray, shape (n_rows,)
    shown : ndarray of bool, shape (n,)
        Unknowns that the envelopes look at.
    """

    def __init__(
        self,
        system: ReducedSystem,
        rows: Array,
        row_inputs: Array,
        row_constants: Array,
        shown: Flags,
    ) -> None:
        self.system, self.rigid, more = system, Rigid(system), len(rows)
        self.shown = shown
        count = len(self.rigid.laws)
        self.force_row = {law: more + i for i, law in enumerate(self.rigid.laws)}
        self.rows = np.pad(rows, ((0, count), (0, 0)))
        self.row_inputs = np.pad(row_inputs, ((0, count), (0, 0)))
        self.row_constants = np.pad(row_constants, (0, count))
        self.known = bool(np.any(row_inputs))
        self.active: list[Subsystem] = []
        self.decompositions: dict[Key, Decomposition] = {}
        self._together: dict[tuple[Key, ...], Decomposition] = {}
        self._base = self._parts_with_contacts_open()

    @property
    def parts(self) -> int:
        """Number of parts with all contacts open."""
        return len(np.unique(self._base))

    @property
    def fastest(self) -> float:
        """Largest |eigenvalue| of the present blocks [1/T]."""
        return max((b.decomposition.propagator.fastest for b in self.active), default=0.0)

    def _parts_with_contacts_open(self) -> Index:
        """Component of each unknown with all contacts open, shape (n,)."""
        system = self.system
        laws = zip(system.structure.laws, system.law_rows)
        return components(
            system.size,
            (system.stiffness, system.damping, system.mass),
            [np.flatnonzero(row) for spring, row in laws if not spring.is_contact],
        )

    def form(self, branches: Sequence[Branch], u: Array, v: Array, spend: Callable[[float], None]) -> None:
        """Form the blocks that the branches ask for at displacement `u`, velocity `v`;
        keep those that go on, and tell `spend` what a new one costs before it is made.

        Raises
        ------
        Mechanism
            Massless DOFs that nothing holds; its shape is over all unknowns.
        """
        system = self.system
        labels = self._base.copy()
        for i, (s, b) in enumerate(zip(system.structure.laws, branches)):
            if s.is_contact and (b.stiffness or b.damping or b.held):
                parts = np.unique(labels[system.law_rows[i] != 0])
                if len(parts):
                    labels[np.isin(labels, parts)] = parts[0]
        acting = [i for i, b in enumerate(branches) if b.stiffness or b.damping or b.force0 or b.held]
        found: list[tuple[Key, Array]] = []  # what there is, with its constant forces
        for label in np.unique(labels):
            index = np.flatnonzero(labels == label)
            laws = np.array([i for i in acting if np.any(system.law_rows[i, index])], np.intp)
            key = (
                int(label),
                len(index),
                *((int(i), branches[i].stiffness, branches[i].damping, branches[i].held) for i in laws),
            )
            if key not in self.decompositions:
                spend(cost_of_decomposition(len(index)))
                self.decompositions[key] = self._decomposition(index, laws, branches)
            own = [branches[i].force0 for i in laws]
            found.append((key, system.constant[index] - system.law_rows[np.ix_(laws, index)].T @ own))
        on_way = {
            key: subsystem.q[part.q]
            for subsystem in self.active
            for key, part in zip(subsystem.keys, subsystem.decomposition.parts)
        }
        self.active = []
        for group in self._groups(found):
            keys, constants = zip(*group)
            own = [self.decompositions[key] for key in keys]
            states = [
                on_way[key] if key in on_way else r.propagator.enter(u[r.index], v[r.index])
                for key, r in zip(keys, own)
            ]
            whole = Subsystem(keys, self._joined(keys), np.concatenate(constants), np.concatenate(states))
            self.active.append(whole)

    def _groups(self, found: list[tuple[Key, Array]]) -> list[list[tuple[Key, Array]]]:
        """What is put together."""
        groups: list[list[tuple[Key, Array]]] = []
        room = 0  # in the last one of those that may grow
        for own in found:
            propagator = self.decompositions[own[0]].propagator
            if not isinstance(propagator, ModalPropagator) or propagator.u_p is not None:
                groups.append([own])
            elif len(propagator.lam) <= room:
                groups[0].append(own)
                room -= len(propagator.lam)
            else:
                groups.insert(0, [own])
                room = SMALL - len(propagator.lam)
        return groups

    def _joined(self, keys: tuple[Key, ...]) -> Decomposition:
        """The regimes of some keys as one."""
        if len(keys) == 1:
            return self.decompositions[keys[0]]
        if keys not in self._together:
            own = [self.decompositions[key] for key in keys]
            propagator = ModalPropagator.joined(
                [r.propagator for r in own if isinstance(r.propagator, ModalPropagator)]
            )
            ends = np.cumsum([0, *(r.on_u.shape[1] for r in own)]).tolist()
            parts = [
                part._replace(q=slice(i, j)) for r, i, j in zip(own, ends, ends[1:]) for part in r.parts
            ]
            index, laws = (np.concatenate([getattr(r, x) for r in own]) for x in ("index", "laws"))
            self._together[keys] = self._described(index, laws, propagator, tuple(parts), None)
        return self._together[keys]

    def _decomposition(self, index: Index, laws: Index, branches: Sequence[Branch]) -> Decomposition:
        system = self.system
        grid = np.ix_(index, index)
        b = system.law_rows[np.ix_(laws, index)]
        k = system.stiffness[grid] + (b.T * [branches[i].stiffness for i in laws]) @ b
        c = system.damping[grid] + (b.T * [branches[i].damping for i in laws]) @ b
        held = np.array([i for i in laws if branches[i].held], np.intp)
        held_rows = system.law_rows[np.ix_(held, index)] if len(held) else None
        try:
            propagator = make_propagator(system.mass[grid], c, k, system.inputs[index], held_rows)
        except Mechanism as err:
            whole = np.zeros(system.size)
            whole[index] = err.shape
            raise Mechanism(whole) from None
        dashpots = [
            (int(i), branches[i].damping, system.law_rows[i, index]) for i in laws if branches[i].damping
        ]
        work = WorkIntegrals(propagator, system.damping[grid], system.inputs[index], dashpots)
        parts = (Part(slice(None), index, work),)
        reactions = self._reactions(held, index, propagator, c, k) if len(held) else None
        return self._described(index, laws, propagator, parts, reactions)

    def _described(
        self,
        index: Index,
        laws: Index,
        propagator: Propagator,
        parts: tuple[Part, ...],
        reactions: Reactions | None,
    ) -> Decomposition:
        """A regime with what rows and unknowns take from its state."""
        watched = np.flatnonzero(np.any(self.rows[:, index] != 0, axis=1))
        place = [-1] * len(self.rows)
        for i, row in enumerate(watched.tolist()):
            place[row] = i
        rows = self.rows[np.ix_(watched, index)]
        motion = on_stacked(np.vstack([propagator.u_q, propagator.v_q, propagator.onward(propagator.v_q)]))
        on_u = rows @ propagator.u_q
        shown = np.flatnonzero(self.shown[index])
        return Decomposition(
            index,
            laws,
            propagator,
            watched,
            place,
            rows,
            on_u,
            np.abs(on_u),
            np.concatenate([rows @ x for x in np.split(motion, 3)]),
            motion,
            shown,
            np.concatenate([x[shown] for x in np.split(motion, 3)]),
            parts,
            reactions,
        )

    def _reactions(
        self, held: Index, index: Index, propagator: Propagator, c: Array, k: Array
    ) -> Reactions:
        """From ``G f = B M^-1 (p - C v - K u) - x''``, see `rigid` and `propagator.held_space`."""
        assert propagator.u_p is not None and propagator.v_p is not None  # of all that is held
        at = np.array([self.rigid.laws.index(i) for i in held], np.intp)
        inverse = np.linalg.pinv(self.rigid.compliance[np.ix_(at, at)], rcond=1e-12)
        x = inverse @ self.rigid.yielding[np.ix_(index, at)].T
        on_p = -x @ (k @ propagator.u_p + c @ propagator.v_p)
        on_p[:, : len(index)] += x
        on_p[:, on_p.shape[1] - len(held) :] -= inverse
        return Reactions(
            held,
            np.array([self.force_row[i] for i in held], np.intp),
            self.rigid.gap[at],
            self.rigid.inputs[at],
            -x @ (k @ propagator.u_q + c @ propagator.v_q),
            on_p,
            -x @ c @ propagator.u_p,
        )
