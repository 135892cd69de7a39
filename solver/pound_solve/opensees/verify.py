"""Compare the peaks of a deck with those of OpenSees at three halved steps."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from pound_deck.diagnostics import Diagnostic
from pound_solve.driver.prepare import prepare
from pound_solve.driver.request import Request
from pound_solve.driver.run import in_temporary_folder
from pound_solve.opensees import environment
from pound_solve.opensees.export import export
from pound_solve.opensees.extrapolation import Limit, limit
from pound_solve.opensees.peaks import our_peaks

HALVINGS = (1, 2, 4)  #: parts of the coarsest step


class Compared(NamedTuple):
    """One quantity: its name, our peak, those of OpenSees at the halved steps, and their limit."""

    name: str
    ours: float
    theirs: tuple[float, ...]
    limit: Limit

    @property
    def deviation(self) -> float:
        """Our peak less the limit."""
        return self.ours - self.limit.value

    @property
    def agrees(self) -> bool:
        """Whether our peak lies within the uncertainty of the limit."""
        return abs(self.deviation) <= self.limit.uncertainty


class Comparison(NamedTuple):
    """All quantities, the version of OpenSees, its coarsest step [T], and the method of our run."""

    rows: list[Compared]
    program: str
    step: float
    method: str


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
    (method,) = (c["METHOD"] for c in ready.model.analyses if c.spec.name == "HISTORY")
    rows = []
    for name, peak in ours.items():
        values = tuple(run.peaks[name] for run in runs)
        rows.append(Compared(name, peak, values, limit(*values)))
    return Comparison(rows, runs[0].program, step, method), ready.warnings, ready.files
