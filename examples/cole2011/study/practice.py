"""The paper's question, answered for today's practice: when is a lumped floor good enough?"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean
from typing import NamedTuple

import numpy as np
from cases import APART, BENCHMARK, EXACT_EQUIVALENT, TRADITIONAL
from errors import benchmark_of, by_test, drifts
from runs import Run
from tabulate import tabulate


class Cell(NamedTuple):
    """One structure under one record.

    Attributes
    ----------
    strength : float
        Storey yield over that of Table IV.
    runs : sequence of Run
        All tests.
    soft : bool
        Whether contacts are as stiff as the softer element.  The peak of a mesh with stiffer ones
        overshoots that of bars further, so it is no measure of forces.
    """

    strength: float
    runs: Sequence[Run]
    soft: bool = True


RIVALS = {"0(equiv)": "0(equiv)", "1": "one element", "2": "two elements", "5": "five elements"}
LEAST = 500.0  #: peak force of the benchmark from which errors of it are counted [kN]


def practice(cells: Sequence[Cell], resolution: float) -> str:
    """Errors of every model over all cells, and what follows; differences of mean errors below the
    `resolution` [%], the benchmark's own, decide nothing.
    """
    left_out = (BENCHMARK, *(t.name for t in APART))
    names = [run.test for run in cells[0][1] if run.test not in left_out]
    head = ["model", "mean drift error [%]", "largest drift error [%]", "peak force, floor 2 [%]"]
    parts = [
        f"Errors of each model against {BENCHMARK} elements, as smallest / median / largest of "
        f"{len(cells)} cases, each one structure under one record: drift errors relative to no less than "
        f"half the yield drift; peak force of floor 2 where it is above {LEAST:.0f} kN and the contacts of "
        "the mesh are as stiff as the softer element (a mesh with stiffer ones overshoots the force of "
        "bars further).",
        tabulate([row(cells, name) for name in names], head, tablefmt="pipe", disable_numparse=True),
        "- `LAW=EQUIVALENT DIAPHRAGMS=kD1,kD2` (0(exact)) has the impulse and the centroid of the "
        "diaphragms' force. Its stiffness and restitution follow from masses and axial stiffnesses; no "
        "value has to be chosen. " + traditional(cells),
        f"- Mean drift errors that differ by less than {resolution:.2f} %, the benchmark's own error, are "
        f"not told apart. Of {len(cells)} cases, 0(exact) has the smaller one "
        + "; ".join(f"{beats(cells, name, resolution)} {told}" for name, told in RIVALS.items())
        + ".",
        f"- Its mean drift error is {ends(cells)}. Its largest drift error, "
        f"{max(max(errors(cell, EXACT_EQUIVALENT.name)) for cell in cells):.0f} %, is "
        f"{'above' if larger_worst(cells) else 'below'} that of 0(equiv).",
        f"- {forces(cells)}",
    ]
    return "\n\n".join(parts)


def larger_worst(cells: Sequence[Cell]) -> bool:
    """Whether the largest drift error of 0(exact) exceeds that of 0(equiv)."""
    exact, equiv = (max(max(errors(c, n)) for c in cells) for n in (EXACT_EQUIVALENT.name, "0(equiv)"))
    return exact > equiv


def traditional(cells: Sequence[Cell]) -> str:
    """What the usual stiffnesses come to."""
    rows = []
    for name, stiffness in zip(TRADITIONAL, ("10", "1", "0.1")):
        drift = median_error(cells, name)
        rows.append(f"{stiffness} k_D {drift:.1f} % (peak force {times(peaks(cells, name))})")
    exact = median_error(cells, EXACT_EQUIVALENT.name)
    force = times(peaks(cells, EXACT_EQUIVALENT.name))
    return (
        f"With the usual stiffnesses the median of the mean drift errors is, for {', '.join(rows)}; with "
        f"it {exact:.1f} % (peak force {force}). Forces are multiples of that of {BENCHMARK} elements."
    )


def median_error(cells: Sequence[Cell], name: str) -> float:
    """Median of a model's mean drift errors [%]."""
    return float(np.median([fmean(errors(cell, name)) for cell in cells]))


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
    exact = peaks(cells, EXACT_EQUIVALENT.name)
    nearer = [sum(abs(a) < abs(b) for a, b in zip(exact, peaks(cells, name))) for name in few]
    counts = ", ".join(f"{count} of {len(exact)} ({name})" for count, name in zip(nearer, few))
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
        for _, runs, soft in cells
        if soft and (peak := benchmark_of(runs).forces[1]) > LEAST
    ]


def errors(cell: Cell, name: str, far: bool | None = None) -> list[float]:
    """Sizes of the drift errors of one test, of all places, or of those at the far ends or beside the
    contact alone [%].
    """
    strength, runs, _ = cell
    found = drifts([by_test(runs)[name]], benchmark_of(runs), strength)
    return [abs(d.scaled) for d in found if far is None or d.far == far]


def beats(cells: Sequence[Cell], name: str, resolution: float) -> str:
    """In how many cells 0(exact) has the smaller mean error, and in how many another model has it."""
    gains = [fmean(errors(c, name)) - fmean(errors(c, EXACT_EQUIVALENT.name)) for c in cells]
    wins, losses = (sum(s * x > resolution for x in gains) for s in (1, -1))
    return f"in {wins}, and the larger one in {losses}, against"


def spread(values: Sequence[float]) -> str:
    """Smallest, median and largest, where there are values."""
    if not values:
        return "-"
    return " / ".join(f"{x:.1f}" for x in np.quantile(values, (0.0, 0.5, 1.0)))
