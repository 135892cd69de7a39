"""Table ``struck_members``."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.results.columns import CONTACT, ELEMENT, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name

CROSSING = 0.5  #: largest component of a member's direction along that of the contact that strikes it
PEAK_MISSED = 1e-3  #: fraction of a contact's peak by which its force at a stored instant must not be lower


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each end of a member that a contact strikes, the hardest contact first."""
    from pound_solve.structure.locations import member_end  # not needed to read a report

    history, model = run.history, run.model
    column = {(o.element, o.quantity): k for k, o in enumerate(history.items.outputs)}
    envelope = history.recorder.envelopes.output.largest()
    yields = {
        (s.element, s.component): min(map(abs, s.strengths))
        for s in run.structure.laws
        if s.strengths is not None
    }
    for law, t_peak, peak in _struck(run):
        at_peak = _members_at(run, law, t_peak, peak)
        for element, end in _crossing(run, law):
            k = column.get((element, f"shear {end}"))
            m = column.get((element, f"moment {end}"))
            if k is None or m is None:
                continue
            yield (
                contact_name(model, run.structure.laws[law].element),
                element,
                end,
                member_end(model, history.items.buildings, element, end),
                t_peak,
                abs(at_peak[k]) if at_peak is not None else math.nan,
                *envelope[k],
                *envelope[m],
                yields.get((element, f"hinge {end}"), math.nan),
            )


def _struck(run: RunRecord) -> list[tuple[int, float, float]]:
    """Contacts that closed with a force, the hardest first: number of the law, time and value of the
    largest force.
    """
    hardest: dict[int, tuple[int, float, float]] = {}
    for c in run.history.returned.peaks.collisions:
        if c.peak == c.peak and (c.law not in hardest or c.peak > hardest[c.law][2]):
            hardest[c.law] = c.law, c.t_peak, c.peak
    return sorted(hardest.values(), key=lambda struck: -struck[2])


def _crossing(run: RunRecord, law: int) -> Iterator[tuple[int, str]]:
    """Members that end at the nodes of a contact and cross its direction, each with that end."""
    model, spring = run.model, run.structure.laws[law]
    angle = math.radians(spring.facts["angle"])
    along = math.cos(angle), math.sin(angle)
    contact = model.elements[spring.element]
    for node in (contact.i, contact.j):
        for e in model.elements.values():
            if e.j is None or node not in (e.i, e.j):
                continue
            dx, dy = model.nodes[e.j].x - model.nodes[e.i].x, model.nodes[e.j].y - model.nodes[e.i].y
            length = math.hypot(dx, dy)
            if length and abs(dx * along[0] + dy * along[1]) <= CROSSING * length:
                yield e.id, "I" if node == e.i else "J"


def _members_at(run: RunRecord, law: int, t: float, peak: float) -> Array | None:
    """Forces of the members while a contact pushes hardest, from its close-ups; None if these lack it."""
    recorder = run.history.recorder
    nearest = recorder.closeup_at(t)
    if nearest is None or nearest.force[law, 0] < (1.0 - PEAK_MISSED) * peak:
        return None
    return np.asarray(nearest.members[:, 0])


TABLE = Table(
    name="struck_members",
    title="Struck members",
    place=35,
    stages=(Stage.PEAKS,),
    columns=(
        CONTACT,
        ELEMENT,
        Column("end", doc="end of the member at the struck node"),
        Column("location", "place", doc="building, column of a storey or beam of a floor, and its end"),
        time_column("t_peak", "contact\nat time", "time of the largest force of the contact"),
        Column(
            "shear_at_peak",
            "shear\nthen",
            "F",
            "num",
            doc="absolute shear at that time, NaN without close-ups",
        ),
        Column("shear", "largest\nshear", "F", "num", doc="largest absolute shear of the history"),
        time_column("t_shear", "at time", "time of the largest shear"),
        Column("moment", "largest\nmoment", "F*L", "num", doc="largest absolute moment at this end"),
        time_column("t_moment", "at time", "time of the largest moment"),
        Column(
            "yield_moment",
            "yield\nmoment",
            "F*L",
            "num",
            doc="smaller yield moment of the hinge at this end, NaN for none",
        ),
    ),
    rows=rows,
    limit=30,
    note="Members that end at the node of a contact and cross its direction, the hardest contact first.",
)
