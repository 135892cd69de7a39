"""Separations from many records: two oscillators under noise, known distributions, runs that meet."""

import math

import h5py
import numpy as np
import pytest
from scipy.signal import lsim
from scipy.stats import binom

from pound_solve.cli.main import main
from pound_solve.report.plot import suites
from pound_solve.report.sweep.separation import drawn, needs, probabilities
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import Asked, CurveError, curves, demands
from pound_solve.statistics.fragility import from_capacities
from pound_solve.statistics.fragility_of_sweep import STOPS, fit
from pound_solve.statistics.incremental import capacity
from pound_solve.statistics.needed_gaps import NeededGaps, Options, groups
from pound_solve.statistics.separation import RULES, SeparationPeaks, correlation, share
from sweep.small import swept

T1, T2, XI = 0.5, 0.8, 0.05
DECK = """TITLE  Two oscillators side by side
UNITS  kN m s
PARAM  gap = 1
GRAVITY 1
NODES
   1  0 0  FIX=XYR
   2  1 0  FIX=YR
   3  9 0  FIX=XYR
   4  8 0  FIX=YR
ELEMENTS
   1  LEFT  1 2
   2  RIGHT 3 4
   3  HIT 2 4  NAME="roof"
PROPS
   LEFT  SPRING KX={k1}
   RIGHT SPRING KX={k2}
   HIT   CONTACT GAP=gap LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
   2,4 1
DAMPING
   MODAL XI={xi}
EQUAKE
   RECORD "noise0.txt" UNIT=M/S2
ANALYSIS
   MODAL 2
   HISTORY 20 METHOD=EXACT
"""
STUDY = """deck = "pair.inp"

[grid]
gap = {gaps}

[[motions]]
files = ["noise*.txt"]
unit = "M/S2"
scale = [1, 0.5]
"""
DT, COUNT = 0.02, 6


def noise(number):
    """White between its samples of 20 s."""
    return np.random.default_rng(number).normal(size=1001)


def study(folder, gaps="[1]"):
    stiff = [(2.0 * math.pi / t) ** 2 for t in (T1, T2)]
    (folder / "pair.inp").write_text(DECK.format(k1=stiff[0], k2=stiff[1], xi=XI))
    for n in range(COUNT):
        rows = (f"{DT * i:.4f} {a!r}" for i, a in enumerate(noise(n).tolist()))
        (folder / f"noise{n}.txt").write_text("\n".join(rows) + "\n")
    path = folder / "pair.toml"
    path.write_text(STUDY.format(gaps=gaps))
    return path


@pytest.fixture(scope="module")
def free(tmp_path_factory):
    """A sweep whose gap stays open, and its file."""
    path = swept(study(tmp_path_factory.mktemp("free"))).write()
    return Sweep.open(path), path


def motion(number, period):
    """Displacements of an oscillator, integrated apart, at 40 instants of each step of the record."""
    w, fine = 2.0 * math.pi / period, 40
    t = np.arange(1001) * DT
    dense = np.linspace(0.0, t[-1], 1000 * fine + 1)
    system = ([[0.0, 1.0], [-w * w, -2.0 * XI * w]], [[0.0], [-1.0]], [[1.0, 0.0]], [[0.0]])
    return lsim(system, np.interp(dense, t, noise(number)), dense)[1]


@pytest.mark.full
def test_runs_tell_peaks_and_the_gap_that_they_need(free):
    sweep, _ = free
    for number in range(COUNT):
        u1, u2 = motion(number, T1), motion(number, T2)
        (row,) = np.flatnonzero((sweep["record"] == f"noise{number}.txt") & (sweep["scale"] == 1.0))
        expected = np.abs(u1).max(), np.abs(u2).max(), (u1 - u2).max()
        found = [sweep[name][row, 0] for name in ("peak_i", "peak_j", "needed_gap")]
        assert found == pytest.approx(expected, rel=2e-4)
        assert sweep["correlation"][row, 0] == pytest.approx(correlation(T1, T2, XI, XI), rel=1e-9)
        assert sweep["given_gap"][row, 0] == 1.0


