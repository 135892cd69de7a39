"""Runs that are repeated with shorter steps until their peaks converge."""
