"""Kernels of the laws: their branches, forces and states, and products with sparse rows."""

from __future__ import annotations

from pound_solve.integrate.kernels.state import (
    A1,
    AT,
    BETA,
    CODE,
    CURVED,
    D0,
    EXIT,
    F0,
    HELD,
    LD,
    LD1,
    LV,
    LV1,
    N_EXITS,
    NORMAL,
    PRESSED,
    SAVED,
    SECANT,
    STIFFNESS,
    TURN,
    WORK,
    A,
    C,
    K,
    Laws,
    Matrices,
    Product,
)
from pound_solve.laws.automaton import PUSH, PUSH_RATE
from pound_solve.laws.functions import PARAMETERS, VARIABLES, Tables, row
from pound_solve.numerics.ldl import Place
from pound_solve.numerics.types import Array, Index

parameters, memory = row(PARAMETERS), row(VARIABLES)  #: rows of `Laws.p` and `Laws.memory` as tuples


def motions(coefs: Array, s: float, out: Array, at: int) -> None:
    """Inputs and their rates at the local time `s` of a piece, into rows `at` and `at + 1`."""
    top, n = coefs.shape
    for j in range(n):
        value, rate = coefs[top - 1, j], 0.0
        for k in range(top - 2, -1, -1):
            rate = rate * s + value
            value = value * s + coefs[k, j]
        out[at, j], out[at + 1, j] = value, rate


def load(m: Matrices, s: Array, q: Array, out: int) -> None:
    """Loads for the inputs `s`, into row `out`."""
    for i in range(q.shape[1]):
        q[out, i] = m.constant[i]
    for j in range(len(s)):
        for i in range(q.shape[1]):
            q[out, i] += m.inputs[j, i] * s[j]


def carry(q: Array, x: int, out: int) -> None:
    """Copy row `x` of `q` into row `out`."""
    for i in range(q.shape[1]):
        q[out, i] = q[x, i]


def times(a: Product, q: Array, x: int, out: int) -> None:
    """Product of a matrix with row `x` of `q`, into row `out`."""
    n = q.shape[1]
    for i in range(n):
        q[out, i] = a.diagonals[0, i] * q[x, i]
    for z in range(1, len(a.offsets)):
        first, size = max(0, -a.offsets[z]), n - abs(a.offsets[z])
        near, far = q[out, first : first + size], q[x, first + a.offsets[z] :]
        for i in range(size):
            near[i] += a.diagonals[z, i] * far[i]
    for r in range(len(a.row)):
        total = 0.0
        for j in range(a.pointers[r], a.pointers[r + 1]):
            total += a.values[j] * q[x, a.columns[j]]
        q[out, a.row[r]] += total


def along(a: tuple[Index, Place, Array], i: int, q: Array, x: int) -> float:
    """One sparse row times row `x` of `q`."""
    total = 0.0
    for j in range(a[0][i], a[0][i + 1]):
        total += a[2][j] * q[x, a[1][j]]
    return total


def follows(w: Laws, i: int, k: float) -> float:
    """Dashpot that follows law `i`, whose tangent stiffness is `k`."""
    return w.f[i, BETA] * max(k, 0.0) + w.f[i, SECANT] * w.memory[i, STIFFNESS]


def enter(w: Laws, f: Tables, i: int) -> None:
    """Take over the branch that law `i` is on."""
    b = f.branch[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i))
    w.f[i, K], w.f[i, C], w.f[i, F0] = b[0], b[1] + follows(w, i, b[0]), b[2]
    count = 0
    for e in range(3):
        x, y, z = b[3 + 3 * e], b[4 + 3 * e], b[5 + 3 * e]
        w.f[i, EXIT + 3 * e], w.f[i, EXIT + 3 * e + 1], w.f[i, EXIT + 3 * e + 2] = x, y, z
        if x != 0.0 or y != 0.0:
            count = e + 1
    w.i[i, N_EXITS] = count


def law_work(w: Laws, f: Tables, i: int, d: float) -> float:
    """Work done on law `i` so far, dashpots apart."""
    if w.i[i, CURVED]:
        c = f.curve[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i), w.f[i, D0], d, 0.0)
        return w.f[i, WORK] + c[3]
    return w.f[i, WORK] + (0.5 * w.f[i, K] * (d + w.f[i, D0]) + w.f[i, F0]) * (d - w.f[i, D0])


def law_force(w: Laws, f: Tables, i: int, d: float, v: float) -> float:
    """Force of law `i`."""
    if w.i[i, CURVED]:
        c = f.curve[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i), w.f[i, D0], d, v)
        return c[0] + follows(w, i, c[1]) * v
    return w.f[i, K] * d + w.f[i, C] * v + w.f[i, F0]


def drag(w: Laws, f: Tables, i: int, d: float, v: float) -> float:
    """Force whose work at the rate `v` law `i` dissipates, by its dashpot and those that follow it."""
    if not w.i[i, CURVED]:
        return w.f[i, C] * v
    if v == 0.0:
        return 0.0
    own = f.power[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i), d, v)
    return own / v + follows(w, i, w.f[i, K]) * v


