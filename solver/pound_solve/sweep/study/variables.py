"""Variables of a study: PARAMs of its deck, or the strength of its records, that a verb varies by itself.

The table ``[variables]`` gives each a line.  Its value is that of the deck unless the study gives another.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import suggest
from pound_deck.model import Model
from pound_solve.sweep.study.document import Document, Path_

TABLE: Final = "variables"
MOTION: Final = "motion"  #: name of the factor on all records of [[motions]], unless a PARAM has this name
#: items of a variable, those of all verbs: one study serves several
ITEMS: Final = ("value", "low", "high", "scale", "distribution", "mean", "sd", "cov", "mode")


@dataclass(frozen=True)
class StudyVariable:
    """One variable.

    Attributes
    ----------
    name : str
        Of a PARAM as the study writes it, or `MOTION`.
    value : float
        Its value in the deck, or the one that the study gives.
    low, high : float
        Bounds; infinite without one.
    """

    name: str
    value: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def path(self) -> Path_:
        """Path of the variable in the study."""
        return TABLE, self.name


def given_values(document: Document) -> dict[str, float | None]:
    """Value of every variable as the study gives it; None where it is that of the deck."""
    values: dict[str, float | None] = {}
    for name in document.take((TABLE,), dict, {}):
        document.take((TABLE, name), dict, {})
        values[name] = document.take((TABLE, name, "value"), float, None)
    if not values:
        message = "the study names no variables"
        document.mistake("S604", message, (TABLE,), f"[{TABLE}] with a line for each PARAM: gap = {{}}")
    return values


def study_variables(document: Document, model: Model) -> Iterator[StudyVariable]:
    """Yield the variables of a study; mistakes are added to the document.

    Parameters
    ----------
    document : Document
    model : Model
        Its deck, which has the other values.
    """
    params = {name.upper(): value for name, value in model.params.items()}
    for name, given in given_values(document).items():
        path = (TABLE, name)
        document.known(path, ITEMS)
        value = _value(document, name, given, params)
        if math.isnan(value):
            continue
        low = document.take((*path, "low"), float, -math.inf)
        high = document.take((*path, "high"), float, math.inf)
        if not low < high:
            document.mistake("S605", f"low is below high, not {low:g} and {high:g}", path)
        elif not low <= value <= high:
            message = f"{name} is {value:g}, outside of its bounds {low:g} and {high:g}"
            document.mistake("S605", message, path, "give a value within them")
        else:
            yield StudyVariable(name, value, low, high)


def _value(document: Document, name: str, given: float | None, params: Mapping[str, float | str]) -> float:
    """Value of a variable; NaN, with a mistake, where there is none."""
    there = params.get(name.upper())
    if isinstance(there, str):
        document.mistake("S605", f"PARAM {name} is a text: a variable is a number", (TABLE, name))
        return math.nan
    if there is None and name != MOTION:
        hint = suggest(name, list(params)) or f"its PARAMs: {', '.join(params).lower() or 'none'}"
        document.mistake("S604", f"the deck has no PARAM {name}", (TABLE, name), hint)
        return math.nan
    if there is None and not document.tables("motions"):
        message = f"{MOTION} is the factor on the records of [[motions]], and the study has none"
        document.mistake(
            "S604", message, (TABLE, name), "name the PARAM by which the deck scales its motion"
        )
        return math.nan
    return given if given is not None else 1.0 if there is None else there
