"""Response spectra: closed forms, limits, an independent integration, and the verb ``spectrum``."""

from __future__ import annotations

import csv
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from pound_solve import run
from pound_solve.cli.main import main
from pound_solve.loading import spectrum
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.spectrum import response_spectrum
from pound_solve.numerics.types import Array

PERIODS = (0.013, 0.2, 0.57, 3.0)


def lines(*points: float) -> Piecewise:
    """Straight lines between time, value, time, value, ..."""
    return Piecewise.from_samples(points[::2], points[1::2])


def noise(seed: int, n: int) -> Piecewise:
    """Random samples at uneven times."""
    rng = np.random.default_rng(seed)
    return Piecewise.from_samples(np.cumsum(rng.uniform(0.005, 0.05, n)), rng.standard_normal(n))


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("xi", [0.0, 0.02, 0.3, 0.95])
def test_a_step_is_overshot(period: float, xi: float) -> None:
    """Chopra (2012), section 4.3: u = a/w^2 (1 + exp(-pi xi / sqrt(1 - xi^2))); undamped a/w and 2 a."""
    w = 2 * math.pi / period
    found = response_spectrum(lines(0, 1.5, 10, 1.5), period, xi, free=False)
    overshoot = 1 + math.exp(-math.pi * xi / math.sqrt(1 - xi**2))
    assert found.sd[0, 0] == pytest.approx(1.5 / w**2 * overshoot, rel=1e-11)
    assert found.psa[0, 0] == pytest.approx(1.5 * overshoot, rel=1e-11)
    if xi == 0.0:
        assert found.sv[0, 0] == pytest.approx(1.5 / w, rel=1e-11)
        assert found.sa[0, 0] == pytest.approx(3.0, rel=1e-11)


@pytest.mark.full
@pytest.mark.parametrize("rise", [0.03, 0.1, 0.23, 0.77])
def test_a_ramp_of_finite_rise(rise: float) -> None:
    """Chopra (2012), Eq. 4.5.3: u = a/w^2 (1 + |sin(pi tr/T)| / (pi tr/T)), undamped."""
    ramp = Piecewise(np.array([0.0, rise, 50.0]), np.array([[0.0, 2.0], [2.0 / rise, 0.0]]))
    period = np.array(PERIODS)
    x = np.pi * rise / period
    expected = 2.0 / (2 * np.pi / period) ** 2 * (1 + np.abs(np.sin(x)) / x)
    assert response_spectrum(ramp, period, 0.0, free=False).sd[0] == pytest.approx(expected, rel=1e-10)


def test_an_endless_ramp_carries_a_rigid_oscillator_along() -> None:
    """u = -(c/w^2)(t - sin(w t)/w): at a whole number of periods c t/w^2."""
    period, end = 0.25, 2.0
    found = response_spectrum(lines(0, 0, end, 3.0 * end), period, 0.0, free=False)
    assert found.sd[0, 0] == pytest.approx(3.0 * end * (period / (2 * math.pi)) ** 2, rel=1e-12)
    assert found.sv[0, 0] == pytest.approx(2 * 3.0 * (period / (2 * math.pi)) ** 2, rel=1e-12)


@pytest.mark.parametrize("share", [0.05, 0.2, 0.45])
def test_after_a_short_pulse_the_free_vibration_is_the_largest(share: float) -> None:
    """Chopra (2012), Eq. 4.7.8: u = 2 a/w^2 sin(pi td/T) for td < T/2, undamped."""
    pulse = lines(0, 2.0, share, 2.0)
    expected = 4.0 / (2 * math.pi) ** 2 * math.sin(math.pi * share)
    assert response_spectrum(pulse, 1.0, 0.0).sd[0, 0] == pytest.approx(expected, rel=1e-12)
    assert response_spectrum(pulse, 1.0, 0.0, free=False).sd[0, 0] < 0.99 * expected


@pytest.mark.parametrize("xi", [0.02, 0.05, 0.2])
def test_harmonic_base_motion_at_resonance(xi: float) -> None:
    """Steady state: a / (2 xi w^2), absolute acceleration a sqrt(1 + 4 xi^2) / (2 xi)."""
    t = np.linspace(0.0, 150.0, 150 * 200 + 1)  # chords of 200 points a period are 1.2e-4 too low at most
    found = response_spectrum(Piecewise.from_samples(t, 3.0 * np.sin(2 * np.pi * t)), 1.0, xi)
    assert found.psa[0, 0] == pytest.approx(3.0 / (2 * xi), rel=1.3e-4)
    assert found.sa[0, 0] == pytest.approx(3.0 * math.sqrt(1 + 4 * xi**2) / (2 * xi), rel=1.3e-4)


