"""Materials and sections of frames, with the modifiers of sections."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000.tables import SapRow, SapTables

_NO_SECTION: Final = ("AUTO SELECT", "NONPRISMATIC")  #: shapes without properties


@dataclass(frozen=True, slots=True)
class SapMaterial:
    """Moduli, weight and mass per volume [F/L^2, F/L^3, F T^2/L^4]."""

    e: float
    g: float
    weight: float
    mass: float


@dataclass(frozen=True, slots=True)
class SapSection:
    """A section, its modifiers applied.

    Attributes
    ----------
    material : str
    area : float
        For stiffness [L^2].
    inertia : dict of int to float
        Second moment of area about local axis 2 or 3 [L^4].
    shear : dict of int to float
        Shear area along local axis 2 or 3, 0 without shear deformation [L^2].
    mass, weight : float
        Areas for mass and weight [L^2].
    """

    name: str
    material: str
    area: float
    inertia: Mapping[int, float]
    shear: Mapping[int, float]
    mass: float
    weight: float
    span: Span

    def modified(self, row: SapRow) -> SapSection:
        """Return the section with the modifiers of a row."""

        def factor(*names: str) -> float:
            return row.real(row.key(*names), 1.0)

        second = {2: factor("I22Mod", "I2Mod"), 3: factor("I33Mod", "I3Mod")}
        shear = {2: factor("AS2Mod", "A2Mod"), 3: factor("AS3Mod", "A3Mod")}
        return SapSection(
            self.name,
            self.material,
            self.area * factor("AMod"),
            {k: self.inertia[k] * second[k] for k in (2, 3)},
            {k: self.shear[k] * shear[k] for k in (2, 3)},
            self.mass * factor("MMod", "MassMod"),
            self.weight * factor("WMod", "WeightMod"),
            self.span,
        )


def materials(tables: SapTables, gravity: float, draft: Draft) -> dict[str, SapMaterial]:
    """Materials by name.

    A material without a shear modulus has that of its Poisson's ratio.
    """
    out: dict[str, SapMaterial] = {}
    for row in tables["MATERIAL PROPERTIES 02 - BASIC MECHANICAL PROPERTIES"]:
        with draft.keeping():
            name = _new(row, "Material", out)
            e = row.real("E1")
            g = row.real("G12", 0.0) or e / (2.0 * (1.0 + abs(row.real("U12", 0.0))))
            weight = row.real("UnitWeight", 0.0)
            out[name] = SapMaterial(e, g, weight, row.real("UnitMass", weight / gravity))
    return out


def sections(tables: SapTables, known: Mapping[str, SapMaterial], draft: Draft) -> dict[str, SapSection]:
    """Sections by name; those without properties, such as lists for a design, are left out."""
    out: dict[str, SapSection] = {}
    for row in tables["FRAME SECTION PROPERTIES 01 - GENERAL"]:
        if row.word("Shape") in _NO_SECTION:
            continue
        with draft.keeping():
            name = _new(row, "SectionName", out)
            material = row.text("Material")
            if material not in known:
                what = f"section {name[:40]}: there is no material {material[:40]}"
                raise mistake("L646", what, row.place("Material"), "correct the name, or add the material")
            area = row.real("Area")
            inertia = {2: row.real("I22", 0.0), 3: row.real("I33", 0.0)}
            shear = {2: row.real("AS2", 0.0), 3: row.real("AS3", 0.0)}
            plain = SapSection(name, material, area, inertia, shear, area, area, row.span)
            out[name] = plain.modified(row)
            if row.real("I23", 0.0):
                what = f"I23 of section {name[:40]}: bending out of the plane"
                draft.add("PROPS", "", row.span, [draft.lose(row.place("I23"), what)])
    return out


def _new(row: SapRow, key: str, known: Mapping[str, object]) -> str:
    """Name that a row defines; raise Mistake where it is given twice."""
    name = row.text(key)
    if name in known:
        what = f"{row.table}: {name[:40]} is given twice"
        raise mistake("L645", what, row.place(key), "give it another name")
    return name
