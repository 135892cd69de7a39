"""Pushovers that turn, several of them in one deck, their loops and backbones."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from decks import hinged_frame, model_of
from pound_solve import run
from pound_solve.analyses import cycles, pushover, pushover_checks, static
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import drive
from pound_solve.results import Results
from pound_solve.structure.assembly import assemble

STOREY = """
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 A 1 2
PROPS
 A SPRING KX=100 FX=5 RULE={rule}
WEIGHTS
 2 19.62
"""


def pushed(text: str, card: str) -> pushover.PushoverResult:
    """Pushover of a deck by a card."""
    s = assemble(model_of(f"{text}\nANALYSIS\n PUSHOVER {card}\n"))
    assert not pushover_checks.mistaken_cards(s)
    state = static.solve(s)
    return pushover.push(s.stressed(state.axial), state, s.model.analyses[0])


def ran(folder: Path, text: str) -> Results:
    deck = folder / "deck.inp"
    deck.write_text(text)
    return run(deck, out=folder)


def messages(text: str, card: str) -> list[str]:
    s = assemble(model_of(f"{text}\nANALYSIS\n PUSHOVER {card}\n"))
    return [d.message for d in pushover_checks.mistaken_cards(s)]


# loops by hand


def test_loops_of_a_plastic_storey() -> None:
    """Yield at 0.05 by 5. A full cycle of the amplitude a loses 4 * 5 (a - 0.05); its equivalent damping is
    2/pi (1 - 0.05/a).
    """
    p = pushed(STOREY.format(rule="ELASTO_PLASTIC"), "2 0.1,0.2 CYCLES=2 STEPS=3")
    assert [pts[-1].displacement for pts in p.points_of_legs()] == pytest.approx(
        [0.1, -0.1] * 2 + [0.2, -0.2] * 2
    )
    found = cycles.legs(p)
    assert all(math.isnan(leg.loop) and math.isnan(leg.damping) for leg in found[:2])
    for leg, amplitude in zip(found[2:4] + found[6:], [0.1] * 2 + [0.2] * 2):
        assert leg.loop == pytest.approx(4 * 5 * (amplitude - 0.05), rel=1e-12)
        assert leg.damping == pytest.approx(2 / math.pi * (1 - 0.05 / amplitude), rel=1e-12)
        assert leg.stiffness == pytest.approx(5 / amplitude, rel=1e-12)
    # from -0.1 to 0.2 and back to -0.2: no leg ends where the one before it began
    assert all(math.isnan(leg.loop) for leg in found[4:6])


def test_what_is_no_cycle_has_no_loop() -> None:
    rising = pushed(STOREY.format(rule="ELASTO_PLASTIC"), "2 0.05,0.1,0.2,0.4 STEPS=2")
    assert all(math.isnan(leg.loop) for leg in cycles.legs(rising))


def test_a_shear_that_falls_with_the_displacement_has_no_damping() -> None:
    """P-Delta beyond zero shear: at its largest displacement the column leans on its load."""
    deck = """
GEOMETRY PDELTA
NODES
 1 0 0 FIX=XYR
 2 0 0 SLAVED=XY MASTER=1
 3 0 4
ELEMENTS
 1 FOOT 1 2
 2 COL 2 3
PROPS
 FOOT SPRING KR=2000 MR=20 RULE=ELASTO_PLASTIC
 COL FRAME E=2e8 A=1 I=0.1
LOADS
 3 0 -200
