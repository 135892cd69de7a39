"""Budgets of every kind of deck: what it imports, compiles and holds, pinned in processes of their own."""

import json
import os
import subprocess
import sys

import pytest

from pound_solve.catalog import FAMILIES, specs
from pound_solve.results import Results
from pound_solve.results.tables.figures.imports import LIBRARIES
from pound_solve.results.tables.reduced_system.arrays import stored
from tiers import at_night

pytestmark = pytest.mark.full

FRAME = """UNITS  kN m s
NODES
   1  0 0  FIX=XYR
   2  0 3
   3  4 3
ELEMENTS
   1  M 1 2
   2  M 2 3
PROPS
   M FRAME E=2E8 A=0.01 I=1E-4 {yields}
WEIGHTS
   2,3 100
LOADS
   3 0 -5
{rest}
ANALYSIS
   {analysis}
"""
SINE = "EQUAKE\n   SINE AMPLITUDE=1 PERIOD=0.5 DURATION=1"
HINGES = "RULE=BILINEAR R=0.05 MI=20 MJ=20 LP=0.3"
#: kinds of decks: what FRAME holds, and what the report calls it
KINDS = {
    "linear static": {"analysis": "STATIC"},
    "modal": {"analysis": "MODAL 2"},
    "linear history": {"analysis": "HISTORY 1", "rest": SINE},
    "piecewise linear history": {"analysis": "HISTORY 1", "rest": SINE, "yields": HINGES},
    "general history": {
        "analysis": "HISTORY 0.1 METHOD=NEWMARK DT=0.01",
        "rest": SINE + "\nGEOMETRY LARGE",
        "yields": HINGES,
    },
}
#: libraries that are slow to import, which no kind needs; but steps take numba where it is on
NUMERICS = {"scipy", "numba", "llvmlite"}
#: the folders of the methods, and those that kinds of decks need
FOLDERS = {"closed_form", "events", "kernels", "series", "stepping"}
STEPS = {"events", "kernels", "stepping"}
EXACT = {"closed_form", "events"}
ENGINES = {
    "linear history": EXACT,
    "piecewise linear history": EXACT
    | {"kernels"},  # hinges at joints without mass may turn at one instant
    "general history": STEPS,
}


def deck(folder, kind):
    path = folder / "deck.inp"
    path.write_text(FRAME.format(**({"yields": "", "rest": ""} | KINDS[kind])))
    return path


def run(path, *words, compiling="1"):
    """Run a deck in a process of its own: the modules that it imports, and what it prints."""
    return main([str(path), "--quiet", *words], compiling)


def main(words, compiling="1"):
    """Run the command line in a process of its own."""
    code = (
        "import json, sys; from pound_solve.cli.main import main\n"
        f"status = main({words!r})\n"
        "print(json.dumps([status, sorted(sys.modules)]))"
    )
    env = {**os.environ, "POUND_COMPILE": compiling}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=env)
    assert done.returncode == 0, done.stderr
    status, modules = json.loads(done.stdout.splitlines()[-1])
    assert status == 0, done.stderr
    return set(modules), done.stdout


def libraries(modules):
    return {name.partition(".")[0] for name in modules} & set(LIBRARIES)


def engines(modules):
    return {name for name in FOLDERS if f"pound_solve.integrate.{name}" in modules}


@pytest.mark.parametrize("kind", ["linear static", "general history", *at_night(*list(KINDS)[1:-1])])
def test_each_kind_of_deck_imports_what_it_needs_and_no_more(tmp_path, kind):
    # with compiled kernels AUTO takes series
    modules, _ = run(deck(tmp_path, kind), "--explain", compiling="0")
    with Results.open(tmp_path / "deck.h5") as results:
        assert f"Kind of problem: {kind}." in results.note("arrays")
        told = {part: (count, which) for part, count, which in results.table("imports").tolist()}
        held = {part for part, *_ in results.table("arrays").tolist()}
    assert not libraries(modules) & NUMERICS
    assert "matplotlib" not in libraries(modules)
    moving = "history" in kind
    assert engines(modules) == ENGINES.get(kind, set())
    assert ("history" in held) == moving
    assert "pound_solve.assess.study" not in modules
    assert not {m for m in modules if m.startswith("pound_solve.laws.contact.")}
    # and the table says so
    assert told["numba"] == (0, "not imported")
    assert told["kernels compiled"] == (0, "none")
    assert set(told["pound_solve.integrate"][1].split(", ")) >= {"protocol"}
    assert ("pound_solve.integrate.closed_form" in told) == ("closed_form" in ENGINES.get(kind, set()))


