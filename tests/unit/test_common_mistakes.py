"""Decks with one mistake each, of kinds that engineers make, are told by name and with the cure; decks that
only look like it are not.
"""

import re
from pathlib import Path

import pytest

from pound_deck.reader import read_text
from pound_solve.catalog import catalog
from pound_solve.driver.prepare import DeckError, assembled, prepare
from pound_solve.driver.request import Request

SOUND = sorted((Path(__file__).parent / "sound").glob("*.inp"))

#: two concrete frames beside each other
FRAMES = """NODES
 11 0 0 FIX=XYR
 12 0 3.5
 13 0 7
 14 6 0 FIX=XYR
 15 6 3.5
 16 6 7
 21 6.45 0 FIX=XYR
 22 6.45 3.5
 23 6.45 7
 24 12.45 0 FIX=XYR
 25 12.45 3.5
 26 12.45 7
ELEMENTS
 11 COL 11 12
 12 COL 12 13
 13 COL 14 15
 14 COL 15 16
 15 BEAM 12 15
 16 BEAM 13 16
 21 PIER 21 22
 22 PIER 22 23
 23 PIER 24 25
 24 PIER 25 26
 25 BEAM 22 25
 26 BEAM 23 26
 31 HIT 15 22
 32 HIT 16 23
PROPS
 COL FRAME E=25E6 A=0.16 I=0.0021 RULE=TAKEDA R=0.03 MI=200 MJ=200 LP=0.25
 PIER FRAME E=25E6 A=0.25 I=0.0052 RULE=TAKEDA R=0.03 MI=400 MJ=400 LP=0.3
 BEAM FRAME E=25E6 A=0.18 I=0.0054
 HIT CONTACT GAP=0.03 LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
 12,13,15,16 240
 22,23,25,26 300
GEOMETRY PDELTA
DAMPING
 RAYLEIGH XI=0.05 MODES=1,3
EQUAKE
 SINE AMPLITUDE=2 PERIOD=1 DURATION=5
ANALYSIS
 STATIC GRAVITY=YES
 HISTORY 10
"""

#: the same as storeys, springs and masses
STOREYS = """NODES
 10 0 0 FIX=XYR
 11 TO 12 0 3.5 TO 7 FIX=YR
 20 8 0 FIX=XYR
 21 TO 22 8 3.5 TO 7 FIX=YR
ELEMENTS
 11 TO 12 LEFT 10 TO 11 11 TO 12
 21 TO 22 RIGHT 20 TO 21 21 TO 22
 31 HIT 12 22
PROPS
 LEFT SPRING KX=30000 RULE=BILINEAR R=0.05 FX=300
 RIGHT SPRING KX=60000 RULE=BILINEAR R=0.05 FX=500
 HIT CONTACT GAP=0.03 K=1E6
WEIGHTS
 11,12 480
 21,22 600
EQUAKE
 SINE AMPLITUDE=2 PERIOD=1 DURATION=5
ANALYSIS
 MODAL 2
 HISTORY 10
"""

RIGHT_FOOT, RIGHT_FEET = " 21 6.45 0 FIX=XYR", [" 21 6.45 0 FIX=XYR", " 24 12.45 0 FIX=XYR"]
HINGES = "RULE=TAKEDA R=0.03 MI=400 MJ=400 LP=0.3"
#: a column in two pieces, as where a floor of the neighbour strikes it
SPLIT = [("ELEMENTS", " 27 6.45 1.75\nELEMENTS"), (" 21 PIER 21 22", " 21 PIER 21 27\n 27 PIER 27 22")]

#: without dashpots across hinges, which divide the rotation between them
PLASTIC = [
    ("RULE=TAKEDA R=0.03 MI=400", "RULE=ELASTO_PLASTIC MI=400"),
    ("RAYLEIGH XI=0.05 MODES=1,3", "MODAL XI=0.05"),
]
ONE_HINGE = [
    (" 27 PIER 27", " 27 UPPER 27"),
    (" BEAM FRAME", " UPPER FRAME E=25E6 A=0.25 I=0.0052 RULE=ELASTO_PLASTIC MJ=400 LP=0.3\n BEAM FRAME"),
]

UNWEIGHTED = (" STATIC GRAVITY=YES", " STATIC")
#: a third floor of the left frame
THIRD = [
    ("ELEMENTS\n", " 17 0 10.5\n 18 6 10.5\nELEMENTS\n 17 COL 13 17\n 18 COL 16 18\n 19 BEAM 17 18\n"),
    ("12,13,15,16 240", "12,13,15,16,17,18 240"),
]
SYNTHETIC = ("SINE AMPLITUDE=2 PERIOD=1 DURATION=5", "SYNTHETIC PGA=3 SEED=1 DURATION=9")
#: one foot on soil
SOIL = [
    (RIGHT_FOOT, " 21 6.45 0"),
    ("31 HIT", "30 FOOT 21\n 31 HIT"),
    ("PROPS", "PROPS\n FOOT FOUNDATION G=40000 NU=0.3 WGT=18 B=1.2 L=1.2"),
]


def fixed(letters):
    """The feet of the right frame with these directions fixed."""
    return [(line, line.replace(" FIX=XYR", f" FIX={letters}" * bool(letters))) for line in RIGHT_FEET]


