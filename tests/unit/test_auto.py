"""AUTO by steps: its tolerance, the estimate of its error, trials of EXACT, and what ends it."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from decks import results_of
from kernels import as_with_numba, steps_alone
from pound_solve.check import Subject
from pound_solve.integrate import auto, costs, trial
from pound_solve.integrate.convergence import compared, estimate, step_refinement, tolerance_refinement
from pound_solve.integrate.convergence.compared import RESPONSES, ComparedPeaks
from pound_solve.integrate.protocol import Stop
from pound_solve.integrate.tracker import Collision, Peaks
from pounding_frames import HINGED, POUNDING, figures, run, tabled
from tiers import at_night

pytestmark = pytest.mark.full

ONE = np.array([RESPONSES])  #: kind of a made-up peak


@pytest.fixture(autouse=True)
def loading(monkeypatch):
    """What AUTO chooses does not hang on what makes kernels ready here."""
    as_with_numba(monkeypatch)


@pytest.mark.parametrize("tol", [1e-2, 1e-3, 1e-4])
def test_auto_keeps_its_tolerance_and_its_estimate_holds(tmp_path, monkeypatch, tol):
    exact = run(tmp_path, "AUTO")
    assert "EXACT" in exact.table("scene")["decision"].tolist()
    truth, closed = figures(exact), exact.table("contact_summary")["closures"][0]
    steps_alone(monkeypatch)
    found = run(tmp_path, f"AUTO TOL={tol}")
    assert found.table("contact_summary")["closures"][0] == closed
    assert error_against(found, truth) <= estimated(found) <= tol


APPENDAGE = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
 3 4 0 FIX=YR
ELEMENTS
 1 STOREY 1 2
 2 TANK 2 3
PROPS
 STOREY SPRING KX=4000
 TANK SPRING KX=2E5 FX=1.5 RULE=BILINEAR R=0.02
WEIGHTS
 2 981
 3 9.81
DRIFT
 "storey" 1 2
EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.5 DURATION=2
ANALYSIS
 HISTORY 2 METHOD={}
"""


def test_the_estimate_covers_what_yields_beside_the_drifts(tmp_path, monkeypatch):
    """A light tank on a stiff spring: its ductility needs far shorter steps than the storey's drift."""
    deck, rows = tmp_path / "tank.inp", []
    for method in ("EXACT", "AUTO TOL=1e-3"):
        deck.write_text(APPENDAGE.format(method))
        with results_of(deck) as r:
            rows.append(r.table("spring_envelope")[0])
            claimed = estimated(r) if method != "EXACT" else 0.0
        steps_alone(monkeypatch)
    assert rows[0]["ductility"] > 10
    for name in ("ductility", "plastic_work"):
        assert abs(rows[1][name] / rows[0][name] - 1.0) <= claimed <= 1e-3


def estimated(results):
    (check,) = [c for c in results.checks if c.subject is Subject.ERROR]
    assert not check.looks
    return check.value


def error_against(results, truth):
    drift = np.abs(truth[:4]).reshape(2, 2).max(axis=0)
    against = np.concatenate([drift, drift, truth[4:]])
    return float(np.abs((figures(results) - truth) / against).max())


def test_auto_learns_nothing_from_two_runs_with_the_same_steps(tmp_path, monkeypatch):
    """Output times cut the steps of both: a difference of zero between them is no accuracy."""
    truth = figures(run(tmp_path, "EXACT"))
    steps_alone(monkeypatch)
    found = run(tmp_path, "AUTO TOL=1e-3", every=0.004)
    assert error_against(found, truth) <= estimated(found) <= 1e-3


def test_auto_gives_up_where_shorter_steps_bring_nothing(tmp_path, monkeypatch):
    """A peak that differs by a tenth from run to run, as a force that rings does."""
    steps_alone(monkeypatch)
    monkeypatch.setattr(
        step_refinement, "MAX_STALE_RUNS", 3
    )  # each takes twice the steps of the one before
    rings = itertools.cycle((1.0, 1.1))
    monkeypatch.setattr(
        step_refinement, "figures", lambda *given: ComparedPeaks(np.array([next(rings)]), np.ones(1), ONE)
    )
    found = run(tmp_path, "AUTO TOL=1e-2")
    (check,) = [c for c in found.checks if c.subject is Subject.ERROR]
    assert check.looks and "not shown" in check.remark and "nor nearer" in check.remark
    assert dict(found.table("overview").tolist())["error of the method"].endswith("TOL 0.01, not shown")
    assert check.value > 1e-2 and found.status == "done"


