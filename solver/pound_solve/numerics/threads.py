"""The number of threads for numpy's linear algebra, which must be set before numpy is imported."""

from __future__ import annotations

import os
from typing import Final

#: environment variables that limit the threads of numpy builds
VARIABLES: Final = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def one() -> None:
    """Use one thread unless the user requests more: the last digits depend on the number of threads, and
    several threads are slower for small matrices.
    """
    for name in VARIABLES:
        os.environ.setdefault(name, "1")
