"""Input and output of a damping model."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind
from pound_solve.laws.refusal import ItemError
from pound_solve.numerics import matrices
from pound_solve.numerics.modes import Modes
from pound_solve.numerics.types import Array
from pound_solve.structure.proportional import Chosen, Proportional

BUILDING = Field(
    "BUILDING",
    Kind.TEXT,
    default="",
    doc="name of the building to damp by its own modes; omitted: the whole structure",
)
#: of the models that are made of modes
NODES = Field("NODES", Kind.NODES, default=None, doc="all nodes of one building, in place of its name")


@dataclass(frozen=True)
class DampingContext:
    """Input of a damping model.

    Attributes
    ----------
    mass : callable
        ``mass(nodes or None)``: mass matrix of the masses at these nodes, shape (n_columns, n_columns).
    modes : callable
        ``modes(nodes or None, count)``: the `count` slowest modes, or more (None: all), of the initial
        structure, or of the building that these nodes make up, over all unknowns.
    building : callable
        ``building(name)``: nodes of the building of that name.
    warn : callable
        ``warn(message, item)`` reports an item of the card that is not applied as given.
    """

    mass: Callable[[Collection[int] | None], matrices.Matrix]
    modes: Callable[[Collection[int] | None, int | None], Modes]
    building: Callable[[str], Collection[int]]
    warn: Callable[[str, str], None]

    def nodes(self, card: Card) -> Collection[int] | None:
        """Nodes of the BUILDING of a card, or its NODES; None: all.

        Raises
        ------
        DampingError
            Both are given, or there is no such building.
        """
        nodes: Collection[int] | None = card["NODES"]
        if not card["BUILDING"]:
            return nodes
        if nodes is not None:
            raise DampingError("BUILDING stands for all nodes of a building: leave NODES out", "NODES")
        return self.building(card["BUILDING"])

    def from_modes(self, modes: Modes, rates: Array) -> matrices.Matrix:
        r"""Return :math:`M \Phi\,\mathrm{diag}(2\xi_n\omega_n)\,\Phi^T M`, shape (n_free, n_free): full.

        Parameters
        ----------
        modes : Modes
            Mass-normalised.
        rates : ndarray, shape (n_modes,)
            :math:`2\xi_n\omega_n` [1/T].

        References
        ----------
        Wilson EL, Penzien J (1972), Evaluation of orthogonal damping matrices,
        Int. J. Numer. Methods Engng 4: 5-10.
        """
        mass = self.mass(None)
        n = len(modes.shapes)
        weighted = mass[:n, :n] @ modes.shapes
        return np.asarray((weighted * rates) @ weighted.T)


#: of the models that are made of modes
AFTER = Field(
    "AFTER",
    Kind.WORD,
    default="REST",
    words=("REST", "STATIC"),
    doc="modes of the structure at rest, or of the loaded structure, as in MODAL AFTER=STATIC",
)


class Dashpots(NamedTuple):
    """Dashpots parallel to the hysteretic laws of elements: `beta` [T] times the law's present stiffness,
    tangent or `secant`.
    """

    elements: Chosen
    beta: float
    secant: bool


@dataclass(frozen=True)
class CardDamping:
    """Damping of one card and words for the report.

    `relative` acts on the motion relative to the quasi-static one of moved supports (mass-proportional and
    modal damping, which do not act between two nodes); `proportional` acts between nodes; `dashpots` follow
    the laws.
    """

    relative: matrices.Matrix | None
    proportional: Proportional | None
    text: str
    dashpots: Dashpots | None = None


class DampingError(ItemError):
    """Raised for contradictory damping; `item` names the field at fault."""


def frequencies(card: Card, omega: Callable[[], Array], context: DampingContext) -> Array:
    """Circular frequencies from OMEGA or MODES of a card; numbers beyond the last mode select the last one.

    Parameters
    ----------
    card : Card
    omega : callable
        Returns the modal frequencies; called only if MODES is given.
    context : DampingContext

    Raises
    ------
    DampingError
        Both or neither are given, there is no mode, or one is a rigid-body mode.
    """
    if (card["OMEGA"] is None) == (card["MODES"] is None):
        raise DampingError(
            "XI needs the circular frequencies (OMEGA=) or the modes (MODES=) that have it", "XI"
        )
    if card["OMEGA"] is not None:
        return np.array(card["OMEGA"])
    known = omega()
    if not len(known):
        raise DampingError("the structure has no mode", "MODES")
    if max(card["MODES"]) > len(known):
        whole = "the building" if card["BUILDING"] else "the structure"
        text = (
            f"{whole} has no mode {max(card['MODES'])}: its last one, {len(known)}, is taken in its place"
        )
        context.warn(text, "MODES")
    chosen = known[np.minimum(card["MODES"], len(known)) - 1]
    if not chosen.all():
        raise DampingError(
            "a mode of zero frequency cannot carry a damping ratio: is a support (FIX) missing?", "MODES"
        )
    return np.asarray(chosen)


def ratios(card: Card, count: int) -> Array:
    """Damping ratio at each of `count` frequencies: the values of XI, or its single value for all.

    Raises
    ------
    DampingError
        Their numbers differ.
    """
    xi = card["XI"]
    if len(xi) not in (1, count):
        raise DampingError(
            f"XI has {len(xi)} values for {count} frequencies: give one for each, or one for all", "XI"
        )
    return np.broadcast_to(np.array(xi), (count,))


def apart(at: Array, item: str) -> None:
    """Raise DampingError if two frequencies or modes coincide, since no curve passes through both."""
    close = np.diff(np.sort(at)) <= 1e-9 * np.abs(at).max()
    if close.any():
        raise DampingError(f"two of these are the same ({np.sort(at)[1:][close][0]:.6g})", item)


def values(numbers: Array) -> str:
    """Numbers as text for the report."""
    return ", ".join(f"{x:.6g}" for x in numbers)


def span(omega: Array, rates: Array) -> str:
    """Range of the modal damping ratios, as text for the report."""
    moving = omega > 0.0
    if not moving.any():
        return "no mode"
    xi = 0.5 * rates[moving] / omega[moving]
    return f"{moving.sum()} modes have {xi.min():.4g} to {xi.max():.4g}"
