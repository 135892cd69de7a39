"""Assembly of a structure's damping from all cards of DAMPING."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card
from pound_solve.numerics import modes
from pound_solve.numerics.graph import components
from pound_solve.numerics.matrices import Matrix, entries, gathered, weighted
from pound_solve.numerics.types import Array
from pound_solve.structure.buildings import building
from pound_solve.structure.damping.base import CardDamping, DampingContext, DampingError, Dashpots
from pound_solve.structure.damping.secant import SecantLaw
from pound_solve.structure.dofs import label
from pound_solve.structure.elements.base import Role
from pound_solve.structure.proportional import Proportional
from pound_solve.structure.structure import Structure

MECHANISM = "the modes that this damping needs cannot be computed: the structure is a mechanism"


def add_damping(structure: Structure, loaded: Structure | None = None) -> list[Diagnostic]:
    """Add the damping of the DAMPING cards to the matrices and laws of an assembled structure.

    Parameters
    ----------
    structure : Structure
        Its dashpots are assembled; its damping matrices, laws and damping texts are extended.
    loaded : Structure or None
        The structure with the stiffness of the static state, for cards with AFTER=STATIC. None: adds all
        other cards.

    Returns
    -------
    list of Diagnostic
        Errors in the cards, and warnings.
    """
    sources, problems = DampingSources(structure, loaded or structure), list[Diagnostic]()
    # of the tangent and of the secant stiffness
    betas = np.array([[s.beta for s in structure.laws], [s.secant for s in structure.laws]])
    for card in structure.model.damping:
        if (card.values.get("AFTER") == "STATIC") != (loaded is not None):
            continue
        group = _group(card, sources, problems)
        if group is None:
            continue
        for matrix in _matrices(structure, group):
            structure.damping = structure.damping + matrix
        if group.proportional is not None:
            structure.proportional += (group.proportional,)
        if group.dashpots is not None:
            betas[int(group.dashpots.secant)] += _multiples(structure, group.dashpots)
        structure.damping_texts.append((card, group.text))
    structure.initial_damping = structure.damping
    if betas.any():
        initial = betas.sum(axis=0) * [s.k0 for s in structure.laws]
        structure.initial_damping = structure.damping + weighted(structure.law_rows, initial)
        structure.laws = tuple(
            replace(s, beta=beta, secant=secant, law=SecantLaw(s.law.rule, s.law.p) if secant else s.law)
            for s, beta, secant in zip(structure.laws, *betas.tolist())
        )
    return problems


def _group(card: Card, sources: DampingSources, problems: list[Diagnostic]) -> CardDamping | None:
    """Damping of one card; None if the card is in error."""

    def warn(message: str, item: str) -> None:
        problems.append(
            Diagnostic("P346", message, card.place(item), "name modes that there are", "warning")
        )

    context = sources.context(warn)
    try:
        group: CardDamping = card.spec.impl(card, context)
    except DampingError as err:
        problems.append(Diagnostic("P332", str(err), card.place(err.item)))
    except np.linalg.LinAlgError:
        problems.append(Diagnostic("P332", MECHANISM, card.span))
    else:
        return group
    return None


def _matrices(structure: Structure, group: CardDamping) -> list[Matrix]:
    """Damping matrices of a group over all columns, excluding dashpots parallel to laws."""
    matrices = []
    if group.relative is not None:
        n = structure.n_free
        matrices.append(structure.free_block(group.relative))
        if len(structure.dofs.moved):
            matrices.append(_at_supports(structure, group.relative[:n, :n]))
    if group.proportional is not None:
        matrices.append(between_nodes(structure, group.proportional))
    return matrices


def between_nodes(structure: Structure, damping: Proportional) -> Matrix:
    """Damping matrix in proportion to the stiffness of elements, shape (n, n)."""
    elements = structure.model.elements.values()
    chosen = [structure.parts[e.id] for e in elements if damping.elements.has(e)]
    blocks = (b for p in chosen for b in ([p.initial()] if damping.laws else p.stiffness))
    return damping.beta * structure.dofs.assembled((b.dofs, b.matrix) for b in blocks)


def _multiples(structure: Structure, dashpots: Dashpots) -> Array:
    """Factor on each law's stiffness for its parallel dashpot [T], shape (n_laws,)."""
    model = structure.model
    return np.array(
        [
            dashpots.beta
            if s.role is Role.SPRING and dashpots.elements.has(model.elements[s.element])
            else 0.0
            for s in structure.laws
        ]
    )


