"""The structure of a results file, for drawing: its nodes, what connects them, and its buildings."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.graph import components
from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.beams import Shift, beams
from pound_solve.report.plot.neighbours import Contact, moves, reach
from pound_solve.results import Results
from pound_solve.structure.elements.base import axes as own_axes

SHARE = 0.08  #: largest drawn displacement as a fraction of the structure's size
APART = 0.03  #: distance of neighbours in pictures without displacements, likewise
PLATE = 0.012  #: half the length of the plate at the end of a contact's reach, likewise
WALL = 0.035  #: half the length of a wall, and about its distance, as a fraction of that size
HATCHES = 6
HINGES = "spring/deformation"  #: history with the rotations of hinges
INWARDS = 0.07  #: of a hinge from the end of its member, as a fraction of its length
SLENDER = 0.15  #: least half of a picture's side, as a fraction of that size
NOWHERE = np.zeros(2)
UNDISPLACED: Final = Shift(MappingProxyType({}), MappingProxyType({}))  #: no displacements


class DrawnStructure:
    """Nodes and elements of a results file.

    Parameters
    ----------
    results : Results
    distance : callable or None
        ``distance(gap, size)``: least distance that a contact with that gap is drawn with, in a structure
        of that size [L]; buildings are moved apart for it (see `neighbours`).  None: no building is moved.

    Attributes
    ----------
    true : dict of int to ndarray, shape (2,)
        Nodes [L].
    place : dict of int to ndarray, shape (2,)
        Nodes as they are drawn.
    beams : dict of int to Beam
        Members that bend, by element.
    contacts : list of Contact
    distances : dict of str to float
        Distance that each contact is drawn with, beyond its reach [L]; empty without `distance`.
    low, high : ndarray, shape (2,)
        Corners of the box around all nodes [L].
    size : float
        The longer side of that box, 1 for a single node [L].
    """

    def __init__(self, results: Results, distance: Callable[[float, float], float] | None = None) -> None:
        self.nodes, self.elements = results.table("nodes"), results.table("elements")
        self.units = results.units
        self.true = {int(n["node"]): np.array([n["x"], n["y"]], float) for n in self.nodes}
        self.fixed = {int(n["node"]): str(n["fixed"]) for n in self.nodes}
        self.mass: dict[int, float] = {}
        if "masses" in results.tables:
            self.mass = {int(m["node"]): max(m["mx"], m["my"]) for m in results.table("masses")}
        self.place = self.true
        self.beams = beams(results, self.true)
        self.contacts = list(self._contacts(results))
        self._measure()
        self.distances: dict[str, float] = {}
        if distance is not None:
            self.distances = {c.name: distance(c.gap, self.size) for c in self.contacts}
            of = self.buildings()
            moved = moves(self.contacts, self.true, of, self.distances)
            if any(moved.values()):
                self.place = {n: xy + np.array([moved[of[n]], 0.0]) for n, xy in self.true.items()}
                self._measure()

    def _contacts(self, results: Results) -> Iterator[Contact]:
        """Contacts of the results."""
        if "contact_laws" not in results.tables:
            return  # without directions and gaps there is nothing to draw
        facts = {str(law["contact"]): law for law in results.table("contact_laws")}
        for e in self.elements[self.elements["kind"] == "CONTACT"]:
            name = contact_name(e)
            along = np.array(own_axes(float(facts[name]["angle"]))[0])
            yield Contact(name, int(e["i"]), int(e["j"]), along, float(facts[name]["gap"]))

    def _measure(self) -> None:
        """Set the corners and the size of the box around all nodes."""
        xy = np.array(list(self.place.values()))
        self.low, self.high = xy.min(axis=0), xy.max(axis=0)
        self.size = float(max(self.high - self.low)) or 1.0

    def lines(self, without: Collection[int] = ()) -> list[tuple[int, int]]:
        """Ends of all elements between two nodes but contacts, and `without` some others."""
        return [
            (int(e["i"]), int(e["j"]))
            for e in self.elements
            if e["j"] and e["kind"] != "CONTACT" and int(e["element"]) not in without
        ]

    def path(self, shift: Shift = UNDISPLACED) -> Array:
        """All elements between two nodes but contacts as one line with gaps, displaced: members that bend
        between nodes that move are curved, shape (2, n) [L].
        """
        bent = [b for b in self.beams.values() if b.i in shift.nodes and b.j in shift.nodes]
        curved = {b.element for b in bent}
        straight = [
            (self.place[i] + shift.at(i), self.place[j] + shift.at(j)) for i, j in self.lines(curved)
        ]
        return broken_line([*straight, *(b.line(self.place, shift) for b in bent)])

    def arm(self, contact: Contact) -> Array:
        """Reach of a contact from node I, shape (2,) [L]."""
        return reach(contact, self.place, self.distances.get(contact.name, 0.0))

    def ends(self, contact: Contact, shift: Shift = UNDISPLACED) -> tuple[Array, Array, Array]:
        """Node I, the end of the contact's reach, and node J, displaced; a wall's J is its front."""
        start = self.place[contact.i] + shift.at(contact.i)
        if not contact.j:
            return start, start, self.front(contact)
        return start, start + self.arm(contact), self.place[contact.j] + shift.at(contact.j)

    def draw(self, axes: Any, shift: Shift = UNDISPLACED, **look: Any) -> Any:
        """Draw the members, displaced; return the line."""
        look.setdefault("linestyle", "-")
        return axes.plot(*self.path(shift=shift), **look)[0]

    def front(self, wall: Contact) -> Array:
        """Point of a wall that node I meets."""
        return np.asarray(self.place[wall.i] + self.distances.get(wall.name, WALL * self.size) * wall.along)

    def draw_contacts(self, axes: Any, shift: Shift = UNDISPLACED) -> None:
        """Draw the contacts, displaced: the reach of node I with a plate at its end, a thin line over the
        gap, and a plate at node J, or a wall.
        """
        look: dict[str, Any] = {"color": style.RED, "linestyle": "-", "zorder": 5}  # above the masses
        for c in self.contacts:
            start, tip, end = self.ends(c, shift)
            if not c.j:
                axes.plot(*zip(start, end), **look, linewidth=0.8)
                draw_wall(axes, end, c.along, WALL * self.size)
                continue
            plate = PLATE * self.size * np.array([-c.along[1], c.along[0]])
            for line, width in (((start, tip), 1.5), ((tip, end), 0.8)):
                axes.plot(*zip(*line), **look, linewidth=width)
            for point in (tip, end):
                axes.plot(*zip(point - plate, point + plate), **look, linewidth=1.5)

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
        lengths = [np.hypot(*(self.place[j] - self.place[i])) for i, j in self.lines()]
        apart = width * float(np.quantile(lengths, 0.25)) / self.size if lengths else width
        largest = min(8.0, 0.7 * apart)
        for node, mass in self.mass.items():
            if heaviest and mass:
                size = largest * (0.25 + 0.75 * (mass / heaviest) ** 0.5)
                axes.plot(*self.place[node], "o", color="0.2", markersize=size, zorder=4)

    def view(self, room: float = 0.06) -> tuple[Array, Array]:
        """Corners of what a picture shows: `room` around the structure as a fraction of its size; a slender
        structure gets more.
        """
        half = np.maximum(0.5 * (self.high - self.low) + room * self.size, SLENDER * self.size)
        middle = 0.5 * (self.low + self.high)
        return middle - half, middle + half

    def frame(self, axes: Any, room: float = 0.06) -> None:
        """Set equal scales and limits with `room` around the structure, a fraction of its size."""
        (x0, y0), (x1, y1) = self.view(room)
        axes.set_xlim(x0, x1)
        axes.set_ylim(y0, y1)
        axes.set_aspect("equal", adjustable="box")
        style.grid(axes, f"X [{self.units.length}]", f"Y [{self.units.length}]")
        for axis, span in (("x", x1 - x0), ("y", y1 - y0)):
            axes.locator_params(axis=axis, nbins=max(2, min(8, round(8 * span / max(x1 - x0, y1 - y0)))))
        if self.place is not self.true:
            self._name_places(axes, 0.08 * (x1 - x0))

    def _name_places(self, axes: Any, least: float) -> None:
        """Put the true places of supports on the X axis, which no one scale fits; the ones nearer than
        `least` to the one before are left out.
        """
        ticks: list[tuple[float, float]] = []
        for x, true in sorted(
            {(float(self.place[n][0]), float(self.true[n][0])) for n in self.place if self.fixed[n]}
        ):
            if not ticks or x - ticks[-1][0] > least:
                ticks.append((x, true))
        axes.set_xticks([x for x, _ in ticks], [f"{true:g}" for _, true in ticks])

    def component(self, element: int, component: str) -> Array:
        """Place at which a spring or hinge is drawn [L]: near its end of the member, or in the middle."""
        (e,) = self.elements[self.elements["element"] == element]
        i = self.place[int(e["i"])]
        if not e["j"]:
            return i
        j = self.place[int(e["j"])]
        fraction = {"I": INWARDS, "J": 1.0 - INWARDS}.get(component.split()[-1], 0.5)
        at: Array = i + fraction * (j - i)
        return at

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
        pairs = self.lines()
        masters = {int(n["node"]): str(n["master"]).split(",") for n in self.nodes}
        none = ("", "0")  # the second in files of format 1
        pairs += [(node, int(m)) for node, several in masters.items() for m in several if m not in none]
        groups = [np.array([at[i], at[j]]) for i, j in pairs]
        joined = components(len(numbers), groups=groups)
        return dict(zip(numbers, joined.tolist()))

    def feet(self, lowest: int, base: float) -> list[int]:
        """Nodes fixed along X at the level `base` [L] of the building that the node `lowest` belongs to."""
        of = self.buildings()
        supported = [n for n in self.place if of[n] == of[lowest] and "X" in self.fixed[n]]
        return [n for n in supported if abs(self.place[n][1] - base) <= 1e-3 * self.size]


def contact_name(element: Any) -> str:
    """Name of a contact in tables and histories."""
    return str(element["name"] or element["element"])


def apart(fraction: float = APART) -> Callable[[float, float], float]:
    """Distance of neighbours as a fraction of the structure's size, for pictures without displacements."""
    return lambda gap, size: fraction * size


