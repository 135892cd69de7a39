"""Which of the three makes kernels ready, and what a user is told of it."""

from __future__ import annotations

import ast
import re
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import pound_solve
from kernels import interpreted
from pound_solve.laws import functions
from pound_solve.laws.hysteresis import bilinear
from pound_solve.numerics import jit, library, providers
from pound_solve.numerics.block import Block
from pound_solve.numerics.digest import KERNELS, digest
from pound_solve.numerics.library import REFUSED
from pound_solve.numerics.providers import INTERPRETED, Interpreter, provider
from pound_solve.numerics.record import record

DECK = Path(__file__).parents[2] / "examples/01_two_oscillators/two_oscillators.inp"


def kernel(x: float) -> float:
    """Stand in for a kernel."""
    return x


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder for libraries, on a machine that has numba, whose kernels are compiled."""
    monkeypatch.delenv("POUND_COMPILE", raising=False)
    monkeypatch.setattr(library, "FOLDER", tmp_path)
    monkeypatch.setattr(providers, "find_spec", lambda name: object())
    monkeypatch.setattr(jit, "cold", lambda kernel: False)
    provider.cache_clear()
    yield tmp_path
    provider.cache_clear()


def without_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(providers, "find_spec", lambda name: None)


def test_a_library_comes_first(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    there = object.__new__(library.Library)
    monkeypatch.setattr(library, "load", lambda folder: there if folder == machine else None)
    assert provider() is there
    assert there.fast and there.notice(kernel) == ""
    assert there.ready(kernel, "f8(f8)") is kernel  # Python calls it, and the library knows it by number


@pytest.mark.usefixtures("machine")
def test_then_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(provider(), jit.Numba) and provider().fast
    assert provider().notice(kernel) == ""
    monkeypatch.setattr(jit, "cold", lambda kernel: True)
    assert provider().notice(kernel) == jit.COMPILING


@pytest.mark.usefixtures("machine")
def test_then_python(monkeypatch: pytest.MonkeyPatch) -> None:
    without_numba(monkeypatch)
    assert isinstance(provider(), Interpreter) and not provider().fast
    assert provider().ready(kernel) is kernel
    assert provider().notice(kernel) == INTERPRETED


def test_python_is_asked_for(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (machine / f"{library.STEM}{digest()}.so").write_bytes(b"")
    monkeypatch.setenv("POUND_COMPILE", "0")
    assert isinstance(provider(), Interpreter) and provider().notice(kernel) == ""


@pytest.mark.parametrize("key", ["0123456789abcdef", digest()])
def test_a_library_of_other_source_or_of_another_machine_is_refused(
    machine: Path, monkeypatch: pytest.MonkeyPatch, key: str
) -> None:
    (machine / f"{library.STEM}{key}.so").write_bytes(b"no library")
    assert isinstance(provider(), jit.Numba) and provider().notice(kernel) == REFUSED
    monkeypatch.setattr(jit, "cold", lambda kernel: True)
    assert provider().notice(kernel) == f"{REFUSED}; {jit.COMPILING}"
    without_numba(monkeypatch)
    provider.cache_clear()
    assert provider().notice(kernel) == f"{REFUSED}; {INTERPRETED}"


def test_the_digest_sees_kernels_laws_and_what_packs_their_arguments() -> None:
    program = Path(library.__file__).parents[1]
    found = {p for pattern in KERNELS for p in program.glob(pattern)}
    for module in ("laws/hysteresis/bilinear.py", "integrate/kernels/laws.py", "numerics/block.py"):
        assert program / module in found


class Numbers(NamedTuple):
    """Arguments of several kinds."""

    real: float
    whole: int
    flag: bool


class Counter:
    """The fields of a record."""

    count: int
    time: float


def test_arguments_are_laid_out_as_compiled_code_has_them() -> None:
    a, counter = np.arange(6.0).reshape(2, 3), record(Counter)
    counter.count = 7
    block = Block([a, Numbers(0.5, 3, np.True_), counter], {})
    assert block.types == ["<f82", "real", "whole", "flag", "<i8<f8"]
    cells = struct.unpack("=9qdqqq", block.packed())
    assert cells[:4] == (0, 0, 6, 8) and cells[5:9] == (2, 3, 24, 8)
    assert cells[4] == a.ctypes.data and cells[9:12] == (0.5, 3, 1)
    assert np.frombuffer(counter, np.int64)[0] == 7
    assert cells[12] == np.frombuffer(counter, np.int64).ctypes.data


def test_functions_of_rules_become_numbers() -> None:
    own = functions.functions(bilinear.RULE)
    tables = functions.RuleFunctions(*((f,) for f in own))
    numbers = {f.__qualname__: n for n, f in enumerate(own)}
    block = Block([tables], numbers)
    assert block.types == ["<i81"] * len(tables)
    with pytest.raises(KeyError):
        Block([tables], {})


def test_kernels_call_rules_by_functions_that_a_library_replaces() -> None:
    fields = functions.RuleFunctions._fields
    assert [call.__name__ for call in functions.CALLS] == [f"{field}_of" for field in fields]
    assert len(functions.SIGNATURES) == len(fields)
    program = Path(library.__file__).parents[1]
    for path in program.glob("integrate/**/*.py"):
        assert not re.search(r"rules\.\w+\[", path.read_text(encoding="utf-8")), path


def test_arrays_with_gaps_are_refused() -> None:
    with pytest.raises(TypeError, match="without gaps"):
        Block([np.zeros((3, 4))[:, 1]], {})


@pytest.mark.full
def test_the_report_says_how_kernels_run(tmp_path: Path) -> None:
    deck = tmp_path / "short.inp"
    deck.write_text(DECK.read_text("utf-8").replace("HISTORY   5", "HISTORY   0.1"), "utf-8")
    with interpreted():
        results = pound_solve.run(deck)
    assert dict(results.table("run_figures").tolist())["kernels"] == "as Python, which was asked for"


def test_no_function_of_a_rule_is_handed_on() -> None:
    """Numba cannot keep a function to which another one is handed: it would compile it in every process."""
    tree = ast.parse(Path(functions.__file__).read_text(encoding="utf-8"))
    calls = [x.func for x in ast.walk(tree) if isinstance(x, ast.Call)]
    named = [x for x in ast.walk(tree) if isinstance(x, ast.Name) and isinstance(x.ctx, ast.Load)]
    used = [x for x in named if x.id == "function_of_rule"]
    assert used and all(x in calls for x in used)
