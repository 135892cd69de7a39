"""A frame with hinges in OpenSees: the peer's side of ``test_against_opensees`` in
``tests/unit/test_frame_hinges.py``.

Two storeys of 3.5 m, one bay of 6 m; every member is an elastic beam between two zero-length rotational
springs (Steel01) of 60 EI/L that harden by 3 %.  A uniform load on the beams and a push at the floors grow
together.  Units kN, m.  Runs in the environment that ``peer_env.py`` makes.

Prints displacements of the nodes (x, y, rotation) and end moments of the members.
"""

import argparse

import openseespy.opensees as ops

E, HEIGHT, SPAN, HARDENING = 2.0e8, 3.5, 6.0, 0.03
COLUMN = {"A": 0.012, "I": 2.5e-4, "M": 260.0}
BEAM = {"A": 0.009, "I": 1.8e-4, "M": 170.0}
MEMBERS = [
    *((i, j, COLUMN) for i, j in ((1, 11), (2, 12), (11, 21), (12, 22))),
    *((i, j, BEAM) for i, j in ((11, 12), (21, 22))),
]
STEPS = 1000


def build() -> None:
    """Nodes 1, 2 at the ground, 11, 12, 21, 22 at the floors; member n is element 10 n, then its hinges."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for floor in range(3):
        for side in (1, 2):
            ops.node(10 * floor + side, SPAN * (side - 1), HEIGHT * floor)
    ops.fix(1, 1, 1, 1)
    ops.fix(2, 1, 1, 1)
    ops.geomTransf("Linear", 1)
    for n, (i, j, section) in enumerate(MEMBERS, 1):
        length = HEIGHT if section is COLUMN else SPAN
        ops.uniaxialMaterial("Steel01", n, section["M"], 60.0 * E * section["I"] / length, HARDENING)
        inner = []
        for end, node in enumerate((i, j), 1):
            own = 1000 * n + end
            ops.node(own, *ops.nodeCoord(node))
            ops.equalDOF(node, own, 1, 2)
            ops.element("zeroLength", 10 * n + end, node, own, "-mat", n, "-dir", 6)
            inner.append(own)
        ops.element("elasticBeamColumn", 10 * n, *inner, section["A"], E, section["I"], 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.eleLoad("-ele", 50, 60, "-type", "-beamUniform", -30.0)
    ops.load(11, 75.0, 0.0, 0.0)
    ops.load(21, 150.0, 0.0, 0.0)


def main() -> None:
    """Push and print."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    build()
    ops.system("FullGeneral")
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.test("NormUnbalance", 1e-11, 50)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0 / STEPS)
    ops.analysis("Static")
    if ops.analyze(STEPS) != 0:
        raise SystemExit("OpenSees did not converge")
    for node in (11, 12, 21, 22):
        print(node, *(f"{x:.12g}" for x in ops.nodeDisp(node)))
    for n in range(1, len(MEMBERS) + 1):
        force = ops.eleForce(10 * n)
        print(n, f"{force[2]:.10g}", f"{force[5]:.10g}")


if __name__ == "__main__":
    main()
