"""The two pounding buildings of Cole et al. (2011) in OpenSees: the peer's side of the benchmark.

Horizontal DOF only; units kN, m, s, t.  Each diaphragm is a chain of n axial elements (n = 0: one
lumped mass), with an elastoplastic column at both ends, and meets its neighbour across a gap.  Runs in
the environment that ``peer_env.py`` makes and needs nothing but OpenSeesPy and the standard library.

Prints one JSON object; drifts in m, forces in kN, one entry per floor where there are two.
"""

import argparse
import json
import os
import struct
import tempfile
import time

import openseespy.opensees as ops
from two_buildings import BUILDINGS, GAP, SOFT, STIFF, G, rayleigh, read_two_columns

# name: integrator, algorithm, the fastest solver that is right.  Newton, because Linear lets contacts
# gain energy; factored once, because the effective matrix of central differences is constant.  The lagged
# form takes the damping force of the step before: cheaper, but of first order only.
METHODS = {
    "newmark": (("Newmark", 0.5, 0.25), ("Newton",), "BandSPD"),  # average acceleration
    "central": (("CentralDifference",), ("Linear", "-factorOnce"), "BandSPD"),
    "central-lagged": (("CentralDifferenceAlternative",), ("Linear", "-factorOnce"), "Diagonal"),
}


def node(building, floor, i):
    """Tag of node i (0 = left end) of a diaphragm; on floor 0, the ground, only the ends exist."""
    return 100_000 * building + 10_000 * floor + i


