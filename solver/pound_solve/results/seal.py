"""The seal of a results file: a checksum of its bytes, compared before HDF5 sees the first of them.

HDF5 trusts its input: a damaged heap can hang it.  The seal comes last in the file, behind all HDF5 data,
and HDF5 ignores it. A program that changes the file through HDF5 drops the seal, because HDF5 truncates the
file at the end of its own data; digests of the parts (see `form`) then show which parts are unchanged.

The checksum covers the checksums of pages, so that a growing file is resealed cheaply.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator, Sequence
from typing import IO, Final

PAGE: Final = 2**15  #: bytes per page checksum
#: a mark, the number of sealed bytes, the CRC-32 of the CRC-32s of their pages
_SEAL: Final = struct.Struct("<8sQI")
_MARK: Final = b"\x93POUND\r\n"
LENGTH: Final = _SEAL.size


def checksums(file: IO[bytes], start: int, end: int) -> Iterator[int]:
    """CRC-32s of the pages of a file from the page at `start`; the last one ends at `end`."""
    file.seek(start)
    while start < end:
        page = file.read(min(PAGE, end - start))
        yield zlib.crc32(page)
        start += PAGE


def seal(pages: Sequence[int], size: int) -> bytes:
    """The seal of `size` bytes whose pages have these checksums."""
    return _SEAL.pack(_MARK, size, zlib.crc32(struct.pack(f"<{len(pages)}I", *pages)))


def holds(file: IO[bytes]) -> bool | None:
    """Whether the bytes of a file match its seal; None if it has no seal."""
    end = file.seek(0, os.SEEK_END) - LENGTH
    if end < 0:
        return None
    file.seek(end)
    stored = file.read(LENGTH)
    if not stored.startswith(_MARK):
        return None
    size = _SEAL.unpack(stored)[1]
    return size <= end and seal(list(checksums(file, 0, size)), size) == stored
