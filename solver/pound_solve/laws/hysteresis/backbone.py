r"""The bilinear backbone that the degrading rules share, and its strength loss.

The formulas are for one side (`mirror`), with the yield force :math:`F_y > 0`, the yield deformation
:math:`d_y = F_y / k` and the ductility :math:`x = |d| / d_y`:

.. math:: F(x) = F_y \left[(1 - r)\,\gamma\,\varphi(\max(x, \mu_L)) + r x\right]

so that, on the elastic line, the fraction :math:`\gamma\varphi` of the initial yield force remains.  The
hardening is not reduced.  :math:`\varphi` decreases linearly with the ductility from 1 at :math:`D_1` to
:math:`\varphi_R` at :math:`D_2` and, if :math:`D_3` is given, further to 0.01 at :math:`D_3`.  In the
SUDDEN forms it stays at :math:`\varphi_R` up to :math:`D_3` and drops to 0.01 there.  :math:`\mu_L` is the
largest ductility so far, of the same side (EACH) or the larger of both sides (LARGEST).  In the forms with
RCYC, :math:`\gamma = 1 - c n`, but at least 0.01, after :math:`n` inelastic cycles (RCYC is :math:`c` in
per cent).  With CYCLES the number of cycles replaces the ductility: :math:`\gamma = \varphi(n)`, and
:math:`\varphi = 1`.

A spring that has reached ductility :math:`\mu` unloads with

.. math:: k_u = k \max\left(\mu^{-\alpha},\; \frac{(1 - r)\,\varphi(\mu) + r \mu}{\mu}\right)

The second bound, the secant from the origin to the backbone, is ours.  A softer line would reach zero force
beyond the origin, and for large :math:`\alpha` would be flatter than the backbone itself.

Three choices are ours, since no source states them.  The loss due to ductility acts immediately, so the
backbone itself falls.  A yield of one side counts as a cycle of that side once the other side yields.  Both
losses are multiplied.

Internal variables of each rule: the largest ductility of each side (1 before yield); a point (d, f) or, on
the backbone, the ductility at which the spring reached it; and the number of changes of the yielding side,
with the sign of the side that yielded last.  A spring that reverses as it reaches the backbone has not
yielded.

References
----------
Carr AJ (2008), Ruaumoko manual, volume 5, appendix A (strength loss: ILOS 0 to 7).
Otani S (1981), Hysteresis models of reinforced concrete for earthquake response analysis, J. Faculty of
Engng, Univ. of Tokyo 36(2): 407-441 (unloading stiffness as a power of the ductility).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pound_deck.schema import Field, Kind
from pound_solve.laws.automaton import FY, FY_MINUS, K, Numbers, linear, passes
from pound_solve.laws.mirror import need_both_sides, on_side, outward, side, turns_inward
from pound_solve.laws.refusal import ItemError

# branches of the positive side; add one for the negative side
ELASTIC, YIELDING, WEAKENING = 0, 1, 3

BEFORE = -1e300  #: smaller than any ductility, for the other side of zero
REMAINING_STRENGTH = 0.01  #: fraction of the yield force that finally remains
# parameters of a law after K, FY, FY_MINUS: r, alpha; of the loss D1, D2, phi_R, its form, D3 (0: none) and
# the loss by a cycle
R, ALPHA, D1, D2, PHI_R, FORM, D3, BY_CYCLE = range(3, 11)
NO_LOSS = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)  #: parameters D1 to BY_CYCLE without a strength loss
PARAMETERS = 11  #: number of these parameters; a rule's own parameters follow
# internal variables: largest ductilities of both sides; the point (d, f); changes of the yielding side,
# with the sign of the last one
MU, MU_MINUS, D, F, CHANGES = range(5)
MET = D  #: replaces the point on the backbone: the ductility at which the spring reached it
VIRGIN = (1.0, 1.0, 0.0, 0.0, 0.0)  #: initial internal variables
VARIABLES = 5
_WORDS = "NONE EACH CYCLES LARGEST EACH_RCYC EACH_SUDDEN LARGEST_RCYC LARGEST_SUDDEN"
FORMS = {word: code for code, word in enumerate(_WORDS.split())}  #: forms of the loss by Ruaumoko's codes
_CYCLES, _LARGEST, _EACH_SUDDEN, _LARGEST_RCYC, _LARGEST_SUDDEN = 2.0, 3.0, 5.0, 6.0, 7.0
_COUNTING = 4.0  #: the first form that counts cycles in addition to the ductility

R_FIELD = Field(
    "R", Kind.REAL, "-", default=0.0, lo=0.0, below=1.0, doc="ratio of post-yield to initial stiffness"
)
ALFA_FIELD = Field(
    "ALFA",
    Kind.REAL,
    "-",
    default=0.0,
    lo=0.0,
    hi=1.0,
    doc="unloading stiffness falls with this power of ductility; 0: initial stiffness",
)
LOSS = (
    Field(
        "ILOS",
        Kind.WORD,
        default="NONE",
        words=tuple(FORMS),
        codes=FORMS,
        doc="strength falls with the ductility of each direction, the larger of both, or the number of "
        "inelastic cycles; RCYC: also with cycles; SUDDEN: likewise, and beyond DUCT2 only at DUCT3",
    ),
    Field(
        "DUCT1",
        Kind.REAL,
        "-",
        default=None,
        lo=1.0,
        doc="ductility (CYCLES: number of cycles) at which strength loss begins",
    ),
    Field("DUCT2", Kind.REAL, "-", default=None, above=1.0, doc="ductility where it ends"),
    Field("RDUCT", Kind.REAL, "-", default=None, above=0.0, hi=1.0, doc="residual yield force ratio"),
    Field(
        "DUCT3",
        Kind.REAL,
        "-",
        default=None,
        above=1.0,
        doc="ductility where 0.01 of the yield force is left; omitted: RDUCT stays",
    ),
    Field(
        "RCYC",
        Kind.REAL,
        "-",
        default=None,
        lo=0.0,
        below=100.0,
        doc="loss of yield force per inelastic cycle, per cent; for the forms RCYC and SUDDEN",
    ),
)
#: names of the lines of a backbone whose loss depends on the largest deformation of the side alone
LINES = ("yielding", "yielding weaker", "yielding weakened", "yielding without strength")
#: the items of such a loss
LOSS_OF_SIDE = (
    replace(
        LOSS[0],
        words=("NONE", "EACH"),
        codes={word: FORMS[word] for word in ("NONE", "EACH")},
        doc="strength falls with the ductility of each direction",
    ),
    replace(LOSS[1], doc="ductility at which strength loss begins"),
    *LOSS[2:5],
)
_ITEMS = ("DUCT1", "DUCT2", "RDUCT", "DUCT3", "RCYC")


def parameters(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Numbers:
    """Return the first parameters of all rules on this backbone: k, both yield forces, r, alpha, then the
    strength loss as D1, D2, residual fraction, form, D3 and the loss per cycle.

    Raises
    ------
    ValueError
        A side has no yield force, r is outside its limits, or the strength loss is incomplete.
    """
    need_both_sides(fy_plus, fy_minus)
    r, alpha = values.get("R", 0.0), values.get("ALFA", 0.0)
    if not 0.0 <= r < 1.0:
        raise ItemError("R of a degrading rule lies from 0 to below 1", "R")
    return (k, fy_plus, fy_minus, r, alpha, *loss(values))


def loses_strength(values: Mapping[str, Any]) -> bool:
    """Return whether a card requests a strength loss.

    Raises
    ------
    ValueError
        The card has items of a strength loss, but requests none.
    """
    if values["ILOS"] == "NONE" and any(values.get(name) is not None for name in _ITEMS):
        raise ValueError(f"{', '.join(_ITEMS)} have no effect without ILOS=EACH or the like")
    return bool(values["ILOS"] != "NONE")


def loss(values: Mapping[str, Any]) -> Numbers:
    """Return the parameters of the strength loss; see `parameters`."""
    if not loses_strength(values):
        return NO_LOSS
    form = FORMS[values["ILOS"]]
    items: list[Any] = [values.get(name) for name in _ITEMS]
    d1, d2, phi_r, d3, by_cycle = items
    if None in (d1, d2, phi_r):
        raise ItemError("ILOS needs DUCT1, DUCT2 and RDUCT", "ILOS")
    if d1 >= d2:
        raise ItemError("DUCT2 must be larger than DUCT1", "DUCT2")
    if d3 is not None and d3 <= d2:
        raise ItemError("DUCT3 must be larger than DUCT2", "DUCT3")
    if d3 is not None and phi_r <= REMAINING_STRENGTH:
        raise ItemError(
            f"RDUCT must be larger than {REMAINING_STRENGTH:g}, which is left at DUCT3", "RDUCT"
        )
    if d3 is None and form in (_EACH_SUDDEN, _LARGEST_SUDDEN):
        raise ItemError("a SUDDEN loss needs DUCT3, where it happens", "ILOS")
    if (by_cycle is None) is (form >= _COUNTING):
        raise ValueError("RCYC goes with the forms of ILOS that end in RCYC or SUDDEN, and these need it")
    return d1, d2, phi_r, float(form), d3 or 0.0, (by_cycle or 0.0) / 100.0


def yield_force(p: Numbers, s: float) -> float:
    """Yield force of a side, positive."""
    return p[FY] if s > 0.0 else -p[FY_MINUS]


def largest_ductility(m: Numbers, s: float) -> float:
    """Return the largest ductility of a side so far."""
    return m[MU] if s > 0.0 else m[MU_MINUS]


def phi(p: Numbers, x: float) -> float:
    """Return the fraction of the yield force that remains at ductility `x` or, with CYCLES, after `x`
    cycles.
    """
    d1, d2, phi_r, d3 = p[D1], p[D2], p[PHI_R], p[D3]
    if d3 > 0.0 and x >= d3:
        return REMAINING_STRENGTH
    if x >= d2:
        if d3 == 0.0 or p[FORM] == _EACH_SUDDEN or p[FORM] == _LARGEST_SUDDEN:
            return phi_r
        return phi_r - (phi_r - REMAINING_STRENGTH) * (x - d2) / (d3 - d2)
    if x <= d1:
        return 1.0
    return 1.0 - (1.0 - phi_r) * (x - d1) / (d2 - d1)


def strength_by_ductility(p: Numbers, x: float) -> float:
    """Return the fraction of the yield force that remains at ductility `x`."""
    return 1.0 if p[FORM] == _CYCLES else phi(p, x)


def counts_larger_side(p: Numbers) -> bool:
    """Return whether the larger ductility of both sides determines the loss."""
    return bool(p[FORM] == _LARGEST or p[FORM] >= _LARGEST_RCYC)


def governing_ductility(p: Numbers, m: Numbers, s: float) -> float:
    """Return the largest ductility so far that determines the strength loss of a side."""
    return max(m[MU], m[MU_MINUS]) if counts_larger_side(p) else largest_ductility(m, s)


def inelastic_cycles(m: Numbers, s: float) -> float:
    """Return the number of inelastic cycles of a side: its yields that were followed by one of the other
    side.
    """
    changes = abs(m[CHANGES]) - (s * m[CHANGES] > 0.0)
    return float(changes // 2.0)


def strength_by_cycles(p: Numbers, m: Numbers, s: float) -> float:
    """Return the fraction of the yield force of a side that remains after its cycles."""
    if p[FORM] == _CYCLES:
        return phi(p, inelastic_cycles(m, s))
    if p[FORM] < _COUNTING:
        return 1.0
    return max(1.0 - p[BY_CYCLE] * inelastic_cycles(m, s), REMAINING_STRENGTH)


def strength_line(p: Numbers, mu: float, x: float) -> tuple[float, float, float]:
    """Return the line of the remaining fraction of the yield force from ductility `x` on: slope, value at
    zero, and the ductility at which it ends (0: no end).  The ductility `mu` determines the loss so far.
    """
    d1, d2, phi_r, d3 = p[D1], p[D2], p[PHI_R], p[D3]
    flat_to = max(mu, d1)  # no further strength is lost up to this ductility
    if p[FORM] == 0.0 or p[FORM] == _CYCLES:
        return 0.0, 1.0, 0.0
    if d3 > 0.0 and max(x, flat_to) >= d3:
        return 0.0, REMAINING_STRENGTH, 0.0
    sudden = p[FORM] == _EACH_SUDDEN or p[FORM] == _LARGEST_SUDDEN
    if max(x, flat_to) >= d2 and (d3 == 0.0 or sudden):
        return 0.0, phi_r, d3
    if x < flat_to:
        return 0.0, phi(p, flat_to), flat_to
    if x < d2:
        slope = -(1.0 - phi_r) / (d2 - d1)
        return slope, 1.0 - slope * d1, d2
    slope = -(phi_r - REMAINING_STRENGTH) / (d3 - d2)
    return slope, phi_r - slope * d2, d3


def line_at(p: Numbers, x: float, dy: float) -> int:
    """Return the number of the line of a backbone at a deformation `x` beyond the yield deformation, where
    the loss depends on this side alone: 0 up to the ductility D1, then up to D2, up to D3, and beyond.
    """
    if p[FORM] == 0.0:
        return 0
    return int(x >= p[D1] * dy) + int(x >= p[D2] * dy) + int(x >= p[D3] * dy > 0.0)


def line_of_side(p: Numbers, n: int, fy: float, k: float) -> tuple[float, float, float]:
    """Return the slope and the force at zero deformation of line `n` of such a backbone, and the
    deformation at which it ends (0: no end), for a side that yields at `fy` with the secant stiffness `k`.
    """
    begin = BEFORE if n == 0 else p[D1] if n == 1 else p[D2] if n == 2 else p[D3]
    fall, value, end = strength_line(p, BEFORE, begin)
    return (p[R] + (1.0 - p[R]) * fall) * k, (1.0 - p[R]) * value * fy, end * fy / k


def backbone(p: Numbers, m: Numbers, s: float, x: float) -> float:
    """Return the force of the backbone of a side at a ductility `x` that it has reached, positive."""
    r, ratio = p[R], strength_by_cycles(p, m, s) * strength_by_ductility(p, governing_ductility(p, m, s))
    return yield_force(p, s) * ((1.0 - r) * ratio + r * x)


def unloading(p: Numbers, x: float) -> float:
    """Return the unloading stiffness after ductility `x`."""
    k, r, alpha = p[K], p[R], p[ALPHA]
    stiffness: float = k * max(x**-alpha, (1.0 - r) * strength_by_ductility(p, x) / x + r)
    return stiffness


def ductilities_with(m: Numbers, s: float, x: float) -> tuple[float, float]:
    """Return the largest ductilities when side `s` has reached `x`."""
    return (max(m[MU], x), m[MU_MINUS]) if s > 0.0 else (m[MU], max(m[MU_MINUS], x))


def changes_at(m: Numbers, s: float, x: float) -> float:
    """Return the count of changes of the yielding side after side `s` has followed the backbone to
    ductility `x`.
    """
    yields = passes(x, m[MET], max(m[MU], m[MU_MINUS]))
    return m[CHANGES] if not yields or s * m[CHANGES] > 0.0 else s * (abs(m[CHANGES]) + 1.0)


def enter_backbone(p: Numbers, m: Numbers, s: float, x: float) -> tuple[int, Numbers]:
    """Return the state on the backbone of side `s`, reached at ductility `x`."""
    plus, minus = ductilities_with(m, s, x)
    m = (plus, minus, x, 0.0, m[CHANGES])
    slope, _, _ = strength_line(p, governing_ductility(p, m, s), x)
    return on_side(WEAKENING if slope < 0.0 else YIELDING, s), m


def yield_line(p: Numbers, at: int, m: Numbers) -> tuple[float, float, float]:
    """Return the slope and the force at zero of the present line of the backbone, mirrored to the positive
    side, and the ductility at which it ends (0: no end).
    """
    k, r, s = p[K], p[R], side(at)
    mu = governing_ductility(p, m, s)
    slope, value, end = strength_line(p, mu, mu if at == on_side(WEAKENING, s) else BEFORE)
    scale = (1.0 - r) * strength_by_cycles(p, m, s)
    return (r + scale * slope) * k, yield_force(p, s) * scale * value, end


def yield_branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch along the backbone until the motion reverses (event 0) or the line ends
    (event 1).
    """
    s = side(at)
    slope, f0, end = yield_line(p, at, m)
    if end == 0.0:
        return linear(slope, s * f0, turns_inward(s))
    return linear(slope, s * f0, turns_inward(s), outward(s, end * yield_force(p, s) / p[K]))


