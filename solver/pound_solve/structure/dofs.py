"""Degrees of freedom (DOFs): which are unknown, which follow a master, which are prescribed.

Every node has ``ux``, ``uy`` and ``rz``; an element may have internal DOFs in addition (the rotations of
its hinges).  A fixed DOF is zero, a slaved one follows its master with the rigid arm between them, and one
at a moved support is prescribed; the rest are the unknowns.  The columns of every assembled matrix are the
unknowns, then the prescribed DOFs.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pound_deck.model import Node
from pound_solve.numerics.matrices import Matrix, gathered
from pound_solve.numerics.types import Array

DIRECTIONS = "XYR"
NAMES = ("ux", "uy", "rz")
INTERNAL = ("rotation inside I", "rotation inside J", "stretch inside I", "stretch inside J")

#: node number and direction (0 x, 1 y, 2 rotation), or element number and 3, 4, ... for its internal ones
Dof = tuple[int, int]
Terms = tuple[tuple[int, float], ...]  #: columns and factors, whose sum is a DOF


def label(dof: Dof) -> str:
    """Name of a DOF in words."""
    owner, d = dof
    return f"node {owner} {NAMES[d]}" if d < 3 else f"element {owner} {INTERNAL[d - 3]}"


def labels(dofs: Sequence[Dof], most: int = 6) -> str:
    """Names of the first few of several DOFs, and the number of the rest."""
    text = ", ".join(label(f).removeprefix("node ") for f in dofs[:most])
    return text + (f", and {len(dofs) - most} more" if len(dofs) > most else "")


@dataclass(frozen=True)
class DofMap:
    """Numbering of the DOFs.

    Attributes
    ----------
    free : tuple of Dof
        The unknowns, in the order of the nodes; internal ones of elements last.
    moved : tuple of Dof
        DOFs at moved supports, whose motion is prescribed.
    terms : mapping of Dof to tuple of (int, float)
        Each DOF as a sum of columns; empty for a fixed one.
    """

    free: tuple[Dof, ...]
    moved: tuple[Dof, ...]
    terms: Mapping[Dof, Terms]

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.free) + len(self.moved)

    def add(self, out: Array, dofs: Collection[Dof], values: Collection[float]) -> None:
        """Add `values` times `DOFs` to a row over the columns, shape (size,)."""
        for dof, value in zip(dofs, values):
            for column, factor in self.terms[dof]:
                out[column] += value * factor

    def row(self, dofs: Collection[Dof], values: Collection[float]) -> Array:
        """Sum of `values` times `DOFs` as a row over the columns, shape (size,)."""
        row = np.zeros(self.size)
        self.add(row, dofs, values)
        return row

    def rows(self, sums: Sequence[tuple[Collection[Dof], Collection[float]]]) -> Matrix:
        """Rows of several such sums, shape (len(sums), size)."""
        terms = [
            (i, column, value * factor)
            for i, (dofs, values) in enumerate(sums)
            for dof, value in zip(dofs, values)
            for column, factor in self.terms[dof]
        ]
        return gathered((len(sums), self.size), *np.array(terms).reshape(-1, 3).T)

    def assembled(self, blocks: Iterable[tuple[Sequence[Dof], Array]]) -> Matrix:
        """Sum of small matrices, each at its DOFs, shape (size, size)."""
        rows, columns, values = [], [], []
        for dofs, matrix in blocks:
            terms = [self.terms[f] for f in dofs]
            for one, line in zip(terms, matrix.tolist()):
                for other, value in zip(terms, line):
                    if value != 0.0:
                        for i, fi in one:
                            for j, fj in other:
                                rows.append(i)
                                columns.append(j)
                                values.append(value * fi * fj)
        return gathered((self.size, self.size), rows, columns, values)

    def matrix(self, dofs: Collection[Dof]) -> Matrix:
        """Rows of several DOFs, shape (len(DOFs), size)."""
        return self.rows([((f,), (1.0,)) for f in dofs])

    def value(self, dofs: Collection[Dof], values: Collection[float], u: Array) -> float:
        """Sum of `values` times `DOFs` at displacements `u` of all columns."""
        return float(
            sum(
                value * factor * u[column]
                for dof, value in zip(dofs, values)
                for column, factor in self.terms[dof]
            )
        )


def number(
    nodes: Mapping[int, Node], moved: Collection[Dof] = (), internal: Collection[Dof] = ()
) -> DofMap:
    """Number the DOFs of `nodes` and the `internal` ones of elements; fixed DOFs in `moved` get prescribed
    columns.
    """
    moved, prescribed = tuple(sorted(moved)), frozenset(moved)
    free = tuple(
        (n.id, d)
        for n in nodes.values()
        for d in range(3)
        if DIRECTIONS[d] not in n.fixed and DIRECTIONS[d] not in n.slaved and (n.id, d) not in prescribed
    ) + tuple(internal)
    column = {f: i for i, f in enumerate(free + moved)}
    terms: dict[Dof, Terms] = {f: ((column[f], 1.0),) for f in internal}
    for n in nodes.values():
        for d in range(3):
            if DIRECTIONS[d] not in n.slaved:
                terms[n.id, d] = ((column[n.id, d], 1.0),) if (n.id, d) in column else ()
    # rotations first: a slaved node's arm rotates with its master, whose rotation may itself be slaved
    for d in (2, 0, 1):
        for n in nodes.values():
            if DIRECTIONS[d] in n.slaved:
                terms[n.id, d] = _slaved(n, nodes[n.slaved[DIRECTIONS[d]]], d, terms)
    return DofMap(free, moved, terms)


def _slaved(node: Node, master: Node, d: int, terms: Mapping[Dof, Terms]) -> Terms:
    """A slaved DOF as terms of the master's: the same displacement, and the rotation times the arm."""
    arm = (-(node.y - master.y), node.x - master.x, 0.0)[d]
    rotation = tuple((c, f * arm) for c, f in terms[master.id, 2]) if arm else ()
    return terms[master.id, d] + rotation
