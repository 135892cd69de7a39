"""What a damping model is given and what it returns."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Ground:
    """What damping models build upon.

    Attributes
    ----------
    mass : callable
        ``mass(nodes or None)``: mass matrix of the masses at these nodes, shape (n_columns, n_columns).
    stiffness : callable
        ``stiffness(property labels or None)``: initial stiffness of their elements, same shape.
    modes : callable
        Circular frequencies (n_modes,), shapes (n_free, n_modes) and mass matrix (n_free, n_free).
    pad : callable
        Matrix of the free freedoms padded to all columns.
    """

    mass: Callable[[Collection[int] | None], Matrix]
    stiffness: Callable[[Collection[str] | None], Matrix]
    modes: Callable[[], tuple[Matrix, Matrix, Matrix]]
    pad: Callable[[Matrix], Matrix]

    def omega(self) -> Matrix:
        """Circular frequencies of the modes."""
        return self.modes()[0]


@dataclass(frozen=True)
class Group:
    """Damping matrices of one card and words for the report.

    `relative` acts on the motion relative to the quasi-static one of moved supports (mass-proportional and
    modal damping: they have no place between two nodes); `between` acts between nodes as it stands.
    """

    relative: Matrix | None
    between: Matrix | None
    text: str


class DampingError(Exception):
    """Contradictory damping; `item` names the field at fault."""

    def __init__(self, message: str, item: str = "") -> None:
        super().__init__(message)
        self.item = item
