"""``pound-solve report``: print the report of a results file, or write it as a page."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pound_solve.cli import common

if TYPE_CHECKING:
    from pound_solve.results import Results

SUMMARY = "print the report of a results file, or write it as a page for a browser"
EXAMPLES = (
    ("model.h5 --brief", "the first page"),
    ("model.h5 --pages", "numbered pages for a printer"),
    ("model.h5 --html", "one page for a browser"),
)

_PAGE = 60  #: lines of a page for a printer: A4 across in Courier 8, as wide as the report


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", help="results file (.h5)")
    parser.add_argument("--brief", action="store_true", help="print the summary only")
    parser.add_argument("--full", action="store_true", help="print long tables in full")
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--pages",
        nargs="?",
        type=_length,
        const=_PAGE,
        metavar="LINES",
        help=f"divide the text into numbered pages for a printer, without LINES of {_PAGE} lines",
    )
    form.add_argument(
        "--html",
        nargs="?",
        type=Path,
        const=Path(),
        metavar="FILE",
        help="write one page with tables that sort and pictures that zoom, without FILE model.html "
        "(needs plotly: the extra html)",
    )


def _length(text: str) -> int:
    """Number of lines of a page."""
    from pound_solve.report.pages import SHORTEST

    if not text.isdecimal() or int(text) < SHORTEST:
        told = (
            f"{text[:40]} is no number of lines, {SHORTEST} at least; a results file stands before --pages"
        )
        raise argparse.ArgumentTypeError(told)
    return int(text)


def execute(args: argparse.Namespace) -> int:
    """Print the report, or write the page and print its path."""
    from pound_solve.report.pages import paged
    from pound_solve.report.text import render
    from pound_solve.results import Results
    from pound_solve.results.contents import SECTIONS
    from pound_solve.results.place import digest_in

    chosen: dict[str, Any] = {
        "limit": 0 if args.full else None,
        "only": SECTIONS[0][1] if args.brief else None,
    }
    with Results.open(args.results) as results:
        if args.html is not None:
            return _page(results, args.html, chosen)
        text = render(results, **chosen)
        sys.stdout.write(paged(results, text, args.pages) if args.pages else text)
        beside = results.path.with_suffix(".rpt")
        if digest_in(beside) not in ("", results.digest):
            common.complain(f"warning: {beside} is the report of another run")
    return common.DONE


def _page(results: Results, path: Path, chosen: dict[str, Any]) -> int:
    """Write the page into a file, by default beside the results."""
    from pound_solve.report.html import page
    from pound_solve.results.whole_file import write_text

    path = results.path.with_suffix(".html") if path == Path() else path
    try:
        text = page(results, **chosen)
    except ImportError:
        need = '--html needs plotly: pip install "pound-solve[html]"'
        return common.complain(need, common.MISTAKES)
    write_text(path, text)
    print(path)
    return common.DONE
