r"""FRAME: beam-column between two nodes, elastic or with hinges at its ends.

The one-component member: an elastic beam (`beam`) in series with a rotational spring at either end of its
flexible length, which follows a hysteresis rule. The hinge has its own stiffness KH (moment over rotation),
or a length LP over which the section of the beam yields (moment over curvature): its stiffness is then
:math:`EI/L_p`, and its flexibility :math:`L_p/EI` is subtracted from the beam, so that the elastic member
is exactly that of EI. From a slender beam the flexibility of :math:`L_p = L/4` can be subtracted at
one end, or of :math:`L_p = L/6` at both.  Flexibility beyond nine tenths of that stays with the beam: the
rotation of the hinge is then that of its length less this elastic part.  A hinge is at most as long as the
member.

Moments and rotations of hinges are positive where the member sags: tension on the right of the line from
I to J.  Only the hinges with a strength are built.

References
----------
Giberson MF (1967), The response of nonlinear multi-story structures subjected to earthquake excitation,
Earthquake Engineering Research Laboratory, California Institute of Technology, Pasadena.
"""

from __future__ import annotations

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.elements import beam
from pound_solve.structure.elements.base import (
    DAMAGE,
    ElementContext,
    ElementError,
    ElementParts,
    hysteretic,
    signed,
)
from pound_solve.structure.elements.beam import pair

ENDS = ((2, "I", "MI"), (5, "J", "MJ"))  #: local DOF, name and strength of the hinges


def build(context: ElementContext) -> ElementParts:
    """Build the beam and the hinges that have a strength."""
    p = context.prop
    (rule,) = p.laws["RULE"]
    ends = [end for end in ENDS if p[end[2]] is not None]
    _consistent(context, [item for _, _, item in ends])
    if not ends:
        return beam.build(context).parts
    ei = p["E"] * p["I"]
    if p["KH"] is not None:
        stiffness, taken = dict(zip((2, 5), pair(p["KH"]))), None
    else:
        lengths = dict(zip((2, 5), pair(p["LP"])))
        stiffness, taken = {d: ei / lengths[d] for d in lengths}, np.zeros((6, 6))
        for d, _, _ in ends:
            taken[d, d] = lengths[d] / ei
    member = beam.build(context, tuple(d for d, _, _ in ends), taken)
    for d, end, item in ends:
        row, strength = dict(zip(member.dofs, member.opening[d])), signed(p[item], item)
        member.parts.laws.append(
            hysteretic(
                *(context.element.id, f"hinge {end}", "F*L", row, p, rule, stiffness[d], strength),
                share=member.share,
            )
        )
    return member.parts


def _consistent(context: ElementContext, strengths: list[str]) -> None:
    """Raise ElementError if the items of hinges contradict each other."""
    p = context.prop
    stiffness_items = [item for item in ("KH", "LP") if p[item] is not None]
    companions = [*stiffness_items, *(["DUCTU"] if p["DUCTU"] is not None else [])]
    (rule,) = p.laws["RULE"]
    if not strengths:
        if rule.impl is not None:
            raise ElementError(f"{rule.name} needs a yield moment: MI, MJ or both", "RULE")
        if companions:
            item = companions[0]
            raise ElementError(f"{item} has no effect without a yield moment MI or MJ", item)
        return
    first = strengths[0]
    if rule.impl is None:
        raise ElementError(f"{first} has no effect with RULE=ELASTIC: name a rule that yields", first)
    if not stiffness_items:
        what = "a hinge needs its stiffness KH or its length LP, often half the depth of the section"
        raise ElementError(what, first)
    if len(stiffness_items) > 1:
        raise ElementError("KH and LP both give the stiffness of a hinge: keep one of them", "LP")
    _not_pinned(context, strengths, companions)
    wrong = [item for item in strengths if len(p[item]) == 2 and not p[item][0] >= 0.0 >= p[item][1]]
    if len(wrong) > 1:
        raise ElementError("MI and MJ need a positive value, then a negative one: MI=200,-150", wrong[0])


def _not_pinned(context: ElementContext, strengths: list[str], companions: list[str]) -> None:
    """Raise ElementError if a pinned end has a yield moment, or if no hinge uses the `companions`."""
    p = context.prop
    pinned = [(end, item) for d, end, item in ENDS if item in strengths and d in beam.pinned(p)]
    if not pinned:
        return
    ends = " and ".join(end for end, _ in pinned)
    items = [item for _, item in pinned]
    if len(items) == len(strengths):
        items += ["RULE", *companions]
    many = len(pinned) > 1
    why = f"end{'s' * many} {ends} {'are' if many else 'is'} pinned, where no hinge yields"
    if p["I"] == 0.0:
        why = "I=0 is a bar without bending"
    raise ElementError(f"{why}: leave out {', '.join(items)}", items[0])


SPEC = Spec(
    "element",
    "FRAME",
    "beam-column, elastic or with hinges",
    (
        *beam.FIELDS,
        Field(
            "RULE", Kind.FAMILY, default="ELASTIC", family="hysteresis", doc="hysteresis rule of the hinges"
        ),
        Field(
            "MI",
            Kind.REAL,
            "F*L",
            default=None,
            count=(1, 2),
            doc="yield moment of the hinge at I, sagging and (signed) hogging; omitted: no hinge",
        ),
        Field("MJ", Kind.REAL, "F*L", default=None, count=(1, 2), doc="yield moment of the hinge at J"),
        Field(
            "KH",
            Kind.REAL,
            "F*L",
            default=None,
            above=0,
            count=(1, 2),
            doc="stiffness of the hinges at I and J, in series with the beam; one value: both",
        ),
        Field(
            "LP",
            Kind.REAL,
            "L",
            default=None,
            above=0,
            count=(1, 2),
            doc="length of the hinges at I and J within the beam, in place of KH; one value: both",
        ),
        *DAMAGE,
    ),
    reference="Przemieniecki 1968; Giberson 1967",
    impl=build,
)