def test_a_deck_without_contacts_holds_none_of_their_arrays(tmp_path):
    path = deck(tmp_path, "piecewise linear history")
    run(path, "--explain")
    with Results.open(tmp_path / "deck.h5") as results:
        held = {(part, what): size for part, what, _, size in results.table("arrays").tolist()}
        assert held["contacts", "closures of 0"] == 0
        assert held["geometric nonlinearity", "chords of 0"] == 0
        # four hinges over six unknowns
        assert held["springs and hinges", "deformations of 4"] == 8 * 4 * results_unknowns(results)
        assert not {what for part, what in held if part == "stored at an instant" and "contact" in what}
        assert not [name for name in results.histories if name.startswith("contact")]


def results_unknowns(results):
    return int(dict(results.table("size").tolist())["unknowns before reduction"])


def test_a_run_that_is_not_asked_explains_nothing(tmp_path):
    _, out = run(deck(tmp_path, "linear static"))
    with Results.open(tmp_path / "deck.h5") as results:
        assert not {"arrays", "imports"} & set(results.tables)
    assert "ARRAYS" not in out
    _, out = run(deck(tmp_path, "linear static"), "--explain")
    assert "ARRAYS IN MEMORY" in out and "REDUCED SYSTEM AND PROBLEM SIZE" in out


def test_the_version_and_the_help_need_no_numbers():
    for word in ("--version", "--help"):
        code = (
            "import sys; from pound_solve.cli.main import main\n"
            f"try: main([{word!r}])\n"
            "except SystemExit: pass\n"
            "print(*(m for m in sys.modules if m.startswith('pound_')))\n"
            f"assert not set({LIBRARIES!r}) & {{m.partition('.')[0] for m in sys.modules}}"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        loaded = set(done.stdout.splitlines()[-1].split())
        assert {m for m in loaded if not m.startswith("pound_solve.cli")} == {
            "pound_solve",
            "pound_solve.deck",
            "pound_solve.interruption",
            "pound_solve.user_error",
            "pound_solve.modules",
            "pound_solve.numerics",
            "pound_solve.numerics.threads",
            "pound_solve.report",
            "pound_solve.report.formats",
            "pound_solve.version",
        }


def test_a_report_needs_no_numerics(tmp_path):
    path = deck(tmp_path, "modal")
    run(path)
    modules, _ = main(["report", str(path.with_suffix(".h5"))])
    assert not libraries(modules) & (NUMERICS | {"lark", "matplotlib"})
    layers = {name.split(".")[1] for name in modules if name.startswith("pound_solve.")}
    flat = {"check", "deck", "interruption", "modules", "user_error", "version"}
    assert layers <= flat | {"cli", "numerics", "report", "results"}
    assert {name for name in modules if name.startswith("pound_solve.numerics.")} == {
        "pound_solve.numerics.threads",
        "pound_solve.numerics.types",
    }


def test_every_spec_stands_in_the_package_of_its_family():
    for spec in specs():
        assert spec.impl is None or f".{FAMILIES[spec.family]}." in spec.impl.__module__ + "."


def test_sparse_matrices_count_with_their_indices():
    sparse = pytest.importorskip("scipy.sparse")
    import numpy as np

    a = sparse.csr_array(np.eye(5))
    numbers, held = stored(a, np.zeros((2, 3)))
    assert numbers == 5 + 6
    assert held == 8 * 11 + a.indices.nbytes + a.indptr.nbytes
