"""Named tuples by address: compiled kernels read the same parts as Python does, and hand on one number."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np
import pytest

from kernels import NUMBA
from pound_solve.numerics import jit, kernel_cache
from pound_solve.numerics.record import record
from pound_solve.numerics.types import Array, Flags, Index

pytestmark = NUMBA


class Counter:
    """The fields of a record."""

    count: int


class Inner(NamedTuple):
    """A part of several parts."""

    scale: float
    order: Index
    flags: Flags


class Parts(NamedTuple):
    """A part of every kind."""

    vector: Array
    inner: Inner
    whole: int
    flag: bool
    table: Array
    layers: Array
    pair: tuple[Array, Array]
    counter: Any
    last: float


def parts() -> Parts:
    inner = Inner(0.5, np.array([2, 0, 1]), np.array([True, False, True]))
    table, layers = np.arange(6.0).reshape(2, 3), np.arange(24.0).reshape(2, 3, 4)
    pair = (np.full(2, 7.0), np.full(4, 9.0))
    return Parts(np.arange(3.0), inner, -3, True, table, layers, pair, record(Counter), 0.25)


def weigh(inner: Inner, row: Array) -> float:
    """Sum of the entries of a row that are flagged."""
    total = 0.0
    for i in range(len(row)):
        if inner.flags[i]:
            total += inner.scale * row[inner.order[i]]
    return total


weigh.__module__ = f"pound_solve.{__name__}"  # functions of the program are compiled with their callers


def use(own: Parts, out: Array) -> float:
    """Read every part, write to arrays and to the record."""
    table, layers = own.table, own.layers
    for i in range(len(out)):
        out[i] = own.vector[i] + own.whole
        own.vector[i] += weigh(own.inner, table[1])  # seen by what reads the array afterwards
    total = own.last + own.vector.sum() + len(own.inner.order) + own.vector.size + table.size
    for k in range(layers.shape[0]):
        for j in range(layers.shape[2]):
            total += (k + 1) * layers[k, 1:, j].sum()
    for one in own.pair:
        total += one[-1] * len(one)
    own.counter.count += 1
    return total if own.flag else -total


def test_compiled_code_reads_and_writes_the_parts_as_python_does(monkeypatch: pytest.MonkeyPatch) -> None:
    # what is kept of a function whose module cannot be imported cannot be loaded again
    monkeypatch.setattr(kernel_cache, "cache_folder", lambda: kernel_cache.CacheFolder(None))
    slow, fast = parts(), parts()
    out, same = np.zeros(3), np.zeros(3)
    called = jit.Numba().ready(use)
    for count in (1, 2):
        assert called(fast, same) == use(slow, out) != 0.0
        assert fast.counter.count == slow.counter.count == count
        np.testing.assert_array_equal(fast.vector, slow.vector)
        np.testing.assert_array_equal(same, out)
    other = parts()._replace(flag=False, whole=5)
    assert called(other, same) == use(parts()._replace(flag=False, whole=5), out) < 0.0
    np.testing.assert_array_equal(same, out)


def test_a_tuple_is_one_argument_and_a_loop_reads_its_addresses_once() -> None:
    made: Any = jit.compiled(use, jit.kinds_of([parts(), np.zeros(3)]), inner=True)
    (own,) = made.overloads.values()
    function = own.library._final_module.get_function(own.fndesc.mangled_name)
    kinds = [str(argument.type) for argument in function.arguments]
    assert kinds == ["ptr"] * 3 + ["ptr", "ptr", "i64", "i64", "ptr", "i64", "i64"]  # those of `out`
    loads = re.findall(r"= load [^\n]*", str(function))
    assert sum("!invariant.load" in load for load in loads) > 10


@pytest.mark.parametrize("part", [np.zeros((4, 2))[:, 0], "text", ()])
def test_a_tuple_with_anything_else_in_it_is_handed_on_in_numbers(part: Any) -> None:
    class Odd(NamedTuple):
        part: Any
        size: float

    (kind,) = jit.kinds_of([Odd(part, 1.0)])
    assert not hasattr(kind, "parts")
