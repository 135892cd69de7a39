"""Sphinx builds the site from the pages as they lie in the repository: ``make docs``.

The source folder is the root of the repository, so that the relative links between README, manual, examples
and benchmarks hold on the site as they do in the repository.  The contents are not written by hand: they
follow the tables of ``manual/README.md``.
"""

from __future__ import annotations

import re
from pathlib import Path

from sphinx.application import Sphinx

import pound_solve

ROOT = Path(__file__).parents[2]

project = "pound-solve"
author = "The pound-solve developers"
project_copyright = author
version = release = pound_solve.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",  # after mathjax: it puts its own copy in the place of the one on the network
]
root_doc = "README"
include_patterns = [
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "manual/*.md",
    "manual/site/*.rst",
    "examples/README.md",
    "examples/*/README.md",
    "benchmarks/README.md",
]
exclude_patterns = [".venv*", "build"]
highlight_language = "none"  # blocks without a language are decks, terminals and reports

# ---------------------------------------------------------------- pages

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4  # anchors as a repository page has them

# ---------------------------------------------------------------- API reference

# a name that a module passes on is described where it is defined
autodoc_default_options = {"members": True, "show-inheritance": True, "ignore-module-all": True}
autodoc_member_order = "bysource"
napoleon_google_docstring = False
# fields of dataclasses are a list below their class; as entries they would link to all of the same name
napoleon_custom_sections = [("Attributes", "params_style")]

# ---------------------------------------------------------------- HTML

html_theme = "furo"
html_title = f"{project} {version}"
html_copy_source = False
html_search_scorer = str(ROOT / "manual/site/scorer.js")
html_additional_pages = {"index": "index.html"}  # leads to the README
templates_path = ["templates"]


def contents() -> str:
    """Build the tables of contents from the tables of the manual's front page.

    Each heading becomes a caption, the first link of each row an entry.
    """
    manual = "The manual </manual/README>"
    parts = []
    for section in (ROOT / "manual/README.md").read_text("utf-8").split("\n## ")[1:]:
        head, _, body = section.partition("\n")
        rows = re.findall(r"^\| \[([^\]]+)\]\(([^)]+)\.md\)", body, re.M)
        entries = [f"{text[0].upper()}{text[1:]} </{_docname(link)}>" for text, link in rows]
        parts.append(_toctree(head, entries if parts else [manual, *entries]))
    api = ["Python API </manual/site/python>", "API for extensions </manual/site/extensions>"]
    more = ["Contributing </CONTRIBUTING>", "Benchmarks </benchmarks/README>", "Changelog </CHANGELOG>"]
    return "\n".join([*parts, _toctree("API reference", api), _toctree("Project", more)])


def _docname(link: str) -> str:
    """Name the document that a link of the manual's front page leads to."""
    return (ROOT / "manual" / link).resolve().relative_to(ROOT).as_posix()


def _toctree(caption: str, entries: list[str]) -> str:
    """Build a hidden table of contents: it shows in the side bar only."""
    return "\n".join(["```{toctree}", ":hidden:", f":caption: {caption}", "", *entries, "```", ""])


def adapt(app: Sphinx, docname: str, source: list[str]) -> None:
    """Change what a page of the repository says into what the site needs.

    A link to a folder becomes plain text: the site has pages and files, but no folders.
    """
    place = Path(app.env.doc2path(docname))
    if place.suffix == ".md":
        source[0] = re.sub(
            r"\[([^\]]+)\]\(([^):#]+)\)",
            lambda link: link[1] if (place.parent / link[2]).is_dir() else link[0],
            source[0],
        )
    if docname == root_doc:
        source[0] += "\n" + contents()
    elif docname == "examples/README":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\n*/README\n```\n"


def setup(app: Sphinx) -> None:
    """Connect the function above."""
    app.connect("source-read", adapt)
