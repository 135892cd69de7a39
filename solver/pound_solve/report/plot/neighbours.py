r"""Neighbouring buildings drawn apart, so that a picture shows whether they touch.

Gaps are centimetres between buildings of tens of metres, and models often give the columns on both sides of
a gap the same place.  A picture that magnifies displacements by a factor f but not the gaps shows floors
that pass through each other.  Here buildings are moved along X until each contact has at least the drawn
distance that the picture needs: f g for a gap g.  If building b moves by :math:`o_b`, a contact of
direction a from node i to node j at a true distance D needs

.. math:: (o_{b(j)} - o_{b(i)})\,a_x \ge f g - D .

The least such moves are longest paths in the graph of buildings, found by relaxation (Bellman-Ford).  The
part of a contact that is longer is drawn as a rigid *reach* of node i, so that the reach touches node j
exactly when the contact closes.

References
----------
Cormen TH, Leiserson CE, Rivest RL, Stein C (2009), Introduction to Algorithms, 3rd edition, MIT Press,
section 24.4 (difference constraints).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from pound_solve.numerics.types import Array

LEVEL = 0.5  #: least horizontal component of a contact's direction that moves buildings apart


class Contact(NamedTuple):
    """A contact as it is drawn.

    Attributes
    ----------
    name : str
    i, j : int
        Its nodes; `j` is 0 for a wall.
    along : ndarray, shape (2,)
        Direction in which node I meets J.
    gap : float
        Initial gap [L].
    """

    name: str
    i: int
    j: int
    along: Array
    gap: float


def moves(
    contacts: Sequence[Contact],
    place: Mapping[int, Array],
    building: Mapping[int, int],
    distances: Mapping[str, float],
) -> dict[int, float]:
    """Least moves of the buildings along X that give contacts their drawn distances.

    Parameters
    ----------
    contacts : sequence of Contact
    place : mapping of int to ndarray, shape (2,)
        True places of the nodes [L].
    building : mapping of int to int
        Building of each node.
    distances : mapping of str to float
        Least distance that each contact is drawn with [L].

    Returns
    -------
    dict of int to float
        Move of each building [L].  Contacts that no moves satisfy together keep what was reached.
    """
    limits = []
    for c in contacts:
        if c.j and abs(c.along[0]) > LEVEL and building[c.i] != building[c.j]:
            lack = distances[c.name] - float((place[c.j] - place[c.i]) @ c.along)
            left, right = (c.i, c.j) if c.along[0] > 0.0 else (c.j, c.i)
            limits.append((building[left], building[right], lack / abs(float(c.along[0]))))
    moved = dict.fromkeys(sorted(set(building.values())), 0.0)
    for _ in moved:
        for left, right, lack in limits:
            moved[right] = max(moved[right], moved[left] + lack)
    return moved


def reach(contact: Contact, place: Mapping[int, Array], distance: float) -> Array:
    """Point fixed to node I, relative to it, that touches node J when a contact of that drawn distance
    closes, shape (2,) [L].
    """
    if not contact.j:
        return np.zeros(2)
    whole = float((place[contact.j] - place[contact.i]) @ contact.along)
    return max(whole - distance, 0.0) * contact.along
