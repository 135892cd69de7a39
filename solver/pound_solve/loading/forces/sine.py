"""SINE: forces proportional to sin(w (t - START) + PHASE) from START on; zero before and after."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from pound_deck.schema import Spec
from pound_solve.loading.forces.base import COMMON, Force, finish
from pound_solve.loading.motions import sine
from pound_solve.loading.motions.base import LoadingContext, Piecewise


def build(card_values: Mapping[str, Any], context: LoadingContext) -> Force:
    """Force of a SINE card.

    Raises
    ------
    RecordError
        R405 unless one of PERIOD and OMEGA is given, or where the sine has no end.
    """
    w = sine.omega(card_values)
    start, end = float(card_values.get("START", 0.0)), sine.ending(card_values, context)
    if end <= start:
        return finish(card_values, Piecewise.zero(0.0, start or 1.0), {"kind": SPEC.name})
    # from 0 on first, so that the angle is not the difference of large numbers
    breaks = sine.intervals(w, 0.0, end - start)
    angle = w * breaks[:-1] + np.longdouble(card_values.get("PHASE", 0.0))
    wave = Piecewise(breaks, sine.taylor(1.0, w, angle))
    return finish(card_values, wave.delayed(start), {"kind": SPEC.name})


SPEC: Final = Spec("force", "SINE", "sinusoidal force", (*COMMON, *sine.FIELDS), impl=build)