EQUAL_STRENGTHS = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 0 2 FIX=YR
ELEMENTS
 1 LOWER 1 2
 2 UPPER 2 3
PROPS
 LOWER SPRING KX=300 FX=1 RULE=ELASTO_PLASTIC
 UPPER SPRING KX=700 FX=1 RULE=ELASTO_PLASTIC
WEIGHTS
 3 1
INITIAL
 3 VX=1
EQUAKE
 SINE AMPLITUDE=4 PERIOD=1 DURATION=3
ANALYSIS
 HISTORY 3 METHOD=AUTO TOL=1e-3
OUTPUT
 EVERY=0.01
"""


def test_auto_gives_up_early_where_each_step_finds_another_motion(tmp_path, monkeypatch):
    """Two springs of one strength over a node without mass: rounding decides at each step which yields."""
    steps_alone(monkeypatch)
    deck = tmp_path / "equal.inp"
    deck.write_text(EQUAL_STRENGTHS)
    with results_of(deck, out=tmp_path) as found:
        looks = {check.subject: check for check in found.checks if check.looks}
        runs = int(dict(found.table("run").tolist())["runs"])
    assert "not unique" in looks[Subject.UNIQUENESS].remark
    assert "nor nearer" in looks[Subject.ERROR].remark and looks[Subject.ERROR].value > 0.1
    assert runs < 2 + step_refinement.MAX_STALE_RUNS


def test_auto_keeps_its_last_whole_run_when_it_is_interrupted(tmp_path, monkeypatch):
    steps_alone(monkeypatch)
    runs = []

    class Interrupted(step_refinement.Replay):
        def __init__(self, recorder):
            super().__init__(recorder)
            runs.append(self)

        def sample(self, t, *motion):
            if len(runs) == 3 and t[-1] > 0.5:
                raise KeyboardInterrupt
            super().sample(t, *motion)

    monkeypatch.setattr(step_refinement, "Replay", Interrupted)
    found = run(tmp_path, "AUTO TOL=1e-6")
    assert len(runs) == 3 and found.status == "stopped" and found.message.startswith("A506 at t = ")
    second = np.concatenate([told[1][:, -1] for told in runs[1].samples[-1:]])
    assert found.time[-1] == runs[1].samples[-1][0][-1] > 0.5
    assert np.abs(found.history("node/u")[-1]).max() == pytest.approx(np.abs(second).max(), rel=1e-12)
    (check,) = [c for c in found.checks if c.subject is Subject.ERROR]
    assert check.looks and "not shown" in check.remark and check.remark.endswith("interrupted")
    assert found.table("contact_summary")["closures"][0] >= 1


def test_an_interrupt_between_two_runs_ends_with_a_report(tmp_path, monkeypatch):
    def interrupt(*given):
        raise KeyboardInterrupt

    steps_alone(monkeypatch)
    monkeypatch.setattr(step_refinement, "figures", interrupt)
    found = run(tmp_path, "AUTO TOL=1e-3")
    assert found.status == "stopped" and found.message.startswith("A506 at t = 0 s: interrupted")


@pytest.mark.parametrize("few", [3, *at_night(0, 10**6)])
def test_auto_takes_one_way_and_the_same_again(tmp_path, monkeypatch, few):
    """EXACT given up at once, on its way, or never: one method is named, and all figures return."""
    monkeypatch.setattr(trial, "MAX_DECOMPOSITIONS", few)
    truth = figures(run(tmp_path, "EXACT"))
    rounds = []
    for _ in range(2):
        found = run(tmp_path, "AUTO TOL=1e-3")
        (method,) = [d for d in found.table("scene") if d["subject"] == "method"]
        rounds.append((method["decision"], figures(found).tolist(), found.history("energy").tolist()))
        found.close()
    assert rounds[0] == rounds[1]
    assert few < 10**6 or rounds[0][0] == "EXACT"
    assert np.abs(np.array(rounds[0][1]) / truth - 1.0).max() < 1e-3


def test_auto_takes_series_where_stiffnesses_do_not_return(tmp_path):
    """Takeda's hinges unload with another stiffness each time, those of a bilinear spring do not."""
    takeda = "RULE=TAKEDA MI=60 MJ=60 R=0.05 ALFA=0.4 BETA=0 KH=2E5"
    for hinge, method in ((HINGED, "EXACT"), (takeda, "TAYLOR")):
        found = run(tmp_path, "AUTO TOL=1e-2", hinge)
        assert method in found.table("scene")["decision"].tolist()


