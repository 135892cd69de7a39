"""Models of SAP2000: published results, what comes of each table, and where the mistakes stand."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from imports.sap2000_models import EVERYTHING, PORTAL, SEVEN_STOREYS, bathe_and_wilson, replaced
from pound_deck.diagnostics import has_errors
from pound_deck.messages import MESSAGES
from pound_deck.reader import read_text
from pound_import.sap2000.importer import translate
from pound_import.sap2000.recognise import is_sap2000
from pound_solve import run
from pound_solve.catalog import catalog
from pound_solve.cli.main import main

CATALOG = catalog()


def read(text, **choice):
    return translate("frame.s2k", text, CATALOG, **choice)


def model(text, **choice):
    """The model of the new deck, which its reader takes without a mistake."""
    new = read(text, **choice)
    assert not has_errors(new.report), new.report
    deck, told, _ = read_text(new.text, CATALOG)
    assert deck is not None and not has_errors(told), told
    return deck


def codes(new):
    return [d.code for d in new.report if d.code != "L652"]


# ---------------------------------------------------------------------- published results


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    def solve(text):
        deck = tmp_path_factory.mktemp("sap") / "model.inp"
        deck.write_text(read(text).text)
        results = run(str(deck))
        displacements = {row["node"]: row for row in results.table("static_displacement")}
        forces = {(row["element"], row["quantity"]): row["value"] for row in results.table("static_force")}
        return displacements, forces

    return solve


def test_a_frame_on_a_hinge_and_a_roller_sags_as_published(solved):
    """CSI, Software Verification, example 1-018, model A: joint 5, UZ [in]."""
    displacements, _ = solved(PORTAL)
    assert f"{displacements[5]['y']:.5f}" == "-2.77076"


def test_seven_storeys_with_diaphragms_sway_as_published(solved):
    """CSI, Software Verification, example 1-022: joint 22 U1 [in], frame 1 P [kip] and M3 [kip in]."""
    displacements, forces = solved(SEVEN_STOREYS)
    assert f"{displacements[22]['x']:.5f}" == "1.45076"
    assert f"{forces[1, 'axial I']:.2f}" == "69.99"
    assert f"{forces[1, 'moment I']:.2f}" == "2324.68"


def test_ten_bays_and_nine_storeys_swing_as_published(tmp_path):
    """CSI, Software Verification, example 1-021, after Bathe and Wilson 1972: eigenvalues [1/s^2]."""
    deck = tmp_path / "model.inp"
    deck.write_text(read(bathe_and_wilson()).text)
    eigenvalues = [row["omega"] ** 2 for row in run(str(deck)).table("modes")]
    assert [f"{x:.6g}" for x in eigenvalues] == ["0.589541", "5.52696", "16.5879"]


# ---------------------------------------------------------------------- recognised


def test_models_are_recognised():
    assert is_sap2000(PORTAL) and is_sap2000(SEVEN_STOREYS)
    assert not is_sap2000("TITLE x\nEQUAKE\n TABLE POINTS=0,0,1,1\n") and not is_sap2000("")
    assert codes(read("NODES\n 1 0 0\n")) == ["L640"]


# ---------------------------------------------------------------------- each table


@pytest.fixture(scope="module")
def everything():
    return model(EVERYTHING)


def test_units_and_nodes(everything):
    m = everything
    assert (m.units.force, m.units.length, m.gravity) == ("kN", "m", 9.80665)
    assert [(n.id, n.x, n.y, n.fixed, dict(n.slaved)) for n in m.nodes.values()] == [
        (1, 0.0, 0.0, "XYR", {}),
        (2, 0.0, 3.0, "", {}),
        (3, 6.0, 3.0, "", {"X": 2}),
        (4, 6.0, 0.0, "XY", {}),
        (5, 6.05, 0.0, "XYR", {}),
        (6, 6.05, 3.0, "", {}),
        (7, 6.05, 6.0, "", {}),
        (8, 10.0, 3.0, "", {}),
        (9, 3.0, 3.0, "YR", {"X": 2}),  # the master joint, which no frame holds
        (10, 10.0, 2.8, "", {"X": 8, "Y": 8, "R": 8}),
        (11, 12.0, 0.0, "XYR", {}),
    ]


def test_frames(everything):
    m = everything
    frames = [e for e in m.elements.values() if m.props[e.prop].spec.name == "FRAME"]
    assert [(e.id, e.i, e.j, e.name) for e in frames] == [
        (1, 1, 2, ""),
        (2, 4, 3, ""),
        (3, 2, 3, ""),
        (4, 5, 6, "C1"),
        (5, 6, 7, "C2"),
        (6, 6, 8, "G"),
    ]
    column, beam, light, turned, partial = (m.props[frames[k].prop] for k in (0, 2, 3, 4, 5))
    assert [column[x] for x in ("E", "A", "I", "G", "AS")] == [3e7, 0.16, 0.002133, 1.25e7, 0.1333]
    assert column["WGT"] == pytest.approx(2.5 * 0.16 * 9.80665)
    assert (beam["I"], beam["END1"], beam["END2"], beam["PIN"]) == (0.0015625, 0.1, 0.2, "I")
    assert (light["E"], light["G"]) == (2e7, 8e6)  # of the Poisson's ratio
    assert light["I"] == pytest.approx(0.7 * 0.002133)
    assert light["WGT"] == pytest.approx(2 * 0.16 * 9.80665)  # without UnitMass: weight over gravity
    assert (turned["I"], turned["AS"]) == (0.001125, 0.125)  # I22 by the angle of 90
    assert (partial["PIN"], partial["FJ"]) == ("NONE", (0.00025, 0.0))


def test_links(everything):
    m = everything
    links = {e.name: (m.props[e.prop], e.i, e.j) for e in m.elements.values() if e.id > 6}
    items = {
        "GAP": ("CONTACT", 3, 6, {"GAP": 0.05, "ANGLE": 0.0, "LAW": "LINEAR", "K": 90000.0}),
        "DAMP U1 damping": ("DASHPOT", 2, 6, {"CX": 30.0, "ALPHA": 0.5}),
        "WEN U1": ("SPRING", 11, None, {"KX": 5000.0, "ANGLE": 90.0, "R": 0.05, "N": 4.0}),
        "LIN U1": ("SPRING", 8, 11, {"KX": 800.0, "ANGLE": pytest.approx(-56.309932474)}),
        "LIN U1 damping": ("DASHPOT", 8, 11, {"CX": 20.0}),
        "LIN U2": ("SPRING", 8, 11, {"KX": 60.0, "ANGLE": pytest.approx(33.690067526), "ARM": 1.0}),
        "LIN R3": ("SPRING", 8, 11, {"KR": 7.0}),
        "RUB U2": ("SPRING", 7, None, {"KX": 2000.0, "ANGLE": 0.0, "R": 0.1, "N": 2.0}),
        "RUB U1": ("SPRING", 7, None, {"KX": 100000.0, "ANGLE": 90.0}),
        "MLE U1": ("SPRING", 3, 6, {"KX": 1000.0, "FX": (10.0, -10.0), "R": 0.1}),
        "MLP U1": ("SPRING", 3, 6, {"KX": 1000.0, "R": 0.2, "R2": 0.1, "F2": (1.4, 1.4)}),
        "spring of joint S": ("SPRING", 10, None, {"KY": 50000.0}),
    }
    assert links.keys() == items.keys()
    for name, (kind, i, j, values) in items.items():
        card, *ends = links[name]
        assert (card.spec.name, *ends) == (kind, i, j), name
        assert {key: card[key] for key in values} == values, name
    assert links["MLE U1"][0]["RULE"] == ("BILINEAR_ELASTIC",)


def test_loads_of_a_case(everything):
    """DEAD, with the weight of frames, and half of LIVE."""
    m = everything
    assert [(x["NODES"], x["FX"], x["FY"], x["MZ"]) for x in m.loads] == [
        ((2,), 1.5, -20.0, -2.5),
        ((2,), 0.0, -1.0, -0.05),  # the point load on the rigid end
    ]
    uniform = {(x["ELEMENTS"], x["WX"], x["WY"]) for x in m.member_loads if x["WX"] or x["WY"]}
    assert uniform == {
        ((3,), 0.0, -20.0),
        ((3,), 0.1875, 0.0),  # GRAVITY loads act along any axis
        ((1, 2), 0.0, -4.0),
        ((3, 5, 6), 0.0, -3.75),
        ((4,), 0.0, -0.784532),
    }
    points = [(x["ELEMENTS"], x["PY"], x["AT"]) for x in m.member_loads if x["PY"]]
    assert points[-1] == ((3,), -12.0, pytest.approx((3 - 0.1) / 5.7))
    assert sum(p for _, p, _ in points[:3]) == pytest.approx(-3.0)
    assert sum(p * at * 3.95 for _, p, at in points[:3]) == pytest.approx(-3.0 * (1 + 2 / 3))


def test_mass(everything):
    """Added mass, half of DEAD, 0.3 of LIVE, half of the mass of a link."""
    weights = {w["NODES"]: (w["WX"], w["WY"], w["WR"]) for w in everything.weights}
    self_weight, floor = 25 * 0.16 * 3 / 2, (20 + 25 * 0.15) * 6 / 2
    dead = 0.5 * (self_weight + floor)
    live = 0.3 * (40 + 12 + 2 * (1 - 0.05 / 6))
    assert weights[2,] == pytest.approx(
        (4 * 9.80665 + dead + live, 2 * 9.80665 + dead + live, 0.5 * 9.80665), rel=1e-9
    )
    assert weights[9,] == pytest.approx((8 * 9.80665, 0.0, 0.0))
    assert not {(1,), (4,), (5,), (11,)} & weights.keys()  # supports


def test_analyses(everything):
    m = everything
    assert m.geometry == "PDELTA"
    assert [(a.spec.name) for a in m.analyses] == ["STATIC", "MODAL", "HISTORY"]
    static, modal, history = m.analyses
    assert (static["SELF_WEIGHT"], modal["MODES"], history["T"], m.output["EVERY"]) == ("NO", 4, 2.0, 0.01)
    (damping,) = m.damping
    assert (damping["ALPHA"], damping["BETA"]) == (0.2, 0.001)
    across, up = m.equake
    assert across["POINTS"] == (0.1, 0.0, 0.5, 0.3, 1.1, -0.2, 1.9, 0.0)
    assert (across["SCALE"], across["DIRECTION"], up["SCALE"], up["DIRECTION"]) == (9.81, "X", 3.0, "Y")


def test_a_function_from_a_file_leaves_the_history_to_be_completed():
    text = EVERYTHING.replace("Function=MOTION   TransAccSF=9.81", "Function=RECORD   TransAccSF=9.81")
    text = replaced(text, "FUNCTION - TIME HISTORY - FROM FILE", "Name=RECORD   FileName=quake.txt")
    new = read(text)
    assert any("function RECORD, whose values are not in the file" in d.message for d in new.report)
    m = model(text)
    assert len(m.equake) == 1 and [a.spec.name for a in m.analyses][-1] == "HISTORY"


def test_the_page_has_the_same_frame_in_both_languages():
    page = (Path(__file__).parents[2] / "manual/coming-from-sap2000.md").read_text("utf-8")
    theirs, ours = re.findall(r"^```\n((?:TABLE|UNITS).*?)^```", page, re.M | re.S)
    deck, mistakes, _ = read_text(ours, CATALOG)
    assert deck is not None and not has_errors(mistakes)
    same = model(theirs)
    plain = [
        [(n.id, n.x, n.y, n.fixed) for n in m.nodes.values()]
        + [(e.id, e.prop, e.i, e.j) for e in m.elements.values()]
        + [dict(card.values) for card in (*m.props.values(), *m.member_loads)]
        for m in (same, deck)
    ]
    assert plain[0] == plain[1]


def test_it_runs(tmp_path):
    deck = tmp_path / "model.inp"
    deck.write_text(read(EVERYTHING).text.replace("HISTORY 2", "HISTORY 0.05"))
    assert run(str(deck)).status == "done"


@pytest.mark.parametrize(
    ("load", "axial"),
    [("GRAVITY", -20.0), ("uls", -30.0), ("TWICE", -60.0), ("live", -40.0), ("DEAD", None)],
)
def test_loads_are_chosen_by_case_combination_or_pattern(load, axial):
    loads = model(EVERYTHING, load=load).loads
    assert [x["FY"] for x in loads][:1] == ([axial] if axial else [])


def test_patterns_are_summed():
    both = model(EVERYTHING, load="LIVE, dead").member_loads
    assert {x["WY"] for x in both} >= {-20.0, -4.0} and any(x["PY"] == -24.0 for x in both)


# ---------------------------------------------------------------------- the plane

SPACE = [  # two frames of one bay, three apart
    *(f"Joint={k}{at}   XorR={x}   Y={y}   Z={z}" for at, y in (("F", 0), ("B", 3.5)) for k, x, z in (
        (1, 0, 0), (2, 0, 3), (3, 5, 3), (4, 5, 0)
    )),
]  # fmt: skip
BARS = [
    *(f"Frame={k}{at}   JointI={i}{at}   JointJ={j}{at}" for at in "FB" for k, i, j in (
        (1, 1, 2), (2, 2, 3), (3, 4, 3)
    )),
    "Frame=T1   JointI=2F   JointJ=2B",
]  # fmt: skip


def in_space(active="UX=Yes   UY=Yes   UZ=Yes   RX=Yes   RY=Yes   RZ=Yes"):
    names = [bar.split("   ")[0] for bar in BARS]
    text = replaced(PORTAL, "JOINT COORDINATES", *SPACE)
    text = replaced(text, "CONNECTIVITY - FRAME", *BARS)
    text = replaced(text, "FRAME SECTION ASSIGNMENTS", *(f"{name}   AnalSect=W8X31" for name in names))
    text = replaced(text, "JOINT RESTRAINT ASSIGNMENTS", "Joint=1F   U1=Yes   U2=Yes   U3=Yes   R3=Yes")
    text = replaced(text, "FRAME LOADS - DISTRIBUTED", "Frame=2F   LoadPat=FLOOR   FOverLA=1")
    return replaced(text, "ACTIVE DEGREES OF FREEDOM", active)


def test_a_model_in_space_is_refused_with_its_planes():
    (told,) = read(in_space()).report
    assert told.code == "L647"
    assert told.hint.endswith(": XZ@Y=0 (3), XZ@Y=3.5 (3), YZ@X=0 (3), YZ@X=5 (2)")
    (told,) = read(in_space("UX=Yes   UY=No   UZ=Yes   RX=No   RY=Yes   RZ=No")).report
    assert told.hint.endswith(": XZ@Y=0 (3), XZ@Y=3.5 (3)")


@pytest.mark.parametrize(
    ("plane", "ends"),
    [
        ("XZ@Y=3.5", {(0.0, 0.0), (0.0, 3.0), (5.0, 3.0), (5.0, 0.0)}),
        ("y=0", {(0.0, 0.0), (0.0, 3.0), (5.0, 3.0), (5.0, 0.0)}),
        ("X=0", {(0.0, 0.0), (0.0, 3.0), (3.5, 0.0), (3.5, 3.0)}),
        ("XY@Z=3", {(0.0, 0.0), (5.0, 0.0), (0.0, 3.5), (5.0, 3.5)}),
    ],
)
def test_a_plane_is_chosen(plane, ends):
    assert {(n.x, n.y) for n in model(in_space(), plane=plane).nodes.values()} == ends


@pytest.mark.parametrize("plane", ["XZ@Y=1", "XY@Y=3", "Q", "XZ@", "Y=", "Y=1e400"])
def test_a_plane_without_members_is_refused(plane):
    (told,) = [d for d in read(in_space(), plane=plane).report if d.severity == "error"]
    assert told.code == ("L647" if plane == "XZ@" else "L648")


@pytest.mark.parametrize(
    ("plane", "turn", "second"), [("XZ", -1, "I33"), ("YZ", 1, "I22"), ("XY", 1, "I22")]
)
def test_axes_of_each_plane(plane, turn, second):
    """The same cantilever in three planes; a moment about the normal is anticlockwise or not."""
    a, b = plane
    text = replaced(PORTAL, "JOINT COORDINATES", "Joint=1   X=0   Y=0   Z=0", f"Joint=2   {_place(b)}")
    text = replaced(text, "CONNECTIVITY - FRAME", "Frame=1   JointI=1   JointJ=2")
    text = replaced(text, "FRAME SECTION ASSIGNMENTS", "Frame=1   AnalSect=W8X31")
    text = replaced(text, "JOINT RESTRAINT ASSIGNMENTS", "Joint=1   U1=Yes")
    text = replaced(text, "FRAME LOADS - DISTRIBUTED")
    moments = "   ".join(f"M{k}={k}" for k in (1, 2, 3))
    text = replaced(
        text, "JOINT LOADS - FORCE", f"Joint=2   LoadPat=FLOOR   F1=10   F2=20   F3=30   {moments}"
    )
    text = replaced(
        text, "ACTIVE DEGREES OF FREEDOM", "UX=Yes   UY=Yes   UZ=Yes   RX=Yes   RY=Yes   RZ=Yes"
    )
    m = model(text, plane=plane)
    axes = ["XYZ".index(c) for c in (a, b)]
    normal = 3 - sum(axes)
    (load,) = m.loads
    assert (load["FX"], load["FY"]) == tuple(10.0 * (k + 1) for k in axes)
    assert load["MZ"] == turn * (normal + 1)
    assert m.nodes[1].fixed == ("X" if axes[0] == 0 else "")
    assert m.props["P1"]["I"] == {"I33": 110.0, "I22": 37.1}[second]


def _place(axis):
    return "   ".join(f"{c}={2 * (c == axis)}" for c in "XYZ")


# ---------------------------------------------------------------------- what is refused

WRONG = [
    # of the text and its values
    ("Joint=2    CoordSys=GLOBAL", "Joint=2    CoordSys GLOBAL", "L641", "CoordSys"),
    ("Link=G1   LinkType=Gap   Mass=0", 'Link=G1   LinkType="Gap   Mass=0', "L641", 'LinkType="Gap'),
    ("Frame=1   JointI=1   JointJ=2", "Frame=1   JointI=1   JointI=2", "L641", "JointI=2"),
    ("Frame=1   JointI=1   JointJ=2", "Frame=1   JointI=1", "L642", "Frame=1"),
    ("E1=30000000", "E1=30000000,5", "L643", "E1="),
    ("E1=30000000", "E1=3e31", "L643", "E1="),
    ("Joint=B1   U1=Yes", "Joint=B1   U1=y", "L643", "U1=y"),
    ("MaxNumModes=4", "MaxNumModes=4.5", "L643", "MaxNumModes"),
    ("OutSteps=200", "OutSteps=0", "L643", "Case=QUAKE"),
    ("DOF=U1   Fixed=No   TransKE=800", "DOF=X   Fixed=No   TransKE=800", "L643", "DOF=X"),
    ("TransKE=800", "TransKE=-800", "L643", "TransKE"),
    ("TransK=90000", "TransK=0", "L643", "TransK=0"),
    ("CExp=0.5", "CExp=0", "L643", "CExp"),
    ("YieldExp=4", "YieldExp=0.5", "L643", "YieldExp"),
    ("Force=10   Displ=0.01\n   Link=E1", "Force=10   Displ=0.04\n   Link=E1", "L643", "Link=E1"),
    ("Dir=Gravity   DistType=RelDist   RelDistA", "Dir=up   DistType=RelDist   RelDistA", "L643", "Dir=up"),
    ("LoadPat=LIVE   CoordSys=Local    Type", "LoadPat=LIVE   CoordSys=SKEW    Type", "L651", "CoordSys"),
    ("RelDistA=0   RelDistB=1", "RelDistA=0   RelDistB=1.5", "L643", "RelDistB"),
    ("RelDistA=0   RelDistB=1", "RelDistA=0.5   RelDistB=0.1", "L643", "Frame=3"),
    ("Time=0.5", "Time=0.1", "L643", "Time"),
    ("Name=FLOOR   CoordSys=GLOBAL   Axis=Z", "Name=FLOOR   CoordSys=GLOBAL   Axis=Q", "L643", "Axis"),
    ("ComboName=ULS   ComboType=\"Linear Add\"   CaseName=GRAVITY   ScaleFactor=1.5",
     "ComboName=ULS   ComboType=\"Linear Add\"   CaseName=ULS   ScaleFactor=1.5", "L651", "ComboName=ULS"),
    # of names
    ("Joint=2    CoordSys", "Joint=1    CoordSys", "L645", "Joint=1"),
    ("Frame=2   JointI=4", "Frame=1   JointI=4", "L645", "Frame=1"),
    ("Link=DAMP  JointI=2", "Link=GAP  JointI=2", "L645", "Link=GAP"),
    ("Material=LIGHT   UnitWeight", "Material=C30   UnitWeight", "L645", "Material"),
    ("SectionName=BEAM   Material=C30", 'SectionName="COLUMN 40/40"   Material=C30', "L645", "SectionName"),
    ("Frame=2   JointI=4", "Frame=2   JointI=44", "L646", "JointI=44"),
    ("Frame=2   AnalSect=", "Frame=22   AnalSect=", "L646", "Frame=22"),
    ("Frame=3   AnalSect=BEAM", "Frame=3   AnalSect=LIST", "L646", "AnalSect"),
    ("Frame=3   AnalSect=BEAM   MatProp=Default\n", "", "L646", "Frame=3"),
    ("MatProp=LIGHT", "MatProp=HEAVY", "L646", "Frame=C1"),
    ("SectionName=BEAM   Material=C30", "SectionName=BEAM   Material=C31", "L646", "Material"),
    ("Joint=B4   Constraint=BLOCK", "Joint=B4   Constraint=BRICK", "L646", "Constraint"),
    ("Link=GAP    LinkType=Gap", "Link=GAPS    LinkType=Gap", "L646", "Link=GAPS"),
    ("LinkProp=D1", "LinkProp=D2", "L646", "Link=DAMP"),
    ("Function=MOTION   TransAccSF=3", "Function=OTHER   TransAccSF=3", "L646", "Function"),
    # of units and parts
    ('CurrUnits="KN, m, C"', 'CurrUnits="KN, yd, C"', "L650", "CurrUnits"),
    ('CurrUnits="KN, m, C"', "", "L650", "ProgramName"),
    ("JointJ=B3  IsCurved=No", "JointJ=B3  IsCurved=Yes", "L651", "IsCurved"),
    ("Frame=1   JointI=1   JointJ=2", "Frame=1   JointI=1   JointJ=1", "L651", "Frame=1"),
    ("Joint=B4   CoordSys=LOCAL   CoordType=Cartesian   XorR=1   Y=1   Z=1   GlobalX=10",
     "Joint=B4   CoordSys=LOCAL   CoordType=Cartesian   XorR=1   Y=1   Z=1", "L651", "CoordSys"),
    ("CoordType=Cylindrical", "CoordType=Spherical", "L651", "CoordType"),
    ("Frame=C2   Angle=90", "Frame=C2   Angle=30", "L651", "Frame=C2"),
    ("Angle=90   AdvanceAxes=No", "Angle=90   AdvanceAxes=Yes", "L651", "AdvanceAxes"),
    ("LengthI=0.2   LengthJ=0.4   RigidFactor=0.5", "LengthI=20   LengthJ=0.4   RigidFactor=0.5",
     "L651", "Frame=3"),
    ('LoadType="Load pattern"   LoadName=LIVE', "LoadType=Accel   LoadName=UZ", "L651", "Case=GRAVITY"),
    ("Case=QUAKE   OutSteps=200   StepSize=0.01\n", "", "L644", "Case=QUAKE"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "code", "underlined"), WRONG)
def test_mistakes_are_reported_at_their_places(old, new, code, underlined):
    assert EVERYTHING.count(old) >= 1
    text = EVERYTHING.replace(old, new, 1)
    load = "ULS" if "ULS" in new else ""
    told = [d for d in read(text, load=load).report if d.severity == "error" and d.code == code]
    lines = text.splitlines()
    places = [lines[d.span.line - 1][d.span.column - 1 :] for d in told]
    assert any(place.startswith(underlined) for place in places)
    assert all(d.hint for d in told)


def test_tables_that_must_be_there():
    for name in ("JOINT COORDINATES", "CONNECTIVITY - FRAME"):
        assert "L644" in codes(read(replaced(PORTAL, name)))


def test_an_unknown_load_is_refused_with_those_that_exist():
    (told,) = [d for d in read(EVERYTHING, load="SNOW").report if d.severity == "error"]
    assert told.code == "L649" and told.hint == "there are GRAVITY, ULS, TWICE, DEAD, LIVE"


def test_all_mistakes_are_reported_in_one_pass():
    text = EVERYTHING
    for old, new in (
        ("JointI=4", "JointI=44"),
        ("E1=20000000", "E1=x"),
        ("DOF=U1", "DOF=U9"),
        ("U1=Yes", "U1=7"),
    ):
        text = text.replace(old, new, 1)
    assert set(codes(read(text))) >= {"L643", "L646"}
    assert len([d for d in read(text).report if d.severity == "error"]) >= 4


def test_all_messages_of_such_models_are_in_use():
    provoked = {code for _, _, code, _ in WRONG} | {"L640", "L644", "L647", "L648", "L649", "L652"}
    assert {c for c in MESSAGES if c.startswith(("L64", "L65"))} == provoked


# ---------------------------------------------------------------------- what is lost or by convention

LOST = [
    ('CardinalPt="10 (centroid)"', 'CardinalPt="8 (top center)"', "L609", "insertion point of frame 1"),
    ("TensLimit=No   CompLimit=No", "TensLimit=No   CompLimit=Yes", "L609", "limits of tension"),
    ("Type=Automatic   RigidFactor=0\n", "Type=Automatic   RigidFactor=1\n", "L609", "automatic"),
    ("Frame=3   PI=No", "Frame=3   PI=Yes", "L609", "released force PI of frame 3"),
    ("I23=0", "I23=0.1", "L609", "I23 of section BEAM"),
    ("Type=Force   Dir=2", "Type=Moment   Dir=2", "L609", "moments along frame G"),
    ("F1=3   F2=0", "F1=3   F2=7", "L609", "1 loads act out of the plane"),
    ("Joint=M    Constraint=FLOOR", "Joint=B3    Constraint=FLOOR", "L609", "at several levels"),
    ("Joint=S    Constraint=BLOCK", "Joint=3    Constraint=BLOCK", "L609", "belongs to another constraint"),
    ("CONSTRAINT DEFINITIONS - BODY", "CONSTRAINT DEFINITIONS - WELD", "L609", "a weld constraint"),
    ("Link=W1   DOF=U1   Fixed=No", "Link=W1   DOF=U1   Fixed=Yes", "L609", "which is fixed"),
    ("HysType=Kinematic", "HysType=Takeda", "L609", "hysteresis of the type Takeda"),
    ("Force=12   Displ=0.03", "Force=15   Displ=0.03", "L609", "a curve that no rule has"),
    ("05 - GAP", "06 - HOOK", "L609", "link GAP of the kind Gap"),
    ("Link=G1   DOF=U1", "Link=G1   DOF=R3", "L609", "a gap of a rotation"),
    ("   TransOpen=0.05", "", "L605", "is closed: no TransOpen"),
    ("LoadName=U3", "LoadName=U2", "L609", "U2: acceleration out of the plane"),
    ("LoadType=Accel   LoadName=U3", 'LoadType="Load pattern"   LoadName=LIVE', "L609", "no acceleration"),
    ("CoordSys=GLOBAL   Angle=0", "CoordSys=GLOBAL   Angle=10", "L609", "an acceleration at an angle"),
    ("InitialCond=Zero   RunCase=No", "InitialCond=Zero   RunCase=Yes", "L609", "a further history"),
    ("Joint=M   CoordSys=GLOBAL   Mass1=8", "Joint=Y   CoordSys=GLOBAL   Mass1=8", "L609", "outside of"),
    ("Mass1=4", "Mass1=-40", "L609", "the mass of joint 2"),
    ("MATERIAL PROPERTIES 01 - GENERAL", "AREA LOADS - UNIFORM", "L609", "the table AREA LOADS - UNIFORM"),
    ("MATERIAL PROPERTIES 01 - GENERAL", "FRAME HINGE ASSIGNS 02", "L609", "FRAME HINGE ASSIGNS 02"),
    ("DIRECT HISTORY 3 - PROPORTIONAL", "DIRECT HISTORY 3 - INTERPOLATED", "L609", "INTERPOLATED"),
    ("InitialCond=GRAVITY", "InitialCond=Zero", "L605", "the history starts from the static state"),
    ("GeoNonLin=None", 'GeoNonLin="Large Displ"', "L605", "GEOMETRY PDELTA"),
    ("JointI=3   JointJ=B2\n   Link=DAMP", "JointI=3\n   Link=DAMP", "L605", "closes towards its ground"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "code", "told"), LOST)
def test_what_is_lost_is_named_and_marked(old, new, code, told):
    assert old in EVERYTHING
    read_now = read(EVERYTHING.replace(old, new, 1))
    assert any(d.code == code and told in d.message for d in read_now.report)
    assert told in read_now.text
    deck, mistakes, _ = read_text(read_now.text, CATALOG)
    assert deck is not None, mistakes


def test_directions_along_turned_axes_of_joints_are_lost():
    text = EVERYTHING.replace("Joint=S   AngleA=0", "Joint=4   AngleA=30")
    assert "local axes" not in read(text).text  # all displacements are held, in any axes
    text = text.replace("Joint=4    U1=Yes", "Joint=4    U1=No")
    assert "the restraints of joint 4 follow local axes" in read(text).text
    text = EVERYTHING.replace("Joint=S   AngleA=0", "Joint=2   AngleA=30")
    text = text.replace("LoadPat=LIVE   CoordSys=GLOBAL   F1", "LoadPat=LIVE   CoordSys=Local   F1")
    springs = EVERYTHING.replace("Joint=S   AngleA=0", "Joint=S   AngleA=30")
    assert "springs along local axes of joint S" in read(springs).text
    assert "loads along axes of joint 2 other than the global ones" in read(text).text


def test_without_a_choice_none_of_several_patterns_is_taken():
    text = EVERYTHING.replace("Case=GRAVITY   Type=NonStatic", "Case=GRAVITY   Type=LinBuckling")
    new = read(text)
    assert any("none of DEAD, LIVE is chosen" in d.message for d in new.report)
    assert not model(text).loads


def test_a_mistake_of_the_new_deck_is_moved_to_the_row(tmp_path):
    text = PORTAL.replace("Area=9.12", "Area=-9.12")
    new = read(text)
    _, told, _ = read_text(new.text, CATALOG, name="new")
    (moved,) = [d for d in new.moved(told, "new") if d.severity == "error"]
    assert text.splitlines()[moved.span.line - 1].lstrip().startswith("SectionName=W8X31")


# ---------------------------------------------------------------------- loads and links in detail


def cantilever(*tables):
    """A horizontal cantilever of length 2, its tip the joint 2."""
    text = replaced(PORTAL, "JOINT COORDINATES", "Joint=1   X=0   Y=0   Z=0", "Joint=2   X=2   Y=0   Z=0")
    text = replaced(text, "CONNECTIVITY - FRAME", "Frame=1   JointI=1   JointJ=2")
    text = replaced(text, "FRAME SECTION ASSIGNMENTS", "Frame=1   AnalSect=W8X31")
    text = replaced(text, "JOINT RESTRAINT ASSIGNMENTS", "Joint=1   U1=Yes   U2=Yes   U3=Yes   R2=Yes")
    for name, *rows in tables:
        text = replaced(text, name, *rows)
    return text


@pytest.mark.parametrize(
    ("first", "last", "a", "b"), [(0.0, 3.0, 0.0, 1.0), (2.0, 2.0, 0.25, 0.75), (1.0, -4.0, 0.1, 0.9)]
)
def test_a_load_that_varies_gives_the_forces_of_the_textbook(first, last, a, b, tmp_path):
    places, values = f"RelDistA={a}   RelDistB={b}", f"FOverLA={first}   FOverLB={last}"
    row = f"Frame=1   LoadPat=FLOOR   Dir=Gravity   {places}   {values}"
    deck = tmp_path / "model.inp"
    deck.write_text(read(cantilever(("FRAME LOADS - DISTRIBUTED", row))).text)
    results = run(str(deck))
    forces = {(x["element"], x["quantity"]): x["value"] for x in results.table("static_force")}
    tip = next(x["y"] for x in results.table("static_displacement") if x["node"] == 2)
    x0, size = 2 * a, 2 * (b - a)
    total = size * (first + last) / 2
    moment = total * x0 + size**2 * (first / 6 + last / 3)
    assert forces[1, "shear I"] == pytest.approx(total) and forces[1, "moment I"] == pytest.approx(moment)
    grid = np.linspace(0.0, size, 20001)
    q = first + (last - first) * grid / size
    at = x0 + grid
    bending = at**2 * (3 * 2.0 - at) / (6 * 29900 * 110)
    sagging = np.trapezoid(q * (bending + at / (11500 * 2.28)), grid)
    assert tip == pytest.approx(-sagging, rel=1e-7)


@pytest.mark.parametrize(
    ("items", "expected"),
    [
        ("Dir=X", {"WX": 1.5}),
        ("Dir=Z", {"WY": 1.5}),
        ("CoordSys=Local   Dir=2", {"WY": 1.5}),
        ("CoordSys=Local   Dir=1", {"WX": 1.5}),
        ('Dir="Z Proj"', {"WY": 1.5}),
        ('Dir="X Proj"', {}),
        ("Dir=Y", {}),
    ],
)
def test_directions_of_loads(items, expected):
    row = f"Frame=1   LoadPat=FLOOR   {items}   FOverLA=1.5"
    cards = model(cantilever(("FRAME LOADS - DISTRIBUTED", row))).member_loads
    assert [{k: c[k] for k in ("WX", "WY") if c[k]} for c in cards] == ([expected] if expected else [])


def test_older_tables():
    """Names of columns and tables of older versions."""
    m = model(
        cantilever(
            ("FRAME LOADS - DISTRIBUTED", "Frame=1   LoadCase=FLOOR   Dir=Gravity   FOverL=2"),
            ("MASSES 1 - MASS SOURCE", "MassFrom=Loads   LoadCase=FLOOR   Multiplier=1"),
        )
    )
    assert [x["WY"] for x in m.member_loads] == [-2.0] and [w["WX"] for w in m.weights] == [2.0]
    assert "WGT" not in read(cantilever()).text


def test_a_frame_is_divided_at_the_joints_on_it(tmp_path):
    """The portal's beam in one piece, with a joint in its middle, a release, a rigid end and all loads."""
    beam = PORTAL.replace("   Frame=3   JointI=2   JointJ=5   IsCurved=No\n", "")
    beam = beam.replace("Frame=4   JointI=5   JointJ=4", "Frame=4   JointI=2   JointJ=4")
    for line in [x for x in beam.splitlines() if x.startswith("   Frame=3 ")]:
        beam = beam.replace(line + "\n", "")
    beam = replaced(beam, "FRAME LOADS - POINT", "Frame=4   LoadPat=FLOOR   Dir=X   RelDist=0.75   Force=2")
    beam = replaced(beam, "FRAME LOADS - GRAVITY", "Frame=4   LoadPat=FLOOR   MultiplierZ=-1")
    beam = replaced(beam, "FRAME RELEASE ASSIGNMENTS 1 - GENERAL", "Frame=4   M3I=Yes")
    ends = "Frame=4   LengthI=0   LengthJ=4   RigidFactor=1"
    beam = replaced(beam, "FRAME OFFSET ALONG LENGTH ASSIGNMENTS", ends)
    assert len(model(beam).elements) == 3
    text = replaced(
        beam, "FRAME AUTO MESH ASSIGNMENTS", "Frame=4   AutoMesh=Yes   AtJoints=Yes   AtFrames=No"
    )
    m = model(text)
    parts = {e.name: (m.props[e.prop], e.i, e.j, e.id) for e in m.elements.values() if e.name}
    first, last = parts["4/1"], parts["4/2"]
    assert (first[1:3], last[1:3]) == ((2, 5), (5, 4))
    assert [(p[0]["PIN"], p[0]["END1"], p[0]["END2"]) for p in (first, last)] == [
        ("I", 0, 0),
        ("NONE", 0, 4),
    ]
    assert {x["ELEMENTS"]: x["WY"] for x in m.member_loads if x["WY"]} == {(first[3], last[3]): -0.1}
    assert [(x["ELEMENTS"], x["PX"], x["AT"]) for x in m.member_loads if x["PX"]] == [
        ((last[3],), 2.0, pytest.approx(72 / 140))
    ]
    partial = text.replace(
        "RelDistB=1   FOverLA=0.1   FOverLB=0.1", "RelDistB=0.8   FOverLA=0   FOverLB=0.8"
    )
    points = [(x["PY"], x["ELEMENTS"][0]) for x in model(partial).member_loads if x["PY"]]
    sums = [sum(p for p, element in points if element == part[3]) for part in (first, last)]
    assert sums == pytest.approx([-0.5 * 144 / 2, -(0.5 + 0.8) / 2 * 0.3 * 288])
    refused = read(text.replace("LengthJ=4", "LengthJ=150"))
    assert [d.code for d in refused.report if d.severity == "error"] == ["L651"]
    crossing = read(text.replace("AtFrames=No", "AtFrames=Yes"))
    assert "division of frame 4 at frames that cross it" in crossing.text


