"""Ground motions: records with their units and windows, sines, synthetic motions."""

from __future__ import annotations

import math
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pound_solve
from pound_solve.loading.forces import record as force_record
from pound_solve.loading.forces import sine as force_sine
from pound_solve.loading.forces import table as force_table
from pound_solve.loading.motions import matched, record, sine, synthetic, table
from pound_solve.loading.motions.base import METRE, GroundMotion, LoadingContext
from pound_solve.loading.motions.wave import fronts
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.spectrum import response_spectrum
from tiers import at_night


def context(tmp_path: Path = Path(), length: str = "m", duration: float = 0.0) -> LoadingContext:
    metre = METRE[length]
    return LoadingContext(9.80665 * metre, metre, (tmp_path,), duration)


class TestRecord:
    TEXT = "0 0\n1 0.2\n2 -0.4\n4 0.1\n"  # uneven, peak 0.4

    def build(self, tmp_path: Path, text: str = TEXT, length: str = "m", **card: Any) -> GroundMotion:
        (tmp_path / "made_up.txt").write_text(text)
        return record.build({"FILE": "made_up.txt", "FORMAT": "AUTO", **card}, context(tmp_path, length))

    def refused(self, code: str, tmp_path: Path, text: str = TEXT, **card: Any) -> str:
        with pytest.raises(RecordError) as caught:
            self.build(tmp_path, text, **card)
        assert caught.value.code == code
        return str(caught.value)

    def test_lines_between_samples_and_nothing_after(self, tmp_path: Path) -> None:
        a = self.build(tmp_path, UNIT="DECK").acceleration
        np.testing.assert_allclose(
            a.value([0, 0.5, 1, 1.5, 3, 4, 4.001, 9]), [0, 0.1, 0.2, -0.1, -0.15, 0.1, 0, 0], atol=1e-15
        )

    @pytest.mark.parametrize("length", METRE)
    @pytest.mark.parametrize(
        ("unit", "in_metres"),
        [("G", 9.80665), (None, 9.80665), ("M/S2", 1.0), ("CM/S2", 0.01), ("GAL", 0.01), ("MM/S2", 0.001)],
    )
    def test_units(self, tmp_path: Path, unit: str | None, in_metres: float, length: str) -> None:
        motion = self.build(tmp_path, length=length, UNIT=unit)
        assert motion.info["pga"] == pytest.approx(0.4 * in_metres * METRE[length], rel=1e-15)
        assert motion.info["unit"] == (unit or "G")

    def test_g_is_the_decks_gravity_exactly(self, tmp_path: Path) -> None:
        (tmp_path / "r.txt").write_text("0 1\n1 1\n")
        motion = record.build({"FILE": "r.txt"}, LoadingContext(9.81, search_path=(tmp_path,)))
        assert motion.acceleration.value(0.5) == 9.81

    def test_unit_of_the_file_and_a_deck_that_knows_better(self, tmp_path: Path) -> None:
        text = (
            "made up\na, b\nACCELERATION TIME SERIES IN UNITS OF CM/S2\nNPTS= 2, DT= 0.1 SEC\n 100. -50.\n"
        )
        assert self.build(tmp_path, text).info["pga"] == pytest.approx(1.0)
        motion = self.build(tmp_path, text, UNIT="MM/S2")
        assert motion.info["pga"] == pytest.approx(0.1)
        assert any("CM/S2" in w for w in motion.info["warnings"])
        assert self.build(tmp_path, text, UNIT="GAL").info["warnings"] == ()

    def test_scale_and_sign(self, tmp_path: Path) -> None:
        motion = self.build(tmp_path, UNIT="M/S2", SCALE=-2.0)
        assert motion.acceleration.value(2.0) == pytest.approx(0.8)
        assert motion.info["scale"] == -2.0 and motion.info["pga"] == pytest.approx(0.8)

    def test_lines_of_a_larger_file(self, tmp_path: Path) -> None:
        text = f"a deck\n1 2\n{self.TEXT}the end\n7 8\n"
        for name in ("COLUMNS", "AUTO"):
            a = self.build(tmp_path, text, UNIT="DECK", FORMAT=name, LINES=(3, 6)).acceleration
            assert (a.end, float(a.value(2.0))) == (4.0, -0.4)
        said = self.refused("R402", tmp_path, text=text, FORMAT="COLUMNS", LINES=(3, 7))
        assert "line 7" in said  # as it stands in the file
        for span in ((3, 9), (4, 3)):
            assert "the file has 8 lines" in self.refused("R405", tmp_path, text=text, LINES=span)

    def test_times_in_another_column(self, tmp_path: Path) -> None:
        text = "9 0.0 0.1 7\n9 0.5 0.2 7\n9 2.0 0.3 7\n"
        a = self.build(tmp_path, text, UNIT="DECK", FORMAT="COLUMNS", TIMES=2, COLUMN=3).acceleration
        assert (a.end, float(a.value(0.5))) == (2.0, 0.2)
        assert "COLUMN=2 is the time" in self.refused(
            "R405", tmp_path, text=text, FORMAT="COLUMNS", TIMES=2, COLUMN=2
        )
        assert "TIMES=5" in self.refused("R405", tmp_path, text=text, FORMAT="COLUMNS", TIMES=5, COLUMN=2)
        swapped = "0.1 0\n0.2 1\n"
        assert self.build(tmp_path, swapped, UNIT="DECK", FORMAT="COLUMNS", TIMES=2).info["pga"] == 0.2

    def test_start_between_samples(self, tmp_path: Path) -> None:
        a = self.build(tmp_path, UNIT="DECK", START=0.5).acceleration
        assert a.start == 0
        np.testing.assert_allclose(a.value([0, 0.5, 1.5, 3.5, 3.6]), [0.1, 0.2, -0.4, 0.1, 0.0], atol=1e-15)

    def test_window(self, tmp_path: Path) -> None:
        motion = self.build(tmp_path, UNIT="DECK", START=1.5, DURATION=1.5)
        a = motion.acceleration
        assert (a.start, a.end) == (0.0, 1.5)
        np.testing.assert_allclose(a.value([0, 0.5, 1.5, 1.51]), [-0.1, -0.4, -0.15, 0], atol=1e-15)
        assert motion.info["t_pga"] == 0.5

    def test_start_on_a_sample_makes_no_sliver(self, tmp_path: Path) -> None:
        text = "".join(f"{k % 7}\n" for k in range(200))
        for k in range(1, 100):
            a = self.build(tmp_path, text, UNIT="DECK", DT=0.01, START=k / 100, DURATION=0.5).acceleration
            assert len(a.breaks) == 51 and np.diff(a.breaks).min() > 0.009

    def test_delay_and_late_first_sample(self, tmp_path: Path) -> None:
        a = self.build(tmp_path, UNIT="DECK", START=-2.0).acceleration
        assert a.start == 0
        np.testing.assert_allclose(a.value([0, 1, 2, 3, 6]), [0, 0, 0, 0.2, 0.1], atol=1e-15)
        late = self.build(tmp_path, "0.5 1\n1 2\n", UNIT="DECK").acceleration
        assert late.start == 0
        np.testing.assert_allclose(late.value([0, 0.49, 0.5, 1]), [0, 0, 1, 2])

    def test_time_scale_stretches_the_window(self, tmp_path: Path) -> None:
        a = self.build(tmp_path, UNIT="DECK", START=1.0, DURATION=1.0, TSCALE=0.5).acceleration
        assert a.end == 0.5
        np.testing.assert_allclose(a.value([0, 0.25, 0.5]), [0.2, -0.1, -0.4], atol=1e-15)

    def test_empty_window(self, tmp_path: Path) -> None:
        assert "0 to 4 s" in self.refused("R405", tmp_path, START=4.0)
        self.refused("R405", tmp_path, START=-5.0, DURATION=5.0)

    def test_velocity_and_displacement_after_the_end(self, tmp_path: Path) -> None:
        motion = self.build(tmp_path, "0 1\n2 1\n", UNIT="DECK")
        np.testing.assert_allclose(motion.velocity(5.0).value([0, 1, 2, 3, 5]), [0, 1, 2, 2, 2])
        np.testing.assert_allclose(motion.displacement(5.0).value([1, 2, 5]), [0.5, 2, 8])
        assert (motion.info["pgv"], motion.info["pgd"]) == pytest.approx((2.0, 2.0))

    def test_info(self, tmp_path: Path) -> None:
        motion = self.build(tmp_path, "1\n2\n3\n", DT=0.25, DIRECTION="Y", SUPPORTS=(3, 7), UNIT="M/S2")
        assert (motion.direction, motion.supports) == ("Y", (3, 7))
        want = {
            "kind": "RECORD",
            "name": "made_up.txt",
            "format": "COLUMNS",
            "npts": 3,
            "dt": 0.25,
            "duration": 0.5,
        }
        assert {key: motion.info[key] for key in want} == want
        assert len(motion.info["sha256"]) == 64 and Path(motion.info["file"]).is_file()
        assert self.build(tmp_path).info["dt"] is None  # uneven

    def test_errors_name_the_file(self, tmp_path: Path) -> None:
        assert "made_up.txt" in self.refused("R402", tmp_path, text="0 1\n1 x\n", FORMAT="COLUMNS")
        self.refused("R402", tmp_path, FORMAT="PEER")

    def test_unit_slip(self, tmp_path: Path) -> None:
        text = "1\n500\n-300\n"
        assert any("500 g" in w for w in self.build(tmp_path, text, DT=0.01).info["warnings"])
        assert self.build(tmp_path, text, DT=0.01, UNIT="GAL").info["warnings"] == ()

    @pytest.mark.parametrize(("scale", "unit", "told"), [
        (9.81, "G", True), (-9.81, "G", True), (9.81, "GAL", False), (9.5, "G", False), (1.0, "G", False),
    ])  # fmt: skip
    def test_gravity_counted_twice(self, tmp_path: Path, scale: float, unit: str, told: bool) -> None:
        motion = self.build(tmp_path, "1\n0.2\n-0.1\n" if unit == "G" else "1\n20\n-10\n", DT=0.01,
                            UNIT=unit, SCALE=scale)  # fmt: skip
        assert any("SCALE" in w and "anyway" in w for w in motion.info["warnings"]) is told


