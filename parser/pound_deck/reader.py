"""From a deck's file to its Model and all its diagnostics: the stages of reading, in order."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from pound_deck.build import build
from pound_deck.cards import parse, parse_items
from pound_deck.checks import run_checks
from pound_deck.diagnostics import Diagnostic, Mistake, has_errors, hints, suggest, unsuppressed
from pound_deck.expressions import Definition, Expression, ExpressionStep, Value, resolve
from pound_deck.model import Model, Span
from pound_deck.outline import Outline
from pound_deck.schema import Catalog
from pound_deck.source import DeckSource, LogicalLine

Reading = tuple[Model | None, list[Diagnostic], dict[str, str]]


def read_deck(
    path: str,
    catalog: Catalog,
    overrides: Mapping[str, str] | None = None,
    unsaved: Mapping[str, str] | None = None,
) -> Reading:
    """Read and check a deck.

    Parameters
    ----------
    path : str
        The deck's file; spans carry this name.
    catalog : Catalog
        Every Spec that PROPS, DAMPING, EQUAKE, FORCES and ANALYSIS may hold.
    overrides : mapping of str to str
        Texts that replace PARAM values, by name in any case.
    unsaved : mapping of str to str
        Texts of an editor by real path, read in place of these files.

    Returns
    -------
    model : Model or None
        None only when there are errors.
    diagnostics : list of Diagnostic
        All mistakes and warnings, in the order of the deck.
    files : dict of str to str
        Texts by file name, for :func:`~pound_deck.diagnostics.caret`.

    Raises
    ------
    OSError
        The deck cannot be read.
    """
    source = DeckSource(unsaved=unsaved or {})
    lines = source.read(str(path))
    with _no_collection():
        return _read(source, lines, catalog, overrides or {})


def read_text(
    text: str, catalog: Catalog, overrides: Mapping[str, str] | None = None, name: str = "deck.inp"
) -> Reading:
    """Read and check a deck given as text; see :func:`read_deck`."""
    source = DeckSource()
    data = text.encode("utf-8", "surrogatepass")
    lines = source.lines(name, source.decode(name, data, Span(name, 1, 1, 2)))
    with _no_collection():
        return _read(source, lines, catalog, overrides or {})


@contextmanager
def _no_collection() -> Iterator[None]:
    """Pause garbage collection: a deck makes no reference cycles, and a long one takes twice the time."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _read(
    source: DeckSource, lines: list[LogicalLine], catalog: Catalog, overrides: Mapping[str, str]
) -> Reading:
    report = source.report
    files = source.files
    unread = has_errors(report)
    outline = Outline(catalog, report)
    rows = list(parse(lines, report))
    for row in sorted(rows, key=lambda row: row.word != "PARAM"):  # names first: a line may start with one
        outline.add(row)
    texts = {f"--set {name}": str(value) for name, value in overrides.items()}
    if unread:  # checks would only report definitions that are in the unread file as missing
        outline.lose_all()
        texts = {}
    params = _params(outline, texts, report)
    model, cards = build(outline, params, catalog, dict(files), report)
    report += run_checks(
        model, cards, outline.unreadable_sections, outline.incomplete_sections, outline.unreadable_props
    )
    if unread:  # names may be defined in unread files
        report[:] = [d for d in report if d.code not in ("P222", "P234")]
    order = {name: k for k, name in enumerate(files)}
    report.sort(
        key=lambda d: (
            (order.get(d.span.file, -1), d.span.line, d.span.column) if d.span else (len(order), 0, 0)
        )
    )
    report[:] = unsuppressed(report, model.meant)
    return (None if has_errors(report) else model), report, {**files, **texts}


def _params(
    outline: Outline, texts: Mapping[str, str], report: list[Diagnostic]
) -> dict[str, Value | None]:
    """Values of all PARAMs; `texts` holds the overrides by the name that their spans carry."""
    if texts:
        values = resolve(outline.definitions, [], outline.lost)  # to find which PARAMs hold texts
        for source, text in texts.items():
            _override(source, text, values, outline, report)
    return resolve(outline.definitions, report, outline.lost)


def _override(
    source: str, text: str, params: Mapping[str, Value | None], outline: Outline, report: list[Diagnostic]
) -> None:
    """Replace the definition of a PARAM by the text of an override; `params` are the deck's values."""
    name = source.removeprefix("--set ").strip()
    line = LogicalLine(source, 1, text)
    place = Span(source, 1, 1, max(2, len(text) + 1))
    key = name.upper()
    if key not in outline.definitions:
        if key not in outline.lost:
            hint = hints(
                suggest(key, params), f"its PARAMs are {', '.join(params)}" if params else "it has no PARAM"
            )
            report.append(Diagnostic("P232", f"the deck has no PARAM {name[:60]}", place, hint))
        return
    # a text stays a text: paths hold slashes, dashes and blanks
    value = _text(text, place) if isinstance(params[key], str) else _number(line)
    if value is None:
        message = f"PARAM {name} holds a number, and {text[:60]!r} is none"
        hint = f"write --set {name}=5, or an expression without blanks"
        report.append(Diagnostic("P233", message, place, hint))
    else:
        outline.definitions[key] = Definition(outline.definitions[key].name, value, place)


def _text(text: str, place: Span) -> Expression:
    """Expression of a text, without the quotes around it."""
    bare = text.strip()
    quoted = len(bare) > 1 and bare[0] == bare[-1] and bare[0] in "\"'" and bare.count(bare[0]) == 2
    return Expression((ExpressionStep("text", bare[1:-1] if quoted else bare, place),), place, bare)


def _number(line: LogicalLine) -> Expression | None:
    """The single expression of a line, such as a number; None where the line holds anything else."""
    try:
        items = parse_items(line)
    except Mistake:
        return None
    if len(items) != 1 or items[0].name or len(items[0].parts) != 1:
        return None
    part = items[0].parts[0]
    return part if isinstance(part, Expression) and not (part.lone and part.lone.kind == "text") else None
