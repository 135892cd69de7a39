"""Section 'Members and springs' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Members and springs", 30)
