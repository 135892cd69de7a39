"""All pictures of a results file, found by searching the modules of `pictures`; there is no list."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Final

from pound_solve.modules import modules_below
from pound_solve.report.plot import pictures
from pound_solve.report.plot.schema import Picture


def _found() -> list[Picture]:
    """Objects `SPEC` of all modules, sorted by their places."""
    specs = (import_module(name).SPEC for name in modules_below(pictures))
    return sorted(specs, key=lambda spec: spec.place)


#: Every picture by its name, in the order of their places.
PICTURES: Final[Mapping[str, Picture]] = MappingProxyType({spec.name: spec for spec in _found()})