@pytest.mark.full
def test_the_double_difference_is_near_under_noise_and_sums_are_not(free):
    """The gap is needed to one side, the peaks are of both: half as many crests make it a little less."""
    found = [g for g in groups(free[0], Options()) if g.level == 1.0]
    (group,) = found
    rules = {rule.name: gap for rule, gap in zip(RULES, group.rules)}
    assert 0.85 < group.needed.mean() / rules["DDC"] < 1.02
    assert rules["ABS"] > rules["SRSS"] > rules["DDC"]
    assert group.needed.mean() < 0.8 * rules["ABS"]
    assert group.contacts(0.0) == (COUNT, COUNT) and group.contacts(rules["ABS"]) == (0, COUNT)


def test_motion_is_linear_in_the_level(free):
    half, whole = sorted(groups(free[0], Options()), key=lambda g: g.level)
    assert (half.level, whole.level) == (0.5, 1.0)
    np.testing.assert_allclose(half.needed * 2.0, whole.needed, rtol=1e-9)
    np.testing.assert_allclose(np.array(half.rules) * 2.0, whole.rules, rtol=1e-9)
    assert half.contacts(0.4 * whole.needed.min()) == whole.contacts(0.8 * whole.needed.min())


def test_the_gap_that_is_needed_is_a_demand_like_any_other(free):
    """Fragility of contact at one gap: the motion is linear, so that each capacity is gap over need."""
    gap = 0.9 * float(next(g for g in groups(free[0], Options()) if g.level == 1.0).needed.min())
    (found,) = fit(free[0], Asked("needed_gap"), [gap], "capacities")
    whole = next(g for g in groups(free[0], Options()) if g.level == 1.0)
    assert found.fragility.median == pytest.approx(np.exp(np.log(gap / whole.needed).mean()), rel=1e-6)


def test_contact_at_several_gaps_is_that_of_the_gaps_that_are_needed(free, tmp_path):
    """What meets at a gap lies between the levels that the needs of the free motion tell; of runs that met,
    what they needed is not known.
    """
    whole = np.sort(next(g for g in groups(free[0], Options()) if g.level == 1.0).needed)
    gap = 0.9 * float(whole.min())
    sweep = Sweep.open(swept(study(tmp_path, f"[{gap!r}, 1.0]")).write())
    met, open_ = curves(sweep, Asked("closures")), curves(free[0], Asked("needed_gap"))
    for curve, needed in zip((c for c in met if c.case != "gap=1"), open_):
        low, high = capacity(curve.points, STOPS, 1.0, in_steps=True)
        level, _ = capacity(needed.points, STOPS, gap, from_rest=True)
        assert curve.record == needed.record and low < level <= high
    tight, wide = fit(sweep, Asked("needed_gap"), [gap], "capacities")
    assert wide.fragility.median == pytest.approx(np.exp(np.log(gap / whole).mean()), rel=1e-6)
    assert tight.observed == wide.observed and tight.observed[1] == (1.0, COUNT, COUNT)
    (beyond, _) = fit(sweep, Asked("needed_gap"), [1.01 * gap])
    assert beyond.fragility is None
    assert beyond.remark == f"met at a gap of {gap:.6g}: wider gaps are not known"


def test_what_a_single_contact_needs_is_not_known_where_another_met():
    sweep = synthetic(np.array([[0.02, 0.03], [math.nan, math.nan]]))
    with pytest.raises(CurveError, match="leave --label out"):
        fit(sweep, Asked("needed_gap", "floor 1"), [0.01])
    assert demands(sweep, Asked("needed_gap")).tolist() == [0.03, math.inf]


@pytest.mark.full
def test_runs_that_meet_tell_up_to_their_gap(free, tmp_path):
    free_whole = next(g for g in groups(free[0], Options()) if g.level == 1.0)
    gap = float(np.sort(free_whole.needed)[2:4].mean())
    sweep = Sweep.open(swept(study(tmp_path, f"[{gap!r}]")).write())
    group = next(g for g in groups(sweep, Options()) if g.level == 1.0)
    assert len(group.needed) == 3 and group.met.tolist() == [gap] * 3
    for part in (0.5, 0.99, 1.0):
        assert group.contacts(part * gap) == free_whole.contacts(part * gap)
    assert group.contacts(1.01 * gap) == (0, 0)  # a free motion is not known there
    (row,) = needs([group])
    assert row[3:5] == (3, 3) and math.isnan(row[7]) and "wider gaps are not known" in row[-1]
    censored = from_capacities(np.sort(free_whole.needed)[:3], [gap] * 3)
    assert group.fitted.median == pytest.approx(censored.median, rel=1e-9)


