"""The paper's question, answered for today's practice: when is a lumped floor good enough?"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

import numpy as np
from cases import BENCHMARK, CANDIDATES
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
        f"{len(cells)} "
        "structures under a record: drift errors relative to no less than half the yield drift; peak "
        "force of "
        f"floor 2 where it is above {LEAST:.0f} kN.",
        tabulate([row(cells, name) for name in names], head, tablefmt="pipe", disable_numparse=True),
        f"- `LAW=EQUIVALENT DIAPHRAGMS=kD1,kD2` (0(exact)), the contact with the impulse and the "
        f"centroid of the "
        f"diaphragms' force, has a smaller mean drift error than the paper's 0(equiv) in "
        f"{beats(cells, '0(equiv)')} "
        f"cases, than one element in {beats(cells, '1')}, than two in {beats(cells, '2')}.",
        "- Restitution and stiffness then follow from masses and axial stiffnesses. No value has to "
        "be chosen. "
        "The usual stiffnesses, 10, 1 and 0.1 times k_D, have larger median errors than any other row, and "
        "the choice among them decides whether the force is several times too large or too small.",
        "- Lumped floors with this contact are good enough where drifts are asked for and the mean "
        "error above is "
        "acceptable. Where peak forces or the far ends of long floors matter, take distributed masses: "
        "the rows 2 "
        "and 5 say what few elements leave.",
    ]


def row(cells: Sequence[Cell], name: str) -> list[str]:
    """Errors of one model."""
    found = [errors(cell, name) for cell in cells]
    forces = [
        100 * (by_test(runs)[name].forces[1] / peak - 1)
        for _, runs in cells
        if (peak := benchmark_of(runs).forces[1]) > LEAST
    ]
    return [name, spread([fmean(e) for e in found]), spread([max(e) for e in found]), spread(forces)]


def errors(cell: Cell, name: str) -> list[float]:
    """Sizes of the drift errors of one test [%]."""
    strength, runs = cell
    return [abs(d.scaled) for d in drifts([by_test(runs)[name]], benchmark_of(runs), strength)]


def beats(cells: Sequence[Cell], name: str) -> str:
    """In how many cells the contact by the exact theory has the smaller mean error."""
    better = sum(fmean(errors(cell, "0(exact)")) < fmean(errors(cell, name)) for cell in cells)
    return f"{better} of {len(cells)}"


def spread(values: Sequence[float]) -> str:
    """Smallest, median and largest, where there are values."""
    if not values:
        return "-"
    return " / ".join(f"{x:.1f}" for x in np.quantile(values, (0.0, 0.5, 1.0)))
