"""Quantities that a sweep keeps of each run, each from a column of a table of the report."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from pound_solve.check import Check, Subject, looked
from pound_solve.results.contents import TABLES
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Stage, Table
from pound_solve.statistics.curves import Asked, CurveError
from pound_solve.sweep.study.pairs import PAIRS

Values: TypeAlias = dict[str, dict[str, float]]  #: of one run: by quantity and by label
Fields: TypeAlias = Mapping[str, Any]  #: of one row of a table, by column


@dataclass(frozen=True)
class Quantity:
    """One quantity.

    Attributes
    ----------
    name : str
    axis : str
        Meaning of its labels; empty for one number per run.
    unit : str
        Dimensions, as of a column.
    doc : str
    table : str
        Table that contains it.
    label : callable
        Label of a row; empty for one number per run; None skips the row.  Of several rows with one label
        the largest value counts.
    value : callable
        Value in a row.
    """

    name: str
    axis: str
    unit: str
    doc: str
    table: str
    label: Callable[[Fields], str | None]
    value: Callable[[Fields], float]


def _largest(row: Fields) -> float:
    return float(max(abs(row["max"]), abs(row["min"])))


def _of(column: str) -> Callable[[Fields], float]:
    return lambda row: float(row[column])


def _named(column: str) -> Callable[[Fields], str]:
    return lambda row: str(row[column])


def _storey(row: Fields) -> str:
    return f"{row['building']} {row['storey']}"


def _hinge(row: Fields) -> str | None:
    return None if math.isnan(row["ductility"]) else f"{row['element']} {row['component']}"


def _building(quantity: str) -> Callable[[Fields], str | None]:
    return lambda row: str(row["building"]) if row["quantity"] == quantity else None


def _first_mode(row: Fields) -> str | None:
    return "" if row["mode"] == 1 else None


def _known(value: float) -> float:
    """Sort key of a value: NaN, a value that is not known, comes before all others."""
    return -math.inf if math.isnan(value) else value


def _check(subject: Subject) -> Callable[[Fields], str | None]:
    return lambda row: "" if row["subject"] == subject else None


def _each(
    table: str,
    axis: str,
    label: Callable[[Fields], str | None],
    entries: Sequence[tuple[str, str, str, Callable[[Fields], float]]],
) -> Iterator[Quantity]:
    """Make the quantities of one table that share their labels, each from name, unit, meaning, value."""
    return (Quantity(name, axis, unit, doc, table, label, value) for name, unit, doc, value in entries)


QUANTITIES: Final = (
    Quantity("period", "", "T", "period of the first mode of MODAL", "modes", _first_mode, _of("period")),
    Quantity(
        "frequency", "mode", "1/T", "natural frequency of each mode of MODAL",
        "modes", lambda row: str(row["mode"]), _of("frequency"),
    ),
    *_each("drift_envelope", "drift", _named("name"), (
        ("peak_drift", "L", "largest absolute drift", _largest),
        ("drift_ratio", "-", "largest absolute drift over its height", _of("ratio_max")),
    )),
    *_each("contact_summary", "contact", _named("contact"), (
        ("closures", "-", "number of collisions", _of("closures")),
        ("contact_force", "F", "largest compression", _of("peak_force")),
        ("penetration", "L", "largest overlap", _of("peak_penetration")),
        ("impulse", "F*T", "impulse of all collisions", _of("impulse")),
        ("contact_loss", "F*L", "energy lost in the contact", _of("energy_lost")),
        ("min_gap", "L", "smallest gap, negative while in contact", _of("min_gap")),
    )),
    *_each(PAIRS.name, "contact", _named("contact"), [
        (c.name, c.unit, c.doc, _of(c.name)) for c in PAIRS.columns[1:]
    ]),
    Quantity(
        "base_shear", "building", "F", "largest absolute base shear",
        "base_envelope", _building("shear X"), _largest,
    ),
    Quantity(
        "overturning_moment", "building", "F*L", "largest absolute overturning moment",
        "base_envelope", _building("moment"), _largest,
    ),
    *_each("storey_envelope", "storey", _storey, (
        ("storey_drift", "-", "largest absolute drift ratio", _of("drift")),
        ("residual_drift", "-", "drift ratio at the end", _of("residual")),
        ("storey_shear", "F", "largest absolute shear", _of("shear")),
        ("floor_acceleration", "L/T^2", "largest absolute total acceleration", _of("acceleration")),
    )),
    *_each("spring_envelope", "hinge", _hinge, (
        ("ductility", "-", "largest absolute deformation over yield", _of("ductility")),
    )),
    *_each("checks", "", _check(Subject.ENERGY), (
        ("energy_residual", "-", "largest energy residual over the largest energy", _of("value")),
    )),
    *_each("checks", "", _check(Subject.ERROR), (
        ("error_estimate", "-", "largest error of the peaks by the estimates of AUTO", _of("value")),
    )),
)  # fmt: skip
#: tables from which the quantities are extracted
SOURCES: Final[Mapping[str, Table[RunRecord]]] = MappingProxyType(
    {q.table: PAIRS if q.table == PAIRS.name else TABLES[q.table] for q in QUANTITIES}
)


def taken(rows: Mapping[str, list[Fields]]) -> Values:
    """Quantities of one run from its table rows; the largest value of rows with the same label."""
    values: Values = {}
    for q in QUANTITIES:
        by_label: dict[str, float] = {}
        for row in rows.get(q.table, ()):
            if (label := q.label(row)) is not None:
                by_label[label] = max(by_label.get(label, math.nan), q.value(row), key=_known)
        if by_label:
            values[q.name] = by_label
    return values


def value_of(values: Values, asked: Asked) -> float:
    """Value of a quantity of one run, without a label the one of the largest magnitude; NaN without one."""
    by_label = values.get(asked.quantity, {})
    if asked.label:
        return by_label.get(asked.label, math.nan)
    return max((x for x in by_label.values() if not math.isnan(x)), key=abs, default=math.nan)


def label_of(values: Values, asked: Asked) -> str:
    """Label of `value_of`; empty where there is no value."""
    by_label = {label: x for label, x in values.get(asked.quantity, {}).items() if not math.isnan(x)}
    return asked.label or max(by_label, key=lambda label: abs(by_label[label]), default="")


def require(values: Values, asked: Asked) -> None:
    """Check that a run which has a quantity has the label asked for.

    Raises
    ------
    CurveError
        It has others.
    """
    labels = list(values.get(asked.quantity, {}))
    if asked.label and labels and asked.label not in labels:
        raise CurveError(f"{asked.quantity} has no label {asked.label}: there are {', '.join(labels)}")


def rows_at(stage: Stage, record: RunRecord) -> Iterator[tuple[str, list[Fields]]]:
    """Name of every table in `SOURCES` that is written at a stage, and its rows as mappings by column."""
    for name, table in SOURCES.items():
        if stage in table.stages:
            columns = [c.name for c in table.columns]
            yield name, [dict(zip(columns, row)) for row in table.rows(record) or ()]


def doubts(rows: Mapping[str, list[Fields]]) -> str:
    """Text of the checks of one run whose verdict calls for a look."""
    return "; ".join(map(str, looked(map(Check.of, rows.get("checks", ())))))
