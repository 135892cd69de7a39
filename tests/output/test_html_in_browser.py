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
    return tab.locator(f"#{table} tbody tr td:nth-child({number})").all_inner_texts()


def test_a_click_on_a_head_sorts_the_table_and_a_third_one_restores_it(shown: Any) -> None:
    tab, _, complaints = shown
    before = column(tab, "collisions", 7)
    numbers = [float(text) for text in before]
    assert len(numbers) > 3 and numbers not in (sorted(numbers), sorted(numbers, reverse=True))
    head = tab.locator("#collisions th:nth-child(7) button")
    head.click()
    assert [float(text) for text in column(tab, "collisions", 7)] == sorted(numbers)
    assert tab.locator("#collisions th:nth-child(7)").get_attribute("aria-sort") == "ascending"
    head.click()
    assert [float(text) for text in column(tab, "collisions", 7)] == sorted(numbers, reverse=True)
    head.click()
    assert column(tab, "collisions", 7) == before
    assert not complaints


def test_texts_sort_too_and_rows_stay_whole(shown: Any) -> None:
    tab, *_ = shown
    rows = tab.locator("#nodes tbody tr").all_inner_texts()
    tab.locator("#options th:nth-child(1) button").focus()
    tab.keyboard.press("Enter")
    texts = column(tab, "options", 1)
    assert texts == sorted(texts, key=str.lower)
    tab.locator("#nodes th:nth-child(2) button").click()
    tab.locator("#nodes th:nth-child(2) button").click()
    assert tab.locator("#nodes tbody tr").all_inner_texts() == rows[::-1]


def test_pictures_zoom_and_return(shown: Any) -> None:
    tab, _, complaints = shown
    assert tab.locator(".picture .main-svg").count() >= 2 * tab.locator(".picture").count()
    place = "#p2"
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
    tab.mouse.dblclick(box["x"] + 0.5 * box["width"], y)
    tab.wait_for_timeout(300)
    assert tab.evaluate(span) == pytest.approx([low, high])
    assert not complaints


def test_no_request_leaves_and_none_could(shown: Any, server: tuple[str, list[str]]) -> None:
    """Runs last: its attempts are complaints of the browser."""
    tab, requests, complaints = shown
    assert [url.partition(":")[0] for url in requests] == ["file"]
    assert tab.locator("#contact_summary tbody td").first.inner_text() == EVIL.replace(
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
