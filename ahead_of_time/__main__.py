"""Compile the kernels: ``python -m ahead_of_time FOLDER`` puts a library for every level into a folder."""

from __future__ import annotations

import argparse
import os
import platform
from pathlib import Path

from ahead_of_time import calls, dispatch
from ahead_of_time.link import SUFFIX, link
from ahead_of_time.machine_code import Machine, contents, door, unoptimised
from pound_solve.numerics.digest import digest
from pound_solve.numerics.library import BASE, CONTENTS, STEM, WIDE, Block

LEVELS = (BASE, WIDE) if platform.machine().lower() in ("x86_64", "amd64") else (BASE,)


def build(folder: Path) -> list[Path]:
    """Compile all kernels; return the paths of the libraries, one for every level."""
    numbers = dispatch.numbers()
    found = calls.observed(numbers)
    dispatch.put_in_place(dispatch.dispatchers(numbers))
    kernels = {call.kernel.__name__: (call, *unoptimised(call)) for call in found}
    paths = []
    for level in LEVELS:
        machine = Machine(level)
        objects = {CONTENTS: machine.code(CONTENTS, contents(found, numbers))}
        for name, (call, module, kernel) in kernels.items():
            text = door(module, kernel, name, len(Block(call.arguments, numbers).cells))
            objects[name] = machine.code(name, text, module)
        paths.append(folder / f"{STEM}{digest()}-{level}{SUFFIX}")
        link(objects, paths[-1])
    return paths


def main() -> None:
    """Read the command line and build."""
    parser = argparse.ArgumentParser(prog="python -m ahead_of_time", description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    os.environ["POUND_COMPILE"] = "0"  # the runs that are observed are of Python
    for path in build(folder):
        print(path)


if __name__ == "__main__":
    main()
