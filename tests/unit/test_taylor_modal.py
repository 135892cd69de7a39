"""Intervals that TAYLOR takes in modes: the same answers as by series, and bounds that hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kernels import interpreted
from pound_solve.integrate.series import modal, modal_tables
from pound_solve.integrate.series.modal import FOLLOWED, MODES
from pound_solve.numerics.matrices import MAX_DENSE
from unit.test_taylor import item, same
from verification.cases import ROOT, Ran, run_deck, run_text

pytestmark = pytest.mark.full

#: a chain of stiff elements on a column that yields, beside a stop; the ground moves along straight lines
CHAIN = """UNITS kN m s
PARAM k = 4e5   gap = 0.004   fy = 60   c = 0   every = 0.02
NODES
 1 0 0 FIX=XYR
 10 TO 16 1 TO 7 0 FIX=YR
ELEMENTS
 1 COLUMN 1 10
 2 TO 7 BAR 10 TO 15 11 TO 16
 8 STOP 16
PROPS
 COLUMN SPRING KX=4000 FX=fy RULE=ELASTO_PLASTIC
 BAR SPRING KX=k
 STOP CONTACT GAP=gap LAW=KELVIN_VOIGT K=2e5 C=0
WEIGHTS
 10 TO 16 20
DAMPING
 RAYLEIGH XI=0.03 OMEGA=15,200
LOADS
 16 FX=5
EQUAKE
 TABLE POINTS=0,0,0.1,1,0.2,-2,0.3,3,0.4,-1,0.6,-3,0.7,2,0.9,4,1,-4,1.1,3,1.2,-2,2,0
OUTPUT
 EVERY=every
ANALYSIS
 STATIC
 HISTORY 2
"""


def counts(r: Ran) -> tuple[int, int]:
    """Series and intervals in modes."""
    rows = {str(x["item"]): str(x["value"]) for x in r.tables["run"]}
    return int(rows["series"]), int(rows.get("intervals in modes", 0))


def test_modes_find_what_series_find(monkeypatch: pytest.MonkeyPatch) -> None:
    """Histories, peaks, collisions, energies, with yielding and pounding in between."""
    deck, params = ROOT / "examples" / "cole2011" / "distributed.inp", {"n": 10}
    r = run_deck(deck, params, "TAYLOR")
    monkeypatch.setattr(modal_tables, "MIN_RADIANS", math.inf)
    s = run_deck(deck, params, "TAYLOR")
    same(r, s, 1e-9)
    assert counts(s)[1] == 0
    assert counts(r)[1] > 500 and counts(r)[0] < 0.4 * counts(s)[0]
    assert item(r, "events") == item(s, "events")


@pytest.mark.slow
def test_more_unknowns_than_plain_arrays_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sparse matrices, with modes and without."""
    deck, params = ROOT / "examples" / "cole2011" / "distributed.inp", {"n": 80, "t": 0.8, "gap": 0.0005}
    r = run_deck(deck, params, "TAYLOR")
    assert int(item(r, "unknowns")) > MAX_DENSE
    monkeypatch.setattr(modal_tables, "MIN_RADIANS", math.inf)
    same(r, run_deck(deck, params, "TAYLOR"), 1e-9)
    assert counts(r)[1] > 0


