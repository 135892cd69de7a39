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

from typing import NamedTuple

import numpy as np

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, first_rise, highest, size
from pound_solve.integrate.kernels.laws import along, load, motions, times, transition
from pound_solve.integrate.kernels.state import (
    A1,
    AT,
    CHATTER,
    CONTACT,
    CV,
    DASHPOT,
    DONE,
    EVENTS,
    EXIT,
    F0,
    FULL,
    GOAL,
    HIGH,
    IMPULSE,
    KEPT,
    LD,
    LD1,
    LOGGED,
    LOW,
    LV,
    LV1,
    MASS,
    MOST_D,
    MOST_V,
    N_EXITS,
    P1,
    PEAK,
    RUNAWAY,
    SHOWN,
    STEP,
    STEPS,
    T_HIGH,
    T_LOW,
    T_PEAK,
    U1,
    V1,
    WORST,
    C,
    D,
    K,
    Laws,
    Matrices,
    Motion,
    P,
    Samples,
    U,
    V,
    Y,
)
from pound_solve.integrate.protocol import STILL
from pound_solve.integrate.stepping.kernel import next_look, power, sample, settle, write
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
KC, CC = TERMS + 1, TERMS + 2  #: rows of `Series.u` for products with K and C
#: columns of `Series.step`: length to try next, most of v M v, shortest step, terms that carry energy
LENGTH, SPEED, SHORTEST, CARRIED = range(4)
SHORT = 7  #: why `march` came back, beside those of `arrays`: steps are too short for the clock
SAME = STEP  #: integer of `count`: changes of branch at one instant


class Series(NamedTuple):
    """The series of a step.

    Attributes
    ----------
    u : ndarray, shape (TERMS + 3, n)
        Coefficients of the unknowns; scratch.
    d : ndarray, shape (n_laws, TERMS + 1)
        Of the deformations.
    s : ndarray, shape (TERMS + 1, n_inputs)
        Of the inputs.
    p : ndarray, shape `isolate.room`
        What `isolate` works on.
    inverse : ndarray, shape (n,)
        Of a diagonal mass.
    gauss : ndarray, shape (TERMS // CHECK + 1, 2, most points)
        Weights and points on (0, 1), two more than half of the terms that carry energy.
    step : ndarray, shape (4,)
        Columns as above.
    """

    u: Array
    d: Array
    s: Array
    p: Array
    inverse: Array
    gauss: Array
    step: Array


@loose
def product(a: Array, i: int, b: Array, j: int) -> float:
    """Product of two rows."""
    total = 0.0
    for k in range(a.shape[1]):
        total += a[i, k] * b[j, k]
    return total


def inputs(e: Series, coefs: Array, begin: float, h: float) -> None:
    """Series of the inputs from the local time `begin` of their piece on, in steps of `h`."""
    top, n = coefs.shape
    for j in range(n):
        for k in range(top):
            e.s[k, j] = coefs[k, j]
        for i in range(top - 1):
            for k in range(top - 2, i - 1, -1):
                e.s[k, j] += begin * e.s[k + 1, j]
        scale = 1.0
        for k in range(top):
            e.s[k, j] *= scale
            scale *= h


def deform(w: Laws, e: Series, k: int, top: int) -> None:
    """Coefficients `k` of the deformations; the inputs have `top` of them."""
    for i in range(len(w.i)):
        d = along(w.rows, i, e.u, k)
        if k < top:
            for j in range(e.s.shape[1]):
                d += w.inputs[i, j] * e.s[k, j]
        e.d[i, k] = d


def share(m: Matrices, e: Series, k: int, h: float) -> float:
    """Twice the kinetic energy of the term `k`."""
    times(m.m, e.u, k, CC)
    return product(e.u, k, e.u, CC) * (k / h) * (k / h)


