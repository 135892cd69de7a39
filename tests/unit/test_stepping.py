"""The stepping methods: order, events, Newton's iterations, compiled and interpreted."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from decks import results_of
from kernels import FAST, NUMBA, by_numba, interpreted
from pound_solve.check import looked
from pound_solve.integrate import condensed
from pound_solve.integrate.events import within_step
from pound_solve.integrate.kernels import allocation, products
from pound_solve.integrate.stepping import kernel, locating, parts
from pound_solve.integrate.stepping.factor import invalidate_factor
from pound_solve.laws import functions
from pound_solve.laws.hysteresis import bilinear, imk_bilinear
from pound_solve.numerics import cubic, jit, kernel_cache, ldl
from pounding_frames import HINGED, POUNDING, figures, run
from tiers import each_once

pytestmark = pytest.mark.full


@each_once(
    (
        "method, steps",
        [
            ("NEWMARK DT={}", (5e-4, 2.5e-4, 1.25e-4)),
            ("HHT DT={} ALPHA=-0.05", (2.5e-4, 1.25e-4, 6.25e-5)),
            ("GENERALISED_ALPHA DT={} RHO=0.8", (5e-4, 2.5e-4, 1.25e-4)),
        ],
    ),
    ("turn", ["0.5", "0"]),
    at_most=2,
)
def test_implicit_methods_are_of_order_two_on_frames_that_yield_and_pound(tmp_path, method, steps, turn):
    exact = run(tmp_path, "EXACT", turn=turn)
    assert exact.table("contact_summary")["closures"][0] >= 1
    assert exact.table("spring_envelope")["yield_events"].sum() >= 4
    errors = []
    for h in steps:
        own = run(tmp_path, method.format(h), turn=turn)
        assert own.table("contact_summary")["closures"][0] == exact.table("contact_summary")["closures"][0]
        errors.append(np.abs(figures(own) / figures(exact) - 1.0).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((orders > 1.8) & (orders < 2.3)), (errors, orders)
    assert errors[-1] < 5e-4


def test_central_differences_are_of_order_two_on_frames_that_pound(tmp_path):
    exact = run(tmp_path, "EXACT", hinge="")
    errors = [
        np.abs(figures(run(tmp_path, f"CENTRAL DT={h}", hinge="")) / figures(exact) - 1.0).max()
        for h in (2e-4, 1e-4, 5e-5)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((orders > 1.8) & (orders < 2.3)), (errors, orders)


def test_energy_residual_falls_with_the_square_of_the_step(tmp_path):
    found = [
        float(run(tmp_path, f"NEWMARK DT={h}").table("checks")["value"][0]) for h in (2e-3, 1e-3, 5e-4)
    ]
    assert all(3.2 < a / b < 5.0 for a, b in itertools.pairwise(found)), found


def test_steps_without_cuts_go_to_the_same_drifts(tmp_path):
    exact = figures(run(tmp_path, "EXACT"))[:4]
    cut, uncut = (
        [
            np.abs(figures(run(tmp_path, f"NEWMARK DT={h} EVENTS={how}"))[:4] / exact - 1.0).max()
            for h in (1e-3, 2.5e-4)
        ]
        for how in ("LOCATED", "STEPPED")
    )
    assert uncut[1] < 0.6 * uncut[0] < 0.01, uncut
    assert cut[1] < 0.5 * uncut[1]  # the jump of the contact's dashpot is what the cuts are for


@FAST
@pytest.mark.parametrize("method", ["NEWMARK DT=0.01", "HHT DT=0.01 EVENTS=STEPPED", "CENTRAL DT=4e-4"])
def test_interpreted_kernels_give_the_same_numbers(tmp_path, method):
    hinge = "" if method.startswith("CENTRAL") else HINGED
    fast = run(tmp_path, method, hinge)
    kept = {name: fast.history(name) for name in fast.histories}
    fast.close()
    with interpreted():
        slow = run(tmp_path, method, hinge)
    for name, values in kept.items():
        size = np.abs(values).max(initial=1e-300)
        assert np.abs(slow.history(name) - values).max(initial=0.0) < 1e-10 * size, name


@pytest.mark.parametrize("step", [0, 1])
def test_iterations_that_use_a_factor_up_and_fail_end_in_parts(tmp_path, monkeypatch, step):
    """Newton's iterations may update the factor more often than it bears and find no equilibrium: a new
    factor does not help them, so the step is taken in parts.
    """
    tries = []

    def fails(sim, rules, scheme, coefs, end, h, at):
        if sim.run.step != step:
            return parts.try_step(sim, rules, scheme, coefs, end, h, at)
        tries.append(float(sim.run.time))
        assert tries.count(tries[-1]) < 4, "the same step is tried again and again"
        invalidate_factor(sim.run)
        return False

    right = run(tmp_path, "NEWMARK DT=0.001", every=0.2).history("node/u")
    monkeypatch.setattr(kernel, "try_step", fails)
    with interpreted():
        found = run(tmp_path, "NEWMARK DT=0.001", every=0.2)
    assert found.status == "done" and len(tries) >= 6
    assert np.abs(found.history("node/u") - right).max() < 1e-9 * np.abs(right).max()


@pytest.mark.parametrize("method", ["NEWMARK DT=1E-3", "CENTRAL DT=2E-4", "NEWMARK DT=1E-3 EVENTS=STEPPED"])
def test_envelopes_see_steps_between_the_outputs(tmp_path, method):
    """All steps, and both sides of every event: whether they are outputs makes no difference."""
    step, deck, both = float(method.split("=")[1].split()[0]), tmp_path / "free.inp", []
    for every in (20 * step, step):
        text = POUNDING.format(method=method, hinge="", turn="0.5", gap=0.005, every=every)
        # no motion of the ground, whose corners would cut the steps between two outputs unevenly
        text = text.replace("EQUAKE\n SINE AMPLITUDE=6 PERIOD=0.4 DURATION=1.2", "INITIAL\n 3,4 VX=0.5")
        deck.write_text(text)
        both.append(results_of(deck))
    rare, often = both
    assert rare.table("contact_summary")["closures"][0] > 1
    for name in ("node_envelope", "member_envelope"):
        for one, other in zip(rare.table(name), often.table(name)):
            size = max(abs(other["max"]), abs(other["min"]))
            assert abs(one["max"] - other["max"]) <= 1e-8 * size + 1e-12
            assert abs(one["min"] - other["min"]) <= 1e-8 * size + 1e-12
    t, place = often.history("time"), often.labels("node/u")
    for r in rare.table("node_envelope"):  # what was stored at every step is within
        x = often.history({"d": "node/u", "v": "node/v", "a": "node/a"}[r["quantity"][0]])
        own = x.reshape(len(t), -1)[:, place.index(f"{r['node']} {r['direction']}")]
        room = 1e-8 * np.abs(own).max() + 1e-12
        assert r["min"] - room <= own.min() and own.max() <= r["max"] + room


def test_full_matrices_have_an_end(tmp_path, monkeypatch):
    """EXACT and LAPLACE refuse more unknowns than they can hold, in words; AUTO takes another method."""
    monkeypatch.setattr(condensed, "MAX_UNKNOWNS", 2)
    for method in ("EXACT", "LAPLACE DT=0.001"):
        found = run(tmp_path, method, "")
        assert found.status == "stopped" and "A505" in found.message
        assert "unknowns are too many" in found.message and "NEWMARK" in found.message
    found = run(tmp_path, "AUTO TOL=1e-2", "")
    took = dict(found.table("run").tolist())["method"].split(",")[0]
    assert found.status == "done" and took in ("TAYLOR", "NEWMARK")


@NUMBA
@pytest.mark.slow  # numba compiles the kernel of the steps
def test_decks_with_any_number_of_rules_share_one_compiled_version(tmp_path):
    with by_numba(tmp_path):
        for hinge in ("", HINGED, HINGED.replace("BILINEAR", "ELASTO_PLASTIC").replace("R=0.05 ", "")):
            run(tmp_path, "NEWMARK DT=0.01", hinge)
        assert len(jit.compiled(kernel.advance).signatures) == 1
        rules = [imk_bilinear.RULE, bilinear.RULE]
        assert {len(f) for f in functions.tables(rules)} == {functions.ROOM}
        assert functions.tables(rules).transition[:2] == tuple(
            functions.tables([r]).transition[0] for r in rules
        )


@NUMBA
def test_a_kernel_is_cold_until_it_is_compiled(tmp_path, monkeypatch):
    monkeypatch.setattr(jit.numba().config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(kernel_cache, "cache_folder", lambda: kernel_cache.CacheFolder(tmp_path, ""))
    assert jit.cold(cubic.cubic_rise) and jit.cold(cubic.cubic_peak)
    peak = jit.compiled.__wrapped__(cubic.cubic_peak)
    assert jit.cold(cubic.cubic_peak)
    assert peak(0.0, 0.0, 1.0, -1.0, 1.0) == cubic.cubic_peak(0.0, 0.0, 1.0, -1.0, 1.0) == (0.5, 0.25)
    assert jit.cold(cubic.cubic_rise) and not jit.cold(cubic.cubic_peak)


BAR = """UNITS kN m s
PARAM  n = 12
NODES
 1 -5 0 FIX=XYR
 2 10.01 0 FIX=XYR
 100 TO 100+n  0 TO 10 0 FIX=YR
