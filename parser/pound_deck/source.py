"""Files to logical lines: encodings, line ends, comments, continuations and INCLUDE."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.files import opened
from pound_deck.model import Span

MAX_BYTES: Final = 8_000_000
MAX_DEPTH: Final = 20
MAX_INCLUDES: Final = 1000
MAX_LINE: Final = 2_000_000

_COMMENT: Final = re.compile(r""""[^"]*"|'[^']*'|(!)""")
INCLUDE: Final = re.compile(r"\s*INCLUDE(?![\w.])\s*(?!=)(.*)", re.IGNORECASE | re.DOTALL)
_FILE_NAME: Final = re.compile(r"""("[^"\n]+"|'[^'\n]+'|[^\s"']+)\s*""")
_PAGE: Final = re.compile(r"\s*<(!doctype|html|head|\?xml)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class LogicalLine:
    """A logical line without its comments: the text of one card.

    Continued lines are joined by a line end, so that columns still count from the start of their own line.
    """

    file: str
    number: int
    text: str

    @property
    def span(self) -> Span:
        """Span of the first physical line, without the blanks around it."""
        first = self.text.split("\n", 1)[0]
        column = len(first) - len(first.lstrip()) + 1
        return Span(self.file, self.number, column, max(len(first.rstrip()), column) + 1)


@dataclass(slots=True)
class DeckSource:
    """Reads a deck and its included files.

    Attributes
    ----------
    report : list of Diagnostic
        Receives the mistakes of the files.
    files : dict of str to str
        Texts by the name in spans; line ends are ``\\n``.
    unsaved : mapping of str to str
        Texts of an editor by real path, read in place of these files.
    """

    report: list[Diagnostic] = field(default_factory=list)
    files: dict[str, str] = field(default_factory=dict)
    unsaved: Mapping[str, str] = field(default_factory=dict)
    _bytes: int = 0
    _includes: int = 0

    def read(self, name: str) -> list[LogicalLine]:
        """Logical lines of a deck.

        Raises
        ------
        OSError
            The deck itself cannot be read; for an included file that is a diagnostic.
        """
        return self.lines(name, self._load(name, Span(name, 1, 1, 2)), (os.path.realpath(name),))

    def lines(self, name: str, text: str, path: tuple[str, ...] = ()) -> list[LogicalLine]:
        """Logical lines of a text; `path` names the files being read, outermost first."""
        self.files[name] = text
        lines: list[LogicalLine] = []
        for line in self.logical(name, text):
            include = INCLUDE.match(line.text)
            if include:
                lines += self._include(line, include[1], path)
            elif is_end(line.text):
                break
            elif len(line.text) > MAX_LINE:
                self._error("P110", f"a card of {len(line.text)} characters is too long", line.span)
            else:
                lines.append(line)
        return lines

    def logical(self, name: str, text: str) -> Iterator[LogicalLine]:
        """Logical lines of one text, INCLUDE and END among them."""
        start, pending = 0, ""
        for number, raw in enumerate(text.split("\n"), 1):
            code = without_comment(raw)
            if not code or code.isspace():
                # blank and comment lines are allowed within a continued card; columns need the line end
                pending += "\n" if pending else ""
                continue
            start = start if pending else number
            code = code.rstrip()
            if code.endswith("&"):
                pending += code[:-1] + "\n"
                continue
            yield LogicalLine(name, start, pending + code)
            pending = ""
        if pending:
            last = LogicalLine(name, start, pending.rstrip())
            self._error("P109", "the line ends in & but nothing follows it", last.span)
            yield last

    def _include(self, line: LogicalLine, rest: str, path: tuple[str, ...]) -> list[LogicalLine]:
        match = _FILE_NAME.fullmatch(rest)
        if not match:
            self._error("P108", "INCLUDE takes one file name", line.span, 'write INCLUDE "file name"')
            return []
        name = os.path.join(os.path.dirname(line.file), match[1].strip("\"'"))
        real = os.path.realpath(name)
        self._includes += 1
        if real in path:
            self._error("P106", f"{name} includes itself", line.span, "take this INCLUDE out")
        elif len(path) > MAX_DEPTH or self._includes > MAX_INCLUDES:
            limits = f"more than {MAX_DEPTH} files deep or {MAX_INCLUDES} times"
            self._error("P107", f"INCLUDE stands {limits}", line.span, "join some of the files")
        else:
            try:
                return self.lines(name, self._load(name, line.span), (*path, real))
            except (OSError, ValueError) as error:
                reason = getattr(error, "strerror", None) or str(error)
                where = "the name counts from the folder of this file"
                self._error("P105", f"cannot read {name}: {reason}", line.span, where)
        return []

    def _load(self, name: str, here: Span) -> str:
        text = self.unsaved.get(os.path.realpath(name)) if self.unsaved else None
        if text is not None:
            return self.decode(name, text.encode("utf-8", "surrogatepass"), here)
        with opened(name) as stream:
            # one byte more than allowed: distinguishes a deck that is too large from one that just fits
            return self.decode(name, stream.read(MAX_BYTES - self._bytes + 1), here)

    def decode(self, name: str, data: bytes, here: Span) -> str:
        """Text of a file; empty, with a diagnostic at `here`, where it cannot be a deck."""
        self._bytes += len(data)
        if self._bytes > MAX_BYTES:
            hint = "put records into files of their own and name them under EQUAKE with FILE="
            self._error("P104", f"{name}: a deck holds at most {MAX_BYTES // 1_000_000} MB", here, hint)
            return ""
        if b"\0" in data:
            self._error(
                "P102", f"{name} is not a text file: it holds zero bytes", here, "save it as UTF-8 text"
            )
            return ""
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            text = data.decode("latin-1")
            before = data[: error.start].replace(b"\r\n", b"\n").replace(b"\r", b"\n").decode("latin-1")
            column = len(before) - before.rfind("\n")
            place = Span(name, before.count("\n") + 1, column, column + 1)
            message = f"{name} is not UTF-8; read as Latin-1"
            self.report.append(Diagnostic("P101", message, place, "save it as UTF-8", "warning"))
        if _PAGE.match(text[:1000]):
            hint = "download the raw file instead of the page that shows it"
            self._error("P103", f"{name} looks like an HTML page, not a deck", here, hint)
            return ""
        return text.replace("\r\n", "\n").replace("\r", "\n")

    def _error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.report.append(Diagnostic(code, message, span, hint))


def is_end(text: str) -> bool:
    """Whether a logical line is END, which ends its file."""
    return text.strip().upper() == "END"


def without_comment(raw: str) -> str:
    """Text of a line up to the exclamation mark that starts its comment."""
    if "!" not in raw:
        return raw
    mark = next((m.start() for m in _COMMENT.finditer(raw) if m[1]), len(raw))
    return raw[:mark]
