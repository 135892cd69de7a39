"""Idealised capacity, equivalent oscillator and performance point, by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from decks import model_of
from pound_solve import run
from pound_solve.analyses import pushover_checks
from pound_solve.analyses.capacity_line import CapacityCurve
from pound_solve.analyses.load_pattern import EquivalentSystem
from pound_solve.analyses.pushover import CapacityPoint
from pound_solve.results import Results
from pound_solve.structure.assembly import assemble


def curve(*points: tuple[float, float]) -> CapacityCurve:
    return CapacityCurve([CapacityPoint(d, v, v, 0, 1) for d, v in points])


# the line


def test_the_line_has_the_area_of_the_curve() -> None:
    """Corners (0.1, 10), (0.3, 14), then down to 7 at 0.5: Vy = 14, E = 0.5 + 2.4."""
    c = curve((0.0, 0.0), (0.1, 10.0), (0.3, 14.0), (0.5, 7.0))
    line = c.line(c.strongest)
    assert line is not None and (c.strongest, line.yield_shear) == (0.3, 14.0)
    assert line.yield_displacement == pytest.approx(2 * (0.3 - 2.9 / 14), rel=1e-14)
    # 80 % of 14 is left at 0.3 + 0.2 * 2.8/7
    assert c.ultimate == pytest.approx(0.38, rel=1e-14)
    # up to a displacement between the corners
    line = c.line(0.2)
    assert line is not None and line.yield_shear == pytest.approx(12.0, rel=1e-14)
    assert line.yield_displacement == pytest.approx(2 * (0.2 - (0.5 + 0.05 * 22) / 12), rel=1e-13)


def test_a_plateau_ends_where_it_is_left() -> None:
    c = curve((0.0, 0.0), (0.1, 10.0), (0.4, 10.0), (0.6, 0.0))
    assert c.strongest == 0.4 and c.ultimate == pytest.approx(0.44, rel=1e-14)
    line = c.line(c.strongest)
    assert line is not None and line.yield_displacement == pytest.approx(0.1, rel=1e-14)


def test_the_static_state_is_the_origin_and_the_sense_that_of_the_push() -> None:
    c, mirrored = curve((0.1, 2.0), (0.3, 8.0), (0.5, 8.0)), curve((0.1, 2.0), (-0.1, -4.0), (-0.3, -4.0))
    for found in (c, mirrored):
        assert found.d == pytest.approx([0.0, 0.2, 0.4]) and found.v == pytest.approx([0.0, 6.0, 6.0])
    assert (c.sense, mirrored.sense) == (1.0, -1.0)


def test_a_curve_that_stiffens_has_no_line() -> None:
    """A contact closes at 0.2: the area is below that of a triangle."""
    c = curve((0.0, 0.0), (0.2, 2.0), (0.4, 40.0))
    assert c.line(0.4) is None and c.line(0.2) is not None
    back = curve((0.0, 0.0), (0.2, 2.0), (0.1, 3.0), (0.4, 4.0))
    assert back.line(0.4) is None and back.line(0.15) is None


def test_an_elastic_curve_yields_at_its_end() -> None:
    line = curve((0.0, 0.0), (1 / 3, 7.0)).line(1 / 3)
    assert line is not None and line.yield_displacement == pytest.approx(1 / 3, rel=1e-12)


# the performance point


def plastic(stiffness: float = 100.0, strength: float = 10.0) -> CapacityCurve:
    return curve((0.0, 0.0), (strength / stiffness, strength), (1.0, strength))


def flat(level: float):
    """Spectrum whose displacement is proportional to the square of the period."""
    return lambda periods: np.full(len(periods), level)


SYSTEM = EquivalentSystem(4.0, 1.25, 5.0)


def test_equal_displacement_beyond_the_corner() -> None:
    """T* = 2 pi sqrt(4/100) = 1.2566; Se = 8: Sd = 8 * 4/100 = 0.32, times 1.25 = 0.4."""
    point = plastic().performance(SYSTEM, flat(8.0), 0.5)
    assert point is not None and point.line.end == pytest.approx(0.4, rel=1e-11)
    assert point.period == pytest.approx(2 * math.pi * 0.2, rel=1e-11)
    assert point.reduction == pytest.approx(8 * 1.25 * 4 / 10, rel=1e-11)


def test_more_than_equal_displacement_below_the_corner() -> None:
    """q_u = 4, T* = 1.2566 = TC/2: d = 0.4/4 (1 + 3 * 2) = 0.7."""
    point = plastic().performance(SYSTEM, flat(8.0), 2 * 2 * math.pi * 0.2)
    assert point is not None and point.line.end == pytest.approx(0.7, rel=1e-11)


def test_an_elastic_answer_needs_no_rule() -> None:
    """Sd * factor = 0.05 < 0.1, on either side of the corner."""
    for corner in (0.1, 10.0):
        point = plastic().performance(SYSTEM, flat(1.0), corner)
        assert point is not None and point.line.end == pytest.approx(0.05, rel=1e-11)
        assert point.reduction == pytest.approx(1.0, rel=1e-11)


def test_a_demand_beyond_the_curve_is_told() -> None:
    assert plastic().performance(SYSTEM, flat(21.0), 0.5) is None
    stiffening = curve((0.0, 0.0), (0.2, 2.0), (1.0, 400.0))
    assert stiffening.performance(SYSTEM, flat(8.0), 0.5) is None


@given(
    hard=st.floats(0.0, 0.8),
    level=st.floats(0.5, 12.0),
    corner=st.floats(0.05, 4.0),
    far=st.floats(1.0, 3.0),
)
def test_the_point_does_not_depend_on_the_target(
    hard: float, level: float, corner: float, far: float
) -> None:
    """A curve that is pushed further has the same point; its line ends at it and has its displacement."""

    def reaching(end: float) -> CapacityCurve:
        return curve((0.0, 0.0), (0.1, 10.0), (end, 10.0 + 100.0 * hard * (end - 0.1)))

    one, two = (reaching(end).performance(SYSTEM, flat(level), corner) for end in (4.0, 4.0 * far))
    if one is not None:
        assert two is not None and two.line.end == pytest.approx(one.line.end, rel=1e-9)
        assert one.demand == pytest.approx(one.line.end, rel=1e-9)


def test_a_ground_at_rest_leaves_the_static_state() -> None:
    point = plastic().performance(SYSTEM, flat(0.0), 0.5)
    assert point is not None and point.demand == 0.0 and point.line.end < 1e-11


@given(
    knots=st.lists(
        st.tuples(st.floats(1e-3, 1.0) | st.just(0.0), st.floats(-5.0, 50.0)), min_size=0, max_size=6
    ),
    level=st.floats(0.0, 30.0),
    corner=st.floats(0.01, 5.0),
)
def test_every_curve_has_an_answer(knots: list[tuple[float, float]], level: float, corner: float) -> None:
    """Also one that falls, stiffens, or changes its side: a point whose line ends at it, or none."""
    d = np.concatenate([[0.0], np.cumsum([step for step, _ in knots])])
    v = [0.0, *(shear for _, shear in knots)]
    c = curve(*zip(d.tolist(), v))
    point = c.performance(SYSTEM, flat(level), corner)
    if point is not None and level:
        assert 0.0 < point.line.end <= d[-1] * (1.0 + 1e-12)
        elastic = (
            SYSTEM.factor * level * SYSTEM.mass * point.line.yield_displacement / point.line.yield_shear
        )
        ratio = level * SYSTEM.factor * SYSTEM.mass / point.line.yield_shear
        longer = (
            1.0 if ratio <= 1.0 else max(1.0, (1 + (ratio - 1) * max(corner / point.period, 1.0)) / ratio)
        )
        assert point.demand == pytest.approx(elastic * longer, rel=1e-9)
        assert 0.0 < point.line.yield_displacement <= point.line.end


def test_the_point_does_not_depend_on_target_and_stations(tmp_path: Path) -> None:
    """A record-like spectrum that meets the curve several times: the first meeting counts."""
    found = []
    for card in ("2 3", "2 10", "2 3 STEPS=10", "2 10 STEPS=10"):
        deck = tmp_path / "deck.inp"
        deck.write_text(
            "NODES\n 1 0 0 FIX=XYR\n 2 0 3 FIX=YR\nELEMENTS\n 1 A 1 2\nPROPS\n"
            " A SPRING KX=100 FX=5 RULE=BILINEAR R=0.3\nWEIGHTS\n 2 19.62\n"
            f"EQUAKE\n SINE AMPLITUDE=1.5 PERIOD=1.3 DURATION=40\nANALYSIS\n PUSHOVER {card} TC=0.3\n"
        )
        (point,) = run(deck, out=tmp_path).table("performance")
        found.append(point["displacement"])
    assert found == pytest.approx([found[0]] * 4, rel=1e-9) and found[0] < 0.11


# the equivalent oscillator, from decks

STOREYS = """
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 2 3
PROPS
 A SPRING KX=100 FX=5 RULE=BILINEAR R=0.2
 B SPRING KX=80 FX=3 RULE=BILINEAR R=0.1
