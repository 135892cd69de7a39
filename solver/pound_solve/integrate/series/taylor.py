r"""TAYLOR: event-driven integration by power series, explicit, without a time step to choose.

Between events the reduced system is linear, so the motion has a power series that converges everywhere.
Each coefficient follows from the previous ones by products with the sparse K and C (see `expansion`).  The
forces of closed rigid contacts (`rigid`), power contacts (`power_contacts`), smooth hysteresis (`smooth`)
and friction (`friction`) are separate series, whose coefficients follow likewise.  A step is as long as
`expansion.MAX_DEGREE` terms are accurate to rounding: about five radians of the fastest mode that takes
part.  Within it each event function and each quantity whose peak is kept is a polynomial, whose first rise
and extremes are found with proof (see `events.polynomial_roots`).  Works are integrated by Gauss's rule,
each on its own, so that the balance of energies remains a check.  Massless unknowns follow the others
(see `massless`).

Elastic motion without contact is advanced in modes, from goal to goal (`modal`).  Otherwise the products
determine the cost of a step.  If EXACT has to decompose many unknowns, or many combinations of stiffnesses,
TAYLOR is faster and as exact.  If the fastest mode is far above the motion (a stiff node with little mass,
a strong dashpot), TAYLOR takes many steps.

References
----------
Barrio R (2005), Performance of the Taylor series method for ODEs/DAEs, Appl. Math. Comput. 163: 525-545;
Jorba A, Zou M (2005), A software package for the numerical integration of ODEs by means of high-order
Taylor methods, Experimental Mathematics 14: 99-117.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Spec
from pound_solve.check import Check
from pound_solve.integrate.events import polynomial_roots
from pound_solve.integrate.kernels import allocation
from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.integrate.kernels.recording import PAUSE
from pound_solve.integrate.kernels.state import (
    CHATTER,
    LOST_FORCE,
    RIGID_EVENT,
    RUNAWAY,
    STEP_TOO_SHORT,
    UNRESTRAINED,
    Goals,
    Scheme,
)
from pound_solve.integrate.protocol import (
    CHATTER_TEXT,
    RUNAWAY_TEXT,
    MonitoredOutputs,
    Outcome,
    Problem,
    Recorder,
    Stop,
    goals,
    reason_not_in_series,
    reason_not_linear,
    refuse_rigid,
    remedy,
    rounding_check,
)
from pound_solve.integrate.release import release
from pound_solve.integrate.rigid.contacts import MasslessContact, RigidContacts
from pound_solve.integrate.rigid.instants import RigidInstants
from pound_solve.integrate.series import (
    envelope_buffers,
    expansion,
    friction,
    march,
    massless,
    modal_tables,
    p_delta,
    power_contacts,
    power_dampers,
    rigid,
    single_pole,
    smooth,
    springs,
    state,
)
from pound_solve.integrate.series.course import IntervalCourse, StepCourse
from pound_solve.integrate.series.present import Present
from pound_solve.integrate.tracker import Peaks
from pound_solve.laws.automaton import BranchKind
from pound_solve.numerics.matrices import MAX_DENSE, dense, used_rows
from pound_solve.numerics.record import record
from pound_solve.numerics.types import Array
from pound_solve.structure.elements.base import Role

MAX_STEPS = 5_000_000  #: most steps of a run


def gauss_rules(rules: int) -> Array:
    """Weights and points on (0, 1) of Gauss's rules with 2, 4 ... points, see `state.Series`."""
    gauss = np.zeros((rules, 2, 2 * rules))
    for i in range(rules):
        count = 2 * (i + 1)
        places, weights = np.polynomial.legendre.leggauss(count)
        gauss[i, :, :count] = 0.5 * weights, 0.5 * (1.0 + places)
    return gauss


