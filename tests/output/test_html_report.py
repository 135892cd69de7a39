"""The page: the tables of the text report, pictures of the numbers of the file, nothing from outside."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from output import sample
from pound_solve import Deck, run
from pound_solve.cli.main import main
from pound_solve.report.html import POLICY, page
from pound_solve.report.html.picture import MOST_POINTS, thinned
from pound_solve.report.html.pictures import pictures
from pound_solve.report.text import render
from pound_solve.report.views import view_of
from pound_solve.results import Results
from pound_solve.results.contents import SECTIONS
from unit.test_reactions import STACK

plotly = pytest.importorskip("plotly.offline")

WORDS = re.compile(r"\s+|(?<=\w)-")
EVIL = '</script><img src=http://nowhere.example/x onerror="a()">'
DECK = f"""TITLE Two masses & a <wall>
UNITS kN m s
NODES
  1 0 0 FIX=XYR
  2 3 0 FIX=YR
  3 4 0 FIX=YR
  4 7 0 FIX=XYR
ELEMENTS
  1 COLUMN 1 2
  2 COLUMN 4 3
  3 POUND  2 3 NAME='{EVIL}'
PROPS
  COLUMN SPRING KX=4000 RULE=BILINEAR R=0.05 FX=60
  POUND  CONTACT GAP=0 LAW=KELVIN_VOIGT K=1E5 E=0.65
WEIGHTS
  2 981
  3 200
EQUAKE
  SINE AMPLITUDE=3 PERIOD=0.8 DURATION=6
ANALYSIS
  MODAL 2 SHAPES=YES
  HISTORY 7
"""


class Reader(HTMLParser):
    """What a page holds: its tags with their attributes, its tables, its scripts."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.tables: dict[str, list[list[str]]] = {}
        self.numbers: dict[str, str] = {}  # of the tables in the report
        self.scripts: list[str] = []
        self.styles: list[str] = []
        self._rows: list[list[str]] = []
        self._inside = self._heading = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        own = dict(attrs)
        self.tags.append((tag, own))
        self._inside = tag if tag in ("td", "th", "script", "style", "h3") else self._inside
        if tag == "table":
            name = str(own["class"])
            parts = sum(key.partition("/")[0] == name for key in self.tables)
            name += f"/{parts + 1}" if parts else ""
            self._rows = self.tables[name] = []
            self.numbers[name] = self._heading.split()[0]
        elif tag == "tr":
            self._rows.append([])
        elif tag in ("td", "th"):
            self._rows[-1].append("")
        elif tag in ("script", "style"):
            (self.scripts if tag == "script" else self.styles).append("")
        elif tag == "br" and self._inside == "th":
            self._rows[-1][-1] += " "
        elif tag == "h3":
            self._heading = ""

    def handle_endtag(self, tag: str) -> None:
        self._inside = "" if tag == self._inside else self._inside

    def handle_data(self, data: str) -> None:
        if self._inside in ("td", "th"):
            self._rows[-1][-1] += data
        elif self._inside == "script":
            self.scripts[-1] += data
        elif self._inside == "style":
            self.styles[-1] += data
        elif self._inside == "h3":
            self._heading += data


@pytest.fixture(scope="module")
def results() -> Iterator[Results]:
    with run(Deck(DECK)) as found:
        assert found.status == "done" and found.history("contact/force").max() > 0.0
        yield found


def blocks_of(text: str) -> dict[str, str]:
    """Blocks of the text report by their numbers."""
    parts = re.split(r"^(\d+\.\d+)  [A-Z].*$", text, flags=re.M)
    return {
        number: re.split(r"^\d+  [A-Z ,]+\n=+$", own, flags=re.M)[0]
        for number, own in zip(parts[1::2], parts[2::2])
    }


