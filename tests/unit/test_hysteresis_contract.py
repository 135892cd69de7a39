"""The contract that every hysteresis rule of the catalog keeps, along random paths.

A new rule is held to it as soon as its file declares a SPEC: with the `sample` there, and with all its
defaults if nothing must be given.  SAMPLES has further parameters to try.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contract
from contract import CLAUSES
from kernels import NUMBA, by_numba
from paths import Walk, turning_points
from pound_deck.schema import REQUIRED, Field, Spec
from pound_solve.catalog import catalog
from pound_solve.laws import functions
from pound_solve.laws.automaton import (
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    Law,
    Numbers,
    Rule,
    above,
    drive,
    linear,
    on_spring,
)
from pound_solve.laws.condensed import without
from pound_solve.laws.hysteresis import bilinear, cracking, slipping, wayne_stewart
from samples import values

pytestmark = pytest.mark.full

K = 800.0  #: initial stiffness
PLUS, MINUS = 12.0, -8.0  #: yield forces: at +15 and -10 mm
REACH = 0.1  #: paths run between plus and minus this

LOSS = {"DUCT1": 1.5, "DUCT2": 5.0, "RDUCT": 0.3}
DEGRADING: list[dict[str, Any]] = [
    {},
    {"R": 0.05, "ALFA": 0.4},
    {"R": 0.3, "ALFA": 1.0},
    {"R": 0.02, "ALFA": 0.5, "ILOS": "EACH", **LOSS},
    {"ILOS": "LARGEST", **LOSS},
    {"ALFA": 1.0, "ILOS": "EACH", "DUCT1": 1.0, "DUCT2": 2.0, "RDUCT": 0.2},
    {"R": 0.1, "ALFA": 0.4, "ILOS": "EACH", **LOSS, "DUCT3": 8.0},
    {"R": 0.05, "ILOS": "LARGEST_RCYC", "RCYC": 8.0, **LOSS, "DUCT3": 7.0},
    {"ILOS": "CYCLES", "DUCT1": 1.0, "DUCT2": 6.0, "RDUCT": 0.4},
]
#: the loss of rules with a crack point, beyond their yield point at 0.04 or so
CRACKED_LOSS = {"ILOS": "EACH", "DUCT1": 1.0, "DUCT2": 1.6, "RDUCT": 0.3}
FALLING = [{n: v for n, v in sample.items() if n != "ALFA"} for sample in DEGRADING if "ILOS" in sample]
#: at 0.045 (or 0.025) the cap; capacities that make the component fail on some paths, and not on others
CAPPED: list[dict[str, Any]] = [
    {"DP": (0.03,), "DPC": (0.1,)},
    {"R": 0.05, "DP": (0.03,), "DPC": (0.1,), "RESIDUAL": 0.2, "LAMBDA": (1.0,)},
    {
        "R": 0.1,
        "DP": (0.04, 0.02),
        "DPC": (0.05, 0.1),
        "RESIDUAL": 0.1,
        "LAMBDA": (1.0, 0.8, 1.0),
        "C": 1.5,
    },
    {"R": 0.02, "DP": (0.01,), "DPC": (0.03,), "LAMBDA": (0.5, 0.0, 2.0)},
]

#: further parameters to try; what is left out has its default
SAMPLES: dict[str, list[dict[str, Any]]] = {
    "BILINEAR": [*({"R": r} for r in (-0.1, 0.0, 0.05, 0.4, 0.9)), *FALLING],
    "BILINEAR_ELASTIC": [{"R": r} for r in (0.0, 0.1, 0.7)],
    "BILINEAR_SLACK": [
        {"R": r, "SLACK": slack, "GROW": grow}
        for r, slack in ((0.0, (0.0,)), (0.05, (0.004, -0.002)), (0.4, (0.004,)), (0.9, (0.004, -0.002)))
        for grow in ("YES", "NO")
    ]
    + [
        {"R": r, "SLACK": (0.004, -0.002), "GROW": "YES", "ILOS": "EACH", **LOSS, "DUCT3": gone}
        for r, gone in ((0.0, None), (0.05, 5.5))
    ],
    "BOUC_WEN": [{"R": 0.0, "N": 1.0}, {"R": 0.1, "N": 2.0}, {"R": 0.05, "N": 1.5, "BETA": 0.7}],
    "CLOUGH": DEGRADING,
    "DEGRADING_BILINEAR": DEGRADING,
    "ELASTO_PLASTIC": [{}, *({n: v for n, v in sample.items() if n != "R"} for sample in FALLING)],
    "FLAG_SHAPED": [{"R": r, "BETA": beta} for r, beta in ((0.0, 1.0), (0.1, 0.5), (0.4, 0.9), (0.9, 0.1))],
    "IMK_BILINEAR": CAPPED,
    "IMK_PEAK_ORIENTED": CAPPED,
    "IMK_PINCHING": [
        {**sample, "KAPPAF": f, "KAPPAD": d} for sample in CAPPED for f, d in ((0.3, 0.5), (0.7, 0.0))
    ],
    "MASONRY_STRUT": [
        {"DM": 0.02, "DU": 0.06},
        {"DM": 0.018, "DU": 0.03, "ARE": 0.0},
        {"DM": 0.03, "DU": 0.09, "DCL": -0.05, "ACH": 0.0, "GPLU": 0.0, "GUN": 1.5, "EX2": 0.0},
        {"DM": 0.03, "DU": 0.2, "DCL": 0.01, "BA": 0.5, "BCH": 0.9, "EX1": 0.0},
        {"DM": 0.05, "DU": 0.08, "ACH": 0.95, "ARE": 1.0, "BCH": 0.5, "GUN": 5.0, "GPLU": 1.0, "GPLR": 2.0},
    ],
    "MATSUSHIMA": [
        {"R": r, "ALFA": alfa, "BETA": beta}
        for r, alfa, beta in ((0.0, 0.8, 0.9), (0.3, 0.5, 0.5), (0.1, 1.0, 0.6), (0.9, 0.3, 1.0))
    ],
    "ORIGIN_CENTRED": [{n: v for n, v in sample.items() if n != "ALFA"} for sample in DEGRADING],
    "Q_HYST": DEGRADING,
    "RAMBERG_OSGOOD": [{"N": 5.0}, {"N": 1.7, "ALPHA": 0.4}, {"N": 15.0, "ALPHA": 2.0}],
    "RING_SPRING": [
        {"R": r, "LOWER": lower} for r, lower in ((0.0, 0.3), (0.1, 0.9), (0.4, 0.1), (0.9, 0.5))
    ],
    "SCHOETTLER_RESTREPO": [
        {"R": 0.0, "ALFA": 0.5, "PINCH": 0.3, **CRACKED_LOSS},
        {"R": 0.05, "RHO": (0.9, 0.6), **CRACKED_LOSS, "DUCT3": 2.0},
    ],
    "SINA": [
        {"R": 0.3, "ALFA": 1.0, "FCC": (0.05, 0.6)},
        {"R": 0.02, "FCR": (0.2, 0.7), "RHO": (0.3, 0.8), "ALFA": 0.5, "FCC": (0.9,)},
        {"R": 0.9, "FCR": (0.9, 0.1), "RHO": (0.9, 0.1), "ALFA": 1.0, "FCC": (0.01,)},
        {"R": 0.0, "FCR": (0.05, 0.9), "RHO": (0.05, 0.9), "ALFA": 1.0},
        {"R": 0.0, "ALFA": 0.5, **CRACKED_LOSS},
        {"R": 0.05, "RHO": (0.9, 0.6), **CRACKED_LOSS, "DUCT3": 2.0},
    ],
    "TAKEDA": [*DEGRADING, *({**sample, "BETA": beta} for sample in DEGRADING for beta in (0.6, 1.0))],
    "TAKEDA_SLIP": [
        {"R": 0.3, "ALFA": 1.0, "SLIP": 0.0, "INNER": 0.3},
        {"R": 0.02, "FCR": (0.2, 0.7), "RHO": (0.3, 0.8), "ALFA": 0.5, "INNER": 0.1},
        {"R": 0.9, "FCR": (0.9, 0.1), "RHO": (0.9, 0.1), "ALFA": 1.0, "SLIP": 10.0},
        {"R": 0.0, "FCR": (0.05, 0.9), "RHO": (0.05, 0.9), "ALFA": 1.0, "INNER": 0.01},
        {"R": 0.0, "ALFA": 0.5, **CRACKED_LOSS},
        {"R": 0.05, "RHO": (0.9, 0.6), **CRACKED_LOSS, "DUCT3": 2.0},
    ],
    "TRILINEAR": [
        {"R": 0.5, "F2": (1.3,)},
        {"R": 0.3, "R2": 0.05, "F2": (1.5, 2.5)},
        {"R": 0.2, "R2": -0.05, "F2": (1.1,)},
    ],
    "WAYNE_STEWART": [
        {"R": 0.1, "FU": (16.0,), "FI": 2.0, "PTRI": -0.05, "PUNL": 1.5, "BETA": 1.1, "ALPHA": 0.6},
        {
            **{"R": 0.2, "FU": (20.0, -12.0), "FI": 0.0, "PTRI": -0.02, "ALPHA": 0.9},
            **{"SLACK": (0.005, -0.003), "RPINCH": 0.0},
        },
        {"R": 0.1, "FU": (15.0,), "FI": 4.0, "PUNL": 2.0, "ALPHA": 0.3, "SLACK": (0.004,), "RPINCH": 0.0},
    ],
}

SAME_BOTH_WAYS = {"RAMBERG_OSGOOD"}  #: rules that take no unequal yield forces
ONE_SIDED = {"MASONRY_STRUT"}  #: rules without a force in tension

RULES = {s.name: s for s in catalog().family("hysteresis").values() if s.impl is not None}


def samples_of(spec: Spec) -> list[dict[str, Any]]:
    """Parameters to try for a rule."""
    found = [values(spec, PLUS, PLUS / K), *SAMPLES.get(spec.name, ())]
    if all(f.default is not REQUIRED for f in spec.fields):
        found.append({})
    return [x for n, x in enumerate(found) if x not in found[:n]]


def test_samples_are_of_rules_that_there_are() -> None:
    assert set(SAMPLES) <= set(RULES)


def filled(spec: Spec, sample: dict[str, Any]) -> dict[str, Any]:
    """Values of a card: the sample, and the defaults of the other fields."""
    values = {f.name: f.default for f in spec.fields} | sample
    assert set(values) == {f.name for f in spec.fields}, f"{spec.name} has no such fields"
    assert REQUIRED not in values.values(), f"{spec.name}: the sample leaves out what must stand"
    for f in spec.fields:
        if values[f.name] is not None:
            assert allowed(f, values[f.name]), (
                f"{spec.name} {f.name}={values[f.name]}: a deck may not say so"
            )
    return values


def allowed(f: Field, value: Any) -> bool:
    """Whether the reader would accept a value."""
    if f.words:
        return value in f.words
    numbers = value if isinstance(value, tuple) else (value,)
    return f.count[0] <= len(numbers) <= f.count[1] and all(
        (f.lo is None or x >= f.lo)
        and (f.hi is None or x <= f.hi)
        and (f.above is None or x > f.above)
        and (f.below is None or x < f.below)
        for x in numbers
    )


def cases(minus: float, but: AbstractSet[str] = frozenset()) -> Iterator[Any]:
    for name in sorted(RULES.keys() - but):
        for sample in samples_of(RULES[name]):
            side = -PLUS if name in SAME_BOTH_WAYS else minus
            law = RULES[name].impl(filled(RULES[name], sample), K, PLUS, side)
            yield pytest.param(law, sample, id=f"{name} {minus} {sample}")


def one_of_each(cases: Iterable[Any]) -> list[Any]:
    """The first case of each rule in every check, the others at night."""
    first = {case.id.split()[0]: case.id for case in reversed([*cases])}
    at_night = pytest.mark.slow
    return [
        pytest.param(*case.values, id=case.id, marks=() if case.id in first.values() else at_night)
        for case in cases
    ]


UNEQUAL, EQUAL = list(cases(MINUS)), list(cases(-PLUS, ONE_SIDED))
every = pytest.mark.parametrize(("law", "sample"), UNEQUAL)


def kept_by(law: Law) -> list[Callable[[Law, float], None]]:
    """The clauses that a rule keeps.

    A virgin WAYNE_STEWART spring unloads along another line than one that has yielded by however little:
    where a tiny mass swings about its strength, that must not be left out.
    """
    but = [contract.resting_at_its_strength_is_not_yielding] * (law.rule is wayne_stewart.RULE)
    return [clause for clause in CLAUSES if clause not in but]


CURVED = [case for case in UNEQUAL if case.values[0].curved]  # these take seconds


@pytest.mark.parametrize(
    ("law", "sample"), [*(case for case in UNEQUAL if case not in CURVED), *one_of_each(CURVED)]
)
def test_contract(law: Law, sample: dict[str, Any]) -> None:
    for clause in kept_by(law):
        clause(law, REACH)


STRAIGHT = [
    pytest.param(law, share, id=f"{case.id} less {share}")
    for case in UNEQUAL
    for law in case.values[:1]
    for share in (0.5, 0.25)
    if isinstance(law, Law) and not law.curved and share * law.rule.steepest(law.p) < 0.9 * law.p[0]
]


@pytest.mark.parametrize(("law", "share"), one_of_each(STRAIGHT))
def test_contract_without_a_share_of_the_elastic_deformation(law: Law, share: float) -> None:
    """The same contract (by rounding, two events at one place may change their order, so that the branch in
    between differs), and the same forces at deformations that are smaller by that share of f / k.
    """
    less = without(law, share)
    for clause in kept_by(law):
        if clause is not contract.trying_changes_nothing:
            clause(less, REACH)
    for seed in range(3):
        whole, part = Walk(law), Walk(less)
        for goal in turning_points(seed, REACH):
            whole.move(goal)
            part.move(goal - share * whole.force / law.p[0])
            assert part.force == pytest.approx(whole.force, abs=1e-9 * K * REACH)
            gone = 0.5 * share * whole.force**2 / law.p[0]
            assert part.work == pytest.approx(whole.work - gone, abs=1e-9 * K * REACH**2)


@pytest.mark.parametrize(("law", "sample"), EQUAL)
def test_symmetric_parameters_answer_symmetrically(law: Law, sample: dict[str, Any]) -> None:
    if any(len(v) == 2 for v in sample.values() if isinstance(v, tuple)):
        pytest.skip("two different sides")
    for seed in range(3):
        one, other = Walk(law), Walk(law)
        for goal in turning_points(seed, REACH):
            one.move(goal)
            other.move(-goal)
            assert other.force == pytest.approx(-one.force, abs=1e-10)
            assert other.work == pytest.approx(one.work, abs=1e-10)


# ---------------------------------------------------------------------- any history


def envelope(law: Law, d: float) -> float:
    """Largest force of the virgin rule on the way to `d`, with the sign of `d`."""
    walk = Walk(law).move(d)
    ends = [law.force(s, x)[0] for s, a, b in walk.visits for x in (a, b)]
    return max(ends) if d > 0.0 else min(ends)


def corner(law: Law, sample: dict[str, Any], fy: float, which: int) -> float:
    """Deformation of a side where the last yield line of the virgin rule begins."""
    if law.rule is slipping.RULE:  # its lines to the yield point lie above the cracked backbone
        return fy / (law.p[cracking.RHO : cracking.RHO + 2][which] * K)
    ratio = (sample["F2"][which] - 1.0) / sample["R"] if "F2" in sample else 0.0
    slack = sample.get("SLACK", (0.0,))
    gap = slack[which] if len(slack) == 2 else slack[0] * np.sign(fy)
    return fy / K * (1.0 + ratio) + float(gap)


def bounds(law: Law, sample: dict[str, Any], minus: float) -> Callable[[float, float], tuple[float, float]]:
    """Limits of the force once the deformation has reached `low` and `high`: those of the virgin rule.

    A kinematic rule may get to its last yield line sooner than the virgin one; where that line falls
    (negative hardening) it is higher on the other side.  A curve comes to its yield line far out.
    """
    if law.curved:
        begin_plus, begin_minus = 10.0 * REACH, -10.0 * REACH
    else:
        begin_plus, begin_minus = corner(law, sample, PLUS, 0), corner(law, sample, minus, -1)
    fall = -min(sample.get("R", 0.0), sample.get("R2", 0.0), 0.0) * K

    def at(low: float, high: float) -> tuple[float, float]:
        low, high = min(low, begin_minus), max(high, begin_plus)
        over = fall * (high - low)
        return envelope(law, low) - over, envelope(law, high) + over

    return at


numbers = st.lists(st.floats(-REACH, REACH), min_size=1, max_size=30)


@settings(max_examples=12)
@given(path=numbers)
@every
def test_any_history_keeps_within_the_backbone(law: Law, sample: dict[str, Any], path: list[float]) -> None:
    """No NaN, no force beyond the backbone, no branch changes without motion (`pieces` counts them)."""
    walk, limits = Walk(law), bounds(law, sample, MINUS)
    low = high = 0.0
    for goal in path:
        walk.move(goal)
        low, high = min(low, goal), max(high, goal)
    bottom, top = limits(low, high)
    for state, a, b in walk.visits:
        for d in (a, b):
            assert bottom - 1e-10 <= law.force(state, d)[0] <= top + 1e-10
    assert np.isfinite(walk.work) and law.stored(walk.state, walk.d) <= walk.work + 1e-10


@pytest.mark.parametrize(("law", "sample"), one_of_each(UNEQUAL))
def test_a_long_history(law: Law, sample: dict[str, Any]) -> None:
    """Two thousand turns, most of them small, as in a long earthquake."""
    rng = np.random.default_rng(11)
    state, d, most = law.start(), 0.0, 0.0
    bottom, top = bounds(law, sample, MINUS)(-REACH, REACH)
    for goal in (REACH * np.sin(np.arange(400) * 0.7) * rng.uniform(-0.2, 1.0, 400)).tolist():
        for x in (goal, *(goal + 1e-3 * rng.uniform(-1.0, 1.0, 4)).clip(-REACH, REACH).tolist()):
            state = drive(law, state, d, x, limit=60)
            d = x
            f = law.force(state, d)[0]
            assert bottom - 1e-10 <= f <= top + 1e-10
            most = max(most, abs(f))
            assert np.isfinite(law.work(state, d))
    assert most > 0.3 * PLUS


# ---------------------------------------------------------------------- compiled


@pytest.fixture
def numba(tmp_path: Path) -> Iterator[None]:
    """Numba compiles the functions; test_ahead_of_time compares those of a library."""
    with by_numba(tmp_path):
        yield


@NUMBA
@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(RULES))
@pytest.mark.usefixtures("numba")
def test_compiled_functions_give_the_same_numbers(name: str) -> None:
    compare([p.values[0] for p in UNEQUAL if p.id.startswith(f"{name} ")])


@NUMBA
@pytest.mark.slow
@pytest.mark.parametrize("name", sorted({p.id.split()[0] for p in STRAIGHT}))
@pytest.mark.usefixtures("numba")
def test_compiled_functions_of_a_law_without_a_share_of_its_deformation(name: str) -> None:
    compare([without(*p.values) for p in STRAIGHT if p.id.startswith(f"{name} ")][:4])


def compare(laws: Sequence[Law]) -> None:
    """Hold compiled functions to those of Python along a path."""
    for law in laws:
        rule = law.rule
        branch, transition, recoverable, curve, power, _, smooth = (f[0] for f in functions.tables([rule]))
        p = law.p + (0.0,) * (functions.PARAMETERS - rule.parameters)
        rest = (0.0,) * (functions.VARIABLES - rule.variables)
        walk = Walk(law).move(*turning_points(3, REACH))
        for n, (state, _, d) in enumerate(walk.visits):
            at, d0, own = state[0], state[1], state[3]
            m = own + rest
            assert branch(p, at, m) == pytest.approx(rule.branch(law.p, at, own), rel=1e-13, abs=1e-13)
            f = law.force(state, d)[0]
            expected = rule.recoverable(law.p, at, own, d, f)
            assert recoverable(p, at, m, d, f) == pytest.approx(expected, rel=1e-13)
            assert power(p, at, m, d, 1.0) == law.dissipated_power(state, d, 1.0) == 0.0
            if rule.curve is not None:
                expected = rule.curve(law.p, at, own, d0, d, 0.0)
                assert curve(p, at, m, d0, d, 0.0) == pytest.approx(expected, rel=1e-12, abs=1e-13)
            if rule.smooth_curve is not None:
                expected = rule.smooth_curve(law.p, at, own, d, f)
                assert smooth(p, at, m, d, f) == pytest.approx(expected, rel=1e-12, abs=1e-13)
            if n + 1 < len(walk.visits) and walk.visits[n + 1][0] is not state:
                for way in range(len(law.branch(state).events)):
                    there, memory = transition(p, at, m, way, d, 0.0)
                    to, now = rule.transition(law.p, at, own, way, d, 0.0)
                    assert there == to
                    assert memory == pytest.approx(now + rest, rel=1e-12, abs=1e-13)


# ---------------------------------------------------------------------- the contract can fail


def jumps(p: Numbers, at: int, m: Numbers) -> Numbers:
    k, c, f0, *events = bilinear.branch(p, at, m)
    return (k, c, 1.01 * f0 if at == bilinear.YIELDING_PLUS else f0, *events)


def too_stiff(p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float) -> tuple[float, ...]:
    """A curve with the right force and work, and a wrong tangent."""
    k, _, f0 = bilinear.branch(p, at, m)[:3]
    return k * d + f0, 1.01 * k, 0.0, (0.5 * k * (d + d0) + f0) * (d - d0)


def idle(p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float) -> tuple[float, ...]:
    """A curve with the right force, and a wrong work."""
    f, k, c, work = too_stiff(p, at, m, d0, d, v)
    return f, k / 1.01, c, 0.99 * work


def elsewhere(p: Numbers, at: int, m: Numbers, way: int, d: float, v: float) -> tuple[int, Numbers]:
    """Unloads along a line that does not pass through the point where the motion turned."""
    there, memory = bilinear.transition(p, at, m, way, d, v)
    return there, (0.5 * memory[0],) if at != bilinear.ELASTIC else memory


def backward(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Once it has slipped, it yields at a force that is exceeded already where it unloads."""
    k, c, f0, *events = bilinear.branch(p, at, m)
    if at == bilinear.ELASTIC and m[0] != 0.0:
        events[2] += 0.2 * p[1]
    return (k, c, f0, *events)