class TestSine:
    @pytest.mark.parametrize("period", [1.0, 0.37, 1 / 3])
    @pytest.mark.parametrize("phase", [0.0, 0.7])
    def test_closed_form_over_100_periods(self, period: float, phase: float) -> None:
        a, w = 2.5, 2 * math.pi / period
        motion = sine.build(
            {"AMPLITUDE": a, "PERIOD": period, "PHASE": phase}, context(duration=100 * period)
        )
        t = np.linspace(0, 100 * period, 10007)
        # fmod is exact: the angle keeps all its digits
        angle = 2 * np.pi * np.array([math.fmod(x, period) for x in t]) / period + phase
        parts = (motion.acceleration, motion.velocity(), motion.displacement())
        exact = (a * np.sin(angle), -a / w * np.cos(angle), -a / w**2 * np.sin(angle))
        for part, want, amplitude in zip(parts, exact, (a, a / w, a / w**2)):
            np.testing.assert_allclose(part.value(t), want, rtol=0, atol=1e-13 * amplitude)
        assert motion.velocity0 == pytest.approx(exact[1][0], rel=1e-15)
        assert motion.info["pga"] == pytest.approx(a, rel=1e-12)
        assert motion.info["pgv"] == pytest.approx(a / w, rel=1e-12)
        # the plain integral of the acceleration is the same motion
        plain = motion.acceleration.integral(motion.velocity0)
        np.testing.assert_allclose(plain.value(t), exact[1], rtol=0, atol=1e-12 * a / w)

    def test_omega_scale_and_given_start(self) -> None:
        card = {"AMPLITUDE": 3.0, "OMEGA": 2.0, "SCALE": -0.5, "VELOCITY0": 0.0, "DISPLACEMENT0": 0.1}
        motion = sine.build(card, context(duration=10.0))
        t = np.linspace(0, 10, 101)
        np.testing.assert_allclose(motion.acceleration.value(t), -1.5 * np.sin(2 * t), atol=1e-14)
        np.testing.assert_allclose(motion.velocity().value(t), 0.75 * (np.cos(2 * t) - 1), atol=1e-13)
        want = 0.1 + 0.375 * np.sin(2 * t) - 0.75 * t
        np.testing.assert_allclose(motion.displacement().value(t), want, atol=1e-13)

    def test_delay_end_and_rest(self) -> None:
        card = {
            "AMPLITUDE": 1.0,
            "OMEGA": math.pi,
            "START": 1.0,
            "DURATION": 2.5,
            "VELOCITY0": 0.0,
            "DISPLACEMENT0": 0.0,
        }
        motion = sine.build(card, context(duration=6.0))
        t = np.array([0.0, 0.5, 1.5, 3.0, 3.5, 4.0, 6.0])
        s = np.clip(t - 1, 0, 2.5)
        acting = (t >= 1) & (t <= 3.5)
        np.testing.assert_allclose(motion.acceleration.value(t), acting * np.sin(math.pi * s), atol=1e-14)
        v = (1 - np.cos(math.pi * s)) / math.pi
        np.testing.assert_allclose(motion.velocity(6.0).value(t), v, atol=1e-14)
        d = s / math.pi - np.sin(math.pi * s) / math.pi**2 + v * np.maximum(t - 3.5, 0)
        np.testing.assert_allclose(motion.displacement(6.0).value(t), d, atol=1e-14)
        integrated = motion.acceleration.extended(6.0).integral(0.0).integral(0.0)
        np.testing.assert_allclose(integrated.value(t), d, atol=1e-14)

    def test_a_long_one_keeps_its_acceleration_and_little_else(self) -> None:
        card = {"AMPLITUDE": 1.0, "PERIOD": 1.0}
        sine.build(card, context(duration=1.0))  # what the first call imports is not of the motion
        tracemalloc.start()
        try:
            a = sine.build(card, context(duration=500.0)).acceleration
            kept, most = (x / a.coefs.nbytes for x in tracemalloc.get_traced_memory())
            assert kept < 1.2 and most < 4.0
            tracemalloc.reset_peak()
            other = a.on(np.union1d(a.breaks, a.breaks[:-1] + 0.01))  # on twice as many pieces
            assert tracemalloc.get_traced_memory()[1] < 4.0 * other.coefs.nbytes
        finally:
            tracemalloc.stop()
        t = np.linspace(0.0, 500.0, 997)
        np.testing.assert_allclose(other.value(t), np.sin(2 * np.pi * t), atol=1e-11)

    def test_sine_that_never_begins(self) -> None:
        motion = sine.build({"AMPLITUDE": 1.0, "PERIOD": 1.0, "START": 9.0}, context(duration=5.0))
        assert (motion.acceleration.start, motion.acceleration.end) == (0.0, 5.0)
        assert motion.info["pga"] == 0

    @pytest.mark.parametrize("card", [{}, {"PERIOD": 1.0, "OMEGA": 6.0}])
    def test_period_or_omega(self, card: dict[str, float]) -> None:
        with pytest.raises(RecordError, match="PERIOD or OMEGA"):
            sine.build({"AMPLITUDE": 1.0, **card}, context(duration=1.0))

    def test_without_end_or_too_long(self) -> None:
        with pytest.raises(RecordError, match="without an end"):
            sine.build({"AMPLITUDE": 1.0, "PERIOD": 1.0}, context())
        with pytest.raises(RecordError, match="too long"):
            sine.build({"AMPLITUDE": 1.0, "PERIOD": 1e-9}, context(duration=100.0))


