"""Section 'Ground motion' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Ground motion", 90)
