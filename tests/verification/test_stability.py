"""The stability matrix: no case ends in a fault; and long runs keep phase, energy and bits."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest

from decks import results_of
from kernels import steps_alone
from pound_solve.assess.stability import isolated, judge, page, scenes
from pound_solve.assess.stability.scenes import case as scene_case
from pound_solve.assess.stability.scenes import contact, hysteresis, linear
from pound_solve.catalog import catalog
from pound_solve.check import Subject, beyond, looked
from pound_solve.cli.main import main
from pound_solve.integrate.tolerances import EVENT_TOLERANCE, MOVING_ALIKE

pytestmark = pytest.mark.full


def chosen(case):
    """Scenes and laws that have one speciality each; short ones."""
    laws = {"linear": {""}, "contact": {"LINEAR", "KELVIN_VOIGT"}, "hysteresis": {"BILINEAR"}}
    quick = {
        "massless node that is met", "gap", "two contacts at the same instant",
        "softening branch to collapse", "rigid-body modes", "repeated eigenvalues",
    }  # fmt: skip
    return case.law in laws[case.family] and case.scene in quick


def test_the_quick_part_of_the_matrix_has_no_fault(monkeypatch):
    monkeypatch.setattr(judge, "methods", lambda: ["EXACT"])
    rows = list(judge.matrix(chosen=chosen, limit=0.0))
    assert [(r.case.scene, r.case.law, r.says) for r in rows if r.end == judge.FAULT] == []
    ends = [r.end for r in rows]
    assert len(rows) >= 16 and ends.count(judge.RIGHT) > 0.8 * len(rows), ends


@pytest.mark.slow
@pytest.mark.parametrize("family", judge.FAMILIES)
def test_the_matrix_has_no_fault(family):
    rows = list(judge.matrix((family,), lambda case: not case.heavy))
    assert [(r.case.scene, r.case.law, r.method, r.says) for r in rows if r.end == judge.FAULT] == []


@pytest.mark.slow
def test_study_prints_the_matrix(monkeypatch, capsys):
    few = [c for c in linear.linear_scenes() if c.scene == "rigid-body modes"]
    monkeypatch.setattr(scenes, "linear_scenes", lambda: iter(few))
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main(["study", "--stability", "--family", "linear", "--quick"]) == 0
    said, progress = capsys.readouterr()
    runs = len(few) * len(judge.methods())
    assert f"| rigid-body modes | {len(few)} |" in said and f"{runs} runs: {runs} right" in said
    assert f"\r {runs} of {runs}: rigid-body modes" in progress and progress.endswith("  \r")


def test_the_page_names_methods_and_scenes_of_stops_and_no_file():
    case = next(linear.linear_scenes())
    refused = "/tmp/x/case.inp:11:56: error P330: element 3 (POUND): needs mass\n  the line\n  hint: y"
    ends = [
        ("CENTRAL", judge.STOPPED, "A502 at t = 0 s: the step 1 is above the limit 0.3"),
        ("HHT", judge.STOPPED, "A502 at t = 0 s: the step 2 is above the limit 0.7"),
        ("EXACT", judge.STOPPED, refused),
        ("EXACT", judge.FAULT, "KeyError: 1"),
    ]
    said = page.page([judge.JudgedRun(case, m, end, math.nan, says, 0.0) for m, end, says in ends])
    scene = f"{case.scene}, {case.variant}"
    assert f"| 2 | CENTRAL, HHT | A502 at t = 0 s: the step 1 is above the limit 0.3 | {scene} |" in said
    assert f"| 1 | EXACT | P330: element 3 (POUND): needs mass | {scene} |" in said
    assert f"- {scene} by EXACT: KeyError: 1" in said and "case.inp" not in said
    assert all(f"{end}: " in said for end in page.ENDS)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "study takes a deck, or --stability"),
        (["a.inp", "--stability"], "leave out a.inp"),
        (["a.inp", "--quick"], "--quick belongs to --stability"),
        (["a.inp", "--law", "LINEAR"], "--law belongs to --stability"),
        (["--stability", "--steps", "0.1"], "--steps belongs to a study of a deck"),
        (["--stability", "-o", "x"], "--out belongs to a study of a deck"),
        (["--stability", "--set", "k=1"], "--set belongs to a study of a deck"),
        (["--stability", "--law", "GLUE"], "no scenes with the law GLUE"),
        (["--stability", "--family", "linear", "--law", "LINEAR"], "--family linear has no scenes"),
    ],
)
def test_study_says_which_options_belong_together(words, told, capsys):
    assert main(["study", *words]) == 2
    assert told in capsys.readouterr().err


def judged(case, **given):
    """How a made-up run of a case is judged."""

    def run(case, deck, method):
        return isolated.Findings(**{"t": np.zeros(2), "u": np.zeros((2, 1)), **given})

    return judge.judge(run, case, "NEWMARK").end


def test_the_judge_tells_right_from_wrong():
    case = scene_case.StabilityCase(
        "linear", "", "", "", "", within=0.1, right=lambda t: np.array([[0.0], [1.0]])
    )
    ends = np.array([[0.0], [1.05]]), np.array([[0.0], [1.2]])
    assert judged(case, u=ends[0]) == judge.RIGHT
    assert judged(case, u=ends[1]) == judge.FAULT
    look = beyond(Subject.ENERGY, "residual", 2.0, 1e-9, "energy is lost or made")
    assert judged(case, u=ends[1], looks=(look,)) == judge.FLAGGED
    assert judged(case, stop="A503 at t = 1 s: why") == judge.STOPPED
    assert judged(case, wrong="NaN or infinite values") == judge.FAULT


def test_an_answer_that_no_engineer_would_believe_excuses_no_error(tmp_path):
    """Bodies that overlap by a tenth of their lengths over a soft contact."""
    spec = catalog().family("contact")["LINEAR"]
    case = next(c for c in contact.contact_scenes(spec) if c.variant == "1e-06")
    text = case.deck.replace(scene_case.METHOD, "EXACT")
    deck = tmp_path / "soft.inp"
    deck.write_text(text)
    with results_of(deck) as results:
        assert {check.subject for check in looked(results.checks)} == {Subject.RESPONSE}
    assert isolated.solve(text, case.files).looks == ()


LINE = np.linspace(0.0, 1.0, 11)
RIGHT_RUN = isolated.Findings(
    t=LINE, u=LINE[:, None], f=LINE[:, None], swings=np.array([[1.0, 0.0]]), blows=np.array([2.0, 1e-3])
)


def compared(method, off=RIGHT_RUN, nudged=RIGHT_RUN):
    """How a made-up run is judged against a reference that `nudged` stands for with other masses."""
    case = scene_case.StabilityCase("contact", "", "", "", "GRAVITY 1\nMETHOD=@METHOD", within=0.1)

    def run(case, deck, method):
        return (RIGHT_RUN if deck == case.deck else nudged) if "REFINE" in method else off

    return judge.judge(run, case, method)


@pytest.mark.parametrize(
    ("method", "off", "end"),
    [
        ("NEWMARK", {"f": 1.05 * LINE[:, None]}, judge.RIGHT),
        ("NEWMARK", {"f": 1.2 * LINE[:, None]}, judge.FAULT),
        ("NEWMARK", {"blows": np.array([2.0, 2e-3])}, judge.RIGHT),  # a touch, beside the other
        ("NEWMARK", {"blows": np.array([2.4, 1e-3])}, judge.FAULT),
        ("NEWMARK", {"swings": np.array([[1.01, 0.0]])}, judge.RIGHT),
        ("AUTO", {"swings": np.array([[1.01, 0.0]])}, judge.FAULT),
        ("AUTO", {"blows": np.array([2.01, 1e-3])}, judge.FAULT),
        ("AUTO", {"u": 1.05 * LINE[:, None]}, judge.RIGHT),
        ("EXACT", {"u": (1.0 + 1e-5) * LINE[:, None]}, judge.FAULT),
        ("LAGUERRE", {"u": (1.0 + 1e-4) * LINE[:, None]}, judge.RIGHT),
        ("LAGUERRE", {"u": (1.0 + 1e-2) * LINE[:, None]}, judge.FAULT),
    ],
)
def test_forces_are_judged_and_auto_by_what_it_promises(method, off, end):
    assert compared(method, RIGHT_RUN._replace(**off)).end == end


def test_nothing_is_judged_beyond_what_other_digits_of_the_masses_change():
    """The answer is known up to t = 0.5 here: what is off earlier counts, what is off later does not."""
    late, early = LINE.copy(), LINE.copy()
    late[6:], early[4:] = 0.0, 0.0
    nudged = RIGHT_RUN._replace(u=late[:, None])
    row = compared("EXACT", RIGHT_RUN._replace(u=2.0 * late[:, None] - RIGHT_RUN.u), nudged)
    assert row.end == judge.RIGHT and row.says == f"{judge.PARTLY}, up to t = 0.5"
    assert compared("EXACT", RIGHT_RUN._replace(u=early[:, None]), nudged).end == judge.FAULT
    assert compared("EXACT", RIGHT_RUN._replace(u=early[:, None])).end == judge.FAULT


def test_a_contact_that_other_digits_of_the_masses_undo_is_not_judged():
    grazed = RIGHT_RUN._replace(blows=np.array([2.0, 1.0]))
    case = scene_case.StabilityCase("contact", "", "", "", "GRAVITY 1\nMETHOD=@METHOD", within=0.1)

    def run(other):
        def found(case, deck, method):
            return RIGHT_RUN if "REFINE" not in method else grazed if deck == case.deck else other

        return found

    touching, parted = (judge.judge(run(x), case, "NEWMARK") for x in (grazed, RIGHT_RUN))
    assert touching.end == judge.FAULT
    assert parted.end == judge.RIGHT and parted.says == judge.PARTLY


def test_springs_are_not_judged_where_a_body_turns_unless_the_reference_has_no_steps():
    """A reference by steps does not see that a law turns which moves back at 1e-6 of its largest rate."""
    turning = RIGHT_RUN._replace(v=np.where(LINE > 0.95, 1e-9, 1.0)[:, None])
    late, early = 1.0 * LINE, 1.0 * LINE
    late[-1], early[-2] = 1.2, 1.2
    case = scene_case.StabilityCase("hysteresis", "", "", "", "GRAVITY 1\nMETHOD=@METHOD", within=0.1)

    def end(f, by):
        def run(case, deck, method):
            if method == "TAYLOR":
                return RIGHT_RUN._replace(f=f[:, None])
            return turning if by in method else isolated.Findings(stop="A505 at t = 0 s: curved")

        row = judge.judge(run, case, "TAYLOR")
        assert (row.says == judge.PARTLY) is (row.end == judge.RIGHT)
        return row.end

    assert [end(late, "NEWMARK"), end(early, "NEWMARK")] == [judge.RIGHT, judge.FAULT]
    assert end(late, "REFINE") == judge.FAULT


def test_other_masses_show_a_touch_that_steps_take_for_rounding(monkeypatch):
    asked = []
    monkeypatch.setattr(judge, "nudged", lambda deck, share: asked.append(share) or deck)
    case = scene_case.StabilityCase("contact", "", "", "", "GRAVITY 1\nMETHOD=@METHOD", within=0.1)

    def run(case, deck, method):
        if "REFINE" in method:
            return isolated.Findings(stop="A505 at t = 0 s: curved")
        return RIGHT_RUN if "NEWMARK" in method else RIGHT_RUN._replace(blows=np.array([2.0, 1.0]))

    judge.judge(run, case, "TAYLOR")
    assert asked == [judge.BLIND] and 5.0 * MOVING_ALIKE * EVENT_TOLERANCE < judge.BLIND < 1e-6


def test_masses_are_nudged_by_their_share():
    deck = judge.nudged(linear.one(""), 1e-3)
    assert "\nGRAVITY 0.999000999" in deck and judge.nudged("NODES\n", 1e-3) == "NODES\n"


@pytest.mark.parametrize(
    ("message", "clear"),
    [
        ("A503 at t = 1.25 s: too many changes within one step, the last in element 3", True),
        ("A501 static analysis: the structure buckles: its factor is 0.5", True),
        ("A503 at t = 1.25 s: no", False),
        ("the history went wrong somewhere on its way to the end", False),
    ],
)
def test_a_clear_stop_has_number_time_and_cause(message, clear):
    assert bool(isolated.CLEAR.match(message)) is clear


def test_exact_refuses_a_curved_law(tmp_path):
    rule = catalog().family("hysteresis")["BOUC_WEN"]
    deck = tmp_path / "curved.inp"
    deck.write_text(hysteresis.storeys(scene_case.items(rule)).replace(scene_case.METHOD, "EXACT"))
    results = results_of(deck)
    assert results.status == "stopped"
    assert results.message.startswith("A505 at t = 0 s: ")
    assert "the law BOUC_WEN of element 1 is curved" in results.message


@pytest.mark.parametrize("method", ["HHT", "GENERALISED_ALPHA"])
def test_a_spike_leaves_its_impulse_whatever_the_alphas(tmp_path, method):
    """The acceleration of its last step must not act over the long one that follows.

    The spike has two steps; HHT (alpha -0.1, gamma 0.6) gets a tenth of its peak one step late, of which
    0.4 falls behind its end: 4 % of the impulse.
    """
    (case,) = (c for c in linear.linear_scenes() if c.variant == "a spike")
    row = judge.judge(isolated.Runner(0.0), case, method)
    assert row.error == pytest.approx(0.04, abs=0.002) if method == "HHT" else row.error < 0.01, row.says


def test_steps_that_do_not_resolve_the_motion_are_told(tmp_path):
    """Newmark keeps the energy of free vibration whatever the step; the report must tell all the same."""
    for dt, verdict in ((0.01, "good"), (0.2, "look")):
        deck = tmp_path / "one.inp"
        text = linear.one(linear.KICK, every=0.2).replace(scene_case.METHOD, f"NEWMARK DT={dt}")
        deck.write_text(text)
        found = {c.name: c for c in results_of(deck).checks}["steps in a period of the motion, about"]
        # the method's own period is longer: omega' = 2/h atan(omega h/2)
        own = 2 * math.pi / (2 / dt * math.atan(scene_case.OMEGA * dt / 2)) / dt
        assert found.verdict == verdict
        assert found.value == pytest.approx(own, rel=0.35)


def test_auto_says_how_good_it_is_rather_than_its_steps(tmp_path, monkeypatch):
    steps_alone(monkeypatch)
    deck = tmp_path / "pair.inp"
    spec = catalog().family("contact")["KELVIN_VOIGT"]
    k = 1e3 * scene_case.STOREY
    law = scene_case.items(spec, K=k)
    deck.write_text(contact.pair(law, end=0.2).replace(scene_case.METHOD, "AUTO TOL=0.01"))
    checks = results_of(deck).checks
    assert any(c.subject is Subject.ERROR for c in checks) and not any("steps in" in c.name for c in checks)


OMEGA = scene_case.OMEGA


def drifted(folder, method, periods, dt=0.0):
    """Phase, in radians ahead of the exact one, and energy over that at the start, less 1, at the end."""
    deck = folder / "long.inp"
    text = linear.one(linear.KICK, end=float(periods), every=float(periods))
    deck.write_text(text.replace(scene_case.METHOD, f"{method} DT={dt!r}" if dt else method))
    results = results_of(deck)
    u, v = results.history("node/u")[-1, 0, 0], results.history("node/v")[-1, 0, 0]
    energy = results.history("energy")
    return math.atan2(u * OMEGA, v), (energy[-1, 1] + energy[-1, 2]) / (energy[0, 1] + energy[0, 2]) - 1.0


def wrapped(angle):
    return math.remainder(angle, 2 * math.pi)


@pytest.mark.parametrize("periods", [100, pytest.param(10_000, marks=pytest.mark.slow)])
def test_phase_and_energy_over_many_periods(tmp_path, periods):
    """Newmark: omega' = 2/h atan(omega h/2), central: 2/h asin(omega h/2); both keep the energy
    (central that of its own: kinetic and strain together swing by (omega h)^2/4 between them).
    """
    dt, span = 0.01, 2 * math.pi * periods
    # the clock sums the steps, and the last one takes what rounding has left
    clock = OMEGA * periods / dt * float(np.spacing(float(periods)))
    x = OMEGA * dt / 2
    for method, own, phase, energy in (
        ("EXACT", 1.0, 1e-15 * span + 1e-12, 1e-12),
        ("NEWMARK", math.atan(x) / x, clock + 1e-9, 1e-10),
        ("CENTRAL", math.asin(x) / x, clock + 3 * x * x, x * x),
    ):
        ahead, drift = drifted(tmp_path, method, periods, 0.0 if method == "EXACT" else dt)
        assert abs(wrapped(ahead - span * (own - 1.0))) < phase, method
        assert abs(drift) < energy, method


@pytest.mark.slow
def test_a_thousand_seconds_of_record(tmp_path):
    """EXACT balances the energy of a long record that yields and pounds; steps come to the same drifts."""
    spec = catalog().family("contact")["KELVIN_VOIGT"]
    k = 100 * scene_case.STOREY
    quake = "EQUAKE\n SYNTHETIC PGA=10 SEED=7 DT=0.02 DURATION=1000\n"
    law = scene_case.items(spec, K=k)
    given = {
        "motion": quake,
        "gap": 0.02,
        "end": 1000.0,
        "every": 1.0,
        "speed": 0.0,
        "k2": 2 * scene_case.STOREY,
    }
    text = contact.pair(law, damping=scene_case.damped(0.05), **given)
    deck = tmp_path / "long.inp"
    found = []
    for method in ("EXACT", "NEWMARK DT=0.002"):
        deck.write_text(text.replace(scene_case.METHOD, method))
        found.append(results_of(deck, out=tmp_path / method[:5]))
    checks = found[0].table("checks")
    assert float(checks["value"][0]) < 1e-9 and found[0].table("contact_summary")["closures"][0] > 20
    u = [np.abs(r.history("node/u")[:, :, 0]).max() for r in found]
    assert u[1] == pytest.approx(u[0], rel=0.05)


BITS = """import hashlib, sys
from pound_solve.cli.main import main
assert main([sys.argv[1], "-o", sys.argv[2], "--quiet"]) == 0
from pound_solve.results import Results
with Results.open(sys.argv[2] + "/row.h5") as r:
    print(*(hashlib.sha256(r.history(k).tobytes()).hexdigest() for k in sorted(r.histories)))
"""


def test_the_same_deck_gives_the_same_bits_on_any_number_of_cores(tmp_path):
    """The command line takes one thread of linear algebra, unless it is told otherwise."""
    deck = tmp_path / "row.inp"
    n = 60
    k = 100 * scene_case.STOREY
    law = scene_case.items(catalog().family("contact")["KELVIN_VOIGT"], K=k)
    text = contact.CROWD.format(n=n, law=law, k=k, end=0.1)
    chain = text.replace(scene_case.METHOD, "EXACT").replace(
        f"STOREY 1 TO {n}\n", f"STOREY 1 TO {n}\n 901 TO 959 STOREY 1 TO 59 2 TO 60\n"
    )
    deck.write_text(chain)
    said = []
    for i, threads in enumerate(("", "", "1")):
        env = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
        env |= {"PYTHONPATH": os.pathsep.join(sys.path)} | (
            {"OPENBLAS_NUM_THREADS": threads} if threads else {}
        )
        words = [sys.executable, "-c", BITS, str(deck), str(tmp_path / str(i))]
        said.append(subprocess.run(words, env=env, capture_output=True, text=True, check=True).stdout)
    assert said[0] and said[0] == said[1] == said[2]
