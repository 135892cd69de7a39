"""File object for HDF5 whose writes reach the disk in whole transactions, or not at all.

HDF5 does not survive a failed write: its own tables become inconsistent, and closing the file ends the
process. This object never fails on a write. It buffers pages in memory until `SafeFile.commit`, which first
reserves space at the end of the file, where a full disk is detected, and only then writes the pages.  On a
full disk the file therefore keeps the state of the last commit.

Some space stays reserved behind the data until the file is closed, so that a run on a full disk can still
record its end.

Each commit seals the file (see `seal`), so that the file of a killed run has a checksum too.  The file is
unsealed while pages are written.
"""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import IO, Final

from pound_solve.results.form import ResultsError
from pound_solve.results.seal import LENGTH, PAGE, checksums, seal

try:
    import fcntl
except ImportError:  # Windows, where other programs cannot rename or remove an open file
    fcntl = None  # type: ignore[assignment]

RESERVE: Final = 4 * PAGE  #: space reserved behind the data


class NoRoomError(ResultsError):
    """Raised if the disk is full; the file keeps the state of the last commit."""


class FileBusyError(ResultsError):
    """Raised if another program writes the file."""


class SafeFile:
    """A new file that one program writes, for the driver ``fileobj`` of h5py.

    The file is locked, so that a second writer is refused and readers learn that it is in use.

    Parameters
    ----------
    path : Path
        File to write; replaces an old one that is not in use.

    Raises
    ------
    FileBusyError
        Another program writes the file.
    NoRoomError
        The disk has no space for the reserve.
    OSError
        The file cannot be created.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._disk = _locked(path)
        self._pages: dict[int, bytearray] = {}
        self._sums: list[int] = []  # checksums of the pages on the disk
        self._sealed = 0  # position of the seal
        self._place = 0
        self._size = self._committed = self._room = 0
        self._reserve = RESERVE
        self._disk.truncate(0)
        try:
            self._make_room(RESERVE)
        except NoRoomError:
            self.remove()
            raise

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a position; see `io.IOBase.seek`."""
        self._place = offset + (self._size if whence == os.SEEK_END else 0)
        return self._place

    def tell(self) -> int:
        """Current position in the file."""
        return self._place

    def readinto(self, buffer: memoryview) -> int:
        """Fill a buffer from the current position, with zeros behind the end of the data."""
        at, done = self._place, 0
        while done < len(buffer):
            number, inside = divmod(at + done, PAGE)
            part = min(PAGE - inside, len(buffer) - done)
            buffer[done : done + part] = self._page(number)[inside : inside + part]
            done += part
        self._place += done
        return done

    def read(self, count: int) -> bytes:
        """Read some bytes from the current position."""
        buffer = bytearray(count)
        self.readinto(memoryview(buffer))
        return bytes(buffer)

    def write(self, data: memoryview) -> int:
        """Buffer data for the current position until `commit`."""
        at, done = self._place, 0
        while done < len(data):
            number, inside = divmod(at + done, PAGE)
            part = min(PAGE - inside, len(data) - done)
            page = self._pages.get(number)
            if page is None:
                page = self._pages[number] = bytearray(self._page(number))
            page[inside : inside + part] = data[done : done + part]
            done += part
        self._place += done
        self._size = max(self._size, self._place)
        return done

    def truncate(self, size: int) -> int:
        """Set the size of the data."""
        self._size = size
        return size

    def flush(self) -> None:
        """Do nothing: `commit` writes."""

    def _page(self, number: int) -> bytes | bytearray:
        """One page as it was last written, in memory or on the disk."""
        if number in self._pages:
            return self._pages[number]
        start = number * PAGE
        if start >= self._committed:
            return bytes(PAGE)
        self._disk.seek(start)
        return self._disk.read(PAGE).ljust(PAGE, b"\0")

    def commit(self) -> None:
        """Write all buffered pages to the disk.

        Raises
        ------
        NoRoomError
            The disk is full: nothing was written, and the buffer is discarded.
        """
        try:
            self._make_room(self._size + self._reserve + LENGTH)
        except NoRoomError:
            self._reserve = 0  # frees space for the final message of the run
            self.forget()
            raise
        self._lay(self._sealed, bytes(LENGTH))
        for number in sorted(self._pages, reverse=True):  # the head, which refers to the rest, last
            self._lay(number * PAGE, self._pages[number])
        self._sum_up(sorted(self._pages))
        self._pages.clear()
        self._committed = self._size
        self._seal(self._room - LENGTH)

    def _seal(self, place: int) -> None:
        """Write the seal of the data on the disk at a position, the end of the file."""
        self._sealed = place
        self._lay(place, seal(self._sums, self._committed))

    def _lay(self, place: int, data: bytes | bytearray) -> None:
        self._disk.seek(place)
        self._disk.write(data)

    def _sum_up(self, changed: list[int]) -> None:
        """Update the checksums of changed pages and of those between the former and the new end."""
        count = -(-self._size // PAGE)
        ends = range(min(self._committed, self._size) // PAGE, count)
        self._sums = self._sums[:count] + [0] * (count - len(self._sums))
        for number in {*changed, *ends}:
            if number < count:
                start = number * PAGE
                self._sums[number] = next(checksums(self._disk, start, min(start + PAGE, self._size)))

    def forget(self) -> None:
        """Discard all writes since the last commit."""
        self._pages.clear()
        self._size = self._committed

    def _make_room(self, size: int) -> None:
        """Reserve disk space up to a size; raise NoRoomError if the disk is full."""
        if size <= self._room:
            return
        try:
            _allocate(self._disk, self._room, size - self._room)
        except OSError as err:
            self._disk.truncate(self._room)
            if err.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
                raise NoRoomError(f"{self.path}: no room on the disk") from err
            raise
        self._room = size

    def end(self) -> None:
        """Release the reserve and seal the file; others may then read the file, but not write it."""
        self._seal(self._committed)
        self._disk.truncate(self._committed + LENGTH)
        self._room = self._committed + LENGTH
        if fcntl is not None:
            fcntl.flock(self._disk, fcntl.LOCK_SH)

    def remove(self) -> None:
        """Close the file and remove it."""
        self.close()
        self.path.unlink()

    def close(self) -> None:
        """Close the file and release its lock."""
        self._disk.close()


def in_use(path: Path) -> bool | None:
    """Whether a program has the file open for writing; None on systems without locks."""
    if fcntl is None:
        return None
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            return True
    return False


def _locked(path: Path) -> IO[bytes]:
    """Open and lock the file at a path."""
    if fcntl is None:
        return _fresh(path)
    while True:
        disk = path.open("ab", 0)  # creates it if missing
        disk.close()
        disk = path.open("r+b", 0)
        try:
            fcntl.flock(disk, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as err:
            if not _only_read(disk):
                disk.close()
                raise FileBusyError(
                    f"{path}: another run writes it; wait for it, or give another folder with -o"
                ) from err
            _give_up(path, disk)  # leaves it to its readers, who keep it open
            continue
        except OSError:  # a file system without locks
            return disk
        try:
            if os.path.samestat(os.fstat(disk.fileno()), path.stat()):
                return disk
        except FileNotFoundError:
            pass
        disk.close()  # the run that held it has ended and moved it away in the meantime


def _fresh(path: Path) -> IO[bytes]:
    """New file at a path, on a system without locks where an open file cannot be removed (Windows)."""
    try:
        path.unlink(missing_ok=True)
    except PermissionError as err:
        text = f"{path}: open in another run, or in a program that reads it; close it, or give another name"
        raise FileBusyError(text) from err
    return path.open("x+b", 0)


def _only_read(disk: IO[bytes]) -> bool:
    """Whether all lock holders only read the file."""
    try:
        fcntl.flock(disk, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _give_up(path: Path, disk: IO[bytes]) -> None:
    """Remove the file from its path, if the path still leads to it, and close it."""
    try:
        if os.path.samestat(os.fstat(disk.fileno()), path.stat()):
            path.unlink()
    except FileNotFoundError:
        pass
    disk.close()


def _allocate(disk: IO[bytes], start: int, count: int) -> None:
    """Reserve disk space for `count` bytes from a position on."""
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(disk.fileno(), start, count)
    else:
        disk.seek(start)
        disk.write(bytes(count))
