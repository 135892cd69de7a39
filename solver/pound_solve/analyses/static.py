r"""STATIC: displacements under the loads, traced from event to event (see `path_following`), with P-Delta.

Loads grow from zero to their full value.  An initial overlap of a contact grows with them, so that the path
starts without stress.  With geometry PDELTA the axial forces N of the members give the stiffness
:math:`K_G(N)`.  N are the forces of the static state itself, found by iteration, and act from the start of
loading.  The *buckling load factor* :math:`\lambda` is the multiple of the loads at which

.. math:: \det\bigl(K_t + \lambda K_G(N)\bigr) = 0

with the tangent stiffness and the axial forces that the loads cause without P-Delta.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.analyses.path_following import EquilibriumPath, Mark, PathEvent
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.laws.automaton import State
from pound_solve.numerics.matrices import Factor, Matrix, scaled, used_rows
from pound_solve.numerics.modes import scaling
from pound_solve.numerics.types import Array
from pound_solve.structure.structure import Structure

MOST_ROUNDS = 100  #: of axial forces


@dataclass(frozen=True)
class StaticState:
    """Result of a static analysis.

    Attributes
    ----------
    u : ndarray, shape (n_free,)
        Displacements [L] or [rad].
    states : tuple
        State of every law.
    events : int
        Number of branch changes on the path.
    axial : ndarray, shape (n_geometric,)
        Axial forces in the geometric stiffness, tension positive [F].
    buckling : float
        Buckling load factor; infinite without compression, NaN if undefined.
    rounds : int
        Number of iterations for the axial forces.
    """

    u: Array
    states: tuple[State, ...]
    events: int
    axial: Array = field(default_factory=lambda: np.zeros(0))
    buckling: float = math.nan
    rounds: int = 1


def at_rest(structure: Structure) -> StaticState:
    """Return the unloaded state: no displacement, every law virgin."""
    return StaticState(np.zeros(structure.n_free), tuple(s.law.start() for s in structure.laws), 0)


def solve(structure: Structure) -> StaticState:
    """Load the structure from rest.

    Parameters
    ----------
    structure : Structure
        Without geometric stiffness: that of ``structure.stressed(result.axial)`` is in equilibrium.

    Raises
    ------
    InstabilityError
        A loaded part is a mechanism or buckles, initially or after yielding.
    """
    state = loaded(structure)
    if not structure.geometric:
        return state
    pad = np.zeros(len(structure.dofs.moved))
    axial = structure.axial(np.append(state.u, pad))
    path = resumed(structure, state)
    k, pressed = path.tangent(), resumed(structure.stressed(axial), state).tangent()
    factor = buckling(path.constraints.reduced_matrix(k), path.constraints.reduced_matrix(pressed - k))
    if factor <= 1.0:
        raise InstabilityError(
            f"the structure buckles: its buckling load factor is {factor:.6g}, which is below 1"
        )
    for rounds in range(2, MOST_ROUNDS):
        state = loaded(structure.stressed(axial))
        new_axial = structure.axial(np.append(state.u, pad))
        if np.abs(new_axial - axial).max() <= 1e-12 * np.abs(new_axial).max():
            return replace(state, axial=axial, buckling=factor, rounds=rounds)
        change, axial = np.abs(new_axial - axial), new_axial
    worst = structure.geometric[int(np.argmax(change))].element
    raise InstabilityError(
        f"the axial forces did not settle within {MOST_ROUNDS} rounds of P-Delta, least that of member "
        f"{worst}: its building is near buckling under these loads, or a member is missing there",
        "A507",
    )


def loaded(structure: Structure) -> StaticState:
    """Apply the loads to a structure at rest."""
    load = structure.loads[: structure.n_free]
    rest = at_rest(structure)
    # an overlap or prestress that deforms a law at rest grows with the load
    starts = [s.law.branch(x) for s, x in zip(structure.laws, rest.states)]
    lead = np.array([-b.force0 / b.stiffness if b.force0 else 0.0 for b in starts])
    if not load.any() and not lead.any():
        return rest
    path = EquilibriumPath(structure, rest.u, rest.states, 0.0 * load, load, lead=lead)
    whole = Mark(0.0 * load, 1.0, 1.0)
    while (hit := path.step([whole])) != 0:
        if isinstance(hit, PathEvent):
            path.transition(hit)
    return StaticState(path.u, tuple(path.states), path.changes)


def resumed(structure: Structure, state: StaticState) -> EquilibriumPath:
    """Return the path that starts at `state`."""
    nothing = np.zeros(structure.n_free)
    return EquilibriumPath(structure, state.u, state.states, nothing, nothing)


def after(structure: Structure, state: StaticState) -> Structure:
    """Return the structure with the tangent stiffness of `state` as its initial stiffness; closed rigid
    contacts stay closed in its modes (for MODAL AFTER=STATIC).
    """
    initial, path = structure.initial_stiffness, resumed(structure, state)
    k = initial - structure.free_block(initial) + structure.free_block(path.tangent())
    return replace(
        structure, initial_stiffness=k, basis=path.constraints.basis if len(path.constraints) else None
    )


def buckling(k: Matrix, geometric: Matrix) -> float:
    """Return the smallest positive factor for which ``K + factor * geometric`` is singular: infinite if
    there is none, NaN if K is not positive definite on its DOFs.
    """
    at = np.flatnonzero(used_rows(k))
    if not len(at):
        return math.nan
    root = scaling(k[np.ix_(at, at)])
    try:
        least = _least(*(scaled(x[np.ix_(at, at)], root) for x in (geometric, k)))
    except np.linalg.LinAlgError:
        return math.nan
    return -1.0 / least if least < -1e-12 else math.inf


def _least(g: Matrix, k: Matrix) -> float:
    """Return the smallest eigenvalue of ``g x = value k x``.

    Raises
    ------
    numpy.linalg.LinAlgError
        K is not positive definite.
    """
    if isinstance(k, np.ndarray):
        lower = np.linalg.cholesky(k)
        half = np.linalg.solve(lower, g)
        return float(np.linalg.eigvalsh(np.linalg.solve(lower, half.T))[0])
    from scipy.sparse.linalg import LinearOperator, eigsh

    factor = Factor(k)
    if factor.negative:
        raise np.linalg.LinAlgError("not positive definite")
    start = factor.solve(np.random.default_rng(0).standard_normal(k.shape[0]))
    inverse = LinearOperator(k.shape, factor.solve)
    return float(eigsh(g, 1, k, which="SA", v0=start, Minv=inverse, return_eigenvectors=False)[0])


SPEC = Spec(
    "analysis",
    "STATIC",
    "displacements under the static loads",
    (
        Field(
            "GRAVITY",
            Kind.WORD,
            default="NO",
            words=("NO", "YES"),
            doc="apply the nodal WEIGHTS as downward loads",
        ),
        Field(
            "SELF_WEIGHT",
            Kind.WORD,
            default="YES",
            words=("YES", "NO"),
            doc="apply the weight WGT of members as loads",
        ),
    ),
)
