"""Kernels compiled ahead of time: a shared library next to this module, in platform-specific wheels.

`ahead_of_time` builds it from the same source.  Every kernel has an entry point in it, which takes one
block of numbers: all arguments in order, see `block.Block`.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from pound_solve.numerics.block import Block
from pound_solve.numerics.digest import digest
from pound_solve.numerics.jit import Function

FOLDER = Path(__file__).parent  #: folder of the libraries in a wheel
STEM = "kernels-"  #: start of the name of a library file; the digest of the source follows
CONTENTS = "contents"  #: function in a library that returns its contents, see `Library`
REFUSED = (
    "the compiled kernels here are not of this program and machine: install it anew, or, in a checkout, "
    "run `make kernels`"
)


class Library:
    """A library.  Its contents are lines of words: ``kernel``, its name and the types of its arguments; or
    ``function`` and the name of a rule's function, whose number is its position among these lines.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OSError
        The loader of the platform rejects it.
    """

    name, fast, loading = "compiled, from the library of the wheel", True, 0.0

    def __init__(self, path: Path) -> None:
        self._library = ctypes.CDLL(str(path))
        contents = getattr(self._library, CONTENTS)
        contents.restype = ctypes.c_char_p
        lines = [line.split() for line in contents().decode().splitlines()]
        self.types = {name: types for kind, name, *types in lines if kind == "kernel"}
        functions = [name for kind, name, *_ in lines if kind == "function"]
        self.numbers = {name: number for number, name in enumerate(functions)}

    def ready(self, kernel: Function, signature: str = "") -> Function:
        """See `providers.Provider`."""
        if signature:
            return kernel
        door, types = getattr(self._library, kernel.__name__), self.types[kernel.__name__]

        def call(*arguments: Any) -> int:
            block = Block(arguments, self.numbers)
            if block.types != types:
                raise TypeError(f"{kernel.__name__} is compiled for other arguments")
            result = ctypes.c_int64()
            if door(block.packed(), ctypes.byref(result)):
                raise ArithmeticError(f"an index out of range in {kernel.__name__}, or the like")
            return result.value

        return call

    def notice(self, kernel: Function) -> str:
        """See `providers.Provider`."""
        return ""


def load(folder: Path) -> Library | None:
    """Return the library of this version of the source, or None if this machine can load none."""
    for path in folder.glob(f"{STEM}{digest()}.*"):
        try:
            return Library(path)
        except OSError:
            continue
    return None


def present(folder: Path) -> bool:
    """Return whether there are libraries of any version."""
    return any(folder.glob(f"{STEM}*"))