def test_bounds_hold_between_the_ends_of_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every followed quantity stays within its bounds, and its series over a cell is the quantity."""
    tightest, series_off, seen = math.inf, 0.0, 0

    def checked(laws, series, n_inputs, t):
        nonlocal tightest, series_off, seen
        own = series.modal
        cells = len(own.values) - 1
        p = np.zeros(40)
        for i in range(len(own.offset)):
            for cell in range(cells):
                y = np.array([value(own, i, cell, s, n_inputs) for s in SHARES])
                low, high = modal.cell_bounds(own, cell, i)
                size = np.abs(own.values[:, i]).max() + 1e-12
                assert (y > low - 1e-12 * size).all() and (y < high + 1e-12 * size).all()
                ends = own.values[cell, i], own.values[cell + 1, i]
                out = max(y.max() - max(ends), min(ends) - y.min())
                if out > 0.0:
                    tightest = min(tightest, own.chord_error[i] / out)
                terms = modal.expand_in_cell(own, cell, i, n_inputs, p)
                assert terms > 0
                powers = np.polynomial.polynomial.polyval(SHARES, p[: terms + 1])
                series_off = max(series_off, np.abs(powers - y).max() / size)
                seen += 1
        return quiet(laws, series, n_inputs, t)

    quiet = modal.is_quiet
    monkeypatch.setattr(modal, "is_quiet", checked)
    with interpreted():
        r = run_text(CHAIN.replace("HISTORY 2", "HISTORY 1.2"), {}, "TAYLOR")
    assert r.status == "done", r.message
    assert seen > 300
    assert tightest < 10.0  # a bound far above what it bounds would prove little
    assert series_off < 1e-12


SHARES = np.linspace(0.0, 1.0, 9)


def value(own: modal.Modal, i: int, cell: int, s: float, n_inputs: int) -> float:
    """A followed quantity within a cell, by complex exponentials."""
    cells, total = len(own.values) - 1, own.offset[i]
    for b in range(len(own.counts)):
        at, count = own.index_of[b, i], own.counts[b, MODES]
        if at < 0:
            continue
        assert at < own.counts[b, FOLLOWED]
        x, row, exponent = own.x[b, 0], own.rows[b, at], own.exponent_per_cell[b, :, :count]
        grown = np.exp((exponent[0] + 1j * exponent[1]) * (cell + s))
        free = (x[:count] + 1j * x[count : 2 * count]) * grown
        start, slope = x[2 * count :][:n_inputs], x[2 * count :][n_inputs : 2 * n_inputs]
        later = np.concatenate([start + slope * (cell + s) / cells, slope])
        total += row[:count] @ free.real + row[count : 2 * count] @ free.imag
        total += row[2 * count : 2 * count + 2 * n_inputs] @ later
    return float(total)


@pytest.mark.parametrize("change", [{}, {"fy": 1e9, "gap": 1.0}, {"gap": 0.0005}, {"every": 0.03}])
def test_a_chain_under_a_table_as_by_exact(change: dict[str, float]) -> None:
    """Constant loads, plastic drifts, a contact closed at the start, intervals of several lengths."""
    r = run_text(CHAIN, change, "TAYLOR")
    e = run_text(CHAIN, change, "EXACT")
    same(r, e, 1e-8)
    assert counts(r)[1] > 0 or "every" in change


def test_parts_that_nothing_holds_are_taken_by_series() -> None:
    """A chain that floats has modes that come to rest nowhere."""
    floating = (
        CHAIN.replace(" 1 COLUMN 1 10\n", "").replace(" STATIC\n", "").replace("LOADS\n 16 FX=5\n", "")
    )
    assert counts(run_text(floating, {}, "TAYLOR"))[1] == 0


#: a light mass behind a stiff spring and a dashpot; no element of it is a law
LIGHT = """UNITS N m s
PARAM k = 1e6   c = 1e-9
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 SOFT 1 2
 2 STIFF 2 3
 3 DRAG 2 3
PROPS
 SOFT SPRING KX=25
 STIFF SPRING KX=k
 DRAG DASHPOT CX=c
WEIGHTS
 2 1
 3 1e-6
INITIAL
 2 UX=1
 3 UX=1
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 10
"""


def test_a_structure_without_any_law_is_taken_in_modes() -> None:
    """No force of a law is kept between the ends of intervals."""
    r = run_text(LIGHT, None, "TAYLOR")
    assert r.status == "done", r.message
    assert counts(r)[1] > 100
    w = math.sqrt(25.0 / (1.0 + 1e-6))
    assert np.abs(r.u[:, r.nodes.index(2), 0] - np.cos(w * r.time)).max() < 1e-6
