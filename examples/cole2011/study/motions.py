"""Records of the three earthquakes: stations, processings, signs and windows that the paper allows."""

from __future__ import annotations

from dataclasses import dataclass, replace


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
EL_CENTRO_OLD_TURNED = replace(EL_CENTRO_OLD, sign=-1, says=EL_CENTRO_OLD.says + " × (−1)")
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

#: of every earthquake the records that the readings take
RECORDS = (
    (
        EL_CENTRO, EL_CENTRO_OWN, EL_CENTRO_OLD, EL_CENTRO_OLD_TURNED,
        replace(EL_CENTRO, start=2.05, says="PEER 270 × (−1), 2.05 to 12.05 s"),
    ),
    (MEXICO, MEXICO_STRONG, replace(MEXICO_STRONG, sign=1, says="SCT E-W, 54.02 to 64.02 s")),
    (LOMA_PRIETA, CORRALITOS_OWN, GILROY_3, GILROY_2, CAPITOLA),
)  # fmt: skip


def disturbed(record: Record) -> tuple[Record, ...]:
    """The record 1 % weaker and stronger, and a sample earlier (where there is one) and later."""
    starts = [start for start in (record.start - record.step, record.start + record.step) if start >= 0]
    return (
        *(replace(record, scale=record.scale * factor) for factor in (0.99, 1.01)),
        *(replace(record, start=start) for start in starts),
    )
