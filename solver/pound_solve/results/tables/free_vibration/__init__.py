"""Section 'Free vibration' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Free vibration", 80)
