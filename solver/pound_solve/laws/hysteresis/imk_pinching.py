r"""Ibarra-Medina-Krawinkler, pinching: reloading is soft before it aims at the largest deformation.

The backbone :math:`B`, the excursions and the deterioration are those of `imk`.  A side is loaded along its
backbone up to its *peak*: the largest deformation so far (initially the yield point), with the force of the
present backbone.  Its last turning point is its *local peak*.  It unloads with :math:`k_u` from the local
peak to zero force.  This point is the *foot* of the excursion of the other side, which goes

* to the *break point*, if the foot lies before it,

  .. math:: d_b = (1 - \kappa_d) (d_{peak} - B(d_{peak})/k_u), \qquad
            f_b = \kappa_f B(d_{peak}) \frac{d_b - d_{foot}}{d_{peak} - d_{foot}}

* then to the local peak, if the line to it is stiffer than the line to the peak but not stiffer than
  :math:`k_u`, and if the local peak lies below the peak and within the backbone,
* then to the peak, where the backbone continues.

Reloading is never stiffer than :math:`k`.  If a soft :math:`k_u` has brought the foot too close to the
peak, or beyond it, the peak moves to the point where a line with the stiffness :math:`k` meets the
backbone.

A motion that reverses before the peak unloads with :math:`k_u`.  If it reverses again, it reloads from
there to the break point or to the peak.

Internal variables in addition to those of `imk`: for each side, the deformation of the peak, and the
deformation and force of the local peak.

References
----------
In addition to those of `imk`: Clough RW, Johnston SB (1966), Effect of stiffness degradation on earthquake
ductility requirements, Proc. Japan Earthquake Engng Symp., Tokyo; Mahin SA, Bertero VV (1975), An
evaluation of some methods for predicting seismic behavior of reinforced concrete buildings, EERC 75-5,
Univ. of California, Berkeley (the local peak).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import NEVER, BranchKind, K, Law, Numbers, Rule, linear
from pound_solve.laws.hysteresis.imk import (
    BRANCHES,
    FAILED,
    FOOT,
    KU,
    KU_BEFORE,
    PARAMETERS,
    add_work,
    end_excursion,
    falling,
    fields,
    hardening,
    parameters,
    recoverable_energy,
    replace_side,
    residual,
    softened,
    ultimate,
    variables_of_side,
    virgin,
)
from pound_solve.laws.mirror import both_sides, inward, on_side, outward, side, turns_inward

ELASTIC, HARDENING, FALLING, RESIDUAL, UNLOADING = 1, 3, 5, 7, 9
#: reloading branches, by their end points
FOOT_BREAK, FOOT_LOCAL, FOOT_PEAK, BREAK_LOCAL, BREAK_PEAK, LOCAL_BREAK, LOCAL_PEAK = range(11, 25, 2)
FAR = 1e300
KAPPA_F, KAPPA_D = PARAMETERS, PARAMETERS + 1  #: parameters of a law after those of `imk`
PEAK, LOCAL_D, LOCAL_F = 2, 3, 4  #: internal variables of a side: peak; local peak, deformation and force

Point = tuple[float, float]  #: deformation and force, mirrored


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic; the yield points are the peaks."""
    sides = []
    for s in (1.0, -1.0):
        fy, _, ref, _ = virgin(p, s)
        sides += [fy, ref, fy / p[K], fy / p[K], fy]
    return ELASTIC, (*sides, p[K], p[K], 0.0, 0.0, 0.0, 0.0)


def backbone(p: Numbers, s: float, m: Numbers, d: float) -> float:
    """Return the force of the present backbone."""
    (k1, f1), (k2, f2) = hardening(p, s, m), falling(p, s, m)
    return max(residual(p, s), min(k1 * d + f1, k2 * d + f2))


def peak(p: Numbers, s: float, m: Numbers) -> Point:
    """Return the largest deformation of a side, with the force of the backbone."""
    d = variables_of_side(m, s)[PEAK]
    return d, backbone(p, s, m, d)


def local_peak(s: float, m: Numbers) -> Point:
    """Return the last turning point of a side."""
    of_side = variables_of_side(m, s)
    return of_side[LOCAL_D], of_side[LOCAL_F]


