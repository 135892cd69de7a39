"""Variables scaled to a range from 0 to 1 between their bounds, linearly or by logarithms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.variables import StudyVariable

SCALE: Final = "scale"  #: item of a variable
LINEAR, LOG = "linear", "log"


class Scaling:
    """Map of the variables to the unit cube.

    Parameters
    ----------
    variables : sequence of StudyVariable
        With finite bounds.
    logarithmic : sequence of bool
        Whether a variable is scaled by its logarithm.
    """

    def __init__(self, variables: Sequence[StudyVariable], logarithmic: Sequence[bool]) -> None:
        self.logarithmic = np.array(logarithmic, bool)
        self._low = self._in(np.array([v.low for v in variables]))
        self._width = self._in(np.array([v.high for v in variables])) - self._low

    def _in(self, values: Array) -> Array:
        """Values, or their logarithms."""
        return np.where(self.logarithmic, np.log(np.where(self.logarithmic, values, 1.0)), values)

    def to_unit(self, values: Sequence[float] | Array) -> Array:
        """Point of the unit cube, shape (p,), of values of the variables."""
        return np.asarray((self._in(np.asarray(values, np.float64)) - self._low) / self._width)

    def to_values(self, x: Array) -> Array:
        """Values of the variables, shape (p,), at a point of the unit cube."""
        return self.extended(np.clip(x, 0.0, 1.0))

    def extended(self, x: Array) -> Array:
        """The same at a point that may lie outside of the unit cube."""
        at = self._low + x * self._width
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, at, 0.0)), at)


def scaling(document: Document, variables: Sequence[StudyVariable]) -> Scaling:
    """Scaling of the variables of a study by their items ``scale``."""
    return Scaling(variables, [document.take((*v.path, SCALE), str, LINEAR) == LOG for v in variables])


def check_bounds(document: Document, variables: Sequence[StudyVariable]) -> None:
    """Add a mistake for every variable without finite bounds, or with a scale that it cannot have."""
    for v in variables:
        scale = document.take((*v.path, SCALE), str, LINEAR)
        if not math.isfinite(v.high - v.low):
            message = f"{v.name} needs bounds, between which its value is searched"
            document.mistake("S604", message, v.path, "give low and high")
        elif scale not in (LINEAR, LOG):
            document.mistake("S603", f"scale is {LINEAR} or {LOG}", (*v.path, SCALE))
        elif scale == LOG and v.low <= 0.0:
            message = f"{v.name} may be {v.low:g}, which has no logarithm"
            document.mistake("S605", message, v.path, "give low above zero, or leave scale out")
