r"""Bilinear impact (Muthukumar 2003): a spring and a slider that dissipate energy by hysteresis.

On first loading, the force follows :math:`K_1` up to the overlap :math:`\delta_y`, then :math:`K_2`.  It
unloads along :math:`K_1` to the line :math:`f = K_2\delta`, and then along that line to zero:

.. math:: f = K_2\delta + (K_1 - K_2)(\delta - \delta_p), \qquad 0 \le \delta - \delta_p \le \delta_y

If the bodies are pressed together again before they separate, the force rises along :math:`K_1` to the
upper line.

The constants represent the Hertz force :math:`k_h\delta^n` at one maximum overlap :math:`\delta_m`, with
:math:`K = k_h\delta_m^{n-1}`, :math:`\delta_y = a\delta_m`:

.. math:: a K_1 + (1-a) K_2 = K

An impact that reaches :math:`\delta_m` has the energy :math:`W = \delta_m^2 (a K_1 + (1-a) K)/2` and loses
:math:`D = \delta_m^2 a (K_1 - K)`.  EXACT: :math:`D = (1-e^2) W`, so that with :math:`s = (1-e^2)/2`

.. math:: K_1 = K\,\frac{a + s(1-a)}{a(1-s)}, \qquad K_2 = \frac{K - a K_1}{1-a}

which needs :math:`e^2 > a/(2-a)`.  PUBLISHED: :math:`D = k_h\delta_m^{n+1}(1-e^2)/(n+1)`, the loss computed
from the energy of a Hertz contact; the restitution is then greater than :math:`e`.

The restitution depends on the approach speed.  It is 1 if :math:`\delta_y` is not exceeded, and has its
minimum, :math:`(K_2/K_1)^{1/4}`, at the overlap :math:`\delta_y(1 + \sqrt{K_1/K_2})`.

References
----------
Muthukumar S (2003), A contact element approach with hysteresis damping for the analysis and design of
pounding in bridges, PhD thesis, Georgia Institute of Technology; Nielson BG (2005), Analytical fragility
curves for highway bridges in moderate seismic zones, PhD thesis, ibid. (the constants, a = 0.1).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    GAP,
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.refusal import ItemError

OPEN, STIFF, SOFT, BACK = 0, 1, 2, 3
DY = 3  #: index of the overlap at which K2 begins, among the parameters (K1, K2, gap, this overlap)
SLIDER = 0  #: internal variable: position of the slider, delta_p


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: open, or pressed if the gap is negative (an initial overlap)."""
    return (STIFF if p[GAP] < 0.0 else OPEN), (0.0,)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    k1, k2, gap, dy = p[:4]
    if at == OPEN:
        return linear(0.0, 0.0, above(gap))
    if at == SOFT:
        return linear(k2, (k1 - k2) * dy - k2 * gap, REVERSAL_DOWN)
    if at == BACK:
        return linear(k2, -k2 * gap, REVERSAL_UP, below(gap))
    zero = gap + m[SLIDER]
    return linear(k1, -k1 * gap - (k1 - k2) * m[SLIDER], above(zero + dy), below(zero))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, a slip, a reversal or a separation."""
    dy, overlap = p[DY], d - p[GAP]
    if at == OPEN:
        return STIFF, (0.0,)
    if at == SOFT:
        return STIFF, (max(overlap - dy, 0.0),)
    if at == BACK:
        return (STIFF, (max(overlap, 0.0),)) if event == 0 else (OPEN, (0.0,))
    if event == 0:
        return SOFT, m
    return (BACK, m) if m[SLIDER] > 0.0 else (OPEN, (0.0,))


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the area below the unloading path."""
    _, k2, gap, dy = p[:4]
    if at == OPEN:
        return 0.0
    overlap = d - gap
    corner = overlap if at == BACK else overlap - dy if at == SOFT else m[SLIDER]
    return 0.5 * (k2 * corner * corner + (k2 * corner + f) * (overlap - corner))


