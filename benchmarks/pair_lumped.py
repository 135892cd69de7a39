"""The paper's two buildings with lumped floors: pound-solve, OpenSees and scipy, time against error.

    python benchmarks/pair_lumped.py                 # tests 0(10) and 0(equiv); some minutes

The same columns and rules as ``pair_cole.py``.  scipy runs in the environment of pound-solve, in a process
of its own.  In test 0(equiv) the contact has a dashpot and holds until the overlap is gone (TENSION=YES),
because no material of OpenSees lets go where the force is zero.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

from pair_cole import (
    DECK,
    DURATION,
    OURS,
    PEER,
    STEPLESS,
    STEPPED,
    answer,
    at_equal_error,
    best_of,
    opensees,
    ours,
    read_at2,
    record_file,
    table,
    theirs,
    write_two_columns,
)

LUMPED = DECK.with_name("lumped.inp")
CONTACTS = {  # stiffness [kN/m] and dashpot [kN s/m]: Table V; Eqs 16 and 17
    "0(10)": (18_813_000.0, 0.0),
    "0(equiv)": (3_254_097.0, 9822.4),
}


def set_in_deck(case):
    """PARAM values of a case: contacts that hold until the overlap is gone."""
    k, c = CONTACTS[case]
    return {"kc": k, "cc": c, "stick": '"YES"'}


def scipy(record, method, rtol, *more):
    """One run of scipy."""
    arguments = f"--rtol={rtol}", f"--duration={DURATION}", f"--method={method}", *more
    return answer(f"scipy, {method}", rtol, theirs(sys.executable, "scipy_lumped.py", record, *arguments))


def main():
    """Run all sides, print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--case", nargs="+", choices=CONTACTS, default=list(CONTACTS))
    add("--dt", nargs="+", type=float, default=[1e-3, 3e-4, 1e-4, 3e-5, 1e-5], help="steps [s]")
    add("--rtol", nargs="+", type=float, default=[1e-4, 1e-6, 1e-8], help="tolerances of scipy")
    add("--repeat", type=int, default=2, help="rounds of the peers; the best time of each run counts")
    add("--peer", type=Path, default=PEER, help="interpreter of the peer's environment")
    add("--record", type=Path, help="PEER file of El Centro 270, where it is not installed")
    args = parser.parse_args()
    if not args.peer.exists():
        sys.exit(f"pair_lumped: no {args.peer}; make it by peer_env.py")
    for library in ("OMP", "OPENBLAS", "MKL"):  # one thread; numpy is not imported yet
        os.environ[f"{library}_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder, "record.txt")
        write_two_columns(record, *read_at2(args.record or record_file()))
        for case in args.case:
            k, c = CONTACTS[case]
            params, contact = set_in_deck(case), (f"--k-contact={k}", f"--c-contact={c}")
            best = best_of([lambda m=m, p=params: ours(LUMPED, folder, p, m) for m in STEPLESS], OURS)
            mine = [
                lambda m=method, dt=dt, p=params: ours(LUMPED, folder, p, m, dt)
                for method in STEPPED
                for dt in args.dt
            ]
            peers = [
                lambda m=method, dt=dt, c=contact: opensees(args.peer, record, m, dt, "--n=0", *c)
                for method in ("newmark", "central", "central-lagged")
                for dt in args.dt
            ] + [
                lambda m=method, e=rtol, c=contact: scipy(record, m, e, *c)
                for method in ("RK45", "DOP853", "Radau")
                for rtol in args.rtol
            ]
            best += best_of(mine, OURS) + best_of(peers, args.repeat)
            print(f"\ntest {case}: k_C = {k:g} kN/m, c_C = {c:g} kN s/m; dt or rtol in the second column")
            print("\n".join([*table(best, best[0]), "", *at_equal_error(best, best[0])]), flush=True)


if __name__ == "__main__":
    main()
