"""Machine code of kernels, which numba makes as for the present process, but for a file."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import AOTCPUCodegen
from numba.core.compiler_lock import global_compiler_lock

from ahead_of_time.calls import Call
from pound_solve.numerics import jit
from pound_solve.numerics.addressed import Addressed
from pound_solve.numerics.library import CONTENTS

WHOLE, REAL, ADDRESS = "i64", "double", "ptr"  #: LLVM's names of types of 64 bits
#: version of the mathematical functions that every glibc has, by processor
FIRST = {"x86_64": "GLIBC_2.2.5", "aarch64": "GLIBC_2.17"}
#: functions of which glibc 2.29, or 2.38, has a second version: of other errors, not of other numbers
RENEWED = ("exp", "exp2", "log", "log2", "pow", "fmod")


def unoptimised(call: Call) -> tuple[Any, str]:
    """A kernel with all that it calls, as a module of LLVM, and the name of its function there."""
    made: Any = jit.compiled(call.kernel, jit.kinds_of(call.arguments), inner=True)
    (own,) = made.overloads.values()
    return own.library._final_module, own.fndesc.mangled_name


def door(module: Any, kernel: str, name: str, kinds: Sequence[Any], sizes: Sequence[int]) -> str:
    """LLVM's text of a function that calls a kernel with the numbers of a `block.Block`.

    Parameters
    ----------
    module : module of LLVM
    kernel : str
        Name of the kernel's function in it.
    name : str
        Of the door.
    kinds : sequence of numba types
        Of the arguments.
    sizes : sequence of int
        Numbers in the block for each.

    Raises
    ------
    ValueError
        The kernel takes more numbers or fewer.
    """
    result, exception, *given = [str(x.type) for x in module.get_function(kernel).arguments]
    cells = cells_handed_on(kinds, sizes)
    if len(given) != len(cells):
        raise ValueError(f"{name} takes {len(given)} numbers, its block has {len(cells)}")
    lines = [
        f'declare i32 @"{kernel}"({", ".join([result, exception, *given])})',
        f"define i32 @{name}(ptr %cells, ptr %result) {{",
        "%exception = alloca ptr",
    ]
    arguments = ["ptr %result", "ptr %exception"]
    for (n, by_address), kind in zip(cells, given):
        lines.append(f"%place{n} = getelementptr {WHOLE}, ptr %cells, {WHOLE} {n}")
        arguments.append(f"ptr %place{n}" if by_address else f"{kind} %own{n}")
        if by_address:
            continue
        if kind in (WHOLE, REAL, ADDRESS):
            lines.append(f"%own{n} = load {kind}, ptr %place{n}")
        else:
            lines.append(f"%cell{n} = load {WHOLE}, ptr %place{n}")
            lines.append(f"%own{n} = trunc {WHOLE} %cell{n} to {kind}")
    lines.append(f'%status = call i32 @"{kernel}"({", ".join(arguments)})')
    return "\n".join([*lines, "ret i32 %status", "}"])


def cells_handed_on(kinds: Sequence[Any], sizes: Sequence[int]) -> list[tuple[int, bool]]:
    """Numbers of the cells that a door hands on, and whether by their addresses: the first of a tuple that
    is `Addressed`, else all.
    """
    found, first = list[tuple[int, bool]](), 0
    for kind, size in zip(kinds, sizes):
        by_address = isinstance(kind, Addressed)
        found += [(first, True)] if by_address else [(first + n, False) for n in range(size)]
        first += size
    return found


def contents(calls: Sequence[Call], numbers: dict[str, int]) -> str:
    """LLVM's text of the function that returns what a library holds, see `library.Library`."""
    kernels = [" ".join(["kernel", call.kernel.__name__, *call.types]) for call in calls]
    functions = [f"function {name}" for name in sorted(numbers, key=numbers.__getitem__)]
    coded = "\n".join([*kernels, *functions]).encode() + b"\0"
    letters = "".join(f"\\{byte:02x}" for byte in coded)
    text = f'@text = constant [{len(coded)} x i8] c"{letters}"'
    return f"{text}\ndefine ptr @{CONTENTS}() {{\nret ptr @text\n}}"


def first_versions() -> str:
    """LLVM's text by which code calls the first version of functions, so that old systems can load it."""
    first = FIRST.get(platform.machine(), "") if platform.libc_ver()[0] == "glibc" else ""
    return "".join(f'module asm ".symver {name}, {name}@{first}"\n' for name in RENEWED if first)


def machine_code(name: str, source: str, kernel: Any = None) -> bytes:
    """An object file with one function that is seen from outside.

    It is for any processor of the platform: for one that works on four numbers at once it is no faster, as
    most loops have few turns.

    Parameters
    ----------
    name : str
        Of the function.
    source : str
        LLVM's text of it.
    kernel : module of LLVM or None
        What it calls.
    """
    llvm.initialize_native_asmparser()  # for `first_versions`
    with jit.compiling(), global_compiler_lock:
        library = AOTCPUCodegen(name).create_library(name)
        if kernel is not None:
            library.add_llvm_module(llvm.parse_bitcode(kernel.as_bitcode()))
        library.add_llvm_module(llvm.parse_assembly(first_versions() + source))
        module = library._final_module
        for own in (*module.functions, *module.global_variables):
            if not own.is_declaration and own.name != name:
                own.linkage = "internal"
        made: bytes = library.emit_native_object()
    return made
