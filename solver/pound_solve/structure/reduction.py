r"""The reduced system: the equations of motion of a history, without idle DOFs.

DOFs that nothing can set in motion are dropped; the others follow

.. math:: M\ddot u + C\dot u + K u + \sum_i b_i f_i(d_i, \dot d_i) = F s(t) + p_0, \qquad
          d_i = b_i^T u + e_i^T s(t)

with the laws' forces :math:`f_i`, the inputs :math:`s(t)` (ground accelerations, or displacement,
velocity and acceleration of moved supports; histories of forces) and constant loads :math:`p_0`.

Displacements are relative to the ground if the whole base moves uniformly, and total with motions of
SUPPORTS.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pound_solve.loading.excitation import Excitation
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import GroundMotion, Piecewise, common_breaks
from pound_solve.numerics.graph import components
from pound_solve.numerics.matrices import Matrix, by_rows, entries, gathered, selection, used_rows
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.corotational import QUANTITIES, CorotationalMembers
from pound_solve.structure.dofs import NAMES, Dof, label, labels
from pound_solve.structure.reduction_checks import check_inertia, check_jumps
from pound_solve.structure.structure import Structure


@dataclass(frozen=True)
class Decision:
    """One line of the report's table `scene`: an omission or choice, with its reason."""

    subject: str
    decision: str
    why: str


@dataclass
class ReducedSystem:
    """The reduced problem of a history; see the module's head.

    Attributes
    ----------
    dofs : tuple of Dof
        The n unknowns that remain.
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
        Acceleration of the ground along x and y and about the origin, from s;
        zero rows in the total form.
    force_inputs : ndarray, shape (n_free, n_inputs)
        Part of F from FORCES, on all unknown DOFs.
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
    motions: Sequence[GroundMotion]
    forces: Sequence[Force]
    decisions: list[Decision] = field(default_factory=list)

    def all_dofs(self, u: Array, t: float, order: int = 0) -> Array:
        """All columns of the structure, prescribed ones included, from the unknowns' motion at `t`.

        With `order` 1 or 2 `u` is their velocity or acceleration, and so is the result.
        """
        return self.expanded(u, self.excitation.value(t, order), order)

    def expanded(self, u: Array, s: Array, order: int = 0) -> Array:
        """`all_dofs` from inputs `s` (of the same order of derivative);
        columns are instants where there are several.
        """
        free = self.expand @ u + self.expand_inputs @ s
        if order == 0:
            free = (free.T + self.expand_constant).T
        return np.concatenate([free, self.support_inputs @ s])

    def reduce_rows(self, rows: Matrix) -> tuple[Matrix, Array, Array]:
        """Convert rows over all columns of the structure to rows over unknowns and over inputs, and
        constants.
        """
        n = self.structure.n_free
        free = rows[:, :n]
        over = free @ self.expand
        return (
            gathered(over.shape, *entries(over)),
            free @ self.expand_inputs + rows[:, n:] @ self.support_inputs,
            free @ self.expand_constant,
        )

    def applied(self, s: Array) -> Array:
        """Return the held loads and FORCES on all unknown DOFs at inputs `s`, shape (n_free,) [F, F L].

        Several instants are columns.
        """
        constant = self.structure.retained_loads[: self.structure.n_free]
        return ((self.force_inputs @ s).T + constant).T

    @cached_property
    def corotational(self) -> CorotationalMembers:
        """The corotational members over the unknowns."""
        return self.structure.corotational.on(self.columns)

    @cached_property
    def corotational_inputs(self) -> Array:
        """Their quantities from the inputs, shape (n_members, 6, n_inputs)."""
        corotational = self.structure.corotational
        quantities = corotational.rows[:, self.structure.n_free :] @ self.support_inputs
        return np.asarray(quantities, float).reshape(len(corotational), QUANTITIES, quantities.shape[1])

    def quantities(self, u: Array, s: Array) -> Array:
        """Quantities of the members, shape (n_times, n_members, 6), for rows of unknowns and of inputs."""
        quantities = (u @ self.corotational.rows.T).reshape(len(u), len(self.corotational), QUANTITIES)
        return np.asarray(quantities + np.einsum("ti,cji->tcj", s, self.corotational_inputs), float)

    @property
    def columns(self) -> list[int]:
        """Columns of the unknowns in the structure's matrices."""
        column = {f: i for i, f in enumerate(self.structure.dofs.free)}
        return [column[f] for f in self.dofs]

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.dofs)

    def name(self, index: int) -> str:
        """Name of an unknown in words."""
        return label(self.dofs[index])

    def explain_massless(self, index: int, softens: bool = False) -> str:
        """Explain in words why a massless unknown has no equilibrium, and the remedy.

        Parameters
        ----------
        index : int
        softens : bool
            Its stiffness is negative; otherwise it is zero.
        """
        owner, d = self.dofs[index]
        if not softens:
            return f"{self.name(index)} has no mass and nothing holds it"
        if d >= len(NAMES):
            remedy = f"give element {owner} a flatter softening branch, or a longer LP"
        else:
            remedy = "give the joints WR in WEIGHTS" if NAMES[d] == "rz" else "give it weight"
        why = "its stiffness has become negative: it snaps through"
        return f"{self.name(index)} has no mass, and {why}; {remedy}"


