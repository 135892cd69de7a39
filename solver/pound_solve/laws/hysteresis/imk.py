r"""Backbone and cyclic deterioration common to the three rules of Ibarra, Medina & Krawinkler.

The *backbone* of the positive side (the negative side is a mirror image with separate values) is

.. math:: B(d) = \max\bigl(\lambda F_{y0},\ \min(F_y + \alpha_s k\,(d - F_y/k),\ F_{ref} + k_c d)\bigr)

It hardens up to the *cap* at :math:`F_y/k + \theta_p`, then softens towards zero at :math:`\theta_{pc}`
beyond the cap (:math:`k_c` does not change), down to the residual strength :math:`\lambda F_{y0}`.

An *excursion* lasts from one zero of the force to the next.  The energy :math:`E_i` dissipated in the i-th
excursion deteriorates the component by

.. math:: \beta_i = \Bigl(\frac{E_i}{E_t - \sum_{j \le i} E_j}\Bigr)^c, \qquad E_t = \Lambda F_{y0}

with a separate :math:`\Lambda` for each mode of deterioration, and the mean :math:`F_{y0}` of both sides:

* basic strength: :math:`F_y` and :math:`\alpha_s` of the side that is entered next are multiplied by
  :math:`1 - \beta_s` (:math:`F_y` stays at or above the residual strength);
* post-capping strength: :math:`F_{ref}` of that side is multiplied by :math:`1 - \beta_c`;
* accelerated reloading: the target deformation of reloading is multiplied by :math:`1 + \beta_a`;
* unloading stiffness: :math:`k_u` is multiplied by :math:`1 - \beta_k` when a motion reverses on a loading
  path, with :math:`E_i` reduced by the energy that will be recovered.

If this gives no :math:`\beta < 1`, the energy capacity is exhausted and the component fails at the end of
the excursion.  It fails immediately at the ultimate deformation :math:`\theta_u`, and where no strength
remains.

References
----------
Ibarra LF, Medina RA, Krawinkler H (2005), Hysteretic models that incorporate strength and stiffness
deterioration, Earthquake Engng Struct. Dyn. 34(12): 1489-1511.
Lignos DG, Krawinkler H (2011), Deterioration modeling of steel components in support of collapse prediction
of steel moment frames under earthquake loading, J. Struct. Eng. 137(11): 1291-1302 (Lambda, the ultimate
rotation; theta_p and theta_pc).
Our choices: an excursion deteriorates :math:`k_u` only once, regardless of its number of reversals, and by
at most a half; only :math:`\Lambda = 0` switches a mode off.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind
from pound_solve.laws.automaton import FY, FY_MINUS, STRENGTHLESS, BranchKind, K, Numbers
from pound_solve.laws.mirror import need_both_sides
from pound_solve.laws.refusal import ItemError

FAILED = 0
#: first branch of all three rules; those of a rule follow in pairs: positive side, negative side
BRANCHES = BranchKind.OPEN.named(STRENGTHLESS)

# parameters of a law after K, FY, FY_MINUS: alpha_s; theta_p and theta_pc of both sides; lambda; theta_u of
# both sides (0: none); energy capacities E_t for basic strength, post-capping strength, unloading stiffness
# and reloading; exponent c
R, THETA_P, THETA_P_MINUS, THETA_PC, THETA_PC_MINUS, LAMBDA, THETA_U, THETA_U_MINUS = range(3, 11)
ET_STRENGTH, ET_CAP, ET_UNLOADING, ET_RELOADING, C = range(11, 16)
PARAMETERS = 16  #: number of these parameters; a rule's own parameters follow

# internal variables: SIDE numbers of each side, then the unloading stiffness now and at the start of the
# excursion, where it started, the energy of the finished excursions, and of the present one up to the
# present branch, and where that was entered
KU, KU_BEFORE, FOOT, DONE, SPENT, ENTERED = range(10, 16)
FY_NOW, F_REF = 0, 1  #: first variables of a side, mirrored: F_y and F_ref; the others belong to the rule
SIDE = 5


def variables_of_side(m: Numbers, s: float) -> Numbers:
    """Return the internal variables of a side."""
    return m[:SIDE] if s > 0.0 else m[SIDE:KU]


def replace_side(m: Numbers, s: float, of_side: Numbers) -> Numbers:
    """Return the internal variables with those of side `s` replaced."""
    return of_side + m[SIDE:] if s > 0.0 else m[:SIDE] + of_side + m[KU:]


def virgin(p: Numbers, s: float) -> tuple[float, float, float, float]:
    """Return the initial yield force, capping force and F_ref of a side, and the slope of the softening
    branch.
    """
    k, r = p[K], p[R]
    if s > 0.0:
        fy, theta_p, theta_pc = p[FY], p[THETA_P], p[THETA_PC]
    else:
        fy, theta_p, theta_pc = -p[FY_MINUS], p[THETA_P_MINUS], p[THETA_PC_MINUS]
    cap = fy + r * k * theta_p
    return fy, cap, cap + cap / theta_pc * (fy / k + theta_p), -cap / theta_pc


def ultimate(p: Numbers, s: float) -> float:
    """Return the ultimate deformation of a side."""
    return p[THETA_U] if s > 0.0 else p[THETA_U_MINUS]


def residual(p: Numbers, s: float) -> float:
    """Return the residual strength of a side."""
    fy0, _, _, _ = virgin(p, s)
    return p[LAMBDA] * fy0


def hardening(p: Numbers, s: float, m: Numbers) -> tuple[float, float]:
    """Return the slope and force at zero deformation of the hardening line."""
    fy0, _, _, _ = virgin(p, s)
    fy = variables_of_side(m, s)[FY_NOW]
    slope = p[R] * p[K] * fy / fy0
    return slope, fy - slope * fy / p[K]


def falling(p: Numbers, s: float, m: Numbers) -> tuple[float, float]:
    """Return the slope and force at zero deformation of the falling line."""
    _, _, _, kc = virgin(p, s)
    return kc, variables_of_side(m, s)[F_REF]


def deterioration(energy: float, before: float, capacity: float, c: float) -> float:
    """Return the deterioration parameter beta of an excursion: 1 if the energy capacity is exhausted, 0 if
    the mode is off.
    """
    remaining = capacity - before - energy
    if capacity == 0.0 or energy <= 0.0:
        return 0.0
    return 1.0 if remaining <= energy else (energy / remaining) ** c


def add_work(line: Numbers, m: Numbers, d: float) -> Numbers:
    """Return the internal variables after adding the work done on a branch up to `d`."""
    (k, _, f0), d0 = line[:3], m[ENTERED]
    return (*m[:SPENT], m[SPENT] + (0.5 * k * (d + d0) + f0) * (d - d0), d)


def softened(p: Numbers, m: Numbers, f: float) -> float:
    """Return the deteriorated unloading stiffness of a motion that reverses at the force `f`."""
    before = m[KU_BEFORE]
    energy = m[SPENT] - 0.5 * f * f / before
    return before * (1.0 - min(deterioration(energy, m[DONE], p[ET_UNLOADING], p[C]), 0.5))


def end_excursion(p: Numbers, m: Numbers, s: float, d: float) -> tuple[Numbers, float, bool]:
    """End an excursion at `d`, and deteriorate side `s`, which is loaded next.

    Returns
    -------
    internal variables, beta of the reloading, whether the component fails
    """
    energy, before, c = max(m[SPENT], 0.0), m[DONE], p[C]
    strength = deterioration(energy, before, p[ET_STRENGTH], c)
    cap = deterioration(energy, before, p[ET_CAP], c)
    stiffness = deterioration(energy, before, p[ET_UNLOADING], c)
    reloading = deterioration(energy, before, p[ET_RELOADING], c)
    of_side = variables_of_side(m, s)
    fy = max(of_side[FY_NOW] * (1.0 - strength), residual(p, s))
    m = replace_side(m, s, (fy, of_side[F_REF] * (1.0 - cap), *of_side[2:]))
    m = (*m[:KU_BEFORE], m[KU], d, before + energy, 0.0, d)
    return m, reloading, max(max(strength, cap), max(stiffness, reloading)) >= 1.0


def recoverable_energy(p: Numbers, m: Numbers, line: Numbers, loading: bool, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    ku = softened(p, add_work(line, m, d), f) if loading else m[KU]
    return 0.5 * f * f / ku


def parameters(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Numbers:
    """Return the common parameters of the three rules from a card's values.

    Raises
    ------
    ValueError
        A yield force is zero, or the ultimate deformation is not beyond yield.
    """
    need_both_sides(fy_plus, fy_minus)
    both = [values[name] for name in ("DP", "DPC", "DU")]
    dp, dpc, du = ((x[0], x[-1]) if x else (0.0, 0.0) for x in both)
    if values["DU"] and not (du[0] > fy_plus / k and du[1] > -fy_minus / k):
        raise ItemError("the ultimate deformation DU is beyond the yield deformation", "DU")
    mean = 0.5 * (fy_plus - fy_minus)
    modes = values["LAMBDA"]
    modes = modes * 4 if len(modes) == 1 else modes + (0.0,) * (4 - len(modes))
    capacities = tuple(x * mean for x in modes)
    return (k, fy_plus, fy_minus, values["R"], *dp, *dpc, values["RESIDUAL"], *du, *capacities, values["C"])


#: backbone of both sides
BACKBONE = (
    Field(
        "R", Kind.REAL, "-", default=0.0, lo=0.0, below=1.0, doc="ratio of hardening to initial stiffness"
    ),
    Field(
        "DP",
        Kind.REAL,
        "L",
        above=0.0,
        count=(1, 2),
        doc="plastic deformation from yield to the cap (theta_p), positive and negative side; one value: "
        "both",
    ),
    Field(
        "DPC",
        Kind.REAL,
        "L",
        above=0.0,
        count=(1, 2),
        doc="deformation from the cap to zero strength (theta_pc), likewise",
    ),
    Field(
        "RESIDUAL",
        Kind.REAL,
        "-",
        default=0.0,
        lo=0.0,
        below=1.0,
        doc="ratio of residual strength to yield force",
    ),
    Field(
        "DU",
        Kind.REAL,
        "L",
        default=None,
        above=0.0,
        count=(1, 2),
        doc="ultimate deformation, at which all strength is lost, likewise; omitted: none",
    ),
)


def fields(modes: str, most: int) -> tuple[Field, ...]:
    """Return the fields of a card: the backbone, and the energy capacities of at most `most` of the
    `modes`.
    """
    return (
        *BACKBONE,
        Field(
            "LAMBDA",
            Kind.REAL,
            "L",
            default=(0.0,),
            lo=0.0,
            count=(1, most),
            doc=f"energy capacity as a multiple of the yield force, for {modes}; "
            "one value: for all; 0: no such deterioration",
        ),
        Field(
            "C",
            Kind.REAL,
            "-",
            default=1.0,
            lo=1.0,
            hi=2.0,
            doc="exponent of the deterioration, 1 (steady) to 2",
        ),
    )
