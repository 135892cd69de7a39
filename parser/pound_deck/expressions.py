"""Arithmetic of the deck: expressions as postfix steps, PARAM values, no ``eval``.

An expression is kept as the list of steps of a pocket calculator (`1 + 2*n` becomes ``1 2 n * +``), so that
no recursion is needed, however long a line of a deck is.
"""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake, mistake, suggest
from pound_deck.model import Span

Value = float | str


@dataclass(frozen=True, slots=True)
class ExpressionStep:
    """A ``number``, ``word`` or ``text``, or a ``call`` or ``operator`` that takes `arity` values."""

    kind: str
    text: str
    span: Span
    arity: int = 0


@dataclass(frozen=True, slots=True)
class Expression:
    """A number, word, text or formula of the deck, with its `text` as written."""

    steps: tuple[ExpressionStep, ...]
    span: Span
    text: str

    @property
    def lone(self) -> ExpressionStep | None:
        """The only step of an expression; None if it has several."""
        return self.steps[0] if len(self.steps) == 1 else None

    @property
    def lone_word(self) -> str:
        """The word in upper case, where the expression is just an unquoted word; else empty."""
        return self.steps[0].text.upper() if len(self.steps) == 1 and self.steps[0].kind == "word" else ""


@dataclass(frozen=True, slots=True)
class Range:
    """``first TO last BY step``."""

    first: Expression
    last: Expression
    step: Expression | None
    span: Span

    @property
    def text(self) -> str:
        """The range as written, with single blanks."""
        return f"{self.first.text} TO {self.last.text}" + (f" BY {self.step.text}" if self.step else "")


@dataclass(frozen=True, slots=True)
class Definition:
    """A PARAM of the deck: its name as written and its value."""

    name: str
    value: Expression
    span: Span


def _round(x: float) -> float:
    """Round to the nearest whole number, halves away from zero as Fortran's NINT."""
    return math.copysign(math.floor(abs(x) + 0.5), x)


_OF_MATH: Final = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "log10")
_OF_MANY: Final = {"MIN": min, "MAX": max}  #: take one value or more
FUNCTIONS: Final[Mapping[str, Callable[..., float]]] = {
    **{name.upper(): getattr(math, name) for name in _OF_MATH},
    "ABS": abs,
    **_OF_MANY,
    "FLOOR": math.floor,
    "CEIL": math.ceil,
    "ROUND": _round,
    "INT": math.trunc,
}
#: reserved names, which no PARAM can have
RESERVED: Final = frozenset(FUNCTIONS) | {"PI", "TO", "BY", "NAN", "INF", "INFINITY"}
_CALLS: Final = "functions are " + ", ".join(name.lower() for name in FUNCTIONS)


def evaluate(expression: Expression, params: Mapping[str, Value | None]) -> Value:
    """Value of an expression.

    Parameters
    ----------
    expression : Expression
    params : mapping of str to float, str or None
        Values by upper-case name; None for one whose own mistake is already reported.

    Returns
    -------
    float or str
        Finite number; a text only where the expression is nothing but a text or the name of one.

    Raises
    ------
    Mistake
        With a diagnostic, unless it only repeats one.
    """
    stack: list[Value] = []
    for step in expression.steps:
        if step.arity:
            values = stack[-step.arity :]
            del stack[-step.arity :]
            stack.append(_apply(step, values))
        else:
            stack.append(_leaf(step, params))
    return stack[0]


def _leaf(step: ExpressionStep, params: Mapping[str, Value | None]) -> Value:
    if step.kind == "text":
        return step.text
    if step.kind == "number":
        return _finite(float(step.text.upper().replace("D", "E")), step)
    name = step.text.upper()
    if name == "PI":
        return math.pi
    if name in params:
        value = params[name]
        if value is None:
            raise Mistake
        return value
    if name in FUNCTIONS:
        message = f"{step.text} is a function"
        raise mistake(
            "P222", message, step.span, f"write {step.text}(...) with no blank before the bracket"
        )
    hint = suggest(name, chain(params, ["PI"])) or "define it with PARAM, or put a text in quotes"
    raise mistake("P222", f"{step.text} is no number and no PARAM of this deck", step.span, hint)