def synthetic(needed, u=(0.03, 0.04), rho=0.0, level=0.4):
    """A sweep whose runs needed some gaps at several contacts, shape (n_runs, n_contacts)."""
    n, m = needed.shape
    full = np.ones((n, m))
    variables = {
        "run": Variable(np.arange(1, n + 1)),
        "deck": Variable(np.array(["pair.inp"] * n, object)),
        "record": Variable(np.array([f"{i}.at2" for i in range(n)], object)),
        "scale": Variable(np.ones(n)),
        "pga": Variable(np.full(n, level)),
        "status": Variable(np.array(["done"] * n, object)),
        "message": Variable(np.array([""] * n, object)),
        "doubt": Variable(np.array([""] * n, object)),
        "reached": Variable(np.full(n, 20.0)),
        "needed_gap": Variable(needed, "contact", "m"),
        "given_gap": Variable(9.0 * full, "contact", "m"),
        "peak_i": Variable(u[0] * full, "contact", "m"),
        "peak_j": Variable(u[1] * full, "contact", "m"),
        "correlation": Variable(rho * full, "contact", "-"),
    }
    about = {"study": "synthetic.toml", "program_version": "0", "units": "kN m s"}
    return Sweep(variables, {"contact": tuple(f"floor {k}" for k in range(m))}, about)


def test_a_known_distribution_is_recovered():
    rng = np.random.default_rng(8)
    needed = 0.05 * np.exp(0.3 * rng.normal(size=(2000, 1)))
    (group,) = groups(synthetic(needed), Options())
    own = group.fitted
    assert own.median_interval.low < 0.05 < own.median_interval.high
    assert own.dispersion_interval.low < 0.3 < own.dispersion_interval.high
    assert own.median_interval.high / own.median_interval.low < 1.03
    count, total = group.contacts(0.05)
    told, low, high = share(count, total)
    assert low < 0.5 < high and told == pytest.approx(group.by_fit(0.05), abs=0.03)


def test_exact_intervals_hold_their_level():
    """Of 2000 samples of 12 records the interval of 90 % holds the probability in 90 % or more."""
    rng, p = np.random.default_rng(3), 0.3
    hits = sum(
        low <= p <= high for _, low, high in (share(int(k), 12, 0.9) for k in rng.binomial(12, p, 2000))
    )
    expected = sum(
        binom.pmf(k, 12, p) for k in range(13) if share(k, 12, 0.9)[1] <= p <= share(k, 12, 0.9)[2]
    )
    assert expected >= 0.9 and hits / 2000 == pytest.approx(expected, abs=0.02)


def test_the_widest_need_of_all_contacts_counts():
    needed = np.array([[0.01, 0.03], [0.05, 0.02], [0.01, 0.01]])
    together, one, other = groups(synthetic(needed), Options())
    assert together.contact == "any" and together.needed.tolist() == [0.03, 0.05, 0.01]
    assert one.needed.tolist() == needed[:, 0].tolist() and other.contact == "floor 1"
    assert together.contacts(0.025) == (2, 3)


def test_rules_at_hand():
    """3-4-5: the mean peaks of all runs."""
    (group,) = groups(synthetic(np.array([[0.04], [0.06]]), rho=0.5), Options(raised=(2.0, 1.5)))
    rows = {row[3]: row for row in probabilities([group], Options(gaps=[0.055]))}
    gaps = {name: row[5] for name, row in rows.items()}
    raised = math.hypot(0.06, 0.06)
    assert gaps == pytest.approx(
        {
            "ABS": 0.07, "SRSS": 0.05, "DDC": math.sqrt(0.0025 - 0.0012), "ASCE 7-10": raised,
            "EN 1998-1": raised, "EN 1998-1, 0.7": 0.7 * raised, "": 0.055,
        }
    )  # fmt: skip
    assert rows["SRSS"][6:9] == (1, 2, 0.5) and rows["ABS"][6:9] == (0, 2, 0.0)
    assert rows["ASCE 7-10"][4] == "12.12.3, eq. 12.12-2"