ELEMENTS
 1 SOFT 1 100
 2 MEET 100+n 2
 101 TO 100+n BAR 100 TO 99+n 101 TO 100+n
PROPS
 SOFT SPRING KX=5000
 BAR  FRAME E=1E6 A=1
 MEET CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1E5*n C=0
WEIGHTS
 100 TO 100+n 1000/n
INITIAL
 100 TO 100+n VX=0.3
ANALYSIS
 HISTORY 1 METHOD=NEWMARK DT={dt}
OUTPUT
 EVERY=0.1
"""


def bar(folder, dt):
    deck = folder / "bar.inp"
    deck.write_text(BAR.format(dt=dt))
    return results_of(deck)


def test_a_contact_that_opens_and_closes_again_late_in_a_coarse_step(tmp_path):
    """A bar against a wall; the step takes two periods of its first mode, and its end opens and returns."""
    found = bar(tmp_path, 0.05)
    assert not found.message
    collisions = found.table("collisions")
    assert 1 < len(collisions) < 10
    assert np.all(np.diff(collisions["t_start"]) > 1e-3)  # none returns at the instant when it opened


def test_changes_at_one_instant_stop_with_time_place_and_what_helps(tmp_path, monkeypatch):
    """With an interpolation from where the contact has just opened it would close there again and again,
    but for shorter parts of the step.
    """

    def at_start(laws, step, i, e):
        return within_step.event_value(laws, i, e, laws.now.deformation[i], laws.now.rate[i])[0]

    monkeypatch.setattr(locating, "value_at_start", at_start)
    monkeypatch.setattr(within_step, "MOVING_ALIKE", 1.0)  # else that counts as rounding
    monkeypatch.setattr(parts, "SHORTEST_PART", 1.0)
    with interpreted():
        told = bar(tmp_path, 0.05).message
    assert told.startswith("A503 at t = 0.703") and "at one instant" in told
    assert "element 2 (KELVIN_VOIGT)" in told and "DT well below 0.05, or METHOD=EXACT" in told


def test_too_many_changes_within_a_step_stop_before_their_log_is_full(tmp_path, monkeypatch):
    monkeypatch.setattr(allocation, "TRANSITIONS", 4 - 16 * 5)  # four rows for five laws
    told = run(tmp_path, "NEWMARK DT=0.1").message
    assert "more than 2 times within one step, the last in element" in told


CURVED = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 COL 1 2
PROPS
 COL SPRING KX=2000 FX=30 RULE=BOUC_WEN {items}
WEIGHTS
 2 98.1
EQUAKE
 SINE AMPLITUDE=6 PERIOD=0.5 DURATION=2
ANALYSIS
 HISTORY 2 METHOD=NEWMARK DT={dt}
OUTPUT
 EVERY=0.02
"""


