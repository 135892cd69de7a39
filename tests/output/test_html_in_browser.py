"""The page in a real browser: tables sort, pictures zoom, and no request leaves it.

Needs playwright, which no extra brings, and a Chromium: its own, or one of the machine.
"""

from __future__ import annotations

import http.server
import shutil
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from output.test_html_report import DECK, EVIL
from pound_solve import Deck, run
from pound_solve.report.html import page

pytest.importorskip("plotly.offline")
playwright = pytest.importorskip("playwright.sync_api")
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def server() -> Iterator[tuple[str, list[str]]]:
    """A server of this machine, and what it was asked for."""
    asked: list[str] = []

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(self.path)
            self.send_response(200)
            self.end_headers()

        def log_message(self, *args: object) -> None:
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as own:
        threading.Thread(target=own.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{own.server_port}", asked
        own.shutdown()


@pytest.fixture(scope="module")
def shown(
    tmp_path_factory: pytest.TempPathFactory, server: tuple[str, list[str]]
) -> Iterator[tuple[Any, list[str], list[str]]]:
    """The page, open; the requests of the browser; what it complained about."""
    path = tmp_path_factory.mktemp("html") / "model.html"
    with run(Deck(DECK.replace("http://nowhere.example", server[0]))) as results:
        path.write_text(page(results), "utf-8")
    with playwright.sync_playwright() as kit:
        found = shutil.which("chromium") or shutil.which("google-chrome")
        try:
            browser = kit.chromium.launch(executable_path=found, args=["--no-sandbox"])
        except playwright.Error as err:
            pytest.skip(f"no Chromium: {str(err).splitlines()[0]}")
        tab = browser.new_page(viewport={"width": 1300, "height": 900})
        requests: list[str] = []
        complaints: list[str] = []
        tab.on("request", lambda request: requests.append(request.url))
        tab.on("console", lambda message: complaints.append(message.text))
        tab.on("pageerror", lambda error: complaints.append(str(error)))
        tab.goto(path.as_uri())
        tab.wait_for_selector("#p1 .main-svg")
        yield tab, requests, complaints
        browser.close()


def column(tab: Any, table: str, number: int) -> list[str]:
    return tab.locator(f"table.{table} tbody tr td:nth-child({number})").all_inner_texts()


def test_a_click_on_a_head_sorts_the_table_and_a_third_one_restores_it(shown: Any) -> None:
    tab, _, complaints = shown
    before = column(tab, "collisions", 7)
    numbers = [float(text) for text in before]
    assert len(numbers) > 3 and numbers not in (sorted(numbers), sorted(numbers, reverse=True))
    head = tab.locator("table.collisions th:nth-child(7) button")
    head.click()
    assert [float(text) for text in column(tab, "collisions", 7)] == sorted(numbers)
    assert tab.locator("table.collisions th:nth-child(7)").get_attribute("aria-sort") == "ascending"
    head.click()
    assert [float(text) for text in column(tab, "collisions", 7)] == sorted(numbers, reverse=True)
    head.click()
    assert column(tab, "collisions", 7) == before
    assert not complaints


def test_texts_sort_too_and_rows_stay_whole(shown: Any) -> None:
    tab, *_ = shown
    rows = tab.locator("table.nodes tbody tr").all_inner_texts()
    tab.locator("table.options th:nth-child(1) button").focus()
    tab.keyboard.press("Enter")
    texts = column(tab, "options", 1)
    assert texts == sorted(texts, key=str.lower)
    tab.locator("table.nodes th:nth-child(2) button").click()
    tab.locator("table.nodes th:nth-child(2) button").click()
    assert tab.locator("table.nodes tbody tr").all_inner_texts() == rows[::-1]


def test_pictures_zoom_and_return(shown: Any) -> None:
    tab, _, complaints = shown
    assert tab.locator(".picture .main-svg").count() >= 2 * tab.locator(".picture").count()
    titles = tab.locator("figure h3").all_inner_texts()
    place, last = f"#p{titles.index('Ground acceleration') + 1}", f"#p{titles.index('Energies') + 1}"
    tab.locator(place).scroll_into_view_if_needed()
    span = f"() => document.querySelector('{place}')._fullLayout.xaxis.range"
    low, high = tab.evaluate(span)
    box = tab.locator(f"{place} .nsewdrag").first.bounding_box()
    y = box["y"] + box["height"] / 2
    tab.mouse.move(box["x"] + 0.25 * box["width"], y)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.5 * box["width"], y, steps=5)
    tab.mouse.up()
    tab.wait_for_timeout(300)
    near, far = tab.evaluate(span)
    assert near == pytest.approx(low + 0.25 * (high - low), abs=0.01 * (high - low))
    assert far == pytest.approx(low + 0.5 * (high - low), abs=0.01 * (high - low))
    follower = span.replace(place, last)
    assert tab.evaluate(follower) == [near, far]
    tab.mouse.dblclick(box["x"] + 0.5 * box["width"], y)
    tab.wait_for_timeout(300)
    assert tab.evaluate(span) == pytest.approx([low, high]) == tab.evaluate(follower)
    assert not complaints


