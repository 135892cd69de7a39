"""The form of a results file: what its writer and its reader agree on, beside the tables and histories."""

from __future__ import annotations

import re
from typing import Final

FILETYPE: Final = "pound-solve results"
FORMAT_VERSION: Final = (1, 1)  #: major: old readers fail; minor: something was added
IDENTITY: Final = (
    "identity"  #: name of the text in the group of the saved state that says what it belongs to
)
STATUSES: Final = ("done", "stopped")  #: how a run ends; before that its file says "running"


class ResultsError(Exception):
    """A results file that cannot be created or read."""


def storable(text: str) -> str:
    """Text that HDF5 can hold: no NUL, nothing outside UTF-8 (undecodable bytes in file names)."""
    if text.isascii() and "\0" not in text:
        return text
    return text.replace("\0", "\N{REPLACEMENT CHARACTER}").encode("utf-8", "replace").decode("utf-8")


def escape(name: str) -> str:
    """Name of one HDF5 link for a path, which may hold slashes and dots."""
    return storable(name).replace("%", "%25").replace("/", "%2F").replace(".", "%2E")


def unescape(key: str) -> str:
    """The path that `escape` turned into that name."""
    return key.replace("%2E", ".").replace("%2F", "/").replace("%25", "%")


def reason(err: OSError) -> str:
    """Why a file does not open, in a user's words."""
    said = str(err)
    if "unable to lock" in said:
        return "in use by another program (perhaps the run is still going on)"
    if "truncated" in said:
        return "damaged results file: it ends too early"
    if "signature" in said:
        return "not an HDF5 file"
    system = re.search("error message = '([^']*)'", said)
    return system[1] if system else said
