"""A cache of results by the content of the arguments: several runs of one structure, as in a study or with
AUTO, order its unknowns and compute its modes only once.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

from pound_solve.numerics.matrices import entries

P = ParamSpec("P")
R = TypeVar("R")


def by_content(most: int) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Cache the results of a function for its most recent arguments, compared by content.

    The results are shared, so a caller must not modify them.

    Parameters
    ----------
    most : int
        Number of results to keep.

    Returns
    -------
    callable
        Decorator of functions of numbers, texts, arrays and matrices.
    """

    def remember(function: Callable[P, R]) -> Callable[P, R]:
        kept: dict[bytes, R] = {}  # the most recent last

        @wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            key = digest([*args, *kwargs.items()])
            result = kept.pop(key, None)  # other threads that need it meanwhile compute it again
            if result is None:
                result = function(*args, **kwargs)
            kept[key] = result
            for oldest in list(kept)[: max(len(kept) - most, 0)]:
                kept.pop(oldest, None)
            return result

        return call

    return remember


def digest(values: Any) -> bytes:
    """Return a digest of numbers, texts, arrays and matrices, and of sequences of these."""
    hasher = hashlib.sha256()
    for value in values:
        if isinstance(value, list | tuple):
            hasher.update(b"(" + digest(value))
        elif hasattr(value, "shape"):
            arrays = [value] if isinstance(value, np.ndarray) else entries(value)
            hasher.update(f"{value.shape} {[x.dtype.str for x in arrays]}".encode())
            for x in arrays:
                hasher.update(x.tobytes())
        else:
            hasher.update(f"{type(value).__name__} {value!r};".encode())
    return hasher.digest()
