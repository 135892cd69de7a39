"""What a run costs against the size of its model, and where AUTO goes over from EXACT to other
methods.

    python benchmarks/scale.py                              # all; some eight minutes
    python benchmarks/scale.py growth --only contacts
    python benchmarks/scale.py changeover --only lumped "chain 20"

Growth: CPU seconds of the history alone, one thread, the best of some rounds after one that loads and
compiles; memory is the peak of what Python and numpy hold during a whole run.  What the smallest size costs
is taken off: every run costs that; an exponent is the slope of the straight line that fits the log of the
rest over log size best, through the last three sizes that cost half as much again.  Growth ends with one
table, in Markdown.  Changeover: CPU seconds of a whole process, which loads what its method needs, because
that is what a user waits for; kernels are compiled before.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
import tracemalloc
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import NamedTuple
from unittest import mock

from pair_cole import HERE, text

EXAMPLES = HERE.parent / "examples"
TOL = 1e-3
WITHIN = 1.2  #: AUTO may cost so many times the best
ROUNDS, LONG = 4, 2.0  #: rounds, of which the first warms up; after so many seconds in all there is none
LIMIT = 60.0  #: seconds that a process may take
FITTED = 3  #: sizes that an exponent is fitted to, at most


class Run(NamedTuple):
    """What one run cost."""

    seconds: float  # CPU, of the history
    facts: dict[str, str]  # the table `run`


# ---------------------------------------------------------------------- models


def deck(nodes, elements, props, weights, t, every, **more):
    """Text of a deck of springs along x."""
    parts = {
        "NODES": nodes, "ELEMENTS": elements, "PROPS": props, "WEIGHTS": weights, **more,
        "ANALYSIS": [f"HISTORY {t}"], "OUTPUT": [f"EVERY={every}", "NODES=1"],
    }  # fmt: skip
    lines = ["UNITS kN m s", "GRAVITY 9.81"]
    for name, own in parts.items():
        lines += [name, *own]
    return "\n".join(lines) + "\n"


def shaken(pga, t):
    """What shakes a deck, and damps it."""
    return {
        "DAMPING": ["RAYLEIGH ALPHA=0.5 BETA=0.001"],
        "EQUAKE": [f"SYNTHETIC PGA={pga} SEED=5 DURATION={t}"],
    }


def chain(n, t=2.0, every=0.1):
    """n equal masses on n equal elastic springs: no law at all."""
    return deck(
        ["1000000 0 0 FIX=XYR", f"1 TO {n} 1 TO {n} 0 FIX=YR"],
        ["1 S 1000000 1"] + ([f"2 TO {n} S 1 TO {n - 1} 2 TO {n}"] if n > 1 else []),
        ["S SPRING KX=4E5"], [f"1 TO {n} 2000"], t, every, **shaken(3, t),
    )  # fmt: skip


def row(buildings, storeys=1, t=10.0, every=0.02, rule="ELASTO_PLASTIC"):
    """A row of shear buildings, every second one softer; neighbours' floors pound."""
    nodes, elements, weights = [], [], []
    for b in range(buildings):
        base, first, last = (b * storeys + i for i in (0, 1, storeys))
        nodes += [
            f"{1_000_000 + b} {10 * b} 0 FIX=XYR",
            f"{first} TO {last} {10 * b} 1 TO {storeys} FIX=YR"
            if storeys > 1
            else f"{first} {10 * b} 1 FIX=YR",
        ]
        elements.append(f"{first} C{b % 2} {1_000_000 + b} {first}")
        if storeys > 1:
            elements.append(f"{first + 1} TO {last} C{b % 2} {first} TO {last - 1} {first + 1} TO {last}")
        if b:
            ends = f"{first - storeys} TO {base} {first} TO {last}" if storeys > 1 else f"{base} {first}"
            span = f"{500_000 + first} TO {500_000 + last}" if storeys > 1 else f"{500_000 + first}"
            elements.append(f"{span} POUND {ends}")
    total = buildings * storeys
    weights.append(f"1 TO {total} 2000")
    return deck(
        nodes, elements,
        [
            f"C0 SPRING KX=4E5 FX=2000 RULE={rule}", f"C1 SPRING KX=2.5E5 FX=1500 RULE={rule}",
            "POUND CONTACT GAP=0.01 ANGLE=0 LAW=KELVIN_VOIGT K=2E6 C=0",
        ],
        weights, t, every, **shaken(4, t),
    )  # fmt: skip


