"""The verb `example`, the archives that carry the examples, and the main job without the records."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

from pound_solve.cli.main import main
from pound_solve.cli.verbs import example
from pound_solve.loading.records import known as module
from tiers import at_night

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
NAMES = sorted(path.parent.name for path in EXAMPLES.glob("*/README.md"))
LONG = "08_gap_suite"  #: makes motions that meet a spectrum


def test_every_folder_with_a_readme_is_listed_with_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["example"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert sorted(line.split()[0] for line in lines) == NAMES
    assert all(len(line.split()) > 4 for line in lines)


@pytest.mark.full
@pytest.mark.parametrize("name", [*(n for n in NAMES if n != LONG), *at_night(LONG)])
def test_an_example_is_written_whole_and_checks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    out = tmp_path / "a" / "b"
    assert main(["example", name, "-o", str(out)]) == 0
    commands = capsys.readouterr().out.splitlines()
    decks, notebooks = (
        [Path(line.removeprefix(how)) for line in commands if line.startswith(how)]
        for how in ("pound-solve ", "jupyter lab ")
    )
    assert decks == sorted(out.glob("*.inp")) and notebooks == sorted(out.glob("*.ipynb"))
    assert decks or notebooks
    for notebook in notebooks:
        assert notebook.read_bytes() == (EXAMPLES / name / notebook.name).read_bytes()
    for deck in decks:
        assert deck.read_bytes() == (EXAMPLES / name / deck.name).read_bytes()
        # what is not there can be a record alone, never an included file
        assert main(["check", str(deck)]) == 0 or "R401" in capsys.readouterr().err
    assert (out / "README.md").is_file()


def test_no_file_is_written_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = tmp_path / "two_oscillators.inp"
    own.write_text("mine")
    assert main(["example", "01_two_oscillators", "-o", str(tmp_path)]) == 3
    assert f"{own} exists already" in capsys.readouterr().err
    assert own.read_text() == "mine" and list(tmp_path.iterdir()) == [own]


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("cole2012", "did you mean cole2011"),
        ("portal", "02_portal_frame"),
        ("../frames", "frames"),
        ("q", "there are"),
    ],
)
def test_an_unknown_name(capsys: pytest.CaptureFixture[str], name: str, hint: str) -> None:
    assert main(["example", name]) == 2
    assert hint in capsys.readouterr().err


def test_the_folder_of_its_name_is_the_default(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["example", "frames"]) == 0
    assert (tmp_path / "frames" / "steel_10x3.inp").is_file()


def test_an_installation_without_examples(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(example, "FOLDERS", (tmp_path,))
    assert main(["example"]) == 3
    assert "install the package again" in capsys.readouterr().err


def test_the_main_job_without_the_package_of_records(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is missing, where it is had, and what runs without it; with the file of that name it runs."""
    monkeypatch.setattr(module.importlib.util, "find_spec", lambda name: None)
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    deck = str(EXAMPLES / "cole2011" / "distributed.inp")
    words = [deck, "--set", "n=2", "--set", "t=0.5", "--quiet", "-o", str(tmp_path / "out")]
    assert main(words) == 2
    told = capsys.readouterr().err
    for word in (
        "R401",
        "El Centro",
        "pound-solve[records]",
        "ngawest2.berkeley.edu",
        "--records",
        "pound-solve example",
    ):
        assert word in told, word
    (tmp_path / "RSN6_IMPVALL.I_I-ELC270.AT2").write_text(
        "PEER\nmade up\nACCELERATION IN UNITS OF G\nNPTS= 200, DT= .0100 SEC,\n" + " .1 -.1\n" * 100
    )
    assert main([*words, "--records", str(tmp_path)]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["wheel", "sdist"])
def test_an_archive_alone_writes_and_runs_an_example(tmp_path: Path, kind: str) -> None:
    """In an empty environment, away from the checkout; the registry of packages must be there."""
    plain = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}

    def call(*command: str | Path) -> str:
        done = subprocess.run(
            command, cwd=tmp_path, env=plain, check=True, stdout=subprocess.PIPE, text=True
        )
        return done.stdout

    call(sys.executable, "-m", "build", f"--{kind}", "--outdir", tmp_path / "dist", ROOT)
    (archive,) = (tmp_path / "dist").iterdir()
    venv.create(tmp_path / "empty", with_pip=True)
    folder = tmp_path / "empty" / ("Scripts" if os.name == "nt" else "bin")
    call(folder / "python", "-m", "pip", "install", "--quiet", archive)
    assert sorted(line.split()[0] for line in call(folder / "pound-solve", "example").splitlines()) == NAMES
    for name, deck in (("01_two_oscillators", "two_oscillators"), ("02_portal_frame", "earthquake")):
        call(folder / "pound-solve", "example", name)
        call(folder / "pound-solve", f"{name}/{deck}.inp", "--quiet")
        assert (tmp_path / name / f"{deck}.rpt").is_file()
