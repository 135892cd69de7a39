"""Readings of what the paper does not say: damping, columns, contacts, and records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from motions import (
    EL_CENTRO,
    EL_CENTRO_OLD,
    EL_CENTRO_OLD_TURNED,
    EL_CENTRO_OWN,
    GILROY_2,
    GILROY_3,
    LOMA_PRIETA,
    MEXICO,
    MEXICO_STRONG,
    Record,
)

#: damping, and the card in place of the decks' own: Rayleigh of the two sway modes of each building
DAMPING = {
    "Rayleigh, by building": "",
    "modal": "MODAL XI=xi",
    "Rayleigh, modes 1 and 2": "RAYLEIGH XI=xi MODES=1,2",
    "Rayleigh, modes 1 and 4": "RAYLEIGH XI=xi MODES=1,4",
}
#: element whose stiffness the contact has, times n
ADJACENT = {"softer": "kd2", "harmonic mean": "2*kd1*kd2/(kd1+kd2)", "stiffer": "kd1"}


@dataclass(frozen=True)
class Structure:
    """One choice of all that is no record.

    Attributes
    ----------
    strength : float
        Storey yield over that of Table IV.
    xi : float
        Damping ratio.
    damping : str
        Key of `DAMPING`.  The last two are of the modes of both buildings; all but contacts is damped.
    slabs, everywhere : bool
        Whether damping by building includes the diaphragms, and whether columns stand at all their nodes.
    hardening : float
    pulls : bool
        Whether a contact with a dashpot holds until the overlap is gone.
    contact : str
        Key of `ADJACENT`.
    """

    strength: float
    xi: float
    damping: str = "Rayleigh, by building"
    slabs: bool = False
    everywhere: bool = False
    hardening: float = 0.02
    pulls: bool = True
    contact: str = "softer"

    @property
    def params(self) -> dict[str, object]:
        """Values of the decks' PARAMs."""
        return {
            "fy1": 2400 * self.strength, "fy2": 1400 * self.strength, "xi": self.xi,
            "slabs": int(self.slabs), "bays": "n" if self.everywhere else 1, "hard": self.hardening,
            "stick": '"YES"' if self.pulls else '"NO"', "ka": ADJACENT[self.contact],
        }  # fmt: skip

    @property
    def row(self) -> list[str]:
        """Cells of a table, as `HEAD` names them."""
        damped = "all" if self.slabs or self.damping != "Rayleigh, by building" else "columns"
        return [
            f"{self.strength:g}", f"{100 * self.xi:g} % {self.damping}", damped,
            "all nodes" if self.everywhere else "ends", f"{100 * self.hardening:g} %",
            "yes" if self.pulls else "no", self.contact,
        ]  # fmt: skip


