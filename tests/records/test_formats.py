"""Record formats, each on a small hand-made file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pound_solve.loading.records import formats
from pound_solve.loading.records.base import RawRecord, RecordError, head
from pound_solve.loading.records.text import is_data, parse, split_head

PEER_NEW = """PEER NGA STRONG MOTION DATABASE RECORD
Nowhere-01, 1/2/1903, Invented Station, 090
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      7, DT=   .0050 SEC,
   .1000000E-01  -.2000000E-01   .3000000E-01  -.4000000E-01   .5000000E-01
  -.6000000E-01   .7000000E-01
"""
PEER_OLD = """PACIFIC ENGINEERING AND ANALYSIS STRONG-MOTION DATA
 NOWHERE 01/02/03, INVENTED, 090
 ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=30.0 Hz
     3    0.0200    NPTS, DT
  1.0D-3 -2.0d-03  .3E-02
"""
BERG = """Invented record, north
0.00  0.00  0.02  0.10  0.03 -0.20  0.06  0.30
0.08 -0.05  0.10  0.00
"""


def geonet(
    title: str = "Corrected",
    declared: int = 12,
    factor: str = "1.00",
    components: tuple[str, ...] = ("N28W", "S62W", "Up"),
) -> str:
    """Three invented blocks of 12 accelerations, with 12 velocities and displacements where corrected."""
    more = 12 if title == "Corrected" else 0
    lines: list[str] = []
    for k, component in enumerate(components, 1):
        lines += [
            f"{title} accelerogram 19000101_000000_NONE GNS Science",
            "Site NONE",
            "Nowhere",
            "Instrument X_1",
        ]
        lines += [
            "Resolution: 18-bit",
            f"{title} record of an invented station",
            "5 km east of nowhere",
            "1900 January 01",
        ]
        lines += [
            "Epicentre",
            "Number of points  12",
            f"Raw readings in units of {factor} mm/s/s",
            "Filter",
        ]
        lines += [f"Component {component}  Axis", "Acceleration:", "Velocity:", "Displacement:"]
        integers = [0] * 40
        integers[33:36] = [declared, more, more]
        reals = [0.0] * 60
        reals[24:26] = [0.005, 0.02]
        lines += ["".join(f"{n:8d}" for n in integers[r : r + 10]) for r in range(0, 40, 10)]
        lines += ["".join(f"{x:8.4f}" for x in reals[r : r + 10]) for r in range(0, 60, 10)]
        # the first two fill their eight columns: no blank stands between them
        values = [-11024.7 * k, -9733.1, *(100.0 * k + n for n in range(10))]
        for part in (values, *([[1.0] * 12, [2.0] * 12] if more else [])):
            lines += ["".join(f"{x:8.1f}" for x in part[r : r + 10]) for r in range(0, 12, 10)]
    return "\n".join(lines) + "\n"


def read(format: str, text: str, **options: Any) -> RawRecord:
    raw: RawRecord = formats()[format].impl.read(text, options)
    return raw


def refused(code: str, format: str, text: str, **options: Any) -> str:
    with pytest.raises(RecordError) as caught:
        read(format, text, **options)
    assert caught.value.code == code
    return str(caught.value)


def test_every_format_is_found_and_has_both_functions() -> None:
    page = (Path(__file__).parents[2] / "manual" / "records.md").read_text("utf-8")
    assert set(formats()) == {"AUTO", *re.findall(r"^\*\*([A-Z]+)\*\* –", page, re.M)}
    (row,) = re.findall(r"^\| `FORMAT` .*$", page, re.M)
    assert set(re.findall(r"`([A-Z]+)`", row)) - {"FORMAT"} == set(formats())
    for spec in formats().values():
        assert spec.family == "record"
        assert callable(spec.impl.sniff) and callable(spec.impl.read)


class TestNumbers:
    def test_glued_numbers_and_d_exponents(self) -> None:
        values, counts = parse([" 1.5057E+0-2.2223E+0 3.", "-.123E-02-.456E-02", "", "1.0D-3,2d0;.5"])
        assert values.tolist() == [1.5057, -2.2223, 3.0, -0.00123, -0.00456, 0.001, 2.0, 0.5]
        assert counts == [3, 2, 0, 3]

    @pytest.mark.parametrize("word", ["nan", "-inf", "1e999", "********", "0.1O", "1_000", "1940-05-18"])
    def test_what_is_no_finite_number_is_refused_with_its_line(self, word: str) -> None:
        with pytest.raises(RecordError, match="line 7") as caught:
            parse(["1.0", "2.0", f"3.0 {word}"], 5)
        assert caught.value.code == "R402"

    def test_no_numbers(self) -> None:
        with pytest.raises(RecordError) as caught:
            parse(["", "  "])
        assert caught.value.code == "R402"

    def test_titles_and_data(self) -> None:
        title, data, first = split_head(["# t, a", "", "date 1940-05-18", "0 1 # first", "1 2"])
        assert (title, data, first) == (["t, a", "date 1940-05-18"], ["0 1 ", "1 2"], 4)
        assert not is_data("1940-05-18") and not is_data("") and is_data("nan") and is_data("1.0-2.0 3")

    def test_head_ends_with_a_whole_line(self) -> None:
        assert head("short") == "short"
        assert head("0123456789\n" * 1000).endswith("9\n")
        assert len(head("x" * 10000)) == 4096


class TestPeer:
    def test_new_header(self) -> None:
        raw = read("PEER", PEER_NEW)
        assert raw.values.tolist() == [0.01, -0.02, 0.03, -0.04, 0.05, -0.06, 0.07]
        assert (raw.dt, raw.unit, raw.declared, raw.component) == (0.005, "G", 7, "090")
        assert raw.t[-1] == pytest.approx(0.03)

    def test_old_header_with_d_exponents(self) -> None:
        raw = read("PEER", PEER_OLD)
        assert raw.values.tolist() == [0.001, -0.002, 0.003]
        assert (raw.dt, raw.declared, raw.unit) == (0.02, 3, "G")

    def test_other_unit(self) -> None:
        assert read("PEER", PEER_NEW.replace("UNITS OF G", "UNITS OF CM/SEC**2")).unit == "CM/S2"

    @pytest.mark.parametrize("declared", [6, 8])
    def test_wrong_count_names_both(self, declared: int) -> None:
        message = refused("R403", "PEER", PEER_NEW.replace("     7,", f"     {declared},"))
        assert f"declares {declared} " in message and "holds 7" in message

    def test_bad_value_names_its_line(self) -> None:
        assert "line 6" in refused("R402", "PEER", PEER_NEW.replace(".7000000E-01", "x"))

    def test_velocity_file(self) -> None:
        refused("R402", "PEER", PEER_NEW.replace("ACCELERATION", "VELOCITY"))

    def test_no_header_and_bad_step(self) -> None:
        refused("R402", "PEER", "1 2 3\n")
        refused("R402", "PEER", PEER_NEW.replace(".0050", "0.0"))

    def test_windows_line_ends(self) -> None:
        assert len(read("PEER", PEER_NEW.replace("\n", "\r\n")).values) == 7


class TestColumns:
    def test_one_column_needs_a_step(self) -> None:
        raw = read("COLUMNS", "my record\n# cm/s2\n1.5\n-2\n\n3 # last\n", DT=0.01)
        assert raw.values.tolist() == [1.5, -2.0, 3.0]
        assert raw.dt == 0.01 and raw.title == ("my record", "cm/s2") and raw.unit is None
        assert "DT" in refused("R405", "COLUMNS", "1\n2\n")

    @pytest.mark.parametrize(
        "text", ["0 1\n0.5 2\n0.6 3\n", "t,a\n0,1\n0.5,2\n0.6,3\n", "0\t1\n.5\t2\n.6\t3"]
    )
    def test_time_and_acceleration(self, text: str) -> None:
        raw = read("COLUMNS", text)
        assert raw.t.tolist() == [0.0, 0.5, 0.6] and raw.values.tolist() == [1.0, 2.0, 3.0]

    def test_column_of_many(self) -> None:
        text = "0 1 10\n1 2 20\n"
        assert read("COLUMNS", text, COLUMN=3).values.tolist() == [10.0, 20.0]
        assert read("COLUMNS", text, COLUMN=1, DT=0.1).values.tolist() == [0.0, 1.0]
        assert "3 columns" in refused("R405", "COLUMNS", text)
        assert "3 columns" in refused("R405", "COLUMNS", text, DT=0.1)
        refused("R405", "COLUMNS", text, COLUMN=4)
        refused("R405", "COLUMNS", text, COLUMN=1)

    def test_numbers_in_turn(self) -> None:
        raw = read("COLUMNS", "1. 2. 3.-4.\n5. 6.\n", COLUMN=0, DT=0.02)
        assert raw.values.tolist() == [1, 2, 3, -4, 5, 6] and raw.dt == 0.02
        refused("R405", "COLUMNS", "1 2\n3\n", COLUMN=0)

    def test_ragged_rows_even_when_the_sum_fits(self) -> None:
        assert "line 2 holds 1" in refused("R402", "COLUMNS", "0 1\n2\n3 4 5\n")

    def test_bad_values(self) -> None:
        assert "line 3" in refused("R402", "COLUMNS", "t a\n0 1\n1 nan\n")
        assert "line 1" in refused("R402", "COLUMNS", "**** 1\n1 2\n")
        assert "line 3" in refused("R402", "COLUMNS", "0 1\n1 2\nend of record\n")
        refused("R402", "COLUMNS", "only words\n")
        refused("R402", "COLUMNS", "1\n", DT=0.1)

    def test_times_must_increase(self) -> None:
        message = refused("R402", "COLUMNS", "0 1\n1 2\n1 3\n")
        assert "sample 3" in message


class TestBerg:
    def test_uneven_pairs(self) -> None:
        raw = read("BERG", BERG)
        assert raw.t.tolist() == [0.0, 0.02, 0.03, 0.06, 0.08, 0.1]
        assert raw.values.tolist() == [0.0, 0.1, -0.2, 0.3, -0.05, 0.0]
        assert raw.title == ("Invented record, north",) and raw.dt is None

    def test_glued_pairs(self) -> None:
        assert read("BERG", "0.00 0.10 0.02-0.20 0.04-0.30 0.06 0.00\n").values.tolist() == [
            0.1,
            -0.2,
            -0.3,
            0.0,
        ]

    def test_time_without_acceleration(self) -> None:
        assert "11 numbers" in refused("R403", "BERG", BERG.replace("0.10  0.00\n", "0.10\n"))

    def test_times_must_increase(self) -> None:
        refused("R402", "BERG", BERG.replace("0.08", "0.05"))


class TestGeonet:
    @pytest.mark.parametrize("wanted", [2, "2", "S62W", "s62w"])
    def test_component(self, wanted: object) -> None:
        raw = read("GEONET", geonet(), COMPONENT=wanted)
        assert raw.values[:3].tolist() == [-22049.4, -9733.1, 200.0] and len(raw.values) == 12
        assert (raw.dt, raw.unit, raw.component, raw.declared) == (0.02, "MM/S2", "S62W", 12)

    def test_first_and_last_component(self) -> None:
        assert read("GEONET", geonet()).component == "N28W"
        assert read("GEONET", geonet(), COMPONENT="UP").values[-1] == 309.0

    def test_uncorrected_readings_in_their_unit(self) -> None:
        raw = read("GEONET", geonet("Uncorrected", factor="0.50"), COMPONENT=3)
        assert len(raw.values) == 12 and raw.values[-1] == 154.5

    def test_count(self) -> None:
        message = refused("R403", "GEONET", geonet(declared=11))
        assert "35" in message and "36" in message and "N28W" in message
        cut = geonet().splitlines()[:-1]
        refused("R403", "GEONET", "\n".join(cut), COMPONENT=3)
        refused("R403", "GEONET", "\n".join(cut[:20]))

    def test_unknown_component_lists_them(self) -> None:
        assert "1 N28W, 2 S62W, 3 Up" in refused("R405", "GEONET", geonet(), COMPONENT="N00E")
        refused("R405", "GEONET", geonet(), COMPONENT=4)

    def test_other_file(self) -> None:
        refused("R402", "GEONET", BERG)


class TestAuto:
    @pytest.mark.parametrize(
        ("text", "format"),
        [
            (PEER_NEW, "PEER"),
            (PEER_OLD, "PEER"),
            (BERG, "BERG"),
            (geonet(), "GEONET"),
            (geonet("Uncorrected"), "GEONET"),
            ("0 1\n1 2\n", "COLUMNS"),
            ("t,a\n0,1\n1,2\n", "COLUMNS"),
            ("\n".join(f"{k * 0.01:.2f} {k}" for k in range(3000)), "COLUMNS"),
        ],
    )
    def test_recognised(self, text: str, format: str) -> None:
        raw = read("AUTO", text)
        assert raw.format == format
        assert np.array_equal(raw.values, read(format, text).values)
        # no two of the formats claim it, but for those that go by numbers alone
        claims = [s.name for s in formats().values() if s.impl.sniff(head(text)) and not s.impl.greedy]
        assert claims == ([] if formats()[format].impl.greedy else [format])

    def test_items_of_the_format_go_through(self) -> None:
        assert read("AUTO", "1\n2\n", DT=0.5).dt == 0.5
        assert read("AUTO", geonet(), COMPONENT="Up").component == "Up"
        assert read("AUTO", "1 2 3\n4 5\n6 7 8\n", DT=0.5, COLUMN=0).values.tolist() == [
            1,
            2,
            3,
            4,
            5,
            6,
            7,
            8,
        ]

    def test_not_recognised(self) -> None:
        assert "PEER" in refused(
            "R402", "AUTO", "2 CORRECTED ACCELEROGRAM\n*\n 1 2 3 4\n 5 6\n|\n 1 2 3 4\n"
        )
        refused("R402", "AUTO", "words\n")
        assert "line 2: 'x'" in refused("R402", "AUTO", "0 1\n1 x\n")
        refused("R402", "AUTO", " \n")

    def test_spoilt_table_is_reported_by_line(self) -> None:
        assert "line 2" in refused("R402", "AUTO", "0 1\n1 nan\n2 3\n")
