"""Compile the kernels: ``python -m ahead_of_time FOLDER`` puts their library into a folder."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from ahead_of_time import calls, dispatch
from ahead_of_time.link import SUFFIX, link
from ahead_of_time.machine_code import contents, door, machine_code, unoptimised
from pound_solve.numerics.digest import digest
from pound_solve.numerics.library import CONTENTS, STEM, Block


def build(folder: Path) -> Path:
    """Compile all kernels; return the path of their library."""
    numbers = dispatch.numbers()
    found = calls.observed(numbers)
    dispatch.put_in_place(dispatch.dispatchers(numbers))
    objects = {CONTENTS: machine_code(CONTENTS, contents(found, numbers))}
    for call in found:
        name = call.kernel.__name__
        module, kernel = unoptimised(call)
        n_cells = len(Block(call.arguments, numbers).cells)
        objects[name] = machine_code(name, door(module, kernel, name, n_cells), module)
    path = folder / f"{STEM}{digest()}{SUFFIX}"
    link(objects, path)
    return path


def main() -> None:
    """Read the command line and build."""
    parser = argparse.ArgumentParser(prog="python -m ahead_of_time", description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    os.environ["POUND_COMPILE"] = "0"  # the runs that are observed are of Python
    print(build(folder))


if __name__ == "__main__":
    main()
