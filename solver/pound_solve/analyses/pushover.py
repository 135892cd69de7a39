r"""PUSHOVER: a load pattern that grows from the static state until a displacement or a load factor is
reached.

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
from dataclasses import dataclass, field, replace

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.analyses import static
from pound_solve.analyses.equilibrium import SUM_ROUNDING, SupportReactions
from pound_solve.analyses.load_pattern import LoadPattern
from pound_solve.analyses.path_following import Change, EquilibriumPath, Mark, PathEvent
from pound_solve.analyses.static import StaticState
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.check import Check, Subject, at_most
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import building, buildings
from pound_solve.structure.extract_building import extract_building
from pound_solve.structure.structure import Structure

FURTHEST = 0.2  #: largest target as a fraction of the height of the control node above its base


@dataclass(frozen=True)
class CapacityPoint:
    """A point of the capacity curve: control displacement [L], base shear [F], load factor, changes."""

    displacement: float
    shear: float
    factor: float
    changes: int


@dataclass
class PushoverResult:
    """Results of a pushover.

    Attributes
    ----------
    card : Card
    structure : Structure
        The pushed structure: the whole deck, or one building.
    curve : list of CapacityPoint
        At the start, at the stations, and where laws changed.
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
        about = "pushover, force out of balance over the largest"
        return at_most(Subject.EQUILIBRIUM, about, self.unbalanced, SUM_ROUNDING, "forces do not balance")

    def add(self, point: CapacityPoint) -> None:
        """Add a point to the curve; it replaces the last one at the same displacement and factor."""
        last = self.curve[-1:]
        if last and (last[0].displacement, last[0].factor) == (point.displacement, point.factor):
            self.curve.pop()
        self.curve.append(point)


def mistaken_cards(structure: Structure) -> list[Diagnostic]:
    """Return the error in the PUSHOVER card of a deck: one message, or none."""
    for card in structure.model.analyses:
        if card.spec.name == "PUSHOVER" and (wrong := _wrong(structure, card)):
            message, item, hint = wrong
            return [Diagnostic("P335", message, card.place(item), hint)]
    return []


def distant_targets(structure: Structure) -> list[Diagnostic]:
    """Return a message if the target of a PUSHOVER exceeds what the height of its control node allows."""
    model, warnings = structure.model, list[Diagnostic]()
    for card in model.analyses:
        if card.spec.name != "PUSHOVER" or card["TARGET"] is None or card["DIRECTION"] != "X":
            continue
        b = next((b for b in buildings(structure) if card["NODE"] in b.nodes), None)
        high = model.nodes[card["NODE"]].y - b.base if b else 0.0
        if abs(card["TARGET"]) > FURTHEST * high > 0.0:
            unit = model.units.length
            message = (
                f"TARGET is {card['TARGET']:g} {unit}, node {card['NODE']} {high:.4g} {unit} above its base"
            )
            hint = f"TARGET is a displacement in {unit}: buildings fall at a tenth of their height"
            warnings.append(Diagnostic("P377", message, card.place("TARGET"), hint, "warning"))
    return warnings


