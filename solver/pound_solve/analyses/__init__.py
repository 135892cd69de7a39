"""Analyses that a deck may ask for, one a file."""
