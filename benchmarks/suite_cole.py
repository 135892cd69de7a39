"""A suite of runs of the paper's two buildings: what a run costs, and the peer at equal error.

    python benchmarks/suite_cole.py --runs 200

The runs scale the record by factors about 1.  Each keeps what the peer's script keeps, extremes of drifts
and contacts.  One process carries out all of them, on one thread; what it loads and reads counts.
"""

import argparse
import csv
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import pair_cole as pair

SPREAD = 0.1  # the factors lie within 1 less and 1 plus this


def suite(record, n, count, folder, duration=pair.DURATION):
    """CPU seconds of all runs: of the whole process, and of each run alone."""
    step = 2.0 * SPREAD / max(count - 1, 1)
    factors = ",".join(f"{pair.SIGN * (1.0 - SPREAD + step * i):.6f}" for i in range(count))
    command = [sys.executable, "-m", "pound_solve", "sweep", pair.lean(folder), "--motions", record]
    command += [f"--scale={factors}", "--set", f"n={n}", "--set", f"t={duration}", "--workers", "1"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*command, "-o", Path(folder, "out"), "--quiet"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with Path(folder, "out", "sweep.csv").open(newline="") as file:
        own = [float(row["cpu_seconds"]) for row in csv.DictReader(file) if row["status"] == "done"]
    if len(own) != count:
        sys.exit(f"suite_cole: {count - len(own)} of {count} runs are not done")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, own


def main():
    """Run both sides, print what a run costs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--n", type=int, default=20, help="axial elements for each diaphragm")
    add("--runs", type=int, default=200)
    add("--dt", nargs="+", type=float, default=[1e-5, 5e-6], help="steps of the peer [s]")
    add("--peer", type=Path, default=pair.PEER, help="interpreter of the peer's environment")
    add("--record", type=Path, help=f"PEER file of {pair.RECORD}, where it is not installed")
    args = parser.parse_args()
    if not args.peer.exists():
        sys.exit(f"suite_cole: no {args.peer}; make it by peer_env.py")
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ[f"{library}_NUM_THREADS"] = "1"
    found = args.record or pair.record_file()
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder, "record.txt")
        pair.write_two_columns(record, *pair.read_at2(found))
        reference = pair.ours(pair.lean(folder), folder, {"n": args.n}, "TAYLOR")
        peer = [pair.opensees(args.peer, record, "central", dt, f"--n={args.n}") for dt in args.dt]
        whole, own = suite(found, args.n, args.runs, folder)
    a_run = whole / args.runs
    print(f"n = {args.n}, {args.runs} runs: {whole:.1f} CPU s, {1.0 / a_run:.2f} runs per CPU second")
    middle = sorted(own)[len(own) // 2]
    print(f"CPU s of a run: {a_run:.3f}; without start and tables {middle:.3f} (median)")
    told = [pair.errors(answer, reference) for answer in peer]
    for kind, error in pair.EQUAL.items():
        points = [(one[kind], answer.seconds) for one, answer in zip(told, peer)]
        seconds, beyond = pair.seconds_for(error, points)
        star = " *" if beyond else ""
        print(f"the peer, {kind} to {error:g}: {seconds:.1f} CPU s{star}, ratio {seconds / a_run:.0f}")
    print("* beyond the runs: extrapolated, or the coarsest run is better already")


if __name__ == "__main__":
    main()
