"""Contributions of an element to the structure."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from typing import Any, Self

import numpy as np

from pound_deck.model import Card, Element, Node
from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import GAP, Branch, Law, State
from pound_solve.laws.condensed import without
from pound_solve.laws.refusal import ItemError
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import CorotationalMember
from pound_solve.structure.dofs import Dof


@dataclass(frozen=True)
class ElementMatrix:
    """A small symmetric matrix on some DOFs."""

    dofs: tuple[Dof, ...]
    matrix: Array


class Role(Enum):
    """Function of a component in the structure."""

    SPRING = auto()  #: a spring or hinge with a hysteresis rule; damping models may add a dashpot to it
    CONTACT = auto()
    FRICTION = auto()  #: slides at a share of the force of another component of its element
    DAMPER = auto()  #: resists the rate alone

    @property
    def collides(self) -> bool:
        """Whether its closures are collisions; it connects its nodes only while closed. Its losses count as
        contact losses, those of slipping springs as hysteretic, those of dashpots as damping.
        """
        return self is Role.CONTACT

    @property
    def reports_damping(self) -> bool:
        """Whether the reported force includes the law's resistance to the rate; it excludes dashpots that a
        damping model adds to a spring.
        """
        return self in (Role.CONTACT, Role.DAMPER)


@dataclass(frozen=True)
class LawSpring:
    """A component whose force follows a law with internal variables.

    The deformation is ``sum(row * u[DOFs])``; the force acts back on the DOFs along `row`.

    Attributes
    ----------
    component : str
        Its name within the element: ``X``, ``Y``, ``R``, ``hinge I``, ``contact``, ...
    rule : str
        Name of the law's Spec.
    k0 : float
        Initial stiffness for modes and damping [F/L] or [F L]; 0 unless it is a spring.
    unit : str
        Dimension of the force, ``F`` or ``F*L``.
    beta : float
        Dashpot as a multiple of the present stiffness while that is positive [T]; damping models set it.
    secant : float
        Dashpot as a multiple of the secant stiffness [T]; not zero with a `SecantLaw` only.
    yields : tuple of float or None
        Deformations at first yield, positive and negative, for ductilities; NaN for a side that does not.
    strengths : tuple of float or None
        Forces there [F] or [F L].
    beside : float
        Flexibility of the elastic part that belongs to the adjoining beam [L/F] or [1/(F L)]: `yields`
        include it, the deformation does not.
    role : Role
    normal_component : str
        Of friction: the component of the same element whose force presses the faces together.
    facts : mapping
        For a contact: figures of the report (xi, e_asked, e_given, note, reduced_mass, k, c).
    """

    element: int
    component: str
    rule: str
    dofs: tuple[Dof, ...]
    row: tuple[float, ...]
    law: Law
    k0: float = 0.0
    yields: tuple[float, float] | None = None
    strengths: tuple[float, float] | None = None
    beside: float = 0.0
    facts: Mapping[str, Any] = field(default_factory=dict)
    unit: str = "F"
    beta: float = 0.0
    secant: float = 0.0
    role: Role = Role.SPRING
    normal_component: str = ""

    @property
    def gap(self) -> float:
        """Deformation at which a contact touches [L]."""
        return self.law.p[GAP]

    @property
    def steepest(self) -> float:
        """Stiffness that none of its straight branches exceeds [F/L] or [F L]; 0 for a damper, whose force
        depends on the rate.
        """
        return 0.0 if self.role is Role.DAMPER else self.law.rule.steepest(self.law.p)

    @property
    def damps(self) -> bool:
        """Whether its force may depend on the rate: contacts and dampers have dashpots on some branches."""
        return self.role.reports_damping or bool(self.beta or self.secant) or self.law.curved

    def whole(self, deformation: float, force: float) -> float:
        """Deformation comparable with `yields`: the law's plus the elastic part in the adjoining beam."""
        return deformation + self.beside * force

    def branch(self, state: State) -> Branch:
        """Linear branch of the law, the dashpots of `beta` and `secant` included."""
        branch = self.law.branch(state)
        if not self.beta and not self.secant:
            return branch
        follows = self.secant * state[3][-1] if self.secant else 0.0
        return branch._replace(damping=branch.damping + self.beta * max(branch.stiffness, 0.0) + follows)

    def force(self, state: State, d: float, v: float) -> float:
        """Reported force at deformation `d` and rate `v`."""
        return self.law.force(state, d, v if self.role.reports_damping else 0.0)[0]