def test_auto_without_drifts_and_laws_compares_displacements(tmp_path):
    deck = tmp_path / "large.inp"
    text = POUNDING.format(method="{method}", hinge="", turn="0.5", gap=0.02, every=0.01)
    text = text.replace(" 99 MEET 4 13\n", "").replace(" MEET  CONTACT", "! MEET  CONTACT")
    text = text.split("DRIFT")[0] + "EQUAKE" + text.split("EQUAKE")[1]
    text = text.replace("UNITS kN m s", "UNITS kN m s\nGEOMETRY LARGE")
    ends = []
    for method in ("AUTO TOL=1e-4", "NEWMARK DT=5e-5"):
        deck.write_text(text.replace("{method}", method))
        found = results_of(deck)
        if method.startswith("AUTO"):
            told = estimated(found)
        ends.append(np.array(found.history("node/u")))
        found.close()
    most = np.abs(ends[1]).max(axis=(0, 1))
    error = (np.abs(ends[0].max(axis=0) - ends[1].max(axis=0)) / most).max()
    assert 0.0 < error <= told <= 1e-4


def test_auto_hands_on_the_envelopes_of_its_last_run_alone(tmp_path, monkeypatch):
    """They are those of NEWMARK with the step that it came to, and no coarser run is left in them."""
    steps_alone(monkeypatch)
    found = run(tmp_path, "AUTO TOL=1e-3", "")
    step = next(r["value"] for r in found.table("run") if r["item"] == "time step")
    alone = run(tmp_path, f"NEWMARK DT={step}", "")
    for a, b in zip(tabled(found), tabled(alone)):
        assert np.abs(a - b).max() <= 1e-9 * np.abs(b).max()
    assert found.note("node_envelope") == alone.note("node_envelope")


class Refinement(step_refinement.StepRefinement):
    """Runs that are made up."""

    def __init__(self, tol, most=1.0, length=1.0, cost=0.0):
        self.tol, self.asked, self.length, self.step_cost = tol, compared.RESPONSE, length, cost
        self.h = self.aim = most
        self.events = self.retries = 0
        self.complete = None


def test_auto_gives_up_what_would_cost_too_much():
    """After a run that stopped, where a quarter of its step is too short, and after some retries."""
    steps = Refinement(1e-3, most=1e-3, length=2.0)
    limit = step_refinement.MAX_RETRY_COST / (4.0 * 2000)
    for cost, hopeless in ((1.001 * limit, True), (0.999 * limit, False)):
        steps.step_cost = cost
        assert steps._hopeless() is hopeless
    steps.retries = step_refinement.MAX_SHORTER
    assert not steps._hopeless()
    steps.complete = "a run"
    assert steps._hopeless()


def left(errors, ratio=2.0):
    """Estimate for the last of runs of such errors, each with `ratio` times the steps of the one before."""
    steps = [1000 * ratio**k for k in range(len(errors))]
    return estimate.error_left(steps, [1.0 + np.atleast_1d(e) for e in errors], np.ones(1))


