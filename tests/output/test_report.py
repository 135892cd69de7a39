"""The report: what it promises about its form, and that it hides nothing."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from output import sample
from pound_solve import __version__
from pound_solve.analyses.static_response import without_rounding
from pound_solve.report.text import WIDTH, render
from pound_solve.results import Results, Writer
from pound_solve.results.contents import SECTIONS, TABLES


@pytest.fixture(scope="module")
def report(done: Results) -> str:
    return render(done)


@pytest.fixture
def only(tmp_path: Path) -> Callable[..., str]:
    """Report of a finished run with the given tables only."""

    def make(**tables: list[tuple[object, ...]]) -> str:
        with Writer(tmp_path / "o.h5", title="t", units=sample.UNITS, program_version="0") as writer:
            for name, rows in tables.items():
                writer.table(name, rows)
            writer.finish("done")
        with Results.open(tmp_path / "o.h5") as results:
            return render(results)

    return make


def body(report: str) -> list[str]:
    """Lines between the first rule of dashes and the next blank line."""
    lines = report.split("\n")
    start = next(i for i, line in enumerate(lines) if re.fullmatch(r"  [- ]+", line)) + 1
    return [line.strip() for line in lines[start : lines.index("", start)]]


def test_plain_text(report: str) -> None:
    assert report.isascii()
    assert report.endswith("\n")
    lines = report.split("\n")
    assert max(map(len, lines)) == WIDTH == 132
    assert all(line == line.rstrip() for line in lines)
    assert "\t" not in report


def test_sections_and_tables_in_order(report: str) -> None:
    expected = []
    for number, (heading, names) in enumerate(SECTIONS, 1):
        expected.append(f"{number}  {heading.upper()}")
        expected += [f"{number}.{i}  {TABLES[name].title.upper()}" for i, name in enumerate(names, 1)]
    assert re.findall(r"^\d+(?:\.\d+)?  [A-Z].*$", report, re.MULTILINE) == expected


def test_banner(report: str) -> None:
    banner = report[: report.index("1  SUMMARY")]
    assert f"POUND-SOLVE {__version__}" in banner
    assert "diaphragm - gap 8 mm, xi = 5 %" in banner
    assert "force kN, length m, time s" in banner
    assert "DID NOT" not in banner


@pytest.mark.parametrize("name", TABLES)
def test_units_in_heads(report: str, name: str) -> None:
    table = TABLES[name]
    start = report.index(f"  {table.title.upper()}\n\n")
    head = report[start:].partition("\n\n\n")[0]
    for column in table.columns:
        if column.unit:
            assert f"[{sample.UNITS.text(column.unit)}]" in head


def test_the_same_bytes_again(tmp_path: Path, report: str) -> None:
    with Results.open(sample.write(tmp_path / "again.h5")) as results:
        assert render(results) == report
    assert report.index("1  SUMMARY") < report.index("5.2  RUN LOG") < report.rindex("12  RUN FIGURES")
    last = report[report.index("12  RUN FIGURES") :]
    assert "wall time" in last
    assert "wall time" not in report[: -len(last)]
    assert str(tmp_path) not in report


def test_missing_and_empty_tables_are_left_out(only: Callable[..., str]) -> None:
    text = only(modes=sample.rows()["modes"], reactions=[], checks=sample.rows()["checks"])
    assert re.findall(r"^\d+(?:\.\d+)?  [A-Z].*$", text, re.MULTILINE) == [
        "1  SUMMARY",
        "1.1  CHECKS OF THIS RUN",
        "2  FREE VIBRATION",
        "2.1  NATURAL MODES",
    ]
    assert "Forces of the supports" not in text


def test_empty_columns_are_left_out(only: Callable[..., str]) -> None:
    nan = float("nan")
    text = only(nodes=[(1, 0.0, 0.0, "XYR", "", "")], drift_envelope=[("d", 0.1, 1.0, -0.1, 2.0, nan, nan)])
    assert "fixed" in text
    for head in ("slaved  ", "master", "height", "ratio"):
        assert head not in text


def test_a_table_without_content_is_left_out(only: Callable[..., str]) -> None:
    assert "RUN FIGURES" not in only(run_figures=[("", "")])


def test_words_for_zero(report: str) -> None:
    assert re.search(r"^ +12 .* ground +-$", report, re.MULTILINE)
    assert re.search(r"^ +302 .* Y +X +100$", report, re.MULTILINE)


def test_defaults_are_marked(report: str) -> None:
    assert "An asterisk (*) marks a default value." in report
    assert re.search(r"gravity +9\.80665 m/s\^2 +\*  weights", report)
    assert not re.search(r"duration .*\*", report)


def test_a_checksum_is_cut(report: str) -> None:
    assert " 9b0c5a1f3e77\n" in report


def test_long_tables_are_cut(tmp_path: Path) -> None:
    many = [sample.rows()["collisions"][0]] * 120
    with Writer(tmp_path / "o.h5", title="t", units=sample.UNITS, program_version="0") as writer:
        writer.table("collisions", many)
        writer.finish("done")
    with Results.open(tmp_path / "o.h5") as results:
        usual, short, whole = render(results), render(results, limit=3), render(results, limit=0)
    row = re.compile(r"^ +902 +\d", re.MULTILINE)
    assert "... and 20 more rows: table 'collisions' of the results file" in usual
    assert len(row.findall(usual)) == 100
    assert "... and 117 more rows: table 'collisions'" in short
    assert "more rows" not in whole
    assert len(row.findall(whole)) == 120


@pytest.fixture(scope="module")
def with_long_tables(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A run with 70 rows in a table of four sections each, and a short table."""
    path = tmp_path_factory.mktemp("long") / "o.h5"
    with Writer(path, title="t", units=sample.UNITS, program_version="0") as writer:
        for name in ("contact_summary", "collisions", "damping", "run_figures"):
            writer.table(name, [sample.rows()[name][0]] * 70)
        writer.table("reactions", sample.rows()["reactions"])
        writer.finish("done")
    return Results.open(path)


