"""The two diaphragms of a contact, given on its card or found behind its nodes.

The search starts at a contact's node and follows stiff members straight away from the contact to the far
end.  The nodal masses add up; the stiffnesses act in series.  A node without such a member is a rigid
diaphragm.  So is a chain that is fixed at its far end, because the theory covers reflection at a free end
only.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pound_solve.laws.two_bars import Diaphragm, Pair
from pound_solve.structure.elements.base import LawSpring, axes
from pound_solve.structure.mass import mass_along
from pound_solve.structure.structure import Structure

GOOD_ENOUGH = 0.05  #: error of the changes of velocity up to which lumped mass is accepted
STRAIGHT = 1e-6  #: sine of the angle by which a member may miss the contact's direction


@dataclass(frozen=True)
class DiaphragmCollision:
    """The two diaphragms of a contact.

    Attributes
    ----------
    sides : tuple of Diaphragm
        Behind I and J.
    pair : Pair or None
        The theory; None if a mass is zero, or rigid without being specified as such on the card.
    lumped_error : float
        Error of the changes of velocity with lumped masses [-].
    note : str
    """

    sides: tuple[Diaphragm, Diaphragm]
    pair: Pair | None
    lumped_error: float
    note: str

    def plateau(self, impulse: float, peak: float, duration: float) -> float:
        """Return the mean force of a collision, which averages its oscillation; at most the `peak` [F].

        The mean is the impulse over the duration.  The duration is at most the time in which the first
        force of the theory produces its impulse: this excludes the weak second phase of a stepwise
        decreasing force and the tail of a coarse mesh.
        """
        if not duration > 0.0:
            return math.nan
        if self.pair is None or self.pushing(impulse, peak):
            return impulse / duration
        return min(peak, impulse / min(duration, self.pair.impulse / self.pair.force))

    def predicted(self, approach: float, impulse: float, peak: float) -> float:
        """Return the first force of the theory at an approach speed [F]; NaN if it does not apply."""
        return math.nan if self.pair is None or self.pushing(impulse, peak) else self.pair.force * approach

    def pushing(self, impulse: float, peak: float) -> bool:
        """Whether a contact gives more than twice the impulse that a collision of waves with its peak force
        would give.  The limit is continuous where the impedances of the bars become equal; the time of
        contact is not.
        """
        return self.pair is not None and impulse > 2.0 * peak * self.pair.impulse / self.pair.force


def sides(
    structure: Structure, members: Mapping[int, Sequence[int]], spring: LawSpring
) -> tuple[Diaphragm, Diaphragm]:
    """Return the diaphragms on the sides of I and J of a contact; a wall or a fixed node has infinite mass.

    `members` are the numbers of the elements at each node.
    """
    element = structure.model.elements[spring.element]
    stiffness = structure.model.props[element.prop]["DIAPHRAGMS"]
    first, second = map(Diaphragm, spring.facts["masses"])
    if stiffness is not None:
        return Diaphragm(first.mass, stiffness[0]), Diaphragm(second.mass, (*stiffness, math.inf)[1])
    (nx, ny), _ = axes(spring.facts["angle"])
    first = _behind(structure, members, element.i, (-nx, -ny)) or first
    if element.j is not None:
        second = _behind(structure, members, element.j, (nx, ny)) or second
    return first, second


def diaphragm_collisions(structure: Structure) -> dict[int, DiaphragmCollision]:
    """Return the two diaphragms of every contact, keyed by the number of its law."""
    members: dict[int, list[int]] = {}
    for e in structure.model.elements.values():
        if e.j is not None:
            members.setdefault(e.i, []).append(e.id)
            members.setdefault(e.j, []).append(e.id)
    return {
        i: _diaphragm_collision(structure, members, s)
        for i, s in enumerate(structure.laws)
        if s.role.collides
    }


def _diaphragm_collision(
    structure: Structure, members: Mapping[int, Sequence[int]], spring: LawSpring
) -> DiaphragmCollision:
    """Both sides of a contact, and their theory."""
    first, second = both = sides(structure, members, spring)
    if 0.0 in (first.mass, second.mass):
        return DiaphragmCollision(both, None, math.nan, "no theory: a diaphragm has no mass")
    prop = structure.model.props[structure.model.elements[spring.element].prop]
    known = prop["DIAPHRAGMS"] is not None
    rigid = [n for n, d in zip("IJ", both) if math.isinf(d.stiffness) and not math.isinf(d.mass)]
    if rigid and not known:
        # a mass at a column is not a floor: its supports matter, and the theory omits them
        who = " and ".join(rigid)
        what = f"no theory: {who} rigid, no member behind; DIAPHRAGMS under PROPS gives a stiffness"
        return DiaphragmCollision(both, None, math.nan, what)
    pair = Pair(first, second)
    plasticity = prop["R"] if spring.rule == "EQUIVALENT" else 1.0
    lumped = known and math.isfinite(spring.facts["e_given"])
    e = spring.facts["e_given"] if lumped else 1.0
    error = (1.0 + e) / (1.0 + plasticity * pair.e) - 1.0
    notes = [] if pair.paper_holds else ["Z of the shorter period is the larger: Eqs 7, 8, 14-17 fail"]
    notes.append(_verdict(lumped, error))
    return DiaphragmCollision(both, pair, error, "; ".join(notes))


def _verdict(lumped: bool, error: float) -> str:
    """Return a text on whether lumped mass is adequate."""
    rule = f"(rule: up to {100 * GOOD_ENOUGH:g} %)"
    if abs(error) <= GOOD_ENOUGH:
        return f"lumped mass is good enough {rule}"
    if lumped:
        return f"this lumped contact is not good enough {rule}: take LAW=EQUIVALENT or distributed mass"
    return f"lumped elastic mass would not be good enough {rule}"


def _behind(
    structure: Structure, members: Mapping[int, Sequence[int]], node: int, direction: tuple[float, float]
) -> Diaphragm | None:
    """Return the chain of members that extends from a node along a direction; None for a rigid one."""
    nodes = structure.model.nodes
    mass = flexibility = 0.0
    while True:
        nodal = mass_along(structure.model, structure.nodal_mass, node, direction)
        if math.isinf(nodal):
            return None
        mass += nodal
        stiffness = _straight_on(structure, members.get(node, ()), node, direction)
        if not stiffness:
            return Diaphragm(mass, 1.0 / flexibility) if flexibility else None
        here = nodes[node]
        node = min(stiffness, key=lambda n: math.hypot(nodes[n].x - here.x, nodes[n].y - here.y))
        moving = [d for d, n in zip("XY", direction) if n != 0.0]
        if any(nodes[node].slaved.get(d, node) == here.slaved.get(d, here.id) for d in moving):
            return None  # both follow one master: nothing between them deforms
        flexibility += 1.0 / stiffness[node]


def _straight_on(
    structure: Structure, members: Sequence[int], node: int, direction: tuple[float, float]
) -> dict[int, float]:
    """Return the nodes that members join to this one straight along a direction, with the stiffness
    between.
    """
    nodes, stiffness = structure.model.nodes, dict[int, float]()
    here = nodes[node]
    for member in members:
        e = structure.model.elements[member]
        other = nodes[e.j if e.i == node and e.j is not None else e.i]
        dx, dy = other.x - here.x, other.y - here.y
        off = abs(dx * direction[1] - dy * direction[0])
        if dx * direction[0] + dy * direction[1] <= 0.0 or off > STRAIGHT * math.hypot(dx, dy):
            continue
        block = structure.parts[member].initial()
        from_here, from_there = (
            np.array([direction[d] if owner == n and d < 2 else 0.0 for owner, d in block.dofs])
            for n in (node, other.id)
        )
        along = -float(from_here @ block.matrix @ from_there)
        if along > 0.0:
            stiffness[other.id] = stiffness.get(other.id, 0.0) + along
    return stiffness