def test_a_curved_law_against_an_ode_solver(tmp_path):
    """Bouc-Wen, N=2: the hysteretic part is an ODE of its own; scipy's DOP853 takes all three."""
    k, fy, r, m = 2000.0, 30.0, 0.1, 10.0
    dy = fy / k

    def rate(t, y):
        u, v, z = y
        force = r * k * u + (1 - r) * fy * z
        dz = (v - 0.5 * abs(v) * abs(z) * z - 0.5 * v * z * z) / dy
        return [v, -6.0 * np.sin(2 * np.pi * t / 0.5) - force / m, dz]

    times = np.arange(101) * 0.02
    ode = solve_ivp(rate, (0, 2), [0, 0, 0], "DOP853", times, rtol=1e-10, atol=1e-12, max_step=1e-3)
    errors = []
    for dt in (4e-3, 2e-3, 1e-3):
        deck = tmp_path / "curved.inp"
        deck.write_text(CURVED.format(dt=dt, items=f"R={r} N=2"))
        u = results_of(deck).history("node/u")[:, 1, 0]
        errors.append(np.abs(u - ode.y[0]).max() / np.abs(ode.y[0]).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 1.8) and errors[-1] < 1e-3, (errors, orders)


@settings(max_examples=60)
@given(st.integers(0, 10_000), st.integers(1, 40))
def test_the_sparse_factor_and_its_updates(seed, n):
    rng = np.random.default_rng(seed)
    half = rng.random((n, n)) < 2.0 / n
    linked = half | half.T | np.eye(n, dtype=bool)
    order = ldl.order(n, *np.nonzero(linked))
    assert sorted(order) == list(range(n))
    linked = linked[np.ix_(order, order)]
    a = np.where(linked, rng.standard_normal((n, n)), 0.0)
    a = a + a.T + np.diag(4.0 + np.abs(a).sum(axis=1))
    s = ldl.analyse(n, *np.nonzero(linked))
    columns = np.repeat(np.arange(n), np.diff(s.ap))
    l, d, row = np.zeros(len(s.li)), np.zeros(n), np.zeros(n)  # noqa: E741
    assert ldl.factor(s, a[s.ai, columns], l, d, row) == -1
    for _ in range(3):
        b = rng.standard_normal(n)
        x = b.copy()
        ldl.solve(s, l, d, x)
        assert np.abs(a @ x - b).max() < 1e-10
        first = int(rng.integers(n))
        rest = np.flatnonzero(linked[first] & (np.arange(n) > first))[:1]
        row[first], row[rest] = 1.0, -1.0
        a += 2.5 * np.outer(row, row)
        assert ldl.update(s, l, d, row, first, 2.5)
        assert not row.any()


