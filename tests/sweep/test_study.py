"""What a study may say: its runs, and all of its mistakes in one pass, each at its place."""

import re

import pytest

from pound_solve.cli.main import main
from pound_solve.sweep.session import run_study
from pound_solve.sweep.study.document import Document, places
from pound_solve.sweep.study.study import StudyError, read
from sweep.small import DECK, STUDY, folder, record


def mistakes(path):
    """Code and line of every mistake, and the whole text."""
    with pytest.raises(StudyError) as caught:
        read(Document.read(str(path)))
    found = caught.value.diagnostics
    return [(d.code, d.span.line if d.span else 0) for d in found], str(caught.value)


def only(tmp_path, study, code, line, *words, deck=DECK):
    found, text = mistakes(folder(tmp_path, study, deck))
    assert (code, line) in found and len(found) == 1, text
    for word in words:
        assert word in text


def test_runs_are_decks_by_params_by_records_by_levels(tmp_path):
    runs = read(Document.read(str(folder(tmp_path)))).runs
    assert [r.number for r in runs] == list(range(1, 17))
    told = [(*dict(r.case.params).values(), r.shaking.record.name, r.shaking.scale) for r in runs]
    assert told[:5] == [
        ("0.01", "4000", "first.txt", 1.0),
        ("0.01", "4000", "first.txt", 2.5),
        ("0.01", "4000", "second.txt", 1.0),
        ("0.01", "4000", "second.txt", 2.5),
        ("0.01", "5000.5", "first.txt", 1.0),
    ]
    assert len({r.identity for r in runs}) == 16


def test_lists_side_by_side_and_a_file_of_cases(tmp_path):
    (tmp_path / "cases.csv").write_text("scale, record\n1, first.txt\n2, second.txt\n")
    study = 'deck = "wall.inp"\ncases = "cases.csv"\n[zip]\ngap = [0.01, 0.02]\nk = [1000, 2000]\n'
    runs = read(Document.read(str(folder(tmp_path, study)))).runs
    assert [tuple(v for _, v in r.case.params) for r in runs] == [
        ("0.01", "1000", "1", "first.txt"),
        ("0.01", "1000", "2", "second.txt"),
        ("0.02", "2000", "1", "first.txt"),
        ("0.02", "2000", "2", "second.txt"),
    ]
    assert all(r.shaking is None for r in runs)


def test_the_identity_is_that_of_contents_not_of_names(tmp_path):
    def identities(where, study=STUDY):
        return [r.identity for r in read(Document.read(str(folder(where, study)))).runs]

    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    own = identities(tmp_path / "a")
    assert identities(tmp_path / "b") == own
    record(tmp_path / "b/second.txt", 2.0, 0.9001)
    runs = read(Document.read(str(tmp_path / "b/walls.toml"))).runs
    same = [a == r.identity for a, r in zip(own, runs)]
    assert same == [r.shaking.record.name == "first.txt" for r in runs]
    assert not set(own) & set(identities(tmp_path / "b", 'tol = 1E-5\nmethod = "AUTO"\n' + STUDY))
    assert not set(own) & set(identities(tmp_path / "b", STUDY.replace("0.01, 0.02", "0.03, 0.04")))


def test_a_record_of_the_deck_itself_counts_in_the_identity(tmp_path):
    study = 'deck = "wall.inp"\n[grid]\nrecord = ["first.txt", "second.txt"]\n'
    before = [r.identity for r in read(Document.read(str(folder(tmp_path, study)))).runs]
    record(tmp_path / "second.txt", 2.1, 0.9)
    after = [r.identity for r in read(Document.read(str(tmp_path / "walls.toml"))).runs]
    assert before[0] == after[0] and before[1] != after[1]


def test_places_of_items_in_tables_lists_of_tables_and_dotted_keys():
    text = (
        'a = 1\n[grid]\n  gap = [\n  1,\n 2]\nx.y = 3\n[[motions]]\nfiles = 1\n[[motions]]\n"files" = 2\n'
    )
    found = {path: (s.line, s.column) for path, s in places(text, "f").items()}
    assert found == {
        ("a",): (1, 1),
        ("grid",): (2, 1),
        ("grid", "gap"): (3, 3),
        ("grid", "x", "y"): (6, 1),
        ("motions", 0): (7, 1),
        ("motions", 0, "files"): (8, 1),
        ("motions", 1): (9, 1),
        ("motions", 1, "files"): (10, 1),
    }


