"""Solve a pound-solve model: from the checked Model to results, report and pictures."""

__version__ = "0.1.0"
