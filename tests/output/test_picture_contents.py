"""What pictures show is what tables hold; labels do not overprint; lines stay distinct."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import pound_solve
from pound_solve.check import Subject, at_most
from pound_solve.cli.main import main
from tiers import each_once

pytest.importorskip("matplotlib")

from pound_solve.report import plot
from pound_solve.report.html.pictures import pictures as html_pictures
from pound_solve.report.plot import PICTURES, Choice, ChoiceError, labels, members, style
from pound_solve.report.plot.moments import moment
from pound_solve.report.plot.pictures import hinges, storeys, summary
from pound_solve.results import Results

#: two frames with hinges and a contact, stored so coarsely that no sample meets a peak
PAIR = """
TITLE Two frames at $cost$
UNITS kN m s
NODES
  1  0   0  FIX=XYR
  2  4   0  FIX=XYR
 11  0   3
 12  4   3
  3  4.1 0  FIX=XYR
  4  7.1 0  FIX=XYR
 13  4.1 3
 14  7.1 3
ELEMENTS
  1 COLUMN  1 11
  2 COLUMN  2 12
  3 COLUMN  3 13
  4 COLUMN  4 14
 11 BEAM   11 12
 12 BEAM   13 14   NAME="beam B"
 90 POUND  12 13   NAME="floor 1"
PROPS
 COLUMN FRAME E=28E6 A=0.16 I=6.4E-4 MI=80 MJ=80 LP=0.2 RULE=TAKEDA DUCTU=8
 BEAM   FRAME E=28E6 A=0.11 I=8E-4
 POUND  CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=2E5 E=0.6
MEMBER_LOADS
 11  WY=-12
 12  PY=-40 AT=0.25
WEIGHTS
 11,12  120
 13,14  60
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2
DRIFT
 "A" 1 11
 "B $x$" 3 13
LIMITS
 "low" DRIFT=0.001
 "far" DRIFT=0.4
EQUAKE
 SINE AMPLITUDE=3 PERIOD=0.5
ANALYSIS
 STATIC
 MODAL 4
 PUSHOVER 11 0.06 STEPS=12 TC=0.3 BUILDING="building 1"
 HISTORY 1.1 METHOD=NEWMARK DT=0.001
OUTPUT
 EVERY=0.037
"""


#: a steel column that yields under axial force and moment, and a beam whose hinge takes moments alone
COLUMN = """
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 3 3 FIX=Y
ELEMENTS
 7 COLUMN 1 2
 9 BEAM 2 3
PROPS
 COLUMN BEAM_COLUMN E=2e8 A=0.0106 I=8.1e-5 PY=2490 MP=226 LP=0.3 HINGES=I
 BEAM FRAME E=2e8 A=0.01 I=1e-4 MI=150,-120 LP=0.2 PIN=J RULE=BILINEAR R=0.02
WEIGHTS
 2 900
LOADS
 2 0 -900
DAMPING
 RAYLEIGH XI=0.02 MODES=1,2
EQUAKE
 SINE DIRECTION=X AMPLITUDE=3 PERIOD=0.9
 SINE DIRECTION=Y AMPLITUDE=2.5 PERIOD=0.11
ANALYSIS
 STATIC
 HISTORY 2 METHOD=NEWMARK DT=0.001
OUTPUT
 EVERY=0.01
"""


#: a long row of masses, the last of which meets a wall
ROW = """
NODES
 1001 TO 1120  0 TO 70  0  FIX=YR
ELEMENTS
 1 TO 119  BAR  1001 TO 1119  1002 TO 1120
 120 STOP 1120 NAME=wall
PROPS
 BAR SPRING KX=100
 STOP CONTACT GAP=1 K=100
WEIGHTS
 1001 TO 1120  1
ANALYSIS
 HISTORY 0.1
"""


@pytest.fixture(scope="module")
def pair(tmp_path_factory: Any) -> Iterator[Results]:
    deck = tmp_path_factory.mktemp("pair") / "pair.inp"
    deck.write_text(PAIR, encoding="utf-8")
    with pound_solve.run(deck) as out:
        yield out


@pytest.fixture(scope="module")
def still(pair: Results) -> Callable[[str], Any]:
    """The pictures of the pair, each made once for all tests that only look."""
    return cache(lambda name: plot.picture(pair, name))


def drawn(figure: Any) -> list[tuple[str, np.ndarray]]:
    """Visible texts of a figure with their boxes in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    FigureCanvasAgg(figure).draw()
    out = []
    for text in figure.findobj(Text):
        if text.get_visible() and text.get_text().strip() and text.axes is not None:
            if not text.axes.axison:
                continue
            out.append((text.get_text(), style.text_box(text)))
    return out


