"""Pictures of a results file: which can be drawn, what they show, and that they repeat to the byte."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pound_solve
from decks import NAMED
from pound_solve.cli.main import main

pytest.importorskip("matplotlib")

from gallery import FILES, FOLDER
from output import sample
from pound_solve.report import plot
from pound_solve.report.plot import PICTURES, style
from pound_solve.results import Results, Writer
from tiers import at_night

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def results(tmp_path_factory: Any) -> Any:
    deck = ROOT / "examples" / "01_two_oscillators" / "two_oscillators.inp"
    with pound_solve.run(deck, out=tmp_path_factory.mktemp("run")) as out:
        yield out


def lines(axes: Any) -> list[np.ndarray]:
    return [np.column_stack(line.get_data()) for line in axes.get_lines()]


def test_every_picture_is_a_module_with_its_paragraph_in_the_manual() -> None:
    page = (ROOT / "manual" / "plots.md").read_text("utf-8")
    sections = [line.removeprefix("### ").strip("`") for line in page.splitlines() if line[:4] == "### "]
    assert sections == list(PICTURES)
    shown = re.findall(r"^### `(\w+)`\n(?:(?!^### ).*\n)*?!\[.*?\]\(pictures/(.*?)\)", page, re.MULTILINE)
    assert dict(shown) == FILES and all((FOLDER / file).stat().st_size > 2000 for file in FILES.values())
    folder = Path(style.__file__).parent / "pictures"
    assert {p.stem for p in folder.glob("[!_]*.py")} == set(PICTURES)


def test_the_pictures_are_listed(capsys: Any) -> None:
    assert main(["plot"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(PICTURES)


@pytest.mark.full
@pytest.mark.parametrize(
    ("ending", "count"), [("svg", 3), *at_night(("png", 1), ("svg", None), ("png", None), ("pdf", None))]
)
def test_every_picture_is_drawn_and_repeats(
    results: Results, tmp_path: Path, ending: str, count: int | None
) -> None:
    names = plot.possible(results)
    assert {"frame", "histories", "energy", "contacts", "collisions"} <= set(names)
    names = [name for name in names if name not in ("loads", "loops", "interaction", "hinges", "diagrams")]
    names = names[:count]  # springs alone, without loads
    first, left_out = plot.draw(results, names, tmp_path / "a", ending)
    again, _ = plot.draw(results, names, tmp_path / "b", ending)
    assert len(first) == len(names) and not left_out
    for a, b in zip(first, again):
        assert a.read_bytes() == b.read_bytes(), a.name
        assert a.stat().st_size > 5000


def test_the_frame_has_all_nodes_and_contacts(results: Results) -> None:
    figure = plot.picture(results, "frame")
    texts = {t.get_text() for t in figure.axes[0].texts}
    nodes = results.table("nodes")
    assert {str(n) for n in nodes["node"]} <= texts
    contacts = [e for e in results.table("elements") if e["kind"] == "CONTACT"]
    gaps = results.table("contact_laws")["gap"]
    assert {f"{e['name'] or e['element']}\ngap {gap:.4g} m" for e, gap in zip(contacts, gaps)} <= texts


def test_histories_are_those_of_the_file(results: Results) -> None:
    figure = plot.picture(results, "histories")
    drawn = [lines(axes) for axes in figure.axes]
    for name, curves in zip(("ground", "drift"), drawn):
        t, values = results.course(name)
        assert len(curves) == values.shape[1]
        for curve, column in zip(curves, values.T):
            assert np.array_equal(curve, np.column_stack([t, column]))
    peaks = results.table("contact_summary")["peak_force"]
    assert np.allclose(results.course("contact/force")[1].max(axis=0), peaks, rtol=1e-9)


def test_energies_pile_up_to_the_input(results: Results) -> None:
    axes = plot.picture(results, "energy").axes[0]
    top = axes.collections[-1].get_paths()[0].vertices[:, 1].max()
    assert top == pytest.approx(results.history("energy")[:, 0].max(), rel=1e-6)


LOADED = """
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=Y
ELEMENTS
 1 FOOT 1 2
