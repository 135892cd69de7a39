"""The one way in which files of a user are read."""

from __future__ import annotations

import errno
import os
import stat
from typing import IO


def opened(name: str | os.PathLike[str]) -> IO[bytes]:
    """A file that is open to be read.

    Raises
    ------
    OSError
        It cannot be read.  Pipes and devices are no files: their end may never come, and what was read once
        is gone.
    """
    kind = os.stat(name).st_mode
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind)):
        raise OSError(errno.EINVAL, "a pipe or a device, not a file", os.fspath(name))
    return open(name, "rb")


def contents(name: str | os.PathLike[str]) -> bytes:
    """All that stands in a file; raises as `opened`."""
    with opened(name) as file:
        return file.read()
