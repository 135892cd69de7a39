"""What tables assign to frames of the plane: section, local axes, releases, rigid ends, modifiers, mass."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000.frames import SapFrame, known
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.sections import SapSection
from pound_import.sap2000.tables import SapRow, SapTables
from pound_import.sap2000.vectors import difference, local_axes

_MOST_NAMED: Final = 10  #: frames that a message names


def in_plane(
    tables: SapTables,
    frames: Mapping[str, SapFrame],
    sections: Mapping[str, SapSection],
    plane: SapPlane,
    draft: Draft,
) -> dict[str, SapFrame]:
    """Frames of the plane by name, with all that tables assign to them."""
    inside = {
        name: frame for name, frame in frames.items() if plane.holds(frame.i.at) and plane.holds(frame.j.at)
    }

    def each(table: str, change: Callable[[SapRow, SapFrame], SapFrame]) -> None:
        for row in tables[table]:
            with draft.keeping():
                frame = inside.pop(known(frames, row).name, None)
                if frame:  # with a mistake it stays out: no others follow from it
                    inside[frame.name] = change(row, frame)

    def lose(table: str, has: Callable[[SapRow], bool], what: str, remedy: str) -> None:
        lost: dict[str, Span] = {}

        def note(row: SapRow, frame: SapFrame) -> SapFrame:
            if has(row):
                lost[frame.name] = row.span
            return frame

        each(table, note)
        if lost:
            place = next(iter(lost.values()))
            text = f"{what} of {_listed(lost)}"
            draft.add("ELEMENTS", "", place, [draft.lose(place, text, remedy)])

    each("FRAME SECTION ASSIGNMENTS", lambda row, frame: replace(frame, section=_section(row, sections)))
    each("FRAME PROPERTY MODIFIERS", lambda row, frame: replace(frame, modifiers=row))
    each("FRAME LOCAL AXES ASSIGNMENTS 1 - TYPICAL", _turned)
    each("FRAME RELEASE ASSIGNMENTS 1 - GENERAL", _released)
    each("FRAME RELEASE ASSIGNMENTS 2 - PARTIAL FIXITY", _fixity)
    each("FRAME OFFSET ALONG LENGTH ASSIGNMENTS", _offsets)
    each("FRAME ADDED MASS ASSIGNMENTS", lambda row, frame: replace(frame, added=row.real("MassPerLen")))
    ends = "FRAME OFFSET ALONG LENGTH ASSIGNMENTS"
    lose(ends, _has_automatic_ends, "automatic rigid ends", "add END1 and END2: the file holds no lengths")
    lose(
        "FRAME INSERTION POINT ASSIGNMENTS",
        _is_eccentric,
        "insertion point",
        "frames run from node to node",
    )
    limits = "limits of tension or compression"
    lose("FRAME TENSION AND COMPRESSION LIMITS", _has_limits, limits, "a TENDON takes tension only")
    return {name: inside[name] for name in frames if name in inside}


def _section(row: SapRow, sections: Mapping[str, SapSection]) -> SapSection:
    name = row.text("AnalSect")
    if name not in sections:
        what = f"there is no section {name[:40]} with properties"
        raise mistake("L646", what, row.place("AnalSect"), "of FRAME SECTION PROPERTIES 01 - GENERAL")
    material = row.get("MatProp", "Default")
    section = sections[name]
    return section if material.upper() == "DEFAULT" else replace(section, material=material)


def _turned(row: SapRow, frame: SapFrame) -> SapFrame:
    if row.yes("AdvanceAxes"):
        what = f"the local axes of frame {frame.name[:40]} are given by a vector or a plane"
        raise mistake("L651", what, row.place("AdvanceAxes"), "give their angle")
    along = difference(frame.j.at, frame.i.at)
    return replace(frame, axes=local_axes(along, row.real("Angle", 0.0)))


def _released(row: SapRow, frame: SapFrame) -> SapFrame:
    components = (f"{force}{end}" for end in "IJ" for force in ("P", "V2", "V3", "T", "M2", "M3"))
    return replace(frame, released=frozenset(c for c in components if row.yes(c)))


def _fixity(row: SapRow, frame: SapFrame) -> SapFrame:
    springs = {c: row.real(c, 0.0) for c in ("M2I", "M3I", "M2J", "M3J")}
    return replace(frame, fixity={c: k for c, k in springs.items() if k > 0.0})


def _offsets(row: SapRow, frame: SapFrame) -> SapFrame:
    rigid = row.real("RigidFactor", 0.0)
    ends = tuple(rigid * row.real(key, 0.0) for key in ("LengthI", "LengthJ"))
    if min(ends) < 0.0 or sum(ends) >= frame.length:
        what = f"the rigid ends of frame {frame.name[:40]} leave no flexible length"
        raise mistake("L651", what, row.span, "RigidFactor times LengthI and LengthJ")
    return replace(frame, offsets=(ends[0], ends[1]))


def _has_automatic_ends(row: SapRow) -> bool:
    lengths = row.has("LengthI") or row.has("LengthJ")
    return row.word("Type") == "AUTOMATIC" and row.real("RigidFactor", 0.0) > 0.0 and not lengths


def _is_eccentric(row: SapRow) -> bool:
    if not row.yes(row.key("Transform", "StiffTransform", "StiffTrans"), True):
        return False
    shifts = any(row.real(f"JtOffset{axis}{end}", 0.0) for axis in "XYZ" for end in "IJ")
    return shifts or row.get("CardinalPt", "10").split()[0] not in ("10", "11")


def _listed(names: Iterable[str]) -> str:
    """Names of frames, shortened where there are many."""
    names = list(names)
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    return f"frame{'s' if len(names) > 1 else ''} {', '.join(n[:40] for n in names[:_MOST_NAMED])}{more}"


def _has_limits(row: SapRow) -> bool:
    return row.yes("TensLimit") or row.yes("CompLimit")
