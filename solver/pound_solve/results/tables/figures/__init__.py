"""Section 'Run figures' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Run figures", 900, of_the_day=True)
