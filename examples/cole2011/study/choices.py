"""Readings of what the paper does not say: values of the decks' PARAMs, and records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Record:
    """A record as a reading uses it.

    Attributes
    ----------
    name : str
        Earthquake, as the paper names it.
    file : str
        Known name, or file on the records path.
    sign, scale, start : float
        PARAMs of the decks.
    items : str
        Items of the RECORD card that its format needs.
    says : str
        Station, processing and window.
    step : float
        Interval of the samples [s].
    """

    name: str
    file: str
    sign: float
    scale: float
    start: float = 0.0
    items: str = ""
    says: str = ""
    step: float = 0.02

    @property
    def params(self) -> dict[str, object]:
        """PARAM values of the decks."""
        return {"record": f'"{self.file}"', "sign": self.sign, "scale": self.scale, "t0": self.start}


EL_CENTRO = Record("El Centro", "ELCENTRO_270", -1, 1, says="PEER 270 × (−1), first 10 s", step=0.01)
EL_CENTRO_OWN = replace(EL_CENTRO, sign=1, says="PEER 270, first 10 s")
EL_CENTRO_OLD = Record(
    "El Centro",
    "elcentro_1940_ew_smc_g_0p02.dat",
    1,
    1,
    0,
    "COLUMN=2",
    "older processing, 0.214 g, first 10 s",
)
SCT = "mexico_1985_sct_t_ns_ew_ud_g_0p02.txt"
MEXICO = Record("Mexico City", SCT, 1, 2, 43, "COLUMN=3", "SCT E-W, 43 to 53 s")
MEXICO_STRONG = Record("Mexico City", SCT, -1, 2, 54.02, "COLUMN=3", "SCT E-W × (−1), 54.02 to 64.02 s")
LOMA_PRIETA = Record(
    "Loma Prieta", "CORRALITOS_000", -1, 1, says="Corralitos 000 × (−1), first 10 s", step=0.005
)
CORRALITOS_OWN = replace(LOMA_PRIETA, sign=1, says="Corralitos 000, first 10 s")
GILROY_3 = Record(
    "Loma Prieta", "loma_prieta_1989_gilroy3_000_p695_121021.txt", 1, 1, 0, "COLUMN=2",
    "Gilroy 3 000, first 10 s", 0.005,
)  # fmt: skip
GILROY_2 = Record(
    "Loma Prieta", "loma_prieta_1989_gilroy2_000.at2", 1, 1, says="Gilroy 2 000, first 10 s", step=0.005
)
CAPITOLA = Record(
    "Loma Prieta", "loma_prieta_1989_capitola_000_p695_121011.txt", 1, 1, 0, "COLUMN=2",
    "Capitola 000, first 10 s", 0.005,
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Reading:
    """What the paper leaves unsaid, decided: PARAMs of the decks, and records.

    Attributes
    ----------
    params : mapping
        Values of PARAMs; a deck takes those that it has.
    records : tuple of tuple of Record
        Of every earthquake the record, and others in its place where its file is missing.
    grounds : tuple of (str, str, str)
        Item, choice, and its ground.
    """

    name: str
    params: Mapping[str, object] = field(default_factory=dict)
    records: tuple[tuple[Record, ...], ...] = ()
    grounds: tuple[tuple[str, str, str], ...] = ()


LITERAL = Reading(
    "literal",
    {},
    ((EL_CENTRO,), (MEXICO,), (LOMA_PRIETA,)),
    (
        ("storey yield", "Table IV", "printed: 2400 and 1400 kN a storey"),
        (
            "damping",
            "Rayleigh 5 % at both sway modes; diaphragms undamped",
            "usual ratio; a stiffness-proportional part damps waves in the diaphragms, which the theory "
            "does not",
        ),
        (
            "columns",
            "at both ends of each diaphragm, elastic-plastic",
            "Figure 8 draws columns at the ends; no hardening is named",
        ),
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
BEST = Reading(
    "best",
    {"fy1": 4800, "fy2": 2800, "xi": 0.03, "slabs": 1, "bays": "n", "hard": 0.02, "stick": '"YES"'},
    ((EL_CENTRO_OLD, EL_CENTRO), (MEXICO_STRONG,), (GILROY_3, GILROY_2, LOMA_PRIETA)),
    (
        (
            "storey yield",
            "twice Table IV",
            "the yield as if entered for each column of a storey; a poster of the authors has the same "
            "values as 'Yield load'",
        ),
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
        (
            "contact",
            "n times the softer k_D; 0(equiv) holds until the overlap is gone",
            "Figure 4; Eq. 15 is that of a contact that pulls",
        ),
        ("El Centro", EL_CENTRO_OLD.says, "a processing older than the PEER collection"),
        (
            "Mexico City",
            MEXICO_STRONG.says,
            "the strong part: the paper's motion causes moderate inelastic deformation",
        ),
        (
            "Loma Prieta",
            GILROY_3.says,
            "a N-S component of the event with its strong part in the first 10 s",
        ),
    ),
)
READINGS = (LITERAL, BEST)


@dataclass(frozen=True, eq=False)
class Variant:
    """One choice of the literal reading changed, under El Centro."""

    name: str
    params: Mapping[str, object] = field(default_factory=dict)
    record: Record = EL_CENTRO


VARIANTS = (
    Variant("literal reading"),
    Variant("record's own sign", record=EL_CENTRO_OWN),
    Variant("record from 2.05 s", record=replace(EL_CENTRO, start=2.05)),
    Variant("older processing of the record", record=EL_CENTRO_OLD),
    Variant("yield twice Table IV", {"fy1": 4800, "fy2": 2800}),
    Variant("no damping", {"xi": 0}),
    Variant("2 % damping", {"xi": 0.02}),
    Variant("tangent damping", {"of": '"TANGENT"'}),
    Variant("hardening 2 %", {"hard": 0.02}),
    Variant("hardening 5 %", {"hard": 0.05}),
    Variant("damped diaphragms", {"slabs": 1}),
    Variant("contact of the stiffer element", {"ka": "kd1"}),
    Variant("contact of the harmonic mean", {"ka": "2*kd1*kd2/(kd1+kd2)"}),
)


def disturbed(record: Record) -> tuple[Record, ...]:
    """The record 1 % weaker and stronger, and a sample earlier (where there is one) and later."""
    starts = [start for start in (record.start - record.step, record.start + record.step) if start >= 0]
    return (
        *(replace(record, scale=record.scale * factor) for factor in (0.99, 1.01)),
        *(replace(record, start=start) for start in starts),
    )