def moved_supports(motions: Sequence[GroundMotion], fixed: Sequence[Dof]) -> tuple[Dof, ...]:
    """Fixed DOFs that the motions with SUPPORTS prescribe."""
    moved: set[Dof] = set()
    for m in motions:
        if m.supports is not None:
            moved |= {(node, d) for node in m.supports for d in m.directions}
    return tuple(sorted(moved & set(fixed)))


def build(
    structure: Structure,
    motions: Sequence[GroundMotion],
    t_end: float,
    start: Array,
    start_rate: Array,
    forces: Sequence[Force] = (),
) -> ReducedSystem:
    """Reduce a structure to the unknowns that its history needs.

    Parameters
    ----------
    structure : Structure
    motions : sequence of GroundMotion
    t_end : float
        Length of the history [T].
    start, start_rate : ndarray, shape (n_free,)
        Displacement and velocity at t = 0: DOFs that start in motion stay.
    forces : sequence of Force

    Raises
    ------
    ReductionError
        Mass on arms of slaved nodes leaves some motion without inertia; or a force that jumps on a massless
        DOF would deform a hysteretic spring instantaneously.
    """
    n, dofs = structure.n_free, structure.dofs.free
    inputs = _inputs(structure, motions, forces, t_end)
    live = _excited_unknowns(structure, inputs, start, start_rate)
    keep = np.flatnonzero(live)
    mass, damping, stiffness = (
        a[np.ix_(keep, keep)] for a in (structure.mass, structure.damping, structure.stiffness)
    )
    check_inertia(mass, [dofs[i] for i in keep])
    check_jumps(structure, inputs.applied[:, inputs.excitation.jumps()], live)
    return ReducedSystem(
        structure=structure,
        dofs=tuple(dofs[i] for i in keep),
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        inputs=inputs.forces[keep],
        constant=structure.retained_loads[keep],
        law_rows=structure.law_rows[:, keep],
        law_inputs=structure.law_rows[:, n:] @ inputs.supports,
        excitation=inputs.excitation,
        expand=selection(n, keep),
        expand_constant=np.zeros(n),
        expand_inputs=np.zeros_like(inputs.forces),
        support_inputs=inputs.supports,
        total=bool(structure.dofs.moved),
        acceleration_inputs=inputs.ground,
        force_inputs=inputs.applied,
        motions=motions,
        forces=forces,
        decisions=_decisions([f for f, kept in zip(dofs, live) if not kept], n),
    )


def _decisions(dropped: Sequence[Dof], n: int) -> list[Decision]:
    """Decisions about the dropped DOFs, for the report."""
    if not dropped:
        return []
    why = "nothing sets them in motion: " + labels(dropped)
    return [Decision(f"{len(dropped)} of {n} degrees of freedom", "dropped", why)]


