"""``/history/energy``: cumulative energies."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from pound_solve.results.schema import History, HistoryLayout

#: columns of the history
ENERGIES: Final = ("input", "kinetic", "strain", "damping", "hysteretic", "contact", "residual")
LAYOUT = HistoryLayout((len(ENERGIES),), {"labels": ENERGIES, "unit": "F*L"})

ENERGY = History(
    name="energy",
    place=120,
    row=f"{len(ENERGIES)} columns",
    doc=f"cumulative energies: {', '.join(ENERGIES)}",
    layout=lambda items: LAYOUT,
    values=lambda block: block.energy,
    axes=MappingProxyType({"part": "labels"}),
)
