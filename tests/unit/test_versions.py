"""All files that state the version, its date or what the program needs agree; the notes of a release."""

from __future__ import annotations

import importlib.util
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from pound_solve import __version__

ROOT = Path(__file__).parents[2]
CHANGELOG, CITATION, RECIPE = (
    (ROOT / name).read_text("utf-8")
    for name in ("CHANGELOG.md", "CITATION.cff", ".github/conda/recipe.yaml")
)
DATED = re.findall(r"^## (\d\S*) - (\d{4}-\d\d-\d\d)$", CHANGELOG, re.M)


def test_the_version_is_the_newest_of_the_changelog_and_its_date_that_of_the_citation() -> None:
    (date,) = re.findall(r'^date-released: "(.*)"$', CITATION, re.M)
    assert DATED[0] == (__version__, date)


def test_citation_recipe_and_extension_have_the_version() -> None:
    extension = json.loads((ROOT / "manual/editor/vscode/package.json").read_text("utf-8"))
    assert extension["version"] == __version__
    assert re.findall(r"^version: (.*)$", CITATION, re.M) == [__version__]
    assert re.findall(r'^  version: "(.*)"$', RECIPE, re.M) == [__version__]


def test_the_recipe_asks_for_what_the_program_asks_for() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    program, built_with = project["project"], project["build-system"]["requires"]
    host, run = (
        {line.replace(" ", "") for line in re.findall("- (.*)", part)}
        for part in re.split("host:|run:|tests:", RECIPE)[1:3]
    )
    needed = {*program["dependencies"]}
    assert run == {*needed, f"python{program['requires-python']}"}
    assert host == {
        *needed,
        *program["optional-dependencies"]["fast"],
        *built_with,
        "python",
        "pip",
        "setuptools",
    }


@pytest.fixture
def release() -> Any:
    """The script that a release runs."""
    spec = importlib.util.spec_from_file_location("release", ROOT / ".github/release.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_notes_of_a_release_are_its_part_of_the_changelog(release: Any) -> None:
    text = release.notes(f"v{__version__}", __version__, CHANGELOG)
    assert (
        text.startswith("### Added") and "\n## " not in text and len(text) < 125_000
    )  # the repository's limit
    assert f"## {__version__} - {DATED[0][1]}\n\n{text}\n" in CHANGELOG


@pytest.mark.parametrize(
    ("tag", "heading", "told"),
    [
        ("v1.2.4", "1.2.3 - 2026-01-31", "the tag is v1.2.4"),
        ("1.2.3", "1.2.3 - 2026-01-31", "the tag is 1.2.3"),
        ("v1.2.3", "Unreleased", "no heading"),
        ("v1.2.3", "1.2.3", "no heading"),
        ("v1.2.3", "1.2.30 - 2026-01-31", "no heading"),
    ],
)
def test_a_tag_without_its_version_and_date_is_no_release(
    release: Any, tag: str, heading: str, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        release.notes(tag, "1.2.3", f"# Changelog\n\n## {heading}\n\n- New.\n")
