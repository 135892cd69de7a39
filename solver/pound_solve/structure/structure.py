"""The assembled structure: matrices, laws and load vectors over its DOFs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve.numerics import modes
from pound_solve.numerics.matrices import Matrix, entries, gathered, least_squares
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import CorotationalMembers
from pound_solve.structure.dofs import Dof, DofMap
from pound_solve.structure.elements.base import ElementMatrix, ElementParts, Geometric, LawSpring, Output
from pound_solve.structure.mass import MassBlock
from pound_solve.structure.proportional import Proportional


@dataclass
class Structure:
    """The assembled structure.

    Arrays run over `DOFs` columns: the unknowns, then the prescribed DOFs.  Matrices are dense or sparse;
    see `matrices`.

    Attributes
    ----------
    stiffness : Matrix, shape (n, n)
        Linear stiffness without that of laws [F/L].
    initial_stiffness : Matrix, shape (n, n)
        The same with the initial stiffness of all hysteretic laws.
    mass : Matrix, shape (n, n)
        [F T^2/L]
    damping : Matrix, shape (n, n)
        Without the dashpots of laws [F T/L].
    initial_damping : Matrix, shape (n, n)
        The same with the dashpots of hysteretic laws, at their initial stiffness.
    loads : ndarray, shape (n,)
        Static loads [F].
    released : ndarray, shape (n,)
        Part of the loads that a history removes at its start.
    ground : ndarray, shape (3, n)
        ``M r`` for a unit acceleration of the ground along x and y and for a rotation about the origin,
        supports included [F T^2/L], [F T^2].
    laws : tuple of LawSpring
    law_rows : Matrix, shape (n_laws, n)
        Deformation of each law from the DOFs.
    outputs : tuple of Output
        Quantities of the elements outside laws.
    geometric : tuple of Geometric
        Stiffness of the members from their axial forces; empty for small displacements.
    corotational : CorotationalMembers
        Members whose forces follow their displaced chord; over all columns.
    nodal_mass : mapping of Dof to float
        Diagonal mass by node and direction, weights and members.
    self_weight : bool
        Whether the weight of members is among the loads.
    parts : mapping of int to Parts
        Contributions of each element, by element number.
    damping_texts : list of (Card, str)
    proportional : tuple of Proportional
        Damping between nodes other than the dashpots of elements.
    axial_forces : ndarray, shape (n_geometric,)
        Axial forces in the geometric stiffness [F].
    mass_blocks : tuple of MassBlock
        Matrices that add up to `mass`.
    remarks : list of Diagnostic
        Warnings of the assembly.
    basis : Matrix, shape (n_free, n_free), or None
        Z, if modes are restricted to the motions u = Z u; see `tied`.
    """

    model: Model
    dofs: DofMap
    stiffness: Matrix
    initial_stiffness: Matrix
    mass: Matrix
    mass_blocks: tuple[MassBlock, ...]
    damping: Matrix
    initial_damping: Matrix
    loads: Array
    released: Array
    ground: Array
    laws: tuple[LawSpring, ...]
    law_rows: Matrix
    outputs: tuple[Output, ...]
    geometric: tuple[Geometric, ...]
    corotational: CorotationalMembers
    nodal_mass: dict[Dof, float]
    self_weight: bool
    parts: dict[int, ElementParts]
    damping_texts: list[tuple[Card, str]] = field(default_factory=list)
    proportional: tuple[Proportional, ...] = ()
    axial_forces: Array = field(default_factory=lambda: np.zeros(0))
    basis: Matrix | None = None
    remarks: list[Diagnostic] = field(default_factory=list)

    @property
    def n_free(self) -> int:
        """Number of unknown DOFs."""
        return len(self.dofs.free)

    @property
    def retained_loads(self) -> Array:
        """Static loads that remain during a history, shape (n,) [F]."""
        return self.loads - self.released

    @cached_property
    def free_vibration(self) -> modes.Modes:
        """All modes of the initial structure, contacts open."""
        return self.vibration(None)

    def vibration(self, count: int | None) -> modes.Modes:
        """Return at least the `count` slowest modes of the initial structure, contacts open; all if `count`
        is None.
        """
        if "free_vibration" in self.__dict__:
            return self.free_vibration
        slowest = modes.solve(self.constrained(self.initial_stiffness), self.constrained(self.mass), count)
        return slowest if self.basis is None else replace(slowest, shapes=self.basis @ slowest.shapes)

    def constrained(self, k: Matrix) -> Matrix:
        """Part of a matrix over all columns from which modes are computed, shape (n_free, n_free)."""
        free = k[: self.n_free, : self.n_free]
        return free if self.basis is None else self.basis.T @ free @ self.basis

    def axial(self, u: Array) -> Array:
        """Axial forces of the members of `geometric` at displacements `u` of all columns [F]."""
        return np.array([self.dofs.value(g.dofs, g.axial, u) + g.constant for g in self.geometric])

    def stressed(self, axial: Array) -> Structure:
        """Return the structure with the geometric stiffness of these axial forces, shape (n_geometric,)
        [F].
        """
        if not len(axial):
            return self
        rows: dict[tuple[int, str], Array] = {}
        blocks: list[ElementMatrix] = []
        for g, force in zip(self.geometric, axial.tolist()):
            blocks.append(ElementMatrix(g.dofs, force * g.matrix))
            for quantity, row in g.forces.items():
                rows[g.element, quantity] = force * row
        matrix = self.dofs.assembled((b.dofs, b.matrix) for b in blocks)
        outputs = tuple(
            replace(o, u_row=o.u_row + rows.get((o.element, o.quantity), 0.0)) for o in self.outputs
        )
        return replace(
            self,
            stiffness=self.stiffness + matrix,
            initial_stiffness=self.initial_stiffness + matrix,
            outputs=outputs,
            axial_forces=axial,
        )

    def displaced(self, u: Array) -> Structure:
        """Return the structure whose initial stiffness is that at displacements `u` of the unknowns."""
        if not self.corotational:
            return self
        pad = np.zeros(len(self.dofs.moved))
        k = self.initial_stiffness + self.free_block(self.corotational.stiffness(np.append(u, pad)))
        return replace(self, initial_stiffness=k)

    def free_block(self, k: Matrix) -> Matrix:
        """Return the part of a matrix over all columns or over the unknowns that belongs to the unknowns;
        zeros elsewhere.
        """
        (i, j, x), n = entries(k), self.n_free
        inside = (i < n) & (j < n)
        return gathered(self.stiffness.shape, i[inside], j[inside], x[inside])

    def member_forces(self, u: Array) -> Array:
        """All of `outputs` at displacements `u` of all columns and no velocity, shape (n_outputs,)."""
        linear = [self.dofs.value(o.dofs, o.u_row, u) + o.constant for o in self.outputs]
        if not self.corotational:
            return np.array(linear)
        at, share = self.corotational.shares([(o.element, o.quantity) for o in self.outputs])
        actions = self.corotational.actions(self.corotational.quantities(u)[None])[0]
        forces: Array = np.array(linear) + (share * actions[at, 1:]).sum(axis=1)
        return forces

    def influence(self) -> Array:
        """Quasi-static motion of the unknowns for unit prescribed motions, shape (n_free, n_moved)."""
        n = self.n_free
        k = self.initial_stiffness
        return -least_squares(k[:n, :n], k[:n, n:])
