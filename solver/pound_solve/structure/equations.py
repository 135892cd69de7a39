r"""Equations of motion of a structure with released supports, which give the support forces.

The columns are the unknowns, then every fixed direction of every node, moved or not.  The rows of the fixed
directions,

.. math:: R = K u + \sum_i b_i f_i + C \dot u + M \ddot u_a - P

are the forces of the supports on the structure: the forces of all elements that meet the support, the
springs' and dampers' :math:`f_i` with their dashpots among them, damping in proportion to their stiffness,
the inertia of the support's own mass at its total acceleration :math:`\ddot u_a`, less the loads on it.

Mass-proportional and modal damping do not act between two nodes.  They act between each mass and the ground
and bypass the supports, so R excludes them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pound_solve.numerics.matrices import Matrix, entries, gathered, least_squares, used_columns, used_rows
from pound_solve.numerics.matrices import at as values_at
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.assembly import assemble
from pound_solve.structure.corotational import QUANTITIES
from pound_solve.structure.damping.assembly import between_nodes
from pound_solve.structure.dofs import Dof
from pound_solve.structure.reduction import ReducedSystem
from pound_solve.structure.structure import Structure

ROUNDING = 1e-9  #: fraction of its terms below which an entry of a sum of rows is rounding


def fixed_dofs(structure: Structure) -> list[Dof]:
    """All fixed directions of the nodes, moved or not, in the order of the released columns."""
    nodes = structure.model.nodes.values()
    return sorted((n.id, d) for n in nodes for d in range(3) if "XYR"[d] in n.fixed)


def released(structure: Structure) -> Structure:
    """Return the structure with its geometric stiffness on supports that may move; its damping is only the
    part that acts between nodes.
    """
    model = replace(structure.model, damping=())
    bare = assemble(model, fixed_dofs(structure), structure.self_weight)
    damping = bare.damping
    for share in structure.proportional:
        damping = damping + between_nodes(bare, share)
    whole = replace(bare, damping=damping, laws=structure.laws)  # the laws include changes by damping
    return whole.stressed(structure.axial_forces)


@dataclass(frozen=True)
class Weights:
    """Weights of the rows of the equations of motion in sums, one matrix for each kind of term, shape
    (n_sums, n_columns).

    Attributes
    ----------
    elements : Matrix
        Forces of the elements: stiffness, damping between nodes, springs, dampers.
    geometric : Matrix
        Contribution of axial forces to these on displaced members.
    contacts : Matrix
        Forces of the contacts and of the friction in them.
    inertia : Matrix
        Mass times acceleration relative to the ground, if it moves uniformly.
    ridden : Matrix
        Mass times the ground acceleration; with `inertia` it gives the total acceleration.
    ground : Matrix
        Mass-proportional and modal damping.
    loads : Matrix
        Loads, with the sign of the right-hand side: their sum is subtracted.
    """

    elements: Matrix
    geometric: Matrix
    contacts: Matrix
    inertia: Matrix
    ridden: Matrix
    ground: Matrix
    loads: Matrix


def rigid_motions(structure: Structure) -> Array:
    """Rigid translations along x and y and rotation about the origin, over all columns of a released
    structure, shape (3, n_columns); internal DOFs follow without strain.
    """
    columns, k = structure.dofs.free + structure.dofs.moved, structure.initial_stiffness
    rigid = np.array([_rigid(structure, f) for f in columns]).reshape(-1, 3).T
    inside = np.array([d > 2 for _, d in columns], bool) & used_rows(k)
    if inside.any():
        inner, others = np.flatnonzero(inside), np.flatnonzero(~inside)
        pull = k[np.ix_(inner, others)] @ rigid[:, others].T
        rigid[:, inner] = -least_squares(k[np.ix_(inner, inner)], pull).T
    return rigid


def _rigid(structure: Structure, dof: Dof) -> tuple[float, float, float]:
    """Motion of a node's DOF in the rigid translations along x and y and the rotation about the origin."""
    owner, d = dof
    if d > 2:
        return 0.0, 0.0, 0.0
    node = structure.model.nodes[owner]
    return ((1.0, 0.0, -node.y), (0.0, 1.0, node.x), (0.0, 0.0, 1.0))[d]