def bouncer(events):
    """One mass that flies to and fro between two walls, a hundred changes a second and no loss."""
    t = events / 100
    return deck(
        ["1000000 0 0 FIX=XYR", "1 1 0 FIX=YR", "2 2 0 FIX=XYR"],
        ["1 S 1000000 1", "2 POUND 1 2", "3 POUND 1000000 1"],
        ["S SPRING KX=1", "POUND CONTACT GAP=0.00841 ANGLE=0 LAW=KELVIN_VOIGT K=2E8 C=0"],
        ["1 2000"], t, t / 10, INITIAL=["1 VX=1"],
    )  # fmt: skip


#: name: deck, what is set in it
SCENES = {
    "two oscillators": (EXAMPLES / "01_two_oscillators" / "two_oscillators.inp", {}),
    "lumped": (EXAMPLES / "cole2011" / "lumped.inp", {}),
    "chain 5": (EXAMPLES / "cole2011" / "distributed.inp", {"n": 5}),
    "chain 20": (EXAMPLES / "cole2011" / "distributed.inp", {"n": 20}),
    "chain 60": (EXAMPLES / "cole2011" / "distributed.inp", {"n": 60}),
    "row 3 x 4": (row(3, 4), {}),
    "row 8 x 10": (row(8, 10), {}),
    "row 6 x 5, Takeda": (row(6, 5, rule="TAKEDA ALFA=0.4 BETA=0.3 R=0.02"), {}),
    "row of three": (EXAMPLES / "07_row_of_three" / "row_of_three.inp", {}),
    "concrete frame": (EXAMPLES / "03_concrete_frame" / "concrete_frame.inp", {}),
    "timber frame": (EXAMPLES / "04_timber_frame" / "timber_frame.inp", {}),
    "unequal frames": (EXAMPLES / "06_unequal_frames" / "unequal_frames.inp", {}),
    "steel 10 x 3": (EXAMPLES / "frames" / "steel_10x3.inp", {"t": 5, "pga": 6}),
}


# ---------------------------------------------------------------------- runs


def run(folder, source, method, rounds=ROUNDS, **options):
    """One model by one method; the least of some rounds."""
    from pound_solve import run as solve  # not before the number of threads is set

    path = Path(folder, "scene.inp")
    path.write_text(source, encoding="utf-8")
    best, began = None, time.process_time()
    for i in range(rounds):
        with (
            tempfile.TemporaryDirectory(dir=folder) as out,
            solve(path, out=out, method=method, **options) as results,
        ):
            if results.status != "done":
                sys.exit(f"scale: {results.message}")
            used, facts = costs(results)
        if best is None or i == 1 or used < best.seconds:  # the first one may have compiled
            best = Run(used, facts)
        if time.process_time() - began > LONG and i:
            break
    return best


def costs(results):
    """CPU seconds of the histories, and the table `run`."""
    figures, facts = (
        {text(r["item"]): text(r["value"]) for r in results.table(name)} for name in ("run_figures", "run")
    )
    return float(figures["solve seconds, CPU"]), facts


@contextmanager
def steps_alone(auto):
    """Keep AUTO from EXACT and TAYLOR."""
    with (
        mock.patch.object(auto, "reason_not_linear", lambda system: "barred"),
        mock.patch.object(auto, "has_series", lambda system: False),
    ):
        yield


def one(path, params, method, tol, barred):
    """Solve in this process, which ends; print what it cost."""
    from pound_solve import run as solve
    from pound_solve.integrate import auto

    options = {"method": method} | ({"tol": tol} if method == "AUTO" else {})
    with (
        steps_alone(auto) if barred else nullcontext(),
        tempfile.TemporaryDirectory() as out,
        solve(path, params=params, out=out, **options) as results,
    ):
        solving, facts = costs(results)
        print(json.dumps([results.status, solving, facts]))


