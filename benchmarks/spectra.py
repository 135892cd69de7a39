"""Response spectra and intensity measures beside eqsig and pyRotd.

    python benchmarks/spectra.py export FILE... FOLDER
    python benchmarks/spectra.py compare FOLDER

The first writes samples and this program's figures; the second needs eqsig and pyrotd, and not this
program: the two may have environments of their own.

The other programs get the same samples in m/s2.  Zeros follow them, because this program counts the free
vibration, and because the Fourier transform of pyRotd is periodic: its oscillators must come to rest.  They
get the samples once as they are, and once with seven more on every line between two, because they look for
peaks at samples and integrate by the trapezium rule.
"""

import argparse
import json
from pathlib import Path

import numpy as np

PERIODS = np.geomspace(0.05, 5.0, 41)
GRAVITY = 9.80665
QUIET = 20  # longest periods of zeros


def export(names, folder):
    """Write samples and figures of records as JSON."""
    from pound_solve.assess.spectra import of_record
    from pound_solve.loading.intensity import intensity
    from pound_solve.loading.spectrum import response_spectrum

    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        (lines,) = of_record(name).accelerations.values()
        found = response_spectrum(lines, PERIODS, 0.05)
        held = {
            "dt": float(np.diff(lines.breaks).mean()),
            "a": lines.value(lines.breaks).tolist(),
            "intensity": intensity(lines, GRAVITY)._asdict(),
            **{q: getattr(found, q)[0].tolist() for q in ("sd", "psa", "sa")},
        }
        (folder / f"{Path(name).stem}.json").write_text(json.dumps(held), encoding="utf-8")


def compare(folder):
    """Print the differences, other program less this one, as shares of this one."""
    print("| record | samples | program | quantity | median | largest |\n|---|---|---|---|---|---|")
    for path in sorted(folder.glob("*.json")):
        own = json.loads(path.read_text(encoding="utf-8"))
        for parts in (1, 8):
            t = np.arange((len(own["a"]) - 1) * parts + 1) / parts
            a, dt = np.interp(t, np.arange(len(own["a"])), own["a"]), own["dt"] / parts
            label = f"| {path.stem} | {'as they are' if parts == 1 else 'eightfold'} |"
            for program, quantity, theirs in spectra(a, dt):
                off = theirs / np.array(own[quantity]) - 1.0
                worst = np.abs(off).argmax()
                figures = f"{np.median(np.abs(off)):.1e} | {off[worst]:+.1e} at {PERIODS[worst]:.3f} s"
                print(f"{label} {program} | {quantity} | {figures} |")
            for quantity, value in measures(a, dt):
                print(f"{label} eqsig | {quantity} | | {value / own['intensity'][quantity] - 1.0:+.1e} |")


def spectra(a, dt):
    """Spectra of other programs: program, quantity, values."""
    import eqsig
    import pyrotd

    long = np.concatenate([a, np.zeros(int(QUIET * PERIODS[-1] / dt))])
    sd, _, psa = eqsig.sdof.pseudo_response_spectra(long, dt, PERIODS, 0.05)
    yield "eqsig", "sd", sd
    yield "eqsig", "psa", psa
    yield "pyRotd", "psa", pyrotd.calc_spec_accels(dt, long, 1.0 / PERIODS, 0.05).spec_accel


def measures(a, dt):
    """Intensity measures of eqsig: quantity, value."""
    import eqsig

    signal = eqsig.AccSignal(a, dt)
    yield "arias", eqsig.im.calc_arias_intensity(signal)[-1] * 9.81 / GRAVITY  # it has a gravity of its own
    yield "cav", eqsig.im.calc_cav(signal)[-1]
    for end in (75, 95):
        yield f"d5_{end}", eqsig.im.calc_sig_dur(signal, start=0.05, end=end / 100)


def main():
    """Write figures, or compare them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    verb = verbs.add_parser("export", help="write samples and figures of this program")
    verb.add_argument("files", nargs="+", metavar="FILE", help="record")
    verb.add_argument("folder", type=Path)
    verb = verbs.add_parser("compare", help="print the differences of the other programs")
    verb.add_argument("folder", type=Path)
    args = parser.parse_args()
    if args.verb == "export":
        export(args.files, args.folder)
    else:
        compare(args.folder)


if __name__ == "__main__":
    main()
