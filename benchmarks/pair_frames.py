"""pound-solve and OpenSees step by step, in one go: steel frames, and the chain of the paper.

    python benchmarks/pair_frames.py                      # everything; some minutes
    python benchmarks/pair_frames.py frames --case 10x3

Both sides take the same steps of the same method, so here the work per step counts, not the error (for
that see ``pair_cole.py``).  Times are CPU seconds of the step loop alone, one thread each, the best of
some rounds.  On our side two runs of different length, one after the other, are subtracted: what remains
holds no compilation, no layout and no report.  Of some such differences the median is told, and nothing
where they differ too much among themselves.
"""

import argparse
import math
import os
import re
import statistics
import sys
import tempfile
import tracemalloc
from pathlib import Path
from typing import NamedTuple

from pair_cole import DECK as CHAIN
from pair_cole import HERE, PEER, read_at2, record_file, text, theirs, write_two_columns

FRAMES = HERE.parent / "examples" / "frames"
DT = 0.005  # of the frames [s]
CHAIN_DT = 1e-4  # below the stability limit of the chain with 20 elements a diaphragm [s]
SHORT = 0.05  # length of the run that is taken off [s]
NOISY = 0.3  # share of their median that the quartiles of times may be apart
STOREYS = 5, 10, 20, 40, 80, 160  # of the growth, three bays


class Case(NamedTuple):
    """One frame: its deck, what is set there, and the same for the peer."""

    deck: str
    params: dict[str, float]
    peer: list[str]


CASES = {
    "small": Case("steel_10x3", {"storeys": 2, "pga": 12, "t": 5}, ["--storeys=2", "--bays=3"]),
    "10x3": Case("steel_10x3", {}, ["--storeys=10", "--bays=3"]),
    "20x6": Case("steel_20x6", {}, ["--storeys=20", "--bays=6", "--tall"]),
}
GEOMETRIES = "SMALL", "PDELTA"


# ---------------------------------------------------------------------- our side


def ours(deck, folder, **options):
    """One run of a deck: CPU seconds of its analyses, steps, and the results that are left open."""
    from pound_solve import run  # not before the number of threads is set

    results = run(deck, out=tempfile.mkdtemp(dir=folder), **options)
    if results.status != "done":
        sys.exit(f"pair_frames: {results.message}")
    told = {
        text(row["item"]): text(row["value"])
        for name in ("run", "run_figures")
        for row in results.table(name)
    }
    return float(told["solve seconds, CPU"]), int(told["steps"]), results


def per_step(deck, folder, params, length, rounds, **options):
    """Microseconds for a step, the median of some rounds after one that compiles; NaN where the rounds
    differ too much.
    """
    found = []
    for _ in range(rounds + 1):
        taken = []
        for t in (SHORT, length):
            own = {**params, "t": t}
            if "every" in own:
                own["every"] = t
            seconds, steps, results = ours(deck, folder, params=own, **options)
            results.close()
            taken.append((seconds, steps))
        (short, few), (long, many) = taken
        found.append(1e6 * (long - short) / (many - few))
    found = sorted(found[1:])
    low, median, high = statistics.quantiles(found, method="inclusive") if rounds > 1 else 3 * found
    return median if median > 0.0 and high - low <= NOISY * median else math.nan


def beside(us, best):
    """Our time for a step, and how often it goes into the peer's."""
    return "   lost in noise" if math.isnan(us) else f"{us:9.2f} us a step, {best / us:.1f} times less"


def variant(case, geometry, folder):
    """Deck of a case with another GEOMETRY, in a file of its own."""
    source = (FRAMES / f"{case.deck}.inp").read_text(encoding="utf-8")
    path = Path(folder, f"{case.deck}_{geometry}.inp")
    path.write_text(re.sub(r"^GEOMETRY .*", f"GEOMETRY {geometry}", source, flags=re.M), encoding="utf-8")
    return path


def our_peaks(deck, folder, params, events):
    """Extremes of roof and hinges at the steps, as the peer takes them."""
    params = {**params, "every": DT, "events": f'"{events}"'}
    _, _, results = ours(deck, folder, params=params)
    with results:
        roof = results.history("drift")[:, 0]
        turns = abs(results.history("spring/deformation")[1:]).max(axis=0)
        hinges = dict(zip(results.labels("spring/deformation"), turns.tolist()))
    return {"roof": [float(roof.max()), float(roof.min())], "hinges": hinges}


# ---------------------------------------------------------------------- the peer


def write_motion(case, folder):
    """Samples of the deck's motion for the peer: dt, then accelerations up to the end of the history."""
    step = 0.01  # of SYNTHETIC
    deck = FRAMES / f"{case.deck}.inp"
    _, _, results = ours(deck, folder, params={**case.params, "every": step})
    with results:
        samples = results.history("ground").ravel()
    path = Path(folder, "motion.txt")
    path.write_text("".join(f"{x!r}\n" for x in [step, *samples.tolist()]))
    return path


# ---------------------------------------------------------------------- the comparisons


def difference(mine, other):
    """Largest difference of roof and of hinges, each relative to the largest of its kind."""
    roof = max(abs(a - b) for a, b in zip(mine["roof"], other["roof"])) / max(map(abs, other["roof"]))
    hinges, peers = mine["hinges"], other["hinges"]
    if hinges.keys() != peers.keys():
        sys.exit("pair_frames: the sides name different hinges")
    return roof, max(abs(hinges[k] - peers[k]) for k in peers) / max(peers.values())


