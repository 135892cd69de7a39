"""Fields and Specs of the items of a line, also of an incomplete one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from pound_deck.expressions import Value
from pound_deck.schema import Catalog, Field, Kind, Spec
from pound_deck.sections import CARDS, FAMILIES, SECTIONS

Words = Sequence[tuple[str, str]]  #: items as (upper-case name or nothing, text)
Params = Mapping[str, Value | None]  #: values by upper-case name

_OWN: Final = {spec.name: spec for spec in SECTIONS}
_CARDS: Final = {spec.name: spec for spec in CARDS}
LABEL: Final = Field("LABEL", Kind.PROP, doc="label of the property set", positional=True)


@dataclass(frozen=True, slots=True)
class Fields:
    """Fields of a line.

    Attributes
    ----------
    spec : Spec or None
        None if the kind of the line is missing or unknown.
    family : str
        Family of the line's kind; empty if lines of its section have none.
    kind_at : int
        Index of the item that names the kind; -1 without one.
    known : mapping of str to Field
        Every field that the line may have, by name.
    matched : tuple of Field or None
        The field of each item.
    chosen : mapping of str to Spec
        Members of families that the line chooses, by upper-case name or code as written.
    """

    spec: Spec | None
    family: str
    kind_at: int
    known: Mapping[str, Field]
    matched: tuple[Field | None, ...]
    chosen: Mapping[str, Spec]

    def next(self) -> Field | None:
        """Field of the next positional item; None without one."""
        taken = len(self.matched) - self.kind_at - 1
        places = [f for f in self.known.values() if f.positional]
        return places[taken] if 0 <= taken < len(places) else None


def fields(words: Words, section: str, catalog: Catalog, params: Params | None = None) -> Fields:
    """Fields of a line.

    Parameters
    ----------
    words : sequence of (str, str)
        Its items as (name, text).
    section : str
        Its section; empty for a card outside sections.
    catalog : Catalog
    params : mapping of str to value, optional
        PARAMs, which may name members of families.
    """
    known_params = params or {}
    spec, family, kind_at = _kind(words, section, catalog, known_params)
    known = {f.name: f for f in spec.fields} if spec else {}
    items = _given(words, spec, kind_at)
    chosen = _chosen(items, known, catalog, known_params)
    kind = Field("KIND", Kind.FAMILY, doc=f"kind of {family}", family=family) if family else None
    before = ((kind,), (LABEL, kind))[kind_at] if kind_at >= 0 else ()
    matched = (*before[: len(words)], *(known.get(name) for name, _ in items))
    return Fields(spec, family, kind_at, known, matched, chosen)


def _kind(words: Words, section: str, catalog: Catalog, params: Params) -> tuple[Spec | None, str, int]:
    """Spec of a line, its family, and the index of the item that names it."""
    if not section:
        return _CARDS.get(words[0][1].upper() if words else ""), "", 0
    if section in _OWN:
        return _OWN[section], "", -1
    family, at = FAMILIES[section], 1 if section == "PROPS" else 0
    word = words[at][1] if len(words) > at and not words[at][0] else ""
    return member(word, family, catalog, params), family, at


def _chosen(words: Words, known: dict[str, Field], catalog: Catalog, params: Params) -> dict[str, Spec]:
    """Members of families that a line chooses or takes by default; their fields are added to `known`."""
    texts = {f.name: f.default for f in known.values() if isinstance(f.default, str)} | dict(words)
    chosen = {}
    for f in [f for f in known.values() if f.kind is Kind.FAMILY]:
        for word in texts.get(f.name, "").split(","):
            law = member(word, f.family, catalog, params)
            if law:
                chosen[word.upper()] = law
                known |= {g.name: g for g in law.fields if g.name not in known}
    return chosen


def member(word: str, family: str, catalog: Catalog, params: Params) -> Spec | None:
    """Member of a family by its name, by its old code, or by a PARAM that holds either."""
    members, text = catalog.family(family), word.strip("\"'").upper()
    value = params.get(text) if text not in members else None
    if value is not None:
        text = value.upper() if isinstance(value, str) else f"{value:.15g}"
    if text in members:
        return members[text]
    return catalog.by_code(family, int(text)) if text.isdecimal() and len(text) < 10 else None


def _given(words: Words, spec: Spec | None, kind_at: int) -> list[tuple[str, str]]:
    """Items after the kind as (name of the field, text); the name is empty without a field."""
    places = [f.name for f in spec.fields if f.positional] if spec else []
    items, named = [], False
    for k, (name, text) in enumerate(words[kind_at + 1 :]):
        named = named or bool(name)
        items.append((name or (places[k] if not named and k < len(places) else ""), text))
    return items
