"""Read models of other programs: text in, a deck of this program out, with how each item was read.

A folder for each program: `opensees`, `ruaumoko`, `sap2000`.  All write into a `draft`, which becomes a
`translation`.
"""
