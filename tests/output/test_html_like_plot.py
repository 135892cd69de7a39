"""Pictures of the page show the numbers of the pictures that `plot` draws."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pound_solve
from output.test_picture_contents import COLUMN, PAIR

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex

from pound_solve.report import plot
from pound_solve.report.html.members import CELLS, bends, orbits
from pound_solve.report.html.methods import errors_of_methods
from pound_solve.report.html.peaks import columns_of_nodes
from pound_solve.report.html.picture import MOST_POINTS, PlotlyPicture
from pound_solve.report.html.pictures import pictures
from pound_solve.report.plot.pictures import storeys
from pound_solve.report.plot.pictures.hinges import COLOURS
from pound_solve.results import Results
from unit.test_reactions import STACK

Points = set[tuple[float, float]]


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Results]:
    deck = tmp_path_factory.mktemp("pair") / "pair.inp"
    deck.write_text(PAIR, encoding="utf-8")
    with pound_solve.run(deck) as results:
        yield results


@pytest.fixture(scope="module")
def drawn(pair: Results) -> Callable[[str], PlotlyPicture]:
    """The pictures of the page by their titles."""
    by_title = cache(lambda: {p.title: p for p in pictures(pair)})
    return lambda title: by_title()[title]


def points(x: Any, y: Any) -> Points:
    """Points of a curve, of the digits that the page keeps."""
    pairs = zip(np.array(x, float).tolist(), np.array(y, float).tolist())
    return {(float(f"{a:.7g}"), float(f"{b:.7g}")) for a, b in pairs if np.isfinite(a) and np.isfinite(b)}


def of_page(trace: dict[str, Any]) -> Points:
    return points(trace["x"], trace["y"])


def of_lines(lines: Any) -> Points:
    return set[tuple[float, float]]().union(*(points(*line.get_data()) for line in lines))


def test_displacements_over_the_height() -> None:
    two = STACK.format(h=3, joint=4.5, light=20, roof=50, names="")
    motion = "EQUAKE\n SINE AMPLITUDE=4 PERIOD=0.5 DURATION=0.4\n"
    deck = f"UNITS kN m s\nGRAVITY 10\n{two}{motion}ANALYSIS\n HISTORY 0.5 METHOD=EXACT\n"
    with pound_solve.run(pound_solve.Deck(deck)) as results:
        (picture,), figure = columns_of_nodes(results), plot.picture(results, "envelopes")
    right, left = picture.traces
    lines = figure.axes[-1].lines[:-1]  # the last is that at zero
    assert of_page(left) == of_lines(lines[::2]) and of_page(right) == of_lines(lines[1::2])
    assert len(of_page(left)) > 2 and of_page(left) != of_page(right)
    assert len(right["text"]) == len(right["x"]) and right["text"][0].startswith("node ")


def test_loads(pair: Results, drawn: Callable[[str], PlotlyPicture]) -> None:
    _, arrows, combs, values = drawn("Static loads").traces
    axes = plot.picture(pair, "loads").axes[0]
    heads = [t for t in axes.texts if getattr(t, "arrow_patch", None) is not None and not t.get_text()]
    assert len(heads) > 7
    at = np.array(arrows["marker"]["size"]) > 0
    assert of_page({"x": np.array(arrows["x"])[at], "y": np.array(arrows["y"])[at]}) == points(
        *zip(*(t.xy for t in heads))
    )
    assert of_page(combs) <= of_page(arrows)
    assert sorted(values["text"]) == sorted(t.get_text() for t in axes.texts if t.get_text())


@pytest.mark.parametrize("n, name", [(0, "bending moment M"), (1, "shear force V"), (2, "axial force N")])
def test_diagrams(pair: Results, drawn: Callable[[str], PlotlyPicture], n: int, name: str) -> None:
    unit = "kN*m" if n == 0 else "kN"
    picture = drawn(f"Envelopes of the member forces: {name} [{unit}]")
    _, largest, smallest, ends = picture.traces
    axes = plot.picture(pair, "diagrams").axes[n]
    low, high = re.search(r": (\S+) to (\S+)\n", axes.get_title()).groups()  # type: ignore[union-attr]
    assert ends["text"] == [high, low] and picture.note.startswith(f"From {low} to {high} {unit}.")
    outlines = [line for line in axes.lines if len(line.get_xdata()) > 20]
    there = of_lines(outlines)
    for trace, value, furthest in ((largest, high, max), (smallest, low, min)):
        shown = of_page(trace)
        assert shown <= there and len(shown) < len(there)
        texts = [float(text.split(": ")[1]) for text in trace["text"] if text]
        assert furthest(texts) == float(value)
    corners = [points(*line.get_xydata()[[0, 1, -2, -1]].T) for line in outlines]
    assert len(corners) > 8 and of_page(largest) | of_page(smallest) >= set().union(*corners)


def test_straight_parts_of_diagrams_have_no_points_between_their_ends() -> None:
    x = np.sort([*np.linspace(0.0, 1.0, 21), 0.3, 0.3])
    straight = 5.0 - 7.0 * x
    assert bends(x, straight, 1e-4).tolist() == [0, len(x) - 1]
    jump = straight + 3.0 * (np.arange(len(x)) > np.flatnonzero(x == 0.3)[0])
    kink, bow = -np.abs(x - 0.3) - 3.0 * x, 10.0 * x * (1.0 - x)  # the kink is no extreme
    for values in (jump, kink, bow):
        kept = bends(x, values, 1e-4)
        off = np.interp(x, x[kept], values[kept]) - values
        assert np.abs(off[(x != 0.3) | (values is not jump)]).max() < 1e-3
        assert {values[kept].min(), values[kept].max()} == {values.min(), values.max()}
    assert len(bends(x, jump, 1e-4)) == 4 and len(bends(x, kink, 1e-4)) == 3


@pytest.mark.parametrize(
    "n, title", [(0, "Ductilities of springs and hinges"), (1, "Damage of springs and hinges")]
)
def test_maps_of_hinges(pair: Results, drawn: Callable[[str], PlotlyPicture], n: int, title: str) -> None:
    on_page = dict[tuple[float, float], str]()
    for trace in drawn(title).traces[1:]:  # the worst above the others
        on_page |= dict.fromkeys(of_page(trace), trace["marker"]["color"])
    axes = plot.picture(pair, "hinges").axes[n]
    discs = {
        place: to_hex(line.get_markerfacecolor())
        for line in axes.lines
        if line.get_marker() == "o"
        for place in of_lines([line])
    }
    assert on_page == discs and set(discs.values()) <= set(COLOURS)
    assert len(set(discs.values())) > 1 and len(discs) > 4


def test_collisions(pair: Results, drawn: Callable[[str], PlotlyPicture]) -> None:
    top, bottom = plot.picture(pair, "collisions").axes
    (peaks,), (closed,) = (
        drawn(title).traces
        for title in ("Peak forces of the collisions", "Times at which contacts were closed")
    )
    assert of_page(peaks) == of_lines(top.lines) and len(peaks["x"]) > 1
    starts = {float(f"{bar.get_x():.7g}") for bar in bottom.patches}
    assert set(closed["x"][::3]) == starts and set(closed["y"]) == {0.0}
    table = pair.table("collisions")
    np.testing.assert_allclose(closed["x"][1::3], table["t_end"], rtol=1e-6)
    rows = drawn("Times at which contacts were closed").rows
    assert list(rows) == [t.get_text() for t in bottom.get_yticklabels()]


def test_axial_forces_over_moments(tmp_path: Path) -> None:
    deck = tmp_path / "column.inp"
    deck.write_text(COLUMN, encoding="utf-8")
    with pound_solve.run(deck) as results:
        (picture,), figure = orbits(results), plot.picture(results, "interaction")
    panels = {axes.get_title(): axes.lines for axes in figure.axes if axes.get_title()}
    groups = {trace["name"]: trace["legendgroup"] for trace in picture.traces if "showlegend" not in trace}
    assert groups.keys() == panels.keys() and len(groups) == 2
    for name, lines in panels.items():
        path, strength, *marks = [t for t in picture.traces if t["legendgroup"] == groups[name]]
        (curve,) = [line for line in lines if len(line.get_xdata()) > 100]
        x, y = curve.get_data()
        assert of_page(path) <= of_lines([curve])
        sizes = np.ptp(x), np.ptp(y)
        kept = path["x"], path["y"]
        off = [np.abs(np.subtract.outer(v, k)) / size for v, k, size in zip((x, y), kept, sizes)]
        assert np.max(off, axis=0).min(axis=1).max() < 1.001 / CELLS, "all are near a point that is kept"
        assert [min(kept[0]), max(kept[1])] == pytest.approx([x.min(), y.max()], rel=1e-6)
        limits = [line for line in lines if line.get_label() in ("strength", "yield moment")]
        assert {a for a, _ in of_page(strength)} == {a for a, _ in of_lines(limits)}
        others = [line for line in lines if line.get_linestyle() == "None"]
        assert [of_page(mark) for mark in marks] == [of_lines([line]) for line in others]


def test_capacity_and_demand(pair: Results, drawn: Callable[[str], PlotlyPicture]) -> None:
    picture = drawn("Capacity and demand of pushover 1 (N2 method)")
    axes = plot.picture(pair, "performance").axes[0]
    assert [of_page(trace) for trace in picture.traces] == [of_lines([line]) for line in axes.lines]
    assert len(axes.lines) == 4 and (picture.x, picture.y) == (axes.get_xlabel(), axes.get_ylabel())
    assert picture.reach == pytest.approx(axes.get_xlim()[1])
    assert picture.traces[-1]["text"] == [t.get_text() for t in axes.texts]


def test_errors_of_a_study(done: Results) -> None:
    figure = plot.picture(done, "study")
    on_page = list(errors_of_methods(done))
    assert len(on_page) == len(figure.axes) == 2
    for picture, axes in zip(on_page, figure.axes):
        *methods, advised = picture.traces
        assert methods and [of_page(t) for t in methods] == [
            of_lines([x]) for x in axes.lines[: len(methods)]
        ]
        assert picture.x == axes.get_xlabel() and picture.log
        np.testing.assert_allclose(advised["y"][::3], done.table("study_advice")["target"])


def test_drift_ratios_have_one_unit(pair: Results, drawn: Callable[[str], PlotlyPicture]) -> None:
    over_time = drawn("Drift ratios of the storeys")
    over_height = drawn("Extreme drift ratios over the height")
    assert (over_time.y, over_height.x) == ("drift ratio [%]", "drift ratio [%]")
    largest = max(max(map(abs, trace["y"])) for trace in over_time.traces)
    extreme = max(max(map(abs, trace["x"])) for trace in over_height.traces if None not in trace["x"])
    assert largest == pytest.approx(100.0 * np.abs(pair.course("storey/drift", jumps=True)[1]).max())
    assert 0.9 * extreme < largest <= extreme * (1.0 + 1e-6)
    assert all(len(trace["x"]) <= MOST_POINTS + 2 for trace in over_time.traces)


def test_drift_limits_stand_beside_the_profiles(
    pair: Results, drawn: Callable[[str], PlotlyPicture]
) -> None:
    figure = plot.picture(pair, "storeys")
    lines = [line.get_xdata()[0] for line in figure.axes[0].lines if line.get_color() == storeys.GREY]
    (trace,) = (t for t in drawn("Extreme drift ratios over the height").traces if t["name"] == "low")
    assert lines == [-0.1, 0.1] == [trace["x"][0], trace["x"][-1]]
    assert trace["x"][2] is None and len(set(trace["y"])) == 3
    for title in (
        "Extreme storey shears over the height",
        "Extreme total floor accelerations over the height",
    ):
        assert "low" not in [t["name"] for t in drawn(title).traces]
