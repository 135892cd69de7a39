"""``pound-solve loop``: drive one hysteresis rule or contact law along a path of deformation."""

from __future__ import annotations

import argparse
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "drive a hysteresis rule or contact law along a path; print and draw its loop"
EXAMPLES = (("TAKEDA KX=1000 FX=10 --svg loop.svg", "a hysteresis loop, drawn"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("law", help="name of the rule or law")
    parser.add_argument("items", nargs="*", metavar="NAME=VALUE", help="items of its card, as in a deck")
    parser.add_argument("--path", metavar="D,D,...", help="turning points of the deformation")
    parser.add_argument("--file", type=Path, help="file of turning points, any number a line")
    parser.add_argument(
        "--rate",
        type=common.finite,
        metavar="V",
        help="speed of the deformation (default: infinitely slow; of a contact 1)",
    )
    parser.add_argument(
        "--png", type=common.picture, metavar="FILE", help="draw with matplotlib into a file"
    )
    parser.add_argument("--svg", type=Path, metavar="FILE", help="draw into an SVG file")


def execute(args: argparse.Namespace) -> int:
    """Print the corners of the loop and its text plot; draw it into the files given."""
    from pound_solve.assess import law_test
    from pound_solve.report import text_plot

    family = args.law.lower() in law_test.AXES and bool(args.items)
    spec = law_test.law_of(f"{args.law} {args.items.pop(0)}" if family else args.law)
    spring, items = law_test.specimen(spec, args.items)
    path = _turning_points(args) or law_test.protocol(spring)
    rate = law_test.usual_rate(spring) if args.rate is None else args.rate
    loop = law_test.trace(spring.law, path, rate)
    texts = (f"{spec.name} {items}", *law_test.AXES[spec.family])
    print(f"{texts[0]}\n\n{law_test.table(loop.corners)}\n\n{text_plot.letters(loop.curve)}")
    if args.svg:
        from pound_solve.results.whole_file import write_text

        write_text(args.svg, text_plot.svg(loop.curve, *texts))
    if args.png:
        from pound_solve.report import plot

        try:
            plot.loop(loop.curve, *texts, args.png)
        except ImportError:
            text = '--png needs matplotlib: pip install "pound-solve[plot]"; --svg needs nothing'
            return common.complain(text, common.MISTAKES)
    return common.DONE


def _turning_points(args: argparse.Namespace) -> list[float]:
    """Turning points of the deformation from --path or --file; empty where neither is given."""
    from pound_deck.files import contents
    from pound_solve.assess.law_test import LawTestError

    if args.path and args.file:
        raise LawTestError("give --path or --file, not both")
    text = args.path or ""
    if args.file:
        text = contents(args.file).decode("utf-8")
    words = [w for line in text.splitlines() for w in line.split("#")[0].replace(",", " ").split()]
    points = common.numbers(words, "--path and --file take deformations", LawTestError)
    if (args.path is not None or args.file) and not points:
        raise LawTestError("--path and --file take one deformation at least")
    return points
