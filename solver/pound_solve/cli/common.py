"""Functions that several verbs share: exit statuses, messages, arguments of a deck, lists of numbers."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import terminal
from pound_solve.report.formats import IMAGE_FORMATS

if TYPE_CHECKING:
    from pound_solve.driver.run import Request

DONE, STOPPED, MISTAKES, FILES = range(4)  #: exit statuses


def complain(text: str, status: int = FILES) -> int:
    """Print a line on the error stream and return the exit status."""
    terminal.tell(f"pound-solve: {text}")
    return status


def add_deck(parser: argparse.ArgumentParser, nargs: str | None = None) -> None:
    """Add the deck, its parameters and the folders of records."""
    parser.add_argument("deck", nargs=nargs, help="input deck")
    add_deck_options(parser)


def add_deck_options(parser: argparse.ArgumentParser) -> None:
    """Add the parameters of a deck and the folders of records."""
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="replace a PARAM of the deck"
    )
    parser.add_argument(
        "--records", action="append", default=[], type=Path, metavar="DIR", help="folder with records"
    )


def add_method(parser: argparse.ArgumentParser) -> None:
    """Add the options that replace items of the HISTORY card."""
    parser.add_argument("--method", help="replace METHOD of HISTORY")
    parser.add_argument("--dt", type=float, help="replace DT of HISTORY")
    parser.add_argument("--tol", type=float, help="replace TOL of HISTORY")


def request(args: argparse.Namespace) -> Request:
    """Request of a run from the arguments of `add_deck`, `add_method` and the verb.

    Raises
    ------
    SystemExit
        The deck is a results file, a --set is not NAME=VALUE, or the name is none for a file.
    """
    from pound_solve.driver.run import Request
    from pound_solve.results import is_hdf5

    if is_hdf5(args.deck):
        readers = "report, export, plot, separation and spectrum read it"
        text = f"{args.deck} is a results file, not a deck: {readers}"
        raise SystemExit(complain(text, MISTAKES))
    options = vars(args)
    chosen = {name: options[name] for name in ("method", "dt", "tol", "explain", "name") if name in options}
    try:
        return Request(args.deck, parameters(args.set), options.get("out"), tuple(args.records), **chosen)
    except ValueError as err:
        raise SystemExit(complain(f"--name: {err}", MISTAKES)) from None


def parameters(items: Sequence[str]) -> dict[str, str]:
    """PARAM values of --set by name.

    Raises
    ------
    SystemExit
        An item is not NAME=VALUE.
    """
    values = {}
    for item in items:
        name, equals, value = item.partition("=")
        if not equals or not name.strip():
            raise SystemExit(complain(f"--set {item}: write NAME=VALUE", MISTAKES))
        values[name.strip()] = value.strip()
    return values


def picture(word: str) -> Path:
    """Parse the file of a picture; its ending must be a format of matplotlib."""
    path = Path(word)
    if path.suffix.removeprefix(".") not in IMAGE_FORMATS:
        raise argparse.ArgumentTypeError(f"{word}: a picture ends in .{', .'.join(IMAGE_FORMATS)}")
    return path


def finite(word: str) -> float:
    """Parse a finite number."""
    return numbers([word], "the option takes a number", argparse.ArgumentTypeError)[0]


def share(word: str) -> float:
    """Parse a level of confidence, between 0 and 1."""
    (value,) = numbers([word], "--confidence takes a number", argparse.ArgumentTypeError)
    if not 0.0 < value < 1.0:
        raise argparse.ArgumentTypeError(f"{word}: a level of confidence is between 0 and 1")
    return value


def drawable(path: Path | None) -> bool:
    """Whether a requested picture can be drawn; prints what is missing before the work begins."""
    if path is None:
        return True
    from pound_solve.report import plot

    try:
        plot.ready(path.parent)
    except ImportError:
        complain('--picture needs matplotlib: pip install "pound-solve[plot]"', MISTAKES)
        return False
    return True


def numbers(words: Sequence[str], takes: str, error: type[Exception]) -> list[float]:
    """Parse finite numbers of the magnitudes that a deck may have; raise `error`, with the text `takes` on
    what the option takes, at the first word that is not one.
    """
    from pound_deck.schema import GREAT, OF_MAGNITUDE

    values = []
    for word in words:
        try:
            values.append(float(word))
        except ValueError:
            raise error(f"{word[:60]} is no number: {takes}") from None
        if not math.isfinite(values[-1]):
            raise error(f"{word[:60]} is no finite number: {takes}")
        if abs(values[-1]) > GREAT:
            raise error(f"{word[:60]} is too large: {takes} {OF_MAGNITUDE}")
    return values
