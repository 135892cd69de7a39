"""Functions that open and read files of a user."""

from __future__ import annotations

import errno
import os
import stat
from typing import IO


def opened(name: str | os.PathLike[str]) -> IO[bytes]:
    """Open a file for reading.

    Raises
    ------
    OSError
        It cannot be read.  Pipes and devices are refused: they may never end, and can be read only once.
    """
    kind = os.stat(name).st_mode
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind)):
        raise OSError(errno.EINVAL, "a pipe or a device, not a file", os.fspath(name))
    return open(name, "rb")


def contents(name: str | os.PathLike[str]) -> bytes:
    """Read a whole file; raises as `opened`."""
    with opened(name) as file:
        return file.read()
