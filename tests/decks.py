"""Decks in tests: from a text to a model, a structure, a static result or a reduced system; from a file to
results.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pound_deck.diagnostics import has_errors, render
from pound_deck.model import Model
from pound_deck.reader import read_text
from pound_solve.analyses import history_start, static
from pound_solve.catalog import catalog
from pound_solve.driver import run as driver
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.motions.wave import fronts
from pound_solve.numerics.types import Array
from pound_solve.results import Results
from pound_solve.structure import reduction
from pound_solve.structure.assembly import assemble
from pound_solve.structure.condensation import condense
from pound_solve.structure.dofs import Dof
from pound_solve.structure.structure import Structure

#: a deck with texts of the user wherever the program shows one: title, two elements, drift, building
NAMED = """TITLE {0}
UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
 3 6 0 FIX=YR
ELEMENTS
 1 COLUMN 1 2 NAME="{1}"
 2 WALL 2 NAME="{2}"
 3 COLUMN 1 3
 4 WALL 2 3
PROPS
 COLUMN SPRING KX=4000 RULE=BILINEAR FX=40 R=0.1
 WALL CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
 2 981
 3 400
DRIFT
 "{3}" 1 2 HEIGHT=3
BUILDINGS
 "{4}" NODES=1,2,3
EQUAKE
 SINE AMPLITUDE=2 PERIOD=1 DURATION=1
ANALYSIS
 MODAL 1
 HISTORY 1
