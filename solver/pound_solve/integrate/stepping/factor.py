"""Factorisation of A, the effective mass of a step, and its update when a law changes its tangent.

`factor` is a row of `Step.factors`: `WHOLE` or `PART`.
"""

from __future__ import annotations

from pound_solve.integrate.kernels.effective_mass import factorise_effective_mass
from pound_solve.integrate.kernels.state import Run, Scheme, Simulation
from pound_solve.numerics.ldl import update

MAX_UPDATES = 200  #: rank-one updates before A is factorised again


def factorise_step(sim: Simulation, scheme: Scheme, h: float, factor: int) -> int:
    """Factorise A for steps of length `h`; return -1 or the unknown whose pivot vanishes."""
    on_mass = (1.0 - scheme.alpha_m) / (1.0 - scheme.alpha_f)
    return factorise_effective_mass(sim, on_mass, scheme.gamma * h, scheme.beta * h * h, factor)


def tangent_change(scheme: Scheme, h: float, stiffness: float, damping: float) -> float:
    """Return what multiplies ``b b^T`` in the change of A if a law's tangent changes by a `stiffness` and
    a `damping`.
    """
    return scheme.gamma * h * damping + scheme.beta * h * h * stiffness


def invalidate_factor(run: Run) -> None:
    """Mark the factor of the nominal step as invalid, so that A is factorised again before its next use."""
    run.updates = MAX_UPDATES + 1


def is_valid_factor(run: Run) -> bool:
    """Return whether the factor of the nominal step is valid and has had few enough updates."""
    return run.updates <= MAX_UPDATES


def update_factor(sim: Simulation, i: int, change: float, factor: int) -> bool:
    """Add ``change b b^T`` of law `i` to a factor; return False if A must be factorised again."""
    step = sim.step
    rows = sim.laws.definition.rows
    if change == 0.0 or rows.pointers[i] == rows.pointers[i + 1]:
        return True
    first = len(step.row)
    for q in range(rows.pointers[i], rows.pointers[i + 1]):
        step.row[rows.columns[q]] += rows.values[q]
        first = min(first, rows.columns[q])
    return update(sim.linear.pattern, step.factors[factor], step.pivots[factor], step.row, first, change)