def in_sight(figure: Any, axes: Any) -> list[tuple[str, np.ndarray]]:
    """Labels and numbers of one axes that lie within the figure."""
    ticks = []
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        for place, label in zip(axis.get_ticklocs(), axis.get_ticklabels()):
            if low <= place <= high and label.get_visible() and label.get_text():
                ticks.append((label.get_text(), style.text_box(label)))
    own = [(t.get_text(), style.text_box(t)) for t in axes.texts if t.get_visible() and t.get_text()]
    for t in (axes.title, axes._left_title, axes._right_title, axes.xaxis.label, axes.yaxis.label):
        if t.get_text().strip() and t.get_visible():
            own.append((t.get_text(), style.text_box(t)))
    legend = axes.get_legend()
    if legend is not None:
        own += [(t.get_text(), style.text_box(t)) for t in legend.get_texts()]
    return own + ticks


def overprinted(figure: Any) -> list[tuple[str, str]]:
    """Pairs of texts whose boxes overlap."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure).draw()
    texts = [t for axes in figure.axes if axes.axison for t in in_sight(figure, axes)]
    return [
        (a, b)
        for (a, x), (b, y) in combinations(texts, 2)
        if x[0] < y[2] - 0.5 and y[0] < x[2] - 0.5 and x[1] < y[3] - 0.5 and y[1] < x[3] - 0.5
    ]


STILL = [name for name, spec in PICTURES.items() if spec.write is None and name != "study"]


@pytest.mark.full
@each_once(("name", STILL), at_most=9)
def test_no_text_of_a_picture_covers_another(still: Callable[[str], Any], name: str) -> None:
    assert overprinted(still(name)) == []


@pytest.mark.full
@each_once(("name", STILL), at_most=9)
def test_axes_bear_units(still: Callable[[str], Any], name: str) -> None:
    for axes in still(name).axes:
        if not axes.axison:
            continue
        for axis, said in ((axes.xaxis, axes.get_xlabel()), (axes.yaxis, axes.get_ylabel())):
            named = axis.get_major_formatter().__class__.__name__ in ("FixedFormatter", "FuncFormatter")
            hidden = not any(t.get_visible() and t.get_text() for t in axis.get_ticklabels())
            group = axes.get_shared_x_axes() if axis is axes.xaxis else axes.get_shared_y_axes()
            shared = not said and (named or hidden or len(group.get_siblings(axes)) > 1)
            assert shared or re.search(r"\[[^]]+\]", said), (name, said)


@pytest.mark.full
def test_node_numbers_keep_apart_and_those_without_room_are_left_out() -> None:
    figure = style.figure(3.8, 3.8)
    axes = figure.add_subplot()
    axes.set_xlim(-1, 14)
    axes.set_ylim(-1, 14)
    places = [(x, y) for x in range(14) for y in range(14)]
    for n, place in enumerate(places):
        labels.label(axes, place, str(1000 + n))
    labels.settle(figure)
    kept = [t.get_text() for t in axes.texts]
    assert 20 < len(kept) < len(places) and kept[0] == "1000"
    assert overprinted(figure) == []


@pytest.mark.full
def test_node_numbers_of_a_wide_structure_keep_apart(tmp_path: Path) -> None:
    deck = tmp_path / "row.inp"
    deck.write_text(ROW, encoding="utf-8")
    with pound_solve.run(deck) as results:
        figure = plot.picture(results, "frame")
        assert overprinted(figure) == []
        kept = {t.get_text() for t in figure.axes[0].texts}
        assert "1001" in kept and any(text.startswith("wall\ngap 1 ") for text in kept)
        assert 20 < len(kept) < 121
        assert overprinted(plot.picture(results, "summary")) == []


def test_a_label_avoids_lines_and_texts_where_it_can() -> None:
    figure = style.figure(4.0, 3.0)
    axes = figure.add_subplot()
    axes.set_xlim(0, 10)
    axes.set_ylim(0, 10)
    axes.plot([5, 10], [5, 10], linestyle="-")
    labels.label(axes, (5, 5), "first")
    labels.label(axes, (5, 5), "second")
    labels.settle(figure)
    first, second = axes.texts
    assert first.get_horizontalalignment() == "right" and first.get_verticalalignment() == "bottom"
    assert second.get_verticalalignment() == "top"


def test_a_label_stands_beside_shading_and_not_against_its_side() -> None:
    figure = style.figure(4.0, 3.0)
    axes = figure.add_subplot()
    axes.set_xlim(0, 10)
    axes.set_ylim(0, 10)
    axes.fill([5, 9, 9, 5], [5, 5, 9, 9], linewidth=0)
    labels.label(axes, (5, 7), "free")  # without the shading to the right of its point
    labels.label(axes, (7, 5), "up", side=(0.0, 0.3))
    labels.label(axes, (7, 5), "down", side=(0.0, -0.3))
    labels.settle(figure)
    free, up, down = axes.texts
    assert free.get_horizontalalignment() == "right"
    assert up.get_verticalalignment() != "top" and down.get_verticalalignment() != "bottom"


#: two long floors above each other, the lower one in tension, the upper one in compression
FLOORS = """
NODES
 100 TO 120 0 TO 60 0 FIX=YR
 200 TO 220 0 TO 60 3 FIX=YR
