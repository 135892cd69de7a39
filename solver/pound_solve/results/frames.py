"""Tables and histories as objects of pandas and xarray (extra ``data``), which are imported on demand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.results.axes import Axis

if TYPE_CHECKING:
    import pandas
    import xarray


def library(name: str) -> Any:
    """Import a package of the extra ``data``.

    Raises
    ------
    ImportError
        It is not installed; the message names the remedy.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as err:
        if err.name != name:
            raise
        raise ImportError(f'this needs {name}: pip install "pound-solve[data]"', name=name) from None


def frame(rows: NDArray[Any], units: Mapping[str, str], title: str) -> pandas.DataFrame:
    """A table: one column for each field of the rows; title and units are in ``attrs``."""
    table: pandas.DataFrame = library("pandas").DataFrame(
        {name: rows[name] for name in rows.dtype.names or ()}
    )
    table.attrs = {"title": title, "units": dict(units)}
    return table


def labelled(
    name: str, time: Array, values: Array, axes: Sequence[Axis], attributes: Mapping[str, Any]
) -> xarray.DataArray:
    """A history with its coordinates, shape (nt, \\*row).

    A row whose places are pairs (member and component) gets an axis for each; missing pairs are NaN.

    Parameters
    ----------
    name : str
        Path of the history.
    time : ndarray, shape (nt,)
        Time axis [T].
    values : ndarray, shape (nt, \\*row)
        The history.
    axes : sequence of Axis
        Of the row.
    attributes : mapping
        ``units`` and further attributes of the array.
    """
    coordinates: dict[str, Any] = {"time": time}
    if len(axes) == 1 and len(axes[0].coordinates) == 2:
        pairs = list(zip(*axes[0].coordinates.values()))
        if len(set(pairs)) == len(pairs):
            values, grid = _dense(values, pairs)
            coordinates |= zip(axes[0].coordinates, grid)
    if len(coordinates) == 1:
        coordinates |= {axis.name: _plain(axis.labels) for axis in axes}
    array: xarray.DataArray = library("xarray").DataArray(
        values, coordinates, tuple(coordinates), name.rpartition("/")[2], dict(attributes)
    )
    return array


def _dense(values: Array, pairs: Sequence[tuple[Any, Any]]) -> tuple[Array, tuple[Any, Any]]:
    """Columns labelled by pairs as an array with two label axes, and the labels of both axes."""
    first, second = (list(dict.fromkeys(labels)) for labels in zip(*pairs))
    grid = np.full((len(values), len(first), len(second)), np.nan)
    grid[:, [first.index(a) for a, _ in pairs], [second.index(b) for _, b in pairs]] = values
    return grid, (_plain(first), _plain(second))


def _plain(labels: Sequence[Any]) -> NDArray[Any]:
    """Labels as an array of numbers or fixed-length texts, which xarray can write to any file."""
    return np.asarray(labels)
