"""Runs that are repeated with shorter steps or smaller tolerances until their peaks converge."""
