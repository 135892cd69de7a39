"""Models of OpenSees: what comes of each command, what OpenSees itself computes, and what is refused."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest

from imports.opensees_models import FIBRES, FRAME, HINGED, IN_PYTHON, POUNDING, TRUSS
from pound_deck.diagnostics import has_errors
from pound_deck.messages import MESSAGES
from pound_deck.reader import read_text
from pound_import.opensees.replay import NaturalModes, replay
from pound_solve import run
from pound_solve.catalog import catalog
from pound_solve.cli.main import main
from pound_solve.driver.importing import Choices, imported

pytest.importorskip("tkinter")
ROOT = Path(__file__).parents[2]
KN = ("kN", "m", "s")
HEAD = """model basic -ndm 2 -ndf 3
node 1 0 0
node 2 0 3
fix 1 1 1 1
geomTransf Linear 1
mass 2 1 1 0
"""
BEAM = "element elasticBeamColumn 1 1 2 0.1 2e7 1e-3 1\n"
LINK = "element zeroLength 8 1 2 -mat 5 -dir 1\n"


def read(folder, text, name="model.tcl", **choices):
    (folder / name).write_text(text)
    _, translation = imported(str(folder / name), Choices(**choices))
    return translation


def model(folder, text, **choices):
    translation = read(folder, text, units=KN, **choices)
    assert not has_errors(translation.report), translation.report
    new, mistakes, _ = read_text(translation.text, catalog())
    assert new is not None, mistakes
    return new


def errors(translation):
    return [(d.code, d.span.line, d.message) for d in translation.report if d.severity == "error"]


# ---------------------------------------------------------------------- replay


def commands(folder, text, **files):
    for name, content in files.items():
        (folder / f"{name}.tcl").write_text(content)
    (folder / "model.tcl").write_text(text)
    return replay(
        folder / "model.tcl", "model.tcl", "tcl_model", lambda so_far, count: NaturalModes([4.0, 9.0])
    )


def test_commands_come_with_the_file_and_line_that_called_them(tmp_path):
    text = "foreach n {1 2} {\n    node $n 0 $n\n}\nsource part.tcl\ncorner 7\n"
    text += "pattern Plain 1 Linear {\n\n  load 1 2 3 4\n}\n"
    done = commands(tmp_path, text, part="proc corner {n} {\n  node $n 5 [expr {$n*2}]\n}\ncorner 6\n")
    assert done.mistake is None
    assert [(c.words, c.span.file, c.span.line) for c in done.commands] == [
        (("node", "1", "0", "1"), "model.tcl", 2),
        (("node", "2", "0", "2"), "model.tcl", 2),
        (("node", "6", "5", "12"), "part.tcl", 2),
        (("node", "7", "5", "14"), "part.tcl", 2),
        (("pattern", "Plain", "1", "Linear"), "model.tcl", 6),
        (("load", "1", "2", "3", "4"), "model.tcl", 8),
    ]


def test_a_model_is_answered_from_itself(tmp_path):
    text = """
    node 3 1.5 2.5
    mass 3 4 5 6
    set w [eigen 2]
    node 4 [nodeCoord 3 2] [lindex $w 1]
    analysis Static
    integrator DisplacementControl 3 1 0.25
    analyze 3
    node 5 [nodeDisp 3 1] [lindex [nodeMass 3] 1]
    analysis Transient
    analyze 4 0.5
    node 6 [getTime] [llength [eleResponse 1 forces]]
    node 7 [nodeReaction 3 1] [llength [getNodeTags]]
    """
    done = commands(tmp_path, text)
    assert done.mistake is None
    nodes = [list(map(float, c.words[2:])) for c in done.commands if c.name == "node"]
    assert nodes == [[1.5, 2.5], [2.5, 9.0], [0.75, 5.0], [2.0, 12.0], [0.0, 4.0]]


def test_files_of_the_folder_are_read_and_written_ones_stay_in_memory(tmp_path):
    (tmp_path / "points.txt").write_text("1 0 0\n2 0 3\n")
    text = """
    set in [open points.txt r]
    while {[gets $in line] >= 0} { node {*}$line }
    close $in
    set out [open record.txt w]
    puts $out "0.1 0.2"
    puts -nonewline $out 0.3
    close $out
    file mkdir results
    exec touch here
    timeSeries Path 1 -dt 0.1 -filePath record.txt
    """
    done = commands(tmp_path, text)
    assert done.mistake is None and len(done.commands) == 3
    assert done.written == {"record.txt": "0.1 0.2\n0.3"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["model.tcl", "points.txt"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("set in [open ../secret.txt r]", "outside of the folder"),
        ("set in [open /etc/passwd r]", "outside of the folder"),
        ('set in [open "|ls" r]', "no such file"),
        ("source ../secret.tcl", "outside of the folder"),
        ("socket localhost 80", "socket"),
        ("node 1 $missing 0", "missing"),
        ("node 1 [expr {1/0}] 0", "divide by zero"),
        ("while {1} {node 1 0 0}", "more than 3 s"),
        ("while {1} {}", "more than 3 s"),
        ("set a x; while {1} {append a $a}", "use of memory"),
    ],
)
def test_a_model_that_ends_early_is_told_with_its_place(tmp_path, text, message):
    (tmp_path.parent / "secret.txt").write_text("1")
    (tmp_path / "model.tcl").write_text(f"set ok 1\n{text}\n")
    done = replay(
        tmp_path / "model.tcl", "model.tcl", "tcl_model", lambda c, n: NaturalModes(), seconds=3.0
    )
    if message == "socket":  # not in the interpreter: a command like any other
        assert done.commands[-1].words == ("socket", "localhost", "80")
    else:
        assert done.mistake and done.mistake.code == "L621" and message in done.mistake.message
        assert done.mistake.span.line == (1 if message == "use of memory" else 2)


def test_a_loop_that_waits_for_a_result_is_no_warning(tmp_path):
    text = HEAD + BEAM + "analysis Static\nwhile {[nodeDisp 2 1] < 1} { analyze 1 }\n"
    (tmp_path / "model.tcl").write_text(text)
    done = replay(
        tmp_path / "model.tcl", "model.tcl", "tcl_model", lambda c, n: NaturalModes(), seconds=2.0
    )
    assert done.mistake and done.mistake.severity == "error" and "a count" in done.mistake.hint


def test_what_a_model_asks_of_its_results_does_not_refuse_it(tmp_path):
    text = HEAD + BEAM + "analysis Static\nanalyze 1\nset x [expr {1/int([nodeDisp 2 1])}]\n"
    translation = read(tmp_path, text)
    assert translation.text and [d.code for d in translation.report] == ["L621"]
    assert "divide by zero" in translation.report[0].message


# ---------------------------------------------------------------------- whole models against OpenSees


def solved(folder, text):
    """Results file of a model that is imported and run."""
    deck = folder / "new.inp"
    translation = read(folder, text, units=KN)
    assert not has_errors(translation.report), translation.report
    deck.write_text(translation.text)
    return h5py.File(run(deck, out=folder, tol=1e-6).path)


def peaks(file, node):
    """Least and largest displacement of a node along x."""
    rows = file["tables/node_envelope"][:]
    chosen = (rows["node"] == node) & (rows["direction"] == b"X") & (rows["quantity"] == b"displacement")
    (row,) = rows[chosen]
    return [row["min"], row["max"]]


def test_a_frame_has_the_periods_displacements_and_peaks_of_opensees(tmp_path):
    """OpenSees 3.7.1: eigen -fullGenLapack; Newmark, steps of 1e-3 and 5e-4 s, extrapolated."""
    m = model(tmp_path, FRAME)
    assert m.geometry == "PDELTA_VARYING"
    assert [a.spec.name for a in m.analyses] == ["MODAL", "STATIC", "HISTORY"]
    assert [(d["I"], d["J"]) for d in m.drifts] == [(1, 11), (11, 21)]
    with solved(tmp_path, FRAME.replace("PDelta", "Linear")) as file:  # modes here have the loads' P-Delta
        periods = file["tables/modes"]["period"][:2]
    with solved(tmp_path, FRAME) as file:
        static = file["tables/static_displacement"][:]
        roof = static[static["node"] == 21][0]
        moved = peaks(file, 21)
    assert periods == pytest.approx([0.735111998353399, 0.24595981241341597], rel=1e-11)
    expected = [2.0142974194490615e-05, -0.0004325999999999999, -0.001592591777926008]
    assert [roof["x"], roof["y"], roof["r"]] == pytest.approx(expected, rel=1e-9)
    assert moved == pytest.approx([-0.10180726810, 0.10490725041], rel=2e-6)


def test_a_model_that_asks_for_modes_under_load_gets_those_of_opensees(tmp_path):
    """OpenSees 3.7.1: a cantilever with P-Delta, whose first circular frequency is 1.60565."""
    text = """
