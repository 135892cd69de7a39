"""The forces of a pushover per unit load factor."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from pound_deck.model import Card
from pound_solve.analyses.path_following import EquilibriumPath
from pound_solve.numerics import modes
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import columns_of
from pound_solve.structure.structure import Structure

SOUGHT = 12  #: slowest modes of a large structure among which the pattern is chosen


class LoadPattern:
    """The forces of a PATTERN on the pushed nodes, per unit load factor.

    Parameters
    ----------
    structure : Structure
    card : Card
    building : collection of int, or None
        Nodes of the pushed building; None: all nodes.

    Attributes
    ----------
    forces : ndarray, shape (n_free,)
        Present forces; zeros outside the pattern, and before the first mode is known.
    mass : float
        Mass of the pushed nodes [F T^2/L].
    """

    def __init__(self, structure: Structure, card: Card, building: Collection[int] | None) -> None:
        building = tuple(structure.model.nodes) if building is None else building
        n, d = structure.n_free, "XY".index(card["DIRECTION"])
        model, dofs = structure.model, structure.dofs
        kind, nodes = card["PATTERN"], card["NODES"]
        self.by_mode, self._stiff = kind == "MODE", 1
        self.along = np.array([float(at == d) for _, at in dofs.free])  # unit motion of the whole
        pushed = np.zeros(n)
        for node in building if nodes is None else nodes:
            pushed[[i for i, _ in dofs.terms[node, d] if i < n]] = 1.0
        self.structure_mass = structure.mass[:n, :n]
        self.pushed = pushed * self.along
        self.mass = float(self._share(np.ones(n)).sum())
        self.forces = np.zeros(n)
        if kind == "LOADS":
            (columns,) = columns_of(model, dofs.free, [building])
            self.forces[columns] = structure.loads[columns]
        elif kind == "FORCES":
            self.forces = dofs.row([(node, d) for node in nodes], card["FORCES"])[:n]
        elif kind == "UNIFORM":
            self.forces = self._of(np.ones(n))
        elif kind == "TRIANGULAR":
            base = min((model.nodes[x].y for x in building if model.nodes[x].fixed), default=0.0)
            height = [model.nodes[owner].y - base if at == d else 0.0 for owner, at in dofs.free]
            self.forces = self._of(np.array(height))

    def _share(self, shape: Array) -> Array:
        """Return forces proportional to mass times a shape, on the pushed DOFs."""
        return np.asarray(self.pushed * (self.structure_mass @ (self.along * shape)))

    def _of(self, shape: Array) -> Array:
        """Return forces proportional to mass times a shape, with unit sum."""
        p = self._share(shape)
        total = float(p.sum())
        return p / total if abs(total) > 1e-12 * np.abs(p).sum() else 0.0 * p

    def follow(self, path: EquilibriumPath) -> Array:
        """Return the forces at the present point of a path; a modal PATTERN follows the present tangent
        stiffness.
        """
        if self.by_mode:
            try:
                reduced = path.constraints.reduced_matrix
                vibration = modes.solve(reduced(path.tangent()), reduced(self.structure_mass), SOUGHT)
            except np.linalg.LinAlgError:
                return self.forces  # a part without mass has become a mechanism
            stiff = path.constraints.expand(vibration.shapes[:, vibration.omega > 0.0])
            if stiff.shape[1] >= self._stiff:  # otherwise some motion has no resistance any more
                self._stiff = stiff.shape[1]
                effective = ((self.along * (self.structure_mass @ self.pushed)) @ stiff) ** 2
                self.forces = self._of(stiff[:, int(np.argmax(effective))])
        return self.forces
