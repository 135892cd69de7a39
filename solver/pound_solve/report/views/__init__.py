"""Tables that the report prints in another shape than they are stored in: one function for each, by the
name of the table, from the results to the parts that are printed one below the other.

`ECHO` repeats the deck in groups; a report in full prints these tables as they are stored.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Final

from pound_solve.report.views import echo, members, nodes, side_by_side
from pound_solve.report.views.part import TablePart
from pound_solve.results import Results

View = Callable[[Results], list[TablePart]]

SHAPED: Final[Mapping[str, View]] = MappingProxyType(
    {
        "node_envelope": nodes.motion,
        "reaction_envelope": nodes.reactions,
        "member_envelope": members.envelopes,
        "storey_envelope": side_by_side.storeys,
        "static_force": members.static_forces,
        "mode_shapes": side_by_side.shapes,
    }
)
ECHO: Final[Mapping[str, View]] = MappingProxyType(
    {
        **{name: partial(echo.ranges, name) for name in ("nodes", "elements")},
        **{name: partial(echo.equal, name) for name in ("masses", "springs", "loads", "member_loads")},
        "properties": echo.properties,
    }
)


def view_of(name: str, whole: bool) -> View | None:
    """Function that shapes a table for a report, in full or not; None: printed as it is stored."""
    return SHAPED.get(name) or (None if whole else ECHO.get(name))
