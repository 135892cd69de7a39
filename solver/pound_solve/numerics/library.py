"""Kernels compiled ahead of time: a shared library beside this module, in the wheel of a platform.

`ahead_of_time` builds it from the same source.  A kernel has a door in it, which takes one block of
numbers: the arguments one after the other, see `Block`.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pound_solve.numerics.digest import digest
from pound_solve.numerics.jit import Function
from pound_solve.numerics.types import Array, Index

FOLDER = Path(__file__).parent  #: where a wheel puts libraries
STEM = "kernels-"  #: of a library's file; the digest of the source follows
CONTENTS = "contents"  #: function in a library that returns what it holds, see `Library`
REFUSED = "the compiled kernels here are not of this program and machine: install it anew"


class Block:
    """Arguments of a kernel as numbers of 64 bits.

    An array is laid out as in compiled code: two owners, which kernels do not know; the number of its
    elements and the size of one; its address, shape and strides.  A record is its address, a function of a
    rule its number.

    Parameters
    ----------
    arguments : sequence
    numbers : mapping
        Numbers of the rules' functions by their names.

    Attributes
    ----------
    cells : list of int or float
    types : list of str
        One for every argument and part of one.
    """

    def __init__(self, arguments: Sequence[Any], numbers: Mapping[str, int]) -> None:
        self.cells: list[int | float] = []
        self.types: list[str] = []
        self._numbers, self._kept = numbers, list[Any]()
        self._take(tuple(arguments))

    def _take(self, value: Any) -> None:
        """Lay out an argument."""
        if isinstance(value, tuple):
            value = with_numbers(value, self._numbers)
        if isinstance(value, tuple):
            for part in value:
                self._take(part)
        elif isinstance(value, np.ndarray):
            self._take_array(value)
        elif isinstance(value, np.void):
            self._kept.append(np.frombuffer(value, np.uint8))
            self.cells.append(self._kept[-1].ctypes.data)
            self.types.append("".join(str(field[1]) for field in value.dtype.descr))
        elif isinstance(value, float):
            self.cells.append(float(value))
            self.types.append("real")
        else:
            self.cells.append(int(value))
            self.types.append("flag" if isinstance(value, bool | np.bool_) else "whole")

    def _take_array(self, a: Array) -> None:
        """Lay out an array.

        Raises
        ------
        TypeError
            The array has gaps.
        """
        if not a.flags.c_contiguous:
            raise TypeError("a kernel takes arrays without gaps")
        self._kept.append(a)
        address = a.__array_interface__["data"][0]
        self.cells += [0, 0, a.size, a.itemsize, address, *a.shape, *a.strides]
        self.types.append(f"{a.dtype.str}{a.ndim}")

    def packed(self) -> bytes:
        """The numbers as they lie in memory."""
        return struct.pack(
            "=" + "".join("d" if isinstance(x, float) else "q" for x in self.cells), *self.cells
        )


def with_numbers(value: tuple[Any, ...], numbers: Mapping[str, int]) -> tuple[Any, ...] | Index:
    """The tuple, or, if it is one of functions, an array of their numbers in its stead."""
    if not value or not callable(value[0]):
        return value
    return np.array([numbers[f.__qualname__] for f in value], np.int64)


class Library:
    """A library, whose contents are lines of words: ``kernel``, its name and the types of its arguments;
    ``function`` and the name of a rule's function, the number of which is its place among them.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OSError
        The platform's loader does not take it.
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
    """The library of this version of the source; None where there is none that this machine can load."""
    for path in folder.glob(f"{STEM}{digest()}.*"):
        try:
            return Library(path)
        except OSError:
            continue
    return None


def present(folder: Path) -> bool:
    """Whether there are libraries, of whatever version."""
    return any(folder.glob(f"{STEM}*"))