def test_a_correlation_that_is_not_known_leaves_its_rule_out():
    (group,) = groups(synthetic(np.array([[0.04], [0.06]]), rho=math.nan), Options())
    assert "DDC" not in {row[3] for row in probabilities([group], Options())}
    (group,) = groups(synthetic(np.array([[0.04], [0.06]]), rho=math.nan), Options(correlation=1.0))
    assert group.rules[2] == pytest.approx(0.01)
    assert math.isnan(SeparationPeaks(0.1, 0.2).difference) and SeparationPeaks(0.1, 0.0).difference == 0.1


def test_the_verb_writes_all_of_it(free, tmp_path, capsys):
    _, path = free
    picture = tmp_path / "contact.svg"
    assert main(["separation", str(path), "--gap", "0.05,0.1", "--picture", str(picture)]) == 0
    out = capsys.readouterr().out
    assert "Clopper" in out and "roof" in out and "4.4.2.7(3)" in out
    assert "SRSS, ASCE 7-10, EN 1998-1" in picture.read_text()
    told = path.with_name("separation.rpt").read_text()
    assert "SEPARATION OF THE BUILDINGS" in told and "noise0.txt" in told and told.isascii()
    lines = path.with_name("separation.csv").read_text().splitlines()
    assert lines[0].startswith("case,level,contact,rule,source,gap,") and len(lines) == 1 + 2 * (
        len(RULES) + 2
    )
    with h5py.File(path.with_name("separation.h5")) as file:
        assert file["probability"].shape == (16,) and file["gap"].attrs["units"] == "m"
        assert file["gap"].dims[0].keys() == ["row"]
    first = {p: p.read_bytes() for p in path.parent.glob("separation.[rc]*")}
    assert main(["separation", str(path), "--gap", "0.05,0.1"]) == 0
    assert first == {p: p.read_bytes() for p in first} and len(first) == 2


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["--gap", "0"], "above zero"),
        (["--gap", "x"], "no number"),
        (["--periods", "1,2"], "stand together"),
    ],
)
def test_options_that_make_no_sense(free, words, why, capsys):
    assert main(["separation", str(free[1]), *words]) == 2
    assert why in capsys.readouterr().err


def test_options_of_sweeps_are_none_of_a_run(tmp_path, capsys):
    assert main(["separation", str(tmp_path / "run.h5"), "--gap", "0.1"]) == 2
    assert "--gap needs the runs of a sweep" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--periods", "--damping", "--raise"])
@pytest.mark.parametrize(
    "word", ["0,1", "1,-1", "nan,1", "inf,1", "1e300,1", "1e-300,1", "1", "1,2,3", "a,1"]
)
def test_two_numbers_are_of_the_magnitudes_that_a_deck_may_have(option, word, capsys):
    with pytest.raises(SystemExit) as end:
        main(["separation", "run.h5", f"{option}={word}"])
    assert end.value.code == 2 and f"{option}: " in capsys.readouterr().err


def test_a_sweep_without_contacts_is_refused():
    own = synthetic(np.array([[0.1]]))
    variables = {k: v for k, v in own.variables.items() if k != "needed_gap"}
    with pytest.raises(CurveError, match="need contacts"):
        groups(Sweep(variables, own.labels, own.about), Options())


def test_a_picture_of_runs_that_all_met():
    own = synthetic(np.full((4, 1), np.nan))
    found = groups(own, Options())
    assert found[0].fitted is None and all(map(math.isnan, found[0].rules))
    (shown,) = drawn(own, found, Options())
    assert shown.rules == [] and shown.gaps[-1] == 9.0 and isinstance(shown, suites.Contacts)
    assert isinstance(found[0], NeededGaps)