RULE = Rule(
    (
        *BranchKind.OPEN.named("open"),
        *BranchKind.PRESSED.named("pressed", "pressed, soft", "pressed, back"),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=4,
    variables=1,
)


def restitution(k1: float, k2: float, dy: float, overlap: float) -> float:
    """Return the restitution [-] of an impact that reaches `overlap` [L]."""
    beyond = overlap - dy
    if beyond <= 0.0:
        return 1.0
    energy = 0.5 * k1 * dy**2 + (k1 * dy + 0.5 * k2 * beyond) * beyond
    return math.sqrt(1.0 - (k1 - k2) * dy * beyond / energy)


def speed(k1: float, k2: float, dy: float, overlap: float, mass: float) -> float:
    """Return the approach speed [L/T] at which a reduced mass reaches `overlap` [L], beyond dy."""
    beyond = overlap - dy
    energy = 0.5 * k1 * dy**2 + (k1 * dy + 0.5 * k2 * beyond) * beyond
    return math.sqrt(2.0 * energy / mass) if mass else math.inf


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values.

    Parameters
    ----------
    values : mapping
        GAP and K1, K2, DY, or KH, N, E, DM, A, RELATION.
    reduced_mass : float
        Of the colliding masses [F T^2/L], used only for the note; may be zero.

    Raises
    ------
    ValueError
        Neither or both of the sets are given, or the constants do not define a loop.
    """
    by_slopes = [name for name in ("K1", "K2", "DY") if values[name] is not None]
    by_e = [name for name in ("KH", "E", "DM") if values[name] is not None]
    if (len(by_slopes), len(by_e)) not in ((3, 0), (0, 3)):
        raise ValueError(
            "give either K1, K2 and DY, or KH, E and DM"
            + (f", not {', '.join(by_slopes + by_e)}" if by_slopes or by_e else "")
        )
    if by_slopes:
        k1, k2, dy = (values[name] for name in by_slopes)
        if k2 > k1:
            raise ItemError(f"K2 {k2:g} is above K1 {k1:g}: the second stiffness is the lower one", "K2")
        required = resulting = math.nan
        worst = dy * (1.0 + math.sqrt(k1 / k2))
        slow, at = (speed(k1, k2, dy, x, reduced_mass) for x in (dy, worst))
        note = f"e depends on the speed: 1 up to {slow:.4g}, least, {(k2 / k1) ** 0.25:.4g}, at {at:.4g}"
    else:
        k1, k2, dy = constants(values)
        required, resulting = values["E"], restitution(k1, k2, dy, values["DM"])
        at = speed(k1, k2, dy, values["DM"], reduced_mass)
        relation = values["RELATION"].lower()
        note = f"{relation} relation of E; e depends on the speed: as given at {at:.4g}, which reaches DM"
    law = Law(RULE, (k1, k2, values["GAP"], dy))
    return Built(law, k1, 0.0, 0.0, required, resulting, note)


def constants(values: Mapping[str, Any]) -> tuple[float, float, float]:
    """Return K1, K2 [F/L] and the overlap [L] at which K2 begins.

    Raises
    ------
    ValueError
        No constants give the required E.
    """
    e, dm, a, n = (values[name] for name in ("E", "DM", "A", "N"))
    k = values["KH"] * dm ** (n - 1.0)
    if values["RELATION"] == "PUBLISHED":
        loss = k * (1.0 - e * e) / (n + 1.0)  # divided by DM^2
        least = math.sqrt(max(1.0 - (n + 1.0) * (1.0 - a), 0.0))
        k1, k2 = k + loss / a, k - loss / (1.0 - a)
    else:
        s = 0.5 * (1.0 - e * e)
        least = math.sqrt(a / (2.0 - a))
        k1 = k * (a + s * (1.0 - a)) / (a * (1.0 - s))
        k2 = (k - a * k1) / (1.0 - a)
    if k2 <= 0.0:
        raise ItemError(
            f"E {e:g} is out of reach: K2 would not be positive; with A {a:g} E must be above {least:.4g}, "
            "a smaller A reaches lower",
            "E",
        )
    return k1, k2, a * dm


SPEC = Spec(
    "contact",
    "BILINEAR_IMPACT",
    "two stiffnesses with a dissipative loop",
    (
        Field("K1", Kind.REAL, "F/L", default=None, above=0, doc="first stiffness (with K2 and DY)"),
        Field("K2", Kind.REAL, "F/L", default=None, above=0, doc="second stiffness (with K1 and DY)"),
        Field("DY", Kind.REAL, "L", default=None, above=0, doc="overlap where K2 begins (with K1 and K2)"),
        Field("KH", Kind.REAL, "F/L^N", default=None, above=0, doc="Hertz stiffness (with E and DM)"),
        Field("N", Kind.REAL, "-", default=1.5, lo=1, doc="Hertz exponent"),
        Field(
            "E", Kind.REAL, "-", default=None, above=0, hi=1, doc="restitution of an impact that reaches DM"
        ),
        Field("DM", Kind.REAL, "L", default=None, above=0, doc="largest expected overlap"),
        Field("A", Kind.REAL, "-", default=0.1, above=0, below=1, doc="ratio DY / DM"),
        Field(
            "RELATION",
            Kind.WORD,
            default="EXACT",
            words=("EXACT", "PUBLISHED"),
            doc="how E gives K1 and K2: exact at DM, or by the energy loss of a Hertz contact",
        ),
    ),
    reference="Muthukumar 2003; Nielson 2005",
    sample="KH=1 N=1 E=0.6 DM=2",
    impl=build,
)