def test_a_singular_matrix_names_its_unknown():
    s = ldl.analyse(3, *np.nonzero(np.ones((3, 3))))
    a = np.array([[2.0, 1.0, 1.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]])  # its last pivot is zero
    columns = np.repeat(np.arange(3), np.diff(s.ap))
    assert ldl.factor(s, a[s.ai, columns], *np.zeros((3, 3))) == 2


PUSHED = """NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=Y
ELEMENTS
 1 C 1 2
PROPS
 C FRAME E=2E7 A=0.1 I=0.001
WEIGHTS
 2 100 0
INITIAL
 2 UX=0.1
ANALYSIS
 HISTORY 0.5 METHOD={method}
OUTPUT
 EVERY=0.01
"""


def test_massless_rotations_start_in_balance(tmp_path):
    """A column pushed at its top: the rotation there follows as 3/2 u/h, and the steps start quietly."""
    found = []
    for method in ("EXACT", "NEWMARK DT=0.001"):
        deck = tmp_path / "pushed.inp"
        deck.write_text(PUSHED.format(method=method))
        found.append(results_of(deck).history("node/u")[:, 1])
        assert found[-1][0] == pytest.approx([0.1, 0.0, -0.05], abs=1e-12)
    assert np.abs(found[0] - found[1]).max() < 2e-4


