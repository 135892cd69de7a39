"""TABLE: a force history written in the deck, straight lines between its points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.forces.base import COMMON, Force, finish
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.motions.table import lines


def build(card_values: Mapping[str, Any], context: LoadingContext) -> Force:
    """Force of a TABLE card.

    Raises
    ------
    RecordError
        R405 where the points are no table, see `motions.table.lines`.
    """
    return finish(card_values, lines(card_values["POINTS"]), {"kind": SPEC.name})


SPEC: Final = Spec(
    "force",
    "TABLE",
    "force history written in the deck",
    (
        *COMMON,
        Field(
            "POINTS",
            Kind.REAL,
            count=(4, 400_000),
            doc="time, factor, time, factor, ...; linear between, zero outside; a repeated time is a jump",
        ),
    ),
    impl=build,
)
