"""The study of Cole, Dhakal, Carr & Bull (2011), anew: ``python examples/cole2011/study -o FOLDER``.

Runs ten tests under three records, and what the paper leaves unsaid in variants; writes ``study.md``,
a text of tables with pictures beside it.  The Mexico City record is on no package: give its folder with
``--records``; without it the study says what it left out.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from cases import CANDIDATES, EXACT_EQUIVALENT, FINER, SYSTEMS, TESTS, Test, stiffened
from chapter import Study, write
from choices import EL_CENTRO, LITERAL, READINGS, VARIANTS, Reading, Record, disturbed
from runs import Job, found, solve_all

#: tests that every variant runs
SPARSE = ("0(10)", "0(equiv)", "1", "2", "20")
#: tests of a slightly disturbed record
FEWER = ("0(exact)", "2", "20")
#: what may be left out
PARTS = ("systems", "finer", "variant", "stiffness", "disturbed")


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
    parser.add_argument("--quick", action="store_true", help="El Centro and the literal reading alone")
    parser.add_argument(
        "--without", action="append", default=[], choices=PARTS, help="leave a part out; the text says so"
    )
    parser.add_argument("--processes", type=int, metavar="N", help="default: one a core")
    return parser.parse_args(argv)


def progress(done: int, of: int) -> None:
    """Show how far the runs are, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{done} of {of} runs ", end="" if done < of else "\n", file=sys.stderr, flush=True)


def records_of(reading: Reading, folders: Sequence[Path]) -> tuple[list[Record], list[str]]:
    """The records of a reading that are at hand, and what is said of those that are not."""
    taken, told = [], []
    for group in reading.records:
        there = [r for r in group if found(r, folders)]
        taken += there[:1]
        if there[:1] != [group[0]]:
            instead = f"{there[0].says} in its place" if there else "left out"
            told.append(
                f"{reading.name} reading, {group[0].name}: {group[0].says} ({group[0].file}): {instead}"
            )
    return taken, told


def plan(folders: tuple[Path, ...], quick: bool) -> tuple[list[tuple[tuple[str, ...], Job]], list[str]]:
    """All runs with their places in the study, and what is left out for want of records."""
    jobs: list[tuple[tuple[str, ...], Job]] = []
    left_out: list[str] = []

    def add(
        place: tuple[str, ...], record: Record, tests: Iterable[Test], params: Mapping[str, object]
    ) -> None:
        jobs.extend((place, Job(record, test, params, folders)) for test in tests)

    for reading in (LITERAL,) if quick else READINGS:
        records, told = records_of(reading, folders)
        left_out += told
        for record in records[:1] if quick else records:
            add(
                ("reading", reading.name, record.name),
                record,
                (*TESTS, EXACT_EQUIVALENT, *CANDIDATES),
                reading.params,
            )
    if quick:
        return jobs, []
    add(("systems",), EL_CENTRO, SYSTEMS, {})
    add(("finer",), EL_CENTRO, FINER, {})
    for variant in VARIANTS[1:]:
        if found(variant.record, folders):
            add(
                ("variant", variant.name),
                variant.record,
                [t for t in TESTS if t.name in SPARSE],
                variant.params,
            )
        else:
            left_out.append(f"variant: {variant.name}")
    for factor, tests in stiffened():
        add(("stiffness", repr(factor)), EL_CENTRO, tests, {})
    for reading in READINGS:
        for record in records_of(reading, folders)[0]:
            for n, other in enumerate(disturbed(record)):
                tests = [t for t in (*TESTS, EXACT_EQUIVALENT) if t.name in FEWER]
                add(("disturbed", reading.name, record.name, str(n)), other, tests, reading.params)
    return jobs, left_out


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    args = arguments(argv)
    began = time.perf_counter()
    folders = tuple(p.resolve() for p in args.records)
    if not found(EL_CENTRO, folders):
        print('El Centro is missing: pip install "pound-solve[records]"', file=sys.stderr)
        return 3
    jobs, left_out = plan(folders, args.quick)
    jobs = [(place, job) for place, job in jobs if place[0] not in args.without]
    left_out += [f"the part `{part}`, on demand" for part in args.without]
    args.out.mkdir(parents=True, exist_ok=True)
    solved = solve_all([job for _, job in jobs], args.out / "runs.jsonl", progress, args.processes)
    runs = [(place, run) for (place, _), (run, _) in zip(jobs, solved)]
    used = {reading.name: records_of(reading, folders)[0] for reading in READINGS}
    study = Study(runs, used, folders, left_out)
    page = args.manual / "cole2011-study.md" if args.manual else args.out / "study.md"
    drawn = page.parent / "study" if args.manual else page.parent
    drawn.mkdir(parents=True, exist_ok=True)
    write(page, drawn, study)
    for name in left_out:
        print(f"left out, or done otherwise: {name}")
    print(
        f"{len(runs)} runs, {sum(cost for _, cost in solved):.0f} s of CPU time; in "
        f"{time.perf_counter() - began:.0f} s; {page}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
