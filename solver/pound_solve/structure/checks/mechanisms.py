"""Checks for mechanisms within a building, and for periods implausible for its height."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_solve.loading.motions.base import METRE
from pound_solve.numerics import modes
from pound_solve.numerics.matrices import Matrix, scaled, used_rows
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.buildings import Building, buildings, columns_of, stands
from pound_solve.structure.checks.members import members_by_set
from pound_solve.structure.checks.supports import ROUNDING, resisted, shaken, some
from pound_solve.structure.dofs import DIRECTIONS
from pound_solve.structure.structure import Structure

#: fraction of a motion's largest displacement above which a node counts as moving
MOVING_RATIO: Final = 0.1
MIN_STEPS_PER_PERIOD: Final = 10  #: steps in a first period
MAX_SHAPE_DIFFERENCE: Final = 1e-6  #: fraction of a motion by which that of one body may differ
#: 4 H/T, the speed of a shear wave up a building [m/s]: walls and stiff frames have 100 to 500, a solid
#: block of concrete 2200
MAX_WAVE_SPEED: Final = 1000.0


def find_mechanisms(
    structure: Structure, parts: Sequence[tuple[Building, BuildingStiffness]]
) -> list[Diagnostic]:
    """Report buildings of members whose nodes can move although the base is held, as with too many pins."""
    problems = list[Diagnostic]()
    for b, part in parts:
        unresisted = part.unresisted_motions()
        bent = [m for m in unresisted[:, ~_allowed(structure, unresisted)].T if not _rigid(structure, b, m)]
        problems += [_mechanism(structure, b, motion) for motion in bent[:1]]
    return problems


def implausible_periods(
    structure: Structure, parts: Sequence[tuple[Building, BuildingStiffness]]
) -> Iterator[tuple[str, Diagnostic]]:
    """Yield the names of buildings whose first period is implausible for their height, each with a warning.

    A building slower than an inverted pendulum of its height falls over under its own weight.  Buildings on
    springs may be rigid on purpose.
    """
    model = structure.model
    framed = {
        e.i for members in members_by_set(model).values() for e in members if model.props[e.prop]["I"]
    }
    sprung = {e.i for e in model.elements.values() if model.props[e.prop].spec.name == "SPRING"}
    metre = METRE.get(model.units.length.lower(), math.inf)
    for b, part in parts:
        t1 = part.period
        high = max(model.nodes[n].y for n in b.nodes) - b.base
        if not t1 or high <= 0.0:
            continue
        slowest = 2.0 * math.pi * math.sqrt(high / model.gravity)
        high = max(b.levels) - b.base  # height of the mass that sways; a massless mast may rise above it
        speed = 4.0 * high / t1
        if t1 > slowest:
            limit, why = f"above {slowest:.3g}", "it would fall by its own weight"
        elif speed > MAX_WAVE_SPEED * metre and framed & set(b.nodes) and not sprung & set(b.nodes):
            shortest = 4.0 * high / (MAX_WAVE_SPEED * metre)
            limit, why = f"below {shortest:.2g}", "a solid block is hardly stiffer"
        else:
            continue
        yield b.name, _period(structure, b, t1, limit, why)


def _period(structure: Structure, b: Building, t1: float, limit: str, why: str) -> Diagnostic:
    model, unit = structure.model, structure.model.units
    message = f"the first period of {b.name!r} is about {t1:.2g} {unit.time}, {limit} {unit.time}: {why}"
    hint = (
        f"check the units of WEIGHTS ({unit.force}), E ({unit.text('F/L^2')}), I, stiffnesses and lengths, "
        "and GRAVITY"
    )
    return Diagnostic("P357", message, model.nodes[b.feet[0]].span, hint, "warning")


def coarse_steps(
    structure: Structure, parts: Sequence[tuple[Building, BuildingStiffness]]
) -> list[Diagnostic]:
    """Report histories of fewer than `MIN_STEPS_PER_PERIOD` steps in the first period of each building, and
    output intervals longer than that period.
    """
    model, problems = structure.model, list[Diagnostic]()
    longest, unit = max((part.period for _, part in parts), default=0.0), model.units.time
    for card in (c for c in model.analyses if c.spec.name == "HISTORY" and longest):
        first = f"a motion whose first period is about {longest:.2g} {unit}"
        dt, every = card.values.get("DT"), model.output["EVERY"]
        if dt is not None and longest < MIN_STEPS_PER_PERIOD * dt:
            message = f"steps of DT={dt:g} {unit} do not follow {first}"
            hint = f"DT is a time in {unit}: a hundredth of the first period is usual"
            problems.append(Diagnostic("P365", message, card.place("DT"), hint, "warning"))
        if every is not None and longest < every < card["T"]:
            message = f"rows every {every:g} {unit} do not show {first}"
            hint = f"EVERY is a time in {unit}; peaks are found between the rows, too"
            problems.append(Diagnostic("P365", message, model.output.place("EVERY"), hint, "warning"))
    return problems


def supported_parts(structure: Structure) -> list[tuple[Building, BuildingStiffness]]:
    """Return the buildings with a height that the ground shakes along x, with their stiffness, if it can be
    computed.
    """
    model, pairs = structure.model, list[tuple[Building, BuildingStiffness]]()
    if "X" not in shaken(model):
        return pairs
    tall = [b for b in buildings(structure) if stands(model, b.nodes)]
    for b, columns in zip(tall, columns_of(model, structure.dofs.free, [b.nodes for b in tall])):
        if part := _part(structure, columns):
            pairs.append((b, part))
    return pairs


def _part(structure: Structure, columns: Index) -> BuildingStiffness | None:
    """Stiffness of a building; None if its numbers overflow or the decomposition fails."""
    try:
        with np.errstate(all="ignore"):
            return BuildingStiffness(structure, columns)
    except (np.linalg.LinAlgError, ArithmeticError):
        return None


class BuildingStiffness:
    """Stiffness of a building with open contacts, scaled to a unit diagonal, without unrestrained
    rotations.
    """

    def __init__(self, structure: Structure, columns: Index) -> None:
        k = structure.initial_stiffness[: structure.n_free, : structure.n_free]
        shifts = np.array([structure.dofs.free[c][1] < 2 for c in columns.tolist()], bool)
        self.columns = columns[shifts | used_rows(k[columns][:, columns])]
        stiffness = k[self.columns][:, self.columns]
        self.structure, self.factors = structure, modes.scaling(stiffness)
        self.scaled_stiffness = modes.SingularStiffness(scaled(stiffness, self.factors))

    def unresisted_motions(self) -> Array:
        """Motions that the stiffness does not resist, shape (n, n_motions), over all columns."""
        unresisted = self.scaled_stiffness.null_space.copy()
        unresisted[abs(unresisted) < ROUNDING] = 0.0  # otherwise rounding counts as a deformation
        motions = np.zeros((self.structure.dofs.size, unresisted.shape[1]))
        motions[self.columns] = self.factors[:, None] * unresisted
        return motions

    @cached_property
    def period(self) -> float:
        """First period along x by Rayleigh's quotient of the displacements under its weight along x [T]; 0
        where there is none.
        """
        push = self.structure.ground[0, self.columns]
        work = float(push @ self.sag) if self.sag is not None else 0.0
        ratio = self._inertia / work if work > 0.0 else 0.0
        return 2.0 * math.pi * math.sqrt(ratio) if 0.0 < ratio < math.inf else 0.0

    def damped(self, damping: Matrix) -> float:
        """Share of critical damping that a matrix over all columns gives this motion; 0 without period."""
        t1 = self.period
        return self._form(damping) * t1 / (4.0 * math.pi * self._inertia) if t1 else 0.0

    @cached_property
    def _inertia(self) -> float:
        return self._form(self.structure.mass)

    @cached_property
    def sag(self) -> Array | None:
        """Displacements of `columns` under its weight along x; None for a mechanism."""
        if self.scaled_stiffness.null_space.shape[1] or self.scaled_stiffness.negative is not None:
            return None
        with np.errstate(all="ignore"):
            try:
                push = self.structure.ground[0, self.columns]
                return np.asarray(self.factors * self.scaled_stiffness.solve(self.factors * push))
            except np.linalg.LinAlgError:
                return None

    def _form(self, matrix: Matrix) -> float:
        """Quadratic form of the displacements under the weight along x with a matrix over all columns; 0
        for a mechanism.
        """
        if self.sag is None:
            return 0.0
        with np.errstate(all="ignore"):
            return float(self.sag @ (matrix[self.columns][:, self.columns] @ self.sag))


def _allowed(structure: Structure, unresisted: Array) -> Flags:
    """Whether each of the motions `unresisted` is resisted by dashpots, closed contacts or other laws, or
    moves no node.
    """
    shifts = [i for i, (_, d) in enumerate(structure.dofs.free) if d < 2]
    still = np.abs(unresisted[shifts]).max(axis=0, initial=0.0) == 0.0
    return np.asarray(still | resisted(structure, unresisted, touching=True).any(axis=0))


def _rigid(structure: Structure, b: Building, motion: Array) -> bool:
    """Whether a motion moves a building as one body, its supports included."""
    x, y = np.array([(structure.model.nodes[n].x, structure.model.nodes[n].y) for n in b.nodes]).T
    one, none = np.ones(len(x)), np.zeros(len(x))
    body = np.column_stack([np.append(one, none), np.append(none, one), np.append(-y, x)])
    moved = structure.dofs.matrix([(n, d) for d in range(2) for n in b.nodes]) @ motion
    left = moved - body @ np.linalg.lstsq(body, moved, rcond=None)[0]
    return bool(abs(left).max() <= MAX_SHAPE_DIFFERENCE * abs(moved).max())


def _mechanism(structure: Structure, b: Building, motion: Array) -> Diagnostic:
    model, free = structure.model, structure.dofs.free
    shifts = [(abs(motion[i]), owner, d) for i, (owner, d) in enumerate(free) if d < 2]
    most = max(shifts)[0]
    moved = [(owner, d) for x, owner, d in shifts if x > MOVING_RATIO * most]
    _, first = moved[0]
    nodes = sorted({owner for owner, d in moved if d == first})
    who = f"node{'s' * (len(nodes) > 1)} {some(nodes)}"
    message = f"nothing holds {who} of {b.name!r} along {DIRECTIONS[first]}: the building is a mechanism"
    hint = "take out a PIN, fix R of its base, or add a member"
    return Diagnostic("P356", message, model.nodes[nodes[0]].span, hint, "warning")
