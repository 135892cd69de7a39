"""Numerics that know nothing of structures."""
