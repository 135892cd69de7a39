"""The seal of a results file: a checksum of all its bytes, which holds before HDF5 sees the first of them.

HDF5 trusts what it reads: a damaged heap can keep it busy without an end.  The seal stands behind the last
byte of HDF5, which takes no notice of it.  A program that changes the file by HDF5 drops the seal, because
HDF5 ends a file where its own data end; digests of the parts, see `form`, then tell what is as it was
written.
"""

from __future__ import annotations

import os
import struct
import zlib
from typing import IO, Final

#: a mark, the number of bytes before the seal, their CRC-32
_SEAL: Final = struct.Struct("<8sQI")
_MARK: Final = b"\x93POUND\r\n"
LENGTH: Final = _SEAL.size
_BLOCK: Final = 2**18  #: bytes read at once


def seal(file: IO[bytes], size: int) -> bytes:
    """The seal of the first `size` bytes of a file."""
    file.seek(0)
    crc = 0
    while size_left := size - file.tell():
        block = file.read(min(_BLOCK, size_left))
        if not block:
            break
        crc = zlib.crc32(block, crc)
    return _SEAL.pack(_MARK, size, crc)


def holds(file: IO[bytes]) -> bool | None:
    """Whether the bytes of a file are those that were sealed; None where it has no seal."""
    size = file.seek(0, os.SEEK_END) - LENGTH
    if size < 0:
        return None
    file.seek(size)
    found = file.read(LENGTH)
    return seal(file, size) == found if found.startswith(_MARK) else None
