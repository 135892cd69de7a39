"""Rows of a deck, sorted into sections, single cards and PARAMs, before anything is bound."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from pound_deck.cards import Item, ParsedLine
from pound_deck.diagnostics import Diagnostic, closest, hints, suggest
from pound_deck.expressions import RESERVED, Definition, Expression
from pound_deck.model import Span
from pound_deck.schema import Catalog
from pound_deck.sections import CARDS, FAMILIES, NAMES, SINGLE

_KEYWORDS: Final = (*NAMES, *(spec.name for spec in CARDS))


@dataclass(slots=True)
class Outline:
    """Rows of a deck, sorted into sections and single cards.

    `unreadable_sections` are names of sections with unreadable rows, and `incomplete_sections` those of
    them whose unreadable rows define unknown names, so that references cannot be checked.
    `unreadable_props` are labels of property sets whose rows are unreadable.
    """

    catalog: Catalog
    report: list[Diagnostic]
    sections: dict[str, list[ParsedLine]] = field(default_factory=lambda: {name: [] for name in NAMES})
    single: dict[str, ParsedLine] = field(default_factory=dict)
    definitions: dict[str, Definition] = field(default_factory=dict)
    lost: set[str] = field(default_factory=set)
    unreadable_sections: set[str] = field(default_factory=set)
    incomplete_sections: set[str] = field(default_factory=set)
    unreadable_props: set[str] = field(default_factory=set)
    _section: str | None = None
    _skipping: bool = False

    def add(self, row: ParsedLine) -> None:
        """Sort a row into its section, or take it as a single card or as PARAMs."""
        if row.word in NAMES:
            self._open(row)
        elif row.word in SINGLE:
            if row.word in self.single:
                self._error("P237", f"{row.word} is given twice", row.span, "take one of them out")
            self.single.setdefault(row.word, row)
        elif row.word == "PARAM":
            self._define(row)
        elif row.items and row.items[0].name in (*SINGLE, "PARAM"):
            name = row.items[0].name
            self._error(
                "P209", f"{name} is no named item", row.items[0].name_span, f"write {name} without ="
            )
        elif row.items is None:
            self.lose(self._section or "NODES", row.word)
        elif self._misspelt(row):
            pass
        elif self._section:
            self.sections[self._section].append(row)
        elif not self._skipping:
            self._skipping = True  # one message for all the lines up to the next section
            hint = hints(
                suggest(row.word, _KEYWORDS) if row.word else "", "write NODES, ELEMENTS, ... above it"
            )
            self._error("P234", "this line stands before any section", row.span, hint)
            self.lose_all()

    def lose(self, section: str, label: str = "") -> None:
        """Record that a section has lost a row to a mistake, with the row's first label, if known."""
        self.unreadable_sections.add(section)
        if section == "PROPS" and label:
            self.unreadable_props.add(label)
        else:
            self.incomplete_sections.add(section)

    def lose_all(self) -> None:
        """Record that rows of any section may be lost."""
        for section in NAMES:
            self.lose(section)

    def _open(self, row: ParsedLine) -> None:
        self._section = row.word
        rest = (row.items or ())[1:]
        # Ruaumoko's sections may carry a number, which has no meaning here
        if rest and not (len(rest) == 1 and _is_whole(rest[0])):
            hint = "put column heads behind an exclamation mark; a name of a section cannot be a label"
            self._error("P236", f"{row.word} stands alone on its line", rest[0].name_span, hint)

    def _misspelt(self, row: ParsedLine) -> bool:
        """Whether a row is a misspelt section name; if so, report it and open the section that is meant."""
        items = row.items or ()
        if not _like_a_heading(items) or row.word in self.definitions or row.word in self.lost:
            return False
        # names of records under EQUAKE are nearer to sections than other words: ELCENTRO, ELEMENTS
        meant = closest(row.word, (*NAMES, *SINGLE), 0.65)
        family = FAMILIES.get(self._section or "", "")
        kinds = self.catalog.family(family) if family != "element" else {}
        if row.word in kinds or closest(row.word, kinds) or (not meant and len(items) == 2):
            return False  # an ordinary line of the section above, perhaps with another mistake
        lines = f"lines of {self._section} start with {', '.join(kinds)}" if kinds else ""
        hint = hints(f"did you mean {meant}?" if meant else lines, "sections are " + ", ".join(NAMES))
        self._error("P235", f"{row.word[:60]} is no section", row.span, hint)
        self._section, self._skipping = (meant if meant in NAMES else None), True
        if not self._section:
            self.lose_all()
        return True

    def _define(self, row: ParsedLine) -> None:
        if row.items is None:
            self.lost |= {name.upper() for name in re.findall(r"([A-Za-z_][\w.]*)\s*=", row.line.text)}
            return
        items = row.items[1:]
        for item in items:
            name, place, part = item.name, item.name_span, item.parts[0]
            if not name or len(item.parts) > 1 or not isinstance(part, Expression):
                hint = "write PARAM name = value; an expression holds no blanks outside brackets"
                self._error("P231", "PARAM takes name = value, one value each", item.span, hint)
                self.lost |= {i.name or i.word for i in items}
                break
            if name in RESERVED:
                self._error("P230", f"{name} cannot be the name of a PARAM", place, "choose another name")
            elif name in self.definitions:
                first = self.definitions[name].span
                self._error(
                    "P229", f"PARAM {name} is already given in line {first.line}", place, "take one out"
                )
            else:
                self.definitions[name] = Definition(name, part, place)
        if not items:
            self._error("P231", "PARAM without a name", row.span, "write PARAM name = value")

    def _error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.report.append(Diagnostic(code, message, span, hint))


def _like_a_heading(items: Sequence[Item]) -> bool:
    """Whether a line has the form of a section name: a word alone, or a word and a whole number."""
    numbered = len(items) == 2 and _is_whole(items[1])
    return bool(items and items[0].word) and (len(items) == 1 or numbered)


def _is_whole(item: Item) -> bool:
    step = item.parts[0].lone if len(item.parts) == 1 and isinstance(item.parts[0], Expression) else None
    return bool(step and not item.name and step.kind == "number" and step.text.isdecimal())
