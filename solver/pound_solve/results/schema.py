"""Every table and history of a results file: names, columns, units, order.

This is the one list that the writer checks against, that the report prints, and that the manual's page is
made from.  Units are dimensions of the deck's own units (``F``, ``L``, ``T``, ``rad``, ``%``; ``-`` a pure
number, empty where units mean nothing); :meth:`pound_deck.model.Units.text` turns them into the deck's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

FORMATS: Final = MappingProxyType(
    {
        "int": "int64",
        "text": "text",
        "time": "float64",
        "num": "float64",
        "short": "float64",
        "percent": "float64",
    }
)  #: how a column is printed, and how it is stored


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    name : str
        Field of the compound dataset.
    head : str
        Head in the report; its line breaks are kept.  Empty stands for the name.
    unit : str
        Dimensions, see the module's head.
    fmt : str
        One of `FORMATS`: ``time`` shows up to six decimals, ``num`` seven significant digits,
        ``short`` five, ``percent`` two to four decimals.
    doc : str
        What the column holds, for the manual.
    zero : str
        What the report prints for 0 in an ``int`` column where 0 means something else than a number.
    clip : int
        Number of characters that the report prints of a text; 0 for all.
    """

    name: str
    head: str = ""
    unit: str = ""
    fmt: str = "text"
    doc: str = ""
    zero: str = ""
    clip: int = 0

    @property
    def is_text(self) -> bool:
        """Whether the column holds text."""
        return self.fmt == "text"

    @property
    def title(self) -> str:
        """Head of the column, which may have several lines."""
        return self.head or self.name.replace("_", " ")


@dataclass(frozen=True, slots=True)
class Table:
    """One table of the report.

    Parameters
    ----------
    name : str
        Dataset below ``/tables``.
    title : str
        Heading; the report prints it in capitals.
    columns : tuple of Column
        In order of storing and printing.
    note : str
        A sentence or two on how to read the table.
    group : str
        Column by whose values the report sorts rows into blocks (order within a block is kept), each with
        number formats of its own; empty for one block.
    limit : int
        The report prints that many rows at most; 0 for all.
    """

    name: str
    title: str
    columns: tuple[Column, ...]
    note: str = ""
    group: str = ""
    limit: int = 0


@dataclass(frozen=True, slots=True)
class History:
    """One dataset below ``/history``.

    Parameters
    ----------
    name : str
        Path below ``/history``.
    row : str
        What one row (one instant) holds, for the manual.
    doc : str
        What the numbers are, for the manual.
    """

    name: str
    row: str
    doc: str


# Columns that many tables share.
_NODE = Column("node", fmt="int", doc="node number")
_ELEMENT = Column("element", fmt="int", doc="element number")
_ITEM = Column("item", doc="what the value is")
_VALUE = Column("value", doc="value with its unit, as text")
_DEFAULT = Column("default", " ", doc="`*` where the deck leaves the item to its default")
_UNIT = Column("unit", doc="unit of the numbers in this row")
_CONTACT = Column("contact", doc="number or name of the contact element")
_MOTION = Column("motion", doc="name of the ground motion")


def _time(name: str, head: str, doc: str) -> Column:
    return Column(name, head, "T", "time", doc)


def _extremes(unit: str) -> tuple[Column, ...]:
    """Largest and smallest value with their times."""
    return (
        Column("max", "max", unit, "num", "largest value"),
        _time("t_max", "at time", "time of the largest value"),
        Column("min", "min", unit, "num", "smallest value"),
        _time("t_min", "at time", "time of the smallest value"),
    )