def test_the_rigid_limit_is_the_peak_acceleration() -> None:
    ground = noise(3, 12)  # but from zero on: a jump is overshot by any oscillator
    still = lines(0, 0, *np.column_stack([ground.breaks + 1, [*ground.coefs[0], 0.0]]).ravel())
    kink = float(np.abs(np.diff(still.coefs[1])).max())
    for period in (1e-3, 1e-2):  # a kink swings on with its slope over the frequency
        found = response_spectrum(still, period, 0.05)
        for value in (found.sa[0, 0], found.psa[0, 0]):
            assert value == pytest.approx(abs(still.peak()[1]), abs=kink * period / (2 * math.pi))


def test_the_long_limit_is_the_displacement_and_velocity_of_the_ground() -> None:
    """Accelerations that end at rest where they began: SD is PGD and SV is PGV."""
    ground = lines(0, 0, 1, 3, 2, 0, 3, -3, 4, 0, 5, -3, 6, 0, 7, 3, 8, 0)
    velocity = ground.integral()
    found = response_spectrum(ground, 1e6, 0.05)
    assert abs(velocity.value(8.0)) < 1e-14 and abs(velocity.integral().value(8.0)) < 1e-14
    assert found.sd[0, 0] == pytest.approx(abs(velocity.integral().peak()[1]), rel=1e-5)
    assert found.sv[0, 0] == pytest.approx(abs(velocity.peak()[1]), rel=1e-5)


def integrated(ground: Piecewise, period: float, xi: float) -> Array:
    """The same peaks by DOP853, whose events are the zeros of the slopes."""
    w, y, best = 2 * math.pi / period, np.zeros(2), np.zeros(3)
    ends = [*ground.breaks, ground.end + period]

    def rate(s: float, y: Array, a0: float, a1: float) -> list[float]:
        return [y[1], -2 * xi * w * y[1] - w * w * y[0] - a0 - a1 * s]

    def rest(s: float, y: Array, a0: float, a1: float) -> float:
        return y[1]

    def turn(s: float, y: Array, a0: float, a1: float) -> float:
        return rate(s, y, a0, a1)[1]

    def jerk(s: float, y: Array, a0: float, a1: float) -> float:
        return 2 * xi * w * turn(s, y, a0, a1) + w * w * y[1]

    for (start, end), line in zip(pairwise(ends), [*ground.coefs.T, (0.0, 0.0)]):
        got = solve_ivp(
            rate,
            (0, end - start),
            y,
            "DOP853",
            rtol=1e-12,
            atol=1e-15,
            args=line,
            events=[rest, turn, jerk],
        )
        y = got.y[:, -1]
        seen = np.vstack([got.y.T, *(e for e in got.y_events if len(e))])
        found = [seen[:, 0], seen[:, 1], 2 * xi * w * seen[:, 1] + w * w * seen[:, 0]]
        best = np.maximum(best, np.abs(found).max(axis=1))
    return best


@pytest.mark.full
@pytest.mark.parametrize("period", [0.011, 0.09, 0.6, 4.0])
@pytest.mark.parametrize("xi", [0.0, 0.05, 0.7])
def test_an_independent_integration_finds_the_same_peaks(period: float, xi: float) -> None:
    ground = noise(11, 30)
    found = response_spectrum(ground, period, xi)
    got = [found.sd[0, 0], found.sv[0, 0], found.sa[0, 0]]
    assert got == pytest.approx(integrated(ground, period, xi), rel=1e-9)


def test_a_first_peak_within_the_interval_that_begins_at_rest() -> None:
    """The slope is zero at rest: the peak is beyond the inflexion, without another change of its sign."""
    ground, period = noise(545, 12), 0.1015625
    expected = integrated(ground, period, 0.0)
    found = response_spectrum(ground, period, 0.0)
    assert [found.sd[0, 0], found.sv[0, 0], found.sa[0, 0]] == pytest.approx(expected, rel=1e-9)


