"""All runs of the study, each found by its place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar

from cases import TESTS
from choices import COSTLY, READINGS, STRUCTURES, Structure
from motions import RECORDS, Record
from runs import Run

Group = list[Run]


class Study:
    """All runs.

    Parameters
    ----------
    runs : iterable of (place, Run, float)
        With the CPU time [s].  The place is ``reading, name, record``; ``systems``; ``finer``; ``method``;
        ``variant, name``; ``stiffness, factor``; ``disturbed, reading, record, number``; or ``cell,
        structure, record's text``.
    records : mapping
        Records of every reading.
    folders : sequence of Path
        Where they are found.
    left_out : sequence of str
        What was left out, or done otherwise, for want of a record.
    """

    #: storey yield of every reading over that of Table IV
    strength: ClassVar[Mapping[str, float]] = {r.name: r.structure.strength for r in READINGS}

    def __init__(
        self,
        runs: Iterable[tuple[tuple[str, ...], Run, float]],
        records: Mapping[str, Sequence[Record]],
        folders: Sequence[Path],
        left_out: Sequence[str],
    ) -> None:
        self.records, self.folders = records, folders
        self._groups: dict[tuple[str, ...], Group] = {}
        self._costs: dict[tuple[str, ...], list[float]] = {}
        for place, run, cost in runs:
            self._groups.setdefault(place, []).append(run)
            self._costs.setdefault(place, []).append(cost)
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
        names = {t.name for t in TESTS}
        return {
            record: [r for r in group if r.test in names]
            for record, group in self.readings[reading].items()
        }

    @cached_property
    def cells(self) -> dict[tuple[Structure, Record], Group]:
        """All tests by structure and record."""
        structures = {repr(s): s for s in (*STRUCTURES, *(s for s, _ in COSTLY))}
        records = {r.says: r for group in RECORDS for r in group}
        return {
            (structures[structure], records[says]): group
            for (structure, says), group in self._under("cell").items()
        }

    @property
    def systems(self) -> Group:
        """The systems named in the paper."""
        return self._groups.get(("systems",), [])

    @property
    def finer(self) -> Group:
        """More elements than the benchmark."""
        return self._groups.get(("finer",), [])

    @property
    def methods(self) -> list[tuple[Run, float]]:
        """The benchmark by its own method and by steps, with the CPU time [s]."""
        return list(zip(self._groups.get(("method",), []), self._costs.get(("method",), [])))

    @property
    def seconds(self) -> float:
        """CPU time of all runs [s]."""
        return sum(map(sum, self._costs.values()))

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
