"""What many contacts and unknowns cost: counts of the work, which must not grow faster than the model."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kernels import interpreted
from pound_solve import run
from pound_solve.integrate import condensed
from pound_solve.integrate.stepping import locating, parts
from pound_solve.results import Results

CROWD = """GRAVITY 1
NODES
 1 TO {n} 0 TO {n}-1 0 FIX=YR
ELEMENTS
 1 TO {n} STOREY 1 TO {n}
 {n}+1 TO 2*{n} WALL 1 TO {n}
PROPS
 STOREY SPRING KX=100 {rule}
 WALL CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1 TO {n} {weight}
INITIAL
 1 TO {n} VX=1
ANALYSIS
 HISTORY 0.4 METHOD=NEWMARK DT=5E-3
OUTPUT
 EVERY=0.1
"""
YIELDING = "RULE=BILINEAR R=0.1 FX=2"
LAWS = ("KELVIN_VOIGT K=1E4 E=0.6", "HERTZ K=1E5")


def solved(folder: Path, n: int, law: str, rule: str = "", weight: str = "1") -> Results:
    deck = folder / f"{n}.inp"
    deck.write_text(CROWD.format(n=n, law=law, rule=rule, weight=weight))
    results = run(deck, out=folder)
    assert results.status == "done", results.message
    return results


def trials(
    monkeypatch: pytest.MonkeyPatch, folder: Path, n: int, law: str, rule: str = ""
) -> tuple[int, int, np.ndarray]:
    """Trial steps of the parts that events cut, events, and displacements of all nodes."""
    count, try_step = 0, locating.try_step

    def counted(*arguments):
        nonlocal count
        count += 1
        return try_step(*arguments)

    with interpreted(), monkeypatch.context() as patch:
        for module in (locating, parts):
            patch.setattr(module, "try_step", counted)
        with solved(folder, n, law, rule) as results:
            events = int(dict(results.table("run").tolist())["events"])
            return count, events, results.history("node/u")[:, :, 0]


@pytest.mark.full
@pytest.mark.parametrize("rule", ["", YIELDING])
@pytest.mark.parametrize("law", LAWS)
def test_contacts_that_meet_at_one_instant_cost_one_event(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, law: str, rule: str
) -> None:
    """Bodies apart from each other, all alike: as many trials for twelve as for two, the same motion."""
    few, events, u = trials(monkeypatch, tmp_path, 2, law, rule)
    many, all_events, all_u = trials(monkeypatch, tmp_path, 12, law, rule)
    assert all_events == 6 * events > 0
    assert many == few
    assert np.abs(all_u - u[:, :1]).max() < 1e-12 * np.abs(u).max()


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Full matrices hold five unknowns, and none is made."""
    monkeypatch.setattr(condensed, "MAX_UNKNOWNS", 5)
    monkeypatch.setattr(condensed, "condense", None)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize(
    ("method", "law", "cure"),
    [
        ("EXACT", "KELVIN_VOIGT K=1E4 E=0.6", "METHOD=TAYLOR or NEWMARK or AUTO takes them"),
        ("EXACT", "STEREOMECHANICS E=0.6", "METHOD=TAYLOR or AUTO takes them"),
        ("LAPLACE DT=1E-3", "KELVIN_VOIGT K=1E4 E=0.6", "METHOD=TAYLOR or NEWMARK or AUTO takes them"),
    ],
)
def test_full_matrices_are_refused_with_the_count_and_what_takes_it(
    tmp_path: Path, method: str, law: str, cure: str
) -> None:
    deck = tmp_path / "deck.inp"
    text = CROWD.format(n=6, law=law, rule="", weight="1")
    deck.write_text(text.replace("NEWMARK DT=5E-3", method))
    with run(deck, out=tmp_path) as results:
        name = method.split()[0]
        assert results.message.startswith(f"A505 at t = 0 s: {name} works on full matrices, and 6 unknowns")
        assert results.message.endswith(cure)


@pytest.mark.usefixtures("small")
def test_auto_takes_what_full_matrices_do_not_hold(tmp_path: Path) -> None:
    deck = tmp_path / "deck.inp"
    text = CROWD.format(n=6, law=LAWS[0], rule="", weight="1").replace("NEWMARK DT=5E-3", "AUTO TOL=0.1")
    deck.write_text(text)
    with run(deck, out=tmp_path) as results:
        assert results.status == "done", results.message
        assert not dict(results.table("run").tolist())["method"].startswith("EXACT")