def test_peaks_lie_between_the_samples() -> None:
    """A step with five samples a period: 1 + cos(36 deg) at the samples, 2 between them."""
    h, w = 0.2, 2 * math.pi
    ground = Piecewise.from_samples(h * np.arange(21), np.ones(21))
    once = expm(h * np.array([[0, 1, 0], [-w * w, 0, -1], [0, 0, 0]]))
    states = [np.linalg.matrix_power(once, n) @ [0, 0, 1] for n in range(21)]
    sampled = max(abs(x[0]) for x in states) * w * w
    assert sampled == pytest.approx(1 + math.cos(math.radians(36)), rel=1e-12)
    assert response_spectrum(ground, 1.0, 0.0).psa[0, 0] == pytest.approx(2.0, rel=1e-12)


def test_a_peak_between_low_samples_beats_one_at_a_sample() -> None:
    """Two undamped steps of one period each, 1 - cos: that of 0.99 has its peak of 1.98 at a break.  That
    of 1 has 1 + cos(36 deg) = 1.809 on both sides of its peak of 2; it may gain (72 deg)^2/8 = 0.197 there.
    """
    breaks, steps = [0.0, 0.5, 1.0, 1.4, 1.6, 2.0], [-0.99, -0.99, 1.0, 1.0, 1.0]
    ground = Piecewise(np.array(breaks), np.array([steps, np.zeros(5)]))
    found = response_spectrum(ground, 1.0, 0.0)
    assert found.psa[0, 0] == pytest.approx(2.0, rel=1e-11)
    assert found.sa[0, 0] == pytest.approx(2.0, rel=1e-11)


@settings(max_examples=40)
@given(st.integers(0, 1000), st.floats(0.003, 20.0), st.floats(0.0, 0.9), st.floats(0.1, 10.0))
def test_properties(seed: int, period: float, xi: float, factor: float) -> None:
    ground = noise(seed, 12)
    found = response_spectrum(ground, period, xi)
    # more breaks on the same lines, the other sign, another amplitude, another unit of time
    finer = response_spectrum(-factor * ground.divided(3), period, xi)
    slower = response_spectrum(
        Piecewise(factor * ground.breaks, ground.coefs / [[1], [factor]]), factor * period, xi
    )
    for name, power in (("sd", 2), ("sv", 1), ("sa", 0)):
        assert getattr(finer, name) == pytest.approx(factor * getattr(found, name), rel=1e-8)
        assert getattr(slower, name) == pytest.approx(factor**power * getattr(found, name), rel=1e-8)
    assert found.psa == pytest.approx(2 * np.pi / period * found.psv, rel=1e-14)


def test_several_periods_and_dampings_at_once_are_those_one_by_one() -> None:
    ground, xi = noise(5, 200), (0.0, 0.05, 0.2)
    found = response_spectrum(ground, PERIODS, xi)
    assert found.sd.shape == (3, 4)
    for i, x in enumerate(xi):
        for j, period in enumerate(PERIODS):
            alone = response_spectrum(ground, period, x)
            for name in ("sd", "sv", "sa"):
                assert getattr(found, name)[i, j] == pytest.approx(getattr(alone, name)[0, 0], rel=1e-12)


@pytest.mark.parametrize(
    ("period", "xi"), [(0.0, 0.05), (-1.0, 0.05), (math.nan, 0.05), (1.0, 1.0), (1.0, -0.1)]
)
def test_what_is_no_oscillator_is_refused(period: float, xi: float) -> None:
    with pytest.raises(ValueError, match="periods are finite and above zero"):
        response_spectrum(lines(0, 0, 1, 1), period, xi)


def sine(periods: int) -> Piecewise:
    """A sine of period 1 in 32 intervals each, by its series of degree 7."""
    starts = np.arange(32 * periods) / 32.0
    w = 2.0 * math.pi
    coefs = [w**k / math.factorial(k) * np.sin(w * starts + k * math.pi / 2.0) for k in range(8)]
    return Piecewise(np.append(starts, float(periods)), np.array(coefs))


def test_lines_have_the_moments_of_their_curve() -> None:
    """Of any polynomial that is multiplied by a straight line the integral is the same, piece by piece."""
    curve, line = sine(1), sine(1).lines(2)
    assert line.degree == 1 and len(line.breaks) == 65
    for power in (0, 1):
        left, right = line.breaks[:-1], line.breaks[1:]
        nodes, weights = np.polynomial.legendre.leggauss(8)
        at = 0.5 * (left + right)[:, None] + 0.5 * (right - left)[:, None] * nodes
        moments = [
            ((f.value(at.ravel()).reshape(at.shape) * nodes**power) @ weights) for f in (curve, line)
        ]
        assert moments[1] == pytest.approx(moments[0], abs=1e-14)
    straight = lines(0, 0, 1, 1)
    assert straight.lines(4) is straight


