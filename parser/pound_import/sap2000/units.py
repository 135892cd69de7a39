"""Units of a model: ``CurrUnits="KN, m, C"`` of PROGRAM CONTROL; the gravity that belongs to them."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import Draft, number
from pound_import.sap2000.tables import SapTables

#: as the deck names them
_FORCES: Final = {
    "LB": "lb",
    "KIP": "kip",
    "N": "N",
    "KN": "kN",
    "KGF": "kgf",
    "TONF": "tonf",
    "TON": "tonf",
}
_LENGTHS: Final = {"IN": 0.0254, "FT": 0.3048, "MM": 0.001, "CM": 0.01, "M": 1.0}  #: metres
_STANDARD: Final = 9.80665  #: gravity by which the program makes mass of weight [m/s^2]


def gravity(tables: SapTables, draft: Draft) -> float:
    """Add UNITS and GRAVITY; return the gravity [L/T^2].

    Raises
    ------
    Mistake
        The model names no units, or others.
    """
    row = next(iter(tables["PROGRAM CONTROL"]), None)
    if row is None or not row.has("CurrUnits"):
        here = row.span if row else tables.here
        what = "the model names no units: PROGRAM CONTROL has no CurrUnits"
        raise mistake("L650", what, here, 'such as CurrUnits="KN, m, C"')
    force, _, rest = row.word("CurrUnits").partition(",")
    length = rest.partition(",")[0].strip()
    if force.strip() not in _FORCES or length not in _LENGTHS:
        what = f"units {row.get('CurrUnits')[:40]!r} are not known"
        hint = f"forces {', '.join(_FORCES)}; lengths {', '.join(_LENGTHS)}"
        raise mistake("L650", what, row.place("CurrUnits"), hint)
    place = row.place("CurrUnits")
    g = float(f"{_STANDARD / _LENGTHS[length]:.9g}")
    draft.add("", f"UNITS {_FORCES[force.strip()]} {length.lower()} s", place)
    draft.add("", f"GRAVITY {number(g)}", place)
    return g