@pytest.mark.parametrize("ratio", [1.4, 2.0, 4.0])
@pytest.mark.parametrize("order", [0.5, 0.75, 1.0, 1.5, 2.0, 2.4])
def test_the_estimate_of_auto_bounds_errors_that_fall_as_a_power_of_the_step(order, ratio):
    """And is not far above them, as soon as four runs show the power twice."""
    errors = [0.1 / ratio ** (order * k) for k in range(5)]
    for runs in (2, 3, 4, 5):
        assert left(errors[:runs], ratio) >= errors[runs - 1]
    assert order > 2.0 or left(errors[:4], ratio) <= 6.0 * errors[3]


@given(st.floats(0.5, 2.5), st.floats(1.2, 5.0), st.floats(1.2, 5.0), st.floats(1e-6, 1.0))
def test_the_observed_order_is_that_of_the_errors(order, first, second, size):
    errors = size, size * first**-order, size * (first * second) ** -order
    before, now = (np.array([a - b]) for a, b in itertools.pairwise(errors))
    assert estimate.observed_order(before, now, first, second)[0] == pytest.approx(order, abs=1e-5)


@pytest.mark.parametrize(
    "errors",
    [
        (0.05, -0.04, 0.05),  # it does not fall
        (0.0019, -0.0009, -0.0011),  # the last two agree by chance, to one side of the answer
        (0.0050, 0.0207, 0.0086, 0.0088),
        (0.078, -0.0075, -0.0041),
        (0.013, 0.0099, 0.0066),  # it falls as slowly as the step
        (0.0130, 0.0166, 0.0080, 0.0037),
        (0.549, 0.380, -0.0195, -0.0133),
        (0.175, 0.048, 0.0281),  # a power that three runs show, and no more
        (2.1e-4, 2.07e-4, 8.7e-5, 3.1e-5),
        (6.0e-4, 5.3e-4, 1.5e-4, 3.5e-4),
    ],
)
def test_the_estimate_of_auto_is_not_taken_in_by_runs_that_agree_by_chance(errors):
    """Made after the peaks of generated decks whose collisions were resolved by more and more steps."""
    assert left(errors) >= abs(errors[-1])


def test_no_peak_hides_behind_the_others():
    """The estimate is that of the worst peak, each with its own order."""
    good, bad = 0.1 / 4.0 ** np.arange(4), 0.02 * 0.7 ** np.arange(4)
    both = left(list(zip(good, bad)))
    assert both == max(left(good), left(bad)) > left(good)


def test_auto_wants_runs_that_show_their_order_and_steps_in_the_hardest_collision(tmp_path, monkeypatch):
    """Made-up peaks of second order; three runs at least, and a fourth that confirms the order."""
    steps_alone(monkeypatch)
    real, h = step_refinement.StepRefinement.run, []

    def run_once(self):
        h.append(self.h)
        return real(self)

    monkeypatch.setattr(step_refinement.StepRefinement, "run", run_once)
    for gap, lasts, runs in ((2e-2, 1.0, 4), (1e-3, 1.0, 3), (1e-3, 1e-4, 4)):
        h.clear()
        monkeypatch.setattr(
            step_refinement,
            "figures",
            lambda *given, gap=gap: ComparedPeaks(
                np.array([1.0 + gap * (h[-1] / h[0]) ** 2]), np.ones(1), ONE
            ),
        )
        monkeypatch.setattr(step_refinement, "hardest", lambda peaks, lasts=lasts: lasts)
        found = run(tmp_path, "AUTO TOL=1e-2", every=0.1)
        facts = dict(found.table("run").tolist())
        assert int(facts["runs"]) == runs, (gap, lasts, facts["runs"])
        assert estimated(found) <= 1e-2
        found.close()


def test_the_hardest_collision_is_that_of_the_largest_force():
    peaks = Peaks([], [], [], [], [])
    assert compared.hardest(peaks) == np.inf
    peaks.collisions += [Collision(0, 1.0, 0.1, 1.5, peak=3.0), Collision(1, 2.0, 0.1, 2.25, peak=4.0)]
    assert compared.hardest(peaks) == 0.25
    for rises, lasts in ((0.0, 0.25), (0.001, 0.0125), (0.0625, 0.125), (0.125, 0.25), (0.2, 0.25)):
        peaks.collisions[1].t_peak = 2.0 + rises
        assert compared.hardest(peaks) == pytest.approx(lasts)
    peaks.collisions.append(
        Collision(1, 3.0, 0.1, peak=5.0)
    )  # still closed: it is longer than what is seen
    assert compared.hardest(peaks) == np.inf