def same_as_the_text(results: Results) -> None:
    """All tables of the page are those of the text report, cell by cell."""
    read, blocks = Reader(page(results)), blocks_of(render(results))
    assert set(read.numbers.values()) == blocks.keys()
    exactly = 0
    for name, (heads, *rows) in read.tables.items():
        lines = blocks[read.numbers[name]].split("\n")
        rules = [k for k, line in enumerate(lines) if line.strip() and not set(line) - {" ", "-"}]
        # a wide table stands in panels, a long text in several lines: short words stay whole but at hyphens
        there = set(WORDS.split("\n".join(lines)))
        for cell in (cell for row in (heads, *rows) for cell in row):
            assert not {word for word in WORDS.split(cell) if len(word) <= 16} - there, (name, cell)
        if len(rules) == 1:
            printed = [line.split() for line in lines[rules[0] + 1 : rules[0] + 1 + len(rows)]]
            if printed == [" ".join(row).split() for row in rows]:
                exactly += 1
    assert exactly > len(read.tables) / 3, "tables of one panel, without blocks and wrapped texts"


@pytest.mark.full
def test_tables_are_those_of_the_text_report(done: Results) -> None:
    with run(Deck(DECK.replace(EVIL, "the gap"))) as results:
        same_as_the_text(results)
    same_as_the_text(done)


def test_rows_are_those_of_the_file_in_number(done: Results) -> None:
    read = Reader(page(done))
    whole = {name: rows for name, (_, *rows) in read.tables.items() if view_of(name, whole=False) is None}
    assert len(whole) > 8
    for name, rows in whole.items():
        if "/" not in name:
            assert len(rows) == len(done.table(name)), name


def test_long_tables_end_where_those_of_the_text_report_end(results: Results) -> None:
    brief = Reader(page(results, limit=1, only=SECTIONS[0][1]))
    assert set(brief.tables) <= set(SECTIONS[0][1]) and not brief.scripts[1:]


def test_nothing_is_loaded_from_outside(results: Results) -> None:
    text = page(results)
    read = Reader(text)
    assert {tag for tag, _ in read.tags} <= {
        "html", "head", "meta", "title", "style", "script", "body", "nav", "a", "main", "section", "div",
        "h1", "h2", "h3", "p", "table", "thead", "tbody", "tr", "th", "td", "button", "br", "figure",
        "figcaption", "span",
    }  # fmt: skip
    for tag, own in read.tags:
        assert not own.keys() & {"src", "srcset", "style", "data", "action", "background", "poster"}, (
            tag,
            own,
        )
        assert not [key for key in own if key.startswith("on")], (tag, own)
        assert str(own.get("href", "#")).startswith("#")
    assert ("meta", {"http-equiv": "Content-Security-Policy", "content": POLICY}) in read.tags
    assert "default-src 'none'" in POLICY and "http" not in POLICY and "*" not in POLICY
    assert not re.search(r"url\(|@import|http", "".join(read.styles))
    library, data, program = read.scripts
    assert library == plotly.get_plotlyjs(), "as its authors wrote it"
    assert program.strip() == (files("pound_solve.report.html") / "page.js").read_text("utf-8").strip()
    assert not re.search(r"fetch|XMLHttp|import|WebSocket|https?:|eval|Function", program)
    assert EVIL not in text and "nowhere.example" in data  # the name of the contact, as a text


def test_texts_of_a_deck_are_no_markup(results: Results) -> None:
    text = page(results)
    assert "<h1>Two masses &amp; a &lt;wall&gt;</h1>" in text
    read = Reader(text)
    assert read.tables["contact_summary"][1][0] == EVIL
    names = [t["name"] for figure in json.loads(read.scripts[1]) for t in figure["traces"]]
    assert not [name for name in names if "<" in name]


def test_columns_of_numbers_stand_to_the_right(done: Results) -> None:
    number = re.compile(r"-?|-?(\d+\.?\d*(e[-+]?\d+)?|inf)", re.I)
    columns = 0
    for table in re.findall("<tbody>(.*?)</tbody>", page(done), re.S):
        rows = [
            re.findall(r'<td class="(\w+)(?: long)?">(.*?)</td>', row) for row in table.split("</tr>")[:-1]
        ]
        for cells in zip(*rows):
            (kind,) = {kind for kind, _ in cells}
            columns += kind == "number"
            assert kind == "number" or not all(number.fullmatch(text) for _, text in cells), cells
    assert columns > 20


