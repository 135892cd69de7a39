"""How the runs of a sweep are carried out: processes, limits, journal, and what survives a kill."""