class TestSynthetic:
    def card(self, **given: Any) -> dict[str, Any]:
        defaults = {f.name: f.default for f in synthetic.SPEC.fields}
        return {**defaults, "PGA": 3.0, **given}

    @pytest.mark.full
    def test_same_seed_same_motion(self) -> None:
        one, two, other = (synthetic.build(self.card(SEED=s), context()) for s in (7, 7, 8))
        assert np.array_equal(one.acceleration.coefs, two.acceleration.coefs)
        assert not np.array_equal(one.acceleration.coefs, other.acceleration.coefs)

    def test_peak_length_and_envelope(self) -> None:
        motion = synthetic.build(self.card(SCALE=-2.0, DURATION=30.0, DT=0.005), context())
        assert motion.info["pga"] == pytest.approx(6.0, rel=1e-14)
        assert motion.info["npts"] == 6001 and motion.acceleration.end == pytest.approx(30.0)
        assert motion.acceleration.value(0.0) == 0
        t = np.array([0.0, 1.0, 2.0, 5.0, 10.0, 12.0])
        np.testing.assert_allclose(
            synthetic.envelope(t, 2.0, 8.0, 0.5), [0, 0.25, 1, 1, 1, math.exp(-1)], rtol=1e-15
        )
        assert synthetic.envelope(np.zeros(1), 0.0, 1.0, 1.0) == 1

    def test_spectrum_peaks_near_wg(self) -> None:
        wg = 20.0
        power = 0.0
        for seed in range(40):
            motion = synthetic.build(
                self.card(SEED=seed, WG=wg, ZG=0.2, DURATION=40.0, STRONG=38.0), context()
            )
            power = power + np.abs(np.fft.rfft(motion.acceleration.coefs[0])) ** 2
        w = 2 * np.pi * np.fft.rfftfreq(motion.acceleration.coefs.shape[1], 0.01)
        smooth = np.convolve(power, np.ones(9) / 9, "same")
        assert w[smooth.argmax()] == pytest.approx(wg, rel=0.1)

    def test_transfer_against_the_spectral_density(self) -> None:
        w, wg, zg, wf, zf = np.linspace(0, 60, 61), 15.0, 0.6, 1.5, 0.5
        soil = (wg**4 + 4 * zg**2 * wg**2 * w**2) / ((wg**2 - w**2) ** 2 + 4 * zg**2 * wg**2 * w**2)
        slow = w**4 / ((wf**2 - w**2) ** 2 + 4 * zf**2 * wf**2 * w**2)
        np.testing.assert_allclose(
            np.abs(synthetic.transfer(w, wg, zg, wf, zf)) ** 2, soil * slow, rtol=1e-12
        )
        assert abs(synthetic.transfer(np.array([1e5]), wg, zg, wf, zf)[0]) < 1e-3

    def test_too_short(self) -> None:
        with pytest.raises(RecordError) as caught:
            synthetic.build(self.card(DURATION=0.01), context())
        assert caught.value.code == "R405"


