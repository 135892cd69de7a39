"""Records of agencies as this program reads them, beside gmprocess and ObsPy.

    python benchmarks/agency_records.py FILE...

Needs gmprocess or ObsPy in the environment; without them the table has the header's figures only.  Files of
the agencies lie in the test data of both projects.  The difference is the largest one of all samples, after
the mean is taken off both where this program takes it off.
"""

import argparse
import contextlib
import io
import logging
import warnings
from pathlib import Path

import numpy as np

from pound_solve.loading.records import formats
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import load

PER_CM = {"G": 980.665, "M/S2": 100.0, "CM/S2": 1.0, "MM/S2": 0.1}


def ours(path):
    """All components of a file as this program reads them, in the order of the file."""
    text, _ = load(path)
    read = formats()["AUTO"].impl.read
    try:
        read(text, {"COMPONENT": "1"})
    except RecordError as error:
        if error.code != "R405":
            raise
        yield read(text, {})  # a format of one component takes no COMPONENT
        return
    for k in range(1, 100):
        try:
            yield read(text, {"COMPONENT": str(k)})
        except RecordError as error:
            if error.code != "R405":
                raise
            return


def theirs(path):
    """Samples [cm/s2] and step [s] of the traces of other programs, by program."""
    out = {}
    with contextlib.suppress(ImportError):
        from gmprocess.io.read import read_data

        with contextlib.redirect_stdout(io.StringIO()):
            streams = read_data(str(path))
        out["gmprocess"] = [(trace.data, trace.stats.delta) for s in streams for trace in s]
    with contextlib.suppress(ImportError):
        import obspy

        with contextlib.suppress(TypeError):  # what ObsPy says of a format that it does not know
            traces = obspy.read(str(path))
            out["ObsPy"] = [(100 * t.data * t.stats.calib, t.stats.delta) for t in traces]
    return out


def differences(raw, others):
    """For each program the trace nearest to ours: largest difference of its samples [cm/s2], step [s]."""
    mine = raw.values * PER_CM[raw.unit or "G"]
    centred = "mean removed" in raw.component
    for program, traces in others.items():
        found = [
            (float(np.abs(mine - (data - data.mean() if centred else data)).max()), step)
            for data, step in traces
            if len(data) == len(mine)
        ]
        if found:
            yield program, *min(found)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="record")
    paths = parser.parse_args().files
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    for path in paths:
        try:
            records = list(ours(path))
        except RecordError as error:
            print(f"{path.name:44.44s} {error}")
            continue
        try:
            others = theirs(path)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # gmprocess raises BaseException itself
            others = {}
            print(f"{path.name:44.44s} other program: {type(error).__name__}: {error}")
        for raw in records:
            peak = float(np.abs(raw.values).max())
            beside = "  ".join(f"{p} {d:.1e} step {s:g}" for p, d, s in differences(raw, others))
            component = raw.component.partition(",")[0]
            print(
                f"{path.name:44.44s} {raw.format:7s} {component:12s} {len(raw.values):7d} "
                f"{raw.dt or 0.0:7g} s  peak {peak:.7g} {raw.unit}, header {raw.peak or '-'}  {beside}"
            )
            for note in raw.notes:
                print(f"{'':44s} {note}")


if __name__ == "__main__":
    main()
