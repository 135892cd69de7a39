"""Family ``record``: how a strong-motion file is written.  One format a file; see :mod:`.base`."""

from __future__ import annotations

import importlib
import pkgutil

from pound_deck.schema import Spec


def formats() -> dict[str, Spec]:
    """Specs of all record formats by name, found by looking through this package."""
    modules = (importlib.import_module(f"{__name__}.{m.name}") for m in pkgutil.iter_modules(__path__))
    specs = (module.SPEC for module in modules if hasattr(module, "SPEC"))
    return {spec.name: spec for spec in specs}