class TestTable:
    def test_lines_jumps_and_nothing_outside(self) -> None:
        points = (0.5, 1.0, 1.0, 3.0, 1.0, -2.0, 2.0, 0.0)
        motion = table.build({"POINTS": points, "SCALE": 2.0}, context())
        t = [0.0, 0.49, 0.5, 0.75, 1.0, 1.5, 2.0, 2.01]
        np.testing.assert_allclose(motion.acceleration.value(t), [0, 0, 2, 4, -4, -2, 0, 0], atol=1e-15)
        assert motion.acceleration.start == 0
        assert motion.info["pga"] == 6.0 and motion.info["t_pga"] == 1.0 and motion.info["npts"] == 4
        # the velocity runs through the jump: areas of a trapezium and a triangle
        np.testing.assert_allclose(
            motion.velocity(3.0).value([0.5, 1.0, 2.0, 3.0]), [0, 2, 0, 0], atol=1e-15
        )

    def test_the_first_of_two_values_at_the_first_time_is_no_matter(self) -> None:
        one, two = (table.lines(p) for p in ((0.0, 7.0, 0.0, 1.0, 2.0, 1.0), (0.0, 1.0, 2.0, 1.0)))
        assert one.breaks.tolist() == two.breaks.tolist() and one.coefs.tolist() == two.coefs.tolist()

    @pytest.mark.parametrize(
        ("points", "why"),
        [
            ((0.0, 1.0, 2.0), "no whole pairs"),
            ((0.0, 1.0, 2.0, 1.0, 1.0, 0.0), "descend from 2 to 1"),
            ((-1.0, 1.0, 2.0, 1.0), "before the history"),
            ((1.0, 0.0, 1.0, 2.0), "all its points are at time 1"),
            ((0.0, 0.0, 1.0, 2.0, 1.0, 3.0, 1.0, 4.0), "three times"),
            ((0.0, 0.0, 1.0, 2.0, 1.0 + 1e-15, 1e300, 2.0, 0.0), "too fast after 1: a jump"),
        ],
    )
    def test_points_that_are_no_table(self, points: tuple[float, ...], why: str) -> None:
        for build, card in ((table.build, {}), (force_table.build, {"NODES": (1,), "FX": 1.0})):
            with pytest.raises(RecordError, match=why) as caught:
                build({"POINTS": points, **card}, context())
            assert (caught.value.code, caught.value.item) == ("R405", "POINTS")


