r"""The elastic beam between two nodes that FRAME and BEAM_COLUMN share.

Axial and bending stiffness, shear deformation by :math:`\phi = 12EI/(G A_s L^2)`, rigid end blocks,
pinned and flexible joints (condensed inside the member), initial forces, self weight, uniform and point
loads, lumped or consistent mass.

Local axes: x from I to J, y to its left; matrices and interpolation are those of `beam_matrices`.

A member that yields has hinges at the ends of the flexible length.  The beam between them then has separate
end DOFs, which the hinges connect to the nodes.  The flexibility of hinges with a length is subtracted from
the beam, so that the elastic member is the same with and without them.  At most nine tenths of the beam's
flexibility is subtracted; longer hinges lose the excess themselves (`laws.condensed`).

References
----------
Przemieniecki JS (1968), Theory of Matrix Structural Analysis, McGraw-Hill, sections 5.6 and 11.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import COROTATIONAL, STRING, CorotationalMember
from pound_solve.structure.dofs import Dof
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementMatrix,
    ElementParts,
    Geometric,
    Output,
    direction,
)
from pound_solve.structure.elements.beam_matrices import (
    GAUSS_W,
    GAUSS_X,
    block_mass,
    end_blocks,
    shapes,
    slopes,
    soften,
    spare,
    stiffness,
)

COORDINATE_ROUNDING = 1e-9  #: of coordinates, share of a length

MOST_TAKEN = 0.9  #: largest flexibility subtracted from a beam for its hinges, as a share of the beam's own
INSIDE = {2: 3, 5: 4, 0: 5, 3: 6}  #: number of the internal DOF behind a hinge, by local DOF


@dataclass(frozen=True)
class HingedBeam:
    """A beam, and the relation between its DOFs and the deformation of its hinges.

    Attributes
    ----------
    parts : ElementParts
    dofs : tuple of Dof
        Nodal DOFs, then internal ones.
    opening : ndarray, shape (6, n_freedoms)
        Deformation of the hinges by local DOF: stretch (rows 0, 3) and bend (rows 2, 5), positive in
        tension and where the member sags (tension on the right of the line from I to J).
    share : float
        Share of the hinges' flexibility that stays in them; the beam has the rest.
    """

    parts: ElementParts
    dofs: tuple[Dof, ...]
    opening: Array
    share: float


def pair(values: tuple[float, ...]) -> tuple[float, float]:
    """Values at I and J; a single value applies to both."""
    return values[0], values[-1]


def pinned(p: Card) -> list[int]:
    """Local rotations that are pinned."""
    return {"NONE": [], "I": [2], "J": [5], "BOTH": [2, 5]}[p["PIN"] if p["I"] > 0.0 else "BOTH"]


def build(context: ElementContext, hinged: tuple[int, ...] = (), taken: Array | None = None) -> HingedBeam:
    """Build a beam's matrices, loads and end forces.

    Parameters
    ----------
    context : ElementContext
        With a property card that has the fields `FIELDS`.
    hinged : tuple of int
        Local DOFs (0, 3 stretch, 2, 5 bend) with a hinge.
    taken : ndarray, shape (6, 6)
        Flexibility of the hinges, subtracted from the beam up to `MOST_TAKEN` [L/F, 1/F, 1/(F L)].

    Raises
    ------
    ElementError
        No length is left, or a hinge is longer than the member; the item is ``LP``.
    """
    line = _line(context)
    beam = _flexible_part(context.prop, line.length, taken)
    dofs, outer, inner = _kinematics(context, line, hinged)
    opening = np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])[:, None] * (inner - outer)
    parts = ElementParts(stiffness=[ElementMatrix(dofs, inner.T @ beam.forces @ inner)])
    m = context.prop["WGT"] / context.gravity
    if m > 0.0:
        # with closed hinges: the internal DOFs of a member have no mass
        mass = _mass(context, m, line.length, beam.phi, beam.closed @ outer[:, :6], line.at_nodes)
        parts.mass.append(ElementMatrix(dofs[:6], mass))
    equivalent, nodal = _loads(context, line.length, beam.phi, line.rotation[:2, :2])
    load = (beam.shape @ inner).T @ equivalent
    load[:6] += nodal
    if load.any():
        parts.loads.append((dofs, load))
    rows, constant = beam.forces @ inner, beam.end_forces(equivalent)
    parts.outputs += _outputs(context, dofs, rows, constant)
    _add_geometry(parts, context, line, beam, dofs, inner, rows, constant)
    return HingedBeam(parts, dofs, opening, beam.share)


@dataclass(frozen=True)
class _Line:
    """Axis of a member.

    Attributes
    ----------
    full, length : float
        Between the nodes, and of the flexible part [L].
    rotation, at_nodes : ndarray, shape (3, 3) and (6, 6)
        Global to local displacements of one node and of both.
    """

    full: float
    length: float
    rotation: Array
    at_nodes: Array


def _line(context: ElementContext) -> _Line:
    """Axis of the member between its nodes."""
    p = context.prop
    if context.j is None:
        raise ElementError(f"a {p.spec.name} member needs two nodes")
    dx, dy = context.j.x - context.i.x, context.j.y - context.i.y
    full = math.hypot(dx, dy)
    length = full - p["END1"] - p["END2"]
    if length <= 0.0:
        raise ElementError(f"no flexible length is left: {full:g} less the end blocks", "END1")
    c, s = direction(dx, dy)
    rotation = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    at_nodes = np.zeros((6, 6))
    at_nodes[:3, :3] = at_nodes[3:, 3:] = rotation
    return _Line(full, length, rotation, at_nodes)


@dataclass(frozen=True)
class _FlexiblePart:
    """The beam between the end blocks, in local axes; see `soften`.

    Attributes
    ----------
    phi : float
        Shear parameter [-].
    k : ndarray, shape (6, 6)
        Stiffness without pins and joints.
    pins : list of int
    forces, shape, flexibility : ndarray, shape (6, 6)
        With pins and joints, less the flexibility of the hinges.
    closed : ndarray, shape (6, 6)
        `shape` with closed hinges.
    share : float
        Share of the hinges' flexibility subtracted from the beam.
    """

    phi: float
    k: Array
    pins: list[int]
    forces: Array
    shape: Array
    flexibility: Array
    closed: Array
    share: float

    def end_forces(self, load: Array) -> Array:
        """End forces of the beam from loads equivalent to `load`, with nodes at rest, shape (6,)."""
        forces: Array = self.k @ (self.flexibility @ load) - load
        forces[self.pins] = 0.0
        return forces


def _flexible_part(p: Card, length: float, taken: Array | None) -> _FlexiblePart:
    """The beam of a property card, less the flexibility `taken` for its hinges."""
    ea, ei, phi = p["E"] * p["A"], p["E"] * p["I"], 0.0
    if p["AS"] > 0.0 and ei > 0.0:
        if p["G"] is None:
            raise ElementError("AS (shear deformation) needs G", "AS")
        phi = 12 * ei / (p["G"] * p["AS"] * length**2)
    k, pins = stiffness(ea, ei, length, phi), pinned(p)
    joints = np.diag([0.0, 0.0, pair(p["FJ"])[0], 0.0, 0.0, pair(p["FJ"])[1]])
    share, behind = 1.0, joints
    if taken is not None:
        _lengths_fit(p, length)
        share = min(1.0, MOST_TAKEN * spare(k, length, ea, joints, taken, pins))
        behind = joints - share * taken
    forces, shape, flexibility = soften(k, pins, behind)
    if ei == 0.0:  # an axial bar stays straight: its loads and mass are shared as on two pins
        _, shape, _ = soften(stiffness(0.0, 1.0, length, 0.0), pins, joints)
    closed = shape if taken is None else soften(k, pins, joints)[1]
    return _FlexiblePart(phi, k, pins, forces, shape, flexibility, closed, share)


def _lengths_fit(p: Card, length: float) -> None:
    """Refuse a hinge longer than the member by more than the rounding of coordinates."""
    longest = max(pair(p["LP"]))
    if longest > length * (1.0 + COORDINATE_ROUNDING):
        message = f"a hinge of {longest:.10g} is longer than the flexible length, {length:.10g}"
        raise ElementError(message, "LP")


def _kinematics(
    context: ElementContext, line: _Line, hinged: tuple[int, ...]
) -> tuple[tuple[Dof, ...], Array, Array]:
    """DOFs of the member, and two maps from them to local displacements, shape (6, n_dofs): of the flexible
    ends as the nodes move them, and of the beam behind the hinges.
    """
    assert context.j is not None
    hinges = tuple((context.element.id, INSIDE[d]) for d in hinged)
    dofs = tuple((n.id, d) for n in (context.i, context.j) for d in range(3)) + hinges
    to_ends = end_blocks(context.prop["END1"], context.prop["END2"]) @ line.at_nodes
    outer = np.hstack([to_ends, np.zeros((6, len(hinges)))])
    inner = outer.copy()
    for n, d in enumerate(hinged):
        inner[d] = 0.0
        inner[d, 6 + n] = 1.0
    return dofs, outer, inner


def _outputs(context: ElementContext, dofs: tuple[Dof, ...], rows: Array, constant: Array) -> list[Output]:
    """End forces: ``rows u + constant``, local, tension positive at both ends."""
    bar = context.prop["E"] * context.prop["I"] == 0.0
    outputs = []
    for name, unit, row, sign in (
        ("axial I", "F", 0, -1.0),
        ("axial J", "F", 3, 1.0),
        ("shear I", "F", 1, 1.0),
        ("moment I", "F*L", 2, 1.0),
        ("shear J", "F", 4, 1.0),
        ("moment J", "F*L", 5, 1.0),
    ):
        if row in (0, 3) or not bar:
            u_row, c0 = sign * rows[row], sign * float(constant[row])
            outputs.append(Output(context.element.id, name, unit, dofs, u_row, None, c0))
    return outputs


def _add_geometry(
    parts: ElementParts,
    context: ElementContext,
    line: _Line,
    beam: _FlexiblePart,
    dofs: tuple[Dof, ...],
    inner: Array,
    rows: Array,
    constant: Array,
) -> None:
    """Add the terms of GEOMETRY: a geometric stiffness, a P-Delta string or corotational geometry."""
    geometry, number, p = context.geometry, context.element.id, context.prop
    axial, mean = 0.5 * (rows[3] - rows[0]), 0.5 * float(constant[3] - constant[0])
    if geometry in ("PDELTA_VARYING", "LARGE"):
        quantities = np.zeros((6, len(dofs)))
        quantities[0], quantities[1] = axial, -rows[2] - rows[5]
        quantities[2:4, :6] = line.at_nodes[3:5] - line.at_nodes[:2]
        quantities[4, 2] = quantities[5, 5] = 1.0
        if geometry == "LARGE":
            held = -beam.end_forces(_initial(p, line.length))
            chord = _corotational(p, line.length, beam.forces, held)
        else:
            k_axial = float(beam.forces[3, 3])
            chord = (STRING, line.full, 0.0, 0.0, 0.5, k_axial, 0.0, 0.0, mean, 0.0), {}
        parts.corotational.append(CorotationalMember(number, dofs, quantities, *chord))
    elif geometry == "PDELTA":
        across = np.zeros(len(dofs))
        across[:6] = (line.at_nodes[4] - line.at_nodes[1]) / line.full
        matrix = line.full * np.outer(across, across)
        parts.geometric.append(Geometric(number, dofs, matrix, axial, mean, {}))
    elif geometry == "PDELTA_MEMBER":
        matrix, adds = _bowed(p, line.length, beam.phi, beam.shape, inner, line.at_nodes)
        parts.geometric.append(Geometric(number, dofs, matrix, axial, mean, adds))


def _loads(context: ElementContext, length: float, phi: float, turn: Array) -> tuple[Array, Array]:
    """Consistent loads on the beam's ends (local, with initial forces) and loads on the rigid end blocks
    (global), shape (6,) each.
    """
    p = context.prop
    uniform = np.zeros(2)
    points: list[tuple[float, Array]] = []
    if context.self_weight:
        uniform[1] -= p["WGT"]
    for card in context.member_loads:
        uniform += (card["WX"], card["WY"])
        if card["PX"] or card["PY"]:
            points.append((card["AT"], np.array([card["PX"], card["PY"]])))
    equivalent, nodal = np.zeros(6), np.zeros(6)
    for xi, w in zip(GAUSS_X, GAUSS_W) if uniform.any() else ():
        equivalent += w * length * shapes(xi, length, phi).T @ (turn @ uniform)
    for at, force in points:
        equivalent += shapes(at, length, phi).T @ (turn @ force)
    equivalent -= _initial(p, length)
    for end, block, sign in ((0, p["END1"], 1.0), (3, p["END2"], -1.0)):
        arm = sign * block / 2 * turn[0]
        nodal[end : end + 2] += uniform * block
        nodal[end + 2] += (arm[0] * uniform[1] - arm[1] * uniform[0]) * block
    return equivalent, nodal


def _initial(p: Card, length: float) -> Array:
    """Initial forces on the beam's ends, local, shape (6,)."""
    at_i, at_j = -pair(p["M0"])[0], pair(p["M0"])[1]  # on the ends, anticlockwise
    shear = (at_i + at_j) / length
    return np.array([-p["N0"], shear, at_i, p["N0"], -shear, at_j])


