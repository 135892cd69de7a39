"""``pound-solve example``: write an example deck with what it includes and its README."""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "write an example: its decks and its README; without a name, list the examples"
EXAMPLES = (("", "list the examples"), ("06_unequal_frames", "write one into a folder of its name"))

_OWN = Path(__file__).parents[2]
#: folders of the examples: beside the package in a wheel, else in the checkout
FOLDERS = (_OWN / "examples", _OWN.parents[1] / "examples")
#: a row of the table of examples/README.md
_ROW = re.compile(r"\| \[(\w+)\]\(\w+/README\.md\) \| (.+?) \| (.+?) \|")
_KEPT = (".inp", ".inc", ".md", ".ipynb", ".toml", ".slurm", "")
#: commands for the files that can be run
_RUN = {".inp": "pound-solve", ".ipynb": "jupyter lab"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("name", nargs="?", help="name of the example")
    text = "folder for its files (default: one of its name in the working folder)"
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help=text)


def execute(args: argparse.Namespace) -> int:
    """List the examples, or write one."""
    folder = next((f for f in FOLDERS if (f / "README.md").is_file()), None)
    if folder is None:
        return common.complain("this installation has no examples: install the package again")
    rows = listed(folder)
    if args.name is None:
        width = max(map(len, rows))
        print("\n".join(f"{name:{width}}  {text}" for name, text in rows.items()))
        return common.DONE
    if args.name not in rows:
        near = get_close_matches(args.name, rows, 1) or [
            n for n in rows if len(args.name) > 2 and args.name.lower() in n
        ]
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(rows)}"
        return common.complain(f"there is no example {args.name[:60]}: {hint}", common.MISTAKES)
    return _write(folder / args.name, args.out or Path(args.name))


def listed(folder: Path) -> Mapping[str, str]:
    """Descriptions of the examples by their names, from the README of their folder."""
    rows = _ROW.findall((folder / "README.md").read_text(encoding="utf-8"))
    return {name: text + _needs(needs) for name, text, needs in rows}


def _needs(needs: str) -> str:
    """Remark on further requirements of an example, from the column on records of the README."""
    if needs == "yes":
        return " (needs the extra records)"
    return f" ({needs.removeprefix('no; ')})" if needs.startswith("no; ") else ""


def _write(source: Path, out: Path) -> int:
    """Write an example, unless one of its files exists already."""
    files = sorted(path for path in source.iterdir() if path.is_file() and path.suffix in _KEPT)
    there = [out / path.name for path in files if (out / path.name).exists()]
    if there:
        return common.complain(f"{there[0]} exists already: give another folder with -o")
    from pound_solve.results.whole_file import write

    out.mkdir(parents=True, exist_ok=True)
    for path in files:
        write(out / path.name, path.read_bytes())
        if path.suffix in _RUN:
            print(f"{_RUN[path.suffix]} {out / path.name}")
    print(f"{out / 'README.md'}")
    return common.DONE