def test_long_tables_are_in_an_appendix_before_the_run_figures(with_long_tables: Results) -> None:
    text = render(with_long_tables)
    assert re.findall(r"^[A-Z0-9]+(?:\.\d+)?  [A-Z].*$", text, re.MULTILINE) == [
        "1  SUMMARY",
        "1.1  CONTACT SUMMARY",
        "2  CONTACTS AND COLLISIONS",
        "2.1  COLLISIONS",
        "3  STATIC ANALYSIS",
        "3.1  SUPPORT REACTIONS",
        "4  APPENDIX: INPUT",
        "4.1  DAMPING",
        "A  APPENDIX: LONG TABLES",
        "A.1  COLLISIONS (2.1)",
        "5  RUN FIGURES",
        "5.1  TIME, MEMORY, VERSIONS",
    ]
    there, _, appendix = text.partition("A.1  ")
    note = "  Table A.1 of the appendix; 'collisions' in the results file.\n"
    assert f"2.1  COLLISIONS\n\n{note}\n\n3  STATIC" in there
    row = re.compile(r"^ +902 +\d", re.MULTILINE)
    assert (len(row.findall(there)), len(row.findall(appendix))) == (0, 70)


def test_excerpts_have_no_appendix(with_long_tables: Results) -> None:
    text = render(with_long_tables, only=("collisions",))
    assert "APPENDIX" not in text and len(re.findall(r"^ +902 +\d", text, re.MULTILINE)) == 70


def test_a_table_of_one_page_stays(with_long_tables: Results) -> None:
    assert "A.1" in render(with_long_tables, limit=53)
    assert "A.1" not in render(with_long_tables, limit=40)


def test_groups_are_blocks(report: str) -> None:
    """Displacements first, then velocities, each block with number formats of its own."""
    envelope = report[report.index("  NODE ENVELOPES\n") : report.index("  REACTION ENVELOPES\n")]
    blocks = [re.findall(r"displacement|velocity|acceleration", b) for b in envelope.split("\n\n")]
    assert [b[0] for b in blocks if b] == ["displacement", "velocity", "acceleration"]
    assert all(len(set(b)) <= 1 for b in blocks)


def test_notes(report: str) -> None:
    assert "\n  Accelerations are absolute.\n" in report


@pytest.mark.parametrize(
    ("values", "printed"),
    [
        ((0.0, -0.0, 0.0), ["0.0", "0.0", "0.0"]),
        ((0.0, 3.5, 7.0), ["0.0", "3.5", "7.0"]),
        ((1e-3, 12000.0, 0.5), ["0.001", "12000.000", "0.500"]),
        ((1.234567891, 0.01, -100.0), ["1.2346", "0.0100", "-100.0000"]),
        ((123.456789, 45.6789, -0.5), ["123.46", "45.68", "-0.50"]),
        ((18204.731, 9101.26), ["18205", "9101"]),
        ((1234567.8, 1e6), ["1234568", "1000000"]),
        ((1e-19, -2.5e-4, 0.0), ["0", "-2.5E-04", "0"]),  # rounding beside what counts
        ((1e-9, -2.5e-4, 0.0), ["1.0E-09", "-2.5E-04", "0"]),
        ((2.5084e7, 1.0, float("nan")), ["2.5084E+07", "1.0000E+00", "-"]),
        ((1e-310, float("inf"), 2.0), ["0.0", "inf", "2.0"]),
        ((-0.0, -1e-310, 5.0), ["0.0", "0.0", "5.0"]),
    ],
)
def test_numbers(only: Callable[..., str], values: tuple[float, ...], printed: list[str]) -> None:
    text = only(reactions=[(i, v, 1.0, 1.0) for i, v in enumerate(values)])
    assert [line.split()[1] for line in body(text)] == printed


