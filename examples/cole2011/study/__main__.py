"""The study of Cole, Dhakal, Carr & Bull (2011), anew: ``python examples/cole2011/study -o FOLDER``.

Runs ten tests under three records, and what the paper leaves unsaid in variants; writes ``study.md``,
a text of tables with pictures beside it.  The Mexico City record is on no package: give its folder with
``--records``; without it the study says what it left out.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from cases import EL_CENTRO, RECORDS, TESTS, VARIANTS, Variant
from chapter import write
from runs import Job, Run, found, solve_all

BASE = VARIANTS[0]


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="study", description=__doc__.split("\n\n")[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("study"), help="folder of text and pictures")
    parser.add_argument(
        "--records", type=Path, action="append", default=[], help="folder with the Mexico City record"
    )
    parser.add_argument("--quick", action="store_true", help="El Centro alone, without variants")
    return parser.parse_args(argv)


def progress(done: int, of: int) -> None:
    """Show how far the runs are, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{done} of {of} runs ", end="" if done < of else "\n", file=sys.stderr, flush=True)


def jobs_of(records: Sequence, variants: Sequence[Variant], folders: tuple[Path, ...]) -> list[Job]:
    """All runs: every record as the decks stand, every variant under its own."""
    out = [Job(record, test, BASE, folders) for record in records for test in TESTS]
    out += [Job(v.record, test, v, folders) for v in variants for test in TESTS]
    return out


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
    runs = solve_all(jobs_of(records, variants, folders), progress)
    by_record: Mapping[str, list[Run]] = {
        r.name: [x for x in runs if x.record == r.name and x.variant == BASE.name] for r in records
    }
    by_variant = {v.name: [x for x in runs if x.variant == v.name] for v in (BASE, *variants)}
    by_variant[BASE.name] = by_record[EL_CENTRO.name]
    args.out.mkdir(parents=True, exist_ok=True)
    write(args.out, by_record, by_variant if variants else {}, left_out)
    for name in left_out:
        print(f"left out, its record is missing: {name}")
    print(f"{len(runs)} runs in {time.perf_counter() - began:.0f} s; {args.out / 'study.md'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
