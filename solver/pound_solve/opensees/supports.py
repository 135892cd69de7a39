"""Nodes, supports, slaved directions and masses."""

from __future__ import annotations

from collections.abc import Set

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
        for master in dict.fromkeys(node.slaved.values()):
            _tie(script, node, script.model.nodes[master], moves)
    if script.arms:
        _refuse_chains(script, moves)
    _masses(script)


def _moving(script: Script) -> set[tuple[int, int]]:
    """Degrees of freedom that move: those that something holds or that have mass."""
    structure = script.structure
    used = used_rows(structure.initial_stiffness) | used_rows(structure.mass) | used_rows(structure.damping)
    used |= np.asarray(abs(structure.law_rows).sum(axis=0)).ravel() > 0.0
    return {dof for dof, terms in structure.dofs.terms.items() if any(used[i] for i, _ in terms)}


def _tie(script: Script, node: Node, master: Node, moves: Set[tuple[int, int]]) -> None:
    """Write the directions in which a node follows a master."""
    following = [d for d in range(3) if node.slaved.get(DIRECTIONS[d]) == master.id]
    directions = [d for d in following if (node.id, d) in moves]
    if not directions:
        return
    arms = {0: master.y - node.y, 1: node.x - master.x, 2: 0.0}
    turns = bool(script.structure.dofs.terms[master.id, 2])
    if not turns or not any(arms[d] for d in directions):
        script.call("nodes", "equalDOF", master.id, node.id, *(d + 1 for d in directions))
    elif len(following) == 3:
        script.arms = True
        script.call("nodes", "rigidLink", "beam", master.id, node.id)
    else:
        message = f"node {node.id} follows node {master.id} by an arm in some directions only"
        script.refuse(message, node.span)


def _refuse_chains(script: Script, moves: Set[tuple[int, int]]) -> None:
    """Refuse nodes that follow several others, or one that follows a third, beside rigid arms.

    OpenSees has arms with its constraint handler Transformation only, and such nodes with Plain only.
    """
    for node in script.model.nodes.values():
        masters = {m for d, m in node.slaved.items() if (node.id, DIRECTIONS.index(d)) in moves}
        chained = any(script.model.nodes[master].slaved for master in masters)
        if chained or len(masters) > 1:
            which = "one that follows a third" if chained else "several nodes"
            message = f"node {node.id} follows {which}, and other nodes follow by rigid arms"
            script.refuse(message, node.span, "constraint handlers of OpenSees do one or the other")


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
