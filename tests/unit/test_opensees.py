"""Decks as scripts for OpenSees: contents of the script, refusals, extrapolation, and runs of OpenSees."""

from __future__ import annotations

import math
import os
import runpy
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from pound_deck.diagnostics import Diagnostic
from pound_solve.catalog import catalog
from pound_solve.cli.main import main
from pound_solve.driver.run import DeckError, Request, prepare
from pound_solve.loading.piecewise import Piecewise
from pound_solve.opensees import environment, impacts
from pound_solve.opensees.damping import STIFF
from pound_solve.opensees.export import ELEMENTS, Exported, export
from pound_solve.opensees.extrapolation import Limit, limit
from pound_solve.opensees.impacts import LAWS
from pound_solve.opensees.motions import corners
from pound_solve.opensees.page import page
from pound_solve.opensees.peaks import ComparedItems
from pound_solve.opensees.rules import RULES
from pound_solve.opensees.verify import AGREES, DIFFERS, UNDECIDED, Compared, Comparison, evened, verify
from samples import written

ROOT = Path(__file__).parents[2]
#: interpreter with openseespy, where there is one
PEER = Path(os.environ.get("POUND_PEER", ROOT / ".venv-peer/bin/python"))
#: decks of ``validation/open`` wait for numbers
EXAMPLES = sorted(
    p for p in (ROOT / "examples").rglob("*.inp") if p.stem != "steel_20x6" and p.parent.name != "open"
)

DECK = """TITLE  A frame beside a wall
UNITS  kN m s
GEOMETRY PDELTA
NODES
   1  0 0  FIX=XYR
   2  0 3
   3  5 3
   4  5 0  FIX=XYR
   5  5 3.5  SLAVED=XYR  MASTER=3
ELEMENTS
   1  COLUMN  1 2
   2  COLUMN  4 3
   3  BEAM    2 3
   4  BRACE   1 3
   5  WALL    5   NAME="roof"
   6  LINK    2 3
   7  DAMPER  2
PROPS
   COLUMN  FRAME  E=25E6 A=0.16 I=2E-3 LP=0.3 MI=150 MJ=150,-140 RULE=BILINEAR R=0.03
   BEAM    FRAME  E=25E6 A=0.2 I=4E-3 PIN=J WGT=2
   BRACE   FRAME  E=2E8 A=1E-3
   WALL    CONTACT GAP=0.02 {law}
   LINK    SPRING KX=300 FX=5 {rule}
   DAMPER  DASHPOT CX=20 ANGLE=90
WEIGHTS
   2,3  200
LOADS
   2  1 -50
INITIAL
   3  VX=0.1
DAMPING
   RAYLEIGH ALPHA=0.3 BETA=0.002
DRIFT
   "left" 1 2
EQUAKE
   TABLE POINTS=0,0,0.5,1,1,0
ANALYSIS
   STATIC
   HISTORY 1
"""
LAW, RULE = "LAW=KELVIN_VOIGT K=1E5 C=30 TENSION=YES", "RULE=ELASTO_PLASTIC"


def exported(folder: Path, text: str) -> Exported:
    """The script of a deck."""
    path = folder / "frame.inp"
    path.write_text(text, "utf-8")
    return export(prepare(Request(str(path))), str(path))


def refusals(folder: Path, text: str) -> tuple[Diagnostic, ...]:
    """What is refused of a deck; nothing if it becomes a script."""
    try:
        exported(folder, text)
    except DeckError as err:
        return err.diagnostics
    return ()


class Recorder(ModuleType):
    """Stands in for openseespy.opensees: keeps the commands of a script and computes nothing."""

    def __init__(self) -> None:
        super().__init__("openseespy.opensees")
        self.calls: list[tuple[Any, ...]] = []

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments: self.calls.append((name, *arguments))

    def of(self, command: str, *first: object) -> list[tuple[Any, ...]]:
        """Arguments of the calls of a command that begin so."""
        n = 1 + len(first)
        return [call[n:] for call in self.calls if call[:n] == (command, *first)]


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Recorder:
    """Commands that build the deck above."""
    recorder, package = Recorder(), ModuleType("openseespy")
    package.opensees = recorder  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "openseespy", package)
    monkeypatch.setitem(sys.modules, "openseespy.opensees", recorder)
    script = tmp_path / "frame_opensees.py"
    exported(tmp_path, DECK.format(law=LAW, rule=RULE)).write(script)
    functions = runpy.run_path(str(script))
    for name in ("nodes", "elements", "loads", "damping", "motion"):
        functions[name]()
    return recorder


