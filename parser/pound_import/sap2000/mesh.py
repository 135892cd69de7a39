"""Automatic mesh: frames that ask for it are divided at the joints that lie on them, as in SAP2000."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import Draft
from pound_import.sap2000.frames import SapFrame, known
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.tables import SapTables
from pound_import.sap2000.vectors import cross, difference, dot, length

_TABLE: Final = "FRAME AUTO MESH ASSIGNMENTS"


def divided(
    tables: SapTables,
    frames: Mapping[str, SapFrame],
    inside: Mapping[str, SapFrame],
    joints: Mapping[str, SapJoint],
    plane: SapPlane,
    draft: Draft,
) -> dict[str, SapFrame]:
    """Frames of the plane, `inside`, or their parts, by name.

    Parameters
    ----------
    tables : SapTables
    frames : mapping of str to SapFrame
        Of the whole model.
    inside : mapping of str to SapFrame
        Of the plane.
    joints : mapping of str to SapJoint
        All of them.
    plane : SapPlane
    draft : Draft
    """
    meshed = _meshed(tables, frames, draft)
    ordered = sorted((j for j in joints.values() if plane.holds(j.at)), key=lambda j: j.at[plane.across])
    places = [joint.at[plane.across] for joint in ordered]
    out: dict[str, SapFrame] = {}
    for name, frame in inside.items():
        ends = sorted(joint.at[plane.across] for joint in (frame.i, frame.j))
        first, last = (
            bisect_left(places, ends[0] - plane.width),
            bisect_right(places, ends[1] + plane.width),
        )
        on_it = _between(frame, ordered[first:last], plane.width) if name in meshed else []
        with draft.keeping():
            out |= {part.name: part for part in _parts(frame, on_it)}
    return out


def _meshed(tables: SapTables, frames: Mapping[str, SapFrame], draft: Draft) -> set[str]:
    """Names of the frames that are divided at joints."""
    out: set[str] = set()
    for row in tables[_TABLE]:
        with draft.keeping():
            name = known(frames, row).name
            if row.yes("AutoMesh") and row.yes("AtJoints"):
                out.add(name)
            if row.yes("AutoMesh") and row.yes("AtFrames"):
                what = f"division of frame {name[:40]} at frames that cross it"
                draft.add("ELEMENTS", "", row.span, [draft.lose(row.span, what, "add nodes there")])
    return out


def _between(frame: SapFrame, joints: list[SapJoint], width: float) -> list[tuple[float, SapJoint]]:
    """Joints on a frame between its ends, with their fractions of its length from I."""
    one, out = frame.axes[0], list[tuple[float, SapJoint]]()
    for joint in joints:
        arm = difference(joint.at, frame.i.at)
        along = dot(arm, one)
        if width < along < frame.length - width and length(cross(arm, one)) <= width:
            out.append((along / frame.length, joint))
    out.sort(key=lambda pair: pair[0])
    # of joints at one place the first divides the frame
    return [pair for k, pair in enumerate(out) if not k or (pair[0] - out[k - 1][0]) * frame.length > width]


def _parts(frame: SapFrame, between: list[tuple[float, SapJoint]]) -> list[SapFrame]:
    """Parts of a frame; releases and rigid ends stay at its ends.

    Raises
    ------
    Mistake
        A rigid end is longer than the part that it belongs to.
    """
    if not between:
        return [frame]
    ends = [(0.0, frame.i), *between, (1.0, frame.j)]
    out = []
    for k, ((start, i), (end, j)) in enumerate(pairwise(ends), 1):
        letters = ("I" if k == 1 else "") + ("J" if k == len(ends) - 1 else "")
        offsets = frame.offsets[0] * ("I" in letters), frame.offsets[1] * ("J" in letters)
        if sum(offsets) >= (end - start) * frame.length:
            what = f"a rigid end of frame {frame.name[:40]} reaches beyond the joint that divides it"
            raise mistake("L651", what, frame.span, "shorten it, or move the joint")
        part = replace(
            frame,
            name=f"{frame.name}/{k}",
            i=i,
            j=j,
            released=frozenset(c for c in frame.released if c[-1] in letters),
            offsets=offsets,
            whole=frame.name,
            part=(start, end),
        )
        out.append(part)
    return out


def wholes(inside: Mapping[str, SapFrame]) -> dict[str, list[SapFrame]]:
    """Parts of each frame, or the frame itself, from I to J, by the name of the frame."""
    out: dict[str, list[SapFrame]] = {}
    for frame in inside.values():
        out.setdefault(frame.whole or frame.name, []).append(frame)
    return out