"""
    p = pushed(deck, "3 0.3 CYCLES=2 PATTERN=FORCES NODES=3 FORCES=1 STEPS=4")
    last = cycles.legs(p)[-1]
    assert last.loop > 0.0 and last.stiffness < 0.0 and math.isnan(last.damping)


def test_an_elastic_storey_has_no_loop() -> None:
    p = pushed(STOREY.format(rule="ELASTO_PLASTIC"), "2 0.04 CYCLES=3 STEPS=5")
    for leg in cycles.legs(p)[2:]:
        assert leg.loop == leg.damping == 0.0 and leg.stiffness == pytest.approx(100.0, rel=1e-13)
    assert [b.cycles for b in cycles.backbone(p)] == [3, 3]


def test_a_contact_that_closes_has_no_loop() -> None:
    """An elastic storey that meets a wall on one side: its curve bends, but comes back on itself."""
    text = STOREY.format(rule="ELASTO_PLASTIC").replace(" 1 A 1 2", " 1 A 1 2\n 2 WALL 2")
    text = text.replace("WEIGHTS", " WALL CONTACT GAP=0.02 LAW=LINEAR K=300\nWEIGHTS")
    p = pushed(text, "2 0.04 CYCLES=2 STEPS=7")
    found = cycles.legs(p)
    assert abs(p.points_of_legs()[0][-1].shear) != pytest.approx(
        abs(p.points_of_legs()[1][-1].shear), rel=0.1
    )
    assert all(leg.loop == leg.damping == 0.0 for leg in found[2:])


def test_the_backbone_joins_the_first_ends_of_each_amplitude() -> None:
    """An IMK spring that loses strength with its work: the second cycle reaches less than the first."""
    rule = "IMK_BILINEAR R=0.05 DP=3 DPC=8 RESIDUAL=0.2 LAMBDA=20"
    p = pushed(STOREY.format(rule=rule), "2 0.06,0.1 CYCLES=3 STEPS=5")
    points = cycles.backbone(p)
    assert [x.first.displacement for x in points] == pytest.approx([-0.1, -0.06, 0.06, 0.1])
    assert [(x.first.leg, x.last.leg, x.cycles) for x in points] == [
        (8, 12, 3), (2, 6, 3), (1, 5, 3), (7, 11, 3)
    ]  # fmt: skip
    for x in points:
        assert abs(x.last.shear) < abs(x.first.shear) * 0.999


def test_targets_are_visited_in_their_order() -> None:
    card = "2 0.1,-0.05,0.15 STEPS=2"
    p = pushed(STOREY.format(rule="BILINEAR R=0.1"), card)
    assert [pts[-1].displacement for pts in p.points_of_legs()] == pytest.approx(
        [0.1, -0.05, 0.15], rel=1e-13
    )
    # 5 + 10 * 0.05; back elastic over 0.1, then with 10; forth elastic over 0.1, then with 10
    assert [pts[-1].shear for pts in p.points_of_legs()] == pytest.approx([5.5, -5.0, 6.0], rel=1e-12)
    assert p.end == "the target displacement is reached" and p.unbalanced < 1e-14


def test_a_displacement_that_begins_off_zero() -> None:
    """A static load of 2 displaces the storey by 0.02; targets count from the unloaded position."""
    p = pushed(STOREY.format(rule="ELASTO_PLASTIC") + "LOADS\n 2 2\n", "2 0.04,-0.01,0.04 STEPS=1")
    assert [x.displacement for x in p.curve] == pytest.approx([0.02, 0.04, 0.04, -0.01, -0.01, 0.04])
    # the first end beyond the static 0.02 is 0.04, the other -0.01
    assert [b.first.displacement for b in cycles.backbone(p)] == pytest.approx([-0.01, 0.04])


# against the laws, and against another program

RULES = [f"{x.name} {x.sample}" for x in catalog().family("hysteresis").values() if x.impl is not None]


@pytest.mark.parametrize("rule", RULES)
def test_one_spring_shows_its_loops(rule: str) -> None:
    """The curve of a spring is its law driven alone along the same path, of every rule."""
    deck = f"NODES\n 1 0 0 FIX=YR\nELEMENTS\n 1 A 1\nPROPS\n A SPRING KX=1 FX=1 RULE={rule}\n"
    p = pushed(deck, "1 1.5,-2,4,-4,4 PATTERN=FORCES NODES=1 FORCES=1 STEPS=8")
    assert p.failed is None and p.unbalanced < 1e-12, p.end
    (spring,) = assemble(model_of(deck)).laws
    law, state, now = spring.law, spring.law.start(), 0.0
    corners = {x.displacement for x, _ in p.ladder}
    for points in p.points_of_legs():
        for x in points[1:]:
            if x.displacement in corners:
                continue
            force = law.force(drive(law, state, now, x.displacement), x.displacement)[0]
            assert x.shear == pytest.approx(force, rel=1e-9, abs=1e-9)
        end = points[-1].displacement
        state, now = drive(law, state, now, end), end


def test_cycles_against_opensees() -> None:
    """The frame of `hinged_frame` pushed to and fro: OpenSees 3.7.1, benchmarks/opensees_pushover.py."""
    p = pushed(
        hinged_frame(), "301 0.1,-0.05,0.3,0,0.35 PATTERN=FORCES NODES=101,201,301 FORCES=1/6,2/6,3/6"
    )
    shears = [points[-1].shear for points in p.points_of_legs()]
    assert shears == pytest.approx([1027.2765, -679.18926, 1810.7987, -705.12881, 1977.3309], rel=7e-7)


def test_a_leg_may_have_as_many_changes_as_a_path() -> None:
    """The largest number of changes counts between two turns."""
    p = pushed(STOREY.format(rule="ELASTO_PLASTIC"), "2 0.2 CYCLES=400 STEPS=1")
    assert p.failed is None and p.curve[-1].leg == 800
    assert p.curve[-1].changes == 1 + 2 * 799


# several in one deck

TWO = (
    STOREY.format(rule="ELASTO_PLASTIC")
    + """ANALYSIS
 PUSHOVER 2 0.2 STEPS=4
 PUSHOVER 2 0.1,-0.1,0.1 STEPS=4
