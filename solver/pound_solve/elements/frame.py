r"""FRAME: elastic beam-column between two nodes.

Axial and bending stiffness, shear deformation by :math:`\phi = 12EI/(G A_s L^2)`, rigid end blocks,
pinned ends (condensed inside the member), self weight, uniform and point loads, lumped or consistent mass.

Local axes: x from I to J, y to its left.  Interpolation over the flexible length with :math:`\xi = x/L`:

.. math::
    N_1 &= \frac{1 - 3\xi^2 + 2\xi^3 + \phi(1-\xi)}{1+\phi}, &
    N_2 &= \frac{L(\xi - 2\xi^2 + \xi^3 + \tfrac{\phi}{2}(\xi - \xi^2))}{1+\phi}

(mirrored at J), which solves the unloaded Timoshenko beam, so nodal results are exact for end loads and
consistent loads alike.

References
----------
Przemieniecki JS (1968), Theory of Matrix Structural Analysis, McGraw-Hill, sections 5.6 and 11.3.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pound_deck.schema import Field, Kind, Spec
from pound_solve.elements.base import Block, ElementError, Output, Parts, Site, direction

Array = NDArray[np.float64]

# Gauss points and weights on (0, 1): four points integrate the products of cubics exactly
_GAUSS_X, _GAUSS_W = (a for a in np.polynomial.legendre.leggauss(4))
_GAUSS_X, _GAUSS_W = 0.5 * (_GAUSS_X + 1.0), 0.5 * _GAUSS_W


def shapes(xi: float, length: float, phi: float) -> Array:
    """Interpolation of axial and transverse displacement, shape (2, 6), at `xi` in [0, 1]."""
    d = 1.0 + phi
    n = np.zeros((2, 6))
    n[0, 0], n[0, 3] = 1.0 - xi, xi
    n[1, 1] = (1 - 3 * xi**2 + 2 * xi**3 + phi * (1 - xi)) / d
    n[1, 2] = length * (xi - 2 * xi**2 + xi**3 + phi / 2 * (xi - xi**2)) / d
    n[1, 4] = (3 * xi**2 - 2 * xi**3 + phi * xi) / d
    n[1, 5] = length * (-(xi**2) + xi**3 - phi / 2 * (xi - xi**2)) / d
    return n


def stiffness(ea: float, ei: float, length: float, phi: float) -> Array:
    """Local stiffness of the flexible part, shape (6, 6), [F/L, F, F L]."""
    k = np.zeros((6, 6))
    k[0, 0] = k[3, 3] = ea / length
    k[0, 3] = k[3, 0] = -ea / length
    a, b = 12 * ei / length**3 / (1 + phi), 6 * ei / length**2 / (1 + phi)
    c, d = (4 + phi) * ei / length / (1 + phi), (2 - phi) * ei / length / (1 + phi)
    k[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = [[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]]
    return k


def end_blocks(at_i: float, at_j: float) -> Array:
    """Local displacements of the flexible ends from those of the nodes, shape (6, 6)."""
    t = np.eye(6)
    t[1, 2], t[4, 5] = at_i, -at_j
    return t


def release(k: Array, pins: list[int]) -> tuple[Array, Array, Array]:
    """Condense pinned rotations.

    Returns
    -------
    forces : ndarray, shape (6, 6)
        End forces from the local displacements, which is the condensed stiffness.
    shape : ndarray, shape (6, 6)
        All local displacements from the kept ones (rows of pinned rotations filled).
    flexibility : ndarray, shape (6, 6)
        Pinned rotations from loads on them.
    """
    keep = [i for i in range(6) if i not in pins]
    shape, flexibility = np.eye(6), np.zeros((6, 6))
    if pins and np.any(k[np.ix_(pins, pins)]):  # an axial bar has no bending stiffness to condense
        inverse = np.linalg.inv(k[np.ix_(pins, pins)])
        shape[np.ix_(pins, pins)] = 0.0
        shape[np.ix_(pins, keep)] = -inverse @ k[np.ix_(pins, keep)]
        flexibility[np.ix_(pins, pins)] = inverse
    forces = k @ shape
    # no rounding may pass for a stiffness: it would hide a mechanism
    forces[pins] = 0.0
    if len(pins) == 2:
        forces[[1, 4]] = 0.0
    return forces, shape, flexibility


def block_mass(m: float, length: float, sign: float) -> Array:
    """Mass of a rigid end block on (axial, transverse, rotation) of its node, shape (3, 3)."""
    s = sign * m * length**2 / 2
    return np.array([[m * length, 0, 0], [0, m * length, s], [0, s, m * length**3 / 3]])


def build(site: Site) -> Parts:
    """Build the member's matrices, loads and end forces."""
    p = site.prop
    if site.j is None:
        raise ElementError("a FRAME member needs two nodes")
    dx, dy = site.j.x - site.i.x, site.j.y - site.i.y
    full = math.hypot(dx, dy)
    length = full - p["END1"] - p["END2"]
    if length <= 0.0:
        raise ElementError(f"no flexible length is left: {full:g} less the end blocks", "END1")
    c, s = direction(dx, dy)
    rotation = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    to_local = np.kron(np.eye(2), rotation)
    ei = p["E"] * p["I"]
    phi = 0.0
    if p["AS"] > 0.0 and ei > 0.0:
        if p["G"] is None:
            raise ElementError("AS (shear deformation) needs G", "AS")
        phi = 12 * ei / (p["G"] * p["AS"] * length**2)
    k = stiffness(p["E"] * p["A"], ei, length, phi)
    pins = {"NONE": [], "I": [2], "J": [5], "BOTH": [2, 5]}[p["PIN"] if ei > 0.0 else "BOTH"]
    forces, shape, flexibility = release(k, pins)
    if ei == 0.0:  # an axial bar stays straight: it hands its loads and mass on as a beam on two pins does
        _, shape, _ = release(stiffness(0.0, 1.0, length, 0.0), pins)
    ends = end_blocks(p["END1"], p["END2"])
    to_ends = ends @ to_local
    from_nodes = shape @ to_ends  # global nodal displacements -> local ends of the flexible part
    freedoms = tuple((n.id, d) for n in (site.i, site.j) for d in range(3))
    parts = Parts(stiffness=[Block(freedoms, to_ends.T @ forces @ to_ends)])

    m = p["WGT"] / site.gravity
    if m > 0.0:
        parts.mass.append(Block(freedoms, _mass(site, m, length, full, phi, from_nodes, to_local)))

    # loads per length (wx, wy global) and point loads, as consistent loads on the flexible ends
    uniform = np.zeros(2)
    points: list[tuple[float, Array]] = []
    if site.self_weight:
        uniform[1] -= p["WGT"]
    for card in site.member_loads:
        uniform += (card["WX"], card["WY"])
        if card["PX"] or card["PY"]:
            points.append((card["AT"], np.array([card["PX"], card["PY"]])))
    turn = rotation[:2, :2]
    equivalent = np.zeros(6)
    for xi, w in zip(_GAUSS_X, _GAUSS_W):
        equivalent += w * length * shapes(xi, length, phi).T @ (turn @ uniform)
    for at, force in points:
        equivalent += shapes(at, length, phi).T @ (turn @ force)
    nodal = from_nodes.T @ equivalent
    for end, block, sign in ((0, p["END1"], 1.0), (3, p["END2"], -1.0)):  # what stands on the rigid blocks
        arm = sign * block / 2 * np.array([c, s])
        nodal[end : end + 2] += uniform * block
        nodal[end + 2] += (arm[0] * uniform[1] - arm[1] * uniform[0]) * block
    if nodal.any():
        parts.loads.append((freedoms, nodal))

    # end forces of the flexible part: k (shape u + flexibility f) - f
    force_rows = forces @ to_ends
    constant = k @ (flexibility @ equivalent) - equivalent
    for name, unit, row, sign in (
        ("axial I", "F", 0, -1.0),  # tension is positive at both ends
        ("axial J", "F", 3, 1.0),
        ("shear I", "F", 1, 1.0),
        ("moment I", "F*L", 2, 1.0),
        ("shear J", "F", 4, 1.0),
        ("moment J", "F*L", 5, 1.0),
    ):
        if row not in (0, 3) and ei == 0.0:
            continue
        parts.outputs.append(
            Output(
                site.element.id,
                name,
                unit,
                freedoms,
                sign * force_rows[row],
                None,
                sign * float(constant[row]),
            )
        )
    return parts


