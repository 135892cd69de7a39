"""Hysteresis rules of springs and hinges, one per file."""
