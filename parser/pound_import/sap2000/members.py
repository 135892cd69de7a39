"""Frames in the new deck: elements with property sets of the kind FRAME."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import Draft, number, quoted
from pound_import.sap2000.frames import SapFrame
from pound_import.sap2000.numbering import computed, numbered
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.sections import SapMaterial, SapSection

_EQUAL: Final = 1e-9  #: relative difference of equal stiffnesses


def write(
    frames: Mapping[str, SapFrame],
    nodes: Mapping[str, int],
    materials: Mapping[str, SapMaterial],
    plane: SapPlane,
    weighty: tuple[float, float],
    draft: Draft,
) -> dict[str, int]:
    """Add the elements and their property sets; return the numbers of elements.

    Parameters
    ----------
    frames : mapping of str to SapFrame
        Of the plane.
    nodes : mapping of str to int
        Numbers of nodes by the names of joints.
    materials : mapping of str to SapMaterial
    plane : SapPlane
    weighty : tuple of float, shape (2,)
        Factors from the mass of a frame by its material, and from its added mass, to weight: the gravity,
        or 0 where the mass does not count [L/T^2].
    draft : Draft
    """
    elements = numbered(frames)
    sets: dict[str, str] = {}
    for name, frame in frames.items():
        with draft.keeping():
            section, material = _properties(frame, materials)
            items = _items(frame, section, material, plane, weighty, draft)
            if items not in sets:
                sets[items] = f"P{len(sets) + 1}"
                draft.add(
                    "PROPS", f"{sets[items]} FRAME {items}", section.span, [f"section {section.name}"]
                )
            called = "" if str(elements[name]) == name else f" NAME={quoted(name)}"
            ends = f"{nodes[frame.i.name]} {nodes[frame.j.name]}"
            draft.add("ELEMENTS", f"{elements[name]} {sets[items]} {ends}{called}", frame.span)
    return elements


def weight(frame: SapFrame, materials: Mapping[str, SapMaterial]) -> float:
    """Weight of a frame per length [F/L].

    Raises
    ------
    Mistake
        It has no section, or its material is not known.
    """
    section, material = _properties(frame, materials)
    return material.weight * section.weight


def _properties(frame: SapFrame, materials: Mapping[str, SapMaterial]) -> tuple[SapSection, SapMaterial]:
    if frame.section is None:
        what = f"frame {frame.name[:40]} has no section"
        raise mistake("L646", what, frame.span, "FRAME SECTION ASSIGNMENTS names it")
    if frame.section.material not in materials:
        what = f"frame {frame.name[:40]}: there is no material {frame.section.material[:40]}"
        raise mistake("L646", what, frame.span, "correct MatProp, or add the material")
    section = frame.section.modified(frame.modifiers) if frame.modifiers else frame.section
    return section, materials[section.material]


def _items(
    frame: SapFrame,
    section: SapSection,
    material: SapMaterial,
    plane: SapPlane,
    weighty: tuple[float, float],
    draft: Draft,
) -> str:
    """Items of the property set of a frame."""
    about = _bending_axis(frame, section, plane)
    shear = section.shear[5 - about]
    items = [
        f"E={number(material.e)}",
        f"A={computed(section.area)}",
        f"I={computed(section.inertia[about])}",
    ]
    if shear and section.inertia[about]:
        items.append(f"G={number(material.g)} AS={computed(shear)}")
    per_length = weighty[0] * material.mass * section.mass + weighty[1] * frame.added
    if per_length:
        items.append(f"WGT={computed(per_length)}")
    items += [f"END{k}={computed(end)}" for k, end in enumerate(frame.offsets, 1) if end]
    forces = {f"{force}{end}" for end in "IJ" for force in ("P", f"V{5 - about}")} & frame.released
    if forces:
        what = f"released force {', '.join(sorted(forces))} of frame {frame.name[:40]}"
        draft.add("ELEMENTS", "", frame.span, [draft.lose(frame.span, what, "add a SPRING")])
    return " ".join([*items, *_ends(frame, about)])


def _ends(frame: SapFrame, about: int) -> list[str]:
    """Items of ends that turn freely, or against a spring."""
    moments = [f"M{about}{end}" for end in "IJ"]
    released = [m in frame.released for m in moments]
    springs = [frame.fixity.get(m, 0.0) if free else 0.0 for m, free in zip(moments, released)]
    pins = "".join(end for end, free, k in zip("IJ", released, springs) if free and not k)
    flexible = [1.0 / k if k else 0.0 for k in springs]
    return [
        *([f"PIN={'BOTH' if pins == 'IJ' else pins}"] if pins else []),
        *([f"FJ={','.join(map(computed, flexible))}"] if any(flexible) else []),
    ]


def _bending_axis(frame: SapFrame, section: SapSection, plane: SapPlane) -> int:
    """Local axis, 2 or 3, about which the frame bends in the plane.

    Raises
    ------
    Mistake
        Neither is normal to the plane, and the section is not the same about both.
    """
    for about in (3, 2):
        if plane.faces(frame.axes[about - 1]):
            return about
    pairs = (section.inertia, section.shear)
    if all(abs(x[2] - x[3]) <= _EQUAL * abs(x[3]) for x in pairs):
        return 3
    what = f"the local axes of frame {frame.name[:40]} lie oblique to the plane"
    raise mistake("L651", what, frame.span, "an angle of 0 or 90 degrees, or equal I22 and I33")
