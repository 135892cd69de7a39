r"""Members as they bend between displaced nodes.

A beam without loads between its ends has the cubic shape

.. math:: w(x) = w_I + (w_J - w_I)\,x + L\,[x (1 - x)^2\,\alpha_I - x^2 (1 - x)\,\alpha_J]

with the rotations :math:`\alpha` of its ends against its chord.  The ends are those of the flexible length,
between rigid blocks.  Where a hinge has turned by :math:`\theta` (sagging positive), an end is turned
against its block by :math:`\theta` at I and :math:`-\theta` at J.  A flexible joint turns by its
flexibility f times the end moment, a pinned end so far that it has no moment; with the rotations
:math:`\rho` behind them

.. math:: p\,(\alpha_I - \rho_I) + (1 - p)\,(4 \alpha_I + 2 \alpha_J) = 0, \qquad
          p = \frac{1}{1 + f\,EI/L}

and the same at J; a pin has p = 0.  Shear deformation is neglected.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.results import Results

MOST: Final = 300  #: members; more are drawn straight
PIECES: Final = 12  #: of a drawn member
NO_MOTION = np.zeros(3)
_X: Final = np.linspace(0.0, 1.0, PIECES + 1)
#: deflections for unit rotations of the ends and a unit length, shape (2, n)
_BOWS: Final = np.array([_X * (1.0 - _X) ** 2, -(_X**2) * (1.0 - _X)])


class Shift(NamedTuple):
    """Displacements as a picture draws them, all times its magnification.

    Attributes
    ----------
    nodes : dict of int to ndarray, shape (3,)
        Along X and Y [L], and rotation, of the nodes that move.
    hinges : dict of (int, str) to float
        Rotations of hinges by element and end, ``I`` or ``J``; sagging positive.
    """

    nodes: Mapping[int, Array]
    hinges: Mapping[tuple[int, str], float]

    def at(self, node: int) -> Array:
        """Displacement of a node, shape (2,) [L]."""
        return self.nodes.get(node, NO_MOTION)[:2]


class Beam(NamedTuple):
    """A member that bends.

    Attributes
    ----------
    element, i, j : int
    along : ndarray, shape (2,)
        Direction from I to J.
    blocks : tuple of float
        Lengths of the rigid ends [L].
    length : float
        Between them [L].
    release : ndarray, shape (2, 2)
        Rotations of the ends against the chord from those behind pins and joints.
    """

    element: int
    i: int
    j: int
    along: Array
    blocks: tuple[float, float]
    length: float
    release: Array

    @property
    def across(self) -> Array:
        """Direction to the left of the line from I to J, shape (2,)."""
        return np.array([-self.along[1], self.along[0]])

    def ends(self, place: Mapping[int, Array], shift: Shift) -> tuple[Array, Array]:
        """Displaced ends of the flexible length, shape (2,) each [L]."""
        turn_i, turn_j = (shift.nodes[n][2] for n in (self.i, self.j))
        first = self.blocks[0] * (self.along + turn_i * self.across)
        last = self.blocks[1] * (self.along + turn_j * self.across)
        return place[self.i] + shift.at(self.i) + first, place[self.j] + shift.at(self.j) - last

    def bends(self, start: Array, end: Array, shift: Shift) -> Array:
        """Rotations of the `ends` against the chord between them, shape (2,)."""
        chord = float((end - start) @ self.across) / self.length
        at_i = shift.nodes[self.i][2] + shift.hinges.get((self.element, "I"), 0.0)
        at_j = shift.nodes[self.j][2] - shift.hinges.get((self.element, "J"), 0.0)
        bends: Array = self.release @ (np.array([at_i, at_j]) - chord)
        return bends

    def line(self, place: Mapping[int, Array], shift: Shift) -> Array:
        """Points from node I along the bent member to node J, shape (n, 2) [L]."""
        start, end = self.ends(place, shift)
        bow = self.length * self.bends(start, end, shift) @ _BOWS
        points: Array = start + np.outer(_X, end - start) + np.outer(bow, self.across)
        if any(self.blocks):
            points = np.vstack([place[self.i] + shift.at(self.i), points, place[self.j] + shift.at(self.j)])
        return points


def beams(results: Results, place: Mapping[int, Array]) -> dict[int, Beam]:
    """FRAME members with bending stiffness by element; none where there are too many to bend.

    A BEAM_COLUMN is none: the rotations of its hinges are not stored.
    """
    items = property_items(results)
    elements = [e for e in results.table("elements") if e["kind"] == "FRAME" and e["j"]]
    bent = [beam for e in elements if (beam := _beam(e, items.get(str(e["property"]), {}), place))]
    return {beam.element: beam for beam in bent} if len(bent) <= MOST else {}


def _beam(e: NDArray[Any], items: Mapping[str, str], place: Mapping[int, Array]) -> Beam | None:
    """Beam of a row of the table of elements and the items of its section; None for an axial bar."""
    ei = float(items.get("E", 0.0)) * float(items.get("I", 0.0))
    if ei == 0.0:
        return None
    i, j = int(e["i"]), int(e["j"])
    whole = place[j] - place[i]
    full = float(np.hypot(*whole))
    blocks = float(items["END1"]), float(items["END2"])
    length = full - sum(blocks)
    joints = [float(f) for f in items["FJ"].split(",")]
    fixity = [1.0 / (1.0 + f * ei / length) for f in (joints[0], joints[-1])]
    fixity = [0.0 if items["PIN"] in (end, "BOTH") else p for end, p in zip("IJ", fixity)]
    fixed, stiffness = np.diag(fixity), np.array([[4.0, 2.0], [2.0, 4.0]])
    release = np.linalg.inv(fixed + (np.eye(2) - fixed) @ stiffness) @ fixed
    return Beam(int(e["element"]), i, j, whole / full, blocks, length, release)


def property_items(results: Results) -> dict[str, dict[str, str]]:
    """Values of the items of each property set, as texts of the table `properties`."""
    items: dict[str, dict[str, str]] = {}
    for row in results.table("properties") if "properties" in results.tables else ():
        items.setdefault(str(row["property"]), {})[str(row["item"])] = str(row["value"])
    return items
