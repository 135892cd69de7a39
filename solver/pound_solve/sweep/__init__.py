"""Suites of runs: one study file, one command, many runs that can be interrupted and taken up."""
