"""Numerical methods, independent of structures."""
