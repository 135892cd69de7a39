"""Return the displacements, forces and reactions of a static state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pound_solve.analyses.equilibrium import SUM_ROUNDING, SupportReactions
from pound_solve.analyses.static import StaticState
from pound_solve.check import Check, Subject, at_most
from pound_solve.numerics.types import Array
from pound_solve.structure.structure import Structure

DUST = 1e-12  #: fraction of the largest value below which a number is rounding error


class ElementForce(NamedTuple):
    """One force or moment of an element; `unit` in dimensions."""

    element: int
    quantity: str
    value: float
    unit: str


@dataclass(frozen=True)
class StaticResponse:
    """A static state in the form used by the tables.

    Attributes
    ----------
    state : StaticState
    displacements : ndarray, shape (n_nodes, 3)
        Of all nodes, in the order of the model [L], [rad].
    forces : list of ElementForce
        By element.
    held : list of int
        Numbers of the supported nodes.
    reactions : ndarray, shape (n_held, 3)
        Forces of the supports on the structure [F], [F L].
    balance : list of tuple
        See `SupportReactions.balance`.
    imbalance : float
        Sum of all forces divided by the largest one.
    """

    state: StaticState
    displacements: Array
    forces: list[ElementForce]
    held: list[int]
    reactions: Array
    balance: list[tuple[Any, ...]]
    imbalance: float

    @property
    def check(self) -> Check:
        """Return the self-check of force equilibrium."""
        about = "static forces and moments out of balance over the largest"
        remark = "loads and reactions do not balance"
        return at_most(Subject.EQUILIBRIUM, about, self.imbalance, SUM_ROUNDING, remark)


def without_rounding(values: Array, kinds: Sequence[str]) -> Array:
    """Return the values, shape (n,), with zeros for rounding errors relative to the largest of
    their kind.
    """
    cleaned = values.copy()
    for kind in set(kinds):
        alike = np.array([k == kind for k in kinds])
        cleaned[alike & (np.abs(values) < DUST * np.abs(values[alike]).max())] = 0.0
    return cleaned


def static_response(structure: Structure, state: StaticState) -> StaticResponse:
    """Return the displacements, forces and reactions of a static state.

    Parameters
    ----------
    structure : Structure
        Without geometric stiffness.
    state : StaticState
    """
    model = structure.model
    stressed = structure.stressed(state.axial)
    full = np.concatenate([state.u, np.zeros(len(stressed.dofs.moved))])
    moved = stressed.dofs.matrix([(node, d) for node in model.nodes for d in range(3)]) @ full
    ground = SupportReactions(structure, state.axial)
    at = ground.reactions(state.u, state.states)
    held = [node for node, x in model.nodes.items() if x.fixed]
    reactions = np.array([at.get((node, d), 0.0) for node in held for d in range(3)])
    balance = ground.balance(state.u, state.states)
    return StaticResponse(
        state,
        without_rounding(moved, "LLR" * len(model.nodes)).reshape(-1, 3),
        _forces(stressed, state, full),
        held,
        without_rounding(reactions, "FFM" * len(held)).reshape(-1, 3),
        balance,
        ground.imbalance(balance, state.u, state.states),
    )


def _forces(structure: Structure, state: StaticState, full: Array) -> list[ElementForce]:
    """Return the forces of members, springs and contacts."""
    units = structure.model.units
    forces = [
        ElementForce(o.element, o.quantity, float(force), o.unit)
        for o, force in zip(structure.outputs, structure.member_forces(full))
    ]
    for x, law_state, d in zip(structure.laws, state.states, (structure.law_rows @ full).tolist()):
        kind = "moment" if x.unit == "F*L" else "force"
        quantity = "contact force" if x.role.collides else f"{kind} {x.component}"
        forces.append(ElementForce(x.element, quantity, x.force(law_state, d, 0.0), x.unit))
    clean = without_rounding(np.array([f.value for f in forces]), [units.text(f.unit) for f in forces])
    return sorted(
        (f._replace(value=value) for f, value in zip(forces, clean.tolist())), key=lambda f: f.element
    )
