"""Commands of OpenSees as a model gave them, with their places."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Mistake, closest, mistake
from pound_deck.model import Span

MOST: Final = 1e30  #: magnitude of a number
_SLIP: Final = 0.9  #: similarity of a misspelt type: OpenSees has many others with similar names


@dataclass(frozen=True, slots=True)
class Command:
    """A command, its words with values in place of variables, and the place that called it."""

    words: tuple[str, ...]
    span: Span

    @property
    def name(self) -> str:
        """Name of the command."""
        return self.words[0]

    def mistake(self, what: str, hint: str = "", code: str = "L622") -> Mistake:
        """Make a Mistake at the place of the command."""
        return mistake(code, what, self.span, hint)

    def no_counterpart(self, name: str, known: Iterable[str], hint: str) -> Mistake:
        """Make a Mistake about a type that is not read; the hint is a known one that it resembles."""
        near = closest(name, known, _SLIP)
        what = f"{self.name} {name[:40]} has no counterpart here"
        return self.mistake(what, f"did you mean {near}?" if near else hint)

    def word(self, k: int, name: str) -> str:
        """Word by position.

        Raises
        ------
        Mistake
            The command is shorter.
        """
        if k < len(self.words):
            return self.words[k]
        raise self.mistake(f"{' '.join(self.words[:2])[:60]}: {name} is missing", code="L620")

    def real(self, k: int, name: str) -> float:
        """Word by position as a number.

        Raises
        ------
        Mistake
            There is none, or it is not a number of possible magnitude.
        """
        return real(self, self.word(k, name), name)

    def whole(self, k: int, name: str) -> int:
        """Word by position as a whole number; raises as `real`."""
        return whole(self, self.word(k, name), name)

    def reals(self, first: int, names: str) -> list[float]:
        """Numbers from a position on, one for each of the names."""
        return [self.real(first + k, name) for k, name in enumerate(names.split())]


def real(command: Command, text: str, name: str) -> float:
    """Number in a word of a command.

    Raises
    ------
    Mistake
        It is not a number of possible magnitude.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if value == 0.0 or 1.0 / MOST <= abs(value) <= MOST:
        return value
    raise command.mistake(f"{name} is {text[:40]!r}, not a number up to {MOST:g}", code="L620")


def whole(command: Command, text: str, name: str) -> int:
    """Whole number in a word of a command; ``1.0`` is one; raises as `real`."""
    value = real(command, text, name)
    if value != round(value) or abs(value) > 2e9:
        raise command.mistake(f"{name} is {text[:40]!r}, not a whole number", code="L620")
    return int(value)


def is_number(text: str) -> bool:
    """Whether a word is a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


@dataclass(frozen=True, slots=True)
class Flags:
    """Words of a command behind its positions, sorted by the flags before them.

    Attributes
    ----------
    command : Command
    plain : tuple of str
        Words before the first flag.
    flags : mapping of str to tuple of str
        Words behind each flag.
    """

    command: Command
    plain: tuple[str, ...]
    flags: Mapping[str, tuple[str, ...]]

    def real(self, flag: str, default: float) -> float:
        """Number behind a flag, or the default where there is no such flag."""
        if flag not in self.flags:
            return default
        return real(self.command, (*self.flags[flag], "")[0], flag)

    def reals(self, flag: str) -> list[float]:
        """All numbers behind a flag; a word may be a list of them."""
        words = " ".join(self.flags.get(flag, ())).split()
        return [real(self.command, word, flag) for word in words]

    def wholes(self, flag: str) -> list[int]:
        """All whole numbers behind a flag."""
        words = " ".join(self.flags.get(flag, ())).split()
        return [whole(self.command, word, flag) for word in words]

    def only(self, known: Collection[str]) -> None:
        """Raise a Mistake for a flag that is not known."""
        for flag in self.flags:
            if flag not in known:
                what = f"{' '.join(self.command.words[:2])[:60]}: the option {flag[:40]} is not read"
                raise self.command.mistake(what)


def options(command: Command, first: int) -> Flags:
    """Sort the words of a command from a position on by flags, words such as ``-mass``."""
    plain: list[str] = []
    flags: dict[str, list[str]] = {}
    current = plain
    for word in command.words[first:]:
        if word[:1] == "-" and word[1:2].isalpha() and not is_number(word):
            current = flags.setdefault(word, [])
        else:
            current.append(word)
    return Flags(command, tuple(plain), {flag: tuple(words) for flag, words in flags.items()})


def joined(parts: Iterable[str]) -> str:
    """Join the parts that are not empty by blanks."""
    return " ".join(part for part in parts if part)