class Inputs(NamedTuple):
    """The excitation and its distribution; one column for each input.

    Attributes
    ----------
    excitation : Excitation
    forces : ndarray, shape (n_free, n_inputs)
        On the unknowns.
    supports : ndarray, shape (n_moved, n_inputs)
        Prescribed displacements.
    ground : ndarray, shape (3, n_inputs)
        Acceleration of the ground along x and y and about the origin.
    applied : ndarray, shape (n_free, n_inputs)
        Part of `forces` from FORCES.
    """

    excitation: Excitation
    forces: Array
    supports: Array
    ground: Array
    applied: Array


def _inputs(
    structure: Structure, motions: Sequence[GroundMotion], forces: Sequence[Force], t_end: float
) -> Inputs:
    """Inputs of the motions (three each where supports move: displacement, velocity, acceleration; else the
    acceleration alone), then of FORCES.
    """
    n, moved = structure.n_free, structure.dofs.moved
    each = 3 if moved else 1
    count = each * len(motions) + len(forces)
    inertial, applied = np.zeros((n, count)), np.zeros((n, count))
    supports, ground = np.zeros((len(moved), count)), np.zeros((3, count))
    histories: list[Piecewise] = []
    for j, motion in enumerate(motions):
        at = each * j
        if moved:
            supports[:, at] = shares = _support_shares(structure, motion)
            for k, matrix in enumerate((structure.stiffness, structure.damping, structure.mass)):
                inertial[:, at + k] = -matrix[:n, n:] @ shares
            histories += [motion.displacement(t_end), motion.velocity(t_end), motion.acceleration]
        else:
            ground[:, at] = [motion.share(d, 0.0, 0.0) for d in range(3)]
            inertial[:, at] = -ground[:, at] @ structure.ground[:, :n]
            histories.append(motion.acceleration)
    for j, force in enumerate(forces, each * len(motions)):
        row = np.zeros(structure.dofs.size)
        for node in force.nodes:
            structure.dofs.add(row, [(node, d) for d in range(len(force.push))], force.push)
        applied[:, j] = row[:n]
        histories.append(force.history)
    breaks = common_breaks([*(m.acceleration for m in motions), *(f.history for f in forces)], t_end)
    return Inputs(Excitation.of(histories, breaks), inertial + applied, supports, ground, applied)


def _support_shares(structure: Structure, motion: GroundMotion) -> list[float]:
    """Displacement of every prescribed DOF for a unit motion, shape (n_moved,)."""
    nodes, supports = structure.model.nodes, motion.supports or ()
    return [
        motion.share(d, nodes[node].x, nodes[node].y) if node in supports else 0.0
        for node, d in structure.dofs.moved
    ]


def _excited_unknowns(structure: Structure, inputs: Inputs, start: Array, start_rate: Array) -> Flags:
    """Which unknowns can be set in motion: all that are coupled, directly or through others, to one that is
    loaded or starts in motion.
    """
    n = structure.n_free
    matrices = [a[:n, :n] for a in (structure.stiffness, structure.damping, structure.mass)]
    real = np.any([used_rows(a) for a in matrices], axis=0)  # the others do not take part
    driven = (start != 0) | (start_rate != 0) | (structure.retained_loads[:n] != 0)
    driven |= np.any(inputs.forces[:, inputs.excitation.active] != 0, axis=1)
    groups = [touched for touched, _ in structure.corotational.on(slice(n)).touched()]
    for spring, (row, _) in zip(structure.laws, by_rows(structure.law_rows)):
        touched = row[row < n]
        groups.append(touched)
        real[touched] = True
        if spring.law.force(spring.law.start(), 0.0)[0] != 0 or np.any(row >= n):
            driven[touched] = True
    component = components(n, matrices, groups)
    return np.asarray(np.isin(component, component[driven]) & real)
