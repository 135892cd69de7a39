"""RECORD: a force history from a file, straight lines between its samples.

Values of the file are factors on FX, FY and MZ; the unit that the file names is ignored.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.forces.base import COMMON, Force, finish
from pound_solve.loading.motions import record
from pound_solve.loading.motions.base import LoadingContext


def build(card_values: Mapping[str, Any], context: LoadingContext) -> Force:
    """Force of a RECORD card; raises as `motions.record.samples` does."""
    samples = record.samples(card_values, context)
    info = {"kind": SPEC.name, "name": str(card_values["FILE"]), "dt": record.step(samples.raw)}
    return finish(card_values, samples.lines, info | {"sha256": samples.sha256, "notes": samples.raw.notes})


SPEC: Final = Spec(
    "force",
    "RECORD",
    "force history from a file",
    (
        *COMMON,
        Field("FILE", Kind.TEXT, doc="file of the history, or name of a known record"),
        *record.FIELDS,
    ),
    impl=build,
)
