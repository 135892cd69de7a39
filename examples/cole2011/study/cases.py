"""What is run: the paper's ten tests, three records, and variants of what the paper does not say."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pound_solve.theory.two_bars import Diaphragm, Pair

HERE = Path(__file__).resolve().parent.parent
LUMPED, EQUIVALENT, DISTRIBUTED = (HERE / f"{n}.inp" for n in ("lumped", "equivalent", "distributed"))
KD1, KD2 = 1881300.0, 752520.0  #: axial stiffness of the diaphragms, Table IV [kN/m]
G = 9.81
PAIR = Pair(Diaphragm(1600 / G, KD1), Diaphragm(3000 / G, KD2))  #: the two floors of Table IV
BENCHMARK = "20"
TRADITIONAL = ("0(10)", "0(1)", "0(0.1)")


@dataclass(frozen=True)
class Record:
    """A record as the study uses it.

    Attributes
    ----------
    file : str
        Known name, or file on the records path.
    items : str
        Items of the RECORD card that its format needs.
    sign, scale, start : float
        PARAMs of the decks.
    """

    name: str
    file: str
    sign: float
    scale: float
    start: float = 0.0
    items: str = ""

    @property
    def params(self) -> dict[str, object]:
        """PARAM values of the decks."""
        return {"record": f'"{self.file}"', "sign": self.sign, "scale": self.scale, "t0": self.start}


EL_CENTRO = Record("El Centro", "ELCENTRO_270", -1, 1)
MEXICO = Record("Mexico City", "mexico_1985_sct_t_ns_ew_ud_g_0p02.txt", 1, 2, 43, "COLUMN=3")
LOMA_PRIETA = Record("Loma Prieta", "CORRALITOS_000", -1, 1)
RECORDS = (EL_CENTRO, MEXICO, LOMA_PRIETA)


@dataclass(frozen=True, eq=False)
class Test:
    """One row of the paper's Table V, one number of elements, or one named system.

    Attributes
    ----------
    edits : tuple of (str, str)
        Texts of the deck and what stands in their place.
    method, dt : str or None, float or None
        Replace those of the deck.
    """

    name: str
    deck: Path
    params: Mapping[str, object]
    edits: tuple[tuple[str, str], ...] = ()
    method: str | None = None
    dt: float | None = None


def lumped(name: str, kc: float, cc: float = 0.0) -> Test:
    """A test with rigid diaphragms and a Kelvin-Voigt contact."""
    return Test(name, LUMPED, {"kc": repr(kc), "cc": repr(cc)}, (), "EXACT")


def distributed(n: int, method: str = "EXACT", dt: float | None = None) -> Test:
    """A test with n axial elements in every diaphragm."""
    return Test(str(n), DISTRIBUTED, {"n": n}, (), method, dt)


def system(name: str, law: str, method: str | None = None, dt: float | None = None) -> Test:
    """The lumped buildings with another contact law."""
    return Test(name, LUMPED, {}, (("LAW=KELVIN_VOIGT  K=kc  C=cc", f"LAW={law}"),), method, dt)


TESTS = (
    lumped("0(10)", 10 * KD1),
    lumped("0(1)", KD1),
    lumped("0(0.1)", 0.1 * KD1),
    Test("0(equiv)", EQUIVALENT, {"model": '"PAPER"'}, (), "EXACT"),
    *(distributed(n) for n in (1, 2, 3, 4, 5, 20)),
)
EXACT_EQUIVALENT = Test("0(exact)", EQUIVALENT, {"model": '"EXACT"'}, (), "EXACT")
FINER = (distributed(50), distributed(100, "CENTRAL", 2e-5), distributed(200, "CENTRAL", 1e-5))
E = 0.65  #: restitution that is usual for concrete
#: stiffness of the Hertz laws [kN/m^1.5]: at 0.3 m/s the peak force of the linear spring k_D, no dashpot
HERTZ = (0.3 * (KD1 * PAIR.mass) ** 0.5 / (1.25 * PAIR.mass * 0.3**2) ** 0.6) ** 2.5
SYSTEMS = (
    system("stereomechanics", f"STEREOMECHANICS E={E}"),
    system("stereomechanics, elastic", "STEREOMECHANICS E=1"),
    system("Lagrange multiplier", "LAGRANGE"),
    Test("Laplace, linear spring k_D", LUMPED, {"kc": repr(KD1)}, (), "LAPLACE", 2.5e-4),
    Test("linear spring k_D", LUMPED, {"kc": repr(KD1)}),
    system("Kelvin-Voigt", f"KELVIN_VOIGT K=kd1 E={E} TENSION=YES"),
    system("Kelvin-Voigt, no tension", f"KELVIN_VOIGT K=kd1 E={E}"),
    system("Mahmoud & Jankowski", f"MAHMOUD_JANKOWSKI K=kd1 E={E}"),
    system("Hertz", f"HERTZ K={HERTZ!r}"),
    system("Jankowski", f"JANKOWSKI K={HERTZ!r} E={E}"),
    system("Hertzdamp", f"HERTZDAMP K={HERTZ!r} E={E}"),
    system("Hertzdamp, published relation", f"HERTZDAMP K={HERTZ!r} E={E} RELATION=PUBLISHED"),
    Test("equivalent lumped mass, paper", EQUIVALENT, {"model": '"PAPER"'}),
    Test("equivalent lumped mass, exact", EQUIVALENT, {"model": '"EXACT"'}),
    Test("distributed masses, n = 20", DISTRIBUTED, {"n": 20}),
)


@dataclass(frozen=True, eq=False)
class Variant:
    """A reading of what the paper leaves unsaid: other PARAMs, other lines of the decks, another record.

    Attributes
    ----------
    edits : tuple of (str, str)
        Texts of the decks and what stands in their place; a deck without the text stays as it is.
    rebuild : callable or None
        Makes another deck out of that with distributed masses.
    """

    name: str
    params: Mapping[str, object] = field(default_factory=dict)
    edits: tuple[tuple[str, str], ...] = ()
    rebuild: Callable[[str], str] | None = None
    record: Record = EL_CENTRO


def columns_everywhere(lines: str) -> str:
    """Stand columns under all nodes of a diaphragm, their stiffness shared like its mass."""
    out = []
    for line in lines.splitlines():
        words = line.split()
        first = words[0] if words else ""
        if first in ("1", "3") and words[-1] == "FIX=XYR":
            base, x = ("5000", "0 TO 20") if first == "1" else ("6000", "20+gap TO 70+gap")
            out.append(f"   {base} TO {base}+n  {x}  0  FIX=XYR")
        elif first in ("2", "4") and words[-1] == "FIX=XYR":
            continue
        elif len(words) == 4 and words[1] in ("COL1", "COL2") and words[2] in ("1", "3", "1000", "3000"):
            # the left column stands for its row: ends and the nodes between
            prop, top = words[1], int(words[3])
            foot = {"1": 5000, "3": 6000}.get(words[2], top - 1000)
            number = 10 * top
            out += [
                f"   {number}  {prop}E  {foot}  {top}",
                f"   {number}+n  {prop}E  {foot}+n  {top}+n",
                f"   {number + 1} TO {number - 1}+n  {prop}M  {foot + 1} TO {foot - 1}+n"
                f"  {top + 1} TO {top - 1}+n",
            ]
        elif len(words) == 4 and words[1] in ("COL1", "COL2"):
            continue
        elif first in ("COL1", "COL2"):
            end, rest = " ".join(words[1:]).replace("/2", "/(2*n)"), " ".join(words[1:]).replace("/2", "/n")
            out += [f"   {first}E  {end}", f"   {first}M  {rest}"]
        elif first == "RAYLEIGH":
            out.append(
                line.replace("PROPS=COL1", "PROPS=COL1E,COL1M").replace("PROPS=COL2", "PROPS=COL2E,COL2M")
            )
        elif line.lstrip().startswith('"B') and words[-2] in "1234":
            foot = {"1": "5000", "2": "5000+n", "3": "6000", "4": "6000+n"}[words[-2]]
            out.append(" ".join(["  ", *words[:-2], foot, words[-1]]))
        else:
            out.append(line)
    return "\n".join(out) + "\n"


RAYLEIGH = "   RAYLEIGH  XI=xi"
VARIANTS = (
    Variant("decks unchanged"),
    Variant("record's own sign", record=Record("El Centro", "ELCENTRO_270", 1, 1)),
    Variant("record from 2.05 s", record=Record("El Centro", "ELCENTRO_270", -1, 1, 2.05)),
    Variant(
        "older processing of the record",
        record=Record("El Centro", "elcentro_1940_ew_smc_g_0p02.dat", 1, 1, items="COLUMN=2"),
    ),
    Variant("no damping", {"xi": 0}),
    Variant("2 % damping", {"xi": 0.02}),
    Variant("tangent damping", edits=((RAYLEIGH, RAYLEIGH + "  STIFFNESS=TANGENT"),)),
    Variant("hardening 2 %", edits=(("RULE=ELASTO_PLASTIC", "RULE=BILINEAR  R=0.02"),)),
    Variant("hardening 5 %", edits=(("RULE=ELASTO_PLASTIC", "RULE=BILINEAR  R=0.05"),)),
    Variant(
        "damped diaphragms",
        edits=(("+n  PROPS=COL1", "+n  PROPS=COL1,SLAB1"), ("+n  PROPS=COL2", "+n  PROPS=COL2,SLAB2")),
    ),
    Variant("columns at all nodes", rebuild=columns_everywhere),
    Variant("contact of the stiffer element", edits=(("kc = n*kd2", "kc = n*kd1"),)),
    Variant("contact of the harmonic mean", edits=(("kc = n*kd2", "kc = n*2*kd1*kd2/(kd1+kd2)"),)),
)
