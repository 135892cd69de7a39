"""The extension of VS Code: what it declares is true, and it works in an editor.

The editor is code-server, VS Code in a browser, which is driven by playwright.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from pound_solve.cli.main import main
from pound_solve.version import __version__

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "manual/editor/vscode"
PACKAGE = json.loads((FOLDER / "package.json").read_text("utf-8"))
SOURCE = (FOLDER / "extension.js").read_text("utf-8")
MANUAL = (ROOT / "manual/editor.md").read_text("utf-8")
DECK = ROOT / "examples/06_unequal_frames/unequal_frames.inp"
COMMANDS = {c["command"]: c["title"] for c in PACKAGE["contributes"]["commands"]}
SETTINGS = PACKAGE["contributes"]["configuration"]["properties"]


def test_the_extension_has_the_version_and_the_licence_of_the_program():
    assert PACKAGE["version"] == __version__
    assert (FOLDER / "LICENSE").read_text("utf-8") == (ROOT / "LICENSE").read_text("utf-8")


def test_commands_and_settings_are_in_the_source_and_in_the_manual():
    assert set(COMMANDS) == set(re.findall(r'registerCommand\("([\w.-]+)"', SOURCE))
    assert {name.removeprefix("pound-solve.") for name in SETTINGS} == set(
        re.findall(r'settings\.get\("(\w+)"', SOURCE)
    )
    assert not [x for x in (*COMMANDS.values(), *SETTINGS) if x not in MANUAL]
    used = {x["command"] for menu in PACKAGE["contributes"]["menus"].values() for x in menu}
    assert used == set(COMMANDS)


def test_the_default_command_is_that_of_the_package_and_has_the_verbs(capsys):
    project = (ROOT / "pyproject.toml").read_text("utf-8")
    assert f'\n{SETTINGS["pound-solve.command"]["default"]} = "pound_solve.cli.main:main"' in project
    verbs = set(re.findall(r'\["(\w+)"[\],]', SOURCE))
    assert verbs == {"lsp", "plot", "run"}
    for verb in verbs:  # all take the folders of records
        with pytest.raises(SystemExit):
            main([verb, "--help"])
        assert "--records" in capsys.readouterr().out


# ---------------------------------------------------------------- in an editor

PROGRAM = shutil.which("code-server")


def done(*command: Any, **how: Any) -> None:
    """Run a command of the editor's side; what it says is shown if it fails."""
    run = subprocess.run([*map(str, command)], capture_output=True, text=True, **how)
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    api = pytest.importorskip("playwright.sync_api")
    pytest.importorskip("matplotlib")
    pytest.importorskip("pygls")
    found = shutil.which("chromium") or shutil.which("google-chrome")
    with api.sync_playwright() as kit:
        try:
            browser = kit.chromium.launch(executable_path=found, args=["--no-sandbox"])
        except api.Error as err:
            pytest.skip(f"no Chromium: {str(err).splitlines()[0]}")
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def vsix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The extension as `make extension` builds it, of a copy of its folder."""
    if not shutil.which("npm"):
        pytest.skip("needs npm, of Node.js")
    if not PROGRAM:
        pytest.skip("needs code-server: npm install --global code-server")
    folder = tmp_path_factory.mktemp("vsix") / "vscode"
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("node_modules", "*.vsix"))
    npm = subprocess.run(["npm", "install"], cwd=folder, capture_output=True, text=True)
    if npm.returncode:
        pytest.skip(f"npm installs nothing here: {npm.stderr.strip().splitlines()[-1]}")
    done("npm", "run", "package", cwd=folder)
    return folder / f"{PACKAGE['name']}-{__version__}.vsix"


class Editor:
    """An editor with the extension, as a server of this machine, and its settings."""

    def __init__(self, program: str, home: Path, browser: Any) -> None:
        self.home, self.browser = home, browser
        self.start = [program, "--config", home / "config.yaml", "--user-data-dir", home / "data"]
        self.start += ["--extensions-dir", home / "extensions"]
        (home / "config.yaml").write_text("auth: none\n")
        for scope in ("User", "Machine"):
            (home / "data" / scope).mkdir(parents=True)
        settings = {"workbench.startupEditor": "none", "files.autoSave": "off"}
        (home / "data/User/settings.json").write_text(json.dumps(settings))
        self.command = home / "program of the test"
        modules = shlex.quote(os.pathsep.join(p for p in sys.path if p))
        python = shlex.quote(sys.executable)
        self.command.write_text(f'#!/bin/sh\nPYTHONPATH={modules} exec {python} -m pound_solve "$@"\n')
        self.command.chmod(0o755)
        self.use(self.command)

    def use(self, command: Path | str) -> None:
        """Set the program; an open editor notices it."""
        settings = {"pound-solve.command": str(command)}
        (self.home / "data/Machine/settings.json").write_text(json.dumps(settings))

    @contextmanager
    def running(self) -> Iterator[Editor]:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"127.0.0.1:{free.getsockname()[1]}"
        quiet = ["--disable-telemetry", "--disable-update-check", "--disable-workspace-trust"]
        command = [*map(str, self.start), "--bind-addr", self.address, *quiet]
        log = self.home / "log"
        with log.open("w") as out, subprocess.Popen(command, stdout=out, stderr=out) as server:
            try:
                wait_for(lambda: "HTTP server listening" in log.read_text())
                yield self
            finally:
                server.terminate()

    def opened(self, deck: Path) -> Any:
        """Open the folder of a deck, and the deck, in a page of the browser."""
        page = self.browser.new_page(viewport={"width": 1500, "height": 900})
        page.set_default_timeout(60_000)
        page.goto(f"http://{self.address}/?folder={deck.parent}")
        page.get_by_role("treeitem", name=deck.name).dblclick()
        page.wait_for_selector(".view-line")
        return page


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory, browser: Any, vsix: Path) -> Iterator[Editor]:
    editor = Editor(str(PROGRAM), tmp_path_factory.mktemp("editor"), browser)
    done(*editor.start, "--install-extension", vsix)
    with editor.running():
        yield editor


def wait_for(met: Any, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not met():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.2)


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    return Path(shutil.copy(DECK, tmp_path / "frames.inp"))


def picture_of(page: Any) -> Any:
    """The content of the panel with the picture."""
    return page.frame_locator("iframe.webview").frame_locator("iframe")


def colour(page: Any, text: str) -> str:
    token = page.locator(".view-line span span").filter(has_text=re.compile(f"^{re.escape(text)}")).first
    return str(token.evaluate("e => getComputedStyle(e).color"))


@pytest.mark.slow
def test_a_deck_in_the_editor(editor: Editor, deck: Path) -> None:
    """Highlighting, the picture beside the deck, a mistake in both, and a run."""
    page = editor.opened(deck)
    wait_for(lambda: page.locator(".view-line span[class*=mtk]").count() > 60)
    assert len({colour(page, text) for text in ("!", "TITLE", "pounding", "28E6")}) == 4

    page.get_by_label("Show Picture of Deck").first.click()
    panel = picture_of(page)
    images, words = panel.locator("img"), panel.locator("pre")
    wait_for(lambda: images.count() == 2)
    assert all(images.nth(k).evaluate("e => e.naturalWidth") > 100 for k in (0, 1))
    before = [images.nth(k).get_attribute("src") for k in (0, 1)]
    assert words.count() == 0

    page.locator(".view-lines").first.click()
    page.keyboard.press("Control+Home")
    page.keyboard.type("NODS 1\n")
    page.wait_for_selector(".squiggly-error")  # the language server reads what is not saved yet
    assert words.count() == 0
    page.keyboard.press("Control+s")
    words.wait_for()
    assert "frames.inp:1:1: error P2" in words.inner_text() and "did you mean NODES?" in words.inner_text()
    assert [images.nth(k).get_attribute("src") for k in (0, 1)] == before

    page.keyboard.press("Control+a")
    page.keyboard.insert_text(deck.read_text("utf-8").replace("NODS 1\n", "").replace("h = 9.6", "h = 12"))
    page.keyboard.press("Control+s")
    words.wait_for(state="detached")
    assert images.count() == 2 and images.first.get_attribute("src") != before[0]
    page.wait_for_selector(".squiggly-error", state="detached")

    page.keyboard.press("Control+Home")
    page.keyboard.type("! not saved yet\n")
    page.get_by_label("Run Deck in Terminal").first.click()
    wait_for(deck.with_suffix(".rpt").exists)
    assert deck.read_text("utf-8").startswith("! not saved yet\n") and "h = 12" in deck.read_text("utf-8")
    page.close()


@pytest.mark.slow
def test_a_program_that_is_not_there(editor: Editor, deck: Path) -> None:
    """The editor says how to install it, and starts the server when the setting is right."""
    page = editor.opened(deck)
    editor.use("no-such-program")
    said = page.locator(".notification-list-item-message")
    said.wait_for()
    text = said.inner_text()
    assert "no-such-program was not found" in text and 'pip install "pound-solve[lsp,plot]"' in text
    page.get_by_label("Show Picture of Deck").first.click()
    picture_of(page).locator("pre").wait_for()
    assert text in picture_of(page).locator("pre").inner_text()

    editor.use(editor.command)
    picture_of(page).locator("img").first.wait_for()
    page.locator(".view-lines").first.click()
    page.keyboard.type("KX ")
    page.wait_for_selector(".squiggly-error")
    page.close()