PROPS
 FOOT SPRING KX=100 KR=50 FX=1 MR=1 RULE=BILINEAR
WEIGHTS
 2 1 0 1
LOADS
 2 0.5 0 0.2
EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.7
ANALYSIS
 STATIC
 HISTORY 1
"""


def test_a_loaded_structure_starts_with_energy_and_turns_in_radians(tmp_path: Path) -> None:
    deck = tmp_path / "loaded.inp"
    deck.write_text(LOADED, encoding="utf-8")
    with pound_solve.run(deck, out=tmp_path) as results:
        axes = plot.picture(results, "energy").axes[0]
        strain = 0.5 * (0.5**2 / 100 + 0.2**2 / 50)
        (line,) = lines(axes)
        assert line[0, 1] == pytest.approx(strain)
        # the pile and the line stay together: nothing is lost
        top = axes.collections[-1].get_paths()[0].vertices[:, 1].max()
        assert top == pytest.approx(line[:, 1].max(), rel=1e-6) and top > 2 * strain
        across, turn = plot.picture(results, "loops", plot.Choice(("1",))).axes[:2]
        assert (across.get_xlabel(), across.get_ylabel()) == ("deformation [m]", "force [kN]")
        assert (turn.get_xlabel(), turn.get_ylabel()) == ("rotation [rad]", "moment [kN*m]")
        assert results.history_units("node/a")[:3] == ("m/s^2", "m/s^2", "rad/s^2")


def test_every_collision_is_marked(results: Results) -> None:
    figure = plot.picture(results, "collisions")
    marked = np.concatenate([c for c in lines(figure.axes[0]) if len(c)])
    table = results.table("collisions")
    assert sorted(marked[:, 0]) == pytest.approx(sorted(table["t_peak"]))
    assert sorted(marked[:, 1]) == pytest.approx(sorted(table["peak_force"]))


def test_what_cannot_be_drawn_is_said(results: Results, tmp_path: Path, capsys: Any) -> None:
    file = str(results.path)
    assert main(["plot", file, "nonsense"]) == 2
    assert "nonsense" in capsys.readouterr().err
    lacking = [name for name in PICTURES if name not in plot.possible(results)]
    if lacking:
        assert main(["plot", file, lacking[0]]) == 2
        assert "lacks" in capsys.readouterr().err
    assert main(["plot", str(tmp_path / "none.h5")]) == 3
    assert main(["plot", file, "energy", "-o", str(tmp_path / "pictures"), "--as", "png"]) == 0
    assert (tmp_path / "pictures" / "two_oscillators_energy.png").exists()


ALONE = """
UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 {place} FIX=YR
 3 {beyond} FIX=YR
ELEMENTS
 1 COLUMN 1 2
 2 WALL   2
 3 COLUMN 2 3
PROPS
 COLUMN SPRING KX=4000
 WALL   CONTACT GAP=0.01 ANGLE={angle} K=1E6
WEIGHTS
 2,3 981
EQUAKE
 SINE AMPLITUDE=2 PERIOD=1 DURATION=2
{drift}
ANALYSIS
 HISTORY 1 {method}