def process(path, params, method, tol, barred=False):
    """One model by one method in a process of its own, the least of two after one that
    compiles.
    """
    command = [sys.executable, __file__, "--one", json.dumps([str(path), params, method, tol, barred])]
    best = None
    for _ in range(3):
        before = os.times()
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT)
        except subprocess.TimeoutExpired:
            return best
        after = os.times()
        if done.returncode:
            return None
        used = after.children_user + after.children_system - before.children_user - before.children_system
        status, solving, facts = json.loads(done.stdout)
        if status != "done":
            return None
        if best is None or used < best.seconds:
            best = Run(used, {**facts, "solving": solving})
        if used > 10 * LONG and solving > 10 * LONG:
            break
    return best


def memory(folder, source, method, **options):
    """Peak of memory of a whole run [MB]."""
    tracemalloc.start()
    run(folder, source, method, rounds=1, **options)
    peak = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    return peak


# ---------------------------------------------------------------------- growth

#: name: (of what, sizes, model, {method: (options, largest size)}, the reason of the exponents)
GROWTH = {
    "degrees of freedom": (
        "degrees of freedom of an elastic chain, 2 s, steps of 10 ms",
        (10, 100, 1000, 10_000, 100_000),
        chain,
        {"NEWMARK": ({"dt": 0.01}, 100_000), "TAYLOR": ({}, 100_000), "EXACT": ({}, 1000)},
        "a step passes once over the entries of the factor, a series some 30 times over those of K; "
        "EXACT: all modes, dense",
    ),
    "contacts": (
        "contacts in a row of one-storey buildings, 5 s, steps of 1 ms",
        (1, 3, 10, 100, 1000),
        lambda n: row(n + 1, t=5.0),
        {"NEWMARK": ({"dt": 1e-3}, 1000), "TAYLOR": ({}, 1000), "EXACT": ({}, 10)},
        "a step passes over all laws, and events, as many again, cost some steps, or a series, over all; "
        "EXACT: a window and new modes for each event",
    ),
    "events": (
        "changes of one mass between two walls, a hundred a second, steps of 1 ms",
        (10, 100, 1000, 10_000, 100_000),
        bouncer,
        {"NEWMARK": ({"dt": 1e-3}, 100_000), "TAYLOR": ({}, 100_000), "EXACT": ({}, 1000)},
        "every event costs the same, and every closure leaves a row",
    ),
    "record": (
        "seconds of a record with 100 samples a second, ten elastic masses, ten times stored",
        (10.0, 100.0, 1000.0, 10_000.0),
        lambda t: chain(10, t, t / 10),
        {"NEWMARK": ({"dt": 0.01}, 10_000.0), "TAYLOR": ({}, 10_000.0), "EXACT": ({}, 1000.0)},
        "the same work for every sample; memory: the record itself",
    ),
    "output": (
        "stored rows, ten elastic masses, 10 s, steps of 10 ms",
        (100, 1000, 10_000, 100_000),
        lambda rows: chain(10, 10.0, 10.0 / rows),
        {"NEWMARK": ({"dt": 0.01}, 100_000), "TAYLOR": ({}, 100_000), "EXACT": ({}, 100_000)},
        "a row costs its step and its passage through Python; memory: blocks, written as they fill",
    ),
}  # fmt: skip


def growth(args, folder):
    """Time and memory against size."""
    lines = []
    for name, (what, sizes, model, methods, reason) in GROWTH.items():
        if args.only and name not in args.only:
            continue
        print(f"\n{name}: {what}\n{'':>10}", *(f"{m:>10} s {'MB':>8} events" for m in methods), flush=True)
        rows = {m: [] for m in methods}
        for size in sizes:
            cells = []
            for method, (options, largest) in methods.items():
                if size > largest:
                    continue
                done = run(folder, model(size), method, **options)
                held = memory(folder, model(size), method, **options)
                events = done.facts.get("events", "-")
                rows[method].append((size, done.seconds, held))
                cells.append(f"{done.seconds:12.4f} {held:8.1f} {events:>6}")
            print(f"{size:10g}", *cells, flush=True)
        lines += [line(what, method, own, reason) for method, own in rows.items()]
    print(
        "\n| what grows | method | from, to | CPU s | exponent | MB | exponent | why |\n" + 8 * "|---" + "|"
    )
    print("\n".join(lines))