JUMP = """NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 C 1 2
PROPS
 C SPRING KX=1000
WEIGHTS
 2 98.1
FORCES
 TABLE 2 FX=5 POINTS=0,0,0.3,0,0.3,1,5,1
INITIAL
 2 VX=0.1
ANALYSIS
 HISTORY 0.7 METHOD={method}
OUTPUT
 EVERY=0.1
"""


def test_a_load_that_jumps_within_the_run_keeps_the_order(tmp_path):
    def end(method):
        deck = tmp_path / "jump.inp"
        deck.write_text(JUMP.format(method=method))
        return results_of(deck).history("node/u")[-1, 1, 0]

    w = 10.0
    static = 5.0 / 1000.0
    exact = 0.1 / w * np.sin(w * 0.7) + static * (1 - np.cos(w * 0.4))
    assert end("EXACT") == pytest.approx(exact, abs=1e-12)
    for method in ("NEWMARK", "HHT", "CENTRAL"):
        errors = [abs(end(f"{method} DT={h}") - exact) for h in (4e-3, 2e-3, 1e-3)]
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        assert np.all((orders > 1.8) & (orders < 2.2)), (method, errors, orders)


def test_products_along_diagonals_and_row_by_row_are_those_of_the_matrix():
    rng, n = np.random.default_rng(3), 13
    a = (
        np.diag(rng.normal(size=n))
        + np.diag(rng.normal(size=n - 2), 2)
        + np.diag(rng.normal(size=n - 1), -1)
    )
    a[0, -1], a[7, 3], a[5, 5] = 3.0, -2.0, 0.0
    laid = allocation.product(a)
    assert laid.offsets.tolist() == [0, -1, 2] and laid.row.tolist() == [0, 7]
    x, y = rng.normal(size=n), np.full(n, np.nan)
    products.multiply(laid, x, y)
    assert np.allclose(y, a @ x, rtol=1e-14, atol=1e-14)


def test_lines_and_rings_are_eliminated_from_both_ends_on_few_diagonals():
    rng, n = np.random.default_rng(4), 40
    ring = np.eye(n, dtype=bool)
    ring[np.arange(n), np.arange(1, n + 1) % n] = True
    names = rng.permutation(n)
    linked = (ring | ring.T)[np.ix_(names, names)]
    own = ldl.order(n, *np.nonzero(linked))
    rows, columns = np.nonzero(linked[np.ix_(own, own)])
    assert sum(abs(rows - columns) == 4) >= 2 * (n - 8)  # a line would have 2, both ends in turn have 4
    assert len(ldl.analyse(n, rows, columns).li) <= 2 * n


SERIES = """PARAM  k = 1E4
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=YR
 3 0 0 FIX=YR
ELEMENTS
 1 WEAK 1 2
 2 STRONG 2 3
PROPS
 WEAK   SPRING KX=k FX=20 RULE=BILINEAR R=0.1
 STRONG SPRING KX=3*k FX=1000 RULE=BILINEAR R=0.1
WEIGHTS
 3 50
EQUAKE
 TABLE POINTS={points}
ANALYSIS
 HISTORY 4 METHOD={method}
"""


