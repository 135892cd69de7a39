"""Plain and sparse matrices: the same numbers, modes and messages; memory that grows with the structure."""

from __future__ import annotations

import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import model_of, solved
from pound_solve import run
from pound_solve.analyses import modal, static
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.numerics import matrices, modes
from pound_solve.structure.assembly import assemble

pytestmark = pytest.mark.full

FRAME = Path(__file__).parents[2] / "examples" / "frames" / "steel_10x3.inp"


def sparse(a):
    """The same matrix, sparse."""
    from scipy.sparse import csr_array

    return csr_array(a)


def chain(n, free=False):
    """Stiffness and mass of n unit masses on springs of one in a row; `free`: held by nothing."""
    ends = [0, n - 1] if free else [n - 1]
    i = np.arange(n)
    own = np.where(np.isin(i, ends), 1.0, 2.0)
    at = np.concatenate([i, i[1:], i[:-1]]), np.concatenate([i, i[:-1], i[1:]])
    k = matrices.gathered((n, n), *at, np.concatenate([own, -np.ones(2 * n - 2)]))
    return k, matrices.selection(n, i)


@settings(max_examples=60)
@given(st.integers(0, 10_000), st.integers(1, 12), st.integers(1, 12))
def test_sparse_and_plain_say_the_same(seed, n, m):
    rng = np.random.default_rng(seed)
    a = np.where(rng.random((n, m)) < 0.4, rng.standard_normal((n, m)), 0.0)
    b, w, q = sparse(a), rng.standard_normal(n), rng.standard_normal(n)
    for x, y in zip(matrices.entries(a), matrices.entries(b)):
        assert (x == y).all()
    for (i, x), (j, y) in zip(matrices.by_rows(a), matrices.by_rows(b)):
        assert (i == j).all() and (x == y).all()
    rows, columns = rng.integers(n, size=9), rng.integers(m, size=9)
    assert (matrices.at(b, rows, columns) == a[rows, columns]).all()
    assert (matrices.used_rows(b) == matrices.used_rows(a)).all()
    assert (matrices.used_columns(b) == matrices.used_columns(a)).all()
    assert matrices.dense(matrices.weighted(b, w)) == pytest.approx(a.T @ np.diag(w) @ a, abs=1e-13)
    square = matrices.weighted(a.T, np.ones(m))
    assert matrices.dense(matrices.scaled(sparse(square), q)) == pytest.approx(
        np.diag(q) @ square @ np.diag(q), abs=1e-13
    )


@settings(max_examples=60)
@given(st.integers(0, 10_000), st.integers(2, 20))
def test_the_factor_solves_and_counts_negative_eigenvalues(seed, n):
    rng = np.random.default_rng(seed)
    half = np.where(rng.random((n, n)) < 0.3, rng.standard_normal((n, n)), 0.0)
    a = (
        half
        + half.T
        + np.diag(rng.choice([-1.0, 1.0], n) * (1.0 + 2.0 * np.abs(half + half.T).sum(axis=1)))
    )
    factor, b = matrices.Factor(sparse(a)), rng.standard_normal(n)
    assert a @ factor.solve(b) == pytest.approx(b, abs=1e-10)
    assert factor.negative == int((np.linalg.eigvalsh(a) < 0.0).sum())


def test_what_resists_nothing_is_found_and_left_out():
    """Two chains that nothing holds: two motions, and under balanced loads the least displacements."""
    n = 6
    one = matrices.dense(chain(n, free=True)[0])
    k = np.block([[one, np.zeros((n, n))], [np.zeros((n, n)), one]])
    root = 1.0 / np.sqrt(np.diag(k))
    k = root[:, None] * k * root
    held, plain = modes.SingularStiffness(sparse(k)), modes.SingularStiffness(k)
    assert held.negative is None and held.null_space.shape == plain.null_space.shape == (2 * n, 2)
    assert np.abs(k @ held.null_space).max() < 1e-14
    push = k @ np.random.default_rng(2).standard_normal(2 * n)
    assert held.solve(push) == pytest.approx(np.linalg.pinv(k) @ push, abs=1e-12)
    assert modes.SingularStiffness(sparse(k - 0.1 * np.eye(2 * n))).negative is not None


