"""Execution of the runs of a sweep: processes, limits, and a journal that survives a kill."""
