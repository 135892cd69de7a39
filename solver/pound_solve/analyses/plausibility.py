"""Checks for implausible results and for results beyond the model's validity, one function each.

Such results are not computational errors; they raise doubts about the units, the strengths or the model.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Final

from pound_deck.model import Model
from pound_solve.analyses.history import HistoryResult
from pound_solve.analyses.spring_response import ORDINARY_ROTATION
from pound_solve.check import Check, Subject, at_least, beyond
from pound_solve.integrate.protocol import Outcome
from pound_solve.structure.buildings import stands
from pound_solve.structure.checks.members import MEMBERS, length
from pound_solve.structure.storeys import storeys
from pound_solve.structure.structure import Structure

RESPONSE: Final = Subject.RESPONSE

LARGEST_DRIFT: Final = 0.1  #: drift over height; frames lose their vertical capacity before this
LARGEST_RESIDUAL: Final = 0.005  #: final drift over height that is visible in a storey
LARGEST_DUCTILITY: Final = 50.0  #: of hinges; concrete or steel members fail before this
LEAST_CLOSURE: Final = 0.01  #: closure as a fraction of the gap; a thousandth suggests wrong units
#: contact force over the weight of the lighter building; an impact at 1 m/s on a stiff wall gives 5
#: for a large floor, 30 for a garage
MOST_FORCE: Final = 100.0
LARGEST_OVERLAP: Final = 0.02  #: of the shortest member that meets a contact


def drifts(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for drifts beyond a tenth of their height."""
    for name, ratio in history.drift_ratios():
        if ratio > LARGEST_DRIFT:
            remark = "check units, masses and strengths"
            yield beyond(RESPONSE, f"drift ratio of {name}", 100 * ratio, 100 * LARGEST_DRIFT, remark, "%")