@pytest.mark.full
def test_spectrum_of_a_curved_acceleration(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against 128 chords in each interval, for periods from a fiftieth of that of the sine to a hundred; an
    interval that is short beside the period is one line.
    """
    motion, periods = sine(6), np.geomspace(0.02, 100.0, 19)
    for damping in (0.0, 0.05, 0.5):
        found, finer = (response_spectrum(x, periods, damping) for x in (motion, motion.chords(128)))
        for name in ("sd", "sv", "sa"):
            assert getattr(found, name) == pytest.approx(getattr(finer, name), rel=2e-5), (damping, name)
    sizes, peaks = list[int](), spectrum._peaks

    def counted(fine: Piecewise, *given: Any) -> Any:
        sizes.append(len(fine.breaks))
        return peaks(fine, *given)

    monkeypatch.setattr(spectrum, "_peaks", counted)
    response_spectrum(motion, [10.0, 20.0])
    assert sizes == [len(motion.breaks)]


def test_chords_of_a_curve() -> None:
    parabola = Piecewise(np.array([0.0, 2.0]), np.array([[0.0], [2.0], [-1.0]]))
    chords = parabola.chords(8)
    assert chords.degree == 1 and len(chords.breaks) == 9
    assert chords.value(chords.breaks) == pytest.approx(parabola.value(chords.breaks), abs=1e-14)
    assert chords.value(0.125) == pytest.approx(parabola.value(0.125) - 0.125**2, abs=1e-14)
    assert np.array_equal(Piecewise.zero(0, 1).chords().coefs, np.zeros((2, 1)))
    assert parabola.divided(4).value(0.7) == pytest.approx(parabola.value(0.7), abs=1e-14)


DECK = """UNITS kN {unit} s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 0 FIX=XYR
ELEMENTS
 1 COLUMN 1 2
PROPS
 COLUMN SPRING KX=4000
WEIGHTS
 2 981
EQUAKE
 TABLE POINTS=0,0,0.1,2.5,0.3,-2.5,0.4,1,1,0
{more}
OUTPUT
 EVERY={every} NODES=2,3
ANALYSIS
 HISTORY 1 METHOD=EXACT FROM=REST
"""
TABLE = lines(0, 0, 0.1, 2.5, 0.3, -2.5, 0.4, 1, 1, 0)


def written(path: Path, unit: str = "m", every: float = 0.1, more: str = "") -> str:
    """File of the deck."""
    path.write_text(DECK.format(unit=unit, every=every, more=more))
    return str(path)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_motions_of_a_deck(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    more = " SINE AMPLITUDE=1 PERIOD=0.5 DURATION=5 DIRECTION=Y"
    deck, out = written(tmp_path / "model.inp", more=more), tmp_path / "s.csv"
    assert main(["spectrum", deck, "--periods", "0.2,1", "--damping", "2,5", "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "model: 1 TABLE X: peak acceleration 2.5 m/s^2 at 0.1 s; damping 2 %" in text
    rows, expected = table(out), response_spectrum(TABLE, [0.2, 1.0], [0.02, 0.05])
    assert [row["motion"] for row in rows] == ["model: 1 TABLE X"] * 4 + ["model: 2 SINE Y"] * 4
    assert [float(row["damping [%]"]) for row in rows[:4]] == [2.0, 2.0, 5.0, 5.0]
    for name, values in (("sd [m]", expected.sd), ("sv [m/s]", expected.sv), ("sa [m/s^2]", expected.sa)):
        assert [float(row[name]) for row in rows[:4]] == pytest.approx(values.ravel(), rel=1e-12)
    # undamped resonance until the analysis ends: a w t / 2; the lines are wrong by 2e-5 at most
    assert main(["spectrum", deck, "--periods", "0.5", "--damping", "0", "-o", str(out)]) == 0
    assert float(table(out)[1]["psa [m/s^2]"]) == pytest.approx(2 * math.pi, rel=2e-5)


def test_a_record_with_items_of_its_card(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record, out = tmp_path / "shake.txt", tmp_path / "s.csv"
    record.write_text("t, a, b\n0, 0, 9\n0.1, 250, 9\n0.3, -250, 9\n0.4, 100, 9\n1, 0, 9\n")
    words = ["spectrum", str(record), "--item", "UNIT=CM/S2", "--item", "COLUMN=2", "--periods", "0.1:1:4"]
    assert main([*words, "-o", str(out)]) == 0
    assert "shake.txt UNIT=CM/S2 COLUMN=2: peak acceleration 2.5 m/s^2" in capsys.readouterr().out
    rows = table(out)
    periods = [float(row["period [s]"]) for row in rows]
    assert periods == pytest.approx([0.1, 10 ** (-2 / 3), 10 ** (-1 / 3), 1.0], rel=1e-14)
    expected = response_spectrum(TABLE, periods)
    assert [float(row["psv [m/s]"]) for row in rows] == pytest.approx(expected.psv[0], rel=1e-12)


def test_the_floor_that_rides_on_the_ground_has_its_spectrum(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deck, out = written(tmp_path / "model.inp"), tmp_path / "s.csv"
    with run(deck) as results:
        time, a = results.time, results.history("node/a")
    words = ["spectrum", str(tmp_path / "model.h5"), "--node", "3", "--node", "2", "-o", str(out)]
    assert main([*words, "--periods", "0.2,1"]) == 0
    found = [float(row["sa [m/s^2]"]) for row in table(out)]
    assert found[:2] == pytest.approx(response_spectrum(TABLE, [0.2, 1.0]).sa[0], rel=1e-9)
    floor = response_spectrum(Piecewise.from_samples(time, a[:, 0, 0]), [0.2, 1.0])
    assert found[2:] == pytest.approx(floor.sa[0], rel=1e-12)
    err = capsys.readouterr().err
    assert (
        "stored every 0.1 s" in err and "spectra below 1 s are coarse" in err and "OUTPUT EVERY=0.02" in err
    )
    assert main([*words, "--periods", "1,2"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.full
def test_two_runs_in_one_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    for name in "ab":
        (tmp_path / name).mkdir()
        run(written(tmp_path / name / "model.inp", every=0.01)).close()
    files = [str(tmp_path / name / "model.h5") for name in "ab"]
    pictures = [tmp_path / "first.svg", tmp_path / "again.svg"]
    for picture in pictures:
        words = ["--node", "2", "--periods", "0.1:2:20", "--damping", "2,5", "--picture", str(picture)]
        assert main(["spectrum", *files, *words]) == 0
    drawn = pictures[0].read_text()
    assert drawn == pictures[1].read_text()
    assert all(f"{Path(file).with_suffix('')} node 2 X, {xi} %" in drawn for file in files for xi in (2, 5))


def test_mistakes_are_told_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck, cm = written(tmp_path / "model.inp"), written(tmp_path / "cm.inp", "cm")
    still = tmp_path / "still.inp"
    still.write_text(Path(deck).read_text().replace("EQUAKE\n", "").replace(" TABLE", "! TABLE"))
    run(deck).close()
    results = str(tmp_path / "model.h5")
    for words, status, told in (
        ([results], 2, "choose the floor with --node"),
        ([results, "--node", "1"], 2, "no accelerations of node 1"),
        ([str(tmp_path / "no.h5"), "--node", "1"], 3, "no such file"),
        ([deck, "--node", "1"], 2, "--node belongs to a results file"),
        ([deck, "--item", "UNIT=G"], 2, "--item belongs to a record"),
        ([deck, "--set", "x"], 2, "write NAME=VALUE"),
        ([deck, cm], 2, "is in cm and s"),
        ([str(still)], 2, "no motion under EQUAKE"),
        (["nowhere.at2"], 2, "R401"),
        (["nowhere.at2", "--item", "UNIT=X"], 2, "P210"),
        ([deck, "--periods", "1:2"], 2, "FIRST:LAST:COUNT"),
        ([deck, "--periods", "2:1:5"], 2, "FIRST:LAST:COUNT"),
        ([deck, "--periods", "1:2:1e9"], 2, "COUNT is a whole number"),
        ([deck, "--periods", "0,1"], 2, "above 0"),
        ([deck, "--periods", "1e-8"], 2, "the period 1e-08 is too short"),
        ([deck, "--damping", "100"], 2, "below 100 percent"),
        ([deck, "--damping", "x"], 2, "takes percentages"),
    ):
        try:
            found = main(["spectrum", *words])
        except SystemExit as end:
            found = end.code
        err = capsys.readouterr().err
        assert (found, told in err, "Traceback" in err) == (status, True, False), err
