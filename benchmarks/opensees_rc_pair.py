"""Two concrete frames that pound, in OpenSees: the peer's side of ``pair_rc.py``.

Four storeys and two bays beside six storeys and one bay; the roof of the first hits a column of the second
between its floors.  Every member is one force-based element, whose end sections yield over a hinge length
and whose elastic stiffness is exactly that of a beam: in OpenSees faster than a beam between two springs,
with the same answer.  Units kN, m, s, t.  Runs in the environment that ``peer_env.py`` makes and needs
nothing but OpenSeesPy and the standard library.

Prints one JSON object; drifts in m, forces in kN.
"""

import argparse
import json
import math
import os
import tempfile
import time
from typing import NamedTuple

import openseespy.opensees as ops
from opensees_cole import read_envelope, spring

G = 9.81  # gravity [m/s2]
E = 27e6  # [kN/m2]
LOAD = 30.0  # of the beams [kN/m]
GAP, STIFF = 0.02, 5e5  # opening [m] and stiffness [kN/m] of a contact
CLOSING = 2.0  # no floors approach faster [m/s]
HARDENING = 0.02
XI = 0.05  # damping ratio of modes 1 and 3, of both frames together


class Section(NamedTuple):
    """Of a member and of its hinges."""

    area: float  # [m2]
    inertia: float  # [m4]
    hinge: float  # length [m]
    sagging: float  # yield moments [kNm]
    hogging: float
    softening: float  # of unloading: Takeda's ALFA


COLUMN_A = Section(0.45**2, 0.5 * 0.45**4 / 12, 0.30, 320.0, -320.0, 0.5)
COLUMN_B = Section(0.5**2, 0.5 * 0.5**4 / 12, 0.30, 420.0, -420.0, 0.5)
BEAM_A = Section(0.3 * 0.55, 0.35 * 0.3 * 0.55**3 / 12, 0.28, 170.0, -260.0, 0.3)
BEAM_B = BEAM_A._replace(sagging=200.0, hogging=-280.0)

LEVELS = 0.0, 3.5, 6.7, 9.9, 13.1, 14.7, 17.9, 21.1  # [m]; the fifth is the roof of A
FRAMES = {  # first node: heights of the floors, places of the columns, sections
    0: (LEVELS[:5], (0.0, 6.0, 12.0), COLUMN_A, BEAM_A),
    1000: (LEVELS[:4] + LEVELS[5:], (12.0, 17.0), COLUMN_B, BEAM_B),  # the gap is in the contacts
}
HIT, HIT_WEIGHT = 1351, 8.0  # node of the column that the roof hits; moves its weight along x only [kN]
CONTACTS = (103, 1101, STIFF), (203, 1201, STIFF), (303, 1301, STIFF), (403, HIT, STIFF / 5)
DRIFTS = {  # nodes of the left columns
    f"{name}{i}": (first + 100 * i - 99, first + 100 * i + 1)
    for name, first, storeys in (("A", 0, 4), ("B", 1000, 6))
    for i in range(1, storeys + 1)
}
SWAY, CONTACT, DRIFT = 1000, 2000, 3000  # tags of springs go up from these; those of members from 0

RULES = "ELASTIC", "BILINEAR", "HYSTERETIC"
GEOMETRIES = "PDELTA", "PDELTA_VARYING"
SOLVERS = {  # system of equations, algorithm
    "BandSPD": ("BandSPD", ("Newton",)),
    "BandGeneral": ("BandGeneral", ("Newton",)),
    "ProfileSPD": ("ProfileSPD", ("Newton",)),
    "SparseSYM": ("SparseSYM", ("Newton",)),
    "UmfPack": ("UmfPack", ("Newton",)),
    "BandSPD, Krylov": ("BandSPD", ("KrylovNewton",)),
    "BandSPD, modified": ("BandSPD", ("ModifiedNewton",)),
}


def members():
    """Nodes I and J, section and ends with a hinge, of every member."""
    for first, (levels, lines, column, beam) in FRAMES.items():
        for floor in range(first + 100, first + 100 * len(levels), 100):
            for node in range(floor + 1, floor + 1 + len(lines)):
                if node == HIT + 50:
                    yield node - 100, HIT, column, "I"
                    yield HIT, node, column, "J"
                else:
                    yield node - 100, node, column, "IJ"
            for node in range(floor + 1, floor + len(lines)):
                yield node, node + 1, beam, "IJ"


