"""Runs drawn over each other, and decks drawn without a run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pound_solve
from pound_solve.cli.main import main
from pound_solve.results import Results

pytest.importorskip("matplotlib")

from pound_solve.report import plot
from pound_solve.report.plot import PICTURES, ChoiceError, Nothing
from pound_solve.report.plot.overlay import run_names

#: two one-storey frames; the first has hinges
PAIR = """
TITLE two frames
UNITS kN {length} s
PARAM gap=0.01
NODES
 1 0 0 FIX=XYR
 2 4 0 FIX=XYR
 11 0 3
 12 4 3
 3 4.1 0 FIX=XYR
 13 4.1 3
 14 4.1 1.5
ELEMENTS
 1 COLUMN 1 11
 2 COLUMN 2 12
 3 MAST 3 14
 4 MAST 14 13
 11 BEAM 11 12
 {contact}
PROPS
 COLUMN FRAME E=28E6 A=0.16 I=6.4E-4 MI=80 MJ=60 LP=0.2 RULE=TAKEDA
 MAST FRAME E=28E6 A=0.11 I=8E-4
 BEAM FRAME E=28E6 A=0.11 I=8E-4
 {law}
MEMBER_LOADS
 11 WY=-12
 11 PY=-40 AT=0.25
LOADS
 13 3 -4 2
WEIGHTS
 11,12 120
 13 60
 14 5
DRIFT
 A 1 11
EQUAKE
 {motion}
ANALYSIS
 STATIC
 HISTORY 1 METHOD=NEWMARK DT=0.001