def _mass(
    site: Site, m: float, length: float, full: float, phi: float, from_nodes: Array, to_local: Array
) -> Array:
    """Mass of the member on its global nodal freedoms, shape (6, 6)."""
    p = site.prop
    if not site.consistent:
        half = m * length / 2
        ends = (half + m * p["END1"], half + m * p["END2"])
        return np.diag([ends[0], ends[0], 0.0, ends[1], ends[1], 0.0])
    flexible = np.zeros((6, 6))
    for xi, w in zip(_GAUSS_X, _GAUSS_W):
        n = shapes(xi, length, phi)
        flexible += w * m * length * n.T @ n
    blocks = np.zeros((6, 6))
    blocks[:3, :3] = block_mass(m, p["END1"], 1.0)
    blocks[3:, 3:] = block_mass(m, p["END2"], -1.0)
    return from_nodes.T @ flexible @ from_nodes + to_local.T @ blocks @ to_local


SPEC = Spec(
    "element",
    "FRAME",
    "elastic beam-column",
    (
        Field("E", Kind.REAL, "F/L^2", above=0, doc="modulus of elasticity"),
        Field("A", Kind.REAL, "L^2", above=0, doc="cross-section area"),
        Field("I", Kind.REAL, "L^4", default=0.0, lo=0, doc="second moment of area; 0: an axial bar"),
        Field("G", Kind.REAL, "F/L^2", default=None, above=0, doc="shear modulus, with AS"),
        Field("AS", Kind.REAL, "L^2", default=0.0, lo=0, doc="shear area; 0: no shear deformation"),
        Field(
            "WGT",
            Kind.REAL,
            "F/L",
            default=0.0,
            lo=0,
            doc="self weight per length: mass, and a load in STATIC",
        ),
        Field("END1", Kind.REAL, "L", default=0.0, lo=0, doc="length of the rigid block at I"),
        Field("END2", Kind.REAL, "L", default=0.0, lo=0, doc="length of the rigid block at J"),
        Field(
            "PIN",
            Kind.WORD,
            default="NONE",
            words=("NONE", "I", "J", "BOTH"),
            codes={"NONE": 0, "I": 1, "J": 2, "BOTH": 3},
            doc="which ends turn freely",
        ),
    ),
    reference="Przemieniecki 1968",
    impl=build,
)
