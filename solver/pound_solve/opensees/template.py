"""The parts of a script that do not depend on the deck: equations, static state, history, peaks."""

from __future__ import annotations

from typing import Final

#: imports and functions before the model
HEAD: Final = """
import argparse
import json
import math
from pathlib import Path

import openseespy.opensees as ops
"""

#: functions after the model
RUN: Final = '''
def samples(name):
    """Times and values of a file beside this script."""
    rows = [line.split() for line in (Path(__file__).resolve().parent / name).read_text().splitlines()]
    return [float(t) for t, _ in rows], [float(x) for _, x in rows]


def equations():
    """How the equations of a step are solved."""
    ops.wipeAnalysis()
    ops.constraints(CONSTRAINTS)
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormUnbalance", TOLERANCE, 100, 0)
    ops.algorithm("Newton")


def stand(axial):
    """Build the model with the side forces of these axial forces, and put the loads on."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    nodes()
    elements()
    for tag, (member, i, j, length, cos, sin) in enumerate(SWAY, FIRST_SWAY):
        ops.uniaxialMaterial("Elastic", tag, axial[member] / length)
        across = -sin, cos, 0.0, -cos, -sin, 0.0
        ops.element("zeroLength", tag, i, j, "-mat", tag, "-dir", 1, "-orient", *across)
    equations()
    damping()
    if not LOADED:
        return
    for tag, put in ((1, loads), (2, released)):
        ops.timeSeries("Linear", tag)
        ops.pattern("Plain", tag, tag)
        put()
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    if ops.analyze(10):
        raise SystemExit("OpenSees finds no equilibrium under the static loads")
    ops.loadConst("-time", 0.0)


def axial_forces():
    """Mean axial forces of the members of SWAY, tension positive."""
    forces = {}
    for member, _, _, _, cos, sin in SWAY:
        f = ops.eleForce(member)
        forces[member] = 0.5 * ((f[3] - f[0]) * cos + (f[4] - f[1]) * sin)
    return forces


def rest():
    """Find the static state, with the axial forces of that state in the side forces."""
    axial = dict.fromkeys((row[0] for row in SWAY), 0.0)
    for _ in range(100):
        stand(axial)
        forces = axial_forces()
        largest = max(map(abs, forces.values()), default=0.0)
        if all(abs(forces[m] - axial[m]) <= 1e-10 * largest for m in axial):
            return
        axial = forces
    raise SystemExit("the axial forces of the static state do not settle")


def values():
    """Compared quantities now."""
    now = {}
    for name, element in CONTACTS:
        now[f"contact {name}, force"] = 0.0 - ops.eleResponse(element, "material", 1, "stress")[0]
    for name, i, j, direction in DRIFTS:
        now[f"drift {name}"] = ops.nodeDisp(j, direction) - ops.nodeDisp(i, direction)
    for name, node, direction in DISPLACEMENTS:
        now[name] = ops.nodeDisp(node, direction)
    return now


def crest(a, b, c):
    """Top or bottom of the parabola through three values in turn if it is there, else the last value."""
    return b + (c - a) ** 2 / (8.0 * (2.0 * b - a - c)) if (b - a) * (b - c) > 0.0 else c


def advance(step):
    """Take one step, by other algorithms where Newton's does not converge."""
    if ops.analyze(1, step) == 0:
        return
    for algorithm in ("KrylovNewton", "NewtonLineSearch", "BFGS"):
        ops.algorithm(algorithm)
        status = ops.analyze(1, step)
        ops.algorithm("Newton")
        if status == 0:
            return
    raise SystemExit(f"OpenSees does not converge in the step after t = {ops.getTime():.9g}")


def history(dt):
    """Run the history and return the largest and smallest values."""
    equations()
    if LOADED:
        ops.remove("loadPattern", 2)
    motion()
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    high = values()
    if not SETTLED:  # OpenSees starts without acceleration: a small step finds that of t = 0
        advance(1e-3 * dt)
        ops.setTime(0.0)
    low, before, last = dict(high), high, high
    for _ in range(math.ceil(END / dt - 1e-6)):
        advance(dt)
        now = values()
        for name, x in now.items():
            if not math.isfinite(x):
                raise SystemExit(f"the response in OpenSees is no number at t = {ops.getTime():.9g}")
            peak = x if name in FORCES else crest(before[name], last[name], x)
            high[name], low[name] = max(high[name], peak), min(low[name], peak)
        before, last = last, now
    return high, low


#: names of quantities that may have a kink at their peak
FORCES = frozenset(f"contact {name}, force" for name, _ in CONTACTS)


def main():
    """Read the step, run, and print the peaks as JSON on the last line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dt", type=float, default=STEP, help=f"time step (default {STEP:g})")
    dt = parser.parse_args().dt
    rest()
    high, low = history(dt)
    peaks = {}
    for name in high:
        if name in FORCES:
            peaks[name] = high[name]
        else:
            peaks[f"{name}, max"], peaks[f"{name}, min"] = high[name], low[name]
    print(json.dumps({"program": f"OpenSees {ops.version()}", "dt": dt, "peaks": peaks}))


if __name__ == "__main__":
    main()
'''
