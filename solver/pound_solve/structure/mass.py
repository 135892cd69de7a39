"""Nodal mass from weights and from the members that end at a node."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from pound_deck.model import Model
from pound_solve.numerics.types import Array
from pound_solve.structure.dofs import DIRECTIONS, Dof, DofMap


class MassBlock(NamedTuple):
    """A small mass matrix on some DOFs, and the nodes that it belongs to [F T^2/L, F T^2, F L T^2]."""

    nodes: frozenset[int]
    dofs: tuple[Dof, ...]
    matrix: Array


def weights(model: Model) -> list[MassBlock]:
    """Mass from the cards of WEIGHTS."""
    mass = []
    for card in model.weights:
        wy = card["WX"] if card["WY"] is None else card["WY"]
        diagonal = np.array([card["WX"], wy, card["WR"]]) / model.gravity
        for node in card["NODES"]:
            mass.append(MassBlock(frozenset([node]), tuple((node, d) for d in range(3)), np.diag(diagonal)))
    return mass


def nodal_mass(model: Model, blocks: Iterable[MassBlock]) -> dict[Dof, float]:
    """Diagonal mass by node and direction; a master includes the mass of its slaves."""
    mass: dict[Dof, float] = {}
    for _, at, matrix in blocks:
        for a, dof in enumerate(at):
            # a consistent matrix is summed along the row in the same direction:
            # the node's share of rigid motion
            same = [b for b, other in enumerate(at) if other[1] == dof[1]] if dof[1] < 2 else [a]
            mass[dof] = mass.get(dof, 0.0) + float(matrix[a, same].sum())
    for node in model.nodes.values():
        for letter, master in node.slaved.items():
            d = DIRECTIONS.index(letter)
            mass[master, d] = mass.get((master, d), 0.0) + mass.get((node.id, d), 0.0)
    return mass


def mass_along(
    model: Model, nodal_mass: Mapping[Dof, float], node: int, normal: tuple[float, float]
) -> float:
    """Effective mass of a node along an oblique direction, 1/m = sum n_d^2 / m_d over directions that can
    move; infinite where none can [F T^2/L].
    """
    inverse = 0.0
    for d, component in enumerate(normal):
        here = model.nodes[node]
        at = (here.slaved.get(DIRECTIONS[d], node), d)
        if component == 0.0 or DIRECTIONS[d] in here.fixed or DIRECTIONS[d] in model.nodes[at[0]].fixed:
            continue
        if nodal_mass.get(at, 0.0) == 0.0:
            return 0.0
        inverse += component**2 / nodal_mass[at]
    return np.inf if inverse == 0.0 else 1.0 / inverse


def ground_inertia(model: Model, dofs: DofMap, blocks: Iterable[MassBlock]) -> Array:
    """``M r`` for a unit acceleration of the ground along x, y and about the origin, shape (3, n)."""
    inertia = np.zeros((3, dofs.size))
    for _, at, matrix in blocks:
        for d in range(3):
            dofs.add(inertia[d], at, matrix @ [_rigid_body(model, f, d) for f in at])
    return inertia


def _rigid_body(model: Model, dof: Dof, d: int) -> float:
    """Displacement of a DOF when the ground moves by one along `d` (2: rotates about the origin)."""
    owner, direction = dof
    if direction > 2:  # internal DOFs of an element are relative to its nodes
        return 0.0
    if d < 2:
        return float(direction == d)
    node = model.nodes[owner]
    return (-node.y, node.x, 1.0)[direction]