class TestTurn:
    POINTS = (0.0, 0.0, 1.0, 20.0, 2.0, 0.0)

    def test_the_ground_moves_on_circles(self) -> None:
        motion = table.build({"POINTS": self.POINTS, "DIRECTION": "R", "ABOUT": (2.0, -1.0)}, context())
        assert motion.directions == (0, 1, 2)
        assert [motion.share(d, 5.0, 3.0) for d in range(3)] == [-4.0, 3.0, 1.0]
        assert [motion.share(d, 2.0, -1.0) for d in range(3)] == [0.0, 0.0, 1.0]
        assert motion.info["warnings"] == ()  # 20 rad/T^2 is no share of gravity

    @pytest.mark.parametrize(("direction", "want"), [("X", [1.0, 0.0, 0.0]), ("Y", [0.0, 1.0, 0.0])])
    def test_straight_motion_is_the_same_everywhere(self, direction: str, want: list[float]) -> None:
        motion = table.build({"POINTS": self.POINTS, "DIRECTION": direction}, context())
        assert [motion.share(d, 5.0, 3.0) for d in range(3)] == want

    def test_a_record_of_a_turn_needs_its_unit(self, tmp_path: Path) -> None:
        (tmp_path / "r.txt").write_text("0 0\n1 2\n")
        card = {"FILE": "r.txt", "DIRECTION": "R"}
        with pytest.raises(RecordError, match="no share of gravity") as caught:
            record.build(card, context(tmp_path))
        assert caught.value.code == "R405"
        assert record.build({**card, "UNIT": "DECK"}, context(tmp_path)).info["pga"] == 2.0


