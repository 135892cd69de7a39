"""A run of a study with its exact derivatives, within a process of the study."""

from __future__ import annotations

from collections.abc import Sequence

from pound_solve.results.sweep_file import DONE
from pound_solve.sensitivity.response import derivatives
from pound_solve.sweep.execution.journal import JournalEntry
from pound_solve.sweep.execution.limits import Clock
from pound_solve.sweep.execution.work import Settings
from pound_solve.sweep.study.quantities import Values
from pound_solve.sweep.study.records import scaled
from pound_solve.sweep.study.run import StudyRun
from pound_solve.sweep.study.study import request_of


def differentiated(run: StudyRun, settings: Settings, clock: Clock) -> JournalEntry:
    """Analysis of a run (see `work.carry_out`): its quantities, and beside each its derivatives.

    Raises
    ------
    NoDerivativeError
        The run has no exact derivatives; the journal keeps the reason.
    """
    motion = scaled(run.shaking) if run.shaking else None
    response = derivatives(request_of(run.case, motion), run.variables, clock)
    values = dict(response.values)
    for quantity, by_label in response.slopes.items():
        for k, name in enumerate(run.variables):
            values[_key(quantity, name)] = {label: float(slopes[k]) for label, slopes in by_label.items()}
    return JournalEntry(run.identity, DONE, doubt="; ".join(response.flags), values=values)


def slopes_of(values: Values, quantity: str, label: str, names: Sequence[str]) -> list[float] | None:
    """Derivatives of a quantity with a label with respect to variables; None where it has none."""
    slopes = [values.get(_key(quantity, name), {}).get(label) for name in names]
    return None if None in slopes else [x for x in slopes if x is not None]


def _key(quantity: str, name: str) -> str:
    """Name of a derivative among the values of a run."""
    return f"{quantity} by {name}"