def test_numbers_and_dates_with_hyphens_and_units_stay_in_one_piece() -> None:
    deck = DECK.replace("Two masses & a <wall>", "Run 2").replace(EVIL, "1E-5 of 2026-01-31")
    with run(Deck(deck)) as results:
        text = page(results)
    assert "<span>1E-5</span> of <span>2026-01-31</span></td>" in text
    assert re.search(r"peak<br>force<br><span>\[kN\]</span></button>", text)


def test_pictures_over_time_are_marked(results: Results) -> None:
    drawn = pictures(results)
    assert {p.time for p in drawn} == {True, False}
    assert all(p.time == p.x.startswith("time [") for p in drawn)
    assert [p.as_json()["time"] for p in drawn] == [p.time for p in drawn]


def round_7(value: float) -> float:
    return float(f"{value:.7g}")


def test_pictures_show_the_numbers_of_the_file(results: Results) -> None:
    drawn = {p.title: p for p in pictures(results)}
    assert {
        "Structure",
        "Ground acceleration",
        "Contact forces",
        "Energies",
        "Forces of springs and hinges",
    } <= set(drawn)
    force, *marks = drawn["Contact forces"].traces
    t, rows = results.course("contact/force", jumps=True)
    table = results.table("collisions")
    curve = set(zip(force["x"], force["y"]))
    assert curve >= {(round_7(x), round_7(y)) for x, y in zip(t, rows[:, 0])}
    assert curve >= set(zip(marks[0]["x"], marks[0]["y"])), "the curve passes through the true peaks"
    np.testing.assert_allclose(marks[0]["y"], table["peak_force"], rtol=1e-6)
    np.testing.assert_allclose(marks[0]["x"], table["t_peak"], rtol=1e-6)
    loop = drawn["Forces of springs and hinges"].traces[0]
    column = results.labels("spring/force").index(loop["name"])
    np.testing.assert_allclose(loop["x"], results.history("spring/deformation")[:, column], rtol=1e-6)
    assert all(p.x.endswith("]") and (p.y.endswith("]") or p.rows) for p in drawn.values()), "units"


def test_profiles_show_both_sides_of_every_storey() -> None:
    two = STACK.format(h=3, joint=4.5, light=20, roof=50, names="")
    motion = "EQUAKE\n SINE AMPLITUDE=4 PERIOD=0.5 DURATION=0.4\n"
    deck = f"UNITS kN m s\nGRAVITY 10\n{two}{motion}ANALYSIS\n HISTORY 0.5 METHOD=EXACT\n"
    with run(Deck(deck)) as results:
        drawn = {p.title: p for p in pictures(results)}
        extremes, levels = results.table("storey_extremes"), results.table("storey_envelope")["level"]
    edges = np.array([np.append(0.0, levels[:-1]), levels]).T.ravel()  # of the storeys, from the ground
    for quantity, title, factor in (
        ("drift ratio", "Extreme drift ratios over the height", 100.0),
        ("shear", "Extreme storey shears over the height", 1.0),
    ):
        rows = extremes[extremes["quantity"] == quantity]
        right, left = drawn[title].traces
        assert (right["name"], left["name"]) == ("building 1, to the right", "building 1, to the left")
        np.testing.assert_allclose(right["x"], np.repeat(factor * rows["max"], 2), rtol=1e-6)
        np.testing.assert_allclose(left["x"], np.repeat(factor * rows["min"], 2), rtol=1e-6)
        np.testing.assert_allclose([right["y"], left["y"]], [edges, edges], rtol=1e-6)
        assert right["line"]["color"] == left["line"]["color"] and len(rows) == 3
    rows = extremes[extremes["quantity"] == "floor acceleration"]
    right, left = drawn["Extreme total floor accelerations over the height"].traces
    np.testing.assert_allclose(right["x"], [4.0, *rows["max"]], rtol=1e-3)  # the amplitude at the base
    np.testing.assert_allclose(left["x"], [-4.0, *rows["min"]], rtol=1e-3)
    np.testing.assert_allclose([right["y"], left["y"]], [[0.0, *levels]] * 2, rtol=1e-6)