def _corotational(
    p: Card, length: float, forces: Array, held: Array
) -> tuple[tuple[float, ...], dict[str, Array]]:
    """Parameters of corotational geometry (see `corotational`), and its contribution to the end forces.

    Parameters
    ----------
    forces : ndarray, shape (6, 6)
        Local end forces of the beam for unit end displacements.
    held : ndarray, shape (6,)
        End forces of the undisplaced beam, without those of member loads, which keep their direction.
    """
    ends = [3, 2, 5]
    d = np.array([[1.0, 0.0], [0.0, -1.0], [0.0, -1.0]])
    actions = forces[np.ix_(ends, ends)] @ d  # axial force and end moments for unit eta and rho
    k = d.T @ actions
    pins = pinned(p)
    # a pinned end does not rotate with the member
    share_i = {2: 0.0, 5: 1.0}[pins[0]] if len(pins) == 1 else 0.5
    n0, t0 = d.T @ held[ends]
    parameters = (COROTATIONAL, length, p["END1"], p["END2"], share_i, k[0, 0], k[0, 1], k[1, 1], n0, t0)
    axial, at_i, at_j = (np.append(row, 0.0) for row in actions)
    shear = (at_i + at_j) / length + (0.0, 0.0, 1.0)
    adds = {"axial I": axial, "axial J": axial, "moment I": at_i, "moment J": at_j}
    return tuple(map(float, parameters)), adds | {"shear I": shear, "shear J": -shear}


