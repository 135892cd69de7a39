"""Checks against a building's first mode: its damping, frequencies of DAMPING, stiffness of contacts."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve.numerics.matrices import Matrix
from pound_solve.structure.buildings import Building
from pound_solve.structure.checks.mechanisms import BuildingStiffness
from pound_solve.structure.checks.members import is_horizontal, length, members_by_set
from pound_solve.structure.structure import Structure

#: fractions of critical damping of a first mode: by DAMPING, where materials and walls give 0.01 to 0.1,
#: and by dashpots, which may include a snubber that ties equipment to a building
MAX_CARD_DAMPING, MAX_DASHPOT_DAMPING = 0.2, 10.0
#: of the largest frequency with a damping ratio over that of the first mode
MIN_FREQUENCY_RATIO: Final = 0.6
MIN_DASHPOT_DAMPING: Final = 1e-3  #: least fraction of critical damping by dashpots, if there are any
#: stiffness of a contact over the axial one of the beams behind it; slabs may stiffen them tenfold
MAX_CONTACT_STIFFNESS_RATIO: Final = 300.0
#: duration of a collision in which sound at 3500 m/s does not cross a column [s]
MIN_COLLISION_TIME: Final = 1e-4
RECORDS: Final = ("RECORD", "SYNTHETIC", "MATCHED")  #: earthquakes; others may be textbook inputs


def misdamped_buildings(
    structure: Structure, parts: Sequence[tuple[Building, BuildingStiffness]]
) -> list[Diagnostic]:
    """Report buildings whose first mode is implausibly damped, or undamped under an earthquake."""
    model, problems = structure.model, list[Diagnostic]()
    added = _by_dashpots(structure)
    for b, part in parts:
        if not part.period:
            continue
        whole, xi = part.damped(structure.initial_damping), part.damped(added)
        by_cards = whole - xi
        place: Card | None = next(iter(model.damping), None)
        dashpots = _dashpots(model, b)
        if place and by_cards > MAX_CARD_DAMPING:
            message = (
                f"DAMPING gives the first mode of {b.name!r} {_percent(by_cards)} of critical: 5 % is usual"
            )
            hint = "XI is a share; ALPHA [1/T] and BETA [T] are factors of M and K, not shares"
            problems.append(Diagnostic("P373", message, place.span, hint, "warning"))
        elif dashpots and xi > MAX_DASHPOT_DAMPING:
            message = (
                f"dashpots give the first mode of {b.name!r} {_percent(xi)} of critical: it does not swing"
            )
            hint = f"coefficients are in {model.units.text('F*T/L')}"
            problems.append(Diagnostic("P373", message, dashpots.place("CX"), hint, "warning"))
        elif dashpots and 0.0 < xi < MIN_DASHPOT_DAMPING:
            message = f"dashpots give the first mode of {b.name!r} no more than {_percent(xi)} of critical"
            hint = f"coefficients are in {model.units.text('F*T/L')}"
            problems.append(Diagnostic("P373", message, dashpots.place("CX"), hint, "warning"))
        elif not whole and not model.damping and any(c.spec.name in RECORDS for c in model.equake):
            message = f"nothing damps the first mode of {b.name!r}"
            hint = "add DAMPING, such as RAYLEIGH XI=0.05 MODES=1,3; XI=0 says that none is meant"
            problems.append(Diagnostic("P373", message, model.nodes[b.feet[0]].span, hint, "warning"))
    return problems


def frequencies_in_hertz(
    structure: Structure, parts: Sequence[tuple[Building, BuildingStiffness]]
) -> list[Diagnostic]:
    """Report circular frequencies of DAMPING below the first mode of all damped buildings, which are
    probably given in hertz.
    """
    model, problems = structure.model, list[Diagnostic]()
    for card in model.damping:
        omega, nodes, name = (card.values.get(item) for item in ("OMEGA", "NODES", "BUILDING"))
        chosen = [
            part
            for b, part in parts
            if (not nodes or set(nodes) & set(b.nodes)) and (not name or name == b.name)
        ]
        periods = [t for part in chosen if (t := part.period)]
        if not omega or not periods:
            continue
        first = 2.0 * math.pi / max(periods)
        if max(omega) < MIN_FREQUENCY_RATIO * first:
            written = ",".join(f"{w:g}" for w in omega)
            message = f"OMEGA={written} is below the first mode, about {first:.3g} rad/{model.units.time}"
            hint = "OMEGA are circular frequencies: 2 pi times those in 1/s"
            problems.append(Diagnostic("P373", message, card.place("OMEGA"), hint, "warning"))
    return problems


def _by_dashpots(structure: Structure) -> Matrix:
    """Damping matrix of dashpots between two nodes; soil dashpots are excluded, since radiation may add
    little.
    """
    joining = (p for e, p in structure.parts.items() if structure.model.elements[e].j is not None)
    return structure.dofs.assembled((b.dofs, b.matrix) for p in joining for b in p.damping)


def _dashpots(model: Model, b: Building) -> Card | None:
    """Property set of a dashpot above the base of a building; None without one."""
    above = {n for n in b.nodes if model.nodes[n].y > b.base}
    cards = (model.props[e.prop] for e in model.elements.values() if e.j and {e.i, e.j} & above)
    return next((card for card in cards if card.spec.name == "DASHPOT"), None)


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"


def _axial(model: Model) -> dict[int, float]:
    """Sum of EA/L of the horizontal members at each node [F/L]."""
    stiffness = defaultdict[int, float](float)
    for label, members in members_by_set(model).items():
        card = model.props[label]
        for e in members:
            if is_horizontal(model, e):
                for n in (e.i, e.j or e.i):
                    stiffness[n] += card["E"] * card["A"] / length(model, e)
    return stiffness


def contact_stiffnesses(
    structure: Structure, parts: Sequence[tuple[Building, BuildingStiffness]]
) -> list[Diagnostic]:
    """Report implausible contacts, one for each property set: so soft that the weight of the bodies would
    compress them by more than the height of their buildings, or too stiff for the beams behind them or for
    the duration of a collision.
    """
    model, problems = structure.model, dict[str, Diagnostic]()
    beams = _axial(model)
    tall = dict[int, float]()
    for b, _ in parts:
        tall.update(dict.fromkeys(b.nodes, max(model.nodes[n].y for n in b.nodes) - b.base))
    for s in structure.laws:
        e = model.elements[s.element]
        if not s.role.collides or s.facts.get("k_unit") != "F/L" or e.prop in problems:
            continue
        m, k = s.facts["reduced_mass"], s.facts["k"]
        high = max(tall.get(e.i, 0.0), tall.get(e.j or e.i, 0.0))
        if not (m and k and high) or math.isinf(k):
            continue
        deep, half, unit = m * model.gravity / k, math.pi * math.sqrt(m / k), model.units
        behind, which = max(beams.get(e.i, 0.0), beams.get(e.j or e.i, 0.0)), f"contact {e.name or e.id}"
        if deep > high:
            message = f"the weight of the bodies at {which} would press it by {deep:.2g} {unit.length}"
        elif k > MAX_CONTACT_STIFFNESS_RATIO * behind > 0.0:
            message = (
                f"{which} is {k / behind:.2g} times as stiff as the beams behind it, EA/L, which give way"
            )
        elif half < MIN_COLLISION_TIME and unit.time.lower() in ("s", "sec"):
            message = f"a collision at {which} takes {half:.1g} {unit.time}: 0.001 s is brief"
        else:
            continue
        card, hint = model.props[e.prop], f"K is in {model.units.text('F/L')}"
        problems[e.prop] = Diagnostic("P369", message, card.place("K"), hint, "warning")
    return list(problems.values())
