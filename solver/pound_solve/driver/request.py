"""Request for a run: the deck and the user's options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pound_deck.model import Card


@dataclass(frozen=True)
class Request:
    """The user's options for a run.

    Attributes
    ----------
    deck : str
        Path of the deck.
    params : mapping of str to str
        PARAM values that replace the deck's.
    out : Path or None
        Folder of report and results; None for the deck's.
    records : tuple of Path
        Folders to search for records, after the deck's own.
    method, dt, tol : str or None, float or None
        Replace METHOD, DT and TOL of every HISTORY.
    explain : bool
        Record in the results what the run imports, compiles and stores.
    unsaved : mapping of str to str
        Texts of an editor, keyed by real path, which replace these files.
    name : str or None
        Name of report and results without their endings; None for the deck's.
    motion : Card or None
        RECORD that replaces the deck's only line under EQUAKE; see `overrides.with_motion`.

    Raises
    ------
    ValueError
        The name is not a valid file name.
    """

    deck: str
    params: Mapping[str, str] = field(default_factory=dict)
    out: Path | None = None
    records: tuple[Path, ...] = ()
    method: str | None = None
    dt: float | None = None
    tol: float | None = None
    explain: bool = False
    unsaved: Mapping[str, str] = field(default_factory=dict)
    name: str | None = None
    motion: Card | None = None

    def __post_init__(self) -> None:
        if self.name is None:
            return
        if not self.name.isprintable() or not any(map(str.isalnum, self.name)):
            remedy = "give characters that can be printed, a letter or a digit among them"
            raise ValueError(f"{self.name[:60]!r} names no file: {remedy}")
        if Path(self.name).name != self.name:
            raise ValueError(f"{self.name[:60]} is a path: a name stands without a folder, see -o")

    def path(self, suffix: str) -> Path:
        """Path of an output file."""
        deck = Path(self.deck)
        return (self.out or deck.parent) / ((self.name or deck.stem) + suffix)
