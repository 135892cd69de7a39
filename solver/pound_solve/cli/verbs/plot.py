"""``pound-solve plot``: draw pictures of a results file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common
from pound_solve.report.formats import ANIMATION_FORMATS, IMAGE_FORMATS

if TYPE_CHECKING:
    from pound_solve.report.plot import Choice
    from pound_solve.results import Results

SUMMARY = "draw pictures of a results file (needs matplotlib: the extra plot)"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("results", nargs="?", help="results file (.h5); none: list the pictures")
    text = "its name (default: all that the file has data for, but the animation)"
    parser.add_argument("pictures", nargs="*", metavar="PICTURE", help=text)
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder (default: the file's)")
    text = "format (default: svg; of the animation html)"
    parser.add_argument("--as", dest="ending", choices=(*IMAGE_FORMATS, *ANIMATION_FORMATS), help=text)
    parser.add_argument(
        "--member",
        action="append",
        default=[],
        metavar="NAME",
        help="this member, spring, hinge or contact only, by number, name or label; may be repeated",
    )
    parser.add_argument("--time", type=_time, metavar="T", help="at this time")
    text = "at the largest force of this contact; 'largest': of the contact with the largest force"
    parser.add_argument("--at-peak", metavar="CONTACT", help=text)
    parser.add_argument("--between", type=_time, nargs=2, metavar=("T1", "T2"), help="these times only")
    parser.add_argument(
        "--style", type=Path, metavar="FILE", help="style sheet of matplotlib, laid over the program's"
    )


def _time(word: str) -> float:
    """Parse a time, a finite number."""
    (value,) = common.numbers([word], "this option takes a time", argparse.ArgumentTypeError)
    return value


def execute(args: argparse.Namespace) -> int:
    """Draw the pictures; print their paths and the names of those left out."""
    from pound_deck.files import opened
    from pound_solve.report import plot
    from pound_solve.results import Results

    if args.results is None:
        for picture in plot.PICTURES.values():
            print(f"{picture.name:<14} {picture.shows}")
        return common.DONE
    between = tuple(args.between) if args.between else None
    choice = plot.Choice(tuple(args.member), args.time, args.at_peak, between, args.style)
    if wrong := _wrong(args, choice):
        return common.complain(wrong, common.MISTAKES)
    if args.style:
        opened(args.style).close()  # a pipe is refused before the work
    try:
        with Results.open(args.results) as results:
            return _draw(results, args, choice)
    except ImportError:
        return common.complain('pictures need matplotlib: pip install "pound-solve[plot]"', common.MISTAKES)


def _wrong(args: argparse.Namespace, choice: Choice) -> str:
    """Message on a mistake in the arguments; empty without one."""
    from pound_solve.report.plot import PICTURES

    for name in args.pictures:
        if name not in PICTURES:
            return f"there is no picture {name}: choose from {', '.join(PICTURES)}"
        if args.ending and args.ending not in PICTURES[name].endings:
            return f"the picture {name} is written as {', '.join(PICTURES[name].endings)}"
    if choice.between and not choice.between[0] < choice.between[1]:
        return "--between takes the first time, then the last"
    if choice.time is not None and choice.at_peak is not None:
        return "--time and --at-peak both name an instant: give one of them"
    for option in sorted(choice.stated):
        users = [p.name for p in PICTURES.values() if option in p.options]
        if not set(users) & set(args.pictures):
            option = option.replace("_", "-")
            return f"--{option} belongs to the pictures {', '.join(users)}: name one of them"
    return ""


def _draw(results: Results, args: argparse.Namespace, choice: Choice) -> int:
    """Draw the named pictures, or all that can be drawn in this format."""
    from pound_solve.report import plot

    folder: Path = args.out or results.path.parent
    held = {*results.tables, *results.histories}
    for name in args.pictures:
        if not held >= set(needs := plot.PICTURES[name].needs):
            text = f"{args.results} lacks what the picture {name} needs: {', '.join(needs)}"
            return common.complain(text, common.MISTAKES)
    names = args.pictures or plot.possible(results, args.ending or IMAGE_FORMATS[0])
    if not names:
        return common.complain(f"{args.results} holds nothing that a picture shows", common.MISTAKES)
    drawn: list[Path] = []
    left_out: dict[str, list[str]] = {}
    for name in names:
        moves = plot.PICTURES[name].write is not None
        ending = args.ending or (ANIMATION_FORMATS if moves else IMAGE_FORMATS)[0]
        more, less = plot.draw(results, [name], folder, ending, choice)
        drawn += more
        for what, pictures in less.items():
            left_out.setdefault(what, []).extend(pictures)
        for path in more:
            print(path, flush=True)
    if left_out:
        reasons = "; ".join(f"{', '.join(names)} (no {what})" for what, names in left_out.items())
        print(f"pound-solve: left out, nothing to draw: {reasons}", file=sys.stderr)
    return common.DONE if drawn else common.MISTAKES