def _bowed(
    p: Card, length: float, phi: float, shape: Array, inner: Array, at_nodes: Array
) -> tuple[Array, dict[str, Array]]:
    """Geometric stiffness of the bent member and its rigid blocks for a unit axial force, shape (n, n), and
    its contribution to the end forces beyond the rotation of the chord.
    """
    flexible = np.zeros((6, 6))
    for xi, w in zip(GAUSS_X, GAUSS_W):
        slope = slopes(xi, length, phi)
        flexible += w * length * np.outer(slope, slope)
    at_ends = shape.T @ flexible @ shape @ inner
    matrix = inner.T @ at_ends
    matrix[:6, :6] += sum(
        p[end] * np.outer(at_nodes[i], at_nodes[i]) for end, i in (("END1", 2), ("END2", 5))
    )
    turn = (inner[4] - inner[1]) / length
    rows = {
        "shear I": at_ends[1] + turn,
        "moment I": at_ends[2],
        "shear J": at_ends[4] - turn,
        "moment J": at_ends[5],
    }
    return matrix, rows


def _mass(
    context: ElementContext, m: float, length: float, phi: float, from_nodes: Array, at_nodes: Array
) -> Array:
    """Mass of the member on its global nodal DOFs, shape (6, 6)."""
    p = context.prop
    if not context.consistent:
        half = m * length / 2
        ends = (half + m * p["END1"], half + m * p["END2"])
        return np.diag([ends[0], ends[0], 0.0, ends[1], ends[1], 0.0])
    flexible = np.zeros((6, 6))
    for xi, w in zip(GAUSS_X, GAUSS_W):
        n = shapes(xi, length, phi)
        flexible += w * m * length * n.T @ n
    blocks = np.zeros((6, 6))
    blocks[:3, :3] = block_mass(m, p["END1"], 1.0)
    blocks[3:, 3:] = block_mass(m, p["END2"], -1.0)
    return from_nodes.T @ flexible @ from_nodes + at_nodes.T @ blocks @ at_nodes


