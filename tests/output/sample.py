"""A results file of realistic size with made-up numbers: two frames that pound each other."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from pound_deck.model import Units
from pound_solve.results import Writer
from pound_solve.results.schema import ENERGIES

NAN = float("nan")
NODES = (1, 2, 3, 4, 100, 101, 102, 300, 301, 302)
UNITS = Units("kN", "m", "s", given=True)
TITLE = "Two 2-storey buildings, 20 axial elements per diaphragm – gap 8 mm, ξ = 5 %"
DECK = "TITLE Zwei Gebäude\nUNITS kN m s\nNODES\n   1  0  0  FIX=XYR   ! Stütze\n"


def rows(seed: int = 1) -> dict[str, list[tuple[Any, ...]]]:
    """Rows of every table."""
    rng = np.random.default_rng(seed)

    def some(scale: float) -> float:
        return float(rng.normal() * scale)

    def when() -> float:
        return round(float(rng.uniform(1, 10)) / 0.002) * 0.002

    envelopes = (
        ("displacement", 0.05, "m", "rad"),
        ("velocity", 0.6, "m/s", "rad/s"),
        ("acceleration", 12.0, "m/s^2", "rad/s^2"),
    )
    return {
        "options": [
            ("analysis", "STATIC, MODAL 4, HISTORY", "", "dead loads, then 4 modes, then time history"),
            ("units", "kN m s", "", "force, length, time; nothing is converted"),
            ("gravity", "9.80665 m/s^2", "*", "weights are divided by it to give masses"),
            ("mass", "LUMPED", "*", "half of a member's mass at each of its ends"),
            ("method", "AUTO", "*", "the program chooses the time integration, see section 3"),
            ("duration", "10 s", "", "end of the time history"),
            ("tolerance", "1E-6", "*", "error allowed in displacement over its peak, at each step"),
            (
                "output interval",
                "0.002 s",
                "",
                "spacing of the stored histories; events are stored besides",
            ),
            ("PARAM n", "20", "", "number of elements in a diaphragm (--set)"),
            ("PARAM gap", "0.008", "", "parameter of the deck"),
        ],
        "nodes": [
            *(
                (n, 20.0 * (n > 99) + 0.1 * (n // 300), 3.5 * (i % 3), "XYR" if i % 3 == 0 else "YR", "", 0)
                for i, n in enumerate(NODES[:-1])
            ),
            (302, 20.1, 7.0, "Y", "X", 301),
        ],
        "elements": [
            (11, "left column", "COL1", "SPRING", 1, 100, 3.5),
            (12, "", "COL1", "SPRING", 1, 0, NAN),
            *((101 + i, "", "SLAB1", "FRAME", 100 + i, 101 + i, 1.0) for i in range(6)),
            (901, "pounding 1", "POUND", "CONTACT", 120, 300, 0.1),
        ],
        "properties": [
            ("COL1", "SPRING", "KX", "210000", "kN/m", ""),
            ("COL1", "SPRING", "ANGLE", "0", "deg", "*"),
            ("COL1", "ELASTO_PLASTIC", "FX", "1200", "kN", ""),
            ("SLAB1", "FRAME", "E", "2.5084E+07", "kN/m^2", ""),
            ("SLAB1", "FRAME", "A", "1.5", "m^2", ""),
            ("POUND", "HERTZDAMP", "K", "15050400", "kN/m^1.5", ""),
            ("POUND", "HERTZDAMP", "E", "0.65", "-", ""),
        ],
        "masses": [
            (100, 81.577, 81.577, 0.0),
            (101, 8.1577298, 8.1577298, 0.0),
            (300, 163.1545, 163.1545, 1.25),
        ],
        "loads": [(100, 0.0, -800.0, 0.0), (101, 0.0, -80.0, 12.5)],
        "member_loads": [(101, "uniform -12 kN/m in global Y over the whole length")],
        "damping": [
            ("all", "RAYLEIGH", "alpha 0.52360 1/s on the mass, beta 0.0014 s on the initial stiffness")
        ],
        "contact_laws": [
            ("901", "KELVIN_VOIGT", "15050400 kN/m", 412.33, 0.1364, 0.65, 0.65, 40.7886, 0.0, 0.008, ""),
            (
                "902",
                "HERTZDAMP",
                "1.505E+07 kN/m^1.5",
                NAN,
                0.6661,
                0.65,
                0.6483,
                40.7886,
                0.0,
                0.008,
                "c varies",
            ),
            ("903", "LINEAR", "15050400 kN/m", 0.0, 0.0, NAN, 1.0, 40.7886, 180.0, 0.01, ""),
        ],
        "diaphragms": [
            ("floor 1", "I", 163.1, 1881300.0, 17516.8, 0.018622, 0.65217, 0.4641, 0.49782),
            ("floor 1", "J", 305.81, 752520.0, 15170.0, 0.040318, 0.34783, 0.24752, 0.2655),
            ("903", "I", 163.1, NAN, NAN, NAN, NAN, NAN, NAN),
            ("903", "J", math.inf, NAN, NAN, NAN, NAN, NAN, NAN),
        ],
        "collision_theory": [
            ("floor 1", 0.42324, 0.52664, 0.040318, 8129.57, 31.0066, "the equations of the paper fail"),
            ("903", NAN, NAN, NAN, NAN, NAN, "rigid: no theory"),
        ],
        "motions": [
            (
                "elcentro_1940_ew_270_peer",
                "X",
                "all",
                "PEER",
                5372,
                0.01,
                -1.0,
                2.10137,
                11.44,
                0.312904,
                0.242387,
                0.0,
                53.71,
                "9b0c5a1f3e77aa01" * 4,
            )
        ],
        "forces": [("1 SINE", "300", 12.5, 0.0, -3.0, 1.0, 0.1, 2.5)],
        "scene": [
            (
                "directions",
                "X only",
                "all loads, motions and contacts act in X; Y and R are held or follow statics",
            ),
            (
                "integrator",
                "exact steps between events",
                "between two events the structure is linear: the matrix exponential gives the state at any "
                "time, so that closing and opening of contacts are found as roots and not as steps",
            ),
            ("left out", "geometric stiffness", "P-DELTA is not asked for"),
        ],
        "size": [("degrees of freedom", "84"), ("after condensation", "44"), ("contacts", "3")],
        "static_displacement": [
            *((n, some(1e-19), -abs(some(2e-4)), some(1e-5)) for n in NODES),
            (999, -0.0, 0.0, 0.0),
        ],
        "arrays": [
            ("structure", "stiffness, mass, damping", 768, 6144),
            ("contacts", "closures of 0", 0, 0),
        ],
        "static_force": [
            (101 + i, quantity, some(300.0), unit)
            for i in range(3)
            for quantity, unit in (("axial", "kN"), ("shear I", "kN"), ("moment I", "kN*m"))
        ],
        "reactions": [(n, some(12.0), abs(some(800.0)), some(40.0)) for n in (1, 2, 3, 4)],
        "equilibrium": [("loads", 0.0, -some(800.0), 0.0), ("sum", 0.0, 1e-12, 0.0)],
        "static_run": [("changes of springs and contacts", "3")],
        "pushover": [("end", "the target displacement is reached")],
        "push_pattern": [(n, "X", some(0.5), some(0.5)) for n in NODES[4:]],
        "capacity_curve": [(0.01 * i, 310.0 * i / (1 + 0.1 * i), 310.0 * i, i // 3) for i in range(12)],
        "push_events": [(1, 0.031, 712.5, 2.1, 11, "hinge I", "elastic", "yielding +")],
        "modes": [
            (
                i + 1,
                w,
                w / math.tau,
                math.tau / w,
                5.0 + 0.31 * i,
                g,
                400 * g * g,
                60 * g * g,
                0.0,
                0.0,
                0.0,
            )
            for i, (w, g) in enumerate(((7.203, 1.19), (11.31, -1.17), (21.09, 0.32), (33.2, 0.2987)))
        ],
        "mode_shapes": [
            (mode, n, math.sin(mode * (i + 1)), 0.0, some(0.01))
            for mode in (1, 2)
            for i, n in enumerate(NODES)
        ],
        "node_envelope": [
            (n, d, quantity, rad if d == "R" else unit, abs(some(s)), when(), -abs(some(s)), when())
            for n in NODES[4:]
            for quantity, s, unit, rad in envelopes
            for d in ("X", "R")
        ],
        "drift_envelope": [
            *(
                (
                    f"B{b} storey {s}",
                    abs(some(0.02)),
                    when(),
                    -abs(some(0.02)),
                    when(),
                    3.5,
                    abs(some(0.01)),
                )
                for b in (1, 2)
                for s in (1, 2)
            ),
            ("across the gap", 0.0312345, 4.21, -0.008, 3.998, NAN, NAN),
        ],
        "member_envelope": [
            (101 + i, quantity, unit, abs(some(900.0)), when(), -abs(some(900.0)), when())
            for i in range(4)
            for quantity, unit in (("axial", "kN"), ("shear I", "kN"), ("moment I", "kN*m"))
        ],
        "spring_envelope": [
            (
                11,
                "X",
                "ELASTO_PLASTIC",
                "kN",
                1200.0,
                -1200.0,
                "m",
                0.0234417,
                -0.0310928,
                14,
                5.4412,
                93.2213,
            ),
            (12, "X", "LINEAR", "kN", 843.19, -799.02, "m", 0.0041, -0.0039, 0, NAN, 0.0),
            (12, "R", "TAKEDA", "kN*m", 310.2, -288.8, "rad", 0.0031, -0.0022, 3, 1.61, 2.118),
        ],
        "spring_plastic": [
            (11, "X", "m", -0.0151234, -0.0112213, 0.0776844, 18.0332),
            (12, "R", "rad", 0.0012, 7e-4, 0.0071, 3.6872),
        ],
        "damage": [
            (11, "X", 8.0, 5.4412, 0.68015, 0.0845, 0.76465, 0.97778),
            (12, "R", 8.0, 1.61, 0.20125, 0.0229, 0.22415, 0.02222),
            (0, "", NAN, NAN, NAN, NAN, 0.75264, 1.0),
        ],
        "contact_summary": [
            ("901", 14, 18204.731, 4.213477, 0.0012096, 151.203, 3.2214, -0.0012096, 0.0731),
            ("902", 2, 9101.2, 5.118203, 0.00071, 71.2, 0.81, -0.00071, 0.0091),
            ("903", 0, 0.0, NAN, 0.0, 0.0, 0.0, 0.00213, 0.0),
        ],
        "collisions": [
            (
                "901" if i % 7 else "902",
                2.0 + i * 0.0503713,
                2.0061 + i * 0.0503713 if i < 119 else NAN,
                v := 0.9 * abs(math.sin(i + 1)),
                0.65 * v,
                0.65,
                18204.731 * v,
                2.0023719 + i * 0.0503713,
                40.7886 * 1.65 * v,
                16000.0 * v,
                15320.4 * v if i % 7 else NAN,
                -15.84 if i % 7 else NAN,
            )
            for i in range(120)
        ],
        "energy": [
            ("input", 64.07213, 100.0),
            ("kinetic", 0.00021, 0.00021 / 64.07213 * 100),
            ("strain", 0.113, 0.1763),
            ("damping", 32.30112, 50.413),
            ("hysteretic", 28.4378, 44.384),
            ("contact", 3.2214, 5.0278),
            ("residual", -1.2e-11, -1.9e-11),
        ],
        "checks": [
            ("energy residual over input", "1.9E-13", "good"),
            ("propagator against half steps", "3.1E-15", "good"),
            ("largest open gap at an event", "2.2E-16 m", "good"),
        ],
        "run": [
            ("method", "exact steps between events"),
            ("steps", "5000"),
            ("events", "31"),
            ("regimes", "4"),
        ],
        "run_figures": [("wall time", "0.412 s"), ("peak memory", "81 MB"), ("numpy", "2.4.6")],
        "imports": [("pound_solve", 3, "app, cli, course"), ("numba", 0, "not imported")],
        "study": [
            ("EXACT", "", 0.05312, 0, 24, 0.0, 1.1e-15, 3e-16, NAN, 8, 1.03e-15),
            ("NEWMARK", "DT=0.005", 0.0305, 1120, 24, 1.4454e-2, 1.7786e-2, 2.5733e-2, NAN, 8, 1.88e-2),
            ("NEWMARK", "DT=0.0025", 0.0417, 2080, 24, 4.533e-3, 5.1073e-3, 6.9075e-3, 2.1245, 8, 5.26e-3),
            ("CENTRAL", "DT=0.005", NAN, 0, 0, NAN, NAN, NAN, NAN, 0, NAN),
        ],
        "study_stops": [("CENTRAL", "DT=0.005", "A502 at t = 0 s: above the stability limit 0.004684")],
        "study_advice": [
            (1e-2, "NEWMARK", "DT=0.0025", 0.0417, 6.9e-3, 9.9e-3),
            (1e-3, "EXACT", "", 0.05312, 1.1e-15, 3.3e-15),
            (1e-6, "", "", NAN, NAN, NAN),
        ],
    }


def layout() -> dict[str, Any]:
    """Layout of every history."""
    force = {
        "element": [101, 101, 102],
        "quantity": ["axial", "moment I", "axial"],
        "unit": ["F", "F*L", "F"],
    }
    node = {"nodes": NODES, "labels": ("ux", "uy", "rz")}
    return {
        "node/u": ((len(NODES), 3), node | {"unit": ("L", "L", "rad")}),
        "node/v": ((len(NODES), 3), node | {"unit": ("L/T", "L/T", "rad/T")}),
        "node/a": ((len(NODES), 3), node | {"unit": ("L/T^2", "L/T^2", "rad/T^2")}),
        "member/force": ((3,), force),
        "contact/gap": ((2,), {"labels": ("901", "902"), "unit": "L"}),
        "contact/force": ((2,), {"labels": ("901", "902"), "unit": "F"}),
        "spring/force": ((0,), {"labels": (), "unit": "F"}),
        "drift": ((1,), {"labels": ("B1 storey 1",), "unit": "L"}),
        "ground": ((1,), {"labels": ("elcentro",), "unit": "L/T^2"}),
        "force": ((1,), {"labels": ("1 SINE",)}),
        "energy": ((7,), {"labels": ENERGIES, "unit": "F*L"}),
    }


def block(start: int, count: int) -> dict[str, np.ndarray]:
    """Histories at `count` instants 0.01 s apart; every number tells where it stands."""
    time = 0.01 * np.arange(start, start + count)
    out = {"time": time}
    for name, (shape, _) in layout().items():
        out[name] = time.reshape(-1, *([1] * len(shape))) + np.arange(math.prod(shape)).reshape(shape)
    return out


def write(path: Path, *, status: str = "done", message: str = "", blocks: int = 3) -> Path:
    """Write the whole sample."""
    with Writer(path, title=TITLE, units=UNITS, program_version="0.1.0") as writer:
        writer.text("decks/two buildings.inp", DECK)
        writer.start_history(layout())
        for number in range(blocks):
            writer.append(block(number * 100, 100))
        for name, table in rows().items():
            writer.table(name, table, "Accelerations are absolute." if name == "node_envelope" else None)
        if status != "running":
            writer.finish(status, message)
    return path
