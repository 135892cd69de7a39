"""Kernel that factorises the matrix of an implicit step, its effective mass."""

from __future__ import annotations

from pound_solve.integrate.kernels.corotational import add_tangent
from pound_solve.integrate.kernels.state import C_ROW, K_ROW, M_ROW, Simulation
from pound_solve.numerics.ldl import factor as factorise


def factorise_effective_mass(
    sim: Simulation, on_mass: float, on_damping: float, on_stiffness: float, factor: int
) -> int:
    """Factorise a weighted sum of M, C and K, laws and corotational members included, into row `factor` of
    `Step.factors`.  Return -1 or the unknown whose pivot vanishes.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    definition = laws.definition
    a = linear.on_pattern
    for q in range(len(step.matrix)):
        step.matrix[q] = on_mass * a[M_ROW, q] + on_damping * a[C_ROW, q] + on_stiffness * a[K_ROW, q]
    for i in range(len(definition.rule)):
        change = on_damping * laws.tangent.damping[i] + on_stiffness * laws.tangent.stiffness[i]
        if change != 0.0:
            for q in range(definition.pair_pointers[i], definition.pair_pointers[i + 1]):
                step.matrix[definition.pair_places[q]] += change * definition.pair_values[q]
    if on_stiffness != 0.0:
        members = sim.members
        for c in range(len(members.parameters)):
            add_tangent(linear, members, step, c, members.tangent, on_stiffness, False)
    return factorise(linear.pattern, step.matrix, step.factors[factor], step.pivots[factor], step.row)
