"""The functions of the rules of a run, gathered so that kernels call them by number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from pound_solve.laws.automaton import EVENTS, MEMORY, PARAMETERS, Rule
from pound_solve.numerics.jit import Function, compiled, numba

ROOM = 8  #: rules that the tables have room for, or a multiple of it


class Tables(NamedTuple):
    """The functions of several rules, one tuple a kind, in the order of the rules."""

    branch: tuple[Function, ...]
    transition: tuple[Function, ...]
    recoverable: tuple[Function, ...]
    curve: tuple[Function, ...]


def straight(
    p: tuple[float, ...], at: int, m: tuple[float, ...], d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Stand in for the curve of a rule that has none."""
    return 0.0, 0.0, 0.0, 0.0


def tables(rules: Sequence[Rule]) -> Tables:
    """Functions of the rules, compiled to be called by number.

    The last rule fills the tables up to a length that hardly a deck exceeds: numba compiles the kernels
    anew for every length.
    """
    found = numba()
    signatures = [None] * len(Tables._fields)
    if found is not None:
        t = found.types
        f8, i8 = t.float64, t.int64
        p, m = t.UniTuple(f8, PARAMETERS), t.UniTuple(f8, MEMORY)
        signatures = [
            t.UniTuple(f8, 3 + 3 * EVENTS)(p, i8, m),
            t.Tuple((i8, m))(p, i8, m, i8, f8, f8),
            f8(p, i8, m, f8, f8),
            t.UniTuple(f8, 4)(p, i8, m, f8, f8, f8),
        ]
    own = [(r.branch, r.transition, r.recoverable, r.curve or straight) for r in rules]
    own += own[-1:] * (-len(own) % ROOM)
    return Tables(*(tuple(compiled(f, s) for f in column) for column, s in zip(zip(*own), signatures)))
