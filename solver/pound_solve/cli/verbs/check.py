"""``pound-solve check``: report all mistakes of a deck without running it."""

from __future__ import annotations

import argparse
import sys

from pound_solve.cli import common

SUMMARY = "report all mistakes of a deck without running it"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    common.add_deck(parser)
    common.add_method(parser)


def execute(args: argparse.Namespace) -> int:
    """Prepare the deck and print its warnings and its size."""
    from pound_deck.diagnostics import render
    from pound_solve.driver import run

    try:
        ready = run.prepare(common.request(args))
    except run.DeckError as err:
        print(err, file=sys.stderr)
        return common.MISTAKES
    if ready.warnings:
        print(render(ready.warnings, ready.files), file=sys.stderr)
    model, n = ready.model, ready.structure.n_free
    print(
        f"{args.deck}: no mistakes; {len(model.nodes)} nodes, {len(model.elements)} elements, "
        f"{n} unknown{'s' * (n != 1)}"
    )
    return common.DONE
