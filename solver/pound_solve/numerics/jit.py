"""Compilation by numba: scalar kernels are compiled where the extra `fast` is installed,
else they run as Python.

A kernel is plain Python.  Nothing is compiled, nor numba imported, before the first request here.
The compiled code is kept between runs (`kernel_cache`), in a folder of its own for every version of the
kernels' source: numba itself does not notice a change in a function that another one calls.
"""

from __future__ import annotations

import dis
import itertools
import types
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from pound_solve.numerics import kernel_cache

Function = Callable[..., Any]


COMPILING = "compiling the kernels, once for this version: a minute or two"
SHORT = 700  #: bytes of bytecode up to which a function is inlined
FASTMATH = {"contract", "reassoc"}  #: reorderings of floating-point operations allowed in `loose` kernels


@cache
def numba() -> Any:
    """numba, with the cache folder set; None where it cannot be imported."""
    try:
        import numba as found
    except ImportError:
        return None
    setattr(found.config, "CACHE_DIR", str(kernel_cache.place().folder or ""))  # noqa: B010
    lighten(found)
    return found


INNER, INLINE = "_inner", "_inline"  #: ends of the names of kernels that only other kernels call


@cache
def lighten(found: Any) -> None:
    """Let numba neither optimise nor emit code of inner kernels, from the first call on.

    It would optimise each of them with all that it calls, and again in every kernel that calls it.  Their
    plain code is linked into the outermost kernel, which alone is optimised and emitted: once.
    """
    library, engine = found.core.codegen.JITCodeLibrary, found.core.codegen.JITCPUCodegen
    optimise, emit = library._optimize_final_module, library._finalize_final_module
    set_environment = engine.set_env

    def is_inner(own: Any) -> bool:
        return bool(own.name.endswith((INNER, INLINE)))

    def optimise_outermost(own: Any) -> None:
        if not is_inner(own):
            optimise(own)

    def emit_outermost(own: Any) -> None:
        if is_inner(own):
            own._finalized = True
        else:
            emit(own)

    def set_if_emitted(self: Any, name: str, environment: Any) -> None:
        if self._engine.is_symbol_defined(name):
            set_environment(self, name, environment)

    library._optimize_final_module, library._finalize_final_module = optimise_outermost, emit_outermost
    engine.set_env = set_if_emitted


def subscripts(function: Function) -> set[str]:
    """Names of globals by which a function indexes."""
    code = itertools.pairwise(dis.get_instructions(function))
    return {
        own.argval
        for own, then in code
        if own.opname == "LOAD_GLOBAL" and (then.opname == "BINARY_SUBSCR" or then.argrepr == "[]")
    }


def flat(function: Function) -> Function:
    """Mark a kernel to be compiled as one function with all that it calls in every step."""
    vars(function)["flat"] = True
    return function


def loose(function: Function) -> Function:
    """Mark a kernel whose sums may be taken in another order, several terms at once."""
    vars(function)["loose"] = True
    return function


@contextmanager
def compiling() -> Iterator[None]:
    """Settings of numba while a kernel is called that may have to be compiled."""
    found = numba()
    if found is None:
        yield
        return
    config = found.config
    before = config.OPT
    # rows of a sparse matrix are loops of one or two turns: unrolled, as higher levels do, they run slower
    config.OPT = type(before)(1)
    try:
        with warnings.catch_warnings():  # that functions as values are new
            warnings.simplefilter("ignore", found.core.errors.NumbaExperimentalFeatureWarning)
            yield
    finally:
        config.OPT = before


def cold(function: Function) -> bool:
    """Whether numba has still to compile a kernel, which is compiled in one version only."""
    folder = kernel_cache.place().folder
    return folder is None or not any(folder.rglob(f"*.{function.__name__}-*.nbc"))


@cache
def compiled(
    function: Function, signature: Any = None, inner: bool = False, inline: bool = False
) -> Function:
    """Compile a kernel and, first, the functions of this program that it calls.

    Parameters
    ----------
    function : callable
        A kernel: numbers, tuples, arrays and other kernels only.
    signature : numba signature, as text or not, or None
        Compile for these types at once, so that the function can be handed on as a value.
    inner : bool
        Only other kernels call it.
    inline : bool
        Put its code into that of its callers: a call that hands on many arrays counts every one of them.

    Returns
    -------
    callable
        The function itself where there is no numba.
    """
    found = numba()
    if found is None:
        return function
    scope, flat = dict(function.__globals__), "flat" in vars(function)
    indices = subscripts(function)
    for used in {i.argval for i in dis.get_instructions(function) if i.opname == "LOAD_GLOBAL"}:
        value = scope.get(used)
        if isinstance(value, types.FunctionType) and value.__module__.startswith("pound_solve"):
            scope[used] = compiled(value, inner=True, inline=flat or len(value.__code__.co_code) < SHORT)
        elif type(value) is int and used not in indices:  # a callee would be compiled anew for every int,
            scope[used] = np.int64(value)  # while only by an int a tuple may be indexed at no cost
    twin = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
    twin.__qualname__, twin.__module__ = function.__qualname__, function.__module__
    # arrays belong to the caller of a kernel: they need not be counted, which would cost more than the work
    kept = kernel_cache.place().folder is not None
    how = {"cache": kept, "error_model": "numpy", "_nrt": False, "forceinline": inline}
    if inner:  # no Python calls it, so that it needs no door to it; kept by a name of its own
        twin.__qualname__ += INLINE if inline else INNER
        how |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "cache": False}
    if "loose" in vars(function):
        how["fastmath"] = FASTMATH
    with compiling():
        out: Function = found.njit(*([] if signature is None else [signature]), **how)(twin)
    return out


class Numba:
    """Kernels that numba compiles, see `providers.Provider`.

    Parameters
    ----------
    told : str
        What a user has to know before every run.
    """

    fast, loading = True, 1.0

    def __init__(self, told: str = "") -> None:
        self._told, self.name = told, "compiled by numba"

    def ready(self, kernel: Function, signature: str = "") -> Function:
        """See `providers.Provider`."""
        self.name = "; ".join(filter(None, ["compiled by numba", kernel_cache.place().told]))
        if signature:
            return compiled(kernel, signature)
        own: Any = compiled(kernel)
        given: tuple[Any, ...] = ()
        entry: Function = own

        def call(*arguments: Any) -> Any:
            nonlocal given, entry
            if len(given) != len(arguments) or any(x is not y for x, y in zip(given, arguments)):
                with compiling():  # numba takes longer to see of what types they are than many a call takes
                    entry = own.compile(tuple(own.typeof_pyval(x) for x in arguments))
                given = arguments
            return entry(*arguments)

        return call

    def notice(self, kernel: Function) -> str:
        """See `providers.Provider`."""
        place = kernel_cache.place()
        compiling = COMPILING if place.folder and cold(kernel) else ""
        return "; ".join(filter(None, [self._told, place.told, compiling]))
