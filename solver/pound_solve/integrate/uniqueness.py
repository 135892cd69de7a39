r"""Uniqueness of the motion when several laws yield or fail at one instant.

The tangent stiffness of the massless unknowns, which have no inertia, distributes the deformation among
laws in series.  The rates are unique if that stiffness is positive definite with the tangents of *all*
laws that reach the ends of their branches together (Hill's comparison solid).  If it leaves a motion free
in which some of these laws continue and others reverse, any of them may continue alone, and rounding
decides.  Dashpots resist such a motion if the tangent is zero; if it is negative, they only slow it
down, and the rounding error grows without any physical cause.

A hardening law rests at the start of its yield line as long as another law in series yields at the same
force.  Whether it has yielded is then undecided, and some rules never forget a yield (see
`remembers_yield`).

Several laws may also lose their forces together.  The force that one loses loads or relieves the others.
Laws that then reverse and keep their forces might equally have failed first.

References
----------
Hill R (1958), A general theory of uniqueness and stability in elastic-plastic solids, J. Mech. Phys. Solids
6: 236-249.
"""

from __future__ import annotations

import math

import numpy as np

from pound_solve.check import Check, Subject, beyond
from pound_solve.laws.automaton import BranchKind, K, drive
from pound_solve.numerics.matrices import dense, diagonal, scaled, used_columns, used_rows
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.reduction import ReducedSystem

NO_STIFFNESS = 1e-9  #: fraction of the elastic stiffness below which a tangent counts as none
PARTICIPATION = 1e-6  #: fraction of the largest deformation in the unrestrained motion
MAX_NAMED = 4  #: most elements that are named
PERTURBATION = 1e-6  #: fraction of its yield deformation by which a spring exceeds yield, or stays below
CYCLES = 12  #: subsequent cycles in which the forces are compared
MAX_DIFFERENCE = 1e-3  #: fraction of the elastic force at yield above which the forces differ
ADVICE = "not unique; vary the strengths, or add a hardening R, or a weight between"


def remembers_yield(spring: LawSpring) -> bool:
    """Return whether the later behaviour of a spring depends on whether it has just reached its first
    yield.
    """
    law = spring.law
    if law.curved or spring.yields is None or spring.strengths is None:
        return False
    ends = [y - spring.beside * f for y, f in zip(spring.yields, spring.strengths)]
    for near, far in (ends, ends[::-1]) if np.isfinite(ends).all() else ():
        way = [0.3 * near, 0.8 * near, 4.0 * far, 0.5 * near, 0.9 * near]
        way += [x for n in range(CYCLES) for x in ((2.0 + n) * far, (2.5 + n) * near)]  # growing
        forces = []
        for d in (near * (1.0 - PERTURBATION), near * (1.0 + PERTURBATION)):
            state = drive(law, law.start(), 0.0, d)
            for goal in way:
                state, d = drive(law, state, d, goal), goal
                forces.append(law.force(state, d)[0])
        apart = np.abs(np.subtract(*np.reshape(forces, (2, -1))))
        if (apart > MAX_DIFFERENCE * abs(law.p[K] * near)).any():
            return True
    return False


