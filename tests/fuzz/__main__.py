"""Fuzz the program: decks, runs, records, results files and words of the command line.

    python -m fuzz                                from the folder tests, as `make fuzz N=1000` does
    python -m fuzz --seed 3 --deck 100000 --run 500 --out FOLDER
    python -m fuzz --seed 3 --only deck 4711      one case again, its files in FOLDER

Prints how many cases of each kind ended how.  A fault leaves a folder with its files, what was said, and
the command that repeats it; the exit status is then 1.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from fuzz.cases import KINDS, bases, case
from fuzz.judge import ENDS, Outcome
from fuzz.workers import outcomes
from pound_solve.numerics import threads

#: share of each kind in N decks: half of all cases are whole runs
SHARES = {
    "deck": 1.0,
    "verbs": 0.02,
    "editor": 0.005,
    "run": 1.25,
    "record": 0.2,
    "results": 0.05,
    "words": 0.01,
    "options": 0.1,
    "study": 0.03,
    "import": 0.1,
    "texts": 0.02,
}


def keep(
    out: Path, kind: str, seed: int, number: int, outcome: Outcome, whole: Mapping[str, bytes]
) -> Path:
    """Write a fault as small files with the command that repeats it."""
    own = case(kind, seed, number, whole)
    folder = out / f"{kind}-{seed}-{number}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, data in own.files.items():
        (folder / name).write_bytes(data)
    again = f"PYTHONPATH=solver:parser:tests python -m fuzz --seed {seed} --only {kind} {number}"
    text = f"{outcome.end}\n\n{own.command}\n{again}\n\n{outcome.said}\n"
    (folder / "fault.txt").write_text(text, encoding="utf-8", errors="backslashreplace")
    return folder


def tasks(counts: Mapping[str, int], first: int) -> Iterator[tuple[str, int]]:
    """All cases, kind by kind."""
    for kind, count in counts.items():
        for number in range(first, first + count):
            yield kind, number


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description="Fuzz the program.")
    parser.add_argument("-n", type=int, default=1000, help="number of decks; other kinds in proportion")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("build/fuzz"), help="folder of faults")
    parser.add_argument("--only", nargs=2, metavar=("KIND", "NUMBER"), help="one case")
    for kind in KINDS:
        parser.add_argument(f"--{kind}", type=int, metavar="N", help=f"number of cases of {kind}")
    return parser.parse_args()


def main() -> int:
    """Run the cases and print the counts."""
    threads.one()  # of each worker, as on the command line
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell may have had ignored
    args = arguments()
    given = {kind: getattr(args, kind) for kind in KINDS}
    if args.only:
        args.first, given = int(args.only[1]), {args.only[0]: 1}
    elif not any(count is not None for count in given.values()):
        given = {kind: max(1, round(share * args.n)) for kind, share in SHARES.items()}
    counts = {kind: count for kind, count in given.items() if count}
    found: Counter[tuple[str, str]] = Counter()
    whole: Mapping[str, bytes] = {}
    if "results" in counts:
        with tempfile.TemporaryDirectory() as folder:
            whole = bases(Path(folder))
    with suppress(KeyboardInterrupt):  # Ctrl-C: the counts so far
        for kind, number, outcome in outcomes(tasks(counts, args.first), args.jobs, args.seed, whole):
            found[kind, outcome.end] += 1
            if outcome.fault:
                where = keep(args.out, kind, args.seed, number, outcome, whole)
                print(f"{outcome.end}: {where}", flush=True)
            if args.only:
                print(outcome.said)
    for kind in counts:
        own = {end: count for (k, end), count in sorted(found.items()) if k == kind}
        print(f"{kind:8}", ", ".join(f"{end} {count}" for end, count in own.items()))
    return int(any(end not in ENDS for _, end in found))


if __name__ == "__main__":
    sys.exit(main())
