"""Damping models, one per file."""
