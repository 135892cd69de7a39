"""Names of a deck's sections and cards, and the Specs of those that are not a plug-in family of the solver.

NODES, ELEMENTS, WEIGHTS, LOADS, MEMBER_LOADS, INITIAL, DRIFT, BUILDINGS and OUTPUT have one kind of line
each, given here.  PROPS, DAMPING, EQUAKE, FORCES and ANALYSIS hold cards of the families ``element``,
``damping``, ``motion``, ``force`` and ``analysis``.  TITLE, UNITS and the other `CARDS` belong to no
section.
"""

from __future__ import annotations

from functools import partial
from typing import Final

from pound_deck.messages import WARNINGS
from pound_deck.schema import Field, Kind, Spec

#: a field by position that steps along with the ranges of its card
_step = partial(Field, positional=True, varies=True)

SECTIONS: Final = (
    Spec(
        "section",
        "NODES",
        "nodes: coordinates, supports and slaved degrees of freedom",
        (
            _step("NODE", Kind.INT, doc="node number; a range generates nodes", lo=1),
            _step("X", Kind.REAL, "L", doc="horizontal coordinate; a range spaces evenly"),
            _step("Y", Kind.REAL, "L", doc="vertical coordinate, upwards; a range spaces evenly"),
            Field("FIX", Kind.FLAGS, default="", words=("XYR",), doc="fixed directions, letters of XYR"),
            Field("SLAVED", Kind.FLAGS, default="", words=("XYR",), doc="directions that follow MASTER"),
            Field(
                "MASTER",
                Kind.NODE,
                default=None,
                count=(1, 3),
                doc="node that the SLAVED directions follow, with a rigid arm; or one for each letter of "
                "SLAVED, in the order written",
            ),
        ),
    ),
    Spec(
        "section",
        "ELEMENTS",
        "elements: which property set joins which nodes",
        (
            _step("ELEMENT", Kind.INT, doc="element number; a range generates elements", lo=1),
            Field("PROP", Kind.PROP, doc="label of its property set", positional=True),
            _step("I", Kind.NODE, doc="first node"),
            _step("J", Kind.NODE, default=None, doc="second node; omitted: the ground or a wall"),
            Field("NAME", Kind.TEXT, default="", doc="name in the report"),
        ),
    ),
    Spec(
        "section",
        "WEIGHTS",
        "nodal weights; mass = weight / gravity",
        (
            Field("NODES", Kind.NODES, doc="nodes that each get this weight", positional=True),
            Field("WX", Kind.REAL, "F", doc="weight that moves along x", lo=0, positional=True),
            Field(
                "WY",
                Kind.REAL,
                "F",
                default=None,
                doc="weight that moves along y; omitted: WX",
                lo=0,
                positional=True,
            ),
            Field(
                "WR",
                Kind.REAL,
                "F*L^2",
                default=0.0,
                doc="rotational inertia times gravity",
                lo=0,
                positional=True,
            ),
        ),
    ),
    Spec(
        "section",
        "LOADS",
        "static nodal loads",
        (
            Field("NODES", Kind.NODES, doc="nodes that each get this load", positional=True),
            Field("FX", Kind.REAL, "F", default=0.0, doc="force along x", positional=True),
            Field("FY", Kind.REAL, "F", default=0.0, doc="force along y, upwards", positional=True),
            Field("MZ", Kind.REAL, "F*L", default=0.0, doc="moment, anticlockwise", positional=True),
            Field(
                "HELD",
                Kind.WORD,
                default="YES",
                words=("YES", "NO"),
                doc="NO: only in STATIC, removed suddenly when the history starts (snap-back)",
            ),
        ),
    ),
    Spec(
        "section",
        "MEMBER_LOADS",
        "static loads on members (FRAME, BEAM_COLUMN), held during the history",
        (
            Field("ELEMENTS", Kind.ELEMENTS, doc="members that each get this load", positional=True),
            Field("WX", Kind.REAL, "F/L", default=0.0, doc="uniform load along global x per member length"),
            Field("WY", Kind.REAL, "F/L", default=0.0, doc="uniform load along global y per member length"),
            Field("PX", Kind.REAL, "F", default=0.0, doc="point load along global x"),
            Field("PY", Kind.REAL, "F", default=0.0, doc="point load along global y"),
            Field(
                "AT",
                Kind.REAL,
                "-",
                default=0.5,
                doc="point load position as a fraction of the flexible length from I",
                lo=0,
                hi=1,
            ),
        ),
    ),
    Spec(
        "section",
        "INITIAL",
        "motion at the start of the history, added to the static state",
        (
            Field("NODES", Kind.NODES, doc="affected nodes", positional=True),
            Field("UX", Kind.REAL, "L", default=0.0, doc="displacement along x"),
            Field("UY", Kind.REAL, "L", default=0.0, doc="displacement along y"),
            Field("UR", Kind.REAL, "-", default=0.0, doc="rotation"),
            Field("VX", Kind.REAL, "L/T", default=0.0, doc="velocity along x"),
            Field("VY", Kind.REAL, "L/T", default=0.0, doc="velocity along y"),
            Field("VR", Kind.REAL, "1/T", default=0.0, doc="rotational velocity"),
        ),
    ),
    Spec(
        "section",
        "DRIFT",
        "storey drifts to record: displacement of J minus I",
        (
            Field("NAME", Kind.TEXT, doc="name in the report", positional=True),
            Field("I", Kind.NODE, doc="lower node", positional=True),
            Field("J", Kind.NODE, doc="upper node", positional=True),
            Field(
                "HEIGHT",
                Kind.REAL,
                "L",
                default=None,
                above=0,
                doc="storey height; omitted: from the coordinates",
            ),
            Field("DIRECTION", Kind.WORD, default="X", words=("X", "Y"), doc="direction of the drift"),
        ),
    ),
    Spec(
        "section",
        "LIMITS",
        "allowed storey drifts and plastic rotations, for the report and the pictures",
        (
            Field("NAME", Kind.TEXT, doc="name of the performance level", positional=True),
            Field(
                "DRIFT",
                Kind.REAL,
                "-",
                default=None,
                above=0,
                hi=0.5,
                doc="allowed drift over storey height: 0.02 is 2 %",
            ),
            Field(
                "ROTATION",
                Kind.REAL,
                "-",
                default=None,
                above=0,
                hi=0.5,
                doc="allowed plastic rotation of hinges [rad]",
            ),
        ),
    ),
    Spec(
        "section",
        "BUILDINGS",
        "names of buildings: parts connected other than by contacts",
        (
            Field("NAME", Kind.TEXT, doc="name in the report", positional=True),
            Field("NODES", Kind.NODES, doc="one or more of its nodes"),
            Field(
                "FLOORS",
                Kind.NODES,
                default=None,
                doc="one node of each floor; omitted: the highest level with mass, and all levels with "
                "at least a tenth of the heaviest level's mass",
            ),
        ),
    ),
    Spec(
        "section",
        "OUTPUT",
        "what is stored and printed",
        (
            Field(
                "EVERY",
                Kind.REAL,
                "T",
                default=None,
                above=0,
                doc="interval of stored histories; omitted: about 1000 rows",
            ),
            Field(
                "NODES", Kind.NODES, default=None, doc="nodes with histories and envelopes; omitted: all"
            ),
            Field(
                "MEMBERS",
                Kind.ELEMENTS,
                default=None,
                doc="elements with histories and envelopes; omitted: all",
            ),
            Field(
                "CLOSEUPS",
                Kind.REAL,
                default=4.0,
                lo=0.0,
                hi=1e5,
                doc="limit in megabytes for histories at the method's own instants while a contact is "
                "closed, and at its force peaks; 0: none",
            ),
            Field(
                "EXTREMES",
                Kind.REAL,
                default=4.0,
                lo=0.0,
                hi=1e5,
                doc="limit in megabytes for the minima and maxima between samples, or between every "
                "second, fourth, ... sample; 0: none",
            ),
            Field(
                "HISTORIES",
                Kind.WORD,
                default="YES",
                words=("YES", "PACKED", "NO"),
                doc="histories in the results file; PACKED: compressed, which takes longer; "
                "NO: times and tables only",
            ),
            Field(
                "STOREYS",
                Kind.WORD,
                default="YES",
                words=("YES", "NO"),
                doc="base shears; drifts, shears and accelerations of storeys; NO if speed matters most",
            ),
        ),
    ),
)

