"""``pound-solve loop``: the path of a law worked by hand, its drawings, and what is said of mistakes."""

from __future__ import annotations

import builtins
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pound_solve.assess.law_test import (
    AXES,
    LawTestError,
    LoopPoint,
    law_of,
    protocol,
    specimen,
    table,
    trace,
)
from pound_solve.catalog import specs
from pound_solve.cli.main import main
from pound_solve.laws.automaton import Law, drive, transitions
from pound_solve.report import text_plot
from samples import has_loop

LAWS = [s for s in specs() if s.family in AXES and has_loop(s)]


def law(name: str, *items: str) -> Law:
    return specimen(law_of(name), items)[0].law


def corners(points: tuple[LoopPoint, ...]) -> list[tuple[float, float, str]]:
    return [(p.d, p.f, p.branch) for p in points]


# ---------------------------------------------------------------- the path of a law


def test_bilinear_by_hand() -> None:
    """k = 100, Fy = 5, r = 0.1: yields at 0.05, hardens with 10, unloads by 2 Fy / k = 0.1."""
    found = trace(law("BILINEAR", "KX=100", "FX=5", "R=0.1"), [0.15, -0.02, 0.02])
    d, f, names = zip(*corners(found.corners))
    assert d == pytest.approx([0, 0.05, 0.15, 0.05, -0.02, 0.02], abs=1e-15)
    assert f == pytest.approx([0, 5, 6, -4, -4.7, -0.7], abs=1e-12)
    assert names == ("elastic", "elastic", "yielding +", "elastic", "yielding -", "elastic")
    assert [p.turn for p in found.corners] == [False, False, True, False, True, True]
    # areas under the path
    work = [0, 0.125, 0.675, 0.575, 0.575 + 0.3045, 0.8795 - 0.5 * (4.7 + 0.7) * 0.04]
    assert [p.work for p in found.corners] == pytest.approx(work, abs=1e-13)
    assert [p.stored for p in found.corners] == pytest.approx([x * x / 200 for x in f], abs=1e-13)


def test_unequal_yield_forces() -> None:
    found = trace(law("BILINEAR", "FX=1,-0.5", "R=0.1"), [3.0, -1.5, 2.0])
    assert [(p.d, p.f) for p in found.corners] == [
        pytest.approx(p, abs=1e-14)
        for p in ((0, 0), (1, 1), (3, 1.2), (1.5, -0.3), (-1.5, -0.6), (0, 0.9), (2, 1.1))
    ]


def test_kelvin_voigt_at_a_rate_by_hand() -> None:
    """k = 1, c v = 0.2: jumps to 0.2 at touch, 1.2 and 0.8 at the turn, lets go at an overlap of 0.2."""
    found = trace(law("KELVIN_VOIGT", "C=0.4"), [1.0, -0.5], rate=0.5)
    assert corners(found.corners) == [
        (0, 0, "open"),
        (1, pytest.approx(1.2), "pressed"),
        (pytest.approx(0.2), pytest.approx(0, abs=1e-15), "pressed"),
        (0, 0, "released"),
        (-0.5, 0, "open"),
    ]
    f = dict.fromkeys([0.0, 1.0], ())
    for d, x in found.curve:
        if d in f:
            f[d] = (*f[d], round(x, 12))
    assert f[0.0][:2] == (0.0, 0.2) and f[1.0] == (1.2, 0.8)
    # closing puts in 0.7, of which the spring has 0.5; opening gives 0.32 back, the rest is lost
    assert [p.work for p in found.corners] == pytest.approx([0, 0.7, 0.38, 0.38, 0.38])
    assert [p.lost for p in found.corners] == pytest.approx([0, 0.2, 0.36, 0.38, 0.38])


def test_with_tension_it_pulls_before_it_parts() -> None:
    found = trace(law("KELVIN_VOIGT", "C=0.4", "TENSION=YES", "GAP=0.3"), [1.3, 0.0], rate=0.5)
    assert corners(found.corners)[-2:] == [
        (pytest.approx(0.3), pytest.approx(-0.2), "pressed"),
        (0, 0, "open"),
    ]


@pytest.mark.parametrize("spec", LAWS, ids=lambda s: s.name)
def test_every_law_is_driven_to_its_end(spec: Any) -> None:
    """The corners agree with a path followed without them, and the work with the area under the curve."""
    spring, _ = specimen(spec)
    path, rate = protocol(spring), float(spring.role.reports_damping)
    found = trace(spring.law, path, rate)
    assert [p.d for p in found.corners if p.turn] == path
    ends = [p for p in found.corners if p.turn]
    if not spring.role.reports_damping:
        state, d = spring.law.start(), 0.0
        for p, goal in zip(ends, path):
            state, d = drive(spring.law, state, d, goal), goal
            assert p.f == pytest.approx(spring.law.force(state, d)[0], abs=1e-12)
            assert p.work == pytest.approx(spring.law.work(state, d), abs=1e-12)
    x, f = np.array(found.curve).T
    area = float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))
    assert area == pytest.approx(ends[-1].work, rel=1e-2 if spring.law.curved else 1e-12)
    for p in found.corners:
        assert p.work == pytest.approx(p.stored + p.lost, abs=1e-9)