def test_input_is_echoed_with_the_digits_of_the_deck(only: Callable[..., str]) -> None:
    text = only(loads=[(1, 12.3456789, 0.0, 0.0), (2, 1000.5, 1e-3, 0.0)])
    rows = [["12.3456789", "0.000", "0.0"], ["1000.5000000", "0.001", "0.0"]]
    assert [line.split()[1:] for line in body(text)] == rows


def test_times_show_what_they_need(only: Callable[..., str]) -> None:
    row = ("a", 1, 2.0, 10.123456, 0.1, 0.1, 0.1, 0.1, 0.1)
    assert " 10.123456 " in only(contact_summary=[row])
    assert " 14.180 " in only(contact_summary=[(*row[:3], 14.180000000000001, *row[4:])])


def test_tags_that_look_like_numbers_stay(only: Callable[..., str]) -> None:
    text = only(run_figures=[("1E5", "007")])
    assert body(text) == ["1E5   007"]


def test_hostile_texts(only: Callable[..., str]) -> None:
    text = only(scene=[("a\nb\tc\x07", "Grüße – ω ≤ µ × 漢", "x" * 400), ("s" * 90, "d" * 90, "w" * 90)])
    assert text.isascii()
    assert max(map(len, text.split("\n"))) <= WIDTH
    assert "a b c?" in text
    assert "Grusse - omega <= mu x ?" in text
    assert text.count("x") >= 400


def test_very_wide_tables_are_split(only: Callable[..., str]) -> None:
    wide = {str: lambda _: "x" * 60, float: lambda v: 1.23456789e5 * v, int: lambda v: v}
    row = tuple(wide[type(v)](v) for v in sample.rows()["motions"][0])
    text = only(motions=[row])
    assert max(map(len, text.split("\n"))) <= WIDTH
    assert len(re.findall(r"^  motion ", text, re.MULTILINE)) == 2


def test_a_stopped_run_says_so_first(tmp_path: Path) -> None:
    """When it stopped, and which sample was the last, which is another time."""
    why = "A506 at t = 2.996 s: interrupted"
    path = sample.write(tmp_path / "s.h5", status="stopped", message=why)
    with Results.open(path) as results:
        text = render(results)
    frame = text[: text.index("1  SUMMARY")]
    head, _, told, _, scope = (line.strip("* ") for line in frame.splitlines() if line.startswith("**  "))
    assert (head, told) == ("THE ANALYSIS DID NOT COMPLETE", why)
    assert (
        scope == "The last sample of the time history is that at 2.990 s: results taken from it end there."
    )


def test_a_killed_run_says_so_first(tmp_path: Path) -> None:
    with Writer(tmp_path / "k.h5", title="", units=sample.UNITS, program_version="0") as writer:
        writer.table("size", [("a", "b")])
    with Results.open(tmp_path / "k.h5") as results:
        text = render(results)
    assert "THE ANALYSIS DID NOT COMPLETE" in text
    assert "The run was killed" in text
    assert "no time history" in text


def test_a_column_of_a_newer_version_may_be_missing(tmp_path: Path) -> None:
    import h5py

    path = sample.write(tmp_path / "m.h5")
    with h5py.File(path, "r+") as file:
        old = file["tables/reactions"]
        attrs = {name: value for name, value in old.attrs.items() if name != "digest"}
        file.attrs["format_version"] = [1, 1]
        data = np.array([(1, 2.0)], dtype=[("node", "i8"), ("fx", "f8")])
        del file["tables/reactions"]
        file["tables/reactions"] = data
        file["tables/reactions"].attrs.update(attrs)
    with Results.open(path) as results:
        assert re.search(r"force X\n  node +\[kN\]", render(results))


def test_rounding_is_no_force() -> None:
    values = np.array([600.0, -3e-14, 2e-13, -5e-26, 1e-9, 0.0])
    kinds = ("kN", "kN", "kN*m", "kN*m", "kN", "kN")
    # a moment is measured against moments: the largest of a kind stays, however small
    assert without_rounding(values, kinds).tolist() == [600.0, 0.0, 2e-13, 0.0, 1e-9, 0.0]
    assert without_rounding(np.array([]), ()).size == 0