#: sections whose lines are cards of a family of the solver
FAMILIES: Final = {
    "PROPS": "element",
    "DAMPING": "damping",
    "EQUAKE": "motion",
    "FORCES": "force",
    "ANALYSIS": "analysis",
}
NAMES: Final = (*(spec.name for spec in SECTIONS), *FAMILIES)  #: of all sections
#: cards allowed anywhere in a deck
CARDS: Final = (
    Spec("card", "TITLE", "heading of the report"),
    Spec("card", "UNITS", "names of the units of force, length and time"),
    Spec(
        "card",
        "GRAVITY",
        "gravity",
        (Field("GRAVITY", Kind.REAL, "L/T^2", doc="acceleration", above=0, positional=True),),
    ),
    Spec(
        "card",
        "MASS",
        "mass of members",
        (
            Field(
                "MASS",
                Kind.WORD,
                doc="mass matrix of members",
                words=("LUMPED", "CONSISTENT"),
                positional=True,
            ),
        ),
    ),
    Spec(
        "card",
        "GEOMETRY",
        "displacements",
        (
            Field(
                "GEOMETRY",
                Kind.WORD,
                doc="displacement effects in equilibrium",
                words=("SMALL", "PDELTA", "PDELTA_MEMBER", "PDELTA_VARYING", "LARGE"),
                codes={"SMALL": 0, "PDELTA": 1, "LARGE": 2},
                positional=True,
            ),
        ),
    ),
    Spec(
        "card",
        "MEANT",
        "warnings to suppress",
        (
            Field(
                "MEANT",
                Kind.WORD,
                doc="codes of warnings to suppress",
                words=WARNINGS,
                count=(1, len(WARNINGS)),
                positional=True,
            ),
        ),
    ),
    Spec("card", "PARAM", "names for numbers or texts: PARAM name = value"),
    Spec("card", "INCLUDE", "reads another file here"),
    Spec("card", "END", "ends the file"),
)
SINGLE: Final = tuple(spec.name for spec in CARDS[:6])  #: cards allowed once