class Equations:
    """The equations of motion of a history over the released columns.

    Parameters
    ----------
    system : ReducedSystem

    Attributes
    ----------
    structure : Structure
        The released one.
    columns : tuple of Dof
    """

    def __init__(self, system: ReducedSystem) -> None:
        self.system, whole = system, system.structure
        self.structure = free = released(whole)
        self.n, self.columns = whole.n_free, free.dofs.free + free.dofs.moved
        place = {f: i for i, f in enumerate(self.columns)}
        self._moved = [place[f] for f in whole.dofs.moved]
        #: displacements of the fixed columns from the inputs
        self._prescribed = np.zeros((free.dofs.size - self.n, system.excitation.coefs.shape[2]))
        self._prescribed[[c - self.n for c in self._moved]] = system.support_inputs
        blocks = ((g.dofs, x * g.matrix) for g, x in zip(whole.geometric, whole.axial_forces.tolist()))
        self._geometric = free.dofs.assembled(blocks)
        self._ground = self._damping_to_ground()
        #: see `rigid_motions`
        self.rigid = rigid_motions(
            replace(free, initial_stiffness=free.initial_stiffness - self._geometric)
        )
        model = whole.model
        kinds = [model.props[model.elements[s.element].prop].spec.name for s in whole.laws]
        self._contact = np.array([kind == "CONTACT" for kind in kinds], bool)

    def rigid_about(self, x: float, y: float, columns: Index) -> Array:
        """Unit displacements along x and y, and a unit rotation about a point that tips towards +x, over
        some columns, shape (3, len(columns)).
        """
        along, up, turn = self.rigid[:, columns]
        return np.array([along, up, x * up - y * along - turn])

    def _damping_to_ground(self) -> Matrix:
        """Damping of the unknowns that does not act between two nodes, shape (n_columns, n_columns)."""
        i, j, c = entries(self.system.structure.damping[: self.n])
        place = np.concatenate([np.arange(self.n), np.array(self._moved, np.int64)])
        p, q, between = entries(self.structure.damping[: self.n])
        difference = gathered(
            self.structure.damping.shape,
            np.concatenate([i, p]),
            np.concatenate([place[j], q]),
            np.concatenate([c, -between]),
        )
        rows, columns, values = entries(difference)
        kept = np.abs(values) > 1e-12 * np.abs(values_at(self.structure.damping, rows, columns))
        return gathered(difference.shape, rows[kept], columns[kept], values[kept])

    def sums(self, weights: Weights) -> LinearSums:
        """Sums of rows of the equations over the unknowns of the reduced system."""
        system, s = self.system, self.structure
        terms = [
            _product(weights.elements, s.stiffness - self._geometric)
            + _product(weights.geometric, self._geometric),
            _product(weights.elements, s.damping) + _product(weights.ground, self._ground),
            _product(weights.inertia, s.mass),
        ]
        motion, inputs = [], []
        for row in terms:
            free, ruled = row[:, : self.n], row[:, self.n :]
            motion.append(free @ system.expand)
            inputs.append(free @ system.expand_inputs + ruled @ self._prescribed)
        inputs[0] = inputs[0] + weights.ridden @ (s.ground.T @ system.acceleration_inputs)
        inputs[0] = inputs[0] - weights.loads @ self._forces()
        constant = terms[0][:, : self.n] @ system.expand_constant - weights.loads @ s.retained_loads
        of_laws = (weights.elements @ s.law_rows.T) * ~self._contact
        of_laws = of_laws + (weights.contacts @ s.law_rows.T) * self._contact
        turning = _product(weights.geometric, s.corotational.rows.T)
        return LinearSums(system, motion, inputs, constant, of_laws, turning)

    def _forces(self) -> Array:
        """FORCES over the released columns, shape (n_columns, n_inputs)."""
        forces = np.zeros((len(self.columns), self._prescribed.shape[1]))
        for j, force in enumerate(self.system.forces, forces.shape[1] - len(self.system.forces)):
            for node in force.nodes:
                pushed = [(node, d) for d in range(len(force.push))]
                self.structure.dofs.add(forces[:, j], pushed, force.push)
        return forces


class LinearSums:
    """Quantities that are linear in the motion, the laws' forces, the inputs and the forces of corotational
    members.

    Parameters
    ----------
    motion : list of Matrix, shape (n_sums, n)
        On displacements, velocities and accelerations of the unknowns.
    inputs : list of ndarray, shape (n_sums, n_inputs)
        On the inputs and their first two derivatives.
    constant : ndarray, shape (n_sums,)
    of_laws : Matrix, shape (n_sums, n_laws)
        On the forces of the laws, all dashpots included.
    turning : Matrix, shape (n_sums, 6 n_members)
        On the forces on the quantities of the corotational members.

    Attributes
    ----------
    shown : ndarray of bool, shape (n,)
        Unknowns that they depend on directly, not through laws and members.
    acting : ndarray of bool, shape (n_laws,)
    """

    def __init__(
        self, system: ReducedSystem, motion: list[Matrix], inputs: list[Array], constant: Array,
        of_laws: Matrix, turning: Matrix,
    ) -> None:  # fmt: skip
        self.system, self.motion, self.inputs, self.constant = system, motion, inputs, constant
        self.of_laws, self.turning = of_laws, turning
        self.shown: Flags = np.any([used_columns(x) for x in motion], axis=0)
        self.acting: Flags = used_columns(of_laws)
        members = used_columns(turning).reshape(-1, QUANTITIES).any(axis=1)
        self.members: Index = np.flatnonzero(members)

    def turned(self, u: Array, s: Array) -> Array:
        """Contribution of corotational members, shape (n_sums, n_times), at displacements of the unknowns
        and at inputs, shape (n, n_times) each.
        """
        seen = self.system.quantities(u.T, s.T)[:, self.members]
        turned = self.system.structure.corotational.turning(seen, self.members)
        columns = (QUANTITIES * self.members[:, None] + np.arange(QUANTITIES)).ravel()
        return np.asarray(self.turning[:, columns] @ turned.reshape(len(turned), -1).T)


def reactions(equations: Equations, supports: Sequence[int]) -> LinearSums:
    """Forces of supports on the structure in X and Y, and their moments: three sums per support, zero in
    free directions.
    """
    dofs = equations.structure.dofs
    held = frozenset(dofs.moved)
    sums = [((f,), (float(f in held),)) for f in ((node, d) for node in supports for d in range(3))]
    rows = dofs.rows(sums)
    return equations.sums(Weights(rows, rows, rows, rows, rows, 0.0 * rows, rows))


def _product(rows: Matrix, matrix: Matrix) -> Matrix:
    """``rows @ matrix``, with entries that are only rounding set to zero."""
    i, j, x = entries(rows @ matrix)
    kept = np.abs(x) > ROUNDING * values_at(abs(rows) @ abs(matrix), i, j)
    return gathered((rows.shape[0], matrix.shape[1]), i[kept], j[kept], x[kept])
