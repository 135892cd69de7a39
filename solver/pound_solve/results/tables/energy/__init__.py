"""Section 'Energy and run log' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Energy and run log", 50)
