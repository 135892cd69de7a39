"""Section 'Pushover' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Pushover", 60)