model basic -ndm 2 -ndf 3
node 1 0 0
node 2 0 4
fix 1 1 1 1
mass 2 20 20 0
geomTransf PDelta 1
element elasticBeamColumn 1 1 2 0.1 2.7e7 1e-4 1
pattern Plain 1 Linear { load 2 0 -300 0 }
integrator LoadControl 0.1
analysis Static
analyze 10
loadConst -time 0.0
set w [expr {sqrt([eigen 1])}]
rayleigh [expr {0.1*$w}] 0 0 0
"""
    (damping,) = model(tmp_path, text).damping
    assert damping["ALPHA"] == pytest.approx(0.160565, rel=1e-5)


def test_a_record_that_is_missing_is_told_at_its_line(tmp_path):
    motion = 'pattern UniformExcitation 2 1 -accel "Series -dt 0.02 -filePath none.txt"\n'
    (warning,) = read(tmp_path, HEAD + BEAM + motion).report
    assert (warning.code, warning.span.line) == ("L609", 8) and "none.txt" in warning.message


def test_a_force_of_a_file_that_the_model_writes_has_its_factor_once(tmp_path):
    text = (
        HEAD
        + BEAM
        + """
set out [open force.dat w]
foreach f {0.0 1.0 0.0} { puts $out $f }
close $out
timeSeries Path 2 -dt 0.5 -filePath force.dat -factor 3.0
pattern Plain 2 2 { load 2 5.0 0 0 }
analysis Transient
analyze 100 0.01
"""
    )
    (force,) = model(tmp_path, text).forces
    assert (force["FX"], force["POINTS"]) == (5.0, (0.0, 0.0, 0.5, 3.0, 1.0, 0.0))


def test_a_record_that_the_model_writes_is_in_the_deck(tmp_path):
    text = (
        HEAD
        + BEAM
        + """
