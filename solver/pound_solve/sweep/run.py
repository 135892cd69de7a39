"""One run of a study: a deck with its PARAMs, and the record that shakes it; its identity."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path

from pound_deck.model import Span
from pound_solve.version import __version__


@dataclass(frozen=True)
class RecordFile:
    """A record as a study names it.

    Attributes
    ----------
    name : str
        Its file without folder, or the name of a known record.
    file : str
        Its whole path, or the name of a known record.
    items : tuple of str
        ``NAME=value``: how it is read, as on a RECORD line.
    sha256 : str
        Of the file.
    place : Span or None
        Where the study names it.
    """

    name: str
    file: str
    items: tuple[str, ...]
    sha256: str
    place: Span | None = None


@dataclass(frozen=True)
class Shaking:
    """A record and its strength.

    Attributes
    ----------
    record : RecordFile
    scale : float
        Factor on the record.
    level : float
        What the study asks for: the factor, or the intensity in shares of gravity.
    """

    record: RecordFile
    scale: float
    level: float


@dataclass(frozen=True)
class Case:
    """A deck with its PARAMs: what runs that differ in their shaking alone share.

    Attributes
    ----------
    deck : str
    params : tuple of (name, value)
        PARAMs that replace the deck's, texts as on the command line.
    records : tuple of Path
        Folders where records are looked for.
    method, dt, tol : str or None, float or None
        Replace those of HISTORY.
    texts : str
        Digest of the deck and its included files when the study was read.
    """

    deck: str
    params: tuple[tuple[str, str], ...] = ()
    records: tuple[Path, ...] = ()
    method: str | None = None
    dt: float | None = None
    tol: float | None = None
    texts: str = ""


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes
    ----------
    number : int
        From 1.
    case : Case
    shaking : Shaking or None
        None where the deck's own motion acts.
    first : RecordFile or None
        The study's first record, under which the case is prepared, whichever of its runs comes first.
    identity : str
        Digest of all that its results depend on, see `identity`.
    """

    number: int
    case: Case
    shaking: Shaking | None
    first: RecordFile | None
    identity: str

    @property
    def title(self) -> str:
        """The run in words."""
        own = [Path(self.case.deck).name, *(f"{k}={v}" for k, v in self.case.params)]
        if self.shaking is not None:
            own += [self.shaking.record.name, f"x {self.shaking.scale:.6g}"]
        return " ".join(own)


def digest_of(files: Mapping[str, str]) -> str:
    """Digest of texts, whatever their names."""
    return blake2b(json.dumps(sorted(files.values())).encode(), digest_size=12).hexdigest()


def identity(case: Case, shaking: Shaking | None, inputs: Mapping[str, str]) -> str:
    """Digest of all that the results of a run depend on.

    Names and places of files do not count, their contents do.

    Parameters
    ----------
    case : Case
    shaking : Shaking or None
    inputs : mapping of str to str
        What the deck reads: the texts of the deck, its included files, digests of its own records.
    """
    own = {
        "inputs": sorted(inputs.values()),
        "params": sorted((name.upper(), value) for name, value in case.params),
        "method": [case.method, case.dt, case.tol],
        "shaking": shaking and [shaking.record.sha256, sorted(shaking.record.items), shaking.scale],
        "version": __version__,
    }
    return blake2b(json.dumps(own).encode(), digest_size=12).hexdigest()
