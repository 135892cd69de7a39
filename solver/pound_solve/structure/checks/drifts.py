"""Check of drifts that do not belong to a storey."""

from __future__ import annotations

from pound_deck.diagnostics import Diagnostic
from pound_solve.structure.buildings import buildings
from pound_solve.structure.structure import Structure


def doubtful_drifts(structure: Structure) -> list[Diagnostic]:
    """Report drifts between nodes of two buildings, or from the upper node to the lower one.

    A drift with an explicit HEIGHT, or between nodes at one height, may measure the distance of two
    buildings.
    """
    nodes, problems = structure.model.nodes, list[Diagnostic]()
    of = {n: b.name for b in buildings(structure) for n in b.nodes}
    for card in structure.model.drifts:
        i, j = card["I"], card["J"]
        rise = nodes[j].y - nodes[i].y
        if card["HEIGHT"] is not None or not rise or not {i, j} <= of.keys():
            continue
        if of[i] != of[j]:
            message = f'drift "{card.label}" is that of node {j} of {of[j]!r} against node {i} of {of[i]!r}'
            hint = "name two nodes of one building; a distance of buildings takes a HEIGHT"
        elif rise < 0.0:
            message = f'drift "{card.label}" is that of node {j} below against node {i} above'
            hint = "exchange I and J: the lower node comes first"
        else:
            continue
        problems.append(Diagnostic("P367", message, card.place("J"), hint, "warning"))
    return problems
