"""EXPLAIN: what a run imported, compiled and held, to show that every kind of deck pays for itself only."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from typing import Any, Final

from pound_solve.numerics.matrices import Matrix
from pound_solve.results.file import Layout
from pound_solve.structure.assembly import Structure
from pound_solve.structure.reduction import ReducedSystem

LIBRARIES: Final = ("lark", "numpy", "scipy", "numba", "llvmlite", "h5py", "tabulate", "matplotlib")
Row = tuple[str, str, int, int]


def kind(structure: Structure, analyses: set[str]) -> str:
    """What kind of problem a deck poses, by its analyses and the laws of its springs and contacts."""
    laws = structure.laws
    curved = bool(structure.corotational) or any(s.law.curved for s in laws)
    shape = "general" if curved else "piecewise linear" if laws else "linear"
    for name, text in (("HISTORY", "history"), ("PUSHOVER", "pushover"), ("STATIC", "static")):
        if name in analyses:
            return f"{shape} {text}"
    return "modal" if "MODAL" in analyses else "no analysis"


def arrays(structure: Structure, system: ReducedSystem | None, layout: Layout) -> list[Row]:
    """Arrays that outlive an analysis: part, what it holds, numbers and bytes.

    Parameters
    ----------
    structure : Structure
    system : ReducedSystem or None
        Of the history, if there is one.
    layout : mapping
        Its stored histories, see `results.Writer.start_history`.
    """
    contact = [i for i, s in enumerate(structure.laws) if s.role.collides]
    spring = [i for i, s in enumerate(structure.laws) if not s.role.collides]
    s = structure
    out = [
        ("structure", "stiffness, mass, damping", *size(s.stiffness, s.mass, s.damping)),
        ("springs and hinges", f"deformations of {len(spring)}", *size(s.law_rows[spring])),
        ("contacts", f"closures of {len(contact)}", *size(s.law_rows[contact])),
        (
            "members that move",
            f"chords of {len(s.corotational)}",
            *size(s.corotational.p, s.corotational.rows),
        ),
    ]
    if system is None:
        return out
    x = system
    back = size(x.expand, x.expand_constant, x.expand_inputs)
    out += [
        (
            "history",
            f"mass, damping, stiffness of {x.size} unknowns",
            *size(x.mass, x.damping, x.stiffness),
        ),
        ("history", "forces and deformations by the inputs", *size(x.inputs, x.law_inputs, x.law_rows)),
        ("history", f"way back to {structure.n_free} degrees of freedom", *back),
        ("ground motion", "polynomials in time", *size(x.excitation.breaks, x.excitation.coefs)),
    ]
    for name, (shape, _) in layout.items():
        count = 1
        for n in shape:
            count *= n
        if count:
            out.append(("stored at an instant", name, count, 8 * count))
    return out


def size(*matrices: Matrix) -> tuple[int, int]:
    """Numbers stored in some plain or sparse matrices, and bytes with the indices."""
    numbers = held = 0
    for a in matrices:
        parts = [a.data, a.indices, a.indptr] if hasattr(a, "indptr") else [a]
        numbers += int(parts[0].size)
        held += sum(int(p.nbytes) for p in parts)
    return numbers, held


def imports() -> list[tuple[str, int, str]]:
    """Modules of this program, by package, and of libraries that this process has imported by now."""
    own: dict[str, list[str]] = {}
    for name in sorted(sys.modules):
        program, _, rest = name.partition(".")
        if program in ("pound_solve", "pound_deck") and rest:
            package, _, module = rest.rpartition(".")
            own.setdefault(f"{program}.{package}".rstrip("."), []).append(module)
    # a package is a module too, which its parent's list names
    out = [(package, len(modules), ", ".join(modules)) for package, modules in own.items()]
    loaded = [name.partition(".")[0] for name in sys.modules]
    out += [(x, loaded.count(x), "" if x in loaded else "not imported") for x in LIBRARIES]
    compiled, kept = kernels()
    out.append(("kernels compiled", compiled, "" if compiled else "none"))
    out.append(("kernels from the cache", kept, "" if kept else "none"))
    return out


def kernels() -> tuple[int, int]:
    """Kernels of this program that numba compiled in this process, and those it took from its cache."""
    if "numba" not in sys.modules:
        return 0, 0
    found = list(_statistics())
    return (
        sum(sum(s.cache_misses.values()) for s in found),
        sum(sum(s.cache_hits.values()) for s in found),
    )


def _statistics() -> Iterator[Any]:
    """Statistics of every kernel's dispatcher: nothing is counted while a run needs its time."""
    dispatcher = sys.modules["numba.core.dispatcher"].Dispatcher
    for x in gc.get_objects():
        if isinstance(x, dispatcher) and x.py_func.__module__.startswith("pound_solve"):
            yield x.stats
