r"""The steps of NEWMARK, HHT, GENERALISED_ALPHA and CENTRAL as scalar kernels.

One step of length h of the generalised-alpha family (Chung & Hulbert 1993):

.. math::
    u_1 = \tilde u + \beta h^2 a_1, \qquad \tilde u = u_0 + h v_0 + h^2(\tfrac12-\beta) a_0 \\
    v_1 = \tilde v + \gamma h a_1, \qquad \tilde v = v_0 + (1-\gamma) h a_0 \\
    \Bigl[\tfrac{1-\alpha_m}{1-\alpha_f} M + \gamma h C + \beta h^2 K\Bigr] a_1
      = p_1 - C\tilde v - K\tilde u - f(\tilde u, \tilde v)
      + \frac{\alpha_f r_0 - \alpha_m M a_0}{1-\alpha_f}

with the residual :math:`r = p - C v - K u - f` at the start of the step.  Between events the laws are
linear, so a step is one solution; curved laws take Newton iterations that change the factor by rank one.
When an exit is passed within the step, the step is taken again, shorter, until it ends on the exit;
then the law changes branch, the acceleration is made consistent, and the rest of the step follows.

Everything here works on arrays in the order of elimination (see `ldl`); `jit` compiles it.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.events.within_step import behind, between, excess, first_exit, summit
from pound_solve.integrate.kernels.corotational import (
    aim,
    chord_force,
    linearise,
    locate,
    miss,
    resist,
    stiffen,
    straight_force,
    turn_start,
)
from pound_solve.integrate.kernels.laws import (
    along,
    bend,
    carry,
    follows,
    grip,
    law_force,
    law_work,
    lean,
    limit,
    load,
    memory,
    motions,
    next_exit,
    parameters,
    restore,
    save,
    slide,
    tangent,
    times,
    transition,
)
from pound_solve.integrate.kernels.state import (
    A1,
    AHEAD,
    AT,
    BASE,
    BUSY,
    CA,
    CA1,
    CHATTER,
    CLOSE,
    CODE,
    CONTACT,
    CROWD,
    CURVED,
    CV,
    D0,
    DASHPOT,
    DELAY,
    DONE,
    EVENTS,
    F0,
    FALLING,
    FIRST,
    FULL,
    G0,
    G1,
    GOAL,
    HELD,
    HIGH,
    IMPULSE,
    KEPT,
    LD,
    LD1,
    LIGHT,
    LOGGED,
    LOW,
    LV,
    LV1,
    MASS,
    MOST_D,
    MOST_V,
    NEAR,
    NEWTON,
    NORMAL,
    P1,
    PAUSE,
    PEAK,
    PIECE,
    PIVOT,
    REFRESH,
    REST,
    RUNAWAY,
    S0,
    S1,
    SAVED,
    SHOWN,
    SINCE,
    SLOPE,
    SLOW,
    STALE,
    STEEPEST,
    STEP,
    STEPS,
    T_HIGH,
    T_LOW,
    T_PEAK,
    U1,
    UPDATES,
    V1,
    VALUE,
    WHOLE,
    WORST,
    A,
    C,
    D,
    K,
    Laws,
    Matrices,
    Motion,
    P,
    R,
    Samples,
    Scheme,
    U,
    V,
    W,
    Y,
)
from pound_solve.integrate.protocol import STILL
from pound_solve.laws.functions import Tables
from pound_solve.numerics.jit import flat, loose
from pound_solve.numerics.ldl import factor, solve, update
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.corotational import KIND, LENGTH, STRING, quantity_stiffness


def refactor(m: Matrices, w: Laws, x: Motion, scheme: Scheme, h: float, at: int) -> int:
    """Factorise A for steps of length `h`; return -1 or the unknown whose pivot vanishes."""
    sm = (1.0 - scheme.alpha_m) / (1.0 - scheme.alpha_f)
    sc, sk = scheme.gamma * h, scheme.beta * h * h
    for q in range(len(x.ax)):
        x.ax[q] = sm * m.a[0, q] + sc * m.a[1, q] + sk * m.a[2, q]
    for i in range(len(w.i)):
        change = sc * w.f[i, C] + sk * w.f[i, K]
        if change != 0.0:
            for q in range(w.pairs[0][i], w.pairs[0][i + 1]):
                x.ax[w.pairs[1][q]] += change * w.pairs[2][q]
    if sk != 0.0:
        for c in range(len(w.corotational.p)):
            stiffen(m, w.corotational, x, c, c, sk, False)
    return factor(m.pattern, x.ax, x.l, at, x.q, D + at, W)


def change_factor(m: Matrices, w: Laws, x: Motion, i: int, change: float, at: int) -> bool:
    """Add ``change b b^T`` of law `i` to a factor; False where it must be made anew."""
    if change == 0.0 or w.rows[0][i] == w.rows[0][i + 1]:
        return True
    first = x.q.shape[1]
    for q in range(w.rows[0][i], w.rows[0][i + 1]):
        x.q[W, w.rows[1][q]] += w.rows[2][q]
        first = min(first, w.rows[1][q])
    return update(m.pattern, x.l, at, x.q, D + at, W, first, change)


def attempt(
    m: Matrices, w: Laws, x: Motion, scheme: Scheme, f: Tables, coefs: Array, s1: float, h: float,
    at: int, count: Index,
) -> bool:  # fmt: skip
    """Try a step of length `h` that ends at the local time `s1`; False where Newton does not converge, and
    the law furthest from it in `count`.
    """
    n, laws = x.q.shape[1], len(w.i)
    b2, g1 = h * h * (0.5 - scheme.beta), (1.0 - scheme.gamma) * h
    bk, gk = scheme.beta * h * h, scheme.gamma * h
    motions(coefs, s1, x.inputs, 2)
    s, rate = x.inputs[2], x.inputs[3]
    load(m, s, x.q, P1)
    for i in range(n):
        x.q[U1, i] = x.q[U, i] + h * x.q[V, i] + b2 * x.q[A, i]
    for i in range(n):
        x.q[V1, i] = x.q[V, i] + g1 * x.q[A, i]
    times(m.k, x.q, U1, BASE)
    if scheme.alpha_f != 0.0 or scheme.alpha_m != 0.0:
        times(m.m, x.q, A, Y)
        one = 1.0 / (1.0 - scheme.alpha_f)
        for i in range(n):
            x.q[BASE, i] -= one * (scheme.alpha_f * x.q[R, i] - scheme.alpha_m * x.q[Y, i])
    for i in range(n):
        x.q[BASE, i] = x.q[P1, i] - x.q[BASE, i] - x.q[CV, i] - g1 * x.q[CA, i]
    for i in range(laws):
        dd, vv = 0.0, 0.0
        for j in range(len(s)):
            dd += w.inputs[i, j] * s[j]
            vv += w.inputs[i, j] * rate[j]
        for q in range(w.rows[0][i], w.rows[0][i + 1]):
            dd += w.rows[2][q] * x.q[U1, w.rows[1][q]]
            vv += w.rows[2][q] * x.q[V1, w.rows[1][q]]
        w.f[i, LD1], w.f[i, LV1] = dd, vv
    b = w.corotational
    aim(w, x, s)
    last, off, count[WORST] = np.inf, -1, -1
    for _ in range(50):
        for i in range(n):
            x.q[A1, i] = x.q[BASE, i]
        for i in range(laws):
            force = w.f[i, K] * w.f[i, LD1] + w.f[i, C] * w.f[i, LV1] + w.f[i, F0]
            if force != 0.0:
                for q in range(w.rows[0][i], w.rows[0][i + 1]):
                    x.q[A1, w.rows[1][q]] -= w.rows[2][q] * force
        for c in range(len(b.p)):
            for j in range(6):
                b.s[c, G1 + j] = b.s[c, REST + j]
            straight_force(b, c, c, AHEAD, G1, 1.0)
            resist(b, c, x.q, A1, G1)
        solve(m.pattern, x.l, at, x.q, D + at, A1)
        worst = 0.0
        for i in range(laws):
            if not w.i[i, CURVED]:
                continue
            j = w.i[i, NORMAL]
            if j >= 0:
                acc = along(w.rows, j, x.q, A1)
                lean(w, i, w.f[j, LD1] + bk * acc, w.f[j, LV1] + gk * acc, acc)
            acc = along(w.rows, i, x.q, A1)
            dd, vv = w.f[i, LD1] + bk * acc, w.f[i, LV1] + gk * acc
            c = f.curve[w.i[i, CODE]](
                parameters(w.p, i), w.i[i, AT], memory(w.memory, i), w.f[i, D0], dd, vv
            )
            k, own = c[1], follows(w, i, c[1])
            damp, force = c[2] + own, c[0] + own * vv
            guess = w.f[i, K] * dd + w.f[i, C] * vv + w.f[i, F0]
            size = max(abs(force), abs(k * w.f[i, MOST_D]), 1e-300)
            if abs(force - guess) > worst * size:
                worst, off = abs(force - guess) / size, i
            change = bk * (k - w.f[i, K]) + gk * (damp - w.f[i, C])
            w.f[i, K], w.f[i, C], w.f[i, F0] = k, damp, force - k * dd - damp * vv
            count[UPDATES] += 1
            if m.explicit or change_factor(m, w, x, i, change, at):
                continue
            if refactor(m, w, x, scheme, h, at) >= 0:
                return False
        error = miss(w, x, bk) if len(b.p) > 0 else 0.0
        if worst <= 1e-12 and error <= 1.0:
            break
        if not error < np.inf:
            return False
        if error > 1.0 and error > SLOW * last:
            linearise(b, S1)
            for c in range(len(b.p)):
                for j in range(6):
                    b.s[c, REST + j] = b.s[c, G1 + j]
                straight_force(b, c, c, S1, REST, -1.0)
            if refactor(m, w, x, scheme, h, at) >= 0:
                return False
            if at != WHOLE:
                count[UPDATES] = REFRESH + 1
        last = error
    else:
        if worst > 1e-12:
            count[WORST] = off
        return False
    for i in range(n):
        x.q[U1, i] += bk * x.q[A1, i]
    for i in range(n):
        x.q[V1, i] += gk * x.q[A1, i]
    for i in range(laws):
        acc = along(w.rows, i, x.q, A1)
        w.f[i, LD1] += bk * acc
        w.f[i, LV1] += gk * acc
    if len(w.leans) > 0:
        limit(w, f, x.q)
    if m.implicit and not m.inert:
        steady(m, w, x, h, count)
    return True


def power(m: Matrices, w: Laws, x: Motion, at: int) -> tuple[float, float]:
    """Power that moved supports put in, and that lost in dashpots which end at them,
    at the start (`at` 0) or the end (2) of a step.
    """
    s = x.inputs[at]
    u, v, a, d, rate = (U, V, A, LD, LV) if at == 0 else (U1, V1, A1, LD1, LV1)
    put, lost = 0.0, 0.0
    moved = len(m.support_c)
    for q in range(moved):
        speed, force, drag = 0.0, 0.0, 0.0
        for j in range(len(s)):
            speed += m.supports[1, q, j] * s[j]
            force += m.supports[0, q, j] * s[j]
        if speed == 0.0:
            continue
        for i in range(x.q.shape[1]):
            force += m.reactions[0, q, i] * x.q[u, i] + m.reactions[2, q, i] * x.q[a, i]
            drag += m.reactions[1, q, i] * x.q[v, i]
        for i in range(len(w.i)):
            if w.supports[i, q] != 0.0:
                force += w.supports[i, q] * (w.f[i, K] * w.f[i, d] + w.f[i, C] * w.f[i, rate] + w.f[i, F0])
        for c in range(len(w.corotational.p)):
            for j in range(6):
                force += w.corotational.supports[c, j, q] * w.corotational.s[c, (G0 if at == 0 else G1) + j]
        put += (force + drag) * speed
        lost += 2.0 * drag * speed
        for z in range(moved):
            for j in range(len(s)):
                lost += speed * m.support_c[q, z] * m.supports[1, z, j] * s[j]
    return put, lost


def note(m: Matrices, w: Laws, x: Motion, t: float, since: float) -> None:
    """Count the motion at the start of the coming step into the peaks, turning points
    on the same branches since the last note, `since` ago, too.
    """
    s, rate = x.inputs[0], x.inputs[1]
    rows, laws = len(m.row_constants), len(w.i)
    for i in range(rows + 2 * laws):
        if i < rows:
            value, slope = along(m.rows, i, x.q, U) + m.row_constants[i], along(m.rows, i, x.q, V)
            for j in range(len(s)):
                value += m.row_inputs[i, j] * s[j]
                slope += m.row_inputs[i, j] * rate[j]
        elif i < rows + laws:
            value, slope = w.f[i - rows, LD], w.f[i - rows, LV]
        else:
            law = i - rows - laws
            value = w.f[law, K] * w.f[law, LD] + w.f[law, F0]
            slope = w.f[law, K] * w.f[law, LV]
            if w.i[law, CONTACT] and w.f[law, C] != 0.0:  # damping is no part of a spring's force
                value += w.f[law, C] * w.f[law, LV]
                slope += w.f[law, C] * along(w.rows, law, x.q, A)
                if light(m, w, law):  # its acceleration is a jump of its velocity over a step, or a part
                    slope = 0.0
        take(w, x, i - rows - laws, i, value, t)
        if since > 0.0 and x.peak[SLOPE, i] * slope < 0.0:
            sign = 1.0 if x.peak[SLOPE, i] > 0.0 else -1.0
            place, top = summit(
                sign * x.peak[VALUE, i], sign * value, sign * x.peak[SLOPE, i], sign * slope, since
            )
            take(w, x, i - rows - laws, i, sign * top, t - since + place)
        x.peak[VALUE, i], x.peak[SLOPE, i] = value, slope
        x.peak[STEEPEST, i] = max(x.peak[STEEPEST, i], abs(slope))


def light(m: Matrices, w: Laws, i: int) -> bool:
    """Whether law `i` holds an unknown without mass, whose velocity may jump."""
    if not m.inert:
        for q in range(w.rows[0][i], w.rows[0][i + 1]):
            if not m.heavy[w.rows[1][q]]:
                return True
    return False


def take(w: Laws, x: Motion, law: int, i: int, value: float, t: float) -> None:
    """Count a value into a peak; `law` is not negative for the force of a law."""
    if value > x.peak[HIGH, i]:
        x.peak[HIGH, i], x.peak[T_HIGH, i] = value, t
    if value < x.peak[LOW, i]:
        x.peak[LOW, i], x.peak[T_LOW, i] = value, t
    if law >= 0 and w.i[law, CONTACT] and value > w.f[law, PEAK]:
        w.f[law, PEAK], w.f[law, T_PEAK] = value, t


@loose
def spent(q: Array) -> float:
    """Three times the mean power that the dashpots of the structure take in a step."""
    loss = 0.0
    for i in range(q.shape[1]):
        loss += q[CV, i] * (q[V, i] + q[V1, i]) + q[Y, i] * q[V1, i]
    return loss


@loose
def gained(q: Array) -> float:
    """Six times the mean power that the loads put in, in a step."""
    work = 0.0
    for i in range(q.shape[1]):
        work += (2.0 * q[P, i] + q[P1, i]) * q[V, i] + (q[P, i] + 2.0 * q[P1, i]) * q[V1, i]
    return work


def accept(
    m: Matrices, w: Laws, x: Motion, f: Tables, scheme: Scheme, h: float, at: int, count: Index
) -> None:
    """Make the end of the step that was tried the start of the next; count it, if it is longer than the
    time in which a falling branch gives way.

    A then has a negative eigenvalue, which its pivots in row `at` tell (Sylvester's law of inertia): along
    that mode the method goes against the force, where the motion goes with it.
    """
    n = x.q.shape[1]
    for i in range(n):
        if x.q[D + at, i] < 0.0:
            count[FALLING] += 1
            break
    before = x.works[0]
    times(m.c, x.q, A1, CA1)
    g1, gk = (1.0 - scheme.gamma) * h, scheme.gamma * h
    work, loss = 0.0, 0.0
    if m.inert:
        for i in range(n):
            x.q[Y, i] = x.q[CV, i] + g1 * x.q[CA, i] + gk * x.q[CA1, i]
    else:
        times(m.c, x.q, V1, Y)
    loss += spent(x.q)
    if len(m.support_c) > 0:
        for i in range(n):
            pushed0, pushed1 = m.constant[i], m.constant[i]
            for j in range(x.inputs.shape[1]):
                pushed0 += m.pushed[i, j] * x.inputs[0, j]
                pushed1 += m.pushed[i, j] * x.inputs[2, j]
            work += 3.0 * (pushed0 * x.q[V, i] + pushed1 * x.q[V1, i])
        put0, lost0 = power(m, w, x, 0)
        put1, lost1 = power(m, w, x, 2)
        work += 3.0 * (put0 + put1)
        loss += 1.5 * (lost0 + lost1)
    else:
        work += gained(x.q)
    b = w.corotational
    for c in range(len(b.p)):
        if b.p[c, KIND] == STRING:  # what its axial force does on the way that a string leaves out
            y0, y1 = b.s[c, S0 + 3], b.s[c, S1 + 3]
            x.works[0] += 0.25 * (y0 * y0 + y1 * y1) / b.p[c, LENGTH] * (b.s[c, S1] - b.s[c, S0])
        b.most[0] = max(b.most[0], chord_force(b, c))
        for j in range(6):
            b.s[c, S0 + j], b.s[c, G0 + j] = b.s[c, S1 + j], b.s[c, G1 + j]
    if len(w.leans) > 0:
        slide(w, h)
    x.works[0] += work * h / 6.0
    x.works[1] += loss * h / 3.0
    x.works[3] += abs(x.works[0] - before)
    for i in range(len(w.i)):
        k, c, f0 = w.f[i, K], w.f[i, C], w.f[i, F0]
        v0, v1 = w.f[i, LV], w.f[i, LV1]
        drag0, drag1 = c * v0, c * v1
        force0, force1 = k * w.f[i, LD] + f0 + drag0, k * w.f[i, LD1] + f0 + drag1
        if w.i[i, CONTACT] and w.i[i, CURVED]:  # its damping is what the rate adds to the force
            force0, force1 = law_force(w, f, i, w.f[i, LD], v0), law_force(w, f, i, w.f[i, LD1], v1)
            drag0 = force0 - law_force(w, f, i, w.f[i, LD], 0.0)
            drag1 = force1 - law_force(w, f, i, w.f[i, LD1], 0.0)
        if drag0 != 0.0 or drag1 != 0.0:
            lost = h / 6.0 * (drag0 * (2.0 * v0 + v1) + drag1 * (v0 + 2.0 * v1))
            w.f[i, DASHPOT] += lost
            x.works[2 if w.i[i, CONTACT] else 1] += lost
        if w.i[i, CONTACT]:
            w.f[i, IMPULSE] += 0.5 * h * (force0 + force1)
        w.f[i, LD], w.f[i, LV] = w.f[i, LD1], w.f[i, LV1]
        w.f[i, MOST_D] = max(w.f[i, MOST_D], abs(w.f[i, LD]))
        w.f[i, MOST_V] = max(w.f[i, MOST_V], abs(w.f[i, LV]))
    if scheme.alpha_f != 0.0 or scheme.alpha_m != 0.0:
        one = 1.0 / (1.0 - scheme.alpha_f)
        for i in range(n):  # a is of no further use
            x.q[A, i] = (1.0 - scheme.alpha_m) * x.q[A1, i] + scheme.alpha_m * x.q[A, i]
        times(m.m, x.q, A, BASE)
        for i in range(n):
            x.q[R, i] = one * (x.q[BASE, i] - scheme.alpha_f * x.q[R, i])
    carry(x.q, U1, U)
    carry(x.q, V1, V)
    carry(x.q, A1, A)
    carry(x.q, Y, CV)
    carry(x.q, CA1, CA)
    carry(x.q, P1, P)
    for j in range(x.inputs.shape[1]):
        x.inputs[0, j], x.inputs[1, j] = x.inputs[2, j], x.inputs[3, j]


def loosen(m: Matrices, w: Laws, x: Motion, s: int) -> float:
    """Factorise ``K + C / e`` over the massless unknowns, e a tiny time, with the chords at columns `s`.

    Returns
    -------
    float
        1 / e: large enough to leave alone what dashpots hold, not so large that the springs are lost beside
        them.
    """
    slow = 0.0
    for i in range(x.q.shape[1]):
        x.q[Y, i], x.q[BASE, i] = 0.0, 0.0
    for q in range(len(x.ax)):
        i = m.column[q]
        if m.pattern.ai[q] == i and not m.heavy[i]:
            x.q[Y, i], x.q[BASE, i] = m.a[2, q], m.a[1, q]
    for i in range(len(w.i)):
        for q in range(w.rows[0][i], w.rows[0][i + 1]):
            j, square = w.rows[1][q], w.rows[2][q] * w.rows[2][q]
            x.q[Y, j] += w.f[i, K] * square
            x.q[BASE, j] += w.f[i, C] * square
    for i in range(x.q.shape[1]):
        if not m.heavy[i] and x.q[Y, i] > 0.0:
            slow = max(slow, x.q[BASE, i] / x.q[Y, i])
    one = max(1.0 / m.instant, 1.0 / (DELAY * slow) if slow > 0.0 else 0.0)
    for q in range(len(x.ax)):
        i, j = m.pattern.ai[q], m.column[q]
        x.ax[q] = 0.0
        if not m.heavy[i] and not m.heavy[j]:
            x.ax[q] = m.a[2, q] + one * m.a[1, q]
        elif i == j:
            x.ax[q] = 1.0
    for i in range(len(w.i)):
        change = w.f[i, K] + one * w.f[i, C]
        for q in range(w.pairs[0][i], w.pairs[0][i + 1]):
            at = w.pairs[1][q]
            if not m.heavy[m.pattern.ai[at]] and not m.heavy[m.column[at]]:
                x.ax[at] += change * w.pairs[2][q]
    b = w.corotational
    for c in range(len(b.p) * m.shifts):
        present = len(b.p) + c
        quantity_stiffness(b.p, c, b.s, s, b.h, present)
        stiffen(m, b, x, c, present, 1.0, True)
    if factor(m.pattern, x.ax, x.l, LIGHT, x.q, D + LIGHT, W) >= 0:
        for i in range(x.q.shape[1]):  # what nothing holds goes on as it did
            x.q[D + LIGHT, i] = np.inf
    return one


def pull(m: Matrices, w: Laws, x: Motion, v: int, lv: int, rate: Array, out: int) -> None:
    """How fast the forces on the massless unknowns change, dashpots apart, at the velocities in row `v`
    and the laws' rates in column `lv`, into row `out`.
    """
    times(m.k, x.q, v, out)
    for i in range(x.q.shape[1]):
        change = 0.0
        for j in range(len(rate)):
            change += m.inputs[j, i] * rate[j]
        x.q[out, i] = change - x.q[out, i]
    for i in range(len(w.i)):
        for q in range(w.rows[0][i], w.rows[0][i + 1]):
            x.q[out, w.rows[1][q]] -= w.rows[2][q] * w.f[i, K] * w.f[i, lv]
    b = w.corotational
    if m.shifts:
        locate(b, x.q, v, rate, AHEAD)
    for c in range(len(b.p) * m.shifts):
        for j in range(6):
            b.s[c, REST + j] = 0.0
        straight_force(b, c, len(b.p) + c, AHEAD, REST, 1.0)
        resist(b, c, x.q, out, REST)
    for i in range(x.q.shape[1]):
        if m.heavy[i]:
            x.q[out, i] = 0.0


def steady(m: Matrices, w: Laws, x: Motion, h: float, count: Index) -> None:
    """Correct velocities of massless unknowns that no dashpot holds, at the end of a step of length `h`.

    They follow from the rates of the forces, which stay in balance.  The method takes about twice their
    mean over the step less those at its start, which would swing about the true ones for ever.
    """
    if m.shifts or count[STALE] != 0:
        loosen(m, w, x, S1)
        count[STALE] = 0
    pull(m, w, x, V1, LV1, x.inputs[3], Y)
    solve(m.pattern, x.l, LIGHT, x.q, D + LIGHT, Y)
    for i in range(x.q.shape[1]):
        if not m.heavy[i]:
            x.q[V1, i] += x.q[Y, i]
            x.q[A1, i] = (x.q[V1, i] - x.q[V, i]) / h
    for i in range(len(w.i)):
        w.f[i, LV1] += along(w.rows, i, x.q, Y)


def release(m: Matrices, w: Laws, x: Motion) -> None:
    """Give massless unknowns the velocities that the present branches ask for.

    They have jumped where a stiffness or a dashpot did.  An implicit step of a tiny length e finds them,
    ``(C + e K) dv = p - C v - K u - f + e d(p - K u - f)/dt`` over the massless unknowns.
    """
    n = x.q.shape[1]
    one = loosen(m, w, x, S0)
    pull(m, w, x, V, LV, x.inputs[1], A1)
    times(m.k, x.q, U, BASE)
    for i in range(n):
        x.q[BASE, i] = x.q[P, i] - x.q[BASE, i] - x.q[CV, i]
        x.q[Y, i] = abs(x.q[P, i]) + abs(m.k.diagonals[0, i] * x.q[U, i]) + abs(x.q[CV, i])
    for i in range(len(w.i)):
        force = w.f[i, K] * w.f[i, LD] + w.f[i, F0] + w.f[i, C] * w.f[i, LV]
        for q in range(w.rows[0][i], w.rows[0][i + 1]):
            x.q[BASE, w.rows[1][q]] -= w.rows[2][q] * force
            x.q[Y, w.rows[1][q]] += abs(w.rows[2][q] * force)
    for c in range(len(w.corotational.p)):
        resist(w.corotational, c, x.q, BASE, G0)
    for i in range(n):  # rounding, or an exit not met to the last digit, is no jump of a dashpot's force
        if not m.heavy[i] and abs(x.q[BASE, i]) > NEAR * x.q[Y, i]:
            x.q[A1, i] += one * x.q[BASE, i]
    solve(m.pattern, x.l, LIGHT, x.q, D + LIGHT, A1)
    for i in range(n):
        x.q[V, i] += x.q[A1, i]
    times(m.c, x.q, V, CV)
    for i in range(len(w.i)):
        w.f[i, LV] += along(w.rows, i, x.q, A1)


def settle(m: Matrices, w: Laws, x: Motion) -> None:
    """Make velocities of massless unknowns and all accelerations consistent with the present branches."""
    turn_start(w, x, x.inputs[0])
    if m.implicit and not m.inert:
        release(m, w, x)
    n = x.q.shape[1]
    times(m.k, x.q, U, BASE)
    for i in range(n):
        x.q[R, i] = x.q[P, i] - x.q[BASE, i] - x.q[CV, i]
    for i in range(len(w.i)):
        force = w.f[i, K] * w.f[i, LD] + w.f[i, C] * w.f[i, LV] + w.f[i, F0]
        if force != 0.0:
            for q in range(w.rows[0][i], w.rows[0][i + 1]):
                x.q[R, w.rows[1][q]] -= w.rows[2][q] * force
    for c in range(len(w.corotational.p)):
        resist(w.corotational, c, x.q, R, G0)
    for i in range(n):
        if not m.heavy[i]:
            x.q[R, i] = 0.0  # in balance, but for rounding that the alphas would take for a load
        x.q[A, i] = x.q[R, i]
    if m.diagonal:
        for i in range(n):
            x.q[A, i] /= x.q[D + MASS, i]
    else:
        solve(m.pattern, x.l, MASS, x.q, D + MASS, A)
    times(m.c, x.q, A, CA)


def switch(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, scheme: Scheme, count: Index, t: float,
    h: float, i: int, way: int,
) -> None:  # fmt: skip
    """Let law `i` leave its branch; `h` is the nominal step, whose factor follows."""
    before, k, c = w.i[i, AT], w.f[i, K], w.f[i, C]
    if w.i[i, NORMAL] >= 0:
        grip(w, f, x.q, i)
    transition(w, f, i, way, w.f[i, LD], w.f[i, LV])
    if w.i[i, CURVED]:
        tangent(w, f, i)
    change = scheme.gamma * h * (w.f[i, C] - c) + scheme.beta * h * h * (w.f[i, K] - k)
    if not m.explicit and change != 0.0:
        count[UPDATES] += 1
        if count[UPDATES] > REFRESH or not change_factor(m, w, x, i, change, WHOLE):
            count[UPDATES] = REFRESH + 1
    force = w.f[i, K] * w.f[i, LD] + w.f[i, C] * w.f[i, LV] + w.f[i, F0]
    if w.i[i, CONTACT] and light(m, w, i):  # the dashpot's is only known when the velocities have settled
        force -= w.f[i, C] * w.f[i, LV]
    if before != w.i[i, AT]:
        write(w, z, count, i, before, t, force)
    count[EVENTS] += 1
    for j in w.leans:
        before = w.i[j, AT]
        grip(w, f, x.q, j)
        if before != w.i[j, AT]:
            write(w, z, count, j, before, t, w.f[j, HELD])
            count[UPDATES] = REFRESH + 1


def write(w: Laws, z: Samples, count: Index, i: int, before: int, t: float, force: float) -> None:
    """Put a change of branch into the log; a contact begins to count its force anew."""
    row = z.log[count[LOGGED]]
    row[0], row[1], row[2], row[3], row[4], row[5], row[6] = (
        i,
        before,
        w.i[i, AT],
        t,
        w.f[i, LD],
        w.f[i, LV],
        force,
    )
    row[7], row[8], row[9] = w.f[i, PEAK], w.f[i, T_PEAK], w.f[i, IMPULSE]
    count[LOGGED] += 1
    if w.i[i, CONTACT]:
        w.f[i, PEAK], w.f[i, T_PEAK], w.f[i, IMPULSE] = force, t, 0.0


def sample(w: Laws, x: Motion, z: Samples, f: Tables, count: Index, t: float) -> None:
    """Keep the motion, the laws' forces and energies."""
    at = count[KEPT]
    z.works[at, 0] = t
    for i in range(x.q.shape[1]):
        for j in range(3):
            z.motion[at, j, i] = x.q[U + j, i]
    for i in range(len(w.i)):
        d = w.f[i, LD]
        still = law_force(w, f, i, d, 0.0)
        z.laws[at, 0, i] = law_force(w, f, i, d, w.f[i, LV]) if w.i[i, CONTACT] else still
        held = f.recoverable[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i), d, still)
        lost = law_work(w, f, i, d) - held
        size = max(abs(d), abs(w.f[i, D0]))
        z.laws[at, 1, i] = held
        z.laws[at, 2, i] = lost if abs(lost) > 1e-14 * w.p[i, 0] * size * size else 0.0
    for i in range(3):
        z.works[at, 1 + i] = x.works[i]
    count[KEPT] += 1