WEIGHTS
 2 19.62
 3 9.81
"""


def ran(folder: Path, card: str, more: str = "") -> Results:
    deck = folder / "deck.inp"
    deck.write_text(f"{STOREYS}{more}ANALYSIS\n PUSHOVER {card}\n")
    return run(deck, out=folder)


@pytest.mark.parametrize(
    ("card", "phi"),
    [
        ("3 0.5", (0.5, 1.0)),
        ("2 0.5", (1.0, 2.0)),
        ("3 0.5 PATTERN=UNIFORM", (1.0, 1.0)),
        # forces 1 and 2: u2 = 3/100, u3 = u2 + 2/80
        ("3 0.5 PATTERN=FORCES NODES=2,3 FORCES=1,2", (0.03 / 0.055, 1.0)),
        # at the roof alone: u2 = 1/100, u3 = u2 + 1/80; all masses count
        ("3 0.5 PATTERN=FORCES NODES=3 FORCES=1", (0.01 / 0.0225, 1.0)),
        ("3 0.5 PATTERN=UNIFORM NODES=3", (0.01 / 0.0225, 1.0)),
    ],
)
def test_mass_and_factor_of_the_oscillator(tmp_path: Path, card: str, phi: tuple[float, float]) -> None:
    """Masses 2 and 1: m* = sum m phi, factor m* / sum m phi^2."""
    (row,) = ran(tmp_path, card).table("capacity_line")
    mass = 2 * phi[0] + phi[1]
    assert row["mass"] == pytest.approx(mass, rel=1e-12)
    assert row["participation"] == pytest.approx(mass / (2 * phi[0] ** 2 + phi[1] ** 2), rel=1e-12)
    assert row["period"] == pytest.approx(2 * math.pi * math.sqrt(mass / row["stiffness"]), rel=1e-12)
    assert row["shear_ratio"] == pytest.approx(row["yield_shear"] / 29.43, rel=1e-9)


def test_an_elastic_frame_moves_as_the_spectrum_of_its_mode(tmp_path: Path) -> None:
    """With the pattern of the first mode the oscillator is that mode: T* its period, the performance point
    its modal displacement.
    """
    motion = "EQUAKE\n SINE AMPLITUDE=0.2 PERIOD=0.7 DURATION=3\n"
    results = ran(tmp_path, "3 0.08 PATTERN=MODE TC=0.6", motion)
    (line,), (point,) = results.table("capacity_line"), results.table("performance")
    k, m = np.array([[180.0, -80.0], [-80.0, 80.0]]), np.diag([2.0, 1.0])
    values, shapes = np.linalg.eig(np.linalg.solve(m, k))
    n = int(np.argmin(values))
    phi = shapes[:, n] / shapes[1, n]
    assert line["participation"] == pytest.approx(phi @ m @ [1, 1] / (phi @ m @ phi), rel=1e-12)
    period = 2 * math.pi / math.sqrt(values[n])
    assert point["period"] == pytest.approx(period, rel=1e-9) and point["changes"] == 0
    acceleration = point["acceleration"]
    assert point["displacement"] == pytest.approx(
        line["participation"] * acceleration / values[n], rel=1e-9
    )
    spectrum = results.table("push_spectra")
    assert np.interp(period, spectrum["period"], spectrum["acceleration"]) == pytest.approx(
        acceleration, rel=0.02
    )


def test_a_demand_beyond_the_curve_has_no_numbers(tmp_path: Path) -> None:
    results = ran(tmp_path, "3 0.1 TC=0.6", "EQUAKE\n SINE AMPLITUDE=20 PERIOD=0.7 DURATION=3\n")
    (point,) = results.table("performance")
    assert math.isnan(point["displacement"]) and point["changes"] == 0
    assert "A row without numbers means" in (tmp_path / "deck.rpt").read_text()


def test_a_stiff_building_under_a_long_motion_follows_the_ground(tmp_path: Path) -> None:
    """A period of 1e-8 s divides the motion into too many intervals; the answer is on the safe side."""
    deck = tmp_path / "deck.inp"
    deck.write_text(
        STOREYS.replace("KX=100", "KX=1e18").replace("KX=80", "KX=1e18").replace("FX=5", "FX=1e9")
        + "EQUAKE\n SINE AMPLITUDE=2 PERIOD=0.7 DURATION=7\nANALYSIS\n PUSHOVER 3 1e-10 TC=0.5\n"
    )
    results = run(deck, out=tmp_path)
    (point,) = results.table("performance")
    assert point["acceleration"] == pytest.approx(2.0, rel=2e-2)


def test_page_one_has_the_capacity_and_the_performance_point(tmp_path: Path) -> None:
    """The displacement includes that of the static load, as in the table of performance points."""
    deck = tmp_path / "deck.inp"
    deck.write_text(
        f"{STOREYS}LOADS\n 3 1\nEQUAKE\n SINE AMPLITUDE=0.2 PERIOD=0.7 DURATION=3\nANALYSIS\n"
        " PUSHOVER 3 0.2 TC=0.6\n PUSHOVER 3 0.03 TC=0.6\n PUSHOVER 3 0.1,-0.1\n"
    )
    results = run(deck, out=tmp_path)
    overview = {row["item"]: row["value"] for row in results.table("overview")}
    point, beyond = results.table("performance")
    top = results.table("capacity_curve")["base_shear"][results.table("capacity_curve")["push"] == 1].max()
    assert overview["pushover 1"] == (
        f"largest base shear {top:.5g} kN at 0.2 m; N2 {point['displacement']:.4g} m under 1 SINE"
    )
    assert math.isnan(beyond["displacement"]) and "; no N2 point under 1 SINE" in overview["pushover 2"]
    assert overview["pushover 3"].endswith(", in 2 legs")


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_point_on_a_curve_with_a_static_load(tmp_path: Path, sense: float) -> None:
    """One storey, k = 100, F = 5, static 1: beyond yield, by hand from the ordinate at T*.

    The curve from the static state: to the load's side it yields after 4, at 0.04, else after 6, at 0.06.
    The control displacement is 0.01 + sense * d, the shear 1 + sense * V.
    """
    deck = tmp_path / "deck.inp"
    deck.write_text(
        "NODES\n 1 0 0 FIX=XYR\n 2 0 3 FIX=YR\nELEMENTS\n 1 A 1 2\nPROPS\n"
        " A SPRING KX=100 FX=5 RULE=ELASTO_PLASTIC\nWEIGHTS\n 2 19.62\nLOADS\n 2 1\n"
        f"EQUAKE\n SINE AMPLITUDE=2 PERIOD=0.9 DURATION=1\nANALYSIS\n PUSHOVER 2 {sense * 3} TC=0.3\n"
    )
    results = run(deck, out=tmp_path)
    (point,), (line,) = results.table("performance"), results.table("capacity_line")
    strength = 4.0 if sense > 0 else 6.0
    assert line["yield_displacement"] == pytest.approx(strength / 100, rel=1e-9)
    assert line["yield_shear"] == pytest.approx(strength, rel=1e-12)
    period = 2 * math.pi * math.sqrt(2 / 100)
    assert point["period"] == pytest.approx(period, rel=1e-9)
    d = point["acceleration"] / 50.0
    assert d > strength / 100  # it yields
    assert point["displacement"] == pytest.approx(0.01 + sense * d, rel=1e-9)
    assert point["base_shear"] == pytest.approx(1.0 + sense * strength, rel=1e-12)
    assert point["reduction"] == pytest.approx(point["acceleration"] * 2 / strength, rel=1e-9)
    assert point["ductility"] == pytest.approx(100 * d / strength, rel=1e-9) and point["changes"] == 1
    spectrum = results.table("push_spectra")
    ordinates = spectrum["displacement"] * (2 * math.pi / spectrum["period"]) ** 2
    assert ordinates == pytest.approx(spectrum["acceleration"], rel=1e-12)


@pytest.mark.parametrize(
    ("more", "card", "told"),
    [
        ("", "3 0.5 BASE=1 TC=1", "TC takes the whole base shear"),
        (" 12 5 3 FIX=YR\n", "3 0.5 TC=1", "the performance point is that of one building with mass"),
    ],
)
def test_a_point_needs_one_building_and_its_whole_shear(more: str, card: str, told: str) -> None:
    text = STOREYS.replace(" 3 0 6 FIX=YR\n", f" 3 0 6 FIX=YR\n{more}")
    if more:
        text = text.replace(" 2 B 2 3\n", " 2 B 2 3\n 12 B 12\n").replace(" 3 9.81\n", " 3 9.81\n 12 30\n")
    model = model_of(f"{text}EQUAKE\n SINE AMPLITUDE=1 PERIOD=1 DURATION=1\nANALYSIS\n PUSHOVER {card}\n")
    found = pushover_checks.mistaken_cards(assemble(model))
    assert [d.message for d in found] == [told]


def test_motions_of_one_name_are_numbered(tmp_path: Path) -> None:
    motions = (
        "EQUAKE\n SINE AMPLITUDE=0.2 PERIOD=0.7 DURATION=3\n SINE AMPLITUDE=0.1 PERIOD=0.7 DURATION=3\n"
    )
    results = ran(tmp_path, "3 0.5 TC=0.6", motions)
    points, spectra = results.table("performance"), results.table("push_spectra")
    assert points["motion"].tolist() == ["1 SINE", "2 SINE"]
    one, two = (spectra[spectra["motion"] == name]["acceleration"] for name in ("1 SINE", "2 SINE"))
    assert one == pytest.approx(2.0 * two, rel=1e-12)