@pytest.fixture
def fresh(shown: Any) -> Iterator[Any]:
    """The page in a tab of its own."""
    tab, *_ = shown
    other = tab.context.browser.new_page(viewport={"width": 1300, "height": 900})
    other.goto(tab.url)
    other.wait_for_selector("#p1 .main-svg")
    yield other
    other.close()


def test_all_kinds_of_numbers_sort(fresh: Any) -> None:
    """Exponents, signs, infinity and units count; texts come after numbers, cells without a value last."""
    cells = ["2", "-", "1.5E-03", "all", "-3E+02", "nan", "inf", "10.5 s", "-0.25", "-inf", "12.000"]
    upwards = ["-inf", "-3E+02", "-0.25", "1.5E-03", "2", "10.5 s", "12.000", "inf", "all"]
    downwards = [*upwards[-2::-1], "all"]
    fill = """(column, cells) => column.forEach((cell, k) => { cell.textContent = cells[k] ?? "-"; })"""
    fresh.locator("table.options tbody td:nth-child(2)").evaluate_all(fill, cells)
    head = fresh.locator("table.options th:nth-child(2) button")
    for expected in (upwards, downwards):
        head.click()
        texts = column(fresh, "options", 2)
        assert texts[: len(expected)] == expected and set(texts[len(expected) :]) == {"-", "nan"}


#: numbers that stand in more than one line
BROKEN = """() => {
  const broken = [];
  const texts = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const node = texts.currentNode;
    if (node.parentElement.closest(".picture")) continue;
    for (const match of node.data.matchAll(/(?<![\\w.:/-])-?\\d[\\d.]*(e[-+]\\d+)?/gi)) {
      const range = document.createRange();
      range.setStart(node, match.index);
      range.setEnd(node, match.index + match[0].length);
      const tops = new Set([...range.getClientRects()].map((box) => Math.round(box.top)));
      if (tops.size > 1) broken.push(match[0]);
    }
  }
  return broken;
}"""


def test_numbers_stay_whole_and_the_page_does_not_move_sideways(fresh: Any) -> None:
    boxes = "boxes => boxes.filter((box) => box.scrollWidth > box.clientWidth).length"
    for width in (1300, 700, 400):
        fresh.set_viewport_size({"width": width, "height": 900})
        fresh.wait_for_timeout(500)
        assert fresh.evaluate("document.documentElement.scrollWidth") == width
        assert fresh.evaluate(BROKEN) == []
    assert fresh.locator(".wide").evaluate_all(boxes) > 0, "tables move in their boxes"


