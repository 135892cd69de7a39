"""Damping models, one a file."""
