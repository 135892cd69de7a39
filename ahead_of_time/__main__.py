"""Compile the kernels: ``python -m ahead_of_time FOLDER`` puts their library into a folder.

Where the library of this version of the source is there, it does nothing.  A library that was built before,
for another checkout of the same source, is copied from the user's cache.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import sysconfig
from importlib.metadata import version
from pathlib import Path

from ahead_of_time.library import build
from ahead_of_time.link import SUFFIX
from pound_solve.numerics import kernel_cache
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
        take(path)
    for other in set(folder.glob(f"{STEM}*")) - {path}:
        other.unlink()
    print(path)


def take(path: Path) -> None:
    """Copy the library from the user's cache to a path; build it first where the cache has none."""
    cache = kernel_cache.cache_folder().folder
    if cache is None:
        build(path)
        return
    kept = cache / f"{STEM}{builder()}{SUFFIX}"
    if not kept.exists():
        new = kept.with_name(f"{kept.name}-{os.getpid()}")
        build(new)
        new.replace(kept)  # at once: another process may build it, too
    shutil.copyfile(kept, path)


def builder() -> str:
    """Digest of what makes a library from the source of the kernels."""
    tools = [f"{name} {version(name)}" for name in ("numba", "llvmlite", "numpy")]
    sources = [own.read_bytes() for own in sorted(Path(__file__).parent.glob("*.py"))]
    made_by = [" ".join([sysconfig.get_platform(), *tools]).encode(), *sources]
    return hashlib.sha256(b"".join(made_by)).hexdigest()[:16]


if __name__ == "__main__":
    main()
