"""Constraints between joints as directions that follow a master: diaphragm, body, equal displacements."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000 import joints as points
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.tables import SapRow, SapTables

KINDS: Final = ("DIAPHRAGM", "BODY", "EQUAL")
#: whose joints move in another way
OTHERS: Final = ("BEAM", "ROD", "PLATE", "LOCAL", "LINE", "WELD")
_DISPLACEMENTS: Final = ("UX", "UY", "UZ")
_ROTATIONS: Final = ("RX", "RY", "RZ")


@dataclass(frozen=True, slots=True)
class SapConstraint:
    """A constraint, and its joints in the plane."""

    kind: str
    row: SapRow
    joints: tuple[SapJoint, ...]


@dataclass(frozen=True, slots=True)
class Follower:
    """Directions of a node, letters of XYR, that follow the master joint; place of the constraint."""

    letters: str
    master: str
    span: Span


def read(
    tables: SapTables, joints: dict[str, SapJoint], plane: SapPlane, draft: Draft
) -> list[SapConstraint]:
    """Constraints that join at least two joints of the plane."""
    definitions: dict[str, tuple[str, SapRow]] = {}
    for kind in (*KINDS, *OTHERS):
        for row in tables[f"CONSTRAINT DEFINITIONS - {kind}"]:
            with draft.keeping():
                definitions[row.text("Name")] = kind, row
    members: dict[str, list[SapJoint]] = {}
    for row in tables["JOINT CONSTRAINT ASSIGNMENTS"]:
        with draft.keeping():
            joint, name = points.known(joints, row), row.text("Constraint")
            if name not in definitions:
                what = f"there is no constraint {name[:40]}"
                raise mistake("L646", what, row.place("Constraint"), "correct the name, or define it")
            if plane.holds(joint.at) and joint not in members.setdefault(name, []):
                members[name].append(joint)
    groups = []
    for name, (kind, row) in definitions.items():
        for group in _levels(row, members.get(name, []), plane, draft):
            if len(group) > 1:
                groups.append(SapConstraint(kind, row, tuple(group)))
    return groups


def _levels(row: SapRow, joints: list[SapJoint], plane: SapPlane, draft: Draft) -> list[list[SapJoint]]:
    """Joints of a constraint by their level, where it acts on each level alone."""
    with draft.keeping():
        axis = "XYZ".find(row.word("Axis", "Z")[:1])
        if row.yes("MultiLevel") and axis >= 0:
            levels: dict[int, list[SapJoint]] = {}
            for joint in joints:
                levels.setdefault(round(joint.at[axis] / max(plane.width, 1e-30)), []).append(joint)
            return list(levels.values())
    return [joints]


def followers(
    groups: list[SapConstraint],
    attached: Collection[str],
    active: tuple[bool, ...],
    plane: SapPlane,
    draft: Draft,
) -> dict[str, Follower]:
    """Directions that follow a master, by the name of the joint.

    Parameters
    ----------
    groups : list of SapConstraint
    attached : collection of str
        Joints at the ends of members: the others cannot be masters.
    active : tuple of bool, shape (6,)
    plane : SapPlane
    draft : Draft
    """
    out: dict[str, Follower] = {}
    masters: set[str] = set()
    for group in groups:
        letters = _letters(group, active, plane, draft)
        if not letters:
            continue
        free = [joint for joint in group.joints if joint.name in attached and joint.name not in out]
        if not free:
            _lose(group, "its joints follow others already", draft)
            continue
        master = max(free, key=lambda joint: (joint.name in masters, sum(joint.fixed)))
        masters.add(master.name)
        for joint in group.joints:
            if joint is master:
                continue
            if joint.name in out or joint.name in masters:
                _lose(group, f"joint {joint.name[:40]} belongs to another constraint", draft)
                continue
            moving = "".join(c for c in letters if c not in fixed_letters(joint, active, plane))
            if moving:
                out[joint.name] = Follower(moving, master.name, group.row.span)
    return out


def fixed_letters(joint: SapJoint, active: tuple[bool, ...], plane: SapPlane) -> str:
    """Directions of XYR that are restrained or inactive."""
    axes = (plane.across, plane.up, 3 + plane.normal)
    return "".join(c for c, k in zip("XYR", axes) if joint.fixed[k] or not active[k])


def _letters(group: SapConstraint, active: tuple[bool, ...], plane: SapPlane, draft: Draft) -> str:
    """Directions of XYR that a constraint joins."""
    row, letters = group.row, ""
    with draft.keeping():
        if group.kind == "DIAPHRAGM":
            letters = _of_diaphragm(group, plane)
        elif group.kind in ("BODY", "EQUAL"):
            keys = (_DISPLACEMENTS[plane.across], _DISPLACEMENTS[plane.up], _ROTATIONS[plane.normal])
            letters = "".join(c for c, key in zip("XYR", keys) if row.yes(key, True))
        else:
            _lose(group, f"a {group.kind.lower()} constraint", draft)
    free = [set(letters) - set(fixed_letters(joint, active, plane)) for joint in group.joints]
    letters = "".join(c for c in letters if any(c in moving for moving in free))
    if group.kind == "EQUAL" or (group.kind == "DIAPHRAGM" and letters != "XYR"):
        arms = {"X": plane.up, "Y": plane.across}
        apart = [c for c in letters if c in arms and _spread(group, arms[c]) > plane.width]
        if apart:
            _lose(group, "its joints lie at several levels: SLAVED has a rigid arm", draft)
        letters = "".join(c for c in letters if c not in apart)
    return letters


def _of_diaphragm(group: SapConstraint, plane: SapPlane) -> str:
    axis = group.row.word("Axis", "Z")[:1]
    level = next((k for k in (plane.up, plane.across) if _spread(group, k) <= plane.width), plane.normal)
    k = "XYZ".find(axis) if axis != "A" else level  # Auto: normal to the joints
    if k < 0:
        raise mistake("L643", f"Axis is {axis}", group.row.place("Axis"), "X, Y, Z or Auto")
    return {plane.up: "X", plane.across: "Y", plane.normal: "XYR"}[k]


def _spread(group: SapConstraint, axis: int) -> float:
    places = [joint.at[axis] for joint in group.joints]
    return max(places) - min(places)


def _lose(group: SapConstraint, what: str, draft: Draft) -> None:
    name = group.row.get("Name")[:40]
    note = draft.lose(group.row.span, f"constraint {name}: {what}", "add SLAVED and MASTER by hand")
    draft.add("NODES", "", group.row.span, [note])
