"""Loads of load patterns on frames and joints, in space: what `loads` and `masses` make theirs of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000 import joints as points
from pound_import.sap2000.frames import SapFrame, known
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.mesh import wholes
from pound_import.sap2000.tables import SapRow, SapTables
from pound_import.sap2000.vectors import Vector, scaled

_AXES: Final = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}
_DOWN: Final = (0.0, 0.0, -1.0)
_NOTHING: Final = (0.0, 0.0, 0.0)
#: of the interval from 0 to 1; exact for polynomials up to degree 5, hence for the work of a load that
#: varies linearly on a beam, whose deflection is cubic
_GAUSS: Final = ((0.5 - 0.15**0.5, 5 / 18), (0.5, 8 / 18), (0.5 + 0.15**0.5, 5 / 18))


@dataclass(frozen=True, slots=True)
class JointForce:
    """Force and moment on a joint [F, F L]."""

    pattern: str
    joint: SapJoint
    force: Vector
    moment: Vector
    span: Span


@dataclass(frozen=True, slots=True)
class FrameForce:
    """Load on a frame.

    Attributes
    ----------
    uniform : tuple of float, shape (3,)
        Force per length along all of it [F/L].
    at_points : tuple
        Pairs of a fraction of the length from I and a force, shape (3,) [F].
    exact : bool
        `at_points` is the load itself; otherwise three points in place of a load that varies.
    """

    pattern: str
    frame: SapFrame
    uniform: Vector
    at_points: tuple[tuple[float, Vector], ...]
    span: Span
    exact: bool = True


def on_joints(tables: SapTables, joints: dict[str, SapJoint], draft: Draft) -> list[JointForce]:
    """Loads on joints."""
    out: list[JointForce] = []
    for row in tables["JOINT LOADS - FORCE"]:
        with draft.keeping():
            joint = points.known(joints, row)
            pattern = row.text(row.key("LoadPat", "LoadCase"))
            force, moment = (tuple(row.real(f"{c}{k}", 0.0) for k in (1, 2, 3)) for c in "FM")
            system = row.word("CoordSys", "GLOBAL")
            if system not in ("GLOBAL", "LOCAL") or (system == "LOCAL" and joint.turned):
                what = f"loads along axes of joint {joint.name[:40]} other than the global ones"
                draft.add("LOADS", "", row.span, [draft.lose(row.span, what)])
                continue
            out.append(JointForce(pattern, joint, _vector(force), _vector(moment), row.span))
    return out


def on_frames(
    tables: SapTables, frames: Mapping[str, SapFrame], inside: Mapping[str, SapFrame], draft: Draft
) -> list[FrameForce]:
    """Loads on frames of the plane, `inside`; `frames` are those of the whole model."""
    readers = {"FRAME LOADS - DISTRIBUTED": _distributed, "FRAME LOADS - POINT": _at_a_point}
    parts, out = wholes(inside), list[FrameForce]()
    for table, reader in readers.items():
        for row in tables[table]:
            with draft.keeping():
                name = known(frames, row).name
                if name not in parts:
                    continue
                if row.word("Type", "FORCE") == "FORCE":
                    out += reader(row, parts[name])
                else:
                    what = f"moments along frame {name[:40]}"
                    draft.add("MEMBER_LOADS", "", row.span, [draft.lose(row.span, what)])
    return out


def by_weight(
    tables: SapTables,
    frames: Mapping[str, SapFrame],
    weights: Mapping[str, float],
    multipliers: Mapping[str, float],
    draft: Draft,
) -> Iterator[FrameForce]:
    """Loads by the weight of frames of the plane.

    Parameters
    ----------
    tables : SapTables
    frames : mapping of str to SapFrame
        Of the plane.
    weights : mapping of str to float
        Their weights per length [F/L].
    multipliers : mapping of str to float
        Factor of the weight in each load pattern.
    draft : Draft
    """
    for pattern, factor in multipliers.items():
        for name, frame in frames.items():
            if factor and weights.get(name):
                yield FrameForce(pattern, frame, scaled(_DOWN, factor * weights[name]), (), frame.span)
    parts = wholes(frames)
    for row in tables["FRAME LOADS - GRAVITY"]:
        with draft.keeping():
            pattern = row.text(row.key("LoadPat", "LoadCase"))
            factors = _vector(tuple(row.real(f"Multiplier{axis}", 0.0) for axis in "XYZ"))
            for frame in parts.get(row.text("Frame"), []):
                weight = weights.get(frame.name, 0.0)
                if weight:
                    yield FrameForce(pattern, frame, scaled(factors, weight), (), row.span)


def _distributed(row: SapRow, parts: Sequence[SapFrame]) -> list[FrameForce]:
    """Load along a frame, on each of its parts."""
    pattern, along = row.text(row.key("LoadPat", "LoadCase")), _direction(row, parts[0])
    a, b = (_fraction(row, parts, key) for key in ("A", "B"))
    first = row.real(row.key("FOverLA", "FOverL"))
    last = row.real(row.key("FOverLB", "FOverLA", "FOverL"))
    if b < a:
        raise mistake("L643", "the load ends before it begins", row.span, "from A to B")
    out = []
    for part in parts:
        start, end = part.part
        low, high = max(a, start), min(b, end)
        if low >= high:
            continue
        if first == last and (low, high) == part.part:
            out.append(FrameForce(pattern, part, scaled(along, first), (), row.span))
            continue
        size = (high - low) / (end - start) * part.length
        at = [low + (high - low) * x for x, _ in _GAUSS]
        forces = [w * size * (first + (last - first) * (s - a) / (b - a)) for s, (_, w) in zip(at, _GAUSS)]
        points = tuple(((s - start) / (end - start), scaled(along, force)) for s, force in zip(at, forces))
        out.append(FrameForce(pattern, part, _NOTHING, points, row.span, exact=False))
    return out


def _at_a_point(row: SapRow, parts: Sequence[SapFrame]) -> list[FrameForce]:
    """Force at a point of a frame, on the part that holds it."""
    pattern, along = row.text(row.key("LoadPat", "LoadCase")), _direction(row, parts[0])
    at, force = _fraction(row, parts, ""), scaled(along, row.real("Force"))
    part = next(part for part in parts if at <= part.part[1])
    start, end = part.part
    return [FrameForce(pattern, part, _NOTHING, (((at - start) / (end - start), force),), row.span)]


def _fraction(row: SapRow, parts: Sequence[SapFrame], end: str) -> float:
    """Place of an end of the load as a fraction of the length from I.

    Raises
    ------
    Mistake
        It is beyond the frame.
    """
    relative = row.word("DistType", "RELDIST") == "RELDIST" and row.has(f"RelDist{end}")
    key = f"{'RelDist' if relative else 'AbsDist'}{end}"
    usual = {"A": 0.0, "B": 1.0}.get(end)
    if usual is not None and not row.has(key):
        return usual
    value = row.real(key) / (1.0 if relative else sum(part.length for part in parts))
    if not -1e-9 <= value <= 1.0 + 1e-9:
        name = row.get("Frame")[:40]
        raise mistake("L643", f"{key} is beyond frame {name}", row.place(key), "within its length")
    return min(max(value, 0.0), 1.0)


def _direction(row: SapRow, frame: SapFrame) -> Vector:
    """Vector of a load of 1: the direction, shortened where the load is per projected length.

    Raises
    ------
    Mistake
        The direction or its coordinate system is not known.
    """
    system = row.word("CoordSys", "GLOBAL")
    if system not in ("GLOBAL", "LOCAL"):
        what = f"a load in the coordinate system {system[:40]}"
        raise mistake("L651", what, row.place("CoordSys"), "give it in GLOBAL or Local")
    words = row.word("Dir", "GRAVITY").replace("-", " ").split()
    projected = words[1:] in (["PROJ"], ["PROJECTED"])
    local = system == "LOCAL"
    if local and words in (["1"], ["2"], ["3"]):
        return frame.axes[int(words[0]) - 1]
    vector = _DOWN if words[:1] == ["GRAVITY"] else _AXES.get(words[0] if words else "")
    if local or vector is None or (len(words) > 1 and not projected):
        what = f"a load along {row.get('Dir')[:40]!r}"
        raise mistake("L643", what, row.place("Dir"), "Gravity, X, Y, Z, with Proj; 1, 2, 3 of Local")
    if not projected:
        return vector
    one = frame.axes[0]
    along = sum(a * b for a, b in zip(vector, one))
    return scaled(vector, max(0.0, 1.0 - along * along) ** 0.5)


def _vector(values: tuple[float, ...]) -> Vector:
    return values[0], values[1], values[2]
