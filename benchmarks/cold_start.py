"""Cold start of the lumped deck, whole process, beside what importing the five packages takes.

    python benchmarks/cold_start.py

The budget: within twice the imports plus 0.4 s.  Medians of interleaved runs, so that load on the machine
meets both alike.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DECK = Path(__file__).resolve().parent.parent / "examples" / "cole2011" / "lumped.inp"
IMPORTS = "import numpy, scipy.linalg, h5py, lark, tabulate"


def seconds(*words):
    """Wall time of one process."""
    began = time.perf_counter()
    subprocess.run([sys.executable, *words], check=True, capture_output=True)
    return time.perf_counter() - began


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as out:
        runs = {
            "bare Python": ("-c", "pass"),
            "imports of the five packages": ("-c", IMPORTS),
            "pound-solve --version": ("-m", "pound_solve", "--version"),
            "pound-solve lumped.inp": ("-m", "pound_solve", str(DECK), "-o", out, "--quiet"),
        }
        times = {name: [] for name in runs}
        for _ in range(rounds):
            for name, words in runs.items():
                times[name].append(seconds(*words))
    medians = {name: statistics.median(t) for name, t in times.items()}
    for name, t in times.items():
        print(f"{name:30} {medians[name]:7.3f} s   ({min(t):.3f} to {max(t):.3f})")
    budget = 2 * medians["imports of the five packages"] + 0.4
    print(f"{'budget of the lumped deck':30} {budget:7.3f} s")


if __name__ == "__main__":
    main()
