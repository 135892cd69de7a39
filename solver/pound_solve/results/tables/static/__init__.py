"""Section 'Static analysis' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Static analysis", 70)
