"""One stress scene, and common parts of the families of scenes.

Laws are taken from the catalog with their own sample items, so a new one is covered without a change here.
Masses are weights (GRAVITY 1); the storey of unit mass has a period of 1.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from pound_deck.schema import Spec
from pound_solve.numerics.types import Array

OMEGA: Final = 2.0 * math.pi
STOREY: Final = OMEGA**2  #: stiffness of the storey of unit mass
METHOD: Final = "@METHOD"  #: placeholder of the method's name and items in a deck
STEP: Final = 1e-3
SPIKE: Final = "EQUAKE\n TABLE POINTS=0.01,0,0.010001,1E6,0.010002,0\n"
JUMP: Final = "EQUAKE\n TABLE POINTS=0.1,0,0.1,5,3,5\n"
ZEROS: Final = "EQUAKE\n TABLE POINTS=0,0,10,0\n"


def every(t: Array, u: Array) -> Array:
    """Return all displacements: the default of `StabilityCase.compared`."""
    return u


@dataclass(frozen=True)
class StabilityCase:
    """One deck of the matrix.

    Attributes
    ----------
    family : str
        ``contact``, ``hysteresis`` or ``linear``.
    scene, variant, law : str
        Row of the table; extreme feature; law.
    deck : str
        Text with `METHOD` in place of the method.
    step : float
        DT of the stepping methods [T].
    within : float
        Allowed error of these methods, as a fraction of the largest displacement.
    right : callable or None
        Displacements ux of the nodes of OUTPUT at some times, shape (n_times, n_nodes), in closed form; or
        the result of `compared` for them.
    inexact : float
        Error of the closed form, as a fraction of the largest displacement.
    compared : callable
        Quantity that is compared with the right one: of times and displacements, shape (n_times, n_nodes).
    like : tuple of str and float
        Deck whose displacements times the factor are the right ones; empty: the deck itself.
    files : mapping of str to str
        Further files of the deck.
    heavy : bool
        Whether a quick run skips the case.
    """

    family: str
    scene: str
    variant: str
    law: str
    deck: str
    step: float = STEP
    within: float = 0.02
    right: Callable[[Array], Array] | None = None
    inexact: float = 0.0
    compared: Callable[[Array, Array], Array] = every
    like: tuple[str, float] = ("", 1.0)
    files: Mapping[str, str] = field(default_factory=dict)
    heavy: bool = False


def powers(unit: str, n: float) -> tuple[float, float]:
    """Exponents of force and length in a unit such as F/L^1.5 or L/T; N in the unit is replaced by `n`.

    Raises
    ------
    ValueError
        A unit of another form.
    """
    if unit in ("", "-"):
        return 0.0, 0.0
    match = re.fullmatch(r"(F)?(?:(/?)L(?:\^([0-9.]+|N))?)?(?:/T(?:\^2)?)?", unit)
    if not match:
        raise ValueError(f"how to scale the unit {unit} is not known")
    size = (n if match[3] == "N" else float(match[3] or 1.0)) if "L" in unit else 0.0
    return float(match[1] == "F"), -size if match[2] else size


def items(spec: Spec, length: float = 1.0, force: float = 1.0, **given: float) -> str:
    """Text of a law's sample items, with K=1 if it has K, scaled to units of `length` and `force`; the
    items in `given` that the law has replace its own.
    """
    values = dict(word.split("=", 1) for word in spec.sample.split())
    if spec.field("K") is not None:
        values["K"] = "1"
    exponent = spec.field("N")
    n = float(values.get("N", exponent.default)) if exponent is not None else 1.0
    for name, value in values.items():
        item = spec.field(name)
        f, x = powers(item.unit if item is not None else "", n)
        if f or x:
            values[name] = ",".join(repr(float(v) * force**f * length**x) for v in value.split(","))
    values |= {name: repr(value) for name, value in given.items() if spec.field(name) is not None}
    return " ".join([spec.name, *(f"{name}={value}" for name, value in values.items())])


def damped(xi: float) -> str:
    """Text of a section DAMPING with a damping ratio `xi` [-] at the storey's period."""
    return f"DAMPING\n RAYLEIGH ALPHA={2.0 * xi * OMEGA!r} BETA=0\n"
