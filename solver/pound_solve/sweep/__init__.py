"""Suites of runs: one study file, one command, many runs that can be interrupted and continued."""

from pound_solve.results.sweep_file import Sweep
from pound_solve.sweep.session import run_study

__all__ = ("Sweep", "run_study")