def show(x: Motion, z: Samples, count: Index, t: float, each: int) -> None:
    """Keep the motion after every `each`-th step between two outputs."""
    count[SINCE] += 1
    if count[SINCE] < each or len(z.which) == 0:
        return
    at = count[SHOWN]
    z.when[at] = t
    for j in range(3):
        for i in range(len(z.which)):
            z.shown[at, j, i] = x.q[U + j, z.which[i]]
    count[SINCE] = 0
    count[SHOWN] += 1


def uncut_step(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, scheme: Scheme, coefs: Array, begin: float,
    count: Index, clock: Array, length: float, tried: bool,
) -> int:  # fmt: skip
    """Advance by `length` without a cut at events: Newton to the forces of the laws at its end, each driven
    along a straight path from its start; `tried` where the first trial is made.
    """
    laws = len(w.i)
    for i in range(laws):
        w.i[i, SAVED] = 0
    for _ in range(50):
        if not tried and not attempt(
            m, w, x, scheme, f, coefs, clock[0] + length - begin, length, WHOLE, count
        ):
            break
        tried, changed, driven = False, False, 0
        for i in range(laws):
            d, d1 = w.f[i, LD], w.f[i, LD1]
            if w.i[i, SAVED] == 0 and next_exit(w, i, d, d1, w.f[i, LV1])[0] < 0:
                continue
            k, c, f0 = w.f[i, K], w.f[i, C], w.f[i, F0]
            if w.i[i, SAVED] == 0:
                save(w, i)
            else:
                restore(w, f, i)
            count[STALE] = 1
            for _ in range(100):
                way, where = next_exit(w, i, d, d1, w.f[i, LV1])
                if way < 0:
                    break
                transition(w, f, i, way, where, w.f[i, LV1])
                driven += 1
                d = where
            if w.i[i, CURVED]:
                bend(w, f, i, d1, w.f[i, LV1])
            if w.f[i, K] != k or w.f[i, C] != c or abs(w.f[i, F0] - f0) > STILL * abs(f0):
                changed = True
                change = scheme.gamma * length * (w.f[i, C] - c) + scheme.beta * length * length * (
                    w.f[i, K] - k
                )
                if change != 0.0 and not m.explicit:
                    count[UPDATES] += 1
                    if not change_factor(m, w, x, i, change, WHOLE):
                        bad = refactor(m, w, x, scheme, length, WHOLE)
                        if bad >= 0:
                            count[WORST] = bad
                            return PIVOT
        if changed:
            continue
        accept(m, w, x, f, scheme, length, WHOLE, count)
        clock[0] += length
        count[EVENTS] += driven
        for i in range(laws):
            if w.i[i, SAVED] == 1 and w.saved[i, 0] != w.i[i, AT]:
                force = w.f[i, K] * w.f[i, LD] + w.f[i, C] * w.f[i, LV] + w.f[i, F0]
                write(w, z, count, i, int(w.saved[i, 0]), clock[0], force)
        note(m, w, x, clock[0], length)
        return DONE
    for i in range(laws):
        if w.i[i, SAVED] == 1:
            restore(w, f, i)
    count[UPDATES], count[STALE] = REFRESH + 1, 1
    return NEWTON