def frames(args, folder):
    """The steel frames under the same motion, with and without P-Delta."""
    solvers = [] if args.peaks else args.solvers
    for name in args.case:
        case = CASES[name]
        motion = write_motion(case, folder)
        for geometry in GEOMETRIES:
            deck = variant(case, geometry, folder)
            said = theirs(
                args.peer, "opensees_steel_frame.py", motion, *case.peer, f"--geometry={geometry}",
                f"--dt={DT}", f"--repeat={args.repeat}", "--time", *solvers,
            )  # fmt: skip
            print(f"\n{name}, {geometry}: {said['equations']} equations, {said['steps']} steps of {DT} s")
            print(f"  OpenSees: {said['iterations']:.2f} iterations a step, period {said['period']:.10g} s")
            if args.peaks:
                frozen(said)
            for events in ("STEPPED", "LOCATED"):
                mine = our_peaks(deck, folder, case.params, events)
                print("  pound-solve {}: roof differs by {:.1e}, hinges by {:.1e}".format(
                    events, *difference(mine, said)))  # fmt: skip
            if not solvers:
                continue
            best = min(said["microseconds"].values())
            for solver in solvers:
                us = said["microseconds"].get(solver)
                print(f"  OpenSees, {solver:28}" + (f"{us:9.1f} us a step" if us else "   stops"))
            for events in ("STEPPED", "LOCATED"):
                params = {**case.params, "every": 1, "events": f'"{events}"'}
                us = per_step(deck, folder, params, case.params.get("t", 20), args.repeat)
                print(f"  pound-solve, {events:25}{beside(us, best)}")


def frozen(said):
    """The peer's numbers that a test keeps."""
    some = sorted(said["hinges"], key=said["hinges"].get)[-3:]
    print("  roof", *said["roof"], "sum of the hinges", sum(said["hinges"].values()))
    print("  hinges", *(f"{k}: {said['hinges'][k]!r}" for k in some), sep="\n    ")


def lean(folder):
    """Deck of the chain with as little output as the frames."""
    deck = Path(folder, "chain.inp")
    deck.write_text(CHAIN.read_text(encoding="utf-8") + "\nOUTPUT\n   EVERY=t\n", encoding="utf-8")
    return deck


def chain(args, folder):
    """The paper's buildings, 20 elements a diaphragm: 84 DOFs."""
    deck = lean(folder)
    record = Path(folder, "record.txt")
    write_two_columns(record, *read_at2(args.record or record_file()))
    print(f"\nchain of 84 degrees of freedom, dt {CHAIN_DT:g} s")
    for method, forms in {"newmark": ("newmark",), "central": ("central", "central-lagged")}.items():
        theirs_us = []
        for form in forms:
            tries = [
                theirs(
                    args.peer, "opensees_cole.py", record, "--n=20", f"--dt={CHAIN_DT}",
                    f"--integrator={form}", "--no-closures",
                )
                for _ in range(args.repeat)
            ]  # fmt: skip
            best = min(tries, key=lambda said: said["cpu_seconds"])
            theirs_us.append(1e6 * best["cpu_seconds"] / best["steps"])
            print(f"  OpenSees, {form + ', ' + best['solver']:28}{theirs_us[-1]:9.2f} us a step")
        us = per_step(deck, folder, {"n": 20}, 10.0, args.repeat, method=method.upper(), dt=CHAIN_DT)
        print(f"  pound-solve, {method:25}{beside(us, min(theirs_us))}")


def growth(args, folder):
    """Time and memory against storeys, three bays; 40 storeys of these columns would buckle: no P-Delta."""
    deck = variant(CASES["10x3"], "SMALL", folder)
    print("\nstoreys    us a step    whole run, MB")
    rows = []
    for storeys in STOREYS:
        params = {"storeys": storeys, "pga": 3, "every": 1, "events": '"STEPPED"'}
        us = per_step(deck, folder, params, 200.0, args.repeat)
        tracemalloc.start()
        ours(deck, folder, params={**params, "t": SHORT, "every": SHORT})[2].close()
        size = tracemalloc.get_traced_memory()[1] / 1e6
        tracemalloc.stop()
        rows.append((storeys, us, size))
        print(f"{storeys:7} {us:12.1f} {size:12.1f}")
    for column, what in ((1, "time"), (2, "memory")):
        (a, *x), (b, *y) = rows[-2], rows[-1]
        print(f"{what} grows as storeys^{math.log(y[column - 1] / x[column - 1], b / a):.2f} at the end")


WHAT = {"frames": frames, "chain": chain, "growth": growth}


def main():
    """Run both sides, print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("what", nargs="*", metavar="WHAT", help=f"of {', '.join(WHAT)}; left out: all")
    add("--case", nargs="+", choices=CASES, default=["10x3", "20x6"])
    add("--solvers", nargs="+", help="of opensees_steel_frame.py",
        default=["BandSPD", "ProfileSPD", "SparseSYM", "UmfPack", "BandSPD, Krylov", "ProfileSPD, Krylov",
                 "BandSPD, modified"])  # fmt: skip
    add("--repeat", type=int, default=5, help="rounds")
    add("--peaks", action="store_true", help="no times: the numbers that the verification test keeps")
    add("--peer", type=Path, default=PEER, help="interpreter of the peer's environment")
    add("--record", type=Path, help="PEER file of El Centro 270, where it is not installed")
    args = parser.parse_args()
    if wrong := set(args.what) - set(WHAT):
        parser.error(f"there is no {', '.join(wrong)}; there are {', '.join(WHAT)}")
    if not args.peer.exists():
        sys.exit(f"pair_frames: no {args.peer}; make it by peer_env.py")
    for library in ("OMP", "OPENBLAS", "MKL"):  # one thread, as the peer; numpy is not imported yet
        os.environ[f"{library}_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        for name in args.what or WHAT:
            WHAT[name](args, folder)


if __name__ == "__main__":
    main()