def scaled(items, factor):
    """Coordinates of the frames in another unit of length."""
    return [
        (line, f" {n} {factor * float(x):g} {factor * float(y):g}{rest}") for line, n, x, y, rest in items
    ]


def nodes():
    """The lines of NODES, taken apart."""
    for line in FRAMES.partition("ELEMENTS")[0].splitlines()[1:]:
        n, x, y, *rest = line.split()
        yield line, n, x, y, "".join(f" {r}" for r in rest)


#: what was changed; the deck, its changes, the code, and words of the message and its cure
MISTAKES = {
    "foot without FIX": (
        [(" 11 0 0 FIX=XYR", " 11 0 0")],
        "P348 the foot of member 11, node 11, hangs free: give it FIX",
    ),
    "FIX at the node above": (
        [(" 11 0 0 FIX=XYR\n 12 0 3.5", " 11 0 0\n 12 0 3.5 FIX=XYR")],
        "P348 the foot of member 11, node 11, hangs free: give it FIX",
    ),
    "no supports": (
        fixed(""),
        "P337 nothing keeps 'building 2' from moving along X as one body: fix its base",
    ),
    "rollers": (
        fixed("Y"),
        "P337 nothing keeps 'building 2' from moving along X as one body: fix its base",
    ),
    "one pin": (
        [(RIGHT_FEET[0], " 21 6.45 0 FIX=XY"), (RIGHT_FEET[1], " 24 12.45 0")],
        "P337 nothing keeps 'building 2' from turning about x = 6.45, y = 0 as one body: fix its base",
    ),
    "columns pinned at both ends": (
        [(HINGES, "PIN=BOTH")],
        "P356 nothing holds nodes 23, 26 of 'building 2' along X: the building is a mechanism: "
        "take out a PIN",
    ),
    "pinned feet and pinned beams": (
        [*fixed("XY"), ("I=0.0054", "I=0.0054 PIN=BOTH")],
        "P356 nothing holds nodes 22, 23, 25, 26 of 'building 2' along X",
    ),
    "column forgotten": ([(" 13 COL 14 15\n", "")], "P314 node 14 is connected to nothing: join it"),
    "beam at a second node": (
        [("ELEMENTS", "NODES\n 17 6 3.5\nELEMENTS"), ("15 BEAM 12 15", "15 BEAM 12 17")],
        "P349 nodes 17 and 15 are both at x = 6, y = 3.5, but nothing joins them: let element 15 "
        "end at node 15",
    ),
    "member twice": (
        [(" 16 BEAM 13 16", " 16 BEAM 13 16\n 17 BEAM 16 13")],
        "P354 members 16 and 17 of BEAM join the same nodes, 16 and 13: take one out",
    ),
    "member from a node to itself": (
        [("16 BEAM 13 16", "16 BEAM 13 13")],
        "P321 both ends of element 16 are node 13",
    ),
    "height of a node with a digit too many": (
        [(" 13 0 7", " 13 0 70")],
        "P353 member 12 is 66.5 m long, others of COL 3.5 m: correct the coordinates of node 12 or 13",
    ),
    "column far from upright": (
        [(" 16 6 7", " 16 60 7")],
        "P353 member 14 is 54.1 m long, others of COL 3.5 m: correct the coordinates of node 15 or 16",
    ),
    "coordinates in mm": (
        scaled(nodes(), 1000.0),
        "P362 'building 1' is 7e+03 m high: coordinates under NODES are in m",
    ),
    "UNITS of another deck": (
        [("NODES\n", "UNITS kN mm s\nNODES\n"), ("AMPLITUDE=2", "AMPLITUDE=2000")],
        "P362 'building 1' is 0.007 m high: coordinates under NODES are in mm",
    ),
    "A in mm2": (
        [("A=0.16", "A=160000")],
        "P352 A of COL is 160000 m^2, but I makes the section 0.0004 m deep: 160000 mm^2 are 0.16 m^2",
    ),
    "I in cm4": (
        [("I=0.0054", "I=540000")],
        "P352 the section of BEAM is 6e+03 m deep by A and I, sqrt(12 I/A), but member 25 is 6 m "
        "long: A is in m^2",
    ),
    "I in dm4": (
        [("I=0.0021", "I=2.1E-7")],
        "P352 the section of COL is 0.004 m deep by A and I, sqrt(12 I/A), but member 11 is 3.5 m long: A",
    ),
    "A and I exchanged": (
        [("A=0.18 I=0.0054", "A=0.0054 I=0.18")],
        "P352 the section of BEAM is 20 m deep by A and I, sqrt(12 I/A), but member 25 is 6 m "
        "long: A is in m^2",
    ),
    "E in MPa": (
        [("E=25E6", "E=25E3")] * 3,
        "P357 the first period of 'building 1' is about 17 s, above 5.31 s: it would fall by its "
        "own weight: check",
    ),
    "E in Pa": (
        [("E=25E6", "E=25E9")] * 3,
        "P357 the first period of 'building 1' is about 0.017 s, below 0.028 s: a solid block is "
        "hardly stiffer",
    ),
    "weights in N": (
        [(" 240", " 240000"), (" 300", " 300000")],
        "P357 the first period of 'building 2' is about 15 s, above 5.31 s",
    ),
    "masses under WEIGHTS": (
        [(" 240", " 24.5"), (" 300", " 30.6")],
        "P361 'building 1' weighs 98 kN, but its beams and columns alone weigh 106 kN by A and E: "
        "WEIGHTS are forces",
    ),
    "weights where gravity is one": (
        [("NODES\n", "GRAVITY 1\nNODES\n"), ("AMPLITUDE=2", "AMPLITUDE=0.2")],
        "P361 'building 1' weighs 9.42e+03 kN, which shortens its columns by 1.2 per mille",
    ),
    "gravity in mm": (
        [("NODES\n", "GRAVITY 9810\nNODES\n")],
        "P342 GRAVITY is 9810, that of mm, but the unit of length is m: it is 9.81 for lengths in m",
    ),
    "no weights": (
        [(" 12,13,15,16 240\n 22,23,25,26 300\n", "")],
        "P347 nothing has mass, so nothing can swing: give the nodes of its floors WEIGHTS",
    ),
    "weights of one building forgotten": (
        [(" 22,23,25,26 300\n", "")],
        "P347 the building of nodes 21, 22, 23, 24, 25, 26 has no mass",
    ),
    "weights at the supports": (
        [(" 22,23,25,26 300", " 21,24 600")],
        "P347 the building of nodes 21, 22, 23, 24, 25, 26 has no mass",
    ),
    "weights twice": (
        [(" 22,23,25,26 300", " 22,23,25,26 300\n 25,26 300")],
        "P329 node 25 has a weight in line 36 already, and this adds to it: take it out of one",
    ),
    "blanks in a list": (
        [("12,13,15,16 240", "12,13 15 240")],
        "P320 WX is 15, which is the number of a node",
    ),
    "floor fixed": (
        [(" 12 0 3.5", " 12 0 3.5 FIX=X")],
        "P343 node 12 of 'building 1' is fixed along X above the base",
    ),
    "gap in mm": (
        [("GAP=0.03", "GAP=30")],
        "P351 GAP is 30 m, more than the 7 m that the buildings at contact 31 are high",
    ),
    "gap in cm": (
        [("GAP=0.03", "GAP=3")],
        "P360 GAP is 3 m, but the nodes of contact 31 are 0.45 m apart: GAP is a distance in m: correct it",
    ),
    "gap below zero": (
        [("GAP=0.03", "GAP=-0.03")],
        "P336 contacts of HIT are pressed at rest: GAP is -0.03",
    ),
    "contact within a building": (
        [("31 HIT 15 22", "31 HIT 12 15")],
        "P358 contact 31 joins nodes 12 and 15, which members or SLAVED hold together: it does not "
        "close: name",
    ),
    "diaphragm through both buildings": (
        [(" 22 6.45 3.5", " 22 6.45 3.5 SLAVED=X MASTER=15")],
        "P358 contact 31 joins nodes 15 and 22, which members or SLAVED hold together",
    ),
    "contact with its nodes exchanged": (
        [("31 HIT 15 22", "31 HIT 22 15"), ("GAP=0.03", "GAP=0.03 ANGLE=0")],
        "P359 contact 31 closes as nodes 22 and 15 move apart: ANGLE points from 15 to 22: "
        "exchange I and J",
    ),
    "contact with the floor above": (
        [("31 HIT 15 22", "31 HIT 15 23")],
        "P368 contact 31 joins node 15 at y = 3.5 with node 23 at y = 7, but node 22 faces it: "
        "name node 22 in place of node 23",
    ),
    "yield moments in N m": (
        [("MI=200 MJ=200", "MI=200E3 MJ=200E3")],
        "P355 hinges of COL yield at 200000 kN*m, a strain of 2 of the section: 0.01 is much: "
        "yield moments are in",
    ),
    "yield moments in MN m": (
        [("MI=200 MJ=200", "MI=0.2 MJ=0.2")],
        "P355 hinges of COL yield at 0.2 kN*m, a strain of 2e-06 of the section: 0.001 is little: "
        "yield moments",
    ),
    "yield moments in N m beside a stiffness": (
        [("MI=200 MJ=200 LP=0.25", "MI=200E3 MJ=200E3 KH=6E4")],
        "P355 COL yields at a rotation of 3.3 rad: 0.05 is much: MI is in kN*m, KH in the same",
    ),
    "ductility per cent": (
        [("LP=0.25", "LP=0.25 DUCTU=800")],
        "P355 DUCTU of COL is 800, but no member has more than 100: DUCTU is a multiple",
    ),
    "hinge longer than its member": (
        [("LP=0.25", "LP=4")],
        "P330 element 11 and 3 more (COL): a hinge of 4 is longer",
    ),
    "hinges on both sides of a node within a column": (
        [*SPLIT, *PLASTIC],
        "P366 hinge J of member 21 and hinge I of member 27 face each other at node 27 and yield at the "
        "same moment, 400 kN*m, without hardening: which of them turns is open: give member 27 a property "
        "set without MI, or both a rule that hardens, such as BILINEAR with R above zero",
    ),
    "hinges that soften on both sides of a node within a column": (
        [*SPLIT, ("RULE=TAKEDA R=0.03 MI=400", "RULE=BILINEAR R=-0.01 MI=400"), PLASTIC[1]],
        "P366 hinge J of member 21 and hinge I of member 27 face each other",
    ),
    "hinges that face each other, and dashpots that a pushover does not have": (
        [*SPLIT, PLASTIC[0], ("HISTORY 10", "PUSHOVER 23 0.1")],
        "P366 hinge J of member 21 and hinge I of member 27 face each other",
    ),
    "hinges on both sides of a node within a column, drawn towards it": (
        [
            *SPLIT,
            *PLASTIC,
            *ONE_HINGE,
            ("PLASTIC MI=400 MJ=400", "PLASTIC MI=400,-300 MJ=400,-300"),
            (" MJ=400 LP=0.3\n BEAM", " MI=300,-400 MJ=300,-400 LP=0.3\n BEAM"),
            ("27 UPPER 27 22", "27 UPPER 22 27"),
        ],
        "P366 hinge J of member 21 and hinge J of member 27 face each other at node 27",
    ),
    "no hinge but the two on both sides of a node": (
        [
            *SPLIT,
            *PLASTIC,
            (" 21 PIER 21", " 21 LOWER 21"),
            *ONE_HINGE,
            ("RULE=ELASTO_PLASTIC MJ=400 LP=0.3\n BEAM", "RULE=ELASTO_PLASTIC MI=400 LP=0.3\n BEAM"),
            (
                " BEAM FRAME",
                " LOWER FRAME E=25E6 A=0.25 I=0.0052 RULE=ELASTO_PLASTIC MJ=400 LP=0.3\n BEAM FRAME",
            ),
        ],
        "which of them turns is open: give member 27 a property set without hinges, or both a rule",
    ),
    "damping in per cent": ([("XI=0.05", "XI=5")], "P341 a damping ratio of 5 is 500 % of critical"),
    "Rayleigh damping without modes": (
        [(" MODES=1,3", "")],
        "P332 XI needs the circular frequencies (OMEGA=) or the",
    ),
    "P-Delta without weight": (
        [(" STATIC GRAVITY=YES\n", "")],
        "P340 GEOMETRY PDELTA, but nothing loads the columns: their axial forces are zero: add "
        "STATIC GRAVITY=YES",
    ),
    "loads upwards": (
        [("EQUAKE", "LOADS\n 12,13,15,16 0 240\nEQUAKE")],
        "P364 loads pull 'building 1' upwards by 960 kN, others press by 960 kN: loads that press are",
    ),
    "loads of beams upwards": (
        [("EQUAKE", "MEMBER_LOADS\n 25,26 WY=40\nEQUAKE")],
        "P364 loads pull 'building 2' upwards by 480 kN, others press by 1200 kN: loads that",
    ),
    "loads of one building alone": (
        [UNWEIGHTED, ("EQUAKE", "LOADS\n 12,13,15,16 0 -240\nEQUAKE")],
        "P340 GEOMETRY PDELTA, but nothing loads the columns of 'building 2': their axial forces are zero",
    ),
    "loads along X": (
        [UNWEIGHTED, ("EQUAKE", "LOADS\n 12,13,15,16 -240\n 22,23,25,26 0 -300\nEQUAKE")],
        "P370 loads push 'building 1' sideways by -960 kN; it weighs 960 kN: loads that press act along Y",
    ),
    "gravity twice": (
        [("EQUAKE", "MEMBER_LOADS\n 15,16 WY=-75\nEQUAKE")],
        "P370 loads press 'building 1' by 900 kN, and STATIC GRAVITY=YES by its weight, 960 kN, once more: "
        "leave one of them out",
    ),
    "loads in N/m": (
        [UNWEIGHTED, ("EQUAKE", "MEMBER_LOADS\n 15,16 WY=-75E3\n 25,26 WY=-90\nEQUAKE")],
        "P370 loads press 'building 1' by 9e+05 kN, 9.4e+02 of its weight, 960 kN: loads are in kN",
    ),
    "loads in MN/m": (
        [UNWEIGHTED, ("EQUAKE", "MEMBER_LOADS\n 15,16 WY=-0.075\n 25,26 WY=-90\nEQUAKE")],
        "P370 loads press 'building 1' by 0.9 kN, 0.00094 of its weight",
    ),
    "beam without its load": (
        [*THIRD, UNWEIGHTED, ("EQUAKE", "MEMBER_LOADS\n 15,19 WY=-75\n 25,26 WY=-90\nEQUAKE")],
        "P370 no load presses nodes 13, 16 of 'building 1', as loads press its other floors: load them",
    ),
    "loads of beams upwards beside others": (
        [UNWEIGHTED, ("EQUAKE", "LOADS\n 12,13,15,16 0 -200\nMEMBER_LOADS\n 15,16 WY=50\nEQUAKE")],
        "P364 loads pull 'building 1' upwards by 600 kN, others press by 800 kN: loads",
    ),
    "loads forgotten, but for the weight of columns": (
        [UNWEIGHTED, ("A=0.16 I=0.0021", "A=0.16 I=0.0021 WGT=4"), ("I=0.0052", "I=0.0052 WGT=6")],
        "P340 GEOMETRY PDELTA, but loads press 'building 1', which weighs 1016 kN, by 56 kN: add STATIC",
    ),
    "roof without weights": (
        [("12,13,15,16 240", "12,15 240"), ("LAW=KELVIN_VOIGT K=1E6 E=0.65", "K=1E6")],
        "P347 the highest beams of 'building 1' have no mass at their nodes, 13, 16: give the nodes of "
        "each",
    ),
    "foot with a weight, without its footing": (
        [(RIGHT_FOOT, " 21 6.45 0"), ("EQUAKE", "WEIGHTS\n 21 60\nEQUAKE")],
        "P348 the foot of member 21, node 21, hangs free: give it FIX",
    ),
    "dashpot of a brace along X": (
        [("31 HIT", "30 DAMP 11 15\n 31 HIT"), ("PROPS", "PROPS\n DAMP DASHPOT CX=200")],
        "P378 dashpot 30 acts along X, but its nodes lie on a slope of 30.3 degrees: ANGLE=MEMBER lets it",
    ),
    "frequencies of damping in Hz": (
        [("MODES=1,3", "OMEGA=1.9,6")],
        "P373 OMEGA=1.9,6 is below the first mode, about 11.8 rad/s: OMEGA are circular frequencies",
    ),
    "nodes of another building under DAMPING": (
        [("MODES=1,3", "OMEGA=12,60 NODES=12,13 PROPS=PIER")],
        "P339 no element of PROPS=PIER ends at one of these NODES: NODES are those of the building",
    ),
    "target of a pushover in cm": (
        [("HISTORY 10", "PUSHOVER 16 30")],
        "P377 TARGET is 30 m, node 16 7 m above its base: TARGET is a displacement in m",
    ),
    "stiffness of a contact of another unit": (
        [("K=1E6", "K=1E9")],
        "P369 contact 31 is 1.3e+03 times as stiff as the beams behind it, EA/L, which give way: K is in "
        "kN/m",
    ),
    "two walls on one side": (
        [
            ("31 HIT", "33 WALL 12\n 34 OTHER 12\n 31 HIT"),
            ("PROPS", "PROPS\n WALL CONTACT GAP=0.2 ANGLE=180 K=2E5"),
            ("PROPS", "PROPS\n OTHER CONTACT GAP=0.2 ANGLE=180 K=3E5"),
        ],
        "P354 contacts 33 and 34 are the same: they close at 180 degrees together: give one ANGLE=180",
    ),
    "frame entered twice": (
        [
            (
                "ELEMENTS\n",
                " 41 0 0 FIX=XYR\n 42 0 3.5\n 44 6 0 FIX=XYR\n 45 6 3.5\nELEMENTS\n 41 COL 41 42\n"
                " 43 COL 44 45\n 45 BEAM 42 45\n",
            ),
            ("12,13,15,16 240", "12,13,15,16,42,45 240"),
        ],
        "P371 the frame of nodes 41, 42, 44, 45 lies upon that of nodes 11, 12, 13, 14, 15, 16",
    ),
    "member twice, of two property sets": (
        [("31 HIT", "30 PIER 11 12\n 31 HIT")],
        "P354 members 11 and 30, COL and PIER, join the same nodes, 11 and 12: take one out",
    ),
    "column of the upper storey forgotten": (
        [(" 14 COL 15 16\n", "")],
        "P375 nothing stands below node 16 of 'building 1', where a beam ends, but node 15 is right below "
        "it: is a column missing from 15 to 16?",
    ),
    "beam forgotten": (
        [(" 26 BEAM 23 26\n", "")],
        "P375 no beam joins nodes 23 and 26 of 'building 2', as one joins 22 and 25 below them",
    ),
    "beam that ends a floor lower": (
        [*THIRD, ("16 BEAM 13 16", "16 BEAM 13 15")],
        "P375 member 16 slopes by 30.3 degrees, all others of BEAM lie: correct its nodes, 13 and 15",
    ),
    "height of a roof node with digits exchanged": (
        [(" 26 12.45 7", " 26 12.45 6.07")],
        "P375 member 26 slopes by 8.81 degrees, all others of BEAM lie",
    ),
    "top storey too low": (
        [*THIRD, (" 17 0 10.5\n 18 6 10.5", " 17 0 7.5\n 18 6 7.5")],
        "P353 column 17 is 0.5 m high, others of COL 3.5 m: correct the height of node 13 or 17",
    ),
    "drift between buildings": (
        [("EQUAKE", 'DRIFT\n "1" 15 23\nEQUAKE')],
        "P367 drift \"1\" is that of node 23 of 'building 2' against node 15 of 'building 1': name two",
    ),
    "drift downwards": (
        [("EQUAKE", 'DRIFT\n "1" 13 12\nEQUAKE')],
        'P367 drift "1" is that of node 12 below against node 13 above: exchange I and J',
    ),
    "contact at the height of another floor": (
        [("32 HIT 16 23", "32 HIT 16 22"), ("GAP=0.03", "GAP=0.03 ANGLE=0")],
        "P368 contact 32 joins node 16 at y = 7 with node 22 at y = 3.5, but node 23 faces it",
    ),
    "contact along Y": (
        [("GAP=0.03", "GAP=0.03 ANGLE=90")],
        "P368 contact 31 acts along Y, but its nodes 15 and 22 lie beside each other: they pass",
    ),
    "stiffness of a contact in N/mm2": (
        [("K=1E6", "K=1")],
        "P369 the weight of the bodies at contact 31 would press it by 1.3e+02 m: K is in",
    ),
    "stiffness of a contact in MN and mm": (
        [("K=1E6", "K=1E12")],
        "P369 contact 31 is 1.3e+06 times as stiff as the beams behind it, EA/L, which give way: K is in",
    ),
    "foot that SUPPORTS leave out": (
        [("DURATION=5", "DURATION=5 SUPPORTS=11,14,21")],
        "P372 no motion has node 24 of 'building 2' among its SUPPORTS: it stands still: name all feet",
    ),
    "factors of damping as ratios": (
        [("RAYLEIGH XI=0.05 MODES=1,3", "RAYLEIGH ALPHA=0.05 BETA=0.05")],
        "P373 DAMPING gives the first mode of 'building 1' 30 % of critical: 5 % is usual: XI is a share",
    ),
    "no damping": (
        [("DAMPING\n RAYLEIGH XI=0.05 MODES=1,3\n", ""), SYNTHETIC],
        "P373 nothing damps the first mode of 'building 1': add DAMPING",
    ),
    "dashpot in N s/m": (
        [("31 HIT", "30 DAMP 11 15\n 31 HIT"), ("PROPS", "PROPS\n DAMP DASHPOT CX=2E5")],
        "P373 dashpots give the first mode of 'building 1' 4.1e+03 % of critical: it does not swing",
    ),
    "dashpot in MN s/m": (
        [("31 HIT", "30 DAMP 11 15\n 31 HIT"), ("PROPS", "PROPS\n DAMP DASHPOT CX=0.2")],
        "P373 dashpots give the first mode of 'building 1' no more than 0.0041 % of critical",
    ),
    "motion along Y": (
        [("DURATION=5", "DURATION=5 DIRECTION=Y")],
        "P374 the ground moves along Y alone, but contact 31 closes along X: add a motion along X",
    ),
    "peak in g": (
        [("SINE AMPLITUDE=2 PERIOD=1 DURATION=5", "SYNTHETIC PGA=0.4 SEED=1 DURATION=5")],
        "R404 PGA=0.4 is 0.041 g: PGA is no share of gravity; 0.4 g is PGA=3.924",
    ),
    "history shorter than the earthquake": (
        [SYNTHETIC, ("HISTORY 10", "HISTORY 3")],
        "R412 the history ends at 3 s, when 8 % of the Arias intensity of the motion has acted, which",
    ),
    "start behind the strong part": (
        [("SINE AMPLITUDE=2 PERIOD=1 DURATION=5", 'RECORD "ELCENTRO_180" START=20')],
        "R412 START=20 cuts off the peak of the record, at 2.18 s: give an earlier START, or a DURATION",
    ),
    "rise longer than the earthquake": (
        [SYNTHETIC, ("DURATION=9", "DURATION=9 RISE=20")],
        "R412 the motion ends at DURATION=9, within its RISE=20",
    ),
    "rows in ms": (
        [("HISTORY 10", "HISTORY 10\nOUTPUT\n EVERY=5")],
        "P365 rows every 5 s do not show a motion whose first period is about 0.53 s: EVERY is a time in s",
    ),
    "hinges longer than half of the member": (
        [("LP=0.25", "LP=2")],
        "P355 the hinges of COL are 2 and 2 m long, but member 13 is 3.5 m: LP is in m",
    ),
    "hardening in per cent": (
        [("RULE=TAKEDA R=0.03 MI=400", "RULE=TAKEDA R=0.3 MI=400")],
        "P355 hinges of PIER keep R=0.3 of the stiffness of the section as they yield: R is a share",
    ),
    "A in cm2": (
        [("A=0.16", "A=1600")],
        "P352 A of COL is 1600 m^2, but I makes the section 0.004 m deep: 1600 cm^2 are 0.16 m^2",
    ),
    "N and m in UNITS": (
        [("NODES\n", "UNITS N m s\nNODES\n")],
        "P376 E of COL is 2.5e+07 N/m^2, 25 MPa: timber has 10000, concrete 25000: E is in N/m^2",
    ),
    "weight by volume": (
        [("A=0.16 I=0.0021", "A=0.16 I=0.0021 WGT=25")],
        "P376 columns of COL weigh 25 kN/m, 156 kN/m^3 of their section: WGT is a weight by length",
    ),
    "soil in MPa": (
        [*SOIL, ("G=40000", "G=40")],
        "P376 G of FOOT is 40 kN/m^2: soils have 10 to 1000 MPa: G is in kN/m^2",
    ),
    "footing in mm": (
        [*SOIL, ("B=1.2", "B=1200")],
        "P376 B of FOOT is 1200 m: it is half the length of the footing: B is in m",
    ),
    "foot held along X only": (
        [(" 11 0 0 FIX=XYR", " 11 0 0 FIX=X")],
        "P348 the foot of member 11, node 11, hangs free: give it FIX",
    ),
    "motion times gravity twice": (
        [("AMPLITUDE=2", "AMPLITUDE=0.35*9.81^2")],
        "R404 peak ground acceleration is 3.43 g",
    ),
    "motion in mm/s2": ([("AMPLITUDE=2", "AMPLITUDE=2000")], "R404 peak ground acceleration is 204 g"),
    "steps in ms": (
        [("HISTORY 10", "HISTORY 10 METHOD=NEWMARK DT=5")],
        "P365 steps of DT=5 s do not follow a motion whose first period is about 0.53 s: DT is a time in s",
    ),
}