def test_nodes_supports_and_masses_are_those_of_the_deck(recorded: Recorder) -> None:
    assert (5, 5.0, 3.5) in recorded.of("node")
    assert (1, 1, 1, 1) in recorded.of("fix")
    assert recorded.of("rigidLink", "beam") == [(3, 5)]
    m, own = 200.0 / 9.81, 2.0 / 9.81 * 5.0 / 2.0
    assert [x[0] for x in recorded.of("mass")] == [2, 3]
    assert np.allclose([x[1:] for x in recorded.of("mass")], [(m + own, m + own, 0.0)] * 2, rtol=1e-14)


def test_elements_have_the_numbers_of_the_deck(recorded: Recorder) -> None:
    (beam,) = recorded.of("element", "elasticBeamColumn")
    assert beam[:6] == (3, 2, 3, 0.2, 25e6, 4e-3) and beam[-2:] == ("-release", 2)
    (bar,) = recorded.of("element", "Truss")
    assert bar[:4] == (4, 1, 3, 1e-3)
    assert [x[0] for x in recorded.of("element", "forceBeamColumn")] == [1, 2]
    materials = {x[1]: (x[0], *x[2:]) for x in recorded.of("uniaxialMaterial")}
    springs = {x[0]: x for x in recorded.of("element", "zeroLength")}
    tags = {e: x[x.index("-mat") + 1] for e, x in springs.items()}
    assert materials[tags[5]] == ("ViscoelasticGap", 1e5, 30.0, -0.02)
    assert materials[tags[6]] == ("ElasticPP", 300.0, 5 / 300, -5 / 300, 0.0)
    assert materials[tags[7]] == ("Viscous", 20.0, 1.0)
    assert springs[5][-2:] == ("-doRayleigh", 0) and springs[6][-2:] == ("-doRayleigh", 1)
    at = springs[7].index("-orient")
    assert springs[7][at + 1 : at + 7] == (0.0, 1.0, 0.0, -1.0, 0.0, 0.0)


def test_sections_of_hinges_add_up_to_the_elastic_beam(recorded: Recorder) -> None:
    """Flexibility of a column at its ends: L/(3 EI), -L/(6 EI)."""
    stiffness = {x[0]: x[-1] * x[1] for x in recorded.of("section", "Elastic")}
    materials = {x[1]: (x[0], *x[2:]) for x in recorded.of("uniaxialMaterial")}

    def initial(tag: int) -> float:
        kind, *arguments = materials[tag]
        if kind == "Parallel":
            return sum(initial(part) for part in arguments)
        return float(arguments[1] if kind == "Steel01" else arguments[0])

    stiffness |= {x[0]: initial(x[1]) for x in recorded.of("section", "Uniaxial")}
    for _, count, *points in recorded.of("beamIntegration", "UserDefined"):
        sections, places, weights = (np.array(points[i * count : (i + 1) * count]) for i in range(3))
        k = np.array([stiffness[int(s)] for s in sections])
        ends = np.array([places - 1.0, places])
        flexibility = 3.0 * (ends * weights / k) @ ends.T
        ei = 25e6 * 2e-3
        assert np.allclose(flexibility, 3.0 / ei * np.array([[1 / 3, -1 / 6], [-1 / 6, 1 / 3]]), rtol=1e-12)


def test_loads_damping_and_motion(recorded: Recorder) -> None:
    assert (2, 1.0, -50.0, 0.0) in recorded.of("load")
    assert recorded.of("eleLoad", "-ele", 3) == [("-type", "-beamUniform", -2.0, 0.0)]
    regions = {x[1]: x for x in recorded.of("region")}
    assert regions["-node"][-4:] == (0.3, 0.0, 0.0, 0.0) and regions["-node"][2:4] == (2, 3)
    assert regions["-eleOnly"][-4:] == (0.0, 0.0, 0.002, 0.0)
    assert sorted(regions["-eleOnly"][2:-5]) == [1, 2, 3, 4, 6]
    (path,) = recorded.of("timeSeries", "Path")
    assert path[1:] == ("-time", 0.0, 0.5, 1.0, "-values", 0.0, 1.0, 0.0)
    assert recorded.of("setNodeVel") == [(3, 1, 0.1, "-commit")]


