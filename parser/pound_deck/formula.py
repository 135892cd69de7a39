"""A formula outside of a deck, in the arithmetic of its expressions: ``2*k + sqrt(gap)``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from pound_deck.cards import parse_items
from pound_deck.diagnostics import Diagnostic, Mistake
from pound_deck.expressions import Expression, evaluate
from pound_deck.source import LogicalLine

NAME = "formula"  #: of its file in diagnostics


class Formula:
    """A formula of some variables.

    Parameters
    ----------
    text : str
    names : iterable of str
        Its variables, in any case.

    Raises
    ------
    FormulaError
        It is no formula of these variables.
    """

    def __init__(self, text: str, names: Iterable[str]) -> None:
        self.text = text
        report: list[Diagnostic] = []
        try:
            # in brackets, within which blanks are allowed
            items = parse_items(LogicalLine(NAME, 1, f"({text})".replace("\n", " ")))
            parts = [part for item in items for part in item.parts]
            if len(parts) != 1 or items[0].name or not isinstance(parts[0], Expression):
                raise FormulaError(f"{text[:60]} is not one formula")
            self._expression = parts[0]
            known = {name.upper() for name in names}
            for step in self._expression.steps:
                if step.kind == "text" or (step.kind == "word" and step.text.upper() not in (*known, "PI")):
                    raise FormulaError(f"{step.text} in {text[:60]} is no number and no variable")
        except Mistake as error:
            error.keep(report)
            raise FormulaError(
                "; ".join(d.message for d in report) or f"{text[:60]} is no formula"
            ) from None

    def value(self, variables: Mapping[str, float]) -> float:
        """Value at values of the variables.

        Raises
        ------
        FormulaError
            It has none there, as a division by zero.
        """
        try:
            value = evaluate(self._expression, {name.upper(): x for name, x in variables.items()})
        except Mistake as error:
            report: list[Diagnostic] = []
            error.keep(report)
            raise FormulaError("; ".join(d.message for d in report)) from None
        assert not isinstance(value, str), "texts are refused when the formula is read"
        return value


class FormulaError(ValueError):
    """Raised if a text is no formula, or has no value; the message states why."""
