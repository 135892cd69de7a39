"""Nodes, supports, slaved directions and masses."""

from __future__ import annotations

import numpy as np

from pound_deck.model import Node
from pound_solve.numerics.matrices import used_rows
from pound_solve.opensees.script import Script
from pound_solve.structure.dofs import DIRECTIONS


def nodes(script: Script) -> None:
    """Write all nodes with their supports, then the nodes that follow others, then the masses."""
    moves = _moving(script)
    for node in script.model.nodes.values():
        script.call("nodes", "node", node.id, node.x, node.y)
        fixed = [int((node.id, d) not in moves) for d in range(3)]
        if any(fixed):
            script.call("nodes", "fix", node.id, *fixed)
    for node in script.model.nodes.values():
        if node.slaved:
            _slave(
                script,
                node,
                [d for d in range(3) if DIRECTIONS[d] in node.slaved and (node.id, d) in moves],
            )
    _masses(script)


def _moving(script: Script) -> set[tuple[int, int]]:
    """Degrees of freedom that move: those that something holds or that have mass."""
    structure = script.structure
    used = used_rows(structure.initial_stiffness) | used_rows(structure.mass) | used_rows(structure.damping)
    used |= np.asarray(abs(structure.law_rows).sum(axis=0)).ravel() > 0.0
    return {dof for dof, terms in structure.dofs.terms.items() if any(used[i] for i, _ in terms)}


def _slave(script: Script, node: Node, directions: list[int]) -> None:
    """Write the directions in which a node follows its master."""
    masters = set(node.slaved.values())
    if not directions:
        return
    script.constrained = True
    model = script.model
    (first, *others) = sorted(masters)
    master = model.nodes[first]
    if others:
        script.refuse(f"node {node.id} follows two nodes", node.span)
        return
    if master.slaved:
        script.refuse(f"node {node.id} follows node {first}, which follows another", node.span)
        return
    arms = {0: master.y - node.y, 1: node.x - master.x, 2: 0.0}
    turns = bool(script.structure.dofs.terms[first, 2])
    if turns and any(arms[d] for d in directions):
        if len(node.slaved) == 3:
            script.call("nodes", "rigidLink", "beam", first, node.id)
        else:
            message = f"node {node.id} follows node {first} by an arm in some directions only"
            script.refuse(message, node.span)
        return
    script.call("nodes", "equalDOF", first, node.id, *(d + 1 for d in directions))


def _masses(script: Script) -> None:
    """Write the lumped masses of weights and members."""
    mass: dict[int, list[float]] = {}
    for _, dofs, matrix in script.structure.mass_blocks:
        if (matrix != np.diag(np.diag(matrix))).any():
            heavy = next(p for p in script.model.props.values() if p.values.get("WGT"))
            script.refuse("MASS CONSISTENT of members", heavy.place("WGT"), "write MASS LUMPED")
            return
        for (node, d), value in zip(dofs, np.diag(matrix).tolist()):
            mass.setdefault(node, [0.0, 0.0, 0.0])[d] += value
    for node, values in mass.items():
        if any(values):
            script.call("nodes", "mass", node, *values)
