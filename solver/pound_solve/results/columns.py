"""Columns that many tables share."""

from __future__ import annotations

from pound_solve.results.schema import Column

NODE = Column("node", fmt="int", doc="node number")
ELEMENT = Column("element", fmt="int", doc="element number")
ITEM = Column("item", doc="name of the value")
VALUE = Column("value", doc="value with its unit, as text")
DEFAULT = Column("default", " ", doc="`*` for a default value")
UNIT = Column("unit", doc="unit of the numbers in this row")
BUILDING = Column("building", doc="name of the building")
STOREY = Column("storey", fmt="int", doc="number of the storey, from below")
PUSH = Column("push", fmt="int", doc="number of the PUSHOVER card in the deck")
LEG = Column("leg", fmt="int", doc="number of the leg, the way from one target to the next")
COMPONENT = Column("component", "comp.", doc="`X`, `Y` or `R` of a spring, `hinge I`, ... of a member")
RULE = Column("rule", doc="hysteresis rule")
CONTACT = Column("contact", doc="number or name of the contact element")


def time_column(name: str, head: str, doc: str) -> Column:
    """Column of instants."""
    return Column(name, head, "T", "time", doc)


def control_displacement(doc: str) -> Column:
    """Column of displacements of the control node of a pushover."""
    return Column("displacement", "control\ndispl.", "L", "num", doc)


def base_shear(doc: str) -> Column:
    """Column of base shears of a pushover."""
    return Column("base_shear", "base\nshear", "F", "num", doc)


def extreme_columns(unit: str) -> tuple[Column, ...]:
    """Largest and smallest value with their times."""
    return (
        Column("max", "max", unit, "num", "largest value"),
        time_column("t_max", "at time", "time of the largest value"),
        Column("min", "min", unit, "num", "smallest value"),
        time_column("t_min", "at time", "time of the smallest value"),
    )