_INPUT = (
    Table(
        "options",
        "Analysis options and parameters",
        (
            _ITEM,
            Column("value", doc="value in the deck's words and units"),
            _DEFAULT,
            Column("meaning", doc="the option spelled out"),
        ),
    ),
    Table(
        "nodes",
        "Nodes",
        (
            _NODE,
            Column("x", "X", "L", "num", "coordinate"),
            Column("y", "Y", "L", "num", "coordinate"),
            Column("fixed", "fixed", doc="directions held at the ground, out of `XYR`"),
            Column("slaved", "slaved", doc="directions that follow the master node"),
            Column("master", "master", fmt="int", doc="master node, 0 for none", zero="-"),
        ),
        note="X and Y are translations, R is the rotation (positive counter-clockwise).",
    ),
    Table(
        "elements",
        "Elements",
        (
            _ELEMENT,
            Column("name", doc="name in the deck, if any"),
            Column("property", doc="property set"),
            Column("kind", doc="kind of element"),
            Column("i", "node I", fmt="int", doc="first node"),
            Column("j", "node J", fmt="int", doc="second node, 0 for the ground or a wall", zero="ground"),
            Column("length", "length", "L", "num", "distance between the nodes"),
        ),
    ),
    Table(
        "properties",
        "Property sets",
        (
            Column("property", doc="property set"),
            Column("kind", doc="kind of element, rule or law that the item belongs to"),
            _ITEM,
            Column("value", doc="value in the deck's units"),
            Column("unit", doc="unit of the value"),
            _DEFAULT,
        ),
        group="property",
    ),
    Table(
        "masses",
        "Lumped masses",
        (
            _NODE,
            Column("mx", "X", "F*T^2/L", "num", "mass in X"),
            Column("my", "Y", "F*T^2/L", "num", "mass in Y"),
            Column("mr", "R", "F*L*T^2", "num", "rotational inertia"),
        ),
    ),
    Table(
        "loads",
        "Nodal loads",
        (
            _NODE,
            Column("fx", "force X", "F", "num", "force in X"),
            Column("fy", "force Y", "F", "num", "force in Y"),
            Column("mz", "moment", "F*L", "num", "moment"),
        ),
    ),
    Table("member_loads", "Member loads", (_ELEMENT, Column("load", doc="the load in words"))),
    Table(
        "damping",
        "Damping",
        (
            Column("group", doc="part of the structure"),
            Column("kind", doc="damping model"),
            Column("description", doc="coefficients, and what they multiply"),
        ),
    ),
    Table(
        "contact_laws",
        "Contacts",
        (
            _CONTACT,
            Column("law", doc="contact law"),
            Column("k", "stiffness", doc="stiffness with its unit (which depends on the law)"),
            Column("c", "c", "F*T/L", "short", "damping coefficient"),
            Column("xi", "damping\nratio", "-", "short", "damping ratio or the law's damping constant"),
            Column(
                "e_asked",
                "e asked",
                "-",
                "short",
                "restitution that the deck asks for; NaN where it gives none",
            ),
            Column(
                "e_given", "e given", "-", "short", "restitution that the law gives with these constants"
            ),
            Column(
                "mass", "reduced\nmass", "F*T^2/L", "short", "mass of the colliding pair, m1 m2 / (m1 + m2)"
            ),
            Column("angle", "angle", "deg", "short", "direction in which node I meets J, from global x"),
            Column("gap", "gap", "L", "num", "initial gap"),
            Column("note", doc="remarks on the law's constants"),
        ),
        note="e is the coefficient of restitution.",
    ),
    Table(
        "diaphragms",
        "Diaphragms that meet",
        (
            _CONTACT,
            Column("side", doc="`I` or `J`: which node of the contact the diaphragm stands behind"),
            Column("mass", "mass m", "F*T^2/L", "short", "total mass; infinite for a wall"),
            Column("stiffness", "stiffness\nkD", "F/L", "short", "axial stiffness; NaN for a rigid one"),
            Column("impedance", "impedance\nZ", "F*T/L", "short", "sqrt(kD m); NaN for a rigid one"),
            Column(
                "period",
                "collision\nperiod T",
                "T",
                "short",
                "2 sqrt(m / kD); NaN for a rigid one or a wall",
            ),
            Column(
                "alpha_lumped",
                "alpha\nlumped",
                "-",
                "short",
                "influence coefficient of lumped masses: the change of velocity over twice the approach "
                "velocity, of an elastic collision",
            ),
            Column("alpha_paper", "alpha\npaper", "-", "short", "of distributed masses, Cole et al. 2011"),
            Column("alpha_exact", "alpha\nexact", "-", "short", "of distributed masses, exact"),
        ),
        note="As found behind the contact's nodes, or by DIAPHRAGMS of its card.",
    ),
    Table(
        "collision_theory",
        "What collisions of these diaphragms do",
        (
            _CONTACT,
            Column(
                "e_paper", "e_eff\npaper", "-", "short", "effective restitution, Eq 14 of Cole et al. 2011"
            ),
            Column("e_exact", "e_eff\nexact", "-", "short", "effective restitution, exact"),
            Column("duration", "duration", "T", "short", "how long the bars are in contact, exact"),
            Column(
                "force", "force per\nspeed", "F*T/L", "num", "contact force for an approach speed of one"
            ),
            Column(
                "lumped_error",
                "lumped\nerror",
                "%",
                "percent",
                "error of the changes of velocity with lumped masses: (1 + e) / (1 + e_eff exact) - 1",
            ),
            Column(
                "note", doc="whether the paper's equations hold, and whether lumped mass is good enough"
            ),
        ),
        note="The theory is that of uniform elastic bars that meet end to end.",
    ),
)