def next_term(m: Matrices, w: Laws, x: Motion, e: Series, k: int, h: float, top: int) -> None:
    """Coefficients `k` + 2 of the unknowns from the two before."""
    n = e.u.shape[1]
    times(m.k, e.u, k, KC)
    times(m.c, e.u, k + 1, CC)
    rate = h * (k + 1)
    for i in range(n):
        e.u[k + 2, i] = -h * h * e.u[KC, i] - rate * e.u[CC, i]
    if k == 0:
        for i in range(n):
            e.u[2, i] += h * h * m.constant[i]
    if k < top:
        for j in range(e.s.shape[1]):
            push = h * h * e.s[k, j]
            if push != 0.0:
                for i in range(n):
                    e.u[k + 2, i] += m.inputs[j, i] * push
    for i in range(len(w.i)):
        force = h * h * w.f[i, K] * e.d[i, k] + rate * w.f[i, C] * e.d[i, k + 1]
        if k == 0:
            force += h * h * w.f[i, F0]
        if force != 0.0:
            for q in range(w.rows[0][i], w.rows[0][i + 1]):
                e.u[k + 2, w.rows[1][q]] -= w.rows[2][q] * force
    below = 1.0 / ((k + 1) * (k + 2))
    if m.diagonal:
        for i in range(n):
            e.u[k + 2, i] *= e.inverse[i] * below
    else:
        for i in range(n):
            x.q[Y, i] = e.u[k + 2, i] * below
        solve(m.pattern, x.l, MASS, x.q, D + MASS, Y)
        for i in range(n):
            e.u[k + 2, i] = x.q[Y, i]
    deform(w, e, k + 2, top)


@flat
def expand(
    m: Matrices, w: Laws, x: Motion, e: Series, coefs: Array, begin: float, h: float
) -> tuple[int, float]:
    """Find the series of a step of length `h` from the present state on.

    Returns
    -------
    terms : int
        Its highest power.
    end : float
        Part of the step, or multiple of it, up to which it is right; NaN where numbers are beyond all
        bounds.
    """
    n, top = e.u.shape[1], len(coefs)
    inputs(e, coefs, begin, h)
    for i in range(n):
        e.u[0, i], e.u[1, i] = x.q[U, i], h * x.q[V, i]
    deform(w, e, 0, top)
    deform(w, e, 1, top)
    e.step[SPEED] = max(e.step[SPEED], share(m, e, 1, h))
    most, k, now, last, e.step[CARRIED] = e.step[SPEED], 0, 0.0, 0.0, CHECK
    while k + 2 <= TERMS:
        while True:
            next_term(m, w, x, e, k, h, top)
            k += 1
            if (k + 1) % CHECK == 0:
                break
        terms = k + 1
        now, last = share(m, e, terms, h), share(m, e, terms - 1, h)
        if most == 0.0:  # from rest
            most = max(share(m, e, 2, h), last, now)
        if now + last > QUIET * most:
            e.step[CARRIED] = terms + CHECK
        if terms > top and now + last <= SMALL * SMALL * most:
            break
    if not now + last < np.inf:
        return terms, np.nan
    end = GROW
    if now > 0.0:
        end = min(end, (SMALL * SMALL * most / now) ** (0.5 / terms))
    if last > 0.0:
        end = min(end, (SMALL * SMALL * most / last) ** (0.5 / (terms - 1)))
    return terms, end


def exit_of(w: Laws, e: Series, terms: int, h: float, end: float, i: int) -> tuple[int, float]:
    """The first exit that law `i` passes before `end`, and where; -1 where there is none."""
    way = -1
    for out in range(w.i[i, N_EXITS]):
        fd, fv, fc = w.f[i, EXIT + 3 * out], w.f[i, EXIT + 3 * out + 1], w.f[i, EXIT + 3 * out + 2]
        if fd == 0.0 and fv == 0.0:
            continue
        p = e.p[POLYNOMIAL]
        for k in range(terms + 1):
            p[k] = fd * e.d[i, k]
        p[0] += fc
        if fv != 0.0:
            for k in range(terms):
                p[k] += fv * (k + 1) / h * e.d[i, k + 1]
        most = abs(fd) * w.f[i, MOST_D] + abs(fv) * w.f[i, MOST_V] + abs(fc)
        at = first_rise(e.p, terms, end, STILL * most)
        if at >= 0.0 and (way < 0 or at < end):
            way, end = out, at
    return way, end


