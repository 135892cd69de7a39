"""What a structure cannot be meant to be: one module for each kind of thing that is looked at.

A check takes a `Structure` and gives warnings; `driver.preflight` lists them all.
"""