_GROUND = (
    Table(
        "motions",
        "Ground motions",
        (
            _MOTION,
            Column(
                "direction", "dir.", doc="direction of the motion; a turn is in radians in place of lengths"
            ),
            Column("supports", doc="supports that it moves"),
            Column("format", doc="format of the record"),
            Column(
                "points", fmt="int", zero="-", doc="number of points read, 0 for a motion that is no record"
            ),
            Column("dt", "step", "T", "short", "time step of the record"),
            Column("scale", "scale", "-", "short", "factor on the record"),
            Column("pga", "peak\naccel.", "L/T^2", "short", "largest absolute acceleration, scaled"),
            _time("t_pga", "at time", "time of the largest acceleration"),
            Column("pgv", "peak\nvelocity", "L/T", "short", "largest absolute velocity, scaled"),
            Column("pgd", "peak\ndisp.", "L", "short", "largest absolute displacement, scaled"),
            _time("start", "start", "time at which the record starts"),
            _time("end", "end", "time at which the motion ends"),
            Column("sha256", doc="checksum of the record's file", clip=12),
        ),
        note="Peaks are those of the whole motion, from start to end, even if the history is shorter. "
        "Velocity and displacement are integrals of the record as it stands, without baseline correction. "
        "The checksum is cut to its first 12 characters.",
    ),
    Table(
        "forces",
        "Forces in time",
        (
            Column("force", doc="number in the deck and kind or name of its history"),
            Column("nodes", doc="nodes that get it"),
            Column("fx", "force X", "F", "num", "force in X for a history of one"),
            Column("fy", "force Y", "F", "num", "force in Y for a history of one"),
            Column("mz", "moment", "F*L", "num", "moment for a history of one"),
            Column("peak", "peak", "-", "short", "value of the history that is farthest from zero"),
            _time("t_peak", "at time", "time of that value"),
            _time("end", "end", "time at which the history ends"),
        ),
        note="Each node gets the force times the history.",
    ),
)

_SCENE = (
    Table(
        "scene",
        "What this analysis needs",
        (
            Column("subject", doc="part of the analysis"),
            Column("decision", doc="what is done, or left out"),
            Column("why", doc="reason"),
        ),
    ),
    Table("size", "Problem size", (_ITEM, _VALUE)),
    Table(
        "arrays",
        "Arrays that are held",
        (
            Column("part", doc="what the arrays belong to"),
            Column("what", doc="what they hold"),
            Column("numbers", fmt="int", doc="numbers in them; of sparse matrices those that are stored"),
            Column("bytes", fmt="int", doc="memory, indices of sparse matrices included"),
        ),
        note="Work arrays of a method, of the order of these, are not counted.",
    ),
)