def test_a_diaphragm_normal_to_the_plane_is_rigid_and_levels_are_apart():
    text = SEVEN_STOREYS.replace(
        "Name=FLOOR1   CoordSys=GLOBAL   Axis=Z", "Name=FLOOR1   CoordSys=GLOBAL   Axis=Y"
    )
    assert dict(model(text).nodes[5].slaved) == {"X": 4, "Y": 4, "R": 4}
    text = SEVEN_STOREYS.replace("Constraint=FLOOR2", "Constraint=FLOOR1").replace(
        "Name=FLOOR1   CoordSys=GLOBAL   Axis=Z   MultiLevel=No",
        "Name=FLOOR1   CoordSys=GLOBAL   Axis=Z   MultiLevel=Yes",
    )
    nodes = model(text).nodes
    assert (dict(nodes[5].slaved), dict(nodes[8].slaved)) == ({"X": 4}, {"X": 7})


def test_the_strengths_of_a_link_to_the_ground_keep_their_sides():
    """Its deformation is that of its joint, but the deck's spring counts that of the ground."""
    curve = ((-4, -7.5), (-2, -7), (0, 0), (1, 3.5), (4, 4.25))
    rows = [f"Link=E1   DOF=U1   NonLinear=Yes   Displ={d}   Force={f}" for d, f in curve]
    text = replaced(EVERYTHING, "LINK PROPERTY DEFINITIONS 03 - MULTILINEAR", *rows)
    sides = {}
    for ends in ("JointI=3   JointJ=B2", "JointI=3"):
        m = model(text.replace("Link=MLE   JointI=3   JointJ=B2", f"Link=MLE   {ends}"))
        (spring,) = [m.props[e.prop] for e in m.elements.values() if e.name == "MLE U1"]
        sides[ends] = spring["FX"]
    assert list(sides.values()) == [(3.5, -7.0), (7.0, -3.5)]


