"""Output files that are either complete or absent: they get their names when they are complete.

An error names the file, which errors of writes to a full disk do not do by themselves.
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


def make_way(path: Path, temporary: Path) -> None:
    """Check that an output file may take its name, and free its temporary name, see `free`.

    Raises
    ------
    OSError
        A folder, a pipe or a device has one of the names.
    """
    if path.exists() and not path.is_file():
        raise OSError(errno.EEXIST, "a folder, a pipe or a device, not a file", str(path))
    free(temporary)


def free(path: Path) -> None:
    """Remove what blocks the name of a file to be written: a link, which would lead elsewhere, or a pipe,
    which would wait for a reader.

    Raises
    ------
    OSError
        A folder has the name.
    """
    if path.is_symlink() or (path.exists() and not path.is_file()):
        path.unlink()


@contextmanager
def whole(path: Path, temporary: Path | None = None) -> Iterator[Path]:
    """Yield the temporary name under which to write a file; at the end of the block, when the disk holds
    all of it, the file is renamed to `path`.

    Parameters
    ----------
    path : Path
    temporary : Path, optional
        Name while it is written, `partial` by default: another where several processes may write the same
        file.

    Raises
    ------
    OSError
        It cannot be written; an existing file of that name is unchanged.
    """
    temporary = temporary or partial(path)
    make_way(path, temporary)
    try:
        yield temporary
        hold(temporary)
        os.replace(temporary, path)
    except BaseException as err:
        temporary.unlink(missing_ok=True)
        if isinstance(err, OSError) and err.filename in (None, str(temporary), temporary):
            err.filename = str(path)
            err.filename2 = None
        raise


def hold(path: Path) -> None:
    """Flush a file to the disk; some file systems report only now that there is no room for it."""
    with path.open("r+b") as file:
        os.fsync(file.fileno())


def write(path: Path, data: bytes | memoryview, temporary: Path | None = None) -> None:
    """Write a file, see `whole`."""
    with whole(path, temporary) as place:
        place.write_bytes(data)


def write_text(path: Path, text: str, encoding: str = "utf-8") -> None:
    """Write a text, see `whole`; a character that the encoding lacks becomes a question mark."""
    write(path, text.encode(encoding, "replace"))


@contextmanager
def whole_hdf(path: Path) -> Iterator[h5py.File]:
    """Yield a new HDF5 file in memory, which is written at the end of the block, see `whole`.

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
