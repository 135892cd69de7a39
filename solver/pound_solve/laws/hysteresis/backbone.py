r"""The bilinear backbone that the degrading rules share, and its loss of strength.

One side at a time (`mirror`), with the yield force :math:`F_y > 0`, the yield deformation
:math:`d_y = F_y / k` and the ductility :math:`x = |d| / d_y`:

.. math:: F(x) = F_y \left[\varphi(\max(x, \mu_L)) + r (x - 1)\right]

The share :math:`\varphi` of the yield force that is left falls along a straight line from 1 at ductility
:math:`D_1` to :math:`\varphi_R` at :math:`D_2` and stays there; :math:`\mu_L` is the largest ductility so
far: of that side (ILOS=EACH) or of either side (LARGEST).  The hardening is not reduced.

A spring that has reached ductility :math:`\mu` unloads with

.. math:: k_u = k \max\left(\mu^{-\alpha},\; \frac{\varphi(\mu) + r (\mu - 1)}{\mu}\right)

The second bound, the secant from the origin to the backbone, is ours: a softer line would reach no force on
the far side of the origin, and for large :math:`\alpha` run flatter than the backbone itself.

Internal variables of each rule: the largest ductility of each side (1 before yield), and a point (d, f).

References
----------
Carr AJ (2008), Ruaumoko manual, volume 5, appendix A (strength loss, ILOS 1 and 3); how the loss acts
within an excursion is not said there: here it acts at once, the backbone itself falls.
Otani S (1981), Hysteresis models of reinforced concrete for earthquake response analysis, J. Faculty of
Engng, Univ. of Tokyo 36(2): 407-441 (unloading stiffness as a power of the ductility).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind
from pound_solve.laws.automaton import Numbers, linear
from pound_solve.laws.mirror import need_both_sides, outward, pair, side, turns_inward

# branches of the positive side; those of the negative side are one more
ELASTIC, YIELDING, WEAKENING = 0, 1, 3

R = Field(
    "R",
    Kind.REAL,
    "-",
    default=0.0,
    lo=0.0,
    below=1.0,
    doc="post-yield stiffness as a share of the initial",
)
ALFA = Field(
    "ALFA",
    Kind.REAL,
    "-",
    default=0.0,
    lo=0.0,
    hi=1.0,
    doc="unloading stiffness falls with this power of the ductility; 0: it stays the initial",
)
LOSS = (
    Field(
        "ILOS",
        Kind.WORD,
        default="NONE",
        words=("NONE", "EACH", "LARGEST"),
        codes={"NONE": 0, "EACH": 1, "LARGEST": 3},
        doc="strength falls with the ductility of each direction alone, or with the larger of both",
    ),
    Field("DUCT1", Kind.REAL, "-", default=None, lo=1.0, doc="ductility where the loss of strength begins"),
    Field("DUCT2", Kind.REAL, "-", default=None, above=1.0, doc="ductility where it ends"),
    Field("RDUCT", Kind.REAL, "-", default=None, above=0.0, hi=1.0, doc="share of the yield force left"),
)


def parameters(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Numbers:
    """First parameters of all rules on this backbone: k, both yield forces, r, alpha, then the loss as
    D1, D2, what is left, and whether the largest ductility of either side drives it.

    Raises
    ------
    ValueError
        No yield force on a side, r outside its limits, or a loss that is not whole.
    """
    need_both_sides(fy_plus, fy_minus)
    r, alpha = values["R"], values.get("ALFA", 0.0)
    if not 0.0 <= r < 1.0:
        raise ValueError("R of a degrading rule lies from 0 to below 1")
    loss = [values[name] for name in ("DUCT1", "DUCT2", "RDUCT")]
    if values["ILOS"] == "NONE":
        if loss != [None] * 3:
            raise ValueError("DUCT1, DUCT2 and RDUCT have no effect without ILOS=EACH or ILOS=LARGEST")
        return k, fy_plus, fy_minus, r, alpha, 0.0, 0.0, 1.0, 0.0
    if None in loss:
        raise ValueError("ILOS needs DUCT1, DUCT2 and RDUCT")
    begin, end, left = loss
    if begin >= end:
        raise ValueError("DUCT2 must be larger than DUCT1")
    if left <= r:
        raise ValueError("RDUCT must be larger than R: the yield line would fall through zero otherwise")
    return k, fy_plus, fy_minus, r, alpha, begin, end, left, float(values["ILOS"] == "LARGEST")


def yield_force(p: Numbers, s: float) -> float:
    """Yield force of a side, positive."""
    return p[1] if s > 0.0 else -p[2]


def reached(m: Numbers, s: float) -> float:
    """Largest ductility of a side so far."""
    return m[0] if s > 0.0 else m[1]


def share(p: Numbers, x: float) -> float:
    """Share of the yield force that is left at ductility `x`."""
    begin, end, left = p[5:8]
    if x >= end:
        return left
    if x <= begin:
        return 1.0
    return 1.0 - (1.0 - left) * (x - begin) / (end - begin)


def worst(p: Numbers, m: Numbers, s: float) -> float:
    """Ductility that has driven the loss of a side so far."""
    return max(m[0], m[1]) if p[8] != 0.0 else reached(m, s)


def backbone(p: Numbers, m: Numbers, s: float, x: float) -> float:
    """Force of a side's backbone at a ductility `x` that it has reached, positive."""
    return yield_force(p, s) * (share(p, worst(p, m, s)) + p[3] * (x - 1.0))


