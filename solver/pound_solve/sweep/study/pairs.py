"""Contacts of one run as pairs of bodies, with the input of the separation rules."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from pound_solve.results.columns import CONTACT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name
from pound_solve.statistics.separation import correlation, own_mode
from pound_solve.structure.elements.base import axes
from pound_solve.structure.structure import Structure


def nodes(structure: Structure) -> set[int]:
    """Nodes of the contacts, whose displacements `rows` requires."""
    elements = structure.model.elements
    contacts = (elements[s.element] for s in structure.laws if s.role.collides)
    return {node for element in contacts for node in (element.i, element.j) if node}


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each contact."""
    peaks = run.history.returned.peaks
    for i in run.history.items.contacts:
        law = run.structure.laws[i]
        element, along = run.model.elements[law.element], axes(law.facts["angle"])[0]
        ends = element.i, element.j or 0
        closure = max(peaks.deformation[i].high, 0.0)
        yield (
            contact_name(run.model, law.element),
            *(_peak(run, node, along) for node in ends),
            _correlation(run, ends, along),
            math.nan if peaks.collisions else closure,
            law.gap,
        )


def _peak(run: RunRecord, node: int, along: tuple[float, float]) -> float:
    """Largest absolute displacement of a node [L]; 0 of a wall, NaN where it is not recorded."""
    nodes = run.history.items.nodes
    if node == 0:
        return 0.0
    if node not in nodes:
        return math.nan
    at = nodes.index(node)
    if 0.0 in along:
        envelope = run.history.recorder.envelopes.node["u"]
        row = 3 * at + (1 if along[1] else 0)
        return float(max(abs(envelope.high[row]), abs(envelope.low[row])))
    return float(np.abs(run.stored("node/u")[:, at, :2] @ along).max(initial=0.0))


def _correlation(run: RunRecord, ends: tuple[int, int], along: tuple[float, float]) -> float:
    """Correlation of the buildings on both sides under white noise; NaN where their modes are not known."""
    modal = getattr(run, "modal", None)
    if modal is None or modal.shapes is None or 0 in ends:
        return math.nan
    nodes = list(run.model.nodes)
    periods, damping = (np.array([getattr(m, name) for m in modal.modes]) for name in ("period", "damping"))
    (t1, xi1), (t2, xi2) = (
        own_mode(modal.shapes[:, nodes.index(node), :2] @ along, periods, damping / 100.0) for node in ends
    )
    return correlation(t1, t2, xi1, xi2)


PAIRS = Table(
    name="pairs",
    title="Pairs",
    place=0,
    stages=(Stage.PEAKS,),
    columns=(
        CONTACT,
        Column("peak_i", "", "L", "short", doc="largest absolute displacement of node I along the contact"),
        Column("peak_j", "", "L", "short", doc="the same of node J; 0 of a wall"),
        Column("correlation", "", "-", "short", doc="of both buildings under white noise, by their modes"),
        Column("needed_gap", "", "L", "short", doc="smallest gap that stays open; none where anything met"),
        Column("given_gap", "", "L", "short", doc="gap of the deck"),
    ),
    rows=rows,
)