def test_slow_modes_of_a_long_chain():
    """omega_j = 2 sin((2j-1) pi / (2 (2n+1))) of n equal masses and springs, held at one end."""
    n, count = 3000, 6
    k, m = chain(n)
    found = modes.solve(k, m, count)
    wanted = [2.0 * math.sin((2 * j - 1) * math.pi / (2 * (2 * n + 1))) for j in range(1, count + 1)]
    assert found.omega == pytest.approx(wanted, rel=1e-9)
    assert found.shapes.T @ (m @ found.shapes) == pytest.approx(np.eye(count), abs=1e-9)
    assert modes.fastest(k, m) == pytest.approx(2.0 * math.cos(math.pi / (2 * n + 1)), rel=1e-8)
    again = modes.solve(k, m, count)
    assert (again.shapes == found.shapes).all()


def test_no_equal_mode_is_passed_over():
    """Three equal chains, the third free: every frequency of the first two comes twice, one is zero."""
    from scipy.sparse import block_diag

    n = 200
    parts = [chain(n), chain(n), chain(n, free=True)]
    k, m = (block_diag([p[i] for p in parts], format="csr") for i in range(2))
    k, m = sparse(k), sparse(m)
    found = modes.solve(k, m, 7).omega
    everything = np.concatenate([modes.solve(*map(matrices.dense, p)).omega for p in parts])
    assert found[0] == 0.0
    assert found == pytest.approx(np.sort(everything)[:7], rel=1e-8, abs=1e-12)


def test_massless_dofs_between_masses():
    """Every second mass taken away: springs of one half between the rest."""
    n = 1001
    k, _ = chain(n)
    at = np.arange(0, n, 2)
    m = matrices.gathered((n, n), at, at, np.ones(len(at)))
    found = modes.solve(k, m, 4)
    plain = modes.solve(matrices.dense(k), matrices.dense(m))
    assert found.omega == pytest.approx(plain.omega[:4], rel=1e-9)
    assert np.abs(found.shapes) == pytest.approx(np.abs(plain.shapes[:, :4]), abs=1e-7)


PORTAL = """
GRAVITY 9.81
GEOMETRY PDELTA
NODES
 1 0 0 FIX=XYR
 2 0 4
 3 6 4
 4 6 0 FIX=XYR
ELEMENTS
 1 C 1 2
 2 B 2 3
 3 C 4 3
PROPS
 C FRAME E=2e8 A=0.01 I=1e-4 RULE=BILINEAR R=0.05 KH=2e4 MI=150 MJ=150
 B FRAME E=2e8 A=0.01 I=2e-4
WEIGHTS
 2 TO 3 200
LOADS
 2 TO 3 10 -200
ANALYSIS
 STATIC
"""


def test_a_whole_static_analysis_is_the_same(monkeypatch):
    plain = solved(PORTAL)
    table = modal.natural_modes(static.after(plain.structure, plain.state), 2)
    monkeypatch.setattr(matrices, "MAX_DENSE", 0)
    s = assemble(model_of(PORTAL))
    state = static.solve(s)
    assert state.u == pytest.approx(plain.state.u, rel=1e-11, abs=1e-15)
    assert state.buckling == pytest.approx(plain.state.buckling, rel=1e-9)
    own = modal.natural_modes(static.after(s.stressed(state.axial), state), 2)
    assert np.array(own) == pytest.approx(np.array(table), rel=1e-9, abs=1e-9)


def test_a_mechanism_has_the_same_name(monkeypatch):
    deck = "NODES\n 1 TO 3 0 TO 2 0 FIX=YR\nELEMENTS\n 1 TO 2 A 1 TO 2 2 TO 3\nPROPS\n A SPRING KX=100\n"

    def said():
        with pytest.raises(InstabilityError, match="mechanism, worst at node 2 ux") as err:
            static.solve(assemble(model_of(deck + "LOADS\n 3 1\nANALYSIS\n STATIC\n")))
        return str(err.value)

    plain = said()
    monkeypatch.setattr(matrices, "MAX_DENSE", 0)
    assert said() == plain


@pytest.mark.slow
def test_memory_grows_with_the_storeys(tmp_path):
    """Peak of what Python and numpy hold in a run of the steel frame: it doubles with the storeys."""
    deck = tmp_path / "frame.inp"  # P-Delta would make the tall ones buckle
    deck.write_text(FRAME.read_text(encoding="utf-8").replace("GEOMETRY PDELTA", "GEOMETRY SMALL"))
    sizes = []
    for storeys in (5, 20, 40):  # the first loads and compiles
        params = {"pga": 3, "every": 0.05, "t": 0.05, "dt": 0.025, "storeys": storeys}
        if storeys > 5:
            tracemalloc.start()
        run(deck, out=tmp_path, params=params).close()
        if storeys > 5:
            sizes.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
    assert sizes[1] < 2.3 * sizes[0], sizes  # full matrices make it 4
