"""What kernels the program calls, and with what arguments: seen in small runs of every method."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pound_solve
from pound_deck.schema import REQUIRED
from pound_solve.catalog import members
from pound_solve.numerics.block import Block, with_numbers
from pound_solve.numerics.jit import Function
from pound_solve.numerics.providers import Interpreter

#: a bar that falls on a stop, for all methods; with members that turn, too, which need steps
DECK = """UNITS kN m s
GEOMETRY {geometry}
NODES
 1 0 0 FIX=XYR
 2 3 0
 3 3.1 0 FIX=XYR
ELEMENTS
 1 BAR 1 2
 2 STOP 2 3
PROPS
 BAR FRAME E=2e5 A=0.01 I=1e-4
 STOP CONTACT GAP=0.1 LAW=KELVIN_VOIGT K=1e4 E=0.7
WEIGHTS
 2 10
INITIAL
 2 VX=1
ANALYSIS
 HISTORY 0.03 METHOD={method}
"""


class Call(NamedTuple):
    """A kernel and the arguments of one call, functions of rules by their numbers.

    Attributes
    ----------
    kernel : callable
    arguments : tuple
    types : list of str
        See `block.Block`.
    """

    kernel: Function
    arguments: tuple[Any, ...]
    types: list[str]


def numbered(value: Any, numbers: dict[str, int]) -> Any:
    """An argument, tuples of functions in it replaced by arrays of their numbers."""
    if not isinstance(value, tuple):
        return value
    parts = with_numbers(value, numbers)
    if not isinstance(parts, tuple):
        return parts
    own = [numbered(part, numbers) for part in parts]
    return type(value)(*own) if hasattr(value, "_fields") else tuple(own)


def decks() -> Sequence[str]:
    """Decks that between them call every kernel."""
    methods = []
    for name, spec in members("method").items():
        needed = " ".join(f"{f.name}=0.01" for f in spec.fields if f.default is REQUIRED)
        methods.append(f"{name} {needed}")
    return [DECK.format(geometry=g, method=m) for g in ("SMALL", "LARGE") for m in methods]


def observed(numbers: dict[str, int]) -> list[Call]:
    """One call of every kernel that the program asks for, in the order of their names.

    Parameters
    ----------
    numbers : dict
        Numbers of the rules' functions by their names.

    Raises
    ------
    ValueError
        A kernel is called with arguments of different types.
    """
    found: dict[str, Call] = {}

    def ready(self: Interpreter, kernel: Function, signature: str = "") -> Function:
        if signature:
            return kernel

        def call(*arguments: Any) -> Any:
            types = Block(arguments, numbers).types
            first = found.setdefault(kernel.__name__, Call(kernel, numbered(arguments, numbers), types))
            if first.types != types or first.kernel is not kernel:
                raise ValueError(f"{kernel.__name__} is called with arguments of different types")
            return kernel(*arguments)

        return call

    Interpreter.ready = ready  # type: ignore[method-assign] # this process runs nothing else
    with tempfile.TemporaryDirectory() as folder:
        for n, deck in enumerate(decks()):
            path = Path(folder, f"{n}.inp")
            path.write_text(deck, encoding="utf-8")
            pound_solve.run(path, out=folder).close()
    return [found[name] for name in sorted(found)]