def test_names_of_curves_stand_below_a_narrow_picture_and_where_they_are_long(fresh: Any) -> None:
    places = """() => [...document.querySelectorAll(".picture")].filter((p) => p.querySelector(".legend"))
      .map((p) => [p, ...[".legend", ".nsewdrag"].map((x) => p.querySelector(x).getBoundingClientRect())])
      .map(([p, names, curves]) => [p.data.some((trace) => trace.name.length > 24),
        names.left >= curves.right, names.top >= curves.bottom, curves.width])"""
    wide, narrow = [], []
    for width, kind in ((1300, wide), (400, narrow)):
        fresh.set_viewport_size({"width": width, "height": 900})
        fresh.wait_for_timeout(500)
        kind += fresh.evaluate(places)
    assert len(wide) == len(narrow) and {long for long, *_ in wide} == {True, False}
    assert all((right, under) == (not long, long) for long, right, under, _ in wide)
    assert all(under and not right and room > 250 for _, right, under, room in narrow)


def test_pictures_over_time_show_the_same_time(fresh: Any) -> None:
    ranges = """() => [...document.querySelectorAll(".picture")]
      .map((p) => [p.layout.xaxis.title.text, p.layout.xaxis.range])"""

    def spans() -> tuple[set[tuple[float, ...]], list[list[float]]]:
        now = fresh.evaluate(ranges)
        times = {tuple(span) for title, span in now if title.startswith("time")}
        return times, [span for title, span in now if not title.startswith("time")]

    assert sum(title.startswith("time") for title, _ in fresh.evaluate(ranges)) > 3
    (whole,), others = spans()
    energies = "[...document.querySelectorAll('figure')].find((f) => f.textContent.startsWith('Energies'))"
    zoom = f"change => Plotly.relayout({energies}.querySelector('.picture'), change).then(() => null)"
    fresh.evaluate(zoom, {"xaxis.range[0]": 1.5, "xaxis.range[1]": 2.25})
    fresh.wait_for_timeout(500)
    assert spans() == ({(1.5, 2.25)}, others), "those of other axes stay"
    fresh.evaluate(zoom, {"xaxis.range": list(whole)})
    fresh.wait_for_timeout(500)
    assert spans() == ({whole}, others)


def test_pictures_over_time_are_in_line(fresh: Any) -> None:
    """But those with long names."""
    edges = """() => [...document.querySelectorAll(".picture")]
      .filter((p) => p.layout.xaxis.title.text.startsWith("time"))
      .filter((p) => p.data.every((trace) => trace.name.length < 24))
      .map((p) => p.querySelector(".nsewdrag").getBoundingClientRect())
      .map((box) => [Math.round(box.left), Math.round(box.right)].join())"""
    places = fresh.evaluate(edges)
    assert len(places) > 2 and len(set(places)) == 1


def test_numbers_at_axes_have_no_prefixes(fresh: Any) -> None:
    """Plotly writes 20u and 200k for a unit that has a prefix of its own."""
    for most in (4e-5, 4e5):
        fresh.evaluate("most => Plotly.relayout('p4', { 'yaxis.range': [0, most] }).then(() => null)", most)
        texts = fresh.locator("#p4 .ytick text").all_text_contents()
        assert len(texts) > 2 and not [text for text in texts if set(text) - set("0123456789.\u2212+E")]


def test_on_a_narrow_screen_short_texts_stay_in_a_line_and_long_ones_are_wrapped(fresh: Any) -> None:
    fresh.set_viewport_size({"width": 400, "height": 900})
    fresh.wait_for_timeout(500)
    lines = """cells => cells.map((cell) => {
      const range = document.createRange();
      range.selectNodeContents(cell);
      return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size;
    })"""
    assert set(fresh.locator("td.text:not(.long)").evaluate_all(lines)) <= {0, 1}
    assert max(fresh.locator("td.long").evaluate_all(lines)) > 1
    overview = "box => box.scrollWidth <= box.clientWidth && box.scrollHeight <= box.clientHeight"
    assert fresh.locator(".wide:has(.overview)").evaluate(overview), "it is read without moving it"


