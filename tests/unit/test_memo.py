"""What is kept of earlier calls: found again by content, shared, and changed by no run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array

import pound_solve
from kernels import FAST
from pound_solve.integrate.kernels import allocation
from pound_solve.integrate.series import massless, modal_tables
from pound_solve.numerics.memo import by_content, digest

DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
 3 6 0 FIX=YR
 4 9 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 STOP 2 3
 3 COL 3 4
PROPS
 COL SPRING KX=1e6 FX=400 RULE=BILINEAR R=0.1
 STOP CONTACT GAP=0.00002 LAW=KELVIN_VOIGT K=1e6 E=0.7
WEIGHTS
 2 100
 3 300
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2
EQUAKE
 TABLE POINTS=0,0,1,3,2,-3,3,0,4,0
ANALYSIS
 HISTORY 4 METHOD={method}
OUTPUT
 EVERY=0.05
"""


def test_what_holds_the_same_is_found_again() -> None:
    calls = []

    @by_content(most=2)
    def total(a: Any, factor: float = 1.0) -> Any:
        calls.append(factor)
        return factor * a.sum()

    one = np.arange(4.0)
    assert total(one) == total(one.copy()) == 6.0 and len(calls) == 1
    assert total(one, 2.0) == total(one, factor=2.0) == 12.0
    assert total(csr_array(np.eye(3))) == total(csr_array(np.eye(3))) == 3.0
    before = len(calls)
    assert total(one) == 6.0 and len(calls) == before + 1  # two others came since


def test_so_many_are_kept_and_no_more() -> None:
    calls: list[float] = []

    @by_content(most=4)
    def kept(x: float) -> float:
        calls.append(x)
        return x

    for x in (1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0):
        assert kept(x) == x
    assert calls == [1.0, 2.0, 3.0, 4.0]
    assert [kept(x) for x in (5.0, 4.0, 1.0)] == [5.0, 4.0, 1.0]  # the first had to go
    assert calls == [1.0, 2.0, 3.0, 4.0, 5.0, 1.0]


def test_a_change_of_what_is_given_is_seen() -> None:
    @by_content(most=4)
    def first(a: Any) -> float:
        return float(a[0])

    a = np.ones(2)
    assert first(a) == 1.0
    a[0] = 7.0
    assert first(a) == 7.0


@pytest.mark.parametrize(
    "other",
    [
        np.arange(4),
        np.arange(4.0).reshape(2, 2),
        np.arange(4.0)[::-1],
        csr_array(np.arange(4.0)[None]),
        [0.0, 1.0, 2.0, 3.0],
        "0123",
    ],
)
def test_other_content_has_another_digest(other: Any) -> None:
    assert digest([other]) != digest([np.arange(4.0)])
    assert digest([other]) == digest([other])
    assert digest([[other], other]) != digest([other, [other]])


def test_an_error_is_raised_again() -> None:
    @by_content(most=2)
    def inverse(a: Any) -> Any:
        return np.linalg.inv(a)

    for _ in range(2):
        with pytest.raises(np.linalg.LinAlgError):
            inverse(np.zeros((2, 2)))


def numbers_of(shared: Any) -> bytes:
    """Digest of all arrays in something that is shared."""
    parts = shared if isinstance(shared, tuple) else vars(shared).values()
    flat = [x for part in parts for x in (part if isinstance(part, tuple) else [part])]
    return digest([x for x in flat if isinstance(x, np.ndarray | float)])


@FAST
@pytest.mark.parametrize("method", ["TAYLOR", "LAGUERRE TOL=1e-6", "NEWMARK DT=0.01"])
def test_runs_share_their_order_and_modes_and_change_neither(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    found: list[Any] = []

    def told(function: Any) -> Any:
        def call(*args: Any) -> Any:
            found.append(function(*args))
            return found[-1]

        return call

    for module, name in ((allocation, "laid_out"), (massless, "laid_out"), (modal_tables, "shared_part")):
        monkeypatch.setattr(module, name, told(getattr(module, name)))
    deck = tmp_path / "deck.inp"
    deck.write_text(DECK.format(method=method))
    seen = []
    for _ in range(2):
        with pound_solve.run(deck, out=tmp_path) as results:
            assert results.status == "done" and len(results.table("collisions")) > 0
            seen.append(results.table("contact_summary").tobytes())
        seen.append([numbers_of(x) for x in found])
    n = len(found) // 2
    assert n and all(x is y for x, y in zip(found[:n], found[n:]))
    assert any(isinstance(x, modal_tables.ModalPart) for x in found) == ("NEWMARK" not in method)
    assert seen[0] == seen[2] and seen[1] == seen[3][:n] == seen[3][n:]
