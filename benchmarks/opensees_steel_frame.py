"""The steel frames of ``examples/frames`` in OpenSees: the peer's side of ``pair_frames.py`` and of
``tests/verification/test_steel_frames.py``.

Every member is an elastic beam-column between two zero-length springs (Steel01).  Units kN, m, s, t.  Runs
in the environment that ``peer_env.py`` makes and needs nothing but OpenSeesPy and the standard library.

Prints one JSON object; lengths in m, rotations in rad.
"""

import argparse
import json
import math
import time

import openseespy.opensees as ops

G = 9.81  # gravity [m/s2]
HEIGHT, BAY = 4.0, 9.0  # [m]
FLOOR = 0.6 * 9.0 * BAY  # mass of a floor for each bay [t]
E, FY = 2.0e8, 345.0e3  # [kN/m2]
RATIO = 10.0  # hinge stiffness over 6EI/L
HARDENING = 0.02  # of a member; that of its hinge is smaller, see HINGE
HINGE = HARDENING / (1.0 + RATIO * (1.0 - HARDENING))
ZETA = 0.02  # damping ratio of modes 1 and 3

# area [m2], moment of inertia [m4], plastic modulus [m3]
COLUMN, STRONG = (0.059, 1.80e-3, 9.88e-3), (0.09, 3.00e-3, 1.45e-2)
BEAM, DEEP = (0.0179, 1.36e-3, 4.56e-3), (0.022, 1.90e-3, 6.00e-3)

# name: system of equations, algorithm
SOLVERS = {
    "BandSPD": ("BandSPD", ("Newton",)),
    "ProfileSPD": ("ProfileSPD", ("Newton",)),
    "SparseSYM": ("SparseSYM", ("Newton",)),
    "UmfPack": ("UmfPack", ("Newton",)),
    "BandSPD, Krylov": ("BandSPD", ("KrylovNewton",)),
    "ProfileSPD, Krylov": ("ProfileSPD", ("KrylovNewton",)),
    "BandSPD, modified": ("BandSPD", ("ModifiedNewton",)),
}


def joint(floor, line):
    """Number of a joint, that of the deck."""
    return 100 * floor + line


def build(storeys, bays, tall, geometry):
    """Make the model; return the hinges, ``{"101 hinge I": element, ...}``, and the elastic members."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    shares = {line: (0.5 if line in (1, bays + 1) else 1.0) * FLOOR for line in range(1, bays + 2)}
    for floor in range(storeys + 1):
        for line, mass in shares.items():
            ops.node(joint(floor, line), (line - 1) * BAY, floor * HEIGHT)
            if floor:
                ops.mass(joint(floor, line), mass, 0.0, 0.0)
            else:
                ops.fix(joint(0, line), 1, 1, 1)
    ops.geomTransf("PDelta" if geometry == "PDELTA" else "Linear", 1)
    ops.geomTransf("Linear", 2)
    hinges, members = {}, []

    def member(number, i, j, section, length, transformation):
        area, inertia, modulus = section
        material = 10 * number
        ops.uniaxialMaterial("Steel01", material, modulus * FY, RATIO * 6.0 * E * inertia / length, HINGE)
        inner = []
        for end, node in (("I", i), ("J", j)):
            own = 100_000 + 10 * number + "IJ".index(end)
            ops.node(own, *ops.nodeCoord(node))
            ops.equalDOF(node, own, 1, 2)
            ops.element("zeroLength", own, node, own, "-mat", material, "-dir", 6)
            hinges[f"{number} hinge {end}"] = own
            inner.append(own)
        ops.element(
            "elasticBeamColumn", number, *inner, area, E, inertia * (RATIO + 1.0) / RATIO, transformation
        )
        members.append(number)

    for floor in range(1, storeys + 1):
        column = STRONG if tall and floor <= storeys // 2 else COLUMN
        for line in shares:
            member(joint(floor, line), joint(floor - 1, line), joint(floor, line), column, HEIGHT, 1)
        for line in range(1, bays + 1):
            ends = joint(floor, line), joint(floor, line + 1)
            member(ends[0] + 50, *ends, DEEP if tall else BEAM, BAY, 2)

    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for floor in range(1, storeys + 1):
        for line, mass in shares.items():
            ops.load(joint(floor, line), 0.0, -mass * G, 0.0)
    return hinges, members


def equations(system, algorithm, tolerance):
    """Choose how OpenSees solves its equations."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system(system)
    ops.test("NormUnbalance", tolerance, 50, 0)
    ops.algorithm(*algorithm)


