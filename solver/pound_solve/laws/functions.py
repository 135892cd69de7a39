"""The functions of the rules of a run, collected so that kernels can call them by number.

Compiled code can call functions by number only if all have the same types, but the numbers of parameters
and of internal variables differ between rules.  Here both tuples are as long as those of the longest rule,
and each function receives the first elements that it needs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from types import FunctionType
from typing import Any, NamedTuple

from pound_solve.laws.automaton import (
    EVENTS,
    BranchFunction,
    CurveFunction,
    EnergyFunction,
    Numbers,
    PowerFunction,
    PowerLawFunction,
    PowerLawNumbers,
    Rule,
    SmoothFunction,
    SmoothNumbers,
    TransitionFunction,
    rate_independent,
)
from pound_solve.numerics.jit import Function
from pound_solve.numerics.providers import provider
from pound_solve.numerics.types import Array

RowPart = Callable[[Array, int, int], Numbers]  #: numbers in a row of an array, starting at a column

ROOM = 8  #: the tables have room for this number of rules, or a multiple of it
#: lengths of the parameters and of the internal variables in the kernels: those of the longest rule of the
#: catalog, to which a test holds them, so that no run has to import every rule
PARAMETERS, VARIABLES = 20, 16


class RuleFunctions(NamedTuple):
    """The functions of several rules: one tuple per kind of function, in the order of the rules."""

    branch: tuple[BranchFunction, ...]
    transition: tuple[TransitionFunction, ...]
    recoverable: tuple[EnergyFunction, ...]
    curve: tuple[CurveFunction, ...]
    dissipated_power: tuple[PowerFunction, ...]
    power_law: tuple[PowerLawFunction, ...]
    smooth_curve: tuple[SmoothFunction, ...]


# the functions that kernels call; the library compiled ahead of time has its own, see `ahead_of_time`


def branch_of(rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch of rule `number`."""
    return rules.branch[number](p, at, m)


def transition_of(
    rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers, event: int, d: float, v: float
) -> tuple[int, Numbers]:
    """Return the state after a transition of rule `number`."""
    return rules.transition[number](p, at, m, event, d, v)


def recoverable_of(
    rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers, d: float, f: float
) -> float:
    """Return the recoverable energy of rule `number`."""
    return rules.recoverable[number](p, at, m, d, f)