def test_jumps_of_a_motion_stay() -> None:
    lines = Piecewise(np.array([0.0, 1.0, 2.0]), np.array([[0.0, 3.0], [0.0, -1.0]]))
    t, a = corners(lines)
    assert a.tolist() == [0.0, 0.0, 3.0, 2.0]
    assert t[1] < t[2] == 1.0 and t[2] - t[1] < 1e-15


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize("law", [*catalog().family("contact")])
def test_every_contact_law_is_exported_or_refused_by_its_name(tmp_path: Path, law: str) -> None:
    spec = catalog().family("contact")[law]
    items = written(spec, 1e4, 0.01)
    items += " K=1E6" * (" K=" not in f" {items}" and spec.field("K") is not None)
    items += " DIAPHRAGMS=1E6" * (law == "EQUIVALENT")
    told = refusals(tmp_path, DECK.format(law=f"LAW={law} {items}", rule=RULE))
    if law in LAWS and law != "KELVIN_VOIGT":
        assert not told
    else:
        (refusal,) = told
        assert refusal.code == "P380" and law in refusal.message
        assert (
            refusal.span is not None
            and refusal.span.line == DECK[: DECK.index("WALL    CONTACT")].count("\n") + 1
        )


@pytest.mark.parametrize("rule", [x for x in catalog().family("hysteresis") if x != "ELASTIC"])
def test_every_rule_is_exported_or_refused_by_its_name(tmp_path: Path, rule: str) -> None:
    spec = catalog().family("hysteresis")[rule]
    text = f"RULE={rule} {written(spec, 5.0, 5.0 / 300.0)}"
    told = refusals(tmp_path, DECK.format(law=LAW, rule=text))
    assert not told if rule in RULES else [rule in x.message for x in told] == [True]


def test_every_element_and_damping_has_a_decision() -> None:
    refused = {"BEAM_COLUMN", "FOUNDATION", "MULTISPRING", "TENDON"}
    assert {*ELEMENTS} | refused == {*catalog().family("element")}
    assert {*STIFF} < {*ELEMENTS}


def test_all_refusals_come_in_one_pass(tmp_path: Path) -> None:
    text = DECK.format(law="LAW=STEREOMECHANICS E=0.5", rule="RULE=CLOUGH")
    changes = {
        "RULE=BILINEAR R=0.03": "RULE=TAKEDA FJ=1E-6",
        "VX=0.1": "UX=0.01",
        "RAYLEIGH ALPHA=0.3 BETA=0.002": "CAUGHEY XI=0.05,0.05 MODES=1,2",
        "   STATIC\n": "   STATIC\n   PUSHOVER NODE=2 TARGET=0.1\n",
    }
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    told = refusals(tmp_path, text)
    assert {x.code for x in told} == {"P380"}
    words = ("STEREOMECHANICS", "CLOUGH", "TAKEDA", "FJ", "displacement", "CAUGHEY", "PUSHOVER")
    for word in words:
        assert any(word in x.message for x in told), word
    assert all(x.span for x in told)


@pytest.mark.full
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_example_is_written_or_refused_with_a_line(path: Path) -> None:
    try:
        ready = prepare(Request(str(path)))
    except DeckError as err:
        assert {x.code for x in err.diagnostics} & {"R401"}, "a deck of the examples has mistakes"
        pytest.skip("needs a record")
    try:
        script = export(ready, str(path))
    except DeckError as err:
        assert err.diagnostics and all(x.code == "P380" and x.span for x in err.diagnostics)
    else:
        compile(script.text, "script", "exec")
        assert script.step > 0.0


# ---------------------------------------------------------------- extrapolation and the verbs


def test_the_limit_of_second_order_is_found_with_its_order() -> None:
    q = [3.0 + 0.2 * h**2 for h in (1.0, 0.5, 0.25)]
    extrapolated = limit(*q)
    assert extrapolated.order == pytest.approx(2.0, abs=1e-12)
    assert extrapolated.value == pytest.approx(3.0, abs=1e-14)
    assert extrapolated.uncertainty == pytest.approx(3.0 * 0.2 / 16.0, rel=1e-12)


@pytest.mark.parametrize("order", [0.6, 1.0, 1.7])
def test_other_orders_are_observed(order: float) -> None:
    extrapolated = limit(*(1.0 - 0.01 * h**order for h in (1.0, 0.5, 0.25)))
    assert extrapolated.order == pytest.approx(order, abs=1e-9)
    assert extrapolated.value == pytest.approx(1.0, abs=1e-11)


