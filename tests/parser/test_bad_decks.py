"""Every message: small decks with one mistake each; the first line names the code and its place."""

import re
from pathlib import Path

import pytest

from pound_deck.diagnostics import caret, render, suggest
from pound_deck.messages import MESSAGES
from pound_deck.reader import read_deck, read_text
from pound_deck.source import MAX_BYTES, MAX_DEPTH, MAX_LINE

EXPECT = re.compile(r"! expect ([A-Z]\d+)(?: (\d+):(\d+))?( solver)?$")
DECKS = sorted((Path(__file__).parent / "bad").glob("*.inp"))


def expected(path):
    return EXPECT.match(path.read_text("utf-8").split("\n")[0])


#: decks that read well here; tests/unit/test_solver_messages.py shows what the solver says of them
OF_THE_SOLVER = [path for path in DECKS if expected(path)[4]]
BAD = [path for path in DECKS if path not in OF_THE_SOLVER]
#: mistakes that only a file made on the fly, or the command line, can hold; each has a test below
ON_THE_FLY = {"P101", "P102", "P103", "P104", "P107", "P110", "P232", "P233"}
#: no mistake of a deck; tests/unit/test_opensees.py shows it for every law and rule
OF_THE_EXPORT = {"P380"}


@pytest.mark.parametrize("path", BAD, ids=lambda p: p.stem)
def test_one_mistake_one_message_at_its_place(path, catalog):
    code, *where, _ = expected(path).groups()
    model, found, files = read_deck(str(path), catalog)
    assert {d.code for d in found} == {code}, render(found, files)
    span = found[0].span
    place = (str(span.line), str(span.column)) if span else (None, None)
    assert place == tuple(where)
    assert path.name.startswith(code)
    assert (model is None) == any(d.severity == "error" for d in found)
    assert caret(found[0], files)


def test_every_parser_message_has_a_deck():
    decks = {path.name[:4] for path in DECKS if path.name.startswith("P")}
    assert decks | ON_THE_FLY | OF_THE_EXPORT == {code for code in MESSAGES if code.startswith("P")}


def test_every_message_of_a_bad_deck_tells_the_cure(catalog):
    for path in BAD:
        for d in read_deck(str(path), catalog)[1]:
            assert d.hint or d.code in {"P109"}, path.name


def test_all_mistakes_in_one_pass(catalog):
    text = "NODES\n 1 0 0 FX=X\n 2 0 (3\n 3 0 oops\nELEMENTS\n 1 COL 1\n 2.5 COL 1 2\nPROPS\n COL SPRNG\n"
    codes = [d.code for d in read_text(text, catalog)[1]]
    assert codes == ["P316", "P211", "P203", "P222", "P216", "P210"]


@pytest.mark.parametrize("deck", ["no_value", "no_value_at_the_end"])
def test_a_value_that_is_missing_is_named(catalog, deck):
    _, (d,), _ = read_deck(str(DECKS[0].parent / f"P209_{deck}.inp"), catalog)
    assert (d.message, d.span.end - d.span.column) == ("the value of KX is missing", len("KX="))


# files that are no decks

GOOD = "NODES\n 1 0 0 FIX=XYR\n 2 0 3\nELEMENTS\n 1 COL 1 2\nPROPS\n COL SPRING KX=1\nANALYSIS\n STATIC\n"


def read_bytes(tmp_path, catalog, data, **more):
    path = tmp_path / "deck.inp"
    path.write_bytes(data)
    return read_deck(str(path), catalog, **more)


def codes(reading):
    return [d.code for d in reading[1]]


def test_latin_1_is_read_with_a_warning(tmp_path, catalog):
    model, found, _ = read_bytes(tmp_path, catalog, b"TITLE Caf\xe9\r\n" + GOOD.encode())
    assert model.title == "Café"
    assert [(d.code, d.severity, d.span.line, d.span.column) for d in found] == [("P101", "warning", 1, 10)]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_line_ends_and_byte_order_mark(tmp_path, catalog, end, mark):
    reading = read_bytes(tmp_path, catalog, mark + GOOD.rstrip().replace("\n", end).encode())
    assert codes(reading) == []
    assert reading[0].nodes[2].y == 3


def test_tabs_and_missing_last_line_end(tmp_path, catalog):
    reading = read_bytes(tmp_path, catalog, GOOD.replace(" ", "\t").rstrip().encode())
    assert codes(reading) == [] and len(reading[0].elements) == 1


@pytest.mark.parametrize("data", [b"\x00\x01\x02", GOOD.encode("utf-16"), b"NODES\n\0"])
def test_binary(tmp_path, catalog, data):
    assert codes(read_bytes(tmp_path, catalog, data)) == ["P102"]