class TestWave:
    def motion(self, **card: Any) -> GroundMotion:
        values = {"POINTS": (0.0, 1.0, 0.5, -1.0, 0.5, 2.0, 1.0, 0.0), "SUPPORTS": (1, 2, 3, 4), **card}
        return table.build(values, context())

    X = {1: 10.0, 2: 0.0, 3: 40.0, 4: 10.0, 9: -5.0}  # noqa: RUF012

    @pytest.mark.parametrize(
        ("speed", "delays"),
        [
            (20.0, [((2,), 0.0), ((1, 4), 0.5), ((3,), 2.0)]),
            (-10.0, [((3,), 0.0), ((1, 4), 3.0), ((2,), 4.0)]),
        ],
    )
    def test_one_motion_for_each_place(self, speed: float, delays: list[tuple[Any, float]]) -> None:
        whole = self.motion(WAVE=speed)
        out = fronts(whole, self.X)
        assert [m.supports for m in out] == [nodes for nodes, _ in delays]
        t = np.linspace(-1.0, 6.0, 701)
        for motion, (_, delay) in zip(out, delays):
            for part in ("velocity", "displacement"):
                early = getattr(whole, part)(6.0).value(np.maximum(t - delay, 0.0))
                np.testing.assert_allclose(
                    getattr(motion, part)(6.0).value(t)[t >= 0], early[t >= 0], atol=1e-14
                )
            np.testing.assert_array_equal(
                motion.acceleration.breaks[-3:], whole.acceleration.breaks + delay
            )
            assert motion.acceleration.start == 0.0 and motion.info["t_pga"] == 0.5 + delay

    def test_without_a_wave_the_motion_is_itself(self) -> None:
        motion = self.motion()
        assert fronts(motion, self.X) == [motion]

    def test_a_delayed_sine_keeps_its_closed_forms(self) -> None:
        a, w, delay = 2.5, 7.0, 1.3
        late = sine.build({"AMPLITUDE": a, "OMEGA": w}, context(duration=40.0)).delayed(delay)
        t = np.linspace(0.0, 40.0, 4001)
        s = t - delay
        steady = -a / w**2 * np.sin(w * s)
        want = np.where(s < 0, -a / w * s, steady)
        np.testing.assert_allclose(late.displacement().value(t), want, rtol=0, atol=1e-13)
        np.testing.assert_allclose(
            late.velocity().value(t), np.where(s < 0, -a / w, -a / w * np.cos(w * s)), rtol=0, atol=1e-13
        )
        # the plain integral of the acceleration is the same motion
        plain = late.acceleration.integral(late.velocity0).integral(late.displacement0)
        np.testing.assert_allclose(plain.value(t), want, rtol=0, atol=1e-11)

    @pytest.mark.parametrize(
        ("card", "why"),
        [
            ({"WAVE": 0.0}, "arrives nowhere"),
            ({"WAVE": 3.0, "SUPPORTS": None}, "needs SUPPORTS"),
            ({"WAVE": 3.0, "DIRECTION": "R"}, "X or Y"),
        ],
    )
    def test_waves_that_cannot_be(self, card: dict[str, Any], why: str) -> None:
        with pytest.raises(RecordError, match=why) as caught:
            self.motion(**card)
        assert (caught.value.code, caught.value.item) == ("R405", "WAVE")


