"""What is run: the paper's ten tests, more elements, other contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from pound_solve.laws.contact import restitution
from pound_solve.laws.two_bars import Diaphragm, Pair

HERE = Path(__file__).resolve().parent.parent
LUMPED, EQUIVALENT, DISTRIBUTED = (HERE / f"{n}.inp" for n in ("lumped", "equivalent", "distributed"))
KD1, KD2 = 1881300.0, 752520.0  #: axial stiffness of the diaphragms, Table IV [kN/m]
G = 9.81
PAIR = Pair(Diaphragm(1600 / G, KD1), Diaphragm(3000 / G, KD2))  #: the two floors of Table IV
BENCHMARK = "20"
TRADITIONAL = ("0(10)", "0(1)", "0(0.1)")


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
    name = f"{n}, steps of {dt:g} s" if dt else str(n)
    return Test(name, DISTRIBUTED, {"n": n}, (), method, dt)


def system(name: str, law: str, method: str | None = None, dt: float | None = None) -> Test:
    """The lumped buildings with another contact law."""
    return Test(
        name, LUMPED, {}, (("LAW=KELVIN_VOIGT  K=kc  C=cc  TENSION=stick", f"LAW={law}"),), method, dt
    )


def released(name: str, e: float, per: float, time: float) -> Test:
    """The lumped buildings with a contact of restitution `e`, which lets go at zero force; its undamped
    frequency is `per` over a `time` [s].
    """
    xi = restitution.no_tension_ratio(e)
    k = PAIR.mass * (per / time) ** 2
    params = {"kc": repr(k), "cc": repr(2.0 * xi * (k * PAIR.mass) ** 0.5), "stick": '"NO"'}
    return Test(name, LUMPED, params, (), "EXACT")


def until(name: str, e: float, duration: float) -> Test:
    """Contact that lasts a `duration` [s]."""
    return released(name, e, restitution.no_tension_time(restitution.no_tension_ratio(e)), duration)


def centred(name: str, e: float, centroid: float) -> Test:
    """Contact whose force has its centroid at a time [s]."""
    xi = restitution.no_tension_ratio(e)
    per = e / (1.0 + e) * (restitution.no_tension_time(xi) + 2.0 * xi)
    return released(name, e, per, centroid)


TESTS = (
    lumped("0(10)", 10 * KD1),
    lumped("0(1)", KD1),
    lumped("0(0.1)", 0.1 * KD1),
    Test("0(equiv)", EQUIVALENT, {"model": '"PAPER"'}, (), "EXACT"),
    *(distributed(n) for n in (1, 2, 3, 4, 5, 20)),
)
EXACT_EQUIVALENT = Test("0(exact)", EQUIVALENT, {"model": '"EXACT"'}, (), "EXACT")
#: restitution and time apart: those of the paper, one of each, and those of the bars; all let go at zero
#: force.  The last is 0(exact).
APART = (
    until("e of Eq. 14, T1", PAIR.e_paper, PAIR.first.period),
    until("exact e, T1", PAIR.e, PAIR.first.period),
    centred("e of Eq. 14, exact centroid", PAIR.e_paper, PAIR.centroid),
    centred("exact e, exact centroid", PAIR.e, PAIR.centroid),
)
FINER = (
    distributed(50),
    distributed(100, "CENTRAL", 2e-5),
    distributed(200, "CENTRAL", 2e-5),
    distributed(200, "CENTRAL", 1e-5),
)
#: the benchmark by its own method and by steps [s]
METHODS = (
    Test("EXACT", DISTRIBUTED, {"n": 20}, (), "EXACT"),
    *(
        Test(f"NEWMARK, {dt:g} s", DISTRIBUTED, {"n": 20}, (), "NEWMARK", dt)
        for dt in (1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
    ),
)
E = 0.65  #: restitution that is usual for concrete, and the plasticity index that stands for it
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
    Test(f"equivalent lumped mass, paper, r = {E}", EQUIVALENT, {"model": '"PAPER"', "r": E}),
    Test(f"equivalent lumped mass, exact, r = {E}", EQUIVALENT, {"model": '"EXACT"', "r": E}),
    Test("distributed masses, n = 20", DISTRIBUTED, {"n": 20}),
)
FACTORS = (
    0.5,
    0.6,
    0.7,
    0.74,
    0.7499,
    0.7501,
    0.76,
    0.8,
    0.9,
    1.0,
    1.1,
    1.25,
    1.5,
)  #: on k_D1; Z1 = Z2 at 0.75


def stiffened() -> Iterator[tuple[float, tuple[Test, ...]]]:
    """Equivalent contacts and distributed masses with other stiffnesses of the first diaphragm."""
    for factor in FACTORS:
        kd1 = factor * KD1
        pair = Pair(Diaphragm(1600 / G, kd1), Diaphragm(3000 / G, KD2))
        changed = {"kd1": repr(kd1)}
        yield (
            factor,
            (
                Test("0(equiv)", EQUIVALENT, {"model": '"PAPER"', **changed}, (), "EXACT"),
                Test("0(exact)", EQUIVALENT, {"model": '"EXACT"', **changed}, (), "EXACT"),
                until("0(touch)", pair.e, pair.duration),
                Test("20", DISTRIBUTED, {"n": 20, "ka": repr(min(kd1, KD2)), **changed}, (), "EXACT"),
            ),
        )
