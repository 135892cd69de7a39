"""One elastic building of the paper, set free: TAYLOR beside heyoka, in one session.

    python3.11 -m venv .venv-heyoka && .venv-heyoka/bin/pip install heyoka numpy
    python benchmarks/pair_building.py --heyoka .venv-heyoka/bin/python

Both follow the same 2 (n + 1) unknowns without forces or events for ten seconds. heyoka compiles the
system anew for each building; pound-solve's kernels are compiled once for all. CPU seconds of the
solution alone, best of five; pound-solve stores both floors every 0.02 s besides, heyoka nothing.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import pound_solve

HERE = Path(__file__).parent
DECK = """UNITS kN m s
PARAM  n = {n}
PARAM  g = 9.81   w1 = 1600   k1 = 420000   kd1 = 1881300
PARAM  lo = sqrt((3-sqrt(5))/2)   hi = sqrt((3+sqrt(5))/2)   s1 = sqrt(k1*g/w1)
GRAVITY g
NODES
   1  0 0 FIX=XYR
   2  20 0 FIX=XYR
   1000 TO 1000+n  0 TO 20  3.5  FIX=YR
   2000 TO 2000+n  0 TO 20  7    FIX=YR
ELEMENTS
   1 COL 1 1000
   2 COL 2 1000+n
   3 COL 1000 2000
   4 COL 1000+n 2000+n
   1001 TO 1000+n SLAB 1000 TO 999+n 1001 TO 1000+n
   2001 TO 2000+n SLAB 2000 TO 1999+n 2001 TO 2000+n
PROPS
   COL   SPRING  KX=k1/2
   SLAB  FRAME   E=kd1*20 A=1
WEIGHTS
   1000,1000+n,2000,2000+n  w1/(2*n)
   1001 TO 999+n            w1/n
   2001 TO 1999+n           w1/n
DAMPING
   RAYLEIGH XI=0.05 OMEGA=lo*s1,hi*s1 NODES=1000 TO 1000+n,2000 TO 2000+n PROPS=COL
INITIAL
   2000 TO 2000+n VX=1
ANALYSIS
   HISTORY {duration} METHOD=TAYLOR
OUTPUT
   EVERY=0.02 NODES=1000,2000 MEMBERS=1 STOREYS=NO
"""


def ours(n, duration, repeat):
    """CPU seconds of the solution, and the last displacements of both floors' left ends."""
    best = float("inf")
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder, "building.inp")
        deck.write_text(DECK.format(n=n, duration=duration))
        for _ in range(repeat + 1):
            with pound_solve.run(deck) as results:
                best = min(best, float(dict(results.table("run_figures").tolist())["solve seconds, CPU"]))
                ends, figures = results.history("node/u")[-1, :, 0], dict(results.table("run").tolist())
    return best, ends, figures


def main():
    """Run both sides for some sizes, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--heyoka", default=".venv-heyoka/bin/python", help="interpreter that has heyoka")
    parser.add_argument("--sizes", default="5,10,20,40")
    parser.add_argument("--duration", type=float, default=10.0)
    parser.add_argument("--repeat", type=int, default=5)
    args = parser.parse_args()
    print("   n  TAYLOR s  heyoka compact s (compilation)  unrolled s (compilation)  largest difference")
    for n in map(int, args.sizes.split(",")):
        own, ends, figures = ours(n, args.duration, args.repeat)
        command = [args.heyoka, "heyoka_building.py", f"--n={n}", f"--duration={args.duration}"]
        told = subprocess.run(command, cwd=HERE, capture_output=True, text=True, check=True).stdout
        peer = json.loads(told)
        apart = max(abs(a - b) for a, b in zip(ends, peer["compact"]["ends"]))
        compact, unrolled = (
            f"{peer[k]['solution']:.4f} ({peer[k]['compilation']:.2f})" for k in ("compact", "unrolled")
        )
        print(f"{n:4d}  {own:8.4f}  {compact:>30s}  {unrolled:>24s}  {apart:18.1e}")
        print(
            f"      {figures.get('series', '')} series, {figures.get('intervals in modes', '')}", flush=True
        )


if __name__ == "__main__":
    main()