"""
)


def test_several_pushovers_begin_at_one_state(tmp_path: Path) -> None:
    results = ran(tmp_path, TWO)
    assert results.status == "done"
    curve = results.table("capacity_curve")
    one, two = (curve[curve["push"] == n] for n in (1, 2))
    assert one["displacement"][0] == two["displacement"][0] == 0.0
    assert one["displacement"][-1] == pytest.approx(0.2) and two["leg"].tolist()[-1] == 3
    loops, outer = results.table("push_legs"), results.table("backbone")
    assert loops["push"].tolist() == [2] * 3 and loops["loop"][-1] == pytest.approx(4 * 5 * 0.05)
    assert loops["largest"].tolist() == pytest.approx([5.0, -5.0, 5.0]) and outer["ratio"].tolist() == [
        1.0,
        1.0,
    ]
    assert outer["displacement"].tolist() == pytest.approx([-0.1, 0.1]) and outer["times"].tolist() == [
        1,
        2,
    ]
    assert results.table("capacity_line")["push"].tolist() == [1]
    events = results.table("push_events")
    assert events["event"].tolist() == [1, 1, 2, 3, 4, 5]
    report = (tmp_path / "deck.rpt").read_text()
    assert "CYCLES OF THE PUSHOVERS" in report and "BACKBONE OF THE CYCLES" in report


def test_an_unbalanced_force_of_any_of_them_is_checked(tmp_path: Path) -> None:
    results = ran(tmp_path, TWO)
    named = [c.name for c in results.checks if c.name.startswith("pushover")]
    assert len(named) == 2


def test_a_path_that_ends_between_turns_keeps_its_legs() -> None:
    """The spring snaps back on the way to the second amplitude: the first two ends stay on the backbone."""
    row = """
NODES
 1 0 0 FIX=YR
 2 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 1 2
PROPS
 A SPRING KX=100 FX=10 RULE=BILINEAR R=-0.9
 B SPRING KX=50
"""
    p = pushed(row, "2 0.2,0.5 CYCLES=1 PATTERN=FORCES NODES=2 FORCES=1 STEPS=3")
    assert p.failed is not None and p.failed.code == "A507"
    assert [x.first.displacement for x in cycles.backbone(p)] == pytest.approx([-0.2, 0.2])


def test_a_pushover_that_stops_does_not_keep_the_next_from_running(tmp_path: Path) -> None:
    """The first snaps back, the second has no first step, the third and the history run."""
    text = """
NODES
 1 0 0 FIX=YR
 2 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 1 2
PROPS
 A SPRING KX=100 FX=10 RULE=BILINEAR R=-0.9
 B SPRING KX=50
WEIGHTS
 1,2 9.81
INITIAL
 2 UX=0.01
ANALYSIS
 PUSHOVER 2 0.9 PATTERN=FORCES NODES=2 FORCES=1
 PUSHOVER 2 0 PATTERN=UNIFORM
 PUSHOVER 2 0.1 PATTERN=UNIFORM
 HISTORY 0.1
