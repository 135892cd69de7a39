"""Compare the peaks of a deck with those of OpenSees at three halved steps."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median_low
from typing import Final, NamedTuple

from pound_deck.diagnostics import Diagnostic
from pound_solve.check import Subject
from pound_solve.driver.prepare import prepare
from pound_solve.driver.request import Request
from pound_solve.driver.run import in_temporary_folder
from pound_solve.opensees import environment
from pound_solve.opensees.export import export
from pound_solve.opensees.extrapolation import Limit, limit
from pound_solve.opensees.peaks import ComparedItems, our_peaks, word
from pound_solve.user_error import UserError

HALVINGS: Final = (1, 2, 4)  #: parts of the coarsest step
AGREES, UNDECIDED, DIFFERS = "agrees", "undecided", "differs"  #: outcomes of a quantity
DOUBT: Final = 0.01  #: share of a quantity up to which its uncertainty decides
COARSEST: Final = 50.0  #: largest step over that of the script


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
    scale : float
        Largest limit of the quantities of its kind, forces or displacements.
    """

    name: str
    ours: float
    our_error: float
    theirs: tuple[float, ...]
    limit: Limit
    scale: float = 0.0

    @property
    def deviation(self) -> float:
        """Our peak less the limit."""
        return self.ours - self.limit.value

    @property
    def size(self) -> float:
        """What deviations and uncertainties are shares of: the limit, or a tenth of the scale."""
        return max(abs(self.limit.value), 0.1 * self.scale)

    @property
    def outcome(self) -> str:
        """AGREES if our peak lies within the uncertainty of the limit and its own error, and these are
        small; UNDECIDED if it lies there and they are not; else DIFFERS.
        """
        doubt = self.limit.uncertainty + self.our_error
        if abs(self.deviation) > doubt:
            return DIFFERS
        return AGREES if doubt <= DOUBT * self.size else UNDECIDED


class Comparison(NamedTuple):
    """All quantities, the version of OpenSees, its coarsest step [T], our method, its estimated error
    relative to a peak, and a remark on differences of the models.
    """

    rows: list[Compared]
    program: str
    step: float
    method: str
    error: float
    remark: str


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
    UserError
        The step is far too coarse.
    """
    ready = prepare(request)
    exported = export(ready, request.deck)
    environment.version(python)
    step = step or exported.step
    if step > COARSEST * exported.step:
        most = COARSEST * exported.step
        raise UserError(
            f"--step {step:g} is too coarse: at most {most:g}; the default is {exported.step:g}"
        )
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
        if any(name not in run.peaks for run in runs):
            raise environment.OpenSeesError(f"OpenSees prints no peak of {name}")
        values = tuple(run.peaks[name] for run in runs)
        rows.append(Compared(name, peak, error * abs(peak), values, limit(*values)))
    rows = evened(rows, exported.compared)
    comparison = Comparison(rows, runs[0].program, step, method, error, exported.remark)
    return comparison, ready.warnings, ready.files


def evened(rows: list[Compared], items: ComparedItems) -> list[Compared]:
    """Rows with the scale of their kind, forces or displacements, whose relative uncertainty is at least
    the median of that kind.

    Events within steps disturb all quantities; one whose three values are close by chance is not more
    certain than others.
    """
    forces = {f"contact {name}, force" for name in items.contacts}
    out: dict[str, Compared] = {}
    for kind in (True, False):
        same = [x for x in rows if (x.name in forces) == kind]
        scale = max((abs(x.limit.value) for x in same), default=0.0)
        scaled = [x._replace(scale=scale) for x in same]
        large = [x for x in scaled if abs(x.limit.value) == x.size > 0.0]
        least = median_low([x.limit.uncertainty / x.size for x in large]) if large else 0.0
        for x in scaled:
            doubt = max(x.limit.uncertainty, least * abs(x.limit.value))
            out[x.name] = x._replace(limit=x.limit._replace(uncertainty=doubt))
    return [out[x.name] for x in rows]
