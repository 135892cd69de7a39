"""Measured quantities that are linear in the motion: drifts, sums of forces, displacements of nodes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pound_solve.analyses.recorder import RecordedItems
from pound_solve.numerics.matrices import Matrix, dense
from pound_solve.numerics.types import Array
from pound_solve.structure.elements.base import axes

SUMS = ("drift", "storey", "base", "acceleration")  #: sums of a history that quantities are taken from


class MeasuredRows(NamedTuple):
    """Rows of the measured quantities, ``on_u u + on_v v + on_a a + on_f f + on_s s + constant``.

    Attributes
    ----------
    on_u, on_v, on_a : ndarray, shape (n_rows, n)
    on_f : ndarray, shape (n_rows, n_laws)
        On the forces of the laws, dashpots included.
    on_s : ndarray, shape (n_rows, 3 n_inputs)
        On the inputs and their first two derivatives.
    constant : ndarray, shape (n_rows,)
    """

    on_u: Array
    on_v: Array
    on_a: Array
    on_f: Array
    on_s: Array
    constant: Array


class Places(NamedTuple):
    """Index of the first row of every group of rows.

    Attributes
    ----------
    drifts : int
        Of the DRIFT cards.
    sums : dict of str to int
        Of the groups `SUMS`.
    ends : dict of (int, int) to int
        Displacement, along the contact, of its end 0 or 1, by law and end; walls have none.
    """

    drifts: int
    sums: dict[str, int]
    ends: dict[tuple[int, int], int]


def measured(items: RecordedItems) -> tuple[MeasuredRows, Places]:
    """Return the rows of all measured quantities of a history, and their places."""
    groups = [_on_displacements(items, items.drifts.rows, items.drifts.input_rows, items.drifts.constants)]
    sums: dict[str, int] = {}
    for name in SUMS:
        x = items.sums[name]
        sums[name] = sum(len(g.constant) for g in groups)
        on_u, on_v, on_a = map(dense, x.motion)
        groups.append(MeasuredRows(on_u, on_v, on_a, dense(x.of_laws), np.hstack(x.inputs), x.constant))
    first = sum(len(g.constant) for g in groups)
    system = items.system
    ends = list(_ends(items))
    rows = system.structure.dofs.rows([([(node, 0), (node, 1)], list(along)) for _, _, node, along in ends])
    groups.append(_on_displacements(items, *system.reduce_rows(rows)))
    whole = MeasuredRows(*(np.concatenate(x) for x in zip(*groups)))
    return whole, Places(0, sums, {(law, end): first + i for i, (law, end, *_) in enumerate(ends)})


def _on_displacements(
    items: RecordedItems, rows: Matrix, on_inputs: Array, constant: Array
) -> MeasuredRows:
    """Return rows that depend on displacements and inputs alone."""
    system, count = items.system, len(constant)
    none = np.zeros((count, system.size))
    rates = np.zeros((count, 2 * system.inputs.shape[1]))
    forces = np.zeros((count, len(system.structure.laws)))
    return MeasuredRows(dense(rows), none, none, forces, np.hstack([on_inputs, rates]), constant)


def _ends(items: RecordedItems) -> Iterator[tuple[int, int, int, tuple[float, float]]]:
    """Yield the law, the end, its node and the direction, of the ends of all contacts between nodes."""
    structure = items.system.structure
    for law in items.contacts:
        spring = structure.laws[law]
        element, along = structure.model.elements[spring.element], axes(spring.facts["angle"])[0]
        for end, node in enumerate((element.i, element.j or 0)):
            if node:
                yield law, end, node, along
