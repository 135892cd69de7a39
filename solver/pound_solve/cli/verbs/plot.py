"""``pound-solve plot``: draw pictures of a run, of several runs over each other, or of a deck."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common
from pound_solve.report.formats import ANIMATION_FORMATS, IMAGE_FORMATS

if TYPE_CHECKING:
    from pound_solve.report.plot import Choice
    from pound_solve.results import Results

SUMMARY = "draw pictures of a run, of several runs over each other, or of a deck (needs the extra plot)"
EXAMPLES = (
    ("model.inp", "the deck, before it is run"),
    ("model.h5", "all pictures of a run"),
    ("model.h5 diagrams --at-peak largest", "forces while a contact pushes hardest"),
    ("near/model.h5 far/model.h5", "two runs over each other"),
    ("study/sweep.h5 contact_force --over gap", "the force over the gap, of a sweep"),
)
NO_MATPLOTLIB = 'pictures need matplotlib: pip install "pound-solve[plot]"'
OF_A_DECK = ("frame", "loads")  #: pictures that need no run
#: options of runs and decks
OF_RUNS = ("member", "time", "at_peak", "between", "set", "records")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    text = (
        "results file (.h5), a deck, which is drawn without a run, or results of a sweep; none: list the "
        "pictures"
    )
    parser.add_argument("file", nargs="?", metavar="FILE", help=text)
    text = (
        "further results files, drawn over the first, and names of pictures (default: all that there are "
        "data for, but the animation); of a sweep: quantities"
    )
    parser.add_argument("words", nargs="*", metavar="FILE|PICTURE", help=text)
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder (default: the first file's)")
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
    text = "PARAM along x (default: the first that varies)"
    parser.add_argument("--over", metavar="PARAM", help=f"of a sweep: {text}")
    common.add_deck_options(parser)


def _time(word: str) -> float:
    """Parse a time, a finite number."""
    (value,) = common.numbers([word], "this option takes a time", argparse.ArgumentTypeError)
    return value


def execute(args: argparse.Namespace) -> int:
    """Draw the pictures; print their paths and the names of those left out."""
    from pound_deck.files import opened
    from pound_solve.driver.reading import is_deck
    from pound_solve.report import plot
    from pound_solve.results.sweep_file import Sweep

    if args.file is None:
        for picture in plot.PICTURES.values():
            print(f"{picture.name:<14} {picture.shows}")
        return common.DONE
    if args.style:
        opened(args.style).close()  # a pipe is refused before the work
    if Sweep.is_of(args.file):
        if wrong := _wrong_of_sweep(args):
            return common.complain(wrong, common.MISTAKES)
        return _trends(args)
    args.pictures = [word for word in args.words if word in plot.PICTURES or not _is_file(word)]
    args.files = [args.file, *(word for word in args.words if word not in args.pictures)]
    args.decks = [file for file in args.files if is_deck(file)]
    between = tuple(args.between) if args.between else None
    choice = plot.Choice(tuple(args.member), args.time, args.at_peak, between, args.style)
    if wrong := _wrong(args, choice):
        return common.complain(wrong, common.MISTAKES)
    try:
        with ExitStack() as stack:
            runs = [stack.enter_context(_opened(file, args)) for file in args.files]
            return _draw(runs, args, choice)
    except ImportError:
        return common.complain(NO_MATPLOTLIB, common.MISTAKES)


def _wrong_of_sweep(args: argparse.Namespace) -> str:
    """Message on an option that the picture of a sweep does not have; empty without one."""
    for option in OF_RUNS:
        if getattr(args, option) not in (None, []):
            return f"--{option.replace('_', '-')} does not belong to the picture of a sweep"
    if args.ending and args.ending not in IMAGE_FORMATS:
        return f"the picture of a sweep is written as {', '.join(IMAGE_FORMATS)}"
    return ""


def _trends(args: argparse.Namespace) -> int:
    """Draw quantities of a sweep over a PARAM."""
    from pound_solve.report.plot import ready, suites
    from pound_solve.report.sweep import trends
    from pound_solve.results.sweep_file import Sweep
    from pound_solve.statistics.curves import PARAM, CurveError

    folder: Path = args.out or Path(args.file).parent
    path = folder / f"{Path(args.file).stem}_trends.{args.ending or IMAGE_FORMATS[0]}"
    sweep = Sweep.open(args.file)
    try:
        ready(folder)
        panels = trends.panels(sweep, args.over or "", args.words)
        over = args.over or trends.varied(sweep)[0]
        suites.trends(panels, sweep.variables[over].doc.removeprefix(PARAM), path, args.style)
    except CurveError as err:
        return common.complain(f"{args.file}: {err}", common.MISTAKES)
    except ImportError:
        return common.complain(NO_MATPLOTLIB, common.MISTAKES)
    print(path)
    return common.DONE


def _is_file(word: str) -> bool:
    """Whether a word names a file rather than a picture."""
    return Path(word).suffix != "" or Path(word).is_file()


def _opened(file: str, args: argparse.Namespace) -> Results:
    """Results of a file, or the structure of a deck."""
    from pound_solve.driver.request import Request
    from pound_solve.driver.run import structure_in_temporary_folder
    from pound_solve.results import Results

    if file not in args.decks:
        return Results.open(file)
    return structure_in_temporary_folder(
        Request(file, common.parameters(args.set), records=tuple(args.records))
    )


def _wrong(args: argparse.Namespace, choice: Choice) -> str:
    """Message on a mistake in the arguments; empty without one."""
    from pound_solve.report.plot import PICTURES

    if args.decks and len(args.files) > 1:
        return f"{args.decks[0]} is a deck: runs are drawn over each other from their results files (.h5)"
    if args.over:
        return f"--over belongs to a sweep, and {args.file} is none"
    if len(args.files) > 1 and (options := choice.stated - {"between"}):
        option = sorted(options)[0].replace("_", "-")
        return f"--{option} belongs to pictures of one run: name one file"
    if (args.set or args.records) and not args.decks:
        return f"--set and --records belong to a deck, and {args.file} is none"
    for name in args.pictures:
        if name not in PICTURES:
            return f"there is no picture {name}: choose from {', '.join(PICTURES)}"
        fits = _fitting(args)
        if name not in fits:
            shows = "a run, and this is a deck" if args.decks else "one run"
            return f"the picture {name} shows {shows}: choose from {', '.join(fits)}"
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


def _fitting(args: argparse.Namespace) -> list[str]:
    """Names of the pictures of a deck, of one run, or of several."""
    from pound_solve.report.plot import PICTURES

    if args.decks:
        return list(OF_A_DECK)
    return [name for name, picture in PICTURES.items() if len(args.files) == 1 or picture.overlay]


def _draw(runs: Sequence[Results], args: argparse.Namespace, choice: Choice) -> int:
    """Draw the named pictures, or all that can be drawn in this format."""
    from pound_solve.report import plot

    folder: Path = args.out or Path(args.file).parent
    files = " and ".join(args.files)
    lack, holds = ("lacks", "holds") if len(runs) == 1 else ("lack", "hold")
    possible = plot.possible(runs, args.ending or IMAGE_FORMATS[0])
    for name in args.pictures:
        if name not in plot.possible(runs, plot.PICTURES[name].endings[0]):
            needs = ", ".join(plot.PICTURES[name].needs)
            text = f"{files} {lack} what the picture {name} needs: {needs}"
            return common.complain(text, common.MISTAKES)
    names = args.pictures or [name for name in possible if name in _fitting(args)]
    if not names:
        return common.complain(f"{files} {holds} nothing that a picture shows", common.MISTAKES)
    drawn: list[Path] = []
    left_out: dict[str, list[str]] = {}
    for name in names:
        moves = plot.PICTURES[name].write is not None
        ending = args.ending or (ANIMATION_FORMATS if moves else IMAGE_FORMATS)[0]
        more, less = plot.draw(runs, [name], folder, ending, choice)
        drawn += more
        for what, pictures in less.items():
            left_out.setdefault(what, []).extend(pictures)
        for path in more:
            print(path, flush=True)
    if left_out:
        reasons = "; ".join(f"{', '.join(names)} (no {what})" for what, names in left_out.items())
        print(f"pound-solve: left out, nothing to draw: {reasons}", file=sys.stderr)
    return common.DONE if drawn else common.MISTAKES
