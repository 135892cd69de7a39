"""All runs of the study, each found by its place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path

from cases import TESTS
from choices import Record
from runs import Run

Group = list[Run]


class Study:
    """All runs.

    Parameters
    ----------
    runs : iterable of (place, Run)
        The place is ``reading, name, record``; ``systems``; ``finer``; ``variant, name``; ``stiffness,
        factor``; or ``disturbed, reading, record, number``.
    records : mapping
        Records of every reading.
    folders : sequence of Path
        Where they are found.
    left_out : sequence of str
        What was left out, or done otherwise, for want of a record.
    """

    def __init__(
        self,
        runs: Iterable[tuple[tuple[str, ...], Run]],
        records: Mapping[str, Sequence[Record]],
        folders: Sequence[Path],
        left_out: Sequence[str],
    ) -> None:
        self.records, self.folders = records, folders
        self._groups: dict[tuple[str, ...], Group] = {}
        for place, run in runs:
            self._groups.setdefault(place, []).append(run)
        self.left_out = left_out

    def _under(self, *start: str) -> dict[tuple[str, ...], Group]:
        """All groups whose place starts so, by the rest of their places."""
        n = len(start)
        return {place[n:]: group for place, group in self._groups.items() if place[:n] == start}

    @cached_property
    def readings(self) -> dict[str, dict[str, Group]]:
        """All tests by reading and record."""
        out: dict[str, dict[str, Group]] = {}
        for (reading, record), group in self._under("reading").items():
            out.setdefault(reading, {})[record] = group
        return out

    def paper(self, reading: str) -> dict[str, Group]:
        """The paper's own tests of every record."""
        own = {t.name for t in TESTS}
        return {name: [r for r in group if r.test in own] for name, group in self.readings[reading].items()}

    @property
    def systems(self) -> Group:
        """The systems named in the paper."""
        return self._groups.get(("systems",), [])

    @property
    def finer(self) -> Group:
        """More elements than the benchmark."""
        return self._groups.get(("finer",), [])

    @property
    def variants(self) -> dict[str, Group]:
        """Changed choices of the literal reading."""
        return {name: group for (name,), group in self._under("variant").items()}

    @property
    def stiffness(self) -> dict[float, Group]:
        """Contacts by the factor on the stiffness of the first diaphragm."""
        return {float(factor): group for (factor,), group in self._under("stiffness").items()}

    @property
    def disturbed(self) -> dict[tuple[str, str], list[Group]]:
        """Tests under slightly disturbed records, by reading and record."""
        out: dict[tuple[str, str], list[Group]] = {}
        for (reading, record, _), group in self._under("disturbed").items():
            out.setdefault((reading, record), []).append(group)
        return out
