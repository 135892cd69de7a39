"""Forces of supports, base shears and storeys of a history: closed forms, and both ways to each force."""

from dataclasses import replace

import numpy as np
import pytest

from decks import results_of, structure_of
from pound_solve.structure.buildings import buildings
from pound_solve.structure.equations import Equations
from tiers import each_once

SDOF = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 COL 1 2
PROPS
 COL SPRING KX=100
WEIGHTS
 2 9.81
DAMPING
 RAYLEIGH ALPHA=0.3 BETA=0.01
EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.7 DURATION=1
OUTPUT
 EVERY={every}
ANALYSIS
 HISTORY 2 METHOD={method}
"""
METHODS = (
    "EXACT",
    "TAYLOR",
    "LAGUERRE TOL=1E-12",
    "AUTO",
    "NEWMARK DT=0.01",
    "HHT DT=0.01",
    "CENTRAL DT=0.01",
    "LAPLACE DT=0.01",
)

#: two frames of unlike heights side by side: hinges, a slaved floor, a spring to the ground, a dashpot
FRAMES = """UNITS kN m s
GRAVITY 10
GEOMETRY {geometry}
NODES
 1 0 0 FIX=XYR
 2 4 0 FIX=XY
 3 0 3
 4 4 3 SLAVED=X MASTER=3
 5 0 6
 6 4 6 SLAVED=X MASTER=5
 11 4.5 0 FIX=XYR
 12 4.5 3 FIX=R
ELEMENTS
 1 COL 1 3
 2 COL 2 4
 3 COL 3 5
 4 COL 4 6
 5 BEAM 3 4
 6 BEAM 5 6
 7 SOFT 11 12
 8 DAMP 1 5
 9 SOIL 4
 20 HIT 4 12
PROPS
 COL FRAME E=2e7 A=0.04 I=2e-4 {hinges}
 BEAM FRAME E=2e7 A=0.06 I=6e-4
 SOFT SPRING KX=2000 KY=1e5 {spring}
 DAMP DASHPOT CX=8
 SOIL SPRING KX=150
 HIT CONTACT GAP=0.004 LAW={law}
WEIGHTS
 3 TO 6 60 WR=2
 12 90
 1 5
LOADS
 3 FX=4
DAMPING
 RAYLEIGH ALPHA=0.2 BETA=0.002 STIFFNESS={damping}
{equake}
FORCES
 TABLE NODES=5,11 FX=20 POINTS=0,0,0.1,1,0.3,0
OUTPUT
 EVERY={every}
BUILDINGS
 "low" NODES=12
ANALYSIS
 STATIC GRAVITY=YES
 HISTORY {end} METHOD={method}
