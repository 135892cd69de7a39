"""Members in pictures bend as the structure does."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import pound_solve
from pound_solve.report.plot import beams, geometry
from pound_solve.results import Results

EI = 2e4
SECTION = "E=2e7 A=0.1 I=1e-3"
#: members from I to J and what is at their ends
MEMBERS = {
    "column": ((0.0, 0.0), (0.0, 3.0), "", ""),
    "beam": ((0.0, 3.0), (4.0, 3.0), "END1=0.4", "PIN=J"),
    "joint": ((4.0, 0.0), (4.0, 3.0), "", "FJ=0,1e-4"),
}
AT = {"column": (1, 2), "beam": (2, 3), "joint": (4, 3)}


def frame(pieces: int) -> str:
    """A frame with masses at its two joints, each member in so many pieces of its flexible length."""
    nodes = ["1 0 0 FIX=XYR", "2 0 3", "3 4 3", "4 4 0 FIX=XYR"]
    elements, props = [], []
    for n, (name, (i, j, first, last)) in enumerate(MEMBERS.items(), 1):
        block = 0.4 if "END1" in first else 0.0
        start, end = np.array(i), np.array(j)
        along = (end - start) / np.hypot(*(end - start))
        start = start + block * along
        row = [AT[name][0], *(100 * n + k for k in range(1, pieces)), AT[name][1]]
        for k in range(1, pieces):
            x, y = (start + k / pieces * (end - start)).tolist()
            nodes.append(f"{row[k]} {x!r} {y!r}")
        for k, (a, b) in enumerate(pairwise(row)):
            elements.append(f"{100 * n + k} {name}{k} {a} {b}")
            ends = " ".join([first] * (k == 0) + [last] * (k == pieces - 1))
            props.append(f"{name}{k} FRAME {SECTION} {ends}")
    return "\n".join(
        [
            "NODES",
            *nodes,
            "ELEMENTS",
            *elements,
            "PROPS",
            *props,
            "WEIGHTS",
            "2,3 100",
            "ANALYSIS",
            "MODAL 3",
        ]
    )


def run(folder: Path, deck: str) -> Results:
    (folder / "frame.inp").write_text(deck, encoding="utf-8")
    return pound_solve.run(folder / "frame.inp")


def test_a_member_is_drawn_as_its_pieces_are(tmp_path: Path) -> None:
    """Blocks, pins and flexible joints included, in each mode."""
    (tmp_path / "fine").mkdir()
    with run(tmp_path, frame(1)) as coarse, run(tmp_path / "fine", frame(beams.PIECES)) as fine:
        s = geometry.DrawnStructure(coarse)
        pieces = geometry.DrawnStructure(fine)
        for mode in (1, 2, 3):
            shift, of_pieces = (
                geometry.mode_shift(x.table("mode_shapes")[x.table("mode_shapes")["mode"] == mode], 100.0)
                for x in (coarse, fine)
            )
            one, other = (np.concatenate([x.at(2), x.at(3)]) for x in (shift, of_pieces))
            scale = (one @ other) / (other @ other)  # the largest of either is that of other nodes
            for n, name in enumerate(MEMBERS, 1):
                line = s.beams[100 * n].line(s.place, shift)
                inner = [100 * n + k for k in range(1, beams.PIECES)]
                points = np.array([pieces.place[node] + scale * of_pieces.at(node) for node in inner])
                first = 2 if s.beams[100 * n].blocks[0] else 1
                assert line[first : first + len(inner)] == pytest.approx(points, abs=1e-6)
                assert line[0].tolist() == (s.place[AT[name][0]] + shift.at(AT[name][0])).tolist()
                assert line[-1] == pytest.approx(s.place[AT[name][1]] + shift.at(AT[name][1]))
                straight = np.linspace(line[0], line[-1], len(line))
                assert mode > 1 or np.abs(line - straight).max() > 0.05


CANTILEVERS = f"""
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 5 0 FIX=XYR
 4 5 3
ELEMENTS
 1 UP 1 2
 2 DOWN 4 3
PROPS
 UP FRAME {SECTION} END1=0.3 MI=40 KH=2e5 RULE=BILINEAR R=0.05
 DOWN FRAME {SECTION} MJ=40,-30 KH=2e5 RULE=BILINEAR R=0.05
WEIGHTS
 2,4 100
EQUAKE
 SINE AMPLITUDE=4 PERIOD=0.6
ANALYSIS
 HISTORY 1.5 METHOD=NEWMARK DT=0.001
OUTPUT
 EVERY=0.05
"""


def test_hinges_kink_members_as_they_have_turned(tmp_path: Path) -> None:
    """The curve between the ends has the moments that are stored, none at the tip."""
    with run(tmp_path, CANTILEVERS) as results:
        displaced = geometry.displacements(results)
        forces, labels = results.history("member/force"), results.labels("member/force")
        assert (results.table("spring_envelope")["ductility"] > 2.0).all()
        s = displaced.structure
        for row in range(len(results.time)):
            shift = displaced.shift(row)
            for element, foot in ((1, "I"), (2, "J")):
                beam = s.beams[element]
                bends = beam.bends(*beam.ends(s.place, shift), shift) / displaced.factor
                moments = EI / beam.length * np.array([[4.0, 2.0], [2.0, 4.0]]) @ bends
                stored = [forces[row, labels.index(f"{element} moment {end}")] for end in "IJ"]
                assert moments == pytest.approx(stored, rel=1e-6, abs=1e-5)
                assert stored["JI".index(foot)] == pytest.approx(0.0, abs=1e-6)


def test_many_members_and_those_with_an_unknown_end_are_straight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with run(tmp_path, CANTILEVERS + " NODES=1,2,3\n") as results:
        displaced = geometry.displacements(results)
        s, shift = displaced.structure, displaced.shift(displaced.row)
        path = s.path(shift).T
        assert path[:2].tolist() == [s.place[4].tolist(), s.place[3].tolist()] and np.isnan(path[2]).all()
        assert len(path) == 3 + (1 + beams.PIECES + 2) + 1  # the other has a rigid block
        assert path[3].tolist() == s.place[1].tolist()
        assert path[-2] == pytest.approx(s.place[2] + shift.at(2))
        monkeypatch.setattr(beams, "MOST", 1)
        assert geometry.DrawnStructure(results).path(shift).shape == (2, 6)
