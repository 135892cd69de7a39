"""The records of a study: found by name or pattern, checked by reading them once, and scaled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Final

from pound_deck.diagnostics import Diagnostic, has_errors, hints, suggest
from pound_deck.model import Card
from pound_solve.catalog import catalog
from pound_solve.driver import record_card
from pound_solve.driver.overrides import MEETING
from pound_solve.loading.motions import record
from pound_solve.loading.motions.base import GroundMotion, LoadingContext
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import find, known, load
from pound_solve.loading.spectrum import pseudo_acceleration
from pound_solve.sweep.study.document import Document, Path_
from pound_solve.sweep.study.run import RecordFile, Shaking

#: items of [[motions]] that a RECORD line does not have
FILES, LEVELS, OSCILLATOR = "files", ("scale", "pga", "sa"), ("period", "damping")
NOT_OF_A_STUDY: Final = ("FILE", "SCALE", *MEETING)  #: of a RECORD line
DAMPING: Final = 0.05


class Suite:
    """One table of [[motions]]: records with the same items, and their levels.

    Parameters
    ----------
    document : Document
        Receives the mistakes.
    number : int
        Of the table.
    folders : sequence of Path
        Folders searched for records.
    """

    def __init__(self, document: Document, number: int, folders: Sequence[Path]) -> None:
        self.document, self.path, self.folders = document, ("motions", number), folders
        self.measure, self.levels = self._levels()
        self.period, self.damping = self._oscillator()
        self.items = tuple(self._items())
        self.records = tuple(self._records())

    def _levels(self) -> tuple[str, list[float]]:
        """Name of the intensity measure that the levels are given in, and the levels."""
        named = [name for name in LEVELS if self.document.at((*self.path, name)) is not None]
        for name in named[1:]:
            message = f"{name} stands beside {named[0]}: one of them tells how strong the records are"
            self.document.mistake("S605", message, (*self.path, name))
        measure = named[0] if named else "scale"
        levels = [float(x) for x in self.document.listed((*self.path, measure), (int, float))]
        if measure != "scale" and not all(x > 0.0 for x in levels):
            self.document.mistake("S605", f"{measure} is above zero", (*self.path, measure))
        return measure, levels or [1.0]

    def _oscillator(self) -> tuple[float, float]:
        """Period [T] and damping ratio of the oscillator whose response is the intensity."""
        period = self.document.take((*self.path, "period"), float, 0.0)
        damping = self.document.take((*self.path, "damping"), float, DAMPING)
        if self.measure == "sa" and not period > 0.0:
            self.document.mistake(
                "S605", "sa needs the period of its oscillator, above zero", (*self.path, "sa")
            )
        if not 0.0 <= damping < 1.0:
            message = "damping is a ratio from 0 to below 1"
            self.document.mistake("S605", message, (*self.path, "damping"))
        for name in OSCILLATOR:
            if self.measure != "sa" and self.document.at((*self.path, name)) is not None:
                self.document.mistake("S605", f"{name} belongs to sa", (*self.path, name))
        return period, damping

    def _items(self) -> Iterator[str]:
        """Items of the RECORD line by which the records are read."""
        fields = {f.name for spec in catalog().family("record").values() for f in spec.fields}
        fields |= {f.name for f in record.SPEC.fields}
        allowed = {name.lower() for name in fields if name not in NOT_OF_A_STUDY}
        words = [FILES, *LEVELS, *OSCILLATOR, *sorted(allowed)]
        for name, value in dict(self.document.at(self.path) or {}).items():
            if name in (FILES, *LEVELS, *OSCILLATOR):
                continue
            path = (*self.path, name)
            if name.upper() in NOT_OF_A_STUDY:
                message = (
                    f"{name} is given in the deck's line under EQUAKE, whose record the sweep replaces"
                )
                self.document.mistake("S602", message, path, "leave it out")
            elif name.lower() not in allowed:
                hint = hints(suggest(name, words), "items of a RECORD line tell how its records are read")
                self.document.mistake("S602", f"motions has no item {name}", path, hint)
            elif isinstance(value, str | int | float) and not isinstance(value, bool):
                yield f"{name.upper()}={value}"
            else:
                self.document.mistake("S603", f"{name} takes a text or a number", path)

    def _records(self) -> Iterator[RecordFile]:
        """Every record once, in the order of their names within a pattern."""
        path = (*self.path, FILES)
        names = self.document.listed(path, (str,))
        if not names and self.document.at(path) is None:
            self.document.mistake(
                "S604", "motions names no files", self.path, 'write files = ["suite/*.AT2"]'
            )
        seen = set[str]()
        for name in names:
            for file in self._matched(name, path):
                if str(file) not in seen:
                    seen.add(str(file))
                    yield from self._read(str(file), path)

    def _matched(self, name: str, path: Path_) -> list[str]:
        """Files that match a pattern, or the one file or known record of that name."""
        if known(name) is not None:
            return [name]
        if any(c in name for c in "*?["):
            files = [str(p) for p in self.document.matching(name) if p.is_file()]
            if not files:
                where = Path(Path(name).anchor or self.document.folder).absolute()
                message = f"no file fits {name}"
                self.document.mistake("S604", message, path, f"patterns count from {where}")
            return files
        try:
            return [str(find(name, (self.document.folder, *self.folders)).absolute())]
        except RecordError as err:
            self.document.mistake(err.code, err.message, path, err.hint)
            return []

    def _read(self, file: str, path: Path_) -> Iterator[RecordFile]:
        """Yield the record if it can be read with these items; otherwise add a diagnostic."""
        name = file if known(file) else Path(file).name
        place = self.document.place(path)
        record_file = RecordFile(name, file, self.items, "", place)
        try:
            _, digest = load(find(file))
            card = card_of(record_file)
            motion = record.samples(card.values, LoadingContext(9.81))
        except RecordError as err:
            self.document.mistake(err.code, err.message, path, err.hint)
            return
        except UnreadableError as err:
            self.document.diagnostics += [replace(d, span=place) for d in err.diagnostics]
            return
        unit, file_unit = card.values["UNIT"], motion.raw.unit
        if unit is not None and file_unit and file_unit != {"GAL": "CM/S2"}.get(unit, unit):
            message = f"{name} says that it is in {file_unit}, not in {unit}"
            hint = "leave unit out where files tell theirs, or give this one a [[motions]] of its own"
            self.document.mistake("S606", message, (*self.path, "unit"), hint)
        yield replace(record_file, sha256=digest)

    def shakings(self, context: LoadingContext) -> Iterator[Shaking]:
        """Every record at every level.

        Parameters
        ----------
        context : LoadingContext
            Of a deck: its unit of length and its gravity.
        """
        for record_file in self.records:
            measured = self._measured(record_file, context)
            for level in self.levels:
                if measured is None:
                    yield Shaking(record_file, level, level)
                elif measured > 0.0:
                    yield Shaking(record_file, level * context.gravity / measured, level)

    def _measured(self, record_file: RecordFile, context: LoadingContext) -> float | None:
        """Intensity of the unscaled record [L/T^2]; None where its levels are factors."""
        if self.measure == "scale":
            return None
        try:
            acceleration = unscaled(record_file, context).acceleration
            if self.measure == "pga":
                intensity = abs(acceleration.peak()[1])
            else:
                intensity = float(pseudo_acceleration(acceleration, self.period, self.damping)[0, 0])
        except (RecordError, ValueError) as err:
            self.document.mistake("S606", f"{record_file.name}: {err}", (*self.path, self.measure))
            return 0.0
        if not intensity > 0.0:
            message = f"{record_file.name} has no acceleration that could be scaled"
            self.document.mistake("S606", message, (*self.path, FILES))
        return intensity


class UnreadableError(Exception):
    """Raised if the items for reading a record are wrong."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__("; ".join(d.message for d in diagnostics))
        self.diagnostics = tuple(diagnostics)


@lru_cache(maxsize=256)
def card_of(record_file: RecordFile) -> Card:
    """RECORD card of a record, unscaled; its place is that in the study.

    Raises
    ------
    UnreadableError
    """
    model, diagnostics, _ = record_card.read(record_file.file, record_file.items, record_file.name)
    if model is None or has_errors(diagnostics):
        raise UnreadableError(diagnostics)
    (card,) = model.equake
    return replace(card, span=record_file.place, spans={}) if record_file.place else replace(card, spans={})


def scaled(shaking: Shaking) -> Card:
    """RECORD card of a record with its scale."""
    card = card_of(shaking.record)
    return replace(card, values={**card.values, "SCALE": shaking.scale})


def unscaled(record_file: RecordFile, context: LoadingContext) -> GroundMotion:
    """Motion of a record without scaling."""
    card = card_of(record_file)
    motion: GroundMotion = card.spec.impl(card.values, context)
    return motion
