"""Table ``imports``."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from typing import Any, Final

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

LIBRARIES: Final = ("lark", "numpy", "scipy", "numba", "llvmlite", "h5py", "tabulate", "matplotlib")


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each package of this program and each library, and two for the compiled kernels."""
    packages: dict[str, list[str]] = {}
    for name in sorted(sys.modules):
        program, _, rest = name.partition(".")
        if program in ("pound_solve", "pound_deck") and rest:
            package, _, module = rest.rpartition(".")
            packages.setdefault(f"{program}.{package}".rstrip("."), []).append(module)
    for package, modules in packages.items():  # a package is a module too, which its parent's list names
        yield package, len(modules), ", ".join(modules)
    loaded = [name.partition(".")[0] for name in sys.modules]
    for library in LIBRARIES:
        yield library, loaded.count(library), "" if library in loaded else "not imported"
    compiled, kept = kernels()
    yield "kernels compiled", compiled, "" if compiled else "none"
    yield "kernels from the cache", kept, "" if kept else "none"


def kernels() -> tuple[int, int]:
    """Number of kernels that numba compiled in this process, and of those it loaded from its cache."""
    if "numba" not in sys.modules:
        return 0, 0
    statistics = list(_statistics())
    return (
        sum(sum(s.cache_misses.values()) for s in statistics),
        sum(sum(s.cache_hits.values()) for s in statistics),
    )


def _statistics() -> Iterator[Any]:
    """Statistics that numba keeps of every kernel of this program that is loaded."""
    dispatcher = sys.modules["numba.core.dispatcher"].Dispatcher
    for x in gc.get_objects():
        if isinstance(x, dispatcher) and x.py_func.__module__.startswith("pound_solve"):
            yield x.stats


TABLE = Table(
    name="imports",
    title="Modules and kernels of this process",
    place=20,
    stages=(Stage.EXPLAIN,),
    columns=(
        Column("part", doc="package of the program, or library"),
        Column("modules", fmt="int", doc="number of imported modules, or of kernels"),
        Column("which", doc="names of the program's own modules"),
    ),
    rows=rows,
)