class Displacements(NamedTuple):
    """The structure of a picture of displacements, and the displacements as they are drawn.

    Attributes
    ----------
    structure : DrawnStructure
        Gaps are magnified as displacements are.
    nodes : list of int
        Recorded nodes.
    drawn : ndarray, shape (nt, n_nodes, 3)
        Their displacements along X and Y [L] and rotations, times `factor`.
    hinges : dict of (int, str) to int
        Element and end, and the column in ``spring/deformation``, of the hinges of members.
    opened : ndarray, shape (nt, n_springs)
        Rotations of the hinges in these columns, times `factor`.
    factor : float
        Magnification: the largest displacement is drawn as `SHARE` of the structure's size.
    row : int
        Row of the largest displacement.
    largest : float
        Its magnitude [L].
    """

    structure: DrawnStructure
    nodes: list[int]
    drawn: Array
    hinges: dict[tuple[int, str], int]
    opened: Array
    factor: float
    row: int
    largest: float

    def shift(self, row: int) -> Shift:
        """Drawn displacements in a row."""
        return self._shift(self.drawn[row], self.opened[row])

    def magnified(self, u: Array, deformation: Array) -> Shift:
        """Drawn displacements at an instant, from rows of ``node/u`` and of ``spring/deformation``."""
        return self._shift(self.factor * u, self.factor * deformation)

    def _shift(self, drawn: Array, opened: Array) -> Shift:
        return Shift(
            dict(zip(self.nodes, drawn)), {hinge: float(opened[k]) for hinge, k in self.hinges.items()}
        )