HEAD = (
    "yield / Table IV", "damping", "damped members", "columns", "hardening", "dashpot pulls",
    "contact as the element that is",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Reading:
    """What the paper leaves unsaid, decided.

    Attributes
    ----------
    records : tuple of tuple of Record
        Of every earthquake the record, and others in its place where its file is missing.
    grounds : tuple of (str, str, str)
        Item, choice, and its ground.
    """

    name: str
    structure: Structure
    records: tuple[tuple[Record, ...], ...]
    grounds: tuple[tuple[str, str, str], ...]


#: the ground of columns at the ends: no other place is named
ENDS = "the least number; the paper does not say where columns stand"
LITERAL = Reading(
    "literal",
    Structure(1, 0.05, hardening=0.0, pulls=False),
    ((EL_CENTRO,), (MEXICO,), (LOMA_PRIETA,)),
    (
        ("storey yield", "Table IV", "printed: 2400 and 1400 kN a storey"),
        (
            "damping",
            "Rayleigh 5 % at both sway modes; diaphragms undamped",
            "usual ratio; a stiffness-proportional part damps waves in the diaphragms, which the theory "
            "does not",
        ),
        ("columns", "at both ends of each diaphragm, elastic-plastic", ENDS + "; no hardening is named"),
        (
            "contact",
            "n times the softer k_D; the dashpot of 0(equiv) lets go at zero force",
            "Figure 4: k_C is that of the adjacent element; a contact does not pull",
        ),
        (
            "El Centro",
            EL_CENTRO.says,
            "component and length as printed; of the two signs the one under which floor 1 collides",
        ),
        (
            "Mexico City",
            MEXICO.says,
            "component and factor as printed; where the long-period motion begins, with a jump of 0.2 g",
        ),
        (
            "Loma Prieta",
            LOMA_PRIETA.says,
            "component as printed; the station is one of several, the sign one of two",
        ),
    ),
)
TWICE = (
    "storey yield",
    "twice Table IV",
    "the yield as if entered for each column of a storey; a poster of the authors has the same values as "
    "'Yield load'",
)
STICKY = (
    "contact",
    "n times the softer k_D; 0(equiv) holds until the overlap is gone",
    "Figure 4; Eq. 15 is that of a contact that pulls",
)
STRONG = (
    "Mexico City",
    MEXICO_STRONG.says,
    "the strong part: the paper's motion causes moderate inelastic deformation",
)
RAYLEIGH = Reading(
    "Rayleigh",
    Structure(2, 0.03, slabs=True, everywhere=True),
    ((EL_CENTRO_OLD, EL_CENTRO), (MEXICO_STRONG,), (GILROY_3, GILROY_2, LOMA_PRIETA)),
    (
        TWICE,
        (
            "damping",
            "Rayleigh 3 % at both sway modes, diaphragms included",
            "the program of the paper applies Rayleigh damping to all members of a model",
        ),
        (
            "columns",
            "at all nodes of a diaphragm, shared out like its mass, bilinear with 2 % hardening",
            "the paper speaks of 'all columns that are connected to that diaphragm'; "
            "2 % is a usual hardening",
        ),
        STICKY,
        ("El Centro", EL_CENTRO_OLD.says, "a processing older than the PEER collection"),
        STRONG,
        (
            "Loma Prieta",
            GILROY_3.says,
            "a N-S component of the event with its strong part in the first 10 s",
        ),
    ),
)
MODAL = Reading(
    "modal",
    Structure(2, 0.05, "modal"),
    ((EL_CENTRO_OLD_TURNED, EL_CENTRO), (MEXICO_STRONG,), (GILROY_2, LOMA_PRIETA)),
    (
        TWICE,
        (
            "damping",
            "5 % in all modes of the model, those of the diaphragms included",
            "usual ratio; the program of the paper offers constant ratios",
        ),
        ("columns", "at both ends of each diaphragm, bilinear with 2 % hardening", ENDS),
        STICKY,
        (
            "El Centro",
            EL_CENTRO_OLD_TURNED.says,
            "a processing older than the PEER collection, one of two signs",
        ),
        STRONG,
        (
            "Loma Prieta",
            GILROY_2.says,
            "a N-S component of the event with its strong part in the first 10 s",
        ),
    ),
)
READINGS = (LITERAL, RAYLEIGH, MODAL)
#: structures that are run under all records
STRUCTURES = (
    LITERAL.structure,
    replace(LITERAL.structure, hardening=0.02, pulls=True, damping="modal"),
    Structure(1, 0.03, slabs=True),
    Structure(1, 0.05, slabs=True, contact="stiffer"),
    Structure(2, 0.05),
    Structure(2, 0.05, "Rayleigh, modes 1 and 2"),
    Structure(2, 0.05, "Rayleigh, modes 1 and 4"),
    MODAL.structure,
    replace(MODAL.structure, xi=0.04),
    replace(MODAL.structure, xi=0.03),
    replace(MODAL.structure, contact="harmonic mean"),
    replace(MODAL.structure, contact="stiffer"),
)
#: columns at all nodes cost ten times as much: these are run under the records of one reading alone
COSTLY = (
    (RAYLEIGH.structure, RAYLEIGH.records),
    (replace(MODAL.structure, everywhere=True), MODAL.records),
)


@dataclass(frozen=True, eq=False)
class Variant:
    """One choice of the literal reading changed, under El Centro."""

    name: str
    params: Mapping[str, object] = field(default_factory=dict)
    record: Record = EL_CENTRO
    damping: str = ""


VARIANTS = (
    Variant("record's own sign", record=EL_CENTRO_OWN),
    Variant("record from 2.05 s", record=replace(EL_CENTRO, start=2.05)),
    Variant("older processing of the record", record=EL_CENTRO_OLD),
    Variant("yield twice Table IV", {"fy1": 4800, "fy2": 2800}),
    Variant("no damping", {"xi": 0}),
    Variant("2 % damping", {"xi": 0.02}),
    Variant("tangent damping", {"of": '"TANGENT"'}),
    Variant("modal damping", damping=DAMPING["modal"]),
    Variant("hardening 2 %", {"hard": 0.02}),
    Variant("hardening 5 %", {"hard": 0.05}),
    Variant("damped diaphragms", {"slabs": 1}),
    Variant("contact of the stiffer element", {"ka": "kd1"}),
    Variant("contact of the harmonic mean", {"ka": ADJACENT["harmonic mean"]}),
)