@pytest.mark.parametrize(
    "method", ["NEWMARK", "NEWMARK EVENTS=STEPPED", "HHT", "GENERALISED_ALPHA RHO=0.5"]
)
def test_springs_in_series_have_the_same_peaks(tmp_path, method):
    """A mass on two springs, nothing between them: one force goes through both, within the steps too."""
    rough = np.random.default_rng(1).normal(scale=5.0, size=401)
    points = ",".join(f"{0.01 * i:.2f},{a:.6f}" for i, a in enumerate(rough))
    deck = tmp_path / "series.inp"
    deck.write_text(SERIES.format(points=points, method=f"{method} DT=0.01"))
    found = results_of(deck).table("spring_envelope")
    assert found["yield_events"][0] > 5 and found["yield_events"][1] == 0
    for peak in (found["force_max"], found["force_min"]):
        assert peak[0] == pytest.approx(peak[1], rel=1e-9)
    assert found["deformation_max"][1] == pytest.approx(found["force_max"][0] / 3e4, rel=1e-9)


@pytest.mark.parametrize("rule", ["TAKEDA", "CLOUGH", "BILINEAR"])
def test_events_of_massless_hinges_are_as_many_however_short_the_step(tmp_path, rule):
    """Rates of hinges, there and back, tell the same at any step: rounding turns none of them around."""
    counts = []
    for h in (1e-3, 3.3e-5, 6e-6):
        deck = tmp_path / "frames.inp"
        hinge = HINGED.replace("BILINEAR", rule)
        text = POUNDING.format(method=f"NEWMARK DT={h}", hinge=hinge, turn="0", gap=0.02, every=0.1)
        deck.write_text(text.replace("HISTORY 1.2", "HISTORY 0.42"))
        found = results_of(deck)
        assert found.status == "done", found.message
        counts.append({x["item"]: x["value"] for x in found.table("run")}["events"])
    assert int(counts[0]) > 4 and len(set(counts)) == 1, counts


SPRUNG = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 COL 1 2
PROPS
 COL SPRING KX={k} FX={fy} RULE={rule}
WEIGHTS
 2 1
INITIAL
 2 VX={speed}
ANALYSIS
 HISTORY {end} METHOD={method}
OUTPUT
 EVERY={end}
"""


def looks(folder, method, rule, k=100.0, fy=1.0, speed=1.0, end=1.0):
    """Checks of one mass on one spring that say "look", by the heads of their names, and the results."""
    deck = folder / "sprung.inp"
    deck.write_text(SPRUNG.format(method=method, rule=rule, k=k, fy=fy, speed=speed, end=end))
    results = results_of(deck)
    told = [x for x in looked(results.checks) if "leans" not in x.remark]  # what has yielded does
    return {x.name[:20]: x.value for x in told}, results


@pytest.mark.parametrize(("share", "told"), [(0.98, False), (1.02, True)])
def test_steps_longer_than_a_falling_branch_allows_are_told(tmp_path, share, told):
    """m + h^2/4 k_t is negative for h above 2 sqrt(m / -k_t)."""
    h = share * 2.0 / 50.0**0.5
    found, _ = looks(tmp_path, f"NEWMARK DT={h!r}", "BILINEAR R=-0.5", end=6 * h)
    assert ("steps too long for a" in found) is told


@pytest.mark.parametrize(("dt", "told"), [(0.09, False), (0.2, True)])
def test_steps_that_a_springs_force_leaves_behind_are_told(tmp_path, dt, told):
    """In free vibration the force rises by omega h of its largest in a step, at most."""
    found, _ = looks(tmp_path, f"NEWMARK DT={dt}", "BILINEAR R=0", fy=1e6, end=20.0)
    assert ("steps in which a spr" in found) is told
    if told:
        assert found["steps in which a spr"] == pytest.approx(1.0 / (10.0 * dt), rel=0.1)


@pytest.mark.parametrize(
    ("method", "digits"), [("NEWMARK DT=0.01", 1e-12), ("EXACT", 1e-12), ("LAPLACE DT=0.01", 1e-10)]
)
def test_springs_too_stiff_for_the_way_they_slip_are_told(tmp_path, method, digits):
    """A block that slips 0.9 m on hardly any friction `fy`, held by 100 kN/m where it sticks."""
    for share, told in ((2e-3, False), (0.2, True)):
        fy = digits * 100.0 * 0.9 / share
        found, results = looks(tmp_path, method, "ELASTO_PLASTIC", fy=fy, end=0.9)
        assert results.table("spring_envelope")["deformation_max"][0] == pytest.approx(0.9, rel=1e-3)
        assert ("share of the force o" in found) is told
        if told:
            assert found["share of the force o"] == pytest.approx(share, rel=0.1)


TOUCHED = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 1 0 FIX=XYR
 4 1 1 FIX=YR
ELEMENTS
 1 STOREY 1 2
 2 STOREY 3 4
 3 MEET 2 4
PROPS
 STOREY SPRING KX=40
 MEET CONTACT GAP=0.05 ANGLE=0 LAW=KELVIN_VOIGT E=0.5 K=40000 MASSES=1,1
WEIGHTS
 2 1
INITIAL
 2 VX=1
ANALYSIS
 HISTORY 0.4 METHOD={method}
OUTPUT
 EVERY=0.001
"""


