"""Plausibility checks of a structure: one module for each kind of mistake.

A check takes a `Structure` and returns warnings; `driver.preflight` lists them all.
"""
