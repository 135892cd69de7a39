"""The reader of results files, which reads tables and histories on demand.

The file describes itself; `pound_solve.results.contents` lists its possible contents.
"""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Concatenate, Final, ParamSpec, Self, TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from pound_deck.model import Units
from pound_solve.check import COLUMNS, Check
from pound_solve.numerics.types import Array
from pound_solve.results.axes import axes_of, coordinates
from pound_solve.results.contents import HISTORIES, TABLES
from pound_solve.results.form import (
    DIGEST,
    DIGEST_OF_THE_DAY,
    FILETYPE,
    FOR_OTHERS,
    FORMAT_VERSION,
    IDENTITY,
    SEALED_SINCE,
    STATUSES,
    THERE,
    ResultsError,
    digest_of,
    digest_of_file,
    escape,
    reason,
    unescape,
)
from pound_solve.results.frames import frame, labelled, library
from pound_solve.results.safe_file import in_use
from pound_solve.results.seal import holds

if TYPE_CHECKING:
    import pandas
    import xarray

#: exceptions of h5py and numpy on a damaged file
DAMAGE: Final = (OSError, RuntimeError, KeyError, ValueError, TypeError, IndexError, AttributeError)
#: message to the user before HDF5 reads such a file
NOT_AS_WRITTEN: Final = (
    "damaged results file: its bytes are not those that were written; take a copy that is whole, or run "
    "the deck again (in Python, Results.open(path, damaged=True) reads the parts that hold)"
)

_P = ParamSpec("_P")
_T = TypeVar("_T")
_D = TypeVar("_D", str, NDArray[Any])


class NoSuchPartError(ResultsError, KeyError):
    """The file has no table, history or text of that name."""

    status = 2

    def __str__(self) -> str:
        return str(self.args[0])


def _sound(method: Callable[Concatenate[Results, _P], _T]) -> Callable[Concatenate[Results, _P], _T]:
    """Decorate a method to raise ResultsError if the file is damaged."""

    @wraps(method)
    def read(self: Results, /, *args: _P.args, **kwargs: _P.kwargs) -> _T:
        try:
            return method(self, *args, **kwargs)
        except ResultsError:
            raise
        except DAMAGE as err:
            raise self._damaged(err) from err

    return read


