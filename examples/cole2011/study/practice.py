"""The paper's question, answered for today's practice: when is a lumped floor good enough?"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

import numpy as np
from cases import BENCHMARK, CANDIDATES, EXACT_EQUIVALENT, TRADITIONAL
from errors import benchmark_of, by_test, drifts
from runs import Run
from tabulate import tabulate

#: a structure's strength over Table IV, and all tests of it under one record
Cell = tuple[float, Sequence[Run]]
LEAST = 500.0  #: peak force of the benchmark from which errors of it are counted [kN]


def practice(cells: Sequence[Cell]) -> list[str]:
    """Errors of every model over all cells, and what follows."""
    names = [run.test for run in cells[0][1] if run.test not in (BENCHMARK, *(t.name for t in CANDIDATES))]
    head = ["model", "mean drift error [%]", "largest drift error [%]", "peak force, floor 2 [%]"]
    return [
        "## For today's practice: when is a lumped floor good enough?",
        f"Errors of each model against {BENCHMARK} elements, as smallest / median / largest of "
        f"{len(cells)} cases, each one structure under one record: drift errors relative to no less than "
        f"half the yield drift; peak force of floor 2 where it is above {LEAST:.0f} kN.",
        tabulate([row(cells, name) for name in names], head, tablefmt="pipe", disable_numparse=True),
        f"- `LAW=EQUIVALENT DIAPHRAGMS=kD1,kD2` (0(exact)), the contact with the impulse and the centroid "
        f"of the diaphragms' force, has a smaller mean drift error than the paper's 0(equiv) in "
        f"{beats(cells, '0(equiv)')} cases, than one element in {beats(cells, '1')}, than two in "
        f"{beats(cells, '2')}, than five in {beats(cells, '5')}.",
        "- Its stiffness and restitution follow from masses and axial stiffnesses; no value has to be "
        "chosen. " + traditional(cells),
        f"- Its mean drift error is {ends(cells)}.",
        f"- {forces(cells)}",
    ]


def traditional(cells: Sequence[Cell]) -> str:
    """What the usual stiffnesses come to."""
    rows = []
    for name, stiffness in zip(TRADITIONAL, ("10", "1", "0.1")):
        drift = np.median([fmean(errors(cell, name)) for cell in cells])
        rows.append(f"{stiffness} k_D {drift:.1f} % (peak force {times(peaks(cells, name))})")
    own = np.median([fmean(errors(cell, EXACT_EQUIVALENT.name)) for cell in cells])
    force = times(peaks(cells, EXACT_EQUIVALENT.name))
    return (
        f"With the usual stiffnesses the median of the mean drift errors is, for {', '.join(rows)}; with "
        f"it {own:.1f} % (peak force {force}). Forces are multiples of that of {BENCHMARK} elements."
    )


def times(found: Sequence[float]) -> str:
    """Smallest and largest of some errors [%], as multiples."""
    return f"{1 + min(found) / 100:.2f} to {1 + max(found) / 100:.2f}" if found else "not seen"


def ends(cells: Sequence[Cell]) -> str:
    """Its errors at the columns beside the contact and at the far ends, and where they are larger."""
    far = [fmean(errors(cell, EXACT_EQUIVALENT.name, True)) for cell in cells]
    near = [fmean(errors(cell, EXACT_EQUIVALENT.name, False)) for cell in cells]
    larger = sum(f > n for f, n in zip(far, near))
    return (
        f"larger at the far ends of the floors than beside the contact in {larger} of {len(cells)} cases "
        f"(medians {np.median(far):.1f} and {np.median(near):.1f} %)"
    )


def forces(cells: Sequence[Cell]) -> str:
    """Peak forces of few elements beside those of the contact."""
    few = ("1", "2", "5")
    told = ", ".join(f"{times(peaks(cells, name))} with {name}" for name in few)
    own = peaks(cells, EXACT_EQUIVALENT.name)
    nearer = [sum(abs(a) < abs(b) for a, b in zip(own, peaks(cells, name))) for name in few]
    counts = ", ".join(f"{count} of {len(own)} ({name})" for count, name in zip(nearer, few))
    return (
        f"The peak force of few elements is, as a multiple of that of {BENCHMARK}: {told}. That of the "
        f"contact is nearer to it in {counts}."
    )


def row(cells: Sequence[Cell], name: str) -> list[str]:
    """Errors of one model."""
    found = [errors(cell, name) for cell in cells]
    return [
        name,
        spread([fmean(e) for e in found]),
        spread([max(e) for e in found]),
        spread(peaks(cells, name)),
    ]


def peaks(cells: Sequence[Cell], name: str) -> list[float]:
    """Errors of the peak force at floor 2 of one model, where the benchmark has one [%]."""
    return [
        100 * (by_test(runs)[name].forces[1] / peak - 1)
        for _, runs in cells
        if (peak := benchmark_of(runs).forces[1]) > LEAST
    ]


def errors(cell: Cell, name: str, far: bool | None = None) -> list[float]:
    """Sizes of the drift errors of one test, of all places, or of those at the far ends or beside the
    contact alone [%].
    """
    strength, runs = cell
    found = drifts([by_test(runs)[name]], benchmark_of(runs), strength)
    return [abs(d.scaled) for d in found if far is None or d.far == far]


def beats(cells: Sequence[Cell], name: str) -> str:
    """In how many cells the contact by the exact theory has the smaller mean error."""
    better = sum(fmean(errors(cell, "0(exact)")) < fmean(errors(cell, name)) for cell in cells)
    return f"{better} of {len(cells)}"


def spread(values: Sequence[float]) -> str:
    """Smallest, median and largest, where there are values."""
    if not values:
        return "-"
    return " / ".join(f"{x:.1f}" for x in np.quantile(values, (0.0, 0.5, 1.0)))
