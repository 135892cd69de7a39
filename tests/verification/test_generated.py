"""Generated decks: the same from the same seed, with every rule and contact law of the catalog."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from kernels import FAST
from pound_solve.catalog import catalog
from tiers import at_night
from verification.generated import answers, campaign, decks, laws

SEEDS = range(1, 61)


@pytest.fixture(scope="module")
def texts() -> list[str]:
    return [decks.deck(seed) for seed in SEEDS]


@pytest.mark.full
def test_a_seed_gives_one_deck(texts: list[str]) -> None:
    assert decks.deck(SEEDS[3]) == texts[3] != texts[4]


def test_all_rules_and_contact_laws_of_the_catalog_occur() -> None:
    rng = random.Random(5)
    hinges = " ".join(laws.hysteresis(rng, 100.0, 0.01, False) for _ in range(800))
    contacts = " ".join(laws.contact(rng, 1e3, 1e-3, 1e6, False) for _ in range(800))
    for family, item, text in (("hysteresis", "RULE", hinges), ("contact", "LAW", contacts)):
        wanted = {name for name, spec in catalog().family(family).items() if name != "ELASTIC"}
        assert set(re.findall(rf"{item}=(\w+)", text)) == wanted


def test_decks_without_curved_laws_can_be_asked_for() -> None:
    straight = {s.name for family in ("hysteresis", "contact") for s in laws.choices(family, True)}
    assert {"TAKEDA", "KELVIN_VOIGT", "LAGRANGE"} <= straight
    assert straight.isdisjoint({"BOUC_WEN", "HERTZDAMP"})


def test_decks_differ_in_what_matters(texts: list[str]) -> None:
    words = (
        "MU=",
        "MODAL",
        "STIFFNESS=TANGENT",
        "ALPHA=0.3",
        "PDELTA",
        "LARGE",
        "DRIFT",
        "GRAVITY=YES",
        "CONSISTENT",
    )
    for word in (*words, "MEMBER_LOADS", "SYNTHETIC", "SINE", "TOL=1E-2", "TOL=1E-4"):
        share = sum(word in text for text in texts) / len(texts)
        assert 0.03 < share < 0.97, (word, share)
    rows = {len(set(re.findall(r"^  (\d)000 ", text, re.MULTILINE))) for text in texts}
    assert rows == {2, 3}


@pytest.mark.full
@FAST
@pytest.mark.parametrize("seed", at_night(107, 114, 0, 14))
def test_steps_of_auto_keep_their_tolerance_on_generated_decks(tmp_path: Path, seed: int) -> None:
    """Against TAYLOR, which has no truncation error, on decks that both solve."""
    deck = tmp_path / f"{seed}.inp"
    deck.write_text(decks.deck(seed), encoding="utf-8")
    truth, own = (answers.answer(deck, None, method, {}) for method in ("TAYLOR", answers.STEPS))
    assert truth.status == own.status == "done" and own.met and own.claimed is not None
    assert answers.errors(own, truth)["auto"] <= own.claimed <= 1e-2


@pytest.mark.parametrize("seed", [175, 177])
def test_hinges_at_rest_do_not_leave_their_branches_again_and_again(tmp_path: Path, seed: int) -> None:
    """Their deformations under gravity are rounding, which the first step changes by more than itself; or a
    slack without width takes the hold from their joints.
    """
    deck = tmp_path / "rest.inp"
    text, count = re.subn(r"HISTORY \d+ METHOD=AUTO TOL=\S+", "HISTORY 0.02", decks.deck(seed))
    assert count == 1
    deck.write_text(text, encoding="utf-8")
    assert answers.answer(deck, None, "NEWMARK", {"dt": 1e-3}).status == "done"


def made_up(seed: int, **more: object) -> dict[str, object]:
    """A row of a campaign."""
    return {
        "seed": seed, "mode": "AUTO", "tol": 1e-3, "status": "done", "message": "", "method": "NEWMARK",
        "claimed": 5e-4, "met": True, "unique": True, "seconds": 2.0, "reference": "TAYLOR",
        "uncertain": 0.0, "best": "TAYLOR", "best seconds": 1.0,
        "errors": dict.fromkeys(campaign.KINDS, 4e-4),
    } | more  # fmt: skip


def test_outcomes_of_a_campaign() -> None:
    above = {"errors": {"auto": 2e-3}}
    for more, outcome in (
        ({}, "right"),
        (above, "above"),
        (above | {"uncertain": 5e-4}, "unsure"),
        (above | {"met": False}, "not met, told"),
        (above | {"unique": False}, "not unique, told"),
        ({"status": "stopped", "errors": {}, "best": ""}, "stopped, another method ends"),
        ({"status": "timeout", "reference": ""}, "timeout, another method ends"),
    ):
        row = made_up(1, **more)
        assert campaign.outcome(row) == outcome, more
    assert campaign.outcome({"status": "stopped", "met": True}) == "stopped"
    rows = [made_up(n, outcome="right", seconds=float(n)) for n in (1, 2, 3)]
    said = campaign.summary(rows)
    assert "| right | NEWMARK | 3 |" in said
    assert "| error over TOL: auto | NEWMARK | 3 | 0.4 | 0.4 | 0.4 | 0.4 | 3, 2, 1 |" in said
    assert "| cost over that of the best | NEWMARK | 3 | 2 | 2.8 | 3 | 3 | 3, 2, 1 |" in said
    assert campaign.line(rows[0]).split()[:4] == ["1", "AUTO", "NEWMARK", "TOL"]
