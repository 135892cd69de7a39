"""The memory layout of kernel arguments for compiled code."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array, Index


class Block:
    """Arguments of a kernel as 64-bit numbers.

    An array has the layout of compiled code: two owners, which kernels do not use; the number of elements
    and the size of one element; the address, shape and strides.  A record is stored as its address, and a
    function of a rule as its number.

    Parameters
    ----------
    arguments : sequence
    numbers : mapping
        Numbers of the rules' functions by their names.

    Attributes
    ----------
    cells : list of int or float
    types : list of str
        One for every argument and for every part of an argument.
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
        """Return the numbers as bytes in memory order."""
        return struct.pack(
            "=" + "".join("d" if isinstance(x, float) else "q" for x in self.cells), *self.cells
        )


def with_numbers(value: tuple[Any, ...], numbers: Mapping[str, int]) -> tuple[Any, ...] | Index:
    """Return the tuple itself or, for a tuple of functions, an array of their numbers."""
    if not value or not callable(value[0]):
        return value
    return np.array([numbers[f.__qualname__] for f in value], np.int64)
