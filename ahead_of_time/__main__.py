"""Compile the kernels: ``python -m ahead_of_time FOLDER`` puts their library into a folder.

Where the library of this version of the source is there, it does nothing.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from ahead_of_time.library import build
from ahead_of_time.link import SUFFIX
from pound_solve.numerics.digest import digest
from pound_solve.numerics.library import STEM


def main() -> None:
    """Read the command line, build, and remove the libraries of other versions."""
    parser = argparse.ArgumentParser(prog="python -m ahead_of_time", description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    path = folder / f"{STEM}{digest()}{SUFFIX}"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        os.environ["POUND_COMPILE"] = "0"  # the runs that are observed are of Python
        build(path)
    for other in set(folder.glob(f"{STEM}*")) - {path}:
        other.unlink()
    print(path)


if __name__ == "__main__":
    main()
