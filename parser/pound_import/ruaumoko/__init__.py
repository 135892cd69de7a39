"""Read a deck of Ruaumoko-2D: its text in, a deck of this program out, with how each item was read.

One file for each part of the old deck: `header` (the control lines), `nodes`, `elements`, `props` with
`springs`, `frames` and `rules`, `nodal` (WEIGHTS, LOADS), `equake`.  `importer` calls them in this order,
`recognise` identifies such decks.
"""