@dataclass(frozen=True)
class Output:
    """A quantity of an element that is linear in displacement and velocity.

    ``value = u_row . u + v_row . v + constant`` on `DOFs`; `unit` in dimensions.
    """

    element: int
    quantity: str
    unit: str
    dofs: tuple[Dof, ...]
    u_row: Array
    v_row: Array | None = None
    constant: float = 0.0


@dataclass(frozen=True)
class Geometric:
    """Stiffness of a member from its own axial force.

    Attributes
    ----------
    matrix : ndarray, shape (n, n)
        For an axial force of one (tension), on `DOFs` [1/L, -, L].
    axial : ndarray, shape (n,)
        The axial force is ``axial . u + constant``, tension positive [F].
    forces : mapping of str to ndarray, shape (n,)
        Contribution of an axial force of one to the rows of the member's outputs, by their quantity.
    """

    element: int
    dofs: tuple[Dof, ...]
    matrix: Array
    axial: Array
    constant: float
    forces: Mapping[str, Array] = field(default_factory=dict)


@dataclass
class ElementParts:
    """Everything one element adds to the structure."""

    stiffness: list[ElementMatrix] = field(default_factory=list)
    geometric: list[Geometric] = field(default_factory=list)
    corotational: list[CorotationalMember] = field(default_factory=list)
    damping: list[ElementMatrix] = field(default_factory=list)
    mass: list[ElementMatrix] = field(default_factory=list)
    loads: list[tuple[tuple[Dof, ...], Array]] = field(default_factory=list)
    laws: list[LawSpring] = field(default_factory=list)
    outputs: list[Output] = field(default_factory=list)

    def internal(self) -> tuple[Dof, ...]:
        """Internal DOFs of the element."""
        blocks = [*self.stiffness, *self.damping, *self.mass]
        touched = [b.dofs for b in blocks] + [s.dofs for s in self.laws]
        used = [f for dofs in touched for f in dofs if f[1] > 2]
        return tuple(sorted(set(used)))

    def initial(self) -> ElementMatrix:
        """Initial stiffness on the nodal DOFs, with the internal DOFs condensed statically.

        Damping in proportion to it acts on the member as a whole; on a hinge, whose initial stiffness is
        large, it would add to the yield moment.
        """
        blocks = self.stiffness + [ElementMatrix(s.dofs, s.k0 * np.outer(s.row, s.row)) for s in self.laws]
        dofs = tuple(dict.fromkeys(f for b in blocks for f in b.dofs))
        place = {f: i for i, f in enumerate(dofs)}
        k = np.zeros((len(dofs), len(dofs)))
        for b in blocks:
            at = [place[f] for f in b.dofs]
            k[np.ix_(at, at)] += b.matrix
        inside = [i for f, i in place.items() if f[1] > 2 and k[i].any()]
        nodes = [i for f, i in place.items() if f[1] < 3]
        if len(nodes) == len(dofs):
            return ElementMatrix(dofs, k)
        follow = np.linalg.solve(k[np.ix_(inside, inside)], k[np.ix_(inside, nodes)])
        left = k[np.ix_(nodes, nodes)] - k[np.ix_(nodes, inside)] @ follow
        return ElementMatrix(tuple(dofs[i] for i in nodes), left)


@dataclass(frozen=True)
class ElementContext:
    """Input of an element.

    Attributes
    ----------
    gravity : float
        [L/T^2]
    consistent : bool
        Consistent instead of lumped mass.
    member_loads : tuple of Card
        MEMBER_LOADS cards that name this element.
    self_weight : bool
        Whether member weight loads the structure.
    geometry : str
        Effect of displacements on members: ``SMALL`` (nothing), ``PDELTA``, ``PDELTA_MEMBER`` (a geometric
        stiffness), ``PDELTA_VARYING`` or ``LARGE`` (a chord).
    mass_along : callable
        ``mass_along(node, (nx, ny))``: translational mass [F T^2/L] of a node
        along a direction; contacts only.
    stiffness_along : callable
        ``stiffness_along(node, (nx, ny))``: elements at a node with their non-zero axial stiffness along a
        direction [F/L]; contacts only.
    """

    element: Element
    prop: Card
    i: Node
    j: Node | None
    gravity: float
    consistent: bool
    member_loads: tuple[Card, ...]
    self_weight: bool
    geometry: str
    mass_along: Callable[[int, tuple[float, float]], float]
    stiffness_along: Callable[[int, tuple[float, float]], dict[int, float]]


