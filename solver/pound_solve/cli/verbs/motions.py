"""``pound-solve motions``: write the ground motions of a deck as record files."""

from __future__ import annotations

import argparse
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "write the ground motions of a deck as record files (.at2), as for a study of many records"
EXAMPLES = (("model.inp -o records", "the motions of a deck as record files"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    common.add_deck(parser)
    parser.add_argument(
        "--dt", type=common.finite, metavar="DT", help="step of the samples (default: the motion's)"
    )
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", default=Path(), help="folder of the files")


def execute(args: argparse.Namespace) -> int:
    """Write the files without replacing existing ones."""
    from pound_solve.assess import motion_files
    from pound_solve.results.whole_file import write_text

    if args.dt is not None and not args.dt > 0.0:
        return common.complain("--dt must be above zero", common.MISTAKES)
    args.name = None
    request = common.request(args)
    files = list(motion_files.of_deck(request, args.dt))
    if there := [f.name for f in files if (args.out / f.name).exists()]:
        text = f"{args.out / there[0]} is there: give another folder with -o, or remove it"
        return common.complain(text)
    args.out.mkdir(parents=True, exist_ok=True)
    for file in files:
        if file.warning:
            common.complain(f"warning: {file.name}: {file.warning}")
        write_text(args.out / file.name, file.text, encoding="ascii")
        print(args.out / file.name)
    return common.DONE
