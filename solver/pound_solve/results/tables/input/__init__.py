"""Section 'Input' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Appendix: input", 110, keeps_long=True)