class TestForces:
    def test_sine_over_100_periods(self) -> None:
        w, start = 2 * math.pi / 0.37, 0.8
        card = {"NODES": (4,), "FX": 3.0, "OMEGA": w, "PHASE": 0.7, "START": start}
        force = force_sine.build(card, context(duration=37.8))
        assert (force.nodes, force.push) == ((4,), (3.0, 0.0, 0.0))
        t = np.linspace(0, 37.8, 10007)
        want = np.where(t < start, 0.0, np.sin(w * (t - start) + 0.7))
        np.testing.assert_allclose(force.history.value(t), want, rtol=0, atol=1e-12)

    def test_sine_that_never_begins(self) -> None:
        card = {"NODES": (4,), "MZ": 3.0, "PERIOD": 1.0, "START": 9.0}
        force = force_sine.build(card, context(duration=5.0))
        assert force.history.peak()[1] == 0.0 and force.push == (0.0, 0.0, 3.0)

    @pytest.mark.parametrize("card", [{}, {"PERIOD": 1.0, "OMEGA": 6.0}])
    def test_period_or_omega(self, card: dict[str, float]) -> None:
        with pytest.raises(RecordError, match="PERIOD or OMEGA"):
            force_sine.build({"NODES": (1,), "FX": 1.0, **card}, context(duration=1.0))

    def test_file_is_taken_as_it_stands(self, tmp_path: Path) -> None:
        (tmp_path / "f.csv").write_text("t,a,b\n0.5,1,10\n1,2,30\n2,4,-20\n")
        card = {"NODES": (1, 2), "FY": -2.0, "FILE": "f.csv", "COLUMN": 3, "START": 0.25, "TSCALE": 2.0}
        force = force_record.build(card, context(tmp_path))
        t = [0.0, 0.49, 0.5, 1.0, 1.5, 3.5, 3.6]
        np.testing.assert_allclose(force.history.value(t), [0, 0, 10, 20, 30, -20, 0])
        assert force.nodes == (1, 2) and force.push == (0.0, -2.0, 0.0)
        with pytest.raises(RecordError, match=r"f\.csv"):
            force_record.build({**card, "COLUMN": 9}, context(tmp_path))

    def test_a_force_of_nothing(self) -> None:
        with pytest.raises(RecordError, match="no component"):
            force_table.build({"NODES": (1,), "POINTS": (0.0, 0.0, 1.0, 1.0)}, context())


def test_specs_are_sound() -> None:
    for module in (record, sine, synthetic, table):
        names = [f.name for f in module.SPEC.fields]
        assert len(names) == len(set(names))
        assert {"DIRECTION", "SCALE", "SUPPORTS", "WAVE", "ABOUT"} <= set(names)
        assert module.SPEC.family == "motion" and module.SPEC.impl is module.build
        assert all(f.doc and f.doc[-1] != "." for f in module.SPEC.fields)


