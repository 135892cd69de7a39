"""``/history/contact``: gaps and forces of the contacts."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from pound_solve.results.schema import History, HistoryLayout
from pound_solve.results.words import contact_name

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array


def labels(items: RecordedItems) -> list[str]:
    """Names of the contacts."""
    structure = items.system.structure
    return [contact_name(structure.model, structure.laws[i].element) for i in items.contacts]


def gaps(block: SampleBlock) -> Array:
    """Initial gaps less closures, shape (n_times, n_contacts)."""
    laws, contacts = block.items.system.structure.laws, list(block.items.contacts)
    initial = np.array([laws[i].gap for i in contacts])
    return initial - block.deformation[contacts].T


GAP = History(
    name="contact/gap",
    place=50,
    row="contacts",
    doc="gap, negative while in contact",
    layout=lambda items: HistoryLayout((len(items.contacts),), {"labels": labels(items), "unit": "L"}),
    values=gaps,
    axes=MappingProxyType({"contact": "labels"}),
    closeup=True,
)
FORCE = History(
    name="contact/force",
    place=60,
    row="contacts",
    doc="contact force, positive in compression",
    layout=lambda items: HistoryLayout((len(items.contacts),), {"labels": labels(items), "unit": "F"}),
    values=lambda block: block.force[list(block.items.contacts)].T,
    axes=MappingProxyType({"contact": "labels"}),
    closeup=True,
)
