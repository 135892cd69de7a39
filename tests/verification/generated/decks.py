"""A deck of two or three frames that stand in a row and pound, drawn from a seed.

What is drawn: storeys, bays, heights of floors, sections, strengths, hysteresis rules and contact laws of
the catalog, friction, damping, P-Delta, gravity, a ground motion, TOL, and whether drifts are followed.  A
draw that the program refuses is drawn anew, so that every seed gives a deck that can be run.  Whether the
mass of members is a matrix is drawn apart, so that all other decks are those of their seeds before.
"""

from __future__ import annotations

import itertools
import random
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from pound_solve.driver.prepare import DeckError, prepare
from pound_solve.driver.request import Request
from verification.generated import laws, motions

E: Final = 27e6  #: modulus of elasticity of concrete [kN/m2]
CONCRETE: Final = 24.0  #: weight of concrete [kN/m3]
CONSISTENT: Final = 0.2  #: share of decks whose members have a matrix of mass
ON_MEMBERS: Final = 0.5  #: share of the floors' weight that is the beams' there
SAME: Final = 1e-6  #: floors closer than that are of one height [m]
DAMPING: Final = (
    "RAYLEIGH XI=0.05 MODES=1,3",
    "RAYLEIGH XI=0.03 MODES=1,4 STIFFNESS=TANGENT",
    "RAYLEIGH XI=0.05 MODES=1,3 STIFFNESS=ELASTIC",
    "RAYLEIGH ALPHA=0.3 BETA=0",
    "MODAL XI=0.04",
    "",
)
CONSTANT: Final = ("SMALL", "PDELTA", "PDELTA_MEMBER")  #: forms that keep members' stiffness
GEOMETRY: Final = (*CONSTANT * 4, "PDELTA_VARYING", "LARGE")
STRAIGHT: Final = 0.4  #: share of decks in which all is linear in pieces, so that no method is ruled out
SECTIONS: Final = ("NODES", "ELEMENTS", "PROPS", "WEIGHTS", "MEMBER_LOADS", "DAMPING", "DRIFT", "EQUAKE",
                   "OUTPUT", "ANALYSIS")  # fmt: skip
STOREYS: Final = (1, 1, 1, 1, 2, 2, 3, 4, 6)
BAYS: Final = (1, 1, 2, 3)
#: deformations of rules, as that to the cap, are in yield deformations of members, five times a hinge's
STRETCH: Final = 5.0
MOST_DRAWS: Final = 200


@dataclass
class Frame:
    """One frame of a deck.

    Attributes
    ----------
    number : int
        The first of its nodes' numbers is 1000 times that.
    left : float
        Place of its first column [m].
    bays : list of float
        Widths [m].
    floors : list of float
        Heights above ground, ascending; the ground is the first [m].
    weight : float
        Of a metre of floor [kN/m].
    met : dict
        Heights between floors at which the first or last column (0 or -1) is hit, with the nodes there.
    """

    number: int
    left: float
    bays: list[float]
    floors: list[float]
    weight: float
    met: dict[tuple[int, float], int] = field(default_factory=dict)

    @property
    def right(self) -> float:
        """Place of its last column [m]."""
        return self.left + sum(self.bays)

    def node(self, column: int, floor: int) -> int:
        """Number of a node."""
        return 1000 * self.number + 10 * floor + column

    def at(self, side: int, height: float) -> tuple[int, bool]:
        """Node of the first (0) or last (-1) column at a height, and whether it is a floor; a node between
        floors is made.
        """
        column = 0 if side == 0 else len(self.bays)
        for i, own in enumerate(self.floors):
            if abs(own - height) < SAME:
                return self.node(column, i), True
        made = self.met.setdefault((side, height), 1000 * self.number + 900 + len(self.met))
        return made, False


