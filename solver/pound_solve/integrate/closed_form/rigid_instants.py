"""Rigid contacts of a run at an instant: impacts, closed contacts that open, overlaps at the start."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.closed_form.deferred_work import DeferredWork
from pound_solve.integrate.closed_form.event_loop import EventDrivenRun
from pound_solve.integrate.closed_form.rigid_contact import ROUNDING, RigidContacts
from pound_solve.integrate.closed_form.subsystems import Subsystems
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Flags

OVERLAP = 1e-10  #: share of its terms beyond which a deformation overlaps at the start


class RigidInstants:
    """Applies `RigidContacts` to the present state of a run.

    Parameters
    ----------
    run : EventDrivenRun
    subsystems : Subsystems
    work : DeferredWork
    """

    def __init__(self, run: EventDrivenRun, subsystems: Subsystems, work: DeferredWork) -> None:
        self.run, self.subsystems, self.work = run, subsystems, work
        self.contacts: RigidContacts = subsystems.rigid

    def _inputs(self) -> Array:
        """Inputs and their first two derivatives just after the present time, shape (3, n_inputs)."""
        excitation = self.run.system.excitation
        own = excitation.about(np.array([self.run.t]))[0]
        return np.stack([polynomial.value(own, 0.0, order) for order in range(3)])

    def _held(self) -> Flags:
        """Which rigid contacts are closed, shape (n_rigid,)."""
        return np.array([self.run.branches[i].held for i in self.contacts.laws], bool)

    def check_start(self) -> None:
        """Stop where rigid bodies overlap at the start."""
        x, run = self.contacts, self.run
        d = x.rows @ run.u + x.inputs @ self._inputs()[0]
        size = np.abs(x.rows) @ np.abs(run.u) + x.gap
        for i in np.flatnonzero(d - x.gap > OVERLAP * size).tolist():
            s = run.laws[x.laws[i]]
            why = f"the rigid contact {s.element} ({s.rule}) overlaps by {d[i] - x.gap[i]:.3g} at the start"
            raise run.stop("A505", why)

    def impact(self) -> None:
        """Let the rigid contacts that touch strike, and close or part.

        Raises
        ------
        ArithmeticError
            The impacts do not end.
        """
        x, run, s, held = self.contacts, self.run, self._inputs(), self._held()
        d, rates = x.rows @ run.u + x.inputs @ s[0], x.rows @ run.v + x.inputs @ s[1]
        near = 1e-12 * (run.largest[0, x.laws] + x.gap) + 1e-13 * max(1.0, run.t) * np.abs(rates)
        touching = held | (d >= x.gap - near)
        fastest = run.largest[1, x.laws]
        impulse, lost, after = x.impact(rates, touching, fastest)
        run.v = run.v - x.velocity_change @ impulse
        # moving supports put work in
        self.work.add(np.array([float(impulse @ (x.inputs @ s[1])), 0.0, lost.sum()]))
        stays = touching & (after >= -ROUNDING * fastest)
        for i, law in enumerate(x.laws):
            run.energy.dashpot_losses[law] += float(lost[i])
            if not held[i] and (stays[i] or impulse[i] > 0.0):
                run.transition(law, 0, float(d[i]), float(rates[i]))
            if law in run.tracker.open:
                run.tracker.open[law].impulse += float(impulse[i])
            if run.branches[law].held and not stays[i]:
                if not held[i]:
                    run.tracker.open[law].peak = np.nan  # the force of an impact is infinite
                run.transition(law, 0, float(d[i]), float(after[i]))
        self.open_pulled()
        self.subsystems.present = []  # the velocities have jumped

    def open_pulled(self) -> None:
        """Open those of the closed rigid contacts whose force would be tensile.

        Raises
        ------
        ArithmeticError
            The forces are not found.
        """
        x, run = self.contacts, self.run
        if not x.laws:
            return
        # a deformation that contact keeps at next to nothing has the rounding of its terms
        terms = np.abs(x.rows) @ np.abs(run.u)
        run.largest[0, x.laws] = np.maximum(run.largest[0, x.laws], terms)
        held = self._held()
        if not held.any():
            return
        s = self._inputs()
        free, size = x.free_accelerations(run.branches, run.u, run.v, s)
        # displacements come from modes that carry the velocities as well
        size = size + self.subsystems.spectral_radius * (np.abs(x.rows) @ np.abs(run.v))
        force = x.plastic_impulses(free, held)
        parting = held & (force == 0.0) & (free - x.delassus @ force < -ROUNDING * size)
        for i in np.flatnonzero(parting).tolist():
            d, v = x.rows[i] @ run.u + x.inputs[i] @ s[0], x.rows[i] @ run.v + x.inputs[i] @ s[1]
            run.transition(x.laws[i], 0, float(d), float(v))
        rows = [self.subsystems.reaction_row[i] for i in x.laws]
        run.largest[0, rows] = np.maximum(run.largest[0, rows], size / np.diag(x.delassus))
