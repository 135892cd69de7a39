"""What large decks cost: CPU seconds and peak memory of whole processes, and how both grow.

    python benchmarks/large.py                          # all; some five CPU minutes, kernels compiled
    python benchmarks/large.py --only contacts record

Every case is one process, from its start to its report.  An exponent is the slope of log cost over log size
between two rows of one method, after the cost of a run with one node is taken off.  It prints Markdown.
"""

import argparse
import math
import os
import sys
import tempfile
import time
from pathlib import Path

from scale import chain, deck, row


def crowd(n):
    """n equal bodies that strike n walls at one instant."""
    return deck(
        [f"1 TO {n} 0 TO {n}-1 0 FIX=YR"],
        [f"1 TO {n} STOREY 1 TO {n}", f"{n}+1 TO 2*{n} WALL 1 TO {n}"],
        ["STOREY SPRING KX=100", "WALL CONTACT GAP=0.05 ANGLE=0 LAW=KELVIN_VOIGT K=2.5E4 E=0.6"],
        [f"1 TO {n} 9.81"], 0.1, 0.1, INITIAL=[f"1 TO {n} VX=1"],
    )  # fmt: skip


def pounding(n):
    """A row of n + 1 buildings that yield and pound, four seconds of it."""
    return row(n + 1, t=4.0, every=0.1)


def recorded(samples):
    """Ten storeys under a record of so many samples, 100 a second; a row of output each second."""
    return chain(10, t=samples / 100, every=1.0)


def stored(rows):
    """Two storeys; so many output times, each of which is a row of every history."""
    t = rows / 1000
    return chain(2, t=t, every=1e-3)


STEPS = ["--method", "NEWMARK", "--dt", "1e-3"]
#: name: deck of a size, sizes, options of each method
CASES = {
    "contacts that meet at once": (crowd, (100, 1000, 10_000), (STEPS, ["--method", "TAYLOR"], [])),
    "contacts in a row": (pounding, (100, 1000, 10_000), (STEPS, ["--method", "TAYLOR"])),
    "nodes": (chain, (1000, 10_000, 100_000), (STEPS, ["--method", "TAYLOR"], [])),
    "record": (recorded, (10_000, 100_000, 1_000_000), ([*STEPS[:3], "1e-2"], ["--method", "TAYLOR"])),
    "output rows": (stored, (100_000, 1_000_000, 10_000_000), (STEPS,)),
}


def cost(folder, text, options, limit):
    """CPU seconds, peak memory [MB] and how a process ended: its exit status, or a signal."""
    path = Path(folder, "large.inp")
    path.write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "pound_solve", str(path), "-o", folder, "--quiet", *options]
    process = os.posix_spawn(sys.executable, command, os.environ)
    while True:
        ended, status, used = os.wait4(process, os.WNOHANG)
        if ended:
            return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, os.waitstatus_to_exitcode(status)
        if spent(process) > limit:
            os.kill(process, 9)
        time.sleep(0.1)


def spent(process):
    """CPU seconds of a running process, where the system tells them."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=list(CASES), metavar="NAME", help="; ".join(CASES))
    parser.add_argument("--most", type=float, default=math.inf, help="leave out larger sizes")
    parser.add_argument("--limit", type=float, default=120.0, help="CPU seconds that a process may take")
    args = parser.parse_args()
    print("| what grows | size | method | CPU s | exponent | memory, MB | exponent |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        least = cost(folder, chain(1), STEPS, args.limit)
        for name in args.only:
            make, sizes, methods = CASES[name]
            for options in methods:
                method, before = options[1] if options else "AUTO", None
                for size in (s for s in sizes if s <= args.most):
                    *used, status = cost(folder, make(size), options, args.limit)
                    if status:
                        print(
                            f"| {name} | {size} | {method} | > {used[0]:.0f} | - | {used[1]:.0f} | - |",
                            flush=True,
                        )
                        break
                    slopes = ["-", "-"]
                    if before:
                        grown = [(b - z) / max(a - z, 0.1 * a) for a, b, z in zip(before[1], used, least)]
                        slopes = [
                            f"{math.log(g) / math.log(size / before[0]):.1f}" if g > 0 else "-"
                            for g in grown
                        ]
                    before = size, used
                    print(
                        f"| {name} | {size} | {method} | {used[0]:.1f} | {slopes[0]} "
                        f"| {used[1]:.0f} | {slopes[1]} |",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
