"""Section 'Error against time' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Error against time", 910, of_the_day=True)
