"""pound-solve and OpenSees on an ordinary pair of concrete frames, in one go: time against error.

    python benchmarks/pair_rc.py kobe_1995_jma_ns_gal_0p01.txt

With a bilinear rule in the hinges, which both programs have, TAYLOR of pound-solve is the reference.  It
cannot be with the deck's own rule, Takeda's: OpenSees has `Hysteretic` instead, which is near but not the
same, and is measured against its own finest run.  Times are CPU seconds of the solution alone, one thread
each.
"""

import argparse
import itertools
import os
import re
import sys
import tempfile
from pathlib import Path

from pair_cole import HERE, PEER, answer, at_equal_error, best_of, ours, table, theirs

DECK = HERE / "rc_pair.inp"
STEP, GAL = 0.01, 0.01  # of the record: interval [s], unit [m/s2]
DURATION = 20.0
TARGETS = 1e-3, 1e-4  # errors at which times are compared


def bilinear(folder):
    """The deck with another rule in its hinges."""
    path = Path(folder, "bilinear.inp")
    deck = DECK.read_text(encoding="utf-8")
    path.write_text(re.sub(r"RULE=TAKEDA (R=\S+) .*", r"RULE=BILINEAR \1", deck), encoding="utf-8")
    return path


def write_motion(record, folder):
    """The record as the peer reads it, with a sample to spare at the end."""
    samples = record.read_text().split()[: round(DURATION / STEP) + 2]
    path = Path(folder, "motion.txt")
    path.write_text("".join(f"{x!r}\n" for x in [STEP, *(GAL * float(a) for a in samples)]))
    return path


def opensees(args, motion, rule, dt, solver, finer=1):
    """One run of OpenSees."""
    options = f"--rule={rule}", f"--dt={dt}", f"--solver={solver}", f"--finer={finer}"
    said = theirs(args.peer, "opensees_rc_pair.py", motion, *options)
    name = f", dt/{finer} near" if finer > 1 else ""
    return answer(f"OpenSees, {solver}{name}", dt, {**said, "closures": []})


def compare(answers, reference):
    """Print the tables."""
    print("\n".join(table(answers, reference)))
    for target in TARGETS:
        print("\n".join(["", *at_equal_error(answers, reference, {"drift": target, "force": target})]))


def main():
    """Run both sides, print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("record", type=Path, help="JMA Kobe N-S: ground acceleration [gal] every 0.01 s, one a line")
    add("--dt", nargs="+", type=float, default=[4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5], help="steps [s]")
    add("--finest", type=float, default=2e-5, help="step of the run that `Hysteretic` is measured by [s]")
    add("--solvers", nargs="+", default=["BandSPD"], help="of opensees_rc_pair.py")
    add("--finer", nargs="+", type=int, default=[1, 10], help="parts of the peer's steps near a contact")
    add("--rounds", type=int, default=3, help="rounds of our side; the best time of each run counts")
    add("--repeat", type=int, default=1, help="the same for the peer")
    add("--peer", type=Path, default=PEER, help="interpreter of the peer's environment")
    args = parser.parse_args()
    if not args.peer.exists():
        sys.exit(f"pair_rc: no {args.peer}; make it by peer_env.py")
    for library in ("OMP", "OPENBLAS", "MKL"):  # one thread, as the peer; numpy is not imported yet
        os.environ[f"{library}_NUM_THREADS"] = "1"

    with tempfile.TemporaryDirectory() as folder:
        motion = write_motion(args.record, folder)
        params = {"record": f'"{args.record.resolve()}"'}

        def own(deck, method, steps=(None,)):
            runs = [lambda dt=dt: ours(deck, folder, params, method, dt) for dt in steps]
            return best_of(runs, args.rounds)

        def peer(rule):
            cases = list(itertools.product(args.dt, args.solvers, args.finer))
            runs = [lambda case=case: opensees(args, motion, rule, *case) for case in cases]
            return best_of(runs, args.repeat)

        deck = bilinear(folder)
        best = [*own(deck, "TAYLOR"), *own(deck, "NEWMARK", args.dt), *peer("BILINEAR")]
        print("bilinear hinges; errors against TAYLOR")
        compare(best, best[0])

        (takeda,) = own(DECK, "TAYLOR")
        near = peer("HYSTERETIC")
        finest = opensees(args, motion, "HYSTERETIC", args.finest, args.solvers[0])
        print(f"\nTakeda: TAYLOR {takeda.seconds:.3f} s; errors of Hysteretic against its own finest run")
        compare(near, finest._replace(seconds=takeda.seconds))


if __name__ == "__main__":
    main()
