"""Extraction of one building from a structure."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from pound_deck.model import Card
from pound_solve.structure.assembly import assemble
from pound_solve.structure.structure import Structure


def extract_building(structure: Structure, nodes: Collection[int]) -> Structure:
    """Return the building formed by some nodes as a structure, without other buildings, contacts with them,
    and damping.
    """
    inside, model = frozenset(nodes), structure.model
    elements = {
        e.id: e for e in model.elements.values() if e.i in inside and (e.j is None or e.j in inside)
    }

    def kept(cards: Sequence[Card], item: str, these: Collection[int]) -> tuple[Card, ...]:
        pairs = [(c, tuple(x for x in c[item] if x in these)) for c in cards]
        return tuple(replace(c, values={**c.values, item: left}) for c, left in pairs if left)

    part = replace(
        model,
        nodes={n: x for n, x in model.nodes.items() if n in inside},
        elements=elements,
        weights=kept(model.weights, "NODES", inside),
        loads=kept(model.loads, "NODES", inside),
        member_loads=kept(model.member_loads, "ELEMENTS", elements),
        buildings=kept(model.buildings, "NODES", inside),
        damping=(),
    )
    moved = [f for f in structure.dofs.moved if f[0] in inside]
    return assemble(part, moved, structure.self_weight)