#: the same of the deck of storeys
STOREY_MISTAKES = {
    "yield forces in N": (
        [("FX=300", "FX=300000")],
        "P363 the springs below 'building 1' yield at 3e+05 kN together, 3.1e+02 of its weight: 1 "
        "is much: FX",
    ),
    "yield forces in MN": (
        [("FX=500", "FX=0.5")],
        "P363 the springs below 'building 2' yield at 0.5 kN together",
    ),
    "stiffnesses in MN/m": (
        [("KX=30000 RULE=BILINEAR R=0.05 FX=300", "KX=30")],
        "P357 the first period of 'building 1' is about 13 s, above 5.31 s: it would fall by its "
        "own weight",
    ),
    "spring in kN/mm": (
        [
            ("ELEMENTS\n", "ELEMENTS\n 30 TIE 10 12\n"),
            ("PROPS\n", "PROPS\n TIE SPRING KX=5 RULE=BILINEAR FX=150\n"),
        ],
        "P363 springs of TIE yield at 30 m; 'building 1' is 7 m high: stiffnesses are in kN/m",
    ),
    "spring that passes a storey": (
        [(" 11 TO 12 LEFT 10 TO 11 11 TO 12", " 11 LEFT 10 11\n 12 LEFT 10 12")],
        "P375 element 12 passes node 11 of 'building 1', from which nothing leads up: let it end or",
    ),
    "one storey without a spring": (
        [(" 11 TO 12 LEFT 10 TO 11 11 TO 12", " 12 LEFT 11 12")],
        "P314 node 10 is",
    ),
}