def displacements(results: Results, rows: slice = slice(None)) -> Displacements:
    """Magnify the displacements in some rows of the history, and the gaps with them."""
    nodes = [int(n) for n in results.attributes("node/u")["nodes"]]
    u = results.history("node/u")[rows]
    sizes = np.hypot(u[..., 0], u[..., 1]).max(axis=1)
    row = int(np.argmax(sizes))
    largest = float(sizes[row])
    factor = SHARE * DrawnStructure(results).size / largest if largest > 0.0 else 1.0
    structure = DrawnStructure(results, lambda gap, size: max(factor * gap, 0.0))
    hinges, opened = hinge_columns(results), np.zeros((len(u), 0))
    if hinges:
        opened = factor * results.history(HINGES)[rows]
    return Displacements(structure, nodes, factor * u, hinges, opened, factor, row, largest)


def mode_shift(shape: NDArray[Any], size: float) -> Shift:
    """Displacements of a mode out of its rows of `mode_shapes`, the largest as `SHARE` of `size`."""
    largest = float(np.hypot(shape["x"], shape["y"]).max())
    factor = SHARE * size / largest if largest else 0.0
    moved = factor * np.column_stack([shape["x"], shape["y"], shape["r"]])
    return Shift(dict(zip(shape["node"].tolist(), moved)), {})


def hinge_columns(results: Results) -> dict[tuple[int, str], int]:
    """Columns of the rotations of the hinges of members, by element and end."""
    if HINGES not in results.histories:
        return {}
    names = results.attributes(HINGES)
    ends = {"hinge I": "I", "hinge J": "J"}  # those of a BEAM_COLUMN are rows of springs
    return {
        (int(element), ends[component]): k
        for k, (element, component) in enumerate(zip(names["element"], names["quantity"]))
        if component in ends
    }


def broken_line(pieces: Iterable[Sequence[Array] | Array]) -> Array:
    """Pieces, each of points of shape (2,), as one line with gaps (NaN), shape (2, n)."""
    gap = NOWHERE * np.nan
    return np.vstack([np.zeros((0, 2)), *(point for piece in pieces for point in (*piece, gap))]).T


def draw_wall(axes: Any, front: Array, across: Array, half: float) -> None:
    """Draw a wall at the point `front`, met in the direction `across`: `half` as long on each side, hatched
    behind.
    """
    along = np.array([-across[1], across[0]])
    ends = front + half * np.array([along, -along])
    look = {"color": style.RED, "linestyle": "-"}
    axes.plot(*ends.T, **look, linewidth=1.4)
    for fraction in np.linspace(0.0, 1.0, HATCHES):
        foot = ends[0] + fraction * (ends[1] - ends[0])
        back = foot + 0.4 * half * (across + along)
        axes.plot(*zip(foot, back), **look, linewidth=0.7)
