"""Family ``force``: forces in time, lines of the FORCES section.  One kind a file; see :mod:`.base`."""
