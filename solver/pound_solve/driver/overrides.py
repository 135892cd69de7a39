"""Replacement of deck items by a request: METHOD, DT, TOL of every HISTORY, and the ground motion.

``--set`` replaces PARAMs when the deck is read.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Final

from pound_deck.diagnostics import Diagnostic, has_errors
from pound_deck.model import Card, Model, Span
from pound_deck.schema import REQUIRED, Field, Spec, out_of_limits
from pound_solve.catalog import catalog
from pound_solve.driver.request import Request

#: items of a motion that define how it acts on the structure
MEETING: Final = ("DIRECTION", "SUPPORTS", "WAVE", "ABOUT")


def overridden(model: Model, request: Request, diagnostics: list[Diagnostic]) -> Model:
    """Return the model with the options of a request; add mistakes to `diagnostics`.

    ``--method``, ``--dt`` and ``--tol`` apply to every HISTORY card; the motion of the request replaces
    that under EQUAKE.
    """
    if request.motion is not None:
        model = with_motion(model, request.motion, diagnostics)
    numbers = {"DT": request.dt, "TOL": request.tol}
    asked = {item: value for item, value in numbers.items() if value is not None}
    if request.method is None and not asked:
        return model
    cards = []
    for card in model.analyses:
        if card.spec.name == "HISTORY":
            changed = _changed(card, request.method, asked, diagnostics)
            if changed is None:
                return model
            card = changed
        cards.append(card)
    if all(card.spec.name != "HISTORY" for card in cards):
        if request.method is not None:
            _method(request.method, diagnostics)
        diagnostics += _invalid(asked, None)
    return replace(model, analyses=tuple(cards))


def with_motion(model: Model, motion: Card, diagnostics: list[Diagnostic]) -> Model:
    """Return the model with another motion instead of the one under EQUAKE.

    The record and the items that define its reading and scaling are the other motion's.  The items
    `MEETING`, which define how it acts on the structure, stay those of the deck's line.
    """
    if len(model.equake) != 1:
        message = (
            f"a motion takes the place of the one line under EQUAKE, and there are {len(model.equake)}"
        )
        place = model.equake[1].span if model.equake else None
        diagnostics.append(Diagnostic("R410", message, place, "name the record by a PARAM"))
        return model
    (old,) = model.equake
    values = {**motion.values, **{item: old.values[item] for item in MEETING}}
    return replace(model, equake=(replace(motion, values=values),))


def _changed(
    card: Card, name: str | None, asked: Mapping[str, float], diagnostics: list[Diagnostic]
) -> Card | None:
    """Return the HISTORY card with the requested method and items; None, with diagnostics, if they are
    wrong.
    """
    method = _method(name or card["METHOD"], diagnostics)
    if method is None:
        return None
    problems = [*_invalid(asked, method), *_unfit(card, method, asked)]
    diagnostics += problems
    if has_errors(problems):
        return None
    card = with_method(card, method, asked)
    missing = [f.name for f in method.fields if card.values[f.name] is REQUIRED]
    if missing:
        message = f"{method.name} needs {', '.join(missing)}"
        diagnostics.append(Diagnostic("P213", message, option("METHOD"), "give --dt; in a study dt"))
        return None
    return card


def _method(name: str, diagnostics: list[Diagnostic]) -> Spec | None:
    """Return the Spec of a method by its name; None, with a diagnostic, if it does not exist."""
    methods = catalog().family("method")
    method = methods.get(name.upper())
    if method is None:
        message = f"{name[:60]} is no method: known methods are {', '.join(methods)}"
        diagnostics.append(Diagnostic("P210", message, option("METHOD")))
    return method


def option(item: str) -> Span:
    """Place, for diagnostics, of a HISTORY item that an option of the request sets."""
    return Span(f"--{item.lower()}", 1, 1, 2)


def _invalid(asked: Mapping[str, float], method: Spec | None) -> Iterator[Diagnostic]:
    """Yield diagnostics for requested values out of limits, and warnings for items that the method lacks.

    The limits are those of the method's items, or for an item that it lacks, those of another method.  The
    method is None for a deck without HISTORY.
    """
    for item, value in asked.items():
        field = method.field(item) if method else None
        others = (m.field(item) for m in catalog().family("method").values())
        if wrong := out_of_limits(value, field or next(filter(None, others))):
            yield Diagnostic("P217", f"{item} {wrong}", option(item))
        elif field is None:
            message = f"{method.name if method else 'a deck without HISTORY'} has no item {item}"
            yield Diagnostic("P211", message, option(item), severity="warning")


def _unfit(card: Card, method: Spec, asked: Mapping[str, float]) -> Iterator[Diagnostic]:
    """Yield diagnostics for items on the card's line that a requested method does not accept."""
    for field in method.fields:
        stated = field.name in card.spans and field.name not in asked
        if stated and (wrong := _outside(card.values[field.name], field)):
            hint = f"take {field.name} out of HISTORY" + ", or give --tol" * (field.name == "TOL")
            message = f"{field.name} of {method.name} {wrong}"
            yield Diagnostic("P217", message, card.spans[field.name], hint)


def _outside(value: Any, field: Field) -> str:
    return out_of_limits(value, field) if isinstance(value, float | int) else ""


def with_method(card: Card, method: Spec, settings: Mapping[str, Any]) -> Card:
    """Return a HISTORY card with another method.

    Its items are those of `settings`, else those on the card's line within the method's limits, else the
    method's defaults; limits and defaults of an item may differ between methods.
    """
    items = {
        f.name: card.values[f.name]
        if f.name in card.spans and not _outside(card.values[f.name], f)
        else f.default
        for f in method.fields
    }
    items |= {item: value for item, value in settings.items() if item in items}
    spans = dict(card.spans) | {item: option(item) for item in ("METHOD", *settings)}
    values = {**card.values, **items, "METHOD": method.name}
    return replace(card, values=values, laws={"METHOD": (method,)}, spans=spans)
