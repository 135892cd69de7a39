"""Connected components: which unknowns are coupled, directly or through others.

This is plain numpy, because small decks do not import scipy (importing its `connected_components` would
take longer than running these decks).  In every round each component takes the lowest adjacent label, which
at least halves the number of unfinished components.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from pound_solve.numerics.matrices import Matrix, entries
from pound_solve.numerics.types import Index


def components(n: int, matrices: Iterable[Matrix] = (), groups: Iterable[Index] = ()) -> Index:
    """Return the connected component of every vertex, identified by its lowest vertex, shape (n,).

    Parameters
    ----------
    n : int
        Number of vertices.
    matrices : iterable of Matrix, shape (n, n)
        A non-zero entry couples its row and its column.
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
