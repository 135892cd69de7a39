"""Decks that are no files: texts and dictionaries, and where their results live."""

from __future__ import annotations

import gc
from pathlib import Path

import numpy as np
import pytest

from pound_solve import Deck, run
from pound_solve.driver.prepare import DeckError

TEXT = """TITLE A mass that meets a wall
UNITS kN m s
PARAM gap=0.01
NODES
  1  0  0  FIX=XYR
  2  3  0  FIX=YR
ELEMENTS
  1  COLUMN  1  2
  2  WALL  2
PROPS
  COLUMN  SPRING  KX=4000
  WALL  CONTACT  GAP=gap LAW=KELVIN_VOIGT K=1000000.0 E=0.65
WEIGHTS
  2  981
EQUAKE
  SINE  AMPLITUDE=2 PERIOD=1 DURATION=1
ANALYSIS
  HISTORY 1
"""
SECTIONS = {
    "TITLE": "A mass that meets a wall",
    "UNITS": "kN m s",
    "PARAM": {"gap": 0.01},
    "NODES": [(1, 0, 0, {"FIX": "XYR"}), (2, 3, 0, {"FIX": "YR"})],
    "ELEMENTS": [(1, "COLUMN", 1, 2), (2, "WALL", 2)],
    "PROPS": [
        ["COLUMN", "SPRING", {"KX": 4000}],
        ["WALL", "CONTACT", {"GAP": "gap", "LAW": "KELVIN_VOIGT", "K": 1e6, "E": np.float64(0.65)}],
    ],
    "WEIGHTS": [(np.int64(2), 981)],
    "EQUAKE": [("SINE", {"AMPLITUDE": 2, "PERIOD": 1, "DURATION": 1})],
    "ANALYSIS": ["HISTORY 1"],
}


def test_a_dictionary_is_the_text_that_it_says() -> None:
    assert Deck.from_sections(SECTIONS) == Deck.from_text(TEXT)


def test_items_are_written_as_a_deck_takes_them() -> None:
    path = Path("a folder") / "record.at2"
    rows = {"EQUAKE": [("RECORD", {"FILE": path})], "OUTPUT": [{"NODES": [1, 2, "11 TO 15"]}]}
    assert Deck.from_sections(rows).text == (
        f'EQUAKE\n  RECORD  FILE="{path}"\nOUTPUT\n  NODES=1,2,11 TO 15\n'
    )


@pytest.mark.parametrize("value", [None, True, {1, 2}, 1j])
def test_what_no_deck_holds_is_refused(value: object) -> None:
    with pytest.raises(TypeError, match="means nothing in a deck: it takes texts, numbers"):
        Deck.from_sections({"NODES": [(1, 0, value)]})


def test_text_dictionary_and_file_give_the_same_results(tmp_path: Path) -> None:
    (tmp_path / "wall.inp").write_text(TEXT)
    with run(tmp_path / "wall.inp") as file, run(SECTIONS) as sections, run(Deck(TEXT)) as text:
        for other in (sections, text):
            for name in file.histories:
                np.testing.assert_array_equal(other.history(name), file.history(name))
        assert text.text("<text>") == TEXT


def test_messages_name_line_and_column_of_the_text() -> None:
    with pytest.raises(DeckError, match=r"<text>:6:8: error P222: X takes a number, and q is") as err:
        run(Deck.from_text(TEXT.replace("  2  3  0", "  2    q 0")))
    assert "\n  2    q 0" in str(err.value)


def test_included_files_count_from_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "nodes.inc").write_text("NODES\n  1 0 0 FIX=XYR\n  2 3 0 FIX=YR\n")
    head, tail = TEXT.split("NODES\n")[0], "ELEMENTS\n" + TEXT.split("ELEMENTS\n")[1]
    with run(Deck(head + "INCLUDE nodes.inc\n" + tail)) as results:
        assert results.status == "done"


def test_without_a_folder_the_results_go_with_their_object() -> None:
    results = run(Deck(TEXT))
    folder = results.path.parent
    assert {path.name for path in folder.iterdir()} == {"deck.h5", "deck.rpt"}
    del results
    gc.collect()
    assert not folder.exists()


def test_a_deck_with_mistakes_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(DeckError):
        run(Deck("NODES\n"))
    assert not list(tmp_path.iterdir())


def test_results_take_the_name_that_is_given(tmp_path: Path) -> None:
    with run(Deck.from_text(TEXT, "wall"), out=tmp_path / "new") as results:
        assert results.path == tmp_path / "new" / "wall.h5"
    assert (tmp_path / "new" / "wall.rpt").is_file()


def test_a_second_run_leaves_the_open_results_of_the_first_alone(tmp_path: Path) -> None:
    first = run(Deck(TEXT), out=tmp_path)
    second = run(Deck(TEXT), {"gap": 0.002}, out=tmp_path)
    assert first.path == second.path
    with run(Deck(TEXT)) as alone, run(Deck(TEXT), {"gap": 0.002}) as other:
        for name in alone.histories:  # read only after the second run has ended
            np.testing.assert_array_equal(first.history(name), alone.history(name))
            np.testing.assert_array_equal(second.history(name), other.history(name))
        for found, expected in zip(first.table("collisions"), alone.table("collisions"), strict=True):
            np.testing.assert_equal(found.tolist(), expected.tolist())
        assert (first.history("contact/gap") != second.history("contact/gap")).any()
    first.close()
    second.close()
