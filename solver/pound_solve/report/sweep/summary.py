"""The report of a sweep: inputs, failures, fractiles, worst runs and checks, as text and tables.

It does not depend on the date, the machine or the order in which runs ended.
"""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_deck.model import Units
from pound_solve.numerics.types import Array, Index
from pound_solve.report.text import WIDTH, printed
from pound_solve.results.form import ResultsError
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import DONE, RUN, Sweep
from pound_solve.results.whole_file import whole
from pound_solve.statistics.curves import (
    FRACTILES,
    LEVELS,
    PARAM,
    Asked,
    cases,
    demands,
    fractiles_of,
    units_of,
)

SHOWN: Final = (
    "drift_ratio", "peak_drift", "storey_drift", "residual_drift", "ductility", "closures", "contact_force",
    "needed_gap", "base_shear", "floor_acceleration",
)  # fmt: skip
GROUPS: Final = 64  #: most groups of cases and levels
VALUES: Final = 20  #: most values of a PARAM or a level, and most records, listed by name
ROWS: Final = 100  #: most runs listed
ALL: Final = "all runs"


def write(path: Path, sweep: Sweep, title: str, more: Iterable[str] = ()) -> Path:
    """Write the report beside a file of results, with its name and the ending .rpt; return its path.

    Raises
    ------
    ResultsError
        It cannot be written.
    """
    report = path.with_suffix(".rpt")
    try:
        with whole(report) as partial:
            partial.write_text(text(sweep, title, more), encoding="ascii", errors="replace", newline="\n")
    except OSError as err:
        raise ResultsError(f"{err.filename}: {err.strerror}") from err
    return report


def text(sweep: Sweep, title: str, more: Iterable[str] = ()) -> str:
    """Text of the report.

    Parameters
    ----------
    sweep : Sweep
    title : str
        Title, which names the analysis.
    more : iterable of str
        Lines of the evaluation, printed after inputs and failures.
    """
    units = units_of(sweep)
    parts = [("what was run", list(_run(sweep)))]
    parts.append(("runs without all results", printed(units, FAILURES, failures(sweep))))
    parts.append((title, list(more)))
    parts.append(("fractiles of the runs", _fractiles(sweep, units)))
    parts.append(("worst runs", printed(units, WORST, worst(sweep))))
    parts.append(("checks", list(_checks(sweep, units))))
    lines = list(_banner(sweep, title))
    for number, (heading, body) in enumerate((p for p in parts if p[1]), 1):
        lines += [f"{number}  {heading.upper()}", "=" * WIDTH, "", *body, "", ""]
    return "\n".join(line.rstrip() for line in lines).rstrip() + "\n"


def _banner(sweep: Sweep, title: str) -> Iterator[str]:
    about = sweep.about
    units = units_of(sweep)
    yield "=" * WIDTH
    yield f" POUND-SOLVE {about['program_version']}     {title.upper()}"
    yield ""
    yield f" Study {about['study']}"
    yield f" Units: force {units.force}, length {units.length}, time {units.time}"
    yield "=" * WIDTH
    yield from ("", "")


def _run(sweep: Sweep) -> Iterator[str]:
    """Lines of text on the inputs: counts, decks, PARAMs, records, levels."""
    status = sweep["status"].tolist()
    counts = ", ".join(f"{status.count(end)} {end}" for end in dict.fromkeys(sorted(status)))
    yield from _line("runs", f"{len(status)}: {counts}")
    params = [(n, v.doc.removeprefix(PARAM)) for n, v in sweep.variables.items() if v.doc.startswith(PARAM)]
    named = [("deck", "decks"), *params, ("record", "records"), *((name, name) for name in _levels(sweep))]
    for name, word in named:
        if name in sweep.variables:
            yield from _line(word, _values(sweep[name].tolist()))


def _line(word: str, text: str) -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent=f"  {word:<12}  ", subsequent_indent=" " * 16, break_long_words=False
    )


def _values(values: Sequence[Any]) -> str:
    """Text of the distinct values or, of many, of their number and range."""
    distinct = list(dict.fromkeys(values))
    numbers = all(isinstance(v, float) for v in distinct)
    words = [f"{v:.6g}" for v in sorted(distinct)] if numbers else [str(v) for v in distinct]
    if len(words) <= VALUES:
        return ", ".join(words)
    return f"{len(words)} from {words[0]} to {words[-1]}" if numbers else f"{len(words)}, {words[0]} first"


def failures(sweep: Sweep) -> list[Row]:
    """One row for each run that is not done."""
    titles = _titles(sweep)
    failed = [
        (run, title, status, (message.splitlines() or [""])[0])
        for run, title, status, message in zip(
            sweep[RUN].tolist(), titles, sweep["status"].tolist(), sweep["message"].tolist()
        )
        if status != DONE
    ]
    return failed[:ROWS] + [(0, f"and {len(failed) - ROWS} more", "", "")] * (len(failed) > ROWS)