_STATIC = (
    Table(
        "static_displacement",
        "Static displacements",
        (
            _NODE,
            Column("x", "X", "L", "num", "displacement"),
            Column("y", "Y", "L", "num", "displacement"),
            Column("r", "R", "rad", "num", "rotation"),
        ),
    ),
    Table(
        "static_force",
        "Static element forces",
        (
            _ELEMENT,
            Column("quantity", doc="name of the force"),
            Column("value", fmt="num", doc="force or moment"),
            _UNIT,
        ),
    ),
    Table(
        "reactions",
        "Support reactions",
        (
            _NODE,
            Column("fx", "force X", "F", "num", "force of the support on the structure"),
            Column("fy", "force Y", "F", "num", "force of the support on the structure"),
            Column("mz", "moment", "F*L", "num", "moment of the support on the structure"),
        ),
        note="Forces of the supports on the structure.",
    ),
    Table(
        "equilibrium",
        "Equilibrium of the static state",
        (
            _ITEM,
            Column("fx", "force X", "F", "num", "sum of the forces in X"),
            Column("fy", "force Y", "F", "num", "sum of the forces in Y"),
            Column("mz", "moment", "F*L", "num", "sum of the moments about the origin"),
        ),
        note="All that acts on the structure, moments about the origin of the coordinates.",
    ),
    Table("static_run", "Course of the static analysis", (_ITEM, _VALUE)),
)

_MODAL = (
    Table(
        "modes",
        "Natural modes",
        (
            Column("mode", fmt="int", doc="number, lowest frequency first"),
            Column("omega", "circular\nfrequency", "rad/T", "short", "circular frequency"),
            Column("frequency", "frequency", "1/T", "short", "cycles per unit of time"),
            Column("period", "period", "T", "short", "period"),
            Column("damping", "damping", "%", "percent", "fraction of critical damping"),
            Column("gamma_x", "particip.\nX", "", "short", "participation factor, ground motion in X"),
            Column("mass_x", "eff. mass\nX", "F*T^2/L", "short", "effective mass in X"),
            Column("share_x", "share\nX", "%", "percent", "effective mass over the moving mass in X"),
            Column("gamma_y", "particip.\nY", "", "short", "participation factor, ground motion in Y"),
            Column("mass_y", "eff. mass\nY", "F*T^2/L", "short", "effective mass in Y"),
            Column("share_y", "share\nY", "%", "percent", "effective mass over the moving mass in Y"),
        ),
        note="Participation factors belong to modes of unit modal mass: "
        "their squares are the effective masses.",
    ),
    Table(
        "mode_shapes",
        "Mode shapes",
        (
            Column("mode", fmt="int", doc="number of the mode"),
            _NODE,
            Column("x", "X", "-", "num", "translation"),
            Column("y", "Y", "-", "num", "translation"),
            Column("r", "R", "rad/L", "num", "rotation"),
        ),
        note="Scaled to a largest translation of 1.",
        group="mode",
        limit=2000,
    ),
)

_PUSHOVER = (
    Table("pushover", "Pushover", (_ITEM, _VALUE)),
    Table(
        "push_pattern",
        "Pattern of the pushing forces",
        (
            _NODE,
            Column("direction", "dir.", doc="`X`, `Y` or `R`"),
            Column("first", "at the start", "", "num", "force or moment for a load factor of one"),
            Column("last", "at the end", "", "num", "force or moment for a load factor of one"),
        ),
        note="For a load factor of one. Forces on slaved degrees of freedom stand at their masters.",
    ),
    Table(
        "capacity_curve",
        "Capacity curve",
        (
            Column("displacement", "control\ndispl.", "L", "num", "displacement of the control node"),
            Column("base_shear", "base\nshear", "F", "num", "force on the ground"),
            Column("factor", "load\nfactor", "-", "num", "factor on the pattern"),
            Column("events", fmt="int", doc="changes of springs, hinges and contacts so far"),
        ),
        note="Displacements and base shears hold those of the static state.",
        limit=500,
    ),
    Table(
        "push_events",
        "Events of the pushover",
        (
            Column("event", fmt="int", doc="number"),
            Column("displacement", "control\ndispl.", "L", "num", "displacement of the control node"),
            Column("base_shear", "base\nshear", "F", "num", "force on the ground"),
            Column("factor", "load\nfactor", "-", "num", "factor on the pattern"),
            _ELEMENT,
            Column("component", "comp.", doc="spring, hinge or contact of the element"),
            Column("before", "from", doc="branch that it left"),
            Column("after", "to", doc="branch that it is on now"),
        ),
        limit=1000,
    ),
)

