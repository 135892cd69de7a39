"""The initial state of a history: the static state plus INITIAL."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.integrate.protocol import Start
from pound_solve.laws.automaton import GAP, Law, State, consistent, drive
from pound_solve.numerics.matrices import least_squares, used_columns, used_rows, weighted
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array
from pound_solve.structure.reduction import ReducedSystem
from pound_solve.structure.structure import Structure

GAP_ROUNDING = 1e-12  #: fraction of a deformation by which a touching rigid contact may miss its gap


def initial(structure: Structure) -> tuple[Array, Array]:
    """Return the displacement and velocity of the unknowns from the INITIAL cards, shape (n_free,) each."""
    n = structure.n_free
    column = {f: i for i, f in enumerate(structure.dofs.free)}
    u, v = np.zeros(n), np.zeros(n)
    for card in structure.model.initial:
        for node in card["NODES"]:
            for d, letter in enumerate("XYR"):
                i = column.get((node, d))
                if i is not None:
                    u[i] += card["U" + letter]
                    v[i] += card["V" + letter]
    return u, v


def begin(
    structure: Structure,
    system: ReducedSystem,
    u: Array,
    v: Array,
    states: Sequence[State],
    u_static: Array,
    times: Array,
) -> Start:
    """Return the state at t = 0: the static state plus INITIAL, with the laws driven along the
    difference.
    """
    keep = system.columns
    u0, v0 = u[keep], v[keep]
    _lead_massless(system, u0, u0 - u_static[keep])
    before = structure.law_rows[:, : structure.n_free] @ u_static
    after = system.law_rows @ u0 + system.law_inputs @ system.excitation.value(0.0)
    rates = system.law_rows @ v0 + system.law_inputs @ system.excitation.value(0.0, 1)
    led = tuple(
        _led(s.law, x, d0, d1, rate)
        for s, x, d0, d1, rate in zip(
            structure.laws, states, before.tolist(), after.tolist(), rates.tolist()
        )
    )
    return Start(u0, v0, led, times)


def _led(law: Law, state: State, d0: float, d1: float, rate: float) -> State:
    """Return the state of a law that is driven from deformation `d0` to `d1`, where it has the
    rate `rate`.
    """
    if law.rigid:  # it stays closed unless pulled open, and its force follows from the motion
        closed = law.branch(state).constrains and d1 - law.p[GAP] >= -GAP_ROUNDING * max(
            abs(d0), law.p[GAP]
        )
        return law.transition(law.start(), 0, d1) if closed else law.start()
    return consistent(law, drive(law, state, d0, d1) if d0 != d1 else state, d1, rate)


def _lead_massless(system: ReducedSystem, u: Array, pushed: Array) -> None:
    """Move massless undamped unknowns without INITIAL values with those that have them, by the stiffness at
    rest: nothing else determines these unknowns.
    """
    laws = system.structure.laws
    idle = massless(system.mass) & (pushed == 0.0) & ~used_rows(system.damping)
    damped = [i for i, s in enumerate(laws) if s.beta != 0.0 or s.role.reports_damping]
    idle &= ~used_columns(system.law_rows[damped])
    if idle.any() and pushed.any():
        k = system.stiffness + weighted(system.law_rows, [s.k0 for s in laws])
        followers, others = np.flatnonzero(idle), np.flatnonzero(~idle)
        away = k[np.ix_(followers, others)] @ pushed[others]
        u[followers] -= least_squares(k[np.ix_(followers, followers)], away)
