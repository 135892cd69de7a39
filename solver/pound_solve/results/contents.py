"""All tables, sections and histories, discovered in the modules of `tables` and `histories`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Any, Final

from pound_solve.modules import modules_below
from pound_solve.results import histories, tables
from pound_solve.results.schema import History, Layout, Section, Stage, Table

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array


_MODULES: Final = tuple(map(import_module, (*modules_below(tables), *modules_below(histories))))
_FOLDERS: Final = tuple(map(import_module, dict.fromkeys(m.__package__ or "" for m in _MODULES)))


def _found(kind: type, modules: Iterable[ModuleType]) -> list[tuple[ModuleType, Any]]:
    """Module-level objects of a kind, ordered by place, with the first module that defines each."""
    objects: dict[int, tuple[ModuleType, Any]] = {}
    for module in modules:
        for x in vars(module).values():
            if isinstance(x, kind):
                objects.setdefault(id(x), (module, x))
    return sorted(objects.values(), key=lambda pair: pair[1].place)


_TABLES: Final = _found(Table, _MODULES)
_PARTS: Final[tuple[tuple[Section, tuple[Table[Any], ...]], ...]] = tuple(
    (section, tuple(t for module, t in _TABLES if module.__package__ == folder.__name__))
    for folder, section in _found(Section, _FOLDERS)
)

#: Sections of the report: heading, names of the tables. A section's number is its position here.
SECTIONS: Final = tuple((section.heading, tuple(t.name for t in tables)) for section, tables in _PARTS)

#: Every table by name, in the order of the report.
TABLES: Final[Mapping[str, Table[Any]]] = MappingProxyType(
    {t.name: t for _, tables in _PARTS for t in tables}
)

#: Tables that differ between two runs of the same deck.
OF_THE_DAY: Final = frozenset(t.name for section, tables in _PARTS if section.of_the_day for t in tables)

#: Tables that move to the appendix of the report where they are long.
MOVABLE: Final = frozenset(
    t.name for section, tables in _PARTS if not (section.keeps_long or section.of_the_day) for t in tables
)

#: Every history by its path below ``/history``, ``time`` first.
HISTORIES: Final[Mapping[str, History]] = MappingProxyType(
    {h.name: h for _, h in _found(History, _MODULES)}
)


def tables_at(stage: Stage) -> Iterator[Table[Any]]:
    """Tables that are written at a stage."""
    return (table for table in TABLES.values() if stage in table.stages)


def layout_of(items: RecordedItems) -> Layout:
    """Layout of all histories except ``time`` for the recorded items."""
    return {name: h.layout(items) for name, h in HISTORIES.items() if name != "time"}


def values_of(block: SampleBlock) -> dict[str, Array]:
    """Rows of all histories, from a block of samples."""
    return {name: h.values(block) for name, h in HISTORIES.items()}


def closeups_of(block: SampleBlock) -> dict[str, Array]:
    """Rows of the histories that are stored in close-ups, from a block of samples."""
    return {name: h.values(block) for name, h in HISTORIES.items() if h.closeup}


def extremes_of(block: SampleBlock) -> dict[str, Array]:
    """Rows of the histories whose extremes are stored, from a block of samples."""
    return {name: h.values(block) for name, h in HISTORIES.items() if h.extremes}
