r"""Rigid contacts: what impulses and forces they take.

With the rows B of the contacts that touch, their rates :math:`w = B v` and
:math:`G = B M^{-1} B^T`, an impact without rebound asks for impulses

.. math:: J \ge 0, \qquad w - G J \le 0, \qquad J^T (w - G J) = 0

a problem with one answer for :math:`M^{-1} B^T J`: the velocities nearest to v, in the sense of the kinetic
energy, in which nothing approaches.  With restitution e the impulses are :math:`(1+e)J` (Moreau).
Momentum is kept, and the energy :math:`\tfrac12(1-e^2) J^T w` is lost, never won.

The contact that approaches fastest strikes first, and with it all that approach and have its E, which
keeps what is symmetric symmetric; what is then found to approach strikes next, at the same instant, so
that a row of equal masses hands an impact through.  Forces of contacts that have closed follow from the
same problem with accelerations for rates.

References
----------
Murty KG (1974), Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11: 123-130
(the pivots).
Moreau JJ (1988), Unilateral contact and dry friction in finite DOF dynamics, in Nonsmooth Mechanics and
Applications, CISM 302: 1-82, Springer.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.laws.automaton import Branch
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.reduction import ReducedSystem

SLOW = 1e-6  #: share of a contact's fastest rate below which an approach has no rebound
NOISE = 1e-12  #: share of its terms below which an acceleration is rounding
MOST_ROUNDS = 100_000  #: of impacts at one instant
MOST_PIVOTS = 10_000


class MasslessContact(Exception):
    """A rigid contact on a DOF without mass."""


class Rigid:
    """The rigid contacts of a reduced system.

    Attributes
    ----------
    laws : list of int
    rows : ndarray, shape (n_rigid, n)
    inputs : ndarray, shape (n_rigid, n_inputs)
        Deformations from the unknowns and the inputs.
    yielding : ndarray, shape (n, n_rigid)
        M^-1 B^T: change of the velocities for unit impulses.
    compliance : ndarray, shape (n_rigid, n_rigid)
        G [1/M].
    gap, restitution : ndarray, shape (n_rigid,)

    Raises
    ------
    Weightless
        A contact on a DOF without mass.
    """

    def __init__(self, system: ReducedSystem) -> None:
        laws = system.structure.laws
        self.system = system
        self.laws = [i for i, s in enumerate(laws) if s.law.rigid]
        self.rows, self.inputs = system.law_rows[self.laws], system.law_inputs[self.laws]
        light = massless(system.mass)
        if (bad := self.rows[:, light].any(axis=1)).any():
            s = laws[self.laws[int(np.argmax(bad))]]
            raise MasslessContact(
                f"the rigid contact {s.element} ({s.rule}) touches a degree of freedom without mass, which "
                "nothing would stop: give it weight"
            )
        heavy = np.flatnonzero(~light) if self.laws else np.zeros(0, np.intp)
        self.yielding = np.zeros(self.rows.T.shape)
        self.yielding[heavy] = np.linalg.solve(system.mass[np.ix_(heavy, heavy)], self.rows[:, heavy].T)
        self.compliance = self.rows @ self.yielding
        self.gap = np.array([laws[i].law.p[2] for i in self.laws])
        self.restitution = np.array([laws[i].law.p[1] for i in self.laws])

    def plastic(self, rates: Array, which: Flags) -> Array:
        """Impulses, shape (n_rigid,), that take all approach from `rates`; others than `which` take none.

        Raises
        ------
        ArithmeticError
            They are not found.
        """
        at = np.flatnonzero(which)
        out, press, small = np.zeros(len(rates)), np.zeros(len(rates), bool), np.zeros(len(rates))
        small[at] = NOISE * np.abs(rates[at]).max(initial=0.0)
        for _ in range(MOST_PIVOTS):
            # one contact at a time is taken in or let go, the first that asks: this ends
            asks = np.where(
                press, out < -small / np.diag(self.compliance), rates - self.compliance @ out > small
            )
            first = np.flatnonzero(asks & which)
            if not len(first):
                return np.maximum(out, 0.0)
            press[first[0]] = not press[first[0]]
            own = np.flatnonzero(press)
            out = np.zeros(len(rates))
            # contacts that cannot be told apart share evenly
            out[own] = np.linalg.lstsq(self.compliance[np.ix_(own, own)], rates[own], rcond=NOISE)[0]
        raise ArithmeticError("which of the rigid contacts press cannot be found")

    def strike(self, rates: Array, touching: Flags, fastest: Array) -> tuple[Array, Array, Array]:
        """Impulses, energies lost, and the rates after the impacts of one instant, shape (n_rigid,) each.

        Parameters
        ----------
        rates : ndarray, shape (n_rigid,)
            Approaching is positive.
        touching : ndarray of bool, shape (n_rigid,)
        fastest : ndarray, shape (n_rigid,)
            Largest rates so far: approaches below `SLOW` times these are without rebound.

        Raises
        ------
        ArithmeticError
            The impacts do not end, or `plastic` finds none.
        """
        impulse, lost = np.zeros(len(rates)), np.zeros(len(rates))
        for _ in range(MOST_ROUNDS):
            hit = touching & (rates > SLOW * fastest)
            if not hit.any():
                break
            e = float(self.restitution[np.argmax(np.where(hit, rates, 0.0))])
            hit &= self.restitution == e
            push = self.plastic(rates, hit)
            lost += 0.5 * (1.0 - e) * (1.0 + e) * push * rates
            impulse += (1.0 + e) * push
            rates = rates - self.compliance @ ((1.0 + e) * push)
        else:
            raise ArithmeticError("the impacts of rigid contacts at one instant do not end")
        push = self.plastic(rates, touching)
        return impulse + push, lost + 0.5 * push * rates, rates - self.compliance @ push

    def accelerations(
        self, branches: Sequence[Branch], u: Array, v: Array, inputs: Array
    ) -> tuple[Array, Array]:
        """Second rates of the deformations if no rigid contact pressed, and the terms that make them up,
        (n_rigid,) each: a share of these is rounding.

        Parameters
        ----------
        branches : sequence of Branch
            Of all laws.
        u, v : ndarray, shape (n,)
        inputs : ndarray, shape (3, n_inputs)
            Inputs and their first two derivatives.
        """
        system = self.system
        k, c, f0 = np.array([(b.stiffness, b.damping, b.force0) for b in branches]).reshape(-1, 3).T
        force = k * (system.law_rows @ u + system.law_inputs @ inputs[0])
        force += c * (system.law_rows @ v + system.law_inputs @ inputs[1]) + f0
        terms = np.array(
            [
                system.inputs @ inputs[0],
                system.constant,
                -system.damping @ v,
                -system.stiffness @ u,
                -system.law_rows.T @ force,
            ]
        )
        size = np.abs(self.yielding).T @ np.abs(terms).sum(axis=0)
        return self.yielding.T @ terms.sum(axis=0) + self.inputs @ inputs[2], size

    def forces(self, held: Flags, branches: Sequence[Branch], u: Array, v: Array, inputs: Array) -> Array:
        """Forces of the contacts that are `held`, shape (n_rigid,)."""
        out, at = np.zeros(len(held)), np.flatnonzero(held)
        free = self.accelerations(branches, u, v, inputs)[0]
        out[at] = np.linalg.pinv(self.compliance[np.ix_(at, at)], rcond=1e-12) @ free[at]
        return out