class Results:
    """A results file, whose histories and tables are read on demand.

    Parameters
    ----------
    path : str or Path
        The file.
    damaged : bool
        Also read a file with a wrong checksum.  Each part is still compared with its digest, but HDF5 may
        crash the process or hang if its own tables are damaged.

    Attributes
    ----------
    changed : bool
        Whether a program has changed the file after the run, as far as that is detectable.

    Raises
    ------
    ResultsError
        There is no such file, or this version cannot read it.  All methods raise this if the file is
        damaged.
    """

    def __init__(self, path: str | Path, damaged: bool = False) -> None:
        self.path = Path(path)
        self._read: dict[str, NDArray[Any]] = {}  # caches tables, which a report reads repeatedly
        if not self.path.is_file():
            raise ResultsError(f"{path}: no such file")
        try:
            with self.path.open("rb") as file:
                sealed = holds(file)
            if sealed is False and not damaged and not in_use(self.path):
                raise ResultsError(f"{path}: {NOT_AS_WRITTEN}")
            self._file = h5py.File(path, "r")
        except OSError as err:
            raise ResultsError(f"{path}: {reason(err)}") from err
        try:
            self._check_head(sealed is True)
        except ResultsError:
            self.close()
            raise
        except DAMAGE as err:
            self.close()
            raise ResultsError(f"{path}: damaged results file: {err}") from err

    def _check_head(self, sealed: bool) -> None:
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
        self.units = Units(force, length, time, stated=True)
        #: ``done``, ``stopped``, ``running``, or ``killed`` if it says so but has no writer
        self.status: str = _plain(attrs["status"])
        if self.status == "running" and in_use(self.path) is False:
            self.status = "killed"
        self._sealed = (major, minor) >= SEALED_SINCE
        self._complete = self.status in STATUSES and self._sealed
        # a valid seal covers every byte, so the parts need no digests
        self._whole = self._complete and sealed
        self.changed = self._complete and not sealed
        # the digest of a complete file covers its tables by name; other versions have other columns
        self._judges_columns = not self._complete and (major, minor) == FORMAT_VERSION
        self.digest: str = _plain(attrs.get(DIGEST, ""))  #: of the contents except run times
        self.message: str = _plain(attrs["message"])  #: reason and time of an early stop, else empty
        self._datasets: dict[str, h5py.Dataset] = {}
        histories = self._file["history"]
        histories.visititems(self._collect)
        if "time" in histories:  # every group of histories has a link to it
            self._datasets["time"] = histories["time"]
        # A kill during a flush may leave histories of different lengths: the rows common to all are valid.
        self._length = min((len(d) for d in self._datasets.values()), default=0)
        if self._complete and not self._whole and self.digest != self._own_digest():
            raise self._damaged("parts are missing or not as they were written")

    def _own_digest(self) -> str:
        """Digest of the file, computed from the digests of its parts."""
        parts: dict[str, str] = {}

        def take(name: str, item: h5py.Dataset | h5py.Group) -> None:
            if DIGEST in item.attrs:
                parts[name] = _plain(item.attrs[DIGEST])
            elif DIGEST_OF_THE_DAY in item.attrs:
                parts[name] = THERE.hexdigest()

        for group in self._file:
            if group != "history" and isinstance(self._file[group], h5py.Group):
                self._file[group].visititems(lambda name, item, group=group: take(f"{group}/{name}", item))
        for name, dataset in self._datasets.items():
            take(f"history/{name}", dataset)
        return digest_of_file(parts, self._file.attrs)

    def _collect(self, name: str, item: h5py.Dataset | h5py.Group) -> None:
        if isinstance(item, h5py.Dataset) and "labels" in item.attrs and name.rpartition("/")[2] != "time":
            self._datasets[name] = item

    @classmethod
    def open(cls, path: str | Path, damaged: bool = False) -> Self:
        """Open a results file, see the class."""
        return cls(path, damaged)

    def close(self) -> None:
        """Close the file."""
        self._read.clear()
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @cached_property
    @_sound
    def tables(self) -> tuple[str, ...]:
        """Names of the tables in the file, in the order of the report."""
        stored = list(self._file["tables"])
        return (*(n for n in TABLES if n in stored), *(n for n in stored if n not in TABLES))

    @property
    @_sound
    def histories(self) -> tuple[str, ...]:
        """Names of the histories in the file, ``time`` first."""
        known = [n for n in HISTORIES if n in self._datasets]
        return (*known, *(n for n in self._datasets if n not in HISTORIES))

    @property
    @_sound
    def texts(self) -> tuple[str, ...]:
        """Names of the texts below ``/input``."""
        return tuple(unescape(key) for key in self._file["input"])

    @property
    def time(self) -> Array:
        """Time axis of the histories, shape (nt,), [T]; empty without a history."""
        return self.history("time") if "time" in self._datasets else np.empty(0)

    @property
    def last_time(self) -> float:
        """Last instant of the histories [T]; NaN without a history."""
        return float(self._datasets["time"][self._length - 1]) if self._length else float("nan")

    @_sound
    def text(self, name: str) -> str:
        """Text below ``/input``; raises KeyError for an unknown name."""
        dataset = self._find(self._file["input"], escape(name), "text", name, self.texts)
        return self._as_written(name, dataset, str(dataset.asstr()[()]))

    @_sound
    def holds(self, name: str) -> bool:
        """Whether the history of that name has an instant or, failing a history, the table has a row and
        the columns of this version.
        """
        if name in self._datasets:
            return self._length > 0
        if name not in self.tables or not len(stored := self._table(name)):
            return False
        return name not in TABLES or {c.name for c in TABLES[name].columns} <= set(stored.dtype.names or ())

    @_sound
    def table(self, name: str) -> NDArray[Any]:
        """Table as structured array, texts as str; raises KeyError for an unknown name."""
        dataset = self._table(name)  # raises for a closed file too
        if name not in self._read:
            stored = dataset[()]
            fields = [stored.dtype[f] for f in stored.dtype.names]
            plain = [(f, "O" if t.kind == "O" else t) for f, t in zip(stored.dtype.names, fields)]
            rows = np.empty(len(stored), dtype=plain)
            for field, kind in zip(stored.dtype.names, fields):
                column = stored[field]
                rows[field] = [_plain(v) for v in column] if kind.kind == "O" else column
            if self._judges_columns and name in TABLES and rows.dtype != TABLES[name].kinds:
                raise self._damaged(f"{name} does not have the columns of such a table")
            self._read[name] = self._as_written(name, dataset, rows, name in TABLES)
        return self._read[name].copy()

    @property
    def checks(self) -> list[Check]:
        """Checks of the run; empty for a file without checks, or with checks as sentences (format 1)."""
        rows = self.table("checks") if "checks" in self.tables else None
        if rows is None or set(COLUMNS) - set(rows.dtype.names or ()):
            return []
        return [Check.of(row) for row in rows]

    @_sound
    def table_units(self, name: str) -> dict[str, str]:
        """Unit of every column of a table, in the deck's units."""
        attrs = self._table(name).attrs
        return {_plain(c): _plain(u) for c, u in zip(attrs["columns"], attrs["units"])}

    @_sound
    def note(self, name: str) -> str:
        """Remark of this run on a table, or an empty text."""
        note: str = _plain(self._table(name).attrs["note"])
        return note

    @_sound
    def history(self, name: str, /, **at: object) -> Array:
        """Values of a history: a selection, or all.

        Parameters
        ----------
        name : str
            One of `histories`.
        **at
            Selection by some of its `coordinates`, as ``node=12, component="X"``.

        Returns
        -------
        ndarray
            Shape (nt, \\*row) without `at`; with it (nt,) for one selected column, (nt, n) for several.

        Raises
        ------
        NoSuchPartError
            The file has no such history, or the history no such column; also a KeyError.
        """
        values: Array = self._dataset(name)[: self._length]
        if values.dtype != float or math.prod(values.shape[1:]) != len(self.labels(name)):
            raise self._damaged(f"{name} does not have the columns that its labels name")
        self._as_written(name, self._dataset(name), values, self._complete)
        if not at:
            return values
        columns = values.reshape(len(values), -1)[:, self.places(name, **at)]
        return columns[:, 0] if columns.shape[1] == 1 else columns

    @_sound
    def coordinates(self, name: str) -> dict[str, tuple[Any, ...]]:
        """Coordinates that select columns of a history: each (``node``, ``component``, ...) with its value
        for every column, in the order of `labels`.
        """
        return coordinates(axes_of(name, self.attributes(name)))

    def places(self, name: str, /, **at: object) -> list[int]:
        """Indices of the columns of a history with these coordinates, in the order of `labels`.

        Raises
        ------
        NoSuchPartError
            The file has no such history, or the history no such column; also a KeyError.
        """
        coordinates = self.coordinates(name)
        left = list(range(len(self.labels(name))))
        for key, value in at.items():
            if key not in coordinates:
                raise NoSuchPartError(
                    f"history {name!r} has no {key!r}; it has: {', '.join(coordinates) or 'none'}"
                )
            there = dict.fromkeys(coordinates[key][i] for i in left)
            left = [i for i in left if coordinates[key][i] == value]
            if not left:
                has = ", ".join(map(str, there))
                raise NoSuchPartError(f"history {name!r} has no number of {key}={value!r}; it has: {has}")
        return left

    @property
    @_sound
    def closeups(self) -> tuple[str, ...]:
        """Names of the histories that have close-ups of collisions in the file."""
        group = self._file.get("closeup", {})
        return tuple(name for name in self.histories if name != "time" and name in group)

    @_sound
    def closeup(self, name: str) -> tuple[Array, Array]:
        r"""Close-ups of collisions: non-decreasing times, shape (n,), and rows of a history, shape (n,
        \*row); raises KeyError for an unknown name.

        They cover every instant of the method at which a contact was pressed, one more before and after,
        and the peaks of the contact forces.
        """
        group = self._file.get("closeup", {})
        t, rows = (self._find(group, key, "close-up", name, self.closeups) for key in ("time", name))
        return self._as_written("time", t, t[()]), self._as_written(name, rows, rows[()])

    @property
    @_sound
    def extremes(self) -> tuple[str, ...]:
        """Names of the histories whose extremes within intervals are in the file."""
        group = self._file.get("extremes", {})
        return tuple(name for name in self.histories if name != "time" and name in group)

    @_sound
    def extreme(self, name: str) -> tuple[Array, Array, Array]:
        r"""Bounds of intervals, shape (n + 1,), and the smallest and largest values of a history within
        them, shape (n, \*row) each; raises KeyError for an unknown name.

        They cover the samples and the method's instants between them; the tables hold the peaks of the
        whole history.
        """
        group = self._file.get("extremes", {})
        t, rows = (self._find(group, key, "extremes", name, self.extremes) for key in ("time", name))
        low, high = np.moveaxis(self._as_written(name, rows, rows[()]), 1, 0)
        return self._as_written("time", t, t[()]), low, high

    @_sound
    def course(self, name: str, jumps: bool = False) -> tuple[Array, Array]:
        r"""A history merged with its close-ups: ascending times, shape (n,), and rows, shape (n, \*row).

        With `jumps`, an instant at which values jump, such as the touch of a contact with a dashpot, stands
        twice: with the values before and after.
        """
        t, rows = self.time, self.history(name)
        if name not in self.closeups:
            return t, rows
        near, near_rows = self.closeup(name)
        t, rows = np.concatenate([t, near]), np.concatenate([rows, near_rows])
        order = np.argsort(t, kind="stable")
        t, rows = t[order], rows[order]
        later = np.diff(t) > 0.0
        kept = np.append(True, later)
        if jumps:
            kept |= np.append(later, True)
        return t[kept], rows[kept]

    @_sound
    def labels(self, name: str) -> tuple[str, ...]:
        """Label of every column of a history (``100 ux`` for node histories)."""
        attrs = self._dataset(name).attrs
        labels = tuple(_plain(v) for v in attrs["labels"])
        if "nodes" not in attrs:
            return labels
        return tuple(f"{node} {label}" for node in attrs["nodes"] for label in labels)

    @_sound
    def history_units(self, name: str) -> tuple[str, ...]:
        """Unit of every column of a history, in the deck's units and the order of `labels`."""
        attrs = self._dataset(name).attrs
        return tuple(_plain(v) for v in attrs["unit"]) * (len(attrs["nodes"]) if "nodes" in attrs else 1)

    @_sound
    def attributes(self, name: str) -> dict[str, list[Any]]:
        """All attributes of a history (``nodes``, ``element``, ``quantity``, ...), each as a list."""
        attrs = self._dataset(name).attrs
        keys = [key for key in attrs if key not in FOR_OTHERS]
        return {key: [_plain(v) for v in np.atleast_1d(attrs[key])] for key in keys}

    def to_pandas(self, table: str) -> pandas.DataFrame:
        """Table as a DataFrame, with its title and the units of its columns in ``attrs`` (extra ``data``).

        Raises
        ------
        NoSuchPartError
            The file has no table of that name.
        ImportError
            pandas is not installed.
        """
        title = TABLES[table].title if table in TABLES else table
        return frame(self.table(table), self.table_units(table), title)

    def to_xarray(self, history: str | None = None) -> xarray.DataArray | xarray.DataTree:
        """Histories with their coordinates (extra ``data``): ``time``, and those of the columns, such as
        ``node``, ``member``, ``component``, ``contact``, ``building``, ``storey``.

        Parameters
        ----------
        history : str, optional
            One of `histories`; all of them if left out, which reads the whole file.

        Returns
        -------
        xarray.DataArray or xarray.DataTree
            One history, or all of them under their paths (``tree["node/u"]``).  Each has the attribute
            ``units``; if components have different units, it lists them (``X: m, R: rad``).

        Raises
        ------
        NoSuchPartError
            The file has no history of that name.
        ImportError
            xarray is not installed.
        """
        if history is not None:
            return self._labelled(history)
        groups: dict[str, dict[str, xarray.DataArray]] = {}
        for name in self.histories:
            if name != "time":
                group, _, leaf = name.rpartition("/")
                groups.setdefault(f"/{group}", {})[leaf] = self._labelled(name)
        attributes = {"title": self.title, "status": self.status, "program_version": self.program_version}
        kit = library("xarray")
        tree: xarray.DataTree = kit.DataTree.from_dict({k: kit.Dataset(data) for k, data in groups.items()})
        tree.attrs = attributes
        return tree

    def _labelled(self, name: str) -> xarray.DataArray:
        stored, axes = self.attributes(name), axes_of(name, self.attributes(name))
        units = stored["unit"]
        if len(set(units)) > 1:
            named = stored.get("quantity") or stored["labels"]
            units = [f"{c}: {u}" for c, u in dict(zip(named, units)).items()]
        attributes = {"units": ", ".join(dict.fromkeys(units))}
        if name in HISTORIES:
            attributes["long_name"] = HISTORIES[name].doc
        return labelled(name, self.time, self.history(name), axes, attributes)

    def __repr__(self) -> str:
        if not self._file:
            return f"<Results {str(self.path)!r}, closed>"
        return "\n".join(self._contents())

    def _contents(self) -> Iterator[str]:
        """Lines of text that list what is in the file."""
        units = self.units
        yield f"<Results {str(self.path)!r}>"
        yield self.title or "(no title)"
        state = [self.status, *([self.message] if self.message else [])]
        yield f"{': '.join(state)}; units {units.force}, {units.length}, {units.time}"
        if "overview" in self.tables:
            said = dict(self.table("overview").tolist())
            yield from (f"{k}: {said[k]}" for k in ("structure", "analyses", "method") if said.get(k))
        rows = ", ".join(f"{name} ({len(self._table(name))})" for name in self.tables)
        yield from textwrap.wrap(f"tables (rows): {rows or 'none'}", 100, subsequent_indent="  ")
        yield "histories:" if self.histories else "histories: none"
        for name in self.histories:
            axes = axes_of(name, self.attributes(name))
            shape = [f"{self._length} instants", *(f"{len(a.labels)} {a.name}" for a in axes)]
            unit = ", ".join(dict.fromkeys(self.history_units(name)))
            yield f"  {name:20} {' x '.join(shape)}" + (f" [{unit}]" if unit else "")

    @_sound
    def restart(self) -> dict[str, Array]:
        """State from which a later run can continue; empty if the file has none."""
        group = self._file.get("restart", {})
        return {
            name: self._as_written(name, group[name], np.asarray(group[name], float))
            for name in group
            if name != IDENTITY
        }

    @_sound
    def identity(self) -> dict[str, str]:
        """Parts of the deck that the state of `restart` depends on, and their values; empty without one."""
        group = self._file.get("restart", {})
        if IDENTITY not in group:
            return {}
        text = self._as_written(IDENTITY, group[IDENTITY], str(group[IDENTITY].asstr()[()]))
        return dict(json.loads(text))

    def _table(self, name: str) -> h5py.Dataset:
        return self._find(self._file["tables"], name, "table", name, self.tables)

    def _find(
        self, group: Mapping[str, Any], key: str, kind: str, name: str, existing: tuple[str, ...]
    ) -> h5py.Dataset:
        """Dataset `key` of a group; raises NoSuchPartError if it is missing."""
        if key not in group:
            raise NoSuchPartError(
                f"no {kind} {name!r} in this file; it has: {', '.join(existing) or 'none'}"
            )
        dataset: h5py.Dataset = group[key]
        if not self._whole and (
            dataset.external or dataset.is_virtual or dataset.file.filename != self._file.filename
        ):
            raise self._damaged(f"{name} is in another file")
        return dataset

    def _as_written(self, name: str, dataset: h5py.Dataset, data: _D, ours: bool = True) -> _D:
        """Return the data of a dataset; raise ResultsError if they do not match its digest."""
        if self._whole:
            return data
        attrs = dataset.attrs
        digest = attrs.get(DIGEST, attrs.get(DIGEST_OF_THE_DAY, "" if ours and self._sealed else None))
        if digest is not None and _plain(digest) != digest_of(attrs, data).hexdigest():
            raise self._damaged(f"{name} is not as it was written")
        return data

    def _damaged(self, why: object) -> ResultsError:
        return ResultsError(f"{self.path}: damaged results file: {why}")

    def _dataset(self, name: str) -> h5py.Dataset:
        return self._find(self._datasets, name, "history", name, self.histories)


def is_hdf5(path: str | Path) -> bool:
    """Whether an HDF5 file of any program exists at the path."""
    return Path(path).is_file() and bool(h5py.is_hdf5(path))


def _plain(value: Any) -> Any:
    """Convert a value of h5py to a str or number of Python."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value.item() if isinstance(value, np.generic) else value
