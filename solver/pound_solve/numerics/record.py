"""Records: named numbers in one block of memory, which compiled code modifies in place."""

from __future__ import annotations

from typing import Any, get_type_hints

import numpy as np


def record(kind: type) -> Any:
    """Return a numpy record with the fields of a protocol, integers and floats, all zero."""
    numbers = {int: np.int64, float: np.float64}
    fields = [(name, numbers[hint]) for name, hint in get_type_hints(kind).items()]
    return np.zeros(1, np.dtype(fields, align=True)).view(np.recarray)[0]
