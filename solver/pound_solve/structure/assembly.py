"""Assembly of matrices, laws and load vectors over the DOFs of a model."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial

import numpy as np

from pound_deck.diagnostics import Diagnostic, has_errors
from pound_deck.model import Card, Element, Model
from pound_solve.numerics.matrices import weighted
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import CorotationalMembers
from pound_solve.structure.damping.assembly import add_damping
from pound_solve.structure.dofs import Dof, DofMap, number
from pound_solve.structure.elements.base import ElementContext, ElementError, ElementParts
from pound_solve.structure.mass import MassBlock, ground_inertia, mass_along, nodal_mass, weights
from pound_solve.structure.structure import Structure


class AssemblyError(Exception):
    """Raised if a model cannot be assembled; holds the diagnostics."""

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        super().__init__("; ".join(d.message for d in diagnostics))
        self.diagnostics = diagnostics


def _refusal(model: Model, label: str, message: str, item: str, elements: list[Element]) -> Diagnostic:
    """Return one diagnostic for all elements of a property set that share a mistake."""
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
        Fixed DOFs whose motion is prescribed (supports that move independently).
    self_weight : bool
        Whether the weight of members loads the structure.

    Raises
    ------
    AssemblyError
        An element or a damping group cannot be built; every mistake is listed.
    """
    elements = _Elements(model, self_weight)
    elements.build()
    if elements.problems:
        raise AssemblyError(elements.problems)
    dofs = number(model.nodes, moved, [f for p in elements.ordered() for f in p.internal()])
    structure = _joined(model, dofs, elements)
    structure.remarks = add_damping(structure)
    if has_errors(structure.remarks):
        raise AssemblyError(structure.remarks)
    return structure


def _joined(model: Model, dofs: DofMap, elements: _Elements) -> Structure:
    """Assemble the matrices, laws and loads of all elements, before any damping model is applied."""
    parts, mass = elements.ordered(), elements.mass
    laws = tuple(s for p in parts for s in p.laws)
    law_rows = dofs.rows([(s.dofs, s.row) for s in laws])
    stiffness = dofs.assembled((b.dofs, b.matrix) for p in parts for b in p.stiffness)
    dashpots = dofs.assembled((b.dofs, b.matrix) for p in parts for b in p.damping)
    loads, released = _loads(model, dofs, parts)
    return Structure(
        model=model,
        dofs=dofs,
        stiffness=stiffness,
        initial_stiffness=stiffness + weighted(law_rows, [s.k0 for s in laws]),
        mass=dofs.assembled((b.dofs, b.matrix) for b in mass),
        mass_blocks=tuple(mass),
        damping=dashpots,
        initial_damping=dashpots,
        loads=loads,
        released=released,
        ground=ground_inertia(model, dofs, mass),
        laws=laws,
        law_rows=law_rows,
        outputs=tuple(o for p in parts for o in p.outputs),
        geometric=tuple(g for p in parts for g in p.geometric),
        corotational=_corotational(dofs, parts),
        nodal_mass=elements.nodal_mass,
        self_weight=elements.self_weight,
        parts=elements.parts,
    )


def _corotational(dofs: DofMap, parts: Sequence[ElementParts]) -> CorotationalMembers:
    members = [c for p in parts for c in p.corotational]
    return CorotationalMembers(members, dofs.rows([(c.dofs, row) for c in members for row in c.rows]))


def _loads(model: Model, dofs: DofMap, parts: Sequence[ElementParts]) -> tuple[Array, Array]:
    """Static loads of elements and LOADS, and the part that a history releases at its start, shape (n,)
    each.
    """
    loads, released = np.zeros(dofs.size), np.zeros(dofs.size)
    for p in parts:
        for at, vector in p.loads:
            dofs.add(loads, at, vector)
    for card in model.loads:
        for node in card["NODES"]:
            at, load = tuple((node, d) for d in range(3)), (card["FX"], card["FY"], card["MZ"])
            dofs.add(loads, at, load)
            if card["HELD"] == "NO":
                dofs.add(released, at, load)
    return loads, released


