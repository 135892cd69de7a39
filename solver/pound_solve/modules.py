"""Modules of a package, discovered by file, so that new ones need no registration."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType


def modules_below(package: ModuleType) -> list[str]:
    """Dotted names of all modules in a package and its subfolders, sorted; none is imported."""
    names = []
    for folder in map(Path, package.__path__):
        for path in folder.rglob("[!_]*.py"):
            names.append(".".join((package.__name__, *path.relative_to(folder).with_suffix("").parts)))
    return sorted(names)
