r"""Kernels of TAYLOR: the motion of a step as a power series, its length, events, peaks and works.

With :math:`s = t/h` the coefficients of :math:`u = \sum_k c_k s^k` follow from the equations of motion,

.. math::
    (k+1)(k+2)\,M c_{k+2} = h^2\Bigl(p_k - K c_k - \sum_i b_i f_{ik}\Bigr) - h (k+1)\,C c_{k+1},

:math:`f_{ik} = k_i d_{ik} + (k+1) c_i d_{i,k+1}/h` those of the laws' forces on their present branches.
Terms are taken until two in a row are below a share `SMALL` of the motion in the norm of energy,
:math:`k^2 c_k^T M c_k / h^2`; where even the last are not, the step ends where they would be, or is tried
again if that is far from its end.

Everything that is looked for within a step is a polynomial: exits of laws, deformations, forces.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, first_rise, highest, size
from pound_solve.integrate.kernels.consistency import make_consistent
from pound_solve.integrate.kernels.laws import linear_force, transition
from pound_solve.integrate.kernels.products import along, evaluate_inputs, form_load, multiply
from pound_solve.integrate.kernels.recording import (
    log_transition,
    next_pause,
    store_sample,
    take_first_sample,
)
from pound_solve.integrate.kernels.state import (
    CHATTER,
    DONE,
    FULL,
    MASS,
    RUNAWAY,
    Buffers,
    Energy,
    Laws,
    LinearSystem,
    Motion,
    Run,
    Step,
)
from pound_solve.integrate.kernels.work import load_on_nodes, support_power
from pound_solve.integrate.protocol import STILL
from pound_solve.laws.functions import Tables
from pound_solve.numerics.jit import flat, loose
from pound_solve.numerics.ldl import solve
from pound_solve.numerics.types import Array, Flags, Index

TERMS = 32  #: of a series, at most
CHECK = 4  #: terms after which it is seen whether they suffice
SMALL = 1e-14  #: share of the motion that a term left out may be
QUIET = 1e-13  #: share of its energy that a term may carry that works need not see
GROW = 2.0  #: how much longer than the last a step may be
AHEAD = 1e-3  #: part of a step that laws are looked at for which may leave at the instant of another
LOOKS = 2  #: instants of a step that envelopes of nodes and members see: some 2.5 radians apart
CUT = 0.5  #: part of a step, as it was tried, that is taken at least
INSTANT = 1e-13  #: share of the time within which two events are at one instant
SHORT = 7  #: why `march` came back, beside those of `kernels.state`: steps are too short for the clock


class Lengths(Protocol):
    """Lengths and sizes that the steps of a run learn from one another: a numpy record."""

    next: float  #: length to try next
    kinetic: float  #: most of v M v so far
    shortest: float  #: step
    carried: int  #: terms of the present series that carry energy


class Series(NamedTuple):
    """The series of a step.

    Attributes
    ----------
    motion : ndarray, shape (TERMS + 1, n)
        Coefficients of the unknowns.
    stiffness_product, damping_product : ndarray, shape (n,)
        Scratch: products of coefficients with K, and with C or M.
    deformation : ndarray, shape (n_laws, TERMS + 1)
        Of the laws.
    inputs : ndarray, shape (TERMS + 1, n_inputs)
    polynomial : ndarray, shape `polynomial_roots.room`
        What `polynomial_roots` works on.
    inverse : ndarray, shape (n,)
        Of a diagonal mass.
    gauss : ndarray, shape (TERMS // CHECK + 1, 2, most points)
        Weights and points on (0, 1), two more than half of the terms that carry energy.
    """

    motion: Array
    stiffness_product: Array
    damping_product: Array
    deformation: Array
    inputs: Array
    polynomial: Array
    inverse: Array
    gauss: Array


@loose
def dot(a: Array, b: Array) -> float:
    """Product of two vectors."""
    total = 0.0
    for k in range(len(a)):
        total += a[k] * b[k]
    return total


def expand_inputs(series: Series, coefs: Array, begin: float, h: float) -> None:
    """Series of the inputs from the local time `begin` of their piece on, in steps of `h`."""
    s = series.inputs
    top, n = coefs.shape
    for j in range(n):
        for k in range(top):
            s[k, j] = coefs[k, j]
        for i in range(top - 1):
            for k in range(top - 2, i - 1, -1):
                s[k, j] += begin * s[k + 1, j]
        scale = 1.0
        for k in range(top):
            s[k, j] *= scale
            scale *= h


def expand_deformations(laws: Laws, series: Series, k: int, top: int) -> None:
    """Coefficients `k` of the deformations; the inputs have `top` of them."""
    for i in range(len(laws.rule)):
        d = along(laws.rows, i, series.motion[k])
        if k < top:
            for j in range(series.inputs.shape[1]):
                d += laws.inputs[i, j] * series.inputs[k, j]
        series.deformation[i, k] = d


def energy_of_term(linear: LinearSystem, series: Series, k: int, h: float) -> float:
    """Twice the kinetic energy of the term `k`."""
    multiply(linear.mass, series.motion[k], series.damping_product)
    return dot(series.motion[k], series.damping_product) * (k / h) * (k / h)


def next_term(
    linear: LinearSystem, laws: Laws, step: Step, series: Series, k: int, h: float, top: int
) -> None:
    """Coefficients `k` + 2 of the unknowns from the two before (see the module's head)."""
    c, new = series.motion, series.motion[k + 2]
    n = len(new)
    multiply(linear.stiffness, c[k], series.stiffness_product)
    multiply(linear.damping, c[k + 1], series.damping_product)
    rate = h * (k + 1)
    for i in range(n):
        new[i] = -h * h * series.stiffness_product[i] - rate * series.damping_product[i]
    if k == 0:
        for i in range(n):
            new[i] += h * h * linear.constant[i]
    if k < top:
        for j in range(series.inputs.shape[1]):
            push = h * h * series.inputs[k, j]
            if push != 0.0:
                for i in range(n):
                    new[i] += linear.inputs[j, i] * push
    for i in range(len(laws.rule)):
        d = series.deformation
        force = h * h * laws.stiffness[i] * d[i, k] + rate * laws.damping[i] * d[i, k + 1]
        if k == 0:
            force += h * h * laws.offset[i]
        if force != 0.0:
            for q in range(laws.rows.pointers[i], laws.rows.pointers[i + 1]):
                new[laws.rows.columns[q]] -= laws.rows.values[q] * force
    below = 1.0 / ((k + 1) * (k + 2))
    if linear.diagonal:
        for i in range(n):
            new[i] *= series.inverse[i] * below
    else:
        for i in range(n):
            new[i] *= below
        solve(linear.pattern, step.factors[MASS], step.pivots[MASS], new)
    expand_deformations(laws, series, k + 2, top)


@flat
def expand(
    linear: LinearSystem, laws: Laws, step: Step, series: Series, lengths: Lengths, coefs: Array,
    begin: float, h: float,
) -> tuple[int, float]:  # fmt: skip
    """Find the series of a step of length `h` from the present state on.

    Returns
    -------
    terms : int
        Its highest power.
    end : float
        Part of the step, or multiple of it, up to which it is right; NaN where numbers are beyond all
        bounds.
    """
    c, now, top = series.motion, step.now, len(coefs)
    expand_inputs(series, coefs, begin, h)
    for i in range(len(now.displacement)):
        c[0, i], c[1, i] = now.displacement[i], h * now.velocity[i]
    expand_deformations(laws, series, 0, top)
    expand_deformations(laws, series, 1, top)
    lengths.kinetic = max(lengths.kinetic, energy_of_term(linear, series, 1, h))
    most, k, own, last, lengths.carried = lengths.kinetic, 0, 0.0, 0.0, CHECK
    while k + 2 <= TERMS:
        while True:
            next_term(linear, laws, step, series, k, h, top)
            k += 1
            if (k + 1) % CHECK == 0:
                break
        terms = k + 1
        own, last = energy_of_term(linear, series, terms, h), energy_of_term(linear, series, terms - 1, h)
        if most == 0.0:  # from rest
            most = max(energy_of_term(linear, series, 2, h), last, own)
        if own + last > QUIET * most:
            lengths.carried = terms + CHECK
        if terms > top and own + last <= SMALL * SMALL * most:
            break
    if not own + last < np.inf:
        return terms, np.nan
    end = GROW
    if own > 0.0:
        end = min(end, (SMALL * SMALL * most / own) ** (0.5 / terms))
    if last > 0.0:
        end = min(end, (SMALL * SMALL * most / last) ** (0.5 / (terms - 1)))
    return terms, end


def event_of(laws: Laws, series: Series, terms: int, h: float, end: float, i: int) -> tuple[int, float]:
    """The first event of law `i` before `end`, and where; -1 where there is none."""
    event, d, p = -1, series.deformation, series.polynomial[POLYNOMIAL]
    for e in range(laws.n_events[i]):
        on_d, on_v, constant = laws.events[i, e, 0], laws.events[i, e, 1], laws.events[i, e, 2]
        if on_d == 0.0 and on_v == 0.0:
            continue
        for k in range(terms + 1):
            p[k] = on_d * d[i, k]
        p[0] += constant
        if on_v != 0.0:
            for k in range(terms):
                p[k] += on_v * (k + 1) / h * d[i, k + 1]
        scale = abs(on_d) * laws.largest_deformation[i] + abs(on_v) * laws.largest_rate[i] + abs(constant)
        at = first_rise(series.polynomial, terms, end, STILL * scale)
        if at >= 0.0 and (event < 0 or at < end):
            event, end = e, at
    return event, end


def first_event(laws: Laws, series: Series, terms: int, h: float, end: float) -> tuple[int, int, float]:
    """The first event of any law before `end`: law, event and place; law -1 where there is none."""
    law, event = -1, -1
    for i in range(len(laws.rule)):
        own, at = event_of(laws, series, terms, h, end, i)
        if own >= 0 and (law < 0 or at < end):
            law, event, end = i, own, at
    return law, event, end


def count_crest(
    laws: Laws, step: Step, series: Series, terms: int, h: float, end: float, t: float, i: int, law: int
) -> None:
    """Count the polynomial at work into peak `i`; `law` is not negative for the force of a law."""
    peaks, p = step.peaks, series.polynomial
    known = peaks.high[i]
    contact = law >= 0 and laws.contact[law]
    if contact:
        known = min(known, laws.peak_force[law])
    high, place = highest(p, terms, end, known)
    if high > peaks.high[i]:
        peaks.high[i], peaks.t_high[i] = high, t + h * place
    if contact and high > laws.peak_force[law]:
        laws.peak_force[law], laws.peak_time[law] = high, t + h * place
    for k in range(terms + 1):
        p[POLYNOMIAL, k] = -p[POLYNOMIAL, k]
    high, place = highest(p, terms, end, -peaks.low[i])
    if place >= 0.0:
        peaks.low[i], peaks.t_low[i] = -high, t + h * place


def track_outputs(
    linear: LinearSystem, laws: Laws, step: Step, series: Series, terms: int, h: float, end: float, t:
    float, top: int,
) -> None:  # fmt: skip
    """Count the monitored outputs up to `end` into the peaks."""
    p = series.polynomial[POLYNOMIAL]
    for i in range(len(linear.monitored_constants)):
        for k in range(terms + 1):
            p[k] = along(linear.monitored, i, series.motion[k])
        for k in range(min(top, terms + 1)):
            for j in range(series.inputs.shape[1]):
                p[k] += linear.monitored_inputs[i, j] * series.inputs[k, j]
        p[0] += linear.monitored_constants[i]
        count_crest(laws, step, series, terms, h, end, t, i, -1)


def track_laws(
    laws: Laws, step: Step, series: Series, terms: int, h: float, end: float, t: float, first: int
) -> None:
    """Count deformations and forces of the laws up to `end` into the peaks, from peak `first` on."""
    peaks, d, p = step.peaks, series.deformation, series.polynomial[POLYNOMIAL]
    for i in range(len(laws.rule)):
        begin, far = d[i, 0], size(d, i, terms)
        if begin + far > peaks.high[first + i] or begin - far < peaks.low[first + i]:
            for k in range(terms + 1):
                p[k] = d[i, k]
            count_crest(laws, step, series, terms, h, end, t, first + i, -1)
        own = first + len(laws.rule) + i
        stiffness, damping = laws.stiffness[i], laws.damping[i] if laws.contact[i] else 0.0
        far *= abs(stiffness)
        high = peaks.high[own]
        if laws.contact[i]:
            high = min(high, laws.peak_force[i])
        force = laws.offset[i] + stiffness * begin
        if damping != 0.0 or force + far > high or force - far < peaks.low[own]:
            for k in range(terms + 1):
                p[k] = stiffness * d[i, k]
            p[0] += laws.offset[i]
            if damping != 0.0:
                for k in range(terms):
                    p[k] += damping * (k + 1) / h * d[i, k + 1]
            count_crest(laws, step, series, terms, h, end, t, own, i)


def derived(k: int, order: int, h: float) -> float:
    """What a derivative makes of the power `k`."""
    out = 1.0
    for j in range(order):
        out *= (k - j) / h
    return out


def evaluate(series: Series, terms: int, s: float, h: float, order: int, out: Array) -> None:
    """Derivative of an order of the motion at the place `s`."""
    c, n = series.motion, len(out)
    for i in range(n):
        out[i] = 0.0
    k = terms
    while k >= order:
        # four terms at once: rows are read and written more slowly than they are reckoned with
        f0, f1 = derived(k, order, h), derived(k - 1, order, h)
        f2, f3 = derived(k - 2, order, h), derived(k - 3, order, h)
        s2, s3, s4 = s * s, s * s * s, s * s * s * s
        if k - 3 >= order:
            for i in range(n):
                out[i] = (
                    out[i] * s4
                    + f0 * s3 * c[k, i]
                    + f1 * s2 * c[k - 1, i]
                    + f2 * s * c[k - 2, i]
                    + f3 * c[k - 3, i]
                )
            k -= 4
        else:
            for i in range(n):
                out[i] = out[i] * s + f0 * c[k, i]
            k -= 1


def law_at(series: Series, terms: int, s: float, h: float, i: int) -> tuple[float, float]:
    """Deformation and rate of a law at the place `s`."""
    d, v = series.deformation[i, terms], 0.0
    for k in range(terms - 1, -1, -1):
        v = v * s + d
        d = d * s + series.deformation[i, k]
    return d, v / h


def add_law_losses(
    laws: Laws,
    series: Series,
    terms: int,
    s: float,
    h: float,
    weight: float,
    moved: bool,
    energy: Energy,
) -> None:
    """Add up the losses in the laws' dashpots and the contacts' impulses at one Gauss point."""
    for i in range(len(laws.rule)):
        drag = laws.damping[i]
        pressed = laws.contact[i] and (laws.stiffness[i] != 0.0 or laws.offset[i] != 0.0)
        if drag != 0.0 or moved or pressed:
            d, v = law_at(series, terms, s, h, i)
            laws.trial.deformation[i], laws.trial.rate[i] = d, v
            lost = weight * drag * v * v
            laws.dashpot_loss[i] += lost
            if laws.contact[i]:
                energy.contact += lost
                laws.impulse[i] += weight * (laws.stiffness[i] * d + drag * v + laws.offset[i])
            else:
                energy.damping += lost


@flat
def add_works(
    linear: LinearSystem, laws: Laws, step: Step, series: Series, coefs: Array, begin: float, terms: int,
    carried: int, h: float, end: float, energy: Energy,
) -> None:  # fmt: skip
    """Add up the works over the step to `end`, by Gauss's rule."""
    moved, trial = len(linear.support_damping) > 0, step.trial
    put = 0.0
    rule = min(carried, TERMS) // CHECK
    for g in range(2 * (rule + 1)):
        weight, s = series.gauss[rule, 0, g] * end * h, series.gauss[rule, 1, g] * end
        evaluate(series, terms, s, h, 1, trial.velocity)
        multiply(linear.damping, trial.velocity, step.product)
        energy.damping += weight * dot(trial.velocity, step.product)
        evaluate_inputs(coefs, begin + s * h, trial.inputs, trial.input_rates)
        add_law_losses(laws, series, terms, s, h, weight, moved, energy)
        if moved:
            evaluate(series, terms, s, h, 0, trial.displacement)
            evaluate(series, terms, s, h, 2, trial.acceleration)
            given, lost = support_power(linear, laws, trial, laws.trial, laws.members.trial)
            put += weight * given
            energy.damping += weight * lost
            for i in range(len(trial.velocity)):
                put += weight * load_on_nodes(linear, trial.inputs, i) * trial.velocity[i]
        else:
            form_load(linear, trial.inputs, trial.load)
            put += weight * dot(trial.load, trial.velocity)
    energy.input += put
    energy.gross_input += abs(put)


def accept(laws: Laws, now: Motion, series: Series, terms: int, h: float, end: float) -> None:
    """Make the place `end` the present."""
    evaluate(series, terms, end, h, 0, now.displacement)
    evaluate(series, terms, end, h, 1, now.velocity)
    for i in range(len(laws.rule)):
        d, v = law_at(series, terms, end, h, i)
        laws.now.deformation[i], laws.now.rate[i] = d, v
        laws.largest_deformation[i] = max(laws.largest_deformation[i], abs(d))
        laws.largest_rate[i] = max(laws.largest_rate[i], abs(v))


@flat
def store_looks(
    trial: Motion,
    buffers: Buffers,
    series: Series,
    terms: int,
    h: float,
    end: float,
    run: Run,
    t: float,
) -> None:
    """Keep the motion at the start of the step, where its acceleration may have jumped, and on its way."""
    for look in range(LOOKS):
        s, at = look * end / LOOKS, run.shown
        for j in range(3):
            out = trial.displacement if j == 0 else trial.velocity if j == 1 else trial.acceleration
            evaluate(series, terms if look else j, s, h, j, out)
            for i in range(len(buffers.which)):
                buffers.shown[at, j, i] = out[buffers.which[i]]
        buffers.shown_time[at] = t + s * h
        run.shown += 1


def change_branch(
    laws: Laws, buffers: Buffers, rules: Tables, run: Run, t: float, law: int, event: int
) -> None:
    """Let a law leave its branch."""
    before, d, v = laws.branch[law], laws.now.deformation[law], laws.now.rate[law]
    transition(laws, rules, law, event, d, v)
    force = linear_force(laws, law, d, v)
    if before != laws.branch[law]:
        log_transition(laws, buffers, run, law, before, t, force)
    run.events += 1
    run.fault = law


def change_branches(
    laws: Laws, buffers: Buffers, rules: Tables, series: Series, terms: int, h: float, at: float, end:
    float, law: int, event: int, run: Run,
) -> None:  # fmt: skip
    """Let a law leave its branch at the place `at`, and others whose events are at the same instant."""
    now, instant = run.time, INSTANT * max(run.time, h)
    change_branch(laws, buffers, rules, run, now, law, event)
    for i in range(len(laws.rule)):
        if i != law:
            own, place = event_of(laws, series, terms, h, min(at + AHEAD, end), i)
            if own >= 0 and place <= at + instant / h:
                change_branch(laws, buffers, rules, run, now, i, own)
    run.same_instant = run.same_instant + 1 if now - run.last_event <= instant else 0
    run.last_event = now


def stride(
    linear: LinearSystem, laws: Laws, step: Step, buffers: Buffers, rules: Tables, series: Series,
    lengths: Lengths, coefs: Array, begin: float, goal: float, pause: int, energy: Energy,
    run: Run,
) -> int:  # fmt: skip
    """Take steps on one piece of the excitation up to a goal, or until Python must look at it.

    Returns
    -------
    int
        DONE, or what is wrong.
    """
    room, first = len(buffers.log) // 2, len(linear.monitored_constants)
    while run.time < goal:
        crowded = len(buffers.log) - run.logged < room
        if crowded or run.steps >= pause or run.shown + LOOKS > len(buffers.shown_time):
            return FULL
        t = run.time
        left = goal - t
        h = left / np.ceil(max(left / lengths.next, 1.0) * (1.0 - 1e-9))
        if h < left:
            h = t + h - t  # the motion goes as far as the clock does, which is rounded
        if h == 0.0:
            return SHORT
        terms, fit = expand(linear, laws, step, series, lengths, coefs, t - begin, h)
        if not fit >= CUT:  # what is known of the motion from terms far too large misleads
            lengths.next = h * fit if fit > 1.0 / 16.0 else h / 16.0
            continue
        end = 1.0 if fit >= 1.0 else (t + fit * h - t) / h
        if end == 0.0:
            return SHORT
        whole = end == 1.0 and h == left
        # terms that were not needed make room for a longer step
        lengths.next = max(h * min(fit * TERMS / terms, GROW), lengths.next if end == 1.0 else 0.0)
        law, event, at = first_event(laws, series, terms, h, end)
        track_outputs(linear, laws, step, series, terms, h, at, t, len(coefs))
        track_laws(laws, step, series, terms, h, at, t, first)
        if at > 0.0:
            if len(buffers.which) > 0:
                store_looks(step.trial, buffers, series, terms, h, at, run, t)
            add_works(linear, laws, step, series, coefs, t - begin, terms, lengths.carried, h, at, energy)
            accept(laws, step.now, series, terms, h, at)
        run.steps += 1
        if law < 0:
            if not whole:
                lengths.shortest = min(lengths.shortest, at * h)
            run.time = goal if whole else t + at * h
            continue
        run.time = t + at * h
        change_branches(laws, buffers, rules, series, terms, h, at, end, law, event, run)
        if run.same_instant > 50 + 4 * len(laws.rule):
            return CHATTER
    return DONE


def march(
    linear: LinearSystem, laws: Laws, step: Step, buffers: Buffers, rules: Tables, series: Series,
    lengths: Lengths, coefs: Array, breaks: Array, goals: Array, outputs: Flags, pieces: Index,
    energy: Energy, run: Run,
) -> int:  # fmt: skip
    """Integrate to the last goal, or until Python must look at something (see
    `stepping.kernel.advance`).
    """
    pause, now = next_pause(step, run), step.now
    if run.started == 0:
        take_first_sample(linear, laws, step, buffers, rules, energy, run)
    while run.goal < len(goals):
        goal = run.goal
        begin, piece = breaks[pieces[goal]], coefs[pieces[goal]]
        why = stride(
            linear,
            laws,
            step,
            buffers,
            rules,
            series,
            lengths,
            piece,
            begin,
            goals[goal],
            pause,
            energy,
            run,
        )
        if why != DONE:
            return why
        multiply(linear.mass, now.velocity, step.product)
        kinetic = 0.5 * dot(now.velocity, step.product)
        if not kinetic <= 10.0 * (run.energy_at_start + energy.gross_input) + 1e-300:
            run.energy_at_start = kinetic
            return RUNAWAY
        run.goal += 1
        if outputs[goal]:
            evaluate_inputs(piece, run.time - begin, now.inputs, now.input_rates)
            form_load(linear, now.inputs, now.load)
            multiply(linear.damping, now.velocity, now.damping_force)
            make_consistent(linear, laws, step)
            store_sample(laws, step, buffers, rules, energy, run, run.time)
            if run.kept == len(buffers.time):
                return FULL
    return DONE