_ENVELOPES = (
    Table(
        "drift_envelope",
        "Drift envelopes",
        (
            Column("name", "drift", doc="name in the deck"),
            *_extremes("L"),
            Column(
                "height", "height", "L", "short", "distance over which the drift is taken, NaN for none"
            ),
            Column("ratio_max", "largest\nratio", "-", "short", "largest absolute drift over the height"),
        ),
    ),
    Table(
        "node_envelope",
        "Node envelopes",
        (
            _NODE,
            Column("direction", "dir.", doc="`X`, `Y` or `R`"),
            Column("quantity", doc="`displacement`, `velocity` or `acceleration`"),
            _UNIT,
            *_extremes(""),
        ),
        group="quantity",
    ),
)

_MEMBERS = (
    Table(
        "member_envelope",
        "Member envelopes",
        (_ELEMENT, Column("quantity", doc="name of the force"), _UNIT, *_extremes("")),
    ),
    Table(
        "spring_envelope",
        "Spring envelopes",
        (
            _ELEMENT,
            Column("component", "comp.", doc="`X`, `Y` or `R` of a spring, `hinge I`, ... of a member"),
            Column("rule", doc="hysteresis rule"),
            Column("unit", "unit of\nforce", doc="unit of the forces in this row"),
            Column("force_max", "largest\nforce", "", "short", "largest force or moment"),
            Column("force_min", "smallest\nforce", "", "short", "smallest force or moment"),
            Column("deformation_unit", "unit of\ndeform.", doc="unit of the deformations in this row"),
            Column("deformation_max", "largest\ndeform.", "", "short", "largest deformation"),
            Column("deformation_min", "smallest\ndeform.", "", "short", "smallest deformation"),
            Column(
                "yield_events",
                "yield\nevents",
                fmt="int",
                doc="number of times that the spring started to yield",
            ),
            Column(
                "ductility",
                "ductility",
                "-",
                "short",
                "largest absolute deformation over yield, NaN for none",
            ),
            Column("plastic_work", "plastic\nwork", "F*L", "short", "energy lost in hysteresis"),
        ),
    ),
    Table(
        "spring_plastic",
        "Plastic deformation of springs",
        (
            _ELEMENT,
            Column("component", "comp.", doc="as in the spring envelopes"),
            Column("unit", doc="unit of the deformations in this row"),
            Column("last", "at the\nend", "", "short", "deformation at the end"),
            Column(
                "residual",
                "residual",
                "",
                "short",
                "left when the force is taken off; NaN for a run that stopped",
            ),
            Column("path", "plastic\npath", "", "short", "plastic work over the yield force"),
            Column("path_ratio", "path over\nyield", "-", "short", "path over the deformation at yield"),
        ),
        note="Springs that have lost energy. The plastic path is the plastic work over the mean of both "
        "yield forces: the sum of all plastic deformations of an elastic, perfectly plastic spring.",
    ),
    Table(
        "damage",
        "Damage index of Park and Ang",
        (
            Column("element", fmt="int", doc="element number, 0 for the whole structure", zero="all"),
            Column("component", "comp.", doc="as in the spring envelopes"),
            Column("ultimate", "ultimate\nductility", "-", "short", "of the side that counts"),
            Column("ductility", "ductility", "-", "short", "largest of that side"),
            Column("by_deformation", "by\ndeform.", "-", "short", "largest over ultimate deformation"),
            Column(
                "by_energy",
                "by\nenergy",
                "-",
                "short",
                "beta times plastic work, over yield force times ultimate deformation",
            ),
            Column("index", "index", "-", "short", "the sum of both"),
            Column("weight", "weight", "-", "short", "share of the plastic work of all rows"),
        ),
        note="1 is failure; beyond about 0.4 a member is not worth repair. All: the mean by the weights.",
    ),
)