def break_point(p: Numbers, s: float, m: Numbers) -> tuple[bool, Point]:
    """Return whether this excursion is pinched, and the break point."""
    kappa_f, kappa_d = p[KAPPA_F], p[KAPPA_D]
    d, f = peak(p, s, m)
    foot = s * m[FOOT]
    d_break = (1.0 - kappa_d) * (d - f / m[KU_BEFORE])
    if kappa_f == 1.0 or foot >= d_break:
        return False, (0.0, 0.0)
    return True, (d_break, kappa_f * f * (d_break - foot) / (d - foot))


def reloading_ends(p: Numbers, s: float, m: Numbers, kind: int) -> tuple[Point, Point]:
    """End points of a reloading branch."""
    begin, end = (s * m[FOOT], 0.0), peak(p, s, m)
    if kind >= LOCAL_BREAK:
        begin = local_peak(s, m)
    elif kind >= BREAK_LOCAL:
        _, begin = break_point(p, s, m)
    if kind in (FOOT_BREAK, LOCAL_BREAK):
        _, end = break_point(p, s, m)
    elif kind in (FOOT_LOCAL, BREAK_LOCAL):
        end = local_peak(s, m)
    return begin, end


def passes_local_peak(p: Numbers, s: float, m: Numbers, d: float, f: float) -> bool:
    """Return whether the path from a point to the peak passes through the last turning point of
    that side.
    """
    (d1, f1), (d2, f2) = local_peak(s, m), peak(p, s, m)
    inside = d < d1 < d2 and f < f1 < f2 and f1 <= backbone(p, s, m, d1)
    return inside and (f2 - f) * (d1 - d) < (f1 - f) * (d2 - d) and f1 - f <= m[KU] * (d1 - d)


def cap_deformation(p: Numbers, s: float, m: Numbers) -> float:
    """Return the deformation where the hardening line meets the falling one."""
    (k1, f1), (k2, f2) = hardening(p, s, m), falling(p, s, m)
    return (f2 - f1) / (k1 - k2)


def residual_start(p: Numbers, s: float, m: Numbers) -> float:
    """Return the deformation at which the falling line reaches the residual strength."""
    k2, f2 = falling(p, s, m)
    return (residual(p, s) - f2) / k2


def on_backbone(p: Numbers, s: float, m: Numbers, d: float) -> int:
    """Return the line of the backbone at a deformation."""
    if d >= residual_start(p, s, m):
        return RESIDUAL
    return FALLING if d >= cap_deformation(p, s, m) else HARDENING


def next_branch(p: Numbers, s: float, m: Numbers, kind: int) -> tuple[int, float]:
    """Return the branch that follows a loading branch (numbered as on the positive side), and the
    deformation where it begins.
    """
    if kind == ELASTIC:
        return HARDENING, peak(p, s, m)[0]
    if kind == HARDENING:
        return FALLING, cap_deformation(p, s, m)
    if kind == FALLING:
        return RESIDUAL, residual_start(p, s, m)
    if kind == RESIDUAL:
        return RESIDUAL, FAR
    if kind == UNLOADING:
        d, f = local_peak(s, m)
        pinched, (d1, f1) = break_point(p, s, m)
        if d >= peak(p, s, m)[0]:
            return on_backbone(p, s, m, d), d
        return (LOCAL_BREAK if pinched and d < d1 and f < f1 else LOCAL_PEAK), d
    _, (d, f) = reloading_ends(p, s, m, kind)
    if kind in (FOOT_BREAK, LOCAL_BREAK):
        return (BREAK_LOCAL if passes_local_peak(p, s, m, d, f) else BREAK_PEAK), d
    if kind in (FOOT_LOCAL, BREAK_LOCAL):
        return LOCAL_PEAK, d
    return on_backbone(p, s, m, d), d


