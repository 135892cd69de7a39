"""pound-solve and OpenSees on the paper's two buildings, in one go: time against error.

    python benchmarks/pair_cole.py --n 20

TAYLOR of pound-solve, which has no step, is the reference, and EXACT, which is found another way, shows
whether it is right; the peer steps through the same motion with each method and each dt.  Times are CPU
seconds of the solution alone.  Only ratios from one go mean anything, so both sides always run here, one
after the other, on one thread each.  Below the table stands what each method with steps would need for the
errors of EQUAL.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent
DECK = HERE.parent / "examples" / "cole2011" / "distributed.inp"
PEER = HERE.parent / ".venv-peer" / "bin" / "python"
RECORD = "ELCENTRO_270"  # the motion of the deck: this record times SIGN, first 10 s
SIGN = -1.0
DURATION = 10.0
STEPLESS = "TAYLOR", "EXACT"  # of our own
STEPPED = "NEWMARK", "CENTRAL"
OURS = 5  # rounds of our side; the best time counts, and the first one loads what later ones have
EQUAL = {"drift": 1e-5, "force": 1e-4}  # errors at which times are compared


class Answer(NamedTuple):
    """What one run of either side says; SI units and kN."""

    method: str
    dt: float | None  # or tolerance
    seconds: float  # CPU
    drift: dict[str, tuple[float, float]]  # name: (max, min) [m]
    force: dict[str, tuple[float]]  # floor: peak contact force [kN]
    closures: list[int]  # by floor
    sane: bool = True


def lean(folder):
    """The deck with the output that the peer keeps: extremes of drifts and contacts, no histories."""
    path = Path(folder, "lean.inp")
    output = "EVERY=t  NODES=1000+n,3000  MEMBERS=11001 TO 18001 BY 1000  STOREYS=NO"
    path.write_text(f'INCLUDE "{DECK}"\nOUTPUT\n   {output}\n')
    return path


def ours(deck, folder, params, method, dt=None, name="", tol=None):
    """One run of pound-solve, with a step or with a tolerance."""
    from pound_solve import run  # not before the number of threads is set

    results = run(deck, params=params, out=tempfile.mkdtemp(dir=folder), method=method, dt=dt, tol=tol)
    if results.status != "done":
        sys.exit(f"pair_cole: {results.message}")
    facts = {text(row["item"]): row["value"] for row in results.table("run_figures")}
    drifts = results.table("drift_envelope")
    contacts = results.table("contact_summary")
    return Answer(
        method=f"pound-solve, {method}{name}",
        dt=tol or dt,
        seconds=float(facts["solve seconds, CPU"]),
        drift={text(row["name"]): (float(row["max"]), float(row["min"])) for row in drifts},
        force=by_floor(contacts["peak_force"]),
        closures=[int(k) for k in contacts["closures"]],
    )


def theirs(python, script, *arguments):
    """What one run of a peer's script says, in a process of its own: OpenSees can hold only one model."""
    command = [python, HERE / script, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{Path(sys.argv[0]).stem}: the peer did not run\n{done.stderr}")
    return json.loads(done.stdout)


def opensees(python, record, method, dt, *more):
    """One run of OpenSees."""
    arguments = f"--dt={dt}", f"--duration={DURATION}", f"--integrator={method}", *more
    said = theirs(python, "opensees_cole.py", record, *arguments)
    return answer(f"OpenSees, {method}, {said['solver']}", dt, said)


def answer(method, dt, said):
    """What a peer said, as an Answer."""
    return Answer(
        method=method,
        dt=dt,
        seconds=said["cpu_seconds"],
        drift={name: tuple(pair) for name, pair in said["drift"].items()},
        force=by_floor(said["peak_force"]),
        closures=said["closures"],
        sane=said["sane"],
    )


def text(cell):
    """Text of a table's cell, which HDF5 may hand back as bytes."""
    return cell.decode() if isinstance(cell, bytes) else str(cell)


def by_floor(forces):
    """Forces as a dict like that of the drifts."""
    return {f"floor {i}": (float(force),) for i, force in enumerate(forces, 1)}


def error(values, reference):
    """Largest difference over all names, each relative to the larger extreme of that name."""
    if values.keys() != reference.keys():
        sys.exit(f"pair_cole: the sides name different things: {sorted(values)} and {sorted(reference)}")
    return max(map(relative, values.values(), (reference[name] for name in values)))


def relative(value, reference):
    """Largest difference of two tuples, relative to the largest magnitude of the second."""
    difference = max(abs(x - y) for x, y in zip(value, reference, strict=True))
    scale = max(map(abs, reference))
    return difference / scale if scale else math.inf * difference if difference else 0.0


def read_at2(path):
    """Step [s] and samples [g] of a PEER file: four lines of heading, the last one with NPTS and DT."""
    *_, counts, samples = path.read_text().split("\n", 4)
    dt = float(counts.upper().split("DT=")[1].split()[0])
    return dt, [float(word) for word in samples.split()]


def write_two_columns(path, dt, samples):
    """Write the window that the peer reads, with a sample to spare at the end."""
    window = samples[: round(DURATION / dt) + 2]
    path.write_text("".join(f"{i * dt:.9g} {SIGN * a!r}\n" for i, a in enumerate(window)))


def record_file():
    """The known record as an installed file."""
    from pound_solve.loading.records.known import find

    return find(RECORD, ())


def errors(answer, reference):
    """Errors of drifts and of contact forces."""
    return {kind: error(getattr(answer, kind), getattr(reference, kind)) for kind in EQUAL}


def table(answers, reference):
    """Lines of the comparison: one for each answer."""
    row = "{:34} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}".format
    yield row("method", "dt s", "CPU s", "drifts", "force", "closures", "ratio")
    for answer in answers:
        dt = f"{answer.dt:.0e}" if answer.dt else "-"
        told = ["no answer"] * 2 + ["-"]
        if answer.sane:
            told = [f"{e:.1e}" for e in errors(answer, reference).values()]
            told.append(f"{answer.seconds / reference.seconds:.2f}")
        closures = ", ".join(map(str, answer.closures))
        yield row(answer.method, dt, f"{answer.seconds:.3f}", *told[:2], closures, told[2])


def seconds_for(target, points):
    """CPU seconds for an error, and whether they lie beyond the runs.

    Between the first run that meets it and the one before, log time is a straight line over log error;
    beyond the finest run the line goes on from there with the slope that fits all runs best.

    Parameters
    ----------
    target : float
        Error asked for.
    points : list of (float, float)
        Error and seconds of each run, the coarsest first.
    """
    x, y = ([math.log(max(v, 1e-16)) for v in column] for column in zip(*points))
    goal = math.log(target)
    met = next((i for i, v in enumerate(x) if v <= goal), None)
    if met == 0:
        return points[0][1], True
    if met is not None:
        share = (goal - x[met - 1]) / (x[met] - x[met - 1])
        return math.exp(y[met - 1] + share * (y[met] - y[met - 1])), False
    mx, my = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - mx) ** 2 for a in x)
    slope = sum((a - mx) * (b - my) for a, b in zip(x, y)) / spread if spread else math.nan
    return math.exp(y[-1] + slope * (goal - x[-1])) if slope < 0 else math.inf, True


