"""The vocabulary of the deck: the items of a card.

A :class:`Spec` describes one kind of card (a section's line, an element, a hysteresis rule, a contact law,
a record format, an analysis, ...).  Families of the solver declare their Specs beside their numerics; the
reader, the range checks, the echo in the report, the deck reference in the manual and ``pound-solve list``
are all made from them, so a new law is one new file.

Units are written in dimensions of the deck's own units: ``F`` force, ``L`` length, ``T`` time, ``-`` none;
for example ``F/L`` or ``F*T/L``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Final

#: magnitudes of a real number, the smaller one where the program may divide by it: quantities in any units
#: lie far within, and products of ten of them do not reach 1e308, where floating point ends
SMALL, GREAT = 1e-30, 1e30
OF_MAGNITUDE: Final = f"of a magnitude up to {GREAT:g}"


class Kind(Enum):
    """Kind of value that a field holds."""

    REAL = "real"  #: a finite number or an expression; or one of ``Field.words``
    INT = "int"  #: a whole number or an expression with a whole value
    WORD = "word"  #: one of ``Field.words``; its old numeric code is accepted too
    TEXT = "text"  #: a name or quoted text, free
    FLAGS = "flags"  #: letters out of ``Field.words[0]``, e.g. ``XYR``, in the order written
    NODE = "node"  #: one node number; bound as int
    NODES = "nodes"  #: node numbers: list and ranges; bound as tuple[int, ...]
    ELEMENTS = "elements"  #: element numbers: list and ranges; bound as tuple[int, ...]
    PROP = "prop"  #: the label of a property set; bound as str
    PROPS = "props"  #: labels of property sets; bound as tuple[str, ...]
    FAMILY = "family"  #: the name (or code) of a Spec of ``Field.family``; that Spec's fields join the card


class _Required:
    def __repr__(self) -> str:
        return "REQUIRED"


REQUIRED: Final = _Required()  #: marks a field that has no default


@dataclass(frozen=True, slots=True)
class Field:
    """One item of a card.

    Parameters
    ----------
    name : str
        Upper-case name as written in the deck (``NAME=value``).
    kind : Kind
        What it holds.
    unit : str
        Dimensions, see the module's head; ``"-"`` for a pure number, ``""`` where units mean nothing.
    default : object
        Value if the item is omitted; `REQUIRED` if it must be given; None if its absence has a meaning. For
        ``count`` above one the default is a tuple or None.
    doc : str
        One sentence for the manual, lower case, no full stop.
    lo, hi : float or None
        Inclusive limits of a number.
    above, below : float or None
        Exclusive limits of a number.
    count : tuple of two ints
        Least and most number of comma-separated values; ``(1, 1)`` binds a scalar, all else a tuple.
    words : tuple of str
        Choices of a WORD (its position is not its code, see `codes`), words that may replace the number of
        a REAL, or the letters of FLAGS.
    codes : mapping of str to int
        Old numeric codes of the words.
    family : str
        Family name of a FAMILY field.
    positional : bool
        The item is read by position (in the order of the Spec's fields); it may be written by name too.
    varies : bool
        In a card written with ranges this item may be a range that steps along with the card's first one.
    """

    name: str
    kind: Kind
    unit: str = ""
    default: Any = REQUIRED
    doc: str = ""
    lo: float | None = None
    hi: float | None = None
    above: float | None = None
    below: float | None = None
    count: tuple[int, int] = (1, 1)
    words: tuple[str, ...] = ()
    codes: Mapping[str, int] = field(default_factory=dict)
    family: str = ""
    positional: bool = False
    varies: bool = False


def out_of_limits(value: float, f: Field) -> str:
    """Text on a violation of the magnitude or the limits of a number for an item; empty if none."""
    return beyond(value, f) or outside(value, f)


def beyond(value: float, f: Field | None) -> str:
    """Text on a violation of the magnitude of a number, which may be NaN; empty if none."""
    nothing = 0.0 if f is None or f.above != 0 else SMALL  # least magnitude of what is divided by
    if nothing <= abs(value) <= GREAT:
        return ""
    allowed = f"of a magnitude from {SMALL:g} to {GREAT:g}" if nothing else OF_MAGNITUDE
    return f"is {value:.10g}, but must be {allowed}"


def outside(value: float, f: Field) -> str:
    """Text on how a number violates the limits of its field; empty if it does not."""
    inside = (
        (f.lo is None or value >= f.lo)
        and (f.hi is None or value <= f.hi)
        and (f.above is None or value > f.above)
        and (f.below is None or value < f.below)
    )
    return "" if inside else f"is {value:.10g}, but must be {_allowed(f)}"


def _allowed(f: Field) -> str:
    low = f"at least {f.lo:g}" if f.lo is not None else f"above {f.above:g}" if f.above is not None else ""
    high = f"at most {f.hi:g}" if f.hi is not None else f"below {f.below:g}" if f.below is not None else ""
    return " and ".join(part for part in (low, high) if part)


@dataclass(frozen=True, slots=True)
class Spec:
    """One kind of card.

    Parameters
    ----------
    family : str
        ``section``, ``element``, ``hysteresis``, ``contact``, ``damping``, ``motion``, ``force``,
        ``record``, ``analysis`` or ``method``.
    name : str
        Upper-case word in the deck.
    title : str
        A few words for headings and ``pound-solve list``.
    fields : tuple of Field
        Positional fields first, in order.
    code : int or None
        Old numeric code, accepted in place of the name.
    reference : str
        Source of the equation.
    sample : str
        Items as in a deck for a typical loop, drawn by ``pound-solve loop`` and the manual.
    impl : object
        Class or function by which the solver uses the card; the reader ignores it.
    """

    family: str
    name: str
    title: str
    fields: tuple[Field, ...] = ()
    code: int | None = None
    reference: str = ""
    sample: str = ""
    impl: Any = None

    def field(self, name: str) -> Field | None:
        """Field of that name, or None."""
        return next((f for f in self.fields if f.name == name), None)


class Catalog:
    """All Specs, by family and name.

    Parameters
    ----------
    specs : iterable of Spec
        Every Spec of every family.

    Raises
    ------
    ValueError
        Two Specs of one family share a name or a code.
    """

    def __init__(self, specs: Iterable[Spec]) -> None:
        self._families: dict[str, dict[str, Spec]] = {}
        for spec in specs:
            members = self._families.setdefault(spec.family, {})
            if spec.name in members:
                raise ValueError(f"two Specs named {spec.name} in family {spec.family}")
            if spec.code is not None and any(spec.code == s.code for s in members.values()):
                raise ValueError(f"two Specs with code {spec.code} in family {spec.family}")
            members[spec.name] = spec

    def families(self) -> tuple[str, ...]:
        """Names of the families."""
        return tuple(self._families)

    def family(self, name: str) -> Mapping[str, Spec]:
        """Specs of a family by name (empty when there are none)."""
        return self._families.get(name, {})

    def codes(self, family: str) -> Mapping[int, str]:
        """Names of a family's Specs by their old numeric codes."""
        return {s.code: s.name for s in self.family(family).values() if s.code is not None}

    def by_code(self, family: str, code: int) -> Spec | None:
        """Spec with that old numeric code, or None."""
        return next((s for s in self.family(family).values() if s.code == code), None)
