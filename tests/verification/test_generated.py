"""Generated decks: the same from the same seed, with every rule and contact law of the catalog."""

from __future__ import annotations

import re

import pytest

from pound_solve.catalog import catalog
from verification.generated import decks

SEEDS = range(1, 101)


@pytest.fixture(scope="module")
def texts() -> list[str]:
    return [decks.deck(seed) for seed in SEEDS]


def test_a_seed_gives_one_deck(texts: list[str]) -> None:
    assert decks.deck(SEEDS[3]) == texts[3] != texts[4]


def test_all_rules_and_contact_laws_of_the_catalog_occur(texts: list[str]) -> None:
    text = "".join(texts)
    for family, item in (("hysteresis", "RULE"), ("contact", "LAW")):
        wanted = {name for name, spec in catalog().family(family).items() if name != "ELASTIC"}
        assert set(re.findall(rf"{item}=(\w+)", text)) == wanted


def test_decks_differ_in_what_matters(texts: list[str]) -> None:
    words = "MU=", "MODAL", "STIFFNESS=TANGENT", "ALPHA=0.3", "PDELTA", "LARGE", "DRIFT", "GRAVITY=YES"
    for word in (*words, "MEMBER_LOADS", "SYNTHETIC", "SINE", "TOL=1E-2", "TOL=1E-4"):
        share = sum(word in text for text in texts) / len(texts)
        assert 0.03 < share < 0.97, (word, share)
    rows = {len(set(re.findall(r"^  (\d)000 ", text, re.MULTILINE))) for text in texts}
    assert rows == {2, 3}
