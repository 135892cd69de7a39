"""Compare the peaks of a deck with those of OpenSees at three halved steps."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

from pound_deck.diagnostics import Diagnostic
from pound_solve.check import Subject
from pound_solve.driver.prepare import prepare
from pound_solve.driver.request import Request
from pound_solve.driver.run import in_temporary_folder
from pound_solve.opensees import environment
from pound_solve.opensees.export import export
from pound_solve.opensees.extrapolation import Limit, limit
from pound_solve.opensees.peaks import ComparedItems, our_peaks, word

HALVINGS = (1, 2, 4)  #: parts of the coarsest step


class Compared(NamedTuple):
    """One quantity.

    Attributes
    ----------
    name : str
    ours, our_error : float
        Our peak, and its error as our method estimates it; 0 for a method that makes none but rounding.
    theirs : tuple of float
        Peaks of OpenSees at the halved steps.
    limit : Limit
        Of `theirs`.
    """

    name: str
    ours: float
    our_error: float
    theirs: tuple[float, ...]
    limit: Limit

    @property
    def deviation(self) -> float:
        """Our peak less the limit."""
        return self.ours - self.limit.value

    @property
    def agrees(self) -> bool:
        """Whether our peak lies within the uncertainty of the limit and its own error."""
        return abs(self.deviation) <= self.limit.uncertainty + self.our_error


class Comparison(NamedTuple):
    """All quantities, the version of OpenSees, its coarsest step [T], our method and its estimated error,
    relative to a peak.
    """

    rows: list[Compared]
    program: str
    step: float
    method: str
    error: float


def verify(
    request: Request, python: str, step: float | None, show: Callable[[str], None]
) -> tuple[Comparison, Sequence[Diagnostic], Mapping[str, str]]:
    """Run a deck here and in OpenSees.

    Parameters
    ----------
    request : Request
    python : str
        Interpreter with openseespy.
    step : float, optional
        Coarsest step of OpenSees [T].
    show : callable
        Receives what is being done.

    Returns
    -------
    comparison : Comparison
    warnings : sequence of Diagnostic
        Of the deck, with the texts of its files.
    files : mapping of str to str

    Raises
    ------
    DeckError, OpenSeesError, OSError
        The deck has mistakes or parts that OpenSees has not; a run stops.
    """
    ready = prepare(request)
    exported = export(ready, request.deck)
    environment.version(python)
    step = step or exported.step
    with tempfile.TemporaryDirectory(prefix="pound-solve-") as folder:
        (script, *_) = exported.write(Path(folder, f"{Path(request.deck).stem}_opensees.py"))
        runs = []
        for parts in HALVINGS:
            show(f"OpenSees, step {step / parts:g}")
            runs.append(environment.run(python, script, step / parts))
    show("pound-solve")
    with in_temporary_folder(request) as results:
        if results.status != "done":
            raise environment.OpenSeesError(f"our run stops: {results.message}")
        ours = our_peaks(results, exported.compared)
        error = max((c.value for c in results.checks if c.subject is Subject.ERROR), default=0.0)
        (method,) = (word(row["value"]) for row in results.table("run") if word(row["item"]) == "method")
    rows = []
    for name, peak in ours.items():
        values = tuple(run.peaks[name] for run in runs)
        rows.append(Compared(name, peak, error * abs(peak), values, limit(*values)))
    rows = evened(rows, exported.compared)
    comparison = Comparison(rows, runs[0].program, step, method, error)
    return comparison, ready.warnings, ready.files


def evened(rows: list[Compared], items: ComparedItems) -> list[Compared]:
    """Rows whose relative uncertainty is at least the median of their kind, forces or displacements.

    Events within steps disturb all quantities; one whose three values are close by chance is not more
    certain than others.
    """
    forces = {f"contact {name}, force" for name in items.contacts}
    shares: dict[bool, list[float]] = {True: [], False: []}
    for x in rows:
        if x.limit.value:
            shares[x.name in forces].append(x.limit.uncertainty / abs(x.limit.value))
    least = {kind: median(values) if values else 0.0 for kind, values in shares.items()}
    return [
        x._replace(
            limit=x.limit._replace(
                uncertainty=max(x.limit.uncertainty, least[x.name in forces] * abs(x.limit.value))
            )
        )
        for x in rows
    ]
