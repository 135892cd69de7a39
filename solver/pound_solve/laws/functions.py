"""The functions of the rules of a run, gathered so that kernels call them by number.

Compiled code calls functions by number where all have the same types.  A rule's parameters and internal
variables have lengths of its own: here they are tuples of the lengths of the longest, and every function
is given the first of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import import_module
from pkgutil import iter_modules, walk_packages
from typing import Any, NamedTuple

from pound_solve import laws
from pound_solve.laws.automaton import EVENTS, Numbers, Rule, rate_independent, rate_power
from pound_solve.numerics.jit import Function, compiled, numba

ROOM = 8  #: rules that the tables have room for, or a multiple of it


def known() -> Iterator[Rule]:
    """Rules of all modules in the packages of this one."""
    families = [f"{laws.__name__}.{m.name}" for m in iter_modules(laws.__path__) if m.ispkg]
    for family in families:
        for module in walk_packages(import_module(family).__path__, f"{family}."):
            rule = getattr(import_module(module.name), "RULE", None)
            if rule is not None:
                yield rule


#: lengths of the parameters and of the internal variables that kernels know: of the longest
PARAMETERS, VARIABLES = (max(lengths) for lengths in zip(*((r.parameters, r.variables) for r in known())))


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
        The rule has more parameters or variables than any rule in the folders of this package.
    """
    if rule.parameters > PARAMETERS or rule.variables > VARIABLES:
        raise ValueError(
            f"a rule has {rule.parameters} parameters and {rule.variables} internal variables: the longest "
            f"in laws/ have {PARAMETERS} and {VARIABLES}, put its file there"
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
