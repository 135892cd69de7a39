"""One sweep at a time writes a folder; pieces of one sweep may share it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


class BusyError(Exception):
    """Another sweep writes the folder."""


@contextmanager
def locked(folder: Path, piece: str = "") -> Iterator[None]:
    """Hold a folder; a piece holds its own name, and shares the folder with other pieces.

    The system frees what a killed process has held.

    Raises
    ------
    BusyError
    OSError
        The folder cannot be made or written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as held:
        whole = held.enter_context((folder / "lock").open("ab"))
        if fcntl is not None:
            own = held.enter_context((folder / f"lock-{piece}").open("ab")) if piece else None
            try:
                fcntl.flock(whole, (fcntl.LOCK_SH if own else fcntl.LOCK_EX) | fcntl.LOCK_NB)
                if own is not None:
                    fcntl.flock(own, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise BusyError(
                    f"{folder}: another sweep writes it; wait for it, or give another -o"
                ) from None
            except OSError:  # a file system without locks
                pass
        yield
