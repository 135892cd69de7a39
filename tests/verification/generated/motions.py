"""Ground motions of generated decks: the program's own, or files of a folder."""

from __future__ import annotations

import random
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pound_solve.loading.motions import record
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.records.base import RecordError

BEGIN = 0.05  #: share of the Arias intensity at which a record is taken to begin
STEPS = (None, 0.01)  #: of samples, that a file without times is read with [s]


class Found(NamedTuple):
    """A record file that can be read: items that it needs, largest value, time at which it begins [s]."""

    items: str
    peak: float
    begins: float


def motion(rng: random.Random, length: float, records: Path | None) -> str:
    """Line of EQUAKE of a motion that lasts a history [s]; its peak is 2 to 8 m/s2."""
    peak = rng.uniform(2.0, 8.0)
    kind, number = rng.random(), rng.randrange(10**6)
    # all is drawn in any case: what follows in the deck is the same with records and without
    cycle, soil = rng.uniform(0.3, 1.2), rng.uniform(9.0, 25.0)
    known = files(records) if records is not None else {}
    if known and kind < 0.5:
        name = sorted(known)[number % len(known)]
        found = known[name]
        start = max(found.begins - 0.5, 0.0)
        return f'RECORD "{name}"{found.items} UNIT=DECK START={start:.2f} SCALE={peak / found.peak:.5g}'
    if kind < 0.85:
        return (
            f"SYNTHETIC PGA={peak:.3g} SEED={number} DURATION={length:g} RISE=1 STRONG={0.6 * length:.2g} "
            f"WG={soil:.3g}"
        )
    return f"SINE AMPLITUDE={0.5 * peak:.3g} PERIOD={cycle:.3g} DURATION={length:g}"


@cache
def files(folder: Path) -> dict[str, Found]:
    """Record files of a folder, by name; what cannot be read is left out."""
    out = {}
    for path in sorted(folder.iterdir()):
        found = read(path)
        if found is not None:
            out[path.name] = found
    return out


def read(path: Path) -> Found | None:
    """What a record file holds, or None."""
    if path.suffix not in (".at2", ".dat", ".txt", ".csv", ".v2a", ".v1a", ".eqb"):
        return None
    context = LoadingContext(1.0, 1.0, (path.parent,), 1.0)
    for dt in STEPS:
        try:
            found = record.samples({"FILE": path.name, "DT": dt}, context)
        except RecordError:
            continue
        t, a = found.t, found.values
        energy = np.cumsum(a**2)
        items = f" DT={dt:g}" if dt else ""
        return Found(items, float(np.abs(a).max()), float(t[np.searchsorted(energy, BEGIN * energy[-1])]))
    return None
