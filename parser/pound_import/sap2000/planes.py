"""The plane of a model: the one that the user names, or the only one in which it has members."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Mistake, mistake
from pound_deck.model import Span
from pound_import.draft import number
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.tables import MOST
from pound_import.sap2000.vectors import Vector, dot

_NAMES: Final = "XYZ"
#: axes of x, of y and normal to the plane; sign of a rotation about the normal that is anticlockwise
_FAMILIES: Final = {"XZ": (0, 2, 1, -1.0), "YZ": (1, 2, 0, 1.0), "XY": (0, 1, 2, 1.0)}
_WANTED: Final = re.compile(
    r"\s*(?:(XZ|YZ|XY)\s*@?)?\s*(?:([XYZ])\s*=\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:E[+-]?\d+)?))?\s*", re.I
)
_TOLERANCE: Final = 1e-6  #: of a coordinate, relative to the size of the model
_MOST_SHOWN: Final = 12  #: planes that a refusal names
_HOW: Final = "--plane XZ, YZ or XY, with @Y=, @X= or @Z= and the coordinate where several are parallel"


@dataclass(frozen=True, slots=True)
class SapPlane:
    """A plane of the model.

    Attributes
    ----------
    family : str
        Axes of x and of y.
    level : float
        Coordinate along the normal [L].
    width : float
        Distance from the plane within which a joint lies in it [L].
    """

    family: str
    level: float
    width: float

    def __str__(self) -> str:
        return f"{self.family}@{_NAMES[self.normal]}={number(self.level)}"

    @property
    def across(self) -> int:
        """Axis of x."""
        return _FAMILIES[self.family][0]

    @property
    def up(self) -> int:
        """Axis of y."""
        return _FAMILIES[self.family][1]

    @property
    def normal(self) -> int:
        """Axis normal to the plane."""
        return _FAMILIES[self.family][2]

    @property
    def turn(self) -> float:
        """Sign of a rotation about the normal that is anticlockwise in the plane."""
        return _FAMILIES[self.family][3]

    def holds(self, at: Vector) -> bool:
        """Whether a point lies in the plane."""
        return abs(at[self.normal] - self.level) <= self.width

    def flat(self, a: Vector) -> tuple[float, float]:
        """Components of a vector, or coordinates of a point, along x and y."""
        return a[self.across], a[self.up]

    def unit_normal(self) -> Vector:
        """Unit vector of rotations that are anticlockwise in the plane."""
        x, y, z = (self.turn * (k == self.normal) for k in range(3))
        return x, y, z

    def faces(self, axis: Vector) -> bool:
        """Whether a unit vector is normal to the plane."""
        return abs(dot(axis, self.unit_normal())) > 1.0 - 1e-6


def choose(
    joints: Mapping[str, SapJoint],
    members: Sequence[tuple[SapJoint, SapJoint]],
    active: Sequence[bool],
    wanted: str,
    here: Span,
) -> SapPlane:
    """Choose the plane.

    Parameters
    ----------
    joints : mapping of str to SapJoint
        Those at the ends of members.
    members : sequence of (SapJoint, SapJoint)
        Joints of frames and links.
    active : sequence of bool, shape (6,)
    wanted : str
        The user's plane, such as ``XZ``, ``XZ@Y=3.5`` or ``Y=3.5``; empty where he names none.
    here : Span

    Raises
    ------
    Mistake
        The model is in space and no plane is named, or the plane named holds no members.
    """
    family, level = _parsed(wanted, here)
    inactive = [name for name, axes in _FAMILIES.items() if not active[axes[2]]]
    families = [family] if family else inactive if len(inactive) == 1 else list(_FAMILIES)
    width = _TOLERANCE * _size(joints)
    levels = {name: _levels(joints, name, width) for name in families}
    if level is None:
        for name in families:
            if len(levels[name]) == 1:
                return SapPlane(name, levels[name][0], width)
    shown = [name for name in families if name != "XY" or family]
    counts = {
        SapPlane(name, at, width): count
        for name in shown
        for at, count in _counts(name, levels[name], members).items()
    }
    if level is None and len(counts) == 1:
        return next(iter(counts))
    if level is None:
        raise _refusal("L647", "the model is in space: choose one of its planes", counts, here)
    for plane in counts:
        if abs(plane.level - level) <= max(width, _TOLERANCE * abs(level)):
            return plane
    raise _refusal("L648", f"no frame or link lies in the plane {wanted[:40]}", counts, here)


def _parsed(wanted: str, here: Span) -> tuple[str, float | None]:
    """Family (empty where none is wanted) and coordinate (None where none is given)."""
    match = _WANTED.fullmatch(wanted)
    family, axis, level = (match[1] or "", match[2] or "", match[3]) if match else ("", "", None)
    family, axis = family.upper(), axis.upper()
    if axis and not family:
        family = next(name for name in _FAMILIES if axis not in name)
    wrong = match is None or (axis and axis in family) or (level and abs(float(level)) > MOST)
    if wrong or (wanted.strip() and not family):
        raise mistake("L648", f"{wanted[:40]!r} is no plane", here, _HOW)
    return family, float(level) if level else None


def _size(joints: Mapping[str, SapJoint]) -> float:
    """Largest extent of the joints along an axis, or 1 where they all coincide."""
    spread = [[joint.at[k] for joint in joints.values()] for k in range(3)]
    return max((max(x) - min(x) for x in spread if x), default=0.0) or 1.0


def _levels(joints: Mapping[str, SapJoint], family: str, width: float) -> list[float]:
    """Coordinates along the normal of a family of planes at which there are joints, ascending."""
    axis = _FAMILIES[family][2]
    levels: list[float] = []
    for at in sorted(joint.at[axis] for joint in joints.values()):
        if not levels or at - levels[-1] > width:
            levels.append(at)
    return levels


def _counts(
    family: str, levels: Sequence[float], members: Sequence[tuple[SapJoint, SapJoint]]
) -> dict[float, int]:
    """Number of members in each plane of a family that has one, by the coordinate of the plane."""
    axis = _FAMILIES[family][2]
    ends = (tuple(bisect_right(levels, joint.at[axis]) for joint in pair) for pair in members)
    return {levels[i - 1]: count for (i, j), count in sorted(Counter(ends).items()) if i == j}


def _refusal(code: str, what: str, counts: Mapping[SapPlane, int], here: Span) -> Mistake:
    """Mistake that names the planes with most members."""
    most = sorted(counts, key=lambda plane: -counts[plane])
    shown = ", ".join(f"{plane} ({counts[plane]})" for plane in most[:_MOST_SHOWN])
    more = f" and {len(most) - _MOST_SHOWN} more" if len(most) > _MOST_SHOWN else ""
    return mistake(code, what, here, f"--plane with one of these (frames and links): {shown}{more}")
