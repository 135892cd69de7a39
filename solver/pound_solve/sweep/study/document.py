"""The file of a study: TOML, the place of every item in it, and the mistakes found there."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeVar

from pound_deck.diagnostics import Diagnostic, suggest
from pound_deck.files import contents
from pound_deck.model import Span
from pound_deck.schema import GREAT, OF_MAGNITUDE

Path_ = tuple[str | int, ...]  #: of an item: names of tables, numbers in lists of tables, its own name
_T = TypeVar("_T")

_KEY: Final = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_KEYS: Final = rf"{_KEY}(?:\s*\.\s*{_KEY})*"
_ITEM: Final = re.compile(rf"\s*({_KEYS})\s*=")
_TABLE: Final = re.compile(rf"\s*(\[\[?)\s*({_KEYS})\s*\]")
_WHERE: Final = re.compile(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)")
DEEPEST: Final = 20  #: most names of an item; the time of reading grows with their square
#: what TOML calls the values, in words
_WORDS: Final = {str: "a text", int: "a whole number", float: "a number", list: "a list", dict: "a table"}


def _number(value: float) -> float:
    """Number of TOML as a float; its integers may be too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def places(text: str, file: str) -> dict[Path_, Span]:
    """Place of every item and table that begins a line, by its path."""
    spans: dict[Path_, Span] = {}
    table: Path_ = ()
    counts: dict[Path_, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if match := _TABLE.match(line):
            table = _names(match[2])
            if match[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                table = (*table, counts[table])
            where = table
        elif match := _ITEM.match(line):
            where = (*table, *_names(match[1]))
        else:
            continue
        start = len(line) - len(line.lstrip())
        spans.setdefault(where, Span(file, number, start + 1, len(line.rstrip()) + 1))
    return spans


def _names(keys: str) -> Path_:
    return tuple(key.strip("\"'") for key in re.findall(_KEY, keys))


@dataclass
class Document:
    """A study file and its mistakes.

    Attributes
    ----------
    name : str
        Its file as the user gave it, or a word for the command line.
    folder : Path
        Folder to which its paths are relative.
    values : dict
        As TOML gives them.
    places : dict of Span by path
    files : dict of str by name
        Texts to which places refer.
    diagnostics : list of Diagnostic
    """

    name: str
    folder: Path
    values: dict[str, Any] = field(default_factory=dict)
    places: dict[Path_, Span] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    @classmethod
    def read(cls, path: str) -> Document:
        """Read a file; raises OSError where it cannot be read."""
        text = contents(path).decode("utf-8-sig", "replace")
        document = cls(path, Path(path).parent, files={path: text}, places=places(text, path))
        if deep := next((place for names, place in document.places.items() if len(names) > DEEPEST), None):
            message = f"a name of more than {DEEPEST} parts"
            document.diagnostics.append(
                Diagnostic("S601", message, deep, "a study has tables of items, no deeper")
            )
            return document
        try:
            document.values = tomllib.loads(text)
        except tomllib.TOMLDecodeError as err:
            document._no_toml(str(err), text)
        except ValueError:
            document._no_toml("a number of too many digits", text)
        except RecursionError:
            document._no_toml("brackets within too many brackets", text)
        return document

    def _no_toml(self, message: str, text: str) -> None:
        """Add a diagnostic at the place where the file is not TOML."""
        lines = text.splitlines() or [""]
        where = _WHERE.search(message)
        if where is None:  # the error concerns the depth or the length of something
            line, column = max(range(len(lines)), key=lambda n: len(lines[n])) + 1, 1
        else:
            line, column = (int(where[1]), int(where[2])) if where[1] else (len(lines), 1)
        said = _WHERE.sub("", message)
        hint = "a text stands in quotes, a list in brackets: gap = [0.01, 0.02]"
        self.diagnostics.append(Diagnostic("S601", said, Span(self.name, line, column, column + 1), hint))

    def set_item(self, path: Path_, value: object, option: str, text: str) -> None:
        """Replace an item of the file by one of the command line."""
        table: Any = self.values
        for name in path[:-1]:
            table = table[name] if isinstance(name, int) else table.setdefault(name, {})
        table[path[-1]] = value
        self.places[path] = Span(option, 1, 1, max(2, len(text) + 1))
        self.files[option] = text

    def place(self, path: Path_) -> Span | None:
        """Place of an item, or of the innermost table around it that has one."""
        for end in range(len(path), 0, -1):
            if path[:end] in self.places:
                return self.places[path[:end]]
        return Span(self.name, 1, 1, 2) if self.name in self.files else None

    def mistake(self, code: str, message: str, path: Path_ = (), hint: str = "") -> None:
        """Add a diagnostic at an item, unless it is there already, or the file is not TOML."""
        if any(d.code == "S601" for d in self.diagnostics):
            return
        diagnostic = Diagnostic(code, message, self.place(path), hint)
        if diagnostic not in self.diagnostics:
            self.diagnostics.append(diagnostic)

    def at(self, path: Path_) -> Any:
        """Value of an item; None where there is none."""
        value: Any = self.values
        for name in path:
            inside = isinstance(value, list) and isinstance(name, int) and name < len(value)
            if not inside and not (isinstance(value, dict) and name in value):
                return None
            value = value[name]
        return value

    def known(self, path: Path_, names: Iterable[str]) -> None:
        """Add a diagnostic for every item of a table that is not one of `names`."""
        names = list(names)
        table = self.at(path)
        for key in table if isinstance(table, dict) else ():
            if key not in names:
                where = ".".join(str(p) for p in path if isinstance(p, str)) or "a study"
                hint = suggest(key, names) or f"it has {', '.join(names)}"
                self.mistake("S602", f"{where} has no item {key}", (*path, key), hint)

    def take(self, path: Path_, kind: type[_T], default: _T) -> _T:
        """Value of an item if it is of a kind, else the default; a wrong value adds a diagnostic."""
        value = self.at(path)
        if value is None:
            return default
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = _number(value)
        if not isinstance(value, kind) or isinstance(value, bool) != (kind is bool):
            self.mistake(
                "S603", f"{path[-1]} is {_WORDS.get(kind, 'true or false')}, not {_value_text(value)}", path
            )
            return default
        if isinstance(value, int | float) and not abs(_number(value)) <= GREAT:
            self.mistake(
                "S603", f"{path[-1]} is a finite number {OF_MAGNITUDE}, not {_value_text(value)}", path
            )
            return default
        return default if self._has_zero(value, path) else value

    def _has_zero(self, value: object, path: Path_) -> bool:
        """Whether a text has a zero character, which no file name can have; adds a diagnostic if so."""
        if not isinstance(value, str) or "\0" not in value:
            return False
        self.mistake("S603", f"{path[-1]} holds a zero character", path)
        return True

    def matching(self, pattern: str) -> list[Path]:
        """Files and folders that match a pattern, sorted; the pattern is relative to the study's folder."""
        path = Path(pattern)
        root = Path(path.anchor) if path.anchor else self.folder
        try:
            return sorted(p.absolute() for p in root.glob(str(path.relative_to(path.anchor))))
        except ValueError:  # not a valid pattern
            return []

    def listed(self, path: Path_, kinds: tuple[type, ...]) -> list[Any]:
        """Values of an item that is a list or a single value; empty where it is left out or wrong."""
        value = self.at(path)
        values = value if isinstance(value, list) else [] if value is None else [value]
        for element in values:
            if not isinstance(element, kinds) or isinstance(element, bool):
                kind = " or ".join(_WORDS[k] for k in kinds if k is not int or float not in kinds)
                self.mistake("S603", f"{path[-1]} takes {kind}, not {_value_text(element)}", path)
                return []
            if isinstance(element, int | float) and not abs(_number(element)) <= GREAT:
                message = f"{path[-1]} takes finite numbers {OF_MAGNITUDE}, not {_value_text(element)}"
                self.mistake("S603", message, path)
                return []
            if self._has_zero(element, path):
                return []
        if value is not None and not values:
            self.mistake("S603", f"{path[-1]} is an empty list", path, "give it a value or leave it out")
        return values

    def tables(self, name: str) -> list[Mapping[str, Any]]:
        """A list of tables, ``[[name]]``, or the one table of ``[name]``."""
        value = self.values.get(name)
        if isinstance(value, dict):  # its items keep their places under a number
            self.values[name] = value = [value]
            for path, place in list(self.places.items()):
                if path[:1] == (name,) and path[1:2] != (0,):
                    self.places[name, 0, *path[1:]] = place
        if value is None:
            return []
        if not isinstance(value, list) or not all(isinstance(v, dict) for v in value):
            self.mistake(
                "S603", f"{name} is a table, not {_value_text(value)}", (name,), f"write [[{name}]]"
            )
            return []
        return value


def _value_text(value: object) -> str:
    """Text of a value for a message."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    return repr(value)[:60]