def curve_of(
    rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the curve of rule `number`."""
    return rules.curve[number](p, at, m, d0, d, v)


def dissipated_power_of(
    rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers, d: float, v: float
) -> float:
    """Return the dissipated power of rule `number`."""
    return rules.dissipated_power[number](p, at, m, d, v)


def power_law_of(rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the power-law coefficients of rule `number`."""
    return rules.power_law[number](p, at, m)


def smooth_curve_of(
    rules: RuleFunctions, number: int, p: Numbers, at: int, m: Numbers, d: float, f: float
) -> SmoothNumbers:
    """Return the smooth curve of rule `number`."""
    return rules.smooth_curve[number](p, at, m, d, f)


#: the functions above, in the order of `RuleFunctions`
CALLS: tuple[Function, ...] = (
    branch_of,
    transition_of,
    recoverable_of,
    curve_of,
    dissipated_power_of,
    power_law_of,
    smooth_curve_of,
)

_P, _M = f"UniTuple(f8, {PARAMETERS})", f"UniTuple(f8, {VARIABLES})"
#: numba types of the functions
SIGNATURES = (
    f"UniTuple(f8, {3 + 3 * EVENTS})({_P}, i8, {_M})",
    f"Tuple((i8, {_M}))({_P}, i8, {_M}, i8, f8, f8)",
    f"f8({_P}, i8, {_M}, f8, f8)",
    f"UniTuple(f8, 4)({_P}, i8, {_M}, f8, f8, f8)",
    f"f8({_P}, i8, {_M}, f8, f8)",
    f"UniTuple(f8, 6)({_P}, i8, {_M})",
    f"UniTuple(f8, 7)({_P}, i8, {_M}, f8, f8)",
)


def straight(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Stand in for the curve of a rule that has none."""
    return 0.0, 0.0, 0.0, 0.0


def no_power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Stand in for the powers of a rule that has none."""
    return 0.0, 1.0, 0.0, 1.0, 0.0, 0.0


def no_smooth_curve(p: Numbers, at: int, m: Numbers, d: float, f: float) -> SmoothNumbers:
    """Stand in for the smooth curve of a rule that has none."""
    return 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0


def missing(*_: Any) -> Any:
    """Stand in for a function of a rule in the templates below; `bound` copies a template and puts the
    function of the rule in its place.
    """
    raise NotImplementedError


def bound(template: Function, name: str, **values: Any) -> Function:
    """Copy a function with other values for some globals, which compiled code treats as constants.

    A closure would be plainer, but `jit.compiled` finds the functions that a kernel calls among its
    globals, and numba would make the functions of a closure a part of the key of its cache.
    """
    copy = FunctionType(template.__code__, {**template.__globals__, **values}, template.__name__)
    copy.__qualname__ = f"{template.__name__}-{name}"  # name of the compiled code in the cache
    return copy


# ---------------------------------------------------------------------- rows of arrays as tuples

first: RowPart = missing  # `bound` sets this for each copy of the functions below
second: RowPart = missing
half = 0


def single_number(a: Array, i: int, j: int) -> Numbers:
    """Return number `j` of row `i` of an array, as a tuple of length 1."""
    return (a[i, j],)


def joined_halves(a: Array, i: int, j: int) -> Numbers:
    """Return the numbers in row `i` of an array from column `j` on, as a tuple."""
    return first(a, i, j) + second(a, i, j + half)


@cache
def from_place(length: int) -> RowPart:
    """Return a function ``numbers(a, i, j)``: `length` numbers of row `i` from column `j` on, as a
    tuple.
    """
    if length == 1:
        return single_number
    n = length // 2
    values = {"first": from_place(n), "second": from_place(length - n), "half": n}
    return bound(joined_halves, str(length), **values)


def start_of_row(a: Array, i: int) -> Numbers:
    """Return the first numbers of row `i` of an array."""
    return first(a, i, 0)


def row(length: int) -> Callable[[Array, int], Numbers]:
    """Return a function ``numbers(a, i)``: the first `length` numbers of row `i`, as a tuple."""
    return bound(start_of_row, str(length), first=from_place(length))


# ---------------------------------------------------------------------- functions of rules

function_of_rule = missing  # `bound` sets this and the lengths for each copy of the functions below
parameters = variables = 0


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch of a rule, see `Rule`."""
    piece: Numbers = function_of_rule(p[:parameters], at, m[:variables])
    return piece


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a transition of a rule."""
    at_after, m_after = function_of_rule(p[:parameters], at, m[:variables], event, d, v)
    return at_after, m_after + m[variables:]


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the recoverable energy of a rule."""
    energy: float = function_of_rule(p[:parameters], at, m[:variables], d, f)
    return energy


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the curve of a rule."""
    response: tuple[float, float, float, float] = function_of_rule(
        p[:parameters], at, m[:variables], d0, d, v
    )
    return response


def dissipated_power(p: Numbers, at: int, m: Numbers, d: float, v: float) -> float:
    """Return the dissipated power from the rule's own function."""
    stated: float = function_of_rule(p[:parameters], at, m[:variables], d, v)
    return stated


def power_by_rate(p: Numbers, at: int, m: Numbers, d: float, v: float) -> float:
    """Return the power of the rate-dependent part of a rule's curve, see `automaton.rate_power`, which
    numba could not cache because it takes another function as an argument.
    """
    moving = function_of_rule(p[:parameters], at, m[:variables], d, d, v)
    resting = function_of_rule(p[:parameters], at, m[:variables], d, d, 0.0)
    power: float = (moving[0] - resting[0]) * v
    return power


def power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the power-law coefficients of a rule."""
    numbers: PowerLawNumbers = function_of_rule(p[:parameters], at, m[:variables])
    return numbers


def smooth_curve(p: Numbers, at: int, m: Numbers, d: float, f: float) -> SmoothNumbers:
    """Return the smooth curve of a rule."""
    numbers: SmoothNumbers = function_of_rule(p[:parameters], at, m[:variables], d, f)
    return numbers


@cache
def functions(rule: Rule) -> tuple[Function, ...]:
    """Return the functions of a rule in the order of `RuleFunctions`, for tuples of `PARAMETERS` and
    `VARIABLES`.

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
    lengths = {"parameters": rule.parameters, "variables": rule.variables}

    def adapted(template: Function, function: Function) -> Function:
        code = function.__code__
        name = f"{function.__module__}.{function.__qualname__}-{code.co_firstlineno}"
        return bound(
            template, f"{name}-{rule.parameters}-{rule.variables}", function_of_rule=function, **lengths
        )

    return (
        adapted(branch, rule.branch),
        adapted(transition, rule.transition),
        adapted(recoverable, rule.recoverable),
        straight if rule.curve is None else adapted(curve, rule.curve),
        rate_independent
        if rule.curve is None
        else adapted(power_by_rate, rule.curve)
        if rule.dissipated_power is None
        else adapted(dissipated_power, rule.dissipated_power),
        no_power_law if rule.power_law is None else adapted(power_law, rule.power_law),
        no_smooth_curve if rule.smooth_curve is None else adapted(smooth_curve, rule.smooth_curve),
    )


def tables(rules: Sequence[Rule]) -> RuleFunctions:
    """Return the functions of the rules, ready to be called by number.

    The last rule is repeated to fill the tables up to a length that few decks exceed, because numba
    recompiles the kernels for every new length.
    """
    by_rule = [functions(r) for r in rules]
    by_rule += by_rule[-1:] * (-len(by_rule) % ROOM)
    ready = provider().ready
    return RuleFunctions(
        *(tuple(ready(f, s) for f in column) for column, s in zip(zip(*by_rule), SIGNATURES))
    )
