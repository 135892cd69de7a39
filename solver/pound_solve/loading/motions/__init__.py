"""Family ``motion``: ground motions of the EQUAKE section.  One kind a file; see :mod:`.base`."""
