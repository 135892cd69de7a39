"""The course of a run: the analyses of a deck one after the other, and the tables that come of them."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pound_deck.model import Card, Model
from pound_solve import __version__
from pound_solve.analyses import damage, history, modal, pushover, restart, static
from pound_solve.analyses.equilibrium import ROUNDING, SupportReactions
from pound_solve.analyses.path_following import InstabilityError
from pound_solve.integrate.protocol import ENERGIES, INTERRUPTED, Outcome, Peaks, Stop
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import Motion
from pound_solve.numerics.types import Array
from pound_solve.results import echo
from pound_solve.results.file import Layout, Writer
from pound_solve.structure import reduction
from pound_solve.structure.assembly import Structure
from pound_solve.structure.diaphragms import diaphragm_collisions
from pound_solve.structure.elements.base import Role
from pound_solve.structure.reduction_checks import ReductionError

#: told the time reached, the time to reach, and what keeps the run waiting there, if anything
Progress = Callable[[float, float, str], None]

SIGNS = (
    "End forces act on the member along its own axes; axial tension and contact compression are positive, "
    "moments of hinges where the member sags."
)
EXACT, STEPS = "Peaks are exact.", "Peaks are those of the steps, interpolated between them."
PREDICTED = (
    "The prediction knows the diaphragms only (section 1), no other forces and no ringing: the peak of a "
    "mesh of lumped masses lies above a constant force by 14 % or more. It takes the contact for much "
    "stiffer than the diaphragms, and is left out where they touch for more than twice its time: softer "
    "contacts stay below it. The plateau is the impulse over the time of contact, or over the shorter "
    "time that the predicted force would take for it; of a coarse mesh it may lie above the peak."
)
ALPHA = "An elastic collision changes a diaphragm's velocity by 2 alpha times the approach velocity."
LUMPED = (
    "The lumped error is (1 + e) / (1 + e_eff exact) - 1 with the restitution e of the contact where "
    "DIAPHRAGMS stands on its card, else with e = 1."
)
DUST = 1e-12  #: share of the largest value below which a number is rounding
MOST_ROWS = 5_000_000  #: of stored histories
ROWS = 1000  #: of stored histories, about, where OUTPUT gives no interval


def zeroed(values: Array, kinds: Sequence[str]) -> Array:
    """Values, shape (n,), without those that are rounding of the largest of their kind."""
    out = values.copy()
    for kind in set(kinds):
        own = np.array([k == kind for k in kinds])
        out[own & (np.abs(values) < DUST * np.abs(values[own]).max())] = 0.0
    return out


class Course:
    """The analyses of one deck.

    Parameters
    ----------
    model : Model
    motions : sequence of Motion
    forces : sequence of Force
    structure : Structure
    overridden : set of str
        Lower-case names of PARAMs that the command line set.
    writer : Writer
    progress : callable or None
    began : float
        Reading of the clock when the run began.
    saved : mapping of str to ndarray
        State that a history with RESTART goes on from, as it lies in the results file; else empty.
    explain : bool
        Tell what is imported, compiled and held, too.
    """

    def __init__(
        self,
        model: Model,
        motions: Sequence[Motion],
        forces: Sequence[Force],
        structure: Structure,
        overridden: set[str],
        writer: Writer,
        progress: Progress | None,
        began: float,
        saved: Mapping[str, Array],
        explain: bool = False,
    ) -> None:
        self.model, self.motions, self.forces, self.structure = model, motions, forces, structure
        self.overridden, self.writer, self.progress = overridden, writer, progress
        self.began, self.every = began, 0.0
        self.solve_seconds = self.cpu_seconds = 0.0  # of histories
        self.saved, self.explain = saved, explain
        self.diaphragm_collisions = diaphragm_collisions(structure)
        self.held: tuple[reduction.ReducedSystem | None, Layout] = (None, {})  # of the history
        self.checks: list[tuple[str, str, str]] = []

    def all(self) -> str:
        """Run everything the deck asks for; return why it stopped, or nothing."""
        self._echo()
        doing = "static analysis"
        try:
            state = self._static()
            # from here on with the stiffness that the axial forces of the static state give
            self.structure = self.structure.stressed(state.axial).displaced(state.u)
            for name, analysis in (
                ("MODAL", self._modal),
                ("PUSHOVER", self._pushover),
                ("HISTORY", self._history),
            ):
                for card in self.model.analyses:
                    if card.spec.name == name:
                        doing = name.lower()
                        analysis(card, state)
        except InstabilityError as err:
            return f"{err.code} {doing}: {err}"
        except np.linalg.LinAlgError as err:
            return f"A501 the structure is a mechanism ({err})"
        except (ReductionError, restart.RestartError) as err:
            return f"A505 {err}"
        except Stop as err:
            return f"{err.code} at t = {err.t:.9g} {self.model.units.time}: {err}"
        except KeyboardInterrupt:
            return f"A506 {doing}: {INTERRUPTED}"
        finally:
            self._figures()
        return ""

    def _echo(self) -> None:
        m, s, w = self.model, self.structure, self.writer
        for name, text in m.files.items():
            w.text(Path(name).name, text)
        w.text("parameters", "\n".join(f"{k} = {echo.text_of(v)}" for k, v in m.params.items()))
        w.table("options", echo.options(m, self.overridden))
        w.table("nodes", echo.nodes(m))
        w.table("elements", echo.elements(m))
        w.table("properties", echo.properties(m))
        w.table("masses", echo.masses(s))
        w.table("loads", echo.loads(s.model), echo.let_go(s.model))
        w.table("member_loads", echo.member_loads(m))
        w.table("damping", echo.damping(s))
        w.table("contact_laws", echo.contact_laws(s))
        theory = any(x.pair for x in self.diaphragm_collisions.values())
        w.table("diaphragms", echo.diaphragms(s, self.diaphragm_collisions), ALPHA if theory else None)
        w.table(
            "collision_theory",
            echo.collision_theory(s, self.diaphragm_collisions),
            LUMPED if theory else None,
        )
        w.table("motions", echo.motions(self.motions))
        w.table("forces", echo.forces(self.forces))
        w.table("size", echo.size(s))

    def _static(self) -> static.StaticState:
        s, cards = self.structure, self.model.analyses
        asked = any(c.spec.name == "STATIC" for c in cards)
        needed = any(
            c.spec.name == "PUSHOVER" or "STATIC" in (c.values.get("FROM"), c.values.get("AFTER"))
            for c in cards
        )
        if not (asked or needed or s.geometric):
            return static.at_rest(s)
        state = static.solve(s)
        if asked:
            self._static_tables(s.stressed(state.axial), state)
        return state

    def _static_tables(self, s: Structure, state: static.StaticState) -> None:
        w = self.writer
        full = np.concatenate([state.u, np.zeros(len(s.dofs.moved))])
        moved = s.dofs.matrix([(node, d) for node in self.model.nodes for d in range(3)]) @ full
        nodes = list(self.model.nodes)
        shown = zeroed(moved, "LLR" * len(nodes)).reshape(-1, 3)
        w.table("static_displacement", [(node, *three) for node, three in zip(nodes, shown.tolist())])
        units = self.model.units
        forces: list[tuple[Any, ...]] = [
            (o.element, o.quantity, float(force), units.text(o.unit))
            for o, force in zip(s.outputs, s.member_forces(full))
        ]
        for x, law_state, d in zip(s.laws, state.states, (s.law_rows @ full).tolist()):
            kind = "moment" if x.unit == "F*L" else "force"
            quantity = "contact force" if x.role.collides else f"{kind} {x.component}"
            forces.append((x.element, quantity, x.force(law_state, d, 0.0), units.text(x.unit)))
        elements, what, values, unit = zip(*forces) if forces else ((), (), (), ())
        told = zip(elements, what, zeroed(np.array(values), unit).tolist(), unit)
        w.table("static_force", sorted(told, key=lambda r: r[0]), SIGNS)
        ground = SupportReactions(self.structure, state.axial)
        at = ground.reactions(state.u, state.states)
        held = [node for node, x in self.model.nodes.items() if x.fixed]
        reactions = np.array([at.get((node, d), 0.0) for node in held for d in range(3)])
        shown = zeroed(reactions, "FFM" * len(held)).reshape(-1, 3)
        w.table("reactions", [(node, *three) for node, three in zip(held, shown.tolist())])
        balance = ground.balance(state.u, state.states)
        w.table("equilibrium", balance)
        off = ground.imbalance(balance)
        good = "good" if off < ROUNDING else "look: loads and reactions do not balance"
        self.checks.append(
            ("static forces and moments out of balance over the largest", f"{off:.2e}", good)
        )
        w.table("checks", self.checks)
        course = [("changes of springs and contacts", str(state.events))]
        if s.geometric:
            course += [
                ("rounds of P-Delta", str(state.rounds)),
                ("buckling load factor", f"{state.buckling:.7g}"),
            ]
        w.table("static_run", course)

    def _modal(self, card: Card, state: static.StaticState) -> None:
        s, note = self.structure, "Contacts are open in the free vibration."
        if card["AFTER"] == "STATIC":
            s, note = static.after(s, state), "Springs and contacts are as the static state leaves them."
        rows = modal.rows(s, card["MODES"])
        if not rows:
            self.writer.table(
                "scene",
                [("free vibration", "no modes", "no degree of freedom that has mass has stiffness too")],
            )
        self.writer.table("modes", rows, note)
        if card["SHAPES"] == "YES":
            self.writer.table("mode_shapes", modal.shape_rows(s, len(rows)))

    def _pushover(self, card: Card, state: static.StaticState) -> None:
        pushed = pushover.push(self.structure, state, card)
        for name, rows in pushover.tables(self.structure, card, pushed).items():
            self.writer.table(name, rows)
        good = "good" if pushed.unbalanced < ROUNDING else "look: forces do not balance"
        self.checks.append(
            ("pushover, force out of balance over the largest", f"{pushed.unbalanced:.2e}", good)
        )
        self.writer.table("checks", self.checks)
        if pushed.failed:
            raise pushed.failed

    def _history(self, card: Card, state: static.StaticState) -> None:
        s, end = self.structure, float(card["T"])
        if card["FROM"] == "REST":
            state = static.at_rest(s)
        u0, v0 = history.initial(s)
        u, times = state.u + u0, self._times(end)
        saved = restart.load(self.saved, s) if self.saved else None
        if saved is not None:
            u, v0 = saved.u, saved.v
            times = np.concatenate([[saved.t], times[times > saved.t]])
            if len(times) < 2:
                raise restart.RestartError(
                    f"the saved state is of t = {saved.t:g}, the history ends at {end:g}"
                )
        place = reduction.build(s, self.motions, end, u, v0, self.forces)
        drifts = history.monitored(s, place)
        if saved is not None:
            start = restart.resume(saved, place, times)
        else:
            start = history.begin(s, place, u, v0, state.states, state.u, times)
        tell, first = self.progress or (lambda t, end, doing: None), None if saved is None else saved.first
        recorder = history.HistoryRecorder(
            place, drifts, self.writer.append, lambda t, doing: tell(t, end, doing), first
        )
        self.held = place, recorder.layout()
        self.writer.start_history(self.held[1])
        spec = card.laws["METHOD"][0]
        options = {f.name: card[f.name] for f in spec.fields}
        save = card["SAVE"] if card["SAVE"] is not None and times[0] < card["SAVE"] < end else end
        began, used = time.perf_counter(), time.process_time()
        stop: Stop | None = None
        parts: list[Outcome] = []
        try:
            while start.times[0] < end:
                part = replace(start, times=_until(start.times, save if start.times[0] < save else end))
                parts.append(spec.impl(place, part, drifts, options, recorder))
                recorder.flush()
                here = self._saved(place, recorder, parts[-1])
                if recorder.reached == save:
                    self.writer.restart(here.arrays(s))
                start = restart.resume(here, place, np.append(here.t, times[times > here.t]))
        except Stop as err:
            stop = err
            parts += [err.outcome] if err.outcome is not None else []
        except KeyboardInterrupt:  # before a method took its first step, or between two
            stop = Stop("A506", max(recorder.reached, 0.0), INTERRUPTED)
        self.solve_seconds += time.perf_counter() - began
        self.cpu_seconds += time.process_time() - used
        recorder.flush()
        self._scene_tables(place)
        outcome = restart.join(parts) if parts and recorder.started else None
        if recorder.started:
            self._sample_tables(place, recorder, outcome is not None and outcome.turns)
        if outcome is not None:
            self._peak_tables(recorder, outcome.peaks, EXACT if outcome.exact else STEPS)
            self._spring_tables(recorder, outcome, stop is None)
            self._check_tables(place, recorder, outcome)
        if stop is not None:
            raise stop

    def _saved(
        self, place: reduction.ReducedSystem, recorder: history.HistoryRecorder, part: Outcome
    ) -> restart.Saved:
        """State at the end of a part of a history."""
        t, (u, v, works) = recorder.reached, recorder.last
        n = self.structure.n_free
        whole_u, whole_v = (place.all_dofs(x, t, order)[:n] for order, x in enumerate((u, v)))
        return restart.Saved(t, whole_u, whole_v, part.states, works, recorder.first_energy)

    def _times(self, end: float) -> Array:
        every = self.model.output["EVERY"]
        if every is None:
            told = [m.info for m in self.motions] + [f.info for f in self.forces]
            steps = [dt for info in told if (dt := info.get("dt"))]
            every = min(steps, default=end / ROWS)
            every *= max(1, round(end / every / ROWS))
        if end / every > MOST_ROWS:
            raise Stop(
                "A505",
                0.0,
                f"OUTPUT EVERY={every:g} asks for {end / every:.0f} rows, more than {MOST_ROWS}",
            )
        count = int(np.floor(end / every * (1 + 1e-12)))
        self.every = every
        times = every * np.arange(count + 1)
        return np.append(times, end) if end - times[-1] > 1e-9 * end else np.append(times[:-1], end)

    def _scene_tables(self, place: reduction.ReducedSystem) -> None:
        rows = [(d.subject, d.decision, d.why) for d in place.decisions]
        if place.total and any(e.j is None for e in self.model.elements.values()):
            rows.append(
                (
                    "elements with one node",
                    "end at a fixed point",
                    "what no motion of SUPPORTS moves stands still",
                )
            )
        form = "total displacements" if place.total else "relative to the ground"
        rows.append(
            (
                "displacements",
                form,
                "supports move apart from each other" if place.total else "one motion for the whole base",
            )
        )
        self.writer.table("scene", rows)

    def _sample_tables(
        self, place: reduction.ReducedSystem, recorder: history.HistoryRecorder, turns: bool
    ) -> None:
        """Envelopes of nodes and members and the energies: what the samples tell, among which are the
        instants at which displacements turn or not.
        """
        w, units = self.writer, self.model.units
        rows: list[tuple[Any, ...]] = []
        found = {q: e.rows() for q, e in recorder.envelopes.node.items()}
        for i, node in enumerate(recorder.nodes):
            for axis in range(3):
                for q, word, dimension in (
                    ("u", "displacement", "L"),
                    ("v", "velocity", "L/T"),
                    ("a", "acceleration", "L/T^2"),
                ):
                    extremes = found[q][3 * i + axis]
                    if extremes[0] != 0.0 or extremes[2] != 0.0:
                        unit = units.text(dimension if axis < 2 else dimension.replace("L", "rad"))
                        rows.append((node, "XYR"[axis], word, unit, *extremes))
        seen, apart = recorder.envelopes.seen, recorder.envelopes.apart
        if seen:
            peaks = "peaks of displacements are among them, others" if turns else "peaks"
            how = (
                f"Seen at {seen} instants, at most {apart:.3g} {units.time} apart, "
                f"and at the output times; {peaks} between them are not. "
            )
        else:
            how = (
                f"At the output times, every {self.every:.6g} {units.time}: peaks between them are not "
                "seen, a smaller OUTPUT EVERY finds them. "
            )
        relative = "Displacements and velocities are relative to the ground, accelerations are total."
        w.table("node_envelope", rows, how + ("All are total." if place.total else relative))
        w.table(
            "member_envelope",
            [
                (o.element, o.quantity, units.text(o.unit), *extremes)
                for o, extremes in zip(recorder.outputs, recorder.envelopes.output.rows())
            ],
            how + SIGNS,
        )
        first, input_ = recorder.first_energy, float(recorder.last_energy[0])
        changes = [*(recorder.last_energy - first * (np.arange(len(ENERGIES)) > 0)), recorder.last_residual]
        share = 100.0 / input_ if input_ else float("nan")
        w.table(
            "energy",
            [(name, float(x), float(x) * share) for name, x in zip((*ENERGIES, "residual"), changes)],
            "Changes since the start" + ("." if place.total else ", of the motion relative to the ground."),
        )

    def _peak_tables(self, recorder: history.HistoryRecorder, peaks: Peaks, how: str) -> None:
        """Drifts, contacts and collisions: what the method found on its way; `how` it found it."""
        m, s, w = self.model, self.structure, self.writer
        w.table(
            "drift_envelope",
            [
                (name, e.high, e.t_high, e.low, e.t_low, h, max(abs(e.high), abs(e.low)) / h)
                for name, e, h in zip(recorder.drifts.names, peaks.monitored, history.heights(m))
            ],
            how,
        )
        contact_rows = []
        for i, x in enumerate(s.laws):
            if not x.role.collides:
                continue
            d = peaks.deformation[i]
            own = [c for c in peaks.collisions if c.law == i]
            best = max(own, key=lambda c: (c.peak == c.peak, c.peak), default=None)  # NaN: an impact
            closed = sum((c.t_end if np.isfinite(c.t_end) else recorder.reached) - c.t_start for c in own)
            gap = x.facts["gap"]
            contact_rows.append(
                (
                    history.contact_name(m, x.element),
                    len(own),
                    best.peak if best else 0.0,
                    best.t_peak if best else float("nan"),
                    max(d.high - gap, 0.0),
                    sum(c.impulse for c in own),
                    recorder.losses[i] + peaks.dashpot_losses[i],
                    gap - d.high,
                    closed,
                )
            )
        w.table("contact_summary", contact_rows, how + " A closure that has not ended counts.")
        ordered = sorted(peaks.collisions, key=lambda c: (c.t_start, c.law))
        w.table(
            "collisions",
            [
                (
                    history.contact_name(m, s.laws[c.law].element),
                    c.t_start,
                    c.t_end,
                    c.approach,
                    c.separation,
                    c.separation / c.approach if c.approach > 0 else float("nan"),
                    c.peak,
                    c.t_peak,
                    c.impulse,
                    self.diaphragm_collisions[c.law].plateau(c.impulse, c.t_end - c.t_start),
                    predicted := self.diaphragm_collisions[c.law].predicted(
                        c.approach, c.t_end - c.t_start
                    ),
                    100.0 * (predicted / c.peak - 1.0) if c.peak > 0.0 else float("nan"),
                )
                for c in ordered
            ],
            PREDICTED if any(x.pair for x in self.diaphragm_collisions.values()) else None,
        )

    def _spring_tables(self, recorder: history.HistoryRecorder, outcome: Outcome, ended: bool) -> None:
        """What springs and hinges went through; damage where the ultimate ductility is given."""
        m, s, units, peaks = self.model, self.structure, self.model.units, outcome.peaks
        rows, plastic, damaged = [], [], []
        for i, x in enumerate(s.laws):
            if x.role.collides:
                continue
            d, f, loss = peaks.deformation[i], peaks.force[i], recorder.losses[i]
            if x.role.viscous:
                loss += peaks.dashpot_losses[i]
            rows.append(
                (
                    x.element,
                    x.component,
                    x.rule,
                    units.text(x.unit),
                    f.high,
                    f.low,
                    units.text("rad" if x.unit == "F*L" else "L"),
                    d.high,
                    d.low,
                    peaks.yields[i],
                    damage.ductility((d.high, d.low), x.yields),
                    loss,
                )
            )
            if loss and x.role is Role.SPRING:  # friction has no residual deformation of its own
                last, unit = recorder.deformations[i], rows[-1][6]
                left = damage.residual(x.law, outcome.states[i], last) if ended else np.nan
                path = damage.plastic_path(loss, x.k0, x.yields)
                plastic.append((x.element, x.component, unit, last, left, *path))
            card = m.props[m.elements[x.element].prop]
            ultimate = card.values.get("DUCTU")
            if ultimate is not None and x.yields is not None:
                sides = (ultimate[0], ultimate[-1])
                found = damage.park_ang((d.high, d.low), loss, x.k0, x.yields, sides, card["PA_BETA"])
                damaged.append((x.element, x.component, found, loss))
        how = EXACT if outcome.exact else STEPS
        self.writer.table("spring_envelope", rows, how)
        self.writer.table("spring_plastic", plastic)
        if not damaged:
            return
        losses = [loss for *_, loss in damaged]
        total = sum(losses) or np.nan
        whole = damage.overall([found.total for _, _, found, _ in damaged], losses)
        self.writer.table(
            "damage",
            [
                *((e, name, *found, found.total, loss / total) for e, name, found, loss in damaged),
                (0, "", *[np.nan] * 4, whole, sum(losses) / total),
            ],
        )

    def _check_tables(
        self, place: reduction.ReducedSystem, recorder: history.HistoryRecorder, outcome: Outcome
    ) -> None:
        """Self-checks and the course of the run."""
        w = self.writer
        # not over the input at the end, which a free body may have given back
        scale = recorder.energy_peak
        ratio = recorder.residual_peak / scale if scale else 0.0
        good = "good" if ratio < (1e-9 if outcome.exact else 1e-2) else "look: energy is lost or made"
        checks = [("largest energy residual over the largest energy", f"{ratio:.2e}", good)]
        self.checks += checks + outcome.checks
        w.table("checks", self.checks)
        w.table("run", [("unknowns", str(place.size)), *((k, str(v)) for k, v in outcome.figures.items())])

    def _figures(self) -> None:
        rows = [
            ("solve seconds", f"{self.solve_seconds:.4f}"),
            ("solve seconds, CPU", f"{self.cpu_seconds:.4f}"),
            ("total seconds", f"{time.perf_counter() - self.began:.4f}"),
            ("pound-solve", __version__),
            ("Python, numpy", f"{platform.python_version()}, {np.__version__}"),
        ]
        self.writer.table("run_figures", rows)
        if not self.explain:
            return
        from pound_solve.driver import resources

        kind = resources.kind(self.structure, {card.spec.name for card in self.model.analyses})
        self.writer.table(
            "arrays", resources.arrays(self.structure, *self.held), f"Kind of problem: {kind}."
        )
        self.writer.table("imports", resources.imports())


def _until(times: Array, end: float) -> Array:
    """The times up to `end`, which is the last of them."""
    return np.append(times[times < end * (1 - 1e-12)], end)
