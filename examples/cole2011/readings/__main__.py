"""How the paper's statements fare over many readings: ``python examples/cole2011/readings -o FOLDER``.

A reading is a structure (strength, damping, columns) and a record for each earthquake.  Every structure
is run once under every record; the readings are all combinations, and the best reading.  Runs are kept in
``FOLDER/runs.jsonl``: what was stopped goes on where it was.  Writes ``readings.md``, the robustness table.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "study"))

import choices
from cases import EXACT_EQUIVALENT, TESTS
from choices import Record
from robustness import BEST, RECORDS, STRUCTURES, Cells, Structure, page
from runs import Job, found, solve_all


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="readings", description=__doc__.split("\n\n")[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("readings"), help="folder of runs and table")
    parser.add_argument(
        "--records", type=Path, action="append", default=[], help="folder with records of no package"
    )
    parser.add_argument("--processes", type=int, default=1, metavar="N")
    parser.add_argument(
        "--structures", type=int, default=len(STRUCTURES), help="how many, from the first on"
    )
    parser.add_argument("--manual", type=Path, metavar="FILE", help="write the table to this page as well")
    return parser.parse_args(argv)


def cells(
    structures: Sequence[Structure], records: Sequence[Record], folders: tuple[Path, ...]
) -> Iterator[tuple[Structure, Job]]:
    """All runs: every structure under every record with every test, and the best reading."""
    pairs = list(product(structures, records))
    if BEST not in structures:
        own = [next((r for r in group if r in records), None) for group in choices.BEST.records]
        pairs += [(BEST, r) for r in own if r is not None]
    for (structure, record), test in product(pairs, (*TESTS, EXACT_EQUIVALENT)):
        yield structure, Job(record, test, structure.params, folders)


def progress(done: int, of: int) -> None:
    """Show how far the runs are, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{done} of {of} runs ", end="" if done < of else "\n", file=sys.stderr, flush=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Run what is not kept, and judge every reading."""
    args = arguments(argv)
    folders = tuple(p.resolve() for p in args.records)
    structures = STRUCTURES[: args.structures]
    every = [r for group in RECORDS for r in group]
    records = [r for r in every if found(r, folders)]
    left_out = [f"{r.name}: {r.says} ({r.file})" for r in every if r not in records]
    args.out.mkdir(parents=True, exist_ok=True)
    jobs = list(cells(structures, records, folders))
    runs = solve_all([job for _, job in jobs], args.out / "runs.jsonl", progress, args.processes)
    done: Cells = {}
    for (structure, job), (run, _) in zip(jobs, runs):
        done.setdefault((structure, job.record), []).append(run)
    text = page(done, sum(cost for _, cost in runs), left_out)
    for path in filter(None, (args.out / "readings.md", args.manual)):
        path.write_text(text, encoding="utf-8", newline="\n")
    print(f"{len(jobs)} runs; {args.out / 'readings.md'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
