"""The results file: HDF5, written in blocks while the solver runs, read lazily afterwards.

All that a reader of results needs stands in the file; :mod:`pound_solve.results.schema` lists what may
stand there. This is the only module that knows HDF5.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self, TypeAlias

import h5py
import numpy as np
from numpy.typing import NDArray

from pound_deck.model import Units
from pound_solve.numerics.types import Array
from pound_solve.results.schema import HISTORIES, TABLES, Column

FILETYPE: Final = "pound-solve results"
FORMAT_VERSION: Final = (1, 0)  #: major: old readers fail; minor: something was added
STATUSES: Final = (
    "done",
    "stopped",
)  #: what :meth:`Writer.finish` takes; before that a file says "running"
#: rows of a chunk, and numbers in it, at most (one row in any case); a block of as many steps costs little
#: to write, and little is lost by a kill
BLOCK, WIDEST = 256, 2**17

#: Of each history: shape of one row, and its attributes.
Layout: TypeAlias = Mapping[str, tuple[tuple[int, ...], Mapping[str, Any]]]

_TEXT: Final = h5py.string_dtype()
_DTYPES: Final = {"int": np.dtype("i8"), "text": _TEXT}


class ResultsError(Exception):
    """A results file that cannot be created or read."""


class Writer:
    """Write a results file while the analysis goes on.

    The file is flushed after every call: a killed run leaves all but its last block.  Leaving the context
    with an exception finishes the file as ``stopped``; otherwise the caller must call :meth:`finish` first.

    Parameters
    ----------
    path : str or Path
        File to write; an old one is replaced.
    title : str
        Title of the deck.
    units : Units
        Names of the deck's units.
    program_version : str
        Version of the program that computes.

    Raises
    ------
    ResultsError
        The file cannot be created.
    """

    def __init__(self, path: str | Path, *, title: str, units: Units, program_version: str) -> None:
        try:
            # Format 1.8 holds attributes above 64 kB (labels of large models); later formats mark a file as
            # open for writing, and a killed run would then leave one that no program opens.
            Path(path).unlink(missing_ok=True)  # a reader that still holds the old file keeps it
            self._file = h5py.File(path, "w", libver=("v108", "v108"))
        except OSError as err:
            raise ResultsError(f"{path}: cannot be written: {_reason(err)}") from err
        self._units = units
        self._history: dict[str, h5py.Dataset] = {}
        self._layout: dict[str, tuple[int, ...]] = {}
        self._file.attrs.update(
            {
                "filetype": FILETYPE,
                "format_version": np.array(FORMAT_VERSION),
                "program_version": program_version,
                "title": _storable(title),
                "units": [units.force, units.length, units.time],
                "status": "running",
                "message": "",
            }
        )
        for group in ("input", "tables", "history"):
            self._file.create_group(group)
        self._file.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._file:
            return
        if kind is not None and self._file.attrs["status"] == "running":
            self.finish("stopped", f"{kind.__name__}: {error}")
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def text(self, name: str, text: str) -> None:
        """Store a text below ``/input``, as the deck by its file name; it replaces one of that name."""
        key = _escape(name)
        group = self._file["input"]
        if key in group:
            del group[key]
        group.create_dataset(key, data=_storable(text), dtype=_TEXT)
        self._file.flush()

    def table(self, name: str, rows: Iterable[Sequence[Any]], note: str | None = None) -> None:
        """Store a table; it replaces one of that name.

        Parameters
        ----------
        name : str
            One of `TABLES`.
        rows : iterable of sequences
            One value a column, in the order of the columns; units as in `TABLES`, percentages as percent.
        note : str, optional
            Remark on this run's table, printed below it after the table's general note.

        Raises
        ------
        ValueError
            The table is not in `TABLES`, or a row has another number of values than the table has columns.
        TypeError
            A value is not of its column's type.
        """
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
        group = self._file["tables"]
        if name in group:
            del group[name]
        dataset = group.create_dataset(name, data=data)
        dataset.attrs["title"] = TABLES[name].title
        dataset.attrs["note"] = _storable(note or "")
        dataset.attrs["columns"] = [c.name for c in columns]
        dataset.attrs["units"] = [self._units.text(c.unit) for c in columns]
        self._file.flush()

    def start_history(self, layout: Layout) -> None:
        """Create the histories' datasets.

        Parameters
        ----------
        layout : mapping
            For each name of `HISTORIES` but ``time``: the shape of one row, and attributes.  ``unit`` holds
            dimensions (``F*L``), one for all or one for each column of the last axis; ``labels`` one text
            for each column of the last axis; without ``labels``, ``element`` and ``quantity`` make them.  A
            row with a first axis of nodes has ``nodes``, their numbers.  A history with an empty row is
            left out.

        Raises
        ------
        ValueError
            A name is not in `HISTORIES`, labels are missing, or their number is not that of the columns.
        """
        if self._layout:
            raise ValueError("the histories are started already")
        self._create("time", (), {"unit": "T"})
        for name, (shape, attributes) in layout.items():
            if name == "time" or name not in HISTORIES:
                raise ValueError(f"no history {name!r} in HISTORIES")
            self._create(name, tuple(shape), dict(attributes))
        self._file.flush()

    def _create(self, name: str, shape: tuple[int, ...], attributes: dict[str, Any]) -> None:
        self._layout[name] = shape
        if 0 in shape:
            return
        width = shape[-1] if shape else 1
        if "labels" not in attributes and {"element", "quantity"} <= attributes.keys():
            attributes["labels"] = [
                f"{e} {q}" for e, q in zip(attributes["element"], attributes["quantity"])
            ]
        labels = attributes.setdefault("labels", [name] if not shape else None)
        if labels is None or len(labels) != width:
            raise ValueError(f"history {name!r}: {width} labels are needed")
        if len(shape) == 2 and len(attributes.get("nodes", ())) != shape[0]:
            raise ValueError(f"history {name!r}: {shape[0]} node numbers are needed")
        unit = attributes.get("unit", "")
        units = [unit] * width if isinstance(unit, str) else list(unit)
        if len(units) != width:
            raise ValueError(f"history {name!r}: one unit or {width} are needed")
        attributes["unit"] = [self._units.text(u) for u in units]
        dataset = self._file["history"].create_dataset(
            name,
            shape=(0, *shape),
            maxshape=(None, *shape),
            chunks=(min(BLOCK, max(WIDEST // math.prod(shape), 1)), *shape),
            dtype="f8",
        )
        for key, value in attributes.items():
            items = np.asarray(value)
            if items.dtype.kind in "iuf":
                dataset.attrs[key] = items
            else:
                texts = np.array([_storable(str(v)) for v in np.atleast_1d(items)], dtype=object)
                dataset.attrs.create(key, texts, dtype=_TEXT)
        self._history[name] = dataset

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
        for name, dataset in self._history.items():
            dataset.resize(len(dataset) + n, axis=0)
            dataset[len(dataset) - n :] = arrays[name]
        self._file.flush()

    def restart(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Store the state that a later run can be taken up from; it replaces an earlier one."""
        if "restart" in self._file:
            del self._file["restart"]
        group = self._file.create_group("restart")
        for name, values in state.items():
            group.create_dataset(name, data=np.asarray(values, float))
        self._file.flush()

    def finish(self, status: str, message: str = "") -> None:
        """Say how the analysis ended: ``done``, or ``stopped`` with a message that says where and why."""
        if status not in STATUSES:
            raise ValueError(f"status {status!r} is none of {', '.join(STATUSES)}")
        self._file.attrs["status"] = status
        self._file.attrs["message"] = _storable(message)
        self._file.flush()


