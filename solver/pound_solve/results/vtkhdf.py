"""The structure and its histories as a VTKHDF file, which ParaView animates.

An UnstructuredGrid of version 2.0 of the format, whose description is part of the documentation of VTK:
points and cells are stored once, values for each step in sequence; the group ``Steps`` holds the offset of
each step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import h5py
import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.results.form import ResultsError
from pound_solve.results.reader import Results
from pound_solve.results.whole_file import whole_hdf

VERSION: Final = (2, 0)
VERTEX, LINE = 1, 3  #: kinds of cells
MOTIONS: Final = (("node/u", "displacement"), ("node/v", "velocity"), ("node/a", "acceleration"))


class Grid(NamedTuple):
    """Points and cells.

    Attributes
    ----------
    points : ndarray, shape (n_points, 3)
        Coordinates [L].
    nodes : sequence of int
        Node of each point.
    elements : sequence of int
        Element of each cell.
    ends : sequence of tuple of int
        Points of each cell: two, or one for an element on the ground or before a wall.
    """

    points: Array
    nodes: Sequence[int]
    elements: Sequence[int]
    ends: Sequence[tuple[int, ...]]


def write_vtkhdf(results: Results, path: str | Path) -> list[int]:
    """Write the stored nodes, the elements between them, and the histories of both.

    Data of points are ``displacement``, ``velocity`` and ``acceleration`` (vectors in the plane, [L],
    [L/T], [L/T^2]), ``rotation`` [rad] and ``node``.  Data of cells are ``element``, the forces of members
    by their component, and those of springs and contacts; NaN where an element has no such value.

    Parameters
    ----------
    results : Results
        Of a run with a history.
    path : str or Path
        The file, by convention ``*.vtkhdf``; one of that name is replaced.

    Returns
    -------
    list of int
        Nodes that were left out with their elements, because the history does not hold them.

    Raises
    ------
    ResultsError
        The results hold no history of nodes, or the file cannot be written.
    """
    if not results.holds("node/u"):
        raise ResultsError(f"{results.path}: no history of nodes, which VTKHDF is made from")
    grid, left_out = _grid(results)
    fixed: dict[str, dict[str, NDArray[Any]]] = {
        "PointData": {"node": np.array(grid.nodes)},
        "CellData": {"element": np.array(grid.elements)},
    }
    moving = {"PointData": _of_points(results), "CellData": _of_cells(results, grid)}
    try:
        with whole_hdf(Path(path)) as file:
            root = file.create_group("VTKHDF")
            root.attrs["Version"] = np.array(VERSION)
            root.attrs["Type"] = np.bytes_("UnstructuredGrid")
            _write_grid(root, grid)
            _write_steps(root, results.time, fixed, moving)
    except OSError as err:
        raise ResultsError(f"{path}: cannot be written: {err.strerror or err}") from err
    return left_out


def _grid(results: Results) -> tuple[Grid, list[int]]:
    """Grid of the stored nodes, and the nodes that are not stored."""
    place = {int(n["node"]): (n["x"], n["y"], 0.0) for n in results.table("nodes")}
    nodes = [int(n) for n in results.attributes("node/u")["nodes"]]
    point = {node: number for number, node in enumerate(nodes)}
    elements, ends = [], []
    for row in results.table("elements"):
        joined = [int(n) for n in (row["i"], row["j"]) if n]
        if point.keys() >= set(joined):
            elements.append(int(row["element"]))
            ends.append(tuple(point[n] for n in joined))
    points = np.array([place[n] for n in nodes], float)
    return Grid(points, nodes, elements, ends), [n for n in place if n not in point]


def _of_points(results: Results) -> dict[str, Array]:
    """Histories of the nodes, shape (nt, n_points, 3) or (nt, n_points)."""
    histories = {}
    for history, name in MOTIONS:
        if history in results.histories:
            values = results.history(history)
            histories[name] = np.concatenate([values[:, :, :2], np.zeros_like(values[:, :, :1])], axis=2)
    histories["rotation"] = results.history("node/u")[:, :, 2]
    return histories


def _of_cells(results: Results, grid: Grid) -> dict[str, Array]:
    """Histories of the elements, shape (nt, n_cells)."""
    histories: dict[str, Array] = {}
    named = {str(e["name"] or e["element"]): int(e["element"]) for e in results.table("elements")}
    cell = {element: number for number, element in enumerate(grid.elements)}
    for history, axis, quantity in (
        ("member/force", "member", "{}"),
        ("spring/force", "spring", "force {}"),
        ("spring/deformation", "spring", "deformation {}"),
        ("contact/force", "contact", "contact force"),
        ("contact/gap", "contact", "contact gap"),
    ):
        if history not in results.histories:
            continue
        values, coordinates = results.history(history), results.coordinates(history)
        components = coordinates.get("component", ("",) * values.shape[1])
        for column, (element, component) in enumerate(zip(coordinates[axis], components)):
            number = cell.get(named.get(element, -1) if axis == "contact" else int(element))
            if number is not None:
                name = quantity.format(component)
                there = histories.setdefault(name, np.full((len(values), len(cell)), np.nan))
                there[:, number] = values[:, column]
    return histories


def _write_grid(root: h5py.Group, grid: Grid) -> None:
    """Write points and cells as one part."""
    offsets = np.cumsum([0, *map(len, grid.ends)])
    parts: dict[str, NDArray[Any]] = {
        "NumberOfPoints": np.array([len(grid.points)]),
        "NumberOfCells": np.array([len(grid.ends)]),
        "NumberOfConnectivityIds": offsets[-1:],
        "Points": grid.points,
        "Connectivity": np.array([n for cell in grid.ends for n in cell], np.int64),
        "Offsets": offsets,
        "Types": np.array([LINE if len(cell) == 2 else VERTEX for cell in grid.ends], np.uint8),
    }
    for name, values in parts.items():
        root.create_dataset(name, data=values)


def _write_steps(
    root: h5py.Group,
    time: Array,
    fixed: Mapping[str, Mapping[str, NDArray[Any]]],
    moving: Mapping[str, Mapping[str, Array]],
) -> None:
    """Write the values of all steps and the offset of each step; `fixed` values are the same in all."""
    steps, n = root.create_group("Steps"), len(time)
    steps.attrs["NSteps"] = n
    steps.create_dataset("Values", data=time)
    steps.create_dataset("NumberOfParts", data=np.ones(n, np.int64))
    for name, shape in (("Part", (n,)), ("Point", (n,)), ("Cell", (n, 1)), ("ConnectivityId", (n, 1))):
        steps.create_dataset(f"{name}Offsets", data=np.zeros(shape, np.int64))
    for kind in ("PointData", "CellData"):
        data, begins = root.create_group(kind), steps.create_group(f"{kind}Offsets")
        for name, values in fixed[kind].items():
            data.create_dataset(name, data=values)
            begins.create_dataset(name, data=np.zeros(n, np.int64))
        for name, history in moving[kind].items():
            data.create_dataset(name, data=history.reshape(-1, *history.shape[2:]))
            begins.create_dataset(name, data=np.arange(n) * history.shape[1])