def _wrong(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the message, the invalid item of the card, and a hint, or None."""
    if wrong := _wrong_building(structure, card) or _wrong_control(structure, card) or _wrong_items(card):
        return wrong
    pattern = LoadPattern(structure, card, _own(structure, card))
    if not (pattern.mass if pattern.by_mode else pattern.forces.any()):
        hint = "the nodes that are pushed need forces, loads or WEIGHTS, and must be able to move so"
        return f"PATTERN={card['PATTERN']} has no force along {card['DIRECTION']}", "PATTERN", hint
    return None


def _wrong_building(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the error in the pushed building, or in the nodes that must belong to it."""
    name = card["BUILDING"]
    if not name and card["NEIGHBOURS"] == "YES":
        return None
    if not name:
        return "NEIGHBOURS=NO needs a building", "NEIGHBOURS", 'add BUILDING="name" of the one that is left'
    try:
        nodes = building(structure, name).nodes
    except KeyError as err:
        return str(err.args[0]), "BUILDING", "buildings have the names of the section BUILDINGS"
    for item, numbers in (("NODE", (card["NODE"],)), ("NODES", card["NODES"]), ("BASE", card["BASE"])):
        for node in numbers or ():
            if node not in nodes:
                return f"node {node} is not of building {name!r}", item, "name nodes of this building"
    return None


def _wrong_control(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the error in the end of the pushover or in its control node."""
    by_displacement = card["CONTROL"] == "DISPLACEMENT"
    if card["TARGET"] is None and (card["FACTOR"] is None or by_displacement):
        needs = "TARGET" if by_displacement else "TARGET or FACTOR"
        return f"PUSHOVER has no end: it needs {needs}", "CONTROL", "add TARGET=displacement"
    if card["FACTOR"] == 0.0:
        return "FACTOR is zero", "FACTOR", "give the load factor to go to, with its sign"
    if not _control(structure, card).any():
        message = f"the control node {card['NODE']} cannot move along {card['DIRECTION']}"
        return message, "NODE", "name a node that is not fixed so"
    return None


def _wrong_items(card: Card) -> tuple[str, str, str] | None:
    """Return the error in the items that belong to one pattern only."""
    pattern, nodes, forces = card["PATTERN"], card["NODES"], card["FORCES"] or ()
    if pattern == "FORCES" and (not forces or len(nodes or ()) != len(forces)):
        hint = "PATTERN=FORCES takes one force for each node: NODES=3,5 FORCES=10,20"
        return f"{len(nodes or ())} NODES, but {len(forces)} FORCES", "FORCES", hint
    if pattern != "FORCES" and forces:
        hint = "write PATTERN=FORCES, or leave them out"
        return f"FORCES do not go with PATTERN={pattern}", "FORCES", hint
    if pattern == "LOADS" and nodes is not None:
        hint = "the loads stand where they are: leave NODES out"
        return "NODES do not go with PATTERN=LOADS", "NODES", hint
    if card["ADAPTIVE"] == "YES" and pattern != "MODE":
        return f"PATTERN={pattern} cannot adapt", "ADAPTIVE", "ADAPTIVE=YES goes with PATTERN=MODE"
    return None


def push(structure: Structure, state: StaticState, card: Card) -> PushoverResult:
    """Push a structure from its static state.

    Parameters
    ----------
    structure : Structure
        With the geometric stiffness of that state.
    state : StaticState
    card : Card
        Of `SPEC`.

    Raises
    ------
    InstabilityError
        The path has no first step.
    """
    nodes = _own(structure, card)
    if nodes is not None and card["NEIGHBOURS"] == "NO":
        structure = extract_building(structure, nodes)
        state = static.solve(structure)
        structure = structure.stressed(state.axial).displaced(state.u)
    n, by_load = structure.n_free, card["CONTROL"] == "FORCE"
    control = _control(structure, card)
    start = float(control @ state.u)
    if card["TARGET"] == start:
        raise InstabilityError(f"the control node stands at its target {start:g} already", "A505")
    pattern = LoadPattern(structure, card, nodes)
    path = EquilibriumPath(
        structure, state.u, state.states, structure.loads[:n], np.zeros(n), None if by_load else control
    )
    path.load = pattern.follow(path)
    if not path.load.any():
        raise InstabilityError("no mode of the static state moves the nodes that are pushed", "A505")
    path.sign = _sense(path, card, control, start)
    reactions = SupportReactions(structure, state.axial, nodes)

    def here() -> CapacityPoint:
        shear = reactions.shear(path.u, path.states, "XY".index(card["DIRECTION"]), card["BASE"])
        return CapacityPoint(float(control @ path.u), shear, path.factor, path.changes)

    ends, result = _ends(card, control, start), PushoverResult(card, structure, first=path.load)
    # the stations divide the path to the first end
    (row, on_factor, value), _ = ends[0]
    begin = float(row @ state.u)
    result.add(here())
    station = 1
    while not result.end:
        part = station / card["STEPS"]
        at_station = Mark(row, on_factor, begin + part * (value - begin))
        try:
            hit = path.step([*(m for m, _ in ends), at_station])
            point = here()
            if isinstance(hit, PathEvent):
                change = path.transition(hit)
                point = replace(point, changes=path.changes)
                result.ladder.append((point, change))
        except InstabilityError as err:
            # under load control this is the capacity; under displacement control the path must continue
            result.end, result.failed = str(err), None if by_load and err.code == "A501" else err
            result.add(here())
            result.ladder = _once(result.ladder)
            break
        result.add(point)
        if isinstance(hit, int):
            if hit < len(ends):
                result.end = ends[hit][1]
            else:
                station += 1
        if card["ADAPTIVE"] == "YES":
            path.load = pattern.follow(path)
    result.curve = [replace(p, displacement=_clean(p.displacement, result.curve)) for p in result.curve]
    result.last, result.unbalanced = path.load, path.unbalanced()
    return result


def _sense(path: EquilibriumPath, card: Card, control: Array, start: float) -> float:
    """Return the sign of the increments of displacement or load factor towards the end."""
    target, factor = card["TARGET"], card["FACTOR"]
    if card["CONTROL"] != "FORCE":
        return math.copysign(1.0, target - start)
    if factor is not None:
        return math.copysign(1.0, factor)
    du = path.rates(path.u, 0.0)[0]
    return math.copysign(1.0, (target - start) * float(control @ du))


def _ends(card: Card, control: Array, start: float) -> list[tuple[Mark, str]]:
    """Return the marks at which the pushover ends, and their text in the report."""
    ends: list[tuple[Mark, str]] = []
    if (target := card["TARGET"]) is not None:
        sense = math.copysign(1.0, target - start)
        ends.append((Mark(sense * control, 0.0, sense * target), "the target displacement is reached"))
    if (factor := card["FACTOR"]) is not None:
        up = math.copysign(1.0, factor)
        ends.append((Mark(np.zeros(len(control)), up, up * factor), "the load factor is reached"))
    return ends


def _once(ladder: list[tuple[CapacityPoint, Change]]) -> list[tuple[CapacityPoint, Change]]:
    """Return the ladder of changes without duplicates at one point."""
    distinct: dict[tuple[float, float, Change], tuple[CapacityPoint, Change]] = {}
    for point, change in ladder:
        distinct.setdefault((point.displacement, point.factor, change), (point, change))
    return list(distinct.values())


def _clean(displacement: float, curve: list[CapacityPoint]) -> float:
    """Return the displacement, or zero if it is a rounding error compared with the largest one."""
    return displacement if abs(displacement) > 1e-13 * max(abs(p.displacement) for p in curve) else 0.0


def _own(structure: Structure, card: Card) -> tuple[int, ...] | None:
    """Return the nodes of the pushed building, or None for all nodes."""
    return building(structure, card["BUILDING"]).nodes if card["BUILDING"] else None


def _control(structure: Structure, card: Card) -> Array:
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
            doc="target displacement of the control node, including the static one",
            positional=True,
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
            "STEPS", Kind.INT, default=50, lo=1, hi=100_000, doc="number of stations on the capacity curve"
        ),
        Field(
            "BASE",
            Kind.NODES,
            default=None,
            doc="supports whose reactions form the base shear; omitted: all that holds the pushed part",
        ),
    ),
    reference="Antoniou & Pinho 2004 (adaptive)",
)
