"""The entry point ``pound-solve``: the argument parser, the choice of the verb and its exit status."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path

from pound_solve.cli import verbs
from pound_solve.cli.common import DONE, MISTAKES, STOPPED, complain
from pound_solve.cli.terminal import columns, tell
from pound_solve.interruption import Interruption
from pound_solve.modules import modules_below
from pound_solve.numerics import threads
from pound_solve.user_error import UserError
from pound_solve.version import __version__

PURPOSE = "earthquake pounding of 2-D frames: a text deck in, a report and an HDF5 file out."
#: what to do first
FIRST_STEPS = (
    ("example 06_unequal_frames", "write an example deck"),
    ("check model.inp", "report all mistakes of a deck"),
    ("model.inp", "run a deck: model.rpt and model.h5"),
    ("plot model.h5", "draw the run"),
    ("list", "list what a deck may use"),
    ("--help", "list all verbs; VERB --help shows options and examples"),
)
VERBS = tuple(name.rpartition(".")[2] for name in modules_below(verbs))


def parser() -> argparse.ArgumentParser:
    """Return the argument parser with the arguments of every verb."""
    parser = argparse.ArgumentParser(prog="pound-solve", description=f"{PURPOSE[0].upper()}{PURPOSE[1:]}")
    parser.add_argument("--version", action="version", version=f"pound-solve {__version__}")
    each = parser.add_subparsers(dest="verb", required=True, metavar="VERB", title="verbs")
    for name in VERBS:
        verb = import_module(f"{verbs.__name__}.{name}")
        examples = listed((f"{name} {words}".strip(), what) for words, what in verb.EXAMPLES)
        subparser = each.add_parser(
            name,
            help=verb.SUMMARY,
            description=verb.SUMMARY,
            epilog=f"examples:\n{examples}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        verb.add_arguments(subparser)
        subparser.set_defaults(execute=verb.execute)
    return parser


def listed(commands: Iterable[tuple[str, str]]) -> str:
    """Text of commands with what they do: beside them, or below them where the terminal is narrow."""
    rows = [(f"  pound-solve {words}".rstrip(), what) for words, what in commands]
    width = max(len(command) for command, _ in rows)
    beside = all(width + 2 + len(what) <= columns(sys.stdout) for _, what in rows)
    between = "  " if beside else "\n      "
    return "\n".join(f"{command.ljust(width if beside else 0)}{between}{what}" for command, what in rows)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status (0 done, 1 stopped, 2 mistakes, 3 files)."""
    for name in ("stdout", "stderr"):  # None where the caller has closed it
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    words = list(sys.argv[1:] if argv is None else argv)
    if not words:
        print(f"pound-solve {__version__}: {PURPOSE}\n\n{listed(FIRST_STEPS)}")
        return DONE
    if words[0] not in (*VERBS, "-h", "--help", "--version"):
        if _misspelt(words):
            near = get_close_matches(words[0], VERBS, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            return complain(f"{words[0]} is neither a verb nor a deck{hint}", MISTAKES)
        words.insert(0, "run")
    args = parser().parse_args(words)
    threads.one()
    with Interruption() as args.interruption, warnings.catch_warnings():
        warnings.showwarning = _tell
        return _status(args.execute, args)


def _tell(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Print a warning of a library in one line that refers to the magnitudes of the deck."""
    where = f"{category.__name__}: {message}".splitlines()[0]
    complain(f"warning: arithmetic at the limits of floating point ({where}): check the deck's magnitudes")


def _misspelt(words: Sequence[str]) -> bool:
    """Whether the first word is neither an option nor a file and another word follows it."""
    first, *others = words
    return bool(
        not first.startswith("-") and others and not others[0].startswith("-") and not Path(first).exists()
    )


def _status(execute: Callable[[argparse.Namespace], int], args: argparse.Namespace) -> int:
    """Exit status of a verb; an exception is reported as one line."""
    try:
        return execute(args)
    except BrokenPipeError:  # the reader closed the output
        sys.stderr.close()
        return 0
    except UserError as err:
        if not err.has_places:
            return complain(str(err), err.status)
        tell(str(err))
        return err.status
    except OSError as err:
        return complain(f"{err.filename or ''}: {err.strerror or err}".lstrip(": "))
    except KeyboardInterrupt:
        return complain("interrupted", STOPPED)
    except MemoryError:
        remedy = "store less (OUTPUT EVERY, NODES, MEMBERS) or use a smaller model"
        return complain(f"not enough memory: {remedy}", STOPPED)
    except Exception as err:
        if os.environ.get("POUND_DEBUG"):
            raise
        kind = type(err).__name__
        text = f"a fault of the program, not of the deck: {kind}: {err}; POUND_DEBUG=1 shows where"
        return complain(text, STOPPED)
