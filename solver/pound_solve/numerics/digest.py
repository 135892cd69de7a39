"""A digest of the source of the kernels, which identifies the compiled code that belongs to it."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

#: files of the kernels and their dependencies
KERNELS = (
    "numerics/*.py",
    "laws/**/*.py",
    "structure/corotational.py",
    "integrate/[!a]*.py",  # AUTO calls the other methods and has no kernel
    "integrate/[!c]*/*.py",  # all methods but the closed forms, which are written in numpy
)


@cache
def digest() -> str:
    """Return the digest of the source of all kernels."""
    program = Path(__file__).parents[1]
    sources = sorted(p for pattern in KERNELS for p in program.glob(pattern))
    return hashlib.sha256(b"".join(p.read_bytes() for p in sources)).hexdigest()[:16]
