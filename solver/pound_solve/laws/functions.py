"""The functions of the rules of a run, gathered so that kernels call them by number.

Compiled code calls functions by number where all have the same types.  A rule's parameters and internal
variables have lengths of its own: here they are tuples of the lengths of the longest, and every function
is given the first of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from pound_solve.laws.automaton import EVENTS, Numbers, Rule, rate_independent, rate_power
from pound_solve.numerics.jit import Function, compiled, numba

ROOM = 8  #: rules that the tables have room for, or a multiple of it
#: lengths of the parameters and of the internal variables in the kernels: those of the longest rule of the
#: catalog, to which a test holds them, so that no run has to import every rule
PARAMETERS, VARIABLES = 20, 16


class Tables(NamedTuple):
    """The functions of several rules, one tuple a kind, in the order of the rules."""

    branch: tuple[Function, ...]
    transition: tuple[Function, ...]
    recoverable: tuple[Function, ...]
    curve: tuple[Function, ...]
    power: tuple[Function, ...]


def straight(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Stand in for the curve of a rule that has none."""
    return 0.0, 0.0, 0.0, 0.0


def written(name: str, source: str, **scope: Function) -> Function:
    """Function from source that was put together, which calls those of `scope`.

    numba needs the length of a tuple to stand in the source.
    """
    space: dict[str, Any] = {"__name__": __name__, **scope}
    exec(compile(source, __file__, "exec"), space)
    (function,) = (space[x] for x in space if x not in scope and not x.startswith("__"))
    function.__qualname__ = name  # compiled code is kept under it
    return function


def row(length: int) -> Function:
    """Function ``row(a, i)`` that returns the first `length` numbers in row `i` of an array as a tuple."""
    numbers = "".join(f"a[i, {j}], " for j in range(length))
    return written(f"row_{length}", f"def row(a, i):\n    return ({numbers})\n")


def functions(rule: Rule) -> tuple[Function, ...]:
    """Functions of a rule in the order of `Tables`, each for the lengths `PARAMETERS` and `VARIABLES`.

    Raises
    ------
    ValueError
        The rule has more parameters or variables than the kernels have room for.
    """
    if rule.parameters > PARAMETERS or rule.variables > VARIABLES:
        raise ValueError(
            f"a rule has {rule.parameters} parameters and {rule.variables} internal variables: the kernels "
            f"have room for {PARAMETERS} and {VARIABLES}, see PARAMETERS and VARIABLES in {__name__}"
        )
    p, m, rest = f"p[:{rule.parameters}]", f"m[:{rule.variables}]", f"m[{rule.variables}:]"

    def adapted(own: Function, given: str, body: str) -> Function:
        name = f"{own.__module__}.{own.__qualname__}-{own.__code__.co_firstlineno}"
        return written(
            f"{name}-{rule.parameters}-{rule.variables}", f"def adapted(p, at, m{given}):\n{body}", own=own
        )

    curve, power = straight, rate_independent
    if rule.curve is not None:
        curve = adapted(rule.curve, ", d0, d, v", f"    return own({p}, at, {m}, d0, d, v)\n")
        if rule.power is not None:
            power = adapted(rule.power, ", d, v", f"    return own({p}, at, {m}, d, v)\n")
        else:
            body = f"    return rate_power(own, {p}, at, {m}, d, v)\n"
            power = written(
                f"power-{curve.__qualname__}",
                f"def adapted(p, at, m, d, v):\n{body}",
                own=rule.curve,
                rate_power=rate_power,
            )
    return (
        adapted(rule.branch, "", f"    return own({p}, at, {m})\n"),
        adapted(
            rule.transition,
            ", event, d, v",
            f"    to, now = own({p}, at, {m}, event, d, v)\n    return to, now + {rest}\n",
        ),
        adapted(rule.recoverable, ", d, f", f"    return own({p}, at, {m}, d, f)\n"),
        curve,
        power,
    )


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
        p, m = t.UniTuple(f8, PARAMETERS), t.UniTuple(f8, VARIABLES)
        signatures = [
            t.UniTuple(f8, 3 + 3 * EVENTS)(p, i8, m),
            t.Tuple((i8, m))(p, i8, m, i8, f8, f8),
            f8(p, i8, m, f8, f8),
            t.UniTuple(f8, 4)(p, i8, m, f8, f8, f8),
            f8(p, i8, m, f8, f8),
        ]
    own = [functions(r) for r in rules]
    own += own[-1:] * (-len(own) % ROOM)
    return Tables(*(tuple(compiled(f, s) for f in column) for column, s in zip(zip(*own), signatures)))
