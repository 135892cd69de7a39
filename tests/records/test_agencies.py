"""Files of agencies: component, unit, step and count from their headers, and what contradicts them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from agency_files import SAMPLES, afad, cosmos, cosmos_part, csmip, esm, knet, smc, unam
from pound_solve.loading.records import formats
from pound_solve.loading.records.base import RawRecord, RecordError, head

FILES: dict[str, Callable[[], str]] = {
    "SMC": smc,
    "COSMOS": cosmos,
    "CSMIP": csmip,
    "KNET": knet,
    "ESM": esm,
    "AFAD": afad,
    "UNAM": unam,
}


def read(format: str, text: str, **options: Any) -> RawRecord:
    raw: RawRecord = formats()[format].impl.read(text, options)
    return raw


def refused(code: str, format: str, text: str, **options: Any) -> str:
    with pytest.raises(RecordError) as caught:
        read(format, text, **options)
    assert caught.value.code == code
    return str(caught.value)


@pytest.mark.parametrize("format", FILES)
class TestEach:
    def test_recognised_and_claimed_by_no_other(self, format: str) -> None:
        text = FILES[format]()
        raw = read("AUTO", text)
        assert raw.format == format and raw.notes == ()
        claims = [s.name for s in formats().values() if s.impl.sniff(head(text)) and not s.impl.greedy]
        assert claims == [format]

    def test_another_file_is_refused_under_its_name(self, format: str) -> None:
        for other, text in FILES.items():
            if other != format:
                assert "no " in refused("R402", format, text())
        refused("R402", format, "")
        refused("R402", format, "0 1\n1 2\n")

    def test_cut_short(self, format: str) -> None:
        # inside the samples of the first component
        text = FILES[format]()
        lines = text.splitlines()
        cut = {"COSMOS": 47, "CSMIP": 48, "SMC": 30}.get(format, len(lines) - 1)
        refused("R403", format, "\n".join(lines[:cut]), **({"COMPONENT": 1} if format == "COSMOS" else {}))

    def test_one_bad_sample_names_its_line(self, format: str) -> None:
        lines = FILES[format]().splitlines()
        row = {"COSMOS": 48, "CSMIP": 46, "SMC": 29}.get(format, len(lines) - 1)
        for bad in ("*", "nan", "#"):
            lines[row] = bad.rjust(10) + lines[row][10:]
            message = refused(
                "R402", format, "\n".join(lines), **({"COMPONENT": 1} if format == "COSMOS" else {})
            )
            assert f"line {row + 1}:" in message

    def test_line_ends(self, format: str) -> None:
        text = FILES[format]()
        plain = text.replace("\r\n", "\n")
        for other in (plain, plain.replace("\n", "\r\n"), plain.rstrip("\n")):
            assert np.array_equal(read(format, other).values, read(format, text).values)


class TestSmc:
    def test_samples(self) -> None:
        raw = read("SMC", smc())
        assert raw.values == pytest.approx(SAMPLES, rel=5e-5)
        assert (raw.dt, raw.unit, raw.component, raw.declared) == (0.005, "CM/S2", "360", 20)
        assert raw.title[0] == "2 CORRECTED ACCELEROGRAM"

    def test_peak_below_zero(self) -> None:
        raw = read("SMC", smc([-x for x in SAMPLES], peak=900.5))
        assert float(raw.peak) == -1019.12350 and raw.notes == ()

    def test_vertical(self) -> None:
        assert read("SMC", smc(tilt=0, azimuth=-32768)).component == "UP"
        assert read("SMC", smc(azimuth=-32768)).component == ""

    def test_uneven_readings(self) -> None:
        pairs = [0.0, 5.0, 0.004, -7.0, 0.01, 6.0]
        raw = read("SMC", smc(pairs, "1 UNCORRECTED ACCELEROGRAM", rate=1.7e38))
        assert raw.dt is None and raw.t.tolist() == [0.0, 0.004, 0.01]
        assert raw.values.tolist() == [5.0, -7.0, 6.0] and raw.declared == 3

    def test_rest_of_a_buffer_behind_uneven_readings(self) -> None:
        pairs = [0.0, 5.0, 0.004, -7.0, 0.01, 6.0]
        text = smc([*pairs, *[9.0] * 6], "1 UNCORRECTED ACCELEROGRAM", rate=1.7e38, declared=6, peak=6.0)
        assert read("SMC", text).values.tolist() == [5.0, -7.0, 6.0]
        refused("R403", "SMC", smc([*pairs, *range(1, 11)], rate=1.7e38, declared=6))

    def test_readings_at_one_time(self) -> None:
        message = refused("R402", "SMC", smc([0.0, 5.0, 0.004, -7.0, 0.004, 6.0], rate=1.7e38))
        assert "corrected file" in message

    def test_padded_with_nuls(self) -> None:
        assert len(read("SMC", smc() + "\0" * 300 + "\r\n").values) == 20

    @pytest.mark.parametrize("kind", ["3 CORRECTED VELOCITY", "4 DISPLACEMENT", "5 RESPONSE SPECTRA"])
    def test_other_quantities(self, kind: str) -> None:
        assert kind[2:] in refused("R402", "AUTO", smc(kind=kind))

    def test_damaged_header(self) -> None:
        refused("R402", "SMC", smc(rate=0.0))
        refused("R402", "SMC", smc().replace("       360", "     3 6 0"))


class TestCosmos:
    @pytest.mark.parametrize(
        ("wanted", "component", "factor"),
        [(None, "340", 1), ("UP", "UP", 0.5), ("70", "70", 0.25), (3, "70", 0.25)],
    )
    def test_components(self, wanted: object, component: str, factor: float) -> None:
        raw = read("COSMOS", cosmos(), COMPONENT=wanted)
        assert raw.values == pytest.approx([factor * x for x in SAMPLES], abs=5.1e-6)
        assert (raw.dt, raw.unit, raw.component, raw.declared) == (0.005, "CM/S2", component, 20)
        assert "1 UP, 2 340, 3 70" in refused("R405", "COSMOS", cosmos(), COMPONENT="90")

    @pytest.mark.parametrize(
        ("unit", "name", "factor"),
        [
            ("g(02)", "G", 1),
            ("gal (10)", "CM/S2", 1),
            ("in/sec2(07)", "CM/S2", 2.54),
            ("mg(11)", "G", 0.001),
        ],
    )
    def test_units(self, unit: str, name: str, factor: float) -> None:
        raw = read("COSMOS", cosmos_part(SAMPLES, unit))
        assert raw.unit == name and raw.values[3] == pytest.approx(1019.12345 * factor, rel=1e-9)

    def test_counts_of_an_instrument(self) -> None:
        assert "counts" in refused("R402", "COSMOS", cosmos_part(SAMPLES, "counts(50)", "raw accel."))

    def test_velocity_behind_the_acceleration(self) -> None:
        first, _, end = cosmos_part(SAMPLES).rpartition("End")
        heading = "     20  velocity     pts, approx 1 secs, units=cm/sec (05),Format=(8F10.5)"
        both = f"{first}{heading}\n   9.0\nEnd{end}"
        assert len(read("COSMOS", both).values) == 20
        assert "quantity" in refused("R402", "COSMOS", cosmos_part(SAMPLES, "cm/sec(05)", "velocity"))

    @pytest.mark.parametrize("end", ["/&  ----------  End of data for channel  1", ""])
    def test_ends(self, end: str) -> None:
        assert len(read("COSMOS", cosmos().replace("End-of-data for Chan  1", end)).values) == 20

    def test_no_step(self) -> None:
        assert "62nd real" in refused(
            "R402", "COSMOS", cosmos_part(SAMPLES).replace("     5.000000", "  -999.000000")
        )


class TestCsmip:
    @pytest.mark.parametrize(
        ("wanted", "component", "factor"),
        [(None, "90", 1), ("UP", "Up", 2), ("360", "360", 3), (2, "Up", 2)],
    )
    def test_components(self, wanted: object, component: str, factor: float) -> None:
        raw = read("CSMIP", csmip(), COMPONENT=wanted)
        assert raw.values == pytest.approx([x / factor for x in SAMPLES], abs=5.1e-6)
        assert (raw.dt, raw.unit, raw.component, raw.declared) == (0.005, "CM/S2", component, 20)

    def test_first_horizontal_one(self) -> None:
        assert read("CSMIP", csmip(("Up", "0 Deg"))).component == "0"

    def test_older_words(self) -> None:
        text = csmip(unit=" (UNITS: CM/SEC/SEC)").upper()
        assert read("AUTO", text).values == pytest.approx(SAMPLES, abs=5.1e-6)

    def test_step_from_the_reals(self) -> None:
        assert read("CSMIP", csmip(step=".008", exact=0.0078125)).dt == pytest.approx(0.00781, abs=1e-9)
        assert read("CSMIP", csmip(exact=0.0)).dt == 0.005
        assert "0.01 s" in refused("R402", "CSMIP", csmip(exact=0.01))

    def test_unknown_unit(self) -> None:
        assert "furlong" in refused("R402", "CSMIP", csmip(unit="in furlongs."))


class TestKnet:
    def test_mean_is_removed_and_said(self) -> None:
        raw = read("KNET", knet())
        gal = 3920 / 6182761
        assert raw.values[:5] == pytest.approx([0, 5 * gal, -5 * gal, 20000 * gal, -20000 * gal], abs=1e-9)
        assert raw.values.mean() == pytest.approx(0, abs=1e-12)
        assert (raw.dt, raw.unit, raw.declared) == (0.01, "CM/S2", 100)
        assert raw.component == "E-W, mean removed"

    @pytest.mark.parametrize(("direction", "name"), [("1", "N-S borehole"), ("5", "E-W"), ("U-D", "U-D")])
    def test_sensors_of_kik_net(self, direction: str, name: str) -> None:
        assert read("KNET", knet(direction=direction)).component == f"{name}, mean removed"

    @pytest.mark.parametrize(
        "scale", ["", "3920", "0(gal)/5", "1(gal)/0", "1.2.3(gal)/4", "9" * 400 + "(gal)/1"]
    )
    def test_no_scale_factor(self, scale: str) -> None:
        assert "line 14" in refused("R402", "KNET", knet(scale=scale))

    def test_rate_and_length(self) -> None:
        assert "line 11" in refused("R402", "KNET", knet(rate="0Hz"))
        assert "line 12" in refused("R402", "KNET", knet(length="long"))
        assert "200" in refused("R403", "KNET", knet(length="2"))
        assert read("KNET", knet(rate="200Hz", length="0.5")).dt == 0.005


class TestEsm:
    def test_samples(self) -> None:
        raw = read("ESM", esm())
        assert raw.values == pytest.approx(SAMPLES, abs=1e-9)
        assert (raw.dt, raw.unit, raw.component, raw.declared) == (0.005, "CM/S2", "HNE", 20)
        assert raw.title[0] == "EVENT_NAME: NOWHERE"

    def test_units(self) -> None:
        assert read("ESM", esm(UNITS="m/s^2")).unit == "M/S2"
        assert "line 9" in refused("R402", "ESM", esm(UNITS="counts"))

    @pytest.mark.parametrize("quantity", ["VELOCITY", "ACCELERATION RESPONSE SPECTRUM"])
    def test_other_quantities(self, quantity: str) -> None:
        assert quantity in refused("R402", "AUTO", esm(DATA_TYPE=quantity))

    def test_damaged_header(self) -> None:
        assert "SAMPLING_INTERVAL_S" in refused("R402", "ESM", esm(SAMPLING_INTERVAL_S="-0.1"))
        assert "NDATA" in refused("R402", "ESM", esm(NDATA="many"))
        assert "R403" in refused("R403", "ESM", esm(NDATA="21"))


@pytest.mark.parametrize(
    ("format", "names"), [("AFAD", ("N-S", "E-W", "U-D")), ("UNAM", ("V", "N00E", "N90E"))]
)
class TestSideBySide:
    def test_components(self, format: str, names: tuple[str, ...]) -> None:
        for k, name in enumerate(names):
            for wanted in (name, str(k + 1), name.lower()):
                raw = read(format, FILES[format](), COMPONENT=wanted)
                assert raw.values == pytest.approx([x / 2**k for x in SAMPLES], abs=5.1e-5)
                assert (raw.component, raw.unit, raw.declared) == (name, "CM/S2", 20)
                assert raw.notes == ()
        assert names[2] in refused("R405", format, FILES[format](), COMPONENT="X")

    def test_first_horizontal_one(self, format: str, names: tuple[str, ...]) -> None:
        assert read(format, FILES[format]()).component == {"AFAD": "N-S", "UNAM": "N00E"}[format]

    def test_short_row(self, format: str, names: tuple[str, ...]) -> None:
        lines = FILES[format]().splitlines()
        lines[-2] = lines[-2][:20]
        assert f"line {len(lines) - 1}: " in refused("R402", format, "\n".join(lines))


def test_steps_of_the_tables() -> None:
    assert (read("AFAD", afad()).dt, read("UNAM", unam()).dt) == (0.01, 0.005)
    refused("R402", "AFAD", afad(step="0"))
    assert "DECIMACION" in refused("R402", "UNAM", unam(thinned="2"))
    assert "volt" in refused("R402", "UNAM", unam(unit="volt"))
    refused("R403", "AFAD", afad(declared=21))
    refused("R403", "UNAM", unam(declared=19))


class TestContradictions:
    @pytest.mark.parametrize(
        ("format", "text"),
        [
            ("SMC", smc(peak=1200.0)),
            ("COSMOS", cosmos_part(SAMPLES, peak=1200.0)),
            ("CSMIP", csmip(peak=1200.0)),
            ("KNET", knet(peak="12.700")),
            ("ESM", esm(**{"PGA_CM/S^2": "1200.0"})),
            ("AFAD", afad(peak="1200.0")),
            ("UNAM", unam().replace("/509.5617/", "/-1200.00/")),
        ],
    )
    def test_peak(self, format: str, text: str) -> None:
        (note,) = read(format, text).notes
        assert note.startswith("the header gives a peak of 12") and "CM/S2, the samples have" in note

    @pytest.mark.parametrize(
        ("peak", "told"), [("12.681", 0), ("12.68", 0), ("12.7", 0), ("12.9", 1), ("", 0)]
    )
    def test_digits_of_the_peak(self, peak: str, told: int) -> None:
        # 20000 readings are 12.6804 gal
        assert len(read("KNET", knet(peak=peak)).notes) == told

    def test_length(self) -> None:
        (note,) = read("ESM", esm(DURATION_S="0.200")).notes
        assert note == "the header gives a length of 0.2 s, the samples last 0.1 s"
        assert read("ESM", esm(DURATION_S="0.095")).notes == ()


@pytest.mark.parametrize("n", [2, 3, 7, 8, 9, 15, 16, 17, 100])
def test_any_number_of_samples(n: int) -> None:
    rng = np.random.default_rng(n)
    values = rng.uniform(-999, 999, n)
    assert read("SMC", smc(values.tolist())).values == pytest.approx(values, rel=5.1e-5)
    assert read("COSMOS", cosmos_part(values.tolist())).values == pytest.approx(values, abs=5.1e-6)
    assert read("ESM", esm(values.tolist())).values == pytest.approx(values, abs=5.1e-7)
    readings = rng.integers(-9999999, 9999999, n)
    raw = read("KNET", knet(readings.tolist(), "1(gal)/1000", length=str(n / 100), peak=""))
    assert raw.values == pytest.approx((readings - readings.mean()) / 1000, rel=1e-12, abs=1e-9)