#: items and the powers of force and length in their unit
DIMENSIONS = {
    "FRAME E": (1, -2),
    "A": (0, 2),
    "I": (0, 4),
    "MI": (1, 1),
    "MJ": (1, 1),
    "K": (1, -1),
    "LP": (0, 1),
    "GAP": (0, 1),
    "AMPLITUDE": (0, 1),
}


def times(text, item, factor):
    """A deck with all values of an item multiplied."""
    return re.sub(rf" {item}=([0-9.E]+)", lambda x: f" {item}={factor * float(x[1]):.6g}", text)


def in_units(units, force, metre):
    """The frames in other units, so many of which are a kN and a metre."""
    text = changed(FRAMES, scaled(nodes(), metre))
    for item, (f, m) in DIMENSIONS.items():
        text = times(text, item, force**f * metre**m)
    for weight in (240, 300):
        text = text.replace(f" {weight}\n", f" {force * weight:g}\n")
    return f"UNITS {units}\n{text}"


def changed(text, changes):
    """The deck with some of its lines replaced."""
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def told(text, changes=()):
    """What `check` says of a deck with some of its lines replaced."""
    model, found, files = read_text(changed(text, changes), catalog())
    try:
        found = assembled(Request("model.inp"), model, found, files).warnings
    except DeckError as err:
        found = err.diagnostics
    return [f"{d.code} {d.message}: {d.hint}" for d in found]