def first_exit(w: Laws, e: Series, terms: int, h: float, end: float) -> tuple[int, int, float]:
    """The first exit that any law passes before `end`: law, exit and place; law -1 where there is none."""
    law, way = -1, -1
    for i in range(len(w.i)):
        out, at = exit_of(w, e, terms, h, end, i)
        if out >= 0 and (law < 0 or at < end):
            law, way, end = i, out, at
    return law, way, end


def crest(
    w: Laws, x: Motion, e: Series, terms: int, h: float, end: float, t: float, i: int, law: int
) -> None:
    """Count the polynomial at work into peak `i`; `law` is not negative for the force of a law."""
    known = x.peak[HIGH, i]
    contact = law >= 0 and w.i[law, CONTACT]
    if contact:
        known = min(known, w.f[law, PEAK])
    high, place = highest(e.p, terms, end, known)
    if high > x.peak[HIGH, i]:
        x.peak[HIGH, i], x.peak[T_HIGH, i] = high, t + h * place
    if contact and high > w.f[law, PEAK]:
        w.f[law, PEAK], w.f[law, T_PEAK] = high, t + h * place
    for k in range(terms + 1):
        e.p[POLYNOMIAL, k] = -e.p[POLYNOMIAL, k]
    high, place = highest(e.p, terms, end, -x.peak[LOW, i])
    if place >= 0.0:
        x.peak[LOW, i], x.peak[T_LOW, i] = -high, t + h * place


def peaks(
    m: Matrices, w: Laws, x: Motion, e: Series, terms: int, h: float, end: float, t: float, top: int
) -> None:
    """Count what happens up to `end` into the peaks."""
    rows, laws = len(m.row_constants), len(w.i)
    p = e.p[POLYNOMIAL]
    for i in range(rows):
        for k in range(terms + 1):
            p[k] = along(m.rows, i, e.u, k)
        for k in range(min(top, terms + 1)):
            for j in range(e.s.shape[1]):
                p[k] += m.row_inputs[i, j] * e.s[k, j]
        p[0] += m.row_constants[i]
        crest(w, x, e, terms, h, end, t, i, -1)
    for i in range(laws):
        d, far = e.d[i, 0], size(e.d, i, terms)
        if d + far > x.peak[HIGH, rows + i] or d - far < x.peak[LOW, rows + i]:
            for k in range(terms + 1):
                p[k] = e.d[i, k]
            crest(w, x, e, terms, h, end, t, rows + i, -1)
        f, own = w.f[i, F0], rows + laws + i
        stiffness, damping = w.f[i, K], w.f[i, C] if w.i[i, CONTACT] else 0.0
        far *= abs(stiffness)
        high = x.peak[HIGH, own]
        if w.i[i, CONTACT]:
            high = min(high, w.f[i, PEAK])
        f += stiffness * d
        if damping != 0.0 or f + far > high or f - far < x.peak[LOW, own]:
            for k in range(terms + 1):
                p[k] = stiffness * e.d[i, k]
            p[0] += w.f[i, F0]
            if damping != 0.0:
                for k in range(terms):
                    p[k] += damping * (k + 1) / h * e.d[i, k + 1]
            crest(w, x, e, terms, h, end, t, own, i)


def derived(k: int, order: int, h: float) -> float:
    """What a derivative makes of the power `k`."""
    out = 1.0
    for j in range(order):
        out *= (k - j) / h
    return out


def evaluate(e: Series, terms: int, s: float, h: float, x: Motion, order: int, out: int) -> None:
    """Derivative of an order of the motion at the place `s`, into row `out`."""
    n = e.u.shape[1]
    for i in range(n):
        x.q[out, i] = 0.0
    k = terms
    while (
        k >= order
    ):  # four terms at once: rows are read and written more slowly than they are reckoned with
        a, b, c, d = (
            derived(k, order, h),
            derived(k - 1, order, h),
            derived(k - 2, order, h),
            derived(k - 3, order, h),
        )
        s2, s3, s4 = s * s, s * s * s, s * s * s * s
        if k - 3 >= order:
            for i in range(n):
                x.q[out, i] = (
                    x.q[out, i] * s4
                    + a * s3 * e.u[k, i]
                    + b * s2 * e.u[k - 1, i]
                    + c * s * e.u[k - 2, i]
                    + d * e.u[k - 3, i]
                )
            k -= 4
        else:
            for i in range(n):
                x.q[out, i] = x.q[out, i] * s + a * e.u[k, i]
            k -= 1


