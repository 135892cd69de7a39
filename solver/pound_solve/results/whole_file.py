"""Output files that are whole or not there: they take their names when they are complete.

An error of the disk bears the name of the file, which that of a write that finds no room lacks.
"""

from __future__ import annotations

import errno
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


def make_way(path: Path) -> None:
    """See that an output file may take its name, and that its name `partial` is free, see `free`.

    Raises
    ------
    OSError
        A folder, a pipe or a device has one of the names.
    """
    if path.exists() and not path.is_file():
        raise OSError(errno.EEXIST, "a folder, a pipe or a device, not a file", str(path))
    free(partial(path))


def free(own: Path) -> None:
    """Free the name of a file that is to be written of a link, which would lead elsewhere, and of a pipe,
    which would wait for a reader.

    Raises
    ------
    OSError
        A folder has the name.
    """
    if own.is_symlink() or (own.exists() and not own.is_file()):
        own.unlink()


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """The name under which to write a file within the block; it takes its own where the block ends.

    Raises
    ------
    OSError
        It cannot be written; what stood at its name stands as before.
    """
    make_way(path)
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

    make_way(path)
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
