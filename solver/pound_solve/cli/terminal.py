"""What a terminal can show: its width, and colours for the words of messages."""

from __future__ import annotations

import os
import re
import sys
from textwrap import shorten
from typing import Final, TextIO

UNKNOWN: Final = 80  #: columns of a stream without a width
RED, YELLOW, GREEN, CYAN = ("\033[1;31m", "\033[1;33m", "\033[1;32m", "\033[36m")
PLAIN: Final = "\033[0m"
#: parts of messages with their colours: severity and code, the line under a place, the word before a hint
PAINTED: Final = tuple(
    (re.compile(pattern, re.MULTILINE), colour)
    for pattern, colour in (
        (r"\berror(?: [A-Z]\d+)?(?=:)", RED),
        (r"\bwarning(?: [A-Z]\d+)?(?=:)", YELLOW),
        (r"^ *\^~*$", GREEN),
        (r"^ +hint(?=:)", CYAN),
    )
)


def columns(stream: TextIO) -> int:
    """Width of a terminal in characters, ``COLUMNS`` first; `UNKNOWN` where there is none."""
    if os.environ.get("COLUMNS", "").isdecimal():
        return int(os.environ["COLUMNS"]) or UNKNOWN
    try:
        return os.get_terminal_size(stream.fileno()).columns or UNKNOWN
    except (OSError, ValueError):  # no terminal, or no file
        return UNKNOWN


def has_colours(stream: TextIO) -> bool:
    """Whether to paint: on a terminal that is not a dumb one, unless ``NO_COLOR`` is set."""
    known = os.name != "nt" or "WT_SESSION" in os.environ  # older consoles print the codes
    dumb = os.environ.get("TERM") == "dumb" or bool(os.environ.get("NO_COLOR"))
    return known and not dumb and stream.isatty()


def tell(text: str) -> None:
    """Print a message on the error stream, painted where that has colours."""
    if has_colours(sys.stderr):
        for pattern, colour in PAINTED:
            text = pattern.sub(rf"{colour}\g<0>{PLAIN}", text)
    print(text, file=sys.stderr)


def fitted(text: str, width: int) -> str:
    """Text shortened between words to a width; runs of blanks become one where it is too long."""
    return text if len(text) <= width else shorten(text, max(width, 8), placeholder="...")
