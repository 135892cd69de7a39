"""Compilation by numba: scalar kernels are compiled if the extra `fast` is installed, and otherwise run as
Python.

A kernel is plain Python.  Nothing is compiled, and numba is not imported, before the first request to this
module.  The compiled code is kept between runs (`kernel_cache`), in a separate folder for each version of
the kernels' source: numba itself does not notice a change in a function that another one calls.
"""

from __future__ import annotations

import dis
import itertools
import types
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from pound_solve.numerics import kernel_cache
from pound_solve.numerics.block import Block
from pound_solve.numerics.types import Array

Function = Callable[..., Any]


COMPILING = "compiling the kernels, once for this version: a minute or two"
FASTMATH = {"contract", "reassoc"}  #: reorderings that `reorder_sums` allows


@cache
def numba() -> Any:
    """Return numba with the cache folder set, or None if it cannot be imported."""
    try:
        import numba as found
    except ImportError:
        return None
    setattr(found.config, "CACHE_DIR", str(kernel_cache.cache_folder().folder or ""))  # noqa: B010
    lighten(found)
    return found


INNER = "_inner"  #: suffix of the names of kernels that only other kernels call


@cache
def lighten(module: Any) -> None:
    """Prevent numba from optimising and emitting code of inner kernels, from the first call on.

    Numba would optimise each of them together with its callees, and again in every kernel that calls it.
    Instead, their unoptimised code is linked into the outermost kernel, and only that kernel is optimised
    and emitted.
    """
    library, engine = module.core.codegen.JITCodeLibrary, module.core.codegen.JITCPUCodegen
    optimise, emit = library._optimize_final_module, library._finalize_final_module
    set_environment = engine.set_env

    def is_inner(code: Any) -> bool:
        return bool(code.name.endswith(INNER))

    def optimise_outermost(code: Any) -> None:
        if not is_inner(code):
            optimise(code)

    def emit_outermost(code: Any) -> None:
        if is_inner(code):
            code._finalized = True
        else:
            emit(code)

    def set_if_emitted(self: Any, name: str, environment: Any) -> None:
        if self._engine.is_symbol_defined(name):
            set_environment(self, name, environment)

    library._optimize_final_module, library._finalize_final_module = optimise_outermost, emit_outermost
    engine.set_env = set_if_emitted


def subscripts(function: Function) -> set[str]:
    """Return the names of global variables that are indexed in a function."""
    code = itertools.pairwise(dis.get_instructions(function))
    return {
        load.argval
        for load, then in code
        if load.opname == "LOAD_GLOBAL" and (then.opname == "BINARY_SUBSCR" or then.argrepr == "[]")
    }


def reorder_sums(function: Function) -> Function:
    """Mark a kernel in which numba may reorder sums, to add several terms at once."""
    vars(function)["reorder_sums"] = True
    return function


@contextmanager
def compiling() -> Iterator[None]:
    """Set up numba for calls in which a kernel may be compiled, as a context manager."""
    module = numba()
    if module is None:
        yield
        return
    config = module.config
    before = config.OPT
    # loops over rows of a sparse matrix have one or two iterations; higher levels unroll them: slower
    config.OPT = type(before)(1)
    try:
        with warnings.catch_warnings():  # functions as values are experimental in numba
            warnings.simplefilter("ignore", module.core.errors.NumbaExperimentalFeatureWarning)
            yield
    finally:
        config.OPT = before


def cold(function: Function) -> bool:
    """Return whether numba has not yet compiled a kernel; each kernel is compiled in one version only."""
    folder = kernel_cache.cache_folder().folder
    return folder is None or not any(folder.rglob(f"*.{function.__name__}-*.nbc"))


