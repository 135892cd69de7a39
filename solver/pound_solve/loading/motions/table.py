"""TABLE: ground accelerations written in the deck, straight lines between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.motions.base import (
    COMMON,
    GroundMotion,
    LoadingContext,
    Piecewise,
    RecordError,
    finish,
)


def build(card_values: Mapping[str, Any], context: LoadingContext) -> GroundMotion:
    """Motion of a TABLE card.

    Raises
    ------
    RecordError
        R405 where the points are no table, see `lines`.
    """
    points = card_values["POINTS"]
    return finish(
        card_values,
        lines(points) * float(card_values.get("SCALE", 1.0)),
        context,
        {"kind": SPEC.name, "name": SPEC.name, "unit": "DECK", "npts": len(points) // 2, "start": 0.0},
    )


def lines(points: Sequence[float]) -> Piecewise:
    """Straight lines between points ``t0, f0, t1, f1, ...``; zero before the first and after the last.

    A repeated time is a jump from the first value to the second.

    Raises
    ------
    RecordError
        R405 for half a pair, times that descend or begin before 0, a time given three times, or a
        slope beyond the largest number.
    """
    t, f = points[::2], points[1::2]
    if len(t) != len(f):
        raise _wrong(f"{len(points)} numbers are no whole pairs of time and value")
    for before, after in pairwise(t):
        if after < before:
            raise _wrong(f"the times descend from {before:g} to {after:g}")
    if t[0] < 0.0:
        raise _wrong(f"the first time is {t[0]:g}, before the history begins")
    if t[0] == t[-1]:
        raise _wrong(f"all its points are at time {t[0]:g}")
    if any(t[i] == t[i + 2] for i in range(len(t) - 2)):
        raise _wrong("a time stands three times: a jump has two values, before it and after it")
    # from t = 0 on, as every motion; an interval of no length is a jump
    t, f = (0.0, t[0], *t), (0.0, 0.0, *f)
    breaks, width, values = np.array(t), np.diff(t), np.array(f)
    some = width > 0.0
    with np.errstate(over="ignore"):
        slopes = np.diff(values)[some] / width[some]
    if not np.isfinite(slopes).all():
        at = breaks[:-1][some][~np.isfinite(slopes)][0]
        raise _wrong(f"the value changes too fast after {at:g}: a jump has its time twice")
    return Piecewise(np.append(breaks[:-1][some], breaks[-1]), np.vstack([values[:-1][some], slopes]))


def _wrong(message: str) -> RecordError:
    hint = "POINTS are pairs of time and value: POINTS=0,0,0.5,1,2,1"
    return RecordError("R405", message, hint, "POINTS")


SPEC: Final = Spec(
    "motion",
    "TABLE",
    "ground acceleration written in the deck",
    (
        Field(
            "POINTS",
            Kind.REAL,
            count=(4, 400_000),
            doc="time, acceleration, time, acceleration, ... in the deck's units; linear between, zero "
            "outside; a repeated time is a jump",
        ),
        *COMMON,
    ),
    impl=build,
)
