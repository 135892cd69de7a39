"""Links: which joints they join, their properties by degree of freedom, and the springs of joints.

A property has a row for each of the degrees of freedom U1, U2, U3 (along the local axes) and R1, R2, R3
(about them).  Those in the plane become components of a SPRING, a DASHPOT or a CONTACT; those out of it
have no effect there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import atan2, degrees
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_deck.schema import Catalog
from pound_import.draft import Draft, number
from pound_import.sap2000 import joints as points
from pound_import.sap2000 import springs
from pound_import.sap2000.joints import SapJoint
from pound_import.sap2000.link_elements import ElementWriter, LinkDof
from pound_import.sap2000.masses import NodalWeights
from pound_import.sap2000.numbering import computed
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.tables import SapRow, SapTables
from pound_import.sap2000.vectors import Vector, difference, dot, length, local_axes

_DEFINITIONS: Final = "LINK PROPERTY DEFINITIONS "
_OBLIQUE: Final = 1e-6  #: cosine of the angle between the normal and an axis that is not in the plane
_DOFS: Final = ("U1", "U2", "U3", "R1", "R2", "R3")


@dataclass(frozen=True, slots=True)
class SapLink:
    """A link.

    Attributes
    ----------
    i, j : SapJoint
        The same joint where the link ends at the ground.
    prop : str
        Name of its property.
    axes : tuple, shape (3, 3)
        Unit vectors of its local axes.
    """

    name: str
    i: SapJoint
    j: SapJoint
    span: Span
    axes: tuple[Vector, Vector, Vector]
    prop: str = ""

    @property
    def length(self) -> float:
        """Distance of its joints [L]."""
        return length(difference(self.j.at, self.i.at))


def connected(tables: SapTables, joints: dict[str, SapJoint], draft: Draft) -> dict[str, SapLink]:
    """Links by name, of the whole model, with their properties."""
    links: dict[str, SapLink] = {}
    for row in tables["CONNECTIVITY - LINK"]:
        with draft.keeping():
            name = row.text("Link")
            if name in links:
                what = f"link {name[:40]} is given twice"
                raise mistake("L645", what, row.place("Link"), "give it another name")
            i = points.known(joints, row, "JointI")
            j = points.known(joints, row, "JointJ") if row.has("JointJ") else i
            links[name] = SapLink(name, i, j, row.span, local_axes(difference(j.at, i.at), 0.0))
    for row in tables["LINK PROPERTY ASSIGNMENTS"]:
        with draft.keeping():
            link = _known(links, row)
            links[link.name] = replace(link, prop=row.text("LinkProp"))
    for row in tables["LINK LOCAL AXES ASSIGNMENTS 1 - TYPICAL"]:
        with draft.keeping():
            link = _known(links, row)
            axes = local_axes(difference(link.j.at, link.i.at), row.real("Angle", 0.0))
            links[link.name] = replace(link, axes=axes)
            if row.yes("AdvanceAxes"):
                what = f"local axes of link {link.name[:40]} by a vector or a plane"
                draft.add("ELEMENTS", "", row.span, [draft.lose(row.span, what, "correct its ANGLE")])
    return links


def _known(links: Mapping[str, SapLink], row: SapRow) -> SapLink:
    name = row.text("Link")
    if name not in links:
        what = f"{row.table}: there is no link {name[:40]}"
        raise mistake("L646", what, row.place("Link"), "correct the name, or add the link")
    return links[name]


def in_plane(links: Mapping[str, SapLink], plane: SapPlane) -> dict[str, SapLink]:
    """Links whose joints lie in the plane."""
    return {name: x for name, x in links.items() if plane.holds(x.i.at) and plane.holds(x.j.at)}


def write(
    tables: SapTables,
    joints: Mapping[str, SapJoint],
    links: Mapping[str, SapLink],
    nodes: Mapping[str, int],
    used: Mapping[str, int],
    plane: SapPlane,
    catalog: Catalog,
    draft: Draft,
) -> None:
    """Add the elements of links and their property sets.

    Parameters
    ----------
    tables : SapTables
    joints : mapping of str to SapJoint
    links : mapping of str to SapLink
        Of the plane.
    nodes : mapping of str to int
        Numbers of nodes by the names of joints.
    used : mapping of str to int
        Numbers of the other elements.
    plane : SapPlane
    catalog : Catalog
        Limits of what rules take.
    draft : Draft
    """
    writer = ElementWriter(max(used.values(), default=0), catalog, draft)
    definitions = _definitions(tables, draft)
    for name, link in links.items():
        with draft.keeping():
            if link.prop not in definitions:
                what = f"link {name[:40]} has no property that is defined"
                raise mistake("L646", what, link.span, "LINK PROPERTY ASSIGNMENTS names it")
            ends = f"{nodes[link.i.name]}" + (f" {nodes[link.j.name]}" if link.i != link.j else "")
            _write_link(link, definitions[link.prop], ends, plane, writer)
    _of_joints(tables, joints, nodes, plane, writer)


def _definitions(tables: SapTables, draft: Draft) -> dict[str, dict[str, list[SapRow]]]:
    """Rows of the properties by name and degree of freedom; several where a curve is given."""
    out: dict[str, dict[str, list[SapRow]]] = {}
    for table in springs.READERS:
        for row in tables[_DEFINITIONS + table]:
            with draft.keeping():
                dof = row.word("DOF")
                if dof not in _DOFS:
                    what = f"DOF is {dof[:40] or 'missing'}"
                    raise mistake("L643", what, row.place("DOF"), ", ".join(_DOFS))
                out.setdefault(row.text("Link"), {}).setdefault(dof, []).append(row)
    for row in tables[_DEFINITIONS + "01 - GENERAL"]:
        with draft.keeping():
            out.setdefault(row.text("Link"), {}).setdefault("", []).append(row)
    return out


def _write_link(
    link: SapLink, definition: Mapping[str, list[SapRow]], ends: str, plane: SapPlane, writer: ElementWriter
) -> None:
    """Add the elements of a link; what has no counterpart is lost."""
    kinds = {rows[0].table for dof, rows in definition.items() if dof}
    if not kinds:
        general = definition.get("", [])
        kind = general[0].get("LinkType", "without properties") if general else "without properties"
        writer.lose(link.span, f"link {link.name[:40]} of the kind {kind[:40]}")
        return
    for dof, rows in definition.items():
        if not dof:
            continue
        axis = link.axes[int(dof[1]) - 1]
        translation, across = dof[0] == "U", dot(axis, plane.unit_normal())
        if translation == plane.faces(axis):
            continue  # out of the plane
        if translation and abs(across) > _OBLIQUE:
            writer.lose(link.span, f"{dof} of link {link.name[:40]}, which lies oblique to the plane")
            continue
        x, y = plane.flat(axis)
        arm = _arm(link, rows[0]) if dof in ("U2", "U3") and link.length else ""
        angle = degrees(atan2(y, x)) if translation else 0.0
        # the ground of a link is its first joint, but that of an element is its second node
        reverse = (link.i == link.j) != (not translation and across < 0.0)
        springs.component(writer, LinkDof(link.name, dof, ends, angle, arm, reverse, link.span), rows)


def masses(
    tables: SapTables, links: Mapping[str, SapLink], gravity: float, out: NodalWeights, draft: Draft
) -> None:
    """Add half of the mass of each link to either of its joints."""
    rows = {row.get("Link"): row for row in tables[_DEFINITIONS + "01 - GENERAL"]}
    for link in links.values():
        with draft.keeping():
            row = rows.get(link.prop)
            half = gravity * row.real("Mass", 0.0) / 2.0 if row else 0.0
            if half and row:
                out.add(link.i, half, half, 0.0, row.span)
                out.add(link.j, half, half, 0.0, row.span)


def _arm(link: SapLink, row: SapRow) -> str:
    """Item of the place of a shear spring: DJ is its distance from the second joint."""
    return f" ARM={computed(min(max(1.0 - row.real('DJ', 0.0) / link.length, 0.0), 1.0))}"


def _of_joints(
    tables: SapTables,
    joints: Mapping[str, SapJoint],
    nodes: Mapping[str, int],
    plane: SapPlane,
    writer: ElementWriter,
) -> None:
    """Add the springs of joints to the ground."""
    keys = (f"U{plane.across + 1}", f"U{plane.up + 1}", f"R{plane.normal + 1}")
    for row in tables["JOINT SPRING ASSIGNMENTS 1 - UNCOUPLED"]:
        with writer.draft.keeping():
            stiff = [row.real(key, 0.0) for key in keys]
            items = "".join(f" {name}={number(k)}" for name, k in zip(("KX", "KY", "KR"), stiff) if k)
            name = row.text("Joint")
            if items and name in nodes and joints[name].turned:
                writer.lose(row.span, f"springs along local axes of joint {name[:40]}", "add a SPRING")
            elif items and name in nodes:
                writer.element(f"SPRING{items}", str(nodes[name]), f"spring of joint {name}", row.span, [])
