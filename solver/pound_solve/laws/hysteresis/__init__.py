"""Hysteresis rules of springs and hinges, one rule a file."""