"""
CONTACT = {"contact": "90 POUND 12 13 NAME=floor", "law": "POUND CONTACT GAP=gap LAW=LINEAR K=2E5"}
SINE = "SINE AMPLITUDE=3 PERIOD=0.5"


def deck(folder: Path, contact: dict[str, str] = CONTACT, length: str = "m", motion: str = SINE) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "pair.inp"
    path.write_text(PAIR.format(length=length, motion=motion, **contact), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def runs(tmp_path_factory: Any) -> Iterator[list[Results]]:
    """With a gap of 10 mm, with one of 12 mm, and without a contact."""
    folder = tmp_path_factory.mktemp("runs")
    near = deck(folder)
    none = deck(folder / "none", {"contact": "", "law": ""})
    with (
        pound_solve.run(near) as a,
        pound_solve.run(near, params={"gap": "0.012"}, out=folder / "wide") as b,
        pound_solve.run(none) as c,
    ):
        yield [a, b, c]


def lines(axes: Any) -> list[np.ndarray]:
    return [np.column_stack(line.get_data()) for line in axes.get_lines()]


def test_each_run_has_its_curve_in_each_panel_that_it_has_values_for(runs: list[Results]) -> None:
    figure = plot.overlaid(runs, "histories")
    ground, drift, force = figure.axes
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["1 X", "A", "floor"]
    assert (len(lines(ground)), len(lines(drift)), len(lines(force))) == (3, 3, 2)
    for axes, name in ((drift, "drift"), (force, "contact/force")):
        for curve, run in zip(lines(axes), runs):
            t, values = run.course(name, jumps=True)
            assert np.array_equal(curve, np.column_stack([t, values[:, 0]]))
    colours = [[line.get_color() for line in axes.get_lines()] for axes in figure.axes]
    assert colours[0] == colours[1] and colours[2] == colours[0][:2] and len(set(colours[0])) == 3
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == run_names([run.path for run in runs])


def test_profiles_are_those_of_the_tables(runs: list[Results]) -> None:
    for axes, quantity in zip(plot.overlaid(runs, "storeys").axes, ("drift ratio", "shear")):
        factor = 100.0 if quantity == "drift ratio" else 1.0
        drawn = [x for x in lines(axes) if x.shape == (2, 2) and x[0, 1] != x[1, 1] and x[1, 1] == 3.0]
        expected = []
        for run in runs:
            table = run.table("storey_extremes")
            (row,) = table[(table["building"] == "building 1") & (table["quantity"] == quantity)]
            expected += [row["max"], row["min"]]
        assert [x[0, 0] for x in drawn] == pytest.approx([factor * x for x in expected])


def test_the_gap_and_the_force_of_a_contact_are_drawn_for_the_runs_that_have_it(
    runs: list[Results],
) -> None:
    for name, history in (("gaps", "contact/gap"), ("contact_force", "contact/force")):
        (axes,) = plot.overlaid(runs, name).axes
        assert len(lines(axes)) == 2
        for curve, run in zip(lines(axes), runs):
            assert np.array_equal(curve[:, 1], run.course(history, jumps=True)[1][:, 0])
    (axes,) = plot.picture(runs[0], "gaps").axes
    smallest = runs[0].table("contact_summary")["min_gap"][0]
    assert axes.get_title() == f"floor: initial 0.01 m, smallest {smallest:.4g} m" and smallest < 0.0


def test_columns_of_nodes_are_compared_by_their_numbers(runs: list[Results]) -> None:
    (axes,) = plot.overlaid(runs, "envelopes").axes
    assert axes.get_title() == "nodes 14 to 13"
    drawn = [x for x in lines(axes) if x[:, 1].tolist() == [1.5, 3.0]]
    expected = []
    for run in runs:
        table = run.table("node_envelope")
        rows = table[(table["direction"] == "X") & (table["quantity"] == "displacement")]
        of_node = {int(row["node"]): row for row in rows}
        expected += [[of_node[node][side] for node in (14, 13)] for side in ("min", "max")]
    assert np.array_equal([x[:, 0] for x in drawn], expected)


@pytest.mark.full
def test_every_overlay_of_two_runs_is_drawn_and_repeats(runs: list[Results], tmp_path: Path) -> None:
    names = plot.possible(runs)
    assert names == [p.name for p in PICTURES.values() if p.overlay and p.name != "capacity"]
    (first, left), (again, _) = (plot.draw(runs[:2], names, tmp_path / n) for n in "ab")
    assert not left
    assert all(a.read_bytes() == b.read_bytes() for a, b in zip(first, again, strict=True))
    assert first[-1].name.endswith("_gaps.svg") and "_vs_" in first[-1].name


def test_no_run_has_what_is_drawn(runs: list[Results]) -> None:
    with pytest.raises(Nothing):
        plot.overlaid([runs[2], runs[2]], "gaps")


def test_names_tell_runs_apart() -> None:
    assert run_names([Path("a/x.h5"), Path("b/y.h5")]) == ["x", "y"]
    assert run_names([Path("a/x.h5"), Path("b/x.h5")]) == ["a/x", "b/x"]
    assert run_names([Path("x.h5"), Path("x.h5")]) == ["x (1)", "x (2)"]


def test_runs_in_other_units_are_refused(runs: list[Results], tmp_path: Path) -> None:
    with (
        pound_solve.run(deck(tmp_path, length="mm")) as other,
        pytest.raises(ChoiceError, match="in the same units"),
    ):
        plot.overlaid([runs[0], other], "storeys")


def test_a_deck_is_drawn_without_a_run_and_without_its_record(tmp_path: Path, capsys: Any) -> None:
    path = deck(tmp_path, motion="RECORD no_such_record.txt DT=0.01 UNIT=G")
    assert main(["plot", str(path), "--set", "gap=0.015"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        str(tmp_path / f"pair_{name}.svg") for name in ("frame", "loads")
    ]
    assert "gap 0.015 m" in (tmp_path / "pair_frame.svg").read_text("utf-8")
    loads = (tmp_path / "pair_loads.svg").read_text("utf-8")
    assert all(text in loads for text in ("12 kN/m", "40 kN", "5 kN", "moment 2 kN*m"))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["pair.inp", "pair_frame.svg", "pair_loads.svg"]


def test_a_deck_with_a_performance_point_is_drawn_without_its_motion(tmp_path: Path) -> None:
    path = deck(tmp_path)
    path.write_text(
        path.read_text("utf-8") + 'ANALYSIS\n PUSHOVER 11 0.06 TC=0.3 BUILDING="building 1"\n', "utf-8"
    )
    assert main(["check", str(path)]) == 0
    assert main(["plot", str(path), "frame"]) == 0


def test_a_deck_with_mistakes_tells_them_all(tmp_path: Path, capsys: Any) -> None:
    path = deck(tmp_path)
    path.write_text(path.read_text().replace("I=8E-4", "I=x").replace("2 4 0", "2 4 y"), "utf-8")
    assert main(["plot", str(path)]) == 2
    assert capsys.readouterr().err.count(" error ") == 3


def test_hinges_and_loads_stand_where_they_act(runs: list[Results]) -> None:
    (axes,) = plot.picture(runs[0], "frame").axes
    rings = next(x for x in axes.get_lines() if x.get_markerfacecolor() == "white")
    assert len(rings.get_xdata()) == 4 == len(runs[0].table("springs"))
    (axes,) = plot.picture(runs[0], "loads").axes
    arrows = [(t.xyann, t.xy) for t in axes.texts if t.arrow_patch is not None and not t.get_text()]
    point = [(np.subtract(head, tail), head) for tail, head in arrows if head == (1.0, 3.0)]
    assert [(way[0], np.sign(way[1])) for way, _ in point] == [(0.0, -1.0)]
    (way,) = [np.subtract(head, tail) for tail, head in arrows if head[1] == 3.0 and head[0] > 4.0 + 1e-9]
    assert way / np.hypot(*way) == pytest.approx([0.6, -0.8])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["{h5}", "{h5}", "energy"], "the picture energy shows one run: choose from"),
        (
            ["{inp}", "energy"],
            "the picture energy shows a run, and this is a deck: choose from frame, loads",
        ),
        (["{inp}", "{h5}"], "is a deck: runs are drawn over each other from their results files"),
        (["{h5}", "--set", "gap=1"], "--set and --records belong to a deck"),
        (["{h5}", "{h5}", "gaps", "--member", "floor"], "--member belongs to pictures of one run"),
        (["{h5}", "--over", "gap"], "--over belongs to a sweep"),
        (["{h5}", "nonsense"], "there is no picture nonsense: choose from summary"),
    ],
)
def test_what_does_not_go_together_is_told(
    runs: list[Results], capsys: Any, words: list[str], told: str
) -> None:
    h5 = runs[0].path
    assert main(["plot", *(w.format(h5=h5, inp=h5.with_suffix(".inp")) for w in words)]) == 2
    assert told in capsys.readouterr().err