set out [open quake.dat w]
foreach a {0.0 1.0 -1.0 0.0} { puts $out $a }
close $out
pattern UniformExcitation 2 1 -accel "Series -dt 0.02 -filePath quake.dat -factor 2.0"
analysis Transient
analyze 100 0.01
"""
    )
    (card,) = model(tmp_path, text).equake
    assert (card.spec.name, card["POINTS"]) == ("TABLE", (0.0, 0.0, 0.02, 2.0, 0.04, -2.0, 0.06, 0.0))


def test_two_masses_that_collide_go_where_those_of_opensees_go(tmp_path):
    """OpenSees 3.7.1: Newmark, steps of 1e-4 and 5e-5 s, which differ by 1e-4."""
    m = model(tmp_path, POUNDING)
    damping = [(d["ALPHA"], d["BETA"], d["NODES"], d["PROPS"]) for d in m.damping]
    assert damping == [(0.1, 0.0, (4,), None), (0.2, 0.0, (2,), None), (0.0, 0.001, None, ("S1",))]
    with solved(tmp_path, POUNDING) as file:
        assert peaks(file, 2) == pytest.approx([-0.051497011579958, 0.024053527626147733], rel=2e-4)


def test_a_section_of_fibres_is_reduced_to_hinges(tmp_path):
    """OpenSees 3.7.1, forceBeamColumn of five sections: a push of 0.06 m takes 102.97 kN."""
    m = model(tmp_path, FIBRES)
    column = m.props["B1"]
    assert column["RULE"] == "TAKEDA" and column["LP"] == pytest.approx((0.15,))
    assert column["MI"][0] == pytest.approx(-column["MI"][1], rel=1e-6)  # a section alike on both sides
    push = m.analyses[-1]
    assert (push["NODE"], push["TARGET"], push["NODES"]) == (2, (0.06,), (2,))
    with solved(tmp_path, FIBRES) as file:
        curve = file["tables/capacity_curve"][:]
    assert curve["base_shear"][-1] == pytest.approx(102.96512470399513, rel=0.002)


# ---------------------------------------------------------------------- each material, section and element


def props(folder, text):
    m = model(folder, HEAD + text)
    return m, next(iter(m.props.values()))


MATERIALS = {
    "Elastic 1 50": "SPRING KX=50",
    "Elastic 1 50 2": "DASHPOT CX=2",
    "ElasticPP 1 50 0.02 -0.01": "SPRING KX=50 FX=1,-0.5 RULE=ELASTO_PLASTIC",
    "Steel01 1 2 50 0.1": "SPRING KX=50 FX=2,-2 RULE=BILINEAR R=0.1",
    "Steel01 1 2 50 0": "SPRING KX=50 FX=2,-2 RULE=ELASTO_PLASTIC",
    "Steel02 1 2 50 0.1": "SPRING KX=50 FX=2,-2 RULE=MENEGOTTO_PINTO R=0.1 R0=20 CR1=0.925 CR2=0.15",
    "Hardening 1 40 2 0 10": "SPRING KX=40 FX=2,-2 RULE=BILINEAR R=0.2",
    "SelfCentering 1 50 5 2 0.6": "SPRING KX=50 FX=2,-2 RULE=FLAG_SHAPED R=0.1 BETA=0.6",
    "BoucWen 1 0.1 50 1 5 15 1 0 0 0": "SPRING KX=50 FX=2.5,-2.5 RULE=BOUC_WEN R=0.1 N=1 BETA=0.75",
    "Hysteretic 1 2 0.02 6 0.82 -2 -0.02 -6 -0.82 1 1 0 0 0.4": (
        "SPRING KX=100 FX=2,-2 RULE=CLOUGH R=0.05 ALFA=0.4"
    ),
    "IMKPinching 1 50 0.2 0.4 1 2 1.2 0.1 0.2 0.4 1 2 1.2 0.1 2 3 4 5 1 1 1 1 1 1 0.4 0.5": (
        "SPRING KX=50 FX=2,-2 RULE=IMK_PINCHING R=0.04 RESIDUAL=0.1 DP=0.2 DPC=0.4 DU=1 LAMBDA=2,3,5,4 "
        "KAPPAF=0.4 KAPPAD=0.5"
    ),
    "Viscous 1 3 0.5": "DASHPOT CX=3 LAW=FLUID ALPHA=0.5",
    "ENT 1 50": "CONTACT GAP=0 ANGLE=0 LAW=LINEAR K=50",
    "ElasticPPGap 1 50 -1e9 -0.02": "CONTACT GAP=0.02 ANGLE=0 LAW=LINEAR K=50",
    "ElasticPPGap 1 50 1e9 0.02": "CONTACT GAP=0.02 ANGLE=180 LAW=LINEAR K=50",
    "ViscoelasticGap 1 50 3 -0.02": "CONTACT GAP=0.02 LAW=KELVIN_VOIGT K=50 C=3 TENSION=YES",
    "ImpactMaterial 1 50 20 -0.001 -0.02": "CONTACT GAP=0.02 LAW=BILINEAR_IMPACT K1=50 K2=20 DY=0.001",
    "Hertzdamp 1 50 0.4 -0.02": "CONTACT GAP=0.02 LAW=HERTZDAMP K=50 D=0.4",
    "Hertzdamp 1 50 0.4 -0.02 1.2": "CONTACT GAP=0.02 LAW=HUNT_CROSSLEY K=50 D=0.4 N=1.2",
    "JankowskiImpact 1 50 0.3 2.5 -0.02": "CONTACT GAP=0.02 LAW=JANKOWSKI K=50 XI=0.3 MASSES=5,5",
}


@pytest.mark.parametrize("material", MATERIALS)
def test_each_material_is_its_rule_or_law(tmp_path, material):
    """The equality of the laws was tried against OpenSees 3.7.1 on an oscillator under a sine."""
    text = f"uniaxialMaterial {material}\nelement zeroLength 1 1 2 -mat 1 -dir 1\n"
    kind, *items = MATERIALS[material].split()
    card = next(card for card in model(tmp_path, HEAD + text).props.values() if card.spec.name == kind)
    for item in items:
        name, _, value = item.partition("=")
        assert taken(card, name, value), name


def taken(card, name, text):
    """Whether an item of a card has the value of a text, words or numbers."""
    value = card[name] if isinstance(card[name], tuple) else (card[name],)
    if not text[0].isdigit():
        return value[0] == text
    return value == pytest.approx(tuple(map(float, text.split(","))))


def test_materials_side_by_side(tmp_path):
    text = "uniaxialMaterial Elastic 1 50\nuniaxialMaterial ENT 2 70\nuniaxialMaterial Parallel 3 1 2\n"
    m = model(tmp_path, HEAD + text + "element zeroLength 9 1 2 -mat 3 -dir 2\n")
    assert [(e.id, p.spec.name) for e, p in ((e, m.props[e.prop]) for e in m.elements.values())] == [
        (9, "SPRING"),
        (10, "CONTACT"),
    ]
    assert m.props["S1"]["KY"] == 50.0 and m.props["C1"]["ANGLE"] == 90.0


@pytest.mark.parametrize(
    ("orient", "angle"),
    [
        ("", 0.0),
        ("-orient 0 1 0 -1 0 0", 90.0),
        ("-orient 1 1 0 -1 1 0", 45.0),
        ("-orient -1 0 0 0 -1 0", 180.0),
    ],
)
def test_local_axes_of_links(tmp_path, orient, angle):
    text = f"uniaxialMaterial Elastic 1 50\nelement zeroLength 1 1 2 -mat 1 1 -dir 1 3 {orient}\n"
    _, card = props(tmp_path, text)
    assert (card["KX"], card["KY"], card["KR"]) == (50.0, 0.0, 50.0)
    assert card["ANGLE"] == pytest.approx(angle)


def test_a_link_of_a_length_has_its_shear_between_its_nodes(tmp_path):
    text = "uniaxialMaterial Elastic 1 50\nelement twoNodeLink 1 1 2 -mat 1 1 -dir 1 2 -shearDist 0.3\n"
    _, card = props(tmp_path, text)
    assert (card["ANGLE"], card["ARM"]) == (90.0, 0.3)


BEAMS = {
    "element elasticBeamColumn 1 1 2 0.1 2e7 1e-3 1 -release 2": "E=2e7 A=0.1 I=1e-3 PIN=J",
    "element ElasticTimoshenkoBeam 1 1 2 2e7 8e6 0.1 1e-3 0.08 1": "E=2e7 I=1e-3 G=2e7 AS=0.032",
    "geomTransf Linear 2 -jntOffset 0 0.2 0 -0.3\nelement elasticBeamColumn 1 1 2 0.1 2e7 1e-3 2": (
        "END1=0.2 END2=0.3"
    ),
    "element elasticBeamColumn 1 1 2 0.1 2e7 1e-3 1 -mass 2.0 -cMass": "WGT=19.62",
    "section Elastic 4 2e7 0.1 1e-3\nelement dispBeamColumn 1 1 2 3 4 1": "E=2e7 A=0.1 I=1e-3",
    "section Elastic 4 2e7 0.1 1e-3 8e6 0.8\nelement dispBeamColumn 1 1 2 3 4 1": "E=2e7 A=0.1 AS=0",
    "section Elastic 4 2e7 0.1 1e-3 8e6 0.8\nelement elasticBeamColumn 1 1 2 4 1": "E=2e7 A=0.1 AS=0",
    "section Elastic 4 2e7 0.1 1e-3 8e6 0.8\nelement forceBeamColumn 1 1 2 3 4 1": "G=2e7 AS=0.032",
    "uniaxialMaterial Steel01 1 50 2e4 0.1\nuniaxialMaterial Elastic 2 2e6\n"
    "section Aggregator 4 1 Mz 2 P\nelement forceBeamColumn 1 1 2 4 4 1": (
        "E=1 A=2e6 I=2e4 RULE=BILINEAR R=0.1 MI=50,-50 MJ=50,-50 LP=0.25"
    ),
    "uniaxialMaterial Steel01 1 50 2e4 0.1\nsection Uniaxial 4 1 Mz\nsection Elastic 5 2e7 0.1 1e-3\n"
    "beamIntegration HingeRadau 3 4 0.4 4 0.5 5\nelement forceBeamColumn 1 1 2 1 3": (
        "E=2e7 A=0.1 I=1e-3 RULE=BILINEAR R=0.1 MI=50,-50 LP=0.4,0.5"
    ),
    "uniaxialMaterial Steel01 1 50 2e4 0.1\nsection Uniaxial 4 1 Mz\n"
    "element beamWithHinges 1 1 2 4 0.4 4 0.5 2e7 0.1 1e-3 1": "I=1e-3 RULE=BILINEAR MJ=50,-50 LP=0.4,0.5",
    "uniaxialMaterial Elastic 1 2e8\nelement truss 1 1 2 0.01 1": "E=2e8 A=0.01 I=0",
    "section Elastic 4 2e8 0.01 1e-3\nelement corotTruss 1 1 2 4": "E=2e6 A=1 I=0",
}


@pytest.mark.parametrize("text", BEAMS)
def test_each_member_is_a_frame(tmp_path, text):
    _, card = props(tmp_path, text + "\n")
    assert card.spec.name == "FRAME"
    for item in BEAMS[text].split():
        name, _, value = item.partition("=")
        assert taken(card, name, value), name


def test_a_bar_that_yields_is_a_spring_along_it(tmp_path):
    text = "uniaxialMaterial Steel01 1 3e5 2e8 0.02\nelement truss 1 1 2 0.01 1\n"
    _, card = props(tmp_path, text)
    assert (card.spec.name, card["ANGLE"]) == ("SPRING", "MEMBER")
    assert card["KX"] == pytest.approx(2e8 * 0.01 / 3.0) and card["FX"] == pytest.approx((3000.0, -3000.0))


def test_nodes_that_follow_others(tmp_path):
    text = (
        HEAD
        + BEAM
        + "node 3 4 3\nnode 4 8 3\nequalDOF 2 3 1\nequalDOF 3 4 1\nnode 5 4 4\nrigidLink beam 2 5\n"
    )
    m = model(tmp_path, text)
    assert [(n.id, dict(n.slaved)) for n in m.nodes.values() if n.slaved] == [
        (3, {"X": 2}),
        (4, {"X": 2}),
        (5, {"X": 2, "Y": 2, "R": 2}),
    ]


@pytest.mark.parametrize(
    ("text", "masters"),
    {
        # a hinge at a joint that follows its floor
        "node 3 4 3\nequalDOF 2 3 1\nnode 4 4 3\nequalDOF 3 4 1 2": {3: {"X": 2}, 4: {"X": 2, "Y": 3}},
        # the floor after the hinge, and a third node for the rotation
        "node 3 4 3\nnode 4 4 3\nequalDOF 3 4 2 1\nequalDOF 2 3 1\nequalDOF 2 4 3": {
            4: {"X": 2, "Y": 3, "R": 2},
            3: {"X": 2},
        },
        # a hinge at the end of an arm, which turns with the node where the arm begins
        "node 3 1 4\nrigidLink beam 2 3\nnode 4 1 4\nequalDOF 3 4 1 2": {
            3: {"X": 2, "Y": 2, "R": 2},
            4: {"X": 2, "Y": 2},
        },
        # two arms in a row
        "node 3 1 4\nnode 4 3 7\nrigidLink beam 2 3\nrigidLink beam 3 4": {
            3: {"X": 2, "Y": 2, "R": 2},
            4: {"X": 2, "Y": 2, "R": 2},
        },
        # a node beside the axis of one that does not turn
        "fix 2 0 0 1\nnode 3 4 4\nequalDOF 2 3 1": {3: {"X": 2}},
    }.items(),
)
def test_each_direction_follows_the_last_node_of_its_chain(tmp_path, text, masters):
    nodes = model(tmp_path, HEAD + BEAM + text + "\n").nodes.values()
    assert {n.id: dict(n.slaved) for n in nodes if n.slaved} == masters


def test_a_frame_with_hinges_at_joints_of_a_floor_moves_as_in_opensees(tmp_path):
    """OpenSees 3.7.1 with constraints Plain, which follows chains: -fullGenLapack, one static step."""
    assert "   2011 6 3.5 SLAVED=XY MASTER=11,12\n" in read(tmp_path, HINGED, units=KN).text
    with solved(tmp_path, HINGED) as file:
        periods = file["tables/modes"]["period"]
        static = file["tables/static_displacement"][:]
    expected = [0.9003737549006045, 0.2625549076818379, 0.013448892833351468]
    assert periods == pytest.approx(expected, rel=1e-11)
    (hinge,) = static[static["node"] == 2022]
    assert [hinge["x"], hinge["y"], hinge["r"]] == pytest.approx(
        [0.01596957274164487, -0.0002170656664311835, -0.0006488425938291889], rel=1e-11
    )


def test_each_node_has_the_freedoms_of_the_model_that_defines_it(tmp_path):
    text = HEAD + BEAM + "model basic -ndm 2 -ndf 2\nnode 3 4 3\nfix 3 0 1\n"
    assert [n.fixed for n in model(tmp_path, text).nodes.values()] == ["XYR", "", "YR"]


def test_nodes_of_a_truss_that_follow_others_have_no_arm(tmp_path):
    """OpenSees 3.7.1: a model without rotations, whose node 5 follows a lower one along x."""
    with solved(tmp_path, TRUSS) as file:
        periods = file["tables/modes"]["period"]
        static = file["tables/static_displacement"][:]
    assert periods == pytest.approx([0.073004016167525, 0.027453882557715914], rel=1e-11)
    (top,) = static[static["node"] == 5]
    assert [top["x"], top["y"]] == pytest.approx([6.749999999999999e-05, -9.481144772734373e-06], rel=1e-11)


def test_loads_follow_their_members_and_series(tmp_path):
    text = (
        HEAD
        + "node 3 4 6\n"
        + BEAM
        + BEAM.replace("1 1 2", "7 2 3", 1)
        + """
