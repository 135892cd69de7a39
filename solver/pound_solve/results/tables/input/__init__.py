"""Section 'Input' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Input", 110)
