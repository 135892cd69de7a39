"""Output of ``check --json`` and ``list --json``, for editors and scripts; schemas: manual/tools.md.

A changed name or meaning requires a new `VERSION`; an added entry does not.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.messages import MESSAGES
from pound_deck.schema import REQUIRED, Field, Spec
from pound_deck.sections import CARDS, FAMILIES, NAMES
from pound_solve.report.listing import takes, usage, vocabulary
from pound_solve.version import __version__

VERSION: Final = 1


def mistakes(
    deck: str, diagnostics: Iterable[Diagnostic], size: Mapping[str, int] | None
) -> dict[str, Any]:
    """Result of ``check --json``.

    Parameters
    ----------
    deck : str
        File name of the deck, as the user gave it.
    diagnostics : iterable of Diagnostic
        All mistakes and warnings, in the order of the deck.
    size : mapping of str to int or None
        Numbers of nodes, elements and unknowns; None if the deck has mistakes.

    Returns
    -------
    dict
        Ready for :func:`json.dumps`.
    """
    return {
        "version": VERSION,
        "deck": deck,
        "good": size is not None,
        "size": size and dict(size),
        "diagnostics": [_mistake(d) for d in diagnostics],
    }


def _mistake(d: Diagnostic) -> dict[str, Any]:
    at = d.span
    return {
        "file": at and at.file,
        "line": at and at.line,
        "column": at and at.column,
        "end_column": at and at.end,
        "severity": d.severity,
        "number": d.code,
        "title": MESSAGES[d.code][0],
        "text": d.message,
        "hint": d.hint,
    }


def vocabulary_of_decks() -> dict[str, Any]:
    """Result of ``list --json``: cards, sections, and every member of every family with its items.

    Returns
    -------
    dict
        Ready for :func:`json.dumps`.
    """
    known = vocabulary()
    families = {name: [_member(s) for s in known.family(name).values()] for name in known.families()}
    return {
        "version": VERSION,
        "program": __version__,
        "cards": [_member(s) for s in CARDS],
        "sections": [{"name": name, "family": FAMILIES.get(name)} for name in NAMES],
        "families": families,
    }


def _member(spec: Spec) -> dict[str, Any]:
    return {
        "name": spec.name,
        "code": spec.code,
        "title": spec.title,
        "write": usage(spec),
        "reference": spec.reference,
        "items": [_item(f) for f in spec.fields],
    }


def _item(f: Field) -> dict[str, Any]:
    required = f.default is REQUIRED
    return {
        "name": f.name,
        "kind": f.kind.value,
        "unit": f.unit,
        "required": required,
        "default": None if required else f.default,
        "takes": takes(f),
        "words": list(f.words),
        "family": f.family,
        "by_position": f.positional,
        "range": f.varies,
        "count": list(f.count),
        "meaning": f.doc,
    }