def next_branch(p: Numbers, at: int, m: Numbers) -> tuple[int, Numbers]:
    """Return the state after the end of a line of the backbone."""
    s = side(at)
    _, _, x = yield_line(p, at, m)
    return enter_backbone(p, (*m[:CHANGES], changes_at(m, s, x)), s, x)


def reversed_at(p: Numbers, at: int, m: Numbers, d: float) -> Numbers:
    """Return the internal variables after a reversal on the backbone at `d`: the ductilities and
    the point.
    """
    s = side(at)
    slope, f0, _ = yield_line(p, at, m)
    x = s * d * p[K] / yield_force(p, s)
    plus, minus = ductilities_with(m, s, x)
    return (plus, minus, d, slope * d + s * f0, changes_at(m, s, x))


def meeting_ductility(p: Numbers, m: Numbers, s: float, slope: float, d: float, f: float) -> float:
    """Return the ductility at which the line with `slope` through (d, f) meets the backbone of side `s`."""
    r, fy, mu = p[R], yield_force(p, s), governing_ductility(p, m, s)
    scale, start = (1.0 - r) * strength_by_cycles(p, m, s), s * (slope * d - f) / fy
    x = BEFORE
    while True:  # for each line of the backbone in turn
        fall, value, end = strength_line(p, mu, x)
        meeting = max(x, (scale * value + start) / (slope / p[K] - r - scale * fall))
        if end == 0.0 or meeting <= end:
            return meeting
        x = end
