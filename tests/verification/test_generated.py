"""Generated decks: the same from the same seed, with every rule and contact law of the catalog."""

from __future__ import annotations

import random
import re

import pytest

from pound_solve.catalog import catalog
from verification.generated import decks, laws

SEEDS = range(1, 61)


@pytest.fixture(scope="module")
def texts() -> list[str]:
    return [decks.deck(seed) for seed in SEEDS]


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
    words = "MU=", "MODAL", "STIFFNESS=TANGENT", "ALPHA=0.3", "PDELTA", "LARGE", "DRIFT", "GRAVITY=YES"
    for word in (*words, "MEMBER_LOADS", "SYNTHETIC", "SINE", "TOL=1E-2", "TOL=1E-4"):
        share = sum(word in text for text in texts) / len(texts)
        assert 0.03 < share < 0.97, (word, share)
    rows = {len(set(re.findall(r"^  (\d)000 ", text, re.MULTILINE))) for text in texts}
    assert rows == {2, 3}