def line(p: Numbers, s: float, m: Numbers, kind: int) -> tuple[float, float]:
    """Return the slope and the (mirrored) force at zero deformation of a branch."""
    if kind == ELASTIC:
        return p[K], 0.0
    if kind == HARDENING:
        return hardening(p, s, m)
    if kind == FALLING:
        return falling(p, s, m)
    if kind == RESIDUAL:
        return 0.0, residual(p, s)
    if kind == UNLOADING:
        d, f = local_peak(s, m)
        return m[KU], f - m[KU] * d
    (d1, f1), (d2, f2) = reloading_ends(p, s, m, kind)
    k = (f2 - f1) / (d2 - d1) if d2 > d1 else 0.0
    return k, f2 - k * d2


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: along the backbone, unloading from it, or along a reloading path."""
    if at == FAILED:
        return linear(0.0, 0.0)
    s = side(at)
    kind = at if s > 0.0 else at - 1
    k, f0 = line(p, s, m, kind)
    _, end = next_branch(p, s, m, kind)
    if ultimate(p, s) > 0.0:
        end = min(end, ultimate(p, s))
    back = inward(s, -f0 / k) if kind in (ELASTIC, UNLOADING) else turns_inward(s)
    return linear(k, s * f0, back, outward(s, end) if end < FAR else NEVER)


def enter_side(p: Numbers, m: Numbers, s: float, d: float) -> tuple[int, Numbers]:
    """End an excursion at `d` and enter side `s`."""
    m, beta, fails = end_excursion(p, m, s, d)
    of_side = variables_of_side(m, s)
    m = replace_side(m, s, (*of_side[:PEAK], of_side[PEAK] * (1.0 + beta), *of_side[LOCAL_D:]))
    d_peak, f = peak(p, s, m)
    k, foot = p[K], s * d
    if f > k * (d_peak - foot):
        (k1, f1), (k2, f2) = hardening(p, s, m), falling(p, s, m)
        d_peak = min((f1 + k * foot) / (k - k1), (f2 + k * foot) / (k - k2))
        d_peak = max(d_peak, foot + residual(p, s) / k)
        m = replace_side(m, s, (*of_side[:PEAK], d_peak, *of_side[LOCAL_D:]))
    if fails or peak(p, s, m)[1] <= 0.0:
        return FAILED, m
    if break_point(p, s, m)[0]:
        return on_side(FOOT_BREAK, s), m
    return on_side(FOOT_LOCAL if passes_local_peak(p, s, m, s * d, 0.0) else FOOT_PEAK, s), m


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after the end of a line, a failure, a reversal, or the end of an excursion."""
    s = side(at)
    kind = at if s > 0.0 else at - 1
    present = branch(p, at, m)
    m = add_work(present, m, d)
    if event == 1:
        following, d_next = next_branch(p, s, m, kind)
        no_strength = following == RESIDUAL and residual(p, s) == 0.0
        if no_strength or 0.0 < ultimate(p, s) < d_next:
            return FAILED, m
        return on_side(following, s), m
    if kind == ELASTIC:
        return on_side(ELASTIC, -s), m
    if kind == UNLOADING:
        return enter_side(p, m, -s, d)
    k, _, f0 = present[:3]
    f = s * (k * d + f0)
    ku = softened(p, m, f)
    of_side = variables_of_side(m, s)
    m = replace_side(m, s, (*of_side[:PEAK], max(of_side[PEAK], s * d), s * d, f))
    return on_side(UNLOADING, s), (*m[:KU], ku, *m[KU_BEFORE:])


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    if at == FAILED:
        return 0.0
    kind = at if at % 2 == 1 else at - 1
    return recoverable_energy(p, m, branch(p, at, m), kind != ELASTIC and kind != UNLOADING, d, f)


RULE = Rule(
    (
        *BRANCHES,
        *BranchKind.ELASTIC.named(*both_sides("elastic")),
        *BranchKind.YIELDING.named(
            *both_sides("yielding", "yielding beyond the cap", "yielding at the residual strength")
        ),
        *BranchKind.ELASTIC.named(
            *both_sides(
                "unloading",
                "reloading to the break point",
                "reloading to the local peak",
                "reloading to the peak",
                "reloading to the local peak",
                "reloading to the peak",
                "reloading to the break point",
                "reloading to the peak",
            )
        ),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=PARAMETERS + 2,
    variables=16,
)

MODES = "basic strength, post-capping strength, unloading stiffness, accelerated reloading"


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    pinch = values["KAPPAF"], values["KAPPAD"]
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), *pinch))


SPEC = Spec(
    "hysteresis",
    "IMK_PINCHING",
    "pinching with capping and cyclic deterioration",
    (
        *fields(MODES, 4),
        Field(
            "KAPPAF",
            Kind.REAL,
            "-",
            above=0.0,
            hi=1.0,
            doc="target force of pinched reloading / peak force",
        ),
        Field(
            "KAPPAD",
            Kind.REAL,
            "-",
            lo=0.0,
            hi=1.0,
            doc="break point ending pinched reloading: distance back from plastic deformation as a "
            "fraction of it",
        ),
    ),
    reference="Ibarra, Medina & Krawinkler 2005; Lignos & Krawinkler 2011",
    sample="R=0.05 DP=3 DPC=8 RESIDUAL=0.2 LAMBDA=80 KAPPAF=0.3 KAPPAD=0.3",
    impl=build,
)