def law_at(e: Series, terms: int, s: float, h: float, i: int) -> tuple[float, float]:
    """Deformation and rate of a law at the place `s`."""
    d, v = e.d[i, terms], 0.0
    for k in range(terms - 1, -1, -1):
        v = v * s + d
        d = d * s + e.d[i, k]
    return d, v / h


@flat
def works(
    m: Matrices, w: Laws, x: Motion, e: Series, coefs: Array, begin: float, terms: int, h: float, end: float
) -> None:
    """Add up the works over the step to `end`, by Gauss's rule."""
    moved = len(m.support_c) > 0
    n = x.q.shape[1]
    put = 0.0
    rule = min(int(e.step[CARRIED]), TERMS) // CHECK
    for g in range(2 * (rule + 1)):
        weight, s = e.gauss[rule, 0, g] * end * h, e.gauss[rule, 1, g] * end
        evaluate(e, terms, s, h, x, 1, V1)
        times(m.c, x.q, V1, Y)
        x.works[1] += weight * product(x.q, V1, x.q, Y)
        motions(coefs, begin + s * h, x.inputs, 2)
        for i in range(len(w.i)):
            drag = w.f[i, C]
            if drag != 0.0 or moved or (w.i[i, CONTACT] and (w.f[i, K] != 0.0 or w.f[i, F0] != 0.0)):
                d, v = law_at(e, terms, s, h, i)
                w.f[i, LD1], w.f[i, LV1] = d, v
                lost = weight * drag * v * v
                w.f[i, DASHPOT] += lost
                x.works[2 if w.i[i, CONTACT] else 1] += lost
                if w.i[i, CONTACT]:
                    w.f[i, IMPULSE] += weight * (w.f[i, K] * d + drag * v + w.f[i, F0])
        if moved:
            evaluate(e, terms, s, h, x, 0, U1)
            evaluate(e, terms, s, h, x, 2, A1)
            given, lost = power(m, w, x, 2)
            put += weight * given
            x.works[1] += weight * lost
            for i in range(n):
                pushed = m.constant[i]
                for j in range(x.inputs.shape[1]):
                    pushed += m.pushed[i, j] * x.inputs[2, j]
                put += weight * pushed * x.q[V1, i]
        else:
            load(m, x.inputs[2], x.q, P1)
            put += weight * product(x.q, P1, x.q, V1)
    x.works[0] += put
    x.works[3] += abs(put)


def accept(w: Laws, x: Motion, e: Series, terms: int, h: float, end: float) -> None:
    """Make the place `end` the present."""
    evaluate(e, terms, end, h, x, 0, U)
    evaluate(e, terms, end, h, x, 1, V)
    for i in range(len(w.i)):
        d, v = law_at(e, terms, end, h, i)
        w.f[i, LD], w.f[i, LV] = d, v
        w.f[i, MOST_D], w.f[i, MOST_V] = max(w.f[i, MOST_D], abs(d)), max(w.f[i, MOST_V], abs(v))


@flat
def show(
    x: Motion, z: Samples, e: Series, terms: int, h: float, end: float, count: Index, t: float
) -> None:
    """Keep the motion at the start of the step, where its acceleration may have jumped, and on its way."""
    for look in range(LOOKS):
        s, at = look * end / LOOKS, count[SHOWN]
        for j in range(3):
            evaluate(e, terms if look else j, s, h, x, j, U1 + j)
            for i in range(len(z.which)):
                z.shown[at, j, i] = x.q[U1 + j, z.which[i]]
        z.when[at] = t + s * h
        count[SHOWN] += 1