def test_all_mistakes_in_one_pass(tmp_path):
    study = """deck = "wall.inp"
wokers = 2
seconds = "long"
[grid]
gapp = [0.01]
k = ["stiff"]
[zip]
scale = [1, 2]
gap = [0.01]
[[motions]]
files = ["nothing*.txt", "first.txt"]
units = "G"
"""
    found, text = mistakes(folder(tmp_path, study))
    assert sorted(found) == [
        ("P222", 6), ("P232", 5), ("S602", 2), ("S602", 12), ("S603", 3), ("S604", 11), ("S605", 7),
    ], text  # fmt: skip
    assert "did you mean workers?" in text and "did you mean unit?" in text and "did you mean GAP?" in text


@pytest.mark.parametrize(
    ("study", "code", "line", "word"),
    [
        ('deck = "wall.inp"\n[grid\n', "S601", 2, "Expected"),
        (f'deck = "wall.inp"\nx = {"[" * 5000}{"]" * 5000}\n', "S601", 2, "too many brackets"),
        (f'deck = "wall.inp"\nx = {"{a=" * 5000}1{"}" * 5000}\n', "S601", 2, "too many brackets"),
        (f'deck = "wall.inp"\n{"a." * 5000}a = 1\n', "S601", 2, "more than 20 parts"),
        (f'deck = "wall.inp"\n[{"a." * 5000}a]\n', "S601", 2, "more than 20 parts"),
        (f'deck = "wall.inp"\nmemory = {"9" * 5000}\n', "S601", 2, "too many digits"),
        ('deck = "wall.inp"\nout = "\0"\n', "S601", 2, "Illegal character"),
        ('deck = "wall\\u0000.inp"\n', "S603", 1, "deck holds a zero character"),
        ('deck = "wall.inp"\nout = "a\\u0000"\n', "S603", 2, "out holds a zero character"),
        ('deck = "wall.inp"\ncases = "a\\u0000"\n', "S603", 2, "cases holds a zero character"),
        ('deck = "wall.inp"\ngrid = 3\n', "S603", 2, "grid is a table, not 3"),
        ('deck = "~nobody/wall.inp"\n', "S604", 1, "there is no deck"),
        ('decks = ["/nowhere/*.inp"]\n', "S604", 1, "no deck fits /nowhere/*.inp"),
        ('decks = ["a/**b"]\n', "S604", 1, "a/**b"),
        ("[grid]\ngap = [1]\n", "S604", 1, "names no deck"),
        ('deck = "wool.inp"\n', "S604", 1, "wool.inp"),
        ('decks = ["w*.dck"]\n', "S604", 1, "w*.dck"),
        ('deck = "wall.inp"\ncases = "none.csv"\n', "S604", 2, "none.csv"),
        ('deck = "wall.inp"\n[grid]\ngap = []\n', "S603", 3, "empty list"),
        ('deck = "wall.inp"\n[grid]\ngap = [true]\n', "S603", 3, "not true"),
        ('deck = "wall.inp"\n[grid]\ngap = [1]\n[zip]\nGAP = [2]\n', "S605", 5, "under grid"),
        ('deck = "wall.inp"\n[grid]\ngap = [0.01, 0.010]\n', "S605", 1, "runs 1 and 2 are the same"),
        ('deck = "wall.inp"\nworkers = 0\n', "S603", 2, "above zero"),
        ('deck = "wall.inp"\nseconds = nan\n', "S603", 2, "finite"),
        ('deck = "wall.inp"\ndt = nan\n', "S603", 2, "finite"),
        ('deck = "wall.inp"\nmethod = "NEWMARK"\ndt = 1e-40\n', "P217", 3, "magnitude"),
        ('deck = "wall.inp"\nmethod = "NEWMARK"\ndt = -1\n', "P217", 3, "DT is -1, but must be above 0"),
        ('deck = "wall.inp"\nmethod = "NEWMARK"\ndt = 1e-12\n', "P345", 3, "steps"),
        ('deck = "wall.inp"\nmethod = "NEWMARK"\n', "P213", 2, "NEWMARK needs DT"),
        ('deck = "wall.inp"\nmethod = "GUESS"\n', "P210", 2, "GUESS is no method"),
        ('deck = "wall.inp"\ndt = 0\n', "P217", 2, "DT is 0"),
        ('deck = "wall.inp"\ntol = 5\n', "P217", 2, "at most 0.1"),
        ('deck = "wall.inp"\nseconds = 1e29\n', "S603", 2, "at most 1e+08, not 1e+29"),
        ('deck = "wall.inp"\nmemory = -1\n', "S603", 2, "above zero"),
        (f'deck = "wall.inp"\nworkers = {10**26}\n', "S603", 2, "at most 10000"),
        (f'deck = "wall.inp"\nmemory = {"9" * 400}\n', "S603", 2, "finite"),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "first.txt"\nscale = [1, inf]\n', "S603", 4, "finite"),
        ('deck = "wall.inp"\nhistories = ["storey/drfit"]\n', "S602", 2, "storey/drift"),
        ('deck = "wall.inp"\n[[motions]]\nscale = 2\n', "S604", 2, "no files"),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "third.txt"\n', "R401", 3, "third.txt"),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "walls.toml"\n', "R402", 3, "walls.toml"),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "first.txt"\ndirection = "Y"\n', "S602", 4, "EQUAKE"),
        (
            'deck = "wall.inp"\n[[motions]]\nfiles = "first.txt"\nscale = 1\npga = 1\n',
            "S605",
            5,
            "beside scale",
        ),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "first.txt"\nsa = 0.1\n', "S605", 4, "period"),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "first.txt"\nperiod = 0.1\n', "S605", 4, "belongs to sa"),
        ('deck = "wall.inp"\n[[motions]]\nfiles = "first.txt"\nunit = "GALS"\n', "P210", 3, "GALS"),
        (
            'deck = "wall.inp"\n[grid]\nscale = [1, 2]\n[[motions]]\nfiles = "first.txt"\n',
            "S607",
            3,
            "replaces",
        ),
    ],
)
def test_a_mistake_is_told_at_its_place(tmp_path, study, code, line, word):
    only(tmp_path, study, code, line, word)