"""


def results_of(
    deck: str | Path,
    params: Mapping[str, object] | None = None,
    *,
    out: Path | None = None,
    method: str | None = None,
    dt: float | None = None,
    tol: float | None = None,
) -> Results:
    """Results of a deck without a report, which takes as long as a small run; see `pound_solve.run`."""
    given = {name: str(value) for name, value in (params or {}).items()}
    request = driver.Request(str(deck), given, None if out is None else Path(out), (), method, dt, tol)
    began, path = time.perf_counter(), request.path(".h5")
    path.parent.mkdir(parents=True, exist_ok=True)
    return driver.solve(driver.prepare(request), path, None, began, request)


def model_of(text: str, params: Mapping[str, object] | None = None) -> Model:
    """The model of a deck; ANALYSIS is added where the deck has none.  A mistake fails the test."""
    if "ANALYSIS" not in text:
        text += "\nANALYSIS\n STATIC\n"
    given = {name: repr(value) for name, value in (params or {}).items()}
    model, found, files = read_text(text, catalog(), given)
    assert model is not None and not has_errors(found), render(found, files)
    return model


def structure_of(
    text: str,
    params: Mapping[str, object] | None = None,
    moved: Collection[Dof] = (),
    self_weight: bool = True,
) -> Structure:
    """The assembled structure of a deck."""
    return assemble(model_of(text, params), moved, self_weight)


def scene_of(text: str, params: Mapping[str, object] | None = None) -> reduction.ReducedSystem:
    """The reduced system of a deck with EQUAKE and HISTORY cards, started
    from its static state and INITIAL cards.
    """
    model = model_of(text, params)
    end = max(c["T"] for c in model.analyses if c.spec.name == "HISTORY")
    context = LoadingContext(model.gravity, 1.0, (), end)
    x = {n.id: n.x for n in model.nodes.values()}
    motions = [m for c in model.equake for m in fronts(c.spec.impl(c.values, context), x)]
    forces = [c.spec.impl(c.values, context) for c in model.forces]
    fixed = [(n.id, d) for n in model.nodes.values() for d in range(3) if "XYR"[d] in n.fixed]
    structure = assemble(model, reduction.moved_supports(motions, fixed))
    u0, v0 = history_start.initial(structure)
    return condense(
        reduction.build(structure, motions, end, static.solve(structure).u + u0, v0, forces)
    ).system


@dataclass(frozen=True)
class Solved:
    """A static result by names.

    Attributes
    ----------
    u : mapping of node to ndarray, shape (3,)
        Displacements ux, uy, rz of every node, slaved and fixed ones included.
    force : mapping of (element, quantity) to float
        Everything that elements put out; laws as ``force X`` or ``contact``.
    reaction : mapping of node to ndarray, shape (3,)
        Forces of the ground on the nodes that have a fixed direction.
    """

    structure: Structure
    state: static.StaticState
    u: dict[int, Array]
    force: dict[tuple[int, str], float]
    reaction: dict[int, Array]

    def total(self) -> Array:
        """Resultant of the reactions about the origin: x, y, moment."""
        out = np.zeros(3)
        for node, (x, y, m) in self.reaction.items():
            n = self.structure.model.nodes[node]
            out += (x, y, m + n.x * y - n.y * x)
        return out


def solved(text: str, params: Mapping[str, object] | None = None, self_weight: bool = True) -> Solved:
    """Static result of a deck."""
    return solve(model_of(text, params), self_weight)


def solve(model: Model, self_weight: bool = True) -> Solved:
    """Static result of a model."""
    s = assemble(model, self_weight=self_weight)
    state = static.solve(s)
    s = s.stressed(state.axial)
    u = {n: s.dofs.matrix([(n, d) for d in range(3)]) @ state.u for n in model.nodes}
    force = {
        (o.element, o.quantity): float(s.dofs.row(o.dofs, o.u_row) @ state.u) + o.constant
        for o in s.outputs
    }
    for spring, law_state, row in zip(s.laws, state.states, s.law_rows):
        name = (
            "contact"
            if spring.role.collides
            else f"{'moment' if spring.unit == 'F*L' else 'force'} {spring.component}"
        )
        force[spring.element, name] = spring.law.force(law_state, float(row @ state.u))[0]
    # reactions: let the supports go, and see what must hold them
    bare = replace(model, nodes={k: replace(n, fixed="") for k, n in model.nodes.items()}, damping=())
    whole = assemble(bare, self_weight=self_weight).stressed(state.axial)
    own = dict(zip(s.dofs.free, state.u))
    full = np.array([own[n, d] if d > 2 else u[n][d] for n, d in whole.dofs.free])
    r = whole.stiffness @ full - whole.loads
    for spring, law_state, row in zip(whole.laws, state.states, whole.law_rows):
        r += row * spring.law.branch(law_state).force(float(row @ full), 0.0)
    at = dict(zip(whole.dofs.free, r))
    reaction = {
        n.id: np.array([at[n.id, d] if "XYR"[d] in n.fixed else 0.0 for d in range(3)])
        for n in model.nodes.values()
        if n.fixed
    }
    return Solved(s, state, u, force, reaction)


def hinged_frame() -> str:
    """Three storeys, two bays and a leaning column: that of benchmarks/opensees_pushover.py."""
    names = [[100 * i + j + 1 for j in range(4)] for i in range(4)]
    deck = "GEOMETRY PDELTA\nNODES\n"
    for i, floor in enumerate(names):
        for j, n in enumerate(floor):
            fix = "FIX=XYR" if i == 0 else f"SLAVED=X MASTER={floor[0]}" if j else ""
            deck += f" {n} {6 * j} {3.5 * i} {fix}\n"
    deck += "ELEMENTS\n"
    for i, (low, high) in enumerate(itertools.pairwise(names), 1):
        for j in range(3):
            deck += f" {1000 * i + j} COL {low[j]} {high[j]}\n"
        for j in range(2):
            deck += f" {1000 * i + 500 + j} BEAM {high[j]} {high[j + 1]}\n"
        deck += f" {1000 * i + 900} LEAN {low[3]} {high[3]}\n"
    return f"""{deck}PROPS
 COL FRAME E=2e8 A=0.03 I=6e-4 RULE=BILINEAR R=0.02 MI=900 MJ=900 KH=2e6
 BEAM FRAME E=2e8 A=0.02 I=4e-4 RULE=BILINEAR R=0.02 MI=500 MJ=500 KH=2e6
 LEAN FRAME E=2e8 A=1
LOADS
 104,204,304 0 -900
"""
