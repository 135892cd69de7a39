r"""Forces between a building and the ground and between its storeys, drifts and accelerations of floors.

All are sums over rows of the equations of motion (`equations`), weighted by a rigid motion r: a unit
displacement along x or y, or a unit rotation that tips the building towards +x.  With the forces of the
elements :math:`e`, of the contacts :math:`c`, the inertia :math:`M\ddot u_a`, the mass-proportional and
modal damping :math:`g` and the loads P

.. math:: V = r_f^T e - r_s^T (M\ddot u_a + c - P)
            = -r^T (M\ddot u_a + c - P) - r_f^T g

over the unknowns (f) and the fixed directions (s) of a building: what its supports, and the elements that
end at the ground, transmit to it, or the inertia and the loads of the whole building. Both are equal if the
equations of motion are satisfied.  Forces of contacts with other buildings or walls and damping between
masses and the ground count as loads on the building here, not as part of V.

The shear of a storey is :math:`r_a^T e` over all rows above the middle of its height: elements wholly above
cancel, which leaves the force of all elements that cross the storey or connect the part above to the
ground.  Moments are taken about the foot of the storey at the axis of the building.  They include the axial
forces of members inclined by displacement (P-Delta), because the linear forces alone already give the
moments of the displaced structure.  They exclude the additional end moments of bent members (PDELTA_MEMBER,
LARGE).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

import numpy as np

from pound_solve.numerics.matrices import Matrix, gathered
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.buildings import Building, columns_of
from pound_solve.structure.equations import Equations, LinearSums, Weights
from pound_solve.structure.reduction import ReducedSystem

#: rows of a matrix that have values in some columns only: the columns, the values of all rows in them
Block: TypeAlias = tuple[Index, Array]


def base_sums(equations: Equations, buildings: Sequence[Building]) -> LinearSums:
    """Force of every building on the ground along x and y, and its overturning moment: three sums each."""
    rows, n = _rigid(equations, buildings), equations.n
    inner = _matrix([(k, x * (k < n)) for k, x in rows], equations)
    held = _matrix([(k, -x * (k >= n)) for k, x in rows], equations)
    return equations.sums(Weights(inner, held, held, held, held, 0.0 * held, held))


def imbalance_sums(equations: Equations, buildings: Sequence[Building]) -> LinearSums:
    """Three groups of sums over the unknowns of every building, each along x, along y and of moments: the
    residual of the equations of motion; the total inertia in it; the loads and the inertia in the ground's
    motion, which drive the building.

    They give the size of the terms for a building that is detached from the ground. Inertia alone does not:
    a body that nothing touches stays in place while the ground moves.
    """
    inner = [(k, x * (k < equations.n)) for k, x in _rigid(equations, buildings)]
    none = [(k, 0.0 * x) for k, x in inner]
    all_of = _matrix([*inner, *none, *none], equations)
    inertia = _matrix([*inner, *inner, *none], equations)
    ridden = _matrix([*inner, *inner, *inner], equations)
    loads = _matrix([*inner, *none, *inner], equations)
    return equations.sums(Weights(all_of, all_of, all_of, inertia, ridden, all_of, loads))


def storey_sums(equations: Equations, buildings: Sequence[Building]) -> LinearSums:
    """Shear and overturning moment of every storey, two sums each: the action of the part above on the part
    below.
    """
    model, elements, geometric = equations.structure.model, list[Block](), list[Block]()
    y = {n.id: n.y for n in model.nodes.values()}
    feet = [(b, *ends) for b in buildings for ends in zip(b.levels, b.levels[1:])]
    nodes = [[n for n in b.nodes if y[n] > 0.5 * (foot + top)] for b, foot, top in feet]
    for (b, foot, _), above in zip(feet, columns_of(model, equations.columns, nodes)):
        x, _, turn = equations.rigid_about(b.axis, foot, above)
        elements.append((above, np.array([x, turn])))
        geometric.append((above, np.array([x, 0.0 * turn])))
    rigid, turned = (_matrix(rows, equations) for rows in (elements, geometric))
    nothing = 0.0 * rigid
    return equations.sums(Weights(rigid, turned, nothing, nothing, nothing, nothing, nothing))


def drift_sums(system: ReducedSystem, buildings: Sequence[Building]) -> LinearSums:
    """Drift ratio of every storey: mean displacement of its floor along x, weighted by mass, less that of
    the floor below, or of the feet, over the height of the storey.
    """
    rows: list[tuple[list[tuple[int, int]], list[float]]] = []
    for b in buildings:
        means = [
            (b.feet, np.full(len(b.feet), 1.0 / len(b.feet))),
            *((f.nodes, f.shares) for f in b.floors),
        ]
        for (low, share), (high, above), foot, top in zip(means, means[1:], b.levels, b.levels[1:]):
            values = np.concatenate([above, -share]) / (top - foot)
            rows.append(([(n, 0) for n in (*high, *low)], values.tolist()))
    of_u, on_inputs, constant = system.reduce_rows(system.structure.dofs.rows(rows))
    return _sums(
        system, [of_u, 0.0 * of_u, 0.0 * of_u], [on_inputs, 0.0 * on_inputs, 0.0 * on_inputs], constant
    )


def acceleration_sums(system: ReducedSystem, buildings: Sequence[Building]) -> LinearSums:
    """Mean total acceleration of every floor along x, weighted by mass."""
    floors = [f for b in buildings for f in b.floors]
    rows = [([(n, 0) for n in f.nodes], f.shares.tolist()) for f in floors]
    of_a, on_inputs, constant = system.reduce_rows(system.structure.dofs.rows(rows))
    ridden = np.array([[1.0, 0.0, -f.level] for f in floors]).reshape(-1, 3) @ system.acceleration_inputs
    nothing = 0.0 * of_a
    return _sums(system, [nothing, nothing, of_a], [ridden, 0.0 * on_inputs, on_inputs], 0.0 * constant)


def storeys(buildings: Sequence[Building]) -> Iterator[tuple[Building, int]]:
    """Buildings and numbers of all storeys from 1 on, in the order of the sums."""
    for b in buildings:
        for i in range(len(b.floors)):
            yield b, i + 1


def _sums(system: ReducedSystem, motion: list[Matrix], inputs: list[Array], constant: Array) -> LinearSums:
    """Sums that depend on the motion and inputs only, not on forces of laws and members."""
    laws, members = len(system.structure.laws), 6 * len(system.structure.corotational)
    nothing = (gathered((len(constant), n), [], [], []) for n in (laws, members))
    return LinearSums(system, motion, inputs, constant, *nothing)


def _rigid(equations: Equations, buildings: Sequence[Building]) -> list[Block]:
    """Rigid motions of every building about the foot of its axis: three rows each."""
    columns = columns_of(equations.structure.model, equations.columns, [b.nodes for b in buildings])
    return [(k, equations.rigid_about(b.axis, b.base, k)) for b, k in zip(buildings, columns)]


def _matrix(blocks: Sequence[Block], equations: Equations) -> Matrix:
    """Blocks of rows one below the other."""
    i, j, x, first = list[Index](), list[Index](), list[Array](), 0
    for columns, values in blocks:
        row, column = np.nonzero(values)
        i.append(first + row)
        j.append(columns[column])
        x.append(values[row, column])
        first += len(values)
    shape = first, len(equations.columns)
    return gathered(shape, *(np.concatenate([np.zeros(0), *parts]) for parts in (i, j, x)))
