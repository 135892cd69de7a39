"""Section 'Reduced system and problem size' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Reduced system and problem size", 100)