def test_the_wheel_moves_the_page_and_zooms_with_a_key(fresh: Any) -> None:
    fresh.locator("#p4").scroll_into_view_if_needed()
    span = "() => document.querySelector('#p4').layout.xaxis.range"
    start = fresh.evaluate("scrollY"), fresh.evaluate(span)
    box = fresh.locator("#p4 .nsewdrag").bounding_box()
    fresh.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    fresh.mouse.wheel(0, -100)
    fresh.wait_for_timeout(500)
    assert fresh.evaluate("scrollY") == start[0] - 100 and fresh.evaluate(span) == start[1]
    box = fresh.locator("#p4 .nsewdrag").bounding_box()
    fresh.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    fresh.keyboard.down("Control")
    fresh.mouse.wheel(0, -100)
    fresh.keyboard.up("Control")
    fresh.wait_for_timeout(500)
    (low, high), (near, far) = start[1], fresh.evaluate(span)
    assert far - near < 0.99 * (high - low)


def test_paper_shows_all_and_keeps_rows_and_pictures_whole(fresh: Any) -> None:
    style = "(parts, name) => [...new Set(parts.map((part) => getComputedStyle(part)[name]))]"
    fresh.evaluate("dispatchEvent(new Event('beforeprint'))")
    fresh.emulate_media(media="print")
    fresh.set_viewport_size({"width": 703, "height": 1000})  # A4 without its margins
    fresh.evaluate("dispatchEvent(new Event('beforeprint'))")
    fresh.wait_for_timeout(500)
    assert fresh.evaluate("document.documentElement.scrollWidth") == 703, "nothing is cut, or shrunk"
    for parts, name, value in (
        ("nav", "display", "none"),
        (".modebar", "display", "none"),
        ("thead", "display", "table-header-group"),
        ("th button", "display", "contents"),
        ("tr", "breakInside", "avoid"),
        ("figure", "breakInside", "avoid"),
        ("h2, h3", "breakAfter", "avoid"),
        (".wide", "overflow", "visible"),
    ):
        assert fresh.locator(parts).evaluate_all(style, name) == [value], parts
    listed = """() => [...document.querySelectorAll(".picture")].map((p) => [p.data.map((trace) =>
      [trace.visible !== "legendonly", trace.showlegend]), p.querySelectorAll(".legend .traces").length])"""
    pictures = fresh.evaluate(listed)
    assert all(not named or visible for traces, _ in pictures for visible, named in traces)
    assert any(not visible for traces, _ in pictures for visible, _ in traces), "some are hidden"
    assert all(count in (0, sum(named for _, named in traces)) for traces, count in pictures)
    widths = "pictures => [...new Set(pictures.map((picture) => picture.clientWidth))]"
    assert fresh.locator(".picture .svg-container").evaluate_all(widths) == [690]
    fresh.emulate_media(media="screen")
    fresh.set_viewport_size({"width": 1300, "height": 900})
    fresh.evaluate("dispatchEvent(new Event('afterprint'))")
    fresh.wait_for_timeout(500)
    assert 690 not in fresh.locator(".picture .svg-container").evaluate_all(widths)
    assert any(not visible and named for traces, _ in fresh.evaluate(listed) for visible, named in traces)
    assert not fresh.locator("table[style*=font]").count()


def test_no_request_leaves_and_none_could(shown: Any, server: tuple[str, list[str]]) -> None:
    """Runs last: its attempts are complaints of the browser."""
    tab, requests, complaints = shown
    assert [url.partition(":")[0] for url in requests] == ["file"]
    assert tab.locator("table.contact_summary tbody td").first.inner_text() == EVIL.replace(
        "http://nowhere.example", server[0]
    )
    tried = "u => fetch(u).then(() => 'it came', () => 'refused')"
    assert tab.evaluate(tried, f"{server[0]}/fetched") == "refused"
    tab.evaluate(
        "u => { const i = new Image(); i.src = u; document.body.append(i); }", f"{server[0]}/image"
    )
    tab.wait_for_timeout(300)
    assert server[1] == []
    assert any("Content Security Policy" in text for text in complaints)