@pytest.mark.parametrize("deck", [FRAMES, STOREYS], ids=["frames", "storeys"])
def test_the_sound_decks_have_no_remark(deck):
    assert not told(deck)


@pytest.mark.parametrize("deck", SOUND, ids=lambda p: p.stem)
def test_sound_decks_of_unusual_structures_have_no_remark(deck):
    """Written by someone who did not know what is told."""
    assert not prepare(Request(str(deck))).warnings


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_the_frames(mistake):
    changes, words = MISTAKES[mistake]
    found = told(FRAMES, changes)
    assert any(words in remark for remark in found), found


@pytest.mark.parametrize("mistake", STOREY_MISTAKES)
def test_a_mistake_in_the_storeys(mistake):
    changes, words = STOREY_MISTAKES[mistake]
    found = told(STOREYS, changes)
    assert any(words in remark for remark in found), found


@pytest.mark.parametrize("units", [("N mm s", 1e3, 1e3), ("kip in s", 0.224809, 39.3701)])
def test_the_frames_in_other_units_have_no_remark(units):
    assert not told(in_units(*units))


@pytest.mark.parametrize(
    "changes",
    [
        [("E=25E6 A=0.18", "E=25E6 A=1E4")],
        [(HINGES, "")],
        [("A=0.25 I=0.0052", "A=1.2 I=3.6"), (HINGES, "")],
        [("E=25E6 A=0.18 I=0.0054", "E=200E6 A=0.0116 I=4.8E-4")],
        [
            (HINGES, "PIN=BOTH"),
            ("PROPS\n", " 27 BRACE 21 25\n 28 BRACE 22 26\nPROPS\n BRACE FRAME E=200E6 A=2E-3\n"),
        ],
        [(" 22 6.45 3.5", " 22 6.45 3.5 SLAVED=X MASTER=25")],
        [("MI=200 MJ=200 LP=0.25", "MI=200 MJ=200 KH=1E9 DUCTU=1E4")],
        [("GAP=0.03", "GAP=0.6")],
        SPLIT,
        [*SPLIT, *PLASTIC, *ONE_HINGE],
        [*SPLIT, *PLASTIC, ("ELASTO_PLASTIC", "BILINEAR R=1E-3")],
        [
            *SPLIT,
            *PLASTIC,
            ("MI=400 MJ=400", "MI=400,-300 MJ=400,-300"),
            ("27 PIER 27 22", "27 PIER 22 27"),
        ],
        [("HISTORY 10", "HISTORY 0.1 METHOD=NEWMARK DT=0.02")],
        [
            ("ELEMENTS", " 17 0 7\n 18 6 7\nELEMENTS\n 17 JOINT 13 17\n 18 JOINT 16 18"),
            ("16 BEAM 13 16", "16 BEAM 17 18"),
            ("PROPS", "PROPS\n JOINT SPRING KX=1E7 KY=1E7 KR=1E5"),
        ],
        [
            (RIGHT_FOOT, " 21 6.45 0\n 27 6.45 0 FIX=XYR"),
            ("31 HIT", "30 FOOT 21 27\n 31 HIT"),
            ("PROPS", "PROPS\n FOOT FOUNDATION G=40000 NU=0.3 WGT=18 B=1.2 L=1.2 UPLIFT=YES"),
            (" 24 12.45 0 FIX=XYR", " 24 12.45 0\n 28 12.45 0 FIX=XYR"),
            ("31 HIT", "29 FOOT 24 28\n 31 HIT"),
        ],
        [("EQUAKE", "LOADS\n 12,13 0 10\n 15,16 0 -20\nEQUAKE")],
    ],
    ids=[
        "beams without axial deformation",
        "elastic",
        "walls",
        "steel beams",
        "braced",
        "diaphragm",
        "rigid-plastic hinges",
        "gap of a sweep",
        "column in two pieces",
        "hinge on one side of a node within a column",
        "hinges that harden on both sides of a node within a column",
        "hinges of other strengths on both sides of a node within a column",
        "first few steps",
        "joints of no length",
        "footings that lift, between two nodes",
        "loads of wind",
    ],
)
def test_frames_that_can_be_meant(changes):
    assert not told(FRAMES, changes)