def test_forces_over_overlaps_are_those_of_closed_contacts(results: Results) -> None:
    (picture,) = [p for p in pictures(results) if p.title == "Contact forces over overlaps"]
    (curve,) = picture.traces
    gap, force = (results.course(f"contact/{name}", jumps=True)[1][:, 0] for name in ("gap", "force"))
    points = {(x, y) for x, y in zip(curve["x"], curve["y"]) if x is not None}
    pressed = (gap <= 0.0) | (force != 0.0)
    assert points == {(round_7(-g), round_7(f)) for g, f in zip(gap[pressed], force[pressed])}
    closures = np.count_nonzero(np.diff(np.append(0, pressed)) == 1)
    assert curve["x"].count(None) == curve["y"].count(None) == closures - 1 > 2


def test_modes_have_their_periods_and_one_is_visible(results: Results) -> None:
    (picture,) = [p for p in pictures(results) if p.title == "Mode shapes"]
    rest, *shapes = picture.traces
    names = [f"mode {m['mode']}, {m['period']:.4g} s" for m in results.table("modes")]
    assert [s["name"] for s in shapes] == names and picture.equal
    assert [s.get("visible", True) for s in shapes] == [True, "legendonly"]
    for shape in shapes:
        moved = [abs(x - x0) for x, x0 in zip(shape["x"], rest["x"]) if x is not None]
        assert max(moved) == pytest.approx(0.08 * (max(filter(None, rest["x"])) - 0.0), rel=1e-5)


def test_springs_that_yielded_have_the_colour_of_their_ductility(results: Results) -> None:
    (picture,) = [p for p in pictures(results) if p.title == "Ductilities of springs and hinges"]
    table = results.table("spring_envelope")
    ductility = {f"{r['element']} {r['component']}": float(r["ductility"]) for r in table}
    assert max(ductility.values()) > 1.0
    discs = {text: t["name"] for t in picture.traces[1:] for text in t["text"]}
    for label, value in ductility.items():
        name = discs[f"{label}: ductility {value:.4g}"]
        low, _, high = name.partition(" to ")
        if name.startswith("above"):
            assert value > float(name.split()[1])
        elif high:
            assert float(low) < value <= float(high)
        else:
            assert name == "not yielded" and value <= 1.0


def test_a_long_curve_keeps_its_extremes() -> None:
    t = np.linspace(0.0, 100.0, 123_457)
    values = np.sin(t) + 0.01 * np.cos(997.0 * t)
    values[77_777] = 31.0
    x, y = thinned(t, values)
    assert len(x) <= MOST_POINTS + 2 and (np.diff(x) > 0.0).all() and (x[0], x[-1]) == (0.0, 100.0)
    assert y.max() == 31.0 and y.min() == values.min()
    np.testing.assert_array_equal(values[np.searchsorted(t, x)], y)
    for some in np.array_split(np.arange(len(t)), 500):  # nothing larger is left out anywhere
        near = (x >= t[some[0]] - 0.1) & (x <= t[some[-1]] + 0.1)
        assert y[near].max() >= values[some].max() and y[near].min() <= values[some].min()


def test_the_same_results_give_the_same_page(done: Results) -> None:
    assert page(done) == page(done)


def test_a_run_that_stopped_says_so_above(tmp_path: Path) -> None:
    with Results.open(
        sample.write(tmp_path / "s.h5", status="stopped", message="A501 <it> moves")
    ) as stopped:
        head = page(stopped).split("<section")[0]
    assert "THE ANALYSIS DID NOT COMPLETE" in head and "A501 &lt;it&gt; moves" in head


def test_the_command_writes_beside_the_results_or_where_it_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = sample.write(tmp_path / "s.h5")
    assert main(["report", str(path), "--html"]) == 0
    assert main(["report", str(path), "--html", str(tmp_path / "other.html"), "--brief"]) == 0
    assert capsys.readouterr().out.split() == [str(tmp_path / "s.html"), str(tmp_path / "other.html")]
    with Results.open(path) as results:
        assert (tmp_path / "s.html").read_text("utf-8") == page(results)
        assert (tmp_path / "other.html").read_text("utf-8") == page(results, only=SECTIONS[0][1])


def test_without_plotly_the_cure_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    assert main(["report", str(sample.write(tmp_path / "s.h5")), "--html"]) == 2
    assert 'needs plotly: pip install "pound-solve[html]"' in capsys.readouterr().err
    assert not (tmp_path / "s.html").exists()
