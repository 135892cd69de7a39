"""Static loads of nodes and members; those that a history releases stand apart."""

from __future__ import annotations

from pound_deck.model import Card, Element
from pound_solve.laws.refusal import ItemError
from pound_solve.opensees.frames import FOLLOWING, line
from pound_solve.opensees.script import Script
from pound_solve.structure.dofs import Dof


def nodal(script: Script) -> None:
    """Write the loads of LOADS, STATIC GRAVITY=YES included."""
    for card in script.model.loads:
        section = "loads" if card["HELD"] == "YES" else "released"
        for node in card["NODES"]:
            script.call(section, "load", node, card["FX"], card["FY"], card["MZ"])


def member(script: Script, element: Element, card: Card) -> None:
    """Write the loads of a FRAME: its weight and MEMBER_LOADS."""
    cards = [c for c in script.model.member_loads if element.id in c["ELEMENTS"]]
    weight = card["WGT"] if script.structure.self_weight else 0.0
    if not cards and not weight:
        return
    geometry = script.model.geometry
    if geometry == "LARGE":  # there the loads of OpenSees turn with the member
        raise ItemError("a load on a member with GEOMETRY LARGE", "WGT")
    if card["I"] == 0.0:
        _at_ends(script, element)
        return
    hinged = card["MI"] is not None or card["MJ"] is not None
    for item, present in (("END1", card["END1"]), ("END2", card["END2"]), ("AS", card["AS"])):
        if present:
            raise ItemError(f"a load on a member with {item}", item)
    cos, sin = line(script, element, card).axis
    wx = sum(c["WX"] for c in cards)
    wy = sum(c["WY"] for c in cards) - weight
    along = [cos * wx + sin * wy, *(cos * c["PX"] + sin * c["PY"] for c in cards)]
    if geometry in FOLLOWING and any(abs(x) > 1e-12 * (abs(wx) + abs(wy)) for x in along):
        raise ItemError(f"a load along a member with GEOMETRY {geometry}", "WGT")
    head = ("loads", "eleLoad", "-ele", element.id, "-type")
    if wx or wy:
        script.call(*head, "-beamUniform", cos * wy - sin * wx, cos * wx + sin * wy)
    for c in cards:
        if not c["PX"] and not c["PY"]:
            continue
        if hinged:
            script.refuse("a point load on a member with hinges", c.place("AT"))
            continue
        across, along = cos * c["PY"] - sin * c["PX"], cos * c["PX"] + sin * c["PY"]
        script.call(*head, "-beamPoint", across, c["AT"], along)


def _at_ends(script: Script, element: Element) -> None:
    """Write the loads of a bar, which its nodes share."""
    total: dict[int, list[float]] = {}
    dof: Dof
    for dofs, vector in script.structure.parts[element.id].loads:
        for dof, value in zip(dofs, vector.tolist()):
            total.setdefault(dof[0], [0.0, 0.0, 0.0])[dof[1]] += value
    for node, values in total.items():
        script.call("loads", "load", node, *values)