ELEMENTS
 1 TO 20 BAR 100 TO 119 101 TO 120
 21 TO 40 BAR 200 TO 219 201 TO 220
 91 STOP 100
 92 STOP 200
PROPS
 BAR FRAME E=2e8 A=0.01
 STOP SPRING KX=1e6
LOADS
 101 TO 120  7 0
 201 TO 220 -7 0
ANALYSIS
 STATIC
"""


def test_values_of_axial_forces_stand_beside_their_shading(tmp_path: Path) -> None:
    deck = tmp_path / "floors.inp"
    deck.write_text(FLOORS, encoding="utf-8")
    with pound_solve.run(deck) as results:
        figure = plot.picture(results, "diagrams")
    (axes,) = figure.axes
    drawn(figure)
    values = [float(text.get_text()) for text in axes.texts]
    assert {140.0, -140.0} <= set(values) and len(values) > 10
    for value, text in zip(values, axes.texts):
        assert value * text.get_position()[1] >= 0.0, text.get_text()  # tension is drawn upwards


def test_ten_lines_differ_in_colour_and_in_stroke() -> None:
    from matplotlib.colors import to_rgb

    with plot.sheet():
        strokes = [style.stroke(k) for k in range(style.LINES)]
    assert style.LINES == 10
    assert len({str(s["linestyle"]) for s in strokes}) == 10
    colours = np.array([to_rgb(s["color"]) for s in strokes])
    apart = [np.linalg.norm(a - b) for a, b in combinations(colours, 2)]
    assert min(apart) > 0.2
    assert (colours @ [0.299, 0.587, 0.114] < 0.65).all()  # dark enough on white


def test_a_style_sheet_replaces_what_it_sets(pair: Results, tmp_path: Path) -> None:
    own = tmp_path / "own.mplstyle"
    own.write_text(
        "# mine\nlines.linewidth: 3.5   # thick\naxes.prop_cycle: cycler(color=['ff0000', '00ff00'])\n"
    )
    figure = plot.picture(pair, "base_shear", Choice(style=own))
    first, ring, second = figure.axes[0].get_lines()[:3]
    assert first.get_linewidth() == second.get_linewidth() == 3.5
    assert first.get_color() == "#ff0000" or first.get_color() == "ff0000"
    assert ring.get_marker() == "o"
    for line, said in (("lines.linewidth 3\n", ":1: a line"), ("\nline.width: 3", "2: matplotlib has no"),
                       ("font.size: big", ":1: ")):  # fmt: skip
        own.write_text(line)
        with pytest.raises(ChoiceError, match=re.escape(said) if said[0] == ":" else said):
            plot.picture(pair, "energy", Choice(style=own))


def peaks(axes: Any) -> list[np.ndarray]:
    """Points of the rings of an axes."""
    rings = [x for x in axes.get_lines() if x.get_marker() == "o" and x.get_linestyle() == "None"]
    return [np.column_stack(x.get_data()) for x in rings]


@pytest.mark.full
def test_the_largest_contact_force_is_that_of_the_table(pair: Results) -> None:
    summary, collisions = pair.table("contact_summary"), pair.table("collisions")
    top = summary["peak_force"][0]
    assert len(collisions) > 1 and pair.history("contact/force").max() < 0.95 * top
    for name, at in (("contact_force", 0), ("histories", 2), ("summary", 5)):
        axes = plot.picture(pair, name).axes[at]
        curve = axes.get_lines()[0]
        assert curve.get_ydata().max() == top
        (rings,) = peaks(axes)
        assert np.array_equal(rings, np.column_stack([collisions["t_peak"], collisions["peak_force"]]))
        times = curve.get_xdata()
        assert (np.diff(times) >= 0.0).all()
        for row in collisions:  # no force is drawn outside of a collision
            outside = (times < row["t_start"]) | (times > row["t_end"])
            assert set(rings[:, 0]) - set(times[outside]) or len(collisions) == 1
    force = curve.get_ydata()[(times > collisions["t_end"][0]) & (times < collisions["t_start"][1])]
    assert (force == 0.0).all()


def test_base_shears_are_those_of_the_table(pair: Results) -> None:
    table = pair.table("base_envelope")
    figure = plot.picture(pair, "base_shear")
    for axes, quantity in zip(figure.axes, ("shear X", "moment")):
        own = table[table["quantity"] == quantity]
        for rings, row in zip(peaks(axes), own):
            assert sorted(rings[:, 1]) == [row["min"], row["max"]]
    history = pair.history("building/base")
    line = figure.axes[0].get_lines()[0]
    assert np.array_equal(line.get_ydata(), history[:, 0]) and "[kN]" in figure.axes[0].get_ylabel()


def test_profiles_are_those_of_the_tables(pair: Results) -> None:
    figure = plot.picture(pair, "storeys")
    envelope, extremes = pair.table("storey_envelope"), pair.table("storey_extremes")
    for n, row in enumerate(envelope):
        own = {r["quantity"]: r for r in extremes[extremes["building"] == row["building"]]}
        for axes, quantity, column, factor in zip(
            figure.axes[3 * n : 3 * n + 3],
            ("drift ratio", "shear", "floor acceleration"),
            ("drift", "shear", "acceleration"),
            (100.0, 1.0, 1.0),
        ):
            _, high, low = (line for line in axes.get_lines() if line.get_color() != storeys.GREY)
            assert high.get_xdata()[-1] == factor * own[quantity]["max"]
            assert low.get_xdata()[-1] == factor * own[quantity]["min"]
            assert max(own[quantity]["max"], -own[quantity]["min"]) == row[column]
            assert (low.get_linestyle(), high.get_linestyle()) == ("--", "-")
    # the profile begins at the base, which moves as the ground
    ground = 3.0
    assert abs(high.get_xdata()[0]) == pytest.approx(ground, rel=1e-2) and high.get_ydata()[0] == 0.0


def test_storey_drifts_show_their_limits_but_those_far_beyond(pair: Results) -> None:
    figure = plot.picture(pair, "storeys")
    drifts = [axes for axes in figure.axes if "drift" in axes.get_xlabel()]
    for axes in figure.axes:
        lines = [line.get_xdata()[0] for line in axes.get_lines() if line.get_color() == storeys.GREY]
        assert lines == ([-0.1, 0.1] if axes in drifts else [])
        named = [text.get_text() for text in axes.texts]
        assert ("low" in named) == (axes in drifts) and "far" not in named


@pytest.mark.parametrize("drift", [0.97, 1.03])
def test_the_name_of_a_limit_covers_no_profile(drift: float) -> None:
    tables = {
        "limits": np.array(
            [("safe", "storey drift", 1.0, drift)],
            [("limit", "O"), ("quantity", "O"), ("allowed", float), ("largest", float)],
        ),
        "storey_envelope": np.array([(9.0,)], [("level", float)]),
    }
    run = cast(Results, SimpleNamespace(holds=tables.__contains__, table=tables.__getitem__))
    with style.sheet():
        figure = style.figure(3.0, 3.0)
        axes = figure.add_subplot()
        (profile,) = axes.plot([drift, drift], [0.0, 9.0])
        storeys.limits(axes, [run], "drift ratio")
        labels.settle(figure)
        (name,) = axes.texts
        line = profile.get_path().transformed(profile.get_transform())
        assert not line.intersects_bbox(name.get_window_extent(), filled=False)


def test_a_performance_point_shows_its_period(pair: Results) -> None:
    figure = plot.picture(pair, "performance")
    (point,) = pair.table("performance")
    assert f"up to the point: {point['period']:.4g} s" in figure.axes[0].get_title()
    lines = {line.get_label(): line.get_xydata().T for line in figure.axes[0].get_lines()}
    (row,), table = pair.table("capacity_line"), pair.table("capacity_curve")
    factor, mass, first = row["participation"], row["mass"], table[0]
    x, y = lines["capacity"]
    assert x == pytest.approx((table["displacement"] - first["displacement"]) / factor, rel=1e-12)
    assert y == pytest.approx((table["base_shear"] - first["base_shear"]) / (factor * mass), rel=1e-12)
    (_, x, _), (_, y, _) = lines["idealised"]
    assert (x, y) == pytest.approx(
        (row["yield_displacement"] / factor, row["yield_shear"] / (factor * mass))
    )
    spectrum = pair.table("push_spectra")
    assert np.array_equal(lines["1 SINE"], [spectrum["displacement"], spectrum["acceleration"]])
    # the yielding oscillator has the period T* of the table
    assert 2.0 * np.pi * np.sqrt(x / y) == pytest.approx(row["period"], rel=1e-12)


def test_the_capacity_curve_names_its_events(pair: Results) -> None:
    axes = plot.picture(pair, "capacity").axes[0]
    table, events = pair.table("capacity_curve"), pair.table("push_events")
    curve = axes.get_lines()[0]
    assert np.array_equal(curve.get_xdata(), table["displacement"])
    assert np.array_equal(curve.get_ydata(), table["base_shear"])
    marked = sum(len(x.get_xdata()) for x in axes.get_lines()[1:] if x.get_marker() == "o")
    assert marked == len(events)
    texts = {t.get_text() for t in axes.texts}
    first = events[0]
    assert f"{first['element']} {first['component']}: yielding" in texts and "floor 1: closes" in texts
    assert f"{table['base_shear'].max():.5g} kN" in texts


def test_diagrams_of_a_beam_are_those_of_statics() -> None:
    # a beam on two pins, q = 12 down over 4, and P = 40 down at a quarter
    load, span, point = 12.0, 4.0, 40.0
    at_i, at_j = load * span / 2 + 0.75 * point, load * span / 2 + 0.25 * point
    ends = {
        "moment I": [0.0], "moment J": [0.0], "shear I": [at_i], "shear J": [at_j], "axial I": [0.0],
        "axial J": [0.0],
    }  # fmt: skip
    along = np.array([1.0, 0.0])
    x, found = members.along_member(
        {k: np.array(v) for k, v in ends.items()}, span, along, [(0.25, np.array([0.0, -point]))]
    )
    m = at_i * span * x - load * (span * x) ** 2 / 2 - point * np.maximum(span * x - 1.0, 0.0)
    assert found["M"][0] == pytest.approx(m, abs=1e-12)
    v = found["V"][0]
    assert v[0] == at_i and v[-1] == pytest.approx(-at_j) and not found["N"].any()
    (jump,) = np.flatnonzero(np.diff(x) == 0.0)[:1]
    assert v[jump] - v[jump + 1] == pytest.approx(point)
    # the moment's slope is the shear
    inner = np.diff(x) > 0.0
    slope = np.diff(m)[inner] / (span * np.diff(x)[inner])
    assert slope == pytest.approx((0.5 * (v[1:] + v[:-1]))[inner])


def test_diagrams_show_the_true_extremes_and_the_values_at_an_instant(pair: Results) -> None:
    place = {int(n["node"]): np.array([n["x"], n["y"]]) for n in pair.table("nodes")}
    table = pair.table("member_envelope")
    rows = {(int(r["element"]), r["quantity"]): r for r in table}
    found = {own.element: own for own in members.lines(pair, place, Choice())}
    assert list(found) == [1, 2, 3, 4, 11, 12]
    for element, own in found.items():
        assert own.high["M"][-1] == rows[element, "moment J"]["max"]
        assert own.high["M"][0] == -rows[element, "moment I"]["min"]
        assert own.low["N"][0] == rows[element, "axial I"]["min"]
        assert own.low["V"][-1] == -rows[element, "shear J"]["max"]
    t, rows = pair.course("member/force")
    at = int(np.argmin(np.abs(t - 0.52)))
    names = pair.attributes("member/force")
    column = list(zip(names["element"], names["quantity"])).index((11, "moment J"))
    row = moment(pair, "member/force", Choice(time=0.52)).row
    (beam,) = members.lines(pair, place, Choice(("11",)), row)
    assert beam.high["M"][-1] == beam.low["M"][-1] == rows[at, column]
    assert f"{t[at]:.6g}" in plot.picture(pair, "diagrams", Choice(("beam B",), time=0.52)).get_suptitle()


def test_the_largest_collision_of_a_contact_is_enlarged(pair: Results) -> None:
    table = pair.table("collisions")
    row = table[int(np.argmax(table["peak_force"]))]
    whole, enlarged = plot.picture(pair, "contact_force").axes
    low, high = enlarged.get_xlim()
    assert low < row["t_start"] < row["t_end"] < high and high - low < 2.0 * (row["t_end"] - row["t_start"])
    assert whole.get_xlim()[1] > 1.0
    assert len(plot.picture(pair, "contact_force", Choice(between=(0.3, 0.6))).axes) == 1
    x, y = enlarged.get_lines()[0].get_data()
    at_touch = y[x == row["t_start"]]
    assert at_touch[0] == 0.0 and at_touch[-1] > 1.0  # the dashpot's force appears at once


def test_loops_of_contacts_close_at_touch_and_parting(pair: Results) -> None:
    lines = [x for x in plot.picture(pair, "contacts").axes[0].get_lines() if x.get_linestyle() == "-"]
    assert len(lines) >= 1
    for line in lines:
        x, y = line.get_data()
        assert y[0] == y[-1] == 0.0 and x[0] == x[1] and x[-1] == x[-2]


@pytest.mark.parametrize("word", ["floor 1", "90", "largest"])
def test_the_force_peak_of_a_contact_is_an_instant(pair: Results, word: str) -> None:
    """Samples lie 0.037 s apart, steps 0.001 s; the close-up has the peak itself."""
    table = pair.table("collisions")
    peak = table[int(np.argmax(table["peak_force"]))]
    for name in ("contact/force", "member/force", "node/u"):
        m = moment(pair, name, Choice(at_peak=word))
        assert m.t == pytest.approx(peak["t_peak"], abs=0.5e-3)
        assert np.abs(pair.time - m.t).min() > 2e-3
        assert m.title.endswith(f"the force peak of contact floor 1: {peak['peak_force']:.6g} kN")
    assert moment(pair, "contact/force", Choice(at_peak=word)).row[0] == pytest.approx(
        peak["peak_force"], rel=1e-3
    )
    assert pair.history("contact/force").max() < 0.9 * peak["peak_force"]  # samples miss it
    for name in ("diagrams", "deformed"):
        title = plot.picture(pair, name, Choice(at_peak=word)).get_suptitle()
        assert f"{peak['peak_force']:.6g} kN" in title


def test_a_force_peak_between_the_samples_is_named_where_it_is_not_stored(tmp_path: Path) -> None:
    deck = tmp_path / "pair.inp"
    deck.write_text(PAIR.replace("EVERY=0.037", "EVERY=0.037\n CLOSEUPS=0"))
    with pound_solve.run(deck) as results:
        m = moment(results, "member/force", Choice(at_peak="floor 1"))
        assert m.t in results.time
        assert "the stored instant nearest to the force peak of contact floor 1" in m.title


def test_the_map_of_hinges_counts_them(pair: Results) -> None:
    figure = plot.picture(pair, "hinges")
    ductility, damage = figure.axes
    table = pair.table("spring_envelope")
    discs = [x for x in ductility.get_lines() if x.get_marker() == "o" and len(x.get_xdata())]
    found = {x.get_markerfacecolor(): len(x.get_xdata()) for x in discs}
    limits = [least for least, _ in reversed(hinges.DUCTILITY)][1:]
    classes = np.searchsorted(limits, table["ductility"], side="left")
    assert found == {
        hinges.COLOURS[n]: int(count) for n, count in zip(*np.unique(classes, return_counts=True))
    }
    worst = pair.table("worst_hinges")[0]
    named = {c: word for c, (_, word) in zip(hinges.COLOURS, reversed(hinges.STATES))}
    drawn_states = {named[x.get_markerfacecolor()] for x in damage.get_lines() if x.get_marker() == "o"}
    assert worst["state"] in drawn_states


def test_one_spring_hinge_or_contact_is_drawn_by_any_of_its_names(pair: Results, capsys: Any) -> None:
    for words, titles in (
        (("1",), ["1 hinge I", "1 hinge J"]),
        (("2 hinge j",), ["2 hinge J"]),
        (("90",), ["floor 1"]),
        (("FLOOR 1", "3 hinge I"), ["3 hinge I", "floor 1"]),
    ):
        axes = plot.picture(pair, "loops", Choice(words)).axes
        assert [a.get_title().split("\n")[0] for a in axes] == titles
    k = pair.labels("spring/force").index("2 hinge J")
    line = plot.picture(pair, "loops", Choice(("2 hinge J",))).axes[0].get_lines()[0]
    assert np.array_equal(line.get_ydata(), pair.history("spring/force")[:, k])
    file = str(pair.path)
    assert main(["plot", file, "loops", "--member", "17"]) == 2
    said = capsys.readouterr().err
    assert "no spring or contact '17'" in said and "4 hinge J" in said and "floor 1" in said
    assert main(["plot", file, "diagrams", "--member", "floor 1"]) == 2
    assert "there are: members 1, 2, 3, 4, 11, 12" in capsys.readouterr().err


def test_forces_of_a_hinge_lie_on_or_within_the_diagram_that_is_drawn(tmp_path: Path) -> None:
    deck = tmp_path / "column.inp"
    deck.write_text(COLUMN, encoding="utf-8")
    with pound_solve.run(deck) as out:
        column, beam = plot.picture(out, "interaction").axes
        labels, forces = out.labels("spring/force"), out.history("spring/force")
        table, springs = out.table("interaction"), out.table("springs")
    assert (column.get_title(), beam.get_title()) == ("7 hinge I", "9 hinge I")
    diagram, path, start, peak, yields = (np.array(x.get_data()).T for x in column.get_lines())
    knee = 0.15 * 2490.0
    by_hand = [(-226, -knee), (-226, knee), (0, -2490), (0, 2490), (226, -knee), (226, knee)]
    assert sorted(np.round(diagram[:-1], 6).tolist()) == [list(corner) for corner in by_hand]
    assert diagram[:-1] == pytest.approx(np.column_stack([table["moment"], table["axial"]]))
    assert diagram[-1].tolist() == diagram[0].tolist()
    # the springs of the hinge carry the axial force, and their levers are 0 and Mp / 0.85 Py
    of_hinge = forces[:, [label.startswith("7 hinge I") for label in labels]]
    assert path[:, 1] == pytest.approx(of_hinge.sum(axis=1), rel=1e-9, abs=1e-6)
    m, n = np.abs(path).T
    assert np.maximum(m / 226.0, 0.85 * m / 226.0 + n / 2490.0).max() == pytest.approx(1.0, abs=1e-9)
    assert start.tolist() == [path[0].tolist()] and abs(start[0, 1] + 900.0) < 1.0
    assert np.abs(peak[0, 0]) == m.max() and peak[0].tolist() in path.tolist()
    # before the first mark every spring is below its strength
    first = min(path.tolist().index(x) for x in yields.tolist())
    limits = springs[springs["element"] == 7]
    reached = (of_hinge >= limits["yield_plus"] - 1e-6) | (of_hinge <= limits["yield_minus"] + 1e-6)
    assert first == np.flatnonzero(reached.any(axis=1))[0] > 0
    assert [x.get_xdata()[0] for x in beam.get_lines()[:2]] == [150.0, -120.0]
    moment = np.array(beam.get_lines()[2].get_xdata())
    assert moment == pytest.approx(forces[:, labels.index("9 hinge I")], rel=1e-9, abs=1e-6)


def test_wrong_times_and_options_are_told(pair: Results, capsys: Any) -> None:
    file = str(pair.path)
    for words, said in (
        (["diagrams", "--time", "9"], "from 0 to 1.1 s"),
        (["contact_force", "--between", "3", "4"], "fewer than two instants"),
        (["diagrams", "--at-peak", "floor 9"], "there are: contacts floor 1"),
        (["diagrams", "--at-peak", "90", "--time", "1"], "both name an instant"),
        (["energy", "--at-peak", "90"], "--at-peak belongs to the pictures deformed, diagrams"),
        (["energy", "--between", "1", "0.5"], "the first time, then the last"),
        (["energy", "--time", "0.5"], "--time belongs to the pictures deformed, diagrams"),
        (["--member", "11"], "--member belongs to"),
        (["animation", "--as", "png"], "written as html, gif, mp4"),
        (["energy", "--style", "none.mplstyle"], "none.mplstyle"),
    ):
        assert main(["plot", file, *words]) in (2, 3)
        err = capsys.readouterr().err
        assert said in err and len(err.splitlines()) == 1


def test_between_shows_these_times_only(pair: Results) -> None:
    axes = plot.picture(pair, "contact_force", Choice(between=(0.3, 0.6))).axes[0]
    assert axes.get_xlim() == (0.3, 0.6)
    inside = [t for t in pair.table("collisions")["t_peak"] if 0.3 <= t <= 0.6]
    assert 0 < len(inside) < len(pair.table("collisions"))
    assert peaks(axes)[0][:, 0].tolist() == inside


def film_in(page: str) -> Any:
    (data,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page)
    return json.loads(data)


def test_the_page_of_the_animation_holds_all_and_fetches_nothing(pair: Results, tmp_path: Path) -> None:
    (path,), _ = plot.draw(pair, ["animation"], tmp_path, "html")
    text = path.read_text("utf-8")
    assert not re.findall(r"(?:src|href|url|import|fetch)\s*[=(]", text)
    assert set(re.findall(r"https?://[^\s\"']+", text)) == {"http://www.w3.org/2000/svg"}
    film = film_in(text)
    u = pair.history("node/u")[:, :, :2]
    frames = np.array(film["moved"])
    assert len(frames) == len(film["captions"]) == len(film["closed"]) == len(pair.time)
    at = np.linspace(pair.time[0], pair.time[-1], len(frames))
    moved = np.array([np.interp(at, pair.time, column) for column in u.reshape(len(u), -1).T]).T
    factor = (frames * moved).sum() / (moved * moved).sum()
    assert frames == pytest.approx(factor * moved, abs=1e-4)
    assert f"drawn {factor:.3g} times" in film["captions"][0]
    # all beams and columns of the pair bend; the page needs four numbers for each
    assert film["members"] == [] and len(film["beams"]) == 6
    assert np.shape(film["turned"]) == (len(frames), 4 * 6) and np.abs(film["turned"]).max() > 0.01
    # however short a collision, a frame shows it
    assert sum(np.diff([0, *(c[0] for c in film["closed"])]) > 0) >= 2
    again, _ = plot.draw(pair, ["animation"], tmp_path / "again", "html")
    assert again[0].read_bytes() == path.read_bytes()


def test_gaps_are_drawn_as_large_as_displacements_beside_rigid_arms(tmp_path: Path) -> None:
    """Between the end of a contact's arm and node J stands the gap, in the animation and in the page."""
    deck = tmp_path / "far.inp"
    deck.write_text(PAIR.replace(" 4.1", " 6.1").replace(" 7.1", " 9.1"), encoding="utf-8")
    with pound_solve.run(deck) as out:
        gaps, t = out.history("contact/gap")[:, 0], out.time
        (path,), _ = plot.draw(out, ["animation"], tmp_path, "html")
        structure = next(p for p in html_pictures(out) if p.title == "Structure")
    (data,) = re.findall(
        r'<script id="data" type="application/json">(.*?)</script>', path.read_text("utf-8")
    )
    film = json.loads(data)
    (factor,) = (float(x) for x in re.findall(r"drawn (\S+) times", film["captions"][0]))
    nodes = np.array(film["nodes"]) + np.array(film["moved"]).reshape(len(film["moved"]), -1, 2)
    ((i, j, *arm),) = film["contacts"]
    assert arm[0] > 1.0
    expected = factor * np.interp(np.linspace(t[0], t[-1], len(nodes)), t, gaps)
    assert nodes[:, j, 0] - nodes[:, i, 0] - arm[0] == pytest.approx(expected, rel=0.01, abs=1e-4)

    lines = {x["name"]: np.array([x["x"], x["y"]], float).T for x in structure.traces}
    (time,) = (float(x) for x in re.findall(r"those at (\S+) s,", structure.note))
    (tip, end), (start, same) = (lines[name][:2] for name in ("contacts", "rigid arms of contacts"))
    assert same.tolist() == tip.tolist()
    assert tip[0] - start[0] == pytest.approx(arm[0], rel=1e-4)
    assert end[0] - tip[0] == pytest.approx(factor * np.interp(time, t, gaps), rel=0.01)


