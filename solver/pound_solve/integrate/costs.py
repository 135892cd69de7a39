"""Counted costs of the methods, by which AUTO chooses.  They are seconds on a nominal machine and are never
measured, so that AUTO always makes the same choice.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.matrices import Factor, Matrix, diagonal, weighted
from pound_solve.numerics.modes import massless
from pound_solve.structure.reduction import ReducedSystem

WINDOW = 1.3e-3  #: of EXACT: a window of dense output
GRID_POINT = 2e-8  #: a point of its search grids, per unknown
ENVELOPE_POINT = 5e-8  #: a point of its envelopes, per unknown of the envelopes
DECOMPOSITION = 8e-4  #: a modal decomposition
PRODUCTS = 1.5e-6  #: matrix products of a decomposition, over the square of its unknowns
MODES = 8e-9  #: modes of a decomposition, over the cube of its unknowns
STEP, STEP_UNKNOWN = 3e-7, 2.5e-8  #: a compiled step of NEWMARK, and more per unknown, twice that per law
TAYLOR_STEP, TAYLOR_UNKNOWN = 9e-6, 5.5e-8  #: a step of TAYLOR, and more per unknown and law
TAYLOR_SMOOTH = 2.5e-6  #: more per smooth law
REVERSALS = 0.25  #: of a smooth law in an interval between two goals: each ends a step of TAYLOR
MODES_STEPS = 2.0  #: cost of an interval in modes, in steps of TAYLOR
TAYLOR_RADIANS = 5.0  #: of the fastest mode in a step of TAYLOR
EVENT_STEPS = 10  #: cost of a located event, in steps
POWERS = 30  #: power iterations for the fastest decay
INTERPRETED = 100  #: cost of an interpreted step over that of a compiled one


def of_decomposition(n: int) -> float:
    """Return the cost of the modal decomposition of `n` unknowns."""
    return DECOMPOSITION + PRODUCTS * n**2 + MODES * n**3


def of_step(system: ReducedSystem) -> float:
    """Return the cost of a compiled step of NEWMARK."""
    return STEP + STEP_UNKNOWN * (system.size + 2 * len(system.structure.laws))


def smooth_laws(system: ReducedSystem) -> int:
    """Return how many laws are smooth curves."""
    return sum(s.law.rule.smooth_curve is not None for s in system.structure.laws)


def of_series_step(system: ReducedSystem) -> float:
    """Return the cost of a compiled step of TAYLOR, or of LAGUERRE."""
    unknowns = system.size + len(system.structure.laws)
    return TAYLOR_STEP + TAYLOR_UNKNOWN * unknowns + TAYLOR_SMOOTH * smooth_laws(system)


def fastest_rate(system: ReducedSystem) -> float:
    r"""Return a bound of the fastest rate that steps of TAYLOR resolve [1/T]: that of the fastest mode with
    all springs elastic and all contacts open (they are closed only briefly), or of the fastest decay.

    The row sums of ``M^-1/2 A M^-1/2`` bound its eigenvalues (Gershgorin).  Massless unknowns with
    dashpots decay at :math:`\lambda \le` the largest eigenvalue of :math:`K x = \lambda C x`.
    """
    laws = system.structure.laws
    elastic = np.array([0.0 if s.role.collides else s.steepest for s in laws], float)
    stiffness = system.stiffness + weighted(system.law_rows, elastic)
    damping = system.damping + weighted(system.law_rows, [s.beta * k for s, k in zip(laws, elastic)])
    is_massless = massless(system.mass)
    heavy = np.flatnonzero(~is_massless)
    root = 1.0 / np.sqrt(diagonal(system.mass)[heavy])
    omega2, decay = (
        float((root * (abs(a[np.ix_(heavy, heavy)]) @ root)).max(initial=0.0)) for a in (stiffness, damping)
    )
    damped = np.flatnonzero(is_massless & (diagonal(damping) > 0.0))
    if len(damped):
        grid = np.ix_(damped, damped)
        decay = max(decay, fastest_decay(stiffness[grid], damping[grid]))
    fastest: float = max(omega2**0.5, decay)
    return fastest


def fastest_decay(k: Matrix, c: Matrix) -> float:
    """Return the largest eigenvalue of ``K x = lambda C x`` by power iteration, infinite for singular C."""
    try:
        factor = None if isinstance(c, np.ndarray) else Factor(c)
        decay = np.linalg.solve(c, k) if factor is None else k
    except np.linalg.LinAlgError:
        return np.inf
    x, largest = np.cos(np.arange(c.shape[0]) ** 2.0), 0.0
    for _ in range(POWERS):
        x /= np.linalg.norm(x)
        x = decay @ x if factor is None else factor.solve(k @ x)
        largest = max(largest, float(np.linalg.norm(x)))
    return largest


class CostlyError(Exception):
    """A run exceeds its budget; it has reached the time `t` at this `cost`."""

    def __init__(self, cost: float, t: float) -> None:
        super().__init__(f"more than {cost:g}, at {t:g}")
        self.cost, self.t = cost, t


class Budget:
    """Limits of the cost of a run of EXACT.

    Parameters
    ----------
    begin, end : float
        Times of the run [T].
    most : float
        Largest cost of the whole run.
    trial : float or None
        Cost after which the cost of the whole run, extrapolated at the present rate, is checked against
        `most` (None: `most`).
    decompositions : float
        Largest number of modal decompositions.
    """

    def __init__(
        self,
        begin: float,
        end: float,
        most: float = np.inf,
        trial: float | None = None,
        decompositions: float = np.inf,
    ) -> None:
        self.begin, self.length, self.most = begin, end - begin, most
        self.trial, self.decompositions = most if trial is None else trial, decompositions
        self.cost = 0.0

    def charge(self, cost: float, t: float, decompositions: int) -> None:
        """Add a cost at time `t` of a run that has made the given number of `decompositions`.

        Raises
        ------
        CostlyError
            The budget is exceeded, or will be at the present rate.
        """
        self.cost += cost
        whole = self.cost * self.length / max(t - self.begin, 1e-300)
        dear = self.cost > self.most or (self.cost > self.trial and whole > self.most)
        if dear or decompositions > self.decompositions:
            raise CostlyError(self.cost, t)
