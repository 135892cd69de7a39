"""RECORD: a recorded ground acceleration, straight lines between its samples.

LINES selects a part of the file.  START and DURATION select an interval in the time of the record; TSCALE
then stretches it.  Outside this interval the acceleration is zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.motions.base import COMMON, GroundMotion, LoadingContext, Piecewise, finish
from pound_solve.loading.motions.doubts import reason_mispaced
from pound_solve.loading.records import formats
from pound_solve.loading.records.base import RawRecord, RecordError
from pound_solve.loading.records.known import find, known, load
from pound_solve.numerics.types import Array

KEPT: Final = 8  #: number of records kept in memory for further runs of the same process
_UNITS: Final = ("G", "M/S2", "CM/S2", "GAL", "MM/S2", "DECK")


class RecordSamples(NamedTuple):
    """Part of a record's file that a card selects.

    Attributes
    ----------
    t, values : ndarray, shape (n,)
        Times from the start of the history, START, DURATION and TSCALE applied, and values as in the file.
    raw : RawRecord
    path : Path
    sha256 : str
    """

    t: Array
    values: Array
    raw: RawRecord
    path: Path
    sha256: str

    @property
    def lines(self) -> Piecewise:
        """Straight lines between the samples, from t = 0 on."""
        lines = Piecewise.from_samples(self.t, self.values)
        return lines if lines.start <= 0 else lines.slice(0.0, lines.end)


def samples(card_values: Mapping[str, Any], context: LoadingContext) -> RecordSamples:
    """Read the record that a card names.

    Parameters
    ----------
    card_values : mapping
        Bound values of the card's `FIELDS` and of its format.
    context : LoadingContext

    Raises
    ------
    RecordError
        The record cannot be used; codes in :mod:`pound_solve.loading.records.base`.
    """
    path = find(str(card_values["FILE"]), context.search_path)
    text, digest = load(path)
    try:
        text = _lines(text, card_values.get("LINES"))
        options = tuple((name, value) for name, value in card_values.items() if name != "SCALE")
        raw = _parsed(text, card_values.get("FORMAT", "AUTO"), options)
        start, duration = float(card_values.get("START", 0.0)), card_values.get("DURATION")
        t, values = _window(raw.t, raw.values, start, duration)
    except RecordError as error:
        raise error.within(path.name) from None
    raw = replace(raw, notes=tuple(f"{path.name}: {note}" for note in raw.notes))
    return RecordSamples(t * float(card_values.get("TSCALE", 1.0)), values, raw, path, digest)


@lru_cache(maxsize=KEPT)
def _parsed(text: str, reader: str, options: tuple[tuple[str, Any], ...]) -> RawRecord:
    """Samples of a text by the reader of a format; cached, because sweeps scale a record repeatedly."""
    raw: RawRecord = formats()[reader].impl.read(text, dict(options))
    for samples in (raw.values, raw.times):
        if samples is not None:
            samples.setflags(write=False)
    return raw


def build(card_values: Mapping[str, Any], context: LoadingContext) -> GroundMotion:
    """Motion of a RECORD card; raises as `samples` does."""
    name = str(card_values["FILE"])
    record = samples(card_values, context)
    raw, path = record.raw, record.path
    unit, warnings = _unit(raw, card_values.get("UNIT"))
    if card_values.get("DIRECTION") == "R" and unit != "DECK":
        message = (
            f"a rotation is no share of gravity and no length, but the record is taken to be in {unit}"
        )
        raise RecordError("R405", message, "write UNIT=DECK: radians per time squared", "DIRECTION")
    scale = float(card_values.get("SCALE", 1.0))
    factor = context.per_unit(unit) * scale
    if unit == "G" and abs(abs(scale) / context.gravity - 1.0) < 0.01:
        warnings.append(f"SCALE={scale:g} is gravity, by which samples in G are multiplied anyway")
    shipped = known(name)
    if shipped and record.sha256 != shipped.sha256:
        warnings.append(
            f"{path.name} differs from the file that {name} stood for when this program was released"
        )
    return finish(
        card_values,
        record.lines * factor,
        context,
        {
            "kind": SPEC.name,
            "name": name,
            "file": str(path),
            "format": raw.format or card_values.get("FORMAT", "AUTO"),
            "component": raw.component,
            "title": raw.title,
            "npts": len(raw.values),
            "dt": step(raw),
            "unit": unit,
            "start": float(card_values.get("START", 0.0)),
            "tscale": float(card_values.get("TSCALE", 1.0)),
            "sha256": record.sha256,
            "warnings": warnings,
            "notes": raw.notes,
            "cuts": _cuts(raw, card_values),
        },
        weakest=_LEAST_PLAUSIBLE_PEAK if raw.unit is None and scale == 1.0 else None,
    )


def _cuts(raw: RawRecord, card_values: Mapping[str, Any]) -> tuple[tuple[str, str, str], ...]:
    """Warnings that the card cuts off the peak of the record, or that its step is implausible."""
    whole = Piecewise.from_samples(raw.t, raw.values)
    start, doubts = float(card_values.get("START", 0.0)), list[tuple[str, str, str]]()
    at, _ = whole.peak()
    if at < start:
        message = f"START={start:g} cuts off the peak of the record, at {at:.4g} s"
        doubts.append((message, "START", "give an earlier START, or a DURATION to the part that is meant"))
    if card_values.get("DT") is not None and (wrong := reason_mispaced(whole)):
        doubts.append((wrong, "DT", "DT is the time from one sample to the next in s"))
    return tuple(doubts)


def _lines(text: str, span: tuple[int, int] | None) -> str:
    """Text of the lines of a file from the first to the last of `span`; all others are blank, so that
    messages give line numbers of the file.
    """
    if span is None:
        return text
    lines = text.splitlines()
    first, last = span
    if not first <= last <= len(lines):
        raise RecordError(
            "R405",
            f"LINES={first},{last}, but the file has {len(lines)} lines",
            "write the number of the first line and that of the last",
            "LINES",
        )
    return "\n" * (first - 1) + "\n".join(lines[first - 1 : last])


def _unit(raw: RawRecord, wanted: str | None) -> tuple[str, list[str]]:
    """Unit of the samples, and warnings about it."""
    if wanted is None:
        return raw.unit or "G", []
    if raw.unit and raw.unit != {"GAL": "CM/S2"}.get(wanted, wanted):
        return wanted, [f"the file says that it is in {raw.unit}; UNIT={wanted} of the deck is used"]
    return wanted, []


def _window(t: Array, a: Array, start: float, duration: float | None) -> tuple[Array, Array]:
    """Samples from `start` on for `duration`, times counted from `start`; the cuts become samples."""
    stop = float(t[-1]) if duration is None else min(float(t[-1]), start + duration)
    if start >= t[-1] or stop <= t[0]:
        raise RecordError(
            "R405",
            f"START and DURATION leave nothing of the record, which runs from {t[0]:g} to {t[-1]:g} s",
        )
    # a sample within rounding of a cut is the cut
    near = 1e-12 * float(np.abs(t[[0, -1]]).max())
    first = max(start, float(t[0]))
    inner = (t > first + near) & (t < stop - near)
    cut = np.concatenate(([first], t[inner], [stop]))
    return cut - start, np.concatenate(([np.interp(first, t, a)], a[inner], [np.interp(stop, t, a)]))


def step(raw: RawRecord) -> float | None:
    """Step of the samples [s], None for uneven ones; times printed with few digits count as even."""
    if raw.dt is not None:
        return raw.dt
    steps = np.diff(raw.t)
    mean = float(steps.mean())
    # nine digits: 0.02, not 0.019999999999999997
    return float(f"{mean:.9g}") if np.abs(steps - mean).max() <= 0.01 * mean else None


_LEAST_PLAUSIBLE_PEAK: Final = 0.05  #: fraction of gravity above which an unscaled record is plausible

#: items that select a part of the file and its time
FIELDS: Final = (
    Field("FORMAT", Kind.FAMILY, default="AUTO", family="record", doc="format of the file"),
    Field(
        "LINES",
        Kind.INT,
        default=None,
        lo=1,
        count=(2, 2),
        doc="first and last line of the record in the file; omitted: all",
    ),
    Field("START", Kind.REAL, "T", default=0.0, doc="time of the record at t = 0; negative: a delay"),
    Field(
        "DURATION",
        Kind.REAL,
        "T",
        default=None,
        above=0,
        doc="duration of the part used; omitted: to the end",
    ),
    Field("TSCALE", Kind.REAL, "-", default=1.0, above=0, doc="factor on the times of the part used"),
)

SPEC: Final = Spec(
    "motion",
    "RECORD",
    "recorded accelerogram",
    (
        Field("FILE", Kind.TEXT, doc="file of the record, or name of a known record", positional=True),
        Field(
            "UNIT",
            Kind.WORD,
            default=None,
            words=_UNITS,
            doc="unit of the samples; omitted: as the file states, else G; DECK: the deck's own",
        ),
        *FIELDS,
        *COMMON,
    ),
    impl=build,
)