_CONTACTS = (
    Table(
        "contact_summary",
        "Contact summary",
        (
            _CONTACT,
            Column("closures", fmt="int", doc="number of collisions"),
            Column("peak_force", "peak\nforce", "F", "num", "largest compression"),
            _time("t_peak", "at time", "time of the largest compression"),
            Column("peak_penetration", "peak\npenetration", "L", "short", "largest overlap"),
            Column("impulse", "impulse", "F*T", "short", "integral of the force over time"),
            Column("energy_lost", "energy\nlost", "F*L", "short", "energy dissipated in the contact"),
            Column("min_gap", "smallest\ngap", "L", "short", "smallest gap, negative while in contact"),
            Column("time_closed", "time\nclosed", "T", "short", "sum of the durations of all collisions"),
        ),
        note="Compression is positive.",
    ),
    Table(
        "collisions",
        "Collisions",
        (
            _CONTACT,
            _time("t_start", "closes", "time of closing"),
            _time("t_end", "opens", "time of opening; NaN when still closed at the end"),
            Column(
                "approach_velocity", "approach\nvelocity", "L/T", "short", "relative velocity at closing"
            ),
            Column(
                "separation_velocity",
                "separation\nvelocity",
                "L/T",
                "short",
                "relative velocity at opening",
            ),
            Column("restitution", "restitution", "-", "short", "separation over approach velocity"),
            Column("peak_force", "peak\nforce", "F", "num", "largest compression"),
            _time("t_peak", "at time", "time of the largest compression"),
            Column("impulse", "impulse", "F*T", "short", "integral of the force over time"),
            Column(
                "plateau_force",
                "plateau\nforce",
                "F",
                "short",
                "impulse over the duration, or over the shorter time that the predicted force would take "
                "for the predicted impulse (where contact lasts up to twice as long as predicted): of a "
                "coarse mesh it may exceed the peak; NaN when still closed at the end",
            ),
            Column(
                "predicted_force",
                "predicted\nforce",
                "F",
                "short",
                "first force of the diaphragms at this approach velocity, Eq 11 of Cole et al. 2011; NaN "
                "where contact lasts more than twice as long as predicted",
            ),
            Column("force_error", "error", "%", "percent", "predicted over peak force, less one"),
        ),
        note="Both velocities are positive for bodies that approach before and part after. "
        "Restitution is that of the law only where nothing else acts on the bodies during the collision.",
        limit=100,
    ),
)

_ENERGY = (
    Table(
        "energy",
        "Energy at the end",
        (
            _ITEM,
            Column("value", "energy", "F*L", "num", "energy or work"),
            Column("share", "of input", "%", "percent", "share of the energy put in"),
        ),
    ),
    Table(
        "checks",
        "Checks of this run",
        (
            Column("check", doc="what was checked"),
            Column("value", doc="what was found"),
            Column("verdict", doc="whether that is good enough"),
        ),
    ),
    Table("run", "Course of the run", (_ITEM, _VALUE)),
)

_FIGURES = (
    Table(
        "run_figures",
        "Time, memory, versions",
        (_ITEM, _VALUE),
        note="Only this last section differs between two runs of the same deck.",
    ),
    Table(
        "imports",
        "Modules and kernels of this process",
        (
            Column("part", doc="package of the program, or library"),
            Column("modules", fmt="int", doc="number of its modules that are imported, or of kernels"),
            Column("which", doc="names of the program's own modules"),
        ),
    ),
)

