"""The number of threads of numpy's linear algebra, which must be set before numpy is imported."""

from __future__ import annotations

import os
from typing import Final

#: environment variables by which its builds limit their threads
VARIABLES: Final = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def one() -> None:
    """Use one thread unless the user asks for more: the last digits depend on the number of threads, and
    several make small matrices slower.
    """
    for name in VARIABLES:
        os.environ.setdefault(name, "1")