class Results:
    """Read a results file; histories and tables are read when asked for.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    ResultsError
        There is no such file, or it is not a results file that this version reads.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise ResultsError(f"{path}: no such file")
        try:
            self._file = h5py.File(path, "r")
        except OSError as err:
            raise ResultsError(f"{path}: {_reason(err)}") from err
        try:
            self._check_head()
        except ResultsError:
            self.close()
            raise
        except (KeyError, ValueError, TypeError, OSError) as err:
            self.close()
            raise ResultsError(f"{path}: damaged results file: {err}") from err

    def _check_head(self) -> None:
        attrs = self._file.attrs
        if _plain(attrs.get("filetype")) != FILETYPE:
            raise ResultsError(f"{self.path}: an HDF5 file, but not one of pound-solve results")
        major, minor = (int(v) for v in attrs["format_version"])
        if major > FORMAT_VERSION[0]:
            raise ResultsError(
                f"{self.path}: format {major}.{minor}, this version reads up to {FORMAT_VERSION[0]}.x; "
                f"written by pound-solve {_plain(attrs['program_version'])}"
            )
        self.program_version: str = _plain(attrs["program_version"])
        self.title: str = _plain(attrs["title"])
        force, length, time = (_plain(u) for u in attrs["units"])
        self.units = Units(force, length, time, given=True)
        self.status: str = _plain(attrs["status"])  #: ``done``, ``stopped`` or ``running``
        self.message: str = _plain(attrs["message"])  #: where and why the analysis stopped, else empty
        self._datasets: dict[str, h5py.Dataset] = {}
        self._file["history"].visititems(self._collect)
        # A kill amid a flush may leave histories of different lengths: what all of them have, holds.
        self._length = min((len(d) for d in self._datasets.values()), default=0)

    def _collect(self, name: str, item: h5py.Dataset | h5py.Group) -> None:
        if isinstance(item, h5py.Dataset):
            self._datasets[name] = item

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Open a results file, see the class."""
        return cls(path)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the tables in the file, in the order of the report."""
        stored = self._file["tables"]
        return (*(n for n in TABLES if n in stored), *(n for n in stored if n not in TABLES))

    @property
    def histories(self) -> tuple[str, ...]:
        """Names of the histories in the file, ``time`` first."""
        known = [n for n in HISTORIES if n in self._datasets]
        return (*known, *(n for n in self._datasets if n not in HISTORIES))

    @property
    def texts(self) -> tuple[str, ...]:
        """Names of the texts below ``/input``."""
        return tuple(_unescape(key) for key in self._file["input"])

    @property
    def time(self) -> Array:
        """Time axis of the histories, shape (nt,), [T]; empty where no history was computed."""
        return self.history("time") if "time" in self._datasets else np.empty(0)

    @property
    def last_time(self) -> float:
        """Last instant of the histories [T]; NaN where there is none."""
        return float(self._datasets["time"][self._length - 1]) if self._length else float("nan")

    def text(self, name: str) -> str:
        """Text below ``/input``; KeyError where there is none of that name."""
        dataset = _find(self._file["input"], _escape(name), "text", name, self.texts)
        return str(dataset.asstr()[()])

    def holds(self, name: str) -> bool:
        """Whether the history of that name has an instant, or else the table of that name a row."""
        if name in self._datasets:
            return self._length > 0
        return name in self.tables and len(self._table(name)) > 0

    def table(self, name: str) -> NDArray[Any]:
        """Table as structured array, texts as str; KeyError where the file has none of that name."""
        stored = self._table(name)[()]
        fields = [stored.dtype[f] for f in stored.dtype.names]
        plain = [(f, "O" if t.kind == "O" else t) for f, t in zip(stored.dtype.names, fields)]
        out = np.empty(len(stored), dtype=plain)
        for field, kind in zip(stored.dtype.names, fields):
            column = stored[field]
            out[field] = [_plain(v) for v in column] if kind.kind == "O" else column
        return out

    def table_units(self, name: str) -> dict[str, str]:
        """Unit of every column of a table, in the deck's units."""
        attrs = self._table(name).attrs
        return {_plain(c): _plain(u) for c, u in zip(attrs["columns"], attrs["units"])}

    def note(self, name: str) -> str:
        """Remark of this run on a table, or an empty text."""
        return _plain(self._table(name).attrs["note"])

    def history(self, name: str) -> Array:
        """History, shape (nt, \\*row); KeyError where the file has none of that name."""
        out: Array = self._dataset(name)[: self._length]
        return out

    def labels(self, name: str) -> tuple[str, ...]:
        """Label of every number of a history's row, row by row (``100 ux`` for node histories)."""
        attrs = self._dataset(name).attrs
        labels = tuple(_plain(v) for v in attrs["labels"])
        if "nodes" not in attrs:
            return labels
        return tuple(f"{node} {label}" for node in attrs["nodes"] for label in labels)

    def history_units(self, name: str) -> tuple[str, ...]:
        """Unit of every number of a history's row, in the deck's units; in the order of `labels`."""
        attrs = self._dataset(name).attrs
        return tuple(_plain(v) for v in attrs["unit"]) * (len(attrs["nodes"]) if "nodes" in attrs else 1)

    def attributes(self, name: str) -> dict[str, list[Any]]:
        """All attributes of a history (``nodes``, ``element``, ``quantity``, ...), each as a list."""
        attrs = self._dataset(name).attrs
        return {key: [_plain(v) for v in np.atleast_1d(attrs[key])] for key in attrs}

    def restart(self) -> dict[str, Array]:
        """State that a later run can be taken up from; empty where the file has none."""
        group = self._file.get("restart", {})
        return {name: np.asarray(group[name], float) for name in group}

    def _table(self, name: str) -> h5py.Dataset:
        return _find(self._file["tables"], name, "table", name, self.tables)

    def _dataset(self, name: str) -> h5py.Dataset:
        return _find(self._datasets, name, "history", name, self.histories)


