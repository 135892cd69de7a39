"""The library of kernels compiled ahead of time gives the numbers that Python and numba give.

It is the one beside the program if there is one, as in a wheel; else it is built, which takes minutes.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import pound_solve
from kernels import interpreted
from pound_deck.schema import Spec
from pound_solve.assess.law_test import specimen
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law
from pound_solve.numerics import library
from pound_solve.numerics.jit import Numba
from pound_solve.numerics.library import Library
from pound_solve.numerics.providers import provider
from pound_solve.results import Results
from pound_solve.structure.corotational import member_actions
from samples import has_loop

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
SHAKEN = """UNITS kN m s
NODES
{nodes}
ELEMENTS
{elements}
PROPS
{properties}
WEIGHTS
{weights}
EQUAKE
 SINE AMPLITUDE=60 PERIOD=0.9 DURATION=2
ANALYSIS
 HISTORY 1.5 METHOD={method}
OUTPUT
 EVERY=0.02
"""
METHODS = ["NEWMARK DT=0.01", "HHT DT=0.01 EVENTS=STEPPED", "CENTRAL DT=0.001", "TAYLOR"]


@pytest.fixture(scope="module")
def ahead(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """The library serves the process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("POUND_COMPILE", raising=False)
        if library.load(library.FOLDER) is None:
            folder = tmp_path_factory.mktemp("kernels")
            path = os.pathsep.join(str(ROOT / own) for own in ("solver", "parser", "."))
            command = [sys.executable, "-m", "ahead_of_time", str(folder)]
            subprocess.run(command, cwd=ROOT, env={**os.environ, "PYTHONPATH": path}, check=True)
            patch.setattr(library, "FOLDER", folder)
        provider.cache_clear()
        found = provider()
        assert isinstance(found, Library)
        yield found
    provider.cache_clear()


def laws(series: bool) -> list[Spec]:
    """Hysteresis rules and contact laws that a spring or a contact has, all or those with series."""
    families = (catalog().family(name).values() for name in ("hysteresis", "contact"))
    found = (spec for family in families for spec in family if has_loop(spec))
    return [spec for spec in found if not series or has_series(specimen(spec)[0].law)]


def has_series(law: Law) -> bool:
    return not law.curved or law.rule.power_law is not None or law.rule.smooth_curve is not None


def shaken(method: str) -> str:
    """A deck of oscillators side by side, each with a law of its own."""
    nodes, elements, properties, weights = [], [], [], []
    for n, spec in enumerate(laws(method == "TAYLOR")):
        a, b, card = 2 * n + 1, 2 * n + 2, specimen(spec)[1].replace("GAP=0", "GAP=0.1")
        nodes.append(f" {a} {10 * n} 0 FIX=XYR\n {b} {10 * n + 3} 0 FIX=YR")
        elements.append(f" {a} S{n} {a} {b}")
        if spec.family == "hysteresis":
            properties.append(f" S{n} SPRING RULE={spec.name} {card}")
        else:
            elements.append(f" {b} C{n} {a} {b}")
            properties.append(f" S{n} SPRING KX=1\n C{n} CONTACT LAW={spec.name} {card}")
        weights.append(f" {b} 0.25")
    parts = ("\n".join(own) for own in (nodes, elements, properties, weights))
    return SHAKEN.format(**dict(zip(("nodes", "elements", "properties", "weights"), parts)), method=method)


def ran(deck: str, folder: Path) -> Results:
    folder.mkdir()
    path = folder / "deck.inp"
    path.write_text(deck, encoding="utf-8")
    found = pound_solve.run(path, out=folder)
    assert found.status == "done", found.message
    return found


def same(one: Results, other: Results, tolerance: float) -> None:
    for name in one.histories:
        a, b = one.history(name), other.history(name)
        size = np.abs(a).max(initial=1e-300)
        assert np.abs(a - b).max(initial=0.0) <= tolerance * size, name


@pytest.mark.usefixtures("ahead")
@pytest.mark.parametrize("method", METHODS)
def test_every_law_gives_the_numbers_of_python(tmp_path: Path, method: str) -> None:
    fast = ran(shaken(method), tmp_path / "library")
    with interpreted():
        slow = ran(shaken(method), tmp_path / "python")
    same(slow, fast, 1e-10)


#: a column that turns, with a damper, against a stop that rubs
TURNING = """UNITS kN m s
GEOMETRY LARGE
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 0.2 3 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 STOP 2 3
 3 DAMP 2 3
PROPS
 COL FRAME E=2e8 A=0.01 I=1e-5
 STOP CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1e5 E=0.7 MU=0.3 KT=1e4
 DAMP DASHPOT CX=20 LAW=FLUID ALPHA=0.5
WEIGHTS
 2 98.1
INITIAL
 2 VX=1
ANALYSIS
 HISTORY 0.5 METHOD=NEWMARK DT=1e-3
"""


@pytest.mark.usefixtures("ahead")
def test_members_that_turn_friction_and_dampers_give_the_numbers_of_python(tmp_path: Path) -> None:
    fast = ran(TURNING, tmp_path / "library")
    with interpreted():
        slow = ran(TURNING, tmp_path / "python")
    assert len(fast.table("collisions")) > 0
    same(slow, fast, 1e-10)


EXAMPLE = ROOT / "examples/01_two_oscillators/two_oscillators.inp"


@pytest.mark.skipif(find_spec("numba") is None, reason="numba is not installed")
@pytest.mark.usefixtures("ahead")
@pytest.mark.parametrize("method", ["NEWMARK", "TAYLOR"])
def test_numba_gives_the_same_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str) -> None:
    step = 1e-3 if method == "NEWMARK" else None
    ahead = pound_solve.run(EXAMPLE, method=method, dt=step, out=tmp_path / "library")
    monkeypatch.setattr(library, "load", lambda folder: None)
    provider.cache_clear()
    assert isinstance(provider(), Numba)
    found = pound_solve.run(EXAMPLE, method=method, dt=step, out=tmp_path / "numba")
    provider.cache_clear()
    same(found, ahead, 1e-10)


@pytest.mark.usefixtures("ahead")
def test_a_process_with_the_library_imports_no_compiler(tmp_path: Path) -> None:
    program = f"""
import sys
from pathlib import Path
import pound_solve
from pound_solve.numerics import library
from pound_solve.numerics.providers import provider
library.FOLDER = Path({str(library.FOLDER)!r})
pound_solve.run({str(EXAMPLE)!r}, method="TAYLOR", out={str(tmp_path)!r})
assert isinstance(provider(), library.Library)
assert not {{"numba", "llvmlite"}} & set(sys.modules)
"""
    path = os.pathsep.join(p for p in sys.path if p)
    subprocess.run([sys.executable, "-c", program], env={**os.environ, "PYTHONPATH": path}, check=True)


def test_other_types_of_arguments_are_refused(ahead: Library) -> None:
    with pytest.raises(TypeError, match="other arguments"):
        ahead.ready(member_actions)(np.zeros((1, 10)), np.zeros((1, 1, 6)), np.zeros((1, 4)))
    with pytest.raises(TypeError, match="without gaps"):
        ahead.ready(member_actions)(np.zeros((10, 1)).T[:, ::2], np.zeros((1, 1, 6)), np.zeros((1, 1, 4)))