def more(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    return 1.01 * on_spring(p, at, m, d, f)


def less(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    return 0.99 * on_spring(p, at, m, d, f)


def hardened(p: Numbers, m: Numbers) -> Numbers:
    """A fifth more strength once it has yielded, by however little."""
    return p if m[0] == 0.0 else (p[0], 1.2 * p[1], 1.2 * p[2], p[3])


def hardened_branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    return bilinear.branch(hardened(p, m), at, m)


def hardened_transition(
    p: Numbers, at: int, m: Numbers, way: int, d: float, v: float
) -> tuple[int, Numbers]:
    return bilinear.transition(hardened(p, m), at, m, way, d, v)


def forgetful() -> Callable[[Numbers, int, Numbers], Numbers]:
    """A branch that softens a little with every question."""
    asked = count()

    def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
        k, *others = bilinear.branch(p, at, m)
        return (k * (1.0 - 1e-9 * next(asked)), *others)

    return branch


@pytest.mark.parametrize(
    ("clause", "wrong", "says"),
    [
        (contract.trying_changes_nothing, {"branch": forgetful()}, "asking changed the law"),
        (contract.force_is_continuous, {"branch": jumps}, "the force jumps"),
        (contract.force_is_continuous, {"transition": elsewhere}, "the force jumps"),
        (contract.branches_begin_clear_of_their_exits, {"branch": backward}, "an exit is above zero"),
        (contract.tangent_is_the_slope_of_the_force, {"curve": too_stiff}, "the tangent"),
        (contract.work_is_the_area_below_the_force, {"curve": idle}, "the work"),
        (contract.stored_energy_comes_back, {"recoverable": more}, "more is stored"),
        (contract.stored_energy_comes_back, {"recoverable": less}, "less is stored"),
        (
            contract.resting_at_its_strength_is_not_yielding,
            {"branch": hardened_branch, "transition": hardened_transition},
            "rounding decides",
        ),
    ],
)
def test_the_contract_tells_a_wrong_rule(
    clause: Callable[[Law, float], None], wrong: dict[str, Any], says: str
) -> None:
    numbers = (K, PLUS, MINUS, 0.3)
    clause(Law(bilinear.RULE, numbers), REACH)
    with pytest.raises(AssertionError, match=says):
        clause(Law(replace(bilinear.RULE, **wrong), numbers), REACH)


def test_the_contract_tells_a_rule_that_gives_energy() -> None:
    """A loop run the wrong way round: low on the way up, high on the way down, without a jump."""

    def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
        k = (1.0 if at == 0 else 2.0) * p[0]
        return linear(k, m[0] - k * m[1], REVERSAL_DOWN if at == 0 else REVERSAL_UP)

    def transition(p: Numbers, at: int, m: Numbers, way: int, d: float, v: float) -> tuple[int, Numbers]:
        f = m[0] + (1.0 if at == 0 else 2.0) * p[0] * (d - m[1])
        return 1 - at, (f, d)

    law = Law(
        Rule(
            BranchKind.ELASTIC.named("up", "down"),
            lambda p: (0, (0.0, 0.0)),
            branch,
            transition,
            parameters=1,
            variables=2,
        ),
        (K,),
    )
    with pytest.raises(AssertionError, match="gives energy"):
        contract.closed_loops_dissipate(law, REACH)


def test_a_rule_that_cycles_is_told() -> None:
    def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
        return linear(p[0], 0.0, above(0.5 * REACH))

    law = Law(
        Rule(
            BranchKind.ELASTIC.named("one", "other"),
            bilinear.start,
            branch,
            lambda p, at, m, w, d, v: (1 - at, m),
            parameters=1,
            variables=1,
        ),
        (K,),
    )
    with pytest.raises(AssertionError, match="without moving"):
        Walk(law).move(REACH)
