"""Sphinx builds the site from the pages as they lie in the repository: ``make docs``.

The source folder is the root of the repository, so that the relative links between README, manual, examples
and benchmarks hold on the site as they do in the repository.  Two things are not written by hand: the
contents follow the tables of ``manual/README.md``, and the API reference follows the packages on disk.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from sphinx.addnodes import pending_xref
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
    "sphinx.ext.viewcode",
    "sphinx-mathjax-offline",  # after mathjax: it puts its own copy in the place of the one on the network
]
root_doc = "README"
include_patterns = [
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "manual/**",
    "examples/README.md",
    "examples/*/README.md",
    "benchmarks/README.md",
]
exclude_patterns = [".venv*", "build"]
nitpicky = True  # every reference into our own packages must resolve
nitpick_ignore_regex = [
    (r"py:.*", r"(?!pound_(solve|deck)\b).*"),  # foreign names: their inventories are on the network
    (r"py:.*", r".*\._\w+"),  # private names have no entry
]
highlight_language = "none"  # blocks without a language are decks, terminals and reports

# ---------------------------------------------------------------- pages

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4  # anchors as a repository page has them

# ---------------------------------------------------------------- API reference

API = ROOT / "manual/api"  # generated, and ignored by git
PACKAGES = {
    "pound_solve": ROOT / "solver/pound_solve",
    "pound_deck": ROOT / "parser/pound_deck",
    "pound_legacy": ROOT / "parser/pound_legacy",
}
# a name that a module passes on is described where it is defined
autodoc_default_options = {"members": True, "show-inheritance": True, "ignore-module-all": True}
autodoc_member_order = "bysource"
viewcode_follow_imported_members = False  # else the list of sources names builtins, which have no page
napoleon_google_docstring = False
napoleon_use_ivar = True  # dataclasses and named tuples describe their fields under Attributes
add_module_names = False

# ---------------------------------------------------------------- HTML

html_theme = "furo"
html_title = f"{project} {version}"
html_copy_source = False
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
    api = [f"{package} </manual/api/{package}>" for package in PACKAGES]
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


def api_pages() -> Iterator[tuple[str, str]]:
    """Name and text of one page for each module of our packages."""
    for package, folder in PACKAGES.items():
        names = {}
        for file in sorted(folder.rglob("*.py")):
            parts = (package, *file.relative_to(folder).with_suffix("").parts)
            if parts[-1] != "__main__":  # importing it runs the program
                names[".".join(parts).removesuffix(".__init__")] = file
        for name in names:
            children = [x for x in names if x.rpartition(".")[0] == name]
            title = name.replace("_", r"\_")
            lines = [title, "=" * len(title), "", f".. automodule:: {name}", ""]
            if children:
                lines += [".. toctree::", "", *(f"   {x.rpartition('.')[2]} <{x}>" for x in children), ""]
            yield name, "\n".join(lines)


def write_api(app: Sphinx) -> None:
    """Write the pages of the API reference, and remove those of modules that are gone."""
    API.mkdir(exist_ok=True)
    pages = dict(api_pages())
    for stale in API.glob("*.rst"):
        if stale.stem not in pages:
            stale.unlink()
    for name, text in pages.items():
        page = API / f"{name}.rst"
        if not page.exists() or page.read_text("utf-8") != text:  # an untouched page is not built again
            page.write_text(text, "utf-8")


def resolve_short_names(app: Sphinx, tree: nodes.document) -> None:
    """Let a name in a docstring or an annotation mean what it means in that module.

    Sphinx alone looks for the name in all modules, and has to guess where several of them have it.
    """
    for node in list(tree.findall(pending_xref)):
        name = node["reftarget"]
        if node.get("refdomain") != "py" or "." in name:
            continue
        meant = getattr(sys.modules.get(node.get("py:module") or ""), name, None)
        if isinstance(meant, type) and meant.__module__.partition(".")[0] in PACKAGES:
            node["reftarget"] = f"{meant.__module__}.{meant.__qualname__}"
        elif name.islower() and node.get("reftype") == "class":
            node.replace_self(node.children)  # "array", "value": a word, no class of ours


def setup(app: Sphinx) -> None:
    """Connect the functions above."""
    app.connect("builder-inited", write_api)
    app.connect("source-read", adapt)
    app.connect("doctree-read", resolve_short_names)