@pytest.mark.parametrize("head", ["<!DOCTYPE html>\n", "\n <html lang=en>", '<?xml version="1.0"?>'])
def test_web_page(tmp_path, catalog, head):
    assert codes(read_bytes(tmp_path, catalog, (head + "<body>it's</body>").encode())) == ["P103"]


def test_fifty_megabytes_end_at_once(tmp_path, catalog):
    path = tmp_path / "deck.inp"
    with path.open("wb") as stream:
        stream.seek(50_000_000)
        stream.write(b"1")
    reading = read_deck(str(path), catalog)
    assert codes(reading) == ["P104"]
    assert sum(map(len, reading[2].values())) <= MAX_BYTES


def test_missing_deck_is_an_oserror(tmp_path, catalog):
    with pytest.raises(FileNotFoundError):
        read_deck(str(tmp_path / "none.inp"), catalog)
    with pytest.raises(OSError):
        read_deck(str(tmp_path), catalog)


def test_deep_includes(tmp_path, catalog):
    for k in range(MAX_DEPTH + 2):
        (tmp_path / f"{k}.inp").write_text(f'INCLUDE "{k + 1}.inp"\n')
    assert codes(read_deck(str(tmp_path / "0.inp"), catalog)) == ["P107"]


def test_includes_that_multiply(tmp_path, catalog):
    for k in range(9):
        (tmp_path / f"{k}.inp").write_text(f'INCLUDE "{k + 1}.inp"\n' * 9)
    (tmp_path / "9.inp").write_text("")
    assert set(codes(read_deck(str(tmp_path / "0.inp"), catalog))) == {"P107"}


def test_line_too_long(tmp_path, catalog):
    line = "WEIGHTS\n 1," + "1," * (MAX_LINE // 2) + "1 5\n"
    assert codes(read_bytes(tmp_path, catalog, (GOOD + line).encode())) == ["P110"]


@pytest.mark.full
def test_ten_thousand_brackets_signs_and_terms(catalog):
    for text, code in (
        ("(" * 10_000 + "1" + ")" * 10_000, ["P204"]),
        ("(" * 10_000, ["P204"]),
        ("-" * 10_000 + "1", []),
        ("1" + "+1" * 10_000, []),
        ("1" + "^1" * 10_000, []),
    ):
        assert codes(read_text(f"PARAM a = {text}\n" + GOOD, catalog)) == code


@pytest.mark.full
def test_ten_thousand_params_in_a_chain(catalog):
    chain = "".join(f"PARAM a{k} = a{k + 1}+1\n" for k in range(10_000)) + "PARAM a10000 = 0\n"
    assert read_text(chain + GOOD, catalog)[0].params["A0"] == 10_000


# --set


@pytest.mark.parametrize(
    ("override", "code"),
    [
        ({"m": "5"}, "P232"),
        ({"n": "abc"}, "P222"),
        ({"n": '"text"'}, "P233"),
        ({"n": "1 2"}, "P233"),
        ({"n": ""}, "P233"),
    ],
)
def test_bad_overrides(catalog, override, code):
    _, found, files = read_text("PARAM n = 2\n" + GOOD, catalog, override)
    assert [d.code for d in found] == [code]
    assert found[0].span.file in files and "--set" in caret(found[0], files)


# the printer


def test_caret_stays_aligned_behind_tabs(catalog):
    _, found, files = read_text(GOOD.replace(" COL SPRING", "\tCOL\tSPRING\t"), catalog)
    assert not found
    _, found, files = read_text(GOOD.replace("KX=1", "\tKX=oops"), catalog)
    _, line, under, _ = caret(found[0], files).split("\n")
    assert under.index("^") == line.index("oops") and under.count("\t") == line[: line.index("oops")].count(
        "\t"
    )
    assert under.strip() == "^~~~"


def test_long_lines_are_cut_around_the_caret(catalog):
    _, found, files = read_text("PARAM a = " + "1+" * 5000 + "oops" + "+1" * 5000 + "\n" + GOOD, catalog)
    _, line, under, *_ = caret(found[0], files).split("\n")
    assert len(line) < 200 and line[under.index("^") :].startswith("oops")


def test_render_stops_at_fifty(catalog):
    _, found, files = read_text(GOOD + "WEIGHTS\n" + " 1 oops\n" * 80, catalog)
    assert render(found, files).endswith("and 30 more")


@pytest.mark.parametrize(
    ("word", "told"),
    [("MY", "did you mean MI or MJ?"), ("ALFFA", "did you mean ALFA?"), ("Q", ""), ("QQQQ", "")],
)
def test_a_name_is_answered_with_those_that_are_like_it(word, told):
    assert suggest(word, ("E", "A", "MI", "MJ", "KH", "ALFA")) == told


def test_of_many_that_begin_alike_none_is_offered():
    assert suggest("MY", [f"M{x}" for x in "ABCDEFGH"]) == ""