"""
    results = ran(tmp_path, text)
    assert results.status == "stopped"
    first, second = results.message.split("; ")[0], results.message.split("; ")[-1]
    assert first.startswith("A507 pushover 1: there is no further equilibrium without a jump")
    assert second == "A505 pushover 2: the control node stands at its target 0 already"
    assert sorted(set(results.table("capacity_curve")["push"].tolist())) == [1, 3]
    assert results.last_time == pytest.approx(0.1)


def test_pushovers_of_a_deck_have_numbers_in_checks_and_pictures(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from pound_solve.report import plot

    cards = "ANALYSIS\n PUSHOVER 2 0.1\n PUSHOVER 2 0.1,-0.1\n"
    with ran(tmp_path, STOREY.format(rule="ELASTO_PLASTIC") + cards) as results:
        checks = [c.split(",")[0] for c in results.table("checks")["check"] if c.startswith("pushover")]
        assert checks == ["pushover 1", "pushover 2"]
        titles = [axes.get_title()[:2] for axes in plot.picture(results, "capacity").axes]
    assert titles == ["1:", "2:"]


def test_a_card_that_is_included_twice_has_two_numbers(tmp_path: Path) -> None:
    (tmp_path / "push.inc").write_text(" PUSHOVER 2 0.2 STEPS=4\n")
    text = STOREY.format(rule="ELASTO_PLASTIC") + "ANALYSIS\n INCLUDE push.inc\n INCLUDE push.inc\n"
    curve = ran(tmp_path, text).table("capacity_curve")
    assert curve["push"].tolist() == [1] * (len(curve) // 2) + [2] * (len(curve) // 2)


def test_a_stop_of_a_pushover_is_told_beside_that_of_the_history(tmp_path: Path) -> None:
    text = (
        STOREY.format(rule="BILINEAR R=0.1")
        + "INITIAL\n 2 UX=0.01\nANALYSIS\n PUSHOVER 2 0\n HISTORY 1 {}\n"
    )
    message = ran(tmp_path, text.format("METHOD=CENTRAL DT=0.9")).message
    assert message.startswith("A505 pushover: the control node stands at its target 0 already; A5")


def test_cycles_that_stop_on_the_first_leg_are_no_push_to_one_target(tmp_path: Path) -> None:
    text = """
NODES
 1 0 0 FIX=YR
 2 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 1 2
PROPS
 A SPRING KX=100 FX=10 RULE=BILINEAR R=-0.9
 B SPRING KX=50
WEIGHTS
 1,2 9.81
ANALYSIS
 PUSHOVER 2 0.9 CYCLES=1 PATTERN=FORCES NODES=2 FORCES=1
"""
    results = ran(tmp_path, text)
    assert results.message.startswith("A507 pushover: ") and not len(results.table("capacity_line"))
    (leg,) = results.table("push_legs")
    assert leg["leg"] == 1 and not len(results.table("backbone"))


# mistakes


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("2 CONTROL=FORCE FACTOR=1 CYCLES=2", "CYCLES needs TARGET"),
        ("2 0.1,0.2 CONTROL=FORCE", "only a displacement can turn at several targets"),
        ("2 0.1 CYCLES=1 CONTROL=FORCE", "only a displacement can turn at several targets"),
        ("2 0.1,0.2 FACTOR=3", "FACTOR does not go with several targets"),
        ("2 0.1,0.2 TC=0.5", "the performance point belongs to one TARGET"),
        ("2 0.1,0.1", "TARGET 0.1 follows itself"),
        ("2 0 CYCLES=1", "TARGET 0 follows itself"),
        ("2 0.1 TC=0.5", "TC gives the performance point under a ground motion along X"),
    ],
)
def test_mistakes_are_told(card: str, message: str) -> None:
    assert messages(STOREY.format(rule="ELASTO_PLASTIC"), card) == [message]


def test_the_hint_on_equal_targets_knows_of_the_opposite_ones() -> None:
    for card, hint in (("2 0.1,-0.1 CYCLES=1", "opposite of each TARGET"), ("2 0.1,0.1", "that differ")):
        text = STOREY.format(rule="ELASTO_PLASTIC") + f"ANALYSIS\n PUSHOVER {card}\n"
        (found,) = pushover_checks.mistaken_cards(assemble(model_of(text)))
        assert hint in found.hint


def test_every_card_is_checked() -> None:
    text = (
        STOREY.format(rule="ELASTO_PLASTIC") + "ANALYSIS\n PUSHOVER 2 0.1,0.1\n PUSHOVER 2 CONTROL=FORCE\n"
    )
    found = pushover_checks.mistaken_cards(assemble(model_of(text)))
    assert [d.message for d in found] == [
        "TARGET 0.1 follows itself",
        "PUSHOVER has no end: it needs TARGET or FACTOR",
    ]
