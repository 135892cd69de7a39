"""Subsystems: parts of the reduced system that move independently of each other between events.

Parts that no closed contact connects are solved separately, with separate modes for each combination of
stiffnesses.  Small parts are evaluated together, because a hundred more numbers in a matrix product cost
less than an additional product.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate import costs
from pound_solve.integrate.closed_form.decomposition import Decomposer, Decomposition
from pound_solve.integrate.events.functions import RowSet
from pound_solve.integrate.propagators.modal import ModalPropagator
from pound_solve.integrate.rigid.contacts import RigidContacts
from pound_solve.laws.automaton import Branch
from pound_solve.numerics.graph import components
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import ReducedSystem

Key = tuple[
    Any, ...
]  #: label and size of a subsystem; number, stiffness, damping, `constrains` of each law

MAX_JOINED_MODES = 128  #: largest number of modes of joined subsystems


@dataclass
class Subsystem:
    """A part of the system on the present branches: its state and its motion over the present window.

    Attributes
    ----------
    keys : tuple of Key
        Keys of the joined decompositions.
    decomposition : Decomposition
    constant : ndarray, shape (n,)
        Constant loads: those of the system, and constants of the laws.
    q : ndarray, shape (n_q,)
        State at the present time.
    states : ndarray, shape (n_q, n_intervals + 1)
    forcing : ndarray, shape (n_intervals, degree + 1, n_q)
        States at the starts of the window's intervals and at the end of the window, and forcing within the
        intervals.
    loads : ndarray, shape (n_intervals, degree + 1, n) or None
        Load polynomials, if massless DOFs or moving supports need them.
    """

    keys: tuple[Key, ...]
    decomposition: Decomposition
    constant: Array
    q: NDArray[Any]
    states: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0)))
    forcing: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0, 0)))
    loads: Array | None = None


class Subsystems:
    """The division of the reduced system into subsystems as contacts close and springs yield.

    Parameters
    ----------
    system : ReducedSystem
    rows : RowSet
        Functionals that the run monitors, starting with the deformations of the laws.  The reactions of the
        rigid contacts are appended.
    enveloped : ndarray of bool, shape (n,)
        Unknowns whose motion the envelopes need.

    Attributes
    ----------
    present : list of Subsystem
    decompositions : dict
        All decompositions so far, by key.
    reaction_row : dict of int to int
        Row of the reaction of every rigid contact, by law.
    rows_have_inputs : bool
        Whether any row depends on the inputs directly.
    """

    def __init__(self, system: ReducedSystem, rows: RowSet, enveloped: Flags) -> None:
        self.system, self.rigid, self.enveloped = system, RigidContacts(system), enveloped
        n_rows, n_rigid = len(rows.rows), len(self.rigid.laws)
        self.reaction_row = {law: n_rows + i for i, law in enumerate(self.rigid.laws)}
        self.rows = RowSet(
            np.pad(rows.rows, ((0, n_rigid), (0, 0))),
            np.pad(rows.inputs, ((0, n_rigid), (0, 0))),
            np.pad(rows.constants, (0, n_rigid)),
        )
        self.rows_have_inputs = bool(np.any(rows.inputs))
        self.present: list[Subsystem] = []
        self.decompositions: dict[Key, Decomposition] = {}
        self._decomposer = Decomposer(system, self.rigid, self.rows, self.reaction_row, enveloped)
        self._joined: dict[tuple[Key, ...], Decomposition] = {}
        self._open_labels = self._labels_with_contacts_open()

    @property
    def parts(self) -> int:
        """Number of independent parts with all contacts open."""
        return len(np.unique(self._open_labels))

    @property
    def spectral_radius(self) -> float:
        """Largest \\|eigenvalue\\| of the present subsystems [1/T]."""
        return max((b.decomposition.propagator.spectral_radius for b in self.present), default=0.0)

    def _labels_with_contacts_open(self) -> Index:
        """Return the component of each unknown with all contacts open, shape (n,)."""
        system = self.system
        laws = zip(system.structure.laws, system.law_rows)
        return components(
            system.size,
            (system.stiffness, system.damping, system.mass),
            [np.flatnonzero(row) for spring, row in laws if not spring.role.collides],
        )

    def _labels(self, branches: Sequence[Branch]) -> Index:
        """Return `_labels_with_contacts_open` after joining the parts that closed contacts connect."""
        labels = self._open_labels.copy()
        for s, b, row in zip(self.system.structure.laws, branches, self.system.law_rows):
            if s.role.collides and (b.stiffness or b.damping or b.constrains):
                parts = np.unique(labels[row != 0])
                if len(parts):
                    labels[np.isin(labels, parts)] = parts[0]
        return labels

    def update(
        self, branches: Sequence[Branch], u: Array, v: Array, charge: Callable[[float], None]
    ) -> None:
        """Form the subsystems of the present branches at displacement `u` and velocity `v`.

        Subsystems that do not change keep their states.  `charge` is called with the cost of each new
        decomposition before it is computed.

        Raises
        ------
        Mechanism
            There are massless DOFs with neither stiffness nor dashpot; the shape covers all unknowns.
        """
        states = {
            key: subsystem.q[part.q]
            for subsystem in self.present
            for key, part in zip(subsystem.keys, subsystem.decomposition.parts)
        }
        decomposed = self._decomposed(branches, charge)
        self.present = []
        for group in self._groups(decomposed):
            keys, constants = zip(*group)
            starts = [
                states[key] if key in states else x.propagator.state_of(u[x.unknowns], v[x.unknowns])
                for key, x in ((key, self.decompositions[key]) for key in keys)
            ]
            decomposition = self._joint_decomposition(keys)
            self.present.append(
                Subsystem(keys, decomposition, np.concatenate(constants), np.concatenate(starts))
            )

    def _decomposed(
        self, branches: Sequence[Branch], charge: Callable[[float], None]
    ) -> list[tuple[Key, Array]]:
        """Return the keys of the present decompositions, which are computed if new, and the constant loads
        of each.
        """
        system, labels = self.system, self._labels(branches)
        acting = [i for i, b in enumerate(branches) if b.stiffness or b.damping or b.force0 or b.constrains]
        decomposed = []
        for label in np.unique(labels):
            unknowns = np.flatnonzero(labels == label)
            laws = np.array([i for i in acting if np.any(system.law_rows[i, unknowns])], np.intp)
            present = (
                (int(i), branches[i].stiffness, branches[i].damping, branches[i].constrains) for i in laws
            )
            key = (int(label), len(unknowns), *present)
            if key not in self.decompositions:
                charge(costs.of_decomposition(len(unknowns)))
                self.decompositions[key] = self._decomposer.decompose(unknowns, laws, branches)
            constants = [branches[i].force0 for i in laws]
            rows = system.law_rows[np.ix_(laws, unknowns)]
            decomposed.append((key, system.constant[unknowns] - rows.T @ constants))
        return decomposed

    def _groups(self, entries: list[tuple[Key, Array]]) -> list[list[tuple[Key, Array]]]:
        """Group the decompositions to be joined."""
        groups: list[list[tuple[Key, Array]]] = []
        room = 0  # number of modes that the first group may still take
        for entry in entries:
            propagator = self.decompositions[entry[0]].propagator
            if not isinstance(propagator, ModalPropagator) or propagator.u_p is not None:
                groups.append([entry])
            elif len(propagator.eigenvalues) <= room:
                groups[0].append(entry)
                room -= len(propagator.eigenvalues)
            else:
                groups.insert(0, [entry])
                room = MAX_JOINED_MODES - len(propagator.eigenvalues)
        return groups

    def _joint_decomposition(self, keys: tuple[Key, ...]) -> Decomposition:
        """Return the joined decomposition of some keys."""
        if len(keys) == 1:
            return self.decompositions[keys[0]]
        if keys not in self._joined:
            self._joined[keys] = self._decomposer.join([self.decompositions[key] for key in keys])
        return self._joined[keys]