"""


def alone(folder: Path, method: str = "", upright: bool = False, angle: int = 0, drift: str = "") -> Path:
    """Results of two masses in a row, or above each other, the first of which meets a wall."""
    place, beyond = ("0 3", "0 6") if upright else ("3 0", "6 0")
    deck = folder / "alone.inp"
    words = ALONE.format(method=method, place=place, beyond=beyond, angle=angle, drift=drift)
    deck.write_text(words, encoding="utf-8")
    pound_solve.run(deck, out=folder).close()
    return folder / "alone.h5"


def test_of_a_run_that_stopped_at_its_start_all_is_drawn_and_exported_that_is_there(
    tmp_path: Path, capsys: Any
) -> None:
    file = str(alone(tmp_path, "METHOD=CENTRAL DT=1"))
    capsys.readouterr()
    assert main(["plot", file]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines() == [str(tmp_path / f"alone_{name}.svg") for name in ("summary", "frame")]
    told = "pound-solve: left out, nothing to draw: loads (no static loads); deformed, histories, "
    assert err.startswith(told) and "(no history)" in err and len(err.splitlines()) == 1
    assert main(["plot", file, "energy"]) == 2  # nothing at all
    assert "energy (no history)" in capsys.readouterr().err
    assert main(["export", file]) == 0
    text = (tmp_path / "alone" / "history_contact_gap.csv").read_text("utf-8")
    assert text == "time [s],2 [m]\n"


@pytest.mark.full
def test_envelopes_show_what_there_is(tmp_path: Path, capsys: Any) -> None:
    with Results.open(alone(tmp_path)) as results, pytest.raises(plot.Nothing, match="no columns"):
        plot.picture(results, "envelopes")
    assert main(["plot", str(results.path)]) == 0
    assert "envelopes (no drifts, no columns of nodes)" in capsys.readouterr().err
    assert not (tmp_path / "alone_envelopes.svg").exists()
    drift = "DRIFT\n top 1 2"
    for upright, cards, titles in (
        (True, "", ["displacements"]),
        (False, drift, ["drifts"]),
        (True, drift, ["drifts", "displacements"]),
    ):
        with Results.open(alone(tmp_path, upright=upright, drift=cards)) as results:
            axes = plot.picture(results, "envelopes").axes
            assert len(axes) == len(titles) and all(w in a.get_title() for w, a in zip(titles, axes))
            table = results.table("node_envelope")
    # the column's line is that of the table: extremes along X of nodes 2 and 3
    own = table[(table["direction"] == "X") & (table["quantity"] == "displacement")]
    low, high = lines(axes[1])[:2]
    assert own["node"].tolist() == [2, 3]
    assert np.array_equal(low, np.column_stack([own["min"], [3.0, 6.0]]))
    assert np.array_equal(high, np.column_stack([own["max"], [3.0, 6.0]]))


@pytest.mark.full
@pytest.mark.parametrize(
    ("angle", "way"), [(0, (1, 0)), (180, (-1, 0)), (60, (0.5, 0.75**0.5)), (-30, (0.75**0.5, -0.5))]
)
def test_a_wall_stands_on_its_side(tmp_path: Path, angle: int, way: tuple[float, float]) -> None:
    with Results.open(alone(tmp_path, angle=angle)) as results:
        figure = plot.picture(results, "frame")
    link, wall, *hatches = [x for x in figure.axes[0].get_lines() if x.get_color() == style.RED]
    start, front = np.column_stack(link.get_data())
    ends = np.column_stack(wall.get_data())
    assert start.tolist() == [3.0, 0.0]
    ahead = (front - start) / np.linalg.norm(front - start)
    assert ahead == pytest.approx(way, abs=1e-12)
    assert ends.mean(axis=0) == pytest.approx(front) and (ends[1] - ends[0]) @ ahead == pytest.approx(0.0)
    assert len(hatches) > 3
    for hatch in hatches:  # behind the wall
        behind = (np.column_stack(hatch.get_data()) - front) @ ahead
        assert behind[0] == pytest.approx(0.0, abs=1e-12) and behind[1] > 0.0
    (x0, x1), (y0, y1) = figure.axes[0].get_xlim(), figure.axes[0].get_ylim()
    assert all(x0 < x < x1 and y0 < y < y1 for x, y in ends)


@pytest.mark.full
@pytest.mark.parametrize(
    "seconds", [(0.03, 0.05, 0.2), (0.025, 0.1, 0.25), (0.9, 1.1, 1.3), (0.02, 0.3, 40.0)]
)
def test_numbers_at_the_axes_of_a_study_do_not_touch(tmp_path: Path, seconds: tuple[float, ...]) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    with Writer(tmp_path / "x.h5", title="x", units=sample.UNITS, program_version="0") as writer:
        found = zip(seconds, (400, 800, 1600), (4e-2, 9e-3, 2.2e-3))
        runs = [("NEWMARK", "", t, n, 0, e, np.nan, np.nan, 2.0, 1, 0.0) for t, n, e in found]
        writer.table("study", runs)
        writer.table("study_advice", [(0.01, "NEWMARK", "", 0.04, 9e-3, 9e-3)])
        writer.finish("done")
    with Results.open(tmp_path / "x.h5") as results:
        figure = plot.picture(results, "study")
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes:
        for axis, way in ((axes.xaxis, 0), (axes.yaxis, 1)):
            low, high = sorted(axis.get_view_interval())
            shown = [
                label.get_window_extent().get_points()[:, way]
                for minor in (False, True)
                for place, label in zip(axis.get_ticklocs(minor=minor), axis.get_ticklabels(minor=minor))
                if label.get_visible() and label.get_text() and low <= place <= high
            ]
            shown.sort(key=lambda ends: ends[0])
            assert len(shown) >= 2
            assert all(a[1] < b[0] for a, b in pairwise(shown))


@pytest.mark.full
def test_names_of_a_deck_are_no_formulas(tmp_path: Path) -> None:
    deck = alone(tmp_path, drift='DRIFT\n "cost $x_1$ and $\\frac" 1 2\n').with_suffix(".inp")
    deck.write_text("TITLE $\\badcommand in $ and $\n" + deck.read_text())
    with pound_solve.run(deck) as results:
        for name in ("envelopes", "frame"):
            plot.draw_into(results, name, tmp_path / f"{name}.svg")
    assert "cost $x_1$ and $\\frac" in (tmp_path / "envelopes.svg").read_text()


@pytest.mark.full
def test_names_that_the_layout_measures_are_no_formulas(tmp_path: Path) -> None:
    """A character without a glyph is a box, without a warning."""
    deck = tmp_path / "named.inp"
    deck.write_text(NAMED.format("$\\frac{1}{0$ \u4e2d\u000c", *["$\\alpha_{$"] * 4), encoding="utf-8")
    with pound_solve.run(deck) as results:
        for ending in ("svg", "png"):
            plot.draw_into(results, "summary", tmp_path / f"summary.{ending}")
    assert "$\\alpha_{$" in (tmp_path / "summary.svg").read_text("utf-8")


BARE = """NODES
 1 0 0 {fix}
 2 1 0 FIX=YR
