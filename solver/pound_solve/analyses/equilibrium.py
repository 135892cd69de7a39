"""Forces of the ground on a structure: reactions, base shear, and the equilibrium of all forces."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pound_solve.laws.automaton import State
from pound_solve.numerics.matrices import by_rows
from pound_solve.numerics.types import Array
from pound_solve.structure.assembly import assemble
from pound_solve.structure.dofs import Dof
from pound_solve.structure.equations import fixed_dofs, rigid_motions
from pound_solve.structure.structure import Structure

#: rounding error of a solution, as a fraction of the terms of a sum of forces
SOLUTION_ROUNDING = 16 * 2.2e-16
SUM_ROUNDING = 1e-9  #: fraction of the largest term below which a sum of forces is zero


class SupportReactions:
    """A structure with its supports released, for the reactions.

    Parameters
    ----------
    structure : Structure
    axial : ndarray, shape (n_geometric,)
        Axial forces in its geometric stiffness.
    nodes : collection of int, or None
        Nodes of the building whose base shear is computed; None: all nodes.

    Attributes
    ----------
    rigid : ndarray, shape (3, n)
        Rigid translations along x and y and rotation about the origin, over all columns.
    """

    def __init__(self, structure: Structure, axial: Array, nodes: Collection[int] | None = None) -> None:
        model = structure.model
        self.nodes = frozenset(model.nodes if nodes is None else nodes)
        bare = assemble(replace(model, damping=()), fixed_dofs(structure), structure.self_weight)
        self.structure, self.n = bare.stressed(axial), bare.n_free
        self.laws = structure.laws  # with changes by damping
        self.geometric = self.structure.stiffness - bare.stiffness
        self.rigid = rigid_motions(bare)
        self.linear, self.nonlinear = self._resistance()

    def _at(self, u: Array, states: Sequence[State]) -> tuple[Array, Array]:
        """Return the displacements of all columns, and the forces of the laws."""
        full = np.append(u, np.zeros(self.structure.dofs.size - self.n))
        d = (self.structure.law_rows @ full).tolist()
        force = [s.force(x, at, 0.0) for s, x, at in zip(self.laws, states, d)]
        return full, np.array(force)

    def reactions(self, u: Array, states: Sequence[State]) -> dict[Dof, float]:
        """Return the forces of the supports on the structure [F], [F L].

        Parameters
        ----------
        u : ndarray, shape (n_free,)
        states : sequence of State
            Of all laws.
        """
        s, (full, force) = self.structure, self._at(u, states)
        whole = s.stiffness @ full + s.corotational.forces(full) + s.law_rows.T @ force - s.loads
        return {f: float(x) for f, x in zip(s.dofs.moved, whole[self.n :])}

    def shear(self, u: Array, states: Sequence[State], d: int, nodes: Sequence[int] | None) -> float:
        """Return the force on the ground in direction `d` [F]: at the supports `nodes`, or at all supports
        of the building and all its elements that end at the ground.
        """
        reactions = self.reactions(u, states)
        if nodes is not None:
            return -sum(reactions.get((node, d), 0.0) for node in nodes)
        total, _ = self._held(*self._at(u, states))
        return float(total[d]) - sum(r for (n, at), r in reactions.items() if at == d and n in self.nodes)

    def balance(self, u: Array, states: Sequence[State]) -> list[tuple[Any, ...]]:
        """Return the rows of the table ``equilibrium``: forces along x and y and moments about the
        origin.
        """
        s, (full, force) = self.structure, self._at(u, states)
        reactions = self.rigid[:, self.n :] @ np.array(list(self.reactions(u, states).values()))
        grounded, couples = self._held(full, force)
        rows = [("loads", self.rigid @ s.loads), ("reactions of the supports", reactions)]
        if any(e.j is None for e in s.model.elements.values()):
            rows.append(("ground below springs and walls with one node", -grounded))
        if couples.any():
            rows.append(("couples that springs and contacts without length do not carry", -couples))
        if s.geometric or s.corotational:
            displaced = self.geometric @ full + s.corotational.forces(full)
            rows.append(("axial forces on displaced members", -self.rigid @ displaced))
        rows.append(("sum", sum(x for _, x in rows)))
        return [(name, *map(float, x)) for name, x in rows]

    def imbalance(self, rows: Sequence[tuple[Any, ...]], u: Array, states: Sequence[State]) -> float:
        """Return the sum of the rows of `balance`, less the rounding error of its terms, as a fraction of
        the largest row.  A moment is also compared with that of the largest force at the far end of the
        structure.
        """
        values = np.abs(np.array([row[1:] for row in rows]))
        force = values[:-1, :2].max()
        moment = max(values[:-1, 2].max(), force * np.abs(self.rigid[2]).max(initial=0.0))
        s, (full, laws) = self.structure, self._at(u, states)
        terms = abs(s.stiffness) @ np.abs(full) + abs(s.law_rows).T @ np.abs(laws) + np.abs(s.loads)
        off = np.maximum(values[-1] - SOLUTION_ROUNDING * (np.abs(self.rigid) @ terms), 0.0)
        return float(max(off[:2].max() / (force or 1.0), off[2] / (moment or 1.0)))

    def _held(self, full: Array, force: Array) -> tuple[Array, Array]:
        """Return the forces and moment of the elements that resist a rigid motion of the structure, shape
        (3,) each: elements of the building that end at the ground, and elements between nodes.
        """
        held = np.array([rows @ full + force @ laws for rows, laws in zip(self.linear, self.nonlinear)])
        return held[0], held[1]

    def _resistance(self) -> tuple[Array, Array]:
        """Return the rows of these forces and moments, shape (2, 3, n), and their factors of the force of
        each law, shape (2, n_laws, 3).
        """
        s = self.structure
        linear = np.zeros((2, *self.rigid.shape))
        for number, parts in s.parts.items():
            if (between := self._place(number)) is None:
                continue
            for b in parts.stiffness:
                moved = [[s.dofs.value([f], [1.0], line) for f in b.dofs] for line in self.rigid]
                for way, force in enumerate(_above_rounding(np.array(moved), b.matrix)):
                    s.dofs.add(linear[between, way], b.dofs, force)
        nonlinear = np.zeros((2, len(s.laws), 3))
        for i, (x, (at, row)) in enumerate(zip(s.laws, by_rows(s.law_rows))):
            if (between := self._place(x.element)) is not None:
                nonlinear[between, i] = _above_rounding(self.rigid[:, at], row)
        return linear, nonlinear

    def _place(self, number: int) -> int | None:
        """Return 0 for an element of the building that ends at the ground, 1 for one between nodes, or
        None.
        """
        element = self.structure.model.elements[number]
        if element.j is None:
            return 0 if element.i in self.nodes else None
        return 1


def _above_rounding(a: Array, b: Array) -> Array:
    """Return ``a @ b`` with entries that are only rounding errors set to zero."""
    product = a @ b
    return np.where(np.abs(product) > SUM_ROUNDING * (np.abs(a) @ np.abs(b)), product, 0.0)
