"""The laws on their present branches, summed over the unknowns: kernels and their arrays.

Between two events a law is a spring, a dashpot and a constant force.  Their sums are formed once after
every event, so that a term of the series costs one product instead of a walk over all laws.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from pound_solve.integrate.kernels.allocation import coupled_pairs, inverse_index
from pound_solve.integrate.kernels.law_state import LawDefinition, Laws
from pound_solve.integrate.kernels.products import row_product
from pound_solve.integrate.kernels.sparse import Rows
from pound_solve.integrate.kernels.state import LinearSystem
from pound_solve.integrate.series.state import AssembledSprings, Series
from pound_solve.numerics.ldl import pointers
from pound_solve.numerics.matrices import Matrix, entries
from pound_solve.numerics.types import Array


def allocate(n: int, rows: Rows, inputs: Array, stiffness: Matrix | None) -> AssembledSprings:
    """Lay out the products ``b b^T`` of the laws.

    Parameters
    ----------
    n : int
        Number of unknowns.
    rows : Rows
        Deformations of the laws over them.
    inputs : ndarray, shape (n_inputs, n)
        Loads of unit inputs.
    stiffness : Matrix, shape (n, n), or None
        K, if the sums include it.
    """
    i, j, values = entries(np.zeros((0, 0)) if stiffness is None else stiffness)
    every = np.arange(0 if stiffness is None else n)  # free bodies have a row, too
    slices = [slice(a, b) for a, b in pairwise(rows.pointers.tolist())]
    first, second = coupled_pairs(rows.columns[x].astype(np.int64) for x in slices)
    keys = np.unique(np.concatenate([first * n + second, i * n + j, every * n + every]))
    place, fixed = np.searchsorted(keys, first * n + second), np.zeros(len(keys))
    fixed[np.searchsorted(keys, i * n + j)] = values
    row, begin = np.unique(keys // n, return_index=True)
    squares = [np.outer(rows.values[x], rows.values[x]).ravel() for x in slices]
    return AssembledSprings(
        row=row.astype(np.uint32),
        index_of=inverse_index(row, n),
        rows=Rows(
            np.append(begin, len(keys)).astype(np.uint32), (keys % n).astype(np.uint32), np.zeros(len(keys))
        ),
        stiffness=fixed,
        pair_pointers=pointers(squares),
        pair_places=place.astype(np.uint32),
        pair_values=np.concatenate([np.zeros(0), *squares]),
        constant=np.zeros(n),
        inputs=np.zeros_like(inputs),
        dashpots=np.zeros(len(slices), np.int64),
        n_dashpots=np.zeros(1, np.int64),
    )


def add_up(linear: LinearSystem, laws: Laws, series: Series) -> None:
    """Sum the tangents, constant forces and input loads of the laws on their present branches.

    The forces of rigid and of power contacts, and of friction that slides, are series instead.
    """
    definition, rows, tangent = laws.definition, laws.definition.rows, laws.tangent
    springs, rigid = series.springs, series.rigid
    friction, contacts = series.friction, series.power_contacts
    values, moved, n = springs.rows.values, springs.inputs, 0
    for q in range(len(values)):
        values[q] = springs.stiffness[q]
    for i in range(len(springs.constant)):
        springs.constant[i] = linear.constant[i]
        for j in range(len(moved)):
            moved[j, i] = linear.inputs[j, i]
    for i in range(len(definition.rule)):
        k, offset, rubs = tangent.stiffness[i], tangent.offset[i], friction.index_of[i]
        if (
            rigid.index_of[i] >= 0
            or contacts.index_of[i] >= 0
            or (rubs >= 0 and friction.sliding_direction[rubs] != 0.0)
        ):
            offset = 0.0
        for q in range(springs.pair_pointers[i], springs.pair_pointers[i + 1]):
            values[springs.pair_places[q]] += k * springs.pair_values[q]
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            at, x = rows.columns[q], rows.values[q]
            springs.constant[at] -= x * offset
            for j in range(len(moved)):
                moved[j, at] -= x * k * definition.inputs[i, j]
        if tangent.damping[i] != 0.0:
            springs.dashpots[n] = i
            n += 1
    springs.n_dashpots[0] = n


def add_product(springs: AssembledSprings, x: Array, out: Array) -> None:
    """Add the forces of the springs at displacements `x`."""
    for r in range(len(springs.row)):
        out[springs.row[r]] += row_product(springs.rows, r, x)


def load_term(springs: AssembledSprings, series: Series, k: int, n_powers: int, i: int) -> float:
    """Return coefficient `k` of the load on an unknown less the constant forces of laws."""
    load: float = springs.constant[i] if k == 0 else 0.0
    if k < n_powers:
        for j in range(series.inputs.shape[1]):
            load += springs.inputs[j, i] * series.inputs[k, j]
    return load


def deformation_term(definition: LawDefinition, series: Series, k: int, n_powers: int, i: int) -> float:
    """Return coefficient `k` of the deformation of law `i`."""
    d = row_product(definition.rows, i, series.motion[k])
    if k < n_powers:
        for j in range(series.inputs.shape[1]):
            d += definition.inputs[i, j] * series.inputs[k, j]
    return d
