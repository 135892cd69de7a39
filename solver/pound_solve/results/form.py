"""Format of a results file, beside the tables and histories: definitions that writer and reader share."""

from __future__ import annotations

import re
from collections.abc import Mapping
from hashlib import blake2b
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from pound_solve.user_error import UserError

FILETYPE: Final = "pound-solve results"
FORMAT_VERSION: Final = (2, 0)  #: major: old readers fail; minor: something was added
#: version from which complete files are sealed (see `seal`) and their digest covers the head
SEALED_SINCE: Final = (2, 0)
#: file attributes that the digest covers
HEAD: Final = ("filetype", "format_version", "program_version", "title", "units", "status", "message")
DIGEST: Final = "digest"  #: attribute that verifies that a part is unchanged
DIGEST_OF_THE_DAY: Final = "digest_of_the_day"  #: the same for parts that differ between two runs of a deck
#: text in the group of the saved state that identifies its run
IDENTITY: Final = "identity"
#: attributes from which other programs read the axes of a history; they repeat its own attributes
FOR_OTHERS: Final = frozenset(
    ("CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "coordinates", "units", "long_name")
)
STATUSES: Final = ("done", "stopped")  #: final states of a run; until then its file says "running"


class ResultsError(UserError):
    """A results file that cannot be created or read."""

    status = 3


def storable(text: str) -> str:
    """Text fit for HDF5: without NUL and characters that UTF-8 lacks (undecodable bytes in file names)."""
    if text.isascii() and "\0" not in text:
        return text
    return text.replace("\0", "\N{REPLACEMENT CHARACTER}").encode("utf-8", "replace").decode("utf-8")


def escape(name: str) -> str:
    """Name of one HDF5 link for a path, which may contain slashes and dots."""
    return storable(name).replace("%", "%25").replace("/", "%2F").replace(".", "%2E")


def unescape(key: str) -> str:
    """Inverse of `escape`: the path."""
    return key.replace("%2E", ".").replace("%2F", "/").replace("%25", "%")


def digest_of(attributes: Mapping[str, Any], data: NDArray[Any] | str | None = None) -> blake2b:
    """Digest of a dataset, by which a reader checks that it has not changed since it was written.

    Parameters
    ----------
    attributes : mapping
        Texts, numbers, and arrays of them.
    data : ndarray or str, optional
        If omitted, the result covers the attributes and can be updated with the bytes of numbers.
    """
    texts = {
        key: [v.decode() if isinstance(v, bytes) else str(v) for v in np.atleast_1d(attributes[key])]
        for key in sorted(attributes)
        if key not in (DIGEST, DIGEST_OF_THE_DAY, *FOR_OTHERS)
    }
    digest = blake2b(storable(repr(texts)).encode(), digest_size=8)
    if isinstance(data, str):
        digest.update(storable(data).encode())
    elif data is not None:
        digest.update(storable(repr(data.tolist())).encode() if data.dtype.names else data.tobytes())
    return digest


#: digest of a part that differs between two runs of a deck: the file's digest covers only its presence
THERE: Final = digest_of({})


def digest_of_file(parts: Mapping[str, str], attributes: Mapping[str, Any]) -> str:
    """Digest of a results file from those of its datasets, by their paths, and from its own attributes."""
    head = digest_of({key: attributes[key] for key in HEAD}).hexdigest()
    lines = "\n".join(f"{name} {digest}" for name, digest in sorted({**parts, "/": head}.items()))
    return blake2b(lines.encode(), digest_size=8).hexdigest()


def reason(err: OSError) -> str:
    """Reason why a file cannot be opened, for a message to the user."""
    said = str(err)
    if "unable to lock" in said:
        return "in use by another program (perhaps the run is still going on)"
    if "truncated" in said:
        return "damaged results file: it ends too early"
    if "signature" in said:
        return "not an HDF5 file"
    system = re.search("error message = '([^']*)'", said)
    return system[1] if system else said
