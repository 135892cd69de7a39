"""Table ``run_figures``."""

from __future__ import annotations

import platform
import time
from collections.abc import Iterator

import numpy as np

from pound_solve.results.columns import ITEM, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table
from pound_solve.version import __version__


def rows(run: RunRecord) -> Iterator[Row]:
    """Times of this run, and versions."""
    from pound_solve.numerics.providers import provider  # which reading a report does not need

    yield "date", time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime())
    yield "solve seconds", f"{run.solve_seconds:.4f}"
    yield "solve seconds, CPU", f"{run.cpu_seconds:.4f}"
    yield "total seconds", f"{time.perf_counter() - run.began:.4f}"
    yield "kernels", provider().name
    yield "pound-solve", __version__
    yield "Python, numpy", f"{platform.python_version()}, {np.__version__}"


TABLE = Table(
    name="run_figures",
    title="Time, memory, versions",
    place=10,
    stages=(Stage.END,),
    columns=(ITEM, VALUE),
    rows=rows,
    note="Only this last section differs between two runs of the same deck.",
)
