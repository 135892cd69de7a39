"""The cache of compiled kernels between runs: one folder for each version of their source.

The folder is in POUND_CACHE if the environment sets it, otherwise in the user's cache folder, or in a
folder of the user within the temporary folder.  Compiled code from the cache is executed, so the last two
must belong to the user and be inaccessible to others.  A user who sets POUND_CACHE is responsible for that
folder.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

from pound_solve.numerics.digest import digest

NAME, VARIABLE = "pound-solve", "POUND_CACHE"
CURE = f"set {VARIABLE} to a folder that you may write to"
NOT_KEPT = f"compiled kernels cannot be kept, every run compiles for a minute or two: {CURE}"
ELSEWHERE = f"compiled kernels cannot be kept in {VARIABLE}={{}}, but in {{}}"
MAX_AGE = 30 * 86400.0  #: age at which an unused version is deleted [s]
OF_A_VERSION = re.compile("[0-9a-f]{16}(-old-.*)?")  #: folder names of versions, also during deletion


class CacheFolder(NamedTuple):
    """Folder of the compiled kernels (None if there is none), and a message about it for the user."""

    folder: Path | None
    notice: str = ""


@cache
def cache_folder() -> CacheFolder:
    """Create the folder of this version and return it; delete folders of versions that are no
    longer used.
    """
    asked = os.environ.get(VARIABLE)
    for root in roots(asked):
        folder = root / digest()
        try:
            claim(root, trusted=str(root) == asked)
            claim(folder, trusted=str(root) == asked)
        except OSError:
            continue
        prune(root)
        return CacheFolder(folder, ELSEWHERE.format(asked, root) if asked and str(root) != asked else "")
    return CacheFolder(None, NOT_KEPT)


def roots(asked: str | None) -> Iterator[Path]:
    """Yield folders that may contain the folders of the versions, best first."""
    if asked:
        yield Path(asked)
    with suppress(RuntimeError):  # no home folder
        yield user_cache()
    with suppress(OSError):  # no temporary folder
        temporary = tempfile.gettempdir()
        yield Path(temporary, f"{NAME}-{os.getuid()}" if hasattr(os, "getuid") else NAME)


def user_cache() -> Path:
    """Return the program's folder in the user's cache, according to the platform's rules.

    Raises
    ------
    RuntimeError
        The user has no home folder.
    """
    try:
        from platformdirs import user_cache_path
    except ImportError:  # numba was installed without the extra `fast`
        return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / NAME
    folder = user_cache_path(NAME, appauthor=False)
    if not folder.is_absolute():
        raise RuntimeError("the user has no home")
    return folder


def claim(folder: Path, trusted: bool = False) -> None:
    """Create a folder that is inaccessible to others, and mark it as used.

    Parameters
    ----------
    folder : Path
    trusted : bool
        Whether the folder may belong to another user and be writable by others.

    Raises
    ------
    OSError
        The folder cannot be created or written, or belongs to another user.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not trusted and hasattr(os, "getuid"):
        if {folder.lstat().st_uid, folder.stat().st_uid} != {
            os.getuid()
        }:  # the owner of a link chose its target
            raise PermissionError(f"{folder} is another user's")
        if folder.stat().st_mode & 0o022:
            folder.chmod(0o700)
    with tempfile.TemporaryFile(dir=folder):
        os.utime(folder)


def prune(root: Path) -> None:
    """Delete versions that no run has used for a long time.

    A folder is renamed first, so that only one of several concurrent processes deletes it.  A run that
    starts to use the folder at this moment creates it again.
    """
    limit = time.time() - MAX_AGE
    for old in root.iterdir():
        try:
            if not OF_A_VERSION.fullmatch(old.name) or old.is_symlink() or old.stat().st_mtime > limit:
                continue
            shutil.rmtree(old.rename(root / f"{old.name[:16]}-old-{os.getpid()}"))
        except OSError:  # another process was faster, or the folder belongs to another user
            continue
