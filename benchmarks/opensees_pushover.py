"""P-Delta pushover of a hinged frame with OpenSees: the numbers frozen in tests/unit/test_pushover.py.

Three storeys of 3.5 m, two bays of 6 m; bilinear hinges in series with elastic members; all gravity on a
leaning column of bars, so that OpenSees, which takes the present axial forces, and pound-solve, which
takes those of the static state, have the same ones.  Run it in an environment with openseespy 3.7.1.2.
"""

from __future__ import annotations

import argparse

import openseespy.opensees as ops

STOREYS, BAYS, H, SPAN = 3, 2, 3.5, 6.0
GRAVITY = 900.0  #: on every floor [kN]
KH, HARD = 2e6, 0.02
STIFF = 1e11  #: of what stands for rigid [kN/m]
TARGETS = (0.05, 0.1, 0.2, 0.4, 0.6, 0.8)
TURNS = (0.1, -0.05, 0.3, 0.0, 0.35)  #: of the pushover to and fro
STEP = 0.0005


def node(floor: int, line: int) -> int:
    """Number of a joint."""
    return 100 * floor + line + 1


def member(
    number: int, i: int, j: int, inertia: float, area: float, strength: float, transformation: int
) -> None:
    """Elastic member between two hinges."""
    ends = []
    for end, joint in ((1, i), (2, j)):
        inner = 10 * number + end
        ops.node(inner, *ops.nodeCoord(joint))
        ops.uniaxialMaterial("Steel01", inner, strength, KH, HARD)
        # no equalDOF: it would chain with the floor's, which OpenSees takes without a word, and wrongly
        ops.element("zeroLength", inner, joint, inner, "-mat", 1, 1, inner, "-dir", 1, 2, 6)
        ends.append(inner)
    ops.element("elasticBeamColumn", number, *ends, area, 2e8, inertia, transformation)


def build() -> None:
    """Frame, leaning column and gravity."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.uniaxialMaterial("Elastic", 1, STIFF)
    ops.geomTransf("Linear", 1)
    ops.geomTransf("PDelta", 2)
    for floor in range(STOREYS + 1):
        for line in range(BAYS + 2):  # the last line is the leaning column
            ops.node(node(floor, line), SPAN * line, H * floor)
            if floor == 0:
                ops.fix(node(floor, line), 1, 1, 1)
    for floor in range(1, STOREYS + 1):
        for line in range(1, BAYS + 2):
            ops.equalDOF(node(floor, 0), node(floor, line), 1)
        ops.fix(node(floor, BAYS + 1), 0, 0, 1)
    for floor in range(1, STOREYS + 1):
        for line in range(BAYS + 1):
            member(1000 * floor + line, node(floor - 1, line), node(floor, line), 6e-4, 0.03, 900.0, 1)
        for line in range(BAYS):
            member(
                1000 * floor + 500 + line, node(floor, line), node(floor, line + 1), 4e-4, 0.02, 500.0, 1
            )
        low, high = node(floor - 1, BAYS + 1), node(floor, BAYS + 1)
        ops.element("elasticBeamColumn", 1000 * floor + 900, low, high, 1.0, 2e8, 1e-3, 2, "-release", 3)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for floor in range(1, STOREYS + 1):
        ops.load(node(floor, BAYS + 1), 0.0, -GRAVITY, 0.0)


def main() -> None:
    """Print load factor by displacement, for one push and for a push to and fro."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    load()
    roof = node(STOREYS, 0)
    go(roof, TARGETS)
    load()
    print()
    go(roof, TURNS)


def load() -> None:
    """Build the frame, apply gravity, and prepare the push."""
    build()
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormDispIncr", 1e-11, 50)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    assert ops.analyze(10) == 0
    ops.loadConst("-time", 0.0)
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    for floor in range(1, STOREYS + 1):
        ops.load(node(floor, 0), floor / 6.0, 0.0, 0.0)


def go(roof: int, targets: tuple[float, ...]) -> None:
    """Go from one displacement of the roof to the next, and print the load factor at each."""
    now = 0.0
    for target in targets:
        ops.integrator("DisplacementControl", roof, 1, STEP if target > now else -STEP)
        ops.analysis("Static")
        assert ops.analyze(round(abs(target - now) / STEP)) == 0
        now = target
        print(f"    ({target}, {ops.getTime():.8g}),")


if __name__ == "__main__":
    main()
