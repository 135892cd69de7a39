"""The study of Cole, Dhakal, Carr & Bull (2011), anew: ``python examples/cole2011/study -o FOLDER``.

Runs ten tests under three records, and what the paper leaves unsaid in variants; writes ``study.md``,
a text of tables with pictures beside it.  The Mexico City record is on no package: give its folder with
``--records``; without it the study says what it left out.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from cases import (
    EL_CENTRO,
    EXACT_EQUIVALENT,
    FINER,
    RECORDS,
    SYSTEMS,
    TESTS,
    VARIANTS,
    Record,
    Test,
    Variant,
)
from chapter import Study, write
from runs import Job, found, solve_all

BASE = VARIANTS[0]
#: tests that every variant runs
SPARSE = ("0(10)", "0(1)", "0(0.1)", "0(equiv)", "1", "2", "5", "20")


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="study", description=__doc__.split("\n\n")[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("study"), help="folder of text and pictures")
    parser.add_argument(
        "--records", type=Path, action="append", default=[], help="folder with the Mexico City record"
    )
    parser.add_argument(
        "--manual",
        type=Path,
        metavar="DIR",
        help="write the manual's chapter instead: DIR/cole2011-study.md",
    )
    parser.add_argument("--quick", action="store_true", help="El Centro alone, without variants")
    return parser.parse_args(argv)


def progress(done: int, of: int) -> None:
    """Show how far the runs are, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{done} of {of} runs ", end="" if done < of else "\n", file=sys.stderr, flush=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    args = arguments(argv)
    began = time.perf_counter()
    folders = tuple(p.resolve() for p in args.records)
    wanted = (EL_CENTRO,) if args.quick else RECORDS
    records = [r for r in wanted if found(r, folders)]
    variants = [] if args.quick else [v for v in VARIANTS[1:] if found(v.record, folders)]
    left_out = [r.name for r in wanted if r not in records]
    left_out += [] if args.quick else [f"variant: {v.name}" for v in VARIANTS[1:] if v not in variants]
    if EL_CENTRO not in records:
        print('El Centro is missing: pip install "pound-solve[records]"', file=sys.stderr)
        return 3

    def job(record: Record, test: Test, variant: Variant = BASE) -> Job:
        return Job(record, test, variant, folders)

    paper = [job(r, test) for r in records for test in (*TESTS, EXACT_EQUIVALENT)]
    grid = [job(v.record, test, v) for v in variants for test in TESTS if test.name in SPARSE]
    systems = [] if args.quick else [job(EL_CENTRO, test) for test in SYSTEMS]
    finer = [] if args.quick else [job(EL_CENTRO, test) for test in FINER]
    # the longest first, so that none is waited for at the end
    runs = dict(zip(ordered := [*finer, *grid, *paper, *systems], solve_all(ordered, progress)))
    study = Study(
        {r.name: [runs[x] for x in paper if x.record == r] for r in records},
        {v.name: [runs[x] for x in grid if x.variant == v] for v in variants},
        [runs[x] for x in systems],
        [runs[x] for x in finer],
        left_out,
    )
    page = args.manual / "cole2011-study.md" if args.manual else args.out / "study.md"
    drawn = page.parent / "study" if args.manual else page.parent
    drawn.mkdir(parents=True, exist_ok=True)
    write(page, drawn, study)
    for name in left_out:
        print(f"left out, its record is missing: {name}")
    print(f"{len(runs)} runs in {time.perf_counter() - began:.0f} s; {page}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