def _titles(sweep: Sweep) -> list[str]:
    """Title of each run: its case, record and level."""
    names = [name for name in ("record", *_levels(sweep)) if name in sweep.variables]
    return [
        ", ".join(filter(None, [case, *(_level_text(sweep[n][i], n) for n in names)]))
        for i, case in enumerate(cases(sweep))
    ]


def _levels(sweep: Sweep) -> list[str]:
    """Name of the variable of the levels, in a list that is empty without one."""
    return [name for name in LEVELS if name in sweep.variables][:1]


def _level_text(value: Any, name: str) -> str:
    return f"{name} {value:.6g}" if isinstance(value, float) else str(value)


def _shown(sweep: Sweep) -> Iterator[tuple[str, Array]]:
    """Yield name and values of every quantity of `SHOWN`: the largest of its labels in each run."""
    for name in SHOWN:
        if name in sweep.variables:
            values = demands(sweep, Asked(name))
            if np.isfinite(values).any():
                yield name, values


def _groups(sweep: Sweep) -> dict[str, Index]:
    """Group runs by case and level, else by case, else all: the finest with several runs per group."""
    named = cases(sweep)
    levels = [""] * len(named)
    for name in _levels(sweep):
        levels = [f"{name} {x:.6g}" for x in sweep[name].tolist()]
    for keys in ([", ".join(filter(None, key)) for key in zip(named, levels)], named):
        sizes = Counter(keys)
        if len(sizes) <= GROUPS and min(sizes.values(), default=0) > 1:
            return {key or ALL: np.flatnonzero(np.array(keys) == key) for key in dict.fromkeys(keys)}
    return {ALL: np.arange(len(named))}


def fractiles(sweep: Sweep) -> Iterator[Row]:
    """One row for each quantity and group."""
    groups = _groups(sweep)
    for name, values in _shown(sweep):
        for key, runs in groups.items():
            known = values[runs]
            known = known[~np.isnan(known)]
            if len(known):
                yield name, key, len(known), *fractiles_of(known).tolist()


def worst(sweep: Sweep) -> Iterator[Row]:
    """One row for each quantity: its largest finite value, where it is, and its run."""
    titles = _titles(sweep)
    for name, values in _shown(sweep):
        at = int(np.nanargmax(np.where(np.isfinite(values), values, np.nan)))
        variable, label = sweep.variables[name], ""
        if variable.axis:
            label = sweep.labels[variable.axis][int(np.nanargmax(np.abs(variable.values[at])))]
        value = f"{values[at]:.5g} {variable.unit}".removesuffix(" -")
        yield name, value, label, int(sweep[RUN][at]), titles[at]


def _fractiles(sweep: Sweep, units: Units) -> list[str]:
    """The table of fractiles, one part for each quantity with its unit."""
    rows, lines = list(fractiles(sweep)), list[str]()
    for name in dict.fromkeys(row[0] for row in rows):
        unit = sweep.variables[name].unit
        lines += [f"  {name} [{unit or '-'}]", ""]
        lines += [*printed(units, FRACTILE_TABLE, [row[1:] for row in rows if row[0] == name]), ""]
    return lines[:-1]


def _checks(sweep: Sweep, units: Units) -> Iterator[str]:
    """Lines of text on the largest energy residual, and on runs whose checks call for a look."""
    if "energy_residual" in sweep.variables:
        residuals = np.asarray(sweep["energy_residual"], np.float64)
        if not np.isnan(residuals).all():
            at = int(np.nanargmax(residuals))
            what = "largest energy residual over the largest energy of its run"
            yield f"  {what}: {residuals[at]:.1e}, run {sweep[RUN][at]}"
    looked = [(run, what) for run, what in zip(sweep[RUN].tolist(), sweep["doubt"].tolist()) if what]
    yield f"  runs whose checks call for a look: {len(looked)} of {len(sweep)}"
    if looked:
        yield from ("", *printed(units, DOUBTS, looked[:ROWS]))
        if len(looked) > ROWS:
            yield from ("", f"  and {len(looked) - ROWS} more: column doubt of the table of runs")


_RUN_COLUMN: Final = Column("run", fmt="int", doc="number of the run", zero="...")
FAILURES: Final = Sheet(
    columns=(
        _RUN_COLUMN,
        Column("title", "case, record, level", doc="what tells the run from others"),
        Column("status", doc="stopped, failed or missing"),
        Column("reason", doc="why"),
    )
)
FRACTILE_TABLE: Final = Sheet(
    columns=(
        Column("group", "case, level", doc="runs that are taken together"),
        Column("runs", fmt="int", doc="runs that tell"),
        *(
            Column(f"q{n}", f"{100 * q:.0f} %", "", "short", doc="not exceeded")
            for n, q in enumerate(FRACTILES)
        ),
    )
)
WORST: Final = Sheet(
    columns=(
        Column("quantity", doc="quantity of the sweep"),
        Column("value", "largest", doc="largest value of all runs that did not stop"),
        Column("label", "where", doc="its label"),
        _RUN_COLUMN,
        Column("title", "case, record, level", doc="what tells the run from others"),
    )
)
DOUBTS: Final = Sheet(columns=(_RUN_COLUMN, Column("doubt", "check", doc="check and its verdict")))
