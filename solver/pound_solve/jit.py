"""The one door to numba: scalar kernels are compiled where the extra `fast` is installed,
else they run as they are.

A kernel is plain Python.  Nothing is compiled, nor numba imported, before somebody asks for it here.
The compiled code is kept between runs in the user's cache folder, in a folder of its own for every version
of the kernels' source: numba itself does not see that a function changed which another one calls.
"""

from __future__ import annotations

import dis
import hashlib
import os
import tempfile
import types
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from pound_solve.laws import EXITS, MEMORY, PARAMETERS, Rule

Function = Callable[..., Any]


SHORT = 700  #: bytes of Python's code up to which a function is put into its callers
LOOSE = {"contract", "reassoc"}  #: what compiled code may do to the rounding of kernels marked so


class Tables(NamedTuple):
    """The functions of several rules, one tuple a kind, in the order of the rules."""

    branch: tuple[Function, ...]
    leave: tuple[Function, ...]
    recoverable: tuple[Function, ...]
    curve: tuple[Function, ...]


def straight(
    p: tuple[float, ...], at: int, m: tuple[float, ...], d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Stand in for the curve of a rule that has none."""
    return 0.0, 0.0, 0.0, 0.0


def folder() -> Path:
    """Where compiled kernels are kept: the user's cache, or a temporary folder if that is read-only."""
    here = Path(__file__).parent
    sources = [
        here / "laws.py",
        here / "jit.py",
        here / "chords.py",
        *sorted(p for f in ("hysteresis", "contact", "integrate") for p in (here / f).glob("*.py")),
    ]
    key = hashlib.sha256(b"".join(p.read_bytes() for p in sources)).hexdigest()[:16]
    home = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    place = Path(home) / "pound-solve" / key
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            return place
    except OSError:
        return Path(tempfile.mkdtemp(prefix="pound-solve-"))


@cache
def numba() -> Any:
    """numba, told where to keep what it compiles; None where it is not installed or switched off.

    POUND_COMPILE=0 in the environment switches it off.
    """
    if os.environ.get("POUND_COMPILE") == "0":
        return None
    try:
        import numba as found
    except ImportError:
        return None
    setattr(found.config, "CACHE_DIR", str(folder()))  # noqa: B010
    return found


def flat(function: Function) -> Function:
    """Mark a kernel to be compiled in one piece with all that it calls: it calls them in every step."""
    function.flat = True  # type: ignore[attr-defined]
    return function


def loose(function: Function) -> Function:
    """Mark a kernel whose sums may be taken in another order, several terms at once."""
    function.loose = True  # type: ignore[attr-defined]
    return function


@contextmanager
def quiet() -> Iterator[None]:
    """Keep numba's notice to itself that functions as values are new."""
    found = numba()
    if found is None:
        yield
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", found.core.errors.NumbaExperimentalFeatureWarning)
        yield


@cache
def compiled(function: Function, signature: Any = None, inner: bool = False) -> Function:
    """Compile a kernel and, first, the functions of this program that it calls.

    Parameters
    ----------
    function : callable
        A kernel: numbers, tuples, arrays and other kernels only.
    signature : numba signature or None
        Compile for these types at once, so that the function can be handed on as a value.
    inner : bool
        Put its code into that of its callers: a call that hands on many arrays counts every one of them.

    Returns
    -------
    callable
        The function itself where there is no numba.
    """
    found = numba()
    if found is None:
        return function
    scope, flat = dict(function.__globals__), hasattr(function, "flat")
    for used in {i.argval for i in dis.get_instructions(function) if i.opname == "LOAD_GLOBAL"}:
        value = scope.get(used)
        if isinstance(value, types.FunctionType) and value.__module__.startswith("pound_solve"):
            scope[used] = compiled(value, inner=flat or len(value.__code__.co_code) < SHORT)
    twin = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
    twin.__qualname__, twin.__module__ = function.__qualname__, function.__module__
    # arrays belong to the caller of a kernel: they need not be counted, which would cost more than the work
    how = {"cache": True, "forceinline": inner, "error_model": "numpy", "_nrt": False}
    if hasattr(function, "loose"):
        how["fastmath"] = LOOSE
    with quiet():
        return found.njit(*([] if signature is None else [signature]), **how)(twin)


def tables(rules: Sequence[Rule]) -> Tables:
    """Functions of the rules, compiled to be called by number."""
    found = numba()
    if found is None:
        return Tables(
            tuple(r.branch for r in rules),
            tuple(r.leave for r in rules),
            tuple(r.recoverable for r in rules),
            tuple(r.curve or straight for r in rules),
        )
    t = found.types
    f8, i8 = t.float64, t.int64
    p, m = t.UniTuple(f8, PARAMETERS), t.UniTuple(f8, MEMORY)
    branch, leave = t.UniTuple(f8, 3 + 3 * EXITS)(p, i8, m), t.Tuple((i8, m))(p, i8, m, i8, f8)
    recoverable, curve = f8(p, i8, m, f8, f8), t.UniTuple(f8, 4)(p, i8, m, f8, f8, f8)
    return Tables(
        tuple(compiled(r.branch, branch) for r in rules),
        tuple(compiled(r.leave, leave) for r in rules),
        tuple(compiled(r.recoverable, recoverable) for r in rules),
        tuple(compiled(r.curve or straight, curve) for r in rules),
    )
