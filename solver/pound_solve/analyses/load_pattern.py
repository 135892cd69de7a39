"""The forces of a pushover per unit load factor."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_deck.model import Card
from pound_solve.analyses.path_following import EquilibriumPath
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.numerics import modes
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import columns_of
from pound_solve.structure.structure import Structure

#: share of the mass-weighted shape below which the control node counts as a node at rest
AT_REST: Final = 1e-9
SOUGHT: Final = 12  #: slowest modes of a large structure among which the pattern is chosen


@dataclass(frozen=True)
class EquivalentSystem:
    r"""The oscillator that stands for a building in the N2 method (EN 1998-1:2004, B.2; Fajfar 2000).

    The shape :math:`\phi` of the pattern is one at the control node:

    .. math:: m^* = \sum_i m_i \phi_i, \qquad \Gamma = m^* \Big/ \sum_i m_i \phi_i^2

    Attributes
    ----------
    mass : float
        :math:`m^*` [F T^2/L].
    factor : float
        :math:`\Gamma`, displacement of the control node over that of the oscillator.
    whole_mass : float
        Mass of the building along the push [F T^2/L].
    """

    mass: float
    factor: float
    whole_mass: float


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
    shape : ndarray, shape (n_free,), or None
        Motion whose inertia the present forces are; None for FORCES and LOADS.
    """

    def __init__(self, structure: Structure, card: Card, building: Collection[int] | None) -> None:
        building = tuple(structure.model.nodes) if building is None else building
        n, d = structure.n_free, "XY".index(card["DIRECTION"])
        model, dofs = structure.model, structure.dofs
        kind, nodes = card["PATTERN"], card["NODES"]
        self.by_mode, self._stiff = kind == "MODE", 1
        self.along = np.array([float(at == d) for _, at in dofs.free])  # unit motion of the whole
        self.structure_mass = structure.mass[:n, :n]

        def moved(nodes: Collection[int]) -> Array:
            columns = np.zeros(n)
            for node in nodes:
                columns[[i for i, _ in dofs.terms[node, d] if i < n]] = 1.0
            return np.asarray(columns * self.along)

        self.of_building = moved(building)
        self.pushed = self.of_building if nodes is None else moved(nodes)
        self.mass = float(self._share(np.ones(n)).sum())
        self.forces = np.zeros(n)
        self.shape: Array | None = None
        self.all_nodes = nodes is None  # the forces are then the inertia of the whole building in the shape
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
        self.shape = shape
        return p / total if abs(total) > 1e-12 * np.abs(p).sum() else 0.0 * p

    def equivalent(self, control: Array, path: EquilibriumPath) -> EquivalentSystem | None:
        """Return the oscillator that stands for the building; None without mass or if the control node
        stays at rest.  The shape is that of the pattern where this pushes all nodes, else the deflection of
        the first step.
        """
        try:
            shape = self.shape if self.all_nodes else None
            shape = path.rates(path.u, path.factor).displacement if shape is None else shape
        except InstabilityError:
            return None  # a mechanism, until a contact closes
        at_control = float(control @ shape)
        if abs(at_control) <= AT_REST * float(np.abs(shape).max(initial=0.0)):
            return None
        phi = self.along * shape / at_control
        inertia = self.of_building * (self.structure_mass @ phi)
        mass, square = float(inertia.sum()), float(inertia @ phi)
        whole = float((self.of_building * (self.structure_mass @ self.along)).sum())
        return EquivalentSystem(mass, mass / square, whole) if mass > 0.0 else None

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
