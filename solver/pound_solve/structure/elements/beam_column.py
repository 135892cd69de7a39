r"""BEAM_COLUMN: beam-column whose ends yield under axial force and moment together.

A hinge is a row of axial springs across the section.  Springs side by side at distances :math:`y_i` from
the axis, each of which yields at :math:`\pm F_i`, carry :math:`N = \sum f_i` and
:math:`M = -\sum f_i y_i`; their capacity is the sum of the segments :math:`\pm F_i (1, -y_i)`, a
convex polygon that is symmetric about its centre, and every such polygon is a sum of segments.
An N-M diagram therefore defines its springs, edge by edge:

.. math:: y_i = -\Delta M_i / \Delta N_i, \qquad F_i = |\Delta N_i| / 4

(each of two parallel edges gives a half; an edge so steep that its spring would lie outside any section
becomes a spring that responds more to bending than to stretching).  Plastic flow follows from the springs
and is normal to the diagram.  A diagram P that is not symmetric becomes :math:`(P - P)/2` about the centre
of its extremes, which keeps its width in every direction, and with it the strengths in pure force and pure
moment. The centre is off the origin where the section resists compression better than tension: the springs'
yield forces are then :math:`(s_i \pm 1) F_i` with :math:`s_i = \alpha + \beta y_i`.

The stiffness of the springs is proportional to their strength, and together they are as stiff in bending as
a length LP of the beam.  Their flexibility is subtracted from the beam between the hinges, so that the
elastic member is exactly that of E, A, I. For long hinges only a share is subtracted, as in `frame`, and
each spring excludes the rest.

References
----------
Ziegler GM (1995), Lectures on Polytopes, Springer, lecture 7 (sums of segments);
Lai S-S, Will GT, Otani S (1984), Model for inelastic biaxial bending of concrete members, J. Struct. Engng
ASCE 110(11): 2563-2584 (springs across a section);
AISC (1978), Specification for the Design, Fabrication and Erection of Structural Steel for Buildings,
part 2: M = 1.18 Mp (1 - P/Py) for I-sections about the strong axis, here straight from (0.15 Py, Mp) to Py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.numerics.types import Array
from pound_solve.structure.elements import beam
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementParts,
    hysteretic,
    signed,
)
from pound_solve.structure.elements.beam import pair

OUTMOST = 2.0  #: largest distance of a spring from the axis, in levers (largest moment over axial force)
KNEE = 0.15  #: fraction of the axial strength of a steel section up to which the moment is not reduced


class HingeSprings(NamedTuple):
    """Springs of a hinge.

    Attributes
    ----------
    direction : ndarray, shape (n, 2)
        Deformation of each spring per unit stretch and unit bend [-, L].
    strength : ndarray, shape (n,)
        F [F].
    shift : ndarray, shape (n,)
        s: it yields at ``(s + 1) F`` and ``(s - 1) F``.
    skew : float
        Largest distance of their diagram from the one given, as a share of its half width.
    """

    direction: Array
    strength: Array
    shift: Array
    skew: float


def diagram(p: Card) -> Array:
    """Corners (N, M) of the card's diagram, anticlockwise, shape (n, 2).

    Raises
    ------
    ElementError
        None or two diagrams are given, or it is not convex about the unloaded section.
    """
    if (p["NM"] is None) == (p["PY"] is None):
        raise ElementError("give the strength as NM, or as PY and MP of a steel section", "NM")
    if p["NM"] is None:
        if p["MP"] is None:
            raise ElementError("PY needs MP, the plastic moment", "PY")
        (plus, minus), m = signed(p["PY"], "PY"), p["MP"]
        corners = np.array([[plus, 0.0], [KNEE * plus, m], [KNEE * minus, m], [minus, 0.0]])
    else:
        if p["MP"] is not None:
            raise ElementError("MP goes with PY; NM holds all moments itself", "MP")
        if len(p["NM"]) % 2:
            raise ElementError("NM takes pairs: axial force, moment, axial force, moment, ...", "NM")
        corners = np.array(p["NM"]).reshape(-1, 2)
    if not (corners[:, 1] < 0.0).any():  # the other side is the mirror image
        mirrored = [[n, -m] for n, m in corners[::-1] if m > 0.0]
        corners = np.vstack([corners, np.array(mirrored).reshape(-1, 2)])
    following = np.roll(corners, -1, axis=0)
    if (corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]).sum() < 0.0:
        corners = corners[::-1]
    size = np.ptp(corners, axis=0)
    if not size.all():
        raise ElementError("the diagram has no area", "NM")
    edges = np.roll(corners, -1, axis=0) - corners
    a = edges[:, 0] / size[0] + 1j * edges[:, 1] / size[1]
    turns = np.angle(np.roll(a, -1) / a)
    if turns.min() < -1e-9 or turns.sum() > 7.0:
        raise ElementError("NM goes once around a convex diagram, corner by corner", "NM")
    if (edges[:, 1] * corners[:, 0] - edges[:, 0] * corners[:, 1]).min() <= 1e-9 * size.prod():
        raise ElementError("the diagram does not hold the unloaded section, N = 0 and M = 0, inside", "NM")
    return corners


def springs(corners: Array) -> HingeSprings:
    """Springs whose diagram is the given one, made symmetric about its centre.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        (N, M) [F, F L], convex, anticlockwise.

    Raises
    ------
    ElementError
        The centre is too far from the unloaded section.
    """
    half = np.ptp(corners, axis=0) / 2
    centre, lever = corners.min(axis=0) + half, half[1] / half[0]
    by_angle: dict[float, tuple[Array, float]] = {}  # parallel edges share one spring
    for edge in np.roll(corners, -1, axis=0) - corners:
        reach = max(abs(edge[0]), abs(edge[1]) / (OUTMOST * lever)) * (-1 if tuple(edge) < (0, 0) else 1)
        d, f = edge / reach, abs(reach) / 4
        key = round(float(np.arctan2(d[1], d[0] * lever)), 9)
        by_angle[key] = (d, by_angle[key][1] + f) if key in by_angle else (d, f)
    direction = np.array([d for d, _ in by_angle.values()])
    strength = np.array([f for _, f in by_angle.values()])
    shift = direction @ np.linalg.solve((direction.T * strength) @ direction, centre)
    if np.abs(shift).max() > 0.999:
        raise ElementError(
            "the unloaded section, N = 0 and M = 0, is too near to the edge of the diagram "
            f"made symmetric about N = {centre[0]:.4g}, M = {centre[1]:.4g}",
            "NM",
        )
    # distance between the two diagrams as convex sets, in half widths (to a few parts in a thousand)
    angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    normals = np.array([np.cos(angle), np.sin(angle)])
    wanted = ((corners - centre) / half @ normals).max(axis=0)
    made = np.abs(strength[:, None] * direction / half @ normals).sum(axis=0)
    return HingeSprings(direction, strength, shift, float(np.abs(wanted - made).max()))


def capacity(hinge: HingeSprings) -> Array:
    """Corners (N, M) of what the springs of a hinge carry together, anticlockwise, shape (2 n, 2) [F, F L]:
    edge by edge from the lowest moment on.
    """
    edges = 2.0 * hinge.strength[:, None] * hinge.direction
    upwards = (edges[:, 1] > 0.0) | ((edges[:, 1] == 0.0) & (edges[:, 0] > 0.0))
    edges = np.where(upwards[:, None], edges, -edges)
    edges = edges[np.argsort(np.arctan2(edges[:, 1], edges[:, 0]), kind="stable")]
    lowest = (hinge.shift * hinge.strength) @ hinge.direction - 0.5 * edges.sum(axis=0)
    corners: Array = lowest + np.cumsum(np.vstack([edges, -edges]), axis=0)
    return corners


def build(context: ElementContext) -> ElementParts:
    """Build the beam and the springs of its hinges."""
    p = context.prop
    (rule,) = p.laws["RULE"]
    if rule.impl is None:
        raise ElementError("an elastic beam-column is a FRAME; here RULE yields", "RULE")
    if p["I"] == 0.0:
        raise ElementError("a BEAM_COLUMN needs I; a bar that yields is a SPRING or a TENDON", "I")
    made = springs(diagram(p))
    if made.skew > p["SKEW"]:
        raise ElementError(
            f"the diagram is {100 * made.skew:.3g} % of its half width away from one that is symmetric "
            "about its centre, which the springs need; "
            f"SKEW={np.ceil(100 * made.skew) / 100:.2g} would accept that",
            "NM",
        )
    whole = (made.direction.T * made.strength) @ made.direction
    flexibility = np.linalg.inv(whole)
    ei, taken = p["E"] * p["I"], np.zeros((6, 6))
    ends = []
    for name, axial, bend, length in zip("IJ", (0, 3), (2, 5), pair(p["LP"])):
        if bend not in beam.pinned(p) and p["HINGES"] in (name, "BOTH"):
            scale = flexibility[1, 1] * ei / length
            taken[np.ix_([axial, bend], [axial, bend])] = flexibility / scale
            ends.append((name, axial, bend, scale))
    if not ends:
        raise ElementError("no end is left that yields: the one of HINGES is pinned", "HINGES")
    member = beam.build(context, tuple(d for _, axial, bend, _ in ends for d in (axial, bend)), taken)
    for name, axial, bend, scale in ends:
        rows = made.direction @ member.opening[[axial, bend]]
        for n, (row, f, s) in enumerate(zip(rows, made.strength.tolist(), made.shift.tolist()), 1):
            at = dict(zip(member.dofs, row))
            strength = (f * (s + 1.0), f * (s - 1.0))
            member.parts.laws.append(
                hysteretic(
                    *(context.element.id, f"hinge {name} {n}", "F", at, p, rule, scale * f, strength),
                    share=member.share,
                )
            )
    return member.parts


SPEC = Spec(
    "element",
    "BEAM_COLUMN",
    "beam-column with axial force-moment interaction",
    (
        *beam.FIELDS,
        Field(
            "PY",
            Kind.REAL,
            "F",
            default=None,
            count=(1, 2),
            doc="axial strength of a steel section, tension and (signed) compression",
        ),
        Field("MP", Kind.REAL, "F*L", default=None, above=0, doc="plastic moment of a steel section"),
        Field(
            "NM",
            Kind.REAL,
            "",
            default=None,
            count=(6, 80),
            doc="corners N,M,N,M,... of any other section's diagram, tension and sagging positive; "
            "without hogging corners the hogging side mirrors them",
        ),
        Field(
            "SKEW",
            Kind.REAL,
            "-",
            default=0.1,
            lo=0,
            doc="allowed asymmetry of the diagram about its centre, as a fraction of its half width",
        ),
        Field(
            "LP",
            Kind.REAL,
            "L",
            above=0,
            count=(1, 2),
            doc="length of the hinges at I and J; one value: both",
        ),
        Field(
            "HINGES",
            Kind.WORD,
            default="BOTH",
            words=("BOTH", "I", "J"),
            doc="ends that can yield; pinned ends do not",
        ),
        Field(
            "RULE",
            Kind.FAMILY,
            default="ELASTO_PLASTIC",
            family="hysteresis",
            doc="hysteresis rule of the springs",
        ),
    ),
    reference="Lai, Will & Otani 1984; steel: AISC 1978",
    impl=build,
)
