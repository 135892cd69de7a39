"""The Catalog of all Specs: every module of a family package that declares a SPEC is in it."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from pound_deck.schema import Catalog, Spec

FAMILIES = (
    "elements",
    "hysteresis",
    "contact",
    "damping",
    "records",
    "motions",
    "forces",
    "analyses",
    "integrate",
)


@cache
def specs() -> tuple[Spec, ...]:
    """Return the Specs of all families, in the order of `FAMILIES` and of file names."""
    found = []
    for family in FAMILIES:
        package = import_module(f"pound_solve.{family}")
        for module in sorted(m.name for m in iter_modules(package.__path__)):
            spec = getattr(import_module(f"pound_solve.{family}.{module}"), "SPEC", None)
            if spec is not None:
                found.append(spec)
    return tuple(found)


def catalog() -> Catalog:
    """Return the vocabulary that a deck may use."""
    return Catalog(specs())
