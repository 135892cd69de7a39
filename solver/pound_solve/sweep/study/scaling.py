"""Bounds and scales of the variables between which a verb searches."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from pound_deck.diagnostics import suggest
from pound_solve.statistics.design_variable import DesignVariable
from pound_solve.sweep.study.document import Document, Path_
from pound_solve.sweep.study.variables import TABLE, StudyVariable, given_values

LINEAR, LOG = SCALES = ("linear", "log")


def scales(document: Document) -> dict[str, str]:
    """Scale of every variable, one of `SCALES`; mistakes of scales and bounds are added to the document."""
    return {name: _scale(document, name) for name in given_values(document)}


def _scale(document: Document, name: str) -> str:
    """Scale of a variable, whose bounds are checked."""
    path: Path_ = (TABLE, name)
    low, high = (document.take((*path, item), float, math.nan) for item in ("low", "high"))
    if math.isnan(low) or math.isnan(high):
        hint = f"{name} = {{ low = ..., high = ... }}: the search stays between them"
        document.mistake("S604", f"{name} needs low and high", path, hint)
    scale = word(document, (*path, "scale"), SCALES)
    if scale == LOG and low <= 0.0:
        document.mistake("S605", f"a logarithmic scale needs low above zero, not {low:g}", path)
    return scale


def word(document: Document, path: Path_, words: Sequence[str]) -> str:
    """Word of an item; the first one where it is left out."""
    given = document.take(path, str, words[0])
    if given not in words:
        hint = suggest(given, list(words)) or f"there are {' and '.join(words)}"
        document.mistake("S603", f"{path[-1]} is no {given}", path, hint)
    return given


def design_variables(
    variables: Sequence[StudyVariable], scales: Mapping[str, str]
) -> tuple[DesignVariable, ...]:
    """Variables of a search."""
    return tuple(DesignVariable(v.name, v.value, v.low, v.high, scales[v.name] == LOG) for v in variables)
