r"""Members whose cracks slip: the automaton that SINA and TAKEDA_SLIP share.

The formulas are for one side (`mirror`), on the backbone of `cracking`; :math:`d_m, F_m` are the largest
deformation of the side and the force there, and a prime denotes the other side.

* It unloads from the backbone (Takeda's rules 1, 3 and 5) with

  .. math:: k_u = \frac{F_m + F_c'}{d_m + d_c'} \quad (d_m \le d_y), \qquad
            k_u = \frac{F_y + F_c'}{d_y + d_c'} \left(\frac{d_y}{d_m}\right)^{\alpha} \quad (d_m > d_y)

  Up to yield this line points to the crack point of the other side; it is never softer than that (our
  choice).
* If the other side has not cracked, this line continues to the crack force of that side.  From there the
  spring follows the backbone if this side has not yielded, otherwise a straight line to the yield point of
  the other side (rule 6).
* From zero force at :math:`d_0` a side that has cracked is loaded straight to :math:`(d_m, F_m)` (rule 4);
  before it has yielded, to its yield point, if that line is steeper.
* Once it has gone beyond its yield point it slips from :math:`d_0` along a flatter line to a point that the
  rule states (`slip_line`), and goes from there straight to :math:`(d_m, F_m)`.
* After a reversal on one of these lines the spring unloads with :math:`b k_u`, but not softer than the line
  that it leaves (rule 7, where :math:`b = 0.7`), nor than the straight line from :math:`d_0` (our choice),
  so that no loop generates energy.
* A motion that turns while it unloads returns along the same line.

Internal variables: the largest deformation of each side (0: not cracked); for the side that is loaded or
unloaded: :math:`d_0`, the point where the present line began, the last reversal, the unloading stiffness
from there, and the branch on which the reversal occurred.

References
----------
Takeda T, Sozen MA, Nielsen NN (1970), Reinforced concrete response to simulated earthquakes, J. Struct.
Div. ASCE 96(12): 2557-2573 (numbers of the rules).
"""

from __future__ import annotations

from pound_solve.laws.automaton import BranchKind, K, Numbers, Rule, linear, passes
from pound_solve.laws.hysteresis.backbone import ALPHA
from pound_solve.laws.hysteresis.cracking import (
    BRANCHES,
    ELASTIC,
    PARAMETERS,
    UNLOADING,
    backbone,
    backbone_branch,
    crack_point,
    deformations_with,
    enter_backbone,
    first_yield,
    has_yielded,
    largest_deformation,
    next_branch,
    peak,
    yield_point,
)
from pound_solve.laws.mirror import both_sides, inward, on_side, outward, side, turns_inward

# branches of the positive side, after those of the backbone; add one for the negative side
SLIPPING, TO_PEAK = 13, 15
#: parameters of a law after those of the backbone: b; the exponent n of TAKEDA_SLIP; ratios of the closing
#: force of SINA to the yield force, of both sides (0: the rule is TAKEDA_SLIP)
INNER, SLIP, FCC, FCC_MINUS = range(PARAMETERS, PARAMETERS + 4)
# internal variables after the largest deformations, mirrored: d_0; the points where the present line began
# and of the last reversal; stiffness of unloading from there, and the branch that the reversal left
ZERO, X_ORIGIN, F_ORIGIN, X_REVERSAL, F_REVERSAL, SLOPE, LEFT = range(2, 9)


def unloading(p: Numbers, s: float, x: float) -> float:
    """Return the unloading stiffness from the backbone at a deformation `x`."""
    (xy, fy), (xc, fc) = yield_point(p, s), crack_point(p, -s)
    to_crack: float = (backbone(p, s, x)[1] + fc) / (x + xc)
    if x <= xy:
        return to_crack
    stiffness: float = max((fy + fc) / (xy + xc) * (xy / x) ** p[ALPHA], to_crack)
    return stiffness


def slip_line(p: Numbers, s: float, m: Numbers) -> tuple[float, float]:
    """Return the slope of the line along which a side slips, and the deformation at its end."""
    x, f = peak(p, s, m)
    if p[FCC] > 0.0:  # SINA: to the closing force on the unloading line from the peak
        f_close = min(f, yield_point(p, s)[1]) * (p[FCC] if s > 0.0 else p[FCC_MINUS])
        end = x - (f - f_close) / unloading(p, s, x)
        return f_close / (end - m[ZERO]) if end > m[ZERO] else p[K], end
    x_other, f_other = peak(p, -s, m)
    span = x + x_other - f_other / unloading(p, -s, x_other)  # d_m + d_z'
    k: float = f / span * (x / span) ** p[SLIP]
    return k, -k * m[ZERO] / (f / x - k) if k * x < f else x


def slips(p: Numbers, s: float, m: Numbers) -> bool:
    """Return whether a side slips before it is loaded to its peak."""
    x, f = peak(p, s, m)
    if not has_yielded(p, s, m) or (p[FCC] == 0.0 and m[ZERO] >= 0.0):
        return False
    k, end = slip_line(p, s, m)
    return end > m[ZERO] and k * (x - m[ZERO]) < f


def loading_end(p: Numbers, m: Numbers, at: int) -> float:
    """Return the mirrored deformation at which a loading line ends."""
    s = side(at)
    return largest_deformation(m, s) if at >= TO_PEAK else slip_line(p, s, m)[1]


