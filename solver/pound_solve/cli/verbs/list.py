"""``pound-solve list``: list the sections, families and members that a deck may use, and their items."""

from __future__ import annotations

import argparse
import json

from pound_solve.cli import common

SUMMARY = "list what a deck may use"
EXAMPLES = (
    ("", "the families"),
    ("contact", "all contact laws"),
    ("hysteresis TAKEDA", "the items of one rule"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "family",
        nargs="?",
        help="section, element, hysteresis, contact, damper, damping, motion, force, record, analysis or "
        "method",
    )
    parser.add_argument("name", nargs="?", help="one member: its items")
    parser.add_argument("--json", action="store_true", help="print everything as JSON, for programs")


def execute(args: argparse.Namespace) -> int:
    """Print the list."""
    if args.json:
        from pound_solve.report.machine_readable import vocabulary_of_decks

        print(json.dumps(vocabulary_of_decks(), indent=1))
        return common.DONE
    from pound_solve.report.listing import listing

    try:
        print(listing(args.family, args.name))
    except KeyError as err:
        return common.complain(str(err.args[0]), common.MISTAKES)
    return common.DONE
