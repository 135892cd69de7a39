"""Functions that call those of a rule by number, for a library that holds all rules."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from types import FunctionType
from typing import Any

import pound_solve.laws
from pound_solve.laws import functions
from pound_solve.laws.automaton import Rule
from pound_solve.laws.condensed import condensed
from pound_solve.modules import modules_below
from pound_solve.numerics.jit import Function


def rules() -> list[Rule]:
    """All rules of the program, in the order of their modules, then those of long hinges."""
    found = [
        value
        for name in modules_below(pound_solve.laws)
        for value in vars(import_module(name)).values()
        if isinstance(value, Rule)
    ]
    shortened = [condensed(rule) for rule in found if may_lack_its_elastic_part(rule)]
    return list(dict.fromkeys([*found, *shortened]))


def may_lack_its_elastic_part(rule: Rule) -> bool:
    """Whether a hinge may follow the rule and leave some of its elastic rotation to the beam."""
    return rule.curve is None and ".hysteresis." in rule.branch.__module__


def columns() -> list[list[Function]]:
    """The functions of all rules: a list for every field of `functions.Tables`."""
    own = [functions.functions(rule) for rule in rules()]
    return [list({f.__qualname__: f for f in column}.values()) for column in zip(*own)]


def numbers() -> dict[str, int]:
    """Numbers of all functions of rules by their names."""
    names = [f.__qualname__ for column in columns() for f in column]
    return {name: n for n, name in enumerate(names)}


def dispatcher(call: Function, field: str, own: Sequence[Function], numbers: dict[str, int]) -> Function:
    """The function of `functions.CALLS` for a library: it finds a rule's function by number.

    Parameters
    ----------
    call : callable
    field : str
        Of `functions.Tables`, which holds numbers instead of functions.
    own : sequence of callable
        The functions that may be called.
    numbers : dict
        Their numbers by their names.
    """
    code = call.__code__
    names = code.co_varnames[: code.co_argcount]
    given = ", ".join(names[2:])
    lines = [f"def {call.__name__}({', '.join(names)}):", f"    which = {names[0]}.{field}[{names[1]}]"]
    for n, function in enumerate(own[:-1]):
        lines += [f"    if which == {numbers[function.__qualname__]}:", f"        return own_{n}({given})"]
    lines.append(f"    return own_{len(own) - 1}({given})")
    scope: dict[str, Any] = {f"own_{n}": function for n, function in enumerate(own)}
    scope["__name__"] = functions.__name__
    exec("\n".join(lines), scope)
    made: Function = scope[call.__name__]
    return made


def dispatchers(numbers: dict[str, int]) -> dict[Function, Function]:
    """What a library calls instead of each of `functions.CALLS`, see `dispatcher`."""
    fields = zip(functions.CALLS, functions.RuleFunctions._fields, columns())
    return {call: dispatcher(call, field, own, numbers) for call, field, own in fields}


def put_in_place(made: dict[Function, Function]) -> None:
    """Let every module of the program call functions in the place of others, in this process."""
    for name, module in list(sys.modules.items()):
        if name.startswith("pound_solve"):
            for key, value in list(vars(module).items()):
                if isinstance(value, FunctionType) and value in made:
                    setattr(module, key, made[value])
