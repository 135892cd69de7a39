"""Read models of other programs: text in, a deck of this program out, with how each item was read.

A folder for each program: `ruaumoko`.  All write into a `draft`, which becomes a `translation`.
"""