def test_the_strengths_of_a_rotation_about_an_axis_into_the_plane_change_sides():
    """Axis 3 of a link along x points against the axis of anticlockwise rotations, or along it."""
    curve = ((-4, -7.5), (-2, -7), (0, 0), (1, 3.5), (4, 4.25))
    rows = [f"Link=E1   DOF=R3   NonLinear=Yes   Displ={d}   Force={f}" for d, f in curve]
    text = replaced(EVERYTHING, "LINK PROPERTY DEFINITIONS 03 - MULTILINEAR", *rows)
    for angle, strengths in ((0, (3.5, -7.0)), (180, (7.0, -3.5))):
        m = model(replaced(text, "LINK LOCAL AXES ASSIGNMENTS 1 - TYPICAL", f"Link=MLE   Angle={angle}"))
        (spring,) = [m.props[e.prop] for e in m.elements.values() if e.name == "MLE R3"]
        assert spring["MR"] == strengths


def test_a_gap_closes_as_in_the_model(tmp_path):
    """A cantilever tip pushed 0.5 in beyond a gap to the right of it."""
    text = cantilever(
        (
            "JOINT COORDINATES",
            "Joint=1   X=0   Y=0   Z=0",
            "Joint=2   X=0   Y=0   Z=100",
            "Joint=3   X=3   Y=0   Z=100",
        ),
        ("JOINT RESTRAINT ASSIGNMENTS", *(f"Joint={k}   U1=Yes   U3=Yes   R2=Yes" for k in (1, 3))),
        ("CONNECTIVITY - LINK", "Link=1   JointI=2   JointJ=3"),
        ("LINK PROPERTY ASSIGNMENTS", "Link=1   LinkProp=G"),
        (
            "LINK PROPERTY DEFINITIONS 05 - GAP",
            "Link=G   DOF=U1   NonLinear=Yes   TransK=50   TransOpen=0.25",
        ),
        ("FRAME LOADS - DISTRIBUTED",),
        ("JOINT LOADS - FORCE", "Joint=2   LoadPat=FLOOR   F1=20"),
    )
    deck = tmp_path / "model.inp"
    deck.write_text(read(text).text)
    tip = next(x["x"] for x in run(str(deck)).table("static_displacement") if x["node"] == 2)
    k = 1 / (100**3 / (3 * 29900 * 110) + 100 / (11500 * 2.28))
    assert tip == pytest.approx((20 + 50 * 0.25) / (k + 50)) and tip > 0.25


# ---------------------------------------------------------------------- the verb


def test_the_verb_takes_a_plane_and_its_loads(tmp_path, capsys):
    source, deck = tmp_path / "model.$2k", tmp_path / "model.inp"
    source.write_text(PORTAL)
    assert main(["import", str(source), "--plane", "XZ", "--load", "FLOOR", "-o", str(deck)]) == 0
    assert main([str(deck), "--quiet"]) == 0
    assert main(["import", str(source), "--plane", "YZ", "-o", str(deck)]) == 2
    assert "L6" in capsys.readouterr().err
