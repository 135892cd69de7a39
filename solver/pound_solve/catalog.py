"""The Catalog of all Specs: every module of a family package that declares a SPEC is in it.

A family is imported when it is first asked for: a deck without HISTORY never sees a method.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import walk_packages
from types import MappingProxyType
from typing import Final

from pound_deck.schema import Catalog, Spec

#: Package of every family.
FAMILIES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "element": "structure.elements",
        "hysteresis": "laws.hysteresis",
        "contact": "laws.contact",
        "damper": "laws.damper",
        "damping": "structure.damping",
        "record": "loading.records",
        "motion": "loading.motions",
        "force": "loading.forces",
        "analysis": "analyses",
        "method": "integrate",
    }
)


class Families(Catalog):
    """A Catalog whose families are imported one by one, when asked for."""

    def families(self) -> tuple[str, ...]:
        """Names of the families."""
        return tuple(FAMILIES)

    def family(self, name: str) -> Mapping[str, Spec]:
        """Specs of a family by name (empty when there are none)."""
        return members(name).family(name) if name in FAMILIES else {}


@cache
def members(family: str) -> Catalog:
    """Import a family: its Specs, in the order of file names."""
    package = import_module(f"pound_solve.{FAMILIES[family]}")
    names = [m.name for m in walk_packages(package.__path__, f"{package.__name__}.") if not m.ispkg]
    modules = (import_module(name) for name in sorted(names, key=lambda name: name.rpartition(".")[2]))
    return Catalog(module.SPEC for module in modules if hasattr(module, "SPEC"))


def catalog() -> Catalog:
    """Return the vocabulary that a deck may use."""
    return Families(())


def specs() -> tuple[Spec, ...]:
    """Return the Specs of all families, in the order of `FAMILIES` and of file names."""
    return tuple(spec for family in FAMILIES for spec in members(family).family(family).values())
