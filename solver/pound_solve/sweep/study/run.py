"""One run of a study: a deck with its PARAMs, and the record that shakes it; its identity."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import blake2b
from pathlib import Path

from pound_deck.model import Span
from pound_solve.version import __version__


@dataclass(frozen=True)
class RecordFile:
    """A record of a study.

    Attributes
    ----------
    name : str
        File name without folder, or name of a known record.
    file : str
        Its whole path, or the name of a known record.
    items : tuple of str
        ``NAME=value``: items for reading it, as on a RECORD line.
    sha256 : str
        Of the file.
    place : Span or None
        Place in the study that names it.
    """

    name: str
    file: str
    items: tuple[str, ...]
    sha256: str
    place: Span | None = None


@dataclass(frozen=True)
class Shaking:
    """A record with its scale.

    Attributes
    ----------
    record : RecordFile
    scale : float
        Factor on the record.
    level : float
        Level given in the study: the factor, or the intensity in units of gravity.
    """

    record: RecordFile
    scale: float
    level: float


@dataclass(frozen=True)
class ParameterCase:
    """A deck with its PARAMs, common to all runs that differ only in their shaking.

    Attributes
    ----------
    deck : str
    params : tuple of (name, value)
        PARAMs that replace those of the deck, as texts of the command line.
    records : tuple of Path
        Folders searched for records.
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
class StudyRun:
    """One run of a study.

    Attributes
    ----------
    number : int
        From 1.
    case : ParameterCase
    shaking : Shaking or None
        None where the deck's own motion acts.
    first : RecordFile or None
        The study's first record, with which the case is prepared, whichever run is executed first.
    inputs : str
        Digest of what the deck reads, see `digest_of`.
    variables : tuple of str
        Variables by which an analysis of the run takes derivatives; empty for a plain run.
    """

    number: int
    case: ParameterCase
    shaking: Shaking | None
    first: RecordFile | None
    inputs: str
    variables: tuple[str, ...] = ()

    @cached_property
    def identity(self) -> str:
        """Digest of everything that determines its results, without names and places of files."""
        shaking = self.shaking
        content = {
            "inputs": self.inputs,
            "params": sorted((name.upper(), value) for name, value in self.case.params),
            "method": [self.case.method, self.case.dt, self.case.tol],
            "shaking": shaking and [shaking.record.sha256, sorted(shaking.record.items), shaking.scale],
            "version": __version__,
        } | ({"variables": self.variables} if self.variables else {})
        return blake2b(json.dumps(content).encode(), digest_size=12).hexdigest()

    def at(self, level: float) -> StudyRun:
        """The same run at another level of its record."""
        if self.shaking is None:
            raise ValueError("a run without a record has no level")
        scale = self.shaking.scale * (level / self.shaking.level)
        return replace(self, shaking=replace(self.shaking, scale=scale, level=level))

    @property
    def title(self) -> str:
        """Title of the run: deck, PARAMs, record and scale."""
        words = [Path(self.case.deck).name, *(f"{k}={v}" for k, v in self.case.params)]
        if self.shaking is not None:
            words += [self.shaking.record.name, f"x {self.shaking.scale:.6g}"]
        return " ".join(words)


def digest_of(files: Mapping[str, str]) -> str:
    """Digest of texts, independent of their names."""
    return blake2b(json.dumps(sorted(files.values())).encode(), digest_size=12).hexdigest()
