"""Output files that are whole or not there: they take their names when they are complete.

An error of the disk bears the name of the file, which that of a write that finds no room lacks.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.interruption import undisturbed

if TYPE_CHECKING:
    import h5py


def partial(path: Path) -> Path:
    """Name of an output file while it is written."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """The name under which to write a file within the block; it takes its own where the block ends.

    Raises
    ------
    OSError
        It cannot be written; what stood at its name stands as before.
    """
    own = partial(path)
    try:
        yield own
        os.replace(own, path)
    except BaseException as err:
        own.unlink(missing_ok=True)
        if isinstance(err, OSError) and err.filename in (None, str(own), own):
            err.filename = str(path)
            err.filename2 = None
        raise


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8, see `whole`."""
    with whole(path) as own:
        own.write_text(text, encoding="utf-8", newline="\n")


@contextmanager
def whole_hdf(path: Path) -> Iterator[h5py.File]:
    """A new HDF5 file, see `whole`; HDF5 itself never meets a full disk.

    Raises
    ------
    OSError, ResultsError
        It cannot be written.
    """
    import h5py  # texts are written without it

    from pound_solve.results.safe_file import SafeFile

    own = partial(path)
    disk = SafeFile(own)
    try:
        with undisturbed(), h5py.File(disk, "w", libver=("v108", "v108")) as file:
            yield file
        with undisturbed():
            disk.commit()
            disk.end()
    except BaseException:
        disk.remove()
        raise
    disk.close()
    os.replace(own, path)
