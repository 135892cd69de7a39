"""Kill runs at random moments: older results stand byte for byte, or the new ones are whole.

    python -m fuzz.kills 300 [--seed 0]           from the folder tests

Each round writes a deck with another method and motion beside the results of the round before, starts a
verb on it, kills its process (SIGKILL) after a random share of its time, and looks at what is there.
Prints how many rounds ended how; the exit status is 1 where one ended wrong.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from random import Random

from fuzz.cases import MOTIONS, plain
from pound_solve.results import Results, ResultsError
from pound_solve.results.place import digest_in
from pound_solve.results.whole_file import partial

METHODS = (
    "METHOD=EXACT",
    "METHOD=TAYLOR",
    "METHOD=LAGUERRE",
    "METHOD=NEWMARK DT=0.005",
    "METHOD=AUTO TOL=1E-2",
)
OLD, NEW = "the older results are intact", "the new results are whole"
#: verbs that write, and the names of what they write beside the deck
VERBS = {
    "run": (["run", "model.inp", "--quiet"], ("model.h5", "model.rpt")),
    "study": (
        ["study", "model.inp", "--methods", "EXACT,TAYLOR", "--repeat", "1"],
        ("model.study.h5", "model.study.rpt"),
    ),
    "format": (["format", "model.inp"], ()),
}


def start(verb: str, folder: Path) -> subprocess.Popen[bytes]:
    """Start a verb on the deck of a folder, kernels as Python."""
    words = [sys.executable, "-m", "pound_solve", *VERBS[verb][0]]
    there = os.pathsep.join(map(os.path.abspath, os.environ.get("PYTHONPATH", "").split(os.pathsep)))
    environment = {**os.environ, "POUND_COMPILE": "0", "PYTHONPATH": there}
    nowhere = subprocess.DEVNULL
    return subprocess.Popen(words, cwd=folder, env=environment, stdout=nowhere, stderr=nowhere)


def write(folder: Path, rng: Random) -> str:
    """Write another deck; returns its text."""
    motion = rng.choice(MOTIONS[:2]).replace("8", str(rng.randint(2, 9)))
    text = plain(motion, rng.choice(METHODS))
    (folder / "model.inp").write_text(text)
    return text


def contents(folder: Path, verb: str) -> list[bytes]:
    """Bytes of what a verb writes and what stands there."""
    paths = [folder / name for name in VERBS[verb][1]]
    return [path.read_bytes() for path in paths if path.exists()]


def verdict(folder: Path, verb: str, before: list[bytes], deck: str) -> str:
    """What stands in the folder after a kill, in words; those that begin with FAULT are wrong."""
    if verb == "format":
        # the deck before or after; a copy beside it may be left
        same = (folder / "model.inp").read_text().split() == deck.split()
        return "the deck is whole" if same else "FAULT: the deck is not whole"
    now = contents(folder, verb)
    if now and now == before[: len(now)]:  # killed amid the renaming, results stand without a report
        return OLD
    try:
        with Results.open(folder / VERBS[verb][1][0]) as results:
            whole = results.status == "done" and all(len(results.table(t)) >= 0 for t in results.tables)
            same = digest_in(folder / VERBS[verb][1][1]) in ("", results.digest)
    except ResultsError as error:
        return f"FAULT: {error}"
    return NEW if whole and same else f"FAULT: status {results.status}, one digest: {same}"


def left(folder: Path, verb: str) -> str:
    """What is left of the run that was killed: nothing, or a file that a reader opens or refuses."""
    if verb == "format":
        return ""
    own = partial(folder / VERBS[verb][1][0])
    if not own.exists():
        return "nothing partial"
    try:
        with Results.open(own) as results:
            return f"partial: {results.status}"
    except ResultsError:
        return "partial: refused in words"


def rounds(folder: Path, count: int, seed: int) -> Iterator[tuple[str, str, str]]:
    """Verb, verdict and what was left of each round."""
    rng = Random(seed)
    times = {}
    write(folder, rng)
    for verb in VERBS:
        begun = time.monotonic()
        assert start(verb, folder).wait() == 0, verb
        times[verb] = time.monotonic() - begun
    for _ in range(count):
        verb = rng.choice(("run", "run", "run", "study", "format"))
        deck = write(folder, rng)
        before = contents(folder, verb)
        process = start(verb, folder)
        with suppress(subprocess.TimeoutExpired):
            process.wait(rng.uniform(0.3, 1.2) * times[verb])
        process.kill()
        process.wait()
        yield verb, verdict(folder, verb, before, deck), left(folder, verb)
        for path in folder.glob("*.partial.*"):
            path.unlink()


def main() -> int:
    """Kill and count."""
    parser = argparse.ArgumentParser(description="Kill runs at random moments.")
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = Counter(rounds(Path(folder), args.count, args.seed))
    for (verb, words, rest), count in sorted(found.items()):
        print(f"{count:5}  {verb:7}{words}; {rest}".rstrip("; "))
    return int(any(words.startswith("FAULT") for _, words, _ in found))


if __name__ == "__main__":
    sys.exit(main())
