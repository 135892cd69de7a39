"""The writer of results files: HDF5, written in blocks while the solver runs."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from pound_solve.interruption import undisturbed
from pound_solve.results.axes import axes_of
from pound_solve.results.contents import HISTORIES, OF_THE_DAY, TABLES, tables_at
from pound_solve.results.form import (
    DIGEST,
    DIGEST_OF_THE_DAY,
    FILETYPE,
    FORMAT_VERSION,
    IDENTITY,
    STATUSES,
    THERE,
    ResultsError,
    digest_of,
    digest_of_file,
    escape,
    storable,
)
from pound_solve.results.safe_file import NoRoomError, SafeFile
from pound_solve.results.schema import Column, HistoryLayout, Layout, Stage
from pound_solve.results.whole_file import free

if TYPE_CHECKING:
    from pound_deck.model import Units
    from pound_solve.results.record import RunRecord
    from pound_solve.results.study_record import MethodStudy

#: rows of a chunk, and numbers in it, at most (one row in any case); a block of as many steps costs little
#: to write, and little is lost by a kill
BLOCK, WIDEST = 256, 2**17

_TEXT: Final = h5py.string_dtype()
_DTYPES: Final = {"int": np.dtype("i8"), "text": _TEXT}


class Writer:
    """Write a results file during the analysis.

    Each call has written its data to the file when it returns: a killed run, or one whose disk is full,
    loses only its last block.  Leaving the context with an exception finishes the file as ``stopped``;
    otherwise the caller must call :meth:`finish` first.

    Parameters
    ----------
    path : str or Path
        File to write; an old one is replaced.  Until the context is left, no other run may write it.
    title : str
        Title of the deck.
    units : Units
        Names of the deck's units.
    program_version : str
        Version of the program that computes.

    Raises
    ------
    ResultsError
        The file cannot be created, or another run writes it.  Every other call raises `NoRoomError` where
        the disk is full; earlier data are kept.
    """

    def __init__(self, path: str | Path, *, title: str, units: Units, program_version: str) -> None:
        try:
            free(Path(path))
            self._disk = SafeFile(Path(path))
        except OSError as err:
            raise ResultsError(f"{path}: cannot be written: {err.strerror}") from err
        self._units = units
        self._history: dict[str, h5py.Dataset] = {}
        self._layout: dict[str, tuple[int, ...]] = {}
        self._digests = dict[str, Any]()  # of the parts, by their paths
        self._stored = dict[str, Any]()  # those since the last commit
        try:
            with undisturbed():
                self._start(title, units, program_version)
        except NoRoomError:
            self._disk.remove()
            raise

    def _start(self, title: str, units: Units, program_version: str) -> None:
        """Write the head of the file."""
        # Format 1.8 holds attributes above 64 kB (labels of large models); later formats mark a file as
        # open for writing, and a killed run would then leave one that no program opens.
        self._file = h5py.File(self._disk, "w", libver=("v108", "v108"))
        self._file.attrs.update(
            {
                "filetype": FILETYPE,
                "format_version": np.array(FORMAT_VERSION),
                "program_version": program_version,
                "title": storable(title),
                "units": [units.force, units.length, units.time],
                "status": "running",
                "message": "",
                DIGEST: "",
            }
        )
        for group in ("input", "tables", "history"):
            self._file.create_group(group)
        self._commit()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._file and kind is not None and self._file.attrs["status"] == "running":
                self.finish("stopped", f"{kind.__name__}: {error}")
            self.close()
        finally:
            self._disk.close()

    def close(self) -> None:
        """Close the file; others may read it now, and write it when the context is left."""
        if self._file:
            with undisturbed():
                self._file.close()
                self._disk.commit()
                self._disk.end()

    def _commit(self) -> None:
        """Write all to the disk; where it has no room, restore the last commit and raise NoRoomError."""
        self._file.flush()
        try:
            self._disk.commit()
        except NoRoomError:
            self._file.close()
            self._disk.forget()
            self._file = h5py.File(self._disk, "r+", libver=("v108", "v108"))
            self._history = {
                name: self._file["history"][name] for name in self._history if name in self._file["history"]
            }
            self._digests = {name: digest for name, digest in self._digests.items() if name in self._file}
            self._stored.clear()
            raise
        self._digests |= self._stored
        self._stored.clear()

    def text(self, name: str, text: str) -> None:
        """Store a text below ``/input``, as the deck by its file name; it replaces one of that name."""
        with undisturbed():
            self._put("input", escape(name), storable(text), {})
            self._commit()

    def table(self, name: str, rows: Iterable[Sequence[Any]], note: str | None = None) -> None:
        """Store a table; it replaces one of that name.

        Parameters
        ----------
        name : str
            One of `TABLES`.
        rows : iterable of sequences
            One value per column, in the order of the columns; units as in `TABLES`, percentages as percent.
        note : str, optional
            Remark on this run's table, printed below it after the table's general note.

        Raises
        ------
        ValueError
            The table is not in `TABLES`, or a row has another number of values than the table has columns.
        TypeError
            A value is not of its column's type.
        """
        self._table(name, rows, note)
        with undisturbed():
            self._commit()

    def _table(self, name: str, rows: Iterable[Sequence[Any]], note: str | None) -> None:
        """Store a table without a commit."""
        if name not in TABLES:
            raise ValueError(f"no table {name!r} in TABLES")
        columns = TABLES[name].columns
        dtype = np.dtype([(c.name, _DTYPES.get(c.fmt, np.dtype("f8"))) for c in columns])
        records = list(rows)
        for number, row in enumerate(records):
            if len(row) != len(columns):
                raise ValueError(
                    f"table {name!r}, row {number}: {len(row)} values for {len(columns)} columns"
                )
        data = np.empty(len(records), dtype)
        for column, values in zip(columns, zip(*records)):
            data[column.name] = _checked(name, column, values)
        attributes = {
            "title": TABLES[name].title,
            "note": storable(note or ""),
            "columns": [c.name for c in columns],
            "units": [self._units.text(c.unit) for c in columns],
        }
        with undisturbed():
            self._put("tables", name, data, attributes)

    def _put(self, group: str, name: str, data: NDArray[Any] | str, attributes: Mapping[str, Any]) -> None:
        """Store an array or a text in a group, without a commit; it replaces one of that name."""
        place = self._file.require_group(group)
        if name in place:
            del place[name]
        dtype = _TEXT if isinstance(data, str) else None
        sums = np.ndim(data) > 0 and np.size(data) > 0  # HDF5 keeps them for chunks of an array only
        dataset = place.create_dataset(name, data=data, dtype=dtype, fletcher32=sums)
        digest = digest_of(attributes, data)
        dataset.attrs.update(attributes)
        dataset.attrs[DIGEST_OF_THE_DAY if name in OF_THE_DAY else DIGEST] = digest.hexdigest()
        self._stored[f"{group}/{name}"] = THERE if name in OF_THE_DAY else digest

    def tables(self, stage: Stage, record: RunRecord | MethodStudy) -> None:
        """Store the tables of a stage, except those whose `rows` returns None.

        Parameters
        ----------
        stage : Stage
        record : RunRecord or MethodStudy
            Source of the rows.
        """
        for table in tables_at(stage):
            rows = table.rows(record)
            if rows is not None:
                self._table(table.name, rows, table.remark(record))
        with undisturbed():
            self._commit()

    def start_history(self, layout: Layout, packed: bool = False) -> None:
        """Create the histories' datasets.

        Parameters
        ----------
        layout : mapping
            For each name of `HISTORIES` but ``time`` its `HistoryLayout`.
        packed : bool
            Compress them; no digit is lost.

        Raises
        ------
        ValueError
            A name is not in `HISTORIES`, labels are missing, or their number is not that of the columns.
        """
        if self._layout:
            raise ValueError("the histories are started already")
        with undisturbed():
            self._create("time", HistoryLayout((), {"unit": "T"}), packed)
            for name, form in layout.items():
                if name == "time" or name not in HISTORIES:
                    raise ValueError(f"no history {name!r} in HISTORIES")
                self._create(name, HistoryLayout(*form), packed)
            self._commit()

    def _create(self, name: str, layout: HistoryLayout, packed: bool) -> None:
        shape = tuple(layout.shape)
        self._layout[name] = shape
        if 0 in shape:
            return
        attributes = _complete(name, layout)
        attributes["unit"] = [self._units.text(u) for u in attributes["unit"]]
        dataset = self._file["history"].create_dataset(
            name,
            shape=(0, *shape),
            maxshape=(None, *shape),
            chunks=(min(BLOCK, max(WIDEST // math.prod(shape), 1)), *shape),
            dtype="f8",
            fletcher32=True,
            compression="gzip" if packed else None,
            compression_opts=1 if packed else None,  # higher levels cost much and gain little
        )
        for key, value in attributes.items():
            items = _items(value)
            dataset.attrs.create(key, items, dtype=None if items.dtype.kind in "iuf" else _TEXT)
        self._history[name] = dataset
        self._digests[f"history/{name}"] = digest_of(attributes)
        self._scale(name, dataset, attributes)

    def _scale(self, name: str, dataset: h5py.Dataset, attributes: Mapping[str, Any]) -> None:
        """Attach labels to the axes of a history in the way of netCDF: a dimension scale for each axis,
        beside the history, so that programs for netCDF open its group by themselves.
        """
        group, _, leaf = name.rpartition("/")
        place = self._file["history"].require_group(group) if group else self._file["history"]
        dataset.attrs["long_name"] = HISTORIES[name].doc
        if len(set(attributes["unit"])) == 1:
            dataset.attrs["units"] = storable(attributes["unit"][0])
        if name == "time":
            dataset.make_scale(leaf)
            return
        if "time" not in place:
            place["time"] = self._history["time"]  # another name of the same dataset
        dataset.dims[0].attach_scale(self._history["time"])
        for number, axis in enumerate(axes_of(name, attributes), 1):
            scale = _beside(name, place, axis.name, axis.labels)
            if not scale.is_scale:
                scale.make_scale(axis.name)
            dataset.dims[number].attach_scale(scale)
            for other, values in axis.coordinates.items():
                along = _beside(name, place, other, values)
                if not along.dims[0]:
                    along.dims[0].attach_scale(scale)
            if axis.coordinates:
                dataset.attrs["coordinates"] = " ".join(axis.coordinates)

    def closeups(self, layout: Layout, blocks: Sequence[Mapping[str, NDArray[Any]]]) -> None:
        """Store the close-ups of collisions, below ``/closeup``.

        Parameters
        ----------
        layout : mapping
            As of `start_history`.
        blocks : sequence of mappings
            Rows of ``time`` and of other histories, in the order of time.
        """
        with undisturbed():
            for name in blocks[0] if blocks else ():
                form = HistoryLayout((), {"unit": "T"}) if name == "time" else layout[name]
                self._aside("closeup", name, form, np.concatenate([block[name] for block in blocks]))
            self._commit()

    def extremes(
        self,
        layout: Layout,
        bounds: NDArray[Any],
        low: Mapping[str, NDArray[Any]],
        high: Mapping[str, NDArray[Any]],
    ) -> None:
        """Store the extremes of histories within intervals, below ``/extremes``.

        Parameters
        ----------
        layout : mapping
            As of `start_history`.
        bounds : ndarray, shape (n_intervals + 1,)
            Of the intervals [T].
        low, high : mapping of str to ndarray, shape (n_intervals, \\*row)
            Smallest and largest values of histories.
        """
        with undisturbed():
            self._aside("extremes", "time", HistoryLayout((), {"unit": "T"}), bounds)
            for name in low:
                rows = np.stack([low[name], high[name]], axis=1)
                self._aside("extremes", name, layout[name], rows)
            self._commit()

    def _aside(self, group: str, name: str, layout: HistoryLayout, rows: NDArray[Any]) -> None:
        """Store rows of a history other than its samples (close-ups, extremes) in a separate group."""
        if 0 in layout.shape:
            return
        attributes = _complete(name, layout)
        attributes["unit"] = [self._units.text(u) for u in attributes["unit"]]
        texts = {key: [storable(v) for v in attributes[key]] for key in ("labels", "unit")}
        self._put(group, name, np.asarray(rows, float), {**attributes, **texts})

    def stored(self, name: str) -> NDArray[np.float64]:
        """Rows of a history so far, shape (n_times, \\*row).

        Raises
        ------
        KeyError
            The run has no such history.
        """
        rows: NDArray[np.float64] = self._history[name][:]
        return rows

    def append(self, block: Mapping[str, NDArray[Any]]) -> None:
        """Append a block of instants to all histories.

        Parameters
        ----------
        block : mapping of str to ndarray, shape (n, \\*row)
            ``time`` and every history of the layout; the same n in all.

        Raises
        ------
        ValueError
            A history is missing or unknown, or a shape is wrong.
        """
        if block.keys() != self._layout.keys():
            odd = sorted(block.keys() ^ self._layout.keys())
            raise ValueError(f"histories that are missing or were never started: {', '.join(odd)}")
        n = len(block["time"])
        arrays = {name: np.asarray(values, dtype=float) for name, values in block.items()}
        for name, values in arrays.items():
            if values.shape != (n, *self._layout[name]):
                raise ValueError(f"history {name!r}: shape {values.shape}, not {(n, *self._layout[name])}")
        with undisturbed():
            for name, dataset in self._history.items():
                dataset.resize(len(dataset) + n, axis=0)
                dataset[len(dataset) - n :] = arrays[name]
            self._commit()
            for name in self._history:
                self._digests[f"history/{name}"].update(np.ascontiguousarray(arrays[name]).data)

    def restart(self, state: Mapping[str, NDArray[Any]], identity: Mapping[str, str]) -> None:
        """Store the state that a later run can continue from, and the identity of what it belongs to; it
        replaces an earlier one.
        """
        with undisturbed():
            self._put("restart", IDENTITY, storable(json.dumps(identity)), {})
            for name, values in state.items():
                self._put("restart", name, np.asarray(values, float), {})
            self._commit()

    def finish(self, status: str, message: str = "") -> None:
        """Store the final status: ``done``, or ``stopped`` with a message that states place and reason."""
        if status not in STATUSES:
            raise ValueError(f"status {status!r} is not one of {', '.join(STATUSES)}")
        parts = {name: digest.hexdigest() for name, digest in self._digests.items()}
        with undisturbed():
            for name, dataset in self._history.items():
                dataset.attrs[DIGEST] = parts[f"history/{name}"]
            self._file.attrs["status"] = status
            self._file.attrs["message"] = storable(message)
            self._file.attrs[DIGEST] = digest_of_file(parts, self._file.attrs)
            self._commit()


def _items(values: Any) -> NDArray[Any]:
    """Array of numbers; of texts for anything else."""
    items = np.asarray(values)
    if items.dtype.kind in "iuf":
        return items
    return np.array([storable(str(v)) for v in np.atleast_1d(items)], dtype=object)


def _beside(history: str, place: h5py.Group, axis: str, values: Sequence[Any]) -> h5py.Dataset:
    """Dataset with the labels of an axis of a history, created if it is missing; the histories of a group
    share it.

    Raises
    ------
    ValueError
        Another history of the group has other labels, or a group has the name of the axis.
    """
    items = _items(values)
    if axis not in place:
        return place.create_dataset(axis, data=items, dtype=None if items.dtype.kind in "iuf" else _TEXT)
    dataset = place[axis]
    if not isinstance(dataset, h5py.Dataset):
        raise ValueError(f"history {history!r}: a group of histories has the name of its axis {axis!r}")
    if _items(dataset.asstr()[()] if items.dtype.kind == "O" else dataset[()]).tolist() != items.tolist():
        raise ValueError(
            f"history {history!r}: another history of its group has other labels on the axis {axis!r}"
        )
    return dataset


def _complete(name: str, layout: HistoryLayout) -> dict[str, Any]:
    """Attributes of a history, completed by labels and one unit for each column; ValueError where their
    number is not that of the columns.
    """
    shape, attributes = layout.shape, dict(layout.attributes)
    width = shape[-1] if shape else 1
    if "labels" not in attributes and {"element", "quantity"} <= attributes.keys():
        attributes["labels"] = [f"{e} {q}" for e, q in zip(attributes["element"], attributes["quantity"])]
    labels = attributes.setdefault("labels", [name] if not shape else None)
    if labels is None or len(labels) != width:
        raise ValueError(f"history {name!r}: {width} labels are needed")
    if len(shape) == 2 and len(attributes.get("nodes", ())) != shape[0]:
        raise ValueError(f"history {name!r}: {shape[0]} node numbers are needed")
    unit = attributes.get("unit", "")
    attributes["unit"] = [unit] * width if isinstance(unit, str) else list(unit)
    if len(attributes["unit"]) != width:
        raise ValueError(f"history {name!r}: one unit or {width} are needed")
    return attributes


def _checked(table: str, column: Column, values: Sequence[Any]) -> Sequence[Any]:
    """Values of one column as they are stored; TypeError where one is not of the column's type."""
    kind: type = {"text": str, "int": Integral}.get(column.fmt, Real)
    wrong = {
        actual
        for actual in set(map(type, values))
        if not issubclass(actual, kind) or issubclass(actual, bool)
    }
    for number, value in enumerate(values if wrong else ()):
        if type(value) in wrong:
            name = kind.__name__.lower()
            raise TypeError(
                f"table {table!r}, row {number}, column {column.name!r}: {value!r} is not {name}"
            )
    return list(map(storable, values)) if kind is str else values