def change(w: Laws, z: Samples, f: Tables, count: Index, t: float, law: int, way: int) -> None:
    """Let a law leave its branch."""
    before = w.i[law, AT]
    transition(w, f, law, way, w.f[law, LD], w.f[law, LV])
    force = w.f[law, K] * w.f[law, LD] + w.f[law, C] * w.f[law, LV] + w.f[law, F0]
    if before != w.i[law, AT]:
        write(w, z, count, law, before, t, force)
    count[EVENTS] += 1
    count[WORST] = law


def stride(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, e: Series, coefs: Array, begin: float,
    goal: float, count: Index, clock: Array, pause: int,
) -> int:  # fmt: skip
    """Take steps on one piece of the motions up to a goal, or until Python must look at it.

    Returns
    -------
    int
        DONE, or what is wrong.
    """
    room = len(z.log) // 2
    while clock[0] < goal:
        if len(z.log) - count[LOGGED] < room or count[STEPS] >= pause or count[SHOWN] + LOOKS > len(z.when):
            return FULL
        t = clock[0]
        left = goal - t
        h = left / np.ceil(max(left / e.step[LENGTH], 1.0) * (1.0 - 1e-9))
        if h < left:
            h = t + h - t  # the motion goes as far as the clock does, which is rounded
        if h == 0.0:
            return SHORT
        terms, fit = expand(m, w, x, e, coefs, t - begin, h)
        if not fit >= CUT:  # what is known of the motion from terms far too large misleads
            e.step[LENGTH] = h * fit if fit > 1.0 / 16.0 else h / 16.0
            continue
        end = 1.0 if fit >= 1.0 else (t + fit * h - t) / h
        if end == 0.0:
            return SHORT
        whole = end == 1.0 and h == left
        # terms that were not needed make room for a longer step
        e.step[LENGTH] = max(h * min(fit * TERMS / terms, GROW), e.step[LENGTH] if end == 1.0 else 0.0)
        law, way, at = first_exit(w, e, terms, h, end)
        peaks(m, w, x, e, terms, h, at, t, len(coefs))
        if at > 0.0:
            if len(z.which) > 0:
                show(x, z, e, terms, h, at, count, t)
            works(m, w, x, e, coefs, t - begin, terms, h, at)
            accept(w, x, e, terms, h, at)
        count[STEPS] += 1
        if law < 0:
            if not whole:
                e.step[SHORTEST] = min(e.step[SHORTEST], at * h)
            clock[0] = goal if whole else t + at * h
            continue
        now = clock[0] = t + at * h
        instant = INSTANT * max(now, h)
        change(w, z, f, count, now, law, way)
        for i in range(len(w.i)):  # others that leave at the same instant
            if i != law:
                way, place = exit_of(w, e, terms, h, min(at + AHEAD, end), i)
                if way >= 0 and place <= at + instant / h:
                    change(w, z, f, count, now, i, way)
        count[SAME] = count[SAME] + 1 if now - clock[3] <= instant else 0
        clock[3] = now
        if count[SAME] > 50 + 4 * len(w.i):
            return CHATTER
    return DONE


def march(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, e: Series, coefs: Array, breaks: Array,
    goals: Array, outputs: Flags, pieces: Index, count: Index, clock: Array,
) -> int:  # fmt: skip
    """Integrate to the last goal, or until Python must look at something (see `kernel.advance`)."""
    pause = next_look(x, count)
    while count[GOAL] < len(goals):
        goal = count[GOAL]
        begin = breaks[pieces[goal]]
        why = stride(m, w, x, z, f, e, coefs[pieces[goal]], begin, goals[goal], count, clock, pause)
        if why != DONE:
            return why
        times(m.m, x.q, V, Y)
        kinetic = 0.5 * product(x.q, V, x.q, Y)
        if not kinetic <= 10.0 * (clock[2] + x.works[3]) + 1e-300:
            clock[2] = kinetic
            return RUNAWAY
        count[GOAL] += 1
        if outputs[goal]:
            motions(coefs[pieces[goal]], clock[0] - begin, x.inputs, 0)
            load(m, x.inputs[0], x.q, P)
            times(m.c, x.q, V, CV)
            settle(m, w, x)
            sample(w, x, z, f, count, clock[0])
            if count[KEPT] == len(z.works):
                return FULL
    return DONE