"""
BASE = "EQUAKE\n SINE AMPLITUDE=4 PERIOD=0.5 DURATION=1"
APART = BASE + " SUPPORTS=1,2\n SINE AMPLITUDE=3 PERIOD=0.4 DURATION=1 SUPPORTS=11"
CHOICES = {
    "geometry": "SMALL", "hinges": "RULE=BILINEAR R=0.05 MI=12 MJ=12 KH=2e4",
    "spring": "FX=20 RULE=BILINEAR,ELASTIC,ELASTIC R=0.1",
    "law": "KELVIN_VOIGT K=50000 E=0.6", "damping": "INITIAL", "equake": BASE, "every": 0.01, "end": 1.2,
    "method": "EXACT",
}  # fmt: skip
BALANCE = "base shear and overturning moment less inertia and loads, over the largest"


def run(folder, text):
    deck = folder / "deck.inp"
    deck.write_text(text)
    found = results_of(deck)
    assert found.status == "done", found.message
    return found


def frames(folder, **other):
    return run(folder, FRAMES.format(**{**CHOICES, **other}))


def balance(found):
    (value,) = [float(c["value"]) for c in found.table("checks") if c["check"] == BALANCE]
    return value


def inertia(found, masses):
    """Sum of mass times total acceleration along x."""
    nodes = list(found.attributes("node/a")["nodes"])
    return sum(m * found.history("node/a")[:, nodes.index(n), 0] for n, m in masses.items())


@pytest.mark.full
@pytest.mark.parametrize("method", METHODS)
def test_an_oscillator_pulls_at_its_support_as_its_spring_and_dashpot_do(tmp_path, method):
    """R = -(k u + beta k v) with every method; the mass-proportional dashpot passes by the support."""
    r = run(tmp_path, SDOF.format(method=method, every=0.01))
    u, v, a = (r.history(f"node/{q}")[:, 1, 0] for q in "uva")
    spring = 100.0 * u + 1.0 * v
    reaction, base = r.history("reaction"), r.history("building/base")
    assert np.abs(reaction[:, 0, 0] + spring).max() < 1e-13 * np.abs(spring).max()
    assert np.abs(reaction[:, 0, 1:]).max() == np.abs(reaction[:, 1]).max() == 0.0
    assert np.abs(base[:, 0] - spring).max() < 1e-13 * np.abs(spring).max()
    assert np.abs(base[:, 2] - 3.0 * spring).max() < 1e-12 * np.abs(spring).max()
    # HHT balances the mean over a step, LAGUERRE has an error
    tolerance = {"HHT": 0.05, "LAGUERRE": 1e-9}.get(method.split()[0], 1e-10)
    assert balance(r) < tolerance  # though the sine ends with a jump
    assert np.abs(base[:, 0] + a + 0.3 * v).max() < tolerance * np.abs(spring).max()
    (row,) = r.table("storey_envelope")
    assert (row["storey"], row["level"], row["height"]) == (1, 3.0, 3.0)
    assert row["mass"] == pytest.approx(1.0, rel=1e-12)
    assert row["shear"] >= np.abs(spring).max() * (1 - 1e-12)
    assert row["drift"] == pytest.approx(np.abs(u).max() / 3.0, rel=1e-2)
    assert row["residual"] == pytest.approx(u[-1] / 3.0, rel=1e-12)
    assert row["acceleration"] >= np.abs(a).max() * (1 - 1e-12)


@pytest.mark.full
@pytest.mark.parametrize("method", ["EXACT", "TAYLOR", "LAGUERRE"])
def test_envelopes_do_not_depend_on_the_output(tmp_path, method):
    """Between samples more than a period apart the peaks are found, as closely as those of nodes are."""
    coarse, fine = (run(tmp_path, SDOF.format(method=method, every=every)) for every in (0.8, 0.001))
    for name, key in (("reaction_envelope", "max"), ("base_envelope", "min"), ("storey_envelope", "shear")):
        one, other = (np.abs(r.table(name)[key]) for r in (coarse, fine))
        assert one == pytest.approx(other, rel=0.01), name
    assert np.abs(coarse.history("reaction")).max() < 0.9 * np.abs(fine.history("reaction")).max()


@pytest.mark.full
@each_once(
    (
        "other",
        {
            "plain": {},
            "tangent": {"damping": "TANGENT", "geometry": "PDELTA"},
            "apart": {"damping": "SECANT", "equake": APART},
            "rigid-apart": {"equake": APART, "hinges": "", "law": "STEREOMECHANICS E=0"},
            "rigid": {"law": "STEREOMECHANICS E=0", "geometry": "PDELTA_MEMBER"},
        },
    ),
    ("method", ["TAYLOR", "EXACT"]),
)
def test_base_shears_are_inertia_loads_and_contact(tmp_path, other, method):
    """Supports and inertia give the same forces, at samples and between them; the contact is a force from
    building to building; storey shears are the inertia above.
    """
    r = frames(tmp_path, method=method, **other)
    assert balance(r) < 1e-9
    labels = list(r.labels("building/base"))
    assert labels[0] == "building 1 shear X" and labels[3] == "low shear X"
    base, contact, v = r.history("building/base"), r.history("contact/force")[:, 0], r.history("node/v")
    assert contact.max() > 1.0
    nodes = list(r.attributes("node/a")["nodes"])
    push = np.interp(r.time, [0.0, 0.1, 0.3], [0.0, 20.0, 0.0])
    whole = -inertia(r, dict.fromkeys((3, 4, 5, 6), 6.0) | {1: 0.5}) + push + 4.0 - contact
    low = -inertia(r, {12: 9.0}) + push + contact
    if other.get("geometry") != "PDELTA_MEMBER":
        # the weight of a support, which stands 2 m from the axis, turns the ground alone
        for name, at, weight in (("building 1", 2, 5.0 * 2.0), ("low", 5, 0.0)):
            place = list(r.labels("storey/moment")).index(f"{name} storey 1")
            moment = r.history("storey/moment")[:, place]
            assert np.abs(moment - base[:, at] - weight).max() < 1e-9 * np.abs(moment).max()
    if other.get("equake") == APART:  # dashpots to the ground act on what is not stored
        return
    for at, (shear, masses) in {0: (whole, (3, 4, 5, 6)), 3: (low, (12,))}.items():
        mass = 6.0 if at == 0 else 9.0
        dashpot = 0.2 * mass * sum(v[:, nodes.index(n), 0] for n in masses)
        assert np.abs(base[:, at] - shear + dashpot).max() < 1e-9 * np.abs(base[:, at]).max()
    top = list(r.labels("storey/shear")).index("building 1 storey 2")
    above = -inertia(r, {5: 6.0, 6: 6.0}) + push
    above -= 0.2 * 6.0 * sum(v[:, nodes.index(n), 0] for n in (5, 6))
    assert np.abs(r.history("storey/shear")[:, top] - above).max() < 1e-9 * np.abs(above).max()


@pytest.mark.full
@pytest.mark.parametrize("geometry", ["SMALL", "PDELTA", "LARGE"])
def test_a_history_at_rest_has_the_reactions_of_the_static_state(tmp_path, geometry):
    rest = "EQUAKE\n SINE AMPLITUDE=1e-9 PERIOD=0.5 DURATION=0.01"
    text = FRAMES.format(
        **{**CHOICES, "geometry": geometry, "equake": rest, "end": 0.02, "method": "NEWMARK DT=0.002"}
    ).replace("FX=20 POINTS", "FX=1e-9 POINTS")
    r = run(tmp_path, text)
    supports = list(r.attributes("reaction")["nodes"])
    for row in r.table("reactions"):
        static = np.array([row["fx"], row["fy"], row["mz"]])
        found = r.history("reaction")[:, supports.index(row["node"])]
        assert np.abs(found - static).max() < 1e-6 * max(np.abs(static).max(), 1.0), row["node"]
    assert balance(r) < 1e-6


@pytest.mark.full
def test_varying_p_delta_and_large_displacements_are_in_balance(tmp_path):
    for geometry in ("PDELTA_VARYING", "LARGE"):
        r = frames(tmp_path, geometry=geometry, method="NEWMARK DT=0.002", end=0.6)
        assert balance(r) < 1e-6


def test_buildings_are_what_contacts_do_not_join(tmp_path):
    r = frames(tmp_path, end=0.02)
    first, low = r.table("buildings")
    assert (first["building"], first["node"], first["nodes"], first["storeys"]) == ("building 1", 1, 6, 2)
    assert (low["building"], low["node"], low["nodes"], low["storeys"]) == ("low", 11, 2, 1)
    assert first["mass"] == pytest.approx(24.5) and low["mass"] == pytest.approx(9.0)
    assert (first["base"], first["top"]) == (0.0, 6.0)
    assert [row["level"] for row in r.table("storey_envelope")] == [3.0, 6.0, 3.0]


def test_storeys_may_be_left_out(tmp_path):
    whole = run(tmp_path, SDOF.format(every=0.02, method="EXACT"))
    lean = run(tmp_path, SDOF.format(every="0.02 STOREYS=NO", method="EXACT"))
    gone = {"base_envelope", "storey_envelope"}
    assert gone <= set(whole.tables) and not gone & {n for n in lean.tables if len(lean.table(n))}
    assert "building/base" in whole.histories and "building/base" not in lean.histories
    assert not any("base shear" in check for check in lean.table("checks")["check"])
    assert (lean.history("node/u") == whole.history("node/u")).all()
    assert (lean.history("reaction") == whole.history("reaction")).all()


STACK = """NODES
 1 TO 2    0 TO 5   0     FIX=XYR
 11 TO 12  0 TO 5   {h}
 13        0        {joint}
 21 TO 22  0 TO 5   6
