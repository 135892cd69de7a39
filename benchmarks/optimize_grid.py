"""Searches for an optimum beside grids of as many points: the studies of ``examples/optimize``.

    python benchmarks/optimize_grid.py [bumpers dampers strengths] [--workers N]

For each study: the objective in the study, that of the best point of the search and of the best of a grid,
the ratio of both, points, runs, and CPU seconds of all runs of each.  A grid has the most points of equal
numbers along each variable that the search has asked for, and is scaled as the search is.
"""

import argparse
import itertools
import shutil
import tempfile
from pathlib import Path

import numpy as np

from pound_solve.cli.main import main as pound_solve
from pound_solve.statistics.optimum import Tried
from pound_solve.sweep import optimize
from pound_solve.sweep.execution.executors import engine
from pound_solve.sweep.points import Points
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import read

FOLDER = Path(__file__).parents[1] / "examples" / "optimize"
STUDIES = ("bumpers", "dampers", "strengths")


def analysis(study, workers):
    """The analysis of a study, without a run."""
    document = Document.read(str(study))
    aim = optimize.aim(document)
    runs = read(document, optimize.TABLES)
    return optimize.OptimumAnalysis(Points(Session(runs, engine("", workers))), aim)


def spent(points):
    """Runs of the points, and their CPU seconds."""
    entries = points.session.entries
    ended = [entries[run.identity] for run in points.session.study.runs if run.identity in entries]
    return len(ended), sum(entry.cpu for entry in ended)


def searched(study, workers):
    """The best point of the search, the objective of the study, and what they have cost."""
    own = analysis(study, workers)
    with own.points.conducted(lambda state: None):
        search = own.carry_out()
    return search.best, own.before.objective, len(search.tried), *spent(own.points)


def on_a_grid(study, count, workers):
    """The best point of a grid of at most so many points, and what they have cost."""
    own = analysis(study, workers)
    variables = own.problem.variables
    each = int(count ** (1.0 / len(variables)) + 1e-9)
    grid = list(itertools.product(np.linspace(0.0, 1.0, each).tolist(), repeat=len(variables)))
    with own.points.conducted(lambda state: None):
        outcomes = own.outcomes(grid)
    tried = [
        Tried(1, x, o, max(c.excess(v) for c, v in zip(own.problem.limits, o.limited)))
        for x, o in zip(grid, outcomes)
    ]
    return min(tried, key=lambda t: t.rank), len(tried), *spent(own.points)


def compared(name, folder, workers):
    """One line of the table."""
    study = folder / f"{name}.toml"
    best, before, count, runs, cpu = searched(study, workers)
    text = study.read_text("utf-8")
    grid = folder / f"{name}_grid.toml"
    grid.write_text(text, "utf-8")  # with a folder of results of its own
    on_grid, points, grid_runs, grid_cpu = on_a_grid(grid, count, workers)
    objectives = [t.outcome.objective if t.is_feasible else np.nan for t in (best, on_grid)]
    return (
        f"{name:<10} {before:>9.5g} {objectives[0]:>9.5g} {objectives[1]:>9.5g} "
        f"{objectives[0] / objectives[1]:>6.3f} {count:>7} {points:>5} {runs:>5} {grid_runs:>5} "
        f"{cpu:>7.1f} {grid_cpu:>7.1f}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("studies", nargs="*", default=STUDIES, help="of examples/optimize")
    parser.add_argument("--workers", type=int, default=1)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "optimize"
        shutil.copytree(FOLDER, folder)
        if not (folder / "suite").is_dir():
            pound_solve(["motions", str(folder / "four_motions.inp"), "-o", str(folder / "suite")])
        head = (
            "study",
            "before",
            "search",
            "grid",
            "ratio",
            "points",
            "grid",
            "runs",
            "grid",
            "CPU s",
            "grid",
        )
        print("{:<10} {:>9} {:>9} {:>9} {:>6} {:>7} {:>5} {:>5} {:>5} {:>7} {:>7}".format(*head))
        for name in args.studies:
            print(compared(name, folder, args.workers), flush=True)


if __name__ == "__main__":
    main()
