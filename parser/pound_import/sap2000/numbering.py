"""Numbers of the new deck: of nodes and elements by their names, and computed values."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from pound_import.draft import number

_MOST: Final = 6  #: digits of a name that is kept as a number
_DIGITS: Final = 13  #: significant digits of computed values: the last ones of a float are rounding


def numbered(names: Iterable[str], used: Iterable[int] = ()) -> dict[str, int]:
    """Numbers by name: a name that is a number stays, others get free ones.

    Parameters
    ----------
    names : iterable of str
        Each once.
    used : iterable of int
        Numbers that are not free.
    """
    names, taken = list(names), set(used)
    out = {name: int(name) for name in names if _is_number(name) and int(name) not in taken}
    following = max((*taken, *out.values()), default=0)
    for name in names:
        if name not in out:
            following += 1
            out[name] = following
    return {name: out[name] for name in names}


def computed(value: float) -> str:
    """Computed value as a deck writes it, without the digits that come from rounding."""
    return number(float(f"{value:.{_DIGITS}g}"))


def _is_number(name: str) -> bool:
    plain = name.isascii() and name.isdigit() and len(name) <= _MOST
    return plain and name[0] != "0"