def test_mistakes_are_told_where_contacts_cannot_be_built():
    changes = [(" 12,13,15,16 240\n 22,23,25,26 300", " 12,15 480\n 22,25 600")]
    codes = {message.split()[0] for message in told(FRAMES, changes)}
    assert codes == {"P330", "P347"}  # E needs masses that collide; a roof has none


def test_what_is_meant_is_not_told():
    changes, words = MISTAKES["drift downwards"]
    code, other = words.split()[0], MISTAKES["beam forgotten"]
    both = [*changes, *other[0]]
    assert len(told(FRAMES, both)) == 2
    assert told(f"MEANT {code}\n{FRAMES}", both) == told(FRAMES, other[0])
    assert not told(f"MEANT P375,{code}\n{FRAMES}", both)


def test_no_error_is_meant():
    unknown = told(f"MEANT P330\n{FRAMES}")
    assert len(unknown) == 1 and unknown[0].startswith("P210 MEANT cannot be P330")


@pytest.mark.parametrize(
    "changes",
    [
        [("KX=60000 RULE=BILINEAR R=0.05 FX=500", "KX=1E9")],
        [("KX=30000 RULE=BILINEAR R=0.05 FX=300", "KX=600")],
        [("FX=300", "FX=20")],
        [("FX=300", "FX=4000")],
    ],
    ids=["rigid neighbour", "isolated", "sliding", "strong"],
)
def test_storeys_that_can_be_meant(changes):
    assert not told(STOREYS, changes)


def test_frequencies_in_hz_are_compared_with_the_building_that_the_card_names():
    """Not with its neighbour, which is far slower here."""
    slow = ("12,13,15,16 240", "12,13,15,16 3000")
    damping = ("RAYLEIGH XI=0.05 MODES=1,3", 'RAYLEIGH XI=0.05 OMEGA=1.9,6 BUILDING="building 2"')
    said = [line for line in told(FRAMES, [slow, damping]) if "OMEGA=" in line]
    assert said and "P373 OMEGA=1.9,6 is below the first mode, about 13.7 rad" in said[0]


def test_two_mistakes_of_one_hinge_are_both_told():
    changes = [("MI=200 MJ=200 LP=0.25", "MI=200 MJ=200 LP=2"), ("R=0.03 MI=200", "R=0.3 MI=200")]
    said = [line for line in told(FRAMES, changes) if line.startswith("P355")]
    assert len(said) == 2 and "the hinges of COL" in said[0] and "R=0.3" in said[1]
