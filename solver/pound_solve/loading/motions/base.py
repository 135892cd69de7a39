"""Common parts of all ground motions: items of the card, context, and the GroundMotion made from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from pound_deck.schema import Field, Kind
from pound_solve.loading.piecewise import Piecewise, merged
from pound_solve.loading.records.base import RecordError
from pound_solve.numerics.types import Array

__all__ = (
    "COMMON",
    "METRE",
    "GroundMotion",
    "LoadingContext",
    "Piecewise",
    "RecordError",
    "common_breaks",
    "finish",
)

COMMON: Final = (
    Field(
        "DIRECTION",
        Kind.WORD,
        default="X",
        words=("X", "Y", "R"),
        doc="direction of the ground motion; R rotates the ground about the point ABOUT",
    ),
    Field("SCALE", Kind.REAL, "-", default=1.0, doc="factor on the acceleration; negative: reversed"),
    Field("SUPPORTS", Kind.NODES, default=None, doc="nodes moved by this motion; omitted: the whole base"),
    Field(
        "WAVE",
        Kind.REAL,
        "L/T",
        default=None,
        doc="speed of the motion along x from one of SUPPORTS to the next, negative towards -x; omitted: "
        "all move at once",
    ),
    Field(
        "ABOUT",
        Kind.REAL,
        "L",
        default=(0.0, 0.0),
        count=(2, 2),
        doc="x,y of the fixed point about which DIRECTION=R rotates the ground",
    ),
)

#: length of one metre in a deck's units of length
METRE: Final[Mapping[str, float]] = MappingProxyType(
    {"m": 1.0, "cm": 100.0, "mm": 1000.0, "ft": 1.0 / 0.3048, "in": 1.0 / 0.0254}
)

Closed = tuple[Callable[[], Piecewise], Callable[[], Piecewise]]
_STRONG, _WEAK = 3.0, 0.001  # [g]
_RARE: Final = 2.0  #: [g], hardly exceeded by any record of an earthquake
_USUAL: Final = 0.3  # [g], typical of damaging motions
_PER_METRE: Final = {"M/S2": 1.0, "CM/S2": 100.0, "GAL": 100.0, "MM/S2": 1000.0}


@dataclass(frozen=True, slots=True)
class LoadingContext:
    """Input of a motion.

    Attributes
    ----------
    gravity : float, [L/T^2]
        Acceleration of gravity in the deck's units.
    metre : float, [L]
        Length of one metre in the deck's units, see `METRE`.
    search_path : tuple of Path
        Folders searched for records.
    duration : float, [T]
        Length of the analysis; 0 when it is not known.
    """

    gravity: float
    metre: float = 1.0
    search_path: tuple[Path, ...] = ()
    duration: float = 0.0

    def per_unit(self, unit: str) -> float:
        """Acceleration [L/T^2] of one ``G``, ``M/S2``, ``CM/S2``, ``GAL``, ``MM/S2`` or ``DECK``."""
        if unit == "DECK":
            return 1.0
        return self.gravity if unit == "G" else self.metre / _PER_METRE[unit]


@dataclass(frozen=True, slots=True, eq=False)
class GroundMotion:
    """The motion of the ground, or of some supports, in one direction.

    Attributes
    ----------
    direction : str
        ``X``, ``Y``, or ``R``: a small rotation about the point `about`, radians in place of lengths.
    supports : tuple of int, or None
        Nodes that it moves; None for the whole base.
    acceleration : Piecewise, [L/T^2]
        Begins at t = 0; zero after its last break.
    velocity0, displacement0 : float, [L/T], [L]
        Of the ground at t = 0.
    info : mapping
        For the report: ``kind name file format component npts dt unit scale start duration pga t_pga
        pgv pgd sha256 warnings notes`` and items specific to the kind; `warnings` concern the size of
        the motion, `notes` contradictions of a file and its header, `cuts` the part of the record that
        acts and its step: text, item of the card, remedy.
    closed : pair of callables, or None
        Make velocity and displacement, where the kind has a closed form; they are not kept, because few
        decks request them.
    about : tuple of two floats, [L]
    wave : float or None, [L/T]
        Apparent speed of a travelling wave; see `wave`.
    """

    direction: str
    supports: tuple[int, ...] | None
    acceleration: Piecewise
    velocity0: float = 0.0
    displacement0: float = 0.0
    info: Mapping[str, Any] = field(default_factory=dict)
    closed: Closed | None = None
    about: tuple[float, float] = (0.0, 0.0)
    wave: float | None = None

    @property
    def name(self) -> str:
        """Name and component of the record, or the kind of the motion."""
        words = [str(self.info[key]) for key in ("name", "component") if self.info.get(key)]
        return " ".join(words) or str(self.info.get("kind") or "")

    @property
    def directions(self) -> tuple[int, ...]:
        """Directions in which the motion may move a support: 0 x, 1 y, 2 rotation."""
        return (0, 1, 2) if self.direction == "R" else ("XY".index(self.direction),)

    def share(self, d: int, x: float, y: float) -> float:
        """Displacement of the ground at (x, y) in direction `d` (0 x, 1 y, 2 rotation) per unit of it."""
        if self.direction != "R":
            return float(d in self.directions)
        return (self.about[1] - y, x - self.about[0], 1.0)[d]

    def delayed(self, by: float) -> GroundMotion:
        """The same motion, later by `by` [T]; before it the ground moves with its velocity at t = 0."""
        lead = self.displacement0 - by * self.velocity0
        closed = self.closed
        if closed:
            v, d = closed
            closed = (
                lambda: v().delayed(by, (self.velocity0,)),
                lambda: d().delayed(by, (lead, self.velocity0)),
            )
        info = dict(self.info)
        if by:
            info["name"] = f"{info['name']}, {by:.6g} later"
            info["t_pga"] += by
        return replace(
            self, acceleration=self.acceleration.delayed(by), displacement0=lead, closed=closed, info=info
        )

    def velocity(self, t_end: float = 0.0) -> Piecewise:
        """Ground velocity [L/T] up to `t_end` at least, constant where the acceleration has ended."""
        if self.closed:
            v = self.closed[0]()
            return v.extended(t_end, (v.value(v.end),))
        return self.acceleration.extended(t_end).integral(self.velocity0)

    def displacement(self, t_end: float = 0.0) -> Piecewise:
        """Ground displacement [L] up to `t_end` at least."""
        if self.closed:
            d = self.closed[1]()
            return (
                d if t_end <= d.end else d.extended(t_end, (d.value(d.end), self.closed[0]().value(d.end)))
            )
        return self.velocity(t_end).integral(self.displacement0)


def finish(
    card: Mapping[str, Any],
    acceleration: Piecewise,
    context: LoadingContext,
    info: Mapping[str, Any],
    velocity0: float = 0.0,
    displacement0: float = 0.0,
    closed: Closed | None = None,
    weakest: float | None = None,
) -> GroundMotion:
    """Motion with the common items of its card, its peaks and the warnings about them.

    Parameters
    ----------
    card : mapping
        Values of the card by field name.
    acceleration : Piecewise, [L/T^2]
        SCALE included.
    context : LoadingContext
    info : mapping
        The kind's part of `GroundMotion.info`.
    velocity0, displacement0 : float, [L/T], [L]
    closed : pair of callables, optional
        See `GroundMotion`.
    weakest : float, optional
        Fraction of gravity below which the peak causes a warning.

    Raises
    ------
    RecordError
        R405 for a WAVE that contradicts the other items.
    """
    scale = float(card.get("SCALE", 1.0))
    bare = GroundMotion(
        card.get("DIRECTION", "X"),
        card.get("SUPPORTS"),
        acceleration,
        velocity0,
        displacement0,
        {},
        closed,
        card.get("ABOUT", (0.0, 0.0)),
        card.get("WAVE"),
    )
    _check_wave(bare)
    t_pga, pga = acceleration.peak()
    warnings = list(info.get("warnings", ()))
    strength = abs(pga) / context.gravity
    # a factor of zero switches a motion off; a rotation cannot be compared with gravity
    unit = str(info.get("unit") or "")  # of a record alone
    if (
        scale != 0
        and bare.direction != "R"
        and not (_WEAK if weakest is None else weakest) <= strength <= (_RARE if unit else _STRONG)
    ):
        finding = f"peak ground acceleration is {strength:.3g} g"
        if info.get("file"):
            warnings.append(f"{finding}; {_likely_unit(strength, unit, context)}check UNIT and SCALE")
        else:
            warnings.append(f"{finding}, with GRAVITY {context.gravity:g}: check both")
    peaks = {
        "scale": scale,
        "duration": acceleration.end,
        "pga": abs(pga),
        "t_pga": t_pga,
        "pgv": abs(bare.velocity().peak()[1]),
        "pgd": abs(bare.displacement().peak()[1]),
    }
    return replace(bare, info={**_BLANK, **peaks, **info, "warnings": tuple(warnings)})


def _likely_unit(strength: float, unit: str, context: LoadingContext) -> str:
    """The unit that would make a peak [g] out of bounds usual, as words for the warning, or nothing."""
    if not unit:
        return ""
    peaks = {
        other: strength * context.per_unit(other) / context.per_unit(unit)
        for other in ("G", "M/S2", "CM/S2", "MM/S2")
    }
    if not min(peaks.values()) > 0.0:  # a factor below the least number
        return ""
    other, peak = min(peaks.items(), key=lambda item: abs(math.log(item[1] / _USUAL)))
    return f"it would be {peak:.3g} g if the samples were in {other}: " if _WEAK <= peak <= _STRONG else ""


def _check_wave(motion: GroundMotion) -> None:
    """Raise RecordError if a travelling wave lacks a speed, supports or a direction."""
    if motion.wave is None:
        return
    if motion.wave == 0.0:
        raise RecordError("R405", "a wave of speed 0 arrives nowhere", "leave WAVE out", "WAVE")
    if motion.supports is None:
        raise RecordError(
            "R405", "WAVE needs SUPPORTS that it reaches one after the other", "add SUPPORTS=", "WAVE"
        )
    if motion.direction == "R":
        raise RecordError("R405", "WAVE goes with DIRECTION=X or Y", "leave WAVE out", "WAVE")


_BLANK: Final[Mapping[str, Any]] = MappingProxyType(
    dict.fromkeys(("kind", "name", "file", "format", "component", "npts", "dt", "unit", "start", "sha256"))
)


def common_breaks(histories: Iterable[Piecewise], t_end: float) -> Array:
    """Times from 0 to `t_end` between which every history is one polynomial.

    Parameters
    ----------
    histories : iterable of Piecewise
    t_end : float, [T]

    Returns
    -------
    ndarray, shape (n,), [T]
        Begins with 0 and ends with `t_end`; no two are closer than 1e-12 of `t_end`.
    """
    breaks = [h.breaks for h in histories]
    inside = np.concatenate([np.array([0.0, t_end]), *breaks])
    return merged(inside[(inside >= 0) & (inside <= t_end)], 1e-12 * t_end)