def prepare(storeys, bays, tall, geometry):
    """Build, give damping from the modes before gravity, and put gravity on."""
    hinges, members = build(storeys, bays, tall, geometry)
    equations("BandGeneral", ("Newton",), 1e-8)
    first, _, third = (math.sqrt(x) for x in ops.eigen(3))
    alpha, beta = 2.0 * ZETA * first * third / (first + third), 2.0 * ZETA / (first + third)
    nodes = [joint(floor, line) for floor in range(1, storeys + 1) for line in range(1, bays + 2)]
    ops.region(1, "-eleOnly", *members, "-rayleigh", 0.0, 0.0, beta, 0.0)
    ops.region(2, "-node", *nodes, "-rayleigh", alpha, 0.0, 0.0, 0.0)
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    if ops.analyze(10):
        raise SystemExit("OpenSees finds no equilibrium under gravity")
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()
    return hinges, 2.0 * math.pi / first


def shake(dt, accelerations, solver, tolerance, step):
    """Set the history up; `dt` is that of the samples [m/s2]."""
    ops.timeSeries("Path", 2, "-dt", dt, "-values", *accelerations)
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    equations(*SOLVERS[solver], tolerance)
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    return round((len(accelerations) - 1) * dt / step)


def peaks(args, dt, accelerations):
    """Extremes of roof and hinges, step by step, with a tight tolerance; Newton's iterations."""
    hinges, period = prepare(args.storeys, args.bays, args.tall, args.geometry)
    steps = shake(dt, accelerations, "BandSPD", 1e-6, args.dt)
    roof, top, iterations = joint(args.storeys, 1), [0.0, 0.0], 0
    rest, turns = ops.nodeDisp(roof, 1), dict.fromkeys(hinges, 0.0)
    for _ in range(steps):
        if ops.analyze(1, args.dt):
            raise SystemExit(f"OpenSees stops at {ops.getTime():g} s")
        iterations += ops.testIter()
        u = ops.nodeDisp(roof, 1)
        top = [max(top[0], u), min(top[1], u)]
        for name, element in hinges.items():
            turns[name] = max(turns[name], abs(ops.eleResponse(element, "deformation")[0]))
    return {
        "program": "OpenSees " + ops.version(),
        "period": period,
        "equations": ops.systemSize(),
        "steps": steps,
        "iterations": iterations / steps,
        "at rest": rest,
        "roof": top,
        "hinges": turns,
    }


def seconds(args, dt, accelerations, solver):
    """CPU time of the step loop alone, extremes kept by OpenSees' own recorders as an engineer would."""
    hinges, _ = prepare(args.storeys, args.bays, args.tall, args.geometry)
    nodes = [joint(floor, 1) for floor in range(1, args.storeys + 1)]
    ops.recorder("EnvelopeNode", "-file", "/dev/null", "-node", *nodes, "-dof", 1, "disp")
    ops.recorder("EnvelopeElement", "-file", "/dev/null", "-ele", *hinges.values(), "deformation")
    steps = shake(dt, accelerations, solver, args.tolerance, args.dt)
    start = time.process_time()
    status = ops.analyze(steps, args.dt)
    took = time.process_time() - start
    ops.wipe()
    return took / steps if status == 0 else None


def main():
    """Read the command line, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("record", help="file: first line dt [s], then ground accelerations [m/s2], one a line")
    add("--storeys", type=int, default=10)
    add("--bays", type=int, default=3)
    add("--tall", action="store_true", help="the sections of the 20-storey frame")
    add("--geometry", choices=("SMALL", "PDELTA"), default="SMALL")
    add("--dt", type=float, default=0.005, help="step [s]")
    add("--tolerance", type=float, default=1e-3, help="unbalanced force [kN], of the timed runs")
    add("--time", nargs="*", choices=SOLVERS, default=[], metavar="SOLVER", help=f"of {list(SOLVERS)}")
    add("--repeat", type=int, default=3, help="timed runs of each solver; the best counts")
    args = parser.parse_args()
    with open(args.record) as file:
        dt, *accelerations = map(float, file)
    said = peaks(args, dt, accelerations)
    timed = {s: [seconds(args, dt, accelerations, s) for _ in range(args.repeat)] for s in args.time}
    said["microseconds"] = {s: 1e6 * min(t) for s, t in timed.items() if all(t)}
    print(json.dumps(said))


if __name__ == "__main__":
    main()