def failures(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for components with an exhausted damage index or beyond their ultimate deformation."""
    shares = [r.damage.by_deformation for r in history.springs if r.damage is not None]
    shares = [share for share in shares if share >= 1.0]
    if shares:
        name = f"largest over ultimate deformation of {len(shares)} springs and hinges"
        yield beyond(RESPONSE, name, max(shares), 1, "beyond DUCTU; the model goes on as if they held")
    lost = [r.spring for r in history.springs if r.failed]
    if lost:
        name = f"springs and hinges without strength, first {lost[0].element} {lost[0].component}"
        remark = "their rule has failed them; what they carried is on others"
        yield beyond(RESPONSE, name, len(lost), 0, remark)
    failed = [r.damage.total for r in history.springs if r.damage is not None and r.damage.total >= 1.0]
    if failed:
        name = f"damage index of {len(failed)} springs and hinges"
        remark = "1 is failure; the model goes on as if they held"
        yield beyond(RESPONSE, name, max(failed), 1, remark)


def rotations(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for hinges rotated beyond the capacity of ordinary members, if the deck gives
    no limit.
    """
    far = [r for r in history.springs if r.beyond_ordinary]
    if far:
        worst = max(far, key=lambda r: r.rotation)
        ends = f"{len(far)} hinges" if len(far) > 1 else "one hinge"
        where = f"{worst.spring.component} of element {worst.spring.element}"
        name = f"plastic rotation of {ends}, largest {where}, ductility {worst.ductility:.3g}"
        remark = (
            "many members lose strength from there on (of concrete: FEMA 356, Tables 6-7 and 6-8); "
            "DUCTU states a limit of your own"
        )
        yield beyond(RESPONSE, name, worst.rotation, ORDINARY_ROTATION, remark, "rad")


def ductilities(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for hinges beyond any usual ductility, if the deck gives no ultimate deformation.

    A hinge with an explicit KH may be rigid until it yields, and a spring may slide or rock: their
    ductility has no such limit.
    """
    model = structure.model
    far = [
        r
        for r in history.springs
        if r.ductility > LARGEST_DUCTILITY
        and not (r.ends or math.isnan(r.rotation))
        and model.props[model.elements[r.spring.element].prop].values.get("KH") is None
    ]
    if far:
        worst = max(far, key=lambda r: r.ductility)
        ends = f"{len(far)} hinges" if len(far) > 1 else "one hinge"
        name = f"ductility of {ends}, largest {worst.spring.component} of element {worst.spring.element}"
        remark = "check yield moments, stiffnesses and their units"
        yield beyond(RESPONSE, name, worst.ductility, LARGEST_DUCTILITY, remark)


def unknown(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for rules that exceeded DULT, the ductility up to which they are calibrated."""
    for i, spring in enumerate(structure.laws):
        card = structure.model.props[structure.model.elements[spring.element].prop]
        if spring.yields is None or card.values.get("DULT") is None:
            continue
        d, f, limits = outcome.peaks.deformation[i], outcome.peaks.force[i], card["DULT"]
        largest = spring.whole(d.high, f.high), spring.whole(d.low, f.low)
        reached = (largest[0] / spring.yields[0], largest[1] / spring.yields[1])
        for ductility, limit in zip(reached, (limits[0], limits[-1])):
            if ductility > limit:
                name = f"ductility of {spring.component} of element {spring.element}"
                remark = f"beyond DULT the rule {spring.rule} is not calibrated"
                yield beyond(RESPONSE, name, ductility, limit, remark)


def distant(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for contacts whose gap is much larger than the motion that would close it."""
    far = [
        (outcome.peaks.deformation[i].high / gap, i)
        for i in history.items.contacts
        if (gap := structure.laws[i].gap) > 0.0
    ]
    far = [(share, i) for share, i in far if 0.0 < share < LEAST_CLOSURE]
    if far:
        share, i = max(far)
        element = structure.model.elements[structure.laws[i].element]
        which = f"contact {element.name or element.id}"
        name = f"largest share of a gap that closes, {which}" + f" and {len(far) - 1} more" * (len(far) > 1)
        remark = "check the unit of the gap, the direction of the contact and the strength of the motion"
        yield at_least(RESPONSE, name, 100 * share, 100 * LEAST_CLOSURE, remark, "%")


def overlaps(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for contacts whose overlap is too large for an elastic contact."""
    model = structure.model
    if not history.items.contacts:
        return
    members, others = lengths(model)
    for i in history.items.contacts:
        law = structure.laws[i]
        contact = model.elements[law.element]
        overlap = max(outcome.peaks.deformation[i].high - law.gap, 0.0)
        name, limit = contact.name or str(law.element), law.facts["limit"]
        if overlap > limit:
            about, remark = f"overlap of contact {name} beyond its law", "its law is not meant for more"
            yield beyond(RESPONSE, about, overlap, limit, remark, model.units.length)
        ends = [n for n in (contact.i, contact.j) if n is not None]
        near = [members[n] for n in ends if n in members] or [others[n] for n in ends if n in others]
        there = min(near, default=0.0)
        if there and overlap > LARGEST_OVERLAP * there:
            about = f"overlap of contact {name} over the shortest member there"
            share, remark = 100 * overlap / there, "check the stiffness of the contact"
            yield beyond(RESPONSE, about, share, 100 * LARGEST_OVERLAP, remark, "%")


def large_forces(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Yield a check for contacts between buildings whose force is many times the weight of the
    lighter one.
    """
    model = structure.model
    standing = [b for b in history.items.buildings if stands(model, b.nodes)]
    weights = {n: b.mass * model.gravity for b in standing for n in b.nodes}
    for i in history.items.contacts:
        law = structure.laws[i]
        contact, peak = model.elements[law.element], outcome.peaks.force[i]
        pair = [weights[n] for n in (contact.i, contact.j) if n in weights]
        force = max(peak.high, -peak.low)
        if pair and force > MOST_FORCE * min(pair):
            about = f"force of contact {contact.name or contact.id} over the weight of the lighter building"
            remark = "check the stiffness of the contact"
            yield beyond(RESPONSE, about, force / min(pair), MOST_FORCE, remark)


def leaning(structure: Structure, history: HistoryResult, residual: Sequence[float]) -> Iterator[Check]:
    """Yield a check for buildings whose springs or hinges have yielded and that lean at the end of the
    history.

    Parameters
    ----------
    residual : sequence of float
        Drift ratio of every storey at the last sample.
    """
    model, drifts = structure.model, list(zip(storeys(history.items.buildings), residual))
    yielded = {model.elements[r.spring.element].i for r in history.springs if r.ductility > 1.0}
    for building in history.items.buildings:
        residuals = [
            (abs(x), storey)
            for (b, storey), x in drifts
            if b is building and storey not in building.bearings
        ]
        most, storey = max(residuals, default=(0.0, 0))
        if most > LARGEST_RESIDUAL and yielded & set(building.nodes):
            name = f"drift of {building.name} storey {storey} at the end"
            remark = "it leans: check strengths and hardening (R); without hardening drifts add up"
            yield beyond(RESPONSE, name, 100 * most, 100 * LARGEST_RESIDUAL, remark, "%")


def lengths(model: Model) -> tuple[dict[int, float], dict[int, float]]:
    """Return the length of the shortest member at every node that has one, and of the longest spring or
    dashpot, which may be a bearing next to a storey [L].
    """
    shortest, longest = dict[int, float](), dict[int, float]()
    for e in model.elements.values():
        kind = model.props[e.prop].spec.name
        long = 0.0 if e.j is None or kind == "CONTACT" else length(model, e)
        for end in (e.i, e.j or e.i) if long else ():
            if kind in MEMBERS:
                shortest[end] = min(long, shortest.get(end, long))
            else:
                longest[end] = max(long, longest.get(end, long))
    return shortest, longest


RULES: Final[Sequence[Callable[[Structure, HistoryResult, Outcome], Iterator[Check]]]] = (
    drifts,
    failures,
    rotations,
    ductilities,
    unknown,
    distant,
    overlaps,
    large_forces,
)


def of_history(structure: Structure, history: HistoryResult) -> list[Check]:
    """Return all plausibility checks of a history."""
    return [check for rule in RULES for check in rule(structure, history, history.returned)]