class Uniqueness:
    """Examines the instants of a run at which laws give way together.

    Attributes
    ----------
    first : float
        The first instant at which rounding decides which of the laws gives way [T]; NaN if there is none.
    elements : list of int
        Elements of the laws among which rounding decides at that instant.
    """

    def __init__(self, system: ReducedSystem) -> None:
        self.system, self.first, self.elements = system, math.nan, list[int]()
        self._losses: list[tuple[float, int, dict[int, int]]] = []  # instants, laws, the branches of others
        self._straight = not system.structure.corotational
        self._is_massless = massless(system.mass)
        self._undamped = self._is_massless & ~used_rows(system.damping)
        self._k0 = np.array([s.k0 for s in system.structure.laws], float)
        self._known: set[bytes] = set()

    def examine_tie(self, t: float, stiffness: Array, damping: Array, rising: Array) -> None:
        """Examine an instant at which laws come to the ends of their branches together.

        Parameters
        ----------
        t : float
            [T]
        stiffness, damping : ndarray, shape (n_laws,)
            Tangents and dashpots of the laws if all tied laws continue [F/L], [F T/L].  If a force is lost:
            minus infinity for other laws that are about to lose theirs, and the numbers of their next
            branches.
        rising : ndarray, shape (n_laws,)
            Positive for laws whose deformation rises to the end of the branch, negative if it falls to it,
            zero for all others.
        """
        if self.elements:
            return
        if (lost := np.isneginf(stiffness)).any():
            law = int(np.flatnonzero((rising != 0.0) & ~lost)[0])
            self._losses.append((t, law, {int(i): int(damping[i]) for i in np.flatnonzero(lost)}))
            return
        if not self._straight:  # the tangents of the members vary
            return
        key = b"".join(x.tobytes() for x in (stiffness, damping, np.sign(rising)))
        if key in self._known:
            return
        self._known.add(key)
        damped = used_columns(self.system.law_rows[damping != 0.0])
        elements = self._open(self._undamped & ~damped, stiffness, rising, NO_STIFFNESS) or self._open(
            self._is_massless, stiffness, rising, -NO_STIFFNESS
        )
        if elements:
            self.first, self.elements = t, elements

    def record_change(self, t: float, law: int, branch: int) -> None:
        """Record that a law changes to another branch, given by number."""
        for since, first, others in self._losses:
            if t >= since and others.pop(law, branch) != branch:
                self._tell(since, [first, law])

    def record_rest(self, t: float, law: int, other: int, branch: int) -> None:
        """Record that a law reverses while another law, or the law itself, rests at the beginning of a
        branch, given by number.
        """
        spring = self.system.structure.laws[other]
        yields = spring.law.rule.branches[branch].kind is BranchKind.YIELDING
        if yields and not self.elements and remembers_yield(spring):
            self._tell(t, [law, other])

    def _tell(self, t: float, laws: list[int]) -> None:
        """Record that it is undecided which of some laws continues."""
        if not self.elements:
            self.first = t
            self.elements = sorted({self.system.structure.laws[i].element for i in laws})

    def _open(self, among: Flags, stiffness: Array, rising: Array, least: float) -> list[int]:
        """Return the elements of tied laws that take part, some continuing and some reversing, in a motion
        of some unknowns whose tangent is below the fraction `least` of the elastic stiffness.
        """
        system, at = self.system, np.flatnonzero(among)
        rows = dense(system.law_rows[:, at])
        linear = dense(system.stiffness[np.ix_(at, at)])
        elastic = diagonal(linear) + (np.maximum(self._k0, stiffness)[:, None] * rows**2).sum(axis=0)
        factors = 1.0 / np.sqrt(np.where(elastic > 0.0, elastic, 1.0))
        values, motions = np.linalg.eigh(scaled(linear + (rows.T * stiffness) @ rows, factors))
        for stretch in (rows @ (factors[:, None] * motions[:, values < least])).T:
            motion = np.sign(rising) * stretch / np.abs(stretch).max()
            on, back = motion > PARTICIPATION, motion < -PARTICIPATION
            if on.any() and back.any():
                return sorted({system.structure.laws[i].element for i in np.flatnonzero(on | back)})
        return []

    def checks(self) -> list[Check]:
        """Return the check of a run; none if its motion is unique."""
        for since, first, others in self._losses:
            if others:
                self._tell(since, [first, *others])
        if not self.elements:
            return []
        named = ", ".join(str(e) for e in self.elements[:MAX_NAMED])
        more = f" and {len(self.elements) - MAX_NAMED} more" if len(self.elements) > MAX_NAMED else ""
        when = f"t = {self.first:.6g} {self.system.structure.model.units.time}"
        about = f"elements of which any may give way: {named}{more} at {when}"
        return [beyond(Subject.UNIQUENESS, about, len(self.elements), 0, ADVICE)]