@pytest.mark.parametrize(
    "method", ["EXACT", "LAPLACE DT=0.001", "NEWMARK DT=0.001", "NEWMARK DT=0.0001", "HHT DT=0.001"]
)
def test_the_dashpot_of_a_contact_does_not_hit_a_node_without_mass(tmp_path, method):
    """The node is carried along at once: the contact has no more force than the storey behind it."""
    deck = tmp_path / "touched.inp"
    deck.write_text(TOUCHED.format(method=method))
    results = results_of(deck)
    peak = results.table("contact_summary")["peak_force"][0]
    u = results.history("node/u")[:, 3, 0]
    assert peak == pytest.approx(40.0 * u.max(), rel=1e-4)


#: a frame whose beam lets its two nodes move together, but for rounding; a spring beside the beam, or none
TOGETHER = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 2
 3 5 2
 4 5 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 BEAM 2 3
 3 COL 4 3
 {beside}
PROPS
 COL FRAME E=3E7 A=0.16 I=0.002 {hinges}
 BEAM FRAME E=3E7 A=0.2 I=0.005
 SOFT SPRING KX=100 FX=5 RULE={rule}
WEIGHTS
 2 200 200 1
 3 200 200 1
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2
EQUAKE
 SINE AMPLITUDE=6 PERIOD=0.35
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.25 METHOD={method}
"""


@each_once(
    ("rule", ["MENEGOTTO_PINTO R=0.02", "BOUC_WEN N=2", "RAMBERG_OSGOOD N=5"]),
    ("method", ["NEWMARK DT=2E-3", "HHT DT=2E-3", "GENERALISED_ALPHA DT=2E-3", "CENTRAL DT=1E-4"]),
)
def test_a_smooth_spring_between_nodes_that_move_together_does_not_reverse(tmp_path, rule, method):
    """The rounding of its rate is no motion: that of the frame is the one without the spring."""
    hinges = "" if method.startswith("CENTRAL") else "RULE=BILINEAR R=0.02 MI=60 MJ=60 LP=0.2"
    deck, motions = tmp_path / "deck.inp", []
    for beside in ("4 SOFT 2 3", ""):
        deck.write_text(TOGETHER.format(beside=beside, hinges=hinges, rule=rule, method=method))
        found = results_of(deck)
        assert found.status == "done", found.message
        motions.append(found.history("node/u"))
    assert np.abs(motions[0] - motions[1]).max() < 1e-11 * np.abs(motions[1]).max()