def at_equal_error(answers, reference, equal=EQUAL):
    """Lines: what each method needs for the errors of `equal`, and for both."""
    row = "{:34} {:>16} {:>16} {:>8}".format
    yield row("CPU s at equal error", *(f"{kind} {e:g}" for kind, e in equal.items()), "ratio")
    for method in dict.fromkeys(a.method for a in answers if a is not reference):
        runs = sorted((a for a in answers if a.method == method and a.sane and a.dt), key=lambda a: -a.dt)
        if len(runs) < 2:
            continue
        told = [errors(a, reference) for a in runs]
        found = [
            seconds_for(e, [(own[kind], a.seconds) for own, a in zip(told, runs)])
            for kind, e in equal.items()
        ]
        cells = [f"{s:.3g}{' *' if beyond else ''}" for s, beyond in found]
        yield row(method, *cells, f"{max(s for s, _ in found) / reference.seconds:.3g}")
    yield "* beyond the runs: extrapolated, or the coarsest run is better already"


def best_of(runs, rounds):
    """Answers of all runs, each with the least time of some rounds."""
    tries = [[run() for run in runs] for _ in range(rounds)]
    return [min(own, key=lambda a: a.seconds) for own in zip(*tries)]


def main():
    """Run both sides, print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--n", type=int, default=20, help="axial elements for each diaphragm, 1 or more")
    add("--methods", nargs="+", default=["newmark", "central"], help="of opensees_cole.py")
    add("--dt", nargs="+", type=float, default=[1e-4, 1e-5], help="steps of the peer [s]")
    add("--repeat", type=int, default=1, help="rounds of the peer; the best time of each run counts")
    add("--peer", type=Path, default=PEER, help="interpreter of the peer's environment")
    add("--record", type=Path, help=f"PEER file of {RECORD}, where it is not installed")
    args = parser.parse_args()
    if args.n < 1:
        parser.error("the deck of the distributed model needs n of 1 or more")
    if not args.peer.exists():
        sys.exit(f"pair_cole: no {args.peer}; make it by peer_env.py")

    for library in ("OMP", "OPENBLAS", "MKL"):  # one thread, as the peer; numpy is not imported yet
        os.environ[f"{library}_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder, "record.txt")
        write_two_columns(record, *read_at2(args.record or record_file()))
        deck, params = lean(folder), {"n": args.n}
        best = best_of([lambda m=m: ours(deck, folder, params, m) for m in STEPLESS], OURS)
        whole = ", all histories"
        best += best_of([lambda m=m: ours(DECK, folder, params, m, name=whole) for m in STEPLESS], OURS)
        best += best_of(
            [
                lambda m=method, dt=dt: ours(deck, folder, params, m, dt)
                for method in STEPPED
                for dt in args.dt
            ],
            args.repeat + 1,
        )
        best += best_of(
            [
                lambda m=method, dt=dt: opensees(args.peer, record, m, dt, f"--n={args.n}")
                for method in args.methods
                for dt in args.dt
            ],
            args.repeat,
        )
    print(f"n = {args.n}, {RECORD} x {SIGN:g}, first {DURATION:g} s; peer: best of {args.repeat}")
    print("\n".join([*table(best, best[0]), "", *at_equal_error(best, best[0])]))


if __name__ == "__main__":
    main()
