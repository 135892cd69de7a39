"""Connected components: which unknowns are coupled, directly or through others.

Plain numpy, because small decks do not import scipy (its `connected_components` would take longer to import
than these decks to run): in every round each component takes the lowest label next to it, which halves the
number of unfinished components at least.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from pound_solve.numerics.matrices import Matrix, entries
from pound_solve.numerics.types import Index


def components(n: int, matrices: Iterable[Matrix] = (), groups: Iterable[Index] = ()) -> Index:
    """Connected component of every vertex, denoted by its lowest vertex, shape (n,).

    Parameters
    ----------
    n : int
        Number of vertices.
    matrices : iterable of Matrix, shape (n, n)
        An entry other than zero couples its row and its column.
    groups : iterable of ndarray of int
        Vertices that are coupled to each other.
    """
    pairs = [np.stack(entries(a)[:2]) for a in matrices]
    pairs += [np.stack([np.broadcast_to(g[:1], len(g)), g]) for g in groups]
    i, j = np.concatenate([np.zeros((2, 0), np.int64), *pairs], axis=1).astype(np.int64)
    label = np.arange(n)
    while (apart := label[i] != label[j]).any():
        i, j = i[apart], j[apart]
        a, b = label[i], label[j]
        np.minimum.at(label, np.maximum(a, b), np.minimum(a, b))
        while (label[label] != label).any():
            label = label[label]
    return label