ELEMENTS
 {elements}
PROPS
 S SPRING KX=200
 W CONTACT GAP=0.01 LAW=LINEAR K=1E5
WEIGHTS
 1,2 2
GRAVITY 9.81
INITIAL
 {node} VX=2
ANALYSIS
 HISTORY {end} METHOD=EXACT
"""


@pytest.mark.full
@pytest.mark.parametrize(
    ("fix", "elements", "node", "end"),
    [("FIX=YR", "1 W 1 2", 1, 1.0), *at_night(("FIX=XYR", "1 S 1 2", 2, 0.1), ("FIX=YR", "1 W 2", 2, 0.1))],
    ids=["two bodies", "no contact", "a body at a wall"],
)
def test_every_picture_of_a_bare_structure_is_drawn_or_says_that_there_is_nothing(
    tmp_path: Path, fix: str, elements: str, node: int, end: float
) -> None:
    deck = tmp_path / "bare.inp"
    deck.write_text(BARE.format(fix=fix, elements=elements, node=node, end=end))
    with pound_solve.run(deck) as results:
        for ending in ("svg", "html"):
            drawn, _ = plot.draw(results, plot.possible(results, ending), tmp_path, ending)
            assert all(path.stat().st_size for path in drawn)
            assert {"bare_frame.svg", "bare_deformed.svg"} <= {p.name for p in drawn} or ending == "html"
