"""Lock of a sweep's folder: one sweep at a time writes it; pieces of one sweep may share it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

from pound_deck.files import opened
from pound_solve.user_error import UserError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


class FolderBusyError(UserError):
    """Raised if another sweep writes the folder."""

    status = 3


@contextmanager
def locked(folder: Path, piece: str = "") -> Iterator[None]:
    """Lock a folder within the context; a piece locks its name, and shares the folder with other pieces.

    The system releases the locks of a killed process.

    Raises
    ------
    FolderBusyError
    OSError
        The folder cannot be made or written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as held:
        whole = held.enter_context(_lock(folder / "lock"))
        if fcntl is not None:
            piece_lock = held.enter_context(_lock(folder / f"lock-{piece}")) if piece else None
            try:
                fcntl.flock(whole, (fcntl.LOCK_SH if piece_lock else fcntl.LOCK_EX) | fcntl.LOCK_NB)
                if piece_lock is not None:
                    fcntl.flock(piece_lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise FolderBusyError(
                    f"{folder}: another sweep writes it; wait for it, or give another -o"
                ) from None
            except OSError:  # a file system without locks
                pass
        yield


def _lock(path: Path) -> IO[bytes]:
    """Open a file for locking; a pipe, which would block until it has a reader, is refused."""
    if path.exists():
        opened(path).close()
    return path.open("ab")