class _Elements:
    """Builder of the elements of a model.

    Contacts are built last, because they need the mass of the nodes.

    Attributes
    ----------
    parts : dict of int to Parts
        Keyed by element number.
    mass : list of MassBlock
        Of nodes and elements.
    nodal_mass : dict of Dof to float
    problems : list of Diagnostic
    """

    def __init__(self, model: Model, self_weight: bool) -> None:
        self.model, self.self_weight = model, self_weight
        self.parts: dict[int, ElementParts] = {}
        self.mass = weights(model)
        self.nodal_mass: dict[Dof, float] = {}
        self.problems: list[Diagnostic] = []
        self._refused: dict[tuple[str, str, str], list[Element]] = {}
        self._loads: dict[int, list[Card]] = {}
        for card in model.member_loads:
            for e in card["ELEMENTS"]:
                self._loads.setdefault(e, []).append(card)

    def build(self) -> None:
        """Build all elements."""
        contacts = []
        for element in self.model.elements.values():
            if self._kind(element) == "CONTACT":
                contacts.append(element)
            else:
                self._build(element)
        self.nodal_mass = nodal_mass(self.model, self.mass)
        for element in contacts:
            self._build(element)
        self.problems += [_refusal(self.model, *why, elements) for why, elements in self._refused.items()]

    def ordered(self) -> list[ElementParts]:
        """Parts of all elements in the order of the model; they are built in another order."""
        return [self.parts[e] for e in self.model.elements]

    def _kind(self, element: Element) -> str:
        return self.model.props[element.prop].spec.name

    def _context(self, element: Element) -> ElementContext:
        model = self.model
        return ElementContext(
            element=element,
            prop=model.props[element.prop],
            i=model.nodes[element.i],
            j=None if element.j is None else model.nodes[element.j],
            gravity=model.gravity,
            consistent=model.mass == "CONSISTENT",
            member_loads=tuple(self._loads.get(element.id, ())),
            self_weight=self.self_weight,
            geometry=model.geometry,
            mass_along=partial(mass_along, model, self.nodal_mass),
            stiffness_along=partial(stiffness_along, model, self.parts),
        )

    def _build(self, element: Element) -> None:
        context, kind = self._context(element), self._kind(element)
        if context.member_loads and kind not in ("FRAME", "BEAM_COLUMN"):
            message = f"element {element.id} is a {kind}: only FRAME and BEAM_COLUMN take member loads"
            self.problems.append(Diagnostic("P331", message, context.member_loads[0].span))
        try:
            parts = _built(context)
        except ElementError as err:
            why = (context.prop.label, str(err), err.item)
            self._refused.setdefault(why, []).append(element)
            return
        self.parts[element.id] = parts
        nodes = frozenset(k for k in (element.i, element.j) if k is not None)
        self.mass += [MassBlock(nodes, b.dofs, b.matrix) for b in parts.mass]


def _built(context: ElementContext) -> ElementParts:
    """Return the parts of an element; raise ElementError also if a number overflows."""
    beyond = "its values and its nodes are too far apart in magnitude to be computed with"
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            parts: ElementParts = context.prop.spec.impl(context)
    except ArithmeticError as err:
        raise ElementError(beyond) from err
    blocks = [b.matrix for b in (*parts.stiffness, *parts.mass, *parts.damping)]
    if not all(np.isfinite(x).all() for x in blocks):
        raise ElementError(beyond)
    return parts


def stiffness_along(
    model: Model, parts: Mapping[int, ElementParts], node: int, normal: tuple[float, float]
) -> dict[int, float]:
    """Axial stiffness [F/L] of the elements at a node along a direction, keyed by element number.

    A rod contributes EA/L times the squared cosine; a zero-length element counts as a rod along the
    direction.
    """
    stiffness = {}
    for name, part in parts.items():
        e, initial = model.elements[name], part.initial()
        at = [n for n, f in enumerate(initial.dofs) if f in ((node, 0), (node, 1))]
        if not at:
            continue
        axis, length = np.array(normal), 0.0
        if e.j is not None:
            i, j = model.nodes[e.i], model.nodes[e.j]
            line = np.array([j.x - i.x, j.y - i.y])
            length = float(np.hypot(*line))
            axis = line / length if length else axis
        t = axis[[initial.dofs[n][1] for n in at]]
        k = float(t @ initial.matrix[np.ix_(at, at)] @ t) * float(axis @ normal) ** 2
        if k > 1e-12 * np.abs(initial.matrix).max():  # a column's cosine may be rounding
            stiffness[name] = k
    return stiffness