def test_values_that_turn_show_no_order() -> None:
    extrapolated = limit(1.0, 1.2, 1.1)
    assert math.isnan(extrapolated.order)
    assert extrapolated.uncertainty == pytest.approx(0.1)


def test_values_that_are_close_by_chance_are_no_more_certain_than_others() -> None:
    items = ComparedItems({"a": 1}, {}, {})
    uncertain = {"contact a, force": 1e-3, "x": 2e-6, "y": 4e-6, "z": 1e-9}
    rows = [Compared(n, 2.0, 0.0, (), Limit(2.0, 2.0, 2.0 * u)) for n, u in uncertain.items()]
    rows.append(Compared("w", 1e-20, 0.0, (), Limit(1.0, 1e-20, 1e-8)))  # next to zero: no share of itself
    even = evened(rows, items)
    assert [x.limit.uncertainty / 2.0 for x in even[:4]] == pytest.approx([1e-3, 2e-6, 4e-6, 2e-6])
    assert even[4].limit.uncertainty == 1e-8 and even[4].size == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("ours", "uncertainty", "error", "outcome"),
    [
        (2.001, 0.002, 0.0, AGREES),
        (2.003, 0.002, 0.0, DIFFERS),
        (2.003, 0.002, 0.002, AGREES),
        (2.003, 0.5, 0.0, UNDECIDED),
        (2.7, 0.5, 0.0, DIFFERS),
    ],
)
def test_a_peak_agrees_only_where_its_uncertainty_is_small(
    ours: float, uncertainty: float, error: float, outcome: str
) -> None:
    row = Compared("x", ours, error, (2.0, 2.0, 2.0), Limit(2.0, 2.0, uncertainty), 3.0)
    assert row.outcome == outcome
    told = page(Comparison([row], "OpenSees 3", 1e-3, "TAYLOR", error, "Know this."))
    assert outcome in told and told.endswith("Know this.")
    assert ("smaller --step" in told) == (outcome != AGREES)


def test_silent_interpreters_and_far_too_coarse_steps_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deck = tmp_path / "frame.inp"
    deck.write_text(DECK.format(law=LAW, rule=RULE), "utf-8")

    def told(*options: str) -> str:
        assert main([*options]) != 0
        return capsys.readouterr().err

    talks = _interpreter(tmp_path, "print('3.7.1')")
    assert "--step 100 is too coarse" in told("verify", str(deck), "--python", talks, "--step", "100")
    assert "OpenSees stops" in told("verify", str(deck), "--python", talks)
    silent = _interpreter(tmp_path, "pass")
    assert "has no OpenSees" in told("verify", str(deck), "--python", silent)
    assert "--opensees" in told("export", str(deck))
    row = '   5  WALL    5   NAME="roof"'
    twice = DECK.format(law=LAW, rule=RULE).replace(row, f'{row}\n   60  WALL    5   NAME="roof"')
    deck.write_text(twice, "utf-8")
    assert "the contacts 5 and 60 have one name, 'roof'" in told("export", str(deck), "--opensees")


def test_laws_whose_models_differ_are_told() -> None:
    assert "GONTHIER" in impacts.remark({"GONTHIER", "LINEAR"})
    assert impacts.remark({"LINEAR", "HERTZ"}) == ""


def test_equal_values_are_their_own_limit() -> None:
    assert limit(0.0, 0.0, 0.0)[1:] == (0.0, 0.0)
    assert limit(2.0, 2.0, 2.0).value == 2.0