def line(what, method, rows, reason):
    """One row of the table: what the least and the largest size cost, and the exponents."""
    sizes, times, held = zip(*rows)
    span = [f"{own[0]:.3g}, {own[-1]:.3g}" for own in (times, held)]
    slopes = [exponent(sizes, own) for own in (times, held)]
    cells = what, method, f"{sizes[0]:,g}, {sizes[-1]:,g}", span[0], slopes[0], span[1], slopes[1], reason
    return f"| {' | '.join(cells)} |"


def exponent(sizes, costs):
    """Slope of log cost over log size beyond what every run costs, fitted to the last few; - if none."""
    least = costs[0]
    grown = [(math.log(n), math.log(c - least)) for n, c in zip(sizes, costs) if c > 1.5 * least][-FITTED:]
    return f"{statistics.linear_regression(*zip(*grown)).slope:.2f}" if len(grown) > 1 else "-"


# ---------------------------------------------------------------------- changeover


def changeover(args, folder):
    """EXACT, TAYLOR, steps and AUTO on models of different size."""
    heads = "unknowns", "EXACT s", "TAYLOR s", "steps s", "AUTO s", "took", "of best"
    print("\n{:20}".format("scene"), *(f"{h:>9}" for h in heads))
    for name, (source, params) in SCENES.items():
        if args.only and name not in args.only:
            continue
        path = source
        if isinstance(source, str):
            path = Path(folder, "scene.inp")
            path.write_text(source, encoding="utf-8")
        ways = ("EXACT", False), ("TAYLOR", False), ("AUTO", True), ("AUTO", False)
        exact, series, steps, auto = (
            process(path, params, method, args.tol, barred) for method, barred in ways
        )
        if auto is None:
            print(f"{name:20} AUTO gives no answer")
            continue
        best = min(r.seconds for r in (exact, series, steps) if r is not None)
        over = auto.seconds / best
        took = auto.facts["method"].split(",")[0]
        cells = [f"{r.seconds:9.2f}" if r else f"{'-':>9}" for r in (exact, series, steps, auto)]
        print(f"{name:20}", f"{auto.facts['unknowns']:>9}", *cells, f"{took:>9} {over:9.2f}", end="  ")
        print("look" if over > WITHIN else "    ", end="")
        if exact:
            facts = (f"{exact.facts[k]} {k}" for k in ("events", "windows", "modal decompositions"))
            print("  EXACT:", *facts, f"{exact.facts['solving']:.2f} s", end="")
        if series:
            print(f"; TAYLOR: {series.facts['series']} series, {series.facts['solving']:.2f} s", end="")
        if steps:
            facts = (f"{steps.facts[k]} {k}" for k in ("steps", "runs"))
            print("; steps:", *facts, f"{steps.facts['solving']:.2f} s", end="")
        print(f"; AUTO {auto.facts['solving']:.2f} s", flush=True)


WHAT = {"growth": growth, "changeover": changeover}


def main():
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="*", metavar="WHAT", help=f"of {', '.join(WHAT)}; left out: all")
    parser.add_argument("--only", nargs="+", help=f"of {', '.join(GROWTH)}; of {', '.join(SCENES)}")
    parser.add_argument("--tol", type=float, default=TOL, help="tolerance of AUTO")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if wrong := set(args.what) - set(WHAT):
        parser.error(f"there is no {', '.join(wrong)}; there are {', '.join(WHAT)}")
    for library in ("OMP", "OPENBLAS", "MKL"):  # numpy is not imported yet
        os.environ[f"{library}_NUM_THREADS"] = "1"
    if args.one:
        return one(*json.loads(args.one))
    with tempfile.TemporaryDirectory() as folder:
        for name in args.what or WHAT:
            WHAT[name](args, folder)


if __name__ == "__main__":
    main()
