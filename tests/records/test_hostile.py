"""Damaged, foreign and doubtful files: an error with its place, or samples that are in order."""

from __future__ import annotations

import contextlib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agency_files import FILES, csmip, knet, smc
from pound_solve.driver.run import DeckError, Request, prepare
from pound_solve.loading.motions import record
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.records import formats
from pound_solve.loading.records.base import RawRecord, RecordError
from pound_solve.loading.records.known import load
from pound_solve.loading.records.text import parse
from sweep.small import folder

#: what damage puts in the place of something else
_WORDS = (
    "",
    " ",
    "\n",
    "\0",
    "-",
    "+",
    ".",
    ",",
    ";",
    "#",
    "nan",
    "inf",
    "*",
    "1e999",
    "1D300",
    "9" * 5000,
    "é",
    "/",
    ":",
    "(",
    "0",
    "-999",
)
_ROUNDS = 250


def damaged(text: str, rng: np.random.Generator) -> str:
    """The text with one to three of its parts taken out, doubled, swapped or written over."""
    for _ in range(int(rng.integers(1, 4))):
        i, j = sorted(int(k) for k in rng.integers(0, len(text) + 1, 2))
        way = int(rng.integers(0, 5))
        if way == 0:
            text = text[:i]
        elif way == 1:
            text = text[:i] + text[min(j, i + 200) :]
        elif way == 2:
            text = text[:j] + text[i:j][:200] + text[j:]
        elif way == 3:
            lines = text.splitlines(keepends=True) or [""]
            a, b = (int(k) for k in rng.integers(0, len(lines), 2))
            lines[a], lines[b] = lines[b], lines[a]
            text = "".join(lines)
        else:
            word = _WORDS[int(rng.integers(0, len(_WORDS)))]
            text = text[:i] + word + text[i + max(1, len(word)) :]
    return text


def in_order(raw: RawRecord) -> bool:
    """Whether the samples are finite, at times that increase."""
    t = raw.t
    return bool(np.isfinite(raw.values).all() and np.isfinite(t).all() and (np.diff(t) > 0).all())


@pytest.mark.full
@pytest.mark.parametrize("format", FILES)
def test_damaged_files_are_read_in_order_or_refused(format: str) -> None:
    rng = np.random.default_rng(20)
    refused = 0
    for n in range(_ROUNDS):
        text = damaged(FILES[format], rng)
        for name in (format, "AUTO"):
            options: dict[str, Any] = {"COMPONENT": "2"} if name == "AUTO" and n % 5 == 0 else {}
            try:
                raw = formats()[name].impl.read(text, options)
            except RecordError as error:
                refused += 1
                assert error.code in {"R402", "R403", "R404", "R405"} and len(error.message) < 900
            else:
                assert in_order(raw), text
    assert 0 < refused < 2 * _ROUNDS


@pytest.mark.parametrize("format", formats())
@pytest.mark.parametrize(
    "text", ["", "\n", " \n \n", "\0", "x" * 100000, "# only\n" * 5000, "1\n", "\n" * 10000 + "1 2\n"]
)
def test_files_of_nothing(format: str, text: str) -> None:
    with pytest.raises(RecordError):
        formats()[format].impl.read(text, {})


