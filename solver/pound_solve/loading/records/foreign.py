"""Known but unsupported files: their kinds, and remedies.

A binary file is recognised by its first bytes for every FORMAT; a text by its first lines, for AUTO only,
because FORMAT=COLUMNS may be able to read it.
"""

from __future__ import annotations

import re
from typing import Final

from pound_solve.loading.records.base import HEAD, RecordError

_UNPACK: Final = "unpack it and name a file inside"
_CONVERT: Final = (
    "convert it to two columns of time and acceleration with the instrument's factor applied, "
    "or get the agency's text file"
)
#: offset of the signature, signature, kind of file, remedy
_SIGNATURES: Final = (
    (0, rb"\x1f\x8b", "a gzip archive", _UNPACK),
    (0, rb"PK\x03\x04", "a zip archive or a workbook", _UNPACK + ", or save the sheet as CSV"),
    (0, rb"BZh\d1AY", "a bzip2 archive", _UNPACK),
    (0, rb"\xfd7zXZ", "an xz archive", _UNPACK),
    (0, rb"\x1f\x9d", "a compress archive", _UNPACK),
    (257, rb"ustar", "a tar archive, such as NIED sends", _UNPACK),
    (0, rb"\d{6}[DRQM][ \0][A-Z0-9 ]{5}", "miniSEED", _CONVERT),
    (0, rb"MS\x03", "miniSEED", _CONVERT),
    (304, rb"\x06\0\0\0|\0\0\0\x06|\x07\0\0\0|\0\0\0\x07", "a SAC file", _CONVERT),
    (0, rb"\x89HDF", "an HDF5 or ASDF file", _CONVERT),
    (0, rb"%PDF", "a PDF document", "get the record itself"),
    (0, rb"\xff\xfe|\xfe\xff", "text in UTF-16", "save it as UTF-8 or ASCII"),
)
_CORRECTED: Final = (
    "get the corrected file (.V2) of the same record, or convert it to two columns of time and acceleration"
)
#: pattern of the first lines, kind of file, remedy
_TEXTS: Final = (
    (
        r"\s*<(?:!doctype|html|\?xml)",
        "a web page or XML",
        "a download may have met a log-in page; get the file",
    ),
    (r"WID[12] ", "GSE", _CONVERT),
    (r"\s*uncorrected accelerogram data\b", "an uncorrected CSMIP file (.V1, .RAW)", _CORRECTED),
    (r"\*? ?VOL1DS FILE", "an uncorrected file of BHRC (.V1)", _CORRECTED),
    (r"\s*response and fourier\b", "spectra of CSMIP (.V3)", _CORRECTED),
)


def refuse_binary(data: bytes) -> None:
    """Raise RecordError if a file is not text.

    Parameters
    ----------
    data : bytes
        The file, or its beginning.

    Raises
    ------
    RecordError
        R402, with the kind of the file and the remedy.
    """
    for place, signature, kind, remedy in _SIGNATURES:
        if re.match(signature, data[place : place + 16]):
            raise RecordError("R402", f"the file is {kind}, which is not read", remedy)
    # NULs at the end pad the blocks of some old text files
    if b"\0" in data[:HEAD].rstrip(b"\0 \r\n"):
        raise RecordError("R402", "the file is binary, and records are read from text", _CONVERT)


def unread(head: str) -> RecordError | None:
    """Error for a text of a known but unsupported kind, or None."""
    for pattern, kind, remedy in _TEXTS:
        if re.match(pattern, head, re.IGNORECASE):
            return RecordError("R402", f"the file is {kind}, which is not read", remedy)
    return None