timeSeries Linear 1 -factor 2.0
pattern Plain 1 1 -fact 3.0 {
    load 2 1.0 2.0 3.0
    eleLoad -ele 7 -type -beamUniform -10.0 2.0
    eleLoad -ele 1 -type -beamPoint 5.0 0.25
}
integrator LoadControl 0.1
analysis Static
analyze 5
loadConst -time 0.0
analyze 5
"""
    )
    m = model(tmp_path, text)
    (load,) = m.loads
    assert (load["FX"], load["FY"], load["MZ"]) == pytest.approx((3.0, 6.0, 9.0))
    along, point = m.member_loads
    cos, sin = 0.8, 0.6  # of the member from (0, 3) to (4, 6)
    assert (along["WX"], along["WY"]) == pytest.approx((3 * (cos * 2 + sin * 10), 3 * (sin * 2 - cos * 10)))
    assert (point["PX"], point["AT"]) == pytest.approx((-15.0, 0.25)) and point["PY"] == pytest.approx(0.0)


def test_a_push_in_small_steps_has_its_turns_as_targets(tmp_path):
    text = (
        HEAD
        + BEAM
        + """
pattern Plain 1 Linear { load 2 2.0 0 0 }
analysis Static
foreach {step count} {0.001 10 -0.001 25 0.002 10} {
    integrator DisplacementControl 2 1 $step
    for {set k 0} {$k < $count} {incr k} { analyze 1 }
}
"""
    )
    push = model(tmp_path, text).analyses[-1]
    assert push["TARGET"] == pytest.approx((0.01, -0.015, 0.005), abs=1e-15)
    assert (push["NODES"], push["FORCES"]) == ((2,), (2.0,))


MOTIONS = {
    'pattern UniformExcitation 2 1 -accel "Series -dt 0.02 -filePath quake.txt -factor 9.81"': (
        "RECORD",
        {"FILE": "quake.txt", "UNIT": "DECK", "SCALE": 9.81, "DT": 0.02, "COLUMN": 0, "DIRECTION": "X"},
    ),
    "timeSeries Path 2 -time {0 1 2} -values {0 3 1}\npattern UniformExcitation 2 2 -accel 2 -fact 2": (
        "TABLE",
        {"POINTS": (0.0, 0.0, 1.0, 6.0, 2.0, 2.0), "DIRECTION": "Y"},
    ),
    "timeSeries Trig 2 1.0 5.0 0.5 -factor 3.0 -shift 0.2\npattern UniformExcitation 2 1 -accel 2": (
        "SINE",
        {"AMPLITUDE": 3.0, "PERIOD": 0.5, "PHASE": 0.2, "START": 1.0, "DURATION": 4.0},
    ),
}


@pytest.mark.parametrize("text", MOTIONS)
def test_each_motion(tmp_path, text):
    m = model(tmp_path, HEAD + BEAM + text + "\nanalysis Transient\nanalyze 100 0.01\n")
    (card,) = m.equake
    kind, items = MOTIONS[text]
    taken = {name: Path(card[name]).name if name == "FILE" else card[name] for name in items}
    assert card.spec.name == kind and taken == items
    assert m.analyses[-1]["T"] == pytest.approx(1.0)


def test_forces_in_time_and_velocities_at_the_start(tmp_path):
    text = (
        HEAD
        + BEAM
        + """