FIELDS = (
    Field("E", Kind.REAL, "F/L^2", above=0, doc="modulus of elasticity"),
    Field("A", Kind.REAL, "L^2", above=0, doc="cross-section area"),
    Field("I", Kind.REAL, "L^4", default=0.0, lo=0, doc="second moment of area; 0: an axial bar"),
    Field("G", Kind.REAL, "F/L^2", default=None, above=0, doc="shear modulus, with AS"),
    Field("AS", Kind.REAL, "L^2", default=0.0, lo=0, doc="shear area; 0: no shear deformation"),
    Field(
        "WGT", Kind.REAL, "F/L", default=0.0, lo=0, doc="self weight per length: mass, and a load in STATIC"
    ),
    Field("END1", Kind.REAL, "L", default=0.0, lo=0, doc="length of the rigid block at I"),
    Field("END2", Kind.REAL, "L", default=0.0, lo=0, doc="length of the rigid block at J"),
    Field(
        "PIN",
        Kind.WORD,
        default="NONE",
        words=("NONE", "I", "J", "BOTH"),
        codes={"NONE": 0, "I": 1, "J": 2, "BOTH": 3},
        doc="ends that rotate freely",
    ),
    Field(
        "FJ",
        Kind.REAL,
        "1/(F*L)",
        default=(0.0,),
        lo=0,
        count=(1, 2),
        doc="joint flexibility at I and J, rotation per moment; one value: both",
    ),
    Field(
        "N0",
        Kind.REAL,
        "F",
        default=0.0,
        doc="initial axial force of the undeformed member, tension positive",
    ),
    Field(
        "M0",
        Kind.REAL,
        "F*L",
        default=(0.0,),
        count=(1, 2),
        doc="initial moments at I and J, sagging positive; one value: both",
    ),
)