ELEMENTS
 1 TO 2  COL  1 TO 2  11 TO 12
 3       COL  11  13
 4       COL  13  21
 5       COL  12  22
 6       BEAM 11 12
 7       BEAM 21 22
PROPS
 COL FRAME E=2E7 A=0.04 I=2E-4
 BEAM FRAME E=2E7 A=0.04 I=2E-4
WEIGHTS
 11 TO 12  50
 21 TO 22  {roof}
 13        {light}
{names}
"""


@pytest.mark.parametrize(
    ("light", "roof", "names", "levels"),
    [
        (9.0, 50.0, "", [3, 6]),  # less than a tenth of the 100 of the heaviest level
        (11.0, 50.0, "", [3, 4.5, 6]),
        (9.0, 2.0, "", [3, 6]),  # the highest level is a floor, however light
        (9.0, 50.0, 'BUILDINGS\n "A" NODES=1 FLOORS=12,13,22', [3, 4.5, 6]),
        (11.0, 50.0, 'BUILDINGS\n "A" NODES=1 FLOORS=11,22', [3, 6]),
    ],
)
def test_floors_are_heavy_levels_or_those_that_the_deck_names(light, roof, names, levels):
    deck = STACK.format(h=3, joint=4.5, light=light, roof=roof, names=names)
    (found,) = buildings(structure_of(deck))
    assert found.levels == pytest.approx([0, *levels], abs=1e-12)
    assert found.mass == pytest.approx((100 + 2 * roof + light) / 9.81, rel=1e-9)


def test_the_shear_of_a_storey_has_the_inertia_of_joints_within_it(tmp_path):
    """A joint of 2 kN above the middle of the second storey, which is no floor."""
    text = "UNITS kN m s\nGRAVITY 10\n" + STACK.format(h=3, joint=5, light=2, roof=50, names="")
    motion = "EQUAKE\n SINE AMPLITUDE=4 PERIOD=0.5 DURATION=1\n"
    r = run(tmp_path, text + motion + "OUTPUT\n EVERY=0.01\nANALYSIS\n HISTORY 1 METHOD=EXACT\n")
    assert r.table("storey_envelope")["storey"].tolist() == [1, 2]
    shear = r.history("storey/shear")
    above = inertia(r, {21: 5.0, 22: 5.0, 13: 0.2})
    assert np.abs(shear[:, 1] + above).max() < 1e-9 * np.abs(shear).max()
    assert np.abs(shear[:, 0] + above + inertia(r, {11: 5.0, 12: 5.0})).max() < 1e-9 * np.abs(shear).max()


#: an oscillator, and a body beside it that nothing but a contact joins to it
BODY = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 -1 3 FIX=YR
ELEMENTS
 1 COL 1 2
 2 HIT 3 2
PROPS
 COL SPRING KX=100
 HIT CONTACT GAP={gap} ANGLE=0 LAW=KELVIN_VOIGT K=5000 E=0.6
WEIGHTS
 2 20
 3 47.151
{loads}
EQUAKE
 TABLE POINTS=0,0.3,1,2 SCALE={scale}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.5 METHOD={method}
"""


