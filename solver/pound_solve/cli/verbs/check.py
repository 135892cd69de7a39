"""``pound-solve check``: report all mistakes of a deck without running it."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from pound_solve.cli import common, terminal

if TYPE_CHECKING:
    from pound_deck.diagnostics import Diagnostic
    from pound_solve.driver.prepare import Prepared

SUMMARY = "report all mistakes of a deck without running it"
EXAMPLES = (
    ("model.inp", "every mistake with its place, and warnings"),
    ("model.inp --set gap=0.05 --json", "with another PARAM, for programs"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    common.add_deck(parser)
    common.add_method(parser)
    parser.add_argument("--json", action="store_true", help="print the result as JSON, for programs")


def execute(args: argparse.Namespace) -> int:
    """Prepare the deck and print its warnings and its size."""
    from pound_solve.driver import run

    try:
        ready = run.prepare(common.request(args))
    except run.DeckError as err:
        if not args.json:
            raise
        _print_json(args.deck, err.diagnostics, None)
        return common.MISTAKES
    size = {
        "nodes": len(ready.model.nodes),
        "elements": len(ready.model.elements),
        "unknowns": ready.structure.n_free,
    }
    if args.json:
        _print_json(args.deck, ready.warnings, size)
    else:
        _print(args.deck, ready, size)
    return common.DONE


def _print(deck: str, ready: Prepared, size: Mapping[str, int]) -> None:
    from pound_deck.diagnostics import render

    if ready.warnings:
        terminal.tell(render(ready.warnings, ready.files))
    verdict = f"no errors, {_counted(len(ready.warnings), 'warning')}" if ready.warnings else "no mistakes"
    sizes = ", ".join(_counted(size[f"{what}s"], what) for what in ("node", "element", "unknown"))
    print(f"{deck}: {verdict}; {sizes}")


def _counted(n: int, what: str) -> str:
    return f"{n} {what}{'s' * (n != 1)}"


def _print_json(deck: str, diagnostics: Iterable[Diagnostic], size: Mapping[str, int] | None) -> None:
    from pound_solve.report.machine_readable import mistakes

    print(json.dumps(mistakes(deck, diagnostics, size), indent=1))
