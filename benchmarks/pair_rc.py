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

from pair_cole import HERE, PEER, answer, at_equal_error, best_of, errors, ours, seconds_for, table, theirs

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


def beside_auto(answers, reference):
    """Lines: AUTO with each target as its tolerance, and how many times as long the cheapest way of the
    peer takes to that target, and to the errors that AUTO has.
    """
    row = "{:>8} {:>12} {:>10} {:>10} {:>18} {:>22}".format
    yield row("target", "AUTO CPU s", "drifts", "force", "peer to the target", "peer to AUTO's errors")
    peers = {a.method for a in answers if a.method.startswith("OpenSees")}
    of_peers = [[a for a in answers if a.method == name and a.sane] for name in sorted(peers)]

    def ratio(own, goals):
        ways = [
            max(
                seconds_for(e, [(errors(a, reference)[kind], a.seconds) for a in runs])[0]
                for kind, e in goals
            )
            for runs in of_peers
        ]
        return f"{min(ways) / own.seconds:.3g}"

    for own in (a for a in answers if a.method.endswith("AUTO")):
        told = errors(own, reference)
        cells = f"{own.dt:g}", f"{own.seconds:.3f}", *(f"{e:.1e}" for e in told.values())
        yield row(*cells, ratio(own, dict.fromkeys(told, own.dt).items()), ratio(own, told.items()))


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

        def own(deck, method, given=(None,), what="dt"):
            runs = [lambda x=x: ours(deck, folder, params, method, **{what: x}) for x in given]
            return best_of(runs, args.rounds)

        def peer(rule):
            cases = list(itertools.product(args.dt, args.solvers, args.finer))
            runs = [lambda case=case: opensees(args, motion, rule, *case) for case in cases]
            return best_of(runs, args.repeat)

        deck = bilinear(folder)
        best = [*own(deck, "TAYLOR"), *own(deck, "AUTO", TARGETS, "tol"), *own(deck, "NEWMARK", args.dt)]
        best += peer("BILINEAR")
        print("bilinear hinges; errors against TAYLOR")
        compare(best, best[0])
        print("\n".join(["", *beside_auto(best, best[0])]))

        (takeda,) = own(DECK, "TAYLOR")
        near = peer("HYSTERETIC")
        finest = opensees(args, motion, "HYSTERETIC", args.finest, args.solvers[0])
        print(f"\nTakeda: TAYLOR {takeda.seconds:.3f} s; errors of Hysteretic against its own finest run")
        compare(near, finest._replace(seconds=takeda.seconds))


if __name__ == "__main__":
    main()