def test_export_writes_the_script_and_its_motion(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deck = tmp_path / "frame.inp"
    deck.write_text(DECK.format(law=LAW, rule=RULE), "utf-8")
    assert main(["export", str(deck), "--opensees", "-o", str(tmp_path / "out")]) == 0
    paths = capsys.readouterr().out.split()
    assert [Path(p).name for p in paths] == ["frame_opensees.py", "frame_motion1.txt"]
    assert Path(paths[1]).read_text() == "0.0 0.0\n0.5 1.0\n1.0 0.0\n"
    text = Path(paths[0]).read_text("utf-8")
    compile(text, paths[0], "exec")
    assert '"""A frame beside a wall' in text and str(tmp_path) not in text


def test_names_of_a_user_do_no_harm(tmp_path: Path) -> None:
    text = DECK.format(law=LAW, rule=RULE).replace('NAME="roof"', 'NAME="a\\\'{0}"')
    text = text.replace("A frame beside a wall", 'A """frame""" \\')
    compile(exported(tmp_path, text).text, "script", "exec")


#: the node at the end of the arm becomes a hinge: it follows the floor along x, the joint along y
HINGED = (
    DECK.replace("   3  5 3\n", "   3  5 3  SLAVED=X  MASTER=2\n")
    .replace("5 3.5  SLAVED=XYR  MASTER=3", "5 3  SLAVED=YX  MASTER=3,2")
    .replace("3  BEAM    2 3\n", "3  BEAM    2 5\n   8  HINGE   3 5\n")
    .replace("PROPS\n", "PROPS\n   HINGE  SPRING KR=3E4\n")
    .replace("   6  LINK    2 3\n", "   6  LINK    1 3\n")
    .replace("   3  VX=0.1\n", "   2  VX=0.1\n")
)


def test_a_node_that_follows_several_is_tied_to_each(tmp_path: Path) -> None:
    text = HINGED.format(law=LAW, rule=RULE)
    lines = exported(tmp_path, text).text.splitlines()
    ties = [line.strip() for line in lines if "equalDOF" in line or "rigidLink" in line]
    assert ties == ["ops.equalDOF(2, 3, 1)", "ops.equalDOF(2, 5, 1)", "ops.equalDOF(3, 5, 2)"]
    assert any(line.startswith('CONSTRAINTS = "Plain"') for line in lines)
    beside = text.replace("NODES\n", "NODES\n   9  0 4  SLAVED=XYR  MASTER=2\n", 1)
    (told,) = refusals(tmp_path, beside)
    assert told.message.endswith(
        "node 5 follows one that follows a third, and other nodes follow by rigid arms"
    )
    assert told.span is not None and beside.splitlines()[told.span.line - 1].startswith("   5  5 3")


def test_consistent_masses_are_refused(tmp_path: Path) -> None:
    (told,) = refusals(tmp_path, "MASS CONSISTENT\n" + DECK.format(law=LAW, rule=RULE))
    assert "CONSISTENT" in told.message and told.span is not None


def test_options_of_a_deck_need_opensees(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "model.h5", "--set", "a=1"]) == 2
    assert "--set belongs to --opensees" in capsys.readouterr().err


def test_an_environment_without_opensees_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deck = tmp_path / "frame.inp"
    deck.write_text(DECK.format(law=LAW, rule=RULE), "utf-8")
    assert main(["verify", str(deck), "--python", str(tmp_path / "python")]) == 1
    assert "cannot be started" in capsys.readouterr().err
    with pytest.raises(environment.OpenSeesError, match=r"has no OpenSees .*pip install openseespy"):
        environment.version(_interpreter(tmp_path, "import sys; sys.exit('No module named openseespy')"))


def test_a_run_that_stops_tells_its_time(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("raise SystemExit('OpenSees does not converge in the step after t = 0.3')")
    with pytest.raises(environment.OpenSeesError, match=r"stops at dt=0.01: .* t = 0.3"):
        environment.run(sys.executable, script, 0.01)


def _interpreter(folder: Path, code: str) -> str:
    """An interpreter that runs `code` whatever it is asked."""
    path = folder / "interpreter"
    path.write_text(f"#!{sys.executable}\n{code}\n")
    path.chmod(0o755)
    return str(path)


@pytest.mark.slow
@pytest.mark.skipif(not PEER.exists(), reason="needs the environment of benchmarks/peer_env.py")
@pytest.mark.parametrize(
    ("deck", "law"),
    [(DECK, LAW), (DECK, "LAW=LINEAR K=1E5"), (DECK, "LAW=JANKOWSKI K=1E6 XI=0.3"), (HINGED, LAW)],
)
def test_opensees_finds_our_peaks(tmp_path: Path, deck: str, law: str) -> None:
    path = tmp_path / "frame.inp"
    path.write_text(deck.format(law=law, rule=RULE), "utf-8")
    comparison, _, _ = verify(Request(str(path)), str(PEER), 1e-4, lambda _: None)
    assert len(comparison.rows) == 5
    assert all(x.outcome == AGREES for x in comparison.rows), page(comparison)
