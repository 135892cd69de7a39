"""Joints in space: coordinates and restraints; the degrees of freedom that are active."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, radians, sin
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000.tables import SapRow, SapTables
from pound_import.sap2000.vectors import Vector

_RESTRAINTS: Final = ("U1", "U2", "U3", "R1", "R2", "R3")
_ACTIVE: Final = ("UX", "UY", "UZ", "RX", "RY", "RZ")
ALL_ACTIVE: Final = (True,) * 6


@dataclass(frozen=True, slots=True)
class SapJoint:
    """A joint.

    Attributes
    ----------
    at : tuple of float, shape (3,)
        Global coordinates [L].
    fixed : tuple of bool, shape (6,)
        Restraints of displacements along and rotations about X, Y, Z.
    turned : bool
        Its local axes are not the global ones.
    """

    name: str
    at: Vector
    span: Span
    fixed: tuple[bool, ...] = (False,) * 6
    turned: bool = False


def read(tables: SapTables, draft: Draft) -> dict[str, SapJoint]:
    """Joints by name, with their restraints."""
    joints: dict[str, SapJoint] = {}
    for row in tables["JOINT COORDINATES"]:
        with draft.keeping():
            name = row.text("Joint")
            if name in joints:
                what = f"joint {name[:40]} is given twice"
                raise mistake("L645", what, row.place("Joint"), "give it another name")
            joints[name] = SapJoint(name, _coordinates(row), row.span)
    for row in tables["JOINT LOCAL AXES ASSIGNMENTS 1 - TYPICAL"]:
        with draft.keeping():
            joint = known(joints, row)
            angles = any(row.real(key, 0.0) for key in ("AngleA", "AngleB", "AngleC"))
            joints[joint.name] = replace(joint, turned=angles or row.yes("AdvanceAxes"))
    for row in tables["JOINT RESTRAINT ASSIGNMENTS"]:
        with draft.keeping():
            joint = known(joints, row)
            fixed = tuple(row.yes(key) for key in _RESTRAINTS)
            if joint.turned and len(set(fixed[:3])) + len(set(fixed[3:])) > 2:
                what = f"the restraints of joint {joint.name[:40]} follow local axes"
                draft.add("NODES", "", row.span, [draft.lose(row.span, what, "correct FIX of the node")])
            joints[joint.name] = replace(joint, fixed=fixed)
    return joints


def known(joints: dict[str, SapJoint], row: SapRow, key: str = "Joint") -> SapJoint:
    """Joint that a row names.

    Raises
    ------
    Mistake
        There is none.
    """
    name = row.text(key)
    if name not in joints:
        what = f"{row.table}: there is no joint {name[:40]}"
        raise mistake("L646", what, row.place(key), "correct the name, or add the joint")
    return joints[name]


def active(tables: SapTables, draft: Draft) -> tuple[bool, ...]:
    """Whether displacements along and rotations about X, Y, Z are active, shape (6,)."""
    with draft.keeping():
        for row in tables["ACTIVE DEGREES OF FREEDOM"]:
            return tuple(row.yes(key, True) for key in _ACTIVE)
    return ALL_ACTIVE


def _coordinates(row: SapRow) -> Vector:
    if all(row.has(key) for key in ("GlobalX", "GlobalY", "GlobalZ")):
        return row.real("GlobalX"), row.real("GlobalY"), row.real("GlobalZ")
    if row.word("CoordSys", "GLOBAL") != "GLOBAL":
        what = f"coordinates in the system {row.get('CoordSys')[:40]}"
        raise mistake("L651", what, row.place("CoordSys"), "export GlobalX, GlobalY and GlobalZ, too")
    kind = row.word("CoordType", "CARTESIAN")
    if kind == "CARTESIAN":
        return row.real(row.key("XorR", "X")), row.real("Y"), row.real("Z")
    if kind == "CYLINDRICAL":
        radius, turn = row.real("XorR"), radians(row.real("T"))
        return radius * cos(turn), radius * sin(turn), row.real("Z")
    raise mistake("L651", f"CoordType is {kind[:40]}", row.place("CoordType"), "Cartesian or Cylindrical")