class TestMatched:
    POINTS = (0.05, 4.0, 0.15, 10.0, 0.5, 10.0, 2.0, 2.5, 4.0, 0.9)

    def card(self, **given: Any) -> dict[str, Any]:
        defaults = {f.name: f.default for f in matched.SPEC.fields}
        return {**defaults, "SPECTRUM": self.POINTS, "DT": 0.00625, **given}

    @pytest.mark.parametrize(("seed", "xi"), [(1, 0.05), *at_night((2, 0.05), (3, 0.02))])
    def test_spectrum_is_met_between_the_periods_too(self, seed: int, xi: float) -> None:
        motion = matched.build(self.card(SEED=seed, XI=xi), context())
        t, sa = np.array(self.POINTS[::2]), np.array(self.POINTS[1::2])
        periods = np.geomspace(t[0], t[-1], 401)
        target = np.exp(np.interp(np.log(periods), np.log(t), np.log(sa)))
        found = response_spectrum(motion.acceleration, periods, xi).psa[0]
        assert np.abs(found / target - 1.0).max() < 0.08
        assert motion.info["misfit"] <= 0.05

    def test_ground_comes_to_rest_where_it_began(self) -> None:
        a = matched.build(self.card(), context()).acceleration
        velocity = a.integral()
        assert abs(velocity.value(a.end)) < 1e-9 and abs(velocity.integral().value(a.end)) < 1e-8

    @pytest.mark.full
    def test_same_seed_same_motion(self) -> None:
        one, two, other = (matched.build(self.card(SEED=s), context()) for s in (3, 3, 4))
        assert np.array_equal(one.acceleration.coefs, two.acceleration.coefs)
        assert not np.array_equal(one.acceleration.coefs, other.acceleration.coefs)

    @pytest.mark.full
    @pytest.mark.parametrize(
        ("given", "why"),
        [
            ({"SPECTRUM": (0.1, 1.0, 0.5)}, "no whole pairs"),
            ({"SPECTRUM": (0.5, 1.0, 0.1, 1.0)}, "do not rise"),
            ({"DT": 0.05}, "too long for the period 0.05"),
            ({"TOL": 0.01, "DURATION": 5.0}, "is met to .* % only, TOL=0.01"),
        ],
    )
    def test_refusals(self, given: dict[str, Any], why: str) -> None:
        with pytest.raises(RecordError, match=why):
            matched.build(self.card(**given), context())

    def test_a_spectrum_that_no_motion_has_is_soon_told(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Most samples exceed its first ordinate, so that each correction has as many unknowns."""
        corrections, correct = [], matched._correction
        monkeypatch.setattr(matched, "_correction", lambda *x: corrections.append(1) or correct(*x))
        steep = self.card(SPECTRUM=(0.1, 5.0, 0.6, 10.0, 2.0, 1e6, 4.0, 0.9), DURATION=5.0)
        with pytest.raises(RecordError, match=r"is met to .* % only"):
            matched.build(steep, context())
        assert len(corrections) == matched.EARLY


def test_the_report_tells_how_well_a_spectrum_is_met(tmp_path: Path) -> None:
    deck = tmp_path / "matched.inp"
    deck.write_text(
        "NODES\n 1 0 0 FIX=XYR\n 2 0 3 FIX=YR\nELEMENTS\n 1 S 1 2\nPROPS\n S SPRING KX=5000\n"
        "WEIGHTS\n 2 300\nDAMPING\n RAYLEIGH XI=0.05 OMEGA=5,20\nEQUAKE\n"
        " MATCHED SPECTRUM=0.1,5,0.2,10,0.6,10,2,3,4,0.9 SEED=1\n SINE AMPLITUDE=1 PERIOD=1 DURATION=2\n"
        "ANALYSIS\n HISTORY 1\n"
    )
    with pound_solve.run(deck, out=tmp_path) as results:
        matched, sine = results.table("motions")["misfit"]
        told = results.table("overview")["value"]
    assert 0.0 < matched <= 0.05 and math.isnan(sine)
    assert any(f"misses the given one by {100 * matched:.2g} % at most" in value for value in told)
