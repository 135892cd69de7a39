"""``pound-solve sweep``: run decks over PARAMs and records, and collect the results in one table."""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common, studies

if TYPE_CHECKING:
    from pound_solve.sweep.study.document import Document

SUMMARY = "run a study: decks by values of PARAMs by records; one table of all runs"
EXAMPLES = (
    ("study.toml -o results", "all combinations, on all processors"),
    ("study.toml --plan", "only list the runs"),
)
LISTS = ("scale", "pga", "sa")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", help="study (.toml), or a deck")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=V,V,...", help="values of a PARAM of the decks"
    )
    parser.add_argument(
        "--motions", action="append", default=[], metavar="PATTERN", help="records, as 'suite/*.AT2'"
    )
    parser.add_argument(
        "--item", action="append", default=[], metavar="NAME=VALUE", help="item of the records, as UNIT=GAL"
    )
    levels = parser.add_mutually_exclusive_group()
    levels.add_argument("--scale", metavar="X,X,...", help="factors on the records")
    levels.add_argument(
        "--pga", metavar="X,X,...", help="peak accelerations to scale to, shares of gravity"
    )
    levels.add_argument("--sa", metavar="X,X,...", help="spectral accelerations likewise, with --period")
    parser.add_argument("--period", type=float, metavar="T", help="period of --sa")
    parser.add_argument("--damping", type=float, metavar="XI", help="damping ratio of --sa (default 0.05)")
    parser.add_argument(
        "--records", action="append", default=[], type=Path, metavar="DIR", help="folder with records"
    )
    common.add_method(parser)
    studies.add_conduct(parser)
    parser.add_argument("--plan", action="store_true", help="tell what is to be run, and what it will take")
    parser.add_argument("--task", metavar="K/N", help="the K-th of N pieces, as of a job array; no table")


def execute(args: argparse.Namespace) -> int:
    """Read the study, execute the remaining runs, write the table."""
    return studies.carried_out(args.study, lambda: _swept(args))


def _piece(word: str | None) -> tuple[int, int]:
    """Parse K/N: number of a piece, and number of pieces; 1 of 1 without the option."""
    if word is None:
        return 1, 1
    match = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", word)
    k, count = map(int, match.groups()) if match else (0, 0)
    if not 1 <= k <= count:
        raise argparse.ArgumentTypeError(f"--task {word}: write K/N with K from 1 to N")
    return k, count


def _document(args: argparse.Namespace) -> Document:
    """Read the study's file, or make a study of a deck, with the items that the command line gives."""
    from pound_solve.sweep.study.document import Document

    if args.study.endswith(".toml"):
        document = Document.read(args.study)
    else:
        document = Document(str(Path(args.study).with_suffix("")), Path())
        document.set_item(("deck",), args.study, "deck", args.study)
    for item in args.set:
        name, equals, value = item.partition("=")
        if not equals or not name.strip():
            raise argparse.ArgumentTypeError(f"--set {item}: write NAME=VALUE,VALUE,...")
        values = [v.strip() for v in value.split(",")]
        document.set_item(("grid", name.strip()), values, f"--set {name.strip()}", value)
    _give_motions(args, document)
    for name in ("method", "dt", "tol"):
        if getattr(args, name) is not None:
            document.set_item((name,), getattr(args, name), f"--{name}", str(getattr(args, name)))
    if args.records:
        document.set_item(
            ("records",), [str(p.absolute()) for p in args.records], "--records", str(args.records[0])
        )
    studies.give_conduct(args, document)
    return document


def _give_motions(args: argparse.Namespace, out: Document) -> None:
    """Replace all records of the study by those of the command line, if any."""
    from pound_solve.loading.records.known import known

    arguments = {name: getattr(args, name) for name in (*LISTS, "period", "damping")}
    options = {name: value for name, value in arguments.items() if value is not None}
    if not args.motions:
        if options or args.item:
            option = next(iter(options), "item")
            raise argparse.ArgumentTypeError(f"--{option} belongs to --motions")
        return
    files = [m if known(m) else os.path.abspath(os.path.expanduser(m)) for m in args.motions]
    out.values["motions"] = [{}]
    out.set_item(("motions", 0, "files"), files, "--motions", " ".join(args.motions))
    for name, value in options.items():
        parsed = value
        if name in LISTS:
            words = value.split(",")
            parsed = common.numbers(words, f"--{name} takes numbers", argparse.ArgumentTypeError)
        out.set_item(("motions", 0, name), parsed, f"--{name}", str(value))
    for item in args.item:
        name, equals, value = item.partition("=")
        if not equals:
            raise argparse.ArgumentTypeError(f"--item {item}: write NAME=VALUE")
        out.set_item(("motions", 0, name.strip().lower()), value.strip(), f"--item {name}", value)


def _swept(args: argparse.Namespace) -> int:
    """Execute the remaining runs and write the table; with --plan, print the plan and run a trial only."""
    from pound_solve.sweep.execution.executors import engine
    from pound_solve.sweep.execution.lock import locked
    from pound_solve.sweep.session import Session
    from pound_solve.sweep.study.study import read

    k, count = _piece(args.task)
    study = read(_document(args))
    if study.warnings and not args.quiet:
        print(study.warnings, file=sys.stderr)
    with locked(study.out, f"{k}-of-{count}" if args.task else ""):
        session = Session(study, engine(args.executor, study.workers), (k, count), args.retry)
        progress = studies.StudyProgress(args)
        if args.plan:
            print("\n".join(session.plan()))
            trial = session.trial(progress)
            progress.end()
            print("\n".join(session.estimate(trial)))
            return common.DONE
        session.carry_out(session.agenda.ahead, progress)
        progress.end()
        return studies.ended(args, session, session.write() if args.task is None else None)
