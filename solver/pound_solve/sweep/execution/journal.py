"""Results of runs, and the journal in which each process records its results.

When a run has ended, its process appends one line to its own file in one system call: a kill loses at most
the runs in progress.  Truncated lines, from a full disk or a power failure, are skipped, and their runs
count as not run.
"""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_deck.files import opened
from pound_solve.numerics.types import Array
from pound_solve.results.sweep_file import DONE
from pound_solve.results.whole_file import write
from pound_solve.sweep.study.quantities import Values

ENDING: Final = ".jsonl"


@dataclass(frozen=True)
class JournalEntry:
    """Result of one run.

    Attributes
    ----------
    identity : str
    status : str
        One of `results.sweep_file.ENDS`.
    message : str
        Reason why it stopped or failed.
    doubt : str
        Checks of the run that call for a look.
    reached : float
        Last time of the history [T]; NaN without one.
    cpu, solve : float
        CPU time of the whole run, and of the method alone [s].
    values : mapping
        Quantities, see `quantities`.
    sequence, gentlest, exact : str, float, bool
        Events and exactness of the run, see `events.EventCourse`.
    at : float
        Time of its end [s since 1970].
    histories : mapping
        Kept histories: times and rows, labels and unit; stored beside the journal, not in its line.
    """

    identity: str
    status: str
    message: str = ""
    doubt: str = ""
    reached: float = float("nan")
    cpu: float = 0.0
    solve: float = 0.0
    values: Values = field(default_factory=dict)
    sequence: str = ""
    gentlest: float = 1.0
    exact: bool = True
    at: float = field(default_factory=time.time)
    histories: Mapping[str, Array] = field(default_factory=dict)


class Journal:
    """The journal of a study, a folder.

    Parameters
    ----------
    folder : Path
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def add(self, entry: JournalEntry) -> None:
        """Append the result of a run to this process's own file.

        Raises
        ------
        OSError
            The disk is full, or the folder cannot be written; nothing is recorded then.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        if entry.histories:
            self._keep(entry)
        fields = {k: v for k, v in asdict(entry).items() if k != "histories"}
        line = json.dumps(fields).encode() + b"\n"
        path = self.folder / f"{platform.node() or 'local'}-{os.getpid()}{ENDING}"
        with path.open("ab", 0) as file:
            size = file.tell()
            if size and not _ends_a_line(path):
                line = b"\n" + line
            try:
                written = file.write(line)
                if written != len(line):
                    raise OSError(28, "No space left on device", str(path))
            except OSError:
                file.truncate(size)
                raise

    def _keep(self, entry: JournalEntry) -> None:
        """Write the histories of a run beside the journal, atomically."""
        path = self.histories(entry.identity)
        memory = BytesIO()  # a failed write of an archive may raise errors other than OSError
        np.savez(memory, allow_pickle=False, **entry.histories)
        write(path, memory.getbuffer(), path.with_suffix(f".{os.getpid()}.part"))

    def histories(self, identity: str) -> Path:
        """Path of the file with the histories of a run."""
        return self.folder / f"{identity}.npz"

    def entries(self) -> dict[str, JournalEntry]:
        """Result of each run by identity: the one with status done if any, else the latest.

        Their values, which may be many, stay in the journal, see `values`.
        """
        latest: dict[str, JournalEntry] = {}
        for entry in self._all():
            old = latest.get(entry.identity)
            if old is None or (entry.status == DONE, entry.at) > (old.status == DONE, old.at):
                latest[entry.identity] = replace(entry, values={})
        return latest

    def values(self, entries: Mapping[str, JournalEntry]) -> Iterator[tuple[str, Values]]:
        """Identity and values of each of some entries, in the order of the journal."""
        for entry in self._all():
            wanted = entries.get(entry.identity)
            if wanted is not None and (wanted.status, wanted.at) == (entry.status, entry.at):
                yield entry.identity, entry.values

    def _all(self) -> Iterator[JournalEntry]:
        for path in sorted(self.folder.glob(f"*{ENDING}")):
            with opened(path) as file:
                for line in file:
                    try:
                        fields: dict[str, Any] = json.loads(line)
                        yield JournalEntry(**fields)
                    except (ValueError, TypeError):  # a truncated line
                        continue


def _ends_a_line(path: Path) -> bool:
    """Whether a file ends with a complete line."""
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) == b"\n"
