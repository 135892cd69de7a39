"""Damper laws, one per file."""