def transition(w: Laws, f: Tables, i: int, way: int, d: float, v: float) -> None:
    """Change the branch of law `i` at deformation `d` and rate `v`."""
    done = law_work(w, f, i, d)
    if w.f[i, EXIT + 3 * way] == 0.0 and w.f[i, EXIT + 3 * way + 2] == 0.0 and abs(d) > w.memory[i, TURN]:
        w.memory[i, TURN], w.memory[i, STIFFNESS] = abs(d), max(law_force(w, f, i, d, 0.0) / d, 0.0)
    at, m = f.transition[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i), way, d, v)
    w.i[i, AT], w.f[i, D0], w.f[i, WORK] = at, d, done
    for j in range(len(m)):
        w.memory[i, j] = m[j]
    enter(w, f, i)


def lean(w: Laws, i: int, d: float, v: float, a: float) -> None:
    """Tell law `i` the force of the one that it leans on, and its rate, at the motion of that one."""
    j = w.i[i, NORMAL]
    k, c = w.f[j, K], w.f[j, C]
    w.memory[i, PUSH], w.memory[i, PUSH_RATE] = max(k * d + c * v + w.f[j, F0], 0.0), k * v + c * a


def limit(w: Laws, f: Tables, q: Array) -> None:
    """Limits of the laws that lean on others, at the end of a step."""
    for i in w.leans:
        j = w.i[i, NORMAL]
        lean(w, i, w.f[j, LD1], w.f[j, LV1], along(w.rows, j, q, A1))
        enter(w, f, i)


def slide(w: Laws, h: float) -> None:
    """Add up the work of the laws that lean on others and slip, over a step of length `h`."""
    for i in w.leans:
        if w.f[i, K] == 0.0:
            before, after = w.f[i, HELD], w.f[i, F0]
            w.f[i, WORK] += (
                h / 6.0 * ((2.0 * before + after) * w.f[i, LV] + (before + 2.0 * after) * w.f[i, LV1])
            )
            w.f[i, HELD], w.f[i, D0] = after, w.f[i, LD1]


def grip(w: Laws, f: Tables, q: Array, i: int) -> None:
    """Let law `i` touch or let go with the one that it leans on, and take over what that does now."""
    j = w.i[i, NORMAL]
    lean(w, i, w.f[j, LD], w.f[j, LV], along(w.rows, j, q, A))
    pressed = (w.i[i, PRESSED] >> w.i[j, AT]) & 1
    if pressed != (w.i[i, AT] != 0):
        transition(w, f, i, 0 if pressed else 2, w.f[i, LD], w.f[i, LV])
    enter(w, f, i)
    w.f[i, HELD] = w.f[i, K] * w.f[i, LD] + w.f[i, F0]


def tangent(w: Laws, f: Tables, i: int) -> None:
    """Linearise a curved law where it is."""
    bend(w, f, i, w.f[i, LD], w.f[i, LV])


def bend(w: Laws, f: Tables, i: int, d: float, v: float) -> None:
    """Linearise a curved law at deformation `d` and rate `v`."""
    c = f.curve[w.i[i, CODE]](parameters(w.p, i), w.i[i, AT], memory(w.memory, i), w.f[i, D0], d, v)
    k, own = c[1], follows(w, i, c[1])
    w.f[i, K], w.f[i, C] = k, c[2] + own
    w.f[i, F0] = c[0] - k * d - c[2] * v


def save(w: Laws, i: int) -> None:
    """Keep the state of law `i`."""
    w.i[i, SAVED] = 1
    w.saved[i, 0], w.saved[i, 1], w.saved[i, 2] = w.i[i, AT], w.f[i, D0], w.f[i, WORK]
    for j in range(w.memory.shape[1]):
        w.saved[i, 3 + j] = w.memory[i, j]


def restore(w: Laws, f: Tables, i: int) -> None:
    """Put law `i` back into the state that was kept."""
    w.i[i, AT], w.f[i, D0], w.f[i, WORK] = int(w.saved[i, 0]), w.saved[i, 1], w.saved[i, 2]
    for j in range(w.memory.shape[1]):
        w.memory[i, j] = w.saved[i, 3 + j]
    enter(w, f, i)


def next_exit(w: Laws, i: int, at: float, to: float, rate: float) -> tuple[int, float]:
    """First exit on the straight path from `at` to `to` with the rate at its end, and where
    (see `laws.follow`); -1 where there is none.
    """
    way = 1.0 if to >= at else -1.0
    best, where = -1, 0.0
    for e in range(w.i[i, N_EXITS]):
        a, b, c = w.f[i, EXIT + 3 * e], w.f[i, EXIT + 3 * e + 1], w.f[i, EXIT + 3 * e + 2]
        if a != 0.0:
            c += b * rate
        now, slope = a * at + c, a * way
        if b != 0.0 and a == 0.0 and c == 0.0:
            if b * way <= 0.0 or to == at:
                continue
            place = at
        elif now >= 0.0 and (slope > 0.0 or (slope == 0.0 and now > 0.0)):
            place = at
        elif slope > 0.0 and a * to + c > 0.0:
            place = at - now / slope * way
        else:
            continue
        if best < 0 or (place - where) * way < 0.0:
            best, where = e, place
    return best, where
