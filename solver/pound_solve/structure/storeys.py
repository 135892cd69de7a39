r"""Forces between a building and the ground and between its storeys, drifts and accelerations of floors.

All are sums over rows of the equations of motion (`equations`), weighted by a rigid motion r: a unit
displacement along x or y, or a turn by one that tips the building towards +x.  With the forces of the
elements :math:`e`, of the contacts :math:`c`, the inertia :math:`M\ddot u_a`, the mass-proportional and
modal damping :math:`g` and the loads P

.. math:: V = r_f^T e - r_s^T (M\ddot u_a + c - P)
            = -r^T (M\ddot u_a + c - P) - r_f^T g

over the unknowns (f) and the fixed directions (s) of a building: what its supports, and the elements that
end at the ground, transmit to it, or the inertia and the loads of the whole building.  Both are equal where
the equations of motion hold.  Forces of contacts with other buildings or walls and damping between masses
and the ground are loads on the building here, and no part of V.

The shear of a storey is :math:`r_a^T e` over all rows above the middle of its height: elements wholly above
cancel in it, so that it is the force of all elements that cross the storey, or stand between what is above
and the ground.  Moments count about the foot of the storey at the axis of the building; the axial forces of
members that stand inclined after a displacement (P-Delta) are in them, because the moments of the linear
forces alone are those of the displaced structure; what these add to the end moments of bent members
(PDELTA_MEMBER, LARGE) is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pound_solve.numerics.matrices import Matrix, gathered
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.buildings import Building, columns_of
from pound_solve.structure.equations import Equations, LinearSums, Weights
from pound_solve.structure.reduction import ReducedSystem


def base_sums(equations: Equations, buildings: Sequence[Building]) -> LinearSums:
    """Force of every building on the ground along x and y, and its overturning moment: three sums each."""
    rows = [equations.rigid_about(b.axis, b.base) * _own(equations, b.nodes) for b in buildings]
    whole = _stacked(rows, equations)
    inner = whole * (np.arange(whole.shape[1]) < equations.n)
    held = inner - whole
    return equations.sums(Weights(*map(_matrix, (inner, held, held, held, 0.0 * held, held))))


def imbalance_sums(equations: Equations, buildings: Sequence[Building]) -> LinearSums:
    """What is left of the equations of motion, summed over the unknowns of every building as above; then
    the inertia among it, which tells its size where a building does not stand on the ground.
    """
    rows = [equations.rigid_about(b.axis, b.base) * _own(equations, b.nodes) for b in buildings]
    inner = _stacked(rows, equations)
    inner[:, equations.n :] = 0.0
    twice, once = _matrix(np.vstack([inner, inner])), _matrix(np.vstack([inner, 0.0 * inner]))
    return equations.sums(Weights(once, once, once, twice, once, once))


def storey_sums(equations: Equations, buildings: Sequence[Building]) -> LinearSums:
    """Shear and overturning moment of every storey, two sums each: of what is above on what is below."""
    elements, geometric = [], []
    y = {n.id: n.y for n in equations.structure.model.nodes.values()}
    for b in buildings:
        for foot, top in zip(b.levels, b.levels[1:]):
            above = _own(equations, [n for n in b.nodes if y[n] > 0.5 * (foot + top)])
            x, _, turn = equations.rigid_about(b.axis, foot) * above
            elements.append(np.array([x, turn]))
            geometric.append(np.array([x, 0.0 * turn]))
    own, turned = (_matrix(_stacked(r, equations)) for r in (elements, geometric))
    nothing = 0.0 * own
    return equations.sums(Weights(own, turned, nothing, nothing, nothing, nothing))


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
        for (low, share), (high, own), foot, top in zip(means, means[1:], b.levels, b.levels[1:]):
            values = np.concatenate([own, -share]) / (top - foot)
            rows.append(([(n, 0) for n in (*high, *low)], values.tolist()))
    of_u, on_inputs, constant = system.over(system.structure.dofs.rows(rows))
    return _sums(
        system, [of_u, 0.0 * of_u, 0.0 * of_u], [on_inputs, 0.0 * on_inputs, 0.0 * on_inputs], constant
    )


def acceleration_sums(system: ReducedSystem, buildings: Sequence[Building]) -> LinearSums:
    """Mean total acceleration of every floor along x, weighted by mass."""
    floors = [f for b in buildings for f in b.floors]
    rows = [([(n, 0) for n in f.nodes], f.shares.tolist()) for f in floors]
    of_a, on_inputs, constant = system.over(system.structure.dofs.rows(rows))
    ridden = np.array([[1.0, 0.0, -f.level] for f in floors]).reshape(-1, 3) @ system.acceleration_inputs
    nothing = 0.0 * of_a
    return _sums(system, [nothing, nothing, of_a], [ridden, 0.0 * on_inputs, on_inputs], 0.0 * constant)


def storeys(buildings: Sequence[Building]) -> Iterator[tuple[Building, int]]:
    """Buildings and numbers of all storeys from 1 on, in the order of the sums."""
    for b in buildings:
        for i in range(len(b.floors)):
            yield b, i + 1


def _sums(system: ReducedSystem, motion: list[Matrix], inputs: list[Array], constant: Array) -> LinearSums:
    """Sums without forces."""
    laws, members = len(system.structure.laws), 6 * len(system.structure.corotational)
    nothing = (gathered((len(constant), n), [], [], []) for n in (laws, members))
    return LinearSums(system, motion, inputs, constant, *nothing)


def _own(equations: Equations, nodes: Sequence[int]) -> Flags:
    """Columns of some nodes, and of what is inside the elements between them."""
    return columns_of(equations.structure.model, equations.columns, nodes)


def _stacked(rows: Sequence[Array], equations: Equations) -> Array:
    return np.concatenate([np.zeros((0, len(equations.columns))), *rows])


def _matrix(rows: Array) -> Matrix:
    i, j = np.nonzero(rows)
    return gathered(rows.shape, i, j, rows[i, j])
