r"""Rigid contacts: impulses of impacts and forces of closed contacts.

Let B be the rows of the touching contacts, :math:`w = B v` their rates and :math:`G = B M^{-1} B^T` the
Delassus matrix.  The impulses of an impact without rebound satisfy

.. math:: J \ge 0, \qquad w - G J \le 0, \qquad J^T (w - G J) = 0

a linear complementarity problem with a unique :math:`M^{-1} B^T J`.  The velocities after it are those
nearest to v, in the norm of the kinetic energy, at which nothing approaches.  With restitution e the
impulses are
:math:`(1+e)J` (Moreau).  Momentum is conserved, and the energy :math:`\tfrac12(1-e^2) J^T w` is lost.

The contact that approaches fastest strikes first, together with all approaching contacts of the same E;
this preserves symmetry.  Contacts that approach after that strike next, at the same instant, so that a row
of equal masses transmits an impact.  Forces of closed contacts follow from the same problem with
accelerations in place of rates.

References
----------
Murty KG (1974), Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11: 123-130
(the pivots).
Moreau JJ (1988), Unilateral contact and dry friction in finite freedom dynamics, in Nonsmooth Mechanics and
Applications, CISM 302: 1-82, Springer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pound_solve.laws.automaton import RESTITUTION, Branch
from pound_solve.numerics.matrices import dense, least_squares
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import ReducedSystem

ACCELERATION_ROUNDING = 1e-12  #: fraction of its terms below which an acceleration is rounding
DISPLACEMENT_SHARE = 0.1  #: fraction of the largest displacement that counts as a term of every unknown
MAX_IMPACTS = 100_000  #: at one instant
MAX_PIVOTS = 10_000


LawForces = Callable[[Array, Array], Array]


def linear_forces(branches: Sequence[Branch]) -> LawForces:
    """Return a function for the forces of laws on linear branches from their deformations and rates, shape
    (n_laws,) each, or (n_laws, n_times).
    """
    k, c, f0 = np.array([(b.stiffness, b.damping, b.force0) for b in branches]).reshape(-1, 3).T
    return lambda d, v: np.asarray((d.T * k + v.T * c + f0).T)


class MasslessContact(Exception):
    """A rigid contact on a massless DOF."""


class RigidContacts:
    """The rigid contacts of a reduced system.

    Attributes
    ----------
    laws : list of int
    rows : ndarray, shape (n_rigid, n)
    inputs : ndarray, shape (n_rigid, n_inputs)
        Deformations as linear functions of the unknowns and the inputs.
    velocity_change : ndarray, shape (n, n_rigid)
        M^-1 B^T: change of the velocities for unit impulses.
    delassus : ndarray, shape (n_rigid, n_rigid)
        G [1/M].
    gap, restitution : ndarray, shape (n_rigid,)

    Raises
    ------
    MasslessContact
        A contact on a massless DOF.
    """

    def __init__(self, system: ReducedSystem) -> None:
        laws = system.structure.laws
        self.system = system
        self.laws = [i for i, s in enumerate(laws) if s.law.rigid]
        self.rows, self.inputs = dense(system.law_rows[self.laws]), system.law_inputs[self.laws]
        is_massless = massless(system.mass)
        if (bad := self.rows[:, is_massless].any(axis=1)).any():
            s = laws[self.laws[int(np.argmax(bad))]]
            raise MasslessContact(
                f"the rigid contact {s.element} ({s.rule}) touches a degree of freedom without mass, which "
                "nothing would stop: give it weight"
            )
        with_mass = np.flatnonzero(~is_massless) if self.laws else np.zeros(0, np.intp)
        mass = system.mass[np.ix_(with_mass, with_mass)]
        self.velocity_change = np.zeros(self.rows.T.shape)
        self.velocity_change[with_mass] = least_squares(mass, self.rows[:, with_mass].T)
        self.delassus = self.rows @ self.velocity_change
        self.gap = np.array([laws[i].gap for i in self.laws])
        self.restitution = np.array([laws[i].law.p[RESTITUTION] for i in self.laws])

    def plastic_impulses(self, rates: Array, chosen: Flags) -> Array:
        """Return the impulses, shape (n_rigid,), of an impact without rebound of the `chosen` contacts.

        Raises
        ------
        ArithmeticError
            The pivoting does not terminate.
        """
        at = np.flatnonzero(chosen)
        impulse, pressed = np.zeros(len(rates)), np.zeros(len(rates), bool)
        tolerance = np.zeros(len(rates))
        tolerance[at] = ACCELERATION_ROUNDING * np.abs(rates[at]).max(initial=0.0)
        for _ in range(MAX_PIVOTS):
            # one contact at a time becomes pressed or free, the first that violates its condition: this
            # scheme terminates
            violated = np.where(
                pressed,
                impulse < -tolerance / np.diag(self.delassus),
                rates - self.delassus @ impulse > tolerance,
            )
            first = np.flatnonzero(violated & chosen)
            if not len(first):
                return np.maximum(impulse, 0.0)
            pressed[first[0]] = not pressed[first[0]]
            pressing = np.flatnonzero(pressed)
            impulse = np.zeros(len(rates))
            # contacts with dependent rows share evenly
            delassus = self.delassus[np.ix_(pressing, pressing)]
            impulse[pressing] = np.linalg.lstsq(delassus, rates[pressing], rcond=ACCELERATION_ROUNDING)[0]
        raise ArithmeticError("the set of rigid contacts that press cannot be found")

    def impact(self, rates: Array, touching: Flags, slow: Array) -> tuple[Array, Array, Array]:
        """Return impulses, energies lost, and the rates after the impacts of one instant, shape (n_rigid,)
        each.

        Parameters
        ----------
        rates : ndarray, shape (n_rigid,)
            Positive for approach.
        touching : ndarray of bool, shape (n_rigid,)
        slow : ndarray, shape (n_rigid,)
            Approach rates up to which there is no rebound.

        Raises
        ------
        ArithmeticError
            The impacts do not end, or `plastic_impulses` fails.
        """
        impulse, lost = np.zeros(len(rates)), np.zeros(len(rates))
        # bodies in a row pass on a fraction of the remaining rate for ever: if none has moved before, the
        # remainder is compared with the impact itself
        slow = np.maximum(slow, ACCELERATION_ROUNDING * rates[touching].max(initial=0.0))
        for _ in range(MAX_IMPACTS):
            hit = touching & (rates > slow)
            if not hit.any():
                break
            e = float(self.restitution[np.argmax(np.where(hit, rates, 0.0))])
            hit &= self.restitution == e
            plastic = self.plastic_impulses(rates, hit)
            lost += 0.5 * (1.0 - e) * (1.0 + e) * plastic * rates
            impulse += (1.0 + e) * plastic
            rates = rates - self.delassus @ ((1.0 + e) * plastic)
        else:
            raise ArithmeticError("the impacts of rigid contacts at one instant do not end")
        plastic = self.plastic_impulses(rates, touching)
        return impulse + plastic, lost + 0.5 * plastic * rates, rates - self.delassus @ plastic

    def free_accelerations(
        self, law_forces: LawForces, u: Array, v: Array, inputs: Array
    ) -> tuple[Array, Array]:
        """Return the second rates of the deformations without contact forces, and the magnitude of their
        terms, (n_rigid,) each.  The rounding is a fraction of the magnitude.  Further axes are instants.

        Parameters
        ----------
        law_forces : callable
            Forces of all laws at their deformations and rates, (n_laws,) each; zero for rigid contacts.
        u, v : ndarray, shape (n,)
        inputs : ndarray, shape (3, n_inputs)
            Inputs and their first two derivatives.
        """
        system = self.system
        force = law_forces(
            system.law_rows @ u + system.law_inputs @ inputs[0],
            system.law_rows @ v + system.law_inputs @ inputs[1],
        )
        terms = np.array(
            [
                system.inputs @ inputs[0],
                np.broadcast_to(system.constant, u.T.shape).T,
                -system.damping @ v,
                -system.stiffness @ u,
                -system.law_rows.T @ force,
            ]
        )
        # displacements of bodies that move as one cancel in K u, but their rounding does not; in a static
        # state it is in proportion to the largest displacement
        u = np.abs(u) + DISPLACEMENT_SHARE * np.abs(u).max(initial=0.0)
        sums = np.abs(terms[:2]).sum(axis=0) + abs(system.law_rows).T @ np.abs(force)
        sums = sums + abs(system.damping) @ np.abs(v) + abs(system.stiffness) @ u
        size = np.abs(self.velocity_change).T @ sums
        return self.velocity_change.T @ terms.sum(axis=0) + self.inputs @ inputs[2], size

    def forces(self, closed: Flags, law_forces: LawForces, u: Array, v: Array, inputs: Array) -> Array:
        """Return the forces of the `closed` contacts, shape (n_rigid,), or (n_rigid, n_times); other
        parameters as in `free_accelerations`.
        """
        forces, at = np.zeros((len(closed), *u.shape[1:])), np.flatnonzero(closed)
        free = self.free_accelerations(law_forces, u, v, inputs)[0]
        forces[at] = self.inverse(at) @ free[at]
        return forces

    def inverse(self, at: Index) -> Array:
        """Return the inverse of G over the contacts `at`; contacts with dependent rows share evenly."""
        return np.asarray(np.linalg.pinv(self.delassus[np.ix_(at, at)], rcond=ACCELERATION_ROUNDING), float)
