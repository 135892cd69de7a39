"""The file of a sweep: runs by quantities, with dimension scales, which xarray opens directly.

Every dataset has ``run`` as its first dimension; a quantity with labels has the axis of its labels as its
second.  Missing values are NaN or empty texts.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from pound_solve.results.form import ResultsError, storable
from pound_solve.results.whole_file import whole, whole_hdf

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

FILETYPE: Final = "pound-solve sweep"
FORMAT_VERSION: Final = (1, 0)  #: major: old readers fail; minor: something was added
#: status of an ended run: with all results, with those up to its stop, or with none
DONE, STOPPED, FAILED = ENDS = ("done", "stopped", "failed")
RUN: Final = "run"  #: the first dimension
ROW: Final = "row"  #: first dimension of a table derived from a sweep
HISTORIES: Final = "histories"
ORDER: Final = "variables"  #: attribute with their names in order
#: variables that differ between two sweeps of a study
OF_THE_DAY: Final = ("cpu_seconds", "solve_seconds")
_TEXT: Final = h5py.string_dtype()
_DAMAGE: Final = (OSError, RuntimeError, KeyError, ValueError, TypeError)


@dataclass(frozen=True)
class Variable:
    """One variable of a sweep.

    Attributes
    ----------
    values : ndarray, shape (n_runs,) or (n_runs, n_labels)
        Numbers, or texts as objects.
    axis : str
        Name of the second dimension; empty for none.
    unit, doc : str
    """

    values: NDArray[Any]
    axis: str = ""
    unit: str = ""
    doc: str = ""


@dataclass(frozen=True)
class Sweep:
    """Results of all runs of a sweep.

    Attributes
    ----------
    variables : mapping of str to Variable
        In the order of the file.
    labels : mapping of str to tuple of str
        Labels of every axis.
    about : mapping of str to str
        Study, version of the program, units.
    path : Path or None
        The file that it was read from.
    """

    variables: Mapping[str, Variable]
    labels: Mapping[str, tuple[str, ...]]
    about: Mapping[str, str] = field(default_factory=dict)
    path: Path | None = None

    def __len__(self) -> int:
        return len(self.variables[RUN].values)

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Values of a variable, shape (n_runs,) or (n_runs, n_labels)."""
        return self.variables[name].values

    @staticmethod
    def is_of(path: str | Path) -> bool:
        """Whether a file holds a sweep, by the file type that its attributes give."""
        if not Path(path).is_file():  # a pipe would wait
            return False
        try:
            with h5py.File(path, "r") as file:
                return bool(file.attrs.get("filetype") == FILETYPE)
        except _DAMAGE:
            return False

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Read a file.

        Raises
        ------
        ResultsError
            There is no such file, or it is not one of a sweep.
        """
        if not Path(path).is_file():
            raise ResultsError(f"{path}: no such file")
        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("filetype") != FILETYPE:
                    raise ResultsError(f"{path}: an HDF5 file, but not one of a sweep")
                if int(file.attrs["format_version"][0]) > FORMAT_VERSION[0]:
                    raise ResultsError(f"{path}: written by a later version of the program")
                return cls(*_read(file), Path(path))
        except _DAMAGE as err:
            raise ResultsError(f"{path}: damaged file: {err}") from err

    def columns(self) -> Iterator[tuple[str, Sequence[Any]]]:
        """Yield name and values of every column of a flat table; a labelled quantity has ``name label``."""
        for name, variable in self.variables.items():
            if not variable.axis:
                yield name, variable.values.tolist()
            else:
                for label, values in zip(self.labels[variable.axis], variable.values.T):
                    yield f"{name} {label}", values.tolist()

    def to_pandas(self) -> DataFrame:
        """DataFrame with a row for each run and a column for each number; needs the extra ``data``."""
        from pandas import DataFrame

        return DataFrame(dict(self.columns())).set_index(RUN)

    def to_xarray(self) -> Dataset:
        """Dataset of the variables with their dimensions and labels; needs the extra ``data``."""
        from xarray import Dataset

        data = {
            name: (
                (RUN, variable.axis) if variable.axis else RUN,
                variable.values,
                {"units": variable.unit, "long_name": variable.doc},
            )
            for name, variable in self.variables.items()
            if name != RUN
        }
        coords = {RUN: self[RUN], **{axis: list(labels) for axis, labels in self.labels.items()}}
        return Dataset(data, coords, dict(self.about))

    def history(self, run: int, name: str) -> tuple[NDArray[Any], NDArray[Any], tuple[str, ...]]:
        """A history that is stored in the sweep: times [T], rows, labels of the columns.

        Parameters
        ----------
        run : int
            Number of the run, from 1.
        name : str
            As in a results file, ``storey/drift``.

        Raises
        ------
        ResultsError
            The file does not hold it.
        """
        try:
            with h5py.File(str(self.path), "r") as file:
                group = file[f"{HISTORIES}/{run}"]
                dataset = group[name.replace("/", "_")]
                labels = tuple(str(_plain(v)) for v in dataset.attrs.get("labels", ()))
                return group["time"][:], dataset[:], labels
        except _DAMAGE as err:
            raise ResultsError(f"{self.path}: no history {name} of run {run}") from err


def write(
    sweep: Sweep, path: Path, histories: Iterable[tuple[int, Mapping[str, NDArray[Any]]]] = ()
) -> None:
    """Write a sweep atomically.

    Parameters
    ----------
    sweep : Sweep
    path : Path
        It gets the ending .h5, and .csv for the table.
    histories : iterable of (number, histories)
        Of runs that have kept some: times, rows, labels and units.

    Raises
    ------
    OSError
        The files cannot be written.
    """

    def fill(file: h5py.File) -> None:
        _write(file, sweep)
        for number, kept in histories:
            _write_histories(file, number, kept)

    _put(path, fill, dict(sweep.columns()))


def write_table(path: Path, columns: Mapping[str, Variable], about: Mapping[str, str]) -> None:
    """Write a table derived from a sweep, as HDF5 with dimension scales and as CSV; see `write`.

    Parameters
    ----------
    path : Path
    columns : mapping of str to Variable
        Without a second dimension.
    about : mapping of str to str
    """

    def fill(file: h5py.File) -> None:
        file.attrs.update({key: storable(value) for key, value in about.items()})
        count = len(next(iter(columns.values())).values) if columns else 0
        scale = _dataset(file, ROW, Variable(np.arange(1, count + 1)))
        scale.make_scale(ROW)
        for name, variable in columns.items():
            _dataset(file, name, variable).dims[0].attach_scale(scale)

    _put(path, fill, {name: variable.values.tolist() for name, variable in columns.items()})


def _put(path: Path, fill: Callable[[h5py.File], None], columns: Mapping[str, Sequence[Any]]) -> None:
    """Write a file, and its columns as CSV beside it, atomically."""
    table = path.with_suffix(".csv")
    with whole(table) as text, whole_hdf(path) as file:
        fill(file)
        with text.open("w", newline="", encoding="utf-8") as lines:
            writer = csv.writer(lines)
            writer.writerow(columns)
            writer.writerows([_cell(v) for v in row] for row in zip(*columns.values()))


def _cell(value: object) -> object:
    """Value as a cell of the CSV table; empty for NaN."""
    if isinstance(value, float):
        return "" if math.isnan(value) else repr(value)
    return value


def _write(file: h5py.File, sweep: Sweep) -> None:
    """Write the variables and their axes into a file."""
    file.attrs.update({"filetype": FILETYPE, "format_version": np.array(FORMAT_VERSION)})
    file.attrs.update({key: storable(value) for key, value in sweep.about.items()})
    file.attrs[ORDER] = list(sweep.variables)
    scales = {RUN: _dataset(file, RUN, sweep.variables[RUN])}
    scales[RUN].make_scale(RUN)
    for axis, labels in sweep.labels.items():
        scales[axis] = _dataset(file, axis, Variable(np.array(labels, object)))
        scales[axis].make_scale(axis)
    for name, variable in sweep.variables.items():
        if name != RUN:
            dataset = _dataset(file, name, variable)
            for at, axis in enumerate((RUN, variable.axis) if variable.axis else (RUN,)):
                dataset.dims[at].attach_scale(scales[axis])


def _dataset(file: h5py.Group, name: str, variable: Variable) -> h5py.Dataset:
    """Create the dataset of a variable with its unit and its meaning."""
    texts = variable.values.dtype.kind == "O"
    data = np.array([storable(v) for v in variable.values.tolist()], object) if texts else variable.values
    dataset = file.create_dataset(name, data=data, dtype=_TEXT if texts else None)
    for key, value in (("units", variable.unit), ("long_name", variable.doc)):
        if value:
            dataset.attrs[key] = value
    return dataset


def _write_histories(file: h5py.File, number: int, kept: Mapping[str, NDArray[Any]]) -> None:
    """Write the histories of one run into a group."""
    group = file.create_group(f"{HISTORIES}/{number}")
    time = group.create_dataset("time", data=kept["time"])
    time.make_scale("time")
    for name, rows in kept.items():
        if name == "time" or "|" in name:
            continue
        place = name.replace("/", "_")
        dataset = group.create_dataset(
            place, data=rows, chunks=rows.shape, compression="gzip", compression_opts=1
        )
        dataset.dims[0].attach_scale(time)
        for key in ("labels", "nodes", "unit"):
            if f"{name}|{key}" in kept:
                texts = [storable(str(v)) for v in kept[f"{name}|{key}"]]
                dataset.attrs.create(key, np.array(texts, object), dtype=_TEXT)


def _read(file: h5py.File) -> tuple[dict[str, Variable], dict[str, tuple[str, ...]], dict[str, str]]:
    """Read the variables of a file, the labels of the axes, and its other attributes."""
    variables, axes = dict[str, Variable](), dict[str, None]()
    for name in map(_plain, file.attrs[ORDER]):
        item = file[name]
        plain = [_plain(v) for v in item[:]] if item.dtype.kind == "O" else item[:]
        values = np.array(plain, object) if item.dtype.kind == "O" else item[:]
        axis = _plain(item.dims[1].keys()[0]) if len(item.shape) > 1 else ""
        attributes = (str(_plain(item.attrs.get(key, ""))) for key in ("units", "long_name"))
        variables[name] = Variable(values, axis, *attributes)
        axes |= {axis: None} if axis else {}
    labels = {axis: tuple(str(_plain(v)) for v in file[axis][:]) for axis in axes}
    known = ("filetype", "format_version", ORDER)
    return variables, labels, {k: str(_plain(v)) for k, v in file.attrs.items() if k not in known}


def _plain(value: Any) -> Any:
    """Convert a text of h5py to a str."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value
