"""Where compiled kernels are kept between runs: one folder for each version of their source.

The folder is in POUND_CACHE, if the environment names it, else in the user's cache folder, else in a folder
of the user in the temporary one.  Compiled code that is loaded runs: the last two must therefore belong to
the user and be closed to others.  Whoever names a folder vouches for it.
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
MAX_AGE = 30 * 86400.0  #: age from which on a version that no run has used is deleted [s]
OF_A_VERSION = re.compile("[0-9a-f]{16}(-old-.*)?")  #: names of its folder, and of one being deleted


class CacheFolder(NamedTuple):
    """Folder of the compiled kernels, None without one, and a message about it to the user."""

    folder: Path | None
    notice: str = ""


@cache
def cache_folder() -> CacheFolder:
    """Create the folder of this version and return it; folders of versions no longer used are deleted."""
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
    """Folders that may hold those of the versions, best first."""
    if asked:
        yield Path(asked)
    with suppress(RuntimeError):  # there is no home
        yield user_cache()
    with suppress(OSError):  # nor a temporary folder
        temporary = tempfile.gettempdir()
        yield Path(temporary, f"{NAME}-{os.getuid()}" if hasattr(os, "getuid") else NAME)


def user_cache() -> Path:
    """The program's folder in the user's cache, by the rules of the platform.

    Raises
    ------
    RuntimeError
        The user has no home.
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
    """Make a folder, closed to others, and mark it as used.

    Parameters
    ----------
    folder : Path
    trusted : bool
        It may be another user's, and others may write to it.

    Raises
    ------
    OSError
        It cannot be made or written, or belongs to another user.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not trusted and hasattr(os, "getuid"):
        if {folder.lstat().st_uid, folder.stat().st_uid} != {
            os.getuid()
        }:  # a link's owner chose its target
            raise PermissionError(f"{folder} is another user's")
        if folder.stat().st_mode & 0o022:
            folder.chmod(0o700)
    with tempfile.TemporaryFile(dir=folder):
        os.utime(folder)


def prune(root: Path) -> None:
    """Delete versions that no run has used for long.

    A folder is renamed first: of several processes that prune, one gets it.  A run that begins to use it at
    this moment makes it anew.
    """
    limit = time.time() - MAX_AGE
    for old in root.iterdir():
        try:
            if not OF_A_VERSION.fullmatch(old.name) or old.is_symlink() or old.stat().st_mtime > limit:
                continue
            shutil.rmtree(old.rename(root / f"{old.name[:16]}-old-{os.getpid()}"))
        except OSError:  # another process was faster, or the folder is another user's
            continue