@given(st.lists(st.floats(-5, 5), min_size=1, max_size=8), st.floats(0.0, 3.0), st.floats(0.0, 2.0))
@example([2.0, 1.625, 1.75], 1.0, 2.0)  # let go with overlap left, pressed again before it is gone
def test_rates_lose_energy_in_the_dashpot(path: list[float], rate: float, c: float) -> None:
    """Whatever the path: work is what is stored and lost, the loss never falls, the force never pulls."""
    found = trace(law("KELVIN_VOIGT", f"C={c!r}", "GAP=0.5"), path, rate)
    lost = [p.lost for p in found.corners]
    assert all(b >= a - 1e-12 for a, b in pairwise(lost))
    assert min(f for _, f in found.curve) > -1e-12 * (1 + c * rate)


def test_an_infinitely_slow_path_is_that_of_follow() -> None:
    """`drive` and `transitions` are one: the last state is the same, and each change has its place."""
    own = law("BILINEAR_SLACK", "SLACK=0.4", "R=0.1")
    seen = list(transitions(own, own.start(), 0.0, 3.0))
    assert [d for d, _ in seen] == pytest.approx([0.4, 1.4])
    assert seen[-1][1] == drive(own, own.start(), 0.0, 3.0)


# ---------------------------------------------------------------- specimens


def test_items_are_those_of_a_deck_and_the_sample_serves_without_any() -> None:
    assert specimen(law_of("takeda"))[1] == "KX=1 FX=1 R=0.05 ALFA=0.4 BETA=0.3"
    assert specimen(law_of("takeda"), ["alfa=0.2"])[1] == "KX=1 FX=1 alfa=0.2"
    assert specimen(law_of("BILINEAR"), ["fx = 3", "KX=2*3"])[1] == "fx = 3 KX=2*3"
    spring, items = specimen(law_of("contact KELVIN_VOIGT"), ["E=0.5"])
    assert items == "GAP=0 MASSES=2,2 K=1 E=0.5" and spring.facts["reduced_mass"] == 1.0


@pytest.mark.parametrize("spec", LAWS, ids=lambda s: s.name)
def test_samples_are_items_of_their_law(spec: Any) -> None:
    """A sample names only items of its own law: what the specimen is given besides is not in it."""
    own = {f.name for f in spec.fields}
    assert {item.split("=")[0] for item in spec.sample.split()} <= own
    required = {f.name for f in spec.fields if repr(f.default) == "REQUIRED"} - {"K"}
    assert required <= {item.split("=")[0] for item in spec.sample.split()}


def test_protocols() -> None:
    spring, _ = specimen(law_of("BILINEAR"), ["KX=100", "FX=5,-2"])
    cycles = [mu * d for mu in (0.5, 1, 2, 4, 6) for d in (0.05, -0.02)]
    assert protocol(spring) == pytest.approx([*cycles, 0.0])
    assert protocol(specimen(law_of("LINEAR"), ["GAP=0.3"])[0]) == pytest.approx([1.3, -0.2, 2.3, -0.2])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["GUESS"], "no law GUESS: there are hysteresis: BILINEAR"),
        (["BILINAER"], "did you mean BILINEAR?"),
        (["contact", "TAKEDA"], "no law TAKEDA: there are contact: "),
        (["FLUID"], "FLUID is of the family damper: only"),
        (["ELASTIC"], "straight line"),
        (["TAKEDA", "ALF=1"], "loop:7:36: error P211"),
        (["TAKEDA", "ALFA=9"], "must be at least 0 and at most 1"),
        (["BILINEAR", "R"], "P215"),
        (["KELVIN_VOIGT", "C=1", "E=0.5"], "give the damping once"),
        (["BILINEAR", "FX=-1,1"], "needs a positive value, then a negative one"),
        (["BILINEAR", "--path", "1,x"], "x is no number"),
        (["BILINEAR", "--path", "1,inf"], "no finite number"),
        (["BILINEAR", "--path", ""], "one deformation at least"),
        (["BILINEAR", "--path", "1", "--file", "f"], "not both"),
        (["ELASTO_PLASTIC", "FX=0"], "--path"),
    ],
)
def test_mistakes_are_told_in_words(words: list[str], told: str, capsys: Any) -> None:
    assert main(["loop", *words]) == 2
    out, err = capsys.readouterr()
    assert told in err and not out and "Traceback" not in err


def test_what_is_no_specimen_raises() -> None:
    with pytest.raises(LawTestError, match="straight line"):
        specimen(law_of("ELASTIC"))