_STUDY = (
    Table(
        "study",
        "Error and time of every run",
        (
            Column("method", doc="method of HISTORY"),
            Column("setting", doc="its step or tolerance as a deck has it"),
            Column("seconds", "time to\nsolve [s]", "", "short", "median of the repeats"),
            Column("steps", fmt="int", zero="-", doc="steps taken"),
            Column("events", fmt="int", doc="changes of springs and contacts that were located"),
            Column("drift", "drifts", "-", "short", "error of the drifts, else of displacements"),
            Column("member", "member\nforces", "-", "short", "error of forces of members and springs"),
            Column("contact", "contact\nforces", "-", "short", "error of the peak contact forces"),
            Column("order", "order", "-", "short", "of the largest of the three, against the row above"),
            Column("collisions", "colli-\nsions", fmt="int", doc="number of collisions"),
            Column("residual", "energy\nresidual", "-", "short", "largest, over the largest energy"),
        ),
        note="An error is the largest difference of an extreme from that of the reference, over the "
        "largest extreme of that kind.",
        group="method",
    ),
    Table(
        "study_stops",
        "Runs that did not come to their end",
        (
            Column("method", doc="method of HISTORY"),
            Column("setting", doc="its step or tolerance"),
            Column("why", doc="message of the run"),
        ),
    ),
    Table(
        "study_advice",
        "Least time for an error",
        (
            Column("target", "largest\nerror", "-", "short", "error that must be met"),
            Column("method", doc="method of HISTORY; empty where no run is sure to meet it"),
            Column("setting", doc="its step or tolerance"),
            Column("seconds", "time to\nsolve [s]", "", "short", "of that run"),
            Column("error", "error\nfound", "-", "short", "largest error of that run"),
            Column("sure", "error\nallowed for", "-", "short", "the same with the margin of the advice"),
        ),
    ),
)

_PARTS = (
    ("Input", _INPUT),
    ("Ground motion", _GROUND),
    ("Scene and problem size", _SCENE),
    ("Static analysis", _STATIC),
    ("Free vibration", _MODAL),
    ("Pushover", _PUSHOVER),
    ("Envelopes of the time history", _ENVELOPES),
    ("Members and springs", _MEMBERS),
    ("Contacts and collisions", _CONTACTS),
    ("Energy and checks", _ENERGY),
    ("Run figures", _FIGURES),
    ("Error against time", _STUDY),
)

#: Sections of the report: heading, names of the tables.  A section's number is its place here.
SECTIONS: Final = tuple((heading, tuple(t.name for t in tables)) for heading, tables in _PARTS)

#: Every table by name, in the order of the report.
TABLES: Final[Mapping[str, Table]] = MappingProxyType({t.name: t for _, tables in _PARTS for t in tables})

#: Columns of ``/history/energy``.
ENERGIES: Final = ("input", "kinetic", "strain", "damping", "hysteretic", "contact", "residual")

#: Every history by its path below ``/history``.
HISTORIES: Final[Mapping[str, History]] = MappingProxyType(
    {
        h.name: h
        for h in (
            History("time", "one number", "the time axis that all histories share"),
            History("node/u", "nodes x 3", "displacement in X, Y and rotation"),
            History("node/v", "nodes x 3", "velocity in X, Y and of rotation"),
            History("node/a", "nodes x 3", "acceleration in X, Y and of rotation"),
            History("member/force", "quantities", "forces and moments of the members"),
            History("member/deformation", "quantities", "deformations of the members"),
            History("contact/gap", "contacts", "gap, negative while in contact"),
            History("contact/force", "contacts", "contact force, positive in compression"),
            History("spring/force", "components", "forces and moments of the springs"),
            History("spring/deformation", "components", "deformations of the springs"),
            History("drift", "drifts", "drifts in the order of the deck"),
            History("ground", "motions", "ground accelerations, scaled"),
            History("force", "forces", "histories of FORCES, in the order of the deck"),
            History("energy", "7 columns", "cumulative energies: " + ", ".join(ENERGIES)),
        )
    }
)


def results_page() -> str:
    """Part of ``manual/results.md`` that lists all tables and histories, as Markdown."""
    out = ["## Tables", ""]
    for number, (heading, tables) in enumerate(_PARTS, 1):
        out += [f"### {number} {heading}", ""]
        for table in tables:
            out += [f"#### `{table.name}`: {table.title.lower()}", ""]
            out += [table.note, ""] if table.note else []
            out += ["| column | stored as | unit | meaning |", "|---|---|---|---|"]
            for c in table.columns:
                unit = f"`{c.unit}`" if c.unit else ""
                meaning = c.doc or c.title.replace("\n", " ")
                out.append(f"| `{c.name}` | {FORMATS[c.fmt]} | {unit} | {meaning} |")
            out.append("")
    out += ["## Histories", "", "| dataset | one row | meaning |", "|---|---|---|"]
    out += [f"| `/history/{h.name}` | {h.row} | {h.doc} |" for h in HISTORIES.values()]
    return "\n".join(out) + "\n"
