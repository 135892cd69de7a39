"""``/history/time``: the time axis."""

from __future__ import annotations

from pound_solve.results.schema import History, HistoryLayout

LAYOUT = HistoryLayout((), {"unit": "T"})

HISTORY = History(
    name="time",
    place=0,
    row="one number",
    doc="the time axis that all histories share",
    layout=lambda items: LAYOUT,
    values=lambda block: block.t,
    closeup=True,
)