def _apply(step: ExpressionStep, values: list[Value]) -> float:
    numbers = [v for v in values if not isinstance(v, str)]
    if len(numbers) < len(values):
        text = next(v for v in values if isinstance(v, str))
        raise mistake("P227", f'the text "{text[:60]}" is not a number', step.span, "use a number")
    try:
        return _finite(_call(step, numbers) if step.kind == "call" else _operate(step.text, numbers), step)
    except ZeroDivisionError:
        raise mistake("P223", "division by zero", step.span, "the part after / or ^ makes it so") from None
    except OverflowError:
        raise mistake("P224", "the value is too large", step.span, "the limit is 1.8e308") from None
    except ValueError:
        shown = ", ".join(f"{x:g}" for x in numbers)
        message = f"{step.text} has no real value for {shown}"
        raise mistake("P225", message, step.span, "the arguments must be in its range") from None


def _call(step: ExpressionStep, numbers: list[float]) -> float:
    name = step.text.upper()
    if name not in FUNCTIONS:
        raise mistake(
            "P226", f"there is no function {step.text}", step.span, suggest(name, FUNCTIONS) or _CALLS
        )
    if name in _OF_MANY and numbers:
        return float(_OF_MANY[name](numbers))
    if len(numbers) != 1:
        takes = "one or more values" if name in _OF_MANY else "one value"
        raise mistake("P226", f"{step.text} takes {takes}, not {len(numbers)}", step.span, _CALLS)
    return float(FUNCTIONS[name](*numbers))


def _operate(sign: str, numbers: list[float]) -> float:
    if len(numbers) == 1:
        return -numbers[0] if sign == "-" else numbers[0]
    a, b = numbers
    match sign:
        case "+":
            return a + b
        case "-":
            return a - b
        case "*":
            return a * b
        case "/":
            return a / b
    if a == 0 and b < 0:
        raise ZeroDivisionError
    return math.pow(a, b)


def _finite(value: float, step: ExpressionStep) -> float:
    if not math.isfinite(value):
        raise mistake(
            "P224", f"{step.text} gives a number that is too large", step.span, "the limit is 1.8e308"
        )
    return value


def resolve(
    definitions: Mapping[str, Definition], report: list[Diagnostic], lost: Iterable[str] = ()
) -> dict[str, Value | None]:
    """Values of all PARAMs by upper-case name; None, with a diagnostic, for those that have none.

    Forward references are allowed.  Names are resolved with a stack, not by recursion.

    Parameters
    ----------
    definitions : mapping of str to Definition
    report : list of Diagnostic
        Receives the mistakes.
    lost : iterable of str
        Names whose definition could not be read, which is reported already.
    """
    values: dict[str, Value | None] = dict.fromkeys(lost)
    known = ChainMap(values, dict.fromkeys(definitions))
    for root in definitions:
        path = {root: None}
        while path:
            name = next(reversed(path))
            definition = definitions[name]
            waits = next(
                (n for n in _names(definition.value) if n in definitions and n not in values), None
            )
            if name in values or waits is None:
                del path[name]
                if name not in values:
                    values[name] = _value(definition, known, report)
            elif waits in path:
                circle = [*list(path)[list(path).index(waits) :], waits]
                shown = " -> ".join(circle[:8] + ["..."] * (len(circle) > 8))
                message = f"PARAM {waits} depends on itself: {shown}"
                report.append(
                    Diagnostic("P228", message, definitions[waits].span, "give one of them a number")
                )
                values.update(dict.fromkeys(circle))
            else:
                path[waits] = None
    return values


def _names(expression: Expression) -> list[str]:
    return [step.text.upper() for step in expression.steps if step.kind == "word"]


def _value(
    definition: Definition, known: Mapping[str, Value | None], report: list[Diagnostic]
) -> Value | None:
    try:
        return evaluate(definition.value, known)
    except Mistake as error:
        error.keep(report)
        return None
