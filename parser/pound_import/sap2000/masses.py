"""Mass: the mass source, mass of frames, added mass of joints, and mass of load patterns."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000 import joints as points
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.numbering import computed
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.spread import FrameForce, JointForce
from pound_import.sap2000.tables import SapRow, SapTables


@dataclass(slots=True)
class MassSource:
    """What makes mass: frames and links, added mass of joints, load patterns with multipliers."""

    elements: bool = True
    added: bool = True
    loads: dict[str, float] = field(default_factory=dict)


def source(tables: SapTables, draft: Draft) -> MassSource:
    """Mass source that is marked as the default one, or the first."""
    with draft.keeping():
        rows = tables["MASS SOURCE"]
        if not rows:
            return _older(tables)
        default = next((row for row in rows if row.yes("IsDefault")), rows[0])
        name = default.get("MassSource")
        out = MassSource(default.yes("Elements", True), default.yes("Masses", True))
        uses_loads = default.yes("Loads")
        for row in rows:
            if uses_loads and row.get("MassSource") == name and row.has("LoadPat"):
                _add(out, row)
        return out
    return MassSource()


def _older(tables: SapTables) -> MassSource:
    """Mass source of older versions: elements, loads or both."""
    row = next(iter(tables["MASSES 1 - MASS SOURCE"]), None)
    if row is None:
        return MassSource()
    words = row.word("MassFrom", "ELEMENTS")
    out = MassSource("ELEM" in words, "ELEM" in words)
    for line in tables["MASSES 1 - MASS SOURCE"] if "LOAD" in words else []:
        if line.has(line.key("LoadPat", "LoadCase")):
            _add(out, line)
    return out


def _add(out: MassSource, row: SapRow) -> None:
    pattern = row.text(row.key("LoadPat", "LoadCase"))
    out.loads[pattern] = out.loads.get(pattern, 0.0) + row.real("Multiplier", 1.0)


class NodalWeights:
    """Weights of nodes by the names of joints: along x, along y, and rotational [F, F, F L^2]."""

    def __init__(self) -> None:
        self.values: dict[str, list[float]] = {}
        self.places: dict[str, Span] = {}

    def add(self, joint: SapJoint, x: float, y: float, turn: float, span: Span) -> None:
        """Add to the weights of a joint."""
        self.places.setdefault(joint.name, span)
        sums = self.values.setdefault(joint.name, [0.0, 0.0, 0.0])
        for k, value in enumerate((x, y, turn)):
            sums[k] += value

    def write(self, nodes: Mapping[str, int], held: Collection[str], draft: Draft) -> None:
        """Add WEIGHTS in the order of nodes; those of joints without a node are lost, and those of joints
        `held` by supports have no effect.
        """
        lost = []
        for name in sorted(self.values, key=lambda name: nodes.get(name, 0)):
            x, y, turn = self.values[name]
            if not any((x, y, turn)) or name in held:
                continue
            place = self.places[name]
            if min(x, y, turn) < 0.0:
                note = draft.lose(place, f"the mass of joint {name[:40]}, which is below zero")
                draft.add("WEIGHTS", "", place, [note])
            elif name in nodes:
                text = f"{nodes[name]} {computed(x)} {computed(y)}"
                draft.add("WEIGHTS", text + (f" {computed(turn)}" if turn else ""), place)
            else:
                lost.append(name)
        if lost:
            place = self.places[lost[0]]
            what = f"mass of joints that are no nodes: {', '.join(n[:40] for n in lost[:10])}"
            draft.add("WEIGHTS", "", place, [draft.lose(place, what)])


def added(
    tables: SapTables,
    joints: dict[str, SapJoint],
    plane: SapPlane,
    gravity: float,
    out: NodalWeights,
    draft: Draft,
) -> None:
    """Add the mass of joints of the plane to `out`; that of others is lost, with its sum."""
    outside, first = 0.0, tables.here
    for row in tables["JOINT ADDED MASS ASSIGNMENTS"]:
        with draft.keeping():
            joint = points.known(joints, row)
            mass = [row.real(f"Mass{k}", 0.0) for k in (1, 2, 3)]
            inertia = [row.real(f"MMI{k}", 0.0) for k in (1, 2, 3)]
            if plane.holds(joint.at):
                x, y = (gravity * mass[k] for k in (plane.across, plane.up))
                out.add(joint, x, y, gravity * inertia[plane.normal], row.span)
            else:
                outside, first = outside + mass[plane.across], first if outside else row.span
    if outside:
        what = f"added mass of joints outside of the plane, in all {computed(outside)}"
        remedy = "add the share of this plane to WEIGHTS"
        draft.add("WEIGHTS", "", first, [draft.lose(first, what, remedy)])


def of_loads(
    sources: MassSource,
    on_joints: Sequence[JointForce],
    on_frames: Sequence[FrameForce],
    plane: SapPlane,
    out: NodalWeights,
) -> None:
    """Add the mass of downward loads to `out`, those of frames by the lever rule."""
    for joint in on_joints:
        factor = sources.loads.get(joint.pattern, 0.0)
        if factor and plane.holds(joint.joint.at):
            down = -factor * joint.force[2]
            out.add(joint.joint, down, down, 0.0, joint.span)
    for load in on_frames:
        factor = sources.loads.get(load.pattern, 0.0)
        if not factor:
            continue
        half = -factor * load.uniform[2] * load.frame.length / 2.0
        parts = [(x, -factor * force[2]) for x, force in load.at_points]
        at_j = half + sum(x * force for x, force in parts)
        at_i = half + sum((1.0 - x) * force for x, force in parts)
        for end, down in ((load.frame.i, at_i), (load.frame.j, at_j)):
            out.add(end, down, down, 0.0, load.span)
