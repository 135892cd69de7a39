r"""Wayne Stewart: nailed timber connections, with pinching, slackness and a softening branch.

The *backbone* of the positive side starts at the slackness :math:`g`:

.. math:: k\,(d - g) \text{ up to } F_y, \quad r k \text{ up to } F_u, \quad p_{tri}\,k \text{ beyond}

(:math:`p_{tri} < 0`: it softens).  Once a side has yielded, both sides are pinched:

* from the backbone the spring unloads with :math:`p_{unl}\,k` to the *pinched line* of the other side;
* the pinched lines are :math:`f = \pm F_i + r_p k d`: the nail slides in the hole that it has crushed;
* the pinched line ends on the *reloading line* of slope

  .. math:: k_p = k \left(\frac{F_y/k}{\beta\,(d_{un} - g)}\right)^{\alpha}

  through the point of the backbone at :math:`g + \beta\,(d_{un} - g)`, where :math:`d_{un}` is the largest
  deformation of that side so far; from there the backbone continues.  A side that has not yielded reloads
  with :math:`k` to its yield point;
* after a reversal anywhere else, the spring unloads and reloads with :math:`p_{unl}\,k` between the paths
  of the two sides.

If the softening branch reaches zero force, or the pinched line of the other side, the connection fails: its
force is zero from then on.

Internal variables: the largest deformations :math:`d_{un} - g` of both sides (mirrored); the foot
:math:`d - f/k_u` of the present unloading line; the branch and the deformation at its upper end and at its
lower end.

The power law of the reloading line is that of Folz and Filiatrault (2001), in which :math:`r_p` is a
separate parameter (their r4).  Our choices: deformations in the power law are measured from the slackness;
the reloading line is never flatter than the line from the intercept :math:`F_i` to its target; and the
connection can fail.

References
----------
Stewart WG (1987), The seismic design of plywood sheathed shear walls, PhD thesis, University of
Canterbury; Ruaumoko's rule 9.

Folz B, Filiatrault A (2001), Cyclic analysis of wood shear walls, J. Struct. Eng. 127(4): 433-441.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY,
    FY_MINUS,
    STRENGTHLESS,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.mirror import inward, need_both_sides, on_side, outward, side, turns_inward
from pound_solve.laws.refusal import ItemError

SLACK, FAILED, UNLOADING = 0, 1, 2
#: the first of each pair of branches: positive side, negative side
ELASTIC, YIELDING, BEYOND, PINCHED, RELOADING = 3, 5, 7, 9, 11

# parameters of a law after K, FY, FY_MINUS: hardening ratio, ultimate forces, intercept F_i of the pinched
# line, slope beyond the ultimate force, ends of the slack; beta, alpha; slopes of the pinched and of the
# unloading lines (slopes as fractions of K)
R, FU, FU_MINUS, INTERCEPT, TRI = range(3, 8)
GAP_PLUS, GAP_MINUS, BETA, ALPHA, PINCH, UNLOAD = range(8, 14)
# internal variables: largest deformations of both sides, foot of the unloading line; for its upper and its
# lower end the branch and the deformation
MOST, MOST_MINUS, FOOT, UPPER, UPPER_END, LOWER, LOWER_END = range(7)

Line = tuple[float, float]  #: slope and force at zero deformation


def is_slack(p: Numbers) -> bool:
    """Return whether there is a slack; with a slack of zero width, massless joints would be a mechanism at
    rest.
    """
    return p[GAP_PLUS] > p[GAP_MINUS]


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: slack if there is a slack, otherwise elastic."""
    return (SLACK if is_slack(p) else ELASTIC), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def backbone(p: Numbers, s: float) -> tuple[float, float, float, Line, Line]:
    """Return the slackness, the deformations at yield and at the ultimate force, and the lines before and
    beyond the ultimate force (mirrored).
    """
    k, r, tri = p[K], p[R], p[TRI]
    if s > 0.0:
        fy, fu, gap = p[FY], p[FU], p[GAP_PLUS]
    else:
        fy, fu, gap = -p[FY_MINUS], -p[FU_MINUS], -p[GAP_MINUS]
    dy = gap + fy / k
    # without hardening, the ultimate force is the yield force
    du = dy + (fu - fy) / (r * k) if r > 0.0 else dy
    return gap, dy, du, (r * k, fy - r * k * dy), (tri * k, fu - tri * k * du)


