"""Elimination orders of a small symmetric matrix, from the neighbours of every unknown.

This is plain Python, because small decks do not import scipy, which would take longer than the ordering.

References
----------
Cuthill E, McKee J (1969), Reducing the bandwidth of sparse symmetric matrices, Proc. 24th Nat. Conf. ACM:
157-172; Tinney WF, Walker JW (1967), Direct solutions of sparse network equations by optimally ordered
triangular factorization, Proc. IEEE 55(11): 1801-1809.
"""

from __future__ import annotations

from collections.abc import Sequence

Neighbours = Sequence[set[int]]


def levels(near: Neighbours, start: int) -> list[list[int]]:
    """Return the unknowns grouped by their distance in the graph from `start`; within each level, those
    with few neighbours come first.
    """
    tiers, seen = [[start]], {start}
    while True:
        further = []
        for unknown in tiers[-1]:
            fresh = sorted(near[unknown] - seen, key=lambda x: (len(near[x]), x))
            seen.update(fresh)
            further += fresh
        if not further:
            return tiers
        tiers.append(further)


def along_a_line(near: Neighbours) -> list[int]:
    """Return the reverse Cuthill-McKee order: level by level, from one end of every component."""
    order: list[int] = []
    left = set(range(len(near)))
    while left:
        tiers = levels(near, min(left, key=lambda x: (len(near[x]), x)))
        while True:  # find a start that is farther away, until there is none
            end = min(tiers[-1], key=lambda x: (len(near[x]), x))
            again = levels(near, end)
            if len(again) <= len(tiers):
                break
            tiers = again
        unknowns = [x for level in tiers for x in level]
        left.difference_update(unknowns)
        order += unknowns
    return order[::-1]


def minimum_degree(near: Neighbours) -> list[int]:
    """Return the minimum-degree order: the next unknown is always the one coupled to the fewest remaining
    ones; its elimination couples these.
    """
    graph = [set(coupled) for coupled in near]
    left, order = set(range(len(graph))), []
    while left:
        unknown = min(left, key=lambda x: (len(graph[x]), x))
        left.remove(unknown)
        order.append(unknown)
        for other in graph[unknown]:
            graph[other] |= graph[unknown]
            graph[other] -= {unknown, other}
    return order
