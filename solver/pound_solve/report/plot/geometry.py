"""The structure of a results file, for drawing: its nodes, what connects them, and its buildings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from pound_solve.numerics.graph import components
from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.results import Results
from pound_solve.structure.elements.base import axes as own_axes

SHARE = 0.08  #: largest drawn displacement as a share of the structure's size
WALL = 0.035  #: half the length of a wall, and about its distance, as a share of that size
HATCHES = 6
SLENDER = 0.15  #: least half of a picture's side, as a share of that size
NOWHERE = np.zeros(2)
STILL: Mapping[int, Array] = MappingProxyType({})  #: no displacements


class DrawnStructure:
    """Nodes and elements of a results file.

    Parameters
    ----------
    results : Results

    Attributes
    ----------
    place : dict of int to ndarray, shape (2,)
        Nodes [L].
    low, high : ndarray, shape (2,)
        Corners of the box around all nodes [L].
    size : float
        The longer side of that box, 1 for a single node [L].
    """

    def __init__(self, results: Results) -> None:
        self.nodes, self.elements = results.table("nodes"), results.table("elements")
        self.units = results.units
        self.place = {int(n["node"]): np.array([n["x"], n["y"]], float) for n in self.nodes}
        self.fixed = {int(n["node"]): str(n["fixed"]) for n in self.nodes}
        self.mass: dict[int, float] = {}
        if "masses" in results.tables:
            self.mass = {int(m["node"]): max(m["mx"], m["my"]) for m in results.table("masses")}
        self.angles: dict[str, float] = {}
        if "contact_laws" in results.tables:
            self.angles = dict(results.table("contact_laws")[["contact", "angle"]].tolist())
        xy = np.array(list(self.place.values()))
        self.low, self.high = xy.min(axis=0), xy.max(axis=0)
        self.size = float(max(self.high - self.low)) or 1.0

    def lines(self, contacts: bool) -> list[tuple[int, int]]:
        """Ends of all elements between two nodes: contacts, or the others."""
        return [
            (int(e["i"]), int(e["j"]))
            for e in self.elements
            if e["j"] and (e["kind"] == "CONTACT") == contacts
        ]

    def path(self, contacts: bool = False, shift: Mapping[int, Array] = STILL) -> Array:
        """All elements between two nodes as one line with gaps (NaN), shape (2, 3 n) [L]."""
        points = [
            (self.place[i] + shift.get(i, NOWHERE), self.place[j] + shift.get(j, NOWHERE), NOWHERE * np.nan)
            for i, j in self.lines(contacts)
        ]
        return np.array(points).reshape(-1, 2).T

    def draw(self, axes: Any, shift: Mapping[int, Array] = STILL, **look: Any) -> Any:
        """Draw the members, displaced by `shift` of every node; return the line."""
        look.setdefault("linestyle", "-")
        return axes.plot(*self.path(shift=shift), **look)[0]

    def draw_contacts(self, axes: Any, shift: Mapping[int, Array] = STILL) -> None:
        """Draw the contacts between two nodes, displaced."""
        look: dict[str, Any] = {"color": style.RED, "linewidth": 1.5, "linestyle": "-", "marker": "|"}
        look |= {"markersize": 8, "zorder": 5}  # above the masses
        if self.lines(contacts=True):
            axes.plot(*self.path(contacts=True, shift=shift), **look)

    def draw_supports(self, axes: Any) -> None:
        """Draw a triangle at each node fixed along X and Y, or along one of them at the lowest level."""
        held = [
            xy for n, xy in self.place.items()
            if (both := {"X", "Y"} & set(self.fixed[n])) and (len(both) == 2 or xy[1] == self.low[1])
        ]  # fmt: skip  # floors of shear buildings may slide: no mark
        if held:
            look = {"marker": "^", "linestyle": "", "color": style.GREEN, "markersize": 6}
            axes.plot(*np.transpose(held), **look, clip_on=False, zorder=3)

    def draw_masses(self, axes: Any, width: float) -> None:
        """Draw a dot at every mass, larger for larger masses, on axes of about `width` points."""
        heaviest = max(self.mass.values(), default=0.0)
        lengths = [np.hypot(*(self.place[j] - self.place[i])) for i, j in self.lines(contacts=False)]
        apart = width * float(np.quantile(lengths, 0.25)) / self.size if lengths else width
        largest = min(8.0, 0.7 * apart)
        for node, mass in self.mass.items():
            if heaviest and mass:
                size = largest * (0.25 + 0.75 * (mass / heaviest) ** 0.5)
                axes.plot(*self.place[node], "o", color="0.2", markersize=size, zorder=4)

    def view(self, room: float = 0.06) -> tuple[Array, Array]:
        """Corners of what a picture shows: `room` around the structure as a share of its size; a slender
        structure gets more.
        """
        half = np.maximum(0.5 * (self.high - self.low) + room * self.size, SLENDER * self.size)
        middle = 0.5 * (self.low + self.high)
        return middle - half, middle + half

    def frame(self, axes: Any, room: float = 0.06) -> None:
        """Set equal scales and limits with `room` around the structure, a share of its size."""
        (x0, y0), (x1, y1) = self.view(room)
        axes.set_xlim(x0, x1)
        axes.set_ylim(y0, y1)
        axes.set_aspect("equal", adjustable="box")
        style.grid(axes, f"X [{self.units.length}]", f"Y [{self.units.length}]")
        for axis, span in (("x", x1 - x0), ("y", y1 - y0)):
            axes.locator_params(axis=axis, nbins=max(2, min(8, round(8 * span / max(x1 - x0, y1 - y0)))))

    def shape(self) -> tuple[float, float]:
        """Width and height of a picture of it, in inches."""
        low, high = self.view()
        width, height = high - low
        scale = min(9.0 / width, 7.0 / height)
        return max(4.0, float(width * scale)), max(2.6, float(height * scale))

    def buildings(self) -> dict[int, int]:
        """Number of the building of every node, from 0: a part connected other than by contacts."""
        numbers = sorted(self.place)
        at = {n: k for k, n in enumerate(numbers)}
        pairs = [*self.lines(contacts=False)]
        pairs += [(int(n["node"]), int(n["master"])) for n in self.nodes if n["master"]]
        joined = components(len(numbers), groups=[np.array([at[i], at[j]]) for i, j in pairs])
        return dict(zip(numbers, joined.tolist()))

    def feet(self, lowest: int, base: float) -> list[int]:
        """Nodes fixed along X at the level `base` [L] of the building that the node `lowest` belongs to."""
        of = self.buildings()
        supported = [n for n in self.place if of[n] == of[lowest] and "X" in self.fixed[n]]
        return [n for n in supported if abs(self.place[n][1] - base) <= 1e-3 * self.size]


def contact_name(element: Any) -> str:
    """Name of a contact in tables and histories."""
    return str(element["name"] or element["element"])


def largest(shifts: Array) -> tuple[int, float]:
    """Row of the largest displacement in an array of shape (nt, n_nodes, 2), and its magnitude."""
    size = np.hypot(shifts[..., 0], shifts[..., 1]).max(axis=1)
    at = int(np.argmax(size))
    return at, float(size[at])


def displacements(results: Results, rows: slice | int = slice(None)) -> tuple[list[int], Array]:
    """Recorded nodes and their displacements along x and y, shape (nt, n_nodes, 2) [L]."""
    numbers = [int(n) for n in results.attributes("node/u")["nodes"]]
    return numbers, results.history("node/u")[rows, :, :2]


def shifts(numbers: Iterable[int], moved: Array) -> dict[int, Array]:
    """Displacements by node number."""
    return dict(zip(numbers, moved))


def draw_wall(axes: Any, node: Array, angle: float, half: float) -> Array:
    """Draw the wall that a node meets in a direction [deg], `half` as long on each side, hatched behind;
    return its highest point.
    """
    across, along = np.array(own_axes(angle))
    ends = node + half * across + half * np.array([along, -along])
    look = {"color": style.RED, "linestyle": "-"}
    axes.plot(*zip(node, node + half * across), **look, linewidth=2.0)
    axes.plot(*ends.T, **look, linewidth=1.4)
    for share in np.linspace(0.0, 1.0, HATCHES):
        front = ends[0] + share * (ends[1] - ends[0])
        back = front + 0.4 * half * (across + along)
        axes.plot(*zip(front, back), **look, linewidth=0.7)
    return max(ends, key=lambda p: p[1])