def first_yield(p: Numbers) -> tuple[float, float]:
    """Return the deformations at yield."""
    (_, dy, *_), (_, dy_minus, *_) = backbone(p, 1.0), backbone(p, -1.0)
    return dy, -dy_minus


def pinched(p: Numbers) -> Line:
    """Return the line along which a side first reloads."""
    return p[PINCH] * p[K], p[INTERCEPT]


def unloading(p: Numbers) -> float:
    """Return the stiffness of the lines from the path of one side to that of the other."""
    return p[UNLOAD] * p[K]


def steepest(p: Numbers) -> float:
    """Return the stiffness of the steepest line."""
    return max(p[K], unloading(p))


def reloading(p: Numbers, s: float, m: Numbers) -> tuple[float, float, float]:
    """Return the target deformation, and the slope and force at zero deformation of the line towards it."""
    k, beta, alpha = p[K], p[BETA], p[ALPHA]
    gap, dy, du, (k1, f1), (k2, f2) = backbone(p, s)
    most = m[MOST] if s > 0.0 else m[MOST_MINUS]
    if most == 0.0:
        return dy, k, -k * gap
    reach = beta * most
    target = gap + reach
    f = max(k1 * target + f1 if target < du else k2 * target + f2, 0.0)
    slope = max(k * ((dy - gap) / reach) ** alpha, (f - pinched(p)[1]) / target)
    return target, slope, f - slope * target


def pinch_end(p: Numbers, s: float, m: Numbers) -> tuple[bool, float]:
    """Return whether the pinched line of a side ends on its reloading line (otherwise on the softening
    backbone), and where.
    """
    slope, f0 = pinched(p)
    target, k, f = reloading(p, s, m)
    if k * target + f > slope * target + f0:
        return True, (f0 - f) / (k - slope)
    _, _, _, _, (k2, f2) = backbone(p, s)
    return False, (f2 - f0) / (slope - k2)


