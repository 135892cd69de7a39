"""The table of a sweep: runs by quantities, from the journal, in the order of the study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_deck.model import Units
from pound_solve.results import sweep_file
from pound_solve.results.sweep_file import RUN, Sweep, Variable
from pound_solve.sweep.execution.journal import Journal, JournalEntry
from pound_solve.sweep.study.quantities import QUANTITIES, Values
from pound_solve.sweep.study.run import StudyRun
from pound_solve.sweep.study.study import Study
from pound_solve.version import __version__

MISSING = "missing"  #: status of a run that has not ended


def table(study: Study, journal: Journal, entries: Mapping[str, JournalEntry]) -> Sweep:
    """Make the table of a study: the inputs, the status and the quantities of each run.

    Parameters
    ----------
    study : Study
    journal : Journal
        Holds the values, which are read twice, run by run: first the labels, then the values.
    entries : mapping of str to JournalEntry
        By identity.
    """
    outcomes = [entries.get(run.identity) or JournalEntry(run.identity, MISSING) for run in study.runs]
    units = Units(*study.units, stated=True)
    place = {run.identity: k for k, run in enumerate(study.runs)}
    by_identity = {e.identity: e for e in outcomes}
    labels = _labels(place, journal.values(by_identity))
    arrays = {q.name: np.full((len(outcomes), len(labels.get(q.axis, ()))), np.nan) for q in QUANTITIES}
    column = {axis: {name: k for k, name in enumerate(names)} for axis, names in labels.items()}
    for identity, values in journal.values(by_identity):
        for q in QUANTITIES:
            for label, value in values.get(q.name, {}).items():
                arrays[q.name][place[identity], column[q.axis][label]] = value
    variables = {**_inputs(study), **_ends(outcomes, units)}
    for q in QUANTITIES:
        if q.axis in labels:
            shaped = arrays[q.name] if q.axis else arrays[q.name][:, 0]
            variables[q.name] = Variable(shaped, q.axis, units.text(q.unit), q.doc)
    about = {"study": Path(study.name).name, "program_version": __version__, "units": " ".join(study.units)}
    return Sweep(variables, {axis: names for axis, names in labels.items() if axis}, about)


def _labels(place: Mapping[str, int], values: Iterable[tuple[str, Values]]) -> dict[str, tuple[str, ...]]:
    """Labels of every axis in the order of the runs in the study, whatever their order in the journal."""
    first: dict[str, dict[str, tuple[int, int]]] = {"": {"": (0, 0)}}
    for identity, by_quantity in values:
        for q in QUANTITIES:
            seen = first.setdefault(q.axis, {}) if q.name in by_quantity else {}
            for k, label in enumerate(by_quantity.get(q.name, ())):
                seen[label] = min(seen.get(label, (place[identity], k)), (place[identity], k))
    return {axis: tuple(sorted(seen, key=seen.__getitem__)) for axis, seen in first.items()}


def write(study: Study, journal: Journal, entries: Mapping[str, JournalEntry]) -> Path:
    """Write the file and the CSV of a study; return the path of the former, see `sweep_file.write`."""
    path = study.out / "sweep.h5"
    sweep_file.write(table(study, journal, entries), path, _histories(study.runs, journal))
    return path


def _histories(
    runs: Sequence[StudyRun], journal: Journal
) -> Iterator[tuple[int, Mapping[str, NDArray[Any]]]]:
    """Yield number and histories of each run with kept histories."""
    for run in runs:
        path = journal.histories(run.identity)
        if path.is_file():
            with np.load(path) as kept:
                yield run.number, dict(kept)


def _inputs(study: Study) -> dict[str, Variable]:
    """Input variables of each run: deck, PARAMs, record, level."""
    runs = study.runs
    variables = {
        RUN: Variable(np.array([r.number for r in runs], np.int64), doc="number of the run"),
        "identity": Variable(_texts(r.identity for r in runs), doc="digest of all that the run depends on"),
        "deck": Variable(_texts(Path(r.case.deck).name for r in runs), doc="deck"),
    }
    if study.measure:
        shakings = [r.shaking for r in runs if r.shaking is not None]
        variables["record"] = Variable(_texts(s.record.name for s in shakings), doc="record")
        variables["scale"] = Variable(np.array([s.scale for s in shakings]), doc="factor on the record")
        if study.measure != "scale":
            what = {"pga": "peak ground acceleration", "sa": "pseudo-acceleration"}[study.measure]
            doc = f"{what} that the record is scaled to, in shares of gravity"
            variables[study.measure] = Variable(np.array([s.level for s in shakings]), doc=doc)
    taken = {*variables, *(q.name for q in QUANTITIES), *(q.axis for q in QUANTITIES), *_ENDS}
    for name in dict.fromkeys(n for r in runs for n, _ in r.case.params):
        values = [dict(r.case.params).get(name, "") for r in runs]
        own_name = f"{name} (PARAM)" if name in taken else name
        variables[own_name] = Variable(_numbers(values), doc=f"PARAM {name}")
    return variables


_ENDS = ("status", "message", "doubt", "reached", "cpu_seconds", "solve_seconds")


def _ends(entries: Sequence[JournalEntry], units: Units) -> dict[str, Variable]:
    """Variables of the end of each run: status, message, times."""
    return dict(
        zip(
            _ENDS,
            (
                Variable(_texts(e.status for e in entries), doc="done, stopped, failed or missing"),
                Variable(_texts(e.message for e in entries), doc="why it stopped or failed"),
                Variable(_texts(e.doubt for e in entries), doc="checks that call for a look"),
                Variable(np.array([e.reached for e in entries]), "", units.text("T"), "end of the history"),
                Variable(np.array([e.cpu for e in entries]), "", "s", "CPU time of the run"),
                Variable(np.array([e.solve for e in entries]), "", "s", "CPU time of its method"),
            ),
        )
    )


def _texts(values: Iterable[str]) -> NDArray[Any]:
    return np.array(list(values), object)


def _numbers(values: Sequence[str]) -> NDArray[Any]:
    """Array of numbers, or of the texts where one of them is not a number."""
    try:
        return np.array([float(v) if v else np.nan for v in values])
    except ValueError:
        return _texts(values)
