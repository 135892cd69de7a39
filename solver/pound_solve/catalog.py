"""The Catalog of all Specs: it contains every module of a family package that declares a SPEC, whose
name is the module's in capitals.

A module is imported when its Spec is first requested: a deck without HISTORY never imports a method.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from types import MappingProxyType
from typing import Final

from pound_deck.schema import Catalog, Spec
from pound_solve.modules import modules_below

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


class Members(Mapping[str, Spec]):
    """Specs of a family, keyed by name.

    The Spec of a name is in the module of that name, which is imported on demand: a deck with one contact
    law does not load the others.

    Parameters
    ----------
    package : str
        Dotted name.
    """

    def __init__(self, package: str) -> None:
        self._modules: dict[str, list[str]] = {}
        for name in modules_below(import_module(package)):
            self._modules.setdefault(name.rpartition(".")[2].upper(), []).append(name)

    def __getitem__(self, name: str) -> Spec:
        for module in map(import_module, self._modules[name]):
            if hasattr(module, "SPEC"):
                spec: Spec = module.SPEC
                return spec
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (name for name in sorted(self._modules) if name in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)


class Families(Catalog):
    """Catalog that looks up the members of a family on demand."""

    def families(self) -> tuple[str, ...]:
        """Names of the families."""
        return tuple(FAMILIES)

    def family(self, name: str) -> Mapping[str, Spec]:
        """Specs of a family, keyed by name (empty if there are none)."""
        return members(name) if name in FAMILIES else {}


@cache
def members(family: str) -> Members:
    """Return the Specs of a family, sorted by name."""
    return Members(f"pound_solve.{FAMILIES[family]}")


def catalog() -> Catalog:
    """Return the catalog of all families: the vocabulary of decks."""
    return Families(())


def specs() -> tuple[Spec, ...]:
    """Return the Specs of all families, in the order of `FAMILIES`, then by name."""
    return tuple(spec for family in FAMILIES for spec in members(family).values())
