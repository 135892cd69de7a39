r"""Spring and dashpot forces that are powers of the overlap: the common part of the curved contact laws.

.. math:: f = k x^n, \qquad c\,x^{(n-1)/2}\dot x, \qquad x = \delta \ge 0
"""

from __future__ import annotations

from pound_deck.schema import Field, Kind

EXPONENT = 1  #: index of n among the parameters of a law with such a spring, after K
#: a contact counts as just touched while its spring energy is below this fraction of its kinetic scale
TOUCH = 1e-20


def stiffness_unit(n: float) -> str:
    """Return the unit of the stiffness."""
    return "F/L" if n == 1.0 else f"F/L^{n:g}"


def spring_force(k: float, n: float, x: float) -> float:
    """Return the force of the spring."""
    return k * x**n if x > 0.0 else 0.0


def spring_energy(k: float, n: float, x: float) -> float:
    """Return the energy of the spring."""
    return k / (n + 1.0) * x ** (n + 1.0) if x > 0.0 else 0.0


def drag(c: float, n: float, x: float) -> float:
    """Return the coefficient of the dashpot."""
    return c * x ** (0.5 * (n - 1.0)) if x > 0.0 else 0.0


def drag_slope(k: float, n: float, mass: float, x: float, v: float, c: float) -> float:
    """Return the derivative of the dashpot force ``c v`` with respect to the overlap `x`; `c` is the
    present coefficient.

    With n < 3 it is infinite at touch, where `x` consists of rounding error only, and an iteration that
    uses it there diverges.  While the energy of the spring is negligible compared with that of the motion,
    zero is the better derivative.
    """
    if x <= 0.0 or k * x ** (n + 1.0) <= TOUCH * mass * v * v:
        return 0.0
    return 0.5 * (n - 1.0) * c * v / x


def stiffness_field(n: float) -> Field:
    """Return the field K of a law with the exponent `n`."""
    return Field("K", Kind.REAL, stiffness_unit(n), above=0, doc="contact stiffness: force at unit overlap")


def power_fields(n: float, linear: bool = True) -> tuple[Field, Field]:
    """Return the fields K and N of a law with a free exponent, `n` by default; `linear`: N may be 1."""
    return (
        Field("K", Kind.REAL, "F/L^N", above=0, doc="contact stiffness: force at unit overlap"),
        Field(
            "N",
            Kind.REAL,
            "-",
            default=n,
            lo=1 if linear else None,
            above=None if linear else 1,
            doc="exponent of the overlap",
        ),
    )