def build(rule, gap, axial=()):
    """Make the model with its loads; return the number of members.

    Without `axial` P-Delta goes with the axial force of each instant.  Axial forces that are given stay:
    the side force N/L times the sway of a member is a spring between its nodes.
    """
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for first, (levels, lines, _, _) in FRAMES.items():
        weight = LOAD * (lines[1] - lines[0])
        for floor, y in enumerate(levels):
            for line, x in enumerate(lines, 1):
                node = first + 100 * floor + line
                ops.node(node, x, y)
                mass = weight * (0.5 if line in (1, len(lines)) else 1.0) / G
                if floor:
                    ops.mass(node, mass, mass, 0.0)
                else:
                    ops.fix(node, 1, 1, 1)
    ops.node(HIT, 12.0, LEVELS[4])
    ops.mass(HIT, HIT_WEIGHT / G, 0.0, 0.0)

    ops.geomTransf("Linear" if axial else "PDelta", 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for n, (i, j, section, hinges) in enumerate(members(), 1):
        (xi, yi), (xj, yj) = ops.nodeCoord(i), ops.nodeCoord(j)
        length = xj - xi + yj - yi
        integration(n, section, length, hinges, rule)
        ops.element("forceBeamColumn", n, i, j, 1, n)
        if yi == yj:
            ops.eleLoad("-ele", n, "-type", "-beamUniform", -LOAD)
        if axial:
            ops.uniaxialMaterial("Elastic", SWAY + n, axial[n - 1] / length)
            across = 2 if yi == yj else 1
            ops.element("zeroLength", SWAY + n, i, j, "-mat", SWAY + n, "-dir", across, "-doRayleigh", 0)
    for tag, (i, j, stiffness) in enumerate(CONTACTS, CONTACT + 1):
        ops.uniaxialMaterial("ElasticPPGap", tag, stiffness, -1e12, -gap)  # compression only; never yields
        spring(tag, i, j, tag, 0)
    ops.uniaxialMaterial("Elastic", DRIFT, 0.0)  # gauges; EnvelopeDrift of this version takes no lists
    for tag, (i, j) in enumerate(DRIFTS.values(), DRIFT + 1):
        spring(tag, i, j, DRIFT, 0)
    return n


def integration(n, section, length, hinges, rule):
    """Make the sections of member n, and the rule that sums them along it.

    An end section stands for the hinge length.  The points between make the sum exact up to the third
    degree, which moments under a uniform load need: two of equal weight if both ends have a hinge; if one
    has, Gauss's two, and an elastic section that takes the hinge length out at the end.
    """
    plain, hinge = 2 * n, 2 * n + 1
    ops.section("Elastic", plain, E, section.area, section.inertia)
    flexure(hinge, section, rule)
    ops.uniaxialMaterial("Elastic", hinge + 300, E * section.area)
    ops.section("Aggregator", hinge, hinge + 300, "P", hinge, "Mz")
    share = section.hinge / length
    if hinges == "IJ":
        off, weight = math.sqrt((1 / 12 - share / 2) / (1 - 2 * share)), 0.5 - share
        points = [(0.0, share, hinge), (1.0, share, hinge)]
    else:
        off, weight, end = math.sqrt(1 / 12), 0.5, float(hinges == "J")
        points = [(end, share, hinge), (end, -share, plain)]
    points += (0.5 - off, weight, plain), (0.5 + off, weight, plain)
    places, weights, sections = zip(*points)
    ops.beamIntegration("UserDefined", n, len(points), *sections, *places, *weights)


def flexure(tag, section, rule):
    """Make the law of moment and curvature of a hinge."""
    stiffness = E * section.inertia
    bends = section.sagging / stiffness, section.hogging / stiffness
    if rule == "ELASTIC":
        ops.uniaxialMaterial("Elastic", tag, stiffness)
    elif rule == "HYSTERETIC":
        far = 1000.0  # ductility where the given backbone ends
        rise = 1.0 + HARDENING * (far - 1.0)
        backbone = []
        for bend in bends:
            backbone += stiffness * bend, bend, stiffness * rise * bend, far * bend
        # neither pinching nor damage; the softer unloading is Takeda's
        ops.uniaxialMaterial("Hysteretic", tag, *backbone, 1.0, 1.0, 0.0, 0.0, section.softening)
    elif sum(bends):  # two yield moments: an elastic and a plastic law, side by side
        ops.uniaxialMaterial("Elastic", tag + 100, HARDENING * stiffness)
        ops.uniaxialMaterial("ElasticPP", tag + 200, (1 - HARDENING) * stiffness, *bends, 0.0)
        ops.uniaxialMaterial("Parallel", tag, tag + 100, tag + 200)
    else:
        ops.uniaxialMaterial("Steel01", tag, section.sagging, stiffness, HARDENING)


def equations(system, algorithm, tolerance):
    """Choose how OpenSees solves its equations."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system(system)
    ops.test("NormUnbalance", tolerance, 50, 0)
    ops.algorithm(*algorithm)


def stand():
    """Put the loads on and keep them; return the axial forces of the members."""
    equations("BandGeneral", ("Newton",), 1e-9)
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    if ops.analyze(10):
        raise SystemExit("OpenSees finds no equilibrium under the loads")
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()
    return [ops.basicForce(tag)[0] for tag in ops.getEleTags() if tag < SWAY]


def prepare(rule, gap, geometry):
    """Make the loaded, damped model; return circular frequencies before the loads, and axial forces."""
    count = build(rule, gap)
    equations("BandGeneral", ("Newton",), 1e-9)
    omegas = [math.sqrt(x) for x in ops.eigen(8)]
    ops.wipeAnalysis()
    axial = stand()
    if geometry == "PDELTA":
        build(rule, gap, axial)
        stand()
    first, third = omegas[0], omegas[2]
    alpha, beta = 2.0 * XI * first * third / (first + third), 2.0 * XI / (first + third)
    nodes = [node for node in ops.getNodeTags() if any(ops.nodeMass(node))]
    ops.region(1, "-node", *nodes, "-rayleigh", alpha, 0.0, 0.0, 0.0)
    ops.region(2, "-eleOnly", *range(1, count + 1), "-rayleigh", 0.0, 0.0, beta, 0.0)
    return omegas, axial


def march(steps, dt, gap, finer):
    """Take the steps, those in which floors may be in touch in `finer` parts each; return the status."""
    if finer == 1:
        return ops.analyze(steps, dt)
    reach = gap - CLOSING * dt
    for _ in range(steps):
        near = any(ops.nodeDisp(i, 1) - ops.nodeDisp(j, 1) > reach for i, j, _ in CONTACTS)
        if status := ops.analyze(finer, dt / finer) if near else ops.analyze(1, dt):
            return status
    return 0


def analyse(record, dt, duration, rule, gap, geometry, solver, tolerance, finer):
    """Run once and return the results as a dict; only ``march`` is timed."""
    omegas, axial = prepare(rule, gap, geometry)
    static = {node: ops.nodeDisp(node) for node in ops.getNodeTags()}
    with open(record) as file:
        step, *accelerations = map(float, file)
    ops.timeSeries("Path", 2, "-dt", step, "-values", *accelerations)
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    equations(*SOLVERS[solver], tolerance)
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")

    with tempfile.TemporaryDirectory() as folder:
        files = [os.path.join(folder, name) for name in ("drift", "force")]
        for path, first, own, what in zip(
            files, (DRIFT, CONTACT), (DRIFTS, CONTACTS), ("deformation", "basicForce")
        ):
            tags = range(first + 1, first + 1 + len(own))
            ops.recorder("EnvelopeElement", "-file", path, "-precision", 16, "-ele", *tags, what)
        used = time.process_time()
        status = march(round(duration / dt), dt, gap, finer)
        used = time.process_time() - used
        unknowns = ops.systemSize()
        ops.wipe()  # flushes the recorders
        (low, high, _), (pressed, *_) = map(read_envelope, files)

    return {
        "program": "OpenSees " + ops.version(),
        "solver": solver,
        "unknowns": unknowns,
        "omegas": omegas,
        "axial": axial,
        "static": static,
        "cpu_seconds": used,
        "status": status,
        "sane": status == 0 and all(abs(x) < 1e6 for x in [*low, *high, *pressed]),
        "drift": {name: [hi, lo] for name, hi, lo in zip(DRIFTS, high, low)},
        "peak_force": [-force for force in pressed],
    }


def main():
    """Read the command line, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("record", help="file of one column: step [s], then ground accelerations [m/s2]")
    add("--dt", type=float, default=1e-3, help="step [s]")
    add("--duration", type=float, default=20.0, help="analysed time [s]")
    add("--rule", choices=RULES, default="BILINEAR", help="of the hinges")
    add("--gap", type=float, default=GAP, help="[m]")
    add("--geometry", choices=GEOMETRIES, default="PDELTA", help="as in a deck: which axial forces count")
    add("--solver", choices=SOLVERS, default="BandSPD")
    add("--finer", type=int, default=1, help="parts of a step in which floors may be in touch")
    add("--tolerance", type=float, default=1e-4, help="unbalanced force [kN]")
    print(json.dumps(analyse(**vars(parser.parse_args()))))


if __name__ == "__main__":
    main()
