"""Read a model of SAP2000 from its text file: tables in, a deck of this program out.

`importer` calls a file for each part of the model: `units`, `joints`, `planes` (which plane of a model in
space), `sections`, `frames` with `assignments`, `mesh` and `members`, `constraints`, `nodes`, `links` with
`springs`, `curves` and `link_elements`, `patterns`, `spread`, `loads` and `masses`, `analysis`.  `tables`
reads the text, `recognise` identifies such files, `effects` names the tables that are not read.
"""