class Deck:
    """The lines of a deck by section, while it is drawn; `consistent` for a matrix of mass of members."""

    def __init__(self, rng: random.Random, records: Path | None, consistent: bool) -> None:
        self.rng, self.element, self.consistent = rng, 0, consistent
        self.lines: dict[str, list[str]] = {name: [] for name in SECTIONS}
        self.straight = rng.random() < STRAIGHT
        geometry = rng.choice(CONSTANT if self.straight else GEOMETRY)
        self.head = ["UNITS kN m s", *["MASS CONSISTENT"] * consistent, f"GEOMETRY {geometry}"]
        self.gravity = rng.choice(("WEIGHTS", "WEIGHTS", "BEAMS", "NONE"))
        self._draw(records)

    def add(self, section: str, line: str) -> None:
        """Append a line to a section."""
        self.lines[section].append(line)

    def join(self, prop: str, i: int, j: int, name: str = "") -> int:
        """Append an element; return its number."""
        self.element += 1
        self.add("ELEMENTS", f"{self.element} {prop} {i} {j}" + (f' NAME="{name}"' if name else ""))
        return self.element

    def _draw(self, records: Path | None) -> None:
        """Draw everything."""
        rng = self.rng
        frames = self._frames()
        for a, b in itertools.pairwise(frames):
            self._contacts(a, b)
        for frame in frames:
            self._build(frame)
        self.add("DAMPING", rng.choice(DAMPING))
        length = float(rng.randint(4, 6))
        self.add("EQUAKE", motions.motion(rng, length, records))
        if rng.random() < 0.25:
            self.lines["DRIFT"] = []
        if rng.random() < 0.5:
            self.add("OUTPUT", f"EVERY={rng.choice((0.01, 0.02, 0.05))}")
        self.add("ANALYSIS", "STATIC" + (" GRAVITY=YES" if self.gravity == "WEIGHTS" else ""))
        tol = rng.choice(("1E-2", "1E-2", "1E-3", "1E-3", "1E-4"))
        self.add("ANALYSIS", f"HISTORY {length:g} METHOD=AUTO TOL={tol}")

    def _frames(self) -> list[Frame]:
        """Draw the frames, from left to right, floors at one height or not."""
        rng = self.rng
        count, equal = (3 if rng.random() < 0.2 else 2), rng.random() < 0.6
        first, storey = rng.uniform(3.4, 4.5), rng.uniform(3.0, 3.6)
        frames: list[Frame] = []
        left = 0.0
        for number in range(1, count + 1):
            shift = 0.0 if equal else rng.uniform(-0.25, 0.25) * storey
            floors = [0.0] + [first + shift + storey * i for i in range(rng.choice(STOREYS))]
            bays = [round(rng.uniform(4.0, 7.0), 1) for _ in range(rng.choice(BAYS))]
            frame = Frame(number, left, bays, [round(y, 3) for y in floors], rng.uniform(15.0, 40.0))
            frames.append(frame)
            left = round(frame.right + rng.choice((0.0, 0.005, 0.01, 0.02, 0.05)), 6)
        return frames

    def _contacts(self, a: Frame, b: Frame) -> None:
        """Draw the contacts of neighbours: floors of the lower one meet floors or columns of the other."""
        rng = self.rng
        lower = a if a.floors[-1] <= b.floors[-1] else b
        slab, column = f"P{a.number}", f"Q{a.number}"
        force, depth = 10.0 ** rng.uniform(2.5, 3.5), 10.0 ** rng.uniform(-3.0, -2.2)
        gap = round(b.left - a.right, 6)
        friction = ""
        if rng.random() < 0.5 and not self.straight:
            friction = f" MU={rng.uniform(0.2, 0.6):.2g} KT={0.2 * force / depth:.3g}"
        law = laws.contact(rng, force, depth, 10.0 ** rng.uniform(5.5, 6.7), self.straight)
        used = set()
        for floor, height in enumerate(lower.floors[1:], 1):
            ends = a.at(-1, height), b.at(0, height)
            prop = slab if ends[0][1] and ends[1][1] else column
            used.add(prop)
            self.join(prop, ends[0][0], ends[1][0], f"{a.number}-{b.number} {floor}")
        for prop in sorted(used):
            self.add("PROPS", f"{prop} CONTACT GAP={gap:g} ANGLE=0 {law}{friction}")

    def _build(self, frame: Frame) -> None:
        """Append nodes, members, properties, weights and drifts of a frame."""
        rng, n = self.rng, frame.number
        x = [frame.left]
        for bay in frame.bays:
            x.append(round(x[-1] + bay, 6))
        weight = frame.weight * (1.0 - ON_MEMBERS if self.consistent else 1.0)
        share = [weight * 0.5 * (p + q) for p, q in zip([0.0, *frame.bays], [*frame.bays, 0.0])]
        for floor, y in enumerate(frame.floors):
            for column, place in enumerate(x):
                number = frame.node(column, floor)
                self.add("NODES", f"{number} {place:g} {y:g}" + (" FIX=XYR" if floor == 0 else ""))
                if floor:
                    self.add("WEIGHTS", f"{number} {share[column]:.5g}")
        for (side, height), number in frame.met.items():
            self.add("NODES", f"{number} {x[side]:g} {height:g}")
            self.add("WEIGHTS", f"{number} {rng.choice((2.0, 8.0))} 0")
        self._members(frame)
        for floor in range(1, len(frame.floors)):
            self.add("DRIFT", f'"F{n} {floor}" {frame.node(0, floor - 1)} {frame.node(0, floor)}')

    def _members(self, frame: Frame) -> None:
        """Append columns and beams with their hinges, and the loads on the beams."""
        rng, n, storeys = self.rng, frame.number, len(frame.floors) - 1
        weight = frame.weight * sum(frame.bays) * storeys
        shear = rng.uniform(0.15, 0.6) * weight / (len(frame.bays) + 1)
        moment = 0.5 * shear * frame.floors[1]
        # twice the fixed-end moment: gravity alone yields neither a beam nor the columns of its joint
        gravity = frame.weight * max(frame.bays) ** 2 / 6.0
        strength = max(0.8 * moment, gravity)
        moment = max(moment, gravity if self.gravity == "BEAMS" else 0.0)
        width = rng.uniform(0.3, 0.4) + 0.04 * storeys
        yields = rng.choice(("BOTH", "BOTH", "BOTH", "BEAMS", "COLUMNS", "NONE"))
        on_beams = ON_MEMBERS * frame.weight if self.consistent else 0.0
        self._props(f"C{n}", width, width, moment if yields in ("BOTH", "COLUMNS") else 0.0, 0.0, True)
        self._props(f"B{n}", 0.3, width + 0.1, strength if yields in ("BOTH", "BEAMS") else 0.0, on_beams)
        columns = len(frame.bays) + 1
        for floor in range(1, storeys + 1):
            for column in range(columns):
                stack = [(frame.floors[floor - 1], frame.node(column, floor - 1))]
                side = {0: 0, columns - 1: -1}.get(column)
                stack += sorted(
                    (y, node)
                    for (own, y), node in frame.met.items()
                    if own == side and frame.floors[floor - 1] < y < frame.floors[floor]
                )
                stack.append((frame.floors[floor], frame.node(column, floor)))
                for (_, i), (_, j) in itertools.pairwise(stack):
                    self.join(f"C{n}", i, j)
            for column in range(columns - 1):
                beam = self.join(f"B{n}", frame.node(column, floor), frame.node(column + 1, floor))
                if self.gravity == "BEAMS":
                    self.add("MEMBER_LOADS", f"{beam} WY={on_beams - frame.weight:.4g}")

    def _props(
        self, label: str, width: float, depth: float, moment: float, load: float, carries: bool = False
    ) -> None:
        """Append a property set of members, with hinges where there is a yield moment; of a mass that is a
        matrix `load` is a part.
        """
        inertia = 0.5 * width * depth**3 / 12.0
        card = f"{label} FRAME E={E:g} A={width * depth:.4f} I={inertia:.6f}"
        if self.consistent:
            card += f" WGT={load or CONCRETE * width * depth:.4g}"
        if moment:
            length = 0.5 * depth
            rule = laws.hysteresis(
                self.rng, moment, STRETCH * moment * length / (E * inertia), self.straight, carries
            )
            card += f" LP={length:.3f} MI={moment:.4g} MJ={moment:.4g} {rule}"
        self.add("PROPS", card)

    def text(self, title: str) -> str:
        """The deck."""
        parts = [f"TITLE {title}", *self.head]
        for name, own in self.lines.items():
            if any(own):
                parts += [name, *(f"  {line}" for line in own if line)]
        return "\n".join(parts) + "\n"


def refused(text: str, records: Path | None) -> bool:
    """Whether the program refuses a deck before it runs, or no method takes what it combines: a rigid
    contact where something else is not linear in pieces.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "deck.inp")
        path.write_text(text, encoding="utf-8")
        try:
            structure = prepare(Request(str(path), records=() if records is None else (records,))).structure
        except DeckError:
            return True
    rigid = any(s.law.rigid for s in structure.laws)
    return rigid and (bool(structure.corotational) or any(s.law.curved for s in structure.laws))


def deck(seed: int, records: Path | None = None) -> str:
    """Text of the deck of a seed.

    Parameters
    ----------
    seed : int
    records : Path or None
        Folder of record files, from which half of the motions are taken; none if left out.
    """
    rng, consistent = random.Random(seed), random.Random(f"mass {seed}").random() < CONSISTENT
    for _ in range(MOST_DRAWS):
        text = Deck(rng, records, consistent).text(f"generated from seed {seed}")
        if not refused(text, records):
            return text
    raise RuntimeError(f"seed {seed}: {MOST_DRAWS} draws were all refused")
