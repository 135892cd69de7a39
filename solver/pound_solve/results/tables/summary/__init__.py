"""Section 'Summary' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Summary", 10, keeps_long=True)