# ---------------------------------------------------------------- the verb


def test_the_verb_prints_items_table_and_drawing(capsys: Any) -> None:
    assert main(["loop", "BILINEAR", "R=0.1", "--path", "2,-1"]) == 0
    text = capsys.readouterr().out
    assert text.split("\n\n")[:2] == [
        "BILINEAR KX=1 FX=1 R=0.1",
        "deformation  force  work  stored  dissipated  branch\n"
        "          0      0     0       0           0  elastic\n"
        "          1      1   0.5     0.5           0  elastic\n"
        "          2    1.1  1.55   0.605       0.945  yielding +  turn\n"
        "          0   -0.9  1.35   0.405       0.945  elastic\n"
        "         -1     -1   2.3     0.5         1.8  yielding -  turn",
    ]
    drawing = text.split("\n\n")[2].rstrip("\n").splitlines()
    assert len(drawing) == 23 and all(len(line) <= 78 for line in drawing)


def test_a_path_from_a_file_is_that_of_the_line(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "turns.txt"
    path.write_text("# cycles\n2\n-1, 1.5   # and back\n\n0\n")
    assert main(["loop", "TAKEDA", "--file", str(path)]) == 0
    by_file = capsys.readouterr().out
    assert main(["loop", "TAKEDA", "--path", "2,-1,1.5,0"]) == 0
    assert capsys.readouterr().out == by_file
    assert main(["loop", "TAKEDA", "--file", str(tmp_path / "none")]) == 3


def test_a_contact_law_goes_at_unit_rate(capsys: Any) -> None:
    texts = []
    for rate in ([], ["--rate", "1"], ["--rate", "0.5"]):
        assert main(["loop", "KELVIN_VOIGT", "C=0.4", *rate]) == 0
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1] != texts[2]


def test_pictures_go_into_files(tmp_path: Path, capsys: Any) -> None:
    pytest.importorskip("matplotlib")
    png, svg = tmp_path / "a.png", tmp_path / "a.svg"
    assert main(["loop", "BOUC_WEN", "--png", str(png), "--svg", str(svg)]) == 0
    assert png.read_bytes().startswith(b"\x89PNG") and svg.read_text().startswith("<svg")
    assert main(["loop", "LINEAR", "--png", str(tmp_path / "no/such/folder.png")]) == 3


def test_without_matplotlib_it_says_how_to_get_it(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    assert main(["loop", "LINEAR", "--png", str(tmp_path / "a.png")]) == 2
    assert "pound-solve[plot]" in capsys.readouterr().err


# ---------------------------------------------------------------- drawings


def test_letters_put_the_curve_where_it_is() -> None:
    text = text_plot.letters([(-1.0, -2.0), (1.0, 2.0)], width=21, height=9)
    lines = text.splitlines()
    assert lines[0].startswith(" 2 ") and lines[0].endswith("*") and len(lines[0]) == 3 + 21
    assert lines[4].split()[0] == "0" and lines[4].count("*") >= 1
    assert lines[8].startswith("-2 *") and lines[9].split() == ["-1", "0", "1"]
    assert lines[0].index("|") == lines[9].index("0") == 3 + 10


def test_a_curve_of_no_height_is_drawn_too() -> None:
    assert "*" * 30 in text_plot.letters([(0.0, 0.0), (1.0, 0.0)], width=30, height=5)
    assert text_plot.svg([(0.0, 0.0), (1.0, 0.0)], "flat", "x", "y").count("<path") > 5


def test_svg_keeps_every_corner_and_no_more() -> None:
    """Points along a straight line are left out, turning points on the same line are not."""
    line = [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0), (1.0, 1.0), (4.0, 0.0)]
    path = text_plot.svg(line, "t", "x", "y").split('class="c" d="')[1].split('"')[0]
    assert path.count("L") == 3
    assert "a &lt; b" in text_plot.svg(line, "a < b", "x", "y")


def test_ticks_are_round() -> None:
    for low, high in ((-6.3, 6.3), (0.0, 0.013), (-1e6, 2.0), (3.1, 3.2)):
        ticks = [float(x) for x in text_plot._ticks(low, high)]
        steps = np.diff(ticks)
        assert 3 <= len(ticks) <= 9 and low <= ticks[0] and ticks[-1] <= high
        assert steps == pytest.approx(steps[0])
        mantissa = steps[0] / 10 ** math.floor(math.log10(steps[0]) + 1e-9)
        assert min(abs(mantissa - m) for m in (1, 2, 5)) < 1e-6


def test_rounding_is_printed_as_nought() -> None:
    text = table(
        [LoopPoint(1.0, 5e-17, "a", 1.0, 2e-33, 1.0, True), LoopPoint(2.0, 1.0, "b", 2.0, 1.0, 1.0, False)]
    )
    assert text.splitlines()[1].split() == ["1", "0", "1", "0", "1", "a", "turn"]
