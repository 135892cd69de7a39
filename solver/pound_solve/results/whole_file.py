"""Output files that are whole or not there: they take their names when they are complete.

An error of the disk bears the name of the file, which that of a write that finds no room lacks.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.interruption import undisturbed

if TYPE_CHECKING:
    import h5py


def partial(path: Path) -> Path:
    """Name of an output file while it is written."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


def make_way(path: Path, own: Path) -> None:
    """See that an output file may take its name, and that its own in the meantime is free, see `free`.

    Raises
    ------
    OSError
        A folder, a pipe or a device has one of the names.
    """
    if path.exists() and not path.is_file():
        raise OSError(errno.EEXIST, "a folder, a pipe or a device, not a file", str(path))
    free(own)


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
def whole(path: Path, own: Path | None = None) -> Iterator[Path]:
    """The name under which to write a file within the block; it takes its own where the block ends and the
    disk holds all of it.

    Parameters
    ----------
    path : Path
    own : Path, optional
        Another name than `partial` for the meantime, where several processes may write the same file.

    Raises
    ------
    OSError
        It cannot be written; what stood at its name stands as before.
    """
    own = own or partial(path)
    make_way(path, own)
    try:
        yield own
        hold(own)
        os.replace(own, path)
    except BaseException as err:
        own.unlink(missing_ok=True)
        if isinstance(err, OSError) and err.filename in (None, str(own), own):
            err.filename = str(path)
            err.filename2 = None
        raise


def hold(own: Path) -> None:
    """Have the disk hold a file; some tell only now that they have no room for it."""
    with own.open("r+b") as file:
        os.fsync(file.fileno())


def write(path: Path, data: bytes | memoryview, own: Path | None = None) -> None:
    """Write a file, see `whole`."""
    with whole(path, own) as place:
        place.write_bytes(data)


def write_text(path: Path, text: str, encoding: str = "utf-8") -> None:
    """Write a text, see `whole`; a character that the encoding lacks becomes a question mark."""
    write(path, text.encode(encoding, "replace"))


@contextmanager
def whole_hdf(path: Path) -> Iterator[h5py.File]:
    """A new HDF5 file, see `whole`.

    HDF5 does not survive a write that fails, and closing such a file ends the process: it writes into
    memory.

    Raises
    ------
    OSError
        It cannot be written.
    """
    import h5py  # texts are written without it

    memory = BytesIO()
    with undisturbed(), h5py.File(memory, "w", libver=("v108", "v108")) as file:
        yield file
    write(path, memory.getbuffer())
