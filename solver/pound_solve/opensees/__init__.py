"""Export of a deck to OpenSees, an independent program, and comparison of its peaks with ours.

`export` writes a script for OpenSeesPy from the assembled structure; one module for each kind of contents
translates it or refuses it by name.  `verify` runs the script at three halved steps and extrapolates.  No
number of the script is a result of this program; model data that the deck gives by a relation (stiffness of
neighbours, dashpots from a restitution, Rayleigh factors from modes) are resolved.
"""