def loading_line(p: Numbers, m: Numbers, at: int) -> tuple[float, float]:
    """Return the slope of a loading line and its force at zero deformation, mirrored."""
    s = side(at)
    if at < TO_PEAK:
        k, _ = slip_line(p, s, m)
        return k, -k * m[ZERO]
    x, f = peak(p, s, m)
    k = (f - m[F_ORIGIN]) / (x - m[X_ORIGIN]) if x > m[X_ORIGIN] else 0.0
    return k, f - k * x


def inner_stiffness(p: Numbers, m: Numbers, at: int, x: float, f: float) -> float:
    """Return the unloading stiffness from a point of a loading line."""
    s = side(at)
    k = max(p[INNER] * unloading(p, s, largest_deformation(m, s)), loading_line(p, m, at)[0])
    if x > m[ZERO]:
        k = max(k, f / (x - m[ZERO]))
    return min(k, p[K])


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def end_of_unloading(p: Numbers, m: Numbers, s: float) -> float:
    """Return the mirrored deformation at which the unloading line of a side ends: at zero force or, before
    the other side has cracked, at its crack force.
    """
    f_crack = crack_point(p, -s)[1] if largest_deformation(m, -s) == 0.0 else 0.0
    return m[X_REVERSAL] - (m[F_REVERSAL] + f_crack) / m[SLOPE]


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic, along the backbone, unloading, or on a loading line."""
    if at < UNLOADING:
        return backbone_branch(p, at)
    s = side(at)
    if at < SLIPPING:
        x, f, k = m[X_REVERSAL], m[F_REVERSAL], m[SLOPE]
        return linear(k, s * (f - k * x), outward(s, x), inward(s, end_of_unloading(p, m, s)))
    k, f = loading_line(p, m, at)
    return linear(k, s * f, turns_inward(s), outward(s, loading_end(p, m, at)))


def enter_at_crack(p: Numbers, m: Numbers, s: float) -> tuple[int, Numbers]:
    """Return the state on the backbone of a side at its crack point."""
    x, _ = crack_point(p, s)
    return enter_backbone(p, (*deformations_with(m, s, x), *m[ZERO:]), s, x)


def begin_loading(p: Numbers, m: Numbers, s: float, x: float, f: float, k: float) -> tuple[int, Numbers]:
    """Return the state in which loading of a side begins: at zero force, or at its crack force after a line
    with slope `k`.
    """
    zero = x - f / k
    xy, fy = yield_point(p, s)
    plus, minus = m[:ZERO]
    x_largest = largest_deformation(m, s)
    if x_largest < xy and (f > 0.0 or fy * (x_largest - zero) > peak(p, s, m)[1] * (xy - zero)):
        plus, minus = deformations_with(m, s, xy)
    m = (plus, minus, zero, x, f, *m[X_REVERSAL:])
    return on_side(SLIPPING if slips(p, s, m) else TO_PEAK, s), m


def reversed_at(p: Numbers, m: Numbers, at: int, x: float, f: float) -> Numbers:
    """Return the internal variables after a reversal."""
    s = side(at)
    x_largest = largest_deformation(m, s)
    if at >= UNLOADING and (at < TO_PEAK or passes(x_largest, x, x_largest)):
        return (*m[:X_REVERSAL], x, f, inner_stiffness(p, m, at, x, f), float(at))
    return (*deformations_with(m, s, x), *m[ZERO:X_REVERSAL], x, f, unloading(p, s, x), float(at))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a crack, a yield, a reversal, a return, zero force or the end of a line."""
    if at == ELASTIC:
        return enter_at_crack(p, m, 1.0 if event == 0 else -1.0)
    s = side(at)
    if UNLOADING <= at < SLIPPING:
        if event == 0:
            return int(m[LEFT]), m
        if largest_deformation(m, -s) > 0.0:
            return begin_loading(p, m, -s, -end_of_unloading(p, m, s), 0.0, m[SLOPE])
        if not has_yielded(p, s, m):
            return enter_at_crack(p, m, -s)
        return begin_loading(p, m, -s, -end_of_unloading(p, m, s), crack_point(p, -s)[1], m[SLOPE])
    k, _, f0 = branch(p, at, m)[:3]
    if event == 0:
        return on_side(UNLOADING, s), reversed_at(p, m, at, s * d, s * (k * d + f0))
    if at < UNLOADING:
        return next_branch(p, at, m)
    x = loading_end(p, m, at)
    if at >= TO_PEAK:
        return enter_backbone(p, m, s, x)
    return on_side(TO_PEAK, s), (*m[:X_ORIGIN], x, k * (x - m[ZERO]), *m[X_REVERSAL:])


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    s = side(at)
    if at == ELASTIC:
        k = p[K]
    elif at < UNLOADING:
        k = unloading(p, s, max(largest_deformation(m, s), s * d))
    elif at < SLIPPING:
        k = m[SLOPE]
    else:
        k = inner_stiffness(p, m, at, s * d, s * f)
    return 0.5 * f * f / k


RULE = Rule(
    (*BRANCHES, *BranchKind.ELASTIC.named(*both_sides("unloading", "slipping", "reloading to the peak"))),
    start,
    branch,
    transition,
    recoverable,
    first_yield=first_yield,
    parameters=PARAMETERS + 4,
    variables=9,
)
