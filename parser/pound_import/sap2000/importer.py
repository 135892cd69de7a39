"""From the text of a model to a deck of this program."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake, has_errors, mistake
from pound_deck.model import Span
from pound_deck.schema import Catalog
from pound_import.draft import Draft
from pound_import.sap2000 import (
    analysis,
    assignments,
    constraints,
    effects,
    frames,
    joints,
    links,
    loads,
    masses,
    members,
    mesh,
    nodes,
    patterns,
    planes,
    sections,
    spread,
    tables,
    units,
)
from pound_import.sap2000.frames import SapFrame
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.links import SapLink
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.recognise import is_sap2000
from pound_import.sap2000.sections import SapMaterial
from pound_import.sap2000.tables import SapTables
from pound_import.translation import Translation, written

_CHECK: Final = "compare it with the manual of SAP2000 or its results"


def translate(name: str, text: str, catalog: Catalog, plane: str = "", load: str = "") -> Translation:
    """Read a model.

    Parameters
    ----------
    name : str
        Of its file, for the places of messages.
    text : str
    catalog : Catalog
        Limits of what hysteresis rules take.
    plane : str
        Such as ``XZ``, ``XZ@Y=3.5`` or ``Y=3.5``; empty: the only plane with frames or links.
    load : str
        Static case, combination or load patterns, separated by commas, to be applied as static loads;
        empty: the only one, or none where there are several.

    Returns
    -------
    Translation
    """
    draft = Draft(_CHECK)
    with draft.keeping():
        model = _read(name, text, draft)
        _write(model, _Choice(catalog, plane, load), draft)
    draft.report.sort(key=lambda d: (d.span.line, d.span.column) if d.span else (0, 0))
    if has_errors(draft.report):
        return Translation("", (), tuple(draft.report))
    return written(_title(name), f"Read from the SAP2000 model {name}.", draft)


@dataclass(frozen=True, slots=True)
class _Choice:
    """What the user chooses of the model."""

    catalog: Catalog
    plane: str
    load: str


@dataclass(frozen=True, slots=True)
class _SapModel:
    """The model in space."""

    tables: SapTables
    gravity: float
    joints: dict[str, SapJoint]
    active: tuple[bool, ...]
    frames: dict[str, SapFrame]
    links: dict[str, SapLink]
    materials: dict[str, SapMaterial]


def _title(name: str) -> str:
    return name.replace("\\", "/").rpartition("/")[2].rpartition(".")[0] or name


def _read(name: str, text: str, draft: Draft) -> _SapModel:
    """Parts of the model that do not depend on the plane.

    Raises
    ------
    Mistake
        The text is no such model, or holds no frames and no links.
    """
    if not is_sap2000(text):
        here = Span(name, 1, 1, 2)
        what = f'{name} is no model of SAP2000: it has no line TABLE: "NAME"'
        raise mistake("L640", what, here, "File, Export, SAP2000 .s2k Text File")
    read = tables.read(name, text, effects.READ, draft.report)
    gravity = 0.0
    with draft.keeping():
        gravity = units.gravity(read, draft)
    points = joints.read(read, draft)
    bars = frames.connected(read, points, draft)
    connections = links.connected(read, points, draft)
    for table, filled in (("JOINT COORDINATES", points), ("CONNECTIVITY - FRAME", {**bars, **connections})):
        if not filled:
            what = f"there is no table {table}, or nothing in it can be read"
            raise mistake("L644", what, read.here, "export all tables of the model definition")
    materials = sections.materials(read, gravity or 1.0, draft)
    active = joints.active(read, draft)
    return _SapModel(read, gravity, points, active, bars, connections, materials)


def _write(model: _SapModel, choice: _Choice, draft: Draft) -> None:
    """Fill the draft.

    Raises
    ------
    Mistake
        No plane can be chosen.
    """
    read, here = model.tables, model.tables.here
    ends = _ends(model.frames, model.links)
    attached = {joint.name: joint for pair in ends for joint in pair}
    plane = planes.choose(attached, ends, model.active, choice.plane, here)
    shapes = sections.sections(read, model.materials, draft)
    whole = assignments.in_plane(read, model.frames, shapes, plane, draft)
    inside = mesh.divided(read, model.frames, whole, model.joints, plane, draft)
    linked = links.in_plane(model.links, plane)
    source = masses.source(read, draft)
    draft.add("", "MASS LUMPED", here)
    ids = _nodes(model, inside, linked, plane, draft)
    weighty = model.gravity * source.elements, model.gravity * source.added
    elements = members.write(inside, ids, model.materials, plane, weighty, draft)
    links.write(read, model.joints, linked, ids, elements, plane, choice.catalog, draft)
    static = patterns.StaticLoad("", {}, here)
    multipliers, run = patterns.patterns(read, draft), patterns.cases(read, draft)
    with draft.keeping():
        static = patterns.choose(read, multipliers, run, choice.load, draft)
    on_joints = spread.on_joints(read, model.joints, draft)
    weights = _weights(inside, model.materials)
    on_frames = spread.on_frames(read, model.frames, inside, draft)
    on_frames += spread.by_weight(read, inside, weights, multipliers, draft)
    loads.write(static, on_joints, on_frames, ids, elements, plane, draft)
    nodal = masses.NodalWeights()
    if source.added:
        masses.added(read, model.joints, plane, model.gravity, nodal, draft)
    if source.elements:
        links.masses(read, linked, model.gravity, nodal, draft)
    masses.of_loads(source, on_joints, on_frames, plane, nodal)
    fixed = {name: constraints.fixed_letters(x, model.active, plane) for name, x in model.joints.items()}
    nodal.write(ids, {name for name, letters in fixed.items() if "XY" in letters}, draft)
    has_mass = any(x.text for x in draft.sections["WEIGHTS"])
    has_mass = has_mass or any("WGT=" in x.text for x in draft.sections["PROPS"])
    analysis.write(read, run, static, plane, has_mass, draft)
    effects.others(read, draft)
    _outline(model, len(whole), len(linked), static, plane, draft)


def _nodes(
    model: _SapModel,
    inside: Mapping[str, SapFrame],
    linked: Mapping[str, SapLink],
    plane: SapPlane,
    draft: Draft,
) -> dict[str, int]:
    """Add the nodes; return their numbers by the names of joints."""
    held = {joint.name for pair in _ends(inside, linked) for joint in pair}
    sprung = {row.get("Joint") for row in model.tables["JOINT SPRING ASSIGNMENTS 1 - UNCOUPLED"]}
    groups = constraints.read(model.tables, model.joints, plane, draft)
    followers = constraints.followers(groups, held, model.active, plane, draft)
    points = {name: x for name, x in model.joints.items() if name in held or name in followers}
    return nodes.write(points, held | sprung, followers, model.active, plane, draft)


def _ends(
    bars: Mapping[str, SapFrame], connections: Mapping[str, SapLink]
) -> list[tuple[SapJoint, SapJoint]]:
    """Joints of frames and of links."""
    return [*((x.i, x.j) for x in bars.values()), *((x.i, x.j) for x in connections.values())]


def _weights(inside: Mapping[str, SapFrame], materials: Mapping[str, SapMaterial]) -> dict[str, float]:
    """Weights per length of the frames [F/L]; those without a section are reported elsewhere."""
    out = {}
    for name, frame in inside.items():
        with suppress(Mistake):
            out[name] = members.weight(frame, materials)
    return out


def _outline(
    model: _SapModel,
    bars: int,
    connections: int,
    static: patterns.StaticLoad,
    plane: SapPlane,
    draft: Draft,
) -> None:
    """Add a warning that says what of the model is read."""
    chosen = f"static loads {static.label[:60]}" if static.label else "no static loads"
    what = (
        f"read as the plane {plane}: {bars} of {len(model.frames)} frames, "
        f"{connections} of {len(model.links)} links; {chosen}"
    )
    hint = "--plane and --load choose others; the page Coming from SAP2000 says what is read"
    draft.report.append(Diagnostic("L652", what, model.tables.here, hint, "warning"))
