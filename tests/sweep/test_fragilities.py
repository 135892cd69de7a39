"""Fragilities of sweeps that are made up: which runs count, which method suits, and what is remarked."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from pound_solve.report.sweep.fragility import drawn, report
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import COLLAPSE, Asked, CurveError, curves, demand
from pound_solve.statistics.fragility_of_sweep import fit

DRIFT, FALL = Asked("peak_drift"), Asked(COLLAPSE)


def sweep(*runs):
    """A sweep of runs that are told by record, scale, status and drift."""
    record, scale, status, drift = zip(*runs)
    variables = {
        "run": Variable(np.arange(1, len(runs) + 1)),
        "deck": Variable(np.array(["wall.inp"] * len(runs), object)),
        "record": Variable(np.array(record, object)),
        "scale": Variable(np.array(scale)),
        "status": Variable(np.array(status, object)),
        "reached": Variable(np.full(len(runs), 3.0)),
        "peak_drift": Variable(np.array(drift)[:, None], "storey", "m"),
    }
    return Sweep(variables, {"storey": ("roof",)}, {"study": "made up", "units": "kN m s"})


def stripes(*falls):
    """Four records at the scales 1, 2, ..., of which some stop at each; a drift of 0.01 times the scale."""
    return sweep(
        *(
            (f"{n}.txt", float(x), "stopped" if n < fall else "done", 0.01 * x)
            for x, fall in enumerate(falls, start=1)
            for n in range(4)
        )
    )


@pytest.mark.parametrize(
    ("status", "reached", "asked", "expected"),
    [
        ("done", 3.0, DRIFT, 0.5),
        ("done", 3.0, FALL, 0.0),
        ("stopped", 1.0, DRIFT, math.inf),
        ("stopped", 1.0, FALL, math.inf),
        ("stopped", math.nan, FALL, math.nan),  # before its history
        ("failed", 1.0, DRIFT, math.nan),
        ("failed", 1.0, FALL, math.nan),
    ],
)
def test_demand_of_one_run(status, reached, asked, expected):
    """The largest magnitude of all labels; none of a collapse, which has no values."""
    values = {} if asked is FALL else {"a": 0.2, "b": -0.5, "c": math.nan}
    assert demand(status, reached, values, asked) == pytest.approx(expected, nan_ok=True)


def test_the_probability_of_collapse_is_that_of_stops():
    """A quarter of the runs stops at 1, three quarters at 2: the median is sqrt 2, and the quartiles of the
    normal distribution lie on both sides of it.
    """
    (found,) = fit(stripes(1, 3), FALL, [])
    assert found.method == "stripes" and found.observed == ((1.0, 1, 4), (2.0, 3, 4))
    assert found.fragility.median == pytest.approx(math.sqrt(2.0), rel=1e-7)
    assert found.fragility.dispersion == pytest.approx(math.log(2.0) / (2.0 * norm.ppf(0.75)), rel=1e-7)
    assert math.isnan(found.limit) and found.remark == "fewer than 10 data"
    (picture,) = drawn([found])
    assert picture.title == "collapse" and picture.levels[-1] == 2.0
    assert [x.tolist() for x in picture.observed] == [[1.0, 2.0], [0.25, 0.75]]


def test_a_cloud_leaves_out_what_stopped_and_what_failed():
    """The others have a drift of 0.01 times the scale to the power of 2, times or over e^0.1: the line of
    logarithms is theirs, and the limit of 0.04 is reached at 2.  A maximum is found to the root of
    rounding.
    """
    runs = [
        (f"{n}.txt", x, "done", 0.01 * x**2 * math.exp(0.1 * s))
        for n, (x, s) in enumerate((x, s) for x in (0.5, 1.0, 3.0) for s in (-1, 1))
    ]
    made = sweep(*runs, ("a.txt", 2.0, "stopped", 9.0), ("b.txt", 2.0, "failed", 9.0))
    (found,) = fit(made, DRIFT, [0.04])
    assert found.method == "cloud" and found.fragility.count == 6
    assert found.fragility.median == pytest.approx(2.0, rel=1e-7)
    assert found.remark == (
        "fewer than 10 data; stopped runs, which are not in the cloud: 1; "
        "runs that failed or are missing: 1"
    )
    assert [p.title for p in drawn([found])] == ["limit 0.04"]
    (none,) = fit(made, FALL, [], "cloud")
    assert none.fragility is None and none.remark.startswith("a cloud has no collapse")
    assert drawn([none]) == []


def test_the_report_tells_runs_and_probabilities_at_levels():
    """The two shares that were observed, and one half at the median; none of a fit that there is not."""
    made, at = stripes(1, 3), [1.0, math.sqrt(2.0), 2.0]
    found = fit(made, FALL, [], "stripes") + fit(made, FALL, [], "cloud")
    lines = [line.split() for line in report(made, FALL, found, at)]
    assert lines[0] == ["Demand:", "collapse"]
    assert " ".join(lines[1]) == "Runs: 8 of the 8 in the sweep; scale 1 to 2, 2 levels"
    assert lines[-2:] == [["0.25", "0.5", "0.75"], ["-", "-", "-"]]


def test_gaps_below_what_the_lowest_level_needs_are_reached_in_proportion():
    """A gap of 0.2 m between frames of four and six storeys; the capacities are levels of straight lines
    from rest, of which a normal distribution has mean and deviation.
    """
    levels = (0.5, 1.0, 1.5)
    needed = {
        "elcentro": (0.022071, 0.043259, 0.092641),
        "gilroy": (0.037330, 0.045283, 0.051989),
        "hachinohe": (0.015838, 0.031772, 0.084388),
        "kobe": (0.060388, 0.138707, 0.158720),
    }
    made = sweep(*((name, x, "done", d) for name, own in needed.items() for x, d in zip(levels, own)))
    made.variables["needed_gap"] = made.variables["peak_drift"]
    made.variables["given_gap"] = Variable(np.full((12, 1), 0.2), "storey", "m")
    found = fit(made, Asked("needed_gap"), [0.005, 0.01, 0.02])
    assert [round(f.fragility.median, 3) for f in found] == [0.084, 0.168, 0.336]
    for f in found:
        at = [np.interp(f.limit, (0.0, *own), (0.0, *levels)) for own in needed.values()]
        assert f.fragility.median == pytest.approx(np.exp(np.log(at).mean()), rel=1e-6)
    remark = "fewer than 10 data; below the lowest level, in proportion to it: "
    assert [f.remark.removeprefix(remark) for f in found] == ["4", "4", "3"]
    drifts = fit(made, DRIFT, [0.005])  # may begin anywhere
    assert drifts[0].fragility is None


def test_limits_are_asked_for_but_of_collapse():
    with pytest.raises(CurveError, match="--limit"):
        fit(stripes(1, 3), DRIFT, [])
    assert len(fit(stripes(1, 3), FALL, [])) == 1


@pytest.mark.parametrize(
    ("runs", "method"),
    [
        (stripes(0, 1, 3), "capacities"),  # three levels of every record
        (stripes(1, 3), "stripes"),
        (sweep(("a", 1.0, "done", 0.01), ("a", 2.0, "done", 0.02)), "stripes"),  # of one record
        (stripes(2), "cloud"),
        (sweep(("a", 1.0, "done", 0.1), ("a", 2.0, "done", 0.2), ("b", 1.0, "done", 0.1)), "cloud"),
    ],
)
def test_the_method_follows_from_the_levels(runs, method):
    assert {f.method for f in fit(runs, DRIFT, [0.015])} == {method}


def test_curves_rise_with_their_levels():
    """Runs stand in any order in a sweep; a run without a demand is counted beside the curve."""
    made = sweep(
        ("a", 2.0, "done", -0.2),
        ("b", 1.0, "done", 0.3),
        ("a", 1.0, "failed", 7.0),
        ("a", 0.5, "done", 0.1),
    )
    one, other = curves(made, DRIFT)
    assert (one.record, one.points, one.left_out) == ("a", ((0.5, 0.1), (2.0, 0.2)), 1)
    assert (other.record, other.points, other.left_out) == ("b", ((1.0, 0.3),), 0)
