"""A variable that is searched between its bounds, scaled to 0 to 1."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

PLACES: Final = 6  #: decimal places of the coordinates of a point of a search for an optimum
DIGITS: Final = 8  #: of the value of a variable there


class DesignVariable(NamedTuple):
    """A variable of a search: value in the study, bounds, and whether its scale is logarithmic."""

    name: str
    value: float
    low: float
    high: float
    is_log: bool = False

    def at(self, share: float) -> float:
        """Value at a share of the range, with `DIGITS` digits; at its own share that of the study."""
        if round(self.share(self.value), PLACES) == share:
            return self.value
        return min(max(float(f"{self.unrounded(share):.{DIGITS}g}"), self.low), self.high)

    def unrounded(self, share: float) -> float:
        """Value at a share, which may lie beyond the range."""
        if self.is_log:
            return self.low * math.pow(self.high / self.low, share)
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """Share of the range at a value."""
        if self.is_log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)