def unloading(p: Numbers, x: float) -> float:
    """Stiffness of unloading after ductility `x`."""
    k, r, alpha = p[0], p[3], p[4]
    stiffness: float = k * max(x**-alpha, (share(p, x) + r * (x - 1.0)) / x)
    return stiffness


def grown(m: Numbers, s: float, x: float) -> tuple[float, float]:
    """Largest ductilities when side `s` has reached `x`."""
    return (max(m[0], x), m[1]) if s > 0.0 else (m[0], max(m[1], x))


def enter(p: Numbers, m: Numbers, s: float, x: float) -> tuple[int, Numbers]:
    """State on the backbone of side `s`, met at ductility `x`."""
    plus, minus = grown(m, s, x)
    m = (plus, minus, 0.0, 0.0)
    falls = p[5] <= x < p[6] and worst(p, m, s) <= x
    return pair(WEAKENING if falls else YIELDING, s), m


def yield_line(p: Numbers, at: int, m: Numbers) -> tuple[float, float, float]:
    """Slope and force at zero of the present line of the backbone, mirrored to the positive side, and the
    ductility where it ends (0: it does not).
    """
    k, r, begin, end, left = p[0], p[3], p[5], p[6], p[7]
    s = side(at)
    fy, mu = yield_force(p, s), worst(p, m, s)
    if at == pair(WEAKENING, s):
        fall = (1.0 - left) / (end - begin)
        return (r - fall) * k, fy * (1.0 + fall * begin - r), end
    until = max(mu, begin)
    return r * k, fy * (share(p, mu) - r), until if until < end else 0.0


def yield_branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Along the backbone until the motion reverses (event 0) or the line ends (event 1)."""
    s = side(at)
    slope, f0, until = yield_line(p, at, m)
    if until == 0.0:
        return linear(slope, s * f0, turns_inward(s))
    return linear(slope, s * f0, turns_inward(s), outward(s, until * yield_force(p, s) / p[0]))


def next_branch(p: Numbers, at: int, m: Numbers) -> tuple[int, Numbers]:
    """State after the end of a line of the backbone."""
    s = side(at)
    return (pair(WEAKENING, s), m) if at == pair(YIELDING, s) else enter(p, m, s, p[6])


def turn(p: Numbers, at: int, m: Numbers, d: float) -> Numbers:
    """Internal variables after a reversal on the backbone at `d`: ductilities, and the point itself."""
    s = side(at)
    slope, f0, _ = yield_line(p, at, m)
    x = s * d * p[0] / yield_force(p, s)
    plus, minus = grown(m, s, x)
    return (plus, minus, d, slope * d + s * f0)


def meets(p: Numbers, m: Numbers, s: float, slope: float, d: float, f: float) -> float:
    """Ductility where the line of that slope through (d, f) meets the backbone of side `s`."""
    r, begin, end, left = p[3], p[5], p[6], p[7]
    fy, mu, steep = yield_force(p, s), worst(p, m, s), slope / p[0]
    start = s * (slope * d - f) / fy
    x = (share(p, mu) - r + start) / (steep - r)
    if x <= max(mu, begin) or mu >= end:
        return x
    fall = (1.0 - left) / (end - begin)
    x = (1.0 + fall * begin - r + start) / (steep - r + fall)
    return x if x <= end else (left - r + start) / (steep - r)