class Taylor(KernelEngine):
    """One run; see the module docstring."""

    exact = True
    keeps_steps = False
    description = "TAYLOR, power series"
    limited_by = "the fastest mode"  #: cause of short steps, for messages

    def __init__(
        self,
        problem: Problem[Recorder],
        contacts: RigidContacts,
        most: float,
        tolerance: float | None = None,
    ) -> None:
        length = float(problem.start.times[-1]) - problem.begin
        solved = Scheme(0.0, 0.0) if tolerance is None else Scheme(1.0, 1.0)  # nothing, or C and K
        super().__init__(problem, solved, length, self.description)
        self.contacts, self.most = contacts, most
        self.sim.run.branches_changed = 1
        self.control: state.StepControl = record(state.StepControl)
        self.control.next_length, self.control.shortest_length = length, np.inf
        self.massless = self._allocate_massless()
        self.series = self._allocate(problem.monitored, tolerance)
        for i in self.series.power_contacts.laws.tolist():
            law_kernels.enter_branch(self.laws, self.rules, i)  # no tangent: its force is a series
            power_contacts.enter_power_contact(self.laws, self.rules, self.series.power_contacts, i)
        power_dampers.linearise_dampers(self.laws, self.rules, self.series.power_dampers)
        smooth.linearise_smooth(self.laws, self.rules, self.series.smooth)
        smooth.set_rate_floor(self.laws.largest, self.series.smooth, length)
        self._hold()

    def _allocate_massless(self) -> state.Massless:
        """Arrays of the massless unknowns."""
        o, system = self.order, self.system
        return massless.allocate(
            self.linear,
            system.stiffness[np.ix_(o, o)],
            system.damping[np.ix_(o, o)],
            system.law_rows[:, o],
            np.array([0.0 if s.role.collides else s.steepest for s in self.law_springs], float),
        )

    def _allocate(self, monitored: MonitoredOutputs, tolerance: float | None) -> state.Series:
        """Arrays of the series, whose parts are empty where nothing in the system needs them."""
        system, laws, o = self.system, self.laws, self.order
        n, n_inputs, n_laws, n_coefs = (
            system.size,
            system.inputs.shape[1],
            len(self.law_springs),
            expansion.MAX_DEGREE + 1,
        )
        mass, whole = self.linear.mass.diagonals[0], system.stiffness[np.ix_(o, o)]
        is_curved = np.array([s.law.curved for s in self.law_springs], bool)
        collides = np.array([s.role.collides for s in self.law_springs], bool)
        is_damper = is_curved & np.array([s.role is Role.DAMPER for s in self.law_springs], bool)
        is_smooth = np.array([s.law.rule.smooth_curve is not None for s in self.law_springs], bool)
        enveloped = self.inverse_order[np.flatnonzero(self.recorder.enveloped_unknowns)]
        modal = modal_tables.allocate(
            system, laws.tangent.stiffness, monitored, self._intervals(), self.inverse_order, enveloped
        )
        kept = n_coefs if tolerance is None else single_pole.LAST_TERM + 1
        return state.Series(
            motion=np.zeros((n_coefs, n)),
            stiffness_product=np.zeros(n),
            damping_product=np.zeros(n),
            mass_product=np.zeros(n),
            deformation=np.zeros((n_laws, n_coefs)),
            inputs=np.zeros((n_coefs, n_inputs)),
            polynomial=np.zeros(polynomial_roots.room(expansion.MAX_DEGREE)),
            inverse=np.divide(1.0, mass, out=np.zeros(n), where=mass > 0.0),
            gauss=gauss_rules(expansion.MAX_DEGREE // expansion.UNCHECKED_TERMS + 1),
            springs=springs.allocate(
                n, laws.definition.rows, self.linear.inputs, whole if len(self.massless.unknown) else None
            ),
            massless=self.massless,
            rigid=rigid.allocate(self.contacts, o, n_laws, n_coefs),
            power_contacts=power_contacts.allocate(is_curved & collides, n_coefs),
            friction=friction.allocate(
                laws.friction.coupled, laws.friction.normal_law[laws.friction.coupled], n_laws, n_coefs
            ),
            smooth=smooth.allocate(is_smooth, n_coefs),
            power_dampers=power_dampers.allocate(is_damper, self.massless.index_of_law >= 0, n_coefs),
            p_delta=p_delta.allocate(len(self.members.parameters), n_coefs),
            damped=self._damped(n_coefs),
            modal=modal,
            envelope=envelope_buffers.allocate(enveloped, self.recorder.enveloped_laws, modal, kept),
            single_pole=single_pole.allocate(n, n_inputs, tolerance),
            control=self.control,
        )

    def _damped(self, n_coefs: int) -> state.Damped:
        """The unknowns that dashpots act on, in the order of elimination."""
        unknown = np.flatnonzero(used_rows(self.system.damping[self.order]))
        damped = self.order[unknown]
        n = len(unknown)
        matrix = allocation.product(self.system.damping[np.ix_(damped, damped)])
        return state.Damped(unknown, matrix, np.zeros((n_coefs, n)), np.zeros(n), np.zeros(n))

    def _intervals(self) -> Array:
        """Return the times between which intervals may be advanced in modes; none if something acts that
        modes do not cover.
        """
        laws, linear = self.laws, self.linear
        others = (
            len(self.members.parameters)
            + len(self.massless.unknown)
            + len(self.contacts.laws)
            + len(linear.support_damping)
        )
        acts_else = (
            laws.definition.curved.any() or laws.definition.inputs.any() or linear.monitored_inputs.any()
        )
        if others or acts_else or len(laws.friction.coupled):
            return np.zeros(1)
        return np.concatenate([self.times[:1], goals(self.system, self.times)[0]])

    def integrate(self) -> None:
        """Integrate by series from event to event."""
        self.begin(march.march)
        self._at_instant(RigidInstants.begin)
        for i in self.series.friction.laws.tolist():
            friction.set_sliding_direction(self.laws.state, self.series.friction, i)
        ex = self.system.excitation
        ends, is_output = goals(self.system, self.times)
        pieces = ex.pieces_after(np.append(self.times[0], ends[:-1]))
        ahead = Goals(ends, is_output, pieces, np.ascontiguousarray(ex.coefs), ex.breaks)
        self.advance(march.march, self.series, ahead)

    def resume(self, why: int) -> None:
        """Let rigid contacts strike, close or part, or move massless joints after a lost force; stop if
        the run cannot continue.
        """
        if why not in (RIGID_EVENT, LOST_FORCE):
            raise self.trouble(why)
        if why == LOST_FORCE:
            present = Present(self, self.series)
            release(present, int(self.sim.run.changed_law))
            present.hand_back()
            self.sim.run.changed_law = -1  # the force is lost: the rest of a jump is rounding
            return
        self._at_instant(self._strike)
        self.sim.run.events += 1

    def _strike(self, instants: RigidInstants) -> bool:
        """Let the rigid contact of the event strike, or part."""
        present, law = instants.run, int(self.sim.run.changed_law)
        if present.branches[law].constrains:
            present.transition(
                law, 0, float(self.laws.now.deformation[law]), float(self.laws.now.rate[law])
            )
        else:
            instants.impact()
        instants.open_pulled()
        return True

    def _at_instant(self, happens: Callable[[RigidInstants], bool]) -> None:
        """Apply an action to the rigid contacts at the present instant, and continue from there if it took
        place.
        """
        present = Present(self, self.series)
        instants = RigidInstants(present, self.contacts)
        try:
            if not happens(instants):
                return
        except ArithmeticError as err:
            raise self.stop("A503", str(err)) from None
        known = (self.massless.index_of_law < 0) & (self.series.friction.index_of < 0)
        present.hand_back_impact(np.flatnonzero(known))
        self._hold(instants.rounding)

    def _hold(self, rounding: Array | float = 0.0) -> None:
        """Set which rigid contacts are closed, and the `rounding` of their forces."""
        x = self.series.rigid
        kinds = [self.law_springs[i].law.rule.branches[self.laws.state.branch[i]].kind for i in x.laws]
        closed = np.array([kind is BranchKind.HELD for kind in kinds], bool)
        rigid.set_closed_contacts(x, self.contacts, closed)
        x.largest[:] = np.maximum(x.largest, rounding)

    def fetch_motions(self) -> None:
        """Pass the stored series and modes to the recorder."""
        envelope = self.series.envelope
        if envelope.kept[envelope_buffers.STEPS]:
            self.recorder.between(StepCourse(envelope, self.order, self.system.excitation).course())
        if envelope.kept[envelope_buffers.INTERVALS]:
            self.recorder.between(IntervalCourse(envelope, self.series.modal, self.order).course())
        envelope.kept[:] = 0

    def fetch(self) -> None:
        """Fetch the stored results; stop if steps are too short for the length of the run."""
        super().fetch()
        done, steps = float(self.sim.run.time - self.times[0]), int(self.sim.run.steps)
        if steps > PAUSE // 2 and steps * self.dt > self.most * done:
            count = f"some {steps * self.dt / done:.1g}" if done else "far too many"
            why = f"{self.limited_by} requires {count} steps (now {self.control.next_length:.3g} long)"
            raise self.stop("A502", why + self.remedy())

    def remedy(self) -> str:
        """Return which methods need not resolve the fastest mode."""
        linear = not reason_not_linear(self.system)
        if self.contacts.laws:
            return ", which EXACT need not follow" if linear else ""
        return f", which {'LAGUERRE and ' if linear else ''}NEWMARK need not follow"

    def trouble(self, why: int) -> Stop:
        """Return the `Stop` that explains why the kernel has returned early."""
        if why == STEP_TOO_SHORT:
            return self.stop(
                "A502", f"{self.limited_by} requires steps shorter than the resolution of the time"
            )
        if why == UNRESTRAINED:
            return self.stop("A501", self._explain_massless())
        if why == RUNAWAY:
            return self.stop("A504", RUNAWAY_TEXT.format(self.sim.run.runaway_energy))
        if why == CHATTER:
            law = int(self.sim.run.changed_law)
            s, at = self.law_springs[law], self.laws.state.branch[law]
            what = (int(self.sim.run.changes_at_instant), s.element, s.rule, s.law.rule.branches[at].name)
            return self.stop("A503", CHATTER_TEXT.format(*what, remedy(self.system)))
        return super().trouble(why)

    def _explain_massless(self) -> str:
        """Return which massless unknown is unrestrained, and why."""
        fault = int(self.sim.run.failed_unknown)
        name, n = (
            self.system.name(int(self.order[fault])),
            int(np.flatnonzero(self.massless.unknown == fault)[0]),
        )
        if self.massless.damped[n]:
            whole = massless.least_damped_unknowns(self.laws, self.massless)
            names = [self.system.name(i) for i in sorted(self.order[self.massless.unknown[whole]].tolist())]
            joints = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else name
            return f"{joints} have no mass, and only dashpots to each other resist them: give one weight"
        if self.massless.failed_pivot[0] < 0.0:
            return self.system.explain_massless(self._softest(), softens=True)
        return self.system.explain_massless(int(self.order[fault]))

    def _softest(self) -> int:
        """Return the unknown that moves most in the softest motion of massless unknowns without dashpot."""
        undamped = self.order[self.massless.unknown[~np.asarray(self.massless.damped, bool)]]
        if len(undamped) > MAX_DENSE:
            return int(self.order[int(self.sim.run.failed_unknown)])
        rows = dense(self.system.law_rows[:, undamped])
        stiffness = dense(self.system.stiffness[np.ix_(undamped, undamped)])
        shapes = np.linalg.eigh(stiffness + (rows.T * self.laws.tangent.stiffness) @ rows)[1]
        return int(undamped[np.argmax(np.abs(shapes[:, 0]))])

    def figures(self) -> dict[str, Any]:
        """Figures of the run for the report."""
        shortest, in_modes = float(self.control.shortest_length), int(self.control.n_modal_intervals)
        return {
            "method": self.name,
            "series": int(self.sim.run.steps) - in_modes,
            **({"intervals in modes": in_modes} if in_modes else {}),
            **({"shortest series": f"{shortest:.4g}"} if np.isfinite(shortest) else {}),
            "events": int(self.sim.run.events),
        }

    def checks(self, peaks: Peaks) -> list[Check]:
        """Self-checks of the run."""
        return rounding_check(self.law_springs, peaks)


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system by power series; see the module docstring.  `options` may hold STEPS, the
    largest number of steps.

    Raises
    ------
    Stop
        A reduced system that is not piecewise linear, massless DOFs that cannot be condensed, too many
        changes at one instant, too many steps, an overflow of numbers, or an interrupt.
    """
    if why := reason_not_in_series(problem.system):
        refuse_rigid(problem, "TAYLOR")
        raise Stop("A505", problem.begin, f"TAYLOR finds no power series where {why}: AUTO takes steps")
    try:
        contacts = RigidContacts(problem.system)
    except MasslessContact as err:
        raise Stop("A505", problem.begin, str(err)) from None
    return Taylor(problem, contacts, options.get("STEPS", MAX_STEPS)).run()


SPEC = Spec(
    "method",
    "TAYLOR",
    "event-driven, power series between events",
    (),
    reference="Jorba & Zou 2005; Barrio 2005",
    impl=integrate,
)