timeSeries Path 2 -dt 0.5 -values {0 1 0} -factor 2.0
pattern Plain 2 2 { load 2 5.0 0 0 }
timeSeries Trig 3 0.0 1.0 0.5 -factor 3.0
pattern Plain 3 3 { load 2 0 1.0 0 }
timeSeries Path 4 -dt 0.1 -filePath force.txt
pattern Plain 4 4 { load 2 0 0 1.0 }
setNodeVel 2 1 0.3 -commit
analysis Transient
analyze 100 0.01
"""
    )
    m = model(tmp_path, text)
    table, sine, record = m.forces
    assert (table["FX"], table["POINTS"]) == (5.0, (0.0, 0.0, 0.5, 2.0, 1.0, 0.0))
    assert (sine["FY"], sine["PERIOD"]) == (3.0, 0.5) and (record["MZ"], record["DT"]) == (1.0, 0.1)
    assert [(v["NODES"], v["VX"]) for v in m.initial] == [((2,), 0.3)]


def test_masses_are_weights_over_gravity(tmp_path):
    text = HEAD + BEAM + "mass 2 1.5 2.5 0.5\n"
    (weight,) = model(tmp_path, text).weights
    assert (weight["WX"], weight["WY"], weight["WR"]) == pytest.approx((14.715, 24.525, 4.905))
    plain = read(tmp_path, text).text  # no units: gravity is 1
    assert "UNITS F L T" in plain and "PARAM g=1\n" in plain


def test_tags_that_a_deck_does_not_take_are_counted_anew(tmp_path):
    text = HEAD.replace("node 2 ", "node -7 ").replace("mass 2", "mass -7") + BEAM.replace(
        "1 1 2", "1 1 -7"
    )
    assert list(model(tmp_path, text).nodes) == [1, 2]


def test_the_first_model_that_is_analysed_is_read(tmp_path):
    second = HEAD.replace("0 3", "0 5") + BEAM + "analysis Static\nanalyze 1\n"
    translation = read(tmp_path, HEAD + BEAM + "eigen 1\nwipe\n" + second)
    assert "2 0 3" in translation.text and [d.code for d in translation.report] == ["L609"]


# ---------------------------------------------------------------------- what is refused, and where

REFUSED = {
    "node 5": ("L620", "x is missing"),
    "node 5 a 0": ("L620", "x is 'a', not a number"),
    "node 5 1e400 0": ("L620", "not a number"),
    "fix 9 1 1 1": ("L623", "node 9"),
    "mass 9 1 1 1": ("L623", "node 9"),
    "mass 2 -1 1 1": ("L620", "negative mass"),
    "element elasticBeamColumn 8 1 2 0.1 2e7 1e-3 9": ("L623", "transformation 9"),
    "element elasticBeamColumn 8 1 1 0.1 2e7 1e-3 1": ("L620", "no length"),
    "element elasticBeamColumn 8 1 2 0.1 2e7 1e-3 1 -curved": ("L622", "-curved"),
    "element quad 8 1 2 1 2 1 PlaneStress 1": ("L622", "element quad"),
    "element zeroLength 8 1 2 -mat 5 -dir 1": ("L623", "material 5"),
    "uniaxialMaterial Pinching4 5 1\nelement zeroLength 8 1 2 -mat 5 -dir 1": ("L622", "Pinching4"),
    "uniaxialMaterial Steel01 5 1 1\nelement zeroLength 8 1 2 -mat 5 -dir 1": ("L620", "2 numbers"),
    "uniaxialMaterial Steel01 5 1 1 0 1 1 0 0\nelement zeroLength 8 1 2 -mat 5 -dir 1": (
        "L622",
        "isotropic",
    ),
    "uniaxialMaterial Elastic 5 1\nelement zeroLength 8 1 2 -mat 5 -dir 4": ("L622", "direction 4"),
    "section Bidirectional 5 1 1 1 1\nelement zeroLengthSection 8 1 2 5": ("L622", "Bidirectional"),
    "geomTransf PDelta 5 -jntOffset 0.3 0 0 0\nelement elasticBeamColumn 8 1 2 0.1 2e7 1e-3 5": (
        "L622",
        "axis",
    ),
    "node 5 4 4\nequalDOF 2 5 1": ("L622", "beside the axis"),
    "node 5 4 3\nnode 6 9 3\nequalDOF 2 6 1\nequalDOF 5 6 2 1": ("L622", "follows two nodes in X: 2 and 5"),
    "node 5 4 3\nequalDOF 2 5 1\nequalDOF 5 2 1": ("L620", "follows itself through others"),
    "node 5 4 3\nnode 6 4 4\nequalDOF 2 5 1\nrigidLink beam 5 6": ("L622", "2 6 (through node 5)"),
    "node 5 4 4\nnode 6 4 3\nequalDOF 2 6 1\nequalDOF 6 5 1": ("L622", "node 5 lies beside the axis"),
    "equalDOF 2 2 1": ("L620", "follows itself"),
    "model basic -ndm 3 -ndf 6": ("L622", "3 dimensions"),
    "rigidDiaphragm 2 1 2": ("L622", "rigidDiaphragm"),
    "nonsense 1": ("L622", "not a known command"),
    "load 2 1 0 0": ("L623", "in no pattern"),
    "pattern MultipleSupport 5 { }": ("L622", "MultipleSupport"),
    "pattern UniformExcitation 5 3 -accel 7": ("L622", "rotation of the ground"),
    "pattern UniformExcitation 5 1 -accel 7": ("L623", "series 7"),
    "pattern Plain 5 Linear { sp 2 1 0.1 }": ("L622", "sp in a pattern"),
    "rayleigh 0.1 0.1 0.1 0.0": ("L622", "at once"),
    "rayleigh -0.1 0 0 0": ("L620", "negative"),
    "uniaxialMaterial Elastic 5 1\nsection Fiber 5 { fiber 0 0 1 5 }\nelement zeroLengthSection 8 1 2 5": (
        "L622",
        "fibres without a length",
    ),
    "uniaxialMaterial Elastic 5 1\nsection Fiber 5 { fiber 0 0 1 5 }\nelement truss 8 1 2 5": (
        "L620",
        "or a section",
    ),
    "element elasticBeamColumn 8 1 2 0.1 2e7 1e-3 1 -release 4": ("L620", "-release is 4"),
    "uniaxialMaterial Elastic 5 1\nelement truss 8 1 2 0.1 5 -rho 1 -cMass 1": ("L622", "consistent mass"),
    "fix 2 1 1": ("L620", "2 restraints, not 3"),
    "node 2 0 4": ("L620", "defined twice"),
    "geomTransf PDelta 1": ("L620", "defined twice"),
    "pattern Plain 5 Linear { load 2 1.0 }": ("L620", "1 values, not 3"),
    "pattern Plain 5 Linear { }\npattern Plain 5 Linear { }": ("L620", "defined twice"),
    "setNodeDisp 2 1 0.1": ("L622", "sets a state"),
    "uniaxialMaterial Elastic 5 1\nelement zeroLength 8 1 2 -mat 5 -dir 1\n"
    "pattern Plain 5 Linear {\neleLoad -ele 8 -type -beamUniform 1\n}": ("L622", "no beam"),
    "remove element 1": ("L622", "changes between analyses"),
}


@pytest.mark.parametrize("text", REFUSED)
def test_each_mistake_has_its_place(tmp_path, text):
    translation = read(tmp_path, HEAD + BEAM + text + "\n")
    code, message = REFUSED[text]
    told = errors(translation)
    assert any(c == code and message in m for c, _, m in told), told
    assert all(line > 6 or "negative mass" in m for _, line, m in told) and not translation.text


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("element elasticbeamcolumn 1 1 2 0.1 2e7 1e-3 1\n", "did you mean elasticBeamColumn?"),
        (
            "uniaxialMaterial Steel1 5 10 100 0.1\nelement zeroLength 8 1 2 -mat 5 -dir 1",
            "did you mean Steel01?",
        ),
        (f"uniaxialMaterial Pinching4 5 1\n{LINK}", "use one of BoucWen"),
    ],
)
def test_a_misspelt_type_has_the_right_one_in_the_hint(tmp_path, text, hint):
    (told,) = (d for d in read(tmp_path, HEAD + text).report if "no counterpart here" in d.message)
    assert told.hint.startswith(hint)


def test_all_mistakes_are_told_in_one_pass(tmp_path):
    text = HEAD + BEAM + "node 5\nnonsense\nelement quad 9\nrayleigh 1\n"
    assert [(c, line) for c, line, _ in errors(read(tmp_path, text))] == [
        ("L620", 8),
        ("L622", 9),
        ("L622", 10),
        ("L620", 11),
    ]


def test_a_script_without_elements(tmp_path):
    assert [(c, line) for c, line, _ in errors(read(tmp_path, "set a 1\n"))] == [("L624", 1)]


def test_all_messages_of_models_of_opensees_are_in_use():
    told = {refusal[0] for refusal in REFUSED.values()} | {
        "L621",
        "L624",
        "L625",
        "L626",
    }  # above and below
    assert {code for code in MESSAGES if code.startswith("L62")} == told | {"L621", "L624", "L625", "L626"}


# ---------------------------------------------------------------------- Python


def test_a_model_in_python_is_executed_only_on_request(tmp_path):
    assert [(c, line) for c, line, _ in errors(read(tmp_path, IN_PYTHON, "model.py"))] == [("L625", 1)]
    translation = read(tmp_path, IN_PYTHON, "model.py", execute=True)
    assert not translation.report
    new, _, _ = read_text(translation.text, catalog())
    assert new and len(new.elements) == 2
    assert "RAYLEIGH ALPHA=0.43682" in translation.text and "MODAL 2" in translation.text


def test_a_mistake_in_python_has_its_line(tmp_path):
    told = errors(
        read(
            tmp_path,
            "import openseespy.opensees as ops\nops.node(1, 0.0, 0.0)\n1/0\n",
            "m.py",
            execute=True,
        )
    )
    assert ("L621", 3, "the model stops: ZeroDivisionError: division by zero") in told


# ---------------------------------------------------------------------- the verb


@pytest.mark.parametrize("name", ["model.tcl", "model.py", "model.s2k", "model.$2k"])
def test_a_model_of_another_program_is_not_run_as_a_deck(tmp_path, capsys, name):
    (tmp_path / name).write_text(FRAME)
    for words in ([], ["check"]):
        assert main([*words, str(tmp_path / name)]) == 2
        told = capsys.readouterr().err
        assert told.count("error") == 1 and f"pound-solve import {name} -o model.inp" in told


def test_the_verb_writes_a_deck_beside_which_the_record_is_found(tmp_path, capsys):
    (tmp_path / "quake.txt").write_text("\n".join("0.1" for _ in range(20)))
    (tmp_path / "decks").mkdir()
    text = HEAD + BEAM + next(iter(MOTIONS)) + "\nanalysis Transient\nanalyze 100 0.01\n"
    (tmp_path / "model.tcl").write_text(text)
    new = tmp_path / "decks" / "new.inp"
    assert main(["import", str(tmp_path / "model.tcl"), "-o", str(new), "--units", "kN,m,s"]) == 0
    assert '"../quake.txt"' in new.read_text()
    assert main([str(new), "--quiet"]) == 0
    with pytest.raises(SystemExit, match="2"):
        main(["import", str(tmp_path / "model.tcl"), "--units", "kN,m"])
    assert "three names" in capsys.readouterr().err


def test_the_page_shows_one_model_in_both_languages(tmp_path):
    page = (ROOT / "manual" / "coming-from-opensees.md").read_text("utf-8")
    script, deck = (block.partition("\n")[2] for block in page.split("## 6.")[1].split("```")[1::2])
    ours, _, _ = read_text(deck, catalog())
    theirs = model(tmp_path, script)
    assert ours and [(n.x, n.y, n.fixed) for n in ours.nodes.values()] == [
        (n.x, n.y, n.fixed) for n in theirs.nodes.values()
    ]
    members = [[p[item] for item in ("E", "A", "I")] for m in (ours, theirs) for p in m.props.values()]
    assert members[0] == members[1] and ours.geometry == theirs.geometry
    assert ours.weights[0]["WX"] == pytest.approx(theirs.weights[0]["WX"])
    (first,), (second,) = ours.damping, theirs.damping
    assert dict(first.values) == dict(second.values)
    assert [a["T"] for a in (*ours.analyses, *theirs.analyses)] == [20.0, 20.0]