def upper_end(p: Numbers, s: float, m: Numbers, foot: float) -> tuple[float, float]:
    """Return the branch and the mirrored deformation where an unloading line meets the path of a side."""
    ku = unloading(p)
    slope, f0 = pinched(p)
    onto_line, end = pinch_end(p, s, m)
    meets = (f0 + ku * foot) / (ku - slope)
    if meets <= end:
        return float(on_side(PINCHED, s)), meets
    if onto_line:
        _, k, f = reloading(p, s, m)
        # parallel only if the two lines coincide
        return float(on_side(RELOADING, s)), (f + ku * foot) / (ku - k) if ku > k * (1.0 + 1e-9) else meets
    _, _, _, _, (k2, f2) = backbone(p, s)
    return float(on_side(BEYOND, s)), (f2 + ku * foot) / (ku - k2)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: without force, along the backbone, between the paths of both sides, or on a
    pinched path.
    """
    k = p[K]
    if at == SLACK:
        return linear(0.0, 0.0, above(p[GAP_PLUS]), below(p[GAP_MINUS]))
    if at == FAILED:
        return linear(0.0, 0.0)
    if at == UNLOADING:
        ku = unloading(p)
        return linear(ku, -ku * m[FOOT], above(m[UPPER_END]), below(m[LOWER_END]))
    s = side(at)
    gap, dy, du, (k1, f1), (k2, f2) = backbone(p, s)
    if at < YIELDING:
        return linear(k, -s * k * gap, outward(s, dy), inward(s, gap))
    if at < BEYOND:
        return linear(k1, s * f1, turns_inward(s), outward(s, du))
    slope, f0 = pinched(p)
    if at < PINCHED:
        # failure at zero force or on the pinched line of the other side, slope d - f0
        no_force = (-s * k2, 0.0, -f2)
        meets = (s * (slope - k2), 0.0, -f0 - f2)
        return linear(k2, s * f2, turns_inward(s), no_force, meets)
    if at < RELOADING:
        return linear(slope, s * f0, turns_inward(s), outward(s, pinch_end(p, s, m)[1]))
    target, kp, f = reloading(p, s, m)
    return linear(kp, s * f, turns_inward(s), outward(s, target))


def unload(p: Numbers, at: int, m: Numbers, s: float, d: float, f: float) -> tuple[int, Numbers]:
    """Return the state after a reversal on a path of side `s` (branch `at`) at deformation `d`,
    force `f`.
    """
    foot = d - f / unloading(p)
    other, end = upper_end(p, -s, m, -s * foot)
    if s > 0.0:
        return UNLOADING, (m[MOST], m[MOST_MINUS], foot, float(at), d, other, -end)
    return UNLOADING, (m[MOST], m[MOST_MINUS], foot, other, end, float(at), d)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after an engagement, a yield, the ultimate force, a failure, a reversal, or a new
    line.
    """
    if at == SLACK:
        return (ELASTIC if event == 0 else ELASTIC + 1), m
    if at == UNLOADING:
        return (int(m[UPPER]) if event == 0 else int(m[LOWER])), m
    s = side(at)
    if at < YIELDING:
        back = SLACK if is_slack(p) else on_side(ELASTIC, -s)
        return (on_side(YIELDING, s) if event == 0 else back), m
    if at < PINCHED:
        if event == 0:
            gap, _, _, _, _ = backbone(p, s)
            most = s * d - gap
            if s > 0.0:
                m = (max(most, m[MOST]), m[MOST_MINUS], 0.0, 0.0, 0.0, 0.0, 0.0)
            else:
                m = (m[MOST], max(most, m[MOST_MINUS]), 0.0, 0.0, 0.0, 0.0, 0.0)
        elif at < BEYOND:
            return on_side(BEYOND, s), m
        else:
            return FAILED, m
    elif event == 1:
        if at < RELOADING:
            onto_line, _ = pinch_end(p, s, m)
            return on_side(RELOADING if onto_line else BEYOND, s), m
        (target, _, _), (_, _, du, _, _) = reloading(p, s, m), backbone(p, s)
        return on_side(YIELDING if target < du else BEYOND, s), m
    k, _, f0 = branch(p, at, m)[:3]
    return unload(p, at, m, s, d, k * d + f0)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered down to zero force: along an unloading line, and along the part of the
    pinched line of the other side where the force has the same sign.
    """
    if at < UNLOADING or f == 0.0:
        return 0.0
    if ELASTIC <= at < YIELDING:
        return 0.5 * f * f / p[K]
    s = -1.0 if f > 0.0 else 1.0
    ku = unloading(p)
    slope, f0 = pinched(p)
    if at == on_side(PINCHED, s):
        on_line = f
    else:
        on_line = s * min((f0 + slope * s * (d - f / ku)) / (1.0 - slope / ku), 0.0)
    along_line = 0.5 * on_line * on_line / slope if on_line != 0.0 else 0.0
    return 0.5 * (f * f - on_line * on_line) / ku + along_line


RULE = Rule(
    (
        *BranchKind.OPEN.named("slack", STRENGTHLESS),
        *BranchKind.ELASTIC.named("unloading", "elastic +", "elastic -"),
        *BranchKind.YIELDING.named(
            "yielding +",
            "yielding -",
            "yielding + beyond the ultimate force",
            "yielding - beyond the ultimate force",
        ),
        *BranchKind.ELASTIC.named("pinched +", "pinched -", "reloading +", "reloading -"),
    ),
    start,
    branch,
    transition,
    recoverable,
    steepest=steepest,
    first_yield=first_yield,
    parameters=14,
    variables=7,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    need_both_sides(fy_plus, fy_minus)
    fu, slack, r, fi = values["FU"], values["SLACK"], values["R"], values["FI"]
    fu_minus = fu[1] if len(fu) == 2 else -fu[0]
    gap_minus = slack[1] if len(slack) == 2 else -slack[0]
    if slack[0] < 0 or gap_minus > 0:
        raise ItemError("SLACK needs a positive value, then a negative one", "SLACK")
    if fu[0] < fy_plus or fu_minus > fy_minus:
        raise ItemError("FU must be at least the yield force: a positive value, then a negative one", "FU")
    if r == 0.0 and (fu[0], fu_minus) != (fy_plus, fy_minus):
        raise ItemError("without hardening (R=0) FU must be the yield force", "FU")
    pinch = r if values["RPINCH"] is None else values["RPINCH"]
    p = (
        *(k, fy_plus, fy_minus, r, fu[0], fu_minus, fi, values["PTRI"], slack[0], gap_minus),
        *(values["BETA"], values["ALPHA"], pinch, values["PUNL"]),
    )
    law = Law(RULE, p)
    slope, f0 = pinched(law.p)
    for s in (1.0, -1.0):
        _, dy, du, (k1, f1), _ = backbone(law.p, s)
        if any(slope * d + f0 >= k1 * d + f1 for d in (dy, du)):
            raise ValueError(
                "FI and RPINCH: the pinched line passes below the yield and the ultimate force"
            )
    return law


SPEC = Spec(
    "hysteresis",
    "WAYNE_STEWART",
    "pinched, softening and degrading: nailed timber",
    (
        Field(
            "R",
            Kind.REAL,
            "-",
            default=0.0,
            lo=0.0,
            below=1.0,
            doc="ratio of stiffness from yield to ultimate force to initial stiffness",
        ),
        Field(
            "FU",
            Kind.REAL,
            "F",
            count=(1, 2),
            doc="ultimate force, positive and (signed) negative; one value: both sides",
        ),
        Field("FI", Kind.REAL, "F", lo=0.0, doc="force at which the pinched lines cross zero deformation"),
        Field(
            "PTRI",
            Kind.REAL,
            "-",
            default=0.0,
            hi=0.0,
            doc="stiffness beyond the ultimate force / initial stiffness",
        ),
        Field(
            "PUNL",
            Kind.REAL,
            "-",
            default=1.0,
            lo=1.0,
            doc="unloading stiffness as a multiple of the initial",
        ),
        Field(
            "SLACK",
            Kind.REAL,
            "L",
            default=(0.0,),
            count=(1, 2),
            doc="deformation at which the spring first engages, positive and (signed) negative; one "
            "value: both sides",
        ),
        Field(
            "BETA",
            Kind.REAL,
            "-",
            default=1.0,
            lo=1.0,
            doc="softening: reloading aims at this multiple of the largest deformation",
        ),
        Field(
            "ALPHA",
            Kind.REAL,
            "-",
            default=0.0,
            lo=0.0,
            hi=1.0,
            doc="exponent of reloading stiffness; 0: initial stiffness",
        ),
        Field(
            "RPINCH",
            Kind.REAL,
            "-",
            default=None,
            lo=0.0,
            below=1.0,
            doc="stiffness of the pinched lines / initial stiffness; omitted: R",
        ),
    ),
    code=9,
    reference="Stewart 1987; Folz & Filiatrault 2001; Ruaumoko rule 9",
    sample="R=0.2 FU=1.6 FI=0.2 PTRI=-0.05 PUNL=1.4 BETA=1.1 ALPHA=0.4",
    impl=build,
)
