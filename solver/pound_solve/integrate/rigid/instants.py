"""Rigid contacts of a run at an instant: impacts, opening of closed contacts, overlaps at the start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from pound_solve.integrate.protocol import Stop
from pound_solve.integrate.rigid.contacts import ACCELERATION_ROUNDING, RigidContacts
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.integrate.tracker import ResponseTracker
from pound_solve.laws.automaton import Branch
from pound_solve.loading.excitation import CLOCK_ROUNDING
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.reduction import ReducedSystem

NO_REBOUND = 1e-6  #: fraction of a contact's fastest rate below which an approach has no rebound
REBOUND_ROUNDING = 4.0  #: height of a rebound that is lost in rounding, over that rounding
START_OVERLAP = 1e-10  #: fraction of its terms beyond which a deformation overlaps at the start


class RigidRun(Protocol):
    """Interface of a run for its rigid contacts.

    Attributes
    ----------
    u, v : ndarray, shape (n,)
        Present displacement and velocity.
    largest : ndarray, shape (2, at least n_laws)
        Largest deformations and rates of the laws so far.
    """

    t: float
    u: Array
    v: Array
    largest: Array
    system: ReducedSystem
    tracker: ResponseTracker

    @property
    def branches(self) -> Sequence[Branch]:
        """Present branches of all laws."""

    def law_forces(self, d: Array, v: Array) -> Array:
        """Return the forces of all laws on their present branches at deformations `d` and rates `v`,
        (n_laws,) each; zero for rigid contacts.
        """

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Let a law leave its branch at deformation `d` and rate `v`."""

    def add_impact_work(self, put_in: float, lost: Array) -> None:
        """Add the work that moving supports put in at an impact, and the loss of each law, (n_laws,)."""

    def stop(self, code: str, why: str) -> Stop:
        """Return the exception that ends the run here."""


