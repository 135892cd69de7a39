"""Nodes of the new deck: joints of the plane at the ends of members, or joined to one by a constraint."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from pound_import.draft import Draft, number
from pound_import.sap2000.constraints import Follower, fixed_letters
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.numbering import numbered
from pound_import.sap2000.planes import SapPlane


def write(
    joints: Mapping[str, SapJoint],
    attached: Collection[str],
    followers: Mapping[str, Follower],
    active: tuple[bool, ...],
    plane: SapPlane,
    draft: Draft,
) -> dict[str, int]:
    """Add the nodes; return their numbers by the names of joints.

    Parameters
    ----------
    joints : mapping of str to SapJoint
        Those that become nodes.
    attached : collection of str
        Those at the ends of members: nothing else holds the free directions of the others.
    followers : mapping of str to Follower
    active : tuple of bool, shape (6,)
    plane : SapPlane
    draft : Draft
    """
    ids = numbered(joints)
    for name, joint in joints.items():
        x, y = plane.flat(joint.at)
        fixed, follower = fixed_letters(joint, active, plane), followers.get(name)
        if name not in attached:
            fixed = "".join(c for c in "XYR" if not follower or c not in follower.letters)
        text = f"{ids[name]} {number(x)} {number(y)}"
        text += f" FIX={fixed}" if fixed else ""
        text += f" SLAVED={follower.letters} MASTER={ids[follower.master]}" if follower else ""
        notes = [] if str(ids[name]) == name else [f"joint {name}"]
        draft.add("NODES", text, joint.span, notes)
    return ids
