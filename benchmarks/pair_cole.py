"""pound-solve and OpenSees on the paper's two buildings, in one go: time against error.

    python benchmarks/pair_cole.py --n 20

The exact solution of pound-solve is the reference; the peer steps through the same motion with each
method and each dt.  Only ratios of times from one go mean anything, so both sides always run here,
one after the other, on one thread each.
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


class Answer(NamedTuple):
    """What one run of either side says; SI units and kN."""

    method: str
    dt: float | None
    seconds: float
    drift: dict[str, tuple[float, float]]  # name: (max, min) [m]
    force: dict[str, tuple[float]]  # floor: peak contact force [kN]
    closures: list[int]  # by floor
    sane: bool = True


def ours(n, folder):
    """Exact solution by pound-solve."""
    from pound_solve import run  # not before the number of threads is set

    results = run(DECK, params={"n": n}, out=tempfile.mkdtemp(dir=folder))
    facts = {text(row["item"]): row["value"] for row in results.table("run_figures")}
    drifts = results.table("drift_envelope")
    contacts = results.table("contact_summary")
    return Answer(
        method="pound-solve, exact",
        dt=None,
        seconds=float(facts["solve seconds"]),
        drift={text(row["name"]): (float(row["max"]), float(row["min"])) for row in drifts},
        force=by_floor(contacts["peak_force"]),
        closures=[int(k) for k in contacts["closures"]],
    )


def theirs(python, record, n, method, dt):
    """One run of OpenSees, in a process of its own: it can hold only one model."""
    command = [python, HERE / "opensees_cole.py", record, f"--n={n}", f"--dt={dt}"]
    command += [f"--duration={DURATION}", f"--integrator={method}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"pair_cole: the peer did not run\n{done.stderr}")
    said = json.loads(done.stdout)
    return Answer(
        method=f"OpenSees, {method}, {said['solver']}",
        dt=dt,
        seconds=said["solve_seconds"],
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
    from pound_solve.records.known import find

    return find(RECORD, ())


def table(answers, reference):
    """Lines of the comparison: one for each answer."""
    row = "{:34} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}".format
    yield row("method", "dt s", "solve s", "drifts", "force", "closures", "ratio")
    for answer in answers:
        dt = f"{answer.dt:.0e}" if answer.dt else "-"
        closures = ", ".join(map(str, answer.closures))
        if not answer.sane:
            told = ["blew up"] * 2 + ["-"]
        else:
            pairs = (answer.drift, reference.drift), (answer.force, reference.force)
            told = [f"{error(*pair):.1e}" for pair in pairs]
            told.append(f"{answer.seconds / reference.seconds:.1f}")
        yield row(answer.method, dt, f"{answer.seconds:.3f}", *told[:2], closures, told[2])


def main():
    """Run both sides, print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--n", type=int, default=20, help="axial elements for each diaphragm, 1 or more")
    add("--methods", nargs="+", default=["newmark", "central"], help="of opensees_cole.py")
    add("--dt", nargs="+", type=float, default=[1e-4, 1e-5], help="steps of the peer [s]")
    add("--repeat", type=int, default=1, help="rounds; the best time of each run counts")
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
        runs = [lambda: ours(args.n, folder)]
        for method in args.methods:
            runs += [lambda m=method, dt=dt: theirs(args.peer, record, args.n, m, dt) for dt in args.dt]
        rounds = [[run() for run in runs] for _ in range(args.repeat)]

    best = [min(tries, key=lambda a: a.seconds) for tries in zip(*rounds)]
    print(f"n = {args.n}, {RECORD} x {SIGN:g}, first {DURATION:g} s; best of {args.repeat}")
    print("\n".join(table(best, best[0])))


if __name__ == "__main__":
    main()