def test_the_summary_tells_what_calls_for_a_look_alone() -> None:
    values = {"b": 2.0, "c": 3.0}
    checks = [at_most(Subject.ENERGY, name, value, 2.5, "too large", "m") for name, value in values.items()]
    results = SimpleNamespace(status="done", tables={}, checks=checks)
    assert summary._figures(cast(Results, results)) == ["look at: c: 3 m"]


@pytest.mark.full
def test_a_gif_moves(pair: Results, tmp_path: Path) -> None:
    from PIL import Image

    choice = Choice(between=(0.3, 0.6))
    files = [plot.draw(pair, ["animation"], tmp_path / n, "gif", choice)[0][0] for n in ("a", "b")]
    assert files[0].read_bytes() == files[1].read_bytes()
    with Image.open(io.BytesIO(files[0].read_bytes())) as film:
        frames = []
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB"), float))
    inside = (pair.time >= 0.3) & (pair.time <= 0.6)
    assert len(frames) == inside.sum()
    assert all(np.abs(a - b).max() > 50 for a, b in pairwise(frames))


@pytest.mark.full
def test_names_are_no_formulas_in_the_summary(pair: Results, tmp_path: Path) -> None:
    (path,), _ = plot.draw(pair, ["summary"], tmp_path)
    text = path.read_text("utf-8")
    assert "Two frames at $cost$" in text and "B $x$" in text