@pytest.mark.full
@pytest.mark.parametrize("method", ["EXACT", "TAYLOR", "LAGUERRE TOL=1E-12", "NEWMARK DT=0.01"])
@pytest.mark.parametrize(
    ("gap", "loads", "scale", "force"),
    [(0.01, "", 1, 0.0), (0, "LOADS\n 3 FX=7.3", 1e-12, 7.3)],
    ids=["untouched", "pressed"],
)
def test_a_body_without_inertia_is_in_balance(tmp_path, method, gap, loads, scale, force):
    """Neither one that stays where it is while the ground moves away under it nor one that a load presses
    against its neighbour is accelerated: what is left of their forces is rounding, and so is the inertia.
    """
    r = run(tmp_path, BODY.format(method=method, gap=gap, loads=loads, scale=scale))
    assert r.history("contact/force").max() == pytest.approx(force, abs=1e-9)
    assert balance(r) < 1e-9


def test_a_force_that_the_equations_lack_is_out_of_balance(tmp_path, monkeypatch):
    """The check fails where a contact pushes one building only."""
    whole = Equations.sums

    def without_contacts(self, weights):
        return whole(self, replace(weights, contacts=0.0 * weights.contacts))

    monkeypatch.setattr(Equations, "sums", without_contacts)
    r = run(tmp_path, BODY.format(method="EXACT", gap=0, loads="", scale=-1))
    assert r.history("contact/force").max() > 1.0
    assert balance(r) > 0.1