def build(n, k_contact, c_contact):
    """Make the model; return ``{"B1 storey 1 left": element, ...}`` and the two contact elements."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    tags = iter(range(1, 10**9))
    columns = {}
    sides = {"left": 0, "right": n} if n else {"": 0}

    for j, b in BUILDINGS.items():
        left = n * (j - 1)  # elements are 1 m long; the gap is a property of the contact
        for i in sides.values():
            ops.node(node(j, 0, i), float(left + i))
            ops.fix(node(j, 0, i), 1)
        diaphragms = [node(j, floor, i) for floor in (1, 2) for i in range(n + 1)]
        for tag in diaphragms:
            i = tag % 10_000
            share = (0.5 if i in (0, n) else 1.0) / n if n else 1.0
            ops.node(tag, float(left + i), "-mass", share * b["W"] / G)

        column, slab = 10 * j, 10 * j + 1
        ops.uniaxialMaterial("ElasticPP", column, b["k"] / len(sides), b["Fy"] / b["k"])
        ops.uniaxialMaterial("Elastic", slab, n * b["kD"])
        own = []
        for floor in (1, 2):
            for side, i in sides.items():
                own.append(spring(next(tags), node(j, floor - 1, i), node(j, floor, i), column, 1))
                columns[f"B{j} storey {floor} {side}".strip()] = own[-1]
            for i in range(n):
                # a Truss of unit area gives the digits of a zeroLength spring in less time
                ends = node(j, floor, i), node(j, floor, i + 1)
                ops.element("Truss", next(tags), *ends, 1.0, slab, "-doRayleigh", 0)

        # a region takes nodes or elements, never both
        alpha, beta = rayleigh(b)
        ops.region(10 * j, "-node", *diaphragms, "-rayleigh", alpha, 0.0, 0.0, 0.0)
        ops.region(10 * j + 1, "-eleOnly", *own, "-rayleigh", 0.0, 0.0, beta, 0.0)

    if c_contact:  # holds until the overlap is gone, and pulls before; no material here lets go at no force
        ops.uniaxialMaterial("ViscoelasticGap", 1, k_contact, c_contact, -GAP)
    else:
        ops.uniaxialMaterial("ElasticPPGap", 1, k_contact, -1e12, -GAP)  # compression only; never yields
    contacts = [spring(next(tags), node(1, floor, n), node(2, floor, 0), 1) for floor in (1, 2)]
    return columns, contacts


def spring(tag, i, j, material, rayleigh=0):
    """Make a spring between two nodes at one place; return its tag."""
    ops.element("zeroLength", tag, i, j, "-mat", material, "-dir", 1, "-doRayleigh", rayleigh)
    return tag


def analyse(record, n, dt, duration, integrator, solver, k_contact, c_contact, count, tolerance=1e-6):
    """Run once and return the results as a dict; only ``ops.analyze`` is timed."""
    columns, contacts = build(n, k_contact, c_contact)
    times, accelerations = read_two_columns(record)
    ops.timeSeries("Path", 1, "-time", *times, "-values", *accelerations, "-factor", G)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)

    scheme, algorithm, fastest = METHODS[integrator]
    if c_contact and integrator == "central":
        algorithm = ("Linear",)  # its matrix holds the dashpots, and these come and go
    solver = solver or fastest
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system(solver)
    ops.test("NormUnbalance", tolerance, 50, 0)
    ops.algorithm(*algorithm)
    ops.integrator(*scheme)
    ops.analysis("Transient")

    with tempfile.TemporaryDirectory() as folder:
        drift_file, force_file = (os.path.join(folder, name) for name in ("drift", "force"))
        ops.recorder("EnvelopeElement", "-file", drift_file, "-precision", 16,
                     "-ele", *columns.values(), "deformation")  # fmt: skip
        kind = ("Element", "-binary") if count else ("EnvelopeElement", "-precision", 16, "-file")
        ops.recorder(*kind, force_file, "-ele", *contacts, "material", 1, "stress")

        steps = round(duration / dt)
        start, used = time.perf_counter(), time.process_time()
        status = ops.analyze(steps, dt)
        seconds, used = time.perf_counter() - start, time.process_time() - used
        reached = ops.getTime()
        ops.wipe()  # flushes the recorders

        low, high = read_envelope(drift_file)[:2]
        if count:
            peaks, closures = read_contacts(force_file)
        else:
            peaks, closures = [-f for f in read_envelope(force_file)[0]], None

    numbers = [*low, *high, *peaks]
    return {
        "program": "OpenSees " + ops.version(),
        "n": n,
        "dt": dt,
        "integrator": integrator,
        "solver": solver,
        "k_contact": k_contact,
        "c_contact": c_contact,
        "steps": steps,
        "solve_seconds": seconds,
        "cpu_seconds": used,
        "status": status,  # 0 also for a run that blew up
        "time_reached": reached,
        "sane": status == 0 and all(abs(x) < 1e6 for x in numbers),
        "drift": {name: [hi, lo] for name, hi, lo in zip(columns, high, low)},
        "peak_force": peaks,
        "closures": closures,
    }


def read_envelope(path):
    """Rows minimum, maximum, largest magnitude; one column for each element."""
    with open(path) as file:
        return [[float(x) for x in line.split()] for line in file]


def read_contacts(path):
    """Peak compression and number of closures of both contacts.

    Version 3.7.1 writes each step as two doubles and one stray newline byte.
    """
    peaks, closures, pressed = [0.0, 0.0], [0, 0], [False, False]
    with open(path, "rb") as file:
        for *stresses, _ in struct.iter_unpack("<2dc", file.read()):
            for floor, stress in enumerate(stresses):
                closures[floor] += stress < 0 and not pressed[floor]
                pressed[floor] = stress < 0
                peaks[floor] = max(peaks[floor], -stress)
    return peaks, closures


def main():
    """Read the command line, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("record", help="file of two columns: time [s], ground acceleration [g]")
    add("--n", type=int, default=20, help="axial elements for each diaphragm (0: lumped floors)")
    add("--dt", type=float, default=1e-4, help="step [s]")
    add("--duration", type=float, default=10.0, help="analysed time [s]")
    add("--integrator", choices=METHODS, default="newmark")
    add("--solver", help="OpenSees system of equations; default the fastest that is right")
    add("--k-contact", type=float, help="[kN/m]; default n min(kD), or 10 max(kD) for n = 0")
    add("--c-contact", type=float, default=0.0, help="[kN s/m]")
    add("--no-closures", dest="count", action="store_false", help="keep no force history (a little faster)")
    args = vars(parser.parse_args())
    if args["k_contact"] is None:
        args["k_contact"] = args["n"] * SOFT or 10 * STIFF
    print(json.dumps(analyse(**args), indent=1))


if __name__ == "__main__":
    main()
