"""Vectors in space, and the local axes of frames and links."""

from __future__ import annotations

from math import cos, hypot, radians, sin
from typing import Final

Vector = tuple[float, float, float]

UP: Final[Vector] = (0.0, 0.0, 1.0)
_VERTICAL: Final = 1e-3  #: largest sine of the angle between an axis and Z for the axis to be vertical


def scaled(a: Vector, factor: float) -> Vector:
    """Product of a vector and a number."""
    return a[0] * factor, a[1] * factor, a[2] * factor


def sum_of(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def difference(a: Vector, b: Vector) -> Vector:
    """The first less the second."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def length(a: Vector) -> float:
    """Magnitude of a vector."""
    return hypot(*a)


def local_axes(along: Vector, angle: float) -> tuple[Vector, Vector, Vector]:
    """Local axes 1, 2, 3.

    Parameters
    ----------
    along : tuple of float, shape (3,)
        From the first joint to the second; zero: upwards.
    angle : float
        Rotation of axes 2 and 3 about axis 1 [deg].

    Returns
    -------
    tuple of tuple of float, shape (3, 3)
        Unit vectors.  At the angle 0 the plane of axes 1 and 2 is vertical, with axis 2 upwards; where
        axis 1 is vertical, axis 2 is X.
    """
    size = length(along)
    one = scaled(along, 1.0 / size) if size else UP
    horizontal = cross(UP, one)
    if length(horizontal) <= _VERTICAL:
        three = cross(one, (1.0, 0.0, 0.0))
    else:
        three = cross(one, UP)
    three = scaled(three, 1.0 / length(three))
    two = cross(three, one)
    c, s = cos(radians(angle)), sin(radians(angle))
    return (one, sum_of(scaled(two, c), scaled(three, s)), sum_of(scaled(three, c), scaled(two, -s)))
