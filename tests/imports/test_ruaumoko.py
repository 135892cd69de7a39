"""Decks of Ruaumoko-2D: what comes of each item, on what ground, and where the mistakes stand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from imports.ruaumoko_decks import IN_SPACE, OSCILLATOR, PORTAL, STICK
from pound_deck.diagnostics import has_errors
from pound_deck.messages import MESSAGES
from pound_deck.reader import read_text
from pound_import.ruaumoko.equake import File
from pound_import.ruaumoko.importer import translate
from pound_import.ruaumoko.recognise import is_legacy
from pound_solve import run
from pound_solve.catalog import catalog
from pound_solve.cli.main import main
from pound_solve.driver.prepare import DeckError, prepare
from pound_solve.driver.request import Request
from pound_solve.results.sweep_file import Sweep

CATALOG = catalog()
RECORD = File("quake.txt", "\n".join("0.1" for _ in range(50)))


def read(text, *records, run=False):
    return translate("old.dat", text, CATALOG, records, run=run)


def model(text, *records):
    old = read(text, *records)
    assert not has_errors(old.report), old.report
    new, found, _ = read_text(old.text, CATALOG)
    assert new is not None, found
    return new


def codes(old):
    return [d.code for d in old.report if d.code != "L606"]


# ---------------------------------------------------------------------- recognised


@pytest.mark.parametrize("text", [STICK, OSCILLATOR, PORTAL, IN_SPACE])
def test_old_decks_are_recognised(text):
    assert is_legacy(text)
    assert is_legacy(text.replace("2 0 1 0 2 0 0 0 0 0 0", "2 0 l 0 2 0 0 0"))  # a slip, an item too few


@pytest.mark.parametrize(
    "text",
    [
        "",
        "TITLE x\nNODES\n 1 0 0 FIX=XYR\n 2 0 3\nELEMENTS\n 1 C 1 2\n",
        "NODES\n 1 0 0\n 2 0 3\n 3 0 4\nNODES\n",
        "one\n1 2 3 4 5 6 7 8\n1 2 3 4 5 6 7 8\n1 2 3 4 5 6 7 8\n1 2 3 4 5 6 7 8\n",
    ],
)
def test_others_are_not(text):
    assert not is_legacy(text)


def test_a_deck_in_space_is_refused_in_one_sentence():
    (found,) = read(IN_SPACE).report
    assert found.code == "L601" and "plane" in found.message


def test_what_is_no_old_deck():
    assert [d.code for d in read("NODES\n 1 0 0\n").report] == ["L610"]


# ---------------------------------------------------------------------- certain items


def test_every_certain_item():
    m = model(STICK)
    assert m.title == "Two storeys of springs" and m.gravity == 9.81
    assert (m.mass, m.geometry, m.units.length) == ("LUMPED", "SMALL", "m")
    assert [(n.x, n.y, n.fixed, dict(n.slaved)) for n in m.nodes.values()] == [
        (0.0, 0.0, "XYR", {}),
        (3.0, 0.0, "YR", {}),
        (6.0, 0.0, "YR", {}),  # KUP beside NF 0 has no effect
    ]
    assert [(e.prop, e.i, e.j) for e in m.elements.values()] == [("P1", 1, 2), ("P2", 2, 3)]
    lower, upper = m.props["P1"], m.props["P2"]
    assert (lower["KX"], lower["FX"], lower["R"]) == (6000.0, (12.0, -10.0), 0.05)
    assert lower["RULE"] == ("BILINEAR", "ELASTIC", "ELASTIC") and lower["ANGLE"] == "MEMBER"
    assert (upper["KX"], upper["RULE"]) == (5000.0, ("ELASTIC",))
    assert [(w["NODES"], w["WX"], w["WY"]) for w in m.weights] == [((2,), 98.1, 0.0), ((3,), 49.05, 0.0)]
    assert [(x["NODES"], x["FX"]) for x in m.loads] == [((3,), 0.5)]
    assert [(d["I"], d["J"]) for d in m.drifts] == [(1, 3)]
    (damping,) = m.damping
    assert (damping.spec.name, damping["XI"], damping["MODES"]) == ("MODAL", (0.05, 0.05), (1, 2))
    (motion,) = m.equake
    assert (motion["FILE"], motion["START"], motion["SCALE"]) == ("old.dat", 0.01, 1.0)
    assert [a.spec.name for a in m.analyses] == ["STATIC", "MODAL", "HISTORY"]
    history = m.analyses[-1]
    assert (history["T"], history["METHOD"], history["DT"]) == (0.4, "NEWMARK", 0.005)
    assert m.output["EVERY"] == 0.01
    assert codes(read(STICK, run=True)) == []


def test_rule_52():
    spring = model(OSCILLATOR).props["P1"]
    given = {name: spring[name] for name in ("R", "FCR", "RHO", "DULT", "ALFA", "PINCH")}
    assert given == {
        "R": 0.06,
        "FCR": (0.8, 0.7),
        "RHO": (0.6, 0.5),
        "DULT": (3.5, 3.0),
        "ALFA": 0.4,
        "PINCH": 0.3,
    }
    assert codes(read(OSCILLATOR, run=True)) == []


def test_the_record_behind_the_deck_acts_from_the_line_that_istart_counts(tmp_path):
    """Times of the file, not of the counters; the blank line within it ends nothing."""
    deck = tmp_path / "old.dat"
    deck.write_text(STICK)
    ready = prepare(Request(str(deck)))
    (motion,) = ready.motions
    t = np.array([0.0, 0.01, 0.04, 0.05, 0.29])
    assert motion.acceleration.value(t) == pytest.approx(
        [0.0, 0.3 * 9.81, -0.2 * 9.81, 0.1 * 9.81, -0.1 * 9.81], abs=1e-9
    )
    assert [d.code for d in ready.warnings] == ["L606", "P318", "R412"]  # the drift is level


def test_an_old_deck_runs_as_the_one_made_of_it(tmp_path, capsys):
    deck = tmp_path / "old.dat"
    deck.write_text(STICK)
    assert main(["import", str(deck), "-o", str(tmp_path / "new.inp")]) == 0
    assert "L606" in capsys.readouterr().err
    assert main([str(deck), "--quiet"]) == 0 and main([str(tmp_path / "new.inp"), "--quiet"]) == 0
    first, second = ((tmp_path / f"{stem}.rpt").read_text() for stem in ("old", "new"))
    cut = [report[report.index("NODE ENVELOPE") : report.index("ENERGY")] for report in (first, second)]
    assert cut[0] == cut[1]


# ---------------------------------------------------------------------- what rests on convention


def test_a_frame_is_imported_with_comments_and_not_run():
    old = read(PORTAL, RECORD)
    marked = [line for line in old.text.splitlines() if "BY CONVENTION" in line]
    assert set(codes(old)) == {"L605"} and len(marked) == len(codes(old)) + 1  # one line explains the mark
    m = model(PORTAL, RECORD)
    column, beam = m.props["P1"], m.props["P2"]
    assert (column["E"], column["A"], column["I"], column["END2"]) == (3e7, 0.16, 0.002, 0.2)
    assert (column["RULE"], column["R"], column["ALFA"], column["MI"]) == ("TAKEDA", 0.03, 0.5, (120, -120))
    assert (beam["RULE"], beam["M0"]) == ("ELASTIC", (30.0, -30.0))
    assert (m.mass, m.geometry) == ("CONSISTENT", "PDELTA")
    assert dict(m.nodes[3].slaved) == {"X": 2}
    assert [(d.spec.name, d["XI"], d["STIFFNESS"]) for d in m.damping] == [
        ("RAYLEIGH", (0.05, 0.03), "INITIAL")
    ]
    (motion,) = m.equake
    assert (motion["FILE"], motion["DT"], motion["SCALE"]) == ("quake.txt", 0.02, 0.5 / 9.81)
    ran = read(PORTAL, RECORD, run=True)
    assert has_errors(ran.report) and not ran.text
    assert "IBERG 6" in next(d.message for d in ran.report if d.code == "L606")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("2 0 1 0 2 0 0 0", "2 0 0 0 2 0 0 0", "stay elastic"),
        ("2 0 1 0 2 0 0 0", "2 0 1 0 3 0 0 0", "BEYOND=CONSTANT"),
        ("2 0 1 0 2 0 0 0", "1 0 1 0 2 0 0 0", "static and modal"),
        ("2 3.0 0.0 0 1 1 0 0 0 0\n", "", "evenly between 1 and 3"),
        ("1 1 1 2\n2 2 2 3", "2 1 1 2", "member 2 does not follow 0"),
        ("WEIGHTS 0", "WEIGHTS 1", "masses"),
        ("6000 0 0", "6000 100 0", "makes no moment"),
        ("3 1 0.01 1 -1", "3 1 0.01 1 0.2", "cut at this time"),
    ],
)
def test_conventions(old, new, words):
    assert old in STICK
    found = read(STICK.replace(old, new))
    assert any(words in d.message for d in found.report), found.report


@pytest.mark.parametrize(
    ("code", "line", "items"),
    [
        (1, "2 6 0.5", {"ILOS": "EACH", "DUCT3": None, "RCYC": None}),
        (2, "2 6 0.5 9 0", {"ILOS": "CYCLES", "DUCT3": 9.0}),
        (3, "2 6 0.5 9 4", {"ILOS": "LARGEST", "DUCT3": 9.0, "RCYC": None}),
        (4, "2 6 0.5 0 4", {"ILOS": "EACH_RCYC", "DUCT3": None, "RCYC": 4.0}),
        (5, "2 6 0.5 9 4", {"ILOS": "EACH_SUDDEN", "DUCT3": 9.0, "RCYC": 4.0}),
        (5, "2 6 0.5 0 4", {"ILOS": "EACH_RCYC", "DUCT3": None, "RCYC": 4.0}),
        (6, "2 6 0.5 9", {"ILOS": "LARGEST_RCYC", "DUCT3": 9.0, "RCYC": 0.0}),
        (7, "2 6 0.5 9 4", {"ILOS": "LARGEST_SUDDEN", "DUCT3": 9.0, "RCYC": 4.0}),
    ],
)
def test_losses_of_strength(code, line, items):
    text = STICK.replace("1 2 0 0 6000", f"1 2 {code} 0 6000").replace(
        "12 -10 0 0 0 0", f"12 -10 0 0 0 0\n{line}"
    )
    card = model(text).props["P1"]
    wanted = {"DUCT1": 2.0, "DUCT2": 6.0, "RDUCT": 0.5} | items
    assert {name: card[name] for name in wanted} == wanted
    assert "L605" in codes(read(text))


@pytest.mark.parametrize(
    ("rule", "line", "items"),
    [
        (5, "0.1 -0.1 0", {"SLACK": (0.1, -0.1), "GROW": "YES"}),
        (52, "1 0.1 0.9 0.9 0.8 0.8 3 3 0\n0.4 0 0.3 0.3 0 0", {"FCR": (0.9, 0.9), "PINCH": 0.3}),
    ],
)
def test_losses_of_rules_that_lose_by_each_direction_only(rule, line, items):
    lines = "\n".join(["12 -10 0 0 0 0", "2 6 0.5", *[line] * 3])
    text = STICK.replace("12 -10 0 0 0 0", lines)
    card = model(text.replace("1 2 0 0 6000", f"1 {rule} 1 0 6000")).props["P1"]
    wanted = {"ILOS": "EACH", "DUCT1": 2.0, "DUCT2": 6.0, "RDUCT": 0.5, "DUCT3": None} | items
    assert {name: card[name] for name in wanted} == wanted
    report = read(text.replace("1 2 0 0 6000", f"1 {rule} 3 0 6000")).report
    (d,) = (d for d in report if d.code == "L604")
    assert d.message.startswith("ILOS, item 3 of the line, is 3") and d.hint == "write 0 or 1"


def test_matsushima():
    text = STICK.replace("1 2 0 0 6000", "1 28 0 0 6000")
    card = model(text.replace("12 -10 0 0 0 0", "12 -10 0 0 0 0" + "\n0.9 0.8" * 3)).props["P1"]
    assert (card["RULE"][0], card["ALFA"], card["BETA"]) == ("MATSUSHIMA", 0.9, 0.8)


def test_losses_that_are_refused():
    for rule, code, line in ((2, 8, "2 6 0.5"), (9, 1, "2 6 0.5\n20 2 0 1 0 0 1 0 0")):
        text = STICK.replace("1 2 0 0 6000", f"1 {rule} {code} 0 6000")
        found = codes(read(text.replace("12 -10 0 0 0 0", f"12 -10 0 0 0 0\n{line}")))
        assert "L604" in found, rule


def test_a_node_follows_a_node_of_its_own_in_each_direction():
    assert "2 3.0 0.0 0 1 1 0" in STICK
    two = STICK.replace("2 3.0 0.0 0 1 1 0", "2 3.0 0.0 2 2 1 1 3")
    assert dict(model(two).nodes[2].slaved) == {"X": 1, "Y": 3}
    told = [d.message for d in read(two).report if "follows" in d.message]
    assert [m.split("node 2 ")[1] for m in told] == [
        "follows 1 along X with a rigid arm",
        "follows 3 along Y with a rigid arm",
    ]


def test_generated_nodes_lie_evenly():
    text = STICK.replace("2 3.0 0.0 0 1 1 0 0 0 0\n", "").replace("1 0.0 0.0 1 1 1", "1 0.0 0.0 0 1 1")
    m = model(text.replace("3 6.0 0.0 0 1 1 2 0", "3 6.0 1.0 0 1 1 0 0"))
    assert (m.nodes[2].x, m.nodes[2].y, m.nodes[2].fixed) == (3.0, 0.5, "YR")


# ---------------------------------------------------------------------- mistakes at their places


@pytest.mark.parametrize(
    ("old", "new", "code", "place"),
    [
        ("3 2 2 2 1 2 9.81", "3 2 2 2 1 2 g", "L603", (4, 13)),
        ("3 2 2 2 1 2 9.81 5.0 5.0 0.005", "3 2 2 2 1 2 9.81 5.0 5.0 0", "L603", (4, 26)),
        ("3 2 2 2 1", "3.5 2 2 2 1", "L603", (4, 1)),
        ("3 2 2 2 1 2 9.81 5.0 5.0 0.005 0.4 1.0", "3 2 2 2 1 2", "L602", (4, 1)),
        ("2 0 1 0 2 0 0", "2 0 1 0 4 0 0", "L604", (3, 9)),
        ("2 0 1 0 2 0 0", "7 0 1 0 2 0 0", "L604", (3, 1)),
        ("2 0 1 0 2 0 0", "2 1 1 0 2 0 0", "L604", (3, 3)),
        ("2 3.0 0.0 0 1 1", "2 3.0 0.0 5 1 1", "L604", (10, 11)),
        ("3 6.0 0.0", "4 6.0 0.0", "L608", (11, 1)),
        ("2 2 2 3", "2 2 2 9", "L608", (18, 7)),
        ("2 2 2 3", "2 3 2 3", "L608", (18, 3)),
        ("1 2 0 0 6000", "1 45 0 0 6000", "L604", (22, 3)),
        ("1 2 0 0 6000", "2 2 0 0 6000", "L604", (22, 1)),
        ("2 SPRING", "2 WALL", "L604", (24, 3)),
        ("3 49.05 0 0", "8 49.05 0 0", "L608", (29, 1)),
        ("3 1 0.01 1 -1", "3 9 0.01 1 -1", "L608", (36, 3)),
        ("3 1 0.01 1 -1", "2 1 0.01 1 -1", "L604", (36, 1)),
        ("3 1 0.01 1 -1", "3 1 0.01 0 -1", "L603", (36, 10)),
        ("3 1 0.01 1 -1", "3 1 0.01 1e-320 -1", "L603", (36, 10)),
        ("ELEMENTS 0", "! gone", "L607", (1, 1)),
        ("WEIGHTS 0", "NODES", "L607", (27, 1)),
        ("2 0 1 0 2 0 0 0 0 0 0", "2 0 1 0 2 0 0 1 0 0 0", "L609", (3, 15)),
    ],
)
def test_a_mistake_stands_at_its_place(old, new, code, place):
    assert old in STICK
    found = [d for d in read(STICK.replace(old, new, 1)).report if d.code == code]
    assert place in [(d.span.line, d.span.column) for d in found], (
        found,
        read(STICK.replace(old, new, 1)).report,
    )
    assert all(d.hint for d in found)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("2 0 1 0 2 0 0", "2 0 1 0 4 0 0", "ICTYPE, item 5 of the line, is 4, a damping"),
        ("2 0 1 0 2 0 0", "2 0 1 x 2 0 0", "IPCONM, item 4 of the line, is 'x', not a number"),
        ("2 0 1 0 2 0 0", "2 0 1 3 2 0 0", "IPCONM, item 4 of the line, is 3"),
        ("2 0 1 0 2 0 0", "2 0 1 0 2 0 3", "INLGEO, item 7 of the line, is 3"),
        ("2 0 1 0 2 0 0", "2 1 1 0 2 0 0", "IFMT, item 2 of the line, is not 0"),
        ("9.81 5.0 5.0 0.005", "9.81 5.0 -5 0.005", "C2, item 9 of the line, is -5, a damping ratio"),
        ("9.81 5.0 5.0 0.005 0.4", "9.81 5.0 5.0 0.005 0", "TIME, item 11 of the line, is not above zero"),
        ("2 2 2 1 2 9.81", "2 2 2 1 1 9.81", "MODE1, item 5 of the line, is 1, and MODE2"),
        ("2 3.0 0.0 0 1 1", "2 3.0 0.0 0 3 1", "NF2, item 5 of the line, is 3"),
        ("2 3.0 0.0 0 1 1 0", "2 3.0 0.0 2 1 1 9", "KUP1, item 7 of the line, is 9, no node"),
        ("2 2 2 3", "2 5 2 3", "MT, item 2 of the line, is 5, a property set"),
        ("2 2 2 3", "2 2 2 9", "J, item 4 of the line, is 9, which NODES do not hold"),
        ("DRIFT\n1 3", "DRIFT\n1 9", "a node of DRIFT, item 2 of the line, is 9"),
        ("2 SPRING", "2 WALL", "TYPE, item 2 of the line, is WALL"),
        ("1 2 0 0 6000", "1 45 0 0 6000", "IHYST, item 2 of the line, is 45"),
        ("1 2 0 0 6000", "1 2 0 1 6000", "IDAMG, item 4 of the line, is 1"),
        ("3 49.05 0 0", "3 49.05 z 0", "WY, item 3 of the line, is 'z'"),
        ("3 1 0.01 1 -1", "3 9 0.01 1 -1", "ISTART, item 2 of the line, is 9, a counter"),
        ("3 1 0.01 1 -1", "2 1 0.01 1 -1", "IBERG, item 1 of the line, is 2, a format"),
        ("3 1 0.01 1 -1", "6 1 0 1 -1", "DELTAT, item 3 of the line, is not above zero"),
        ("3 1 0.01 1 -1", "3 1 0.01 0 -1", "ASCALE, item 4 of the line, is zero"),
        ("3 1 0.01 1 -1", "3 1 0.01 1 0.001", "END, item 5 of the line, is 0.001, not after the start"),
    ],
)
def test_a_mistake_of_an_item_names_it_with_its_position(old, new, told):
    """The position is that of the place, too."""
    assert old in STICK
    text = STICK.replace(old, new, 1)
    (d,) = (d for d in read(text).report if d.message.startswith(told))
    before = text.splitlines()[d.span.line - 1][: d.span.column - 1]
    assert f", item {len(before.split()) + 1} of the line, " in d.message


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("1 0 0 4 0 0 0 0 0", "3 0 0 4 0 0 0 0 0", "ITYPE, item 1 of the line, is 3"),
        ("1 0 0 4 0 0 0 0 0", "1 5 0 4 0 0 0 0 0", "IPIN, item 2 of the line, is 5"),
        ("1 0 0 4 0 0 0 0 0", "1 0 4 4 0 0 0 0 0", "ICOND, item 3 of the line, is 4"),
        ("1 0 0 4 0 0 0 0 0", "1 0 0 4 8 0 0 0 0", "ILOS, item 5 of the line, is 8"),
        ("1 0 0 4 0 0 0 0 0", "1 0 0 4 0 0 0 2 0", "IGA, item 8 of the line, is 2"),
    ],
)
def test_the_options_of_a_frame_are_named_with_their_positions(old, new, told):
    assert old in PORTAL
    text = PORTAL.replace(old, new, 1)
    if "ILOS" in told:
        text = text.replace("0 0 120 -120 120 -120", "0 0 120 -120 120 -120\n2 6 0.5")
    (d,) = (d for d in read(text, RECORD).report if d.message.startswith(told))
    before = text.splitlines()[d.span.line - 1][: d.span.column - 1]
    assert f", item {len(before.split()) + 1} of the line, " in d.message


@pytest.mark.parametrize(
    ("levels", "cure"),
    [
        (1, "NLEVEL stands in line 4, column 19: write 2 there"),
        (3, "NLEVEL stands in line 4, column 19: write 2 there, or list 3 nodes"),
    ],
)
def test_the_cure_of_a_list_of_drifts_does_not_lead_to_another_refusal(levels, cure):
    text = PORTAL.replace("0 10 10 0 1 5 1 1 2 2", f"0 10 10 0 1 5 1 1 {levels} 2")
    (told,) = (d for d in read(text).report if d.code == "L608")
    assert told.hint == cure
    cured = text.splitlines()
    cured[3] = f"{cured[3][:18]}2{cured[3][19:]}"
    assert "L608" not in codes(read("\n".join(cured)))


@pytest.mark.parametrize(
    ("listed", "levels", "told"),
    [
        ("1 2 3", 2, "DRIFT lists 3 nodes, and NLEVEL is 2"),
        ("1\n3", 3, "DRIFT lists 2 nodes, and NLEVEL is 3"),
        ("1", 2, "DRIFT lists 1 node, and NLEVEL is 2"),
        ("", 2, "DRIFT lists 0 nodes, and NLEVEL is 2"),
    ],
)
def test_a_list_of_drifts_of_another_length(listed, levels, told):
    text = STICK.replace("DRIFT\n1 3", f"DRIFT\n{listed}")
    text = text.replace("0 2 10 0 1 5 1 1 2 2", f"0 2 10 0 1 5 1 1 {levels} 2")
    (found,) = [d for d in read(text).report if d.severity == "error"]
    assert (found.code, found.message) == ("L608", told)
    assert f"line 5, column 18: write {len(listed.split())} there" in found.hint


@pytest.mark.parametrize(("wrong", "code"), [("9", "L608"), ("x", "L603"), ("0", "L608")])
def test_a_wrong_node_in_a_list_of_drifts_does_not_question_nlevel(wrong, code):
    text = STICK.replace("DRIFT\n1 3", f"DRIFT\n1 {wrong}")
    (found,) = [d for d in read(text).report if d.severity == "error"]
    assert (found.code, found.span.line, found.span.column) == (code, 14, 3)


def test_a_record_in_a_file_of_its_own_must_be_named():
    assert "L611" in codes(read(PORTAL))


def test_all_messages_of_old_decks_are_in_use():
    assert {c for c in MESSAGES if c.startswith(("L60", "L61"))} == {f"L6{n:02}" for n in range(1, 14)}


def test_a_mistake_of_the_model_is_told_at_the_old_line(tmp_path):
    deck = tmp_path / "old.dat"
    deck.write_text(STICK.replace("12 -10 0 0 0 0", "12 10 0 0 0 0"))
    with pytest.raises(DeckError) as caught:
        prepare(Request(str(deck)))
    (found,) = [d for d in caught.value.diagnostics if d.severity == "error"]
    assert (found.span.file, found.span.line) == (str(deck), 22)


def test_three_formats_of_separate_records():
    for code, items in (("0", {"FORMAT": "COLUMNS", "COLUMN": 0, "DT": 0.02}), ("1", {"FORMAT": "BERG"})):
        (motion,) = model(PORTAL.replace("6 1 0.02", f"{code} 1 0.02"), RECORD).equake
        assert {name: motion[name] for name in items} == items


def test_the_verb_refuses_what_it_cannot_read(tmp_path, capsys):
    deck = tmp_path / "old.dat"
    deck.write_text("NODES\n 1 0 0\n")
    assert main(["import", str(deck)]) == 2 and "L610" in capsys.readouterr().err
    deck.write_text(STICK)
    assert main(["import", str(deck), "-o", str(deck)]) == 2
    assert deck.read_text() == STICK
    assert main(["import", str(deck)]) == 0 and capsys.readouterr().out.startswith("TITLE Two storeys")
    assert main(["import", str(tmp_path / "none.dat")]) == 3


@pytest.mark.full
def test_motions_and_sweeps_read_old_decks_as_runs_do(tmp_path, capsys, monkeypatch):
    """One way to a deck: the motion of an old one becomes a file, and records take its place in a sweep."""
    monkeypatch.setenv("POUND_COMPILE", "0")
    deck = tmp_path / "old.dat"
    deck.write_text(STICK)
    assert main(["motions", str(deck), "--dt", "0.01", "-o", str(tmp_path / "suite")]) == 0
    assert len(list((tmp_path / "suite").glob("*.at2"))) == 1
    study = tmp_path / "old.toml"
    study.write_text('deck = "old.dat"\n[[motions]]\nfiles = ["suite/*.at2"]\nscale = [1, 2]\n')
    assert main(["sweep", str(study), "--workers", "1", "--quiet"]) == 0
    sweep = Sweep.open(tmp_path / "old.sweep/sweep.h5")
    assert sweep["status"].tolist() == ["done", "done"] and sweep["deck"].tolist() == ["old.dat"] * 2
    with run(deck, out=tmp_path) as results:
        (own,) = results.table("drift_envelope")
    peak = max(abs(own["max"]), abs(own["min"]))
    assert sweep["peak_drift"][0, 0] == pytest.approx(peak, rel=1e-6)  # the file has seven digits
    assert sweep["peak_drift"][1, 0] > 1.5 * peak


def test_a_mistake_in_an_old_deck_has_its_line_in_every_verb(tmp_path, capsys):
    deck = tmp_path / "old.dat"
    deck.write_text(STICK.replace("3 6.0 0.0", "3 6.y 0.0"))
    study = tmp_path / "old.toml"
    study.write_text('deck = "old.dat"\n[[motions]]\nfiles = ["elcentro 180"]\n')
    line = next(n for n, text in enumerate(deck.read_text().splitlines(), 1) if "6.y" in text)
    for words in (["motions", str(deck)], ["spectrum", str(deck)], ["sweep", str(study)]):
        assert main(words) == 2
        assert f"old.dat:{line}:" in capsys.readouterr().err, words


def test_the_page_shows_one_model_in_both_languages():
    page = (Path(__file__).parents[2] / "manual" / "coming-from-ruaumoko.md").read_text("utf-8")
    old, new = (block.lstrip("\n") for block in page.split("## 7.")[1].split("```")[1::2])
    ours, _, _ = read_text(new, CATALOG)
    theirs = model(old)
    assert ours
    nodes, elements, cards = (
        [select(m) for m in (ours, theirs)]
        for select in (
            lambda m: [(n.x, n.y, n.fixed) for n in m.nodes.values()],
            lambda m: [(e.prop, e.i, e.j) for e in m.elements.values()],
            lambda m: [*m.props.values(), *m.weights, *m.damping, *m.equake, *m.analyses, m.output],
        )
    )
    assert nodes[0] == nodes[1] and elements[0] == elements[1]
    for first, second in zip(*cards, strict=True):
        assert dict(first.values) == dict(second.values)