class RigidInstants:
    """Applies `RigidContacts` to the present state of a run.

    Parameters
    ----------
    run : RigidRun
    contacts : RigidContacts

    Attributes
    ----------
    rounding : ndarray, shape (n_rigid,)
        Largest rounding of the terms of their forces so far, over `contacts.ROUNDING` [F].
    """

    def __init__(self, run: RigidRun, contacts: RigidContacts) -> None:
        self.run, self.contacts = run, contacts
        self.rounding = np.zeros(len(contacts.laws))

    def _inputs(self) -> Array:
        """Inputs and their first two derivatives just after the present time, shape (3, n_inputs)."""
        excitation = self.run.system.excitation
        coefs = excitation.about(np.array([self.run.t]))[0]
        return np.stack([polynomial.value(coefs, 0.0, order) for order in range(3)])

    def _closed(self) -> Flags:
        """Return which rigid contacts are closed, shape (n_rigid,)."""
        return np.array([self.run.branches[i].constrains for i in self.contacts.laws], bool)

    def begin(self) -> bool:
        """Start the rigid contacts, and return whether there are any.  Stop if rigid bodies overlap.
        Contacts that are closed strike, stay closed or open, as their velocities and forces require.

        The deformations have the rounding of the static displacements.

        Raises
        ------
        ArithmeticError
            The impacts do not end, or the forces are not found.
        """
        run, laws = self.run, self.contacts.laws
        self._check_overlap()
        farthest = np.abs(run.u).max(initial=0.0)
        run.largest[0, laws] = np.maximum(run.largest[0, laws], farthest)
        if self._closed().any():
            self.impact()
            self.open_pulled()
        return bool(laws)

    def _check_overlap(self) -> None:
        """Stop if rigid bodies overlap."""
        x, run = self.contacts, self.run
        d = x.rows @ run.u + x.inputs @ self._inputs()[0]
        size = START_OVERLAP * (np.abs(x.rows) @ np.abs(run.u) + x.gap) + EVENT_TOLERANCE * np.abs(
            run.u
        ).max(initial=0.0)
        for i in np.flatnonzero(d - x.gap > size).tolist():
            s = run.system.structure.laws[x.laws[i]]
            why = f"the rigid contact {s.element} ({s.rule}) overlaps by {d[i] - x.gap[i]:.3g} at the start"
            raise run.stop("A505", why)

    def impact(self) -> None:
        """Apply the impacts of the touching rigid contacts, which then close or part.

        Raises
        ------
        ArithmeticError
            The impacts do not end.
        """
        x, run, s, closed = self.contacts, self.run, self._inputs(), self._closed()
        d, rates = x.rows @ run.u + x.inputs @ s[0], x.rows @ run.v + x.inputs @ s[1]
        near = EVENT_TOLERANCE * (run.largest[0, x.laws] + x.gap)
        near += CLOCK_ROUNDING * max(1.0, run.t) * np.abs(rates)
        touching = closed | (d >= x.gap - near)
        fastest = run.largest[1, x.laws]
        impulse, lost, after = x.impact(rates, touching, self._slow(s))
        run.v = run.v - x.velocity_change @ impulse
        losses = np.zeros(len(run.branches))
        losses[x.laws] = lost
        run.add_impact_work(float(impulse @ (x.inputs @ s[1])), losses)
        stays = touching & (after >= -ACCELERATION_ROUNDING * fastest)
        for i, law in enumerate(x.laws):
            if not closed[i] and (stays[i] or impulse[i] > 0.0):
                run.transition(law, 0, float(d[i]), float(rates[i]))
            if law in run.tracker.open:
                run.tracker.open[law].impulse += float(impulse[i])
            if run.branches[law].constrains and not stays[i]:
                if not closed[i]:
                    run.tracker.open[law].peak = np.nan  # the force of an impact is infinite
                run.transition(law, 0, float(d[i]), float(after[i]))

    def _slow(self, inputs: Array) -> Array:
        """Return the approach rates up to which there is no rebound, shape (n_rigid,).

        The last rebounds of a body that comes to rest are lost in the rounding of its deformation.  After
        an approach at v with restitution e, the body rises by (e v)^2 / 2a, where a is the acceleration
        that brings it back.
        """
        x, run = self.contacts, self.run
        pressing = np.maximum(x.free_accelerations(run.law_forces, run.u, run.v, inputs)[0], 0.0)
        lost = REBOUND_ROUNDING * EVENT_TOLERANCE * (run.largest[0, x.laws] + x.gap)
        rebound, e = np.sqrt(2.0 * pressing * lost), x.restitution
        approach = np.divide(rebound, e, out=np.zeros(len(e)), where=e > 0.0)
        slow: Array = np.maximum(NO_REBOUND * run.largest[1, x.laws], approach)
        return slow

    def open_pulled(self, spectral_radius: float = 0.0) -> None:
        """Open the closed rigid contacts whose force would be tensile.

        Parameters
        ----------
        spectral_radius : float
            Largest magnitude of the eigenvalues [1/T], if displacements and velocities come from the same
            modes.

        Raises
        ------
        ArithmeticError
            The forces are not found.
        """
        x, run = self.contacts, self.run
        if not x.laws:
            return
        # a deformation that contact keeps near zero has the rounding of its terms
        terms = np.abs(x.rows) @ np.abs(run.u)
        run.largest[0, x.laws] = np.maximum(run.largest[0, x.laws], terms)
        closed = self._closed()
        if not closed.any():
            return
        s = self._inputs()
        free, size = x.free_accelerations(run.law_forces, run.u, run.v, s)
        size = size + spectral_radius * (np.abs(x.rows) @ np.abs(run.v))
        force = x.plastic_impulses(free, closed)
        parting = closed & (force == 0.0) & (free - x.delassus @ force < -ACCELERATION_ROUNDING * size)
        for i in np.flatnonzero(parting).tolist():
            d, v = x.rows[i] @ run.u + x.inputs[i] @ s[0], x.rows[i] @ run.v + x.inputs[i] @ s[1]
            run.transition(x.laws[i], 0, float(d), float(v))
        self.rounding = np.maximum(self.rounding, size / np.diag(x.delassus))
