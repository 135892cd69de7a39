r"""Grammar of decks for editors that colour by TextMate's rules, among them VS Code and Sublime Text.

Every rule is one expression on one line, in what Oniguruma and Python's ``re`` have in common, so that the
tests can apply it; that of PARAM holds to the end of its line.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any, Final

from highlighters.words import EXTENSIONS, Words, words

SCOPE: Final = "source.pound-deck"

_END: Final = r"(?![\w.])"  #: of a word
_NOT_NAME: Final = r"(?![\w.]|\s*=)"  #: of a word that is no name of an item
_TEXT: Final = r"""(?:"[^"]*"|'[^']*')"""


def grammar() -> dict[str, Any]:
    """Return the grammar, ready for :func:`json.dumps`."""
    return {
        "name": "pound-solve deck",
        "scopeName": SCOPE,
        "fileTypes": list(EXTENSIONS),
        "patterns": _patterns(words()),
    }


def text() -> str:
    """Return the file ``pound-deck.tmLanguage.json``."""
    return json.dumps(grammar(), indent=1) + "\n"


def _patterns(w: Words) -> list[dict[str, Any]]:
    alone = _any(w.sections)
    cards = _any(set(w.cards) - {"TITLE", "INCLUDE", "PARAM"})
    comment = _rule(r"!.*$", "comment.line.exclamation")
    text = _rule(_TEXT, "string.quoted")
    named = _rule(r"(?<![\w.])([A-Za-z_][\w.]*)\s*(=)", "", "variable.other.name", "keyword.operator")
    values = _values(w)
    # a PARAM may have the name of an item
    param = {
        "begin": rf"(?i)^\s*(PARAM){_NOT_NAME}",
        "beginCaptures": {"1": {"name": _scope("keyword.control")}},
        "end": "$",
        "patterns": [comment, text, named, *values],
    }
    return [
        comment,
        _rule(rf"(?i)^\s*(TITLE){_END}([^!\"']*)", "", "keyword.control", "string.unquoted.title"),
        _rule(
            rf"(?i)^\s*(INCLUDE){_NOT_NAME}\s*({_TEXT}|[^\s!]*)", "", "keyword.control", "string.other.file"
        ),
        param,
        _rule(rf"(?i)^\s*({alone})(?=\s*(?:\d+\s*)?(?:!|$))", "", "entity.name.section"),
        _rule(rf"(?i)^\s*({cards}){_NOT_NAME}", "", "keyword.control"),
        _rule(rf"(?i)^\s*({_any(w.kinds)}){_NOT_NAME}", "", "support.type.kind"),
        _rule(
            rf"""(?i)^\s*({_TEXT}|[^\s!="',]+)\s+({_any(w.elements)}){_NOT_NAME}""",
            "",
            "entity.name.label",
            "support.type.kind",
        ),
        text,
        _rule(rf"(?i)(?<![\w.])({_any(w.items)})\s*(=)", "", "variable.parameter.item", "keyword.operator"),
        named,
        _rule(rf"(?i)(?<=[=,])({_any(w.members)}){_END}", "support.class.member"),
        _rule(rf"(?i)(?<=[=,])({_any(w.choices)}){_END}", "constant.language.choice"),
        *values,
    ]


def _values(w: Words) -> list[dict[str, Any]]:
    """What expressions and ranges are made of."""
    return [
        _rule(rf"(?i)(?<![\w.])({_any(w.functions)})(?=\()", "support.function"),
        _rule(rf"(?i)(?<![\w.])PI{_END}", "constant.language.pi"),
        _rule(rf"(?i)(?<![\w.])(TO|BY){_NOT_NAME}", "keyword.operator.range"),
        _rule(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]?\d+)?(?![\w.])", "constant.numeric"),
        _rule(r"&(?=\s*(?:!|$))", "keyword.operator.continuation"),
        _rule(r"\*\*|[-+*/^=,]", "keyword.operator"),
        _rule(r"[A-Za-z_][\w.]*", "variable.other.word"),
    ]


def _any(choices: Iterable[str]) -> str:
    """Alternatives, a longer one before its own beginning."""
    return "|".join(sorted(choices, key=lambda word: (-len(word), word)))


def _rule(match: str, name: str, *captures: str) -> dict[str, Any]:
    """A rule that names all that it matches, or its groups."""
    out: dict[str, Any] = {"match": match}
    if name:
        out["name"] = _scope(name)
    if captures:
        out["captures"] = {str(k): {"name": _scope(c)} for k, c in enumerate(captures, 1)}
    return out


def _scope(name: str) -> str:
    return f"{name}.{SCOPE.rpartition('.')[2]}"
