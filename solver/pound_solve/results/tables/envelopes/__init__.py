"""Section 'Envelopes of the time history' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Envelopes of the time history", 20)