def start_again(w: Laws, f: Tables) -> None:
    """Linearise all that is curved at the start of the step."""
    for i in range(len(w.i)):
        if w.i[i, CURVED]:
            tangent(w, f, i)
    linearise(w.corotational, S0)


def cut(
    m: Matrices, w: Laws, x: Motion, scheme: Scheme, f: Tables, coefs: Array, s0: float, piece: float,
    h: float, law: int, way: int, tau: float, count: Index,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Shorten a step from the local time `s0`, in which exits are passed, to the first of them.

    Parameters
    ----------
    piece, h : float
        Its length as it was tried, and the nominal one.
    law, way, tau : int, int, float
        What `first_exit` said of it.

    Returns
    -------
    why, law, way, at : int, int, int, float
        DONE or what failed; the law and its exit, law -1 where none is met after all; the length, which was
        tried last, or 0 where the exit is met at once.
    """
    low, high, third, stuck = 0.0, piece, np.nan, False
    g_low = behind(w, x, law, way)
    g_high, g_third = excess(w, law, way, w.f[law, LD1], w.f[law, LV1])[0], np.nan
    for turn in range(100):
        if tau <= CLOSE * h:
            return DONE, law, way, 0.0
        last = high - low <= CLOSE * h
        if last:
            tau = high
        elif turn > 12 or stuck:
            tau = 0.5 * (low + high)
        bad = refactor(m, w, x, scheme, tau, PIECE)
        if bad >= 0:
            count[WORST] = bad
            return PIVOT, law, way, 0.0
        if not attempt(m, w, x, scheme, f, coefs, s0 + tau, tau, PIECE, count):
            if last:
                return NEWTON, law, way, 0.0
            start_again(w, f)  # at `high` there was a solution: look for the exit nearer to it
            low, g_low, third, g_third, stuck = tau, np.nan, np.nan, np.nan, True
            continue
        passed, exit2, tau2 = first_exit(w, x, tau)
        other = passed >= 0 and (passed != law or exit2 != way)
        if other:
            law, way, g_low, g_high = passed, exit2, np.nan, np.nan
            if low == 0.0:
                g_low = behind(w, x, law, way)
        g, size = excess(w, law, way, w.f[law, LD1], w.f[law, LV1])
        if abs(g) <= STILL * size or last or 0.0 <= tau - tau2 <= CLOSE * h:
            if passed < 0 and abs(g) > NEAR * size:
                law = -1  # it was no exit: rates of massless unknowns may mislead
            return DONE, law, way, tau
        if passed >= 0:
            third, g_third, high, g_high = high, g_high, tau, g
        elif g_high <= 0.0:
            return DONE, -1, way, tau  # no exit up to here; the rest of the step may have one
        else:
            third, g_third, low, g_low = low, g_low, tau, g
        if passed >= 0 and g_low != g_low:
            tau = tau2 if g_third != g_third else between(high, third, np.nan, g_high, g_third, np.nan)
        elif passed >= 0:
            tau = between(high, low, third, g_high, g_low, g_third)
        else:
            tau = between(low, high, third, g_low, g_high, g_third)
        tau += 0.5 * CLOSE * h  # a trial just beyond the exit ends the search, one before it does not
        if not low < tau < high:
            tau = 0.5 * (low + high)
    return NEWTON, law, way, 0.0


def whole_step(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, scheme: Scheme, coefs: Array, begin: float,
    count: Index, clock: Array, length: float, h: float, tried: bool,
) -> int:  # fmt: skip
    """Advance by `length`, in pieces where events cut it; the factor at hand is for the step `h`,
    and `tried` tells that the first trial is made.

    After the touch of a curved contact the pieces grow from a short one: forces like the fourth root
    of time begin there.
    """
    left, first, same = length, True, 0
    most = 100 + 8 * len(w.i)
    curved = False
    for i in range(len(w.i)):
        if w.i[i, CURVED]:
            curved = True
    while left > 0.0:
        if len(z.log) - count[LOGGED] <= len(w.leans):
            return CROWD
        t = clock[0]
        piece = left
        if clock[3] < left:
            piece, first = clock[3], False
        slot = WHOLE if first else PIECE
        if not first:
            bad = refactor(m, w, x, scheme, piece, PIECE)
            if bad >= 0:
                count[WORST] = bad
                return PIVOT
        elif abs(length - h) > 1e-9 * h:
            first = False
            continue
        halvings = 0
        while not tried and not attempt(m, w, x, scheme, f, coefs, t + piece - begin, piece, slot, count):
            halvings += 1
            if halvings > 25:
                return NEWTON
            first, piece, count[UPDATES] = False, 0.5 * piece, REFRESH + 1
            slot = PIECE
            start_again(w, f)
            if refactor(m, w, x, scheme, piece, PIECE) >= 0:
                return NEWTON
        tried = False
        law, way, tau = first_exit(w, x, piece)
        if law < 0:
            accept(m, w, x, f, scheme, piece, slot, count)
            clock[3] *= 2.0
            left -= piece
            clock[0] = t + piece
            note(m, w, x, clock[0], piece)
            first = False
            continue
        if curved:  # what is tried from here on moves the tangents away from the factor at hand
            count[UPDATES] = REFRESH + 1
        first = False
        why, law, way, at = cut(m, w, x, scheme, f, coefs, t - begin, piece, h, law, way, tau, count)
        if why != DONE:
            return why
        if at > 0.0:
            accept(m, w, x, f, scheme, at, PIECE, count)
            left -= at
            clock[0] = t + at
            note(m, w, x, clock[0], at)
            if at > 1e-9 * h:
                same = 0
        if law < 0:
            continue
        switch(m, w, x, z, f, scheme, count, clock[0], h, law, way)
        if w.i[law, CURVED] and w.i[law, CONTACT] and w.f[law, LV] > 0.0:
            clock[3] = FIRST * h
        settle(m, w, x)
        note(m, w, x, clock[0], 0.0)
        count[WORST] = law
        same += 1
        if same > most:
            return CHATTER
    return DONE


@flat
def stride(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, scheme: Scheme, coefs: Array, begin: float,
    count: Index, clock: Array, h: float, last: int, each: int,
) -> bool:  # fmt: skip
    """Take steps of length `h` up to step `last` while every law stays on its branch; `each` is `show`'s.

    Returns
    -------
    bool
        Whether it stopped at a step that is tried, but not accepted, because a law leaves its branch.
    """
    while count[STEP] < last and count[UPDATES] <= REFRESH and clock[3] >= h:
        if not attempt(m, w, x, scheme, f, coefs, clock[0] + h - begin, h, WHOLE, count):
            return False
        if scheme.locate:
            if first_exit(w, x, h)[0] >= 0:
                return True
        else:
            for i in range(len(w.i)):
                if next_exit(w, i, w.f[i, LD], w.f[i, LD1], w.f[i, LV1])[0] >= 0:
                    return True
        accept(m, w, x, f, scheme, h, WHOLE, count)
        clock[0] += h
        note(m, w, x, clock[0], h)
        count[STEP] += 1
        count[STEPS] += 1
        show(x, z, count, clock[0], each)
    return False


def next_look(x: Motion, count: Index) -> int:
    """Step at which Python may look again whether the user wants to stop."""
    return count[STEPS] + min(PAUSE, 1 + BUSY // (1 + x.q.shape[1]))


def advance(
    m: Matrices, w: Laws, x: Motion, z: Samples, f: Tables, scheme: Scheme, coefs: Array, breaks: Array,
    goals: Array, steps: Index, lengths: Array, outputs: Flags, shows: Index, pieces: Index,
    count: Index, clock: Array,
) -> int:  # fmt: skip
    """Integrate to the last goal, or until Python must look at something.

    Parameters
    ----------
    coefs : ndarray, shape (n_pieces, degree + 1, n_inputs)
        The motions; they begin at `breaks`.
    goals : ndarray, shape (n_goals,)
        Times that a step ends at, reached in `steps` steps of `lengths` each, on the motions' `pieces`;
        `outputs` tells whether a sample is taken; on the way to it the envelopes are shown the motion every
        so many steps as `shows` tells.
    count : ndarray, shape (11,)
        Goal, step on the way to it, samples and log rows kept, steps, events, updates of the factor,
        unknown or law at fault, steps since the motion was last shown or sampled, how often it was shown,
        whether the factor of the massless unknowns must be made anew.
    clock : ndarray, shape (4,)
        Time, length that the factor at hand is for, energy at the start, longest piece for now.
    """
    room, pause = len(z.log) // 2, next_look(x, count)
    while count[GOAL] < len(goals):
        goal = count[GOAL]
        h = lengths[goal]
        begin = breaks[pieces[goal]]
        if count[STEP] == 0:
            motions(coefs[pieces[goal]], clock[0] - begin, x.inputs, 0)
            load(m, x.inputs[0], x.q, Y)
            # accelerations of the alpha methods lag behind: after steps much shorter, as through a spike of
            # the load, that of its past would act for too long
            leap = 1.0 if scheme.alpha_f + scheme.alpha_m != 0.0 and h > 2.0 * clock[1] > 0.0 else 0.0
            for i in range(x.q.shape[1]):
                if abs(x.q[Y, i] - x.q[P, i]) > STILL * (abs(x.q[Y, i]) + abs(x.q[P, i])):
                    leap = 1.0
                x.q[P, i] = x.q[Y, i]
            if leap != 0.0:  # a load that jumps, and with it the acceleration
                settle(m, w, x)
                note(m, w, x, clock[0], 0.0)
        while count[STEP] < steps[goal]:
            if len(z.log) - count[LOGGED] < room or count[STEPS] >= pause:
                return FULL
            if clock[1] != h or count[UPDATES] > REFRESH:
                bad = refactor(m, w, x, scheme, h, WHOLE)
                if bad >= 0:
                    count[WORST] = bad
                    return PIVOT
                clock[1], count[UPDATES] = h, 0
            last = min(steps[goal] - 1, count[STEP] + pause - count[STEPS])
            tried = stride(
                m, w, x, z, f, scheme, coefs[pieces[goal]], begin, count, clock, h, last, shows[goal]
            )
            if not tried and (count[STEP] == last < steps[goal] - 1 or count[UPDATES] > REFRESH):
                continue
            length = h if count[STEP] < steps[goal] - 1 else goals[goal] - clock[0]
            why = NEWTON
            if not scheme.locate:
                why = uncut_step(
                    m, w, x, z, f, scheme, coefs[pieces[goal]], begin, count, clock, length, tried
                )
                tried = False
            if why == NEWTON:  # cut at its events a step always has a solution
                why = whole_step(
                    m, w, x, z, f, scheme, coefs[pieces[goal]], begin, count, clock, length, h, tried
                )
            if why != DONE:
                return why
            count[STEP] += 1
            count[STEPS] += 1
            if count[STEP] < steps[goal] or not outputs[goal]:
                show(x, z, count, clock[0], shows[goal])
        clock[0] = goals[goal]
        kinetic = 0.0
        times(m.m, x.q, V, Y)
        for i in range(x.q.shape[1]):
            kinetic += 0.5 * x.q[V, i] * x.q[Y, i]
        if not kinetic <= 10.0 * (clock[2] + x.works[3]) + 1e-300:
            clock[2] = kinetic
            return RUNAWAY
        count[GOAL] += 1
        count[STEP] = 0
        if outputs[goal]:
            sample(w, x, z, f, count, clock[0])
            count[SINCE] = 0
            if count[KEPT] == len(z.works):
                return FULL
    return DONE