@pytest.mark.parametrize("format", FILES)
@pytest.mark.parametrize(
    "long", ["9" * 100000 + "x", "1 acc pts " + "units=" * 20000, "(" * 100000, "1." * 50000]
)
def test_one_endless_line(format: str, long: str) -> None:
    # patterns that try all ways to part such a line take minutes
    lines = FILES[format].splitlines()
    for place in (0, len(lines) // 2):
        text = "\n".join([*lines[:place], long, *lines[place:]])
        for name in (format, "AUTO"):
            # a title may be long; what matters is that an answer comes
            with contextlib.suppress(RecordError):
                assert in_order(formats()[name].impl.read(text, {}))


@pytest.mark.parametrize(
    ("format", "good", "bad", "line"),
    [
        ("PEER", "= 4,", f"= {'4' * 5000},", "line 4"),
        ("PEER", ".0050", "1E400", "line 4"),
        ("PEER", ".3D0", "1D300", "line 5"),
        ("SMC", "        20", "9999999999", "line 14"),
    ],
)
def test_numbers_beyond_all_bounds(format: str, good: str, bad: str, line: str) -> None:
    with pytest.raises(RecordError, match=line):
        formats()[format].impl.read(FILES[format].replace(good, bad), {})


class TestForeign:
    def place(self, tmp_path: Path, data: bytes) -> str:
        path = tmp_path / "file.dat"
        path.write_bytes(data)
        with pytest.raises(RecordError) as caught:
            load(path)
        assert caught.value.code == "R402" and caught.value.hint
        return caught.value.message

    @pytest.mark.parametrize(
        ("data", "kind"),
        [
            (b"\x1f\x8b\x08\0\0", "gzip"),
            (b"PK\x03\x04\x14\0", "zip"),
            (b"BZh91AY&SY", "bzip2"),
            (b"\xfd7zXZ\0", "xz"),
            (b"\x1f\x9d\x90", "compress"),
            (b"AOM0010101.EW".ljust(257, b"\0") + b"ustar\x0000" + b"\0" * 200, "tar"),
            (b"000001D NONE   00HNE" + b"\0" * 40, "miniSEED"),
            (b"MS\x03\x04" + b"\0" * 40, "miniSEED"),
            (b"\0\0\xc7\xc2" * 76 + b"\x06\0\0\0" + b"\0" * 400, "SAC"),
            (b"\0\0\xc7\xc2" * 76 + b"\0\0\0\x06" + b"\0" * 400, "SAC"),
            (b"\x89HDF\r\n\x1a\n", "HDF5"),
            (b"%PDF-1.4\n", "PDF"),
            ("0 1\n1 2\n".encode("utf-16"), "UTF-16"),
            (b"0 1\n\0\x07\0 2\n", "binary"),
        ],
    )
    def test_binary_files_are_named(self, tmp_path: Path, data: bytes, kind: str) -> None:
        assert kind in self.place(tmp_path, data)

    def test_padding_is_no_binary(self, tmp_path: Path) -> None:
        path = tmp_path / "padded.smc"
        path.write_bytes(smc().encode() + b"\0" * 400)
        assert len(formats()["AUTO"].impl.read(load(path)[0], {}).values) == 20

    @pytest.mark.parametrize(
        ("text", "kind"),
        [
            ("<!DOCTYPE html>\n<html>", "web page"),
            ("\n<html><body>Sign in", "web page"),
            ('<?xml version="1.0"?>', "XML"),
            ("WID2 1903/02/01 00:00:00.000 NONE", "GSE"),
            ("Uncorrected Accelerogram Data             Processed: none\n", "CSMIP"),
            ("UNCORRECTED ACCELEROGRAM DATA\n", "CSMIP"),
            ("* VOL1DS FILE:  0/00\n", "BHRC"),
            ("Response and Fourier amplitude spectra (78 periods)\n", "spectra"),
        ],
    )
    def test_texts_that_are_known_and_not_read(self, text: str, kind: str) -> None:
        with pytest.raises(RecordError) as caught:
            formats()["AUTO"].impl.read(text + "0 1\n1 2\n2 3\n", {})
        assert kind in caught.value.message and caught.value.hint

    def test_columns_may_still_make_sense_of_one(self) -> None:
        text = "Uncorrected accelerogram data\n0 1\n1 2\n"
        assert formats()["COLUMNS"].impl.read(text, {}).values.tolist() == [1.0, 2.0]


class TestDecimalComma:
    @pytest.mark.parametrize(
        "text",
        [
            "0,00 0,5\n0,01 -1,25\n0,02 3\n",
            "0,00;0,5\n0,01;-1,25\n0,02;3\n",
            "t\ta\n0,00\t,5\n0,01\t-1,25E0\n0,02\t3,\n",
        ],
    )
    def test_read_where_something_else_parts_numbers(self, text: str) -> None:
        if ",5\n" in text and "\t" in text:
            text = text.replace("\t,5", "\t0,5").replace("3,\n", "3\n")
        raw = formats()["AUTO"].impl.read(text, {})
        assert raw.format == "COLUMNS" and raw.t.tolist() == [0.0, 0.01, 0.02]
        assert raw.values.tolist() == [0.5, -1.25, 3.0]

    def test_numbers_in_turn(self) -> None:
        raw = formats()["COLUMNS"].impl.read("0,5 1,5 2,5\n3,5\n", {"COLUMN": 0, "DT": 0.1})
        assert raw.values.tolist() == [0.5, 1.5, 2.5, 3.5]

    @pytest.mark.parametrize(("text", "line"), [("0,12\n-0,05\n0,3\n", 2), ("0,01,0,25\n0,02,0,5\n", 1)])
    def test_refused_where_it_parts_numbers_too(self, text: str, line: int) -> None:
        for options in ({}, {"DT": 0.1}, {"DT": 0.1, "COLUMN": 0}, {"COLUMN": 2}):
            with pytest.raises(RecordError, match=f"line {line}: '.*' may be a decimal comma"):
                formats()["COLUMNS"].impl.read(text, options)

    @pytest.mark.parametrize(
        "text",
        [
            "0,1\n1,2\n",
            "0, 01\n1, 02\n",
            "0.5,01\n1.5,02\n",
            "0,1,2\n1,3,4\n",
            "0,1,2 3,4,5\n1,1,2 3,4,5\n",
            "0,-1 \n1,-2\n",
            "0 , 5\n1 , 7\n",
        ],
    )
    def test_commas_that_part_numbers(self, text: str) -> None:
        values, counts = parse(text.splitlines())
        plain = [float(word) for word in text.replace(",", " ").split()]
        assert values.tolist() == plain and len(set(counts)) == 1


class TestSize:
    def build(self, tmp_path: Path, text: str, **card: Any) -> tuple[str, ...]:
        (tmp_path / "r.txt").write_text(text)
        context = LoadingContext(9.80665, search_path=(tmp_path,))
        return tuple(record.build({"FILE": "r.txt", **card}, context).info["warnings"])

    @pytest.mark.parametrize(
        ("peak", "unit", "likely"),
        [
            (341.7, None, "0.348 g if the samples were in CM/S2"),
            (3.417, None, "0.348 g if the samples were in M/S2"),
            (3417.0, None, "0.348 g if the samples were in MM/S2"),
            (0.3, "CM/S2", "0.3 g if the samples were in G"),
            (0.3, "MM/S2", "0.3 g if the samples were in G"),
        ],
    )
    def test_the_likely_unit_is_told(
        self, tmp_path: Path, peak: float, unit: str | None, likely: str
    ) -> None:
        (warning,) = self.build(tmp_path, f"0 0\n1 {peak}\n2 0\n", UNIT=unit)
        assert likely in warning and "check UNIT" in warning

    @pytest.mark.parametrize("peak", [0.0, 1e-9, 1e12])
    def test_no_unit_helps(self, tmp_path: Path, peak: float) -> None:
        (warning,) = self.build(tmp_path, f"0 0\n1 {peak}\n2 0\n")
        assert "were in" not in warning

    def test_an_earthquake(self, tmp_path: Path) -> None:
        assert self.build(tmp_path, "0 0\n1 0.3\n2 0\n") == ()


@pytest.mark.full
def test_a_million_samples() -> None:
    readings = np.random.default_rng(1).integers(-30000, 30000, 1_000_000)
    peak = f"{np.abs(readings - readings.mean()).max() * 3920 / 6182761:.3f}"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        raw = formats()["AUTO"].impl.read(knet(readings.tolist(), length="10000", peak=peak), {})
    assert len(raw.values) == 1_000_000 and raw.notes == ()


DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 C 1 2
PROPS
 C SPRING KX=4000
WEIGHTS
 2 98.1
EQUAKE
 RECORD "motion.dat" {items}
ANALYSIS
 HISTORY 0.1 METHOD=EXACT
MEANT P373,R412
"""


@pytest.mark.parametrize(
    ("data", "items", "code", "column", "words"),
    [
        (
            knet(peak="90.0").encode(),
            "SCALE=80",
            "R409",
            9,
            "motion.dat: the header gives a peak of 90 CM/S2, the samples have 12.68",
        ),
        (knet(peak="12.681").encode(), "", None, 0, ""),
        (csmip().encode(), "COMPONENT=N45E", "R405", 32, "no component 'N45E'"),
        (csmip().partition("points of veloc")[0].encode()[:-60], "", "R403", 9, "motion.dat: "),
        (b"\x1f\x8b\x08\0\0", "", "R402", 9, "motion.dat: the file is a gzip archive"),
        (b"0 0\n1 341.7\n2 0\n", "", "R404", 2, "0.348 g if the samples were in CM/S2"),
    ],
)
def test_a_deck_tells_its_place(
    tmp_path: Path, data: bytes, items: str, code: str | None, column: int, words: str
) -> None:
    (tmp_path / "motion.dat").write_bytes(data)
    deck = tmp_path / "deck.inp"
    deck.write_text(DECK.format(items=items))
    try:
        found = list(prepare(Request(str(deck))).warnings)
    except DeckError as error:
        found = list(error.diagnostics)
    assert [d.code for d in found] == ([code] if code else []), found
    for told in found:
        assert (told.span.line, told.span.column) == (12, column)
        assert words in told.message


@pytest.mark.parametrize("scale", ["5e-324", "1e-300"])
def test_a_factor_of_next_to_nothing_is_told(tmp_path: Path, scale: str) -> None:
    folder(tmp_path)
    ready = prepare(Request(str(tmp_path / "wall.inp"), {"scale": scale}))
    assert any("check UNIT and SCALE" in warning.message for warning in ready.warnings)
