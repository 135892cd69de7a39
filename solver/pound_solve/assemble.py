"""Assembly: a Model becomes matrices, laws and load vectors over its freedoms."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve import modes
from pound_solve.damping.base import DampingError, Ground
from pound_solve.dofs import DIRECTIONS, Freedom, Freedoms, number
from pound_solve.elements.base import ElementError, LawSpring, Output, Parts, Site

Array = NDArray[np.float64]


@dataclass
class Structure:
    """The assembled structure; arrays run over `freedoms` columns (unknowns, then prescribed).

    Attributes
    ----------
    stiffness : ndarray, shape (n, n)
        Linear stiffness, laws apart [F/L].
    initial_stiffness : ndarray, shape (n, n)
        The same with the initial stiffness of all hysteretic laws.
    mass : ndarray, shape (n, n)
        [F T^2/L]
    damping : ndarray, shape (n, n)
        [F T/L]
    loads : ndarray, shape (n,)
        Static loads [F].
    ground : ndarray, shape (2, n)
        ``M r`` for a unit ground acceleration along x and y, supports included [F T^2/L].
    laws : tuple of LawSpring
    law_rows : ndarray, shape (n_laws, n)
        Deformation of each law from the freedoms.
    outputs : tuple of Output
        Quantities of the elements outside laws.
    nodal_mass : mapping of Freedom to float
        Diagonal mass by node and direction, weights and members.
    self_weight : bool
        Whether the weight of members is among the loads.
    damping_texts : list of (Card, str)
    """

    model: Model
    freedoms: Freedoms
    stiffness: Array
    initial_stiffness: Array
    mass: Array
    damping: Array
    loads: Array
    ground: Array
    laws: tuple[LawSpring, ...]
    law_rows: Array
    outputs: tuple[Output, ...]
    nodal_mass: dict[Freedom, float]
    self_weight: bool
    damping_texts: list[tuple[Card, str]] = field(default_factory=list)

    @property
    def n_free(self) -> int:
        """Number of unknown freedoms."""
        return len(self.freedoms.free)

    @cached_property
    def free_vibration(self) -> modes.Modes:
        """Modes of the initial structure, contacts open."""
        n = self.n_free
        return modes.solve(self.initial_stiffness[:n, :n], self.mass[:n, :n])

    def influence(self) -> Array:
        """Quasi-static motion of the unknowns for unit prescribed motions, shape (n_free, n_moved)."""
        n = self.n_free
        k = self.initial_stiffness
        return -np.asarray(np.linalg.lstsq(k[:n, :n], k[:n, n:], rcond=None)[0], float)


class AssemblyError(Exception):
    """The model cannot be assembled; holds the Diagnostics."""

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        super().__init__("; ".join(d.message for d in diagnostics))
        self.diagnostics = diagnostics


def assemble(model: Model, moved: Collection[Freedom] = (), self_weight: bool = True) -> Structure:
    """Assemble a model.

    Parameters
    ----------
    model : Model
    moved : collection of Freedom
        Fixed freedoms whose motion is prescribed (supports that move apart from each other).
    self_weight : bool
        Whether the weight of members loads the structure.

    Raises
    ------
    AssemblyError
        An element or a damping group cannot be built; every mistake is listed.
    """
    problems: list[Diagnostic] = []
    # the mass of the nodes comes first: contacts need it
    mass_terms: list[tuple[frozenset[int], tuple[Freedom, ...], Array]] = []
    for card in model.weights:
        wy = card["WX"] if card["WY"] is None else card["WY"]
        diagonal = np.array([card["WX"], wy, card["WR"]]) / model.gravity
        for node in card["NODES"]:
            mass_terms.append((frozenset([node]), tuple((node, d) for d in range(3)), np.diag(diagonal)))

    loads_of: dict[int, list[Card]] = {}
    for card in model.member_loads:
        for e in card["ELEMENTS"]:
            loads_of.setdefault(e, []).append(card)
    nodal_mass: dict[Freedom, float] = {}

    def mass_along(node: int, normal: tuple[float, float]) -> float:
        # mass felt along an oblique direction: 1/m = sum n_d^2 / m_d over directions that can move
        inverse = 0.0
        for d, component in enumerate(normal):
            own = model.nodes[node]
            at = (own.slaved.get(DIRECTIONS[d], node), d)
            if component == 0.0 or DIRECTIONS[d] in own.fixed or DIRECTIONS[d] in model.nodes[at[0]].fixed:
                continue
            if nodal_mass.get(at, 0.0) == 0.0:
                return 0.0
            inverse += component**2 / nodal_mass[at]
        return np.inf if inverse == 0.0 else 1.0 / inverse

    parts: dict[int, Parts] = {}
    contacts_last = sorted(
        model.elements.values(), key=lambda e: model.props[e.prop].spec.name == "CONTACT"
    )
    masses_known = False
    for element in contacts_last:
        prop = model.props[element.prop]
        if prop.spec.name == "CONTACT" and not masses_known:
            _add_diagonals(mass_terms, model, nodal_mass)
            masses_known = True
        site = Site(
            element,
            prop,
            model.nodes[element.i],
            None if element.j is None else model.nodes[element.j],
            model.gravity,
            model.mass == "CONSISTENT",
            tuple(loads_of.pop(element.id, ())),
            self_weight,
            mass_along,
        )
        if site.member_loads and prop.spec.name != "FRAME":
            problems.append(
                Diagnostic(
                    "P331",
                    f"element {element.id} is a {prop.spec.name}: only FRAME takes member loads",
                    site.member_loads[0].span,
                )
            )
        try:
            parts[element.id] = prop.spec.impl(site)
        except ElementError as err:
            problems.append(
                Diagnostic(
                    "P330",
                    f"element {element.id} ({prop.label}): {err}",
                    prop.place(err.item),
                    hint=f"element {element.id} stands at {element.span}",
                )
            )
            continue
        nodes = frozenset(k for k in (element.i, element.j) if k is not None)
        mass_terms += [(nodes, b.freedoms, b.matrix) for b in parts[element.id].mass]
    if not masses_known:
        _add_diagonals(mass_terms, model, nodal_mass)
    if problems:
        raise AssemblyError(problems)
    ordered = [parts[e] for e in model.elements]
    freedoms = number(model.nodes, moved, [f for p in ordered for f in p.internal()])
    n = freedoms.size

    laws = tuple(s for p in ordered for s in p.laws)
    rows = np.array([freedoms.row(s.freedoms, s.row) for s in laws]).reshape(len(laws), n)
    k_linear, c = np.zeros((n, n)), np.zeros((n, n))
    loads = np.zeros(n)
    for p in ordered:
        for b in p.stiffness:
            _scatter(k_linear, freedoms, b.freedoms, b.matrix)
        for b in p.damping:
            _scatter(c, freedoms, b.freedoms, b.matrix)
        for at, vector in p.loads:
            loads += freedoms.row(at, vector)
    for card in model.loads:
        for node in card["NODES"]:
            loads += freedoms.row([(node, d) for d in range(3)], [card["FX"], card["FY"], card["MZ"]])
    mass = np.zeros((n, n))
    ground = np.zeros((2, n))
    for _, at, matrix in mass_terms:
        _scatter(mass, freedoms, at, matrix)
        for d in range(2):
            ground[d] += freedoms.row(at, matrix @ [1.0 if f[1] == d else 0.0 for f in at])
    k0 = k_linear + (rows.T * [s.k0 for s in laws]) @ rows

    structure = Structure(
        model,
        freedoms,
        k_linear,
        k0,
        mass,
        c,
        loads,
        ground,
        laws,
        rows,
        tuple(o for p in ordered for o in p.outputs),
        nodal_mass,
        self_weight,
    )
    _add_damping(structure, mass_terms, parts, problems)
    if problems:
        raise AssemblyError(problems)
    return structure


def _add_diagonals(
    terms: list[tuple[frozenset[int], tuple[Freedom, ...], Array]], model: Model, out: dict[Freedom, float]
) -> None:
    for _, at, matrix in terms:
        for a, freedom in enumerate(at):
            # a consistent matrix is summed along the row of its own direction:
            # the node's share of rigid motion
            same = [b for b, other in enumerate(at) if other[1] == freedom[1]] if freedom[1] < 2 else [a]
            out[freedom] = out.get(freedom, 0.0) + float(matrix[a, same].sum())
    # what follows a master is felt at the master
    for node in model.nodes.values():
        for letter, master in node.slaved.items():
            d = DIRECTIONS.index(letter)
            out[master, d] = out.get((master, d), 0.0) + out.get((node.id, d), 0.0)


def _scatter(out: Array, freedoms: Freedoms, at: tuple[Freedom, ...], matrix: Array) -> None:
    """Add a small matrix at its freedoms, through slaving."""
    columns = [freedoms.terms[f] for f in at]
    for a, row in enumerate(columns):
        for b, col in enumerate(columns):
            value = matrix[a, b]
            if value != 0.0:
                for i, fi in row:
                    for j, fj in col:
                        out[i, j] += value * fi * fj


def _add_damping(
    structure: Structure,
    mass_terms: list[tuple[frozenset[int], tuple[Freedom, ...], Array]],
    parts: dict[int, Parts],
    problems: list[Diagnostic],
) -> None:
    model, freedoms, n = structure.model, structure.freedoms, structure.n_free

    def mass_of(nodes: Collection[int] | None) -> Array:
        if nodes is None:
            return structure.mass
        out, chosen = np.zeros_like(structure.mass), frozenset(nodes)
        for where, at, matrix in mass_terms:
            inside = np.array([f[0] in chosen for f in at])
            if not matrix[np.ix_(inside, ~inside)].any():  # lumped: each node takes its own
                _scatter(out, freedoms, at, np.where(inside[:, None] & inside, matrix, 0.0))
            else:  # a consistent matrix is shared evenly by the nodes that can move
                loose = {k for k in where if len(set(model.nodes[k].fixed)) < 3}
                _scatter(out, freedoms, at, matrix * (len(loose & chosen) / max(len(loose), 1)))
        return out

    def stiffness_of(labels: Collection[str] | None) -> Array:
        if labels is None:
            return structure.initial_stiffness
        out = np.zeros_like(structure.stiffness)
        for e in model.elements.values():
            if e.prop in labels:
                for b in parts[e.id].stiffness:
                    _scatter(out, freedoms, b.freedoms, b.matrix)
                for s in parts[e.id].laws:
                    _scatter(out, freedoms, s.freedoms, s.k0 * np.outer(s.row, s.row))
        return out

    def all_modes() -> tuple[Array, Array, Array]:
        return structure.free_vibration.omega, structure.free_vibration.shapes, structure.mass[:n, :n]

    def pad(matrix: Array) -> Array:
        out = np.zeros_like(structure.mass)
        out[:n, :n] = matrix
        return out

    for card in model.damping:
        try:
            group = card.spec.impl(card, Ground(mass_of, stiffness_of, all_modes, pad))
        except DampingError as err:
            problems.append(Diagnostic("P332", str(err), card.place(err.item)))
            continue
        except np.linalg.LinAlgError:
            problems.append(
                Diagnostic(
                    "P332",
                    "the modes that this damping needs cannot be computed: the structure is a mechanism",
                    card.span,
                )
            )
            continue
        if group.relative is not None:
            free = group.relative[:n, :n]
            structure.damping[:n, :n] += free
            if len(freedoms.moved):
                follow = structure.influence()
                structure.damping[:n, n:] -= free @ follow
                structure.damping[n:, :n] -= follow.T @ free
                structure.damping[n:, n:] += follow.T @ free @ follow
        if group.between is not None:
            structure.damping += group.between
        structure.damping_texts.append((card, group.text))
