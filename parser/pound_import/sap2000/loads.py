"""Static loads of the new deck: LOADS on nodes, MEMBER_LOADS on elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000.numbering import computed
from pound_import.sap2000.patterns import StaticLoad
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.spread import FrameForce, JointForce
from pound_import.sap2000.vectors import Vector, difference, scaled

_ROUND: Final = 1e-12  #: share of a force that comes from the rounding of directions
_VARIES: Final = "a load that varies: three loads at Gauss points, with the same forces at the ends"


def write(
    static: StaticLoad,
    on_joints: Sequence[JointForce],
    on_frames: Sequence[FrameForce],
    nodes: Mapping[str, int],
    elements: Mapping[str, int],
    plane: SapPlane,
    draft: Draft,
) -> None:
    """Add the loads of the chosen patterns times their factors."""
    for joint in on_joints:
        factor = static.factors.get(joint.pattern, 0.0)
        if not factor or not plane.holds(joint.joint.at):
            continue
        items = _components(scaled(joint.force, factor), plane, ("FX", "FY"))
        moment = factor * plane.turn * joint.moment[plane.normal]
        items += f" MZ={computed(moment)}" if moment else ""
        if items and joint.joint.name not in nodes:
            what = f"the load of joint {joint.joint.name[:40]}, which no frame or link holds"
            draft.add("LOADS", "", joint.span, [draft.lose(joint.span, what, "remove the joint")])
        elif items:
            draft.add("LOADS", f"{nodes[joint.joint.name]}{items}", joint.span)
    alike: dict[str, list[FrameForce]] = {}
    for load in on_frames:
        factor = static.factors.get(load.pattern, 0.0)
        if not factor or load.frame.name not in elements:
            continue
        items = _components(scaled(load.uniform, factor), plane, ("WX", "WY"))
        if items:
            alike.setdefault(items, []).append(load)
        _points(load, factor, nodes, elements, plane, draft)
    for items, loads in alike.items():
        ids = ",".join(str(elements[load.frame.name]) for load in loads)
        draft.add("MEMBER_LOADS", f"{ids}{items}", loads[0].span)
    outside = [*_on_joints_across(static, on_joints, plane), *_on_frames_across(static, on_frames, plane)]
    if outside:
        what = f"{len(outside)} loads act out of the plane"
        draft.add(
            "LOADS", "", outside[0], [draft.lose(outside[0], what, "they have no effect in the plane")]
        )


def _points(
    load: FrameForce,
    factor: float,
    nodes: Mapping[str, int],
    elements: Mapping[str, int],
    plane: SapPlane,
    draft: Draft,
) -> None:
    """Add point loads of a frame; those on its rigid ends act on the nodes."""
    notes = [] if load.exact else [_VARIES]
    frame = load.frame
    flexible = frame.length - sum(frame.offsets)
    for fraction, force in load.at_points:
        fx, fy = plane.flat(scaled(force, factor))
        items = _components(scaled(force, factor), plane, ("PX", "PY"))
        if not items:
            continue
        at = (fraction * frame.length - frame.offsets[0]) / flexible
        if 0.0 <= at <= 1.0:
            text = f"{elements[frame.name]}{items} AT={computed(at)}"
            draft.add("MEMBER_LOADS", text, load.span, notes)
        else:
            end, part = (frame.i, fraction) if at < 0.0 else (frame.j, fraction - 1.0)
            dx, dy = plane.flat(scaled(difference(frame.j.at, frame.i.at), part))
            text = f"{nodes[end.name]} FX={computed(fx)} FY={computed(fy)} MZ={computed(dx * fy - dy * fx)}"
            draft.add("LOADS", text, load.span, ["on the rigid end of a frame"])
        notes = []


def _components(force: Vector, plane: SapPlane, names: tuple[str, str]) -> str:
    """Items of the components that are not zero, each after a blank."""
    least = _ROUND * max(map(abs, force))
    return "".join(f" {name}={computed(v)}" for name, v in zip(names, plane.flat(force)) if abs(v) > least)


def _on_joints_across(static: StaticLoad, loads: Sequence[JointForce], plane: SapPlane) -> list[Span]:
    """Places of loads on joints of the plane that act out of it."""
    return [
        load.span
        for load in loads
        if static.factors.get(load.pattern)
        and plane.holds(load.joint.at)
        and (load.force[plane.normal] or any(plane.flat(load.moment)))
    ]


def _on_frames_across(static: StaticLoad, loads: Sequence[FrameForce], plane: SapPlane) -> list[Span]:
    return [
        load.span
        for load in loads
        if static.factors.get(load.pattern)
        and any(abs(force[plane.normal]) > _ROUND * max(map(abs, force)) for force in _forces(load))
    ]


def _forces(load: FrameForce) -> list[Vector]:
    return [load.uniform, *(force for _, force in load.at_points)]