class ElementError(ItemError):
    """Raised if an element cannot be built; `item` names the field of the card at fault."""

    @classmethod
    def of_law(cls, refusal: ValueError, item: str) -> Self:
        """Convert a law's refusal to an error at the law's faulty item, or at `item`, the law's name."""
        return cls(str(refusal), refusal.item if isinstance(refusal, ItemError) else item)


#: Fields of the damage index of Park and Ang, for elements that yield
DAMAGE = (
    Field(
        "DUCTU",
        Kind.REAL,
        "-",
        default=None,
        above=1,
        count=(1, 2),
        doc="ultimate ductility under monotonic loading, positive and negative side; one value: both; "
        "requests the damage index",
    ),
    Field("PA_BETA", Kind.REAL, "-", default=0.05, lo=0, doc="weight of the energy in the damage index"),
)


def signed(values: tuple[float, ...], item: str) -> tuple[float, float]:
    """Strengths in both directions, positive and negative; a single value applies to both.

    Raises
    ------
    ElementError
        A strength has the wrong sign.
    """
    plus, minus = (values[0], -values[0]) if len(values) == 1 else values
    if plus < 0 or minus > 0:
        right = f"{item}={abs(plus):g},{-abs(minus):g}"
        raise ElementError(f"{item} needs a positive value, then a negative one: {right}", item)
    return plus, minus


def hysteretic(
    element: int,
    component: str,
    unit: str,
    row: Mapping[Dof, float],
    card: Card,
    rule: Spec,
    k: float,
    strength: tuple[float, float],
    share: float = 1.0,
) -> LawSpring:
    """Return a component that follows a hysteresis rule.

    Parameters
    ----------
    row : mapping of Dof to float
        Its deformation.
    card : Card
        Holds the rule's items.
    rule : Spec
        Of the family hysteresis, not ELASTIC.
    k : float
        Initial stiffness [F/L] or [F L].
    strength : tuple of float
        Forces at which it yields, positive and negative.
    share : float
        Share of its elastic deformation that it keeps; the adjoining beam has the rest.

    Raises
    ------
    ElementError
        The rule does not take these values, or leaves no deformation to the beam; the item is ``RULE``.
    """
    plus, minus = strength
    try:
        law = rule.impl(card.values, k, plus, minus)
    except ValueError as err:
        raise ElementError.of_law(err, "RULE") from None
    dofs, factors = zip(*((f, float(x)) for f, x in row.items() if x != 0.0))
    yields = law.rule.first_yield(law.p) if law.rule.first_yield else (plus / k, minus / k)
    spring = LawSpring(element, component, rule.name, dofs, factors, law, k, yields, strength, unit=unit)
    if share == 1.0:
        return spring
    try:
        law = without(law, 1.0 - share)
    except ValueError as err:
        most = ",".join(f"{_rounded_down(share * length):.4g}" for length in card["LP"])
        raise ElementError(f"{err}: with it hinges have at most LP={most} here", "RULE") from None
    return replace(spring, law=law, k0=k / share, beside=(1.0 - share) / k)


def _rounded_down(x: float) -> float:
    """The largest four-digit number not above `x` > 0, except for its rounding."""
    unit = 10.0 ** (math.floor(math.log10(x)) - 3)
    return math.floor(x / unit * (1.0 + 1e-12)) * unit


def axes(angle: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Unit vectors of local x and y at `angle` degrees, exact at right angles."""
    quarter, rest = divmod(angle, 90.0)
    if rest == 0.0:
        c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
    else:
        c, s = float(np.cos(np.radians(angle))), float(np.sin(np.radians(angle)))
    return (c, s), (-s, c)


def direction(dx: float, dy: float) -> tuple[float, float]:
    """Unit vector along (dx, dy), snapped to an axis if it differs by rounding only."""
    length = math.hypot(dx, dy)
    c, s = dx / length, dy / length
    return (0.0 if abs(c) < 1e-14 else c), (0.0 if abs(s) < 1e-14 else s)
