"""Checks of an assembled structure before anything is computed: one function for each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_solve.analyses import pushover
from pound_solve.structure.assembly import Structure


def inclined(structure: Structure) -> list[Diagnostic]:
    """Contacts along an inclined line between their nodes: seldom meant between floors."""
    out = []
    for spring in structure.laws:
        if not spring.role.collides:
            continue
        element = structure.model.elements[spring.element]
        angle = spring.facts["angle"]
        if structure.model.props[element.prop]["ANGLE"] is None and angle % 90.0:
            message = (
                f"contact {spring.element} acts along the line between its nodes, at {angle:.4g} degrees"
            )
            hint = "give ANGLE (0 for floors that meet along x) if that is not meant"
            out.append(Diagnostic("P334", message, element.span, hint, "warning"))
    return out


def pressed(structure: Structure) -> list[Diagnostic]:
    """Contacts that are closed at rest: some programs write the gap with a minus sign."""
    elements, props = structure.model.elements, structure.model.props
    used = dict.fromkeys(elements[s.element].prop for s in structure.laws if s.role.collides)
    hint = "a distance is positive; leave it if the bodies are pressed on purpose"
    return [
        Diagnostic(
            "P336",
            f"contacts of {label} are pressed at rest: GAP is {props[label]['GAP']:g}",
            props[label].place("GAP"),
            hint,
            "warning",
        )
        for label in used
        if props[label]["GAP"] < 0.0
    ]


def adrift(structure: Structure) -> list[Diagnostic]:
    """Motions of the whole base that nothing ties the structure to: it stays behind, as one body.

    What flies by itself is meant to.  Contacts with the ground and dashpots tie it too.
    """
    model, dofs = structure.model, structure.dofs
    if model.initial or model.forces or all(c.spec.name != "HISTORY" for c in model.analyses):
        return []
    k = structure.displaced(np.zeros(structure.n_free)).initial_stiffness
    dashpots = [b for p in structure.parts.values() for b in p.damping]
    ways = {c["DIRECTION"]: c for c in reversed(model.equake) if c["SUPPORTS"] is None}
    out = []
    for way in sorted(ways.keys() - {"R"}):
        d = "XY".index(way)
        ride = np.array([float(own == d) for _, own in dofs.free] + [0.0] * len(dofs.moved))
        ends = [[dofs.value((f,), (1.0,), ride) for f in b.dofs] for b in dashpots]
        tied = (
            (abs(k @ ride) > 1e-9 * (abs(k) @ ride)).any()
            or (structure.law_rows @ ride).any()
            or any((b.matrix @ u).any() for b, u in zip(dashpots, ends))
        )
        if ride @ structure.ground[d] > 0.0 and not tied:
            message = f"nothing ties the structure to the ground along {way}: it stays behind as one body"
            hint = f"fix {way} of its base under NODES, or join it to the ground by an element"
            out.append(Diagnostic("P337", message, ways[way].span, hint, "warning"))
    return out


CHECKS: Final[tuple[Callable[[Structure], list[Diagnostic]], ...]] = (
    inclined,
    pressed,
    adrift,
    pushover.mistakes,
)


def preflight(structure: Structure) -> list[Diagnostic]:
    """What all checks find: mistakes and warnings."""
    return [found for check in CHECKS for found in check(structure)]