def test_auto_tries_other_steps_where_one_stops(tmp_path, monkeypatch):
    """A step nearby follows one that stops at once; a whole run is kept where all shorter ones stop."""
    from pound_solve.integrate.stepping import newmark

    real, tried = newmark.integrate, []

    def stops(problem, options):
        tried.append(options["DT"])
        if len(tried) in bad:
            raise Stop("A503", 1e-6, "laws alternate")
        return real(problem, options)

    steps_alone(monkeypatch)
    monkeypatch.setattr(newmark, "integrate", stops)
    bad = range(1, 4)
    found = run(tmp_path, "AUTO TOL=1e-2")
    assert found.status == "done" and estimated(found) <= 1e-2 and len(tried) > 4
    assert tried[1] == pytest.approx(step_refinement.NEARBY * tried[0])
    found.close()
    tried.clear()
    bad = range(3, 100)
    found = run(tmp_path, "AUTO TOL=1e-6")
    assert found.status == "done" and len(tried) == 2 + 1 + step_refinement.MAX_SHORTER
    (check,) = [c for c in found.checks if c.subject is Subject.ERROR]
    assert check.looks and "not shown" in check.remark and "A503" in check.remark


def test_auto_converges_on_all_peaks_where_that_is_asked_for(tmp_path, monkeypatch):
    """Accelerations and members' forces converge more slowly than drifts: they set the step."""
    truth = run(tmp_path, "EXACT")
    steps_alone(monkeypatch)
    steps = {}
    for asked in ("RESPONSE", "ALL"):
        found = run(tmp_path, f"AUTO TOL=2e-3 PEAKS={asked}")
        checks = [c for c in found.checks if c.subject is Subject.ERROR]
        assert len(checks) == (3 if asked == "ALL" else 1)
        told, steps[asked] = (max(c.value for c in checks), int(dict(found.table("run").tolist())["steps"]))
        if asked == "ALL":
            for name, size in (("node/a", 2), ("member/force", 0)):
                a, b = (np.abs(r.history(name)[..., : size or None]).max(axis=0) for r in (found, truth))
                assert np.abs(a - b).max() <= told * b.max()
        found.close()
    assert steps["ALL"] > steps["RESPONSE"]


def test_a_trial_ends_where_the_whole_would_cost_more_than_its_budget():
    """Its progress is checked once a share is spent; it never goes beyond the budget."""
    for spent, done, ends in ((0.1, 0.01, False), (0.3, 0.1, True), (0.3, 0.2, False), (2.1, 0.9, True)):
        budget = costs.Budget(0.0, 10.0, 2.0, 0.2)
        if ends:
            with pytest.raises(costs.CostlyError):
                budget.charge(spent, 10.0 * done, 1)
        else:
            budget.charge(spent, 10.0 * done, 1)


def test_trials_of_exact_cost_a_third_of_the_whole_at_most(tmp_path, monkeypatch):
    """Where EXACT never ends and LAGUERRE stops, each trial before a run counts those before."""
    spent, others = [], []

    def unfit(self):
        raise tolerance_refinement.UnfitError("stopped", False)

    def endless(problem, limits):
        spent.append(limits["COST"])
        raise costs.CostlyError(limits["COST"], 0.9 * float(problem.start.times[-1]))

    real = step_refinement.StepRefinement.least_cost

    def least_cost(self):
        others.append(real(self))
        return others[-1]

    monkeypatch.setattr(auto, "has_series", lambda system: False)
    monkeypatch.setattr(trial.exact, "integrate", endless)
    monkeypatch.setattr(trial, "MIN_COST_OF_MANY", 0.0)
    monkeypatch.setattr(costs, "DECOMPOSITION", 0.0)
    monkeypatch.setattr(tolerance_refinement.ToleranceRefinement, "run", unfit)
    monkeypatch.setattr(step_refinement.StepRefinement, "least_cost", least_cost)
    found = run(tmp_path, "AUTO TOL=1e-5")
    assert found.status == "done" and len(others) > 3 and spent
    assert sum(spent) <= 0.5 * (others[-1] + trial.COST_OF_REST + trial.loading()) * (1 + 1e-12)