def test_a_record_in_another_unit_than_the_study_says_is_refused(tmp_path):
    head = (
        "PEER NGA\nx\ny\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=   3, DT=   .0100 SEC\n0.1 0.2 0.1\n"
    )
    (tmp_path / "peer.at2").write_text(head)
    study = 'deck = "wall.inp"\n[[motions]]\nfiles = "*.at2"\nunit = "GAL"\n'
    only(tmp_path, study, "S606", 4, "peer.at2 says that it is in G")


def test_mistakes_of_a_deck_are_told_with_its_own_lines(tmp_path):
    deck = DECK.replace("FIX=YR", "FIX=YQ").replace("K=1E6", "K=-1")
    found, text = mistakes(folder(tmp_path, STUDY, deck))
    assert len(found) == 2 and re.search(r"wall\.inp:7:\d+: error", text) and "wall.inp:13:" in text


def test_a_deck_with_two_motions_asks_for_params(tmp_path):
    deck = DECK.replace("SCALE=scale", "SCALE=scale\n   RECORD record DIRECTION=Y")
    found, text = mistakes(folder(tmp_path, STUDY, deck))
    assert found[0][0] == "R410" and "there are 2" in text and "PARAM" in text


def test_the_command_line_says_what_a_study_says(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(folder(tmp_path).parent)
    words = ["--motions", "first.txt", "--motions", "se*.txt", "--item", "UNIT=M/S2", "--scale", "1,2.5"]
    assert (
        main(
            [
                "sweep",
                "wall.inp",
                "--set",
                "gap=0.01,0.02",
                "--set",
                "k=4000,5000.5",
                *words,
                "--task",
                "0/2",
            ]
        )
        == 2
    )
    assert "--task 0/2" in capsys.readouterr().err
    assert main(["sweep", "wall.inp", "--set", "gapp=0.01", *words]) == 2
    assert re.search(r"--set gapp:1:1: error P232.*\n0\.01\n", capsys.readouterr().err)
    assert main(["sweep", "wall.inp", "--scale", "1"]) == 2
    assert "--scale belongs to --motions" in capsys.readouterr().err


def test_what_is_told_of_an_option_of_the_decks_stands_at_the_item_of_the_study(tmp_path):
    path = folder(tmp_path, 'deck = "wall.inp"\nmethod = "EXACT"\ndt = 0.1\n')
    assert f"{path}:3:1: warning P211: EXACT has no item DT" in read(Document.read(str(path))).warnings


def test_workers_of_python_have_the_limits_of_a_study(tmp_path):
    with pytest.raises(StudyError, match="workers is above zero and at most 10000, not -1"):
        run_study(folder(tmp_path), workers=-1)
