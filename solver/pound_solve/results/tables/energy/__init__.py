"""Section 'Energy and checks' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Energy and checks", 100)
