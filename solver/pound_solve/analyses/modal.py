r"""MODAL: natural modes with participation factors, effective masses and damping ratios.

For a ground direction with influence vector r:

.. math:: \Gamma_n = \phi_n^T M r, \qquad m_n^* = \Gamma_n^2, \qquad
          \xi_n = \frac{\phi_n^T C\,\phi_n}{2\omega_n}

for mass-normalised shapes.  The effective masses of all modes add up to the mass that can move in the
direction.

References
----------
Chopra AK (2012), Dynamics of Structures, 4th edn, sections 13.1 and 13.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.analyses import static
from pound_solve.numerics.modes import moving_mass
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import buildings, columns_of
from pound_solve.structure.structure import Structure

TELLING: Final = 0.1  #: smallest share of the kinetic energy of a mode for which a building is listed [%]
SPEC = Spec(
    "analysis",
    "MODAL",
    "natural modes",
    (
        Field(
            "MODES",
            Kind.INT,
            default=None,
            lo=1,
            doc="number of modes; omitted: all, at most 12",
            positional=True,
        ),
        Field("SHAPES", Kind.WORD, default="YES", words=("YES", "NO"), doc="print the mode shapes"),
        Field(
            "AFTER",
            Kind.WORD,
            default="REST",
            words=("REST", "STATIC"),
            doc="stiffness of the laws: initial with open contacts, or tangent in the static state",
        ),
    ),
)


class Mode(NamedTuple):
    """One natural mode.

    Attributes
    ----------
    number : int
        1 for the lowest frequency.
    omega, frequency, period : float
        [rad/T], [1/T], [T]
    damping : float
        Fraction of critical damping [%]; NaN for a motion without stiffness.
    gamma_x, gamma_y : float
        Participation factors for unit modal mass.
    mass_x, mass_y : float
        Effective masses [F T^2/L].
    share_x, share_y : float
        Effective masses as a fraction of the mass that can move in the direction [%].
    """

    number: int
    omega: float
    frequency: float
    period: float
    damping: float
    gamma_x: float
    mass_x: float
    share_x: float
    gamma_y: float
    mass_y: float
    share_y: float


class Share(NamedTuple):
    """Share of a building in the kinetic energy of a mode [%]."""

    mode: int
    building: str
    kinetic: float


@dataclass(frozen=True)
class ModalResult:
    """Results of a modal analysis.

    Attributes
    ----------
    modes : list of Mode
    shares : list of Share
        For each mode, the shares of at least `TELLING`.
    shapes : ndarray, shape (n_modes, n_nodes, 3), or None
        With a largest component of 1; None if not requested.
    loaded : bool
        Whether the stiffness is the tangent stiffness of the static state.
    """

    modes: list[Mode]
    shares: list[Share]
    shapes: Array | None
    loaded: bool


def run(structure: Structure, state: static.StaticState, card: Card) -> ModalResult:
    """Compute the natural modes that a card of `SPEC` requests."""
    loaded = card["AFTER"] == "STATIC"
    if loaded:
        structure = static.after(structure, state)
    modes = natural_modes(structure, card["MODES"])
    shapes = mode_shapes(structure, len(modes)) if card["SHAPES"] == "YES" else None
    return ModalResult(modes, kinetic_shares(structure, len(modes)), shapes, loaded)


def natural_modes(structure: Structure, wanted: int | None) -> list[Mode]:
    """Return the lowest modes of a structure.

    Parameters
    ----------
    structure : Structure
    wanted : int or None
        Largest number of modes; None: 12.
    """
    n, sought = structure.n_free, 12 if wanted is None else wanted
    vibration = structure.vibration(sought)
    ground = structure.ground[:, :n]
    total = moving_mass(
        structure.constrained(structure.initial_stiffness),
        structure.constrained(structure.mass),
        ground if structure.basis is None else ground @ structure.basis,
    )
    c = structure.initial_damping[:n, :n]
    modes = []
    for i in range(min(len(vibration.omega), sought)):
        w, shape = float(vibration.omega[i]), vibration.shapes[:, i]
        damping = float(shape @ c @ shape) / (2 * w) if w > 0 else float("nan")
        row = [w, w / (2 * np.pi), 2 * np.pi / w if w > 0 else float("inf"), 100 * damping]
        for d in range(2):
            gamma = float(shape @ ground[d])
            gamma = 0.0 if gamma**2 < 1e-20 * total[d] else gamma  # rounding of an inactive mode
            row += [gamma, gamma**2, 100 * gamma**2 / float(total[d]) if total[d] > 0 else 0.0]
        modes.append(Mode(i + 1, *row))
    return modes


def kinetic_shares(structure: Structure, count: int) -> list[Share]:
    r"""Return the shares of the buildings in the kinetic energy of the lowest modes.

    .. math:: \frac{\phi_b^T (M\phi)_b}{\phi^T M\phi}

    over the unknowns b of a building; masses do not couple buildings, so the shares add up to one.
    """
    shapes, n = structure.vibration(count).shapes[:, :count], structure.n_free
    energy = shapes * (structure.mass[:n, :n] @ shapes)
    all_buildings = buildings(structure)
    columns = columns_of(structure.model, structure.dofs.free, [b.nodes for b in all_buildings])
    shares = 100.0 * np.array([energy[unknowns].sum(axis=0) for unknowns in columns]) / energy.sum(axis=0)
    return [
        Share(i + 1, b.name, float(share))
        for i in range(count)
        for b, share in zip(all_buildings, shares[:, i])
        if share >= TELLING
    ]


def mode_shapes(structure: Structure, count: int) -> Array:
    """Return the shapes of the lowest modes at every node, shape (count, n_nodes, 3), largest
    component 1.
    """
    shapes = structure.vibration(count).shapes
    every = structure.dofs.matrix([(node, d) for node in structure.model.nodes for d in range(3)])
    pad = len(structure.dofs.moved)
    at_nodes = np.zeros((count, len(structure.model.nodes), 3))
    for i in range(count):
        full = np.concatenate([shapes[:, i], np.zeros(pad)])
        scale = np.abs(shapes[:, i]).max()
        x = every @ full / scale
        x[np.abs(x) < 1e-12] = 0.0  # rounding
        at_nodes[i] = x.reshape(-1, 3)
    return at_nodes
