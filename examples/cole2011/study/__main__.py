"""The study of Cole, Dhakal, Carr & Bull (2011), anew: ``python examples/cole2011/study -o FOLDER``.

Runs ten tests under three records, and what the paper leaves unsaid in variants and in many readings;
writes ``study.md``, ``annex.md`` and ``readings.md`` with pictures beside them.  The Mexico City record is
in no package: give its folder with ``--records``; without it the study says what it left out.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from cases import APART, EXACT_EQUIVALENT, FINER, METHODS, SYSTEMS, TESTS, Test, stiffened
from choices import COSTLY, DAMPING, LITERAL, READINGS, STRUCTURES, VARIANTS, Reading, Structure
from gathered import Study
from motions import EL_CENTRO, RECORDS, Record, disturbed
from pages import write
from runs import Job, found, solve_all

#: tests that every variant runs
SPARSE = ("0(10)", "0(equiv)", "1", "2", "20")
#: tests of a slightly disturbed record
FEWER = ("0(equiv)", "0(exact)", "2", "20")
#: what may be left out
PARTS = ("systems", "finer", "method", "variant", "stiffness", "disturbed", "cell")


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
        help="write the pages of the manual instead: DIR/cole2011-study.md, -annex.md and -readings.md",
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


Planned = tuple[tuple[str, ...], Job]


def cells(folders: tuple[Path, ...]) -> tuple[list[Planned], list[str]]:
    """Return the runs of every structure under every record, and the records without a file."""
    every = [r for group in RECORDS for r in group]
    at_hand = [r for r in every if found(r, folders)]
    pairs = list(product(STRUCTURES, at_hand))
    for structure, records in COSTLY:
        first = [next((r for r in group if r in at_hand), None) for group in records]
        pairs += [(structure, r) for r in first if r is not None]
    jobs: list[Planned] = []
    for structure, record in pairs:
        jobs += jobs_of(
            ("cell", repr(structure), record.says), record, (*TESTS, EXACT_EQUIVALENT), structure, folders
        )
    return jobs, [f"{r.name}: {r.says} ({r.file})" for r in every if r not in at_hand]


def jobs_of(
    place: tuple[str, ...],
    record: Record,
    tests: Iterable[Test],
    structure: Structure,
    folders: tuple[Path, ...],
) -> list[Planned]:
    """Return the runs of some tests of a structure under a record."""
    damping = DAMPING[structure.damping]
    return [(place, Job(record, test, structure.params, folders, damping)) for test in tests]


def plan(folders: tuple[Path, ...], quick: bool) -> tuple[list[Planned], list[str]]:
    """All runs with their places in the study, and what is left out for want of records."""
    jobs: list[Planned] = []
    left_out: list[str] = []

    def add(
        place: tuple[str, ...],
        record: Record,
        tests: Iterable[Test],
        params: Mapping[str, object],
        damping: str = "",
    ) -> None:
        jobs.extend((place, Job(record, test, params, folders, damping)) for test in tests)

    for reading in (LITERAL,) if quick else READINGS:
        records, told = records_of(reading, folders)
        left_out += told
        for record in records[:1] if quick else records:
            place = ("reading", reading.name, record.name)
            jobs += jobs_of(place, record, (*TESTS, EXACT_EQUIVALENT, *APART), reading.structure, folders)
    if quick:
        return jobs, []
    add(("systems",), EL_CENTRO, SYSTEMS, {})
    add(("finer",), EL_CENTRO, FINER, {})
    add(("method",), EL_CENTRO, METHODS, {})
    for variant in VARIANTS:
        if found(variant.record, folders):
            tests = [t for t in TESTS if t.name in SPARSE]
            add(("variant", variant.name), variant.record, tests, variant.params, variant.damping)
        else:
            left_out.append(f"variant: {variant.name}")
    for factor, tests in stiffened():
        add(("stiffness", repr(factor)), EL_CENTRO, tests, {})
    for reading in READINGS:
        for record in records_of(reading, folders)[0]:
            for n, other in enumerate(disturbed(record)):
                fewer = [t for t in (*TESTS, EXACT_EQUIVALENT) if t.name in FEWER]
                place = ("disturbed", reading.name, record.name, str(n))
                jobs += jobs_of(place, other, fewer, reading.structure, folders)
    of_cells, without = cells(folders)
    return jobs + of_cells, [*left_out, *without]


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
    runs = [(place, run, cost) for (place, _), (run, cost) in zip(jobs, solved)]
    used = {reading.name: records_of(reading, folders)[0] for reading in READINGS}
    write(args.out, args.manual, Study(runs, used, folders, left_out))
    for name in left_out:
        print(f"left out, or done otherwise: {name}")
    print(
        f"{len(runs)} runs, {sum(cost for _, cost in solved):.0f} s of CPU time; in "
        f"{time.perf_counter() - began:.0f} s; {args.manual or args.out}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
