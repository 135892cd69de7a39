r"""Damage of springs and hinges by a motion: ductility, plastic path, residual deformation, indices.

With the deformation :math:`d_y` and the force :math:`F_y` at first yield of a side, ultimate deformation
:math:`d_u = \mu_u d_y` under monotonic loading, largest deformation :math:`d_m` and dissipated energy
:math:`E_h` the index of Park and Ang is

.. math:: D = \frac{d_m}{d_u} + \beta\,\frac{E_h}{F_y d_u}

Each side is evaluated separately with the whole energy; the larger index counts. The index of the structure
is the mean of all, weighted by the energies: :math:`\sum E_i D_i / \sum E_i`.

References
----------
Park YJ, Ang AHS (1985), Mechanistic seismic damage model for reinforced concrete, J. Struct. Eng. ASCE
111(4): 722-739; Park YJ, Ang AHS, Wen YK (1985), Seismic damage analysis of reinforced concrete buildings,
J. Struct. Eng. ASCE 111(4): 740-757 (weights by energy); Mahin SA, Bertero VV (1981), An evaluation of
inelastic seismic design spectra, J. Struct. Div. ASCE 107(ST9): 1777-1795 (energy as a plastic path).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pound_solve.laws.automaton import K, Law, State, transitions

Sides = tuple[float, float]  #: positive and negative side

NONE: Sides = (0.0, 0.0)  #: a spring that does not yield

UNLOADING_RANGE = 10.0  #: range of unloading, as a multiple of the deformation plus the elastic deformation


class Damage(NamedTuple):
    """Damage index of a component on the side where it is larger."""

    ultimate: float  #: ultimate ductility
    ductility: float
    by_deformation: float  #: first term of the index
    by_energy: float  #: second term

    @property
    def total(self) -> float:
        """The index D."""
        return self.by_deformation + self.by_energy


def holds(strength: float) -> bool:
    """Return whether a side has a strength; 0 and NaN mean none."""
    return abs(strength) > 0.0


def ductility(largest: Sides, yields: Sides | None) -> float:
    """Return the ductility of the governing side: largest deformation over yield deformation; NaN if none
    yields.

    Parameters
    ----------
    largest, yields : tuple of float
        Signed deformations, [L] or [rad].
    """
    return max((d / y for d, y in zip(largest, yields or NONE) if holds(y)), default=math.nan)


def plastic(largest: Sides, yields: Sides | None) -> float:
    """Return the largest deformation beyond first yield of the governing side, [L] or [rad]; NaN without
    yield.

    Parameters
    ----------
    largest, yields : tuple of float
        Signed deformations, [L] or [rad].
    """
    sides = [(d, y) for d, y in zip(largest, yields or NONE) if holds(y)]
    beyond = [abs(d) - abs(y) if d * y > 0.0 else 0.0 for d, y in sides]
    return max(0.0, *beyond) if beyond else math.nan


def plastic_path(loss: float, strengths: Sides | None, yields: Sides | None) -> tuple[float, float]:
    """Return the plastic path [L] or [rad] over which a force equal to the mean strength dissipates `loss`,
    and its ratio to the mean yield deformation.

    Parameters
    ----------
    loss : float
        Dissipated energy [F L].
    strengths, yields : tuple of float, or None
        Signed forces and deformations at first yield, [F] or [F L], [L] or [rad].

    Notes
    -----
    For an elastic, perfectly plastic spring it is the sum of all plastic deformations, if they return to
    their origin or both strengths are equal.
    """
    sides = [(abs(f), abs(y)) for f, y in zip(strengths or NONE, yields or NONE) if holds(f) and holds(y)]
    if not sides:
        return math.nan, math.nan
    strength, at_yield = (sum(x) / len(sides) for x in zip(*sides))
    return loss / strength, loss / strength / at_yield


def residual(law: Law, state: State, d: float) -> float:
    """Return the deformation that remains after slow unloading from `d`, [L] or [rad].

    It is NaN if the force does not reach zero.
    """
    force = law.force(state, d)[0]
    if force == 0.0:
        return d
    end = d - math.copysign(UNLOADING_RANGE * (abs(d) + abs(force) / law.p[K]), force)
    for at, after in [*transitions(law, state, d, end), (end, state)]:
        if force * law.force(state, at)[0] <= 0.0:
            while (middle := 0.5 * (d + at)) not in (d, at):
                d, at = (middle, at) if force * law.force(state, middle)[0] > 0.0 else (d, middle)
            return at
        d, state = at, after
    return math.nan


def park_ang(
    largest: Sides, loss: float, strengths: Sides, yields: Sides, ultimate: Sides, beta: float
) -> Damage:
    """Return the damage index of one component.

    Parameters
    ----------
    largest, yields : tuple of float
        Signed deformations, [L] or [rad].
    loss : float
        Dissipated energy [F L].
    strengths : tuple of float
        Signed forces at first yield, [F] or [F L].
    ultimate : tuple of float
        Ultimate ductilities of both sides.
    beta : float
        Weight of the energy.
    """
    sides = []
    for d, f, y, most in zip(largest, strengths, yields, ultimate):
        if holds(f) and holds(y):
            reached = max(d / y, 0.0)
            sides.append(Damage(most, reached, reached / most, beta * loss / (f * y * most)))
    return max(sides, key=lambda side: side.total, default=Damage(*[math.nan] * 4))


def overall(indices: Sequence[float], losses: Sequence[float]) -> float:
    """Return the index of the structure: the mean weighted by dissipated energies; NaN without
    dissipation.
    """
    total = sum(losses)
    return sum(d * e for d, e in zip(indices, losses)) / total if total else math.nan
