"""The library: every kernel compiled in a process of its own, and all linked."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from ahead_of_time import calls, dispatch
from ahead_of_time.calls import Call
from ahead_of_time.link import link
from ahead_of_time.machine_code import contents, door, machine_code, unoptimised
from pound_solve.numerics import jit
from pound_solve.numerics.block import Block
from pound_solve.numerics.library import CONTENTS


def prepare() -> None:
    """Put in place what a library calls, in this process."""
    dispatch.put_in_place(dispatch.dispatchers(dispatch.numbers()))


def compiled(call: Call) -> bytes:
    """The object file of one kernel."""
    name = call.kernel.__name__
    module, kernel = unoptimised(call)
    sizes = [len(Block([own], dispatch.numbers()).cells) for own in call.arguments]
    return machine_code(name, door(module, kernel, name, jit.kinds_of(call.arguments), sizes), module)


def build(path: Path) -> None:
    """Compile all kernels, each in a process, and link them to a library."""
    numbers = dispatch.numbers()
    found = calls.observed(numbers)
    objects = {CONTENTS: machine_code(CONTENTS, contents(found, numbers))}
    with ProcessPoolExecutor(mp_context=get_context("spawn"), initializer=prepare) as pool:
        objects |= {call.kernel.__name__: code for call, code in zip(found, pool.map(compiled, found))}
    link(objects, path)
