"""Assembly: a Model becomes matrices, laws and load vectors over its DOFs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Element, Model
from pound_solve.numerics import modes
from pound_solve.numerics.matrices import Matrix, entries, gathered, least_squares, weighted
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import CorotationalMembers
from pound_solve.structure.damping.base import DampingContext, DampingError
from pound_solve.structure.damping.secant import SecantLaw
from pound_solve.structure.dofs import DIRECTIONS, Dof, DofMap, label, number
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementMatrix,
    Geometric,
    LawSpring,
    Output,
    Parts,
    Role,
)


@dataclass
class Structure:
    """The assembled structure; arrays run over `DOFs` columns (unknowns, then prescribed),
    matrices are plain or sparse (see `matrices`).

    Attributes
    ----------
    stiffness : Matrix, shape (n, n)
        Linear stiffness, laws apart [F/L].
    initial_stiffness : Matrix, shape (n, n)
        The same with the initial stiffness of all hysteretic laws.
    mass : Matrix, shape (n, n)
        [F T^2/L]
    damping : Matrix, shape (n, n)
        Dashpots of laws apart [F T/L].
    initial_damping : Matrix, shape (n, n)
        The same with the dashpots of hysteretic laws, at their initial stiffness.
    loads : ndarray, shape (n,)
        Static loads [F].
    released : ndarray, shape (n,)
        Those among them that a history takes off where it starts.
    ground : ndarray, shape (3, n)
        ``M r`` for a unit acceleration of the ground along x and y and in a turn about the origin,
        supports included [F T^2/L], [F T^2].
    laws : tuple of LawSpring
    law_rows : Matrix, shape (n_laws, n)
        Deformation of each law from the DOFs.
    outputs : tuple of Output
        Quantities of the elements outside laws.
    geometric : tuple of Geometric
        Stiffness of the members from their axial forces; empty for small displacements.
    corotational : Chords
        Of the members whose forces follow their displaced line; over all columns.
    nodal_mass : mapping of Dof to float
        Diagonal mass by node and direction, weights and members.
    self_weight : bool
        Whether the weight of members is among the loads.
    parts : mapping of int to Parts
        What every element added, by its number.
    damping_texts : list of (Card, str)
    """

    model: Model
    dofs: DofMap
    stiffness: Matrix
    initial_stiffness: Matrix
    mass: Matrix
    damping: Matrix
    initial_damping: Matrix
    loads: Array
    released: Array
    ground: Array
    laws: tuple[LawSpring, ...]
    law_rows: Matrix
    outputs: tuple[Output, ...]
    geometric: tuple[Geometric, ...]
    corotational: CorotationalMembers
    nodal_mass: dict[Dof, float]
    self_weight: bool
    parts: dict[int, Parts]
    damping_texts: list[tuple[Card, str]] = field(default_factory=list)

    @property
    def n_free(self) -> int:
        """Number of unknown DOFs."""
        return len(self.dofs.free)

    @property
    def held(self) -> Array:
        """Static loads that stay on during a history, shape (n,) [F]."""
        return self.loads - self.released

    @cached_property
    def free_vibration(self) -> modes.Modes:
        """All modes of the initial structure, contacts open."""
        return self.vibration(None)

    def vibration(self, count: int | None) -> modes.Modes:
        """Its `count` slowest modes, or more; None: all."""
        if "free_vibration" in self.__dict__:
            return self.free_vibration
        n = self.n_free
        return modes.solve(self.initial_stiffness[:n, :n], self.mass[:n, :n], count)

    def axial(self, u: Array) -> Array:
        """Axial forces of the members of `geometric` at displacements `u` of all columns [F]."""
        return np.array([self.dofs.value(g.dofs, g.axial, u) + g.constant for g in self.geometric])

    def stressed(self, axial: Array) -> Structure:
        """The structure whose members carry these axial forces, shape (n_geometric,):
        their geometric stiffness is part of it.
        """
        if not len(axial):
            return self
        rows: dict[tuple[int, str], Array] = {}
        blocks: list[ElementMatrix] = []
        for g, force in zip(self.geometric, axial.tolist()):
            blocks.append(ElementMatrix(g.dofs, force * g.matrix))
            for quantity, row in g.forces.items():
                rows[g.element, quantity] = force * row
        matrix = _sum(self.dofs, blocks)
        outputs = tuple(
            replace(o, u_row=o.u_row + rows.get((o.element, o.quantity), 0.0)) for o in self.outputs
        )
        return replace(
            self,
            stiffness=self.stiffness + matrix,
            initial_stiffness=self.initial_stiffness + matrix,
            outputs=outputs,
        )

    def displaced(self, u: Array) -> Structure:
        """The structure whose initial stiffness is that at displacements `u` of the unknowns."""
        if not self.corotational:
            return self
        pad = np.zeros(len(self.dofs.moved))
        k = self.initial_stiffness + self.framed(self.corotational.stiffness(np.append(u, pad)))
        return replace(self, initial_stiffness=k)

    def framed(self, k: Matrix) -> Matrix:
        """The part of a matrix over all columns, or over the unknowns, that is theirs; zeros elsewhere."""
        (i, j, x), n = entries(k), self.n_free
        own = (i < n) & (j < n)
        return gathered(self.stiffness.shape, i[own], j[own], x[own])

    def member_forces(self, u: Array) -> Array:
        """All of `outputs` at displacements `u` of all columns and no velocity, shape (n_outputs,)."""
        linear = [self.dofs.value(o.dofs, o.u_row, u) + o.constant for o in self.outputs]
        if not self.corotational:
            return np.array(linear)
        at, share = self.corotational.shares([(o.element, o.quantity) for o in self.outputs])
        found = self.corotational.envelopes(self.corotational.quantities(u)[None])[0]
        return np.array(linear) + (share * found[at, 1:]).sum(axis=1)

    def influence(self) -> Array:
        """Quasi-static motion of the unknowns for unit prescribed motions, shape (n_free, n_moved)."""
        n = self.n_free
        k = self.initial_stiffness
        return -least_squares(k[:n, :n], k[:n, n:])


class AssemblyError(Exception):
    """The model cannot be assembled; holds the Diagnostics."""

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        super().__init__("; ".join(d.message for d in diagnostics))
        self.diagnostics = diagnostics


def _refusal(model: Model, label: str, message: str, item: str, elements: list[Element]) -> Diagnostic:
    """What is wrong with the elements of one property set, told once."""
    first, *others = elements
    more = f" and {len(others)} more" if others else ""
    return Diagnostic(
        "P330",
        f"element {first.id}{more} ({label}): {message}",
        model.props[label].place(item),
        hint=f"element {first.id} stands at {first.span}",
    )


def assemble(model: Model, moved: Collection[Dof] = (), self_weight: bool = True) -> Structure:
    """Assemble a model.

    Parameters
    ----------
    model : Model
    moved : collection of Dof
        Fixed DOFs whose motion is prescribed (supports that move apart from each other).
    self_weight : bool
        Whether the weight of members loads the structure.

    Raises
    ------
    AssemblyError
        An element or a damping group cannot be built; every mistake is listed.
    """
    problems: list[Diagnostic] = []
    # the mass of the nodes comes first: contacts need it
    mass_terms: list[tuple[frozenset[int], tuple[Dof, ...], Array]] = []
    for card in model.weights:
        wy = card["WX"] if card["WY"] is None else card["WY"]
        diagonal = np.array([card["WX"], wy, card["WR"]]) / model.gravity
        for node in card["NODES"]:
            mass_terms.append((frozenset([node]), tuple((node, d) for d in range(3)), np.diag(diagonal)))

    loads_of: dict[int, list[Card]] = {}
    for card in model.member_loads:
        for e in card["ELEMENTS"]:
            loads_of.setdefault(e, []).append(card)
    nodal_mass: dict[Dof, float] = {}

    parts: dict[int, Parts] = {}
    contacts_last = sorted(
        model.elements.values(), key=lambda e: model.props[e.prop].spec.name == "CONTACT"
    )
    masses_known = False
    refused: dict[tuple[str, str, str], list[Element]] = {}
    for element in contacts_last:
        prop = model.props[element.prop]
        if prop.spec.name == "CONTACT" and not masses_known:
            _add_diagonals(mass_terms, model, nodal_mass)
            masses_known = True
        context = ElementContext(
            element,
            prop,
            model.nodes[element.i],
            None if element.j is None else model.nodes[element.j],
            model.gravity,
            model.mass == "CONSISTENT",
            tuple(loads_of.pop(element.id, ())),
            self_weight,
            model.geometry,
            partial(mass_along, model, nodal_mass),
            partial(stiffness_along, model, parts),
        )
        if context.member_loads and prop.spec.name not in ("FRAME", "BEAM_COLUMN"):
            wrong = f"element {element.id} is a {prop.spec.name}"
            message = f"{wrong}: only FRAME and BEAM_COLUMN take member loads"
            problems.append(Diagnostic("P331", message, context.member_loads[0].span))
        try:
            parts[element.id] = prop.spec.impl(context)
        except ElementError as err:
            refused.setdefault((prop.label, str(err), err.item), []).append(element)
            continue
        nodes = frozenset(k for k in (element.i, element.j) if k is not None)
        mass_terms += [(nodes, b.dofs, b.matrix) for b in parts[element.id].mass]
    if not masses_known:
        _add_diagonals(mass_terms, model, nodal_mass)
    problems += [_refusal(model, *why, elements) for why, elements in refused.items()]
    if problems:
        raise AssemblyError(problems)
    ordered = [parts[e] for e in model.elements]
    dofs = number(model.nodes, moved, [f for p in ordered for f in p.internal()])
    n = dofs.size

    laws = tuple(s for p in ordered for s in p.laws)
    rows = dofs.rows([(s.dofs, s.row) for s in laws])
    k_linear = _sum(dofs, (b for p in ordered for b in p.stiffness))
    c = _sum(dofs, (b for p in ordered for b in p.damping))
    loads, released = np.zeros(n), np.zeros(n)
    for p in ordered:
        for at, vector in p.loads:
            dofs.add(loads, at, vector)
    for card in model.loads:
        for node in card["NODES"]:
            at, push = tuple((node, d) for d in range(3)), (card["FX"], card["FY"], card["MZ"])
            dofs.add(loads, at, push)
            if card["HELD"] == "NO":
                dofs.add(released, at, push)
    mass = _sum(dofs, (ElementMatrix(at, matrix) for _, at, matrix in mass_terms))
    ground = np.zeros((3, n))
    for _, at, matrix in mass_terms:
        for d in range(3):
            dofs.add(ground[d], at, matrix @ [_ridden(model, f, d) for f in at])
    k0 = k_linear + weighted(rows, [s.k0 for s in laws])
    corotational = [c for p in ordered for c in p.corotational]

    structure = Structure(
        model,
        dofs,
        k_linear,
        k0,
        mass,
        c,
        c,
        loads,
        released,
        ground,
        laws,
        rows,
        tuple(o for p in ordered for o in p.outputs),
        tuple(g for p in ordered for g in p.geometric),
        CorotationalMembers(
            corotational, dofs.rows([(c.dofs, row) for c in corotational for row in c.rows])
        ),
        nodal_mass,
        self_weight,
        parts,
    )
    _add_damping(structure, mass_terms, parts, problems)
    if problems:
        raise AssemblyError(problems)
    return structure


def mass_along(
    model: Model, nodal_mass: Mapping[Dof, float], node: int, normal: tuple[float, float]
) -> float:
    """Mass of a node felt along an oblique direction, 1/m = sum n_d^2 / m_d over directions that can move;
    infinite where none can [F T^2/L].
    """
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


def stiffness_along(
    model: Model, parts: Mapping[int, Parts], node: int, normal: tuple[float, float]
) -> dict[int, float]:
    """Axial stiffness [F/L] along a direction of the elements that meet a node, by their number.

    That of a rod, EA/L, times the squared cosine; what has no length is a rod along the direction.
    """
    out = {}
    for name, own in parts.items():
        e, initial = model.elements[name], own.initial()
        at = [n for n, f in enumerate(initial.dofs) if f in ((node, 0), (node, 1))]
        if not at:
            continue
        way, length = np.array(normal), 0.0
        if e.j is not None:
            i, j = model.nodes[e.i], model.nodes[e.j]
            line = np.array([j.x - i.x, j.y - i.y])
            length = float(np.hypot(*line))
            way = line / length if length else way
        t = way[[initial.dofs[n][1] for n in at]]
        k = float(t @ initial.matrix[np.ix_(at, at)] @ t) * float(way @ normal) ** 2
        if k > 1e-12 * np.abs(initial.matrix).max():  # a column's cosine may be rounding
            out[name] = k
    return out


def _ridden(model: Model, dof: Dof, d: int) -> float:
    """Motion of a DOF that rides on the ground, which moves by one along `d`
    (2: turns about the origin).
    """
    owner, own = dof
    if own > 2:  # what is inside an element turns against its nodes
        return 0.0
    if d < 2:
        return float(own == d)
    node = model.nodes[owner]
    return (-node.y, node.x, 1.0)[own]


def _add_diagonals(
    terms: list[tuple[frozenset[int], tuple[Dof, ...], Array]], model: Model, out: dict[Dof, float]
) -> None:
    for _, at, matrix in terms:
        for a, dof in enumerate(at):
            # a consistent matrix is summed along the row of its own direction:
            # the node's share of rigid motion
            same = [b for b, other in enumerate(at) if other[1] == dof[1]] if dof[1] < 2 else [a]
            out[dof] = out.get(dof, 0.0) + float(matrix[a, same].sum())
    # what follows a master is felt at the master
    for node in model.nodes.values():
        for letter, master in node.slaved.items():
            d = DIRECTIONS.index(letter)
            out[master, d] = out.get((master, d), 0.0) + out.get((node.id, d), 0.0)


def _sum(dofs: DofMap, blocks: Iterable[ElementMatrix]) -> Matrix:
    """Sum of small matrices at their DOFs, through slaving, shape (n, n)."""
    rows, columns, values = [], [], []
    for block in blocks:
        terms = [dofs.terms[f] for f in block.dofs]
        for own, line in zip(terms, block.matrix.tolist()):
            for other, value in zip(terms, line):
                if value != 0.0:
                    for i, fi in own:
                        for j, fj in other:
                            rows.append(i)
                            columns.append(j)
                            values.append(value * fi * fj)
    return gathered((dofs.size, dofs.size), rows, columns, values)


def _add_damping(
    structure: Structure,
    mass_terms: list[tuple[frozenset[int], tuple[Dof, ...], Array]],
    parts: dict[int, Parts],
    problems: list[Diagnostic],
) -> None:
    model, dofs, n = structure.model, structure.dofs, structure.n_free

    def mass_of(nodes: Collection[int] | None) -> Matrix:
        if nodes is None:
            return structure.mass
        blocks, chosen = list[ElementMatrix](), frozenset(nodes)
        for where, at, matrix in mass_terms:
            inside = np.array([f[1] < 3 and f[0] in chosen for f in at])
            if not matrix[np.ix_(inside, ~inside)].any():  # lumped: each node takes its own
                blocks.append(ElementMatrix(at, np.where(inside[:, None] & inside, matrix, 0.0)))
            else:  # a consistent matrix is shared evenly by the nodes that can move
                loose = {k for k in where if len(set(model.nodes[k].fixed)) < 3}
                blocks.append(ElementMatrix(at, matrix * (len(loose & chosen) / max(len(loose), 1))))
        return _sum(dofs, blocks)

    def stiffness_of(labels: Collection[str] | None, laws: bool) -> Matrix:
        chosen = [parts[e.id] for e in model.elements.values() if labels is None or e.prop in labels]
        return _sum(dofs, (b for p in chosen for b in ([p.initial()] if laws else p.stiffness)))

    def modes_of(nodes: Collection[int] | None, count: int | None) -> modes.Modes:
        if nodes is None:
            return structure.vibration(count)
        k, m = structure.initial_stiffness[:n, :n], structure.mass[:n, :n]
        named = np.zeros(n, bool)
        named[[i for k in nodes for d in range(3) for i, _ in dofs.terms[k, d] if i < n]] = True
        if not named.any():
            raise DampingError("none of these nodes can move", "NODES")
        linked, inside = abs(k) + abs(m), named
        while (more := inside | (linked @ inside > 0.0)).sum() > inside.sum():
            inside = more
        strange = [f for f, x in zip(dofs.free, inside & ~named) if x and f[1] < 3]
        if strange:
            raise DampingError(
                f"{label(strange[0])} hangs together with these nodes: only a whole building has modes",
                "NODES",
            )
        at = np.flatnonzero(inside)
        own = modes.solve(k[np.ix_(at, at)], m[np.ix_(at, at)], count)
        shapes = np.zeros((n, len(own.omega)))
        shapes[inside] = own.shapes
        return modes.Modes(own.omega, shapes)

    betas = np.zeros((2, len(structure.laws)))  # tangent, secant
    for card in model.damping:
        try:
            group = card.spec.impl(card, DampingContext(mass_of, stiffness_of, modes_of))
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
            structure.damping = structure.damping + structure.framed(group.relative)
            if len(dofs.moved):
                structure.damping = structure.damping + _against(structure, group.relative[:n, :n])
        if group.between is not None:
            structure.damping = structure.damping + group.between
        if group.dashpots is not None:
            labels, beta, by_secant = group.dashpots
            for i, s in enumerate(structure.laws):
                if s.role is Role.SPRING and (labels is None or model.elements[s.element].prop in labels):
                    betas[int(by_secant), i] += beta
        structure.damping_texts.append((card, group.text))
    structure.initial_damping = structure.damping
    if betas.any():
        follow = betas.sum(axis=0) * [s.k0 for s in structure.laws]
        structure.initial_damping = structure.damping + weighted(structure.law_rows, follow)
        structure.laws = tuple(
            replace(s, beta=beta, secant=secant, law=SecantLaw(s.law.rule, s.law.p) if secant else s.law)
            for s, beta, secant in zip(structure.laws, *betas.tolist())
        )


def _against(structure: Structure, c: Matrix) -> Matrix:
    """What a damping of the unknowns adds at moved supports, if it acts on the motion relative to the
    quasi-static one, shape (n, n).
    """
    n, follow = structure.n_free, structure.influence()
    pull = c @ follow
    out = []
    for corner, i, j in ((-pull, 0, n), (-pull.T, n, 0), (follow.T @ pull, n, n)):
        rows, columns, values = entries(np.asarray(corner))
        out.append((rows + i, columns + j, values))
    return gathered(structure.stiffness.shape, *(np.concatenate(part) for part in zip(*out)))