@pytest.mark.parametrize(("code", "status"), [("A503", "done"), ("A501", "stopped")])
def test_others_follow_a_trial_of_exact_that_rounding_stops(tmp_path, monkeypatch, code, status):
    """Where the structure gives way they do not, and EXACT is not tried again."""
    tried = []

    def stops(problem, limits):
        tried.append(limits["COST"])
        raise Stop(code, 0.5, "stopped")

    monkeypatch.setattr(auto, "has_series", lambda system: False)
    monkeypatch.setattr(trial.exact, "integrate", stops)
    monkeypatch.setattr(trial, "MIN_COST_OF_MANY", 0.0)
    monkeypatch.setattr(costs, "DECOMPOSITION", 0.0)
    found = run(tmp_path, "AUTO TOL=1e-5")
    assert found.status == status and len(tried) == 1
    found.close()


def test_auto_goes_over_to_series_once_steps_have_cost_as_much(monkeypatch):
    """Each run costs two, the series five: after two runs the third would make six."""

    class Steps:
        system = problem = None
        spent, events = 0.0, 0

        def cost_ahead(self):
            return 2.0

        least_cost = cost_ahead

        def run(self):
            self.spent += 2.0
            runs.append(self.spent)

    runs = []
    monkeypatch.setattr(auto.costs, "of_series_step", lambda system: 1.0)
    monkeypatch.setattr(auto, "by_few_series", lambda *given: "series")
    assert auto.to_tolerance(Steps(), None, None, 5.0) == "series"
    assert runs == [2.0, 4.0]


def cost_of_series(tmp_path, monkeypatch, text):
    """Steps of TAYLOR that AUTO counts with for a deck."""

    class Told(Exception):
        pass

    real = auto.cost_of_series

    def tell(problem):
        raise Told(real(problem) / costs.of_series_step(problem.system))

    deck = tmp_path / "series.inp"
    deck.write_text(text)
    with monkeypatch.context() as patch:
        patch.setattr(auto, "has_series", lambda system: True)
        patch.setattr(auto, "cost_of_series", tell)
        with pytest.raises(Told) as told:
            results_of(deck)
    return float(told.value.args[0])


CHAIN = """UNITS kN m s
NODES
 1  0 0 FIX=XYR
 10 TO 16 1 TO 7 0 FIX=YR
ELEMENTS
 1 COLUMN 1 10
 2 TO 7 BAR 10 TO 15 11 TO 16
PROPS
 COLUMN SPRING KX=4000 FX=60 RULE={rule}
 BAR SPRING KX=4E7
WEIGHTS
 10 TO 16 20
DAMPING
 RAYLEIGH XI=0.03 OMEGA=15,200
EQUAKE
 TABLE POINTS=0,0,1,1,2,0
OUTPUT
 EVERY={every}
ANALYSIS
 HISTORY 2 METHOD=AUTO
"""


def test_the_cost_of_series_counts_intervals_in_modes_and_reversals(tmp_path, monkeypatch):
    def steps(rule, every):
        text = CHAIN.format(rule=rule, every=every)
        return cost_of_series(tmp_path, monkeypatch, text)

    plain = "ELASTO_PLASTIC"
    # in modes an interval costs the same, however long; by series it costs its radians
    assert steps(plain, 0.01) == pytest.approx(costs.MODES_STEPS * 200)
    assert steps(plain, 0.02) == pytest.approx(costs.MODES_STEPS * 100)
    smooth = steps("RAMBERG_OSGOOD N=5", 0.02)
    monkeypatch.setattr(costs, "REVERSALS", 0.0)
    by_series = steps("RAMBERG_OSGOOD N=5", 0.02)
    assert smooth == pytest.approx(by_series + 0.25 * 100)
    assert by_series > 2.0 * steps(plain, 0.02)