def is_hdf5(path: str | Path) -> bool:
    """Whether there is a file of the format of results, ours or not."""
    return bool(h5py.is_hdf5(path))


def _checked(table: str, column: Column, values: Sequence[Any]) -> Sequence[Any]:
    """The values of one column, ready to store."""
    kind: type = {"text": str, "int": Integral}.get(column.fmt, Real)
    wrong = {own for own in set(map(type, values)) if not issubclass(own, kind) or issubclass(own, bool)}
    for number, value in enumerate(values if wrong else ()):
        if type(value) in wrong:
            name = kind.__name__.lower()
            raise TypeError(
                f"table {table!r}, row {number}, column {column.name!r}: {value!r} is not {name}"
            )
    return list(map(_storable, values)) if kind is str else values


def _storable(text: str) -> str:
    """Text that HDF5 can hold: no NUL, nothing outside UTF-8 (undecodable bytes in file names)."""
    if text.isascii() and "\0" not in text:
        return text
    return text.replace("\0", "\N{REPLACEMENT CHARACTER}").encode("utf-8", "replace").decode("utf-8")


def _escape(name: str) -> str:
    """Name of one HDF5 link for a path, which may hold slashes and dots."""
    return _storable(name).replace("%", "%25").replace("/", "%2F").replace(".", "%2E")


def _unescape(key: str) -> str:
    return key.replace("%2E", ".").replace("%2F", "/").replace("%25", "%")


def _plain(value: Any) -> Any:
    """Python's own str or number for what h5py gives."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value.item() if isinstance(value, np.generic) else value


def _find(group: Any, key: str, kind: str, name: str, existing: tuple[str, ...]) -> h5py.Dataset:
    if key not in group:
        raise KeyError(f"no {kind} {name!r} in this file; it has: {', '.join(existing) or 'none'}")
    return group[key]


def _reason(err: OSError) -> str:
    """Why a file does not open, in a user's words."""
    said = str(err)
    if "unable to lock" in said:
        return "in use by another program (perhaps the run is still going on)"
    if "truncated" in said:
        return "damaged results file: it ends too early"
    if "signature" in said:
        return "not an HDF5 file"
    system = re.search("error message = '([^']*)'", said)
    return system[1] if system else said
