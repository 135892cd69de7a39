r"""PUSHOVER: a load pattern that grows from the static state until a displacement or a load factor is
reached, or that takes the control displacement from one target to the next.

The pattern has forces along one direction,

.. math:: p_i = m_i \psi_i \Big/ \sum_j m_j \psi_j, \qquad \psi = 1,\quad \psi = h \quad\text{or}\quad
          \psi = \phi

(UNIFORM, TRIANGULAR with the height above the lowest support, MODE with the mode whose effective mass along
the direction is largest), so that the load factor is the resulting base shear.  Alternatively, it consists
of the FORCES of the card, or repeats the LOADS. The path is traced from event to event (see
`path_following`).  Displacement control can continue beyond the largest base shear; load control ends
there.

With ADAPTIVE=YES the pattern is that of the present mode.  After every change of a law and at every
station, :math:`dp = d\lambda\, p(\phi)` with the mode :math:`\phi` of the tangent stiffness; the forces
that already act remain (force-based adaptive pushover with incremental updating, Antoniou and Pinho 2004,
in its form with one mode and no spectrum).  If the tangent stiffness loses its resistance in some
direction, no such mode exists and the last pattern is kept.

With several targets the control displacement turns at each of them, and every law unloads by its own
branches.  The part of the path from one target to the next is a leg.

With BUILDING one building of several is pushed: the pattern has forces only on its nodes, and the base
shear is that of its supports and of its elements that end at the ground.  Its neighbours resist through
contacts.  With NEIGHBOURS=NO they are removed, and the path starts from the static state of the building
alone, as for a deck with only this building.

References
----------
Antoniou S, Pinho R (2004), Advantages and limitations of adaptive and non-adaptive force-based pushover
procedures, J. Earthquake Engng 8(4): 497-522.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from itertools import groupby
from operator import attrgetter

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.analyses import static
from pound_solve.analyses.equilibrium import SUM_ROUNDING, SupportReactions
from pound_solve.analyses.load_pattern import EquivalentSystem, LoadPattern
from pound_solve.analyses.path_following import Change, EquilibriumPath, Mark, PathEvent
from pound_solve.analyses.static import StaticState
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.check import Check, Subject, at_most
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import building, buildings
from pound_solve.structure.extract_building import extract_building
from pound_solve.structure.structure import Structure


@dataclass(frozen=True)
class CapacityPoint:
    """Point of the capacity curve: control displacement [L], base shear [F], load factor, changes, leg."""

    displacement: float
    shear: float
    factor: float
    changes: int
    leg: int


@dataclass
class PushoverResult:
    """Results of a pushover.

    Attributes
    ----------
    card : Card
    structure : Structure
        The pushed structure: the whole deck, or one building.
    number : int
        Of the card among those of the deck, from 1.
    equivalent : EquivalentSystem or None
        The oscillator that stands for the one building that is pushed; None for several, for a part
        of the base shear, and without mass.
    curve : list of CapacityPoint
        At the start of every leg, at the stations, and where laws changed.
    ladder : list of (CapacityPoint, Change)
        Every change of a law.
    first, last : ndarray, shape (n_free,)
        Pattern at the start and at the end [F] or [-].
    end : str
        Reason for the end.
    failed : InstabilityError or None
        Set if it ended early.
    unbalanced : float
        Largest unbalanced force at the end, as a fraction of the largest acting force.
    """

    card: Card
    structure: Structure
    number: int = 1
    equivalent: EquivalentSystem | None = None
    curve: list[CapacityPoint] = field(default_factory=list)
    ladder: list[tuple[CapacityPoint, Change]] = field(default_factory=list)
    first: Array = field(default_factory=lambda: np.zeros(0))
    last: Array = field(default_factory=lambda: np.zeros(0))
    end: str = ""
    failed: InstabilityError | None = None
    unbalanced: float = 0.0

    @property
    def check(self) -> Check:
        """Return the self-check of force equilibrium."""
        about = f"pushover {self.number}, force out of balance over the largest"
        return at_most(Subject.EQUILIBRIUM, about, self.unbalanced, SUM_ROUNDING, "forces do not balance")

    def add(self, point: CapacityPoint) -> None:
        """Add a point to the curve; it replaces the last one of its leg at one displacement and factor."""
        if self.curve and replace(self.curve[-1], shear=point.shear, changes=point.changes) == point:
            self.curve.pop()
        self.curve.append(point)

    @property
    def turns(self) -> bool:
        """Whether the card has several targets."""
        return len(targets(self.card)) > 1

    def points_of_legs(self) -> list[list[CapacityPoint]]:
        """Return the points of every leg."""
        return [list(points) for _, points in groupby(self.curve, key=attrgetter("leg"))]


def push(structure: Structure, state: StaticState, card: Card, number: int = 1) -> PushoverResult:
    """Push a structure from its static state.

    Parameters
    ----------
    structure : Structure
        With the geometric stiffness of that state.
    state : StaticState
    card : Card
        Of `SPEC`.
    number : int
        Of the card among those of the deck.

    Raises
    ------
    InstabilityError
        The path has no first step.
    """
    nodes = pushed_nodes(structure, card)
    if nodes is not None and card["NEIGHBOURS"] == "NO":
        structure = extract_building(structure, nodes)
        state = static.solve(structure)
        structure = structure.stressed(state.axial).displaced(state.u)
    course = _Course(structure, state, card, nodes)
    result, result.number = course.result, number
    try:
        for leg, target in enumerate(targets(card), 1):
            course.go(leg, target)
    except InstabilityError as err:
        # under load control this is the capacity; under displacement control the path must continue
        capacity = card["CONTROL"] == "FORCE" and err.code == "A501"
        result.end, result.failed = str(err), None if capacity else err
        result.add(course.point())
        result.ladder = _once(result.ladder)
    noise = 1e-13 * max(abs(p.displacement) for p in result.curve)  # rounding error of zero
    result.curve = [
        p if abs(p.displacement) > noise else replace(p, displacement=0.0) for p in result.curve
    ]
    result.last, result.unbalanced = course.path.load, course.path.unbalanced()
    return result


def targets(card: Card) -> list[float | None]:
    """Return the displacements to which the control node goes in turn [L]; None for a FACTOR alone."""
    if card["CYCLES"]:
        return [side * x for x in card["TARGET"] for side in (1.0, -1.0) * card["CYCLES"]]
    return list(card["TARGET"] or (None,))


class _Course:
    """A pushover under way.

    Parameters
    ----------
    structure : Structure
    state : StaticState
    card : Card
    nodes : collection of int, or None
        Of the pushed building; None: of all.

    Attributes
    ----------
    path : EquilibriumPath
    result : PushoverResult
    """

    def __init__(
        self, structure: Structure, state: StaticState, card: Card, nodes: Collection[int] | None
    ) -> None:
        n, by_load = structure.n_free, card["CONTROL"] == "FORCE"
        self.card, self.control = card, control_row(structure, card)
        start, (first, *_) = float(self.control @ state.u), targets(card)
        if first == start:
            raise InstabilityError(f"the control node stands at its target {start:g} already", "A505")
        self.pattern = LoadPattern(structure, card, nodes)
        self.path = EquilibriumPath(
            structure,
            state.u,
            state.states,
            structure.loads[:n],
            np.zeros(n),
            None if by_load else self.control,
        )
        self.path.load = self.pattern.follow(self.path)
        if not self.path.load.any():
            raise InstabilityError("no mode of the static state moves the nodes that are pushed", "A505")
        self.path.turn(self._sense(first))
        self.reactions = SupportReactions(structure, state.axial, nodes)
        self.leg = 1
        self.result = PushoverResult(card, structure, first=self.path.load)
        if of_one_building(structure, card) and card["BASE"] is None:
            self.result.equivalent = self.pattern.equivalent(self.control, self.path)

    def point(self) -> CapacityPoint:
        """Return the present point of the capacity curve."""
        path, along = self.path, "XY".index(self.card["DIRECTION"])
        shear = self.reactions.shear(path.u, path.states, along, self.card["BASE"])
        return CapacityPoint(float(self.control @ path.u), shear, path.factor, path.changes, self.leg)

    def go(self, leg: int, target: float | None) -> None:
        """Go to a target displacement, or to the FACTOR if that comes first.

        Raises
        ------
        InstabilityError
            There is no further equilibrium.
        """
        path, result = self.path, self.result
        if leg > 1:
            self.leg = leg
            path.turn(self._sense(target))
        ends = self._ends(target)
        result.end = ""
        result.add(self.point())
        # the stations divide the path to the first end
        (row, on_factor, value), _ = ends[0]
        begin = float(row @ path.u) + on_factor * path.factor
        station = 1
        while not result.end:
            part = station / self.card["STEPS"]
            at_station = Mark(row, on_factor, begin + part * (value - begin))
            hit = path.step([*(m for m, _ in ends), at_station])
            point = self.point()
            if isinstance(hit, PathEvent):
                change = path.transition(hit)
                point = replace(point, changes=path.changes)
                result.ladder.append((point, change))
            result.add(point)
            if isinstance(hit, int):
                if hit < len(ends):
                    result.end = ends[hit][1]
                else:
                    station += 1
            if self.card["ADAPTIVE"] == "YES":
                path.load = self.pattern.follow(path)

    def _sense(self, target: float | None) -> float:
        """Return the sign of the increments of displacement or load factor towards the end."""
        path, factor = self.path, self.card["FACTOR"]
        if self.card["CONTROL"] == "FORCE" and factor is not None:
            return math.copysign(1.0, factor)
        assert target is not None  # the card was checked
        ahead = target - float(self.control @ path.u)
        if self.card["CONTROL"] == "FORCE":
            path.turn(1.0)
            ahead *= float(self.control @ path.rates(path.u, path.factor).displacement)
        return math.copysign(1.0, ahead)

    def _ends(self, target: float | None) -> list[tuple[Mark, str]]:
        """Return the marks at which this leg ends, and their text in the report."""
        ends: list[tuple[Mark, str]] = []
        if target is not None:
            sense = math.copysign(1.0, target - float(self.control @ self.path.u))
            ends.append(
                (Mark(sense * self.control, 0.0, sense * target), "the target displacement is reached")
            )
        if (factor := self.card["FACTOR"]) is not None:
            up = math.copysign(1.0, factor)
            ends.append((Mark(np.zeros(len(self.control)), up, up * factor), "the load factor is reached"))
        return ends


def _once(ladder: list[tuple[CapacityPoint, Change]]) -> list[tuple[CapacityPoint, Change]]:
    """Return the ladder of changes without duplicates at one point."""
    distinct: dict[tuple[float, float, Change], tuple[CapacityPoint, Change]] = {}
    for point, change in ladder:
        distinct.setdefault((point.displacement, point.factor, change), (point, change))
    return list(distinct.values())


def pushed_nodes(structure: Structure, card: Card) -> tuple[int, ...] | None:
    """Return the nodes of the pushed building, or None for all nodes."""
    return building(structure, card["BUILDING"]).nodes if card["BUILDING"] else None


def of_one_building(structure: Structure, card: Card) -> bool:
    """Return whether one building with mass is pushed."""
    return bool(card["BUILDING"]) or len(buildings(structure)) == 1


def control_row(structure: Structure, card: Card) -> Array:
    """Return the row of the control displacement, shape (n_free,)."""
    at = (card["NODE"], "XY".index(card["DIRECTION"]))
    return structure.dofs.row([at], [1.0])[: structure.n_free]


SPEC = Spec(
    "analysis",
    "PUSHOVER",
    "forces growing from the static state",
    (
        Field("NODE", Kind.NODE, doc="control node", positional=True),
        Field(
            "TARGET",
            Kind.REAL,
            "L",
            default=None,
            count=(1, 1000),
            doc="displacement to which the control node goes, including the static one; several: from "
            "one to the next",
            positional=True,
        ),
        Field(
            "CYCLES",
            Kind.INT,
            default=0,
            lo=0,
            hi=1000,
            doc="number of times that it goes to each TARGET and to its opposite; 0: to each TARGET once",
        ),
        Field("DIRECTION", Kind.WORD, default="X", words=("X", "Y"), doc="direction of forces and control"),
        Field(
            "PATTERN",
            Kind.WORD,
            default="TRIANGULAR",
            words=("UNIFORM", "TRIANGULAR", "MODE", "FORCES", "LOADS"),
            doc="forces by mass, by mass and height, by mass and mode (each of sum 1), as in FORCES, or "
            "the LOADS again",
        ),
        Field("NODES", Kind.NODES, default=None, doc="pushed nodes; omitted: all that have mass"),
        Field("BUILDING", Kind.TEXT, default="", doc="name of the only building pushed; omitted: all"),
        Field(
            "NEIGHBOURS",
            Kind.WORD,
            default="YES",
            words=("YES", "NO"),
            doc="keep the other buildings beside that BUILDING, or remove them",
        ),
        Field(
            "FORCES",
            Kind.REAL,
            "F",
            default=None,
            count=(1, 1000),
            doc="forces on NODES, one per node, with PATTERN=FORCES",
        ),
        Field(
            "CONTROL",
            Kind.WORD,
            default="DISPLACEMENT",
            words=("DISPLACEMENT", "FORCE"),
            doc="what grows: the displacement of NODE (also past the peak load) or the load factor",
        ),
        Field(
            "FACTOR",
            Kind.REAL,
            "-",
            default=None,
            doc="stops at this load factor unless TARGET comes first",
        ),
        Field(
            "ADAPTIVE",
            Kind.WORD,
            default="NO",
            words=("NO", "YES"),
            doc="with PATTERN=MODE: update the mode after every event and at every station",
        ),
        Field(
            "STEPS",
            Kind.INT,
            default=50,
            lo=1,
            hi=100_000,
            doc="number of stations on the way to each target",
        ),
        Field(
            "BASE",
            Kind.NODES,
            default=None,
            doc="supports whose reactions form the base shear; omitted: all that holds the pushed part",
        ),
        Field(
            "TC",
            Kind.REAL,
            "T",
            default=None,
            above=0.0,
            doc="corner period of the spectrum, where its constant acceleration ends: gives the "
            "performance point of the N2 method for every ground motion along DIRECTION",
        ),
        Field(
            "XI",
            Kind.REAL,
            "-",
            default=0.05,
            lo=0.0,
            below=1.0,
            doc="damping ratio of these spectra: 0.05 is 5 %",
        ),
    ),
    reference="Antoniou & Pinho 2004 (adaptive); Fajfar 2000 (N2)",
)
