"""Checks for rigid-body motions that nothing resists while the ground shakes, usually for lack of supports.

A deck with an initial motion or with forces may intend them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Element, Model
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import Building, buildings, stands
from pound_solve.structure.checks.members import members_by_set
from pound_solve.structure.dofs import DIRECTIONS
from pound_solve.structure.elements.base import direction
from pound_solve.structure.elements.beam import INSIDE
from pound_solve.structure.structure import Structure

#: DOFs inside a member: those that turn, and those at its end I
TURNS: Final = (INSIDE[2], INSIDE[5])
ENDS_AT_I: Final = (INSIDE[0], INSIDE[2])
ROUNDING = 1e-9  #: fraction of its terms below which a sum that should be zero is zero


def unsupported_buildings(structure: Structure) -> list[Diagnostic]:
    """Report directions in which nothing connects the structure, or one of its buildings, to the shaken
    ground.
    """
    problems = []
    for way, card in shaken(structure.model).items():
        d = DIRECTIONS.index(way)
        shift = _shift(structure, d)
        if shift @ structure.ground[d] > 0.0 and not resisted(structure, shift[:, None]).any():
            message = f"nothing ties the structure to the ground along {way}: it stays behind as one body"
            hint = f"fix {way} of its base under NODES, or join it to the ground by an element"
            problems.append(Diagnostic("P337", message, card.span, hint, "warning"))
    return problems or _unsupported(structure)


def shaken(model: Model) -> dict[str, Card]:
    """Directions along which the ground moves all supports, with the card that prescribes it; empty if the
    structure has other excitation too.
    """
    if model.initial or model.forces or all(c.spec.name != "HISTORY" for c in model.analyses):
        return {}
    by_direction = {c["DIRECTION"]: c for c in reversed(model.equake) if c["SUPPORTS"] is None}
    return {direction: by_direction[direction] for direction in sorted(by_direction.keys() - {"R"})}


def _unsupported(structure: Structure) -> list[Diagnostic]:
    """Report buildings on shaken ground that can move as a rigid body with open contacts.

    A body without height, such as a ball or a bar between walls, may fly on purpose.
    """
    directions = [DIRECTIONS.index(d) for d in shaken(structure.model)]
    problems = []
    for b in buildings(structure) if directions else ():
        if stands(structure.model, b.nodes) and (free := _free_motion(structure, b, directions)):
            nodes = structure.model.nodes
            base = min(nodes[n].y for n in b.nodes)
            lowest = [n for n in b.nodes if nodes[n].y == base]
            message = f"nothing keeps {b.name!r} from {free} as one body"
            hint = f"fix its base ({some(lowest)}) under NODES, or join it to the ground by an element"
            problems.append(Diagnostic("P337", message, nodes[lowest[0]].span, hint, "warning"))
    return problems


def _free_motion(structure: Structure, b: Building, directions: Sequence[int]) -> str:
    """Describe a rigid-body motion of a building that nothing resists and the ground excites; empty if
    there is none.

    Columns of the matrices here are translations along x and y and a rotation about the middle of the
    building, in units that move its edge by one.
    """
    nodes = [structure.model.nodes[n] for n in b.nodes]
    if any(set(DIRECTIONS) <= set(n.fixed) for n in nodes):
        return ""  # nearly all buildings: skips the matrices
    places = np.array([(n.x, n.y) for n in nodes])
    middle = (places.min(axis=0) + places.max(axis=0)) / 2.0
    size = float(np.ptp(places, axis=0).max()) / 2.0
    rigid = {}
    for n, (x, y) in zip(b.nodes, ((places - middle) / size).tolist()):
        rigid[n] = ((1.0, 0.0, -y), (0.0, 1.0, x), (0.0, 0.0, 1.0 / size))
    motions = _moved(structure, {n: np.array(rows) for n, rows in rigid.items()}, 3)
    motions[structure.n_free :] = 0.0
    held = [rigid[n.id][DIRECTIONS.index(letter)] for n in nodes for letter in n.fixed]
    rows = np.concatenate([np.array(held).reshape(-1, 3), resisted(structure, motions, touching=True)])
    rows = rows[rows.any(axis=1)]
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    value, vector = np.linalg.eigh(rows.T @ rows)
    loose = vector[:, value < ROUNDING]
    inertia = structure.ground[directions] @ motions
    if not (abs(inertia @ loose) > ROUNDING * abs(inertia).max()).any():
        return ""
    for d in range(2):
        if inertia[:, d].any() and np.linalg.norm(loose[d]) > 1.0 - ROUNDING:
            return f"moving along {DIRECTIONS[d]}"
    x, y, turn = loose[:, np.argmax(abs(loose[2]))]
    if not abs(turn) > ROUNDING:
        return "moving"
    about = size * (np.round(middle / size + np.array([-y, x]) / turn, 6) + 0.0)
    return f"turning about x = {about[0]:.4g}, y = {about[1]:.4g}"


def some(nodes: Sequence[int], most: int = 6) -> str:
    """The numbers of the first few of some nodes."""
    return ", ".join(map(str, nodes[:most])) + ", ..." * (len(nodes) > most)


def unmoved_feet(structure: Structure) -> list[Diagnostic]:
    """Report feet of a building that stay fixed while SUPPORTS moves its other feet."""
    model, problems = structure.model, list[Diagnostic]()
    cards = [c for c in model.equake if c["SUPPORTS"] is not None and c["DIRECTION"] != "Y"]
    moved = {n for c in cards for n in c["SUPPORTS"]}
    for b in buildings(structure) if moved else ():
        still = [n for n in b.feet if "X" in model.nodes[n].fixed and n not in moved]
        if still and not moved.isdisjoint(b.feet):
            message = f"no motion has node {some(still)} of {b.name!r} among its SUPPORTS: it stands still"
            hint = "name all feet of the building, or leave SUPPORTS out, which moves the whole base"
            problems.append(Diagnostic("P372", message, cards[0].place("SUPPORTS"), hint, "warning"))
    return problems


def _shift(structure: Structure, d: int) -> Array:
    """Unit rigid-body displacement of the free DOFs along direction `d`; the supports stay."""
    motions = _moved(structure, dict.fromkeys(structure.model.nodes, np.eye(3)[:, [d]]), 1)[:, 0]
    motions[structure.n_free :] = 0.0
    return motions


def _moved(structure: Structure, motions: Mapping[int, Array], count: int) -> Array:
    """Motions over all columns: the given ones of some nodes, those of the beam ends between them, zero
    elsewhere.

    Parameters
    ----------
    motions : mapping of int to ndarray, shape (3, count)
        Keyed by node: translations along x and y, and the rotation.
    """
    columns = [*structure.dofs.free, *structure.dofs.moved]
    moved = np.zeros((len(columns), count))
    beams = {e.id: e for members in members_by_set(structure.model).values() for e in members}
    for row, (owner, d) in zip(moved, columns):
        if d < 3:
            row[:] = motions[owner][d] if owner in motions else 0.0
        elif (e := beams.get(owner)) is not None and e.i in motions and e.j is not None:
            row[:] = _inside(structure.model, e, e.j, d, motions)
    return moved


def _inside(model: Model, e: Element, j: int, d: int, motions: Mapping[int, Array]) -> Array:
    """Motion of a beam end behind a hinge that moves with its node: a rotation, or along the member."""
    end = motions[e.i if d in ENDS_AT_I else j]
    if d in TURNS:
        return np.asarray(end[2])
    c, s = direction(model.nodes[j].x - model.nodes[e.i].x, model.nodes[j].y - model.nodes[e.i].y)
    return np.asarray(c * end[0] + s * end[1])


def resisted(structure: Structure, motions: Array, touching: bool = False) -> Array:
    """Resistance to motions: forces of the initial stiffness and of dashpots, deformations of laws.

    Parameters
    ----------
    motions : ndarray, shape (n, n_motions)
    touching : bool
        Whether contacts count only if they are closed at rest.

    Returns
    -------
    ndarray, shape (n_found, n_motions)
        Exact zeros where terms cancel.
    """
    dofs, laws = structure.dofs, structure.laws
    apart = {s.element for s in laws if touching and s.role.collides and s.gap > 0.0}
    ties = np.array([i for i, s in enumerate(laws) if s.element not in apart], np.int64)
    resistances = []
    for a in (
        structure.displaced(np.zeros(structure.n_free)).initial_stiffness,
        structure.law_rows[ties],
        *(b.matrix @ dofs.matrix(b.dofs) for p in structure.parts.values() for b in p.damping),
    ):
        resistance = np.asarray(a @ motions)
        noise = (
            ROUNDING**2 * abs(a).max() * abs(motions).max() if 0 not in (*a.shape, motions.size) else 0.0
        )
        resistance[abs(resistance) <= ROUNDING * (abs(a) @ abs(motions)) + noise] = 0.0
        resistances.append(resistance)
    return np.concatenate(resistances)