def _at_supports(structure: Structure, c: Matrix) -> Matrix:
    """Terms at moved supports of a damping that acts on the motion relative to the quasi-static one, shape
    (n, n).
    """
    n, influence = structure.n_free, structure.influence()
    pull = c @ influence
    corners = []
    for corner, i, j in ((-pull, 0, n), (-pull.T, n, 0), (influence.T @ pull, n, n)):
        rows, columns, values = entries(np.asarray(corner))
        corners.append((rows + i, columns + j, values))
    return gathered(structure.stiffness.shape, *(np.concatenate(part) for part in zip(*corners)))


@dataclass(frozen=True)
class DampingSources:
    """Matrices of a structure or of a part of it, and modes of `vibrating`, for `DampingContext`."""

    structure: Structure
    vibrating: Structure

    def context(self, warn: Callable[[str, str], None]) -> DampingContext:
        """Input of a damping model; `warn` takes a message and the item."""
        return DampingContext(self.mass, self.modes, self.building, warn)

    def building(self, name: str) -> Collection[int]:
        """Nodes of the building of that name.

        Raises
        ------
        DampingError
            There is none.
        """
        try:
            return frozenset(building(self.structure, name).nodes)
        except KeyError as err:
            raise DampingError(str(err.args[0]), "BUILDING") from None

    def mass(self, nodes: Collection[int] | None) -> Matrix:
        """Mass matrix of the masses at some nodes (None: of all)."""
        if nodes is None:
            return self.structure.mass
        chosen, terms = frozenset(nodes), []
        for where, at, matrix in self.structure.mass_blocks:
            inside = np.array([f[1] < 3 and f[0] in chosen for f in at])
            if not matrix[np.ix_(inside, ~inside)].any():  # lumped: each node has its own mass
                terms.append((at, np.where(inside[:, None] & inside, matrix, 0.0)))
            else:  # the nodes that can move share a consistent matrix evenly
                loose = {k for k in where if len(set(self.structure.model.nodes[k].fixed)) < 3}
                terms.append((at, matrix * (len(loose & chosen) / max(len(loose), 1))))
        return self.structure.dofs.assembled(terms)

    def modes(self, nodes: Collection[int] | None, count: int | None) -> modes.Modes:
        """The `count` slowest modes (None: all) of the structure, or of the building of these nodes.

        Raises
        ------
        DampingError
            The nodes cannot move, or are not all of a building.
        """
        structure, n = self.vibrating, self.vibrating.n_free
        if nodes is None:
            return structure.vibration(count)
        k, m = structure.initial_stiffness[:n, :n], structure.mass[:n, :n]
        terms = structure.dofs.terms
        named = np.zeros(n, bool)
        named[[i for node in nodes for d in range(3) for i, _ in terms[node, d] if i < n]] = True
        if not named.any():
            raise DampingError("none of these nodes can move", "NODES")
        component = components(n, (k, m))
        inside = np.isin(component, component[named])
        others = [f for f, x in zip(structure.dofs.free, inside & ~named) if x and f[1] < 3]
        if others:
            raise DampingError(
                f"{label(others[0])} is connected to these nodes: only a whole building has modes", "NODES"
            )
        at = np.flatnonzero(inside)
        vibration = modes.solve(k[np.ix_(at, at)], m[np.ix_(at, at)], count)
        shapes = np.zeros((n, len(vibration.omega)))
        shapes[inside] = vibration.shapes
        return modes.Modes(vibration.omega, shapes)
