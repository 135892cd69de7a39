"""One run from end to end: deck, model, structure, analyses, results file, report.

The only module that knows every stage.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from pound_deck.diagnostics import Diagnostic, has_errors
from pound_deck.model import Card, Model, Span
from pound_deck.reader import read_deck
from pound_deck.schema import REQUIRED, Spec
from pound_solve import __version__
from pound_solve.analyses import pushover
from pound_solve.catalog import catalog
from pound_solve.driver.sequence import Course, Progress
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import METRE, LoadingContext, Motion
from pound_solve.loading.motions.wave import fronts
from pound_solve.loading.records.base import RecordError
from pound_solve.numerics.types import Array
from pound_solve.results.file import Results, ResultsError, Writer
from pound_solve.structure import reduction
from pound_solve.structure.assembly import AssemblyError, Structure, assemble

DONE, STOPPED = 0, 1  #: exit statuses; the others are the command line's own


class DeckError(Exception):
    """The deck has mistakes; `diagnostics` are all of them and `files` the texts they point into."""

    def __init__(self, diagnostics: Sequence[Diagnostic], files: Mapping[str, str]) -> None:
        from pound_deck.diagnostics import render

        super().__init__(render(diagnostics, files))
        self.diagnostics, self.files = tuple(diagnostics), dict(files)


@dataclass(frozen=True)
class Request:
    """What the user asks of a run.

    Attributes
    ----------
    deck : str
        Path of the deck.
    params : mapping of str to str
        PARAM values that replace the deck's.
    out : Path or None
        Folder of report and results; None for the deck's.
    records : tuple of Path
        Folders where records are looked for, after the deck's own.
    method, dt, tol : str or None, float or None
        Replace METHOD, DT and TOL of every HISTORY.
    explain : bool
        Put what the run imports, compiles and holds into the results.
    """

    deck: str
    params: Mapping[str, str] = field(default_factory=dict)
    out: Path | None = None
    records: tuple[Path, ...] = ()
    method: str | None = None
    dt: float | None = None
    tol: float | None = None
    explain: bool = False

    def path(self, suffix: str) -> Path:
        """Path of an output file."""
        deck = Path(self.deck)
        return (self.out or deck.parent) / (deck.stem + suffix)


@dataclass(frozen=True)
class Prepared:
    """A deck that is read and checked, its motions, its forces in time and its assembled structure."""

    model: Model
    motions: tuple[Motion, ...]
    forces: tuple[Force, ...]
    structure: Structure
    warnings: tuple[Diagnostic, ...]
    files: Mapping[str, str]
    saved: Mapping[str, Array] = field(default_factory=dict)


def prepare(request: Request) -> Prepared:
    """Read a deck, its records, and assemble the structure.

    Raises
    ------
    DeckError
        The deck, a record or the structure has mistakes: all that can be told at once.
    OSError
        The deck cannot be read.
    """
    model, found, files = read_deck(request.deck, catalog(), request.params)
    if model is None or has_errors(found):
        raise DeckError(found, files)
    found = list(found)
    model = _override(model, request, found)
    surroundings = context(model, request)
    motions = _motions(model, surroundings, found)
    forces = [force for card in model.forces if (force := _built(card, surroundings, found)) is not None]
    structure = None
    try:
        fixed = [(n.id, d) for n in model.nodes.values() for d in range(3) if "XYR"[d] in n.fixed]
        heavy = any(c.spec.name == "STATIC" and c["GRAVITY"] == "YES" for c in model.analyses)
        self_weight = all(c["SELF_WEIGHT"] == "YES" for c in model.analyses if c.spec.name == "STATIC")
        structure = assemble(
            _weighed(model) if heavy else model, reduction.moved_supports(motions, fixed), self_weight
        )
    except AssemblyError as err:
        found += err.diagnostics
    if structure is not None:
        found += (
            _inclined(structure) + _pressed(structure) + _adrift(structure) + pushover.mistakes(structure)
        )
    saved = _saved(model, request, found)
    if has_errors(found) or structure is None:
        raise DeckError(found, files)
    return Prepared(model, tuple(motions), tuple(forces), structure, tuple(found), files, saved)


def _saved(model: Model, request: Request, found: list[Diagnostic]) -> dict[str, Array]:
    """State of the results file that a history goes on from; read before the file may be written anew."""
    for card in model.analyses:
        if card.spec.name != "HISTORY" or not card["RESTART"]:
            continue
        path = Path(request.deck).parent / card["RESTART"]
        try:
            with Results.open(path) as results:
                state = results.restart()
        except ResultsError as err:
            found.append(Diagnostic("R406", str(err), card.place("RESTART")))
            return {}
        if not state:
            found.append(Diagnostic("R406", f"{path} holds no state to go on from", card.place("RESTART")))
        return state
    return {}


def _built(card: Card, surroundings: LoadingContext, found: list[Diagnostic]) -> Any:
    """What a card of EQUAKE or FORCES makes; None where it has a mistake."""
    try:
        return card.spec.impl(card.values, surroundings)
    except RecordError as err:
        found.append(Diagnostic(err.code, err.message, card.place(err.item), hint=err.hint))
        return None


def _motions(model: Model, surroundings: LoadingContext, found: list[Diagnostic]) -> list[Motion]:
    """Ground motions of all EQUAKE cards, a wave as one for each place."""
    out: list[Motion] = []
    place = {node.id: node.x for node in model.nodes.values()}
    apart = [card for card in model.equake if card["SUPPORTS"] is not None]
    whole = [card for card in model.equake if card["SUPPORTS"] is None]
    if apart and whole:
        message = "some motions have SUPPORTS and this one has not: give SUPPORTS to all or to none"
        found.append(Diagnostic("R405", message, whole[0].span))
    for card in model.equake:
        motion: Motion | None = _built(card, surroundings, found)
        if motion is None:
            continue
        found += [
            Diagnostic("R404", w, card.span, severity="warning") for w in motion.info.get("warnings", ())
        ]
        ways = {"XYR"[d] for d in motion.directions}
        for node in motion.supports or ():
            if not ways & set(model.nodes[node].fixed):
                message = f"node {node} is not fixed along {motion.direction}: a support that moves must be"
                found.append(Diagnostic("R405", message, card.place("SUPPORTS")))
        out += fronts(motion, place)
    return out


def _inclined(structure: Structure) -> list[Diagnostic]:
    """Contacts along an inclined line between their nodes: seldom meant between floors."""
    out = []
    for spring in structure.laws:
        if not spring.role.collides:
            continue
        element = structure.model.elements[spring.element]
        angle = spring.facts["angle"]
        if structure.model.props[element.prop]["ANGLE"] is None and angle % 90.0:
            message = (
                f"contact {spring.element} acts along the line between its nodes, at {angle:.4g} degrees"
            )
            hint = "give ANGLE (0 for floors that meet along x) if that is not meant"
            out.append(Diagnostic("P334", message, element.span, hint, "warning"))
    return out


def _pressed(structure: Structure) -> list[Diagnostic]:
    """Contacts that are closed at rest: some programs write the gap with a minus sign."""
    elements, props = structure.model.elements, structure.model.props
    used = dict.fromkeys(elements[s.element].prop for s in structure.laws if s.role.collides)
    hint = "a distance is positive; leave it if the bodies are pressed on purpose"
    return [
        Diagnostic(
            "P336",
            f"contacts of {label} are pressed at rest: GAP is {props[label]['GAP']:g}",
            props[label].place("GAP"),
            hint,
            "warning",
        )
        for label in used
        if props[label]["GAP"] < 0.0
    ]


def _adrift(structure: Structure) -> list[Diagnostic]:
    """Motions of the whole base that nothing ties the structure to: it stays behind, as one body.

    What flies by itself is meant to.  Contacts with the ground and dashpots tie it too.
    """
    model, dofs = structure.model, structure.dofs
    if model.initial or model.forces or all(c.spec.name != "HISTORY" for c in model.analyses):
        return []
    k = structure.displaced(np.zeros(structure.n_free)).initial_stiffness
    dashpots = [b for p in structure.parts.values() for b in p.damping]
    ways = {c["DIRECTION"]: c for c in reversed(model.equake) if c["SUPPORTS"] is None}
    out = []
    for way in sorted(ways.keys() - {"R"}):
        d = "XY".index(way)
        ride = np.array([float(own == d) for _, own in dofs.free] + [0.0] * len(dofs.moved))
        ends = [[dofs.value((f,), (1.0,), ride) for f in b.dofs] for b in dashpots]
        tied = (
            (abs(k @ ride) > 1e-9 * (abs(k) @ ride)).any()
            or (structure.law_rows @ ride).any()
            or any((b.matrix @ u).any() for b, u in zip(dashpots, ends))
        )
        if ride @ structure.ground[d] > 0.0 and not tied:
            message = f"nothing ties the structure to the ground along {way}: it stays behind as one body"
            hint = f"fix {way} of its base under NODES, or join it to the ground by an element"
            out.append(Diagnostic("P337", message, ways[way].span, hint, "warning"))
    return out


def context(model: Model, request: Request) -> LoadingContext:
    """What motions need to know: units, search path, length of the analysis."""
    folders = [Path(request.deck).parent, *request.records]
    folders += [Path(p) for p in os.environ.get("POUND_RECORDS", "").split(os.pathsep) if p]
    duration = max((c["T"] for c in model.analyses if c.spec.name == "HISTORY"), default=0.0)
    return LoadingContext(
        model.gravity, METRE.get(model.units.length.lower(), 1.0), tuple(folders), duration
    )


def _weighed(model: Model) -> Model:
    """The model with its nodal weights as loads (STATIC GRAVITY=YES)."""
    extra = []
    for card in model.weights:
        wy = card["WX"] if card["WY"] is None else card["WY"]
        load = {"NODES": card["NODES"], "FX": 0.0, "FY": -wy, "MZ": 0.0, "HELD": "YES"}
        extra.append(replace(card, values=load))
    return replace(model, loads=(*model.loads, *extra))


def _override(model: Model, request: Request, found: list[Diagnostic]) -> Model:
    """Put ``--method``, ``--dt`` and ``--tol`` into the HISTORY cards."""
    given = {"DT": request.dt, "TOL": request.tol}
    if request.method is None and set(given.values()) == {None}:
        return model
    methods = catalog().family("method")
    cards = []
    for card in model.analyses:
        if card.spec.name == "HISTORY":
            name = (request.method or card["METHOD"]).upper()
            if name not in methods:
                found.append(
                    Diagnostic(
                        "P210", f"--method {request.method}: known methods are {', '.join(methods)}", None
                    )
                )
                return model
            method = methods[name]
            asked = {item: value for item, value in given.items() if value is not None}
            for item in asked:
                if item not in {f.name for f in method.fields}:
                    message = f"--{item.lower()}: {name} has no item {item}"
                    found.append(Diagnostic("P211", message, None, severity="warning"))
            card = with_method(card, method, asked)
            missing = [f.name for f in method.fields if card.values[f.name] is REQUIRED]
            if missing:
                found.append(
                    Diagnostic("P213", f"--method {name} needs {', '.join(missing)}: give --dt", None)
                )
                return model
        cards.append(card)
    return replace(model, analyses=tuple(cards))


def with_method(card: Card, method: Spec, given: Mapping[str, Any]) -> Card:
    """HISTORY card with another method: the card's own items where the method has them, else the defaults,
    and what is given.
    """
    own = {f.name: card.values.get(f.name, f.default) for f in method.fields}
    # an item of the deck's own method that was left out there may be one that this method must have
    own |= {f.name: f.default for f in method.fields if own[f.name] is None}
    own |= {item: value for item, value in given.items() if item in own}
    spans = dict(card.spans) | {k: Span("--method/--dt", 1, 1, 2) for k in ("METHOD", *given)}
    values = {**card.values, **own, "METHOD": method.name}
    return replace(card, values=values, laws={"METHOD": (method,)}, spans=spans)


def execute(request: Request, progress: Progress | None = None) -> tuple[int, Results, Prepared]:
    """Run a deck and write its results and report.

    Returns
    -------
    status : int
        `DONE`, or `STOPPED` when an analysis ended early (what was computed is kept).
    results : Results
        The results file, opened.
    prepared : Prepared
        The model and its warnings.

    Raises
    ------
    DeckError, OSError
        See `prepare`; or an output file cannot be written.
    """
    began = time.perf_counter()
    ready = prepare(request)
    if request.out is not None:
        request.out.mkdir(parents=True, exist_ok=True)
    status, results = solve(ready, request.path(".h5"), progress, began, request)
    from pound_solve.report.text import render

    request.path(".rpt").write_text(render(results), encoding="ascii", newline="\n")
    return status, results, ready


def solve(
    ready: Prepared, path: Path, progress: Progress | None, began: float, request: Request
) -> tuple[int, Results]:
    """Run the analyses of a prepared deck into a results file.

    Parameters
    ----------
    ready : Prepared
    path : Path
        The results file.
    progress : callable or None
    began : float
        Reading of `time.perf_counter` from which the total time counts.
    request : Request
        Tells which PARAMs do not come from the deck, and whether to explain.

    Returns
    -------
    status : int
        `DONE` or `STOPPED`.
    results : Results
        The file, opened.
    """
    with Writer(
        path, title=ready.model.title, units=ready.model.units, program_version=__version__
    ) as writer:
        given = {name.lower() for name in request.params}
        message = Course(
            ready.model, ready.motions, ready.forces, ready.structure, given, writer, progress, began,
            ready.saved, request.explain,
        ).all()  # fmt: skip
        writer.finish("stopped" if message else "done", message)
    return (STOPPED if message else DONE), Results.open(path)