@cache
def compiled(function: Function, signature: Any = None, inner: bool = False) -> Function:
    """Compile a kernel, after the functions of this program that it calls.

    Parameters
    ----------
    function : callable
        A kernel, which uses only numbers, tuples, arrays and other kernels.
    signature : numba signature, as text or not, or None
        Types to compile for immediately, so that the function can be passed as a value.
    inner : bool
        Whether only other kernels call it.

    Returns
    -------
    callable
        The function itself if numba is not available.
    """
    module = numba()
    if module is None:
        return function
    scope, indices = dict(function.__globals__), subscripts(function)
    for used in {i.argval for i in dis.get_instructions(function) if i.opname == "LOAD_GLOBAL"}:
        value = scope.get(used)
        if isinstance(value, types.FunctionType) and value.__module__.startswith("pound_solve"):
            scope[used] = compiled(value, inner=True)
        elif type(value) is int and used not in indices:  # a callee would be recompiled for every int,
            scope[used] = np.int64(value)  # but only an int can index a tuple without cost
    twin = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
    twin.__qualname__, twin.__module__ = function.__qualname__, function.__module__
    # the caller owns the arrays: reference counts are unnecessary and would cost more than the work
    kept = kernel_cache.cache_folder().folder is not None
    how = {"cache": kept, "error_model": "numpy", "_nrt": False}
    if inner:  # Python never calls it, so it needs no wrapper, but it needs a separate name in the cache
        twin.__qualname__ += INNER
        how |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "cache": False}
    if "reorder_sums" in vars(function):
        how["fastmath"] = FASTMATH
    with compiling():
        kernel: Function = module.njit(*([] if signature is None else [signature]), **how)(twin)
    return kernel


def kinds_of(arguments: Iterable[Any]) -> tuple[Any, ...]:
    """Return numba's types of a kernel's arguments; named tuples are passed by address where possible."""
    from pound_solve.numerics.addressed import addressed  # this imports numba

    typeof = numba().typeof
    return tuple(addressed(typeof(value)) for value in arguments)


class Numba:
    """Provider of kernels that numba compiles, see `providers.Provider`.

    Parameters
    ----------
    notice : str
        Message for the user before every run.
    """

    fast, loading = True, 1.0

    def __init__(self, notice: str = "") -> None:
        self._notice, self.name = notice, "compiled by numba"

    def ready(self, kernel: Function, signature: str = "") -> Function:
        """See `providers.Provider`."""
        self.name = "; ".join(filter(None, ["compiled by numba", kernel_cache.cache_folder().notice]))
        return compiled(kernel, signature) if signature else Called(compiled(kernel))

    def notice(self, kernel: Function) -> str:
        """See `providers.Provider`."""
        cache = kernel_cache.cache_folder()
        compiling = COMPILING if cache.folder and cold(kernel) else ""
        return "; ".join(filter(None, [self._notice, cache.notice, compiling]))


class Called:
    """A kernel that numba compiles at the first call.

    Parameters
    ----------
    dispatcher : object of numba
    """

    def __init__(self, dispatcher: Any) -> None:
        self._dispatcher, self._entry = dispatcher, dispatcher
        self._given: tuple[Any, ...] = ()
        self._taken: list[Any] = []  # the same, some as addresses
        self._cells: list[Array] = []  # contents of these addresses

    def __call__(self, *arguments: Any) -> Any:
        """Call the kernel."""
        same = len(self._given) == len(arguments) and all(x is y for x, y in zip(self._given, arguments))
        if not same:  # numba's dispatch on types takes longer than many calls
            self._take(arguments)
        return self._entry(*self._taken)

    def _take(self, arguments: tuple[Any, ...]) -> None:
        """Prepare new arguments."""
        with compiling():
            kinds = kinds_of(arguments)
            self._entry = self._dispatcher.compile(kinds)
        self._given, self._taken, self._cells = arguments, [], []
        for value, kind in zip(arguments, kinds):
            if hasattr(kind, "parts"):
                self._cells.append(np.frombuffer(Block(value, {}).packed(), np.int64))
                value = self._cells[-1].ctypes.data
            self._taken.append(value)
