"""Analyses that a deck may request, one per file."""
